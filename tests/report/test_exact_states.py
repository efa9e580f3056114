"""States of the simulated arm: the cube, a trajectory, the torque."""

import numpy as np

from ddlib.trajectories import pick_and_place
from workshop.report.exact_states import RADIUS, random_states, states_along


def test_random_states_fill_the_cube():
    states = random_states(20_000, seed=3)
    assert states.shape == (20_000, 2, 3) and np.abs(states).max() < RADIUS
    flat = states.reshape(-1, 6)
    np.testing.assert_allclose(flat.std(0), RADIUS / np.sqrt(3), rtol=0.02)
    np.testing.assert_allclose(np.corrcoef(flat.T), np.eye(6), atol=0.03)
    assert (np.abs(flat).max(0) > 0.999 * RADIUS).all()


def test_states_along_a_trajectory_are_its_samples():
    states = states_along((39.5, 14.4), 300)
    motion = pick_and_place((39.5, 14.4), np.arange(300) * 0.01)
    for k, series in enumerate(motion):
        np.testing.assert_allclose(states[..., k], series, atol=1e-12)
