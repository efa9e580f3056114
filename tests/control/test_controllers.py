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
