"""Speed and memory, against others in the same run: ``make bench``.

Writes ``book/results/benchmarks.json``, which the page *Status* shows. Each part runs in a
process of its own, so that its peak memory is its own. Times vary with the machine and its
load, ratios much less: the two of a pair take turns. A ratio's goal is to be ahead of the peer by
as much as its user notices, and not to fall behind what is committed (`measure.goal`).
"""

from __future__ import annotations

import argparse
import datetime
import json
import os
import platform
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from importlib import import_module
from pathlib import Path

from measure import committed, memory_row, met, not_measured, quantity

from ddlib.setups import WINDOWS
from ddlib.tables import significant

ROOT = Path(__file__).resolve().parent.parent
sys.path.append(str(ROOT / "book"))
from workshop.report import results  # noqa: E402

BUILT_FROM = ("_config.yml", "_toc.yml", "requirements.txt", "pyproject.toml", "book", "ddlib")


def book() -> list[dict]:
    """Rows of a cold build: notebooks executed and pages written, nothing kept from before."""
    with tempfile.TemporaryDirectory() as folder:
        for name in BUILT_FROM:
            copy = shutil.copytree if (ROOT / name).is_dir() else shutil.copy
            copy(ROOT / name, Path(folder) / name)
        command = [sys.executable, Path(folder) / "book" / "_ext" / "build.py", folder]
        started = time.perf_counter()
        outcome = subprocess.run(command, capture_output=True, text=True)
        seconds = time.perf_counter() - started
    if outcome.returncode:
        raise RuntimeError(f"the build failed:\n{outcome.stderr[-2000:]}")
    row = quantity("Time", "make book, cold", seconds, "s")
    return [row, memory_row("largest process of make book", "children")]


def redraw() -> list[dict]:
    """Rows of the widgets of the built pages: redraws, of which 95 % take less, and openings."""
    group = "Redraw of a widget after a move, 95th percentile"
    module = import_module("redraw")
    try:
        rows, openings = module.rows(), module.openings()
    except (FileNotFoundError, RuntimeError) as error:  # no browser, no built pages
        return [not_measured(group, "all widgets", str(error))]
    moves = [
        quantity(group, r["what"], r["p95, ms"], "ms", module.MOST)
        if "p95, ms" in r
        else not_measured(group, r["what"], r["not measured"])
        for r in rows
    ]
    group = "Opening a page until its widgets answer, median"
    return moves + [
        quantity(group, r["what"], r["median, s"], "s", module.USABLE) for r in openings
    ]


PARTS: dict[str, Callable[[], list[dict]]] = {
    **{f"training-{w}": lambda w=w: import_module("ensembles").measure(w) for w in WINDOWS},
    **{f"solver-{w}": lambda w=w: import_module("solvers").measure(w) for w in WINDOWS},
    "recordings": lambda: import_module("recordings").measure(),
    "book": book,
    "redraw": redraw,
}
"""What is measured, by name; each gives rows (see `measure`)."""


def run(part: str) -> list[dict] | None:
    """The rows of one part, measured in a process of its own; None if that failed."""
    with tempfile.TemporaryDirectory() as folder:
        answer = Path(folder) / "rows.json"
        command = [sys.executable, __file__, "--measure", part, "--into", str(answer)]
        failed = subprocess.run(command).returncode
        return None if failed else json.loads(answer.read_text())


def machine() -> dict:
    """What the times depend on."""
    model = platform.processor() or platform.machine()
    if Path("/proc/cpuinfo").is_file():
        lines = Path("/proc/cpuinfo").read_text().splitlines()
        model = next((x.split(":")[1].strip() for x in lines if x.startswith("model name")), model)
    load = os.getloadavg()[0] if hasattr(os, "getloadavg") else None
    return {"processor": model, "cores": os.cpu_count(), "load before": load}


def text(row: dict) -> str:
    """A row in one line."""
    what = f"{row['group']}: {row['what']}"
    if "not measured" in row:
        return f"{what}: not measured: {row['not measured']}"
    value, unit = (row["ratio"], "times") if "ratio" in row else (row["value"], row["unit"])
    bound = [f"{key} {significant(row[key])}" for key in ("at least", "at most") if key in row]
    verdict = {True: "met", False: "MISSED", None: ""}[met(row)]
    details = [
        f"{key} {significant(value) if isinstance(value, float) else value}"
        for key, value in row.get("details", {}).items()
    ]
    first = (
        f"{what:75s} {significant(value):>8s} {unit:5s} {' '.join(bound):14s} {verdict}".rstrip()
    )
    return "\n    ".join([first, *details])


def main() -> None:
    """Run all parts, print the table and write it; parts that are named are only printed."""
    parser = argparse.ArgumentParser(description=main.__doc__)
    parser.add_argument("parts", nargs="*", help=f"among {', '.join(PARTS)}; default: all")
    parser.add_argument("--measure", choices=PARTS, help=argparse.SUPPRESS)
    parser.add_argument("--into", type=Path, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.measure:
        options.into.write_text(json.dumps(PARTS[options.measure]()))
        return
    for name in options.parts:
        if name not in PARTS:
            parser.error(f"parts must be among {', '.join(PARTS)}, got {name!r}")
    rows, failed, here, started = [], [], machine(), time.monotonic()
    for name in options.parts or PARTS:
        measured = run(name)
        failed += [name] * (measured is None)
        for row in measured or ():
            rows.append(row)
            print(text(row), flush=True)
    if failed:
        sys.exit(f"failed: {', '.join(failed)}; nothing is written")
    if options.parts:
        return
    for group, what in committed().keys() - {(row["group"], row["what"]) for row in rows}:
        print(f"{group}: {what}: measured last time, and no more")
    now = datetime.datetime.now(datetime.UTC).strftime("%Y-%m-%d")
    made_by = {**results.stamp(seconds=time.monotonic() - started), "date": now, **here}
    results.write_json(results.FOLDER / "benchmarks.json", {"made by": made_by, "rows": rows})


if __name__ == "__main__":
    main()
