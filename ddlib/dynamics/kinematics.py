"""Where the hand is and how to get it there: Jacobian, inverse kinematics."""

from __future__ import annotations

import numpy as np

from ddlib._check import finite_array, instance, one_of
from ddlib.dynamics.arm import Arm
from ddlib.trajectories import Trajectory

ELBOWS = ("positive", "negative")  #: Signs of the elbow angle; most points allow either.

# Smallest sine of the elbow angle that is not taken for singular: at 3 degrees from stretched or
# folded the joints must turn twenty times as fast as the hand moves, per length of a link.
_LEAST_SINE = 0.05


class Unreachable(ValueError):
    """The hand cannot get there, or only with the arm stretched or folded."""


def jacobian(arm: Arm, q) -> np.ndarray:
    """Derivatives of the hand's position by the angles `q` (rad), shape (..., 2, 2), m/rad."""
    instance("arm", arm, Arm)
    elbow, hand = np.moveaxis(arm.forward_kinematics(q), -2, 0)
    arms = np.stack([hand, hand - elbow], -1)  # from each joint to the hand, (..., xy, joint)
    return np.stack([-arms[..., 1, :], arms[..., 0, :]], -2)


def _jacobian_rate(arm: Arm, q, qd) -> np.ndarray:
    """Time derivative of `jacobian` in motion, shape (..., 2, 2), m/(rad s)."""
    J, qd = jacobian(arm, q), finite_array("qd", qd, 2)
    turning = np.stack([qd.sum(-1), qd.sum(-1)], -1)
    l1, first = arm.lengths[0], np.asarray(q, float)[..., 0]
    upper = l1 * np.stack([np.cos(first), np.sin(first)], -1)
    extra = np.zeros_like(J * turning[..., None, :])
    extra[..., 0] = upper * (qd[..., :1] - turning[..., :1])  # the upper arm turns without elbow
    quarter = np.stack([-J[..., 1, :], J[..., 0, :]], -2)
    return quarter * turning[..., None, :] - extra


def reach(arm: Arm) -> tuple[float, float]:
    """Least and largest distance of the hand from the shoulder, elbow not too straight, m."""
    instance("arm", arm, Arm)
    (l1, l2), bent = arm.lengths, np.sqrt(1 - _LEAST_SINE**2)
    near, far = (np.sqrt(l1**2 + l2**2 + s * 2 * l1 * l2 * bent) for s in (-1, 1))
    return float(near), float(far)


def inverse_kinematics(arm: Arm, hand, elbow: str = "positive") -> np.ndarray:
    """Angles (rad) that bring the hand to points ``(..., 2)``, m from the shoulder.

    `elbow` is the sign of the elbow angle, "positive" or "negative". Points that are too far or too
    near, with the arm within 3 degrees of stretched or folded, are `Unreachable`.
    """
    instance("arm", arm, Arm)
    hand, (l1, l2) = finite_array("hand", hand, 2), arm.lengths
    one_of("elbow", elbow, ELBOWS)
    distance2 = (hand**2).sum(-1)
    cosine = (distance2 - l1**2 - l2**2) / (2 * l1 * l2)
    bad = np.abs(cosine) > np.sqrt(1 - _LEAST_SINE**2)
    if bad.any():
        worst = float(np.sqrt(distance2[bad].ravel()[0]))
        low, high = reach(arm)
        raise Unreachable(
            f"hand must be {low:.3f} to {high:.3f} m from the shoulder (nearer or farther the arm "
            f"is folded or stretched), got {worst:.3f} m"
        )
    sine = np.sqrt(1 - cosine**2) * (1 if elbow == ELBOWS[0] else -1)
    first = np.arctan2(hand[..., 1], hand[..., 0]) - np.arctan2(l2 * sine, l1 + l2 * cosine)
    return np.stack([first, np.arctan2(sine, cosine)], -1)


def follow_hand(arm: Arm, hand, velocity, acceleration, elbow: str = "positive") -> Trajectory:
    """Joint motion that moves the hand along a path ``(..., time, 2)``; m, m/s and m/s^2."""
    instance("arm", arm, Arm)
    q = inverse_kinematics(arm, hand, elbow)
    # a path is continuous: the shoulder's angle runs on beyond half a turn
    q = np.stack([np.unwrap(q[..., 0], axis=-1), q[..., 1]], -1)
    J = jacobian(arm, q)
    velocity = finite_array("velocity", velocity, 2)
    acceleration = finite_array("acceleration", acceleration, 2)
    qd = np.linalg.solve(J, velocity[..., None])[..., 0]
    bent = np.einsum("...ij,...j->...i", _jacobian_rate(arm, q, qd), qd)  # hand'' = J qdd + J' qd
    return Trajectory(q, qd, np.linalg.solve(J, (acceleration - bent)[..., None])[..., 0])


def end_point_error(arm: Arm, wanted, q) -> np.ndarray:
    """Where the hand is, at angles `q`, minus where it should be, at `wanted`; (..., 2), m."""
    instance("arm", arm, Arm)
    finite_array("wanted", wanted, 2)
    finite_array("q", q, 2)
    return arm.forward_kinematics(q)[..., 1, :] - arm.forward_kinematics(wanted)[..., 1, :]
