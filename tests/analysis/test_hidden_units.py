"""Hidden units at work: saturation, transition regions, ablation, matching."""

import numpy as np
import pytest

from ddlib.analysis import ablation, matched_units, refitted, saturated
from ddlib.learning import TorqueModel, TrainingSet, Weights
from ddlib.metrics import rmss

RNG = np.random.default_rng(5)


@pytest.fixture(scope="module")
def cases():
    windows = RNG.normal(size=(120, 2, 5))
    return windows, RNG.normal(size=(120, 2))


@pytest.fixture(scope="module")
def model(cases):
    data = TrainingSet.from_arrays(*cases)
    return TorqueModel(Weights.random(3, 5, 6, initial=2.0), data.inputs, data.outputs)


def test_saturated_counts_both_ends():
    activity = np.array([[0.05, 0.5], [0.95, 0.5], [0.5, 0.95], [0.2, 0.85]])
    np.testing.assert_allclose(saturated(activity), [0.5, 0.25])


def test_a_unit_held_at_its_mean_is_a_bias(model, cases):
    """Rebuilt with the unit's weight taken out and its mean put into the output bias."""
    one, (windows, torque) = model[0], cases
    units, errors = ablation(one, windows, torque)
    assert units == list(range(6))
    hidden, _ = one.weights.activity(one.scaled(windows))
    for k, error in zip(units, errors, strict=True):
        w = one.weights
        out = w.output_weights.copy()
        out[:, k] = 0
        bias = w.output_bias + w.output_weights[:, k] * hidden[:, k].mean()
        rebuilt = Weights(w.hidden_weights, w.hidden_bias, out, w.direct_weights, bias)
        own = TorqueModel(rebuilt, one.inputs, one.outputs)
        assert error == pytest.approx(rmss(own.torque(windows), torque))


def test_matching_finds_a_permutation_with_mirrors():
    first = RNG.uniform(size=(200, 5))
    order = np.array([3, 0, 4, 1, 2])
    second = first[:, order].copy()
    second[:, 1] = 1 - second[:, 1]
    partner, alike = matched_units(first, second)
    np.testing.assert_array_equal(order[partner], np.arange(5))
    np.testing.assert_allclose(alike, 1)
    strangers = matched_units(first, RNG.uniform(size=(200, 5)))[1]
    assert strangers.max() < 0.4
    still = first.copy()
    still[:, 0] = 0.5
    assert matched_units(still, first)[1].min() == 0


def test_refitted_layer_is_least_squares_with_a_constant():
    rng = np.random.default_rng(5)
    x, new = rng.normal(size=(80, 3)), rng.normal(size=(40, 3))
    factors, noise = rng.normal(size=(3, 2)), rng.normal(size=(80, 2))
    exact = refitted(x, 7 + x @ factors, new, 7 + new @ factors)
    assert exact == pytest.approx([0, 0], abs=1e-9)
    torque = 7 + x @ factors + noise
    every = refitted(x, torque, new, 7 + new @ factors)
    fit = [np.polynomial.Polynomial.fit(x[:, 0], torque[:, j], 1)(x[:, 0]) for j in (0, 1)]
    one = refitted(x[:, :1], torque, new[:, :1], 7 + new @ factors)
    assert one[0] == pytest.approx(rmss(np.stack(fit, -1), torque))
    assert every[0] < one[0] and every[1] < one[1]
    best = refitted(x[:, :0], torque, new[:, :0], torque[:40])
    assert best[0] == pytest.approx(1)  # a constant guess
