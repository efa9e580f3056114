"""Sampled control whose torque comes late: exact poles for any delay."""

from __future__ import annotations

import control
import numpy as np

from ddlib._check import finite_array, number


def late_poles(joints: control.StateSpace, gain, period: float, late: float) -> np.ndarray:
    """Poles of sampled state feedback with a delay between reading and torque, in the z plane.

    The torque ``-gain x`` of a reading at ``k period`` is applied from ``k period + late`` on and
    held for a period, s; the delay may be longer than that. Between two changes of the torque the
    joints, from `ddlib.control.linear.plant`, are solved exactly, so the loop is a difference
    equation; its states are those of the joints and the torques that are still on their way (Astrom
    & Wittenmark 1997).
    """
    number("period", period, 0.0, open_low=True)
    whole, late = divmod(number("late", late, 0.0) / period + 1e-12, 1.0)
    states, inputs = joints.B.shape
    K = finite_array("gain", gain, states)
    parts = [_held(joints, share * period) for share in (late, 1 - late)]
    older, newer = parts[1][0] @ parts[0][1], parts[1][1]

    # states: those of the joints, then the torques of 1, 2, ... periods ago
    waiting = int(whole) + 1
    A = np.zeros((states + waiting * inputs,) * 2)
    A[:states, :states] = parts[1][0] @ parts[0][0]
    A[states:, states:] = np.eye(waiting * inputs, k=-inputs)
    A[states : states + inputs, :states] = -K
    last = slice(states + int(whole) * inputs, None)
    A[:states, last] = older
    if whole:
        A[:states, last.start - inputs : last.start] += newer
    else:
        A[:states, :states] -= newer @ K
    return np.linalg.eigvals(A)


def _held(joints, seconds):
    """State and input matrix of the joints over some seconds under a constant torque."""
    if seconds < 1e-9:
        return np.eye(joints.nstates), np.zeros_like(joints.B)
    sampled = control.sample_system(joints, seconds, "zoh")
    return sampled.A, sampled.B
