"""How large is what Lagrange-Euler leaves out: torque beyond the rigid body's, on a motion."""

from __future__ import annotations

import numpy as np

from ddlib._check import finite_array
from ddlib.dynamics import Arm
from ddlib.simulation.recording import Recording


def residual_torque(arm: Arm, recording: Recording) -> np.ndarray:
    """Applied torque less the torque that a rigid `arm` needs for the motion that took place.

    The applied torque is constant over a control period, or changes once in it, after the
    computing time; its mean is taken. Lagrange-Euler's is taken in the middle of the period,
    with the mean acceleration; the error of that is of second order in the period (for the
    rigid arm of this book on trajectory 6 below 2e-6 N m).

    Parameters
    ----------
    arm : Arm
        The rigid body.
    recording : Recording
        Logged at every control period (``log_every=1``).

    Returns
    -------
    ndarray, shape (..., time - 1, joint)
        N m, for the period that follows each sample but the last.

    Raises
    ------
    ValueError
        If samples have been left out, or the recording does not say for how long a torque
        was held.
    """
    step, period = recording.step, recording.control_step
    if not period:
        raise ValueError(
            "recording must have a control_step above 0, for which its torque was held, "
            f"got {period}"
        )
    if abs(step / period - 1) > 1e-6:
        raise ValueError(
            f"recording must be logged every {period:g} s, a control period, got {step:g} s"
        )
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
