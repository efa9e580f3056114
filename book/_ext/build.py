"""Build the book: `python book/_ext/build.py [--strict] [--lesson NAME] [FOLDER]`.

A chapter that fails does not take the others with it: its page says in a box what failed, the
end of the build lists such pages, and the status is 1. With `--strict`, or with CI=true in the
environment, every warning is an error too. With `--lesson` one notebook is executed, and its page
alone is written, into a folder of its own. Ctrl-C ends all of it at once.

Executed notebooks come from a cache. Only pages whose sources changed are read and written again,
but all are where something changed that all depend on, with `--strict`, and after complaints: for
Sphinx does not repeat the warnings of pages that it has read before. The stamp is written last, so
that only a clean build lets the next call say "nothing changed".
"""

from __future__ import annotations

import argparse
import gc
import json
import os
import re
import shutil
import signal
import sys
import time
from collections.abc import Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import NoReturn

sys.path.insert(0, str(Path(__file__).parents[1]))  # for the workshop of the book

import nbformat
import psutil
from dd_book import FRAME_INPUTS, PAGE_INPUTS, cache_path, digest
from dd_cite import edition
from dd_failures import FAILURES, last_line, where
from dd_public import repository, site
from jupyter_book.sphinx import build_sphinx
from jupyter_cache import get_cache
from jupyter_cache.base import CacheBundleIn
from jupyter_cache.executors.utils import single_nb_execution
from lessons import contents, lesson
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


def known(cache, notebook) -> bool:
    """Whether a notebook's code has been executed."""
    with suppress(KeyError):
        cache.match_cache_notebook(notebook)
        return True
    return False


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
    notebooks = {path: nbformat.read(path, as_version=4) for path in paths}
    new = {path: notebook for path, notebook in notebooks.items() if not known(cache, notebook)}
    pool = ThreadPoolExecutor(os.cpu_count())
    running: dict[Future, Path] = {
        pool.submit(
            single_nb_execution,
            notebook,
            cwd=str(path.parent),
            timeout=TIMEOUT,
            allow_errors=False,
        ): path
        for path, notebook in new.items()
    }
    ended, kept, waiting = [], 0, set(running)
    started = reported = time.monotonic()
    try:
        while waiting:
            finished, waiting = wait(waiting, PAUSE, FIRST_COMPLETED)
            for future in finished:
                path = running[future]
                if error := future.exception():
                    ended.append(path)
                    print(f"{path}: {error}", file=sys.stderr)
                elif (result := future.result()).err:
                    print(f"{path}: {result.exc_string}", file=sys.stderr)
                else:
                    data = {"execution_seconds": result.time}
                    bundle = CacheBundleIn(result.nb, str(path), data=data)
                    cache.cache_notebook_bundle(bundle, check_validity=False, overwrite=True)
                    kept += 1
            now = time.monotonic()
            if not waiting or now - reported >= PAUSE:
                say(f"    {kept} of {len(new)} notebooks after {now - started:.0f} s")
                reported = now
    finally:
        pool.shutdown(wait=False, cancel_futures=True)
    return ended


def write_pages(root: Path, out: Path, strict: bool, only: str = "", **settings) -> int:
    """Let Jupyter Book write the pages on all cores, or only one of them.

    Returns 0 if it wrote them all, and found no fault that counts.
    """
    settings |= {
        "external_toc_path": (root / "_toc.yml").as_posix(),
        "latex_individualpages": False,
        "nitpicky": strict,
    }
    gc.disable()  # the pages are trees of many nodes: to search them would take a fifth of the time
    outcome = build_sphinx(
        *(root, out),
        **dict(path_config=root / "_config.yml", noconfig=True, confoverrides=settings),
        **dict(warningiserror=strict, keep_going=strict, jobs=os.cpu_count()),
        **dict(filenames=[str(root / f"{only}.ipynb")] if only else []),
    )
    if isinstance(outcome, KeyboardInterrupt):
        raise outcome
    return int(isinstance(outcome, Exception) or outcome)


def stop() -> NoReturn:
    """End all kernels and workers, in whatever they are, and then this process."""
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, signal.SIG_IGN)
    end = time.monotonic() + 0.5  # for a kernel that is about to start
    while (children := psutil.Process().children(recursive=True)) or time.monotonic() < end:
        for child in children:
            with suppress(psutil.NoSuchProcess):
                child.kill()
        psutil.wait_procs(children, timeout=0.1)
    print("==> Stopped; notebooks that were executed are kept", flush=True)
    os._exit(128 + signal.SIGINT)


def interrupt(*_) -> NoReturn:
    raise KeyboardInterrupt


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


def surroundings(root: Path, folder: Path) -> None:
    """What kernels find in their environment."""
    os.environ.setdefault("OMP_NUM_THREADS", "1")  # one core for each notebook
    paths = (str(root / "book"), os.environ.get("PYTHONPATH"))  # for pages in its folders, too
    os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, paths))
    # that of the pages, whatever the environment asks for: with Agg they would have no pictures
    os.environ["MPLBACKEND"] = "module://matplotlib_inline.backend_inline"
    os.environ.setdefault(SHARED, str(folder / "measured"))  # chapters and ledger share claims


def build(root: Path, strict: bool, frame: str, stamp: Path) -> tuple[bool, bool]:
    """Execute the notebooks that changed and write the pages; whether it failed, and was clean.

    `frame` is what all pages depend on; pages of another frame are made anew.
    """
    folder, html = cache_path(root), root / "_build" / "html"
    surroundings(root, folder)
    frame_of_pages = root / "_build" / ".doctrees" / "frame"
    if strict or not frame_of_pages.is_file() or frame_of_pages.read_text() != frame:
        for old in (html, frame_of_pages.parent):
            shutil.rmtree(old, ignore_errors=True)
    paths = [root / f"{page}.ipynb" for page in contents(root)]  # the ledger after the chapters
    log(root).write_text("")
    with errors_into(log(root)):
        dead = execute(get_cache(str(folder)), [path for path in paths if path.is_file()], progress)
    for old in (root / "_build" / FAILURES, frame_of_pages, stamp):  # until the pages are written
        old.unlink(missing_ok=True)
    before = log(root).stat().st_size
    with errors_into(log(root)):
        ended = [path.relative_to(root).with_suffix("").as_posix() for path in dead]
        cached = {"nb_execution_cache_path": str(folder), "kernel_ended": ended}
        status = write_pages(root, html, strict, **cached)
    text = strip_colors(log(root).read_bytes()[before:].decode()).splitlines(keepends=True)
    found = messages([line for line in text if NOISE not in line])
    report(root, found, strict)
    if status and not found:
        say("==> FAILED: not all pages could be written")
    failed = bool(status or failures(root) or (strict and found))
    if clean := not (failed or found):
        frame_of_pages.write_text(frame)
    else:
        say(f"==> All messages are in {log(root)}, tracebacks of notebooks in {html}/reports")
        say("    Please report what is not yours, with that file, where this book came from.")
    return failed, clean


def main(root: Path, strict: bool) -> int:
    html = root / "_build" / "html"
    stamp = html / ".built-from"
    public = repository(root)  # buttons, cards, map of the site and footers hang on it
    about = " ".join(filter(None, (public and site(public), public, edition(root))))
    sources = f"{digest(root, PAGE_INPUTS)} {about}"
    by_strict, failed = f"{sources} strict", False
    wanted = {by_strict} if strict else {by_strict, sources}
    if stamp.is_file() and stamp.read_text() in wanted:
        print("==> Nothing changed since the last build")
    else:
        print("==> Executing the notebooks that changed and writing the pages", flush=True)
        started = time.monotonic()
        failed, clean = build(root, strict, f"{digest(root, FRAME_INPUTS)} {about}", stamp)
        if clean:
            stamp.write_text(by_strict if strict else sources)
        print(f"==> {time.monotonic() - started:.0f} s")
    page = html / "index.html"
    if page.is_file():
        print(f"==> Open {page.relative_to(root)}, that is {page.as_uri()}")
    return int(failed)


def alone(root: Path, name: str) -> int:
    """Execute one notebook and write its page, into a folder of its own; others are only read."""
    of = lesson(root, f"book/{name}")
    if of is None or of.page not in contents(root):
        say(f"==> FAILED: _toc.yml names no notebook book/{name}.ipynb")
        return 1
    folder, out = cache_path(root), root / "_build" / "page" / "html"
    surroundings(root, folder)
    cache = get_cache(str(folder))
    print(f"==> Executing {name}, if it changed, and writing its page", flush=True)
    log(root).write_text("")
    with errors_into(log(root)):
        execute(cache, [of.path], progress)
    if not known(cache, of.notebook):
        say(f"==> FAILED: {last_line(strip_colors(log(root).read_text()))}")
        return 1
    (out.parent / ".doctrees" / f"{of.page}.doctree").unlink(missing_ok=True)
    with errors_into(log(root)):
        settings = {"only_page": of.page, "only_cache": str(folder), "nb_execution_mode": "off"}
        status = write_pages(root, out, False, of.page, **settings)
    page = out / f"{of.page}.html"
    print(f"==> Open {page.relative_to(root)}, that is {page.as_uri()}")
    return status


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--strict", action="store_true", help="warnings are errors")
    parser.add_argument("--lesson", default="", help="the one page to build, like feedback")
    parser.add_argument("folder", nargs="?", default=".", type=Path)
    arguments = parser.parse_args()
    in_ci = os.environ.get("CI", "").lower() in {"1", "true"}
    folder = arguments.folder.resolve()
    signal.signal(signal.SIGTERM, interrupt)
    try:
        if arguments.lesson:
            sys.exit(alone(folder, arguments.lesson))
        sys.exit(main(folder, arguments.strict or in_ci))
    except KeyboardInterrupt:
        stop()
