"""Instruments and smoothers on the swinging arm, where the true parameters are known."""

from functools import cache

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from beyond.studies import two_link
from beyond.studies.checks import instruments
from ddlib.dynamics import Arm

PARAMETERS = np.array([0.135, 0.033, 0.023, 3.4, 1.1, 0.003, 0.02, 0.02, 0.05, 0.05, 0, 0])


ARM = Arm("driven", *PARAMETERS[:3], lengths=(0.3, 0.2), gravity_moments=tuple(PARAMETERS[3:5]))
ROTOR = np.diag([0, PARAMETERS[5]])


def _left(q, v, torque):
    """What friction, gravity and velocities leave of a torque for the acceleration."""
    rubs = PARAMETERS[6:8] * v + PARAMETERS[8:10] * np.tanh(v / 0.05)
    return torque - rubs - ARM.inverse_dynamics(q, v, np.zeros(2))


@cache
def _driven(phase):
    """The arm in open loop: positions on a grid of 10 ms, and the torques that drive it."""

    def torque(t):
        return np.stack([0.5 * np.sin(5 * t + phase), 0.4 * np.sin(7 * t + 2 * phase)], -1)

    def change(t, x):
        q, v = x[:2], x[2:]
        return [*v, *np.linalg.solve(ARM.mass_matrix(q) + ROTOR, _left(q, v, torque(t)))]

    t = two_link.STEP * np.arange(600)
    q = solve_ivp(change, (0, t[-1]), np.zeros(4), t_eval=t, rtol=1e-5, atol=1e-7).y[:2].T
    return q, torque(t)


@pytest.fixture
def noisy(monkeypatch):
    rng = np.random.default_rng(1)
    made = {k: _driven(k) for k in range(4)}
    # wiggles from one sample to the next, as those of the real arm
    seen = {
        k: (q + 0.002 * rng.standard_normal(q.shape), torque) for k, (q, torque) in made.items()
    }
    monkeypatch.setattr(two_link, "recorded_run", lambda run: seen[run])
    monkeypatch.setattr(instruments, "_commanded", lambda run: made[run][1])
    return tuple(made)


def test_accelerations_are_those_of_the_equations():
    rng = np.random.default_rng(0)
    states, torque = rng.normal(size=(50, 2, 3)), rng.normal(size=(50, 2))
    q, v = states[..., 0], states[..., 1]
    expected = np.linalg.solve(ARM.mass_matrix(q) + ROTOR, _left(q, v, torque)[..., None])[..., 0]
    np.testing.assert_allclose(instruments._caused(PARAMETERS, states, torque), expected)


def test_instruments_find_what_plain_least_squares_loses(noisy):
    plain = two_link._found(noisy, 5)
    found = instruments._by_instruments(noisy, 5)
    assert plain[3] < 0.6 * PARAMETERS[3]
    np.testing.assert_allclose(found[:5], PARAMETERS[:5], rtol=0.1)


def test_smoothers_find_the_arm_without_noise(monkeypatch):
    monkeypatch.setattr(two_link, "recorded_run", _driven)
    for both in (False, True):
        found = instruments._butterworth((0, 1, 2), 16.0, both)
        np.testing.assert_allclose(found[:5], PARAMETERS[:5], rtol=0.05)
