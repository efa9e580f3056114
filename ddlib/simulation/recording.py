"""What the log of an experiment holds, and how much of its torque the rigid body leaves over."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from ddlib._check import filled, finite_array, instance, number, told, unmasked
from ddlib.dynamics import Arm
from ddlib.trajectories import Trajectory


def equal_step(t) -> float:
    """The step of equally spaced times."""
    step = float(t[1] - t[0])
    if step <= 0 or not np.allclose(np.diff(t), step, rtol=1e-6, atol=0.0):
        raise ValueError(f"t must increase in equal steps, got steps from {step:g} s")
    return step


@dataclass(frozen=True, repr=False)
class Recording:
    """What the log holds: arrays ``(..., time, joint)`` whose leading axes, if any, are runs.

    Without a `duration` the motion is the samples from the first to the last at which the
    reference of any run has a velocity or an acceleration; if none has, all from 0 s on.
    """

    t: np.ndarray  #: Times, s; the motion begins at 0.
    reference: Trajectory  #: What the controller was asked for.
    q: np.ndarray  #: Measured positions, rad.
    tau: np.ndarray  #: Measured torques, N m.
    q_true: np.ndarray  #: True positions, rad.
    qd_true: np.ndarray  #: True velocities, rad/s.
    tau_true: np.ndarray  #: Applied torques, N m.
    duration: float | None = None  #: Length of the motion, s.
    control_step: float | None = None  #: Period for which a torque was held, s; 0: continuous.
    computing_time: float = 0.0  #: How much later than its reading a torque was applied, s.

    def __post_init__(self):
        if self.duration is not None:
            number("duration", self.duration, 0.0, open_low=True)
        if self.control_step is not None:
            number("control_step", self.control_step, 0.0)
        number("computing_time", self.computing_time, 0.0)
        unmasked("q", self.q)
        unmasked("tau", self.tau)

    def __repr__(self):
        *runs, samples, joints = self.q.shape
        what = " x ".join([*(f"{n} runs" for n in runs), f"{samples} samples", f"{joints} joints"])
        return f"Recording({what}, {self.t[0]:g} to {self.t[-1]:g} s)"

    @property
    def step(self) -> float:
        """Sampling period of the log, s; a ValueError if the samples are not equally spaced."""
        return equal_step(self.t)

    @property
    def motion(self) -> slice:
        """The samples of the motion itself, without the rests."""
        early = 1e-6 * (self.t[1] - self.t[0])  # times may be rounded
        first, end = np.searchsorted(self.t, -early), self.t.size
        if self.duration is not None:
            end = np.searchsorted(self.t, self.duration - early)
        else:
            moving = (self.reference.qd != 0) | (self.reference.qdd != 0)
            moving = np.flatnonzero(moving.any(axis=(*range(moving.ndim - 2), -1)))
            if moving.size:
                first, end = moving[0], moving[-1] + 1
        return slice(int(first), int(end))

    @property
    def span(self) -> tuple[float, float]:
        """Begin and end of the motion, s: its first sample, and one period after its last."""
        motion, step = self.motion, self.step
        begin = float(self.t[0]) + motion.start * step
        return begin, begin + (motion.stop - motion.start) * step

    def for_windows(self, width: int) -> Recording:
        """The recording itself: around its motion are rests, of which windows see a part."""
        return self

    @property
    def tracking_error(self) -> np.ndarray:
        """Reference minus true position, rad, shape ``(..., time, joint)``."""
        return self.reference.q - self.q_true

    def __getitem__(self, runs) -> Recording:
        """One run or several of many: ``recording[5]``, ``recording[:5]``."""
        if self.q.ndim < 3:
            raise IndexError(f"recording must have an axis of runs, got q of shape {self.q.shape}")
        return self.mapped(lambda x: x[runs])

    def mapped(self, change: Callable) -> Recording:
        """The recording with all its arrays ``(..., time, joint)`` changed by a function."""
        names = ("q", "tau", "q_true", "qd_true", "tau_true")
        arrays = {name: change(getattr(self, name)) for name in names}
        return replace(self, reference=Trajectory(*map(change, self.reference)), **arrays)


def residual_torque(arm: Arm, recording: Recording) -> np.ndarray:
    """Applied torque less the torque that a rigid `arm` needs for the motion that took place, N m.

    Its shape is ``(..., time - 1, joint)``, for the period that follows each sample but the last.
    The applied torque is constant over a control period, or changes once in it, after the computing
    time; its mean is taken. Lagrange-Euler's is taken in the middle of the period, with the mean
    acceleration; the error of that is of second order in the period.
    """
    instance("arm", arm, Arm)
    instance("recording", recording, Recording)
    step, period = recording.step, recording.control_step
    if not period:
        raise ValueError(f"recording must have a control_step above 0, got {period}")
    if abs(step / period - 1) > 1e-6:
        raise ValueError(f"recording must be logged every {period:g} s, got {step:g} s")
    q, qd = recording.q_true, recording.qd_true
    middle = [(x[..., 1:, :] + x[..., :-1, :]) / 2 for x in (q, qd)]
    needed = arm.inverse_dynamics(*middle, np.diff(qd, axis=-2) / step)
    applied, share_late = recording.tau_true[..., :-1, :], recording.computing_time / period
    if share_late:  # a sample holds what was computed a period ago, until the new torque is ready
        applied = share_late * applied + (1 - share_late) * recording.tau_true[..., 1:, :]
    return applied - needed


def rms(x, axis: int = -2) -> np.ndarray:
    """Root mean square of `x` over time, by default of an array ``(..., time, joint)``."""
    filled("x", x)
    if not isinstance(axis, (int, np.integer, tuple, type(None))) or isinstance(axis, bool):
        raise TypeError(f"axis must be an integer or None, got {told(axis)}")
    if isinstance(axis, int) and not -np.ndim(x) <= axis < np.ndim(x):
        raise ValueError(f"axis must lie within the {np.ndim(x)} axes of x, got {axis}")
    return np.sqrt(np.mean(finite_array("x", x) ** 2, axis))


class Score(NamedTuple):
    """What a controller made of a motion; every field has the shape of the recording's runs."""

    largest: np.ndarray  #: Largest error of a joint, degrees.
    whole: np.ndarray  #: Root mean square error over joints and time, degrees.
    settled: np.ndarray  #: The same without the first third of the motion.
    hand: np.ndarray  #: RMS distance of the hand from its place, without the first third, mm.
    turn: np.ndarray  #: Distance of the hand from its place half-way through the motion, mm.
    effort: np.ndarray  #: Root mean square of the torque vector over the motion, N m.


def score(arm: Arm, recording: Recording, seconds: float | None = None) -> Score:
    """Errors and effort of every run over a motion of `seconds`, or as the recording says.

    Errors of the joints, degrees: the `largest`, the `whole` (root mean square) and `settled`, that
    without the first third. Of the hand, mm: `hand`, RMS without that third, and at the `turn`
    half-way. `effort`: RMS of the torque vector, N m.
    """
    instance("arm", arm, Arm)
    instance("recording", recording, Recording)
    if seconds is not None:
        recording = replace(recording, duration=number("seconds", seconds, 0.0, open_low=True))
    t, error, moving = recording.t, np.rad2deg(recording.tracking_error), recording.motion
    begin, end = recording.span
    early = 1e-6 * recording.step
    settled = slice(int(np.searchsorted(t, begin + (end - begin) / 3 - early)), moving.stop)
    hand, wanted = (
        arm.forward_kinematics(q)[..., 1, :] for q in (recording.q_true, recording.reference.q)
    )
    gap = 1e3 * np.linalg.norm(hand - wanted, axis=-1)
    half = int(np.argmin(np.abs(t - (begin + end) / 2)))
    return Score(
        largest=np.abs(error[..., moving, :]).max((-2, -1)),
        whole=np.sqrt((error[..., moving, :] ** 2).mean((-2, -1))),
        settled=np.sqrt((error[..., settled, :] ** 2).mean((-2, -1))),
        hand=np.sqrt((gap[..., settled] ** 2).mean(-1)),
        turn=gap[..., half],
        effort=np.sqrt((recording.tau_true[..., moving, :] ** 2).sum(-1).mean(-1)),
    )
