"""The package from its wheel, in an empty folder: whole, without the book, mostly without torch."""

import shutil
import subprocess
import sys
import zipfile

import pytest
from book_pages import ROOT

SOURCES = ("ddlib", "pyproject.toml", "README.md", "LICENSE", "LICENSE-CC-BY-4.0")
WITHOUT_TORCH = (
    *("dynamics", "effects", "control", "simulation", "identification", "analysis"),
    *("figures", "widgets", "trajectories", "metrics", "tables", "paper", "_check", "_files"),
)

BLOCK = """
class NoTorch:
    @staticmethod
    def find_spec(name, path=None, target=None):
        if name.partition(".")[0] == "torch":
            raise ModuleNotFoundError("No module named 'torch'", name="torch")

sys.meta_path.insert(0, NoTorch)  # scipy stumbles over a None in sys.modules
"""

IMPORT = """
import importlib, pkgutil, ddlib
sys.modules["resource"] = None  # as on Windows: an import fails
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
assert tried > 30 and not failed, failed
"""

USED = """
import tempfile
from pathlib import Path

import numpy as np

from ddlib import (
    POSITION_FEEDBACK, TorqueModel, TrainingSet, Weights, by_modulation, cases, figures, gains,
    least_squares, sliding_windows, split, widgets,
)
from ddlib.analysis import mean_gradient, ridge_filters
from ddlib.learning import surrogate
from ddlib.setups import errors

training, test = split(POSITION_FEEDBACK.record())
least_squares(by_modulation(training))
windows = sliding_windows(training.q, 21, training.motion)
data = TrainingSet.from_recording(training, 21)
filters = gains(ridge_filters(data, [1e-6]), data.step)
model = TorqueModel(Weights.random(2, 21), data.inputs, data.outputs, data.step)
assert mean_gradient(model, cases(test, 21)[0]).shape == (2, 2, 2, 21)
assert mean_gradient(model.torque, cases(test, 21)[0][:9]).shape == (2, 2, 2, 21)
surrogate("shifted", training.tau[:, training.motion], 0)
picture = figures.hinton(model.weights[0])
with tempfile.TemporaryDirectory() as folder:
    for suffix in ("svg", "png", "pdf"):
        picture.save(Path(folder) / f"weights.{suffix}")
widgets.TrajectoryPicker()
widgets.RealArmSwitches()
assert "torch" not in sys.modules
print("fine")
"""

REFUSED = """
import ddlib, ddlib.learning
from ddlib.learning import Scaler, TorqueModel, Weights

def of(call):
    try:
        call()
    except ImportError as error:
        print(error)

model = TorqueModel(Weights.random(1, 5), Scaler([0, 0], [1, 1]), Scaler([0, 0], [1, 1]))
of(lambda: ddlib.train_ensemble)
of(lambda: ddlib.learning.solve)
of(lambda: exec("from ddlib import WindowNetwork"))
of(model.module)
setup = ddlib.STATE_FEEDBACK
of(lambda: ddlib.setups.train_windows(setup, setup.record(), 11, 1))
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
    packed = {path.relative_to(site) for path in (site / "ddlib").rglob("*") if path.is_file()}
    own = {path.relative_to(ROOT) for path in (ROOT / "ddlib").rglob("*") if path.is_file()}
    assert {path for path in own if "__pycache__" not in path.parts} == packed
    licences = {path.name for path in site.glob("*.dist-info/licenses/*")}
    assert licences == {path.name for path in ROOT.glob("LICENSE*")}  # one names the other


def run(site, *codes: str) -> str:
    """What code prints that sees the wheel alone."""
    start = f"import sys; sys.path.insert(0, {str(site)!r})"
    command = [sys.executable, "-W", "error", "-I", "-c", "\n".join([start, *codes])]
    answer = subprocess.run(command, cwd=site.parent, capture_output=True, text=True)
    assert answer.returncode == 0 and not answer.stderr, answer.stderr
    return answer.stdout


def test_every_module_can_be_imported(site):
    place = f"assert ddlib.__file__ == {str(site / 'ddlib' / '__init__.py')!r}"
    run(site, "packages = ()", IMPORT, place)


def test_what_needs_no_torch_works_without_it(site):
    """Modules of most rooms; recordings, least squares, figures and widgets."""
    assert run(site, BLOCK, f"packages = {WITHOUT_TORCH}", IMPORT, USED) == "fine\n"


def test_what_needs_torch_names_the_way_to_get_it(site):
    *names, of_setups = run(site, BLOCK, REFUSED).splitlines()
    way = 'needs PyTorch: pip install "direct-drive-arm[learning]"'
    kinds = ("train_ensemble", "solve", "WindowNetwork", "TorqueNetwork")
    assert names == [f"ddlib.learning.{name} {way}" for name in kinds]
    assert of_setups.endswith('pip install "direct-drive-arm[learning]"')
