"""The square of trajectories: pick one, watch the arm, compare torques, record it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import lru_cache

import numpy as np
import traitlets as t
from scipy.spatial import ConvexHull

from ddlib._check import finite_array, instance, number, shaped
from ddlib.effects import IDEAL
from ddlib.figures import JOINTS
from ddlib.learning import TorqueModel, sliding_windows
from ddlib.metrics import rmss
from ddlib.setups import STATE_FEEDBACK, Setup
from ddlib.trajectories import APPENDIX_I, MAX_EXTENT_DEG, MOTION_SECONDS, pick_and_place
from ddlib.widgets.base import CurveWidget
from ddlib.widgets.engine._plain import loop, networks, plant
from ddlib.widgets.parts.panels import Mark, Pad, Panel, Scalar
from ddlib.widgets.parts.parameters import Parameter, Presets
from ddlib.widgets.scripts import bundle, styles
from ddlib.widgets.table import Live

_RIGID = "Lagrange-Euler"
_RECORDED = "recorded"

_TIMES = np.linspace(0.0, MOTION_SECONDS, 76)  # where the curves are sampled, s
_AXIS = np.linspace(0.0, MAX_EXTENT_DEG, 31)  # extents at which the map of errors is computed, °
_SHADES = 10  # of the map; both ends are open
_SNAP = 0.035  # a drag that comes so near to a trajectory, as a part of the pad, ends on it

_NOTE = (
    "The simulator records each trajectory, here with perfect sensors. RMSS is the root mean "
    "square error over the standard deviation of the training torques. The shades were computed "
    f"beforehand, at {_AXIS.size} × {_AXIS.size} places."
)

_MOTION = """\
import numpy as np

from ddlib.dynamics import CMU_DD_ARM_II
from ddlib.trajectories import pick_and_place

extents_deg = [{shoulder_deg}, {elbow_deg}]
motion = pick_and_place(extents_deg, np.linspace(0, 3, 301))
torque = CMU_DD_ARM_II.inverse_dynamics(*motion)"""


class _Extents(t.TraitType):
    """Two angles of the square; its errors name the value and the range."""

    default_value = tuple(APPENDIX_I[-1].tolist())

    def validate(self, obj, value):
        try:
            if finite_array("extents_deg", value, 2).ndim != 1:
                raise ValueError(f"extents_deg must have shape (2,), got {np.shape(value)}")
            return tuple(number("extents_deg", x, 0.0, MAX_EXTENT_DEG) for x in value)
        except (TypeError, ValueError) as error:
            raise t.TraitError(str(error)) from None


class _Recorded(t.Any):
    """What was recorded last; who reads it gets a recording of the extents as they stand."""

    def get(self, obj, cls=None):
        if obj._recorded_at != obj.extents_deg:
            obj.record()
        return super().get(obj, cls)


class TrajectoryPicker(CurveWidget):
    """Pick a trajectory of the paper's family; see arm, joint angles and torques; record it.

    The pad is the square of extents from 0 to 45 degrees with the trajectories of the recording.
    The Lagrange-Euler torques are those of the reference motion itself: no controller, no
    friction. With `models` the trajectory is also recorded, without quantisation and noise of
    the sensors, and the networks see the recorded positions. The page computes all of it by the
    live engine; only the map of errors under the pad is computed here. The arm is drawn from above,
    with the paths of its hand in all trajectories of the recording.

    Parameters
    ----------
    models : mapping
        Legend name -> a single trained network.
    setup : Setup
        Arm, effects and controller that record; with `models` the engine must have them, and the
        controller must be a `PID`.
    on_record : callable, optional
        Called with the extents to record them; default ``setup.record``, sensors included. Its
        result is kept in `recording`.
    trajectories_deg : array_like, shape (runs, 2)
        Extents of the recording within the square, degrees; the last one is the test.
    **options
        Passed on to `CurveWidget`.

    Attributes
    ----------
    extents_deg : tuple
        Extents of shoulder and elbow in degrees; starts as the test trajectory.
    recording : object
        What `on_record` returned for the extents as they stand. It is called when the reader
        presses the button, or when this is read and the extents are new.
    numbers : dict
        The numbers beside the pad over the whole square: name -> ndarray, shape
        ``(shoulder, elbow)``, at 31 extents of each joint from 0 to 45 degrees.
    """

    _esm = bundle("picker.js")
    _css = styles("picker.css")

    extents_deg = _Extents()
    arm = t.Dict(help="lengths in m, curves of the joint angles, times in s", read_only=True)
    arm.tag(sync=True)
    loop = t.Dict(help="what the page computes with", read_only=True).tag(sync=True)
    weights = t.Bytes(help="the networks' weights as float32", read_only=True).tag(sync=True)
    map = t.Dict(help="errors of each network over the square", read_only=True).tag(sync=True)
    record_status = t.Dict({"text": "", "count": 0}, read_only=True).tag(sync=True)
    recording = _Recorded(None)
    _recorded_at = None  # the extents that `recording` belongs to

    def __init__(
        self,
        models: Mapping[str, TorqueModel] | None = None,
        setup: Setup = STATE_FEEDBACK,
        on_record: Callable | None = None,
        trajectories_deg=APPENDIX_I,
        **options,
    ):
        instance("setup", setup, Setup)
        if not isinstance(models, Mapping | None):
            raise TypeError(f"models must map names to single networks, got {models!r:.80}")
        models = dict(models or {})
        for name, model in models.items():
            single = isinstance(model, TorqueModel) and model.weights.hidden_bias.ndim == 1
            if not single or name in (_RIGID, _RECORDED):
                raise TypeError(
                    f"models must be single networks by name, got {name}: {model!r:.80}"
                )
        if on_record is not None and not callable(on_record):
            raise TypeError(f"on_record must be callable, got {on_record!r}")
        self._on_record = on_record or setup.record
        family = shaped("trajectories_deg", trajectories_deg, "(runs, 2)")
        if len(family) < 4:
            raise ValueError(
                "trajectories_deg must be 4 pairs or more, three to train on and the last one to "
                f"test, got {len(family)}"
            )
        if family.min() < 0 or family.max() > MAX_EXTENT_DEG:
            raise ValueError(
                f"trajectories_deg must lie from 0 to {MAX_EXTENT_DEG:g} degrees, got "
                f"{family.min():g} to {family.max():g}"
            )
        if np.linalg.matrix_rank(family[:-1] - family[0], tol=1e-3) < 2:
            raise ValueError(
                "trajectories_deg must have training pairs that are not all on one line, as they "
                f"span the hull, got {family[:-1].tolist()!r:.80}"
            )
        curves = _Curves(setup, models, family[:-1])
        square = curves(*(x.ravel() for x in np.meshgrid(_AXIS, _AXIS, indexing="ij")))
        self.numbers = {n: x.reshape(2 * _AXIS.shape) for n, x in square.items() if x.ndim == 1}
        peaks = (Scalar(f"peak {j}", f"Largest {_RIGID} torque, {j}", "N m") for j in JOINTS)
        super().__init__(
            curves.one,
            _parameters(family[-1].tolist()),
            _panels([_RIGID, _RECORDED, *models] if models else [_RIGID]),
            title="Trajectory picker",
            alt="The square of shoulder and elbow extents with the trajectories of a recording; "
            "beside it joint angles and torques of the last one, the test, over 3 seconds.",
            scalars=[*peaks, *(Scalar(f"RMSS, {n}", f"RMSS, {n}", digits=2) for n in models)],
            pad=_pad(family, ConvexHull(family[:-1])),
            note=_NOTE if models else "",
            presets=Presets(
                {
                    str(k): {f"{joint}_deg": x for joint, x in zip(JOINTS, extents)}
                    for k, extents in enumerate(family.tolist(), 1)
                },
                "Trajectory",
            ),
            live=Live(ranges={name: (x.min(), x.max()) for name, x in square.items()}),
            **{"code": _MOTION, **options},
        )
        errors = {name: _shades(self.numbers[f"RMSS, {name}"]) for name in models}
        angles, lengths = [f"{joint} angle" for joint in JOINTS], list(setup.arm.lengths)
        layouts, weights = networks(models.values())
        described = [{"name": name, **layout} for name, layout in zip(models, layouts)]
        self._keep(
            map={"side": _AXIS.size, "errors": errors},
            arm={"lengths": lengths, "angles": angles, "times": _TIMES.tolist()},
            loop={**curves.plain(), "models": described},
            weights=weights,
        )
        self.observe(self._from_parameters, [f"{joint}_deg" for joint in JOINTS])
        self.observe(self._to_parameters, "extents_deg")
        self.on_msg(self._on_message)
        self.extents_deg = family[-1].tolist()

    def record(self):
        """Record the trajectory as it stands; returns and keeps the recording."""
        extents_deg = self.extents_deg
        recording = self._on_record(extents_deg)
        self._recorded_at = extents_deg  # first, as observers read the recording
        self.recording = recording
        angles = " and ".join(f"{x:.1f}°" for x in self.extents_deg)
        self._say(f"Recorded {angles}. Read it from the widget's `recording`.")
        return recording

    def _from_parameters(self, _):
        self.extents_deg = (self.shoulder_deg, self.elbow_deg)

    def _to_parameters(self, _):
        with self.hold_trait_notifications():
            self.shoulder_deg, self.elbow_deg = self.extents_deg

    def _say(self, text):
        count = self.record_status["count"] + 1
        self.set_trait("record_status", {"text": text, "count": count})

    def _on_message(self, _widget, content, _buffers):
        if content.get("type") != "record":
            return
        try:
            self.extents_deg = content["extents_deg"]
            self.record()
        except Exception as error:  # shown in the figure: a comm's handler has no other reader
            self._say(f"Not recorded. {type(error).__name__}: {error}")


def _shades(errors) -> dict:
    """A map: ends of its scale; hundredths of a shade, the shoulder's extents fastest."""
    low, high = np.quantile(errors, (0.02, 0.98))
    shades = 100 * (_SHADES - 1) * (errors.T.ravel() - low) / (high - low)
    return {"low": low, "high": high, "digits": "".join(map(_digits, shades))}


def _digits(value: float) -> str:
    """A number from 0 to 1295, rounded, as two digits to the base of 36."""
    return np.base_repr(min(max(round(value), 0), 36**2 - 1), 36).lower().zfill(2)


def _parameters(start, most=MAX_EXTENT_DEG) -> list[Parameter]:
    return [
        Parameter(f"{joint}_deg", f"{joint.title()} extent", 0, most, x, "°")
        for joint, x in zip(JOINTS, start)
    ]


def _pad(family, hull) -> Pad:
    marks = [
        Mark(x, y, str(k), "test" if k == len(family) else "training")
        for k, (x, y) in enumerate(family.tolist(), 1)
    ]
    corners = family[hull.vertices].tolist()
    label = "hull of the training set"
    return Pad("shoulder_deg", "elbow_deg", marks, corners, label, snap=_SNAP)


def _panels(lines) -> list[Panel]:
    angles = {f"{joint} angle": joint for joint in JOINTS}
    panels = [Panel("Joint angles, °", angles, "time, s", _TIMES)]
    for joint in JOINTS:
        torques = {f"{joint} torque, {line}": line for line in lines}
        title = f"{joint.title()} torque, N m"
        panels.append(Panel(title, torques, "time, s", _TIMES, y_fit=True))
    return panels


class _Curves:
    """All curves of the picker at many extents at once."""

    def __init__(self, setup: Setup, models: Mapping[str, TorqueModel], training):
        silent = setup.effects.without("encoder", "torque_sensor")
        self.setup, self.models = replace(setup, effects=silent), models
        self.one = lru_cache(maxsize=16)(self._one)
        if models:
            training = self.setup.record(training)
            self.loop = loop(self.setup, training)
            # near zero extents a motion's own deviation vanishes: that of the training set
            self.scale = training.tau[:, training.motion].reshape(-1, 2).std(0)
            self.during = training.motion
            every = round(_TIMES[1] / training.step)
            start, stop = training.motion.start, training.motion.stop
            self.shown = np.append(np.arange(start, stop, every), stop - 1)

    def _one(self, **extents) -> dict:
        """The curves at one pair of extents."""
        return {name: x[0] for name, x in self(**extents).items()}

    def __call__(self, shoulder_deg, elbow_deg) -> dict:
        extents_deg = np.stack(np.broadcast_arrays(shoulder_deg, elbow_deg), -1).reshape(-1, 2)
        motion = pick_and_place(extents_deg, _TIMES)
        rigid = self.setup.arm.inverse_dynamics(*motion)
        numbers = {f"peak {joint}": np.abs(rigid[..., j]).max(-1) for j, joint in enumerate(JOINTS)}
        torques = {_RIGID: rigid}
        if self.models:
            recording = self.setup.record(extents_deg)
            recorded = recording.tau[:, self.during]
            torques[_RECORDED] = recording.tau[:, self.shown]
            for name, model in self.models.items():
                windows = sliding_windows(recording.q, model.weights.width, self.during)
                torque = np.stack([model.torque(run) for run in windows])
                torques[name] = torque[:, self.shown - self.during.start]
                numbers[f"RMSS, {name}"] = rmss(torque, recorded, scale=self.scale)
        curves = {}
        for j, joint in enumerate(JOINTS):
            curves[f"{joint} angle"] = np.rad2deg(motion.q[..., j])
            curves.update({f"{joint} torque, {line}": x[..., j] for line, x in torques.items()})
        return {**curves, **numbers}

    def plain(self) -> dict:
        """What the page needs to compute the same."""
        motion = {
            "arm": plant(self.setup.arm, IDEAL)["arm"],
            "times": _TIMES.tolist(),
            "motion": MOTION_SECONDS,
            "lines": {"rigid": _RIGID, "recorded": _RECORDED},
        }
        if not self.models:
            return motion
        return {
            **motion,
            **self.loop,
            "shown": self.shown.tolist(),
            "scale": self.scale.tolist(),
        }
