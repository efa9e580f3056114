"""Run notebooks, several at a time, each in a process of its own.

The processes are forked from one that has imported the large libraries, as for the build
(`book/_ext/ahead.py`); what the environment changes reaches them through it.
"""

from __future__ import annotations

import argparse
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

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
    print(f"{path.name}: {time.monotonic() - started:.0f} s", flush=True)
    return ""


def main(arguments=None) -> int:
    """Run all; 1 if any fails."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("notebooks", nargs="+", type=Path)
    parser.add_argument("--jobs", type=int, default=2, help="processes at a time")
    options = parser.parse_args(arguments)
    # the longest first, so that all processes end together
    paths = sorted(options.notebooks, key=lambda path: -path.stat().st_size)
    with ahead.forked_kernels(), ThreadPoolExecutor(options.jobs) as pool:
        failed = {path.name: text for path, text in zip(paths, pool.map(failure, paths)) if text}
    for name, text in failed.items():
        print(f"FAILED {name}\n{text}", flush=True)
    print(f"{len(failed)} failed, {len(paths) - len(failed)} passed", flush=True)
    return bool(failed)


if __name__ == "__main__":
    sys.exit(main())
