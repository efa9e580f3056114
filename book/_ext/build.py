"""Build the book, strictly: `python book/_ext/build.py [FOLDER]`.

Warnings are errors. Pages are always written from fresh doctrees, since Sphinx does not
repeat the warnings of pages it has read before; executed notebooks come from a cache.
The stamp is written last, so that only a clean build lets the next call say "nothing changed".
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

from ddlib.claims import SHARED
from jupyter_cache import get_cache
from jupyter_cache.executors import load_executor

from dd_book import PAGE_INPUTS, cache_path, digest

# ipykernel says this at every start, of a kernel on the same machine.
NOISE = "Kernel is running over TCP without encryption"

TIMEOUT = 600  # seconds for one cell, as in _config.yml


def build(root: Path) -> int:
    """Run Jupyter Book, pass on what it says, return its exit status."""
    command = [Path(sys.executable).with_name("jupyter-book"), "build", root]
    options = ["-W", "-n", "--keep-going"]
    with subprocess.Popen([*command, *options], stderr=subprocess.PIPE, text=True) as process:
        for line in process.stderr:
            if NOISE not in line:
                print(line, end="", file=sys.stderr, flush=True)
    return process.returncode


def execute_ahead(root: Path) -> None:
    """Execute on all cores the notebooks that the build would otherwise execute one by one.

    What fails here is not kept: the build meets it again and reports it.
    """
    os.environ.setdefault("OMP_NUM_THREADS", "1")  # one core for each notebook
    folder = cache_path(root, root / "_build")
    os.environ[SHARED] = str(folder / "measured")  # chapters and ledger share claims
    cache = get_cache(str(folder))
    for path in sorted((root / "book").glob("*.ipynb")):
        cache.add_nb_to_project(str(path))
    done = load_executor("local-parallel", cache).run_and_cache(timeout=TIMEOUT)
    print(f"==> Executed {len(done.succeeded)} notebooks", flush=True)


def main(root: Path) -> int:
    html = root / "_build" / "html"
    stamp = html / ".built-from"
    sources = digest(root, PAGE_INPUTS)
    if stamp.is_file() and stamp.read_text() == sources:
        print("==> Nothing changed since the last build")
    else:
        print("==> Executing the notebooks that changed and writing the pages", flush=True)
        started = time.monotonic()
        execute_ahead(root)
        for stale in (html, root / "_build" / ".doctrees"):
            shutil.rmtree(stale, ignore_errors=True)
        status = build(root)
        if status:
            print(
                "==> The build FAILED: its warnings and errors are above; tracebacks of "
                f"notebooks are also in {html / 'reports'}",
                file=sys.stderr,
            )
            return status
        stamp.write_text(sources)
        print(f"==> Built in {time.monotonic() - started:.0f} s")
    page = html / "index.html"
    print(f"==> Open {page.relative_to(root)}, that is {page.as_uri()}")
    return 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1] if len(sys.argv) > 1 else ".").resolve()))
