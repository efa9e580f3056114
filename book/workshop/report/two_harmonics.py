"""Controls for the paper's family: motions in which position and acceleration differ.

One sine is proportional to its own second derivative, so along the paper's reference a filter
cannot tell position from acceleration. A second, faster sine of drawn amplitude and sign tells
them apart, at nearly the same extents and speeds. Two single motions do so, too: a polynomial of
degree five out and back, and a circle of the hand.
"""

from __future__ import annotations

import numpy as np

from ddlib.setups import STATE_FEEDBACK, Setup
from ddlib.simulation import CONTROL_STEP, LOG_STEP, REST, Recording, follow
from ddlib.trajectories import (
    APPENDIX_I,
    MAX_EXTENT_DEG,
    MOTION_SECONDS,
    Trajectory,
    pick_and_place,
    time_grid,
)

# The page Provenance shows these notes.
ORDER = 5
"""Frequency of the second sine over that of the first. Odd: then both are symmetric about the
middle of the motion, where half of the paper's sine turns."""

SHARE = 2.0
"""Largest acceleration of the second sine over that of the first one at 45 degrees."""

NEUTRAL = (-0.35, -0.55)
"""Joint angles about which the hand's circle lies, rad: inside the family's range."""


def _two_harmonics(extents_deg, second_deg, t, order: int = ORDER) -> Trajectory:
    """References ``phi = -(theta sin(pi t / 3) + rho sin(order pi t / 3))``, shape (..., time, 2).

    They rest at zero before 0 s and from 3 s on; for ``rho = 0`` they are the paper's family.
    """
    first = pick_and_place(extents_deg, t)
    rho = np.deg2rad(second_deg)
    t = np.asarray(t, dtype=float)
    omega = order * np.pi / MOTION_SECONDS
    moving = (t >= 0) & (t < MOTION_SECONDS)
    sine, cosine = (f(omega * t) * moving for f in (np.sin, np.cos))
    second = (-sine, -omega * cosine, omega**2 * sine)
    return Trajectory(*(x + rho[..., None, :] * y[:, None] for x, y in zip(first, second)))


def _second_amplitudes(order: int = ORDER, seed: int = 0) -> np.ndarray:
    """Amplitudes of the second sine for the six runs, degrees, shape (6, 2)."""
    most = SHARE * MAX_EXTENT_DEG / order**2
    draw = np.random.default_rng(seed)
    return draw.uniform(-most, most, APPENDIX_I.shape)


def record_two_harmonics(
    setup: Setup = STATE_FEEDBACK, order: int = ORDER, seed: int = 0
) -> Recording:
    """The six runs of Appendix I with a second sine on top, recorded as the paper's are."""
    t = time_grid(CONTROL_STEP, REST)
    return _followed(
        setup, t, _two_harmonics(APPENDIX_I, _second_amplitudes(order, seed), t, order)
    )


def record_quintic(setup: Setup = STATE_FEEDBACK, degrees: float = -40.0) -> Recording:
    """Both joints out and back by polynomials of degree five, at rest at either end of each."""
    t = time_grid(CONTROL_STEP, REST)
    half = MOTION_SECONDS / 2
    away = np.clip(np.where(t < half, t, MOTION_SECONDS - t) / half, 0, 1)
    q = np.deg2rad(degrees) * np.polyval([6, -15, 10, 0, 0, 0], away)
    return _followed(setup, t, _along(np.stack([q, 0.6 * q], -1)))


def record_circle(setup: Setup = STATE_FEEDBACK, radius: float = 0.03, turns: int = 2) -> Recording:
    """The hand goes round a circle about where `NEUTRAL` puts it."""
    t = time_grid(CONTROL_STEP, REST)
    angle = 2 * np.pi * turns * np.clip(t, 0, MOTION_SECONDS) / MOTION_SECONDS
    first, second = setup.arm.lengths
    sums = np.cumsum(NEUTRAL)
    centre = np.array([f(NEUTRAL[0]) * first + f(sums[1]) * second for f in (np.cos, np.sin)])
    x, y = centre[:, None] + radius * np.stack([np.cos(angle), np.sin(angle)])
    elbow = -np.arccos((x**2 + y**2 - first**2 - second**2) / (2 * first * second))
    shoulder = np.arctan2(y, x) - np.arctan2(second * np.sin(elbow), first + second * np.cos(elbow))
    return _followed(setup, t, _along(np.stack([shoulder, elbow], -1)))


def _along(q) -> Trajectory:
    speed = np.gradient(q, CONTROL_STEP, axis=0)
    return Trajectory(q, speed, np.gradient(speed, CONTROL_STEP, axis=0))


def _followed(setup: Setup, t, reference: Trajectory) -> Recording:
    return follow(
        setup.arm, setup.controller, reference, t, effects=setup.effects, seed=setup.seed,
        log_every=round(LOG_STEP / CONTROL_STEP), duration=MOTION_SECONDS,
    )  # fmt: skip
