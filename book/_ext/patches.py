"""What the build changes inside other libraries; there is nothing of the kind elsewhere.

A change stands here with its reason, with the version that it was made for, and with what comes of
leaving it out. `tests/book/test_patches.py` says if another version has no longer what is changed.
"""

from __future__ import annotations

import sqlite3
from collections.abc import Callable
from functools import partial

from jupyter_cache.cache import db
from myst_nb import sphinx_ as myst_nb
from nbformat import NotebookNode

# jupyter-cache 1.0.1 gives the path of its database to SQLAlchemy as an address, in which "?" and
# "%" mean something else. Without this, a clone in a folder like "50%" or "why?" is not built.
create_engine = db.create_engine


def by_path(address: str):
    """The engine of a database, opened by the path in its address."""
    path = address.removeprefix("sqlite:///")
    connect = partial(sqlite3.connect, path, check_same_thread=False)
    return create_engine("sqlite:///by-its-path", creator=connect)


db.create_engine = by_path


# MyST-NB 1.4.0 looks a notebook up in the cache by its cells and their tags, so a page cannot have
# other tags when it is read. Without this, pages show all bookkeeping, and say of no fold how long
# it is.
notebook_to_tokens = myst_nb.notebook_to_tokens


def parse_cells_as(change: Callable[[NotebookNode], NotebookNode]) -> None:
    """Parse notebooks with their cells changed; outputs stay those of the cells as they were."""

    def tokens(notebook, *rest):
        cells = [change(cell) for cell in notebook.cells]
        return notebook_to_tokens(NotebookNode({**notebook, "cells": cells}), *rest)

    myst_nb.notebook_to_tokens = tokens
