"""The book's Sphinx extension: the notebooks' cache, a local MathJax, slim pages."""

from __future__ import annotations

import glob
import shutil
import sys
from importlib.metadata import files
from pathlib import Path

import joblib
import patches  # noqa: F401
from slim import slim

sys.path.insert(0, str(Path(__file__).parents[1]))  # for the workshop of the book

MATHJAX = "tex-svg-full.js"
# Kinds of files that notebooks or pages are made from; what tools leave behind is of no such kind,
# or lies in a folder whose name begins with a dot.
KINDS = {
    *(".py", ".pyi", ".ipynb", ".md", ".bib", ".yml", ".toml", ".txt", ".json", ".csv", ".npz"),
    *(".js", ".mjs", ".css", ".svg", ".png", ".cff", ".jinja"),
}
KEPT_CACHES = 3

# What a notebook's outcome depends on beside its own cells, and what the pages depend on.
# Questions for readers (quizzes.yml) are the pages' alone.
READ = ("book/cards.yml", "book/claims.yml", "book/errata.yml", "book/questions.yml")
CELL_INPUTS = ("ddlib", "book/workshop", "book/beyond", "book/results", *READ, "requirements.txt")
PAGE_INPUTS = (
    "book",
    "ddlib",
    "_config.yml",
    "_toc.yml",
    "requirements.txt",
    "pyproject.toml",
    "CITATION.cff",
)


def digest(root: Path, patterns: tuple[str, ...]) -> str:
    """Hash of all sources that the patterns name: see `workshop.report.results`."""
    read = {name: path.read_bytes() for name, path in sources(root, patterns).items()}
    return joblib.hash((sys.version_info[:2], read), hash_name="sha1")[:16]


def sources(root: Path, patterns: tuple[str, ...]) -> dict[str, Path]:
    """Files of `KINDS` that the patterns name, by their paths below the root."""
    tops = [top for pattern in patterns for top in root.glob(pattern)]
    found = {path for top in tops for path in (top, *top.rglob("*")) if path.suffix in KINDS}
    named = {path.relative_to(root): path for path in found if path.is_file()}
    hidden = {name for name in named if any(part.startswith(".") for part in name.parts)}
    return {name.as_posix(): path for name, path in named.items() if name not in hidden}


def cache_path(root: Path, build: Path) -> Path:
    """Where executed notebooks are kept: keyed by the code and data they import and read."""
    return build / ".jupyter_cache" / digest(root, CELL_INPUTS)


def set_cache_path(app, config):
    """Point myst-nb to the cache, and drop the oldest ones."""
    cache = cache_path(Path(app.srcdir), Path(app.outdir).parent)
    caches = cache.parent
    cache.mkdir(parents=True, exist_ok=True)
    cache.touch()
    by_age = sorted(caches.iterdir(), key=lambda path: path.stat().st_mtime)
    for old in by_age[:-KEPT_CACHES]:
        shutil.rmtree(old)
    config.nb_execution_cache_path = str(cache)


def leave_out_unlisted(app, config):
    """Leave out what the table of contents does not name, where the folder's path has brackets.

    Elsewhere `sphinx_external_toc` has done so: by a pattern that begins with that path.
    """
    if glob.escape(str(app.srcdir)) == str(app.srcdir):
        return
    listed = set(config.external_site_map)
    for suffix in config.source_suffix:
        for path in glob.glob(f"**/*{suffix}", root_dir=app.srcdir, recursive=True):
            name = Path(path).as_posix()
            if not {name, name.removesuffix(suffix)} & listed:
                config.exclude_patterns = [*config.exclude_patterns, name]


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


def slim_pages(app, exception):
    """Trim what was written, once all of it is there."""
    if app.builder.format == "html" and exception is None:
        slim(Path(app.outdir))


def setup(app):
    app.connect("config-inited", set_cache_path)
    app.connect("config-inited", leave_out_unlisted, priority=910)  # the table has been read
    app.connect("builder-inited", copy_mathjax)
    app.connect("env-before-read-docs", read_side_by_side)
    app.connect("build-finished", slim_pages, priority=900)  # after the theme's own
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
