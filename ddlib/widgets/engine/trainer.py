"""The whole experiment in the page: trajectories, recording, a window network and its inertia."""

from __future__ import annotations

import numpy as np
import traitlets as t
from scipy.spatial import ConvexHull

from ddlib._check import instance, integer, number, one_of, shaped
from ddlib.analysis import CLASSES, basis
from ddlib.figures import JOINTS
from ddlib.learning import (
    TARGET_RANGE,
    Scaler,
    TorqueModel,
    TrainingSet,
    Weights,
    cases,
    default_rate,
    surrogate,
)
from ddlib.learning.windows import check_width
from ddlib.paper import HIDDEN_UNITS
from ddlib.setups import INITIAL, JOINT_DAMPING, Setup
from ddlib.simulation import LOG_STEP
from ddlib.trajectories import APPENDIX_I, MAX_EXTENT_DEG
from ddlib.widgets.base import PageWidget
from ddlib.widgets.engine._plain import loop, plant, weights_of
from ddlib.widgets.parts.panels import Panel
from ddlib.widgets.picker import _pad, _parameters
from ddlib.widgets.scripts import bundle, styles
from ddlib.widgets.still import still_picture

# By these a page trains unless it says otherwise, and so does the study of what its readers see.
WIDTH = 21  # samples of the window
EVERY = 5  # of the training windows every fifth is learnt from; of trajectory 6 all count
EPOCHS = 2000  # of a run
CHECK = 5  # epochs between two looks at errors and shapes
LEVEL = 0.2  # RMSS in training below which the error counts as gone
MOMENTUM = 0.98  # acceleration
SHIFTS = 5  # draws of torques shifted in time

_FINEST = 5e-5  # step of the encoder, rad: readings are sent as int16
_SCALINGS = {"centred": (-1.0, 1.0), "printed": (0.0, 1.0)}  # ranges of the inputs
_STEPS = (0.25, 0.5, 1.0, 2.0, 4.0)  # step sizes, over `ddlib.learning.default_rate`
_MOMENTA = (0.0, 0.5, 0.9, 0.95, 0.98, 0.995)
_SEEDS = 50  # sets of initial weights that can be chosen
_SEED, _INPUTS, _STEP = 1, "printed", 1.0  # choices at the start
_ERRORS = (0.03, 2.0)  # range of the errors shown

_CHOICES = ("extents_deg", "seed", "inputs", "shifted", "step_size", "momentum")
_NUMBERS = ("error", "training_error", "inertia")

CODE = """\
from dataclasses import replace

from ddlib.analysis import gains, mean_gradient
from ddlib.learning import TrainingSet, cases, surrogate, train_ensemble
from ddlib.setups import JOINT_DAMPING, split
from ddlib.widgets.engine import trainer

extents_deg, shifted = {extents}, {shifted}
training, test = split(JOINT_DAMPING.record(extents_deg))  # or your own set-up
windows, torque = cases(training, {width})
if shifted is not None:
    torque = surrogate("shifted", training.tau[:, training.motion], shifted)
    torque = torque.reshape(-1, 2)
data = TrainingSet.from_arrays(windows, torque, scaling={scaling})
data = replace(data, x=data.x[::5], y=data.y[::5])
start = trainer.first_weights({seed}, {width}, {hidden})
how = dict(rate={rate}, momentum={momentum}, epochs={epochs})
test_set = data.transform(*cases(test, {width}))
model, history, _ = train_ensemble(start, data, test=test_set, **how)
print(history.training[-1, 0], history.test[-1, 0])
inertia = gains(mean_gradient(model, windows[::5]), training.step)[0, 0, 0, 2]
print(f"inertia in the network: {inertia:.1f} kg m²")"""
"""What *Code* copies, with the reader's choices."""

_HINT = (
    "Your browser trains a network with {hidden} hidden units on every fifth window of {width} "
    "positions. The error on trajectory {last} counts all windows. If you change the trajectories, "
    "the page records them anew with the same controller, friction, encoder and torque noise."
)


def first_weights(seed: int, width: int = WIDTH, hidden: int = HIDDEN_UNITS) -> Weights:
    """The page's random initial weights, as an ensemble of one network.

    Parameters
    ----------
    seed : int
        0 to 2**32 - 1, of the generator mulberry32.
    width, hidden : int
        Samples of the window; hidden units.
    """
    state, joints = integer("seed", seed, 0, 2**32 - 1), len(JOINTS)
    layout = {"hidden": hidden, "outputs": joints, "joints": joints, "width": width}
    draws = np.empty(hidden * (joints * width + 1) + joints * (hidden + joints * width + 1))
    for i in range(draws.size):
        state = (state + 0x6D2B79F5) % 2**32
        draws[i] = INITIAL * (2 * _mixed(state) / 2**32 - 1)
    return weights_of(draws, layout)[None]


def _mixed(state: int) -> int:
    x = ((state ^ state >> 15) * (state | 1)) % 2**32
    x ^= (x + (x ^ x >> 7) * (x | 61)) % 2**32
    return x ^ x >> 14


def _bytes(value, _):
    return bytes(value)


class NetworkTrainer(PageWidget):
    """Record trajectories in the page, train a window network on them, read the inertia in it.

    Errors, torques and the filters of all units are seen on the way. Everything is computed in the
    page, with a kernel and without: by plain descent, on every fifth window to be fast. The inertia
    comes from the mean gradient of the shoulder's torque, the arm's own is the mean of M11 over the
    training windows, and filters are named as by `classify`.

    With a kernel the reader's choices are traits to set, observe and link: a page that shows the
    widget then records and trains anew, up to `epoch`. Until it has, and as long as no page shows
    the widget, the results are None.

    Parameters
    ----------
    setup : Setup
        Arm, effects and PID whose recordings it learns from. The page's engine knows viscous and
        Coulomb friction, saturation, and quantisation, here of 5e-5 rad or more.
    extents_deg : array_like, shape (runs, 2)
        Of four trajectories or more at the start, degrees; the last one is the test. Later settings
        have as many; their largest is `MAX_EXTENT_DEG`, or that of the start if it is larger. In
        training each joint must move by a degree or more. The trait of this name is a choice.
    width, hidden : int
        Samples of the window, odd; hidden units.
    epochs, check : int
        Epochs of a run, and between two looks at errors and shapes.
    level : float
        RMSS in training below which the error counts as gone.
    momentum : float
        Acceleration at the start: 0, 0.5, 0.9, 0.95, 0.98 or 0.995; the trait is a choice.
    shifts : int
        Draws of torques that are shifted in time.
    code : str
        What *Code* copies; ``{extents}``, ``{scaling}``, ``{shifted}``, ``{seed}``, ``{rate}``,
        ``{momentum}``, ``{epochs}``, ``{width}`` and ``{hidden}`` stand for the reader's choices.

    Attributes
    ----------
    seed : int
        Choice: number of the initial weights, 1 to 50, see `first_weights`.
    inputs : str
        Choice: range of the scaled inputs, "printed" for 0 to 1 or "centred" for -1 to 1.
    shifted : bool
        Choice: torques that are shifted in time, so that they do not belong to the motion.
    step_size : float
        Choice: 0.25, 0.5, 1, 2 or 4 times the step size of `default_rate`.
    epoch : int
        Epochs trained so far, 0 to `epochs`. Set it, and the page trains up to it.
    weights : Weights or None
        Result, read only: the network's weights after `epoch` epochs.
    model : TorqueModel or None
        Result, read only: the same network with its scaling, from positions in rad to N m.
    error : float or None
        Result, read only: RMSS on all windows of the last trajectory.
    training_error : float or None
        Result, read only: RMSS on the windows that the page trains on, every fifth one.
    inertia : float or None
        Result, read only: the inertia at the shoulder in the network, kg m².

    Raises
    ------
    traitlets.TraitError
        If a trait is set to a value outside its range.

    Examples
    --------
    Shown in JupyterLab, it tells the error after 400 epochs from other initial weights::

        trainer = NetworkTrainer()
        trainer.observe(lambda change: print(trainer.seed, change["new"]), "error")
        trainer.seed, trainer.epoch = 2, 400
    """

    _parameters = _CHOICES
    _esm = bundle("trainer.js")
    _css = styles("trainer.css")

    positions = t.Bytes(help="the runs' encoder readings, steps as int16", read_only=True)
    positions.tag(sync=True)
    torques = t.Bytes(help="the runs' measured torques, N m as float32", read_only=True)
    torques.tag(sync=True)
    noise = t.Bytes(help="the torque sensor's noise in them, N m as float32", read_only=True)
    noise.tag(sync=True)
    extents_deg = t.Any().tag(sync=True)
    seed = t.Int(_SEED).tag(sync=True)
    inputs = t.Enum(tuple(_SCALINGS), _INPUTS).tag(sync=True)
    shifted = t.Bool(False).tag(sync=True)
    step_size = t.Enum(_STEPS, _STEP).tag(sync=True)
    momentum = t.Enum(_MOMENTA, MOMENTUM).tag(sync=True)
    epoch = t.Int(0).tag(sync=True)
    reached = t.Dict(help="the page's last results, and the choices behind them", read_only=True)
    reached.tag(sync=True)
    weight_bytes = t.Bytes(help="the page's last weights as float64", read_only=True)
    weight_bytes.tag(sync=True, from_json=_bytes)
    weights = t.Instance(Weights, allow_none=True, read_only=True)
    model = t.Instance(TorqueModel, allow_none=True, read_only=True)
    error = t.Float(None, allow_none=True, read_only=True)
    training_error = t.Float(None, allow_none=True, read_only=True)
    inertia = t.Float(None, allow_none=True, read_only=True)

    def __init__(
        self,
        setup: Setup = JOINT_DAMPING,
        extents_deg=APPENDIX_I,
        *,
        width: int = WIDTH,
        hidden: int = HIDDEN_UNITS,
        epochs: int = EPOCHS,
        check: int = CHECK,
        level: float = LEVEL,
        momentum: float = MOMENTUM,
        shifts: int = SHIFTS,
        code: str = CODE,
    ):
        instance("setup", setup, Setup)
        one_of("momentum", momentum, _MOMENTA)
        check_width(width)
        integer("hidden", hidden, 1)
        extents = shaped("extents_deg", extents_deg, "(runs, 2)")
        if len(extents) < 4:
            raise ValueError(
                "extents_deg must be 4 pairs or more, three to train on and the last one to test, "
                f"got {len(extents)}"
            )
        if extents.min() < 0:
            raise ValueError(f"extents_deg must not be negative, got {extents.min():g}")
        widest = max(MAX_EXTENT_DEG, float(np.ceil(extents.max())))
        step = plant(setup.arm, setup.effects)["encoder"]
        if step < _FINEST:
            raise ValueError(f"setup.effects.encoder must round to {_FINEST} rad or more")
        recording = setup.record(extents)
        training, test = recording[:-1], recording[-1]
        motion, half, last = recording.motion, width // 2, len(extents)
        seen = recording.q[:, motion.start - half : motion.stop + half]
        torque = recording.tau[:, motion]
        samples = torque.shape[1]
        place = np.arange(samples)[None, :, None] * np.ones((len(training.q), 1, 2))
        shifted = [surrogate("shifted", place, k)[:, 0, 0].astype(int) for k in range(shifts)]
        looks = np.maximum(1, np.arange(0, epochs + 1, check))
        panels, ranges = _charts(looks, np.arange(samples) * recording.step, test.tau[motion], last)
        spec = {
            "title": "Train a network",
            "hint": _HINT.format(hidden=hidden, width=width, last=last),
            "code": code,
            "layout": {
                "hidden": hidden,
                "outputs": len(JOINTS),
                "joints": len(JOINTS),
                "width": width,
            },
            "runs": len(recording.q),
            "samples": samples,
            "every": EVERY,
            "encoder": step,
            "ranges": {name: list(pair) for name, pair in _SCALINGS.items()},
            "target": list(TARGET_RANGE),
            "loop": loop(setup, recording),
            "extents": extents.tolist(),
            "home": "Appendix I" if np.array_equal(extents, APPENDIX_I) else "As given",
            "most": widest,
            "shifts": [shift.tolist() for shift in shifted],
            "initial": INITIAL,
            "seeds": _SEEDS,
            "rate": default_rate(width),
            "steps": list(_STEPS),
            "momenta": list(_MOMENTA),
            "start": {"seed": _SEED, "inputs": _INPUTS, "step": _STEP, "momentum": momentum},
            "epochs": epochs,
            "check": check,
            "level": level,
            "basis": basis(width).tolist(),
            "classes": list(CLASSES),
            "panels": [panel.description() for panel in panels],
            "curves": [
                {"name": name, "low": low, "high": high} for name, (low, high) in ranges.items()
            ],
        }
        still, alt = _still(panels[1:], training, test, extents, width, hidden)
        self._keep(
            spec=spec,
            positions=np.round(seen / step).astype("<i2").tobytes(),
            torques=torque.astype("<f4").tobytes(),
            noise=(torque - recording.tau_true[:, motion]).astype("<f4").tobytes(),
            still=still,
            still_alt=alt,
        )
        super().__init__(extents_deg=extents.tolist(), momentum=momentum)
        self.observe(self._follow, [*_CHOICES, "epoch", "reached"])

    @t.validate("extents_deg")
    def _check_extents(self, proposal):
        runs, most = self.spec["runs"], self.spec["most"]
        try:
            extents = shaped("extents_deg", proposal["value"], (runs, 2))
            low, high = extents.min(), extents.max()
            if low < 0 or high > most:
                raise ValueError(
                    f"extents_deg must lie in [0, {most:g}] degrees, got {low:g} to {high:g}"
                )
            for joint, largest in zip(JOINTS, extents[:-1].max(0)):
                number(f"largest training extent of the {joint} in extents_deg", largest, 1.0)
        except (TypeError, ValueError) as error:
            raise t.TraitError(str(error)) from None
        return tuple(map(tuple, extents.tolist()))

    @t.validate("seed", "epoch")
    def _check_whole(self, proposal):
        name = proposal["trait"].name
        low, high = {"seed": (1, _SEEDS), "epoch": (0, self.spec["epochs"])}[name]
        try:
            return integer(name, proposal["value"], low, high)
        except ValueError as error:
            raise t.TraitError(str(error)) from None

    def _follow(self, _=None):
        """Results belong to the choices and the epoch as they stand, or there are none."""
        reached = self.reached
        choices = {name: getattr(self, name) for name in (*_CHOICES, "epoch")}
        choices["extents_deg"] = [list(pair) for pair in self.extents_deg]
        results = dict.fromkeys(("weights", "model", *_NUMBERS))
        if reached and all(reached[name] == value for name, value in choices.items()):
            results |= {name: reached[name] for name in _NUMBERS}
            numbers = np.frombuffer(self.weight_bytes, "<f8")
            results["weights"] = weights = weights_of(numbers, self.spec["layout"])
            scaling = reached["scaling"]
            ranges = _SCALINGS[self.inputs], TARGET_RANGE
            pair = (_scaler(scaling[name], to) for name, to in zip(("inputs", "outputs"), ranges))
            results["model"] = TorqueModel(weights, *pair, LOG_STEP)
        with self.hold_trait_notifications():
            self._keep(**results)


def _scaler(scaling: dict, target) -> Scaler:
    """A scaling as the page has it: from `low` on, with a gain."""
    low = np.array(scaling["low"])
    return Scaler(low, low + (target[1] - target[0]) / np.array(scaling["gain"]), tuple(target))


def _charts(epochs, time, torque, last: int) -> tuple[list[Panel], dict]:
    """Charts of the errors and of the torques on the test run, and the ranges of their curves."""
    errors = {"training": "training", "test": f"trajectory {last}"}
    panels = [Panel("Error, RMSS", errors, "epoch", epochs, "log", "log", y_range=_ERRORS)]
    ranges = dict.fromkeys(errors, _ERRORS)
    for joint, most in zip(JOINTS, (1.15 * np.abs(torque).max(0)).tolist()):
        lines = {f"{joint} network": "network", f"{joint} true": "measured"}
        title = f"{joint.title()} torque on trajectory {last}, N m"
        ends = f"{joint} low", f"{joint} high"  # of the run as it stands
        panels.append(Panel(title, lines, "time, s", time, y_range=ends))
        ranges |= dict.fromkeys(lines, (-most, most))
    return panels, ranges


def _still(panels, training, test, extents, width, hidden) -> tuple[str, str]:
    """The trajectories, the torques to be learnt, and what an untrained network makes of them."""
    data = TrainingSet.from_recording(training, width, scaling=_SCALINGS[_INPUTS])
    windows, torque = cases(test, width)
    model = TorqueModel(first_weights(_SEED, width, hidden)[0], data.inputs, data.outputs)
    predicted = model.torque(windows)
    curves = {}
    for j, joint in enumerate(JOINTS):
        curves |= {f"{joint} network": predicted[:, j], f"{joint} true": torque[:, j]}
        most = 1.15 * np.abs(torque[:, j]).max(keepdims=True)
        curves |= {f"{joint} low": -most, f"{joint} high": most}
    last = len(extents)
    alt = (
        f"The square of shoulder and elbow extents with the {last} trajectories. Beside it the "
        f"measured torques of both joints on trajectory {last}, and what a "
        "network with random weights makes of the positions, before the reader has trained it."
    )
    pad = _pad(extents, ConvexHull(extents[:-1], qhull_options="QJ"))  # they may be in line
    chosen = {
        p.name: p for p in _parameters(extents[-1].tolist(), max(MAX_EXTENT_DEG, extents.max()))
    }
    return still_picture(curves, panels, chosen, pad, alt), alt
