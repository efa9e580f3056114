"""The package from its wheel, in an empty folder: whole, without the book, mostly without torch."""

import shutil
import subprocess
import sys
import zipfile

import pytest
from book_pages import ROOT

SOURCES = ("ddlib", "pyproject.toml", "README.md", "LICENSE")
WITHOUT_TORCH = (
    *("dynamics", "effects", "control", "simulation", "identification", "analysis"),
    *("figures", "widgets", "trajectories", "metrics", "tables", "paper", "_check", "_files"),
)

IMPORT = """
import importlib, pkgutil, sys
sys.path.insert(0, sys.argv[1])
sys.modules["resource"] = None  # as on Windows: an import fails
packages = sys.argv[2:]

class NoTorch:
    @staticmethod
    def find_spec(name, path=None, target=None):
        if name.partition(".")[0] == "torch":
            raise ImportError("torch is blocked")

if packages:
    sys.meta_path.insert(0, NoTorch)  # scipy stumbles over a None in sys.modules
import ddlib
failed, tried = [], 0
for module in pkgutil.walk_packages(ddlib.__path__, "ddlib."):
    if packages and module.name.split(".")[1] not in packages:
        continue
    try:
        loaded = importlib.import_module(module.name)
        [getattr(loaded, name) for name in getattr(loaded, "__all__", ())]
        tried += 1
    except Exception as error:
        failed.append(f"{module.name}: {error!r}")
print(ddlib.__file__, tried, *failed, sep="\\n")
"""


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """An empty folder into which the wheel is unpacked."""
    tree, site = (tmp_path_factory.mktemp(name) for name in ("tree", "site"))
    for name in SOURCES:
        copy = shutil.copytree if (ROOT / name).is_dir() else shutil.copy
        copy(ROOT / name, tree / name)
    build = "from setuptools.build_meta import build_wheel; build_wheel('.')"
    built = subprocess.run([sys.executable, "-c", build], cwd=tree, capture_output=True, text=True)
    assert built.returncode == 0, built.stderr
    (wheel,) = tree.glob("*.whl")
    with zipfile.ZipFile(wheel) as content:
        content.extractall(site)
    return site


def test_every_file_of_the_package_is_in_the_wheel(site):
    kept = {path.relative_to(site) for path in (site / "ddlib").rglob("*") if path.is_file()}
    own = {path.relative_to(ROOT) for path in (ROOT / "ddlib").rglob("*") if path.is_file()}
    assert {path for path in own if "__pycache__" not in path.parts} == kept


@pytest.mark.parametrize("packages", [WITHOUT_TORCH, ()], ids=["no torch", "every module"])
def test_modules_import_from_the_wheel(packages, site):
    command = [sys.executable, "-W", "error", "-I", "-c", IMPORT, str(site), *packages]
    answer = subprocess.run(command, cwd=site.parent, capture_output=True, text=True)
    assert answer.returncode == 0, answer.stderr
    place, count, *failed = answer.stdout.splitlines()
    assert place == str(site / "ddlib" / "__init__.py")
    assert int(count) > 30 and not failed, "\n".join(failed)
