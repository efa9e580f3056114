"""The plant: order of the integrator, joints that truly stick, springs and their energy."""

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy.integrate import solve_ivp

from ddlib.dynamics import CMU_DD_ARM_II, IMI_ARM, REYES_KELLY_ARM
from ddlib.effects import (
    CoulombFriction,
    Effects,
    FlexibleJoint,
    Ripple,
    StickSlipFriction,
    ViscousFriction,
)
from ddlib.simulation.plant import Plant, runge_kutta_steps

ARM = CMU_DD_ARM_II
STICKY = StickSlipFriction((0.5, 0.15), (0.65, 0.2))
PAIR = st.tuples(st.floats(-3, 3), st.floats(-3, 3)).map(np.array)


def stick(*frictions, **parts):
    return Effects(friction=frictions or (STICKY,), **parts)


def march(plant, x, v, tau, step, count):
    """States along `count` steps under a constant torque."""
    states = [(x, v)]
    for _ in range(count):
        states.append(plant.advance(*states[-1], tau, step))
    return [np.stack(series) for series in zip(*states)]


def total_energy(arm, shaft, x, v):
    mass = shaft.mass_matrix(arm, x[..., :2])
    kinetic = 0.5 * np.einsum("...i,...ij,...j", v, mass, v)
    twist = np.abs(x[..., 2:] - x[..., :2])
    pressed = np.maximum(twist - np.array(shaft.gap) / 2, 0.0)
    springs = 0.5 * (np.array(shaft.stiffness) * pressed**2).sum(-1)
    return kinetic + arm.potential_energy(x[..., :2]) + springs


def test_runge_kutta_is_of_fourth_order():
    arm, tau = REYES_KELLY_ARM, np.array([20.0, -3.0])
    effects = Effects(friction=(ViscousFriction((2.3, 0.2)),))

    def rate(_, y):
        net = tau - effects.friction_torque(y[2:])
        return [*y[2:], *arm.forward_dynamics(y[:2], y[2:], net)]

    start = np.array([0.4, 0.6, 1.0, -0.5])
    exact = solve_ivp(rate, (0, 0.4), start, "DOP853", rtol=1e-13, atol=1e-14).y[:, -1]
    errors = []
    for steps in (10, 20, 40):
        q, qd = march(Plant(arm, effects), start[:2], start[2:], tau, 0.4 / steps, steps)
        errors.append(np.linalg.norm([*q[-1], *qd[-1]] - exact))
    order = np.log2(np.array(errors[:-1]) / errors[1:])
    np.testing.assert_allclose(order, 4.0, atol=0.4)
    assert errors[-1] < 1e-5


def test_cogging_stores_energy_and_gives_it_back():
    """Its torque is minus the slope of ``cogging / cycles cos(cycles q)``."""
    ripple = Ripple(cogging=(2.0, 0.5), cycles=(7, 12), phase=0.4)
    plant, start = Plant(ARM, Effects(motor=(ripple,))), np.array([[0.3, 0.5], [1.0, -2.5]])
    q, qd = march(plant, *start, np.zeros(2), 0.001, 4000)
    stored = np.array([2.0, 0.5]) / [7, 12] * np.cos(np.array([7, 12]) * q + 0.4)
    moving = ARM.kinetic_energy(q, qd)
    np.testing.assert_allclose(moving + stored.sum(-1), moving[0] + stored[0].sum(), rtol=1e-6)
    assert np.ptp(moving) > 0.1


SHORT_OF_ONE = st.floats(-1 + 1e-9, 1 - 1e-9)
"""Share of the breakaway torque; of all of it, rounding decides whether it holds."""


@settings(deadline=None, max_examples=50)
@given(q=PAIR, share=st.tuples(SHORT_OF_ONE, SHORT_OF_ONE).map(np.array))
def test_a_stuck_arm_does_not_move_at_all(q, share):
    """Below the breakaway torque friction equals the applied torque, and does no work."""
    x, v = march(Plant(ARM, stick()), q, np.zeros(2), share * STICKY.breakaway, 0.002, 20)
    assert (x == q).all() and not v.any()


@settings(deadline=None, max_examples=100)
@given(q=PAIR, tau=PAIR)
def test_friction_at_rest_is_as_large_as_it_has_to_be_and_no_larger(q, tau):
    """What friction was follows from the motion: within its limits, and at them if it moves."""
    step = 1e-6
    _, v = Plant(ARM, stick()).advance(q, np.zeros(2), tau, step)
    friction = tau - ARM.inverse_dynamics(q, np.zeros(2), v / step)
    limit = np.array(STICKY.breakaway)
    assert (np.abs(friction) <= limit + 1e-5).all()
    moving = v != 0
    np.testing.assert_allclose(friction[moving], (limit * np.sign(v))[moving], atol=1e-5)
    # Gauss: no other choice of sticking and sliding is consistent with that
    assert not moving.any() or (np.abs(tau) > limit).any()


@pytest.mark.parametrize("flexible", [False, True], ids=["rigid", "flexible"])
@pytest.mark.parametrize("arm", [ARM, REYES_KELLY_ARM], ids=lambda a: a.name)
def test_friction_never_creates_energy(arm, flexible):
    shaft = FlexibleJoint((2e3, 6e2), (0.2, 0.02))
    friction = StickSlipFriction((5.0, 1.5), (7.0, 2.0))
    plant = Plant(arm, stick(friction, transmission=(shaft,) if flexible else ()))
    q, qd = np.random.default_rng(1).uniform(-3, 3, (2, 40, 2))
    x, v = plant.rest(q)
    v = v + (np.tile(qd, 2) if flexible else qd)
    x, v = march(plant, x, v, np.zeros(2), 0.001, 400)
    if flexible:
        energy = total_energy(arm, shaft, x, v)
    else:
        energy = arm.potential_energy(x) + arm.kinetic_energy(x, v)
    assert np.diff(energy, axis=0).max() < 1e-7 * np.ptp(energy)
    assert (~v[..., -2:].astype(bool)).any((0, 2)).mean() > 0.5  # many have come to a stop
    assert (energy[-1] < energy[0] - 0.1).all()


def test_stick_slip_against_its_closed_form():
    """A spring pulled steadily: stick until the breakaway torque F_s, slip, stick again.

    With friction that falls at once to F_c the spring's stretch swings about F_c / k while
    the joint slips: it begins A = (F_s - F_c) / k above and ends as far below, after
    2 (pi - arctan(A w / V)) / w with w = sqrt(k / J) and the pull's speed V.
    """
    k, pull, coulomb, breakaway = 400.0, 0.05, 1.0, 3.0
    friction = StickSlipFriction((coulomb, 1e6), (breakaway, 1e6), speed=1e-6)
    w = np.sqrt(k / ARM.mass_matrix([0.0, 0.0])[0, 0])
    swing = (breakaway - coulomb) / k
    slip = 2 * (np.pi - np.arctan(swing * w / pull)) / w
    rest, jump = 2 * swing / pull, pull * slip + 2 * swing

    def simulated(step):
        """Errors of the first stop, of the rest that follows, and of the jumps."""
        plant, x, v, path = Plant(ARM, stick(friction)), np.zeros(2), np.zeros(2), []
        for n in range(round((breakaway / k / pull + 2.2 * slip + rest) / step)):
            middle = pull * (n + 0.5) * step - x[0] - 0.5 * step * v[0]  # of a held torque
            x, v = plant.advance(x, v, np.array([k * middle, 0.0]), step)
            path.append((x[0], v[0] != 0))
        angle, moving = np.array(path).T
        starts, stops = (np.flatnonzero(np.diff(moving) == s) for s in (1, -1))
        assert len(starts) == len(stops) == 2
        return np.array([
            starts[0] * step - breakaway / k / pull, (stops[0] - starts[0]) * step - slip,
            (starts[1] - stops[0]) * step - rest, *(np.diff(angle[[0, *stops]]) - jump),
        ])  # fmt: skip

    errors = np.abs(simulated(2e-3))
    assert (errors[:3] <= 2.5 * 2e-3).all() and (errors[3:] < 2e-3 * jump).all()


@pytest.mark.parametrize("gap", [(0.0, 0.0), (0.02, 0.05)], ids=["springs", "with play"])
@pytest.mark.parametrize("arm", [ARM, REYES_KELLY_ARM], ids=lambda a: a.name)
def test_springs_and_rotors_keep_their_energy(arm, gap):
    """The kinetic energy is a quadratic form of its own: this checks the equations of motion."""
    shaft = FlexibleJoint((2e3, 6e2), (0.3, 0.05), gap=gap)
    x = np.array([[0.3, 0.5, 0.32, 0.4], [-1.0, 2.0, -1.0, 2.0]])
    v = np.array([[1.0, -0.5, 0.0, 3.0], [0.8, 1.5, -2.0, 1.5]])
    step = 1e-4 if gap[0] else 5e-4
    states = march(Plant(arm, Effects(transmission=(shaft,))), x, v, np.zeros(2), step, 3000)
    energy = total_energy(arm, shaft, *states)
    np.testing.assert_allclose(energy, np.tile(energy[0], (3001, 1)), rtol=2e-4)
    twist = np.abs(states[0][..., 2:] - states[0][..., :2])
    assert (twist.max((0, 1)) > np.array(gap) / 2).all()  # every spring has been pressed


def test_substeps_agree_with_an_implicit_solver():
    friction = (ViscousFriction((5.3, 1.1)), CoulombFriction((8.45, 2.35)))
    effects = Effects(friction=friction)

    def slide(_, state):
        qd = state[2:]
        net = -effects.friction_torque(qd)
        return np.concatenate([qd, IMI_ARM.forward_dynamics(state[:2], qd, net)])

    start = np.array([0.0, 0.3, 1.0, -2.0])
    implicit = solve_ivp(slide, (0, 1.0), start, method="Radau", rtol=1e-9, atol=1e-11).y[:, -1]
    parts = int(runge_kutta_steps(IMI_ARM, effects, 0.002))
    assert parts > 4 and runge_kutta_steps(CMU_DD_ARM_II, Effects(), 0.002) == 1
    plant = Plant(IMI_ARM, effects)
    for steps, close in ((500 * parts, True), (500, False)):  # with whole periods it chatters
        q, _ = march(plant, start[:2], start[2:], np.zeros(2), 1.0 / steps, steps)
        assert np.allclose(q[-1], implicit[:2], atol=1e-5) is close
