"""The studies of characters and of intervals: how errors, parts and shares are found."""

import numpy as np
import pytest

from beyond.rivals.protocol import Cases
from beyond.studies import characters, rivals
from beyond.studies.checks import published


@pytest.fixture(scope="module")
def drawn():
    return characters.data().of(("e", "q", "v"))


def exact(x):
    return characters.ARM.inverse_dynamics(*np.moveaxis(x, -1, 0))


def test_the_parts_of_the_exact_arm_are_those_of_the_file(drawn):
    found = characters._parts(exact, characters.states(drawn).x)
    for name in ("inertial", "coriolis", "gravity"):
        np.testing.assert_allclose(found[name], getattr(drawn, name), atol=1e-13)
    np.testing.assert_allclose(found["mass_matrix"], drawn.mass_matrix, atol=1e-13)
    np.testing.assert_allclose(found["torque"], drawn.tau, atol=1e-13)
    assert max(characters._errors(found, drawn).values()) < 1e-12


def test_at_twice_the_speed_torques_follow_the_square_of_time(drawn):
    x = characters.states(drawn).x
    assert characters._hurried(exact, x) < 1e-12
    still = characters._hurried(lambda fast: exact(fast) + np.array([0.3, 0.4]), x)
    moved = 4 * (drawn.tau - drawn.gravity) + drawn.gravity
    assert still == pytest.approx(0.5 / np.sqrt(moved.var(0).sum()))


def test_the_share_that_intervals_hold():
    x, torque = np.zeros((40, 2, 3)), np.zeros((40, 2))
    torque[:10] = 5.0

    class Fixed:
        def torque(self, x):
            return np.zeros((len(x), 2))

        def deviation(self, x):
            return np.full((len(x), 2), 2.0)

    found = rivals._interval_row(Fixed(), Cases(x, torque, "states", 0.01))
    assert found["covered"] == 0.75  # 5 lies outside 1.96 times 2
    np.testing.assert_allclose(found["half width"], 2 * 1.96, rtol=1e-4)
    assert found["rmss"] == pytest.approx(2.5 / torque.std())


def test_published_weights_keep_their_energy(drawn):
    """Power goes into energy, whose parts a finite step along the motion tells."""
    weights, x = published._published(3), characters.states(drawn, 0.0).x[::7]

    def energy(q, qd):
        at = np.stack([q, 0 * q, 0 * q], -1)
        mass = characters._parts(lambda x: published._lagrangian(weights, x), at)["mass_matrix"]
        assert (np.linalg.eigvalsh(mass) > 0).all()
        np.testing.assert_allclose(mass, mass.mT, atol=1e-12)
        stored = published._layers(weights, "potential_energy", q)[0][:, 0]
        return np.einsum("ni,nij,nj->n", qd, mass, qd) / 2 + stored

    (q, qd, qdd), step = np.moveaxis(x, -1, 0), 1e-5
    ends = [energy(q + h * qd + h**2 / 2 * qdd, qd + h * qdd) for h in (-step, step)]
    power = (published._lagrangian(weights, x) * qd).sum(-1)
    np.testing.assert_allclose((ends[1] - ends[0]) / (2 * step), power, rtol=1e-5, atol=1e-6)
