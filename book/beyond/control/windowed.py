"""A model of windows as the box "inverse arm" of Figure 2-1: it sees the desired motion.

It must be told what to do between the samples of the log it was trained on, every 10 ms.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import control
import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from ddlib.control.controllers import PID, ControlLaw, Controller, as_controller
from ddlib.trajectories import Trajectory


def reference_windows(q, width: int, every: int) -> np.ndarray:
    """Windows around a reference's samples, ``(..., time, joint, width)``; it rests outside."""
    reach = width // 2 * every
    ends = [np.repeat(q[..., end, :], reach, -2) for end in (slice(1), slice(-1, None))]
    padded = np.concatenate([ends[0], q, ends[1]], -2)
    return sliding_window_view(padded, 2 * reach + 1, -2)[..., ::every]


@dataclass(frozen=True)
class WindowFeedforward:
    """Torques of a reference by a model of windows; for `ddlib.control.Feedforward`.

    Before its first and after its last sample the reference is taken to rest. Between two samples
    of the log there is a window of its own around each control sample, a straight line from torque
    to torque, or the last torque is held.
    """

    model: Callable  # of windows (cases, joint, width), rad, oldest first: torque (cases, joint)
    width: int  # odd
    every: int = 5  # control periods between two samples of a window: 10 ms by 2 ms
    between: str = "window"  # or "line" or "hold"

    def __call__(self, q, qd, qdd) -> np.ndarray:
        """Torque for every sample of a reference ``(..., time, joint)`` by its positions."""
        time = q.shape[-2]
        stride = 1 if self.between == "window" else self.every
        at_rest = np.repeat(q[..., -1:, :], stride - 1, -2)  # a window after the end, too
        windows = reference_windows(np.concatenate([q, at_rest], -2), self.width, self.every)
        windows = windows[..., ::stride, :, :]
        centres = windows.shape[-3]
        cases = windows.reshape(-1, *windows.shape[-2:])
        torque = self.model(cases).reshape(*q.shape[:-2], centres, q.shape[-1])
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
class MeasuredWindows:
    """A model of windows inside the loop: what has been is measured, what is to come is desired.

    So much of the measured deviation as `share` says is put into the windows; its axes are runs.
    """

    feedforward: WindowFeedforward
    feedback: Controller
    share: float | np.ndarray = 1.0

    def start(self, reference: Trajectory, step: float) -> ControlLaw:
        """The law of one run: feedback, and the model's torque for measured windows."""
        feedforward = self.feedforward
        feedback = as_controller(self.feedback).start(reference, step)
        half, share = feedforward.width // 2, np.asarray(self.share, float)[..., None, None]
        taps = feedforward.every * np.arange(-half, half + 1)
        last = reference.q.shape[-2] - 1
        deviations: list[np.ndarray] = []  # deviations, newest last; before the first sample none

        def law(k, q, qd):
            deviations.append(q - reference.q[..., k, :])
            del deviations[: -(feedforward.every * half + 1)]
            windows = np.moveaxis(reference.q[..., np.clip(k + taps, 0, last), :], -1, -2)
            past = [
                deviations[t - 1] if -t < len(deviations) else 0 * deviations[-1]
                for t in taps[: half + 1]
            ]
            past = share * np.stack(np.broadcast_arrays(*past), -1)
            windows = np.broadcast_to(windows, (*past.shape[:-1], feedforward.width)).copy()
            windows[..., : half + 1] += past
            cases = windows.reshape(-1, *windows.shape[-2:])
            return feedforward.model(cases).reshape(windows.shape[:-1]) + feedback(k, q, qd)

        return law


def past_slopes(model: Callable, windows, step: float = 1e-5) -> np.ndarray:
    """Mean slopes of a model's torque by past samples, N m/rad: (torque, joint, width // 2 + 1)."""
    joints, width = windows.shape[1:]
    slopes = np.empty((joints, joints, width // 2 + 1))
    for joint, tap in np.ndindex(*slopes.shape[1:]):
        shift = np.zeros((joints, width))
        shift[joint, tap] = step
        change = np.asarray(model(windows + shift)) - model(windows - shift)
        slopes[:, joint, tap] = change.mean(0) / (2 * step)
    return slopes


def poles_inside(
    joints: control.StateSpace, feedback: PID, past, period: float, every: int = 5, late: int = 0
) -> np.ndarray:
    """Poles of a sampled loop with a linear model of these slopes (`past_slopes`) inside."""
    n = joints.ninputs
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
