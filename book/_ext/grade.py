"""Grades returned assignments: `make grade FOLDER=returned`, at most MINUTES=5 each.

Every notebook of the folder, and of its own folders, is run anew from the top: in a process of its
own, beside a fresh judge and a fresh `ddlib`, without a network. Answers are judged with the
settings of the notebook's variant, whatever stands in its copy. What the judge says, and what the
students say, goes into grades.csv in that folder.
"""

from __future__ import annotations

import argparse
import ast
import csv
import io
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import nbformat
from assignment import HOW, folder, lessons, right_letters
from solved import STARTER, assigned

from ddlib._files import write_whole

KEPT = "grades.csv"
MINUTES = 5.0
RUN = Path(__file__).with_name("graded_run.py")
UNSHARE = ["unshare", "--map-root-user", "--net"]
VERDICTS = {"Right": "right", "Wrong": "wrong", "Put your answer": "no answer"}
FIRST = ("file", "name", "lesson", "variant", "changed")
LAST = ("quiz", "score", "of", "error", "seconds")


class Unfit(Exception):
    """A file that cannot be graded, and why."""


@dataclass
class Fresh:
    """An assignment as it was handed out."""

    place: Path
    notebook: nbformat.NotebookNode
    letters: dict[int, str]

    @property
    def questions(self) -> int:
        return self.notebook.metadata["assignment"]["questions"]


def role(cell) -> str:
    """What a cell is for; some editors lose a cell's metadata, others its name."""
    return cell.metadata.get("assignment", "") or cell.get("id", "")


def returned(where: Path) -> list[Path]:
    """The notebooks of a folder, and of folders in it."""
    found = [*where.glob("*.ipynb"), *where.glob("*/*.ipynb")]
    return sorted(p for p in found if not p.relative_to(where).parts[0].startswith("."))


def read(path: Path):
    try:
        notebook = nbformat.read(path, as_version=4)
        known = notebook.metadata["assignment"]
        return notebook, str(known["lesson"]), int(known["variant"])
    except (KeyError, TypeError, AttributeError):
        raise Unfit("its metadata names no assignment of this book") from None
    except Exception as error:
        raise Unfit(f"no notebook: {type(error).__name__}") from None


def isolated() -> bool:
    """Whether the system can start a process that has no network."""
    try:
        return subprocess.run([*UNSHARE, "true"], capture_output=True).returncode == 0
    except OSError:
        return False


def to_run(notebook, fresh: Fresh) -> list[dict]:
    """A notebook's code, with the settings and the checks as they were handed out."""
    given = {role(cell): cell.source for cell in fresh.notebook.cells}
    cells = []
    for cell in (c for c in notebook.cells if c.cell_type == "code"):
        own = role(cell)
        source = cell.source
        if own.startswith("check-") and own in given:  # with what its question was given
            asked = STARTER.sub("# mine = ...", given[own.replace("check", "answer")])
            source = f"{asked}\n{given[own]}"
        cells.append({"role": own, "source": source})
        if own == "settings":
            cells.append({"role": "settings", "source": given[own]})
    return cells


def changed(notebook, fresh: Fresh) -> str:
    """Which settings, and which other code that was handed out, are not as they were."""
    own = {role(c): c.source for c in notebook.cells if c.cell_type == "code"}
    found = []
    for cell in (c for c in fresh.notebook.cells if c.cell_type == "code"):
        name = role(cell)
        if name.startswith(("answer-", "quiz")) or _alike(own.get(name, ""), cell.source):
            continue
        found += _settings(own.get(name, ""), cell.source) if name == "settings" else [name]
    return ", ".join(found)


def _alike(one: str, other: str) -> bool:
    try:
        return ast.dump(ast.parse(one)) == ast.dump(ast.parse(other))
    except SyntaxError:
        return False


def _settings(one: str, other: str) -> list[str]:
    try:
        mine, given = ({k: ast.dump(v) for k, v in assigned(s).items()} for s in (one, other))
    except SyntaxError:
        return ["settings"]
    return [k for k in given if mine.get(k) != given[k]] or ["settings"]


def texts(notebook) -> dict[str, str]:
    """A name and explanations, by column."""
    found = {}
    for cell in notebook.cells:
        own = role(cell)
        if own == "name":
            named = re.search(r"\*\*Name:\*\*[ \t]*(.*)", cell.source)
            found["name"] = named[1].strip() if named else ""
        elif own.startswith("how-"):
            number = own.removeprefix("how-")
            first, _, asked = HOW.format(number).partition(" *")
            told = cell.source.replace(f"*{asked}", "").replace(first, "")
            found[f"explanation {number}"] = told.strip()
    return found


def run(cells: list[dict], place: Path, minutes: float, alone: bool) -> tuple[list[dict], str]:
    """Run cells in a folder: what each of them gave, and why they ended early."""
    kept = place / ".graded"
    command = [sys.executable, str(RUN), str(kept), "alone" if alone else "blocked"]
    process = subprocess.Popen(
        UNSHARE + command if alone else command, cwd=place, start_new_session=True,
        stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        env={"PATH": os.environ.get("PATH", ""), "HOME": str(place), "OMP_NUM_THREADS": "1"},
    )  # fmt: skip
    ended = ""
    try:
        process.communicate(json.dumps(cells).encode(), timeout=60 * minutes)
    except subprocess.TimeoutExpired:
        ended = f"stopped after {minutes:g} minutes"
    finally:
        if hasattr(os, "killpg"):
            try:
                os.killpg(process.pid, signal.SIGKILL)  # and what it has started
            except ProcessLookupError:
                pass
        process.kill()
        process.wait()
    if not ended and process.returncode > 0:
        ended = f"ended with status {process.returncode}"
    lines = kept.read_text("utf-8").splitlines() if kept.exists() else []
    done = [json.loads(line) for line in lines if line.endswith("}")]
    if not ended and len(done) < len(cells):
        ended = "ended before its last cell"
    return done, ended


def verdicts(done: list[dict], fresh: Fresh) -> dict[str, object]:
    """What became of each question, and of the quiz."""
    row, raised = {}, {d["role"]: d["error"] for d in done if d["error"]}
    for number in range(1, fresh.questions + 1):
        said = [d for d in done if d["role"] == f"check-{number}"]
        told = [d for d in said if d["said"] and not d["said"].startswith("Put your")]
        one = (told or said or [None])[-1]
        if one is None:
            row[f"question {number}"], row[f"judge {number}"] = "not reached", ""
            continue
        found = (v for begins, v in VERDICTS.items() if one["said"].startswith(begins))
        row[f"question {number}"] = next(found, "not judged")
        failed = raised.get(f"answer-{number}", "")
        said = one["said"] if told else (failed and f"The answer's cell raised {failed}")
        row[f"judge {number}"] = said or one["error"]
    given = next((d["choices"] for d in reversed(done) if "choices" in d), {})
    right = sum(given.get(str(k)) == letter for k, letter in fresh.letters.items())
    row["quiz"] = f"{right} of {len(fresh.letters)}" if fresh.letters else ""
    row["score"] = [row[f"question {k}"] for k in range(1, fresh.questions + 1)].count("right")
    return row | {"of": fresh.questions}


def grade(path: Path, where: Path, made: dict, minutes: float, alone: bool) -> dict[str, object]:
    """A line of the table, for one file."""
    row = {"file": path.relative_to(where).as_posix()}
    try:
        notebook, lesson, variant = read(path)
        row |= {"lesson": lesson, "variant": variant}
        fresh = made.get((lesson, variant))
        if fresh is None:
            raise Unfit("this book has no such assignment")
        row |= texts(notebook) | {"changed": changed(notebook, fresh)}
        began = time.monotonic()
        with TemporaryDirectory() as place:
            own = Path(place, "run")
            shutil.copytree(fresh.place, own)
            done, ended = run(to_run(notebook, fresh), own, minutes, alone)
        errors = [f"{d['role']}: {d['error']}" for d in done if d["error"]]
        row |= verdicts(done, fresh)
        row |= {"error": "; ".join([ended] * bool(ended) + errors[:1])}
        row["seconds"] = round(time.monotonic() - began, 1)
    except Unfit as why:
        row["error"] = str(why)
    return row


def handed_out(paths: list[Path], to: Path) -> dict[tuple[str, int], Fresh]:
    """Fresh assignments of all lessons and variants that some files say they are."""
    made, known = {}, lessons()
    for path in paths:
        try:
            _, lesson, variant = read(path)
            if lesson in known and (lesson, variant) not in made:
                place = folder(known[lesson], variant, to / f"{lesson}-{variant}")
                notebook = nbformat.read(place / f"{lesson}.ipynb", as_version=4)
                made[lesson, variant] = Fresh(place, notebook, right_letters(lesson))
        except (Unfit, ValueError):
            continue  # the file's own line says it
    return made


def table(rows: list[dict]) -> str:
    """The rows as CSV, with columns for as many questions as one of them has."""
    most = max((row.get("of", 0) for row in rows), default=0)
    asked = [f"{w} {k}" for k in range(1, most + 1) for w in ("question", "judge", "explanation")]
    text = io.StringIO()
    writer = csv.DictWriter(text, [*FIRST, *asked, *LAST], "", "ignore", lineterminator="\n")
    writer.writeheader()
    writer.writerows({k: _plain(v) for k, v in row.items()} for row in rows)
    return text.getvalue()


def _plain(value):
    """What a spreadsheet does not take for a formula."""
    formula = isinstance(value, str) and value.startswith(("=", "+", "-", "@", "\t", "\r"))
    return f"'{value}" if formula else value


def grades(where: Path, minutes: float = MINUTES, jobs: int = 2) -> list[dict]:
    """Grade a folder, and write its table."""
    if not where.is_dir():
        raise ValueError(f"FOLDER must be a folder, got {str(where)!r}")
    if not 0 < minutes < float("inf"):
        raise ValueError(f"MINUTES must be above 0, got {minutes:g}")
    paths = returned(where)
    if not paths:
        raise ValueError(f"FOLDER must have notebooks in it, or in folders of it; got {where}")
    alone = isolated()
    with TemporaryDirectory() as place, ThreadPoolExecutor(jobs) as pool:
        made = handed_out(paths, Path(place))
        rows = list(pool.map(lambda path: grade(path, where, made, minutes, alone), paths))
    write_whole(where / KEPT, table(rows).encode("utf-8-sig"))
    return rows


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("folder", type=Path)
    parser.add_argument("--minutes", type=float, default=MINUTES)
    parser.add_argument("--jobs", type=int, default=2)
    given = parser.parse_args()
    how = "the system" if isolated() else "blocking Python's sockets (programs can still reach it)"
    print(f"==> No network, by {how}; at most {given.minutes:g} minutes for each notebook")
    for row in grades(given.folder, given.minutes, given.jobs):
        score = f"{row['score']} of {row['of']} right" if "score" in row else "not graded"
        print(f"    {row['file']}: {score}" + (f" ({row['error']})" if row["error"] else ""))
    print(f"==> {given.folder / KEPT}")


if __name__ == "__main__":
    try:
        main()
    except ValueError as error:
        sys.exit(f"==> {error}")
