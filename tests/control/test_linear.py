"""Linear loops against the simulation, closed forms and python-control's own feedback."""

import control
import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from ddlib.control import (
    PID,
    closed_loop,
    loop_gain,
    margins,
    opened_loop,
    plant,
    proportional_limit,
)
from ddlib.dynamics import CMU_DD_ARM_II, Arm
from ddlib.effects import Delay, Effects, ViscousFriction
from ddlib.simulation import follow
from ddlib.trajectories import Trajectory

STEP = 0.002
VISCOUS = (0.5, 0.15)
KP, KI, KD = (200.0, 60.0), (90.0, 20.0), (20.0, 6.0)
LINEAR_ARM = Arm("without coupling by the elbow's angle", 6.0, 0.0, 0.7, (0.5, 0.4))


def inertia_of(arm):
    return arm.mass_matrix([0.0, 0.0])


def radius(inertia, viscous, kp, period):
    return abs(closed_loop(plant(inertia, viscous), kp, period=period).poles()).max()


def test_plant_obeys_its_equation():
    M, rng = inertia_of(CMU_DD_ARM_II), np.random.default_rng(0)
    joints = plant(M, VISCOUS)
    qd, tau = rng.normal(size=(2, 2))
    rate = joints.A @ np.concatenate([rng.normal(size=2), qd]) + joints.B @ tau
    np.testing.assert_allclose(rate[:2], qd)
    np.testing.assert_allclose(M @ rate[2:] + np.array(VISCOUS) * qd, tau)
    np.testing.assert_array_equal(joints.C, np.eye(4))


def test_steady_errors_under_a_constant_load():
    """A spring gives way by load over stiffness, an integral not at all; both follow a step."""
    joints = plant(inertia_of(CMU_DD_ARM_II), VISCOUS)
    for ki, give in ((0.0, np.diag(1 / np.array(KP))), (KI, np.zeros((2, 2)))):
        for period in (None, STEP):
            gain = closed_loop(joints, KP, ki, KD, period).dcgain()
            np.testing.assert_allclose(gain, np.hstack([np.eye(2), give]), atol=1e-9)


DAMPERS = [("tachometer", 0.0), ("tachometer", 0.01), ("difference", 0.0), ("difference", 0.03)]


@pytest.mark.parametrize("velocity, smoothing", DAMPERS)
@pytest.mark.parametrize("delay", [0, 1, 4])
@pytest.mark.parametrize("ki", [(0.0, 0.0), KI], ids=["PD", "PID"])
def test_sampled_loop_is_the_simulated_one(ki, delay, velocity, smoothing):
    """On an arm whose equations are linear, sample by sample, with two coupled joints."""
    t = np.arange(500) * STEP
    target = np.deg2rad([3.0, -2.0]) * (t > 0)[:, None]
    recording = follow(
        LINEAR_ARM,
        PID(KP, ki, KD, derivative_filter=smoothing),
        Trajectory(target, 0 * target, 0 * target),
        t,
        effects=Effects((ViscousFriction(VISCOUS),), (Delay(delay),)),
        log_every=1,
        velocity=velocity,
    )
    joints = plant(inertia_of(LINEAR_ARM), VISCOUS)
    options = {"derivative_filter": smoothing, "velocity": velocity}
    loop = closed_loop(joints, KP, ki, KD, STEP, delay, **options)
    inputs = np.vstack([target.T, np.zeros((2, t.size))])
    answer = control.forced_response(loop, t, inputs).outputs.T
    assert np.abs(answer).max() > np.deg2rad(3)
    np.testing.assert_allclose(recording.q_true, answer, atol=1e-11)


GAINS = [(200.0, 0.0, 0.0), (200.0, 0.0, 20.0), (200.0, 90.0, 20.0)]


@pytest.mark.parametrize("velocity, smoothing", DAMPERS)
@pytest.mark.parametrize("period, delay", [(None, 0), (STEP, 0), (STEP, 3)])
@pytest.mark.parametrize("joint", [0, 1])
def test_closing_an_opened_loop_gives_the_closed_one(joint, period, delay, velocity, smoothing):
    """Unity feedback around what was cut open has the closed loop's poles."""
    joints = plant(inertia_of(CMU_DD_ARM_II), VISCOUS)
    options = {"derivative_filter": smoothing, "velocity": velocity if period else "tachometer"}
    opened = opened_loop(joints, KP, KI, KD, period, delay, joint=joint, **options)
    poles = control.feedback(opened, 1).poles()
    expected = closed_loop(joints, KP, KI, KD, period, delay, **options).poles()
    np.testing.assert_allclose(np.sort_complex(poles), np.sort_complex(expected), atol=1e-5)


@pytest.mark.parametrize("smoothing", [0.0, 0.01, 0.1])
@pytest.mark.parametrize("gains", [(400.0, 0.0, 75.0), (400.0, 300.0, 75.0)])
def test_margins_are_python_controls_with_a_filtered_derivative(gains, smoothing):
    """The same loops from transfer functions: continuous, and sampled with a law in 1/z."""
    kp, ki, kd = gains
    J, F, late = 6.5, 5.3, 1
    s, z = control.tf("s"), control.tf("z")
    joint = 1 / (J * s**2 + F * s)
    law = kp + kd * s / (1 + smoothing * s) + (ki / s if ki else 0)
    slope = (1 - 1 / z) / STEP
    sampled = kp + kd * slope / (1 + smoothing * slope) + (ki / slope if ki else 0)
    sampled *= control.sample_system(joint, STEP, "zoh") * z**-late
    timed = {"period": STEP, "delay": late, "velocity": "difference"}
    for known, options in ((joint * law, {}), (sampled, timed)):
        options["derivative_filter"] = smoothing
        found = margins(opened_loop(plant(J, F), *gains, **options))
        gain, phase, _, crossover = control.margin(known)
        assert found.phase_deg == pytest.approx(phase, abs=1e-4)
        assert found.crossover == pytest.approx(crossover, rel=1e-6)
        ours = [np.log(g) for g in (found.upper_gain, found.lower_gain) if 0 < g < np.inf]
        if ours:
            assert min(np.abs(ours - np.log(gain))) < 1e-3


def test_a_filter_costs_the_angle_by_which_it_turns_the_damper():
    """Exact at a crossover: the loop's phase there, with the damper's part turned and shrunk."""
    smoothing = 0.03
    found = margins(opened_loop(plant(6.5, 5.3), 400.0, 0.0, 75.0, derivative_filter=smoothing))
    w = 1j * found.crossover
    loop = (400.0 + 75.0 * w / (1 + smoothing * w)) / (6.5 * w**2 + 5.3 * w)
    assert abs(loop) == pytest.approx(1.0)
    assert found.phase_deg == pytest.approx(np.rad2deg(np.angle(-loop)))


@pytest.mark.parametrize("gains", GAINS)
def test_continuous_margins_are_python_controls(gains):
    loop = loop_gain(6.0, 0.5, *gains)
    gain, phase, _, crossover = control.margin(loop)
    found = margins(loop)
    assert (found.phase_deg, found.crossover) == pytest.approx((phase, crossover))
    if gains[1]:  # conditionally stable: the margin is downwards
        assert found.lower_gain == pytest.approx(gain) and found.upper_gain == np.inf
    else:
        assert (found.upper_gain, found.lower_gain) == (np.inf, 0)


@pytest.mark.parametrize("delay", [0, 1, 5])
@pytest.mark.parametrize("gains", GAINS)
def test_margins_are_where_the_loop_loses_its_stability(gains, delay):
    joints = plant(6.0, 3.0)

    def largest(factor):
        scaled = np.multiply(factor, gains)
        return abs(closed_loop(joints, *scaled, STEP, delay).poles()).max()

    found = margins(opened_loop(joints, *gains, STEP, delay))
    assert largest(1.0) < 1 and found.phase_deg > 0
    assert largest(0.999 * found.upper_gain) < 1 < largest(1.001 * found.upper_gain)
    if found.lower_gain:
        assert largest(1.001 * found.lower_gain) < 1 < largest(0.999 * found.lower_gain)


@pytest.mark.parametrize("delay", [20, 60, 150])
def test_a_long_delay_costs_phase_alone(delay):
    """Each period turns the loop by its crossover times the period, and changes no gain."""
    joint, gains, period = plant(2.0, 1.0), (30.0, 0.0, 2.0), 0.00025
    prompt, late = (margins(opened_loop(joint, *gains, period, n)) for n in (0, delay))
    assert late.crossover == pytest.approx(prompt.crossover)
    lost = np.rad2deg(prompt.crossover * delay * period)
    assert late.phase_deg == pytest.approx(prompt.phase_deg - lost)
    for factor, stable in ((0.999, True), (1.001, False)):
        scaled = np.multiply(factor * late.upper_gain, gains)
        assert (abs(closed_loop(joint, *scaled, period, delay).poles()).max() < 1) == stable


@settings(deadline=None, max_examples=60)
@given(st.floats(0.05, 20), st.floats(-3.0, 1.5))
def test_limit_separates_stable_from_unstable(inertia, power):
    """From hardly any friction to a period of thirty time constants: both ways to fail."""
    period = 0.01
    viscous = 10**power * inertia / period
    limit = proportional_limit(inertia, viscous, period)
    assert radius(inertia, viscous, 0.99 * limit, period) < 1
    assert radius(inertia, viscous, 1.01 * limit, period) > 1


def test_limit_is_twice_friction_over_period():
    assert proportional_limit(6.5, 0.5, STEP) == pytest.approx(2 * 0.5 / STEP, rel=1e-4)
    assert proportional_limit(6.5, 0.0, STEP) == 0
    assert radius(6.5, 0.0, 1.0, STEP) > 1  # without friction no gain is stable
    for x in (0.9e-4, 1.1e-4):  # friction times period over inertia, where the series takes over
        limit = proportional_limit(1.0, x / STEP, STEP)
        assert limit / (2 * x / STEP**2) == pytest.approx(1 + x / 6, abs=1e-8)


def test_stiffness_pulls_back_to_the_posture():
    """Poles of one mass on a spring, and of an arm against its own second derivative."""
    poles = plant(2.0, 0.6, [[8.0]]).poles()
    np.testing.assert_allclose(np.sort_complex(poles), np.sort_complex(np.roots([2.0, 0.6, 8.0])))
    np.testing.assert_allclose(plant(2.0, 0.6, 8.0).poles(), poles)
    M, K = np.array([[3.0, 0.4], [0.4, 0.5]]), np.array([[2.0, -0.3], [-0.3, 0.7]])
    joints = plant(M, [0.0, 0.0], K)
    rates = np.linalg.eigvals(np.linalg.solve(M, K))
    np.testing.assert_allclose(np.sort(joints.poles().imag ** 2)[::2], np.sort(rates))
    np.testing.assert_allclose(joints.dcgain()[:2], np.linalg.inv(K), atol=1e-12)
