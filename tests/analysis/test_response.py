"""Responses and gains against signals and networks whose answer is known."""

import numpy as np
import pytest

from ddlib.analysis import calibrated, savitzky_golay, unit_inputs, unit_responses
from ddlib.learning import Scaler, TorqueModel, Weights
from ddlib.simulation import LOG_STEP

RNG = np.random.default_rng(0)


def test_shares_of_independent_quantities_add_up():
    """With signals at right angles, R² of each is its squared part, alone and unique alike."""
    q = np.linalg.qr(np.column_stack([np.ones(400), RNG.normal(size=(400, 9))]))[0][:, 1:]
    states, noise = q[:, :8].reshape(400, 2, 4), q[:, 8]
    parts = np.array([[0.1, 0.3, 0.5, 0.2], [0.2, 0.1, 0.4, 0.6]])
    y = (states * parts).sum((1, 2)) + 0.3 * noise
    found = unit_responses(np.stack([y, 5 + 2 * y, states[:, 1, 1]], -1)[None], states)
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
    found = unit_responses(states[:, :1, 0], states)
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
    found = calibrated(model, windows, LOG_STEP)
    assert np.allclose(found.direct, wanted, rtol=1e-6, atol=1e-9)
    assert np.allclose(found.whole, wanted, rtol=1e-6, atol=1e-9)


def test_unit_inputs_are_the_nets_of_the_activities():
    model, windows = _network(), RNG.normal(size=(6, 2, 7))
    w = model.weights
    w.output_weights[:] = 0
    logits = [np.log(y / (1 - y)) for y in w.activity(model.scaled(windows))]
    nets = unit_inputs(model, windows)
    np.testing.assert_allclose(nets["hidden"], logits[0])
    np.testing.assert_allclose(nets["direct"] + w.output_bias, logits[1])
