"""Other systems than this one: imports without Unix, Python versions, declared dependencies."""

import ast
import errno
import json
import re
import subprocess
import sys
import tomllib
from importlib.metadata import packages_distributions
from pathlib import Path

import pytest
import yaml
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from ddlib.experiments import results
from ddlib.learning import Scaler, TorqueModel, Weights

ROOT = Path(__file__).parents[2]
PYPROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))

EVERY_MODULE = """
import importlib, pkgutil, sys
sys.modules["resource"] = None  # as on Windows: an import fails
import ddlib
names = [m.name for m in pkgutil.walk_packages(ddlib.__path__, "ddlib.")]
for name in names:
    importlib.import_module(name)
print(len(names))
"""


def test_every_module_loads_without_resource_and_without_a_warning():
    command = [sys.executable, "-W", "error", "-c", EVERY_MODULE]
    answer = subprocess.run(command, capture_output=True, text=True, cwd=ROOT)
    assert answer.returncode == 0, answer.stderr
    files = set((ROOT / "ddlib").rglob("*.py")) - {ROOT / "ddlib" / "__init__.py"}
    assert int(answer.stdout) == len(files)


# --- files that may not be read ---------------------------------------------------------


def no_right(*_, **__):
    raise PermissionError(errno.EACCES, "Permission denied")


def test_a_model_that_may_not_be_read_is_still_a_model(tmp_path, monkeypatch):
    scaler = Scaler([0.0, 0.0], [1.0, 1.0])
    path = tmp_path / "model.npz"
    TorqueModel(Weights.random(1, 3), scaler, scaler).save(path)
    assert TorqueModel.load(path).weights.width == 3
    with pytest.raises(IsADirectoryError if sys.platform != "win32" else PermissionError):
        TorqueModel.load(tmp_path)
    path.write_bytes(path.read_bytes()[:300])
    with pytest.raises(ValueError, match="is not a model file"):
        TorqueModel.load(path)
    monkeypatch.setattr(Path, "read_bytes", no_right)
    with pytest.raises(PermissionError):
        TorqueModel.load(path)


def test_a_result_that_may_not_be_read_is_not_missing(tmp_path, monkeypatch):
    monkeypatch.setattr(results, "FOLDER", tmp_path)
    with pytest.raises(FileNotFoundError, match="make reproduce"):
        results.read("none")
    (tmp_path / "half.json").write_text('{"a": 1')
    with pytest.raises(ValueError, match=r"result 'half' in .* is damaged"):
        results.read("half")
    monkeypatch.setattr(Path, "read_text", no_right)
    with pytest.raises(PermissionError):
        results.read("half")


# --- Python versions --------------------------------------------------------------------

SOURCES = [
    path
    for folder in ("ddlib", "tests", "benchmarks", "book/_ext")
    for path in sorted((ROOT / folder).rglob("*.py"))
]


def test_the_syntax_is_that_of_the_oldest_python():
    oldest = PYPROJECT["project"]["requires-python"]
    assert oldest == ">=3.11" and PYPROJECT["tool"]["ruff"]["target-version"] == "py311"
    assert len(SOURCES) > 100
    for path in SOURCES:
        ast.parse(path.read_text(encoding="utf-8"), path.name, feature_version=(3, 11))


# --- dependencies -----------------------------------------------------------------------


def named(lines) -> dict[str, Requirement]:
    """Requirements by the normal form of their names."""
    found = [Requirement(line) for line in lines]
    return {canonicalize_name(r.name): r for r in found}


def pins() -> dict[str, Requirement]:
    text = (ROOT / "requirements.txt").read_text(encoding="utf-8")
    lines = (line.partition("#")[0].strip() for line in text.splitlines())
    return named(line for line in lines if line)


OWN = named(PYPROJECT["project"]["dependencies"])
EXTRAS = {
    name: named(lines) for name, lines in PYPROJECT["project"]["optional-dependencies"].items()
}


def imported(source: str) -> set[str]:
    """Top-level modules that a source imports anywhere, without those of its own folder."""
    names = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            names |= {alias.name.partition(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and not node.level:
            names.add(node.module.partition(".")[0])
    return names


def cells() -> str:
    """The code of all notebooks."""
    parts = []
    for path in sorted((ROOT / "book").glob("*.ipynb")):
        content = json.loads(path.read_text(encoding="utf-8"))
        code = [c["source"] for c in content["cells"] if c["cell_type"] == "code"]
        parts += ["".join(lines) for lines in code if not "".join(lines).startswith("%")]
    return "\n".join(parts)


UNSEEN = {"pinocchio": "pin"}
"""Modules that a ``.pth`` file puts on the path, with the distributions that they come from."""


def distributions(source: str) -> set[str]:
    """Distributions from which a source imports, in normal form; unknown modules as they are."""
    scripts = (path for path in SOURCES if not path.is_relative_to(ROOT / "ddlib"))
    here = {path.stem for path in scripts} | {"ddlib"}
    known = packages_distributions() | {name: [own] for name, own in UNSEEN.items()}
    names = imported(source) - set(sys.stdlib_module_names) - here
    return {canonicalize_name(known.get(name, [name])[0]) for name in names}


def everything_in(folder: str) -> str:
    paths = [p for p in SOURCES if p.is_relative_to(ROOT / folder)]
    return "\n".join(p.read_text(encoding="utf-8") for p in paths)


def test_the_package_declares_what_it_imports():
    optional = set().union(*EXTRAS.values())
    used = distributions(everything_in("ddlib"))
    assert {"numpy", "torch", "traitlets", "ipython", "pyyaml"} <= used
    assert used - optional <= OWN.keys(), "a dependency is missing in pyproject.toml"
    # anywidget's own need, for whose look and buttons the pages rely on its version 8
    assert OWN.keys() - used == {"ipywidgets"}, "a dependency is declared and not imported"


@pytest.mark.parametrize("folder", ["ddlib", "tests", "book/_ext", "benchmarks", "book"])
def test_the_environment_declares_what_is_imported(folder):
    used = distributions(cells() if folder == "book" else everything_in(folder))
    assert used
    declared = pins().keys() | (EXTRAS["bench"].keys() if folder == "benchmarks" else set())
    assert used <= declared, "a dependency is missing in requirements.txt"


def test_the_pins_lie_in_the_packages_ranges():
    pinned = pins()
    for name, wanted in {**OWN, **EXTRAS["dask"]}.items():
        given = pinned[name]
        if name == "torch":  # a range in both, on purpose
            assert given.specifier == wanted.specifier
        else:
            (version,) = given.specifier
            assert version.operator == "==" and version.version in wanted.specifier, name


# --- what CI runs -----------------------------------------------------------------------

WORKFLOWS = sorted((ROOT / ".github" / "workflows").glob("*.yml"))


def test_actions_are_pinned_to_a_commit_and_say_which_version():
    lines = [line for path in WORKFLOWS for line in path.read_text().splitlines()]
    lines = [line for line in lines if "uses:" in line]
    assert len(lines) >= 6
    for line in lines:
        assert re.search(r"uses: [\w./-]+@[0-9a-f]{40}  # v\d+\.\d+\.\d+$", line), line
    pinned = [re.search(r"uses: (\S+)@(\w+)", line).groups() for line in lines]
    assert len({name for name, _ in pinned}) == len(set(pinned)), "one commit for each action"


def test_ci_runs_the_oldest_and_the_newest_of_everything():
    jobs = yaml.safe_load((ROOT / ".github/workflows/ci.yml").read_text())["jobs"]
    assert {"3.11", "3.14"} <= set(jobs["test"]["strategy"]["matrix"]["python"])
    bounds = jobs["bounds"]["strategy"]["matrix"]["include"]
    assert {(b["python"], b["resolution"]) for b in bounds} == {
        ("3.11", "lowest-direct"),
        ("3.14", "highest"),
    }
    text = json.dumps(jobs["bounds"])
    assert "--resolution ${{ matrix.resolution }}" in text and "pytest" in text
