"""Arms at random: evenly spread, what they are called, and how far from the printed table."""

import numpy as np
import pytest

from ddlib import paper
from ddlib.experiments import KD, KP, RANGES, STATE_FEEDBACK, distance, draw, setup

DEFAULT = {name: 1.0 for name in RANGES} | {"encoder bits": 16.0}


def test_draws_fill_the_ranges_evenly():
    arms = draw(32)
    assert arms == draw(32) != draw(32, seed=1)
    for name, (low, high) in RANGES.items():
        values = np.array([arm[name] for arm in arms])
        share = (values - low) / (high - low)
        if name != "encoder bits":
            share = np.log(values / low) / np.log(high / low)
        counts = np.histogram(share, 8, (0, 1))[0]
        assert (counts == 4).all(), name  # a Sobol sequence: as many in each eighth


def test_the_default_arm_is_among_them():
    here = setup(DEFAULT)
    assert here.effects == STATE_FEEDBACK.effects
    assert here.controller == STATE_FEEDBACK.controller
    assert here.momentum == pytest.approx(STATE_FEEDBACK.momentum, rel=1e-14)


def test_what_the_names_mean():
    here = setup({**DEFAULT, "position gain": 4.0, "damping": 0.5, "friction": 2.0,
                  "torque noise": 3.0, "descent": 2.0, "encoder bits": 12.0})  # fmt: skip
    np.testing.assert_allclose(here.controller.kp, 4 * np.array(KP))
    np.testing.assert_allclose(here.controller.kd, np.array(KD))  # half of the root of 4 times
    viscous, coulomb = here.effects.friction
    assert viscous.coefficient == (1.0, 0.3) and coulomb.level == (1.0, 0.3)
    np.testing.assert_allclose(here.effects.torque_sensor[0].std, (0.489, 0.129))
    assert here.effects.encoder[0].step == pytest.approx(2 * np.pi / 4096)
    assert here.momentum == pytest.approx(0.99)


@pytest.mark.parametrize("column", ["training", "test"])
def test_distance_is_a_factor(column):
    printed = {str(w): {column: getattr(e, column)} for w, e in paper.TABLE_4_1.items()}
    assert distance(printed, column) == 0
    twice = {w: {column: [2 * c[column], 2 * c[column], 99.0]} for w, c in printed.items()}
    assert distance(twice, column) == pytest.approx(np.log(2))
    one = {**printed, "21": {column: printed["21"][column] / np.e}}
    assert distance(one, column) == pytest.approx(1 / np.sqrt(3))


@pytest.mark.parametrize(
    "arm, words",
    [
        ({}, "arm must have a value for 'position gain'"),
        ({**DEFAULT, "friction": 5.0}, "friction"),
        ({**DEFAULT, "encoder bits": float("nan")}, "encoder bits"),
    ],
)
def test_unfit_arms_are_refused(arm, words):
    with pytest.raises(ValueError, match=words):
        setup(arm)


def test_bad_arguments_are_named():
    with pytest.raises(ValueError, match="count"):
        draw(0)
    with pytest.raises(ValueError, match="column must be one of"):
        distance({}, "validation")
