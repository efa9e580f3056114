"""The book's Sphinx extension: the notebooks' cache, a local MathJax, slim pages."""

from __future__ import annotations

import glob
import shutil
import sqlite3
import sys
from functools import cache, partial, wraps
from importlib.metadata import files
from pathlib import Path

import joblib
from jupyter_cache.cache import db
from pybtex import plugin
from slim import slim
from sphinx import addnodes, builders
from sphinx.environment.adapters import toctree
from sphinx.util.parallel import make_chunks

sys.path.insert(0, str(Path(__file__).parents[1]))  # for the workshop of the book

MATHJAX = "tex-svg-full.js"
# Kinds of files that notebooks or pages are made from; what tools leave behind is of no such kind,
# or lies in a folder whose name begins with a dot.
KINDS = {
    *(".py", ".pyi", ".ipynb", ".md", ".bib", ".yml", ".toml", ".txt", ".json", ".csv", ".npz"),
    *(".js", ".mjs", ".css", ".svg", ".png", ".cff"),
}
KEPT_CACHES = 3
SMALL = 1  # a batch has the root of so many times the pages that fall to a process

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


_open = db.create_engine


def open_by_path(address: str):
    """The cache's database by its path: in an address, "?" and "%" would not be the folder's."""
    path = address.removeprefix("sqlite:///")
    connect = partial(sqlite3.connect, path, check_same_thread=False)
    return _open("sqlite:///by-its-path", creator=connect)


db.create_engine = open_by_path


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

    Two extensions of Jupyter Book do not say that they are safe: one acts after all pages are
    read, one on LaTeX alone.
    """
    for name in ("sphinx_multitoc_numbering", "sphinx_jupyterbook_latex"):
        if name in app.extensions:
            app.extensions[name].parallel_read_safe = True


def deal(app, env, names):
    """Pages that document much code take long to read: not all of them in one batch."""
    texts = {name: Path(env.doc2path(name)).read_text(encoding="utf-8") for name in names}
    names.sort(key=lambda name: (-texts[name].count("automodule"), -len(texts[name])))
    batches = len(builders.make_chunks(names, app.parallel))
    names[:] = [name for k in range(batches) for name in names[k::batches]]


def work_in_small_batches(app):
    """One batch of pages is written while the next is made ready: the first comes soon."""
    builders.make_chunks = partial(make_chunks, maxbatch=SMALL)


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


def look_up_plugins_once(app):
    """A citation looks its style up among all installed packages: once for each name will do."""
    plugin._load_entry_point = cache(plugin._load_entry_point)


def slim_pages(app, exception):
    """Trim what was written, once all of it is there."""
    if app.builder.format == "html" and exception is None:
        slim(Path(app.outdir))


def setup(app):
    app.connect("config-inited", set_cache_path)
    app.connect("config-inited", leave_out_unlisted, priority=910)  # the table has been read
    app.connect("builder-inited", copy_mathjax)
    app.connect("builder-inited", copy_titles_alone)
    app.connect("builder-inited", look_up_plugins_once)
    app.connect("env-before-read-docs", read_side_by_side)
    app.connect("env-before-read-docs", deal)
    app.connect("builder-inited", work_in_small_batches)
    app.connect("build-finished", slim_pages, priority=900)  # after the theme's own
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
