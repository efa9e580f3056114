"""Arms drawn at random around the default one: what Table 4-1 looks like on each of them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from scipy.stats import qmc

from ddlib import paper
from ddlib._check import integer, number, one_of
from ddlib.control import pd
from ddlib.effects import (
    CMU_DD_ARM_II_EFFECTS,
    CoulombFriction,
    Noise,
    Quantisation,
    ViscousFriction,
)
from ddlib.experiments.setups import KD, KP, STATE_FEEDBACK, Setup

RANGES = {
    "position gain": (0.25, 8.0),
    "damping": (0.01, 1.0),
    "friction": (0.0625, 4.0),
    "torque noise": (0.125, 4.0),
    "descent": (0.4, 4.0),
    "encoder bits": (12.0, 17.0),
}
"""What is varied, and between which bounds. All but the bits are factors of the default values
and are drawn on a logarithmic scale. The damping is the velocity gain relative to the one that
keeps the default damping ratio; the descent is ``1 / (1 - momentum)``, which says how far the
same number of epochs leads."""


def draw(count: int, seed: int = 0) -> list[dict]:
    """Arms spread evenly over `RANGES` by a scrambled Sobol sequence.

    Parameters
    ----------
    count, seed : int
        How many, best a power of two, and the seed of the scrambling.

    Returns
    -------
    list of dict
        One value for each name in `RANGES`.
    """
    integer("count", count, 1)
    points = qmc.Sobol(len(RANGES), rng=integer("seed", seed, 0)).random(count)
    low, high = np.array(list(RANGES.values())).T
    low[:-1], high[:-1] = np.log(low[:-1]), np.log(high[:-1])
    values = low + points * (high - low)
    values[:, :-1] = np.exp(values[:, :-1])
    return [dict(zip(RANGES, map(float, row))) for row in values]


def setup(arm: Mapping[str, float]) -> Setup:
    """The experiment with an arm from `draw` in place of the default one.

    Parameters
    ----------
    arm : mapping
        A value for each name in `RANGES`.

    Raises
    ------
    ValueError
        If a name is missing, or a value is out of `RANGES`.
    """
    for name, (low, high) in RANGES.items():
        if name not in arm:
            raise ValueError(f"arm must have a value for {name!r}, got {sorted(arm)}")
        number(name, arm[name], low, high)
    viscous, coulomb = CMU_DD_ARM_II_EFFECTS.friction
    (noise,) = CMU_DD_ARM_II_EFFECTS.torque_sensor
    gain, friction = arm["position gain"], arm["friction"]
    effects = replace(
        CMU_DD_ARM_II_EFFECTS,
        friction=(
            ViscousFriction(tuple(friction * np.array(viscous.coefficient))),
            CoulombFriction(tuple(friction * np.array(coulomb.level))),
        ),
        encoder=(Quantisation(2 * np.pi / 2 ** arm["encoder bits"]),),
        torque_sensor=(Noise(tuple(arm["torque noise"] * np.array(noise.std))),),
    )
    kd = arm["damping"] * np.sqrt(gain) * np.array(KD)
    return replace(
        STATE_FEEDBACK,
        name="an arm at random",
        controller=pd(tuple(gain * np.array(KP)), tuple(kd)),
        effects=effects,
        momentum=1 - (1 - STATE_FEEDBACK.momentum) / arm["descent"],
    )


def distance(row: Mapping, column: str = "training") -> float:
    """How far an arm's errors are from a printed column: a factor's logarithm.

    Parameters
    ----------
    row : mapping
        Errors by the window size, as text, and by the name of the column; the median of
        several networks counts.
    column : {"training", "test"}
        Column of Table 4-1.

    Returns
    -------
    float
        Root mean square of ``ln(error / printed error)`` over the three windows; 0.4 is a
        factor of about 1.5.
    """
    one_of("column", column, ("training", "test"))
    ratios = [
        np.median(row[str(width)][column]) / getattr(printed, column)
        for width, printed in paper.TABLE_4_1.items()
    ]
    return float(np.sqrt(np.mean(np.log(ratios) ** 2)))
