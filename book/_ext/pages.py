"""Jupyter Book's command for `build.py`, made ready while the notebooks are still executed.

It imports what the pages need, and then waits for a line on standard input: a JSON list of the
pages that are not to be executed again. Without one it ends.
"""

from __future__ import annotations

import gc
import importlib
import os
import pkgutil
import sys
import warnings
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))  # for the workshop of the book

from dd_failures import UNEXECUTED

import beyond
import ddlib
import workshop

# Imported with nbformat, it compiles a grammar of addresses for more than a second. Nothing here
# asks for it: jsonschema goes without.
sys.modules["rfc3987_syntax"] = None

# All pages are held as trees of many nodes, until the last one is written. Looking through them
# for garbage takes an eighth of the time, and finds less than half a gigabyte.
gc.disable()

# One extension asks of every object in memory whether it is of a kind; some of torch's warn then.
warnings.filterwarnings("ignore", category=FutureWarning, module="sphinx_external_toc")

# Those that take long to import.
EXTENSIONS = ("myst_nb", "sphinx.ext.autodoc", "sphinx_book_theme", "sphinxcontrib.bibtex")


def prepare():
    """Import Jupyter Book, its large extensions and the documented modules; return the command.

    Pages are read and written in processes that are forked from this one.
    """
    from jupyter_book import sphinx
    from jupyter_book.cli.main import main

    rooms = [(room.__path__, f"{room.__name__}.") for room in (ddlib, workshop, beyond)]
    documented = [module.name for room in rooms for module in pkgutil.walk_packages(*room)]
    for name in (*EXTENSIONS, *documented):
        try:
            importlib.import_module(name)
        except Exception:  # its pages will tell
            continue
    # The command has no option for as many jobs as there are cores.
    sphinx.build_sphinx.__kwdefaults__["jobs"] = os.cpu_count()
    return main


def run() -> None:
    command = prepare()
    os.environ[UNEXECUTED] = sys.stdin.readline()
    if not os.environ[UNEXECUTED]:
        return
    try:
        command()
    except SystemExit as end:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(end.code or 0)  # to take the trees apart would take seconds


if __name__ == "__main__":
    run()
