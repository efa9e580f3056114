"""Run notebooks, several at a time, each in a process of its own.

The processes are forked from one that has imported the large libraries, as for the build
(`book/_ext/ahead.py`); what the environment changes reaches them through it.
"""

from __future__ import annotations

import argparse
import os
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from tempfile import TemporaryFile

sys.path.append(str(Path(__file__).parents[2] / "book" / "_ext"))

import ahead
import nbformat
from nbclient import NotebookClient

TIMEOUT = 900  # seconds for a cell


def failure(path: Path) -> str:
    """What stops a notebook; empty if it runs to its end."""
    notebook = nbformat.read(path, as_version=4)
    place = {"metadata": {"path": str(path.parent)}}
    started = time.monotonic()
    try:
        NotebookClient(notebook, timeout=TIMEOUT, resources=place).execute()
    except Exception as error:  # of a cell, or the kernel is gone
        return str(error) or repr(error)
    print(f"{path.parent.name}/{path.name}: {time.monotonic() - started:.0f} s", flush=True)
    return ""


def run(paths: list[Path], jobs: int) -> dict[str, str]:
    """What stops which notebooks; the errors of kernels are shown if there is any."""
    kept = os.dup(2)
    with TemporaryFile("w+") as said:
        os.dup2(said.fileno(), 2)
        try:
            with ahead.forked_kernels(), ThreadPoolExecutor(jobs) as pool:
                told = pool.map(failure, paths)
                failed = {path.name: text for path, text in zip(paths, told) if text}
        finally:
            os.dup2(kept, 2)
            os.close(kept)
        said.seek(0)
        if failed:
            sys.stderr.write(said.read())
    return failed


def main(arguments=None) -> int:
    """Run all; 1 if any fails."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("notebooks", nargs="+", type=Path)
    parser.add_argument("--jobs", type=int, default=2, help="processes at a time")
    options = parser.parse_args(arguments)
    # the longest first, so that all processes end together
    paths = sorted(options.notebooks, key=lambda path: -path.stat().st_size)
    failed = run(paths, options.jobs)
    for name, text in failed.items():
        print(f"FAILED {name}\n{text}", flush=True)
    print(f"{len(failed)} failed, {len(paths) - len(failed)} passed", flush=True)
    return bool(failed)


if __name__ == "__main__":
    sys.exit(main())
