"""The book's Sphinx extension: the notebooks' cache, a local MathJax, slim pages."""

from __future__ import annotations

import shutil
import sys
import time
from functools import partial
from importlib.metadata import files, version
from pathlib import Path

import joblib
import nbformat
from jupyter_cache import get_cache
from slim import slim

sys.path.insert(0, str(Path(__file__).parents[1]))  # for the workshop of the book

MATHJAX = "tex-svg-full.js"
# Kinds of files that notebooks or pages are made from; what tools leave behind is of no such kind,
# or lies in a folder whose name begins with a dot.
KINDS = {
    *(".py", ".pyi", ".ipynb", ".md", ".bib", ".yml", ".toml", ".txt", ".json", ".csv", ".npz"),
    *(".js", ".mjs", ".css", ".woff2", ".svg", ".png", ".cff", ".jinja", ".sh"),
}
KEPT_CACHES = 3

# What a notebook's outcome depends on beside its own cells, what every page depends on beside its
# own source, and what the pages together depend on. Lists like quizzes.yml are the pages' alone.
READ = ("book/cards.yml", "book/claims.yml", "book/errata.yml", "book/questions.yml")
CODE = ("ddlib", "book/workshop", "book/beyond", "requirements.txt")
CELL_INPUTS = (*CODE, "book/results", "book/data", *READ)
SITE = ("book/_ext", "book/_static", "_config.yml", "_toc.yml", "CITATION.cff")
FRAME_INPUTS = (*CELL_INPUTS, *SITE)
PAGE_INPUTS = (
    "book",
    "ddlib",
    "_config.yml",
    "_toc.yml",
    "requirements.txt",
    "pyproject.toml",
    "CITATION.cff",
)


LIBRARIES = ("numpy", "scipy", "torch", "matplotlib", "Sphinx", "myst-nb")


def digest(root: Path, patterns: tuple[str, ...]) -> str:
    """Hash of all sources that the patterns name, and of the versions that make pages of them."""
    read = {name: path.read_bytes() for name, path in sources(root, patterns).items()}
    versions = sys.version_info[:2], *map(version, LIBRARIES)
    return joblib.hash((versions, read), hash_name="sha1")[:16]


def sources(root: Path, patterns: tuple[str, ...]) -> dict[str, Path]:
    """Files of `KINDS` that the patterns name, by their paths below the root."""
    tops = [top for pattern in patterns for top in root.glob(pattern)]
    found = {path for top in tops for path in (top, *top.rglob("*")) if path.suffix in KINDS}
    named = {path.relative_to(root): path for path in found if path.is_file()}
    hidden = {name for name in named if any(part.startswith(".") for part in name.parts)}
    return {name.as_posix(): path for name, path in named.items() if name not in hidden}


def cache_path(root: Path) -> Path:
    """Where executed notebooks are kept: keyed by the code and data they import and read.

    The oldest of such folders are dropped.
    """
    cache = root / "_build" / ".jupyter_cache" / digest(root, CELL_INPUTS)
    cache.mkdir(parents=True, exist_ok=True)
    cache.touch()
    by_age = sorted(cache.parent.iterdir(), key=lambda path: path.stat().st_mtime)
    for old in by_age[:-KEPT_CACHES]:
        shutil.rmtree(old)
    return cache


def copy_mathjax(app):
    """Take the one MathJax file that needs no others; its package as an extension copies 24 MB."""
    if app.builder.format != "html":
        return
    source = next(f for f in files("sphinx-mathjax-offline") if f.name == MATHJAX)
    target = Path(app.outdir, "_static", "mathjax", MATHJAX)
    target.parent.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(source.locate(), target)


def read_side_by_side(app, env, names):
    """Pages are read on all cores.

    One extension of Jupyter Book does not say that it is safe: it acts when all pages are read.
    """
    app.extensions["sphinx_multitoc_numbering"].parallel_read_safe = True


def show_outputs(app, page, text):
    """A page that is built alone takes its outputs from the cache; no other has any."""
    if page == app.config.only_page:
        notebook = nbformat.reads(text[0], as_version=4)
        _, executed = get_cache(app.config.only_cache).merge_match_into_notebook(notebook)
        text[0] = nbformat.writes(executed)


def slim_pages(started, app, exception):
    """Trim what was written, once all of it is there."""
    if app.builder.format == "html" and exception is None:
        slim(Path(app.outdir), started)


def setup(app):
    app.add_config_value("only_page", "", "")  # of `build.py --lesson`
    app.add_config_value("only_cache", "", "")
    app.connect("source-read", show_outputs, priority=100)
    app.connect("builder-inited", copy_mathjax)
    app.connect("env-before-read-docs", read_side_by_side)
    slim_new = partial(slim_pages, time.time() - 1)
    app.connect("build-finished", slim_new, priority=900)  # after the theme's own
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
