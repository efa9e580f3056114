"""The build itself: what it depends on, what it runs again, and that it fails when it should."""

from __future__ import annotations

import shutil
import subprocess
import sys

import nbformat
import pytest
from book_pages import ROOT

sys.path.insert(0, str(ROOT / "book" / "_ext"))
from dd_book import CELL_INPUTS, PAGE_INPUTS, digest

COUNTING = "from pathlib import Path\n\nwith Path('runs').open('a') as file:\n    file.write('x')"


@pytest.fixture
def tiny(tmp_path):
    """A one-notebook book with this book's settings, extension and static files."""
    shutil.copy(ROOT / "_config.yml", tmp_path)
    for name in ("_ext", "_static"):
        shutil.copytree(ROOT / "book" / name, tmp_path / "book" / name)
    (tmp_path / "_toc.yml").write_text("format: jb-book\nroot: book/index\n")
    (tmp_path / "book" / "references.bib").touch()
    (tmp_path / "book" / "results").mkdir()
    (tmp_path / "book" / "results" / "numbers.json").write_text("[1]")
    (tmp_path / "ddlib").mkdir()
    (tmp_path / "ddlib" / "arm.py").write_text("G = 9.81\n")
    (tmp_path / "requirements.txt").write_text("numpy\n")
    write_page(tmp_path, "# Title")
    return tmp_path


def write_page(root, text, code=COUNTING):
    notebook = nbformat.v4.new_notebook(
        cells=[nbformat.v4.new_markdown_cell(text), nbformat.v4.new_code_cell(code)],
        metadata={"kernelspec": {"name": "python3", "display_name": "Python 3"}},
    )
    nbformat.write(notebook, root / "book" / "index.ipynb")


def build(root):
    command = [sys.executable, str(ROOT / "book" / "_ext" / "build.py"), str(root)]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def runs(root) -> int:
    return len((root / "book" / "runs").read_text())


@pytest.mark.parametrize(
    ("inputs", "path", "changes"),
    [
        (CELL_INPUTS, "ddlib/arm.py", True),
        (CELL_INPUTS, "ddlib/new.py", True),
        (CELL_INPUTS, "ddlib/__pycache__/arm.pyc", False),
        (CELL_INPUTS, "book/results/numbers.json", True),
        (CELL_INPUTS, "book/claims.yml", True),
        (CELL_INPUTS, "requirements.txt", True),
        (CELL_INPUTS, "book/index.ipynb", False),
        (PAGE_INPUTS, "book/index.ipynb", True),
        (PAGE_INPUTS, "book/_static/book.css", True),
        (PAGE_INPUTS, "_config.yml", True),
        (PAGE_INPUTS, "book/.ipynb_checkpoints/index.ipynb", False),
    ],
)
def test_digest_sees_what_matters(tiny, inputs, path, changes):
    before = digest(tiny, inputs)
    target = tiny / path
    target.parent.mkdir(exist_ok=True)
    target.write_text(target.read_text() + "\n# more" if target.exists() else "more")
    assert (digest(tiny, inputs) != before) is changes


def test_digest_sees_a_renamed_file(tiny):
    before = digest(tiny, CELL_INPUTS)
    (tiny / "ddlib" / "arm.py").rename(tiny / "ddlib" / "leg.py")
    assert digest(tiny, CELL_INPUTS) != before


@pytest.mark.slow
def test_notebooks_run_again_only_when_needed(tiny):
    first = build(tiny)
    assert first.returncode == 0, first.stdout + first.stderr
    assert "index.html" in first.stdout.splitlines()[-1]
    (tiny / "book" / "runs").rename(tiny / "runs")  # what the cell wrote is no source

    again = build(tiny)
    assert again.returncode == 0
    assert "Nothing changed" in again.stdout
    assert not (tiny / "book" / "runs").exists()

    (tiny / "book" / "_static" / "book.css").write_text("/* other style */")
    assert build(tiny).returncode == 0
    assert not (tiny / "book" / "runs").exists()

    (tiny / "ddlib" / "arm.py").write_text("G = 9.80665\n")
    assert build(tiny).returncode == 0
    assert runs(tiny) == 1


@pytest.mark.slow
@pytest.mark.parametrize(
    ("text", "code", "complaint"),
    [
        ("# Title\n\n{ref}`nowhere`", "1", "nowhere"),
        ("# Title", "1 / 0", "ZeroDivisionError"),
        ("# Title", "import warnings\n\nwarnings.warn('look here')", "stderr was found"),
        ("# Title\n\n{py:func}`ddlib.nothing`", "1", "ddlib.nothing"),
    ],
)
def test_a_failing_build_keeps_failing(tiny, text, code, complaint):
    write_page(tiny, text, code)
    for _ in range(2):
        outcome = build(tiny)
        assert outcome.returncode != 0
        assert complaint in outcome.stdout + outcome.stderr
        assert "FAILED" in outcome.stderr
