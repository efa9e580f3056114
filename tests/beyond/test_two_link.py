"""A real two-link arm: equations with known parameters, and measures on planted results."""

import numpy as np
import pytest

from beyond.chapters import real_two_link_arm as chapter
from beyond.studies import two_link
from ddlib.dynamics import Arm


@pytest.fixture
def motion():
    t = 0.01 * np.arange(600)
    return np.stack([np.sin(4 * t), 1.3 * np.sin(5.7 * t + 1)], -1)


@pytest.mark.parametrize("design", two_link.PUBLISHED)
def test_least_squares_finds_what_made_the_torques(motion, design):
    parameters = np.array(list(two_link.PUBLISHED[design].values()))
    rows = two_link.regressor(two_link.fitted_states(motion, 7))
    np.testing.assert_allclose(
        two_link.parameters_of(rows, rows @ parameters), parameters, atol=1e-9
    )


def test_slopes_are_the_mass_matrix_and_the_weight(motion):
    a, b, d, g1, g2 = 0.3, 0.05, 0.08, 2.0, 1.1
    arm = Arm("real", a, b, d, lengths=(0.3, 0.2), gravity_moments=(g1, g2))
    parameters = np.array([a, b, d, g1, g2, 0.004, 0.02, 0.03, 0, 0, 0, 0])
    still = np.stack([motion, 0 * motion + 1e-9, 0 * motion], -1)
    found = two_link._slopes(still, parameters)
    mass = arm.mass_matrix(motion) + np.diag([0, 0.004])
    np.testing.assert_allclose(found[..., 2], mass, atol=1e-6)
    np.testing.assert_allclose(
        found[..., 1], np.diag([0.02, 0.03]) * np.ones((600, 2, 2)), atol=1e-6
    )
    weight = g2 * np.cos(motion.sum(-1))
    np.testing.assert_allclose(found[:, 1, 0, 0], weight, atol=1e-6)
    np.testing.assert_allclose(found[:, 0, 0, 0] - weight, g1 * np.cos(motion[:, 0]), atol=1e-6)


def test_measures_on_planted_networks(planted_results):
    def design(elbow, times):
        true = np.zeros((2, 2, 3))
        true[0, 0, 2], true[1, 1, 2] = 0.2, elbow
        made = true * np.array(times)[:, None, None, None]
        return {"read": {"41": {"published": true.tolist(), "networks": made.tolist()}}}

    planted = {"A0": design(0.03, [1.0] * 10), "C0": design(0.06, [0.8] * 10)}
    planted["C1"] = design(0.06, [1.5] * 10)
    planted_results(**{"two-link": {"designs": planted}})
    chapter._inertia.cache_clear()
    assert chapter.inertia_off().value == pytest.approx(1.5)
    assert chapter.elbow_moves().value == pytest.approx(1.6)
    chapter._inertia.cache_clear()
