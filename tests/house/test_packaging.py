"""What a wheel holds: every package, and every file of them that is not Python."""

import shutil
import subprocess
import sys
import tomllib
from fnmatch import fnmatch

import pytest
from test_imports import PACKAGES, ROOT

SETTINGS = tomllib.loads((ROOT.parent / "pyproject.toml").read_text(encoding="utf-8"))
TOOL = SETTINGS["tool"]["setuptools"]
DATA = [
    path.relative_to(ROOT).as_posix()
    for path in sorted(ROOT.rglob("*"))
    if path.is_file() and path.suffix not in (".py", ".pyc")
]


def test_every_package_is_found():
    (pattern,) = TOOL["packages"]["find"]["include"]
    names = {".".join(p.relative_to(ROOT.parent).parts) for p in PACKAGES} | {"ddlib"}
    assert all(fnmatch(name, pattern) for name in names) and not fnmatch("book", pattern)
    folders = {path.parent for path in ROOT.rglob("*.py")}
    assert folders == {ROOT, *PACKAGES}, "a folder without __init__.py is no package"


@pytest.mark.parametrize("path", DATA)
def test_every_other_file_is_package_data(path):
    assert any(fnmatch(path, pattern) for pattern in TOOL["package-data"]["ddlib"])


def test_there_is_such_a_file_for_each_script_of_a_widget():
    assert {"widgets/static/curves.js", "widgets/static/curves.css"} <= set(DATA)


IMPORTS = """
import importlib, pkgutil, sys, ddlib
for module in pkgutil.walk_packages(ddlib.__path__, "ddlib."):
    found = importlib.import_module(module.name)
    [getattr(found, name) for name in getattr(found, "__all__", ())]
from ddlib.evidence import claims, ledger
from ddlib.experiments import reproduce, results
calls = claims.load, ledger.errata, lambda: results.read("table-4-1"), lambda: results.networks(21)
for call in (*calls, lambda: reproduce.main(["table-4-1"])):
    try:
        call()
    except FileNotFoundError as error:
        assert "belongs to the book" in str(error), error
    else:
        raise AssertionError(call)
assert not [m for m in sys.modules if m == "tests"]
print(ddlib.__file__)
"""


@pytest.mark.slow
def test_a_copy_without_the_book_imports_and_says_what_is_missing(tmp_path):
    """As after `pip install`: the package lies somewhere else, with no book beside it."""
    copy = tmp_path / "site" / "ddlib"
    shutil.copytree(ROOT, copy, ignore=shutil.ignore_patterns("__pycache__"))
    code = f"import sys; sys.path.insert(0, {str(copy.parent)!r})" + IMPORTS
    command = [sys.executable, "-I", "-c", code]
    answer = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert answer.returncode == 0, answer.stderr
    assert answer.stdout.strip() == str(copy / "__init__.py")
    assert not (tmp_path / "site" / "book").exists()
