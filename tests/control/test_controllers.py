"""Control laws against python-control, difference equations and closed forms."""

from dataclasses import FrozenInstanceError

import control
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from ddlib.control import PID, ComputedTorque, Feedforward, pd, proportional
from ddlib.dynamics import CMU_DD_ARM_II, REYES_KELLY_ARM
from ddlib.effects import Effects, ViscousFriction
from ddlib.simulation import follow
from ddlib.trajectories import Trajectory, pick_and_place, time_grid

STEP = 0.002
KP, KI, KD = (200.0, 80.0), (150.0, 40.0), (30.0, 12.0)


def reference_at(t, extents=(45.0, 20.0)):
    return pick_and_place(extents, t)


def gentle(t):
    """A reference that starts at rest with zero velocity: (1 - cos) with two amplitudes."""
    size, rate = np.array([0.4, -0.3]), 2 * np.pi / 3
    s, c = np.sin(rate * t)[:, None], np.cos(rate * t)[:, None]
    return Trajectory(size * (1 - c), size * rate * s, size * rate**2 * c)


# --- the PID law itself -------------------------------------------------------------


@settings(deadline=None, max_examples=40)
@given(
    kp=st.tuples(st.floats(0, 500), st.floats(0, 500)),
    ki=st.tuples(st.floats(0, 500), st.floats(0, 500)),
    kd=st.tuples(st.floats(0, 50), st.floats(0, 50)),
    seed=st.integers(0, 1000),
)
def test_pid_is_its_difference_equation(kp, ki, kd, seed):
    rng = np.random.default_rng(seed)
    reference = Trajectory(*rng.normal(size=(3, 30, 2)))
    q, qd = rng.normal(size=(2, 30, 2))
    law = PID(kp, ki, kd).start(reference, STEP)
    out = np.array([law(k, q[k], qd[k]) for k in range(30)])
    e, rate = reference.q - q, reference.qd - qd
    # u[k] - u[k-1] = kp (e[k] - e[k-1]) + ki T e[k] + kd (rate[k] - rate[k-1])
    start = np.zeros((1, 2))
    change = (
        np.diff(e, axis=0, prepend=start) * kp
        + np.array(ki) * STEP * e
        + np.diff(rate, axis=0, prepend=start) * kd
    )
    np.testing.assert_allclose(out, np.cumsum(change, axis=0), rtol=1e-9, atol=1e-9)


def test_pid_closed_loop_agrees_with_python_control():
    """Two linear joints, zero-order hold: python-control closes the same sampled loop."""
    inertia, damping = (5.0, 0.7), (0.5, 0.15)
    t = np.arange(1000) * STEP
    reference = reference_at(t)
    plants = [
        control.sample_system(
            control.ss([[0, 1], [0, -c / m]], [[0], [1 / m]], np.eye(2), np.zeros((2, 1))),
            STEP,
            "zoh",
        )
        for m, c in zip(inertia, damping)
    ]

    law = PID(KP, KI, KD).start(reference, STEP)
    state, ours = np.zeros((2, 2)), []  # (joint, [q, qd])
    for k in range(t.size):
        tau = law(k, state[:, 0], state[:, 1])
        ours.append((*state[:, 0], *tau))
        state = np.stack([p.A @ x + p.B[:, 0] * u for p, x, u in zip(plants, state, tau)])
    ours = np.array(ours)

    for j, plant in enumerate(plants):
        # kp + ki T z / (z - 1) over one denominator
        pi = control.tf([KP[j] + KI[j] * STEP, -KP[j]], [1, -1], STEP)
        pi = control.ss(control.ss(pi), inputs="e", outputs="slow")
        derivative = control.ss([], [], [], [[KD[j]]], STEP, inputs="edot", outputs="fast")
        arm = control.ss(plant, inputs="tau", outputs=["q", "qd"])
        loop = control.interconnect(
            [
                arm,
                pi,
                derivative,
                control.summing_junction(["r", "-q"], "e", dt=STEP),
                control.summing_junction(["rd", "-qd"], "edot", dt=STEP),
                control.summing_junction(["slow", "fast"], "tau", dt=STEP),
            ],
            inplist=["r", "rd"],
            outlist=["q", "tau"],
        )
        answer = control.forced_response(loop, t, [reference.q[:, j], reference.qd[:, j]])
        np.testing.assert_allclose(ours[:, j], answer.outputs[0], atol=1e-10)
        np.testing.assert_allclose(ours[:, 2 + j], answer.outputs[1], atol=1e-7)
    assert np.abs(ours[:, 2:]).max() > 10.0


def test_proportional_and_pd_are_pid_without_the_rest():
    assert proportional(KP) == PID(KP) and pd(KP, KD) == PID(KP, (0.0, 0.0), KD)
    reference = Trajectory(*np.ones((3, 1, 2)))
    q, qd = np.array([0.5, -1.0]), np.array([3.0, 0.5])
    np.testing.assert_allclose(proportional((10, 20)).start(reference, 1)(0, q, qd), [5, 40])
    np.testing.assert_allclose(pd((10, 20), (1, 2)).start(reference, 1)(0, q, qd), [3, 41])


def test_runs_do_not_share_an_integral():
    controller = PID((0.0, 0.0), ki=(1.0, 1.0))
    reference = Trajectory(*np.ones((3, 10, 2)))
    first, second = controller.start(reference, 0.5), controller.start(reference, 0.5)
    still = np.zeros(2)
    assert [first(k, still, still)[0] for k in range(4)] == [0.5, 1.0, 1.5, 2.0]
    assert second(0, still, still)[0] == 0.5


def test_integral_torque_is_limited_and_unwinds_at_once():
    limit = 3.0
    reference = Trajectory(*np.zeros((3, 200, 2)))
    law = PID((0.0, 0.0), ki=(10.0, 1.0), integral_limit=limit).start(reference, 0.1)
    off, still = np.array([1.0, -1.0]), np.zeros(2)
    out = np.array([law(k, off if k < 100 else -off, still) for k in range(200)])
    np.testing.assert_allclose(out[:5, 0], [-1, -2, -3, -3, -3])
    assert np.abs(out).max() == limit
    np.testing.assert_allclose(out[99], [-limit, limit])
    np.testing.assert_allclose(out[100], [-limit + 1, limit - 0.1])  # no wound-up surplus


def test_each_row_of_gains_is_a_run():
    gains = np.array([[100.0, 50.0], [200.0, 80.0]])
    t = time_grid(0.01, 0.1)[:60]
    for extents in ((45.0, 20.0), [(45.0, 20.0), (10.0, 30.0)]):
        reference = reference_at(t, extents)
        together = follow(CMU_DD_ARM_II, pd(gains, gains / 8), reference, t, log_every=1)
        assert together.q.shape == (2, 60, 2)
        for i, kp in enumerate(gains):
            own = Trajectory(*(x[i] if x.ndim == 3 else x for x in reference))
            alone = follow(CMU_DD_ARM_II, pd(kp, kp / 8), own, t, log_every=1)
            np.testing.assert_allclose(together.q[i], alone.q, atol=1e-13)
            np.testing.assert_allclose(together.tau[i], alone.tau, atol=1e-11)


# --- closed loops around the arm ------------------------------------------------------


@pytest.mark.parametrize("arm", [CMU_DD_ARM_II, REYES_KELLY_ARM], ids=lambda a: a.name)
def test_sampled_loop_agrees_with_scipy(arm):
    """An adaptive high-order integrator between the samples, and the law written out again."""
    friction = np.array([0.5, 0.15])
    t = time_grid(STEP, 0.1)[:350]
    reference = reference_at(t)
    recording = follow(
        arm,
        PID(KP, KI, KD),
        reference,
        t,
        effects=Effects(friction=(ViscousFriction(tuple(friction)),)),
        log_every=1,
    )
    y, integral = np.zeros(4), np.zeros(2)
    for k in range(t.size):
        np.testing.assert_allclose(recording.q_true[k], y[:2], atol=1e-8)
        np.testing.assert_allclose(recording.qd_true[k], y[2:], atol=1e-7)
        error = reference.q[k] - y[:2]
        integral = integral + np.array(KI) * error * STEP
        tau = np.array(KP) * error + integral + np.array(KD) * (reference.qd[k] - y[2:])
        np.testing.assert_allclose(recording.tau_true[k], tau, atol=1e-5)

        def rate(_, y, tau=tau):
            net = tau - friction * y[2:] - arm.coriolis_matrix(y[:2], y[2:]) @ y[2:]
            return [*y[2:], *np.linalg.solve(arm.mass_matrix(y[:2]), net - arm.gravity(y[:2]))]

        y = solve_ivp(rate, (0, STEP), y, "DOP853", rtol=1e-10, atol=1e-12).y[:, -1]
    assert np.abs(y[:2]).min() > 0.1  # it has moved


def test_fast_sampling_approaches_python_controls_continuous_loop():
    """The sampled PD loop converges to the continuous one, at first order in the period."""
    arm, end = CMU_DD_ARM_II, 0.4

    def update(_t, x, u, _params):
        tau = KP * (u[:2] - x[:2]) + KD * (u[2:] - x[2:])
        net = tau - arm.coriolis_matrix(x[:2], x[2:]) @ x[2:]
        return np.concatenate([x[2:], np.linalg.solve(arm.mass_matrix(x[:2]), net)])

    plant = control.NonlinearIOSystem(update, inputs=4, outputs=4, states=4)
    t = np.arange(1601) * end / 1600
    reference = gentle(t)
    answer = control.input_output_response(
        plant,
        t,
        np.hstack([reference.q, reference.qd]).T,
        np.zeros(4),
        solve_ivp_method="DOP853",
        solve_ivp_kwargs=dict(rtol=1e-8, atol=1e-10, max_step=5e-3),
    )
    final = answer.states[:2, -1]
    gaps = []
    for every in (8, 4, 2):
        coarse = Trajectory(*(x[::every] for x in reference))
        recording = follow(arm, pd(KP, KD), coarse, t[::every], log_every=1)
        gaps.append(recording.q_true[-1] - final)
    gaps = np.array(gaps)
    assert np.abs(gaps[0]).max() < 5e-3
    np.testing.assert_allclose(gaps[0] / gaps[1], 2, atol=0.15)
    np.testing.assert_allclose(gaps[1] / gaps[2], 2, atol=0.15)
    np.testing.assert_allclose(2 * gaps[2] - gaps[1], 0, atol=2e-5)  # extrapolated to zero period


@pytest.mark.parametrize("arm", [CMU_DD_ARM_II, REYES_KELLY_ARM], ids=lambda a: a.name)
def test_exact_feedforward_tracks(arm):
    """What is left is the hold between two samples: it shrinks with the period."""

    def worst(controller, step):
        t = np.arange(round(1.5 / step)) * step
        recording = follow(arm, controller, gentle(t), t, log_every=1)
        return np.abs(recording.tracking_error).max()

    feedback = pd(KP, KD)
    coarse, fine = (worst(Feedforward(arm, feedback), step) for step in (0.004, 0.002))
    assert fine < 3e-4
    assert fine < worst(feedback, 0.002) / 50
    assert coarse / fine == pytest.approx(2, abs=0.1)


def test_feedforward_adds_the_model_to_the_feedback():
    t = time_grid(0.01)[:20]
    reference = reference_at(t)
    q, qd = np.random.default_rng(0).normal(size=(2, 20, 2))
    arm, feedback = CMU_DD_ARM_II, PID(KP, KI, KD)
    calls = []

    def model(*states):
        calls.append(states)
        return arm.inverse_dynamics(*states)

    laws = [c.start(reference, 0.01) for c in (Feedforward(model, feedback), feedback)]
    wanted = arm.inverse_dynamics(*reference)
    for k in range(20):
        with_model, without = (law(k, q[k], qd[k]) for law in laws)
        np.testing.assert_allclose(with_model - without, wanted[k], atol=1e-12)
    assert len(calls) == 1  # off line: once per run, for the whole reference
    same = Feedforward(arm, feedback).start(reference, 0.01)(0, q[0], qd[0])
    np.testing.assert_allclose(same - feedback.start(reference, 0.01)(0, q[0], qd[0]), wanted[0])


@pytest.mark.parametrize(
    "output", [np.zeros(2), np.zeros((7, 2)), np.zeros((20, 3)), np.full((20, 2), np.nan)]
)
def test_feedforward_refuses_a_model_that_does_not_fit(output):
    reference = reference_at(time_grid(0.01)[:20])
    with pytest.raises(ValueError, match=r"model\(q, qd, qdd\)"):
        Feedforward(lambda q, qd, qdd: output, proportional(KP)).start(reference, 0.01)


@pytest.mark.parametrize("arm", [CMU_DD_ARM_II, REYES_KELLY_ARM], ids=lambda a: a.name)
def test_computed_torque_makes_the_error_linear(arm):
    """e'' + kd e' + kp e = 0 for each joint alone, from the velocity step at the start."""
    kp, kd = 100.0, 12.0
    omega, decay = np.sqrt(kp - (kd / 2) ** 2), kd / 2
    errors = {}
    for step in (1e-3, 5e-4):
        t = np.arange(round(0.8 / step)) * step
        reference = reference_at(t)
        controller = ComputedTorque(arm, (kp, kp), (kd, kd))
        recording = follow(arm, controller, reference, t, log_every=round(1e-3 / step))
        errors[step] = recording.tracking_error
    t = np.arange(800) * 1e-3
    # the arm starts at rest: e(0) = 0 and e'(0) is the velocity of the reference
    start = -np.deg2rad([45.0, 20.0]) * np.pi / 3
    closed = start * (np.exp(-decay * t) * np.sin(omega * t) / omega)[:, None]
    gaps = [np.abs(errors[step] - closed).max(0) for step in (1e-3, 5e-4)]
    assert (gaps[1] < 0.01 * np.abs(closed).max(0)).all()
    np.testing.assert_allclose(gaps[0] / gaps[1], 2, atol=0.1)
    extrapolated = 2 * errors[5e-4] - errors[1e-3]
    np.testing.assert_allclose(extrapolated, closed, atol=2e-5 * np.abs(start).max())


def test_computed_torque_is_the_arm_at_the_measured_state():
    reference = Trajectory(*np.random.default_rng(1).normal(size=(3, 1, 2)))
    q, qd = np.array([0.3, -0.8]), np.array([1.0, 2.0])
    arm, kp, kd = REYES_KELLY_ARM, np.array([100.0, 50.0]), np.array([20.0, 10.0])
    law = ComputedTorque(arm, tuple(kp), tuple(kd)).start(reference, STEP)
    wanted = reference.qdd[0] + kd * (reference.qd[0] - qd) + kp * (reference.q[0] - q)
    tau = arm.mass_matrix(q) @ wanted + arm.coriolis_matrix(q, qd) @ qd + arm.gravity(q)
    np.testing.assert_allclose(law(0, q, qd), tau, rtol=1e-12)


# --- refusals -----------------------------------------------------------------------

BAD_GAINS = [(-1.0, 1.0), (1.0, -1e-9), (1.0,), (1.0, 2.0, 3.0), 5.0, (np.nan, 1.0), (np.inf, 1.0)]
MAKERS = {
    "PID kp": (lambda g: PID(g), "kp"),
    "PID ki": (lambda g: PID(KP, ki=g), "ki"),
    "PID kd": (lambda g: PID(KP, kd=g), "kd"),
    "proportional": (proportional, "kp"),
    "pd kp": (lambda g: pd(g, KD), "kp"),
    "pd kd": (lambda g: pd(KP, g), "kd"),
    "computed torque kp": (lambda g: ComputedTorque(CMU_DD_ARM_II, g, KD), "kp"),
    "computed torque kd": (lambda g: ComputedTorque(CMU_DD_ARM_II, KP, g), "kd"),
}


@pytest.mark.parametrize("make, name", MAKERS.values(), ids=MAKERS)
@pytest.mark.parametrize("gains", BAD_GAINS, ids=str)
def test_bad_gains_are_refused_by_name(make, name, gains):
    with pytest.raises(ValueError, match=rf"^{name} must"):
        make(gains)
    make((1.0, 0.0))  # zero is a gain


@pytest.mark.parametrize("gains", ["high", None, ("1", "2")])
def test_gains_must_be_numbers(gains):
    with pytest.raises(TypeError, match="kp"):
        PID(gains)


@pytest.mark.parametrize("limit", [-1.0, np.nan, np.inf])
def test_bad_integral_limits_are_refused(limit):
    with pytest.raises(ValueError, match="integral_limit"):
        PID(KP, integral_limit=limit)


def test_controllers_cannot_be_changed():
    for controller in (PID(KP), Feedforward(CMU_DD_ARM_II, PID(KP))):
        with pytest.raises(FrozenInstanceError):
            controller.kp = (0.0, 0.0)
    with pytest.raises(FrozenInstanceError):
        ComputedTorque(CMU_DD_ARM_II, KP, KD).kp = (0.0, 0.0)
