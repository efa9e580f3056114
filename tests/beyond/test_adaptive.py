"""Adaptive controllers: their equations, the function that never rises."""

import numpy as np
from hypothesis import given, strategies as st
from scipy.integrate import cumulative_simpson, solve_ivp

from beyond.control.adaptive import (
    PARAMETERS,
    CraigHsuSastry,
    SlotineLi,
    mixed_regressor,
)
from ddlib.dynamics import CMU_DD_ARM_II, REYES_KELLY_ARM, Arm
from ddlib.trajectories import Trajectory

ARM = CMU_DD_ARM_II
TRUTH = np.array([ARM.a, ARM.b, ARM.d])
BOX = dict(low=0.6 * TRUTH, high=1.5 * TRUTH)
LAW = SlotineLi((40.0, 10.0), (8.0, 8.0), (2.0, 0.5, 0.2), 0.5 * TRUTH)


def stirring(t) -> Trajectory:
    """Two sines a joint: enough motion for three parameters."""
    phase = np.multiply.outer(np.asarray(t), [[2.0, 5.0], [3.0, 4.0]])
    speed = np.array([[2.0, 5.0], [3.0, 4.0]])
    size = np.array([[0.5, 0.2], [0.6, 0.3]])
    return Trajectory(
        (size * np.sin(phase)).sum(-1),
        (size * speed * np.cos(phase)).sum(-1),
        (-size * speed**2 * np.sin(phase)).sum(-1),
    )


states = st.lists(st.floats(-3, 3), min_size=8, max_size=8)


@given(states)
def test_regressor_is_linear_form_of_the_equations_of_motion(numbers):
    q, qd, v, a = np.reshape(numbers, (4, 2))
    arm = REYES_KELLY_ARM
    base = [arm.a, arm.b, arm.d, *arm.gravity_moments]
    expected = arm.mass_matrix(q) @ a + arm.coriolis_matrix(q, qd) @ v + arm.gravity(q)
    found = mixed_regressor(q, qd, v, a, PARAMETERS[:5]) @ base
    np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(
        mixed_regressor(q, qd, qd, a, PARAMETERS[:5]), Arm.regressor(q, qd, a), atol=1e-12
    )
    viscous, level = np.array([5.0, 2.0]), np.array([3.0, 1.0])
    friction = viscous * v + level * np.clip(v / 0.02, -1, 1)
    found = mixed_regressor(q, qd, v, a, PARAMETERS[5:]) @ [*viscous, *level]
    np.testing.assert_allclose(found, friction, atol=1e-12)


def run_continuous(rates, seconds, first, points=1500):
    """States and estimates of an exact loop, integrated to a tolerance of 1e-11."""
    t = np.linspace(0.0, seconds, points)
    found = solve_ivp(rates, (0.0, seconds), first, "DOP853", t, rtol=1e-11, atol=1e-12)
    assert found.success
    return t, found.y.T[:, :2], found.y.T[:, 2:4], found.y.T[:, 4:]


def test_lyapunov_function_of_slotine_and_li_never_rises():
    def rates(t, y, sign=1):
        q, qd, estimate = y[:2], y[2:4], y[4:]
        torque, change = LAW.output(estimate, stirring(t), q, qd)
        return np.concatenate([qd, ARM.forward_dynamics(q, qd, torque), sign * change])

    start = np.concatenate([[0.4, -0.3], [0.0, 0.0], LAW.estimate])
    t, q, qd, estimates = run_continuous(rates, 6.0, start, 6001)
    wanted = stirring(t)
    values = LAW.lyapunov(ARM, TRUTH, estimates, wanted, q, qd)
    assert np.diff(values).max() <= 1e-9 * values[0]
    error, error_rate = wanted.q - q, wanted.qd - qd
    s = error_rate + 8.0 * error
    spent = ((s**2) * LAW.gain).sum(-1)
    lost = cumulative_simpson(spent, x=t, initial=0.0)
    np.testing.assert_allclose(values[0] - values, lost, atol=1e-5 * values[0])
    assert np.abs(error[-1000:]).max() < 0.02 * np.abs(error).max()
    t, q, qd, estimates = run_continuous(lambda t, y: rates(t, y, -1), 0.2, start)
    wrong = LAW.lyapunov(ARM, TRUTH, estimates, stirring(t), q, qd)
    assert np.diff(wrong).max() > 1e-6 * wrong[0]


def test_errors_of_craigs_loop_obey_their_linear_equation_and_parameters_are_found():
    law = CraigHsuSastry(
        (60.0, 60.0), (16.0, 16.0), (8.0, 8.0), (4.0, 0.5, 0.2), 0.9 * TRUTH, **BOX
    )

    def accelerated(t, q, qd, estimate):
        """Torque and acceleration determine each other only through the plant: no loop here."""
        torque, _ = law.output(estimate, stirring(t), q, qd, np.zeros(2))
        return torque, ARM.forward_dynamics(q, qd, torque)

    def rates(t, y):
        q, qd, estimate = y[:2], y[2:4], y[4:]
        _, qdd = accelerated(t, q, qd, estimate)
        _, change = law.output(estimate, stirring(t), q, qd, qdd)
        return np.concatenate([qd, qdd, change])

    t, q, qd, estimates = run_continuous(
        rates, 12.0, np.concatenate([[0.05, 0.0], stirring(0.0).qd, law.estimate])
    )
    wanted = stirring(t)
    for k in (0, 40, 700):
        _, qdd = accelerated(t[k], q[k], qd[k], estimates[k])
        error, rate = wanted.q[k] - q[k], wanted.qd[k] - qd[k]
        left = wanted.qdd[k] - qdd + 16.0 * rate + 60.0 * error
        Y = mixed_regressor(q[k], qd[k], qd[k], qdd)
        c2 = np.cos(q[k, 1])
        a, b, d = estimates[k]
        mass = np.array([[a + 2 * b * c2, d + b * c2], [d + b * c2, d]])
        np.testing.assert_allclose(
            left, np.linalg.solve(mass, Y @ (TRUTH - estimates[k])), 1e-9, 1e-12
        )
    np.testing.assert_allclose(estimates[-1], TRUTH, rtol=0.02)
