"""The recorder: laws of conservation, rates, sensors, seeds and refusals."""

import warnings
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy.integrate import simpson

from ddlib.control import ComputedTorque, pd, proportional
from ddlib.dynamics import CMU_DD_ARM_II, IMI_ARM, PUMA_560, REYES_KELLY_ARM
from ddlib.effects import (
    IDEAL,
    ComputingTime,
    CoulombFriction,
    Effects,
    Noise,
    Quantisation,
    Saturation,
    ViscousFriction,
)
from ddlib.simulation import Recording, follow, free_motion, record
from ddlib.trajectories import APPENDIX_I, Trajectory, pick_and_place, time_grid

ARM = CMU_DD_ARM_II
PD = pd((200.0, 80.0), (30.0, 12.0))
FRICTION = (ViscousFriction((0.5, 0.15)), CoulombFriction((0.5, 0.15)))
SENSORS = Effects(
    friction=FRICTION,
    actuator=(Saturation((100.0, 30.0)),),
    encoder=(Quantisation.encoder(16),),
    torque_sensor=(Noise((0.4, 0.1)),),
)


def short(seconds=0.4, step=0.002, extents=(45.0, 20.0), rest=0.1):
    """A reference cut short, for quick runs: `t` and the reference."""
    t = time_grid(step, rest)[: round(seconds / step)]
    return t, pick_and_place(extents, t)


def run(controller=PD, effects=IDEAL, seed=0, arm=ARM, reference=None, **options) -> Recording:
    t, made = short()
    return follow(arm, controller, reference or made, t, effects=effects, seed=seed, **options)


# --- the integrator ---------------------------------------------------------------------


@pytest.mark.parametrize("arm", [CMU_DD_ARM_II, IMI_ARM, REYES_KELLY_ARM], ids=lambda a: a.name)
def test_free_arm_keeps_its_energy_and_momentum(arm):
    q = np.array([[0.3, 0.5], [-1.0, 2.0], [0.5, -1.2]])
    qd = np.array([[1.0, -0.5], [0.8, 1.5], [-1.5, 0.3]])
    t, q, qd = free_motion(arm, q, qd, 4.0)
    assert t[-1] == pytest.approx(4.0) and q.shape == (3, 4001, 2)
    kinetic = arm.kinetic_energy(q, qd)
    e, moving = kinetic + arm.potential_energy(q), kinetic.max(-1, keepdims=True)
    assert (np.abs(e - e[:, :1]) / moving).max() < 1e-6
    assert (np.ptp(q, axis=1) > 0.5).all()  # every joint of every run has moved
    if not any(arm.gravity_moments):  # no torque at the shoulder: its momentum is constant
        momentum = np.einsum("...j,...j", arm.mass_matrix(q)[..., 0, :], qd)
        np.testing.assert_allclose(momentum, momentum[:, :1] + 0 * momentum, rtol=1e-6)


def test_friction_takes_exactly_the_energy_that_is_lost():
    effects = Effects(friction=(ViscousFriction((2.0, 0.6)),))
    t, q, qd = free_motion(REYES_KELLY_ARM, [0.5, 0.7], [2.0, -1.0], 2.0, effects=effects)
    power = (qd * effects.friction_torque(qd)).sum(-1)
    lost = simpson(power, x=t)
    e = REYES_KELLY_ARM.kinetic_energy(q, qd) + REYES_KELLY_ARM.potential_energy(q)
    assert lost > 0.1 * (e[0] - REYES_KELLY_ARM.potential_energy([0, 0]))
    assert e[0] - e[-1] == pytest.approx(lost, rel=1e-6)
    assert (np.diff(e) <= 1e-12).all()


# --- rates and samples ------------------------------------------------------------------


@pytest.fixture(scope="module")
def paper_run():
    return record(ARM, PD, APPENDIX_I, effects=SENSORS, seed=5)


def test_a_recording_has_300_samples_of_motion_and_whole_rests(paper_run):
    np.testing.assert_allclose(paper_run.t, np.arange(-50, 350) / 100, atol=1e-12)
    assert paper_run.motion == slice(50, 350) and paper_run.q.shape == (6, 400, 2)
    assert repr(paper_run) == "Recording(6 runs x 400 samples x 2 joints, -0.5 to 3.49 s)"
    for logged, formula in zip(paper_run.reference, pick_and_place(APPENDIX_I, paper_run.t)):
        np.testing.assert_allclose(logged, formula, atol=1e-12)


@settings(deadline=None, max_examples=20)
@given(samples=st.integers(15, 60), rest=st.integers(0, 3), step=st.floats(0.01, 0.09))
def test_a_recording_knows_its_motion(samples, rest, step):
    duration = samples * step
    options = dict(control_step=step, log_step=step, rest=rest * step)
    made = record(ARM, proportional((1.0, 1.0)), (20.0, 10.0), duration=duration, **options)
    assert made.motion == slice(rest, rest + samples)
    assert made.span == pytest.approx((0.0, duration)) and made.step == pytest.approx(step)
    # the reference alone says as much
    assert replace(made, duration=None).motion == made.motion
    assert made.q.shape == (samples + 2 * rest, 2)


def test_an_arm_may_start_anywhere_and_moving():
    """Without torque it is the free arm."""
    t = np.arange(400) * 0.002
    start = np.array([[0.3, 0.5], [-1.0, 2.0]]), np.array([[1.0, -0.5], [0.8, 1.5]])
    rest = Trajectory(*np.zeros((3, t.size, 2)))
    for arm in (ARM, REYES_KELLY_ARM):
        made = follow(arm, proportional((0.0, 0.0)), rest, t, start=start, log_every=1)
        _, q, qd = free_motion(arm, *start, seconds=t[-1], step=0.002)
        np.testing.assert_allclose(made.q_true, q, atol=1e-12)
        np.testing.assert_allclose(made.qd_true, qd, atol=1e-12)
        assert made.q_true.shape == (2, t.size, 2) and not made.tau.any()
    # the difference of the first two readings is the velocity at the start
    difference = pd((0.0, 0.0), (3.0, 2.0))
    made = follow(ARM, difference, rest, t, start=start, velocity="difference", log_every=1)
    np.testing.assert_allclose(made.tau[:, 0], -start[1] * [3.0, 2.0])


# --- actuator and sensors -----------------------------------------------------------------


def test_the_applied_torque_is_the_law_on_the_measured_state():
    gains = np.array([200.0, 80.0])
    effects = Effects(friction=FRICTION, encoder=(Quantisation.encoder(12),))
    recording = run(proportional(tuple(gains)), effects)
    wanted = gains * (recording.reference.q - recording.q)
    np.testing.assert_array_equal(recording.tau_true, wanted)
    np.testing.assert_array_equal(recording.tau, recording.tau_true)
    on_truth = gains * (recording.reference.q - recording.q_true)
    assert np.abs(recording.tau_true - on_truth).max() > 0.01  # not the true state
    limit = np.array([20.0, 3.0])
    clipped = run(proportional(tuple(10 * gains)), Effects(actuator=(Saturation(tuple(limit)),)))
    wanted = 10 * gains * (clipped.reference.q - clipped.q)
    assert (np.abs(wanted).max(0) > limit).all()
    np.testing.assert_array_equal(clipped.tau_true, np.clip(wanted, -limit, limit))


def test_readings_are_whole_encoder_steps_and_noise_is_in_the_log_only(paper_run):
    step = 2 * np.pi / 2**16
    count, error = paper_run.q / step, np.abs(paper_run.q - paper_run.q_true)
    np.testing.assert_allclose(count, np.round(count), atol=1e-6)
    assert 0.4 * step < error.max() <= step / 2 * (1 + 1e-9)
    noise = (paper_run.tau - paper_run.tau_true).reshape(-1, 2)
    np.testing.assert_allclose(noise.std(0), [0.4, 0.1], rtol=4 / np.sqrt(2 * len(noise)))
    quiet = record(ARM, PD, APPENDIX_I, effects=SENSORS.without("torque_sensor"))
    np.testing.assert_array_equal(quiet.tau_true, paper_run.tau_true)
    np.testing.assert_array_equal(quiet.q, paper_run.q)


def test_a_controller_may_be_a_plain_function():
    kp, kd = np.array([60.0, 30.0]), np.array([9.0, 4.0])

    def spring_and_damper(wanted, q, qd):
        assert wanted.q.shape == q.shape == qd.shape == (2, 2)
        return kp * (wanted.q - q) + kd * (wanted.qd - qd)

    own = record(ARM, spring_and_damper, APPENDIX_I[:2])
    built_in = record(ARM, pd(kp, kd), APPENDIX_I[:2])
    np.testing.assert_allclose(own.tau, built_in.tau, atol=1e-12)


# --- refusals ------------------------------------------------------------------------


@pytest.mark.parametrize("arm", [CMU_DD_ARM_II, REYES_KELLY_ARM], ids=lambda a: a.name)
def test_divergence_is_reported_and_nothing_else(arm):
    wild = ComputedTorque(arm, (1e8, 1e8), (1e8, 1e8))
    for controller in (proportional((1e5, 1e5)), pd((1e80, 1e80), (1e80, 1e80)), wild):
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            with pytest.raises(ValueError, match=r"loop diverges.*lower the gains"):
                record(arm, controller, (45.0, 45.0), rest=0.1)


def refused(call, good, cases, error=ValueError):
    """Every change of the good arguments is refused in the words beside it."""
    for words, change in cases:
        with pytest.raises(error, match=words):
            call(**{**good, **change})


def test_record_refuses_bad_values():
    good = dict(arm=ARM, controller=PD, extents_deg=(45.0, 45.0))
    cases = [
        ("log_step must be a multiple of control_step", dict(log_step=0.003)),
        ("log_step", dict(log_step=0.001)),
        ("control_step", dict(control_step=0.0)),
        ("^step must", dict(control_step=0.0013, log_step=0.0013, rest=0.0)),
        ("rest must be a multiple of log_step", dict(rest=0.502)),
        ("rest", dict(rest=-0.5)),
        ("velocity must be one of 'tachometer', 'difference'", dict(velocity="measured")),
        ("seed", dict(seed=-1)),
        ("extents_deg", dict(extents_deg=(45.0,))),
        ("extents_deg", dict(extents_deg=(45.0, np.nan))),
    ]
    refused(record, good, cases)


def test_follow_refuses_bad_values():
    reference = Trajectory(*np.zeros((3, 3, 3, 2)))  # three runs of three samples
    good = dict(arm=ARM, controller=PD, reference=reference, t=[0.0, 0.1, 0.2])
    follow(**good)
    times = ([0.0], [0.0, 0.1, 0.3], [0.0, -0.1, -0.2], [0.0, 0.0, 0.0], [0.0, np.nan, 0.2])
    parts = dict(q=np.zeros((3, 3)), qd=np.zeros((2, 2)), qdd=np.full((3, 3, 2), np.nan))
    starts = {
        "start must be a pair": ([0.0, 0.0],),
        r"start\[0\] must": ([0.0], [0.0, 0.0]),
        r"start\[1\] must": ([0.0, 0.0], [0.0, np.nan]),
        r"start must fit to the runs \(3,\)": (np.zeros((4, 2)), np.zeros(2)),
    }
    cases = [
        *(("t must", dict(t=t)) for t in times),
        *(
            (rf"reference\.{k} must", {"reference": reference._replace(**{k: parts[k]})})
            for k in parts
        ),
        *((f"^{words}", dict(start=start)) for words, start in starts.items()),
        ("log_every", dict(log_every=0)),
        ("computing time below the control", dict(effects=Effects(actuator=(ComputingTime(0.1),)))),
        *(("seed must", dict(effects=SENSORS, seed=bad)) for bad in ([0, 1], [0, -1, 2])),
    ]
    refused(follow, good, cases)
    cases = [
        ("log_every", dict(log_every=5.0)),
        *(
            ("seed must", dict(effects=SENSORS, seed=bad))
            for bad in (None, "many", [0.0, 1.0, 2.0])
        ),
        ("controller must have a start method or be a function", dict(controller="PD")),
        ("arm must be an Arm, which has two joints, .* got SerialArm", dict(arm=PUMA_560)),
        (r"effects must be Effects with .* got ViscousFriction", dict(effects=FRICTION[0])),
    ]
    refused(follow, good, cases, TypeError)


def test_a_controller_must_return_a_torque_for_each_joint():
    words = r"controller must return torques of shape \(\.\.\., 2\), .* got .*3\..* of shape "
    for torque, shape in ((3.0, r"\(\)"), ([3.0, 1.0, 1.0], r"\(3,\)"), ([[3.0]], r"\(1, 1\)")):
        with pytest.raises(ValueError, match=words + shape):
            record(ARM, lambda wanted, q, qd, torque=torque: torque, (45.0, 20.0))


def test_recordings_and_free_motions_refuse_bad_values(paper_run):
    for name, value in (("duration", 0.0), ("control_step", -1.0), ("computing_time", -1.0)):
        with pytest.raises(ValueError, match=rf"^{name} must"):
            replace(paper_run, **{name: value})
    with pytest.raises(ValueError, match=r"^t must increase in equal steps"):
        _ = replace(paper_run, t=paper_run.t**3).step
    good = dict(arm=ARM, q=[0, 0], qd=[0, 0], seconds=1.0)
    cases = [
        ("^q must", dict(q=[np.nan, 0])),
        ("^qd must", dict(qd=[0, 0, 0])),
        ("^seconds must", dict(seconds=0.0)),
        ("^seconds must", dict(step=0.3)),
        ("^step must", dict(step=2.0)),
    ]
    refused(free_motion, good, cases)
