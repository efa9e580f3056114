"""Deep Lagrangian Networks: Lagrange's equation by other means, mass, energy, a known arm."""

import numpy as np
import pytest
import torch

from beyond.rivals.lagrangian import LagrangianNetwork
from beyond.rivals.protocol import Cases
from ddlib.dynamics import CMU_DD_ARM_II, Arm

STEP = 0.01
UPRIGHT = Arm("upright", 1.37, 0.5, 0.52, (1.0, 1.0), (2.6, 1.5))


def states(samples, seed=0, size=1.5, joints=2):
    return np.random.default_rng(seed).uniform(-size, size, (samples, joints, 3))


def untrained(seed=0, joints=2, gain=1.0, **options):
    """A network with random weights, in the units of random data."""
    torque = 5 * np.random.default_rng(seed + 1).standard_normal((50, joints))
    cases = Cases(states(50, seed, 2.0, joints), torque, "states", STEP)
    rival = LagrangianNetwork((12, 9), epochs=0, seed=seed, **options).fit(cases)
    with torch.no_grad():
        for p in rival.network.parameters():
            p.copy_(gain * torch.randn(p.shape, generator=torch.Generator().manual_seed(seed)))
    return rival


def known(arm, samples, seed=0, friction=(0.0, 0.0)):
    x = states(samples, seed)
    q, qd, qdd = np.moveaxis(x, -1, 0)
    torque = arm.inverse_dynamics(q, qd, qdd)
    torque += np.array(friction[0]) * qd + np.array(friction[1]) * np.sign(qd)
    return Cases(x, torque, "states", STEP)


@pytest.mark.parametrize("joints, diagonal", [(2, "softplus"), (3, "relu")])
def test_torque_is_lagranges_equation_of_the_energies(joints, diagonal):
    rival = untrained(3, joints, gain=0.5, diagonal=diagonal)
    q, qd, qdd = np.moveaxis(states(6, 4, joints=joints), -1, 0)
    found = rival._torque(np.stack([q, qd, qdd], -1))
    for k in range(6):
        np.testing.assert_allclose(found[k], lagrange(rival, q[k], qd[k], qdd[k]), 1e-5, 1e-4)


def lagrange(rival, q, qd, qdd, h=1e-4):
    """d/dt dT/dqd - dT/dq + dV/dq, by differences of the energies alone."""

    def kinetic(position, velocity):
        return 0.5 * velocity @ rival.mass_matrix(position) @ velocity

    def momentum(t):
        return rival.mass_matrix(q + qd * t + 0.5 * qdd * t**2) @ (qd + qdd * t)

    torque = (momentum(h) - momentum(-h)) / (2 * h)
    for j, e in enumerate(np.eye(len(q)) * h):
        torque[j] -= (kinetic(q + e, qd) - kinetic(q - e, qd)) / (2 * h)
        torque[j] += (rival.potential_energy(q + e) - rival.potential_energy(q - e)) / (2 * h)
    return torque


def test_a_known_arm_is_recovered_from_torques_alone():
    arm = UPRIGHT
    train, test = known(arm, 600), known(arm, 200, 1)
    rival = LagrangianNetwork((16, 16), epochs=200, finish=600).fit(train)
    q = test.x[..., 0]

    def off(found, wanted):
        return np.sqrt(np.mean((found - wanted) ** 2) / np.mean(wanted**2))

    assert off(rival._torque(test.x), test.torque) < 0.01
    assert off(rival.mass_matrix(q), arm.mass_matrix(q)) < 0.01
    still = np.stack([q, 0 * q, 0 * q], -1)
    assert off(rival._torque(still), arm.gravity(q)) < 0.01
    potential = rival.potential_energy(q) - arm.potential_energy(q)
    assert potential.std() < 0.01 * arm.potential_energy(q).std()


def test_friction_is_recovered_beside_the_arm():
    friction = ([0.8, 0.5], [1.5, 0.7])
    rival = LagrangianNetwork((24, 24), gravity="none", friction=True, epochs=150, finish=200)
    rival.fit(known(CMU_DD_ARM_II, 500, friction=friction))
    qd = np.array([[1.0, 1.0], [-0.5, 0.5]])
    there, back = (rival._torque(np.stack([0 * v, v, 0 * v], -1)) for v in (qd, -qd))
    wanted = np.array(friction[0]) * qd + np.array(friction[1]) * np.sign(qd)
    np.testing.assert_allclose((there - back) / 2, wanted, rtol=0.02)  # all else is even in speed
