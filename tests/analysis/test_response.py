"""Responses, gains and probes against signals and networks whose answer is known."""

import numpy as np
import pytest
from scipy.stats import ortho_group

from ddlib.analysis import (
    calibrated,
    decoded,
    decoded_sign,
    heard,
    savitzky_golay,
    unit_inputs,
    with_jerk,
)
from ddlib.learning import Scaler, TorqueModel, Weights
from ddlib.simulation import LOG_STEP

RNG = np.random.default_rng(0)


def test_jerk_is_the_slope_of_the_acceleration():
    t = np.arange(200) * LOG_STEP
    states = np.stack([t**3 / 6 * k for k in (1.0, 0, 0)], -1)[:, None].repeat(2, 1)
    states[..., 2] = np.stack([np.sin(3 * t), t**2], -1)
    jerk = with_jerk(states)[1:-1, :, 3]
    assert np.allclose(jerk[:, 0], 3 * np.cos(3 * t[1:-1]), atol=1e-3)
    assert np.allclose(jerk[:, 1], 2 * t[1:-1], atol=1e-9)
    assert np.array_equal(with_jerk(states)[..., :3], states)


def test_shares_of_independent_quantities_add_up():
    """With signals at right angles, R² of each is its squared part, alone and unique alike."""
    q = np.linalg.qr(np.column_stack([np.ones(400), RNG.normal(size=(400, 9))]))[0][:, 1:]
    states, noise = q[:, :8].reshape(400, 2, 4), q[:, 8]
    parts = np.array([[0.1, 0.3, 0.5, 0.2], [0.2, 0.1, 0.4, 0.6]])
    y = (states * parts).sum((1, 2)) + 0.3 * noise
    found = heard(np.stack([y, 5 + 2 * y, states[:, 1, 1]], -1)[None], states)
    power = (parts**2).sum() + 0.09
    assert found.alone.shape == (1, 3, 4) and found.together.shape == (1, 3)
    for unit in (0, 1):
        assert np.allclose(found.alone[0, unit], (parts**2).sum(0) / power)
        assert np.allclose(found.unique[0, unit], (parts**2).sum(0) / power)
        assert found.together[0, unit] == pytest.approx((parts**2).sum() / power)
    assert np.allclose(found.alone[0, 2], [0, 1, 0, 0])
    assert list(found.strongest[0]) == [2, 2, 1]


def test_what_two_quantities_share_is_nobodys_own():
    """Position and acceleration proportional: each explains all, neither anything of its own."""
    states = RNG.normal(size=(300, 2, 4))
    states[..., 2] = -4 * states[..., 0] + 1e-3 * RNG.normal(size=(300, 2))
    found = heard(states[:, :1, 0], states)
    assert found.alone[0, [0, 2]] == pytest.approx(1, abs=1e-4)
    assert found.unique[0].max() < 1e-4


def _network(width=7):
    weights = Weights.random(1, width, seed=3)[0]
    inputs = Scaler(np.array([-1.0, -2.0]), np.array([1.0, 0.5]), (-1.0, 1.0))
    return TorqueModel(
        weights, inputs, Scaler(np.array([-20.0, -5]), np.array([30.0, 9]), (0.2, 0.8))
    )


def test_gains_of_a_linear_network_are_the_planted_inertia_and_friction():
    """Direct weights made of an inertia, a damping and a stiffness; hidden units that are off."""
    inertia = np.array([[2.3, 0.4], [0.4, 0.35]])
    damping = np.array([[4.0, 0.0], [0.0, 1.2]])
    stiffness = np.array([[0.7, -0.1], [0.2, 0.0]])
    templates = [savitzky_golay(21, k, LOG_STEP, degree=2) for k in (0, 1, 2)]
    wanted = np.stack([stiffness, damping, inertia], -1)
    filters = np.einsum("ojk,kw->ojw", wanted, templates)  # N m/rad
    model = _network(21)
    small = 1e-6  # where the sigmoid outputs are straight
    weights = model.weights
    weights.output_weights[:] = 0
    weights.output_bias[:] = 0
    gain = model.inputs.gain[:, None] / model.outputs.gain[:, None, None]
    weights.direct_weights[:] = 4 * filters / gain  # the slope of a sigmoid at 0 is a quarter
    centre = model.inputs.unscale(np.zeros((1, 2, 1)), -2)
    windows = centre + small * RNG.normal(size=(50, 2, 21))
    found = calibrated(model, windows)
    assert np.allclose(found.direct, wanted, rtol=1e-6, atol=1e-9)
    assert np.allclose(found.whole, wanted, rtol=1e-6, atol=1e-9)


def test_probes_read_what_is_there_and_only_on_held_out_cases():
    mix = ortho_group.rvs(6, random_state=1)
    x, new = RNG.normal(size=(200, 6)), RNG.normal(size=(100, 6))
    read = decoded(x @ mix, x[:, :2], new @ mix, new[:, :2])
    assert read == pytest.approx([1, 1], abs=1e-8)
    halves = x[:, :1] + RNG.normal(size=(200, 1)), new[:, :1] + RNG.normal(size=(100, 1))
    assert decoded(x, halves[0], new, halves[1])[0] == pytest.approx(0.5, abs=0.15)
    nothing = decoded(x, RNG.normal(size=(200, 1)), new, RNG.normal(size=(100, 1)))
    assert -0.3 < nothing[0] < 0.05


def test_signs_are_judged_by_both_classes_alike():
    x, new = RNG.normal(size=(300, 3)), RNG.normal(size=(200, 3))
    assert decoded_sign(x, x[:, :1], new, new[:, :1])[0] > 0.9
    coin = decoded_sign(x, RNG.normal(size=(300, 1)), new, RNG.normal(size=(200, 1)))[0]
    assert 0.35 < coin < 0.65
    rare = np.where(np.arange(200) < 10, 1.0, -1.0)[:, None]  # always "no" would be right in 95 %
    assert decoded_sign(0 * x + 1.0, x[:, :1], 0 * new + 1.0, rare)[0] == pytest.approx(0.5)


def test_unit_inputs_are_the_nets_of_the_activities():
    model, windows = _network(), RNG.normal(size=(6, 2, 7))
    w = model.weights
    w.output_weights[:] = 0
    logits = [np.log(y / (1 - y)) for y in w.activity(model.scaled(windows))]
    nets = unit_inputs(model, windows)
    np.testing.assert_allclose(nets["hidden"], logits[0])
    np.testing.assert_allclose(nets["direct"] + w.output_bias, logits[1])
