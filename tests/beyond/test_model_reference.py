"""Model-reference control against scipy's linear model; options of the adaptive laws."""

import numpy as np
from scipy.integrate import solve_ivp
from scipy.signal import lsim

from beyond.control.adaptive import SlotineLi, Watched, _CraigHsuSastry, _ModelReference
from ddlib.dynamics import CMU_DD_ARM_II
from ddlib.effects import CMU_DD_ARM_II_EFFECTS
from ddlib.simulation import record
from ddlib.trajectories import Trajectory

ARM = CMU_DD_ARM_II
TRUTH = np.array([ARM.a, ARM.b, ARM.d])
A0, A1 = np.array([60.0, 90.0]), np.array([16.0, 20.0])
INERTIA, VISCOUS = np.array([3.0, 0.5]), np.array([2.0, 0.4])
MATCHED = np.stack([INERTIA, A0 * INERTIA, A1 * INERTIA - VISCOUS, 0 * INERTIA], -1).ravel()
SPEEDS = np.tile([0.5, 900.0, 60.0, 30.0], 2)


def reference(t) -> Trajectory:
    phase = np.multiply.outer(np.asarray(t), [2.0, 3.0])
    speed = np.array([2.0, 3.0])
    return Trajectory(np.sin(phase), speed * np.cos(phase), -(speed**2) * np.sin(phase))


def by_scipy(t):
    """Motion of the linear models by `scipy.signal.lsim`, shape (time, joint, 2)."""
    wanted, motion = reference(t), []
    for j in range(2):
        command = wanted.qdd[:, j] + A1[j] * wanted.qd[:, j] + A0[j] * wanted.q[:, j]
        system = ([[0, 1], [-A0[j], -A1[j]]], [[0], [1]], np.eye(2), np.zeros((2, 1)))
        motion.append(lsim(system, command, t)[1])
    return np.stack(motion, 1)


def law(estimate, rate=SPEEDS, **options):
    return _ModelReference(A0, A1, A1 / 2, rate, estimate, **options)


def test_the_model_is_the_linear_system_that_scipy_integrates():
    t = np.arange(1500) * 0.002
    model, expected = law(MATCHED).model(reference(t), 0.002), by_scipy(t)
    np.testing.assert_allclose(model.q, expected[..., 0], atol=1e-9)
    np.testing.assert_allclose(model.qd, expected[..., 1], atol=1e-9)


def joints(adaptive, seconds, q0):
    """Two joints without coupling under a law, in continuous time: inertia and friction each."""
    grid = np.linspace(0, seconds, 3001)

    def rates(t, y):
        qm, vm, q, qd, estimate = y[:2], y[2:4], y[4:6], y[6:8], y[8:]
        wanted = reference(t)
        am = wanted.qdd + A1 * (wanted.qd - vm) + A0 * (wanted.q - qm)
        torque, change = adaptive.output(estimate, Trajectory(qm, vm, am), q, qd)
        return np.concatenate([vm, am, qd, (torque - VISCOUS * qd) / INERTIA, change])

    start = np.concatenate([np.zeros(4), q0, np.zeros(2), adaptive.estimate])
    found = solve_ivp(rates, (0, seconds), start, "DOP853", grid, rtol=1e-10, atol=1e-11)
    return grid, found.y.T


def test_a_function_of_errors_and_gains_never_rises_and_the_error_dies():
    adaptive = law(0.4 * MATCHED)
    _, y = joints(adaptive, 12.0, np.array([0.2, -0.1]))
    e, rate = y[:, :2] - y[:, 4:6], y[:, 2:4] - y[:, 6:8]
    w = A1 / 2
    # e'Pe of the positive real (s + w) / (s^2 + A1 s + A0), whose P solves A'P + PA = -Q
    p = np.array([[w * A1 + A0, w], [w, 1.0 + 0 * w]])
    energy = 0.5 * (p[0, 0] * e**2 + 2 * p[0, 1] * e * rate + p[1, 1] * rate**2)
    off = (y[:, 8:] - MATCHED).reshape(-1, 2, 4)
    stored = 0.5 * (off**2 / np.reshape(SPEEDS, (2, 4))).sum(-1) / INERTIA
    value = (energy + stored).sum(-1)
    assert np.diff(value).max() <= 1e-9 * value[0]
    assert value[-1] < 0.9 * value[0]
    assert np.abs(e[-300:]).max() < 0.1 * np.abs(e).max()


def test_a_dead_zone_stops_learning_and_leakage_forgets():
    wanted = Trajectory(np.array([0.1, 0.2]), np.array([1.0, -0.5]), np.array([0.3, 0.4]))
    q, qd = np.zeros(2), np.array([0.9, -0.6])
    fine = ((30.0, 9.0), (2.0, 2.0), (1.0, 1.0, 1.0), TRUTH)  # s = 0.3, 0.5
    free = SlotineLi(*fine).output(1.5 * TRUTH, wanted, q, qd)
    zoned = SlotineLi(*fine, dead_zone=(0.3, 0.5)).output(1.5 * TRUTH, wanted, q, qd)
    leaky = SlotineLi(*fine, leakage=0.2).output(1.5 * TRUTH, wanted, q, qd)
    for other in (zoned, leaky):
        np.testing.assert_array_equal(other[0], free[0])
    np.testing.assert_allclose(zoned[1], 0, atol=1e-12)
    np.testing.assert_allclose(leaky[1], free[1] - 0.2 * 0.5 * TRUTH)


def test_an_estimated_mass_matrix_stays_invertible_outside_the_reach_of_the_box():
    low, high = (2.6, 0.0, 0.3), (14.0, 4.0, 2.5)
    watched = Watched(_CraigHsuSastry(
        kp=(60.0, 60.0), kd=(16.0, 16.0), weight=(8.0, 8.0), rate=(50.0, 900.0, 50.0),
        estimate=0.7 * TRUTH, low=low, high=high,
    ))  # fmt: skip
    record(ARM, watched, (40.0, 30.0), velocity="difference", rest=0.1, duration=1.0,
           effects=CMU_DD_ARM_II_EFFECTS)  # fmt: skip
    course = watched.law.estimates
    assert (course >= low).all() and (course <= high).all()
    a, b, d = np.moveaxis(course[1:], -1, 0)
    for cosine in (-1, 0, 1):
        m11, m12 = a + 2 * b * cosine, d + b * cosine
        assert (m11 * d - m12**2 > 0).all() and (m11 > 0).all()
    assert np.ptp(b) > 0.1
