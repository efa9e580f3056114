"""Probes against signals whose answer is known; jerk and parabolas in closed form."""

import numpy as np
import pytest
from numpy.polynomial import Polynomial
from scipy.stats import ortho_group

from ddlib.learning import TorqueModel, TrainingSet, Weights
from ddlib.simulation import LOG_STEP
from workshop.report.probes import cancellation, decoded, decoded_sign, pure_part, with_jerk

RNG = np.random.default_rng(0)


def test_jerk_is_the_slope_of_the_acceleration():
    t = np.arange(200) * LOG_STEP
    states = np.stack([t**3 / 6 * k for k in (1.0, 0, 0)], -1)[:, None].repeat(2, 1)
    states[..., 2] = np.stack([np.sin(3 * t), t**2], -1)
    jerk = with_jerk(states)[1:-1, :, 3]
    assert np.allclose(jerk[:, 0], 3 * np.cos(3 * t[1:-1]), atol=1e-3)
    assert np.allclose(jerk[:, 1], 2 * t[1:-1], atol=1e-9)
    assert np.array_equal(with_jerk(states)[..., :3], states)


def test_pure_part_keeps_polynomials_and_nothing_else():
    x = np.linspace(-1, 1, 21)
    rng = np.random.default_rng(1)
    f = rng.normal(size=(3, 21))
    assert np.allclose(pure_part(f), [Polynomial.fit(x, one, 2)(x) for one in f])


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


def test_cancellation_of_twins_and_rivals():
    windows = RNG.normal(size=(120, 2, 5))
    data = TrainingSet.from_arrays(windows, RNG.normal(size=(120, 2)))
    half = RNG.normal(size=(1, 2, 5))
    zero = dict(
        hidden_bias=np.zeros(2), direct_weights=np.zeros((2, 2, 5)), output_bias=np.zeros(2)
    )
    hidden = np.concatenate([half, half])
    weights = Weights(
        hidden_weights=hidden, output_weights=np.array([[1.0, 1.0], [2.0, -2.0]]), **zero
    )
    model = TorqueModel(weights, data.inputs, data.outputs)
    np.testing.assert_allclose(cancellation(model, windows), [0, 1], atol=1e-9)
