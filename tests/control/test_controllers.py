"""Control laws against python-control, difference equations and closed forms."""

import control
import numpy as np
import pytest

from ddlib.control import PID, ComputedTorque, Feedforward, pd
from ddlib.dynamics import CMU_DD_ARM_II, REYES_KELLY_ARM
from ddlib.simulation import follow
from ddlib.trajectories import Trajectory, pick_and_place

STEP = 0.002
KP, KI, KD = (200.0, 80.0), (150.0, 40.0), (30.0, 12.0)


def reference_at(t, extents=(45.0, 20.0)):
    return pick_and_place(extents, t)


def gentle(t):
    """A reference that starts at rest with zero velocity: (1 - cos) with two amplitudes."""
    size, rate = np.array([0.4, -0.3]), 2 * np.pi / 3
    s, c = np.sin(rate * t)[:, None], np.cos(rate * t)[:, None]
    return Trajectory(size * (1 - c), size * rate * s, size * rate**2 * c)


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


def under(law, errors, rates=0.0, step=0.1):
    """Torques of a law whose two joints have these errors and rates of the error, in turn."""
    errors = np.asarray(errors, float)
    law = law.start(Trajectory(*np.zeros((3, errors.size, 2))), step)
    rates = np.broadcast_to(rates, errors.shape)
    return np.array(
        [law(k, *-np.array([[e, e], [r, r]])) for k, (e, r) in enumerate(zip(errors, rates))]
    )


LIMIT = (3.0, 30.0)  # the first joint's motor is weak


def test_without_a_cure_the_integral_winds_up_behind_the_limit():
    """Ten periods of an error of 1 store 10 N m, all of which 20 periods of -1 have to take."""
    law = PID((0.0, 0.0), (10.0, 10.0), limit=LIMIT, anti_windup=None)
    out = under(law, [1.0] * 10 + [-1.0] * 10)
    np.testing.assert_allclose(out[:, 0], np.minimum(out[:, 1], 3.0))
    np.testing.assert_allclose(out[:, 1], [*range(1, 11), *range(9, -1, -1)], atol=1e-12)


def test_conditional_integration_rests_at_the_limit():
    law = PID((0.0, 0.0), (10.0, 10.0), limit=LIMIT)
    out = under(law, [1.0] * 10 + [-1.0] * 8)
    np.testing.assert_allclose(out[:10, 0], [1, 2, *[3] * 8])
    np.testing.assert_allclose(out[10:, 0], [2, 1, 0, -1, -2, -3, -3, -3], atol=1e-12)
    # a spring alone asks for more than all: nothing is stored, and after it nothing pushes
    stiff = PID((100.0, 100.0), (10.0, 10.0), limit=LIMIT)
    assert under(stiff, [1.0] * 10 + [0.0])[-1] == pytest.approx([0.0, 0.0])


@pytest.mark.parametrize("tracking", [0.25, 1.0])
def test_back_calculation_is_its_difference_equation(tracking):
    """The surplus over the limit settles where the error's inflow is what is taken back."""
    law = PID((0.0, 0.0), (10.0, 10.0), limit=LIMIT, anti_windup=tracking)
    out = under(law, np.r_[np.ones(200), -np.ones(60)])
    stored, known = 0.0, []
    for error in [1.0] * 200 + [-1.0] * 60:
        asked = stored + 10 * error * 0.1
        known.append(np.clip(asked, -3, 3))
        stored = asked + (known[-1] - asked) * 0.1 / tracking
    np.testing.assert_allclose(out[:, 0], known, atol=1e-12)
    back = np.argmax(out[200:, 0] < 3.0)  # the surplus is 10 times the tracking time, in N m
    assert back <= np.ceil(10 * tracking)


def test_a_limit_that_is_never_reached_changes_nothing():
    errors = np.random.default_rng(3).normal(size=300)
    for cure in (None, "conditional", 0.2):
        limited = PID(KP, KI, KD, limit=(1e4, 1e4), anti_windup=cure)
        np.testing.assert_array_equal(under(limited, errors), under(PID(KP, KI, KD), errors))


@pytest.mark.parametrize("smoothing", [0.0, 0.05, 0.4])
def test_filtered_derivative_is_python_controls_backward_euler(smoothing):
    """``kd s / (1 + T_f s)`` with ``s = (1 - 1/z) / T``, of an error that is differenced."""
    error = np.cumsum(np.random.default_rng(5).normal(size=200))
    rate = np.diff(error, prepend=0.0) / 0.1
    out = under(PID((0.0, 0.0), kd=(2.0, 6.0), derivative_filter=smoothing), error, rate)
    z = control.tf([1, 0], [1], 0.1)
    s = (1 - 1 / z) / 0.1
    answer = control.forced_response(
        s / (1 + smoothing * s), inputs=error, timepts=0.1 * np.arange(200)
    )
    np.testing.assert_allclose(out, np.outer(answer.outputs, (2.0, 6.0)), atol=1e-9)


@pytest.mark.parametrize(
    "options, wrong",
    [
        ({"limit": (0.0, 1.0)}, "limit must be positive"),
        ({"limit": 3.0}, "limit must have shape"),
        ({"anti_windup": "clamp"}, "anti_windup must be one of"),
        ({"anti_windup": 0.0}, "anti_windup must lie in"),
        ({"derivative_filter": -0.1}, "derivative_filter must lie in"),
    ],
)
def test_wrong_options_are_refused(options, wrong):
    with pytest.raises(ValueError, match=wrong):
        PID(KP, KI, KD, **options)


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
