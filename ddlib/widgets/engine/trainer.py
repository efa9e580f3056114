"""A window network that the reader trains in the page, from random weights."""

from __future__ import annotations

import anywidget
import numpy as np
import traitlets as t

from ddlib._check import integer
from ddlib.analysis import CLASSES, basis
from ddlib.experiments import JOINT_DAMPING, split
from ddlib.experiments.setups import INITIAL
from ddlib.experiments.studies.page import training as page
from ddlib.figures import JOINTS
from ddlib.learning import TorqueModel, TrainingSet, Weights, default_rate, surrogate
from ddlib.paper import HIDDEN_UNITS, TEST_TRAJECTORY
from ddlib.simulation import LOG_STEP
from ddlib.widgets.baking.still import Still, still_picture
from ddlib.widgets.base import SCRIPT, STYLE, module
from ddlib.widgets.engine.plain import ENGINE, FIELDS, TRAINING, lean
from ddlib.widgets.parts.panels import Panel

SCALINGS = {"centred": (-1.0, 1.0), "printed": (0.0, 1.0)}
"""Ranges of the inputs that can be chosen."""

STEPS = (0.25, 0.5, 1.0, 2.0, 4.0)
"""Step sizes, relative to `ddlib.learning.training.default_rate`."""

MOMENTA = (0.0, 0.5, 0.9, 0.95, 0.98, 0.995)

HINT = (
    "A network with ten hidden units learns the torques of both joints from windows of 21 "
    "positions, by the descent of this chapter, in your browser. For speed it sees every fifth "
    "window of the five training runs; its error on trajectory 6 is over all. Shifted torques "
    "have nothing to do with the motion: what shapes they give, any smooth target gives. A "
    "filter's name follows the rule of the chapter on convolution filters."
)


def first_weights(seed: int) -> Weights:
    """The page's random initial weights, as an ensemble of one network.

    Parameters
    ----------
    seed : int
        0 to 2**32 - 1; the draws are those of the generator mulberry32.
    """
    state = integer("seed", seed, 0, 2**32 - 1)
    width, joints = page.WIDTH, len(JOINTS)
    shapes = {
        "hidden_weights": (HIDDEN_UNITS, joints, width),
        "hidden_bias": (HIDDEN_UNITS,),
        "output_weights": (joints, HIDDEN_UNITS),
        "direct_weights": (joints, joints, width),
        "output_bias": (joints,),
    }
    parts = {}
    for name in FIELDS:
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


def training_set(inputs: str = "centred", shifted: int | None = None) -> tuple[TrainingSet, tuple]:
    """What the page trains on, and the scaled windows and torques of trajectory 6.

    Parameters
    ----------
    inputs : {"centred", "printed"}
    shifted : int, optional
        Draw of shifted torques, 0 to 4; default: the arm's own.
    """
    return page.page_set(SCALINGS[inputs], shifted)


class NetworkTrainer(anywidget.AnyWidget):
    """Train a window network in the page: errors, torques and the filters of all units.

    Everything is computed in the page, with a kernel and without.
    """

    _esm = lean(
        module(*(name for name in SCRIPT if name not in ("controls.js", "curves.js")))
        + module(*ENGINE, TRAINING, "trainer.js")
    )
    _css = module(*STYLE, "trainer.css")

    spec = t.Dict(help="layout, scaling, choices", read_only=True).tag(sync=True)
    positions = t.Bytes(help="the runs' encoder readings, steps as int16", read_only=True)
    positions.tag(sync=True)
    torques = t.Bytes(help="the runs' measured torques, N m as float32", read_only=True)
    torques.tag(sync=True)
    still = Still(help="the torque to be learnt as a picture", read_only=True).tag(sync=True)
    still_alt = t.Unicode(read_only=True).tag(sync=True)

    def __init__(self):
        recording = JOINT_DAMPING.record()
        test = split(recording)[1]
        motion, half = recording.motion, page.WIDTH // 2
        (encoder,) = JOINT_DAMPING.effects.encoder
        seen = recording.q[:, motion.start - half : motion.stop + half]
        counts = np.round(seen / encoder.step)
        torque = recording.tau[:, motion]
        plain, _ = training_set("printed")
        place = np.arange(torque.shape[1])[None, :, None] * np.ones((len(recording.q) - 1, 1, 2))
        shifts = [surrogate("shifted", place, k)[:, 0, 0].astype(int) for k in range(page.SHIFTS)]
        time = np.arange(torque.shape[1]) * LOG_STEP
        epochs = np.maximum(1, np.arange(0, page.EPOCHS + 1, page.CHECK))
        most = 1.15 * np.abs(test.tau[motion]).max(0)
        panels = [
            Panel(
                "Error, RMSS",
                {"training": "training", "test": "trajectory 6"},
                "epoch",
                epochs,
                "log",
                "log",
                y_range=(0.03, 2.0),
            )
        ]
        names = []
        for j, joint in enumerate(JOINTS):
            lines = {f"{joint} network": "network", f"{joint} true": "measured"}
            title = f"{joint.title()} torque on trajectory {TEST_TRAJECTORY}, N m"
            panels.append(
                Panel(title, lines, "time, s", time, y_range=(-float(most[j]), float(most[j])))
            )
            names += [{"name": n, "low": -float(most[j]), "high": float(most[j])} for n in lines]
        self.set_trait(
            "spec",
            {
                "title": "Train a network",
                "hint": HINT,
                "layout": {
                    "hidden": HIDDEN_UNITS,
                    "outputs": len(JOINTS),
                    "joints": len(JOINTS),
                    "width": page.WIDTH,
                },
                "runs": len(recording.q),
                "samples": len(place[0]),
                "every": page.EVERY,
                "encoder": encoder.step,
                "inputs": {
                    "low": plain.inputs.low.tolist(),
                    "gain": plain.inputs.gain.tolist(),
                    "ranges": {name: list(pair) for name, pair in SCALINGS.items()},
                },
                "outputs": {
                    "low": plain.outputs.low.tolist(),
                    "gain": plain.outputs.gain.tolist(),
                    "first": float(plain.outputs.target[0]),
                },
                "shifts": [shift.tolist() for shift in shifts],
                "initial": INITIAL,
                "rate": default_rate(page.WIDTH),
                "steps": list(STEPS),
                "momenta": list(MOMENTA),
                "momentum": page.MOMENTUM,
                "epochs": page.EPOCHS,
                "check": page.CHECK,
                "level": page.LEVEL,
                "basis": basis(page.WIDTH).tolist(),
                "classes": list(CLASSES),
                "panels": [panel.description() for panel in panels],
                "curves": [
                    *({"name": name, "low": 0.03, "high": 2.0} for name in ("training", "test")),
                    *names,
                ],
            },
        )
        self.set_trait("positions", counts.astype("<i2").tobytes())
        self.set_trait("torques", torque.astype("<f4").tobytes())
        picture, alt = _still(panels[1:], test.tau[motion], time)
        self.set_trait("still", picture)
        self.set_trait("still_alt", alt)
        super().__init__()


def _still(panels, torque, time) -> tuple[str, str]:
    """The torques to be learnt and what an untrained network makes of them."""
    data, (windows, _) = training_set()
    model = TorqueModel(first_weights(1)[0], data.inputs, data.outputs)
    output = model.weights.activity(windows)[1]
    told = data.outputs.unscale(output)
    curves = {}
    for j, joint in enumerate(JOINTS):
        curves |= {f"{joint} network": told[:, j], f"{joint} true": torque[:, j]}
    alt = (
        f"Measured torques of both joints on trajectory {TEST_TRAJECTORY}, and what a network with "
        "random weights makes of the positions, before the reader has trained it."
    )
    return still_picture(curves, panels, {}, None, alt), alt
