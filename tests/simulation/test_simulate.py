"""The recorder: laws of conservation, rates, sensors, seeds and refusals."""

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy.integrate import simpson

from ddlib.control import pd, proportional
from ddlib.dynamics import CMU_DD_ARM_II, IMI_ARM, REYES_KELLY_ARM
from ddlib.effects import (
    IDEAL,
    CoulombFriction,
    Effects,
    Noise,
    Quantisation,
    Saturation,
    ViscousFriction,
)
from ddlib.simulation import Recording, follow, record
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


def free_motion(arm, q, qd, seconds, effects=IDEAL):
    """The arm left to itself, without torque: times, angles, velocities."""
    t = np.arange(round(seconds / 0.001) + 1) * 0.001
    rest, start = Trajectory(*np.zeros((3, t.size, 2))), (np.array(q), np.array(qd))
    options = dict(start=start, effects=effects, log_every=1)
    made = follow(arm, proportional((0.0, 0.0)), rest, t, **options)
    for logged, first in zip((made.q_true, made.qd_true), start):
        np.testing.assert_array_equal(logged[..., 0, :], first)
    return t, made.q_true, made.qd_true


@pytest.mark.parametrize("arm", [CMU_DD_ARM_II, IMI_ARM, REYES_KELLY_ARM], ids=lambda a: a.name)
def test_free_arm_keeps_its_energy_and_momentum(arm):
    q = np.array([[0.3, 0.5], [-1.0, 2.0], [0.5, -1.2]])
    qd = np.array([[1.0, -0.5], [0.8, 1.5], [-1.5, 0.3]])
    _, q, qd = free_motion(arm, q, qd, 4.0)
    assert q.shape == (3, 4001, 2)
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


@pytest.fixture(scope="module")
def paper_run():
    return record(ARM, PD, APPENDIX_I, effects=SENSORS, seed=5)


def test_a_recording_has_300_samples_of_motion_and_whole_rests(paper_run):
    np.testing.assert_allclose(paper_run.t, np.arange(-50, 350) / 100, atol=1e-12)
    assert paper_run.motion == slice(50, 350) and paper_run.q.shape == (6, 400, 2)
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
    assert made.q.shape == (samples + 2 * rest, 2)


def test_the_applied_torque_is_the_law_on_the_measured_state():
    gains = np.array([200.0, 80.0])
    effects = Effects(friction=FRICTION, encoder=(Quantisation.encoder(12),))
    recording = run(proportional(tuple(gains)), effects)
    wanted = gains * (recording.reference.q - recording.q)
    np.testing.assert_array_equal(recording.tau_true, wanted)
    np.testing.assert_array_equal(recording.tau, recording.tau_true)
    on_truth = gains * (recording.reference.q - recording.q_true)
    assert np.abs(recording.tau_true - on_truth).max() > 0.01  # not the true state


def test_readings_are_whole_encoder_steps_and_noise_is_in_the_log_only(paper_run):
    step = 2 * np.pi / 2**16
    count, error = paper_run.q / step, np.abs(paper_run.q - paper_run.q_true)
    np.testing.assert_allclose(count, np.round(count), atol=1e-6)
    assert 0.4 * step < error.max() <= step / 2 * (1 + 1e-9)
    noise = (paper_run.tau - paper_run.tau_true).reshape(-1, 2)
    np.testing.assert_allclose(noise.std(0), [0.4, 0.1], rtol=4 / np.sqrt(2 * len(noise)))
