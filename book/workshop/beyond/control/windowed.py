"""A model of windows as the box "inverse arm" of Figure 2-1: it sees the desired motion.

The log has a sample every 10 ms and the controller runs every 2 ms, so a model that was trained on
the log must be told what to do between its samples. A loop with a model whose windows it cannot
make, because its period does not fit, is refused when it starts.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import control
import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from ddlib._check import integer, non_negative, number, one_of, shaped
from ddlib.control.controllers import PID, ControlLaw, Controller, Feedforward, as_controller
from ddlib.trajectories import Trajectory

BETWEEN = ("window", "line", "hold")
"""What happens between two samples of the log: a window of its own around each control sample, a
straight line from torque to torque, or the last torque is held."""


def reference_windows(q, width: int, every: int) -> np.ndarray:
    """A view of the windows around all samples of a reference.

    Parameters
    ----------
    q : ndarray, shape (..., time, joint)
        Positions, rad. Before the first and after the last sample they are taken to rest.
    width : int
        Samples of a window, odd.
    every : int
        Steps between two samples of a window.

    Returns
    -------
    ndarray, shape (..., time, joint, width)
        Read-only.
    """
    reach = width // 2 * every
    ends = [np.repeat(q[..., end, :], reach, -2) for end in (slice(1), slice(-1, None))]
    padded = np.concatenate([ends[0], q, ends[1]], -2)
    return sliding_window_view(padded, 2 * reach + 1, -2)[..., ::every]


@dataclass(frozen=True)
class WindowFeedforward:
    """Torques of a reference by a model of windows; for `ddlib.control.Feedforward`.

    Parameters
    ----------
    model : callable
        ``model(windows) -> torque`` over windows ``(cases, joint, width)``, rad, oldest sample
        first; torques ``(cases, joint)``, N m.
    width : int
        Window size, odd.
    every : int
        Control periods between two samples of a window: 5 for 10 ms and 2 ms.
    between : {"window", "line", "hold"}
        As in `BETWEEN`.
    step : float, optional
        Sampling period of the windows that the model was trained on, s. If it is given, `check`
        refuses loops with another one.

    Notes
    -----
    Before its first and after its last sample the reference is taken to rest.
    """

    model: Callable
    width: int
    every: int = 5
    between: str = "window"
    step: float | None = None

    def __post_init__(self):
        if integer("width", self.width, 3) % 2 == 0:
            raise ValueError(f"width must be odd, so that a window has a centre, got {self.width}")
        integer("every", self.every, 1)
        one_of("between", self.between, BETWEEN)
        if self.step is not None:
            number("step", self.step, 0.0, open_low=True)

    def check(self, control_step: float) -> None:
        """Refuse a loop in which the windows would have another sampling period.

        Parameters
        ----------
        control_step : float
            Control period of the loop, s.

        Raises
        ------
        ValueError
            If `every` control periods are not the period of the model's training windows.
        """
        period = self.every * number("control_step", control_step, 0.0, open_low=True)
        if self.step is not None and abs(period / self.step - 1) > 1e-6:
            raise ValueError(
                f"every must make the loop's windows those of the model: {self.every} control "
                f"periods of {control_step:g} s are {period:g} s, and the model was trained on "
                f"samples {self.step:g} s apart"
            )

    def __call__(self, q, qd, qdd) -> np.ndarray:
        """Torque for every control sample of a reference.

        Parameters
        ----------
        q : array_like, shape (..., time, joint)
            Desired positions, rad.
        qd, qdd : array_like
            Not used: a window of positions is all that the model sees.

        Returns
        -------
        ndarray, shape (..., time, joint)
        """
        q = shaped("q", q, "(..., time, joint)")
        time = q.shape[-2]
        stride = 1 if self.between == "window" else self.every
        late = np.repeat(q[..., -1:, :], stride - 1, -2)  # a window after the end, too
        windows = reference_windows(np.concatenate([q, late], -2), self.width, self.every)
        windows = windows[..., ::stride, :, :]
        centres = windows.shape[-3]
        cases = windows.reshape(-1, *windows.shape[-2:])
        torque = shaped("model(windows)", self.model(cases), f"({len(cases)}, {q.shape[-1]})")
        torque = torque.reshape(*q.shape[:-2], centres, q.shape[-1])
        if stride == 1:
            return torque
        now = np.arange(time)
        before = torque[..., now // stride, :]
        if self.between == "hold":
            return before
        share = (now % stride / stride)[:, None]
        after = torque[..., np.minimum(now // stride + 1, centres - 1), :]
        return before + share * (after - before)


@dataclass(frozen=True)
class PlannedTorque:
    """Torques of a planned motion by a model of windows, added to a feedback law (Figure 2-1).

    `ddlib.control.controllers.Feedforward` does the same for any model; this one knows that a
    model of windows has a sampling period, and refuses a loop that does not give it.

    Parameters
    ----------
    feedforward : WindowFeedforward
    feedback : Controller or callable
        Corrects what the model gets wrong.
    """

    feedforward: WindowFeedforward
    feedback: Controller

    def start(self, reference: Trajectory, step: float) -> ControlLaw:
        """The law that follows `reference`, called every `step` s."""
        self.feedforward.check(step)
        return Feedforward(self.feedforward, self.feedback).start(reference, step)


@dataclass(frozen=True)
class MeasuredWindows:
    """A model of windows inside the loop: what has been is measured, what is to come is desired.

    The nearest thing to computed torque that a model of windows allows: up to the centre its
    window holds measured positions, after it the plan. The model is part of the feedback then,
    and can make the loop unstable.

    Parameters
    ----------
    feedforward : WindowFeedforward
        With a window of its own for every control sample (``between="window"``).
    feedback : Controller or callable
        Beside it.
    share : array_like, shape (...)
        How much of the measured deviation from the plan is put into the windows, 0 or more: 0 is
        `PlannedTorque`, 1 what was measured. Axes are runs.
    """

    feedforward: WindowFeedforward
    feedback: Controller
    share: float | np.ndarray = 1.0

    def __post_init__(self):
        non_negative("share", self.share)
        if self.feedforward.between != "window":
            raise ValueError(
                "feedforward must have between='window' inside a loop, "
                f"got {self.feedforward.between!r}"
            )

    def start(self, reference: Trajectory, step: float) -> ControlLaw:
        """The law that follows `reference`, called every `step` s."""
        made = self.feedforward
        made.check(step)
        feedback = as_controller(self.feedback).start(reference, step)
        half, share = made.width // 2, np.asarray(self.share, float)[..., None, None]
        taps = made.every * np.arange(-half, half + 1)
        last = reference.q.shape[-2] - 1
        kept: list[np.ndarray] = []  # deviations, newest last; before the first sample none

        def law(k, q, qd):
            kept.append(q - reference.q[..., k, :])
            del kept[: -(made.every * half + 1)]
            windows = np.moveaxis(reference.q[..., np.clip(k + taps, 0, last), :], -1, -2)
            past = [kept[t - 1] if -t < len(kept) else 0 * kept[-1] for t in taps[: half + 1]]
            past = share * np.stack(np.broadcast_arrays(*past), -1)
            windows = np.broadcast_to(windows, (*past.shape[:-1], made.width)).copy()
            windows[..., : half + 1] += past
            cases = windows.reshape(-1, *windows.shape[-2:])
            torque = shaped("model(windows)", made.model(cases), f"({len(cases)}, {q.shape[-1]})")
            return torque.reshape(windows.shape[:-1]) + feedback(k, q, qd)

        return law


def past_slopes(model: Callable, windows, step: float = 1e-5) -> np.ndarray:
    """How a model's torque changes with each past sample of its windows, the mean over cases.

    Parameters
    ----------
    model : callable
        As of `WindowFeedforward`.
    windows : array_like, shape (cases, joint, width)
        rad, oldest sample first.
    step : float
        Of the central difference quotient, rad.

    Returns
    -------
    ndarray, shape (torque, joint, width // 2 + 1)
        N m/rad, oldest sample first, the centre last.
    """
    windows = shaped("windows", windows, "(cases, joint, width)")
    joints, width = windows.shape[1:]
    found = np.empty((joints, joints, width // 2 + 1))
    for joint, tap in np.ndindex(*found.shape[1:]):
        shift = np.zeros((joints, width))
        shift[joint, tap] = number("step", step, 0.0, open_low=True)
        change = np.asarray(model(windows + shift)) - model(windows - shift)
        found[:, joint, tap] = change.mean(0) / (2 * step)
    return found


def poles_inside(
    joints: control.StateSpace, feedback: PID, past, period: float, every: int = 5, late: int = 0
) -> np.ndarray:
    """Poles of a sampled loop with a linear model of windows inside (`MeasuredWindows`).

    Parameters
    ----------
    joints : control.StateSpace
        From `ddlib.control.linear.plant`.
    feedback : PID
        Without an integral.
    past : array_like, shape (torque, joint, samples)
        N m/rad, times the share that is measured, as from `past_slopes`.
    period : float
        Control period, s.
    every : int
        Control periods between two samples of a window.
    late : int
        Control periods by which the torque comes late.

    Returns
    -------
    ndarray of complex
        In the z plane: stable if all lie inside the unit circle.
    """
    n = joints.ninputs
    past = shaped("past", past, f"({n}, {n}, samples)")
    integer("every", every, 1), integer("late", late, 0)
    if np.any(feedback.ki):
        raise ValueError(f"feedback must have no integral, got ki={feedback.ki}")
    sampled = control.sample_system(joints, period, "zoh")
    ages = late + every * np.arange(past.shape[-1])[::-1]  # of the samples, oldest first
    # states: angles and velocities now, then those of 1, 2, ... periods ago
    A = np.eye(2 * n * (ages[0] + 1), k=-2 * n)
    A[: 2 * n, : 2 * n] = sampled.A
    now = 2 * n * late
    gains = np.hstack([np.diag(np.broadcast_to(k, n)) for k in (feedback.kp, feedback.kd)])
    A[: 2 * n, now : now + 2 * n] -= sampled.B @ gains
    for age, slope in zip(ages, np.moveaxis(past, -1, 0)):
        A[: 2 * n, 2 * n * age : 2 * n * age + n] += sampled.B @ slope
    return np.linalg.eigvals(A)
