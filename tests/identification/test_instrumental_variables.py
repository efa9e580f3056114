"""Instrumental variables against the textbook, and on arms whose acceleration is noisy."""

from dataclasses import replace

import numpy as np
import pytest

from ddlib.control import pd
from ddlib.dynamics import CMU_DD_ARM_II
from ddlib.effects import (
    CMU_DD_ARM_II_EFFECTS,
    IDEAL,
    CoulombFriction,
    Quantisation,
    ViscousFriction,
)
from ddlib.identification import (
    FRICTION,
    RIGID,
    Equations,
    by_butterworth,
    instrumental_variables,
    least_squares,
    repeat,
    true_parameters,
)
from ddlib.simulation import record
from ddlib.trajectories import APPENDIX_I

LOOP = pd((300.0, 90.0), (35.0, 10.0))


def noisy(repetitions, samples, wrong, seed=0):
    """A line whose regressor is read twice with independent noise."""
    rng = np.random.default_rng(seed)
    x = rng.normal(size=(samples, 2))
    y = x @ [2.0, -1.0] + 0.1 * rng.normal(size=(repetitions, samples))
    first, second = x + wrong * rng.normal(size=(2, repetitions, samples, 2))
    return (Equations(("p", "r"), (z,), (y,)) for z in (first, second))


def test_one_joint_is_the_textbooks_formula():
    equations, instruments = noisy(3, 50, 0.3)
    found = instrumental_variables(equations, instruments, memory=0)
    x, z, y = equations.regressor[0], instruments.regressor[0], equations.torque[0]
    for k in range(3):
        values = np.linalg.solve(z[k].T @ x[k], z[k].T @ y[k])
        np.testing.assert_allclose(found.values[k], values, rtol=1e-10)
        left = y[k] - x[k] @ values
        bread = np.linalg.inv(z[k].T @ x[k])
        drawn = np.einsum("np,pq,nq->n", x[k], bread, z[k])
        left = left / (1 - np.maximum(drawn, 0))  # MacKinnon & White 1985, their third
        meat = (z[k] * left[:, None] ** 2).T @ z[k]
        errors = np.sqrt(np.diag(bread @ meat @ bread.T))
        np.testing.assert_allclose(found.errors[k], errors, rtol=1e-10)


def test_noise_in_the_regressor_shrinks_least_squares_and_not_this():
    equations, instruments = noisy(400, 400, 0.5)
    shrunk = least_squares(equations).values.mean(0)
    np.testing.assert_allclose(shrunk, np.array([2.0, -1.0]) / 1.25, rtol=0.06)
    found = instrumental_variables(equations, instruments)
    np.testing.assert_allclose(found.values.mean(0), [2.0, -1.0], rtol=0.02)
    share = found.covers([2.0, -1.0]).mean(0)
    assert (np.abs(share - 0.95) < 0.035).all()  # three deviations of a binomial


def test_intervals_hold_the_truth_with_a_dozen_equations():
    """Residuals as they are, though corrected for their number, gave .90."""
    equations, instruments = noisy(4000, 12, 0.1)
    share = instrumental_variables(equations, instruments, memory=0).covers([2.0, -1.0]).mean(0)
    assert (np.abs(share - 0.95) < 0.015).all()


def test_instruments_like_the_regressor_are_least_squares():
    equations, _ = noisy(2, 60, 0.2)
    found, plain = instrumental_variables(equations, equations), least_squares(equations)
    np.testing.assert_allclose(found.values, plain.values, rtol=1e-10)


def test_intervals_hold_the_truth_where_noise_is_shared_by_neighbours():
    """Second differences of noise as the regressor's noise, as from readings of a position."""
    rng, repetitions, n = np.random.default_rng(4), 300, 600
    x = np.sin(np.arange(n) * 0.05)[:, None]
    wrong = np.diff(rng.normal(size=(2, repetitions, n + 2)), 2)[..., None]
    slow = np.convolve(rng.normal(size=n * repetitions), np.ones(5) / 5, "same")
    y = 3 * x[:, 0] + 0.2 * slow.reshape(repetitions, n)
    equations, instruments = (Equations(("p",), (x + 0.5 * w,), (y,)) for w in wrong)
    share = instrumental_variables(equations, instruments).covers([3.0]).mean()
    assert 0.9 <= share
    assert least_squares(equations).covers([3.0]).mean() < 0.05


@pytest.mark.parametrize("bits", [16, 12])
def test_a_first_estimates_simulation_is_an_instrument_for_the_arm(bits):
    """Inertias from a coarse encoder, at a bandwidth that lets much of its noise through."""
    names = RIGID + FRICTION
    effects = replace(CMU_DD_ARM_II_EFFECTS, encoder=(Quantisation.encoder(bits),))
    many = repeat(CMU_DD_ARM_II, LOOP, APPENDIX_I[:5], effects, 60, seed=3)
    truth = true_parameters(CMU_DD_ARM_II, effects, names)
    first = replace(CMU_DD_ARM_II, a=truth[0] * 1.03, b=truth[1] * 0.95, d=truth[2] * 0.97)
    friction = (ViscousFriction((0.4, 0.2)), CoulombFriction((0.6, 0.1)))
    guess = record(first, LOOP, APPENDIX_I[:5], effects=replace(IDEAL, friction=friction))
    guess = guess.mapped(lambda x: np.broadcast_to(x, (60, *x.shape)))
    guess = replace(guess, reference=many.reference)
    how = {"cutoff": 30.0, "width": 0.3 if bits == 12 else 0.6}
    equations = by_butterworth(many, names=names, rows=guess, **how)
    found = instrumental_variables(equations, by_butterworth(guess, names=names, **how))
    off = np.abs(found.values.mean(0) / truth - 1)[:3]
    assert off.max() < 0.04
    share = found.covers(truth).mean(0)
    assert share.min() > 0.8 and share.mean() > 0.9
