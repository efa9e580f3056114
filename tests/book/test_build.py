"""The build: what it depends on, what it runs again, when it fails and what it says then."""

from __future__ import annotations

import os
import re
import shutil
import signal
import subprocess
import sys
import time

import dd_book
import nbformat
import psutil
import pytest
from book_pages import ROOT
from bs4 import BeautifulSoup
from dd_book import CELL_INPUTS, PAGE_INPUTS, digest, sources

STAMP = "_build/html/.built-from"
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


def write_page(root, text, *code, name="index"):
    code_cells = [nbformat.v4.new_code_cell(source) for source in code or (COUNTING,)]
    notebook = nbformat.v4.new_notebook(
        cells=[nbformat.v4.new_markdown_cell(text), *code_cells],
        metadata={"kernelspec": {"name": "python3", "display_name": "Python 3"}},
    )
    nbformat.write(notebook, root / "book" / f"{name}.ipynb")


def add_page(root, text, *code, name="chapter"):
    toc = (root / "_toc.yml").read_text()
    head = "" if "chapters:" in toc else "chapters:\n"
    (root / "_toc.yml").write_text(f"{toc}{head}- file: book/{name}\n")
    write_page(root, text, *code, name=name)


def run(root, *options, ci=False):
    command = [sys.executable, str(ROOT / "book" / "_ext" / "build.py"), *options, str(root)]
    surroundings = {key: value for key, value in os.environ.items() if key != "CI"}
    if ci:
        surroundings["CI"] = "true"
    return subprocess.run(command, capture_output=True, text=True, check=False, env=surroundings)


def runs(root) -> int:
    return len((root / "book" / "runs").read_text())


MATTERS = [
    (CELL_INPUTS, "ddlib/dynamics/arm.py", True),
    (CELL_INPUTS, "ddlib/new.py", True),
    (CELL_INPUTS, "ddlib/__pycache__/arm.pyc", False),
    (CELL_INPUTS, "book/results/numbers.json", True),
    (CELL_INPUTS, "book/claims.yml", True),
    (CELL_INPUTS, "requirements.txt", True),
    (CELL_INPUTS, "book/data/motions.csv", True),
    (CELL_INPUTS, "book/lectures.yml", False),
    (PAGE_INPUTS, "book/lectures.yml", True),
    (CELL_INPUTS, "book/index.ipynb", False),
    (PAGE_INPUTS, "book/index.ipynb", True),
    (PAGE_INPUTS, "book/_static/book.css", True),
    (PAGE_INPUTS, "_config.yml", True),
    (PAGE_INPUTS, "book/.ipynb_checkpoints/index.ipynb", False),
    (PAGE_INPUTS, "book/.ruff_cache/0.14.0/1234567", False),
    (CELL_INPUTS, "book/workshop/.ruff_cache/CACHEDIR.TAG", False),
    (CELL_INPUTS, "book/workshop/.mypy_cache/3.11/ddlib.data.json", False),
    (CELL_INPUTS, "ddlib/arm.py~", False),
    (CELL_INPUTS, "ddlib/.arm.py.swp", False),
    (CELL_INPUTS, "ddlib/arm.py.orig", False),
]


def test_digest_sees_what_matters(tiny, monkeypatch):
    for inputs, path, changes in MATTERS:
        before, target = digest(tiny, inputs), tiny / path
        target.parent.mkdir(exist_ok=True, parents=True)
        target.write_text(target.read_text() + "\n# more" if target.exists() else "more")
        assert (digest(tiny, inputs) != before) is changes, path
    before = digest(tiny, CELL_INPUTS)
    (tiny / "ddlib" / "arm.py").rename(tiny / "ddlib" / "leg.py")
    assert digest(tiny, CELL_INPUTS) != before
    for library in ("numpy", "scipy", "torch", "matplotlib"):
        before = digest(tiny, CELL_INPUTS)
        installed = dd_book.version
        monkeypatch.setattr(
            dd_book, "version", lambda n, a=library, v=installed: v(n) + "x" * (n == a)
        )
        assert digest(tiny, CELL_INPUTS) != before, library


def test_the_digest_sees_every_file_that_is_kept(tmp_path):
    """Of any kind: by the list of git, but for licences, from which nothing is made."""
    try:
        command = ["git", "-C", str(ROOT), "ls-files", "-z", *PAGE_INPUTS]
        told = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    except (OSError, subprocess.CalledProcessError):
        pytest.skip("this is no clone")
    unread = re.compile(r".*/(LICENSE-[\w-]+|py\.typed)")
    kept = {name for name in told.split("\0") if name and not unread.fullmatch(name)}
    assert len(kept) > 400 and not kept - set(sources(ROOT, PAGE_INPUTS))


def test_digest_does_not_see_where_the_folder_lies(tiny, tmp_path_factory):
    away = tmp_path_factory.mktemp("away") / "__pycache__" / "b [1]"
    shutil.copytree(tiny, away)
    assert digest(away, PAGE_INPUTS) == digest(tiny, PAGE_INPUTS)


DRAWN = "import matplotlib.pyplot as plt\n\nplt.plot([1, 2])\nplt.show()"


@pytest.mark.slow
def test_a_strict_build_holds_wherever_the_folder_lies(tiny, tmp_path_factory, monkeypatch):
    """With a picture, a page that leads to another, a file that is no page, and another backend."""
    monkeypatch.setenv("MPLBACKEND", "Agg")
    write_page(tiny, "# Title\n\n{doc}`chapter`", DRAWN)
    add_page(tiny, "# Chapter", "1 + 1")
    (tiny / "README.md").write_text("# No page")
    root = shutil.copytree(tiny, tmp_path_factory.mktemp("away") / "Übung (1)" / "a b")
    outcome = run(root, "--strict")
    assert outcome.returncode == 0, outcome.stdout + outcome.stderr
    assert (root / "_build" / "html" / "index.html").as_uri() in outcome.stdout
    assert [path.name for path in root.parent.iterdir()] == [root.name]  # nothing beside it
    page = root / "_build" / "html" / "book" / "index.html"
    found = BeautifulSoup(page.read_text(encoding="utf-8"), "html.parser")
    (picture,) = found.select("article .cell_output img")
    assert (page.parent / picture["src"]).is_file()
    assert found.select_one('article a[href="chapter.html"]')
    assert "Nothing changed" in run(root, "--strict").stdout


def written(root, name: str) -> float:
    return (root / "_build" / "html" / "book" / f"{name}.html").stat().st_mtime


@pytest.mark.slow
def test_what_changed_is_made_again_and_nothing_else(tiny):
    """A sentence: its page. A style: no notebook. Code: all notebooks."""
    add_page(tiny, "# Chapter\n\nIt is quick.", "1 + 1")
    add_page(tiny, "# Other", "2 + 2", name="other")
    first = run(tiny)
    assert first.returncode == 0, first.stdout + first.stderr
    assert "index.html" in first.stdout.splitlines()[-1]
    (tiny / "book" / "runs").rename(tiny / "runs")  # what the cell wrote is no source
    assert "Nothing changed" in run(tiny).stdout

    before = {name: written(tiny, name) for name in ("chapter", "other")}
    write_page(tiny, "# Chapter\n\nIt is light.", "1 + 1", name="chapter")
    assert run(tiny).returncode == 0
    assert (
        written(tiny, "chapter") > before["chapter"] and written(tiny, "other") == before["other"]
    )
    texts = (tiny / "_build" / "html" / "_static" / "search-texts.js").read_text()
    assert "It is light" in texts and "quick" not in texts and "book/chapter" in texts

    write_page(tiny, "# Another title\n\nIt is light.", "1 + 1", name="chapter")
    assert run(tiny).returncode == 0  # which stands in the contents of every page
    assert "Another title" in (tiny / "_build/html/book/other.html").read_text(encoding="utf-8")

    (tiny / "book" / "_static" / "book.css").write_text("/* other style */")
    assert run(tiny).returncode == 0
    assert "other style" in (tiny / "_build" / "html" / "_static" / "book.css").read_text()
    assert not (tiny / "book" / "runs").exists()

    (tiny / "ddlib" / "arm.py").write_text("# 1\n")
    assert run(tiny).returncode == 0
    assert runs(tiny) == 1


@pytest.mark.slow
def test_one_page_is_built_alone(tiny):
    """Its notebook is executed once, and no other; a fault in it is said in a line."""
    add_page(tiny, "# Chapter\n\n{doc}`index`", "print('it ran')")
    outcome = run(tiny, "--lesson", "chapter")
    assert outcome.returncode == 0, outcome.stdout + outcome.stderr
    page = tiny / "_build" / "page" / "html" / "book" / "chapter.html"
    assert outcome.stdout.splitlines()[-1].endswith(page.as_uri())
    assert "it ran" in page.read_text(encoding="utf-8") and not (tiny / "book" / "runs").exists()
    write_page(tiny, "# Chapter", "1 / 0", name="chapter")
    outcome = run(tiny, "--lesson", "chapter")
    assert outcome.returncode == 1 and "FAILED: ZeroDivisionError" in outcome.stderr
    assert "names no notebook book/none" in run(tiny, "--lesson", "none").stderr


ENDLESS = """import os, pathlib, time

pathlib.Path("{}.pid").write_text(str(os.getpid()))
time.sleep(600)"""


@pytest.mark.slow
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM], ids=["Ctrl-C", "kill"])
def test_an_interrupted_build_says_one_line_and_leaves_no_process(number, tiny):
    """Ctrl-C reaches all processes of the group, `kill` the first alone."""
    names = ("index", "chapter", "third", "fourth")  # more than run at once
    for name in names[1:]:
        add_page(tiny, "# Title", ENDLESS.format(name), name=name)
    write_page(tiny, "# Title", ENDLESS.format("index"))
    command = [sys.executable, str(ROOT / "book" / "_ext" / "build.py"), str(tiny)]
    streams = {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT, "text": True}
    build = subprocess.Popen(command, start_new_session=True, **streams)
    files = [tiny / "book" / f"{name}.pid" for name in names]
    while sum(path.is_file() for path in files) < 2 and build.poll() is None:
        time.sleep(0.1)
    (os.killpg if number == signal.SIGINT else os.kill)(build.pid, number)
    lines = build.communicate(timeout=30)[0].splitlines()
    assert build.returncode == 130 and lines[-1].startswith("==> Stopped")
    said = [line for line in lines if "notebooks after" not in line]
    assert len(said) == 2, said  # what it does, and that it stopped
    time.sleep(1)
    kernels = [int(path.read_text()) for path in files if path.is_file()]
    assert len(kernels) >= 2 and not list(filter(psutil.pid_exists, kernels))
    with pytest.raises(ProcessLookupError):
        os.killpg(build.pid, 0)


FAULTS = {
    "nowhere": ("# Title\n\n{ref}`nowhere`", "1"),
    "ZeroDivisionError": ("# Title", "1 / 0"),
    "stderr was found": ("# Title", "import warnings\n\nwarnings.warn('look here')"),
    "ddlib.nothing": ("# Title\n\n{py:func}`ddlib.nothing`", "1"),
}


@pytest.mark.slow
@pytest.mark.parametrize(
    "faults, ci", [(tuple(FAULTS)[:3], False), (tuple(FAULTS)[3:], True)], ids=["option", "CI"]
)
def test_a_strict_build_fails(tiny, faults, ci):
    """Whatever it complains about, each alone is enough: see `build.main`."""
    write_page(tiny, *FAULTS[faults[0]])
    for k, fault in enumerate(faults[1:]):
        add_page(tiny, *FAULTS[fault], name=f"chapter-{k}")
    outcome = run(tiny, *([] if ci else ["--strict"]), ci=ci)
    assert outcome.returncode == 1
    assert not [complaint for complaint in faults if complaint not in outcome.stderr]
    assert "FAILED: under --strict" in outcome.stderr
    assert not (tiny / STAMP).exists()  # else the next call would say "nothing changed"


@pytest.mark.slow
def test_a_warning_does_not_stop_a_reader(tiny):
    write_page(tiny, "# Title\n\n{ref}`nowhere`")
    outcome = run(tiny)
    assert outcome.returncode == 0
    assert "nowhere" in outcome.stderr and "FAILED" not in outcome.stderr
    assert "are about: index" in outcome.stderr
    assert not (tiny / STAMP).exists()


@pytest.mark.slow
def test_bad_chapters_do_not_take_the_book_with_them(tiny):
    """One of which a cell fails, one of which the kernel ends."""
    quotes = [f"from ddlib.tables import quote\nquote({name!r}, -1.5)" for name in "ab"]
    add_page(
        tiny,
        "# Chapter\n\nIt is {glue:text}`a:.2f`, or {glue:text}`b:.2f`.",
        quotes[0],
        "print('so far')\n1 / 0",
        quotes[1],
    )
    add_page(tiny, "# Ended", "import os\n\nos._exit(1)", name="ended")
    outcome = run(tiny)
    assert outcome.returncode == 1
    assert "Traceback" not in outcome.stderr
    assert "FAILED in part" in outcome.stderr
    assert "book/chapter: code cell 2 (“print('so far')”): ZeroDivision" in outcome.stderr
    assert "book/ended: its notebook: The Python process" in outcome.stderr
    pages = {n: tiny / "_build/html/book" / f"{n}.html" for n in ("index", "chapter", "ended")}
    ended = pages["ended"].read_text(encoding="utf-8")
    assert "This page is incomplete" in ended and "os._exit" in ended
    bad = BeautifulSoup(pages["chapter"].read_text(encoding="utf-8"), "html.parser")
    box = bad.select_one("article h1 + .admonition.failed")
    said = box.get_text(" ", strip=True)
    assert "code cell 2" in said and "ZeroDivisionError: division by zero" in said
    assert "Please report" in said and "Python 3." in said
    assert "It is −1.50, or ?." in bad.select_one("article").get_text()
    assert "so far" in bad.select_one("article .cell_output").get_text()
    assert "incomplete" not in pages["index"].read_text(encoding="utf-8")
    assert "index.html" in outcome.stdout.splitlines()[-1]
    assert not (tiny / STAMP).exists()

    write_page(tiny, "# Chapter", "1 + 1", name="chapter")
    write_page(tiny, "# Ended", "1 + 1", name="ended")
    assert run(tiny).returncode == 0
    assert (tiny / STAMP).exists()
    assert "incomplete" not in pages["chapter"].read_text(encoding="utf-8")
