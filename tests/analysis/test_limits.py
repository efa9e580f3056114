"""Limits of single arguments as documented: what lies on them is taken, what lies beyond is not.

Every row names an argument, calls with a value of it, values that are accepted (the limits where
they belong to the range) and values just beyond that are refused by name.
"""

import warnings

import numpy as np
import pytest

from ddlib import (
    setups,
    trajectories,  # fmt: skip
)
from ddlib.analysis import (  # fmt: skip
    coverage,
    filters,
    following,
    hidden_units,
    noise,
    sensitivity,
    simplified,
)
from ddlib.control import PID, linear, pd, velocity
from ddlib.dynamics import CMU_DD_ARM_II as ARM, Arm, Link, derivation, serial  # fmt: skip
from ddlib.effects import CMU_DD_ARM_II_EFFECTS, actuators, friction, real_arm  # fmt: skip
from ddlib.identification import equations, regression  # fmt: skip
from ddlib.learning import autograd, descent, levenberg_marquardt, network, training, windows
from ddlib.simulation import loops, simulate  # fmt: skip
from workshop.beyond.control import delays
from workshop.report import exact_states, knobs, parity_networks, two_harmonics

OVER, UNDER = 1 + 1e-9, 1 - 1e-9
JUST_BELOW = -1e-12
RNG = np.random.default_rng(0)
SAMPLES = RNG.uniform(0.1, 0.9, (30, 4))
JOINTS = linear.plant(ARM.mass_matrix([0.0, 0.0]), (0.5, 0.15))
GAIN = np.hstack([np.diag([300.0, 90.0]), np.diag([35.0, 10.0])])
T = np.arange(40) * 0.01
MOTION = trajectories.pick_and_place((20.0, 30.0), T)
FILTERS = RNG.normal(size=(3, 11))
STATES = RNG.uniform(-1, 1, (20, 3, 2))
WEIGHTS = network.Weights.random(1, 5)
NETWORK = WEIGHTS[0]
DATA = training.TrainingSet(
    RNG.uniform(size=(12, 2, 5)), RNG.uniform(0.2, 0.8, (12, 2)),
    windows.Scaler(np.zeros(2), np.ones(2)), windows.Scaler(np.zeros(2), np.ones(2)),
)  # fmt: skip
SINGLE = network.TorqueModel(NETWORK, DATA.inputs, DATA.outputs)
EQUATIONS = regression.from_states(*MOTION, ARM.inverse_dynamics(*MOTION))
COURSE = training.History(np.array([1, 10, 100]), np.array([[1.0], [0.5], [0.4]]), None)


def arm(**changes):
    return Arm(**{"name": "x", "a": 5.0, "b": 0.6, "d": 0.7, "lengths": (0.5, 0.4), **changes})


def train(**options):
    return descent.train_ensemble(WEIGHTS, DATA, progress=False, **{"epochs": 1, **options})


def solve(**options):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", levenberg_marquardt.NotConverged)
        return levenberg_marquardt.solve(WEIGHTS, DATA, progress=False, **{"steps": 1, **options})


def learn(**options):
    small = {"members": 1, "epochs": 1, "every": 1}
    return parity_networks.learn(2, 2, **{**small, **options})


def estimate(level):
    return regression.least_squares(EQUATIONS).half_width(level)


def turned(name):
    middle = {key: knob.value(0.0) for key, knob in knobs.knobs_of("solver").items()}
    return lambda x: knobs.setup({**middle, name: x}, "solver")


ROWS = [
    ("mass", lambda x: Link(x, 0.5, 0.2, 0.1), [0.0, 0.5], [JUST_BELOW]),
    ("length", lambda x: Link(1.0, x, 0.0, 0.1), [0.0, 0.5], [JUST_BELOW]),
    ("inertia", lambda x: Link(1.0, 0.5, 0.2, x), [0.0, 0.5], [JUST_BELOW]),
    ("a", lambda x: arm(a=x), [5.0], []),
    ("b", lambda x: arm(b=x), [-0.6, 0.0], []),
    ("phase", lambda x: actuators.Ripple(phase=x), [-9.0, 0.0, 9.0], []),
    ("seconds", actuators.ComputingTime, [0.0, 1e-4], [JUST_BELOW]),
    ("integral_limit", lambda x: PID((1, 1), integral_limit=x), [0.0, 0.5], [JUST_BELOW]),
    ("radius", lambda x: coverage.cells_reached(SAMPLES, x, 3), [1e-6, 0.5], [0.0]),
    ("cells", lambda x: coverage.cells_reached(SAMPLES, 1.0, x), [1, 2], [0, 1.5]),
    ("width", lambda x: coverage.log10_reachable_share(x, 0.1), [1, 2], [0, 2.0]),
    ("step", lambda x: coverage.log10_reachable_share(5, x), [1e-6, 0.5], [0.0, 0.5 * OVER]),
    ("resolution", lambda x: coverage.used_dimensions(SAMPLES, x), [0.0, 0.5], [JUST_BELOW]),
    ("period", lambda x: delays.late_poles(JOINTS, GAIN, x, 0.0), [1e-3], [0.0]),
    ("late", lambda x: delays.late_poles(JOINTS, GAIN, 2e-3, x), [0.0, 9e-3], [JUST_BELOW]),
    ("gain", lambda x: delays.late_poles(JOINTS, x, 2e-3, 0.0), [GAIN], [GAIN[:, :3]]),
    ("links", derivation.derive, [1], [0, 7, 1.0]),
    ("step", real_arm.Quantisation, [1e-9, 0.5], [0.0]),
    ("periods", real_arm.Delay, [0, 1], [-1, 1.0]),
    ("members", lambda x: setups.train_windows(
        setups.STATE_FEEDBACK, None, 11, x), [], [0, 1.0]),
    ("convention", lambda x: filters.decompose(FILTERS, x), ["paper", "symmetric"], ["odd"]),
    ("name", lambda x: filters.purest(FILTERS, x), ["not analysable"], ["speed"]),
    ("width", filters.basis, [4, 5], [3, 4.0]),
    ("width", lambda x: filters.savitzky_golay(x, 1, 0.1, 2), [3, 5], [1, 2, 4]),
    ("degree", lambda x: filters.savitzky_golay(5, 0, 0.1, x), [0, 4], [-1, 5]),
    ("derivative", lambda x: filters.savitzky_golay(7, x, 0.1, 3), [0, 3], [-1, 4]),
    ("step", lambda x: filters.savitzky_golay(5, 1, x), [1e-6, 0.5], [0.0]),
    ("step", lambda x: filters.frequency_response(FILTERS, [1.0], x), [1e-6, 0.5], [0.0]),
    ("smoothing", lambda x: friction.CoulombFriction((1, 1), x), [1e-6, 0.5], [0.0]),
    ("smoothing", lambda x: friction.StribeckFriction((1, 1), (2, 2), 0.1, x), [1e-6], [0.0]),
    ("speed", lambda x: friction.StribeckFriction((1, 1), (2, 2), x), [1e-6, 0.5], [0.0]),
    ("speed", lambda x: friction.StickSlipFriction((1, 1), (2, 2), x), [1e-6, 0.5], [0.0]),
    ("order", lambda x: two_harmonics.two_harmonics((9, 9), (1, 1), T, x), [2, 5], [1, 2.0]),
    ("level", estimate, [1e-3, 0.95], [0.0, OVER]),
    ("rounds", lambda x: regression.least_squares(EQUATIONS, x), [1, 2], [0, 1.0]),
    ("inertia", lambda x: linear.loop_gain(x, 0.1, 9.0), [1e-3, 0.5], [0.0]),
    ("viscous", lambda x: linear.loop_gain(1.0, x, 9.0), [0.0, 0.5], [JUST_BELOW]),
    ("kp", lambda x: linear.loop_gain(1.0, 0.1, x), [0.0, 0.5], [JUST_BELOW]),
    ("ki", lambda x: linear.loop_gain(1.0, 0.1, 9.0, ki=x), [0.0, 0.5], [JUST_BELOW]),
    ("kd", lambda x: linear.loop_gain(1.0, 0.1, 9.0, kd=x), [0.0, 0.5], [JUST_BELOW]),
    ("joint", lambda x: linear.opened_loop(JOINTS, (9, 9), joint=x), [0, 1], [-1, 2]),
    ("delay", lambda x: linear.closed_loop(JOINTS, (9, 9), period=1e-3, delay=x), [0, 2], [-1]),
    ("period", lambda x: linear.closed_loop(JOINTS, (9, 9), period=x), [1e-3, 0.5], [0.0]),
    ("inertia", lambda x: linear.proportional_limit(x, 0.1, 1e-3), [1e-3, 0.5], [0.0]),
    ("viscous", lambda x: linear.proportional_limit(1.0, x, 1e-3), [1e-3, 0.5], [JUST_BELOW]),
    ("period", lambda x: linear.proportional_limit(1.0, 0.1, x), [1e-3, 0.5], [0.0]),
    ("torque", loops.Load, [(0.0, -1.0)], [(1.0,), (np.inf, 0.0)]),
    ("posture", lambda x: loops.SecondOrderModel(ARM, x), [(0.0, -1.0)], [(1.0,)]),
    ("speed", lambda x: loops.smooth_pick_and_place((9, 9), T, x), [1e-3, 0.5], [0.0]),
    ("repetitions", lambda x: equations.repeat(
        ARM, pd((9, 9), (9, 9)), (9.0, 9.0), CMU_DD_ARM_II_EFFECTS, x), [1], [0, 1.0]),
    ("hidden", lambda x: autograd.WindowNetwork(5, x), [1, 2], [0, 1.0]),
    ("members", lambda x: network.Weights.random(x, 5), [1, 2], [0, 1.0]),
    ("width", lambda x: network.Weights.random(1, x), [1, 2], [0, 1.0]),
    ("hidden", lambda x: network.Weights.random(1, 5, x), [1, 2], [0, 1.0]),
    ("seed", lambda x: network.Weights.random(1, 5, seed=x), [0, 1], [-1, 1.0]),
    ("initial", lambda x: autograd.WindowNetwork(5, initial=x), [1e-6, 0.5], [0.0]),
    ("width", lambda x: noise.acceleration_noise_gain(x, 0.1), [3, 5], [2, 4, 3.0]),
    ("period", lambda x: noise.acceleration_noise_gain(5, x), [1e-6, 0.5], [0.0]),
    ("deviation", lambda x: noise.noise_floor(ARM, x, 5, 16, 0.1, 0.1),
     [(0.5, 0.1)], [(0.5, 0.0), (0.0, 1.0), (1.0,), ((1.0, 1.0),)]),
    ("bits", lambda x: noise.noise_floor(ARM, (1, 1), 5, x, 0.1, 0.1),
     [1, 40], [UNDER, 40 * OVER]),
    ("torque_noise", lambda x: noise.noise_floor(ARM, (1, 1), 5, 9, x, 0.1),
     [0.0, 0.5], [JUST_BELOW]),
    ("bits", parity_networks.patterns, [1, 2], [0, parity_networks.MOST_BITS + 1]),
    ("bits", parity_networks.one_layer, [1, 2], [0, 1.0]),
    ("bits", parity_networks.direct, [1, 2], [0, 1.0]),
    ("bits", parity_networks.counter, [1, 2], [0, 1.0]),
    ("bits", parity_networks.tree, [1, 2], [0, 1.0]),
    ("rate", lambda x: learn(rate=x), [1e-6, 0.5], [0.0]),
    ("momentum", lambda x: learn(momentum=x), [0.0, 0.999], [JUST_BELOW, 0.999 * OVER]),
    ("every", lambda x: learn(every=x, epochs=2), [1, 2], [0, 1.0]),
    ("epochs", lambda x: learn(epochs=x, every=2), [2], [1, 2.0]),
    ("count", lambda x: knobs.spread_evenly(x, 2), [1], [0, 1.0]),
    ("seed", lambda x: knobs.spread_evenly(2, 2, x), [0, 1], [-1, 1.0]),
    *((name, turned(name), [knob.low, knob.high], [knob.high * 1.01 + 0.01])
      for name, knob in knobs.knobs_of("solver").items()),
    ("method", knobs.knobs_of, ["solver"], ["best"]),
    ("seconds", lambda x: knobs.without_start(setups.STATE_FEEDBACK.record(), x), [0.0, 0.3],
     [-0.01]),
    ("step", lambda x: following.gains(FILTERS, x), [1e-6, 0.5], [0.0]),
    ("margin", lambda x: sensitivity.transition_range(WEIGHTS, x),
     [1e-6, 0.49], [0.0, 0.49 * OVER]),
    ("joints", serial.PUMA_560.first, [1, 6], [0, 7, 1.0]),
    ("rotor", lambda x: simplified.share_of_other_joint(ARM, MOTION, [1.0], x),
     [0.0, 0.5], [JUST_BELOW]),
    ("seconds", lambda x: simulate.free_motion(ARM, (0, 0), (0, 0), x, step=x),
     [1e-3, 0.5], [0.0]),
    ("step", lambda x: simulate.free_motion(ARM, (0, 0), (0, 0), 0.1, x),
     [0.01, 0.1], [0.0, 0.1 * OVER]),
    ("log_every", lambda x: simulate.follow(ARM, pd((9, 9), (9, 9)), MOTION, T, log_every=x),
     [1, 2], [0, 1.0]),
    ("velocity", lambda x: simulate.follow(ARM, pd((9, 9), (9, 9)), MOTION, T, velocity=x),
     ["tachometer", "difference"], ["resolver"]),
    ("steps", lambda x: solve(steps=x), [1, 2], [0, 1.0]),
    ("tolerance", lambda x: solve(tolerance=x), [0.0, 0.5, 1.0], [JUST_BELOW, OVER]),
    ("target_rmss", lambda x: solve(target_rmss=x), [0.0, 0.5], [JUST_BELOW]),
    ("decay", lambda x: solve(decay=x), [0.0, 0.5], [JUST_BELOW]),
    ("radius", lambda x: exact_states.random_states(3, 0, x), [1e-6, 0.5], [0.0]),
    ("steepest", COURSE.settled, [0.0, 0.5], [JUST_BELOW]),
    ("rate", lambda x: train(rate=x), [1e-6, training._MAX_RATE], [0.0, training._MAX_RATE * OVER]),
    ("momentum", lambda x: train(momentum=x), [0.0, 0.999], [JUST_BELOW, 0.999 * OVER]),
    ("epochs", lambda x: train(epochs=x), [1, 2], [0, 1.0]),
    ("width", training.default_rate, [1, 2], [0, 1.0]),
    ("warm_up", lambda x: train(warm_up=x), [0, 1], [-1, 1.0]),
    ("n", lambda x: trajectories.random_extents(x, 0), [1, 2], [0, 1.0]),
    ("seed", lambda x: trajectories.random_extents(2, x), [0, 1], [-1, 1.0]),
    ("max_deg", lambda x: trajectories.random_extents(2, 0, x), [1e-6, 0.5], [0.0]),
    ("step", trajectories.time_grid, [0.01, 0.5], [0.0]),
    ("rest", lambda x: trajectories.time_grid(0.01, x), [0.0, 0.5], [JUST_BELOW]),
    ("margin", lambda x: hidden_units.saturated(SAMPLES, x), [0.0, 0.5], [JUST_BELOW, 0.5 * OVER]),
    (
        "margin",
        lambda x: hidden_units.transition_width(SAMPLES, x),
        [1e-6, 0.49],
        [0.0, 0.49 * OVER],
    ),
    ("periods", lambda x: velocity.difference(x, 0.1), [1, 2], [0, 1.0]),
    ("step", lambda x: velocity.difference(1, x), [1e-6, 0.5], [0.0]),
    ("degree", lambda x: velocity.end_slope(5, x, 0.1), [1, 4], [0, 1.0]),
    ("width", lambda x: velocity.end_slope(x, 2, 0.1), [3, 4], [2, 3.0]),
    ("step", lambda x: velocity.end_slope(5, 2, x), [1e-6, 0.5], [0.0]),
    ("width", windows.check_width, [3, 5], [1, 2, 4, 3.0]),
]  # fmt: skip


def identify(rows):
    return [f"{row[0]}-{k}" for k, row in enumerate(rows)]


@pytest.mark.parametrize("name, call, accepted, refused", ROWS, ids=identify(ROWS))
def test_limits(name, call, accepted, refused):
    for value in accepted:
        call(value)
    for value in refused:
        with pytest.raises((ValueError, TypeError), match=name):
            call(value)
    if not isinstance((accepted or refused)[0], str):
        for value in (np.nan, "three", None if name not in ("period", "rate") else np.inf):
            if value is None and name == "target_rmss":
                continue
            with pytest.raises((ValueError, TypeError), match=name):
                call(value)
