"""Other systems than this one: declared dependencies, and their locks."""

import re
import sys
import tomllib
from functools import cache
from importlib.metadata import packages_distributions

import pytest
from book_pages import ROOT, code_cells
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name
from test_imports import imported

PYPROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
FOLDERS = ("ddlib", "book/workshop", "book/beyond", "tests", "benchmarks", "book/_ext")
TEXTS = {
    folder: {path: path.read_text("utf-8") for path in sorted((ROOT / folder).rglob("*.py"))}
    for folder in FOLDERS
}
HERE = {
    path.parent.name if path.stem == "__init__" else path.stem
    for folder in ("tests", "benchmarks", "book/_ext")
    for path in TEXTS[folder]
    if path.parent.name != "instead"  # what a page that runs has in place of others' packages
}
UNSEEN = {"pinocchio": ["pin"]}
"""Modules that a ``.pth`` file puts on the path, with the distributions that they come from."""


def named(lines) -> dict[str, Requirement]:
    """Requirements by the normal form of their names."""
    return {canonicalize_name(r.name): r for r in map(Requirement, lines)}


OWN = named(PYPROJECT["project"]["dependencies"])
EXTRAS = {k: named(v) for k, v in PYPROJECT["project"]["optional-dependencies"].items()}
GROUPS = PYPROJECT["dependency-groups"]
PINS = named(line for name in ("reader", "build", "tools") for line in GROUPS[name])


def notebooks() -> list[str]:
    """The code of all notebooks."""
    cells = [code for path in sorted(ROOT.glob("book/**/*.ipynb")) for code in code_cells(path)]
    return [code for code in cells if not code.startswith("%")]


installed = cache(packages_distributions)


def distributions(sources) -> set[str]:
    """Distributions from which sources import, in normal form; unknown modules as they are."""
    known = installed() | UNSEEN
    tops = {name.partition(".")[0] for source in sources for name in imported(source)}
    outside = tops - HERE - set(sys.stdlib_module_names) - {"ddlib", "workshop", "beyond", ""}
    return {canonicalize_name(known.get(name, [name])[0]) for name in outside}


def test_the_package_declares_what_it_imports():
    used = distributions(TEXTS["ddlib"].values())
    assert {"numpy", "torch", "traitlets"} <= used <= OWN.keys() | set().union(*EXTRAS.values())
    # anywidget's own need, for whose look and buttons the pages rely on its version 8
    used |= {"ipywidgets"} | distributions(TEXTS["book/workshop"].values())
    used |= distributions(TEXTS["book/beyond"].values())
    assert OWN.keys() <= used, "a dependency is declared and not imported"


def test_the_environment_declares_what_is_imported():
    sources = {**{folder: texts.values() for folder, texts in TEXTS.items()}, "book": notebooks()}
    for folder, texts in sources.items():
        declared = PINS.keys() | EXTRAS["learning"].keys()
        declared |= EXTRAS["bench"].keys() if folder == "benchmarks" else set()
        assert distributions(texts) <= declared, f"{folder}: missing in pyproject.toml"


def test_the_pins_lie_in_the_packages_ranges():
    for name, wanted in {**OWN, **EXTRAS["dask"]}.items():
        (version,) = PINS[name].specifier
        assert version.operator == "==" and version.version in wanted.specifier, name


@pytest.mark.parametrize(
    "file, groups",
    [
        ("requirements.txt", ("reader", "build")),
        ("requirements-test.txt", ("reader", "build", "tools")),
    ],
)
def test_what_make_installs_is_what_pyproject_pins_with_hashes(file, groups):
    blocks = re.split(r"\n(?=\w)", (ROOT / file).read_text(encoding="utf-8").strip())[1:]
    locked = {Requirement(block.partition("\\")[0]).name: block for block in blocks}
    for name, pin in named(line for group in groups for line in GROUPS[group]).items():
        assert Requirement(locked[name].partition("\\")[0]).specifier == pin.specifier, name
    assert all("--hash=sha256:" in block for block in blocks)
