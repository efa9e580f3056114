"""What ridge regression leaves of an inertia, against least squares and signals made for it."""

import numpy as np
import pytest

from ddlib.analysis import gains, half_penalty, ridge_filters
from ddlib.learning import TrainingSet, sliding_windows
from ddlib.simulation import LOG_STEP

MASS = 5.0
TIME = np.arange(-100, 700) * LOG_STEP


def swung(swing, rate=6.0):
    """Windows, torques MASS * acceleration, and states of a slow sine with a faster swing on it."""
    rates, sizes = np.array([1.0, rate]), np.array([[1.0, swing], [0.7, 0.0]])
    phases = rates * TIME[:, None] + [[0.0, 0.4]]
    q, qdd = np.sin(phases) @ sizes.T, -(rates**2 * np.sin(phases)) @ sizes.T
    q[:, 1], qdd[:, 1] = 0.7 * np.cos(1.3 * TIME), -0.7 * 1.69 * np.cos(1.3 * TIME)
    x, inside = sliding_windows(q, 21), slice(10, -10)
    states = np.stack([q, np.gradient(q, LOG_STEP, axis=0), qdd], -1)[inside]
    return TrainingSet.from_arrays(x, MASS * qdd[inside], scaling=(-1, 1), step=LOG_STEP), states


def test_ridge_solves_the_least_squares_problem_with_the_penalty_as_rows():
    data, _ = swung(0.05)
    x, y = (a.reshape(len(a), -1) for a in (data.x, data.y))
    for penalty in (1e-4, 0.3):
        rows = np.sqrt(penalty * len(x)) * np.eye(x.shape[1])
        padded = np.vstack([x - x.mean(0), rows]), np.vstack([y - y.mean(0), np.zeros((42, 2))])
        wanted = np.linalg.lstsq(*padded, rcond=None)[0].T.reshape(2, 2, 21)
        wanted = wanted * data.inputs.gain[:, None] / data.outputs.gain[:, None, None]
        assert np.allclose(ridge_filters(data, [1.0, penalty])[1], wanted, atol=1e-8)


@pytest.mark.parametrize("swing", [0.003, 0.01, 0.05])
def test_half_of_the_mass_is_left_where_theory_says(swing):
    data, states = swung(swing)
    half = half_penalty(data, states)
    penalties = half * np.array([1 / 30, 1 / 3, 1.0, 3.0, 30.0])
    mass = gains(ridge_filters(data, penalties), LOG_STEP)[:, 0, 0, 2] / MASS
    assert np.allclose(mass, [30 / 31, 3 / 4, 1 / 2, 1 / 4, 1 / 31], atol=0.09)


def test_along_one_sine_no_acceleration_is_left():
    assert half_penalty(*swung(0.0)) < 1e-12 < 1e-6 < half_penalty(*swung(0.01))


@pytest.mark.parametrize("step", [0.002, 0.004, 0.02])
def test_the_penalty_is_that_of_the_datas_own_step(step):
    """Of one motion, a window of as many seconds has nearly the same parabola."""
    t = np.arange(-2.0, 8.0, step)
    q = np.stack([0.3 * np.sin(3 * t) + 0.2 * np.sin(7 * t), 0.3 * np.sin(2 * t)], -1)
    qdd = -np.stack([2.7 * np.sin(3 * t) + 9.8 * np.sin(7 * t), 1.2 * np.sin(2 * t)], -1)
    width = round(0.2 / step) + 1
    half = width // 2
    x = sliding_windows(q, width)
    states = np.stack([q, 0 * q, qdd], -1)[half:-half]
    data = TrainingSet.from_arrays(x, MASS * states[..., 2], scaling=(-1, 1), step=step)
    assert data.step == step
    given = [1e-30, half_penalty(data, states)]
    mass = gains(ridge_filters(data, given), step)[:, 0, 0, 2] / MASS
    np.testing.assert_allclose(mass, [1.0, 0.5], atol=0.1)
