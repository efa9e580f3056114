"""The whole experiment in the page: trajectories, recording, a window network and its inertia."""

from __future__ import annotations

import numpy as np
import traitlets as t
from scipy.spatial import ConvexHull

from ddlib._check import integer, one_of
from ddlib.analysis import CLASSES, basis
from ddlib.figures import JOINTS
from ddlib.learning import (
    TARGET_RANGE,
    TorqueModel,
    TrainingSet,
    Weights,
    cases,
    default_rate,
    surrogate,
)
from ddlib.paper import HIDDEN_UNITS, TEST_TRAJECTORY
from ddlib.setups import INITIAL, JOINT_DAMPING, split
from ddlib.simulation import LOG_STEP
from ddlib.trajectories import APPENDIX_I, MAX_EXTENT_DEG
from ddlib.widgets._baking.still import still_picture
from ddlib.widgets.base import SCRIPT, STYLE, _PageWidget, module
from ddlib.widgets.engine._plain import _FIELDS, _TRAINING, ENGINE, lean, loop
from ddlib.widgets.parts.panels import Panel
from ddlib.widgets.picker import _pad, _parameters

_WIDTH = 21  # samples of the window
_EVERY = 5  # of the training windows the page shows every fifth; of trajectory 6 all
_SCALINGS = {"centred": (-1.0, 1.0), "printed": (0.0, 1.0)}  # ranges of the inputs
_STEPS = (0.25, 0.5, 1.0, 2.0, 4.0)  # step sizes, over `ddlib.learning.default_rate`
_MOMENTA = (0.0, 0.5, 0.9, 0.95, 0.98, 0.995)
_ERRORS = (0.03, 2.0)  # range of the errors shown

_HINT = (
    "A network with ten hidden units learns the torques of both joints from windows of 21 "
    "positions, by the descent of this chapter, in your browser. For speed it sees every fifth "
    "window of the five training runs; its error on trajectory 6 is over all. Other trajectories "
    "are recorded here, too, with the same controller, friction and encoder; the torque sensor "
    "repeats its noise. The inertia is the gain on acceleration of the mean gradient of the "
    "shoulder's torque, over the training windows; the arm's is their mean M₁₁. Shifted torques "
    "have nothing to do with the motion. A filter's name follows the rule of the chapter on "
    "convolution filters."
)


def first_weights(seed: int) -> Weights:
    """The page's random initial weights, as an ensemble of one network.

    Parameters
    ----------
    seed : int
        0 to 2**32 - 1, of the generator mulberry32.
    """
    state = integer("seed", seed, 0, 2**32 - 1)
    width, joints = _WIDTH, len(JOINTS)
    shapes = {
        "hidden_weights": (HIDDEN_UNITS, joints, width),
        "hidden_bias": (HIDDEN_UNITS,),
        "output_weights": (joints, HIDDEN_UNITS),
        "direct_weights": (joints, joints, width),
        "output_bias": (joints,),
    }
    parts = {}
    for name in _FIELDS:
        draws = np.empty(int(np.prod(shapes[name])))
        for i in range(draws.size):
            state = (state + 0x6D2B79F5) % 2**32
            draws[i] = INITIAL * (2 * _mixed(state) / 2**32 - 1)
        parts[name] = draws.reshape(1, *shapes[name])
    return Weights(**parts)


def _mixed(state: int) -> int:
    x = ((state ^ state >> 15) * (state | 1)) % 2**32
    x ^= (x + (x ^ x >> 7) * (x | 61)) % 2**32
    return x ^ x >> 14


class NetworkTrainer(_PageWidget):
    """Record trajectories in the page, train a window network on them, read the inertia in it.

    Errors, torques and the filters of all units are seen on the way. Everything is computed in the
    page, with a kernel and without.

    Parameters
    ----------
    epochs, check : int
        Epochs of a run, and between two looks at errors and shapes.
    level : float
        RMSS in training below which the error counts as gone.
    momentum : float
        Acceleration at the start: 0, 0.5, 0.9, 0.95, 0.98 or 0.995.
    shifts : int
        Draws of torques that are shifted in time.
    code : str
        What *Code* copies; ``{extents}``, ``{scaling}``, ``{shifted}``, ``{seed}``, ``{rate}``,
        ``{momentum}`` and ``{epochs}`` stand for the reader's choices.
    """

    _esm = lean(
        module(*(name for name in SCRIPT if name not in ("controls.js", "curves.js")))
        + module(*ENGINE, _TRAINING, "canvas.js", "experiment.js", "trainer.js")
    )
    _css = module(*STYLE, "trainer.css")

    positions = t.Bytes(help="the runs' encoder readings, steps as int16", read_only=True)
    positions.tag(sync=True)
    torques = t.Bytes(help="the runs' measured torques, N m as float32", read_only=True)
    torques.tag(sync=True)
    noise = t.Bytes(help="the torque sensor's noise in them, N m as float32", read_only=True)
    noise.tag(sync=True)

    def __init__(
        self,
        *,
        epochs: int = 2000,
        check: int = 5,
        level: float = 0.2,
        momentum: float = 0.98,
        shifts: int = 5,
        code: str = "",
    ):
        one_of("momentum", momentum, _MOMENTA)
        recording = JOINT_DAMPING.record()
        training, test = split(recording)
        motion, half = recording.motion, _WIDTH // 2
        (encoder,) = JOINT_DAMPING.effects.encoder
        seen = recording.q[:, motion.start - half : motion.stop + half]
        torque = recording.tau[:, motion]
        samples = torque.shape[1]
        place = np.arange(samples)[None, :, None] * np.ones((len(training.q), 1, 2))
        shifted = [surrogate("shifted", place, k)[:, 0, 0].astype(int) for k in range(shifts)]
        looks = np.maximum(1, np.arange(0, epochs + 1, check))
        panels, ranges = _charts(looks, np.arange(samples) * LOG_STEP, test.tau[motion])
        spec = {
            "title": "Train a network",
            "hint": _HINT,
            "code": code,
            "layout": {
                "hidden": HIDDEN_UNITS,
                "outputs": len(JOINTS),
                "joints": len(JOINTS),
                "width": _WIDTH,
            },
            "runs": len(recording.q),
            "samples": samples,
            "every": _EVERY,
            "encoder": encoder.step,
            "ranges": {name: list(pair) for name, pair in _SCALINGS.items()},
            "target": list(TARGET_RANGE),
            "loop": loop(JOINT_DAMPING, recording),
            "extents": APPENDIX_I.tolist(),
            "most": MAX_EXTENT_DEG,
            "shifts": [shift.tolist() for shift in shifted],
            "initial": INITIAL,
            "rate": default_rate(_WIDTH),
            "steps": list(_STEPS),
            "momenta": list(_MOMENTA),
            "momentum": momentum,
            "epochs": epochs,
            "check": check,
            "level": level,
            "basis": basis(_WIDTH).tolist(),
            "classes": list(CLASSES),
            "panels": [panel.description() for panel in panels],
            "curves": [
                {"name": name, "low": low, "high": high} for name, (low, high) in ranges.items()
            ],
        }
        still, alt = _still(panels[1:], training, test)
        self._keep(
            spec=spec,
            positions=np.round(seen / encoder.step).astype("<i2").tobytes(),
            torques=torque.astype("<f4").tobytes(),
            noise=(torque - recording.tau_true[:, motion]).astype("<f4").tobytes(),
            still=still,
            still_alt=alt,
        )
        super().__init__()


def _charts(epochs, time, torque) -> tuple[list[Panel], dict]:
    """Charts of the errors and of the torques on the test run, and the ranges of their curves."""
    errors = {"training": "training", "test": f"trajectory {TEST_TRAJECTORY}"}
    panels = [Panel("Error, RMSS", errors, "epoch", epochs, "log", "log", y_range=_ERRORS)]
    ranges = dict.fromkeys(errors, _ERRORS)
    for joint, most in zip(JOINTS, (1.15 * np.abs(torque).max(0)).tolist()):
        lines = {f"{joint} network": "network", f"{joint} true": "measured"}
        title = f"{joint.title()} torque on trajectory {TEST_TRAJECTORY}, N m"
        ends = f"{joint} low", f"{joint} high"  # of the run as it stands
        panels.append(Panel(title, lines, "time, s", time, y_range=ends))
        ranges |= dict.fromkeys(lines, (-most, most))
    return panels, ranges


def _still(panels, training, test) -> tuple[str, str]:
    """The trajectories, the torques to be learnt, and what an untrained network makes of them."""
    data = TrainingSet.from_recording(training, _WIDTH, scaling=_SCALINGS["centred"])
    windows, torque = cases(test, _WIDTH)
    model = TorqueModel(first_weights(1)[0], data.inputs, data.outputs)
    told = model.torque(windows)
    curves = {}
    for j, joint in enumerate(JOINTS):
        curves |= {f"{joint} network": told[:, j], f"{joint} true": torque[:, j]}
        most = 1.15 * np.abs(torque[:, j]).max(keepdims=True)
        curves |= {f"{joint} low": -most, f"{joint} high": most}
    alt = (
        "The square of shoulder and elbow extents with the six trajectories of Appendix I. Beside "
        f"it the measured torques of both joints on trajectory {TEST_TRAJECTORY}, and what a "
        "network with random weights makes of the positions, before the reader has trained it."
    )
    pad = _pad(APPENDIX_I, ConvexHull(APPENDIX_I[:-1]))
    extents = {p.name: p for p in _parameters(APPENDIX_I[-1].tolist())}
    return still_picture(curves, panels, extents, pad, alt), alt
