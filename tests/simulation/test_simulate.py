"""The recorder: laws of conservation, rates, sensors, seeds and refusals."""

import warnings
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import simpson, solve_ivp

from ddlib.control import ComputedTorque, pd, proportional
from ddlib.dynamics import CMU_DD_ARM_II, IMI_ARM, REYES_KELLY_ARM, Arm, Link
from ddlib.effects import (
    CMU_DD_ARM_II_EFFECTS,
    IDEAL,
    CoulombFriction,
    Effects,
    Noise,
    Quantisation,
    Saturation,
    ViscousFriction,
)
from ddlib.experiments import STATE_FEEDBACK
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
ARRAYS = ("q", "tau", "q_true", "qd_true", "tau_true")


def short(seconds=0.4, step=0.002, extents=(45.0, 20.0), rest=0.1):
    """A reference cut short, for quick runs: `t` and the reference."""
    t = time_grid(step, rest)[: round(seconds / step)]
    return t, pick_and_place(extents, t)


def run(controller=PD, effects=IDEAL, seed=0, arm=ARM, reference=None, **options) -> Recording:
    t, made = short()
    return follow(arm, controller, reference or made, t, effects=effects, seed=seed, **options)


def energy(arm, q, qd):
    return arm.kinetic_energy(q, qd) + arm.potential_energy(q)


# --- the integrator ---------------------------------------------------------------------


@pytest.mark.parametrize("arm", [CMU_DD_ARM_II, IMI_ARM, REYES_KELLY_ARM], ids=lambda a: a.name)
def test_free_arm_keeps_its_energy_for_ten_seconds(arm):
    q = np.array([[0.3, 0.5], [-1.0, 2.0], [0.5, -1.2]])
    qd = np.array([[1.0, -0.5], [0.8, 1.5], [-1.5, 0.3]])
    t, q, qd = free_motion(arm, q, qd, 10.0)
    assert t[-1] == pytest.approx(10.0) and q.shape == (3, 10001, 2)
    e, moving = energy(arm, q, qd), arm.kinetic_energy(q, qd).max(-1, keepdims=True)
    assert (np.abs(e - e[:, :1]) / moving).max() < 1e-6
    assert (np.ptp(q, axis=1) > 0.5).all()  # every joint of every run has moved


def test_free_arm_without_gravity_keeps_its_angular_momentum():
    """No torque at the shoulder: the first row of M(q) qd is constant."""
    _, q, qd = free_motion(ARM, [0.3, 0.5], [1.0, -2.5], 5.0, step=0.002)
    momentum = np.einsum("tj,tj->t", ARM.mass_matrix(q)[:, 0], qd)
    np.testing.assert_allclose(momentum, momentum[0], rtol=1e-7)
    assert np.ptp(qd[:, 0]) > 0.1  # the velocities do change


@pytest.mark.parametrize("arm", [CMU_DD_ARM_II, REYES_KELLY_ARM], ids=lambda a: a.name)
def test_free_motion_agrees_with_scipy(arm):
    def rate(_, y):
        net = -arm.coriolis_matrix(y[:2], y[2:]) @ y[2:] - arm.gravity(y[:2])
        return [*y[2:], *np.linalg.solve(arm.mass_matrix(y[:2]), net)]

    start = [0.4, 0.6, 1.0, -0.5]
    t, q, qd = free_motion(arm, start[:2], start[2:], 10.0)
    every = slice(None, None, 500)
    answer = solve_ivp(rate, (0, 10), start, "DOP853", t[every], rtol=1e-11, atol=1e-12)
    np.testing.assert_allclose(q[every], answer.y[:2].T, atol=1e-6)
    np.testing.assert_allclose(qd[every], answer.y[2:].T, atol=1e-6)


def test_a_simple_pendulum_swings_with_its_period():
    """One heavy link, a weightless one behind: 2 pi sqrt(I / (m g c)) for a small swing."""
    heavy, light = Link(2.0, 0.5, 0.4, 0.1), Link(1e-7, 0.1, 0.05, 1e-7)
    arm = Arm.from_links("pendulum", heavy, light, gravity=9.81)
    t, q, _ = free_motion(arm, [1e-3, 0.0], [0.0, 0.0], 6.0, step=0.002)
    rising = np.flatnonzero((q[:-1, 0] < 0) & (q[1:, 0] >= 0))
    crossing = t[rising] - q[rising, 0] * 0.002 / (q[rising + 1, 0] - q[rising, 0])
    period = 2 * np.pi * np.sqrt((0.1 + 2.0 * 0.4**2) / (2.0 * 9.81 * 0.4))
    np.testing.assert_allclose(np.diff(crossing), period, rtol=1e-5)


def test_friction_takes_exactly_the_energy_that_is_lost():
    effects = Effects(friction=(ViscousFriction((2.0, 0.6)),))
    t, q, qd = free_motion(REYES_KELLY_ARM, [0.5, 0.7], [2.0, -1.0], 2.0, effects=effects)
    power = (qd * effects.friction_torque(qd)).sum(-1)
    lost = simpson(power, x=t)
    e = energy(REYES_KELLY_ARM, q, qd)
    assert lost > 0.1 * (e[0] - REYES_KELLY_ARM.potential_energy([0, 0]))
    assert e[0] - e[-1] == pytest.approx(lost, rel=1e-6)
    assert (np.diff(e) <= 1e-12).all()


def test_viscous_friction_decays_at_its_closed_form():
    """Elbow straight and both joints turning alone: one equation, one exponential."""
    arm = Arm("diagonal inertia", a=4.0, b=0.0, d=1e-9, lengths=(1.0, 1.0))
    effects = Effects(friction=(ViscousFriction((2.0, 0.0)),))
    t, q, qd = free_motion(arm, [0.0, 0.0], [1.0, -1.0], 2.0, 0.01, effects=effects)
    np.testing.assert_allclose(qd[:, 0], np.exp(-2.0 / 4.0 * t), rtol=1e-8)
    np.testing.assert_allclose(q[:, 0], 2 * (1 - np.exp(-t / 2)), atol=1e-8)


def test_free_motions_at_once_and_broadcast():
    qd = np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 2.0]])
    _, q, _ = free_motion(ARM, [0.1, 0.2], qd, 0.5, step=0.01)
    assert q.shape == (3, 51, 2)
    for i in range(3):
        np.testing.assert_allclose(q[i], free_motion(ARM, [0.1, 0.2], qd[i], 0.5, 0.01)[1])


@pytest.mark.parametrize(
    "arguments, name",
    [
        (([np.nan, 0], [0, 0], 1.0), "q"),
        (([0, 0], [0, 0, 0], 1.0), "qd"),
        (([0, 0], [0, 0], 0.0), "seconds"),
        (([0, 0], [0, 0], np.inf), "seconds"),
        (([0, 0], [0, 0], 1.0, 0.0), "step"),
        (([0, 0], [0, 0], 1.0, 2.0), "step"),
        (([0, 0], [0, 0], 1.0, 0.3), "seconds"),
    ],
)
def test_free_motion_refuses_bad_values(arguments, name):
    with pytest.raises(ValueError, match=rf"^{name} must"):
        free_motion(ARM, *arguments)


# --- rates and samples ------------------------------------------------------------------


@pytest.fixture(scope="module")
def paper_run():
    return record(ARM, PD, APPENDIX_I, effects=SENSORS, seed=5)


def test_a_recording_has_300_samples_of_motion_and_whole_rests(paper_run):
    assert paper_run.t.shape == (400,) and paper_run.t[0] == -0.5
    np.testing.assert_allclose(np.diff(paper_run.t), 0.01, rtol=1e-9)
    motion = paper_run.motion
    assert paper_run.t[motion].size == 300 and (motion.start, motion.stop) == (50, 350)
    assert paper_run.t[motion][0] == 0.0 and paper_run.t[motion.stop] == pytest.approx(3.0)
    for name in ARRAYS:
        assert getattr(paper_run, name).shape == (6, 400, 2), name
    for logged, formula in zip(paper_run.reference, pick_and_place(APPENDIX_I, paper_run.t)):
        np.testing.assert_allclose(logged, formula, atol=1e-12)
    for name in ARRAYS:
        assert np.isfinite(getattr(paper_run, name)).all(), name


@settings(deadline=None, max_examples=10)
@given(ratio=st.integers(1, 5), samples=st.integers(30, 60), rest=st.integers(0, 3))
def test_motion_is_whole_at_any_rate(ratio, samples, rest):
    log_step = 3.0 / samples
    recording = record(
        ARM,
        proportional((1.0, 1.0)),
        (20.0, 10.0),
        rest=rest * log_step,
        control_step=log_step / ratio,
        log_step=log_step,
    )
    assert recording.q.shape == (samples + 2 * rest, 2)
    assert recording.t[recording.motion].size == samples and recording.motion.start == rest


def test_arm_rests_until_the_motion_begins(paper_run):
    assert not paper_run.q_true[:, :50].any() and not paper_run.tau_true[:, :50].any()
    assert (np.abs(paper_run.q_true[:, 60]).max(-1) > 0).all()


def test_the_log_takes_every_fifth_control_sample():
    every, fifth, seventh = (run(effects=SENSORS, log_every=n) for n in (1, 5, 7))
    for name in ("t", "q", "q_true", "qd_true", "tau_true"):
        for n, sparse in ((5, fifth), (7, seventh)):
            axis = (slice(None, None, n),)
            np.testing.assert_array_equal(getattr(sparse, name), getattr(every, name)[axis])
    np.testing.assert_array_equal(fifth.reference.qdd, every.reference.qdd[::5])
    assert not np.array_equal(fifth.tau, every.tau[::5])  # each log entry draws its own noise


def test_record_is_follow_on_the_pick_and_place_family(paper_run):
    t = time_grid(0.002, 0.5)
    own = follow(ARM, PD, pick_and_place(APPENDIX_I, t), t, effects=SENSORS, seed=5)
    for name in ARRAYS:
        np.testing.assert_array_equal(getattr(own, name), getattr(paper_run, name))


def test_the_held_torque_explains_the_motion():
    """Between two control samples the torque is constant: scipy integrates to the next one."""
    every = run(effects=Effects(friction=FRICTION[:1]), log_every=1)
    for k in (60, 75, 120, 180):

        def rate(_, y, tau=every.tau_true[k]):
            net = tau - FRICTION[0].torque(y[2:])
            return [*y[2:], *ARM.forward_dynamics(y[:2], y[2:], net)]

        state = [*every.q_true[k], *every.qd_true[k]]
        end = solve_ivp(rate, (0, 0.002), state, "DOP853", rtol=1e-12, atol=1e-14).y[:, -1]
        np.testing.assert_allclose(end[:2], every.q_true[k + 1], atol=1e-12)
        np.testing.assert_allclose(end[2:], every.qd_true[k + 1], atol=1e-11)


def test_a_loop_starts_where_its_reference_starts():
    t = np.arange(100) * 0.002
    reference = Trajectory(*(np.broadcast_to(x, (100, 2)) for x in ([0.5, -0.3], 0.0, 0.0)))
    recording = follow(ARM, PD, reference, t)
    np.testing.assert_array_equal(recording.q_true, np.broadcast_to([0.5, -0.3], (20, 2)))
    assert not recording.tau.any()


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


@pytest.mark.parametrize("still", [np.zeros(2), np.array([0.5, -0.3])])
def test_without_a_moving_reference_all_from_zero_on_is_motion(still):
    t = time_grid(0.01, 0.1, 0.5)
    reference = Trajectory(np.zeros((t.size, 2)) + still, *np.zeros((2, t.size, 2)))
    made = follow(ARM, PD, reference, t, log_every=1)
    assert made.motion == slice(10, 70)
    assert follow(ARM, PD, reference, t, log_every=1, duration=0.2).motion == slice(10, 30)


def test_a_motion_begins_where_the_reference_moves_first():
    t = np.arange(200) * 0.01
    moving = (t > 0.495) & (t < 1.205)
    rate = np.stack([moving, 0 * t], -1)
    reference = Trajectory(np.cumsum(rate, 0) * 0.01, rate, 0 * rate)
    two = Trajectory(*(np.stack([x, 0 * x]) for x in reference))  # the second run rests
    for wanted in (reference, two):
        made = follow(ARM, PD, wanted, t, log_every=1)
        assert made.motion == slice(50, 121)
        assert made.span == pytest.approx((0.5, 1.21))


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


def test_the_first_difference_of_readings_is_the_velocity_at_the_start():
    t = np.arange(5) * 0.002
    rest = Trajectory(*np.zeros((3, 5, 2)))
    options = dict(start=([0.2, 0.1], [1.0, -2.0]), velocity="difference", log_every=1)
    made = follow(ARM, pd((0.0, 0.0), (3.0, 2.0)), rest, t, **options)
    np.testing.assert_allclose(made.tau[0], [-3.0, 4.0])


@pytest.mark.parametrize(
    "start, words",
    [
        (3.0, r"^start must be a pair"),
        (([0.0, 0.0],), r"^start must be a pair"),
        (([0.0], [0.0, 0.0]), r"^start\[0\] must"),
        (([0.0, 0.0], [0.0, np.nan]), r"^start\[1\] must"),
        ((np.zeros((4, 2)), np.zeros(2)), r"^start must fit to the runs \(3,\)"),
    ],
)
def test_a_start_that_does_not_fit_is_refused(start, words):
    reference = Trajectory(*np.zeros((3, 3, 3, 2)))
    with pytest.raises(ValueError, match=words):
        follow(ARM, PD, reference, [0.0, 0.1, 0.2], start=start)


@pytest.mark.parametrize(
    "name, value", [("duration", 0.0), ("control_step", -1.0), ("computing_time", -1.0)]
)
def test_a_recording_refuses_bad_times(paper_run, name, value):
    with pytest.raises(ValueError, match=rf"^{name} must"):
        replace(paper_run, **{name: value})
    with pytest.raises(ValueError, match=r"^t must increase in equal steps"):
        _ = replace(paper_run, t=paper_run.t**3).step


def test_halving_the_step_changes_little_and_in_proportion():
    """The remaining difference is the control period itself: first order."""
    final = []
    for step in (0.004, 0.002, 0.001):
        t, reference = short(0.6, step)
        recording = follow(
            ARM, PD, reference, t, effects=Effects(friction=FRICTION[:1]), log_every=1
        )
        # a time that all three grids share
        final.append(recording.q_true[round(0.6 / step) - round(0.004 / step)])
    first, second = final[0] - final[1], final[1] - final[2]
    assert 0 < np.abs(second).max() < 1e-3
    np.testing.assert_allclose(first / second, 2, atol=0.3)


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


def test_the_applied_torque_saturates_but_the_law_does_not():
    gains, limit = np.array([2000.0, 800.0]), np.array([20.0, 3.0])
    recording = run(proportional(tuple(gains)), Effects(actuator=(Saturation(tuple(limit)),)))
    wanted = gains * (recording.reference.q - recording.q)
    assert (np.abs(wanted).max(0) > limit).all()
    np.testing.assert_array_equal(recording.tau_true, np.clip(wanted, -limit, limit))


def test_measured_positions_are_multiples_of_the_encoder_step(paper_run):
    step = 2 * np.pi / 2**16
    count = paper_run.q / step
    np.testing.assert_allclose(count, np.round(count), atol=1e-6)
    error = paper_run.q - paper_run.q_true
    assert np.abs(error).max() <= step / 2 * (1 + 1e-9)
    assert np.abs(error).max() > 0.4 * step
    assert np.unique(np.round(count)).size > 1000


def test_torque_noise_is_in_the_log_only(paper_run):
    noise = (paper_run.tau - paper_run.tau_true).reshape(-1, 2)
    np.testing.assert_allclose(noise.std(0), [0.4, 0.1], rtol=4 / np.sqrt(2 * len(noise)))
    quiet = record(ARM, PD, APPENDIX_I, effects=SENSORS.without("torque_sensor"))
    np.testing.assert_array_equal(quiet.tau_true, paper_run.tau_true)
    np.testing.assert_array_equal(quiet.q, paper_run.q)


def test_surrogate_noise_is_what_its_docstring_says():
    """2.4 % of the torques' standard deviation; the torque limits are not reached."""
    controller = STATE_FEEDBACK.controller
    recording = record(ARM, controller, APPENDIX_I, effects=CMU_DD_ARM_II_EFFECTS)
    tau = recording.tau_true[:, recording.motion].reshape(-1, 2)
    noise = (recording.tau - recording.tau_true).reshape(-1, 2)
    np.testing.assert_allclose(noise.std(0) / tau.std(0), 0.024, rtol=0.05)
    assert (np.abs(tau).max(0) < [100.0, 30.0]).all()


def test_ideal_sensors_tell_the_truth():
    recording = run()
    np.testing.assert_array_equal(recording.q, recording.q_true)
    np.testing.assert_array_equal(recording.tau, recording.tau_true)


NOISY = Effects(encoder=(Noise((1e-4, 1e-4)),), torque_sensor=(Noise((0.4, 0.1)),))


def test_noise_is_reproducible_and_differs_by_seed():
    first, again, other = (run(effects=NOISY, seed=s) for s in (3, 3, 4))
    for name in ARRAYS:
        np.testing.assert_array_equal(getattr(first, name), getattr(again, name))
        assert not np.array_equal(getattr(first, name), getattr(other, name)), name


def test_runs_of_a_batch_have_their_own_noise():
    t, reference = short(extents=[(45.0, 20.0)] * 2)
    twins = follow(ARM, PD, reference, t, effects=NOISY)
    assert not np.array_equal(twins.q[0], twins.q[1])
    assert not np.array_equal(*(twins.tau - twins.tau_true))


def test_velocity_from_encoder_readings():
    """Quantised readings give a velocity in steps of q_step / period, so the torque shows them."""
    kd, bits = np.array([30.0, 12.0]), 12
    effects = Effects(encoder=(Quantisation.encoder(bits),))
    controller = pd((0.0, 0.0), tuple(kd))
    recording = run(controller, effects, velocity="difference", log_every=1)
    readings = np.diff(recording.q, axis=0, prepend=recording.q[:1])
    speed = readings / 0.002
    wanted = kd * (recording.reference.qd - speed)
    np.testing.assert_allclose(recording.tau_true, wanted, atol=1e-8)
    smooth = run(controller, effects, log_every=1)
    np.testing.assert_allclose(
        smooth.tau_true, kd * (smooth.reference.qd - smooth.qd_true), atol=1e-12
    )
    assert np.abs(speed - recording.qd_true).max() > 0.1


def test_tracking_error_is_reference_minus_true_position():
    recording = run(effects=SENSORS)
    np.testing.assert_array_equal(
        recording.tracking_error, recording.reference.q - recording.q_true
    )
    assert recording.tracking_error.min() < 0  # the arm lags behind a falling reference


def test_the_reference_is_not_touched():
    t, reference = short()
    before = [x.copy() for x in reference]
    recording = follow(ARM, PD, reference, t)
    recording.q[:] = 9.0
    for now, then in zip(reference, before):
        np.testing.assert_array_equal(now, then)


# --- refusals ------------------------------------------------------------------------


@pytest.mark.parametrize("arm", [CMU_DD_ARM_II, REYES_KELLY_ARM], ids=lambda a: a.name)
@pytest.mark.parametrize(
    "make",
    [
        lambda arm: proportional((1e5, 1e5)),
        lambda arm: pd((1e5, 1e5), (1e5, 1e5)),
        lambda arm: pd((1e80, 1e80), (1e80, 1e80)),
        lambda arm: ComputedTorque(arm, (1e8, 1e8), (1e8, 1e8)),
    ],
    ids=["P", "PD", "extreme PD", "computed torque"],
)
def test_divergence_is_reported_and_nothing_else(arm, make):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(ValueError, match=r"loop diverges.*lower the gains"):
            record(arm, make(arm), (45.0, 45.0), rest=0.1)


@pytest.mark.parametrize(
    "options, words",
    [
        (dict(log_step=0.003), "log_step must be a multiple of control_step"),
        (dict(log_step=0.001), "log_step"),
        (dict(log_step=np.nan), "log_step"),
        (dict(control_step=0.0), "control_step"),
        (dict(control_step=-0.002), "control_step"),
        (dict(control_step=0.0013, log_step=0.0013, rest=0.0), "^step must"),
        (dict(rest=0.502), "rest must be a multiple of log_step"),
        (dict(rest=0.001), "rest"),
        (dict(rest=-0.5), "rest"),
        (dict(velocity="measured"), "velocity must be one of 'tachometer', 'difference'"),
        (dict(seed=-1), "seed"),
        (dict(extents_deg=(45.0,)), "extents_deg"),
        (dict(extents_deg=(45.0, np.nan)), "extents_deg"),
    ],
)
def test_record_refuses_bad_values(options, words):
    options = {"extents_deg": (45.0, 45.0), **options}
    with pytest.raises(ValueError, match=words):
        record(ARM, PD, **options)


@pytest.mark.parametrize(
    "change, words",
    [
        (dict(t=0.0), "t must"),
        (dict(t=[0.0]), "t must"),
        (dict(t=[0.0, 0.1, 0.3]), "t must"),
        (dict(t=[0.0, -0.1, -0.2]), "t must"),
        (dict(t=[0.0, 0.0, 0.0]), "t must"),
        (dict(t=[0.0, np.nan, 0.2]), "t must"),
        (dict(t=[0.0, 0.1]), r"reference\.q must have shape"),
        (dict(reference=Trajectory(*np.zeros((3, 2)))), "reference"),
        (dict(reference=Trajectory(*np.zeros((3, 3, 3)))), r"reference\.q must"),
        (dict(reference=Trajectory(*np.full((3, 3, 2), np.nan))), r"reference\.q must"),
        (dict(log_every=0), "log_every"),
        (dict(velocity="none"), "velocity"),
    ],
)
def test_follow_refuses_bad_values(change, words):
    good = dict(reference=Trajectory(*np.zeros((3, 3, 2))), t=[0.0, 0.1, 0.2])
    follow(ARM, PD, **good)
    with pytest.raises(ValueError, match=words):
        follow(ARM, PD, **{**good, **change})


@pytest.mark.parametrize(
    "field, shape", [("qd", (2, 2)), ("qdd", (4, 2)), ("qd", (2,)), ("qdd", (1, 2))]
)
def test_follow_refuses_references_whose_parts_differ(field, shape):
    reference = Trajectory(*np.zeros((3, 3, 2)))._replace(**{field: np.zeros(shape)})
    with pytest.raises(ValueError, match=rf"reference\.{field} must"):
        follow(ARM, PD, reference, [0.0, 0.1, 0.2])


@pytest.mark.parametrize(
    "change, words",
    [
        (dict(log_every=5.0), "log_every"),
        (dict(seed=None), "seed"),
        (dict(controller="PD"), "controller"),
    ],
)
def test_follow_refuses_wrong_kinds(change, words):
    good = dict(controller=PD, reference=Trajectory(*np.zeros((3, 3, 2))), t=[0.0, 0.1, 0.2])
    with pytest.raises(TypeError, match=words):
        follow(ARM, **{**good, **change})


def test_runs_are_indexed_and_sliced():
    recording = record(ARM, proportional((60.0, 30.0)), APPENDIX_I[:3])
    one, two = recording[1], recording[:2]
    assert one.q.shape == recording.q.shape[1:] and two.q.shape == (2, *one.q.shape)
    np.testing.assert_array_equal(two[1].tau, one.tau)
    np.testing.assert_array_equal(one.reference.qdd, recording.reference.qdd[1])
    assert one.motion == recording.motion and one.control_step == recording.control_step
    with pytest.raises(IndexError, match=r"recording must have an axis of runs, got q of shape"):
        one[0]
    with pytest.raises(IndexError):
        recording[3]


def test_a_controller_may_be_a_plain_function():
    kp, kd = np.array([60.0, 30.0]), np.array([9.0, 4.0])

    def spring_and_damper(wanted, q, qd):
        assert wanted.q.shape == q.shape == qd.shape == (2, 2)
        return kp * (wanted.q - q) + kd * (wanted.qd - qd)

    own = record(ARM, spring_and_damper, APPENDIX_I[:2])
    built_in = record(ARM, pd(kp, kd), APPENDIX_I[:2])
    np.testing.assert_allclose(own.tau, built_in.tau, atol=1e-12)
    with pytest.raises(TypeError, match="controller must have a start method or be a function"):
        record(ARM, 3.0, APPENDIX_I[:2])


def test_what_is_simulated_prints_itself():
    made = record(ARM, pd((60.0, 30.0), (9.0, 4.0)), APPENDIX_I[:3], rest=0.1)
    assert repr(made) == "Recording(3 runs x 320 samples x 2 joints, -0.1 to 3.09 s)"
    assert repr(made[0]) == "Recording(320 samples x 2 joints, -0.1 to 3.09 s)"
    assert repr(pd((60.0, 30.0), (9.0, 4.0))) == "PID(kp=(60.0, 30.0), kd=(9.0, 4.0))"
    assert repr(IDEAL) == "Effects(none)"
    assert repr(Effects(actuator=(Saturation((9.0, 4.0)),))) == (
        "Effects(actuator=(Saturation(limit=(9.0, 4.0)),))"
    )
    assert "provenance" not in repr(CMU_DD_ARM_II) and "a=5.291" in repr(CMU_DD_ARM_II)
