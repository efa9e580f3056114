"""Loops around the arm: prediction against simulation, Figure 2-1 as a program, scores."""

import numpy as np
import pytest

from ddlib.control import PID, Feedforward, pd
from ddlib.dynamics import CMU_DD_ARM_II, REYES_KELLY_ARM, SecondOrderModel
from ddlib.effects import Effects, ViscousFriction
from ddlib.setups import KD, KP
from ddlib.simulation import (
    Recording,
    feedforward_system,
    follow,
    predicted_response,
    record,
    run_system,
    score,
    simulated_response,
)
from ddlib.trajectories import (
    APPENDIX_I,
    Trajectory,
    pick_and_place,
    smooth_pick_and_place,
    time_grid,
)

ARM, VISCOUS = CMU_DD_ARM_II, (0.5, 0.15)
PD, KI = pd(KP, KD), (150.0, 45.0)


@pytest.mark.parametrize("joint, posture", [(0, (0.3, -1.0)), (1, (0.0, 0.0))])
@pytest.mark.parametrize("law", [PD, PID(KP, KI, KD)], ids=["PD", "PID"])
def test_prediction_and_simulation_agree_for_small_motions(law, posture, joint):
    options = {"viscous": VISCOUS, "posture": posture, "joint": joint}
    predicted = predicted_response(ARM, law, **options)
    simulated = simulated_response(ARM, law, **options)
    assert simulated.overshoot == pytest.approx(predicted.overshoot, rel=0.05)
    assert simulated.bandwidth == pytest.approx(predicted.bandwidth, rel=0.05)
    # a steady error relative to that of the spring alone: an integral leaves none
    spring = 1 / KP[joint]
    assert simulated.compliance / spring == pytest.approx(predicted.compliance / spring, abs=0.05)
    assert predicted.compliance == pytest.approx(0 if law.ki[joint] else spring, abs=1e-9)


@pytest.mark.parametrize("joint, posture", [(1, (0.7, -1.0)), (0, (np.pi, 0.0))])
def test_prediction_and_simulation_agree_for_an_arm_with_gravity(posture, joint):
    """Bent, and upside down, where gravity is a negative spring."""
    arm = REYES_KELLY_ARM
    law, options = pd((120.0, 20.0), (12.0, 1.5)), {"viscous": (2.0, 0.3), "posture": posture}
    predicted = predicted_response(arm, law, joint=joint, **options)
    simulated = simulated_response(arm, law, joint=joint, step_deg=0.1, **options)
    assert simulated.overshoot == pytest.approx(predicted.overshoot, rel=0.02, abs=2e-3)
    assert simulated.bandwidth == pytest.approx(predicted.bandwidth, rel=0.02)
    assert simulated.compliance == pytest.approx(predicted.compliance, rel=0.01)
    # stiffness from differences of the weight's torque; at rest it adds to the controller's
    h = 1e-5 * np.eye(2)
    pull = (arm.gravity(posture + h) - arm.gravity(posture - h)) / 2e-5
    whole = np.linalg.inv(np.diag(law.kp) + pull)
    assert predicted.compliance == pytest.approx(whole[joint, joint], rel=1e-6)
    assert abs(predicted.compliance * law.kp[joint] - 1) > 0.02  # gravity does matter


def test_second_order_model_is_the_arm_at_its_posture_and_decouples_the_elbow():
    qdd, posture = np.random.default_rng(0).normal(size=(5, 2)), (0.4, -1.1)
    model, q = SecondOrderModel(ARM, posture, VISCOUS), np.zeros((5, 2)) + posture
    np.testing.assert_allclose(model(q, 0 * qdd, qdd), ARM.inverse_dynamics(q, 0 * qdd, qdd))
    np.testing.assert_allclose(model(q, qdd, 0 * qdd), qdd * VISCOUS)
    # trajectory 4 moves the shoulder alone; the elbow's reference rests
    error = [
        np.abs(record(ARM, law, APPENDIX_I[3]).tracking_error[150:300, 1]).max()
        for law in (PD, Feedforward(SecondOrderModel(ARM), PD))
    ]
    assert error[1] < 0.5 * error[0]


@pytest.mark.parametrize("model", [ARM, SecondOrderModel(ARM)], ids=["full", "second order"])
def test_interconnected_system_is_the_simulators_loop(model):
    """The same motion twice: continuous by python-control, sampled by `follow`; and the gap
    between them is the hold's, so it shrinks with the control period."""
    system = feedforward_system(ARM, model, KP, KD, VISCOUS)
    t = np.arange(150) * 0.01
    extents = APPENDIX_I[1]
    drawn = run_system(system, pick_and_place(extents, t), t)
    gaps = []
    for period in (0.002, 0.001):
        fine = np.arange(round(1.5 / period)) * period
        built = follow(
            ARM, Feedforward(model, PD), pick_and_place(extents, fine), fine,
            effects=Effects(friction=(ViscousFriction(VISCOUS),)),
            log_every=round(0.01 / period),
        )  # fmt: skip
        gaps.append(np.abs(np.rad2deg(drawn.q - built.q_true)).max())
        assert np.abs(drawn.tau - built.tau_true).max() < 0.05 * np.abs(built.tau_true).max()
    assert gaps[0] < 0.05 and gaps[1] < 0.7 * gaps[0]


def test_scores_of_a_made_up_recording():
    """A constant error of 1 degree at the elbow, 3 degrees in the first third; encoders are off."""
    t = time_grid(0.01, 0.5)
    reference = Trajectory(*np.zeros((3, t.size, 2)))
    q = np.zeros((2, t.size, 2))
    q[:, :, 1] = np.deg2rad(np.where((t >= 0) & (t < 1), 3.0, 1.0))
    q[:, t < 0] = 7.0  # outside the motion nothing counts
    tau = np.broadcast_to([3.0, 4.0], q.shape)
    result = score(ARM, Recording(t, reference, q + 0.1, tau, q, 0 * q, tau, duration=3.0))
    np.testing.assert_allclose(result.largest, 3)
    np.testing.assert_allclose(result.settled, np.sqrt(0.5))
    np.testing.assert_allclose(result.whole, np.sqrt((9 + 1 + 1) / 6))
    chord = 2e3 * ARM.lengths[1] * np.sin(np.deg2rad(0.5))
    np.testing.assert_allclose(result.hand, chord)
    np.testing.assert_allclose(result.turn, chord)
    np.testing.assert_allclose(result.effort, 5)
    assert result.turn.shape == (2,)


def test_the_smooth_motion_goes_out_and_back_without_a_jump():
    speed = 2.5
    t = np.linspace(-0.2, 3.2, 34_001)
    motion = smooth_pick_and_place(APPENDIX_I, t, speed)
    assert motion.q.shape == (6, t.size, 2)
    half = np.argmin(np.abs(speed * t - 1.5))
    np.testing.assert_allclose(np.rad2deg(motion.q[:, half]), -APPENDIX_I, atol=1e-6)
    assert not motion.q[:, [0, -1]].any()
    for lower, upper in ((motion.q, motion.qd), (motion.qd, motion.qdd)):
        slope = np.gradient(lower, t, axis=-2)
        inside = np.abs(t * speed - 1.5) < 1.49
        np.testing.assert_allclose(slope[:, inside], upper[:, inside], atol=2e-3 * speed**2)
    steps = np.abs(np.diff(motion.qd, axis=-2)).max()
    assert steps < 2 * np.abs(motion.qdd).max() * (t[1] - t[0])  # continuous at both ends
