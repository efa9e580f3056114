"""Measure anew what is too slow for a chapter: ``make reproduce``.

A study (`workshop.report.studies`) whose result is there already, made by the same code, is
skipped; so an interrupted run resumes. Several studies run side by side, each on one core.
"""

from __future__ import annotations

import argparse
import contextlib
import io
import multiprocessing
import os
import sys
import time
import traceback
from concurrent.futures import ProcessPoolExecutor, as_completed

from tqdm.auto import tqdm

from workshop.report import results
from workshop.report.code_hash import code_hash, places, run_study


def _make(name: str, code: str) -> None:
    """Run one study and write its result with the hash `code` of what made it."""
    started = time.process_time()
    content = run_study(name)
    made_by = {"code": code, **results.stamp(time.process_time() - started)}
    results.write_json(results.FOLDER / f"{name}.json", {"made by": made_by, **content})


def _quietly(name: str, code: str) -> None:
    """`_make` in a process of its own: the bars of several would disturb each other."""
    output = io.StringIO()
    with contextlib.redirect_stdout(output), contextlib.redirect_stderr(output):
        _make(name, code)


def _side_by_side(codes: dict[str, str], jobs: int) -> None:
    """Make results in as many processes as cores: no thread waits for another.

    The longest come first. What is finished is kept when another one fails.
    """
    os.environ["OMP_NUM_THREADS"] = "1"
    last = {name: _made_by(name)["seconds"] for name in codes}
    failed = {}
    bar = tqdm(total=round(sum(last.values())), desc="all results", unit="s of work")
    context = multiprocessing.get_context("forkserver" if sys.platform == "linux" else "spawn")
    # All is imported now: a file that changes meanwhile does not go into a later study
    context.set_forkserver_preload(sorted({module for module, _ in places().values()}))
    with bar, ProcessPoolExecutor(jobs, context, max_tasks_per_child=1) as pool:
        order = sorted(codes, key=last.get, reverse=True)
        tasks = {pool.submit(_quietly, name, codes[name]): name for name in order}
        for task in as_completed(tasks):
            name, error = tasks[task], task.exception()
            bar.update(round(last[name]))
            if error:
                failed[name] = "".join(traceback.format_exception(error))[-2000:]
                tqdm.write(f"==> {name}: FAILED")
            else:
                tqdm.write(f"==> {name}: {_made_by(name)['seconds']:.0f} s")
    if failed:
        reasons = "\n".join(f"{name}: {text}" for name, text in failed.items())
        raise RuntimeError(f"failed: {', '.join(failed)}; the others are written\n{reasons}")


def _made_by(name: str) -> dict:
    """The code that made a result, and the processor time it took, s; a minute if it is missing."""
    is_there = (results.FOLDER / f"{name}.json").is_file()
    return results.read(name)["made by"] if is_there else {"code": "", "seconds": 60.0}


def main(arguments=None) -> None:
    """Run the parts that are missing or stale; ``--force`` runs them all."""
    known = list(places())
    parser = argparse.ArgumentParser(description=main.__doc__)
    parser.add_argument("parts", nargs="*", help=f"among {', '.join(known)}; default: all")
    parser.add_argument("--force", action="store_true", help="also what is up to date")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, help="parts at a time")
    options = parser.parse_args(arguments)
    if unknown := sorted(set(options.parts) - set(known)):
        parser.error(f"parts must be among {', '.join(known)}, got {unknown}")
    if options.jobs < 1:
        parser.error(f"jobs must be 1 or more, got {options.jobs}")
    results.FOLDER.mkdir(parents=True, exist_ok=True)
    names = options.parts or known
    codes = {name: code_hash(name) for name in names}  # now: files may change meanwhile
    stale = [name for name in names if options.force or _made_by(name)["code"] != codes[name]]
    for name in names:
        if name not in stale:
            print(f"==> {name}: up to date", flush=True)
    started = time.monotonic()
    if len(stale) > 1 and options.jobs > 1:
        _side_by_side({name: codes[name] for name in stale}, options.jobs)
    else:
        for name in stale:
            print(f"==> {name}", flush=True)
            _make(name, codes[name])
            print(f"==> {name}: {_made_by(name)['seconds']:.0f} s", flush=True)
    if len(stale) == len(known):
        made_by = {**results.stamp(time.monotonic() - started), "jobs": options.jobs}
        made_by["parts"] = len(known)
        results.write_json(results.FOLDER / "reproduce.json", {"made by": made_by})


if __name__ == "__main__":
    main()
