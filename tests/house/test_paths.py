"""Where a clone lies never matters: folders with spaces, umlauts, brackets, or named like ours."""

import os
import shutil
import subprocess

import pytest
from book_pages import ROOT

FOLDERS = ("book", "Übung (1) _build [1]")
RECORD = """#!/bin/sh
printf '%s\\t%s\\t%s\\t%s\\n' "$(pwd -P)" "$PYTHONPATH" "$DDLIB_MEASURED" "$*" >> "$RECORD"
"""
"""Stands for what is in .venv/bin: writes down where it runs, and what it is told."""


@pytest.fixture(params=FOLDERS)
def clone(request, tmp_path):
    """A folder with the Makefile, and an environment that writes down what is asked of it."""
    folder = tmp_path / request.param
    commands = folder / ".venv" / "bin"
    commands.mkdir(parents=True)
    for name in ("Makefile", "pyproject.toml", "requirements.txt", "requirements-test.txt"):
        shutil.copy(ROOT / name, folder)
    for name in ("python", "ruff", "zizmor", "check-jsonschema"):
        (commands / name).write_text(RECORD)
        (commands / name).chmod(0o755)
    for done in (".ready", ".tested"):
        (folder / ".venv" / done).touch()
    return folder


@pytest.mark.skipif(os.name == "nt" or not shutil.which("make"), reason="has no make")
def test_targets_run_in_their_folder_and_find_the_workshop(clone, tmp_path):
    record = tmp_path / "record"
    env = {"PATH": os.environ["PATH"], "RECORD": str(record)}

    def calls(*words) -> list[tuple[str, str, str]]:
        """Paths to import from, folder of measurements and arguments of each command in turn."""
        record.write_text("")
        done = subprocess.run(["make", *words], cwd=clone, env=env, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        records = [line.split("\t") for line in record.read_text("utf-8").splitlines()]
        assert {place for place, *_ in records} == {str(clone.resolve())}
        return [tuple(rest) for _, *rest in records]

    book, measured = str(clone.resolve() / "book"), str(clone.resolve() / "_build" / "measured")
    *_, (path, _, lab) = calls("lab")
    assert path == book and "--ServerApp.root_dir=_build/lab" in lab
    *_, (path, _, lab) = calls("lab", "SOURCES=1")
    assert path == book and "root_dir" not in lab
    modules = "report.reproduce", "chapters.widgets.hero"
    assert calls("reproduce") == [(book, "", f"-m workshop.{module}") for module in modules]
    assert {folder for _, folder, _ in calls("test")} == {measured}
    assert len(calls("check")) > 4
