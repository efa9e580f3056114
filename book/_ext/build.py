"""Build the book: `python book/_ext/build.py [--strict] [FOLDER]`.

A chapter that fails does not take the others with it: its page says in a box what failed, the
end of the build lists such pages, and the status is 1. With `--strict`, or with CI=true in the
environment, every warning is an error too.

Pages are always written from fresh doctrees, since Sphinx does not repeat the warnings of pages
it has read before; executed notebooks come from a cache. The stamp is written last, so that only
a clean build lets the next call say "nothing changed".
"""

from __future__ import annotations

import argparse
import gc
import json
import logging
import os
import re
import shutil
import sys
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor, wait
from contextlib import contextmanager
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))  # for the workshop of the book

import yaml
from dd_book import PAGE_INPUTS, cache_path, digest
from dd_cite import edition
from dd_failures import FAILURES, last_line, where
from dd_public import repository, site
from jupyter_book.sphinx import build_sphinx
from jupyter_cache import get_cache
from jupyter_cache.executors import load_executor
from sphinx.util.console import strip_colors

from workshop.report.evidence.claims import SHARED

TIMEOUT = 600  # seconds for one cell, as in _config.yml
PAUSE = 10  # seconds between two lines of progress

# ipykernel says this at every start, of a kernel on the same machine.
NOISE = "Kernel is running over TCP without encryption"
# How a message of Sphinx begins: where, then what.
MESSAGE = re.compile(r"(?P<where>.*?)(?::\d+)?:? ?(?:WARNING|ERROR|CRITICAL|SEVERE): ")
TRACEBACK = "Traceback (most recent call last):"
NOTEBOOK_FAILED = "Executing notebook failed"
CRASHES = ("Exception occurred:", "Extension error", "Sphinx error:", "Theme error:")


def execute(cache, paths: list[Path], say=print) -> list[Path]:
    """Execute on all cores the notebooks that the cache does not know, and keep them there.

    What fails in a cell is not kept: the build meets it again, shows what came before and reports
    it.

    Parameters
    ----------
    cache : jupyter_cache.base.JupyterCacheAbstract
    paths : list of Path
        Of notebooks.
    say : callable
        Called with a line of progress every `PAUSE` seconds or so, and at the end.

    Returns
    -------
    list of Path
        Notebooks whose kernel ended.
    """
    for path in paths:
        cache.add_nb_to_project(str(path))
    names = list(map(str, paths))
    wanted = len(cache.list_unexecuted(filter_uris=names))

    # Counted by files: the executor forks, and a process that is forked while this one asks the
    # cache's database waits for ever for a lock that nobody in it holds.
    def kept() -> int:
        return sum(1 for _ in Path(cache.path).glob("executed/*/base.ipynb"))

    before, started = kept(), time.monotonic()
    logger = logging.getLogger("notebooks")
    logger.setLevel(logging.WARNING)
    run = load_executor("local-parallel", cache, logger).run_and_cache
    with ThreadPoolExecutor(1) as beside:
        task = beside.submit(run, filter_uris=names, timeout=TIMEOUT)
        left = {task}
        while left:
            _, left = wait(left, PAUSE)
            count = kept() - before
            say(f"    {count} of {wanted} notebooks after {time.monotonic() - started:.0f} s")
    errored = task.result().errored  # also where two notebooks of the same code met in the cache
    left = cache.list_unexecuted(filter_uris=errored) if errored else []
    return [Path(record.uri) for record in left]


def write_pages(root: Path, strict: bool, ended: list[str]) -> int:
    """Let Jupyter Book write the pages on all cores, of which some are not to be executed again.

    Returns 0 if it wrote them all, and found no fault that counts.
    """
    told = {
        "external_toc_path": (root / "_toc.yml").as_posix(),
        "latex_individualpages": False,
        "nitpicky": strict,
        "kernel_ended": ended,
    }
    gc.disable()  # the pages are trees of many nodes: to search them would take a fifth of the time
    outcome = build_sphinx(
        *(root, root / "_build" / "html"),
        **dict(path_config=root / "_config.yml", noconfig=True, confoverrides=told),
        **dict(warningiserror=strict, keep_going=strict, jobs=os.cpu_count()),
    )
    return int(isinstance(outcome, Exception) or outcome)


def log(root: Path) -> Path:
    """Everything that Jupyter Book and Sphinx complained about, tracebacks included."""
    return root / "_build" / "build.log"


def messages(lines: list[str]) -> list[str]:
    """Complaints of Sphinx, each with the lines that belong to it.

    A traceback belongs to a message where a notebook failed. Others are the machinery's own and
    are left out: they never are the message.
    """
    found = [""]
    for line in lines:
        own = line.startswith(TRACEBACK) and NOTEBOOK_FAILED not in found[-1]
        if own or MESSAGE.match(line) or line.startswith(CRASHES):
            found.append("")
        found[-1] += line
    return [text for text in found if text.strip() and not text.startswith(TRACEBACK)]


def taught(root: Path) -> set[str]:
    """Pages of the lectures, if the book has some."""
    path = root / "book" / "lectures.yml"
    told = yaml.safe_load(path.read_text(encoding="utf-8")) if path.is_file() else {}
    return {page for lecture in told.values() for page in lecture["pages"]}


def listed(contents) -> Iterator[str]:
    """The pages of a table of contents, in their order."""
    if isinstance(contents, dict):
        yield from (contents[key] for key in ("root", "file") if key in contents)
    for inner in contents.values() if isinstance(contents, dict) else contents:
        if isinstance(inner, (dict, list)):
            yield from listed(inner)


@contextmanager
def errors_into(path: Path) -> Iterator[None]:
    """What this process and its kernels write to standard error is added to a file."""
    kept = os.dup(2)
    with path.open("a", encoding="utf-8") as file:
        os.dup2(file.fileno(), 2)
        try:
            yield
        finally:
            os.dup2(kept, 2)
            os.close(kept)


def progress(text: str) -> None:
    """On standard output, also where that is no terminal, at once."""
    print(text, flush=True)


def say(text: str) -> None:
    print(text, file=sys.stderr, flush=True)


def failures(root: Path) -> list[dict]:
    """The pages whose notebooks failed, as the extension has listed them."""
    path = root / "_build" / FAILURES
    return json.loads(path.read_text(encoding="utf-8")) if path.is_file() else []


def report(root: Path, found: list[str], strict: bool) -> None:
    """Pass on the messages and say which pages are concerned.

    To a reader, messages about incomplete pages say nothing that is not in the box on the page.
    """
    incomplete = failures(root)
    concerned = set()
    crashes = [text for text in found if text.startswith(CRASHES)]
    for text in found:
        if text in crashes:
            continue
        place = (MESSAGE.match(text) or {"where": ""})["where"] or ""
        known = any(f"{failure['page']}.ipynb" in place for failure in incomplete)
        if strict or not known:
            say(text.rstrip())
        if not known and place:
            concerned.add(Path(place).stem)
    if concerned:
        say(f"==> The warnings above are about: {', '.join(sorted(concerned))}")
    if incomplete:
        say("==> FAILED in part. These pages are incomplete; a box on each says how to report it:")
    for failure in incomplete:
        say(f"    {failure['page']}: {where(failure)}: {failure['error']}")
    for text in crashes:
        say(f"==> FAILED: not all pages could be written: {last_line(text)}")
    if strict and found:
        say("==> FAILED: under --strict or CI=true a warning is an error")


def main(root: Path, strict: bool) -> int:
    html = root / "_build" / "html"
    stamp = html / ".built-from"
    public = repository(root)  # buttons, cards, map of the site and footers hang on it
    about = (digest(root, PAGE_INPUTS), public and site(public), public, edition(root))
    sources = " ".join(filter(None, about))
    failed = False
    if stamp.is_file() and stamp.read_text() == sources:
        print("==> Nothing changed since the last build")
    else:
        print("==> Executing the notebooks that changed and writing the pages", flush=True)
        started = time.monotonic()
        folder = cache_path(root, root / "_build")
        folder.mkdir(parents=True, exist_ok=True)
        os.environ.setdefault("OMP_NUM_THREADS", "1")  # one core for each notebook
        paths = (str(root / "book"), os.environ.get("PYTHONPATH"))  # for pages in its folders, too
        os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, paths))
        # that of the pages, whatever the environment asks for: with Agg they would have no pictures
        os.environ["MPLBACKEND"] = "module://matplotlib_inline.backend_inline"
        os.environ["DDLIB_PNG"] = " ".join(taught(root))  # figures as PNG, for dd_figures
        os.environ.setdefault(SHARED, str(folder / "measured"))  # chapters and ledger share claims
        toc = yaml.safe_load((root / "_toc.yml").read_text(encoding="utf-8"))
        paths = [root / f"{page}.ipynb" for page in listed(toc)]  # the ledger after the chapters
        log(root).write_text("")
        with errors_into(log(root)):
            paths = [path for path in paths if path.is_file()]
            dead = execute(get_cache(str(folder)), paths, progress)
        for stale in (html, root / "_build" / ".doctrees"):
            shutil.rmtree(stale, ignore_errors=True)
        (root / "_build" / FAILURES).unlink(missing_ok=True)
        before = log(root).stat().st_size
        with errors_into(log(root)):
            ended = [path.relative_to(root).with_suffix("").as_posix() for path in dead]
            status = write_pages(root, strict, ended)
        told = strip_colors(log(root).read_bytes()[before:].decode()).splitlines(keepends=True)
        found = messages([line for line in told if NOISE not in line])
        report(root, found, strict)
        failed = bool(status or failures(root) or (strict and found))
        if status and not found:
            say("==> FAILED: not all pages could be written")
        if failed or found:
            say(f"==> All messages are in {log(root)}, tracebacks of notebooks in {html}/reports")
            say("    Please report what is not yours, with that file, where this book came from.")
        else:
            stamp.write_text(sources)
        print(f"==> {time.monotonic() - started:.0f} s")
    page = html / "index.html"
    if page.is_file():
        print(f"==> Open {page.relative_to(root)}, that is {page.as_uri()}")
    return int(failed)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--strict", action="store_true", help="warnings are errors")
    parser.add_argument("folder", nargs="?", default=".", type=Path)
    arguments = parser.parse_args()
    in_ci = os.environ.get("CI", "").lower() in {"1", "true"}
    sys.exit(main(arguments.folder.resolve(), arguments.strict or in_ci))
