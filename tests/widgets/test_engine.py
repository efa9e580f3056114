"""The live engine in a browser against ddlib: motions, torques, networks, descent."""

from __future__ import annotations

import numpy as np
import pytest
from widget_pages import functions

from ddlib.control import PID, Feedforward, pd
from ddlib.dynamics import CMU_DD_ARM_II, IMI_ARM, REYES_KELLY_ARM
from ddlib.effects import (
    IDEAL,
    CoulombFriction,
    Effects,
    Quantisation,
    Saturation,
    StribeckFriction,
    ViscousFriction,
)
from ddlib.learning import sliding_windows
from ddlib.setups import JOINT_DAMPING, SETUPS, STATE_FEEDBACK, split
from ddlib.simulation import follow
from ddlib.trajectories import pick_and_place, time_grid
from ddlib.widgets.engine import _plain as plain
from workshop.report import results

STEP = 0.002
BOOK_ARMS = pytest.mark.parametrize(
    "arm", [CMU_DD_ARM_II, IMI_ARM, REYES_KELLY_ARM], ids=lambda arm: arm.name
)


@pytest.fixture(scope="module")
def engine(browser):
    with functions(browser) as call:
        yield call


# Equations


@pytest.mark.browser
@BOOK_ARMS
def test_equations_of_the_arm(engine, arm):
    rng = np.random.default_rng(0)
    q, qd, last = rng.uniform(-3, 3, (200, 2)), *rng.normal(0, 4, (2, 200, 2))
    given = [plain.plant(arm, IDEAL)["arm"], np.hstack([q, qd, last]).tolist()]
    torque = engine("([arm, all]) => all.map((x) => armTorque(arm, ...x))", given)
    np.testing.assert_allclose(torque, arm.inverse_dynamics(q, qd, last), atol=1e-9)
    answer = engine("([arm, all]) => all.map((x) => armAcceleration(arm, ...x))", given)
    np.testing.assert_allclose(answer, arm.forward_dynamics(q, qd, last), atol=1e-9)
    mass = engine("([arm, all]) => all.map((x) => armMass(arm, x[1]))", given)
    wanted = arm.mass_matrix(q).reshape(-1, 4)[:, [0, 1, 3]]
    np.testing.assert_allclose(mass, wanted, atol=1e-12)

    given = [list(arm.lengths), q.tolist()]
    places = engine("([lengths, q]) => q.map((q) => placesOf(lengths, q))", given)
    np.testing.assert_allclose(places, arm.forward_kinematics(q), atol=1e-12)
    force, small = np.array([3.0, -2.0]), 1e-6
    got = engine("([lengths, q]) => q.map((q) => torqueOfForce(lengths, q, [3, -2]))", given)
    for j in range(2):  # virtual work
        turned = q + small * np.eye(2)[j], q - small * np.eye(2)[j]
        moved = np.subtract(*(arm.forward_kinematics(x)[:, 1] for x in turned)) / (2 * small)
        np.testing.assert_allclose(np.array(got)[:, j], moved @ force, atol=1e-8)


# Motions

FOLLOW = """([plant, gains, model, reference, step, every, velocity]) => {
  const law = model ? feedforward(model, pid(gains, step)) : pid(gains, step);
  return follow(plant, law, reference, step, every, velocity);
}"""


def assert_same_motion(engine, arm, effects, controller, extents_deg, velocity="tachometer"):
    """The engine's log of a motion of the paper's family is that of ddlib."""
    t = time_grid(STEP, 0.2)
    reference = pick_and_place(extents_deg, t)
    model, feedback = None, controller
    if isinstance(controller, Feedforward):
        model, feedback = plain.plant(controller.model, IDEAL)["arm"], controller.feedback
    wanted = {name: x.tolist() for name, x in reference._asdict().items()}
    given = [plain.plant(arm, effects), plain.gains(feedback), model, wanted, STEP, 5, velocity]
    log = {name: np.array(x) for name, x in engine(FOLLOW, given).items()}
    silent = effects.without("torque_sensor")
    recording = follow(
        arm, controller, reference, t, log_every=5, effects=silent, velocity=velocity
    )
    assert recording.t[-1] - recording.t[0] > 3 and np.ptp(recording.q_true) > 0.1
    np.testing.assert_allclose(log["q"], recording.q_true, atol=1e-6)
    np.testing.assert_allclose(log["v"], recording.qd_true, atol=1e-5)
    np.testing.assert_allclose(log["tau"], recording.tau_true, atol=1e-4)
    np.testing.assert_allclose(log["reading"], recording.q, atol=1e-6)


@pytest.mark.browser
@pytest.mark.parametrize("name", SETUPS)
def test_three_seconds_of_each_set_up(engine, name):
    """With friction, encoder and saturation, as Table 4-1's recordings are made."""
    setup = SETUPS[name]
    assert_same_motion(engine, setup.arm, setup.effects, setup.controller, (45.0, 30.0))


@pytest.mark.browser
@BOOK_ARMS
@pytest.mark.parametrize("velocity", ["tachometer", "difference"])
def test_controllers_on_each_arm(engine, arm, velocity):
    effects = Effects(
        friction=(CoulombFriction((1.0, 0.4), 5e-3), ViscousFriction((2.0, 0.6))),
        actuator=(Saturation((25.0, 6.0)),),
        encoder=(Quantisation.encoder(14),),
    )
    laws = [
        PID((250.0, 70.0), (150.0, 40.0), (20.0, 6.0), derivative_filter=0.01),
        PID((250.0, 70.0), (150.0, 40.0), (20.0, 6.0), (20.0, 4.0)),
        PID((250.0, 70.0), (150.0, 40.0), (20.0, 6.0), (20.0, 4.0), anti_windup=0.1),
        Feedforward(arm, pd((150.0, 40.0), (20.0, 5.0))),
    ]
    for law in laws:
        assert_same_motion(engine, arm, effects, law, (20.0, 40.0), velocity)


# Networks

ACTIVITY = """([spec, weights, windows]) => {
  const model = { ...spec, net: networkOf(spec.layout, weights) };
  return windows.map((window) => {
    const { hidden, output } = activity(model.net, scaledWindow(model, window));
    return [[...hidden], [...output], torqueOfOutput(model, output)];
  });
}"""


@pytest.mark.browser
@pytest.mark.parametrize("setup", [STATE_FEEDBACK, JOINT_DAMPING], ids=lambda setup: setup.name)
def test_activities_and_torques_of_committed_networks(engine, setup):
    test = split(setup.record())[1]
    windows = sliding_windows(test.q, 21, test.motion)
    for model in (results.networks(21, setup.name)[k] for k in (0, 24)):
        weights = np.frombuffer(plain.weight_bytes(model), "<f4").tolist()
        given = [plain.network(model), weights, windows.reshape(len(windows), -1).tolist()]
        hidden, output, torque = (np.array(x) for x in zip(*engine(ACTIVITY, given)))
        np.testing.assert_allclose(torque, model.torque(windows), rtol=0, atol=1e-9)
        wanted = model.weights.activity(model.scaled(windows))
        np.testing.assert_allclose(hidden, wanted[0], rtol=0, atol=1e-9)
        np.testing.assert_allclose(output, wanted[1], rtol=0, atol=1e-9)


def test_an_effect_that_the_engine_does_not_have_is_refused():
    """A page that left it out would show another arm than its Python does."""
    effects = Effects(friction=(StribeckFriction((1, 1), (2, 2)),))
    with pytest.raises(TypeError, match="friction must hold"):
        plain.plant(CMU_DD_ARM_II, effects)
