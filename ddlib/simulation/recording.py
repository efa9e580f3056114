"""What the log of an experiment holds, and how much of its torque the rigid body leaves over."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from ddlib._check import finite_array, number
from ddlib.dynamics import Arm
from ddlib.trajectories import Trajectory


def _equal_steps(t) -> float:
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

    def __repr__(self):
        *runs, samples, joints = self.q.shape
        what = " x ".join([*(f"{n} runs" for n in runs), f"{samples} samples", f"{joints} joints"])
        return f"Recording({what}, {self.t[0]:g} to {self.t[-1]:g} s)"

    @property
    def step(self) -> float:
        """Sampling period of the log, s; a ValueError if the samples are not equally spaced."""
        return _equal_steps(self.t)

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
    step, period = recording.step, recording.control_step
    if not period:
        raise ValueError(f"recording must have a control_step above 0, got {period}")
    if abs(step / period - 1) > 1e-6:
        raise ValueError(f"recording must be logged every {period:g} s, got {step:g} s")
    q, qd = recording.q_true, recording.qd_true
    middle = [(x[..., 1:, :] + x[..., :-1, :]) / 2 for x in (q, qd)]
    needed = arm.inverse_dynamics(*middle, np.diff(qd, axis=-2) / step)
    applied, late = recording.tau_true[..., :-1, :], recording.computing_time / period
    if late:  # a sample holds what was computed a period ago, until the new torque is ready
        applied = late * applied + (1 - late) * recording.tau_true[..., 1:, :]
    return applied - needed


def rms(x, axis: int = -2) -> np.ndarray:
    """Root mean square of `x` over time, by default of an array ``(..., time, joint)``."""
    return np.sqrt(np.mean(finite_array("x", x) ** 2, axis))
