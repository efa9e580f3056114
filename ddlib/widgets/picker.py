"""The square of trajectories: pick one, watch the arm, record it."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
import traitlets as t
from scipy.spatial import ConvexHull

from ddlib._check import finite_array, number
from ddlib.arm import CMU_DD_ARM_II, Arm
from ddlib.paper import TEST_TRAJECTORY, TRAINING_TRAJECTORIES
from ddlib.trajectories import APPENDIX_I, MAX_EXTENT_DEG, MOTION_SECONDS, pick_and_place
from ddlib.widgets.base import CurveWidget, Mark, Pad, Panel, Parameter, Scalar, module

JOINTS = ("shoulder", "elbow")
RIGID = "Lagrange-Euler"

TIMES = np.linspace(0.0, MOTION_SECONDS, 101)
"""Where the curves are sampled, s."""

# at 3 s the reference is back at rest: the last sample is the motion's limit from inside
_INSIDE = np.append(TIMES[:-1], np.nextafter(MOTION_SECONDS, 0.0))

_TRAINING = APPENDIX_I[np.array(TRAINING_TRAJECTORIES) - 1]
_HULL = ConvexHull(_TRAINING)


def inside_hull(extents_deg) -> np.ndarray:
    """Whether extents (``(..., 2)``, degrees) lie in the hull of the training trajectories."""
    extents_deg = finite_array("extents_deg", extents_deg, 2)
    distances = extents_deg @ _HULL.equations[:, :2].T + _HULL.equations[:, 2]
    return (distances <= 1e-9).all(-1)


class TrajectoryPicker(CurveWidget):
    """Pick a trajectory of the paper's family; see arm, joint angles and torques; record it.

    The pad is the square of extents from 0 to 45 degrees with the trajectories of Appendix I.
    The torques are those of the reference motion itself: no controller, no friction.

    Parameters
    ----------
    arm : Arm
        The arm that moves.
    models : mapping
        More torque curves: name -> ``callable(extents_deg)`` that returns torques of shape
        ``(time, 2)`` in N m, equally spaced over the motion.
    on_record : callable, optional
        Called with the extents when the reader records; default
        ``ddlib.experiment.STATE_FEEDBACK.record``. Its result is kept in `recording`.
    **options
        Passed on to `CurveWidget`: ``checks``, ``tolerance``, ``interpolation``.

    Attributes
    ----------
    extents_deg : tuple
        Extents of shoulder and elbow in degrees; starts as the test trajectory.
    recording : object
        What `on_record` returned last, or None.
    """

    _esm = module("baked.js", "curves.js", "picker.js")
    _css = module("curves.css", "picker.css")

    extents_deg = t.Tuple(t.Float(), t.Float(), default_value=tuple(APPENDIX_I[-1].tolist()))
    arm = t.Dict(help="lengths in m, curves of the joint angles, times in s").tag(sync=True)
    record_status = t.Dict({"text": "", "count": 0}).tag(sync=True)
    recording = t.Any(None)

    def __init__(
        self,
        arm: Arm = CMU_DD_ARM_II,
        models: Mapping[str, Callable] | None = None,
        on_record: Callable | None = None,
        **options,
    ):
        models = dict(models or {})
        for name, model in models.items():
            if not callable(model) or name == RIGID:
                raise TypeError(f"models must be callables of other names, got {name}: {model!r}")
        if on_record is not None and not callable(on_record):
            raise TypeError(f"on_record must be callable, got {on_record!r}")
        self._on_record = on_record
        lines = [RIGID, *models]
        seconds = "time, s"
        super().__init__(
            lambda **extents: _curves(arm, models, list(extents.values())),
            [
                Parameter(
                    f"{joint}_deg", f"{joint.title()} extent", 0.0, MAX_EXTENT_DEG, start, "°"
                )
                for joint, start in zip(JOINTS, APPENDIX_I[TEST_TRAJECTORY - 1].tolist())
            ],
            [
                Panel("Joint angles, °", {f"{j} angle": j for j in JOINTS}, seconds, TIMES),
                *(
                    Panel(
                        f"{joint.title()} torque, N m",
                        {f"{joint} torque, {line}": line for line in lines},
                        seconds,
                        TIMES,
                    )
                    for joint in JOINTS
                ),
            ],
            title="Trajectory picker",
            alt=(
                "The square of shoulder and elbow extents with the six trajectories of Appendix I, "
                "and beside it joint angles and torques of trajectory 6, the test, over 3 seconds."
            ),
            scalars=[Scalar(f"peak {joint}", f"Largest {joint} torque", "N m") for joint in JOINTS],
            pad=_pad(),
            **options,
        )
        angles = [f"{joint} angle" for joint in JOINTS]
        self.arm = {"lengths": list(arm.lengths), "angles": angles, "times": TIMES.tolist()}
        self.observe(self._from_parameters, [f"{joint}_deg" for joint in JOINTS])
        self.observe(self._to_parameters, "extents_deg")
        self.on_msg(self._on_message)

    @property
    def interpolates(self) -> bool:
        """Whether the extents lie in the hull of the training trajectories."""
        return bool(inside_hull(self.extents_deg))

    def record(self):
        """Record the trajectory as it stands; returns and keeps the recording."""
        call = self._on_record
        if call is None:
            from ddlib.experiment import STATE_FEEDBACK

            call = STATE_FEEDBACK.record
        self.recording = call(self.extents_deg)
        self._say(f"Recorded {_words(self.extents_deg)}: now in the widget's recording.")
        return self.recording

    @t.validate("extents_deg")
    def _check_extents(self, proposal):
        try:
            return tuple(number("extents_deg", x, 0.0, MAX_EXTENT_DEG) for x in proposal.value)
        except ValueError as error:
            raise t.TraitError(str(error)) from None

    def _from_parameters(self, change):
        self.extents_deg = (self.shoulder_deg, self.elbow_deg)

    def _to_parameters(self, change):
        with self.hold_trait_notifications():
            self.shoulder_deg, self.elbow_deg = self.extents_deg

    def _say(self, text):
        self.record_status = {"text": text, "count": self.record_status["count"] + 1}

    def _on_message(self, _widget, content, _buffers):
        if content.get("type") != "record":
            return
        try:
            self.extents_deg = tuple(content["extents_deg"])
            self.record()
        except Exception as error:  # shown in the figure: a comm's handler has no other reader
            self._say(f"Not recorded. {type(error).__name__}: {error}")


def _words(extents_deg) -> str:
    return " and ".join(f"{x:.1f}°" for x in extents_deg)


def _pad() -> Pad:
    marks = [
        Mark(x, y, str(k), "test" if k == TEST_TRAJECTORY else "training")
        for k, (x, y) in enumerate(APPENDIX_I.tolist(), 1)
    ]
    corners = _TRAINING[_HULL.vertices].tolist()
    return Pad("shoulder_deg", "elbow_deg", marks, corners, "hull of the training set")


def _curves(arm, models, extents_deg) -> dict:
    motion = pick_and_place(extents_deg, _INSIDE)
    rigid = arm.inverse_dynamics(*motion)
    torques = {RIGID: rigid}
    for name, model in models.items():
        torque = finite_array(name, model(tuple(extents_deg)), 2)
        if torque.ndim != 2 or len(torque) < 2:
            raise ValueError(f"{name} must return shape (time, 2), got {torque.shape}")
        sampled = np.arange(len(torque)) * MOTION_SECONDS / len(torque)
        torques[name] = np.stack([np.interp(TIMES, sampled, column) for column in torque.T], -1)
    curves = {}
    for j, joint in enumerate(JOINTS):
        curves[f"{joint} angle"] = np.rad2deg(motion.q[:, j])
        curves.update({f"{joint} torque, {line}": tau[:, j] for line, tau in torques.items()})
        curves[f"peak {joint}"] = np.abs(rigid[:, j]).max()
    return curves
