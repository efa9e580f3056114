"""Which arms would have produced Table 4-1: many arms at random, and how well each was trained."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.stats import qmc

from ddlib import paper
from ddlib.controllers import pd
from ddlib.effects import (
    CMU_DD_ARM_II_EFFECTS,
    CoulombFriction,
    Noise,
    Quantisation,
    ViscousFriction,
)
from ddlib.experiment import KD, KP, STATE_FEEDBACK, WINDOWS, errors, train_windows
from ddlib.sweeps import sweep

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
    points = qmc.Sobol(len(RANGES), rng=seed).random(count)
    low, high = np.array(list(RANGES.values())).T
    low[:-1], high[:-1] = np.log(low[:-1]), np.log(high[:-1])
    values = low + points * (high - low)
    values[:, :-1] = np.exp(values[:, :-1])
    return [dict(zip(RANGES, map(float, row))) for row in values]


def setup(arm: dict):
    """The `Setup` of an arm from `draw`."""
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
    controller = pd(tuple(gain * np.array(KP)), tuple(kd))
    momentum = 1 - (1 - STATE_FEEDBACK.momentum) / arm["descent"]
    return replace(
        STATE_FEEDBACK, name="an arm", controller=controller, effects=effects, momentum=momentum
    )


def _arm(arm: dict, members: int, seed: int = 0) -> dict:
    """The six errors of one arm."""
    here = setup(arm)
    recording = here.record()
    tracking = np.abs(recording.tracking_error[:, recording.motion]).max()
    row = {**arm, "largest tracking error, degrees": float(np.rad2deg(tracking))}
    for width in WINDOWS:
        model, history, _ = train_windows(
            here, recording, width, members, seed=seed, progress=False
        )
        found = errors(model, recording)
        row[str(width)] = {
            "training": found["training"],
            "test": found["test"],
            "best test": history.best_test,
            "largest weight": model.weights.largest,
        }
    return row


def training_distance(row: dict) -> float:
    """Root mean square of the logarithms of measured over printed training errors of an arm."""
    ratios = [np.median(row[str(w)]["training"]) / paper.TABLE_4_1[w].training for w in WINDOWS]
    return float(np.sqrt(np.mean(np.log(ratios) ** 2)))


def arms(count=32, members=8) -> dict:
    """Table 4-1 for arms drawn at random (`draw`), with one network for each cell.

    The arm whose training errors come closest to the printed ones is trained again with
    `members` other networks: chosen by the training column, it may be judged by the test column.
    """
    rows = sweep(_arm, [{"arm": arm, "members": 1} for arm in draw(count)], label="arms")
    closest = min(rows, key=training_distance)
    chosen = {name: closest[name] for name in RANGES}
    again = _arm(chosen, members, seed=1)
    return {"ranges": RANGES, "rows": rows, "chosen": again, "members": members}
