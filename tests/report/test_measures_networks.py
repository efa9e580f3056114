"""Measures of networks and windows, on planted ones with answers known by hand."""

from math import erf
from types import SimpleNamespace

import numpy as np
import pytest

from ddlib.analysis import savitzky_golay
from ddlib.learning import History, Scaler, TorqueModel, Weights
from ddlib.setups import STATE_FEEDBACK
from ddlib.simulation import LOG_STEP
from workshop.report import committed
from workshop.report.measures import backpropagation, filters, networks, windows

RNG = np.random.default_rng(0)


# --- the unit, the rule, parity ------------------------------------------------------------------


def test_best_possible_answers_to_noisy_parity():
    """A bit is read rightly with the chance p of staying below half a step; parity then has
    (1 + (2p - 1)^3) / 2.
    """
    found = backpropagation.fine_distinctions()
    p = 0.5 * (1 + erf(0.5 / 0.25 / np.sqrt(2)))
    best = float(found.text.split("at best ")[1].split(" %")[0])
    assert best == pytest.approx(50 * (1 + (2 * p - 1) ** 3), abs=1.5)
    assert 0.5 < found.value <= 1.001  # chance, and as good as can be


def test_parity_takes_every_product_of_bits_and_one_of_signs():
    """As +1 or -1 it is the product of all 1 - 2 x: of bits all 2^n products, of signs one."""
    found = backpropagation.polynomial("bits", 8)
    assert found.value == pytest.approx(1.0)
    assert found.text == "4 at 2 bits, 256 at 8"
    assert backpropagation.polynomial("signs", 8).value == pytest.approx(0, abs=1e-12)


def test_when_errors_reach_a_level():
    errors = np.array([[1.0, 0.5, 3.0], [0.8, 0.4, 2.0], [0.6, 0.3, 1.0]])
    history = History(np.array([10, 20, 40]), errors, None)
    np.testing.assert_allclose(backpropagation.reach(history, 0.75), [25.0, 10.0, np.inf])
    np.testing.assert_allclose(backpropagation.reach(history, 0.9), [15.0, 10.0, np.inf])


# --- windows -------------------------------------------------------------------------------------


def test_multiplications_and_weights_by_hand():
    """21 samples of two joints to 10 hidden and 2 output units, 20 between; no biases."""
    count = 42 * 10 + 42 * 2 + 10 * 2
    assert networks.multiplications(21).value == count * 5 * 300
    assert networks.weights_against_nwh([21]).value == pytest.approx(count / (2 * 21 * 10))
    found = networks.weights_against_nwh()
    assert found.value == pytest.approx(1.2 + 1 / 11)  # n w h and direct weights, 20 more
    assert (
        found.text == "weights for n w h: 284 for 220 at 11, 524 for 420 at 21, 1004 for 820 at 41"
    )


@pytest.mark.parametrize("order", [1, 2, 3])
def test_derivatives_from_windows(monkeypatch, order):
    """A sine without noise: the filter's own gain at its frequency decides the error."""
    t = np.arange(-40, 400) * LOG_STEP
    omega = 7.0
    q, qd = (
        np.repeat(x[:, None], 2, axis=1) for x in (np.sin(omega * t), omega * np.cos(omega * t))
    )
    run = SimpleNamespace(qd_true=qd, motion=slice(40, 340))
    monkeypatch.setattr(committed, "training", lambda: run)

    def cut(run, width):
        half = width // 2
        return np.stack([q[k - half : k + half + 1].T for k in range(40, 340)]), None

    monkeypatch.setattr(windows, "cases", cut)
    taps = np.arange(-10, 11) * LOG_STEP
    gain = savitzky_golay(21, order, LOG_STEP, degree=max(order, 2)) @ np.exp(1j * omega * taps)
    wanted = abs(gain / (1j * omega) ** order - 1)
    found = windows.estimates([order], [21])
    # the true derivative of higher order is itself taken by differences
    assert found.value == pytest.approx(wanted, rel=0.02, abs=0.003)
    assert windows.estimates([order], [5, 21]).value <= found.value * 1.0001


# --- weights as filters --------------------------------------------------------------------------


def test_middle_between_two_crossings(monkeypatch):
    x = np.arange(-10.0, 11)
    parabolas = [(x - s) ** 2 - 9.3 for s in (0.0, 0.4, 0.6, -0.7)]  # crossings at s ± 3.05
    trained = [*parabolas, x - 0.5, x**3 - 20 * x + 3]
    planted = {committed.networks: trained, committed._untrained: [x - 0.3, *parabolas[:2]]}
    monkeypatch.setattr(
        committed,
        "filters",
        lambda width, layer, model=committed.networks: np.array(planted[model])[:, None],
    )
    found = networks.asymmetric(21)
    assert found.value == pytest.approx(0.5)
    assert found.text == "2 of 4 filters with two crossings; before training 2 have two"
    assert networks.asymmetric(21, 0.3).value == pytest.approx(0.75)
    # the crossings are between samples: a parabola has its middle where it has
    planted[committed.networks] = [(x - 0.5) ** 2 - 9.3] * 5
    assert networks.asymmetric(21, 0.499).value == 1 and networks.asymmetric(21, 0.501).value == 0


@pytest.fixture
def planted(monkeypatch):
    """Two networks: one of acceleration filters, one of velocity filters; hidden: position."""
    weights = Weights.random(2, 21)
    taps = [savitzky_golay(21, order, LOG_STEP, degree=2) for order in (0, 1, 2)]
    weights.hidden_weights[:] = taps[0]
    weights.direct_weights[0], weights.direct_weights[1] = taps[2], taps[1]
    scaler = Scaler(np.zeros(2), np.ones(2))
    monkeypatch.setattr(
        committed, "networks", lambda width, *_: TorqueModel(weights, scaler, scaler)
    )


def test_outputs_follow_what_the_filters_measure(planted):
    for name, share in (("position", 0), ("velocity", 0.5), ("acceleration", 0.5)):
        found = filters.follow(21, name)
        assert found.value == share
        assert found.text == "best correlated with position 0, velocity 4, acceleration 4 of 8"
        assert set(np.unique(found.replicates)) <= {0, 0.5, 1}
        assert found.replicates.mean() == pytest.approx(share, abs=0.05)
    assert filters.follow(21, "position", "hidden").value == 1


# --- hidden units at work ------------------------------------------------------------------------


def _planted_features(monkeypatch, x, hidden, torque, new, held, answer):
    """Windows, hidden activities and torques in training and on trajectory 6."""
    asked = []

    def features(width, setup):
        asked.append((width, setup))
        return (x, hidden, torque), (new, held, answer)

    monkeypatch.setattr(filters, "_features", features)
    return asked


def test_what_hidden_units_add_to_a_linear_filter(monkeypatch):
    """Torques of a line and a curve, which two of three networks know in part or wholly."""
    rng = np.random.default_rng(4)
    x, new = rng.normal(size=(300, 4)), rng.normal(size=(200, 4))
    curve, there = rng.normal(size=(2, 300, 2)), rng.normal(size=(2, 200, 2))
    wave = curve[0], there[0]
    torque, answer = (a[:, :2] + 0.5 * b for a, b in zip((x, new), wave))
    hidden = np.stack([wave[0], wave[0] + curve[1], curve[1]])
    held = np.stack([wave[1], wave[1] + there[1], there[1]])
    asked = _planted_features(monkeypatch, x, hidden, torque, new, held, answer)
    alone = filters.linear_alone(11, "some")
    assert alone == pytest.approx([0.5 / np.sqrt(1.25)] * 2, rel=0.06)
    found = filters.hidden_units_add(11, "some", "trajectory 6")
    # noise as large as the curve halves its power: the median network keeps 1 of sqrt 2
    assert found.value == pytest.approx(np.sqrt(2), rel=0.1)
    assert found.text == f"{alone[1]:.2f} alone, {alone[1] / found.value:.2f} with hidden units"
    assert filters.hidden_units_add(21, "some").value >= 1
    assert asked[0] == (11, "some") and asked[-1] == (21, "some")


@pytest.mark.parametrize("noise, share", [(0.0, 1.0), (1.0, 0.5)])
def test_friction_and_rigid_body_in_the_hidden_units(monkeypatch, noise, share):
    """Hidden units whose sum is a line, friction and the rigid body, and noise as large."""
    setup = SimpleNamespace(arm=STATE_FEEDBACK.arm, effects=STATE_FEEDBACK.effects)
    t = np.arange(900) * 0.01
    q = np.stack([np.sin(2 * t), np.sin(3 * t + 1)], -1)
    qd = np.stack([2 * np.cos(2 * t), 3 * np.cos(3 * t + 1)], -1)
    run = SimpleNamespace(q_true=q, qd_true=qd, motion=slice(50, 850))
    x = np.stack([q[k - 2 : k + 3].T.ravel() for k in range(50, 850)])
    line = np.column_stack([x, np.ones(800)])

    def curved(y):
        return y - line @ np.linalg.pinv(line) @ y

    friction = setup.effects.friction_torque(qd[50:850])
    body = setup.arm.inverse_dynamics(q, qd, np.gradient(qd, 0.01, axis=0))[50:850]
    wanted = friction + 2 * body
    sums = [
        wanted + line @ RNG.normal(size=(11, 2))
        + noise * curved(wanted).std(0) * RNG.normal(size=(800, 2))
        for _ in range(5)
    ]  # fmt: skip
    output = np.tile([[2.0, 0.0], [0.0, -1.0]], (5, 1, 1))
    hidden = np.array(sums) / [2.0, -1.0]
    _planted_features(monkeypatch, x, hidden, None, None, None, None)
    own = SimpleNamespace(weights=SimpleNamespace(output_weights=output))
    monkeypatch.setattr(committed, "networks", lambda *_: own)
    monkeypatch.setattr(committed, "training", lambda *_: run)
    monkeypatch.setattr(filters, "SETUPS", {"some": setup})
    found = filters.compensate_friction(5, "some")
    assert found.value == pytest.approx(share, abs=0.06)
    first, second, third = found.text.removesuffix(", shoulder and elbow").split("; ")
    assert first.startswith("R² friction ") and third.startswith("together ")
    fits = [
        np.median([np.corrcoef(curved(s)[:, j], curved(body)[:, j])[0, 1] ** 2 for s in sums])
        for j in (0, 1)
    ]
    told = [float(word) for word in second.removeprefix("rigid body ").split(" and ")]
    assert told == pytest.approx(fits, abs=0.006)
