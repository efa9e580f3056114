"""Measures that simulate, record or count, against closed forms and other ways to a number."""

import re
from dataclasses import replace
from math import comb

import numpy as np
import pytest

from ddlib.control import Feedforward, pd
from ddlib.dynamics import CMU_DD_ARM_II as ARM, SecondOrderModel
from ddlib.effects import CMU_DD_ARM_II_EFFECTS, IDEAL, Effects, ViscousFriction
from ddlib.paper import APPENDIX_I_EXTENTS_DEG
from ddlib.setups import KD, KP
from ddlib.simulation import follow, rms
from ddlib.trajectories import APPENDIX_I, pick_and_place, random_extents, smooth_pick_and_place
from workshop.chapters import (
    dynamics,
    feedback,
    feedforward,
    global_view,
    trajectories_and_recording as trajectories,
    what_lagrange_euler_leaves_out as left_out,
)
from workshop.chapters.feedforward import _EXTENTS, _TIMES, _track
from workshop.report import committed

pytestmark = pytest.mark.usefixtures("planted_members")

EFFECTS = left_out._SETUP.effects
REFERENCE = pick_and_place(APPENDIX_I[5], np.arange(0.0, 3.0, 0.002))

# --- the loop ------------------------------------------------------------------------------------


def nothing(q, qd, qdd):
    return 0 * qdd


def test_the_arm_itself_moves_as_in_the_simulator():
    motion = smooth_pick_and_place(_EXTENTS, _TIMES)
    sampled = np.rad2deg(follow(ARM, pd(KP, KD), motion, _TIMES, log_every=5).tracking_error)
    errors = _track([[0, 0]], [False], nothing, [[1, 1]])[0]
    assert errors.shape == sampled.shape
    assert np.abs(errors - sampled).max() < 0.02 < 0.01 * np.abs(sampled).max() + 0.02
    half = Feedforward(lambda *motion: 0.5 * ARM.inverse_dynamics(*motion), pd(KP, KD))
    sampled = np.rad2deg(follow(ARM, half, motion, _TIMES, log_every=5).tracking_error)
    errors = _track([[0, 0]], [False], half.model, [[1, 1]])[0]
    assert np.abs(errors - sampled).max() < 0.02 < np.abs(sampled).max()


def test_perfect_models_leave_nothing_whatever_the_arm():
    rotors = np.array([[0.0, 0.0], [2.0, 1.0], [0.0, 0.0]])
    frozen = [False, False, True]

    def model(q, qd, qdd):
        torque = ARM.inverse_dynamics(q, qd, qdd) + rotors[:, None] * qdd
        torque[2] = SecondOrderModel(ARM)(q, qd, qdd)[2]
        return torque

    assert np.abs(_track(rotors, frozen, model, np.zeros((3, 2)), speed=2.0)).max() < 1e-5
    # and the test can fail: a model of the arm without rotors leaves an error
    assert np.abs(_track(rotors, frozen, ARM.inverse_dynamics, np.zeros((3, 2)))).max() > 1


def test_a_heavy_rotor_makes_a_joint_that_knows_nothing_of_the_other():
    """Behind a rotor of a ton the motion is that of one inertia on its own spring and damper."""
    heavy = np.array([[1000.0, 1000.0]])
    inertia = heavy + np.diag(ARM.mass_matrix([0.0, 0.0]))
    gains = inertia / np.diag(ARM.mass_matrix([0.0, 0.0]))
    alone = _track(heavy, [False], nothing, gains, extents=(20.0, 0.0))[0]
    assert np.abs(alone[:, 0]).max() > 1
    assert np.abs(alone[:, 1]).max() < 0.01 * np.abs(alone[:, 0]).max()


@pytest.mark.parametrize("effects", [IDEAL, CMU_DD_ARM_II_EFFECTS], ids=["ideal", "all effects"])
def test_runs_of_a_batch_are_runs_by_themselves(effects):
    t = np.arange(750) * 0.002
    found = feedforward._errors([0.5, 0.0], [1.0, 2.0], effects, speed=2.0)
    assert found.shape == (2, 150, 2)  # logged a hundred times a second
    motion = smooth_pick_and_place(_EXTENTS, t, 2.0)
    laws = (
        Feedforward(lambda *m: 0.5 * ARM.inverse_dynamics(*m), pd(KP, KD)),
        pd(2 * np.array(KP), 2 * np.array(KD)),
    )
    for one, law in zip(found, laws):
        wanted = follow(ARM, law, motion, t, effects=effects).tracking_error
        np.testing.assert_allclose(np.deg2rad(one), wanted, atol=1e-9)


def test_a_stiffer_loop_under_load_by_statics():
    """At rest under a load the error of PD is the load over its gain."""
    found = feedback.disturbances(2.0)
    with_it, without = (float(x) for x in re.findall(r"([\d.]+)°", found.text))
    assert with_it == pytest.approx(np.rad2deg(2.0 / KP[0]) / np.sqrt(2), rel=0.1)
    assert found.value == pytest.approx(without / with_it, rel=0.05)


# --- the arm and what the rigid body leaves out --------------------------------------------------


def numbers(text):
    return [
        float(word.replace(",", "")) for word in text.replace(";", "").split() if word[0].isdigit()
    ]


def unexplained(q, qd, qdd):
    """Residual of least squares on an intercept and six states, from the normal equations."""
    torque = ARM.inverse_dynamics(q, qd, qdd)
    design = np.hstack([np.ones((len(q), 1)), q, qd, qdd])
    if np.allclose(qdd, -(np.pi**2) / 9 * q):  # one sine: the same column twice
        design = design[:, :5]
    left = torque - design @ np.linalg.solve(design.T @ design, design.T @ torque)
    return np.sqrt(((left**2).mean(0) / torque.var(0)).mean())


def test_what_a_linear_model_leaves():
    found = dynamics.nonlinearity()
    cube = np.random.default_rng(5).uniform(-np.pi, np.pi, (3, 40_000, 2))
    assert numbers(found.text)[1] == pytest.approx(100 * unexplained(*cube), abs=1.5)
    e = np.deg2rad(random_extents(100, seed=0))[:, None]
    angle = np.pi / 3 * np.arange(300)[:, None] * 0.01
    family = (-e * np.sin(angle), -e * np.pi / 3 * np.cos(angle), e * np.sin(angle) * np.pi**2 / 9)
    wanted = unexplained(*(x.reshape(-1, 2) for x in family))
    assert found.value == pytest.approx(wanted)
    assert numbers(found.text)[0] == round(100 * found.value)


@pytest.mark.parametrize("viscous", [(0.0, 0.0), (20.0, 5.0)])
def test_what_ignoring_velocity_terms_loses(monkeypatch, viscous):
    """Coriolis and centripetal torque over all torque, friction included, on the closed form."""
    rough = replace(dynamics._SETUP, effects=Effects(friction=(ViscousFriction(viscous),)))
    monkeypatch.setattr(dynamics, "_SETUP", rough)
    t = np.arange(300)[:, None] * 0.01
    e, w = np.deg2rad(dynamics.APPENDIX_I[[0, 1, 2, 5]])[:, None], np.pi / 3
    q, qd, qdd = (-f * e for f in (np.sin(w * t), w * np.cos(w * t), -w * w * np.sin(w * t)))
    bend, v1, v2 = ARM.b * np.sin(q[..., 1]), qd[..., 0], qd[..., 1]
    lost = np.stack([-bend * (2 * v1 + v2) * v2, bend * v1**2], -1)
    whole = ARM.inverse_dynamics(q, qd, qdd) + viscous * qd
    share = 100 * np.sqrt((lost**2).mean((0, 1)) / (whole**2).mean((0, 1)))
    told = [float(x) for x in re.findall(r"(\d+) %", dynamics.ignoring_terms().text)]
    np.testing.assert_allclose(told, share, atol=0.51)


def test_looking_ahead_in_closed_form():
    """Slope at the end of a parabola, and in the middle: variances from the normal equations."""
    x = np.arange(-10, 11)
    covariance = np.linalg.inv(np.vander(x, 3).T @ np.vander(x, 3))
    at = np.array([2 * 10.0, 1.0, 0.0]), np.array([0.0, 1.0, 0.0])
    ends, middle = (np.sqrt(row @ covariance @ row) for row in at)
    assert left_out.looking_ahead(21).value == pytest.approx(ends / middle, rel=1e-6)


def test_rounding_in_differences():
    """Rounding is uniform: the difference of two readings has a sixth of a step squared."""
    step = left_out._SETUP.effects.encoder[0].step
    found = left_out.differencing()
    torque = left_out._SETUP.controller.kd[0] * step / np.sqrt(6) / 0.002
    assert float(found.text.split()[0]) == pytest.approx(torque, rel=0.1)
    x = np.arange(-18, 1)
    covariance = np.linalg.inv(np.vander(x, 3).T @ np.vander(x, 3))
    gain = np.sqrt(covariance[1, 1])
    assert found.value == pytest.approx(np.sqrt(2) / gain, rel=0.25)


def test_second_differences_of_rounded_positions():
    """Rounding errors e, uniform: (e1 - 2 e0 + e-1) / T^2 has sqrt(6/12) steps over T^2."""
    run = left_out._ideal()
    gain = np.sqrt((ARM.mass_matrix(run.q_true) ** 2).sum(-1).mean(0)) * np.sqrt(6 / 12) / 0.01**2
    share = gain / np.sqrt((run.tau_true[run.motion] ** 2).mean(0))
    steps = {bits: 2 * np.pi / 2**bits for bits in range(14, 21)}
    slight = [bits for bits, step in steps.items() if (step * share).max() < left_out._SIGNIFICANT]
    found = left_out.sensor_noise()
    assert found.value == min(slight)
    told = [int(word) for word in found.text.split() if word.isdigit()]
    np.testing.assert_allclose(told[2:4], 100 * steps[16] * share, rtol=0.1)


def test_where_late_position_feedback_turns():
    """With that much viscous friction the slowest pole lies on the unit circle."""
    found = left_out.sampling()
    viscous = found.value * np.array(left_out._SETUP.effects.friction[0].coefficient)
    joints = left_out.linear.plant(ARM.mass_matrix([0.0, 0.0]), viscous)
    gain = np.hstack([np.diag(KP), np.zeros((2, 2))])
    poles = np.abs(left_out.late_poles(joints, gain, 0.002, 0.0012))
    assert poles.max() == pytest.approx(1.0, abs=1e-6)
    assert "1.2 ms late" in found.text
    # the text's growth: from the logarithm of the default's largest pole
    joints = left_out.linear.plant(ARM.mass_matrix([0.0, 0.0]), viscous / found.value)
    late, held = (
        np.log(np.abs(left_out.late_poles(joints, gain, 0.002, delay)).max()) / 0.002
        for delay in (0.0012, 0.0)
    )
    told = [float(x) for x in re.findall(r"(-?[\d.]+) 1/s", found.text.replace("−", "-"))]
    np.testing.assert_allclose(told, [late, held], rtol=0.05)


def test_the_snap_that_is_measured_is_the_snap_of_the_reference():
    """Twist: torque through the shaft over its stiffness; left: motor inertia times its qdd."""
    shaft = left_out._SHAFT
    motors, stiffness = np.array(shaft.motor_inertia), np.array(shaft.stiffness)
    through = ARM.inverse_dynamics(*REFERENCE) - motors * REFERENCE.qdd
    twist = through / stiffness
    left = np.diff(twist, 2, axis=0) / 0.002**2 @ motors
    expected = rms(left[:, None])[0] / EFFECTS.torque_sensor[0].std[0]
    slowest = shaft.mode_frequencies(ARM, [0.0, 0.0]).min() / (2 * np.pi)
    # ten times softer: ten times the torque, and a mode slower by the root of ten
    assert np.isclose(left_out.snap().value, slowest * np.sqrt(expected), rtol=0.02)


# --- the family and its recordings ---------------------------------------------------------------


def test_the_chance_of_extents_on_a_limit():
    """Five or more of twelve within half a printed step of a limit, summed by hand."""
    on_limit = sum(x in (0.0, 45.0) for pair in APPENDIX_I_EXTENTS_DEG for x in pair)
    p = 0.1 / 45
    chance = sum(comb(12, k) * p**k * (1 - p) ** (12 - k) for k in range(on_limit, 13))
    found = trajectories.random_draws()
    assert on_limit == 5
    assert found.value == pytest.approx(chance, rel=1e-6)
    # a coarser print makes it likelier
    assert trajectories.random_draws(resolution=9.0).value > 1e4 * found.value


# --- hidden units ----------------------------------------------------------------------------


@pytest.mark.parametrize(("bias", "wanted"), [(0.0, 1.0), (2.1, 1.0), (2.3, 0.0), (-9.0, 0.0)])
def test_time_in_the_transition_region(monkeypatch, bias, wanted):
    """A sigmoid leaves 0.1 to 0.9 at a net input of ln 9 = 2.197."""
    start = committed._untrained(21)
    weights = replace(
        start.weights,
        hidden_weights=1e-6 * start.weights.hidden_weights,
        hidden_bias=np.full_like(start.weights.hidden_bias, bias),
    )
    planted = replace(start, weights=weights)
    monkeypatch.setattr(committed, "networks", lambda *_: planted)
    assert global_view.in_transition(21).value == wanted
