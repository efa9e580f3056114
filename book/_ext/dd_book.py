"""The book's Sphinx extension: the notebooks' cache, a local MathJax, slim pages."""

from __future__ import annotations

import shutil
import sys
from functools import wraps
from importlib.metadata import files
from pathlib import Path

import joblib
from sphinx import addnodes
from sphinx.environment.adapters import toctree

from slim import slim

MATHJAX = "tex-svg-full.js"
SKIP = {"__pycache__", ".ipynb_checkpoints"}
KEPT_CACHES = 3

# What a notebook's outcome depends on beside its own cells, and what the pages depend on.
CELL_INPUTS = ("ddlib", "book/results", "book/*.yml", "requirements.txt")
PAGE_INPUTS = ("book", "ddlib", "_config.yml", "_toc.yml", "requirements.txt", "pyproject.toml")


def digest(root: Path, patterns: tuple[str, ...]) -> str:
    """Hash of all files that the patterns name, folders included: see `ddlib.experiments.results`.

    What Python and Jupyter leave behind does not count.
    """
    tops = [top for pattern in patterns for top in root.glob(pattern)]
    found = {path for top in tops for path in (top, *top.rglob("*")) if path.is_file()}
    read = {p.relative_to(root).as_posix(): p.read_bytes() for p in found if not SKIP & {*p.parts}}
    return joblib.hash((sys.version_info[:2], read), hash_name="sha1")[:16]


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

    Two extensions of Jupyter Book do not say that they are safe: one acts after all pages are
    read, one on LaTeX alone.
    """
    for name in ("sphinx_multitoc_numbering", "sphinx_jupyterbook_latex"):
        if name in app.extensions:
            app.extensions[name].parallel_read_safe = True


def copy_titles_alone(app):
    """The sidebar shows titles of pages: do not copy all their sections for it, on every page.

    Sphinx copies them and drops them afterwards, which takes longer than to write the page.
    """
    usual = getattr(toctree, "_toctree_standard_entry", None)
    if usual is None:  # another Sphinx: as right, and slower
        return

    @wraps(usual)
    def entry(title, ref, maxdepth, toc, *options):
        depth = maxdepth if any(toc.findall(addnodes.toctree)) else 1
        return usual(title, ref, depth, toc, *options)

    toctree._toctree_standard_entry = entry


def slim_pages(app, exception):
    """Trim what was written, once all of it is there."""
    if app.builder.format == "html" and exception is None:
        slim(Path(app.outdir))


def setup(app):
    app.connect("config-inited", set_cache_path)
    app.connect("builder-inited", copy_mathjax)
    app.connect("builder-inited", copy_titles_alone)
    app.connect("env-before-read-docs", read_side_by_side)
    app.connect("build-finished", slim_pages, priority=900)  # after the theme's own
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
