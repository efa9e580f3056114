"""Friction with a memory: bristles against their differential equation, and what they explain."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from ddlib.dynamics import CMU_DD_ARM_II as ARM
from ddlib.effects import Effects, LuGreFriction, ViscousFriction
from ddlib.simulation import follow, free_motion
from ddlib.simulation.plant import Plant, runge_kutta_steps
from ddlib.trajectories import Trajectory

LAW = LuGreFriction((0.5, 0.15), (0.7, 0.2), 0.02, (800.0, 250.0), (4.0, 1.2))
OIL = ViscousFriction((0.3, 0.1))
EFFECTS = Effects(friction=(OIL, LAW))


def pushed(torque, steps, step=0.002, effects=EFFECTS, parts=None):
    """Angles and velocities of an arm at rest, under a torque of the time held for each step."""
    plant, (x, v) = Plant(ARM, effects), (np.zeros(2), np.zeros(2))
    parts = parts or int(runge_kutta_steps(ARM, effects, step))
    path = []
    for k in range(steps):
        for _ in range(parts):
            x, v = plant.advance(x, v, torque(k * step), step / parts)
        path.append((x, v))
    return np.moveaxis(path, 1, 0)


def exact(torque, steps, step=0.002):
    """The same by the five equations of arm and bristles, of an integrator for stiff ones."""

    def rate(_, y, tau):
        q, v, z = y.reshape(3, 2)
        bend = v - LAW.stiffness * np.abs(v) * z / LAW.size(v)
        rubbing = LAW.stiffness * z + LAW.damping * bend + OIL.torque(v)
        return np.concatenate([v, ARM.forward_dynamics(q, v, tau - rubbing), bend])

    y, path = np.zeros(6), []
    for k in range(steps):
        tau = (torque(k * step),)
        y = solve_ivp(rate, (0, step), y, "Radau", args=tau, rtol=1e-9, atol=1e-12).y[:, -1]
        path.append(y[:4].reshape(2, 2))
    return np.moveaxis(path, 1, 0)


def swing(t):
    return np.array([8.0, 1.5]) * np.sin(2 * np.pi * 2 * t)


def test_bristles_follow_their_equation_and_converge_in_second_order():
    wanted = exact(swing, 150)
    parts = int(runge_kutta_steps(ARM, EFFECTS, 0.002))
    errors = [np.abs(pushed(swing, 150, parts=n * parts)[0] - wanted[0]).max() for n in (1, 2, 4)]
    assert np.abs(wanted[0]).max() > 0.03 and errors[0] < 2e-4
    assert (np.log2(np.divide(errors[:-1], errors[1:])) > 1.5).all()


def test_a_joint_yields_like_a_spring_before_it_breaks_away_and_comes_almost_back():
    """Slowly loaded the bristles' equation has a closed form, and so has what is left of it."""
    push = 0.6 * np.array([0.5, 0.15])
    held = pushed(lambda t: push * (1 - np.cos(np.pi / 4 * min(t, 8.0))) / 2, 4200)[0]
    share, unit = push / LAW.breakaway, np.divide(LAW.breakaway, LAW.stiffness)
    np.testing.assert_allclose(held[2000], -unit * np.log(1 - share), rtol=0.03)
    np.testing.assert_allclose(held[-1], -unit * np.log(1 - share**2), rtol=0.06)


def test_slow_sliding_is_opposed_more_while_it_speeds_up():
    """The lag that no friction without a memory has (Canudas de Wit et al. 1995, Fig. 5)."""
    memory, rubbing = LAW.start(), []
    speeds = 0.02 + 0.015 * np.sin(2 * np.pi * np.arange(4000) / 2000)
    for v in speeds:
        memory.slide(np.array([v, v]), 1e-3)
        rubbing.append(memory.torque(np.array([v, v])))
    last = np.array(rubbing[2000:])
    up, down = last[:500], last[500:1000][::-1]  # from the mean speed to the largest, and back
    assert (up.mean(0) > down.mean(0)).all()
    for _ in range(3000):
        memory.slide(np.array([0.5, -0.5]), 1e-3)
    steady = memory.torque(np.array([0.5, -0.5]))
    np.testing.assert_allclose(steady, LAW.torque(np.array([0.5, -0.5])), rtol=1e-6)


def test_a_thrown_arm_comes_to_rest_and_stays():
    law = replace(LAW, damping=(80.0, 15.0))
    t, q, qd = free_motion(ARM, (0.2, -0.5), (0.5, -1.0), 8.0, 0.001, Effects(friction=(law,)))
    assert np.abs(q[-1] - (0.2, -0.5)).min() > 0.01
    assert np.abs(qd[-1]).max() < 1e-6 and np.ptp(q[t > 7], axis=0).max() < 1e-6


def test_no_run_depends_on_another():
    laws = [LuGreFriction(s * np.array([0.5, 0.15]), s * np.array([0.7, 0.2]), 0.02,
                          s**2 * np.array([300.0, 90.0])) for s in (1.0, 2.0)]  # fmt: skip
    both = LuGreFriction(*(np.stack([getattr(law, n) for law in laws])
                           for n in ("level", "breakaway")), 0.02,
                         np.stack([law.stiffness for law in laws]))  # fmt: skip
    t = np.arange(200) * 0.002
    still = np.zeros((2, 200, 2))
    asked = still + 0.1 * np.sin(20 * t)[:, None]

    def drive(law, asked):
        zeros = np.zeros_like(asked)
        reference = Trajectory(asked, zeros, zeros)
        control = lambda wanted, q, qd: 40 * (wanted.q - q) - 2 * qd  # noqa: E731
        return follow(ARM, control, reference, t, effects=Effects(friction=(law,))).q_true

    assert runge_kutta_steps(ARM, Effects(friction=(both,)), 0.002).shape == (2,)
    together = drive(both, asked)
    for k, law in enumerate(laws):
        np.testing.assert_allclose(together[k], drive(law, asked[k]), rtol=0, atol=1e-13)


@pytest.mark.parametrize(
    "name, bad", [("level", (0.0, 0.1)), ("stiffness", (-1.0, 1.0)), ("damping", (1.0, -1.0))]
)
def test_refusals(name, bad):
    good = dict(level=(0.5, 0.15), breakaway=(0.7, 0.2))
    with pytest.raises(ValueError, match=rf"^{name} must"):
        LuGreFriction(**{**good, name: bad})
