"""Notebooks and measured claims as another machine would see them: ``make foreign``.

Rounding differs between processors, libraries and numbers of threads, and thousands of epochs
make another network of it. Under each of `SETTINGS` all cells of notebooks must run, and the
solutions of all exercises must be judged right. No verdict of ``book/claims.yml`` may be
contradicted, and of the committed results every claim must measure what is kept of it.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).parents[2]
JOGS = str(Path(__file__).parent / "foreign")
"""Folder whose ``sitecustomize`` jogs random draws."""


def _threads(count: int) -> dict[str, str]:
    names = ("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS")
    return dict.fromkeys(names, str(count))


SETTINGS = {
    "jog-1": {"DDLIB_JOG": "1"},
    "jog-7": {"DDLIB_JOG": "7"},
    "plain-kernels": {"ATEN_CPU_CAPABILITY": "default", "ONEDNN_MAX_CPU_ISA": "SSE41"},
    "other-libraries": {
        "MKL_CBWR": "COMPATIBLE", "OPENBLAS_CORETYPE": "Nehalem", "ONEDNN_MAX_CPU_ISA": "AVX2"
    },
    "one-thread": _threads(1),
    "two-threads": _threads(2),
}  # fmt: skip
"""Environment variables of each foreign machine; ``jog-1+other-libraries`` has those of both."""

CI = "jog-1+other-libraries"
"""The one that every run of the test suite tries."""


def environment(name: str, folder: Path) -> dict[str, str]:
    """Environment of a setting; notebooks and claims share in `folder` what they measure."""
    path = os.pathsep.join(
        filter(None, [JOGS, str(ROOT / "book"), os.environ.get("PYTHONPATH", "")])
    )
    own = {"PYTHONPATH": path, "PYTHONWARNINGS": "error:::__main__", "DDLIB_MEASURED": str(folder)}
    differs = {key: value for part in name.split("+") for key, value in SETTINGS[part].items()}
    return {**os.environ, "OMP_NUM_THREADS": "1", **own, **differs}


def command(jobs: int, ci: bool) -> list:
    """What checks all of it; in CI, of lessons the open cells and exercises alone."""
    files = "report/test_claims.py", "report/test_judging.py", "book/test_walk.py"
    cells = "open_cells_run or (all_cells_run and evidence)" if ci else "cells_run"
    which = ["-k", f"verdicts_are or measured_now or {cells}"]
    return ["pytest", "-n", jobs, "--dist", "worksteal", "--durations=10", *which,
            *(f"tests/{file}" for file in files)]  # fmt: skip


def holds(name: str, jobs: int, ci: bool) -> bool:
    """Whether all holds under one setting."""
    print(f"==> {name}", flush=True)
    with tempfile.TemporaryDirectory() as folder:
        env, arguments = environment(name, Path(folder)), map(str, command(jobs, ci))
        return not subprocess.run([sys.executable, "-m", *arguments], env=env, cwd=ROOT).returncode


def main(arguments=None) -> int:
    """Run settings one after the other; 1 if anything fails."""
    parser = argparse.ArgumentParser(description=main.__doc__)
    known = f"among {', '.join(SETTINGS)}, or several joined by +"
    parser.add_argument("settings", nargs="*", help=f"{known}; default: all, one after the other")
    parser.add_argument("--ci", action="store_true", help=f"only {CI}")
    parser.add_argument("--jobs", type=int, default=2, help="processes at a time")
    options = parser.parse_args(arguments)
    for name in options.settings:
        if not set(name.split("+")) <= set(SETTINGS):
            parser.error(f"settings must be {known}, got {name!r}")
    names = options.settings or ((CI,) if options.ci else tuple(SETTINGS))
    failed = [name for name in names if not holds(name, options.jobs, options.ci)]
    count = f"{len(names)} foreign machine{'s' * (len(names) > 1)}"
    print(f"==> {count}: " + ("; ".join(failed) or "all hold"), flush=True)
    return bool(failed)


if __name__ == "__main__":
    sys.exit(main())
