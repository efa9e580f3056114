"""The real arm's cases, its blocks, and the models that are tried on them."""

import numpy as np
from scipy.optimize import approx_fprime

from beyond.others import staubli
from beyond.studies import tx40
from beyond.studies.checks import wired
from beyond.studies.tx40 import (
    _BLOCKS,
    Ridge,
    Windowed,
    identified,
    known_structure,
    least_squares,
)
from ddlib.identification import joint_terms
from ddlib.learning import Weights

RNG = np.random.default_rng(0)


def test_windows_surround_the_same_moments():
    rate, width = 500, 81
    data, arm = Windowed.of(rate, width), staubli()
    assert data.x.shape == (820, 6, width) and data.current.shape == (820, 6)
    middle = data.x[:, :, width // 2]
    times = (np.arange(40, 860) + 0.5) / 100
    there = np.stack([np.interp(times, arm.t, arm.q[:, j]) for j in range(6)], -1)
    fastest = np.abs(np.diff(arm.q, axis=0)).max() / arm.step
    assert np.abs(middle - there).max() < fastest * 0.004
    many = 1000 // rate
    own = arm.current[: 9000 // many * many].reshape(-1, many, 6).mean(1)
    centre = 40 * (rate // 100) + (rate // 100) // 2
    np.testing.assert_allclose(data.current[0], own[centre], rtol=1e-12)


def test_no_window_reaches_from_one_side_to_the_other():
    data, seen, half = Windowed.of(100, 81), np.zeros(820, int), 0.4
    for block in range(_BLOCKS):
        training, test = data.fold(block)
        seen += test
        assert not (training & test).any() and training.sum() > 400
        apart = np.abs(np.flatnonzero(training)[:, None] - np.flatnonzero(test)).min() / 100
        assert apart > 2 * half - 1e-9
    assert (seen == 1).all()


def test_ridge_is_the_closed_form():
    x, y = RNG.normal(size=(40, 5)) @ RNG.normal(size=(5, 5)), RNG.normal(size=(40, 2))
    a, b = x - x.mean(0), y - y.mean(0)
    made = Ridge(x, y)
    penalty = 0.3 * np.trace(a.T @ a) / 5 * np.eye(5)
    factors = np.linalg.solve(a.T @ a + penalty, a.T @ b)
    np.testing.assert_allclose(made.filters(0.3), factors, rtol=1e-9)
    np.testing.assert_allclose(made.predict(x, 0.3), y.mean(0) + a @ factors, rtol=1e-9)
    np.testing.assert_allclose(made.predict(x, 1e-12), least_squares(x, y, x), atol=1e-7)


def planted(states, viscous=0.7, coulomb=0.4, inertia=0.05):
    """Currents of six joints that are acceleration, friction and a weight."""
    q, v, a = np.moveaxis(states, -1, 0)
    sign = np.stack([row["sign"] for row in joint_terms(states)], -1)
    return inertia * a + viscous * v + coulomb * sign + 0.2 * np.cos(q[:, [1]]) * [0, 1, 0, 0, 0, 0]


def test_identified_finds_what_was_planted():
    states = Windowed.of(100, 11).states
    current = planted(states)
    found = identified(states, current)
    np.testing.assert_allclose(found.inertia, 0.05, rtol=1e-5)
    np.testing.assert_allclose(found.viscous, 0.7, rtol=1e-5)
    np.testing.assert_allclose(found.coulomb, 0.4, rtol=1e-5)
    np.testing.assert_allclose(found.friction + found.rest, current, atol=1e-6)
    training, test = Windowed.of(100, 11).fold(1)
    told = known_structure(states[training], current[training], states[test])
    np.testing.assert_allclose(told, current[test], atol=1e-5)
    without = known_structure(states[training], current[training], states[test], friction=False)
    assert np.abs(without - current[test]).max() > 0.1


def test_decayed_networks_are_at_an_optimum_of_what_is_said():
    data = Windowed.of(100, 5)
    x, y, decay = data.x[:200:4], data.current[:200:4], 1e-2
    start = Weights.random(1, 5, 2, 6, 6)[0]
    model = tx40._decayed(x, y, start, decay, steps=2000)
    names = ("hidden_weights", "hidden_bias", "output_weights", "direct_weights", "output_bias")
    scaled, wanted = model.scaled(x), model.outputs.scale(y)
    parts = [getattr(model.weights, n) for n in names]
    ends = np.cumsum([p.size for p in parts])[:-1]

    def objective(vector):
        w = Weights(*(v.reshape(p.shape) for v, p in zip(np.split(vector, ends), parts)))
        error = w.activity(scaled)[1] - wanted
        size = sum((getattr(w, n) ** 2).sum() for n in names if n.endswith("weights"))
        return 0.5 * (error**2).sum() / len(scaled) + 0.5 * decay * size

    at = np.concatenate([p.ravel() for p in parts])
    begin = np.concatenate([getattr(start, n).ravel() for n in names])
    slope = approx_fprime(at, objective, 1e-6)
    assert objective(at) < objective(begin)
    assert np.abs(slope).max() < 0.02 * np.abs(approx_fprime(begin, objective, 1e-6)).max()


def test_apart_a_joint_hears_its_own_window_alone():
    x, y = RNG.normal(size=(60, 6, 5)), RNG.normal(size=(60, 6))
    other, training = x.copy(), np.arange(60) < 40
    other[:, 1:] = RNG.normal(size=(60, 5, 5))
    for model in (wired._linear, wired._network):
        a, b = (wired._apart(model, each, y, training, 1e-3, 0) for each in (x, other))
        np.testing.assert_allclose(a[:, 0], b[:, 0], rtol=1e-12)
        assert np.abs(a[:, 1] - b[:, 1]).max() > 0.01
