"""What needs no PyTorch works without it, and what does says how to get it."""

import subprocess
import sys

BLOCK = """
import sys

class NoTorch:
    @staticmethod
    def find_spec(name, path=None, target=None):
        if name.partition(".")[0] == "torch":
            raise ModuleNotFoundError("No module named 'torch'", name="torch")

sys.meta_path.insert(0, NoTorch)  # scipy stumbles over a None in sys.modules
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


def run(code: str) -> tuple[str, str]:
    command = [sys.executable, "-W", "error", "-c", BLOCK + code]
    answer = subprocess.run(command, capture_output=True, text=True)
    return answer.stdout, answer.stderr


def test_recordings_least_squares_figures_and_widgets_need_no_torch():
    assert run(USED) == ("fine\n", "")


def test_what_needs_torch_names_the_way_to_get_it():
    out, error = run(REFUSED)
    lines = out.splitlines()
    assert error == "" and len(lines) == 5, error
    names = ("train_ensemble", "solve", "WindowNetwork", "TorqueNetwork")
    for line, name in zip(lines, names):
        assert line == f'ddlib.learning.{name} needs PyTorch: pip install "ddlib[learning]"'
    assert lines[4].endswith('pip install "ddlib[learning]"')
