"""What the hand carries: a load changes the base parameters and nothing else."""

from __future__ import annotations

from dataclasses import replace

from ddlib._check import number
from ddlib.dynamics.arm import STANDARD_GRAVITY, Arm


def with_load(arm: Arm, mass: float) -> Arm:
    """The arm with a point mass in its hand.

    Parameters
    ----------
    arm : Arm
        Its lengths are those of the kinematics. If it has no gravity moments, it moves in a
        horizontal plane and the load's weight does not matter.
    mass : float
        kg, 0 or more. Han, Hemami & Yurkovich 1987 use 2, 5 and 10 kg.

    Returns
    -------
    Arm
    """
    number("mass", mass, 0.0)
    l1, l2 = arm.lengths
    moments = arm.gravity_moments
    if any(moments):
        weight = mass * STANDARD_GRAVITY
        moments = (moments[0] + weight * l1, moments[1] + weight * l2)
    return replace(
        arm,
        name=f"{arm.name} with {mass:g} kg",
        a=arm.a + mass * (l1**2 + l2**2),
        b=arm.b + mass * l1 * l2,
        d=arm.d + mass * l2**2,
        gravity_moments=moments,
    )
