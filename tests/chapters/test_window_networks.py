"""What the screening design tells of errors that were planted."""

import numpy as np
import pytest

from workshop.chapters.window_networks import effects, width_left
from workshop.report.studies.screening import screening


def test_effects_are_those_that_were_planted():
    """Squares and products of what is varied change neither them nor the empty columns."""
    design = screening()
    x = design[:, :2]
    planted = np.array([[0.5, -0.2], [0.3, 0.0]])
    logs = x @ planted + 0.7 * (x[:, :1] ** 2 + x[:, :1] * x[:, 1:])
    factors, chance = effects(design, logs, 2)
    np.testing.assert_allclose(factors, np.exp(2 * planted))
    assert chance == pytest.approx(1.0)
    logs = logs + 0.1 * design[:, [7]] * [1, 0]
    assert effects(design, logs, 2)[1] == pytest.approx(np.exp(0.2))


def planted(noise):
    """Two errors, each moved by its own quantity alone, in 25 runs of two networks."""
    rng = np.random.default_rng(1)
    places = screening()[:, :2]
    return places, places[:, None] + rng.normal(0, noise, (25, 2, 2))


def test_width_left_against_the_normal_distribution():
    """Slopes of 1: what is left deviates as one network does, far inside the ranges."""
    places, logs = planted(0.1)
    left = width_left(places, logs, np.array([0.2, -0.1]))
    apart = np.sqrt(((logs - logs.mean(1, keepdims=True)) ** 2).sum((0, 1)) / 25)
    wanted = 100 * np.sqrt(3) * np.exp(np.mean(np.log(apart)))
    assert left["exact"] == pytest.approx(wanted, rel=0.05)
    assert left["exact"] < left["counted"] < 1.3 * wanted


def test_errors_that_nothing_moves_narrow_nothing():
    places, logs = planted(0.1)
    still = logs - places[:, None]
    left = width_left(places, still, still.mean((0, 1)))
    assert left["counted"] == pytest.approx(100, abs=3)
