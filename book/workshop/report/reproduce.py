"""Measure anew what is too slow for a chapter: ``make reproduce``.

A study (`workshop.report.studies`) whose result is there already, made by the same code, is
skipped; so an interrupted run resumes. Several studies run side by side, each on one core.
"""

# ruff: noqa: E402

from __future__ import annotations

import multiprocessing
import os
import sys

from workshop.report.code_hash import code_hash, places, run

# Whether studies are forked from a process that has imported everything
FORKED = sys.platform == "linux"

PROCESSES = multiprocessing.get_context("forkserver" if FORKED else "spawn")
if FORKED:
    modules = sorted({module for module, _ in places().values()})
    PROCESSES.set_forkserver_preload([*modules, "ddlib.figures.style"])
if FORKED and __name__ == "__main__":  # it imports while this process does
    from multiprocessing.forkserver import ensure_running

    before = dict(os.environ)
    os.environ["OMP_NUM_THREADS"] = "1"
    ensure_running()
    os.environ.clear()
    os.environ.update(before)

import argparse
import contextlib
import gc
import io
import time
import traceback
from concurrent.futures import ThreadPoolExecutor, as_completed

from tqdm.auto import tqdm

from ddlib import figures
from ddlib.analysis import purest, upright
from ddlib.simulation import LOG_STEP
from workshop.report import results


def picture() -> None:
    """The README's picture: two filters found in the networks of window 21."""
    networks = results.networks(21).weights
    found = {
        f"{name} filter": upright(purest(networks.hidden_weights, name))
        for name in ("velocity", "acceleration")
    }
    target = results.FOLDER.parent / "_static" / "readme.svg"
    figures.decomposition(found, LOG_STEP).save(target)


def make(name: str, code: str) -> None:
    """Run one study and write its result with the hash `code` of what made it."""
    started = time.process_time()
    content = run(name)
    made_by = {"code": code, **results.stamp(time.process_time() - started)}
    results.write_json(results.FOLDER / f"{name}.json", {"made by": made_by, **content})


def make_apart(name: str, code: str, do=make) -> str:
    """`make` in a process of its own with one thread; what went wrong, or nothing.

    On Linux it is forked from a process that has imported everything, which saves four seconds.
    """
    told, tell = PROCESSES.Pipe(duplex=False)
    process = PROCESSES.Process(target=_quietly, args=(tell, do, name, code))
    process.start()
    tell.close()
    try:
        said = told.recv()
    except EOFError:
        said = "the process ended"
    process.join()
    return said


def _quietly(tell, do, *arguments) -> None:
    """Call a function, say nothing meanwhile, and send what went wrong, or nothing."""
    gc.freeze()  # what was imported is no garbage: nobody looks through it again
    said = io.StringIO()
    with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
        try:
            do(*arguments)
        except Exception:
            tell.send(traceback.format_exc())
            return
    tell.send("")


def side_by_side(codes: dict[str, str], jobs: int) -> None:
    """Make results in as many processes as cores: no thread waits for another.

    The longest come first. What is finished is kept when another one fails.
    """
    os.environ["OMP_NUM_THREADS"] = "1"
    last = {name: _seconds(name) for name in codes}
    failed = {}
    bar = tqdm(total=round(sum(last.values())), desc="all results", unit="s of work")
    with bar, ThreadPoolExecutor(jobs) as pool:
        order = sorted(codes, key=last.get, reverse=True)
        tasks = {pool.submit(make_apart, name, codes[name]): name for name in order}
        for task in as_completed(tasks):
            name, said = tasks[task], task.result()
            bar.update(round(last[name]))
            if said:
                failed[name] = said[-2000:]
                tqdm.write(f"==> {name}: FAILED")
            else:
                tqdm.write(f"==> {name}: {_seconds(name):.0f} s")
    if failed:
        said = "\n".join(f"{name}: {text}" for name, text in failed.items())
        raise RuntimeError(f"failed: {', '.join(failed)}; the others are written\n{said}")


def _seconds(name: str) -> float:
    """Processor time that a result took the last time, s; a minute if it is not there."""
    path = results.FOLDER / f"{name}.json"
    return results.read(name)["made by"]["seconds"] if path.is_file() else 60.0


def main(arguments=None) -> None:
    """Run the parts that are missing or stale; ``--force`` runs them all."""
    known = list(places())
    parser = argparse.ArgumentParser(description=main.__doc__)
    parser.add_argument("parts", nargs="*", help=f"among {', '.join(known)}; default: all")
    parser.add_argument("--force", action="store_true", help="also what is up to date")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, help="parts at a time")
    options = parser.parse_args(arguments)
    for name in options.parts:
        if name not in known:
            parser.error(f"parts must be among {', '.join(known)}, got {name!r}")
    if options.jobs < 1:
        parser.error(f"jobs must be 1 or more, got {options.jobs}")
    results.FOLDER.mkdir(parents=True, exist_ok=True)
    names = options.parts or known
    codes = {name: code_hash(name) for name in names}  # now: files may change meanwhile
    stale = []
    for name in names:
        path = results.FOLDER / f"{name}.json"
        fresh = path.is_file() and results.read(name)["made by"]["code"] == codes[name]
        if fresh and not options.force:
            print(f"==> {name}: up to date", flush=True)
        else:
            stale.append(name)
    started = time.monotonic()
    if len(stale) > 1 and options.jobs > 1:
        side_by_side({name: codes[name] for name in stale}, options.jobs)
    else:
        for name in stale:
            print(f"==> {name}", flush=True)
            make(name, codes[name])
            print(f"==> {name}: {_seconds(name):.0f} s", flush=True)
    if len(stale) == len(known):
        made_by = {**results.stamp(time.monotonic() - started), "jobs": options.jobs}
        made_by["parts"] = len(known)
        results.write_json(results.FOLDER / "reproduce.json", {"made by": made_by})
    if "table-4-1" in stale:  # the picture shows two of its networks
        picture()


if __name__ == "__main__":
    main()
