"""Measures that simulate: what they ask of the simulator, and what they make of its answers."""

import re
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from ddlib.control import PID, Feedforward, pd
from ddlib.dynamics import CMU_DD_ARM_II as ARM
from ddlib.dynamics import PUMA_560_ROTORS
from ddlib.effects import CMU_DD_ARM_II_EFFECTS, IDEAL, Effects, ViscousFriction
from ddlib.setups import KD, KP
from ddlib.simulation import follow, smooth_pick_and_place
from ddlib.trajectories import random_extents
from workshop.report.measures import control, dynamics

EXTENTS = (25.0, 40.0)
JOINTS = np.diag(ARM.mass_matrix([0.0, 0.0]))


# --- control: the runs behind the claims -------------------------------------------------------


@pytest.mark.parametrize("effects", [IDEAL, CMU_DD_ARM_II_EFFECTS], ids=["ideal", "all effects"])
def test_runs_of_a_batch_are_runs_by_themselves(effects):
    t = np.arange(750) * 0.002
    found = control._errors([0.5, 0.0], [1.0, 2.0], effects, speed=2.0, extents=EXTENTS)
    assert found.shape == (2, 150, 2)  # logged a hundred times a second
    motion = smooth_pick_and_place(EXTENTS, t, 2.0)
    laws = (
        Feedforward(lambda *m: 0.5 * ARM.inverse_dynamics(*m), pd(KP, KD)),
        pd(2 * np.array(KP), 2 * np.array(KD)),
    )
    for one, law in zip(found, laws):
        wanted = follow(ARM, law, motion, t, effects=effects).tracking_error
        np.testing.assert_allclose(np.deg2rad(one), wanted, atol=1e-9)


def test_the_default_motion_lasts_three_seconds():
    assert control._errors([1.0], [0.0]).shape == (1, 300, 2)
    assert control.TIMES.shape == (1500,) and control.TIMES[-1] == pytest.approx(2.998)
    np.testing.assert_allclose(control.EXTENTS, [44.0, 45.0], atol=2.0)
    np.testing.assert_allclose(control.OWN, JOINTS)


def test_root_mean_squares_are_of_each_run():
    x = np.array([[[3.0, 4.0], [0.0, 0.0]], [[1.0, 1.0], [1.0, 1.0]]])
    np.testing.assert_allclose(control._rms(x), [2.5, 1.0])


def test_runs_with_all_effects(monkeypatch):
    asked = []

    def errors(*arguments):
        asked.append(arguments)
        return np.arange(1.0, 7.0)[:, None, None] * np.ones((6, 5, 2))

    monkeypatch.setattr(control, "_errors", errors)
    found = control._real.__wrapped__(1.5)
    np.testing.assert_allclose(found, [1, 2, 3, 4, 5, 6])
    ((factors, gains, effects, speed),) = asked
    assert list(zip(factors, gains)) == [(0, 1), (1, 1), (0.8, 1), (1.2, 1), (0.8, 0), (1.2, 0)]
    assert effects is CMU_DD_ARM_II_EFFECTS and speed == 1.5


def test_feedback_takes_the_lesser_help(monkeypatch):
    monkeypatch.setattr(control, "_real", lambda speed: np.array([9, 9, 2.0, 5.0, 8.0, 10.0]))
    found = control.feedback()
    assert found.value == pytest.approx(2.0)
    assert found.text == (
        "model 20 % off, all effects: 2.0° for 8.0° without, 5.0° for 10° without"
    )


def test_faster_motions(monkeypatch):
    errors = {1.0: np.array([4.0, 2.0]), 3.0: np.array([9.0, 3.0])}
    monkeypatch.setattr(control, "_real", lambda speed: errors[speed])
    found = control.faster(3.0)
    assert found.value == pytest.approx(3.0)
    assert found.text == (
        "3.0° with a model, 9.0° without at 3 times the speed; 2.0° and 4.0° at the paper's"
    )


def test_faster_means_twice_as_fast(monkeypatch):
    errors = {1.0: np.array([4.0, 2.0]), 2.0: np.array([8.0, 2.0])}
    monkeypatch.setattr(control, "_real", lambda speed: errors[speed])
    assert control.faster().value == pytest.approx(4.0)


def test_a_load_on_the_shoulder(monkeypatch):
    asked = []

    def errors(factors, gains, effects):
        asked.extend([factors, gains, effects])
        return np.array([2.0, 7.0])[:, None, None] * np.ones((2, 3, 2))

    monkeypatch.setattr(control, "_errors", errors)
    found = control.disturbances(4.0)
    assert found.value == pytest.approx(3.5)
    assert found.text == "4 N m on the shoulder: 2.0° for 7.0° without"
    factors, gains, effects = asked
    assert factors == [1, 1] and gains == [1, 0]
    (load,) = effects.actuator
    assert load.torque == (4.0, 0.0)


def test_a_stiffer_loop_under_load_by_statics():
    """At rest under a load the error of PD is the load over its gain."""
    found = control.disturbances(2.0)
    with_it = float(found.text.split(": ")[1].split("°")[0])
    assert with_it == pytest.approx(np.rad2deg(2.0 / KP[0]) / np.sqrt(2), rel=0.1)


def test_perfect_models(monkeypatch):
    def errors(factors, gains):
        assert (factors, gains) == ([1, 0], [0, 1])
        return np.array([[[0.1, -0.9], [0.3, 0.2]], [[-5.0, 1.0], [2.0, 1.0]]])

    def track(rotors, frozen, model, gains):
        assert model == ARM.inverse_dynamics and not np.any(rotors) and not np.any(gains)
        return np.array([[[1e-6, -2e-6]]])

    monkeypatch.setattr(control, "_errors", errors)
    monkeypatch.setattr(control, "track", track)
    found = control.perfect_model()
    assert found.value == pytest.approx(0.9 / max(control.EXTENTS))
    assert found.text.startswith("0.90° on a smooth motion without feedback")
    assert found.text.endswith("2 · 10⁻⁶° with a continuous torque (5.0° by PD alone)")


def test_errors_are_shares_of_the_larger_extent(monkeypatch):
    monkeypatch.setattr(control, "EXTENTS", np.array([10.0, 40.0]))
    monkeypatch.setattr(control, "_errors", lambda *_: np.full((2, 3, 2), [[[2.0, -1.0]]]))
    monkeypatch.setattr(control, "track", lambda *_: np.zeros((1, 1, 2)))
    assert control.perfect_model().value == pytest.approx(2.0 / 40.0)


def answers(monkeypatch, errors_deg):
    """`follow` is asked, notes the question and gives these errors, degrees."""
    asked = SimpleNamespace()

    def planted(arm, law, motion, t, **options):
        asked.arm, asked.law, asked.motion, asked.t, asked.options = arm, law, motion, t, options
        return SimpleNamespace(tracking_error=np.deg2rad(errors_deg))

    monkeypatch.setattr(control, "follow", planted)
    return asked


def test_errors_on_the_family_over_each_extent(monkeypatch):
    wrong = np.zeros((6, 4, 2))
    wrong[:, 2, 1] = [1.0, -2.0, 3.0, 1.0, 1.0, -9.0]
    asked = answers(monkeypatch, wrong)
    extents = asked_extents = np.abs(np.rad2deg(np.array(control.APPENDIX_I) * np.pi / 180))
    found = control.perfect_model_on_family()
    assert found.value == pytest.approx(max(np.abs(wrong[:, 2, 1]) / extents.max(1)))
    assert found.text.startswith("largest error 1.0 to 9.0°")
    assert asked.law.model is ARM and asked.law.feedback == pd(KP, KD)
    middle = np.abs(np.rad2deg(asked.motion.q[:, 750]))
    np.testing.assert_allclose(middle, asked_extents, atol=1e-9)


def test_models_of_joints_by_themselves(monkeypatch):
    wrong = np.array([8.0, 6.0, 2.0])[:, None, None] * np.ones((3, 4, 2))
    asked = answers(monkeypatch, wrong)
    found = control.coupling()
    assert found.value == pytest.approx(3.0)
    assert found.text == (
        "independent PID 8.0°, with models of single joints 6.0°, "
        "of second order with coupling 2.0°"
    )
    feedback = asked.law.feedback
    assert isinstance(feedback, PID) and (feedback.kp, feedback.kd) == (KP, KD)
    np.testing.assert_allclose(feedback.ki, (150.0, 45.0))
    q, qd, qdd = np.random.default_rng(0).normal(size=(3, 3, 5, 2))
    torque = asked.law.model(q, qd, qdd)
    np.testing.assert_array_equal(torque[0], 0)
    np.testing.assert_allclose(torque[1], qdd[1] * JOINTS)
    np.testing.assert_allclose(torque[2], qdd[2] @ ARM.mass_matrix([0.0, 0.0]))


def test_the_drawn_system_against_the_simulator(monkeypatch):
    drawn, built = np.zeros((300, 2)), np.zeros((300, 2))
    drawn[17, 0], built[201, 1] = 0.01, 0.03
    seen = {}

    def run_system(system, motion, t):
        seen["t"], seen["q"] = t, motion.q
        return SimpleNamespace(q=drawn)

    def planted(arm, law, motion, t, log_every):
        assert log_every == 5 and len(t) == 1500 and law.model is ARM
        np.testing.assert_allclose(motion.q[::5], seen["q"])
        return SimpleNamespace(q_true=built)

    monkeypatch.setattr(control, "run_system", run_system)
    monkeypatch.setattr(control, "follow", planted)
    assert control.figure_2_1().value == pytest.approx(np.rad2deg(0.03))
    np.testing.assert_allclose(seen["t"], np.arange(300) * 0.01)


@pytest.mark.parametrize("sign", [-1, 1])
def test_computed_torque_on_the_reference(monkeypatch, sign):
    assert control.off_line().value is True

    class Off:
        def __init__(self, arm, kp, kd):
            np.testing.assert_allclose(kp, KP / JOINTS)
            np.testing.assert_allclose(kd, KD / JOINTS)
            self.arm = arm

        def start(self, motion, step):
            assert step == 0.002
            np.testing.assert_allclose(motion.q.shape, (1500, 2))
            torque = self.arm.inverse_dynamics(*motion)
            torque[700, 1] += sign * 2e-3
            return lambda k, q, qd: torque[k]

    monkeypatch.setattr(control, "ComputedTorque", Off)
    found = control.off_line()
    assert found.value is False and found.text.endswith("(difference 0.002 N m)")


def test_what_a_linear_arm_does_not_explain(monkeypatch):
    asked = {}

    def track(rotors, frozen, model, gains, speed):
        asked.update(rotors=rotors, frozen=frozen, model=model, gains=gains, speed=speed)
        return np.array([9.0, 3.0, 2.5, 1.0])[:, None, None] * np.ones((4, 5, 2))

    monkeypatch.setattr(control, "track", track)
    found = control.linearised(3.0)
    assert found.value == pytest.approx(6.0 / 1.5)
    assert found.text.endswith("falls from 6.0° to 1.5° (model 20 % off, 3 times the speed)")
    assert list(asked["frozen"]) == [False, True, False, True] and asked["speed"] == 3.0
    assert np.shape(asked["rotors"]) == (4, 2) and not np.any(asked["rotors"])
    np.testing.assert_array_equal(asked["gains"], np.ones((4, 2)))
    q, qd, qdd = np.random.default_rng(0).normal(size=(3, 4, 5, 2))
    torque = asked["model"](q, qd, qdd)
    np.testing.assert_array_equal(torque[:2], 0)
    np.testing.assert_allclose(torque[2], 0.8 * ARM.inverse_dynamics(q[2], qd[2], qdd[2]))
    np.testing.assert_allclose(torque[3], 0.8 * qdd[3] @ ARM.mass_matrix([0.0, 0.0]))


@pytest.mark.parametrize("own", [False, True])
def test_gears_turn_rotors_squared(monkeypatch, own):
    asked = {}

    def track(rotors, frozen, model, gains, extents):
        asked.update(rotors=rotors, frozen=frozen, model=model, gains=gains, extents=extents)
        return "errors"

    monkeypatch.setattr(control, "track", track)
    assert control._geared.__wrapped__(50.0, own, (3.0, 4.0)) == "errors"
    rotor = 2500 * PUMA_560_ROTORS[0]
    np.testing.assert_allclose(asked["rotors"], [[0, 0], [rotor, rotor]])
    assert not np.any(asked["frozen"]) and tuple(asked["extents"]) == (3.0, 4.0)
    np.testing.assert_allclose(asked["gains"], [[1, 1], (JOINTS + rotor) / JOINTS])
    q, qd, qdd = np.random.default_rng(0).normal(size=(3, 2, 5, 2))
    wanted = own * qdd * np.array([JOINTS, JOINTS + rotor])[:, None]
    np.testing.assert_allclose(asked["model"](q, qd, qdd), wanted)


def test_gears_hide_the_other_joint(monkeypatch):
    def geared(gear, own_model, extents):
        assert gear == 60.0
        if extents == tuple(control.APPENDIX_I[3]):  # the elbow rests
            assert own_model is False and extents[1] == 0
            elbow = np.array([[0.1, -4.0, 2.0], [0.2, 0.5, -0.1]])
            return np.stack([99 * np.ones_like(elbow), elbow], axis=-1)
        assert extents == tuple(control.EXTENTS)
        sizes = (3.0, 0.4) if own_model else (4.0, 4.0)
        return np.array(sizes)[:, None, None] * np.ones((2, 3, 2))

    monkeypatch.setattr(control, "_geared", geared)
    found = control.backdriven(60.0)
    assert found.value == pytest.approx(8.0)
    assert found.text.endswith("elbow off by 4.0°, behind gears of 60 to 1 by 0.50°")
    found = control.target_for_models(60.0)
    assert found.value == pytest.approx(0.75 / 0.1)
    assert found.text == (
        "a model without coupling leaves 75 % of PD's error, 10 % behind gears of 60 to 1"
    )


# --- dynamics ------------------------------------------------------------------------------------


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


def test_velocity_terms_of_trajectory_1():
    """Coriolis and centripetal torque printed out, on the closed form of the motion."""
    t = np.arange(300) * 0.01
    e = np.deg2rad(dynamics.APPENDIX_I[0])
    w = np.pi / 3
    q, qd, qdd = (
        -np.outer(f, e) for f in (np.sin(w * t), w * np.cos(w * t), -w * w * np.sin(w * t))
    )
    bend = ARM.b * np.sin(q[:, 1])
    velocity = np.stack(
        [-bend * (2 * qd[:, 0] * qd[:, 1] + qd[:, 1] ** 2), bend * qd[:, 0] ** 2], 1
    )
    whole = ARM.inverse_dynamics(q, qd, qdd)
    share = 100 * np.sqrt((velocity**2).mean(0) / (whole**2).mean(0))
    found = dynamics.terms()
    assert found.value is True
    np.testing.assert_allclose(numbers(found.text)[:2], share, atol=0.51)


def test_velocity_terms_are_told_in_percent(monkeypatch):
    monkeypatch.setattr(dynamics, "share_of_velocity_terms", lambda *_: np.array([0.9, 0.8]))
    assert dynamics.terms().text == "velocity terms are 90 % and 80 % of the torque, trajectory 1"


@pytest.mark.parametrize("viscous", [(0.0, 0.0), (20.0, 5.0)])
def test_what_ignoring_velocity_terms_loses(monkeypatch, viscous):
    """Coriolis and centripetal torque over all torque, friction included, on the closed form."""
    rough = replace(dynamics.SETUP, effects=Effects(friction=(ViscousFriction(viscous),)))
    monkeypatch.setattr(dynamics, "SETUP", rough)
    t = np.arange(300)[:, None] * 0.01
    e, w = np.deg2rad(dynamics.APPENDIX_I[[0, 1, 2, 5]])[:, None], np.pi / 3
    q, qd, qdd = (-f * e for f in (np.sin(w * t), w * np.cos(w * t), -w * w * np.sin(w * t)))
    bend, v1, v2 = ARM.b * np.sin(q[..., 1]), qd[..., 0], qd[..., 1]
    lost = np.stack([-bend * (2 * v1 + v2) * v2, bend * v1**2], -1)
    whole = ARM.inverse_dynamics(q, qd, qdd) + viscous * qd
    share = 100 * np.sqrt((lost**2).mean((0, 1)) / (whole**2).mean((0, 1)))
    told = [float(x) for x in re.findall(r"(\d+) %", dynamics.ignoring_terms().text)]
    np.testing.assert_allclose(told, share, atol=0.51)


def test_the_whole_arm_may_turn():
    assert dynamics.shoulder_position().value < 1e-12


def test_coverage_is_the_worst_parameter(monkeypatch):
    covers = np.ones((20, 3), bool)
    covers[:2, 0] = covers[3:7, 1] = False
    monkeypatch.setattr(dynamics, "_coverage", lambda: covers)
    found = dynamics.identification()
    assert found.value == pytest.approx(0.8)
    assert found.text == "95 % intervals hold the truth in 80 to 100 % of 200"


def test_gears_make_the_shoulder_matter_less(monkeypatch):
    def share(arm, motion, ratios, rotor):
        assert list(ratios) == [1.0, 100.0] and rotor == PUMA_560_ROTORS[0]
        return np.array([[0.9, 0.5], [0.8, 0.02]])

    monkeypatch.setattr(dynamics, "share_of_other_joint", share)
    found = dynamics.gears()
    assert found.value == pytest.approx(25.0)
    assert found.text == (
        "the shoulder causes 50 % of the elbow's torque, 2 % behind gears of 100 to 1"
    )


def test_counts_are_compared(monkeypatch):
    sizes = {"newton_euler": 700, "recursive_lagrange": 3_500, "lagrange_euler": 63_000}
    fewer = {"nothing": 0, "zeros": 1_000, "arm": 3_000}

    def count(function, robot, known="nothing"):
        assert robot is dynamics.PUMA_560
        return SimpleNamespace(multiplications=sizes[function.__name__] - fewer[known])

    def closed(links, shared, velocity_terms=True):
        assert shared is True and len(links) == 2
        return SimpleNamespace(multiplications=20 if velocity_terms else 15)

    monkeypatch.setattr(dynamics.costs, "count", count)
    monkeypatch.setattr(dynamics.costs, "count_closed_form", closed)
    assert dynamics.multiplications().value == 3_500
    assert dynamics.multiplications().text == (
        "Lagrangian form of six joints: closed 63,000, recursive 3,500, "
        "2,500 with its zeros known, 500 customised to the Puma; "
        "Newton-Euler 700; two joints, closed 20"
    )
    found = dynamics.recursion()
    assert found.value == pytest.approx(18.0)
    assert found.text == "six joints: 18 times fewer multiplications, 90 times by Newton-Euler"
    assert dynamics.ignoring_terms().value == pytest.approx(0.75)
    assert dynamics.ignoring_terms().text.startswith("15 for 20 multiplications")


# --- the real arm --------------------------------------------------------------------------------


def test_looking_ahead_in_closed_form():
    """Slope at the end of a parabola, and in the middle: variances from the normal equations."""
    x = np.arange(-10, 11)
    covariance = np.linalg.inv(np.vander(x, 3).T @ np.vander(x, 3))
    at = np.array([2 * 10.0, 1.0, 0.0]), np.array([0.0, 1.0, 0.0])
    ends, middle = (np.sqrt(row @ covariance @ row) for row in at)
    assert dynamics.looking_ahead(21).value == pytest.approx(ends / middle, rel=1e-6)


def test_rounding_in_differences():
    """Rounding is uniform: the difference of two readings has a sixth of a step squared."""
    step = dynamics.SETUP.effects.encoder[0].step
    found = dynamics.differencing()
    torque = dynamics.SETUP.controller.kd[0] * step / np.sqrt(6) / 0.002
    assert float(found.text.split()[0]) == pytest.approx(torque, rel=0.1)
    x = np.arange(-18, 1)
    covariance = np.linalg.inv(np.vander(x, 3).T @ np.vander(x, 3))
    gain = np.sqrt(covariance[1, 1])
    assert found.value == pytest.approx(np.sqrt(2) / gain, rel=0.25)


def test_a_dead_zone_swallows_its_width():
    """RMS of a constant loss over that of the torque: from which width is it a fifth?"""
    run = dynamics._ideal()
    rms = np.sqrt((run.tau_true[run.motion] ** 2).mean(0))
    found = dynamics.dead_zone(0.2)
    assert found.value == pytest.approx(dynamics.SIGNIFICANT * rms.min(), rel=0.02)
    assert found.text.startswith("dead zone of 0.2 N m: ")


def test_the_share_of_the_limit(monkeypatch):
    limit = np.array(dynamics.SETUP.effects.actuator[0].limit)
    tau = np.array([[1.0, -0.5], [-0.25, 0.1]]) * limit
    monkeypatch.setattr(dynamics, "_ideal", lambda: SimpleNamespace(tau_true=tau * [0.3, 0.8]))
    found = dynamics.saturation()
    assert found.value == pytest.approx(0.4)
    low, high = np.round(limit * [0.3, 0.4])
    assert found.text == (
        "the motion takes 40 % of the assumed limit at most; "
        f"limits below {low:.0f} or {high:.0f} N m would cut it"
    )


def test_second_differences_of_rounded_positions():
    """Rounding errors e, uniform: (e1 - 2 e0 + e-1) / T^2 has sqrt(6/12) steps over T^2."""
    run = dynamics._ideal()
    gain = np.sqrt((ARM.mass_matrix(run.q_true) ** 2).sum(-1).mean(0)) * np.sqrt(6 / 12) / 0.01**2
    share = gain / np.sqrt((run.tau_true[run.motion] ** 2).mean(0))
    steps = {bits: 2 * np.pi / 2**bits for bits in range(14, 21)}
    slight = [bits for bits, step in steps.items() if (step * share).max() < dynamics.SIGNIFICANT]
    found = dynamics.sensor_noise()
    assert found.value == min(slight)
    told = [int(word) for word in found.text.split() if word.isdigit()]
    np.testing.assert_allclose(told[2:4], 100 * steps[16] * share, rtol=0.1)


@pytest.mark.parametrize("bits", range(14, 21))
def test_any_encoder_may_be_the_first_that_is_slight(monkeypatch, bits):
    """The noise halves with each bit: a level between two encoders tells them apart."""
    text = dynamics.sensor_noise().text
    of_16 = max(int(x) / 100 for x in re.findall(r"(\d+) % (?:of the torque )?at the", text))
    monkeypatch.setattr(dynamics, "SIGNIFICANT", 1.4 * of_16 * 2.0 ** (16 - bits))
    assert dynamics.sensor_noise().value == bits


def test_the_springy_shafts_reference_is_a_motion(monkeypatch):
    """Velocity and acceleration are the slopes; from 0 s on it is trajectory 6."""

    class Enough(Exception):
        pass

    def follow(arm, controller, reference, t, **options):
        raise Enough(reference, t)

    monkeypatch.setattr(dynamics, "follow", follow)
    with pytest.raises(Enough) as caught:
        dynamics.snap()
    (q, qd, qdd), t = caught.value.args
    np.testing.assert_allclose(np.gradient(q, t, axis=0)[1:-1], qd[1:-1], atol=1e-5)
    np.testing.assert_allclose(np.gradient(qd, t, axis=0)[1:-1], qdd[1:-1], atol=1e-5)
    motion = (t >= 0) & (t < 3)
    wanted = dynamics.pick_and_place(dynamics.APPENDIX_I[5], t[motion])
    np.testing.assert_allclose(q[motion], wanted.q, atol=1e-12)
    assert np.abs(qd[motion]).max() > 0.1


def test_where_late_position_feedback_turns():
    """With that much viscous friction the slowest pole lies on the unit circle."""
    found = dynamics.sampling()
    viscous = found.value * np.array(dynamics.SETUP.effects.friction[0].coefficient)
    joints = dynamics.linear.plant(ARM.mass_matrix([0.0, 0.0]), viscous)
    gain = np.hstack([np.diag(KP), np.zeros((2, 2))])
    poles = np.abs(dynamics.late_poles(joints, gain, 0.002, 0.0012))
    assert poles.max() == pytest.approx(1.0, abs=1e-6)
    assert "1.2 ms late" in found.text
    # the text's growth: from the logarithm of the default's largest pole
    joints = dynamics.linear.plant(ARM.mass_matrix([0.0, 0.0]), viscous / found.value)
    late, held = (
        np.log(np.abs(dynamics.late_poles(joints, gain, 0.002, delay)).max()) / 0.002
        for delay in (0.0012, 0.0)
    )
    told = [float(x) for x in re.findall(r"(-?[\d.]+) 1/s", found.text.replace("−", "-"))]
    np.testing.assert_allclose(told, [late, held], rtol=0.05)
