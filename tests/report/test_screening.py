"""The design, the regression and the posterior of the knobs, against closed forms."""

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest

from ddlib.learning import cases
from ddlib.setups import JOINT_DAMPING
from workshop.report import knobs
from workshop.report.knobs import (
    _Emulator,
    _Knob,
    _screening,
    _shares,
    _terms,
    _weigh,
    _without_start,
    moments,
    would_tell,
)

# --- knobs and the design -----------------------------------------------------------------------


def test_places_of_a_knob():
    factor, step = _Knob(0.5, 8.0), _Knob(-1.0, 0.0, logarithmic=False)
    np.testing.assert_allclose(factor.value([-1, 0, 1]), [0.5, 2.0, 8.0])
    np.testing.assert_allclose(step.value([-1, 0, 0.5]), [-1.0, -0.5, -0.25])
    for knob in (factor, step):
        np.testing.assert_allclose(knob.place(knob.value([-0.7, 0.2])), [-0.7, 0.2])


def test_the_design_separates_main_effects_from_all_of_second_order():
    x = _screening()
    assert x.shape == (25, 12) and set(np.unique(x)) == {-1.0, 0.0, 1.0}
    np.testing.assert_array_equal(x.T @ x, 22 * np.eye(12))  # main effects from each other
    np.testing.assert_array_equal(x.sum(0), 0)
    second = [x[:, i] * x[:, j] for i, j in combinations(range(12), 2)]
    second = np.column_stack([x**2, *second])
    np.testing.assert_array_equal(x.T @ second, 0)  # and from squares and products
    assert ((x == 0).sum(0) == 3).all()  # each knob is in the middle of its range three times
    assert np.linalg.matrix_rank(np.column_stack([np.ones(25), x, x**2])) == 25


def test_joint_damping_lies_inside_the_ranges():
    tuned = {"joint damping": 1, "Coulomb friction": 3, "position gain": 2.5, "encoder bits": 12.5,
             "torque noise": 1, "start left out": 0, "lowest input": 0, "decay": 1e-6,
             "steps": 60}  # fmt: skip
    made = knobs._setup(tuned, "solver")
    level = made.effects.friction[1].level
    np.testing.assert_allclose(level, JOINT_DAMPING.effects.friction[1].level)  # to rounding
    same = replace(made.effects, friction=JOINT_DAMPING.effects.friction)
    assert replace(made, name=JOINT_DAMPING.name, effects=same) == JOINT_DAMPING


def test_without_its_start_a_recording_has_fewer_cases():
    whole = JOINT_DAMPING.record()
    late = _without_start(whole, 0.25)
    (x, y), (x2, y2) = (cases(r, 11) for r in (whole, late))
    assert len(y) == 6 * 300 and len(y2) == 6 * 275
    np.testing.assert_array_equal(y.reshape(6, 300, 2)[:, 25:], y2.reshape(6, 275, 2))
    np.testing.assert_array_equal(x.reshape(6, 300, 2, 11)[:, 25:], x2.reshape(6, 275, 2, 11))
    np.testing.assert_array_equal(cases(_without_start(whole, 0.0), 11)[1], y)
    with pytest.raises(ValueError, match="seconds"):
        _without_start(whole, -0.1)


# --- the regression -----------------------------------------------------------------------------


def polynomial(x):
    return 0.3 + x[:, 0] - 0.5 * x[:, 2] + 0.7 * x[:, 1] ** 2 - 0.4 * x[:, 0] * x[:, 1]


def test_the_emulator_is_least_squares_when_nothing_is_known_before():
    rng = np.random.default_rng(1)
    x = _screening()[:, :3]
    y = polynomial(x) + rng.normal(0, 0.1, 25)
    found = _Emulator.fit(x, y, 0.01, widths=(1e3, 1e3, 0.0))
    design = _terms(x)
    wanted = np.linalg.lstsq(design, y, rcond=None)[0]
    np.testing.assert_allclose(found.mean, wanted, atol=1e-3)
    np.testing.assert_allclose(
        found.covariance[1:, 1:],
        0.01 * np.linalg.inv(design.T @ design)[1:, 1:],
        rtol=1e-4,
        atol=1e-8,
    )


def test_what_a_polynomial_misses_makes_it_less_sure():
    """A kink is no polynomial: without noise the misfit has to stand for it."""
    x = _screening()[:, :3]
    found = _Emulator.fit(x, polynomial(x) + 0.8 * np.abs(x.sum(1)), 1e-6)
    assert found.misfit > 0 and (found.predict(x)[1] >= found.misfit).all()
    assert _Emulator.fit(x, polynomial(x), 1e-6).misfit == 0


def test_shares_of_the_variance():
    """Of 2 x1 + x2^2 + 3 x1 x3 over the cube: variances 4/3, 4/45 and 1."""
    coefficients = np.zeros(1 + 3 + 3 + 3)
    coefficients[[1, 5, 8]] = 2.0, 1.0, 3.0
    main, total = _shares(coefficients, 3)
    whole = 4 / 3 + 4 / 45 + 1
    np.testing.assert_allclose(main, np.array([4 / 3, 4 / 45, 0]) / whole)
    np.testing.assert_allclose(total, np.array([4 / 3 + 1, 4 / 45, 1]) / whole)
    x = np.random.default_rng(0).uniform(-1, 1, (200_000, 3))
    assert (_terms(x) @ coefficients).var() == pytest.approx(whole, rel=0.02)


# --- the posterior ------------------------------------------------------------------------------


def test_the_posterior_against_the_conjugate_one():
    """Knobs drawn from a normal distribution, two responses that are linear in them."""
    rng = np.random.default_rng(3)
    places = rng.normal(size=(400_000, 2))
    slopes = np.array([[1.0, 0.5], [-0.3, 0.8]])
    noise, unsure = np.array([[0.5, 0.1], [0.1, 0.4]]), np.array([0.1, 0.2])
    observed = np.array([0.7, -0.4])
    means = places @ slopes.T
    weights, evidence = _weigh(means, np.broadcast_to(unsure, means.shape), noise, observed)
    total = noise + np.diag(unsure)
    covariance = np.linalg.inv(np.eye(2) + slopes.T @ np.linalg.inv(total) @ slopes)
    mean, deviation = moments(places, weights)
    wanted = covariance @ slopes.T @ np.linalg.inv(total) @ observed
    np.testing.assert_allclose(mean, wanted, atol=0.01)
    np.testing.assert_allclose(deviation, np.sqrt(np.diag(covariance)), rtol=0.01)
    marginal = slopes @ slopes.T + total
    log = -0.5 * (
        observed @ np.linalg.solve(marginal, observed) + np.linalg.slogdet(2 * np.pi * marginal)[1]
    )
    assert evidence == pytest.approx(log, abs=0.01)
    assert weights.sum() == pytest.approx(1)


def test_what_another_number_would_tell_against_the_conjugate_one():
    """A number that is a knob plus noise: the variance falls by 1 / (1 + its precision)."""
    places = np.random.default_rng(4).normal(size=(20_000, 2))
    weights = np.full(len(places), 1 / len(places))
    told = would_tell(places, weights, places[:, 0], np.full(len(places), 0.25))
    np.testing.assert_allclose(told, [np.sqrt(0.25 / 1.25), 1.0], atol=0.02)
