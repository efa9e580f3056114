"""Measures of hidden units at work, on planted activities and networks."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.stats import spearmanr

from ddlib.evidence import committed
from ddlib.evidence.measures import filters, networks
from ddlib.experiments import STATE_FEEDBACK, WINDOWS
from ddlib.learning import Scaler, TorqueModel, Weights

RNG = np.random.default_rng(0)


@pytest.fixture
def models(monkeypatch):
    """Names in place of networks: "trained" and "untrained", at all widths."""
    monkeypatch.setattr(committed, "networks", lambda width, *_: "trained")
    monkeypatch.setattr(committed, "untrained", lambda width, *_: "untrained")
    monkeypatch.setattr(filters, "_activities", lambda width: ("windows", "torque", None))


def test_saturation_is_the_median_unit(monkeypatch):
    """Four cases of units that are off or on in 0 to 4 of them."""
    often = {"trained": [[0, 1, 2], [3, 4, 4]], "untrained": [[1, 1, 0], [1, 0, 0]]}

    def activities(width, model, setup):
        name = "untrained" if model is committed.untrained else "trained"
        inside = np.arange(4)[:, None] >= np.array(often[name])[:, None, :]
        return None, None, np.where(inside, 0.5, [0.01, 0.99, 0.02])

    monkeypatch.setattr(filters, "_activities", activities)
    found = filters.saturation(21)
    assert found.value == pytest.approx(2.5 / 4)
    assert found.text == "62 % of the time, 12 % before training"


def test_activities_are_of_the_training_cases(monkeypatch):
    asked = []
    model = SimpleNamespace(
        weights=SimpleNamespace(activity=lambda x: (f"hidden of {x}", "output")),
        scaled=lambda windows: f"scaled {windows}",
    )
    monkeypatch.setattr(committed, "training", lambda *setup: setup[0])
    monkeypatch.setattr(
        filters, "cases", lambda run, width: asked.append((run, width)) or ("windows", "torque")
    )
    found = filters._activities(11, lambda width, *_: model)
    assert found == ("windows", "torque", "hidden of scaled windows")
    assert asked == [("state feedback", 11)]
    filters._activities(21, lambda width, setup: model, "position feedback")
    assert asked[1:] == [("position feedback", 21)]


def test_transition_regions_in_deviations(monkeypatch, models):
    """From 0.1 to 0.9 a sigmoid's input moves by 2 ln 9."""
    spreads = {"trained": [[1.0, 2.0, 8.0]], "untrained": [[0.5, 0.5, 9.0]]}

    def net_inputs(model, windows):
        assert windows == "windows"
        return np.array([-1.0, 1.0])[:, None] * np.array(spreads[model])[:, None, :]

    monkeypatch.setattr(filters, "net_inputs", net_inputs)
    found = filters.transition(21)
    assert found.value == pytest.approx(2 * np.log(9) / 2.0)
    assert found.text == "2.2 standard deviations, 8.8 before training"


def test_cancelling_less_the_null(monkeypatch, models):
    shares = {"trained": [[0.9, 0.8], [0.7, 0.8]], "untrained": [[0.6, 0.5], [0.5, 0.5]]}

    def cancellation(model, windows):
        assert windows == "windows"
        return np.array(shares[model])

    monkeypatch.setattr(filters, "cancellation", cancellation)
    found = filters.cancel(21)
    assert found.value == pytest.approx(0.3)
    assert found.text == "80 %, 50 % before training"


def test_units_that_can_be_spared(monkeypatch):
    """Two networks with an error of 1; held units leave these errors."""
    held = {0: [1.05, 1.2, 1.3], 1: [1.05, 1.09, 1.5], 2: [0.9, 1.0, 1.05]}
    wave = np.array([[1.0, -1.0], [-1.0, 1.0]])  # RMSS of zero on it: 1

    class Networks:
        weights = range(3)

        def __getitem__(self, k):
            return SimpleNamespace(number=k, torque=lambda windows: 0 * wave)

    monkeypatch.setattr(filters, "cases", lambda run, width: ("windows", wave))
    monkeypatch.setattr(
        filters, "ablation", lambda one, windows, torque: ([], np.array(held[one.number]))
    )
    assert list(filters._spare(21, 1.1, lambda width, *_: Networks())) == [1, 2, 3]
    assert list(filters._spare(21, 1.25, lambda width, *_: Networks())) == [2, 2, 3]
    spare = {committed.networks: np.array([1, 2, 7]), committed.untrained: np.array([4, 5, 6])}
    monkeypatch.setattr(filters, "_spare", lambda width, worse, model: spare[model])
    found = filters.spare_units(21)
    assert found.value == 2
    assert found.text == "2 of 10 units can be spared (1 to 7), 5 before training"


def test_errors_of_the_shoulder_alone(monkeypatch):
    torque = np.concatenate([np.ones((2, 2)), RNG.normal(size=(50, 2))])
    test = SimpleNamespace(tau=torque, motion=slice(2, None))
    recording = {5: test}
    moved = torque[2:]
    wrong = np.stack([moved + np.array([f, 9.0]) * moved.std(0) for f in (0.1, 0.3, 0.2)])
    monkeypatch.setattr(committed, "recording", lambda: recording)
    monkeypatch.setattr(committed, "networks", lambda width, *_: "networks")
    monkeypatch.setattr(filters, "predict", lambda model, asked: wrong)
    assert filters.shoulder_profile(21).value == pytest.approx(0.2)


# --- what weights explain ------------------------------------------------------------------------


def test_large_weights_and_saturation(monkeypatch):
    planted = {}
    for width in WINDOWS:
        hidden = RNG.normal(size=(3, 4, 2, width))
        activity = RNG.uniform(size=(3, 20, 4)) ** (1 + np.abs(hidden).max((2, 3)))[:, None]
        planted[width] = hidden, activity

    def planted_networks(width):
        hidden, activity = planted[width]
        own = SimpleNamespace(hidden_weights=hidden, activity=lambda x: (activity, None))
        return SimpleNamespace(weights=own, scaled=lambda windows: windows)

    monkeypatch.setattr(committed, "networks", planted_networks)
    monkeypatch.setattr(networks, "cases", lambda run, width: (None, None))
    sizes, shares = [], []
    for hidden, activity in planted.values():
        for network in range(3):
            for unit in range(4):
                on = activity[network, :, unit]
                sizes.append(max(abs(w) for w in hidden[network, unit].ravel()))
                shares.append(sum(x < 0.1 or x > 0.9 for x in on) / 20)
    wanted = spearmanr(sizes, shares).statistic
    found = networks.weights_and_saturation()
    assert found.value == pytest.approx(wanted) and wanted > 0.2
    assert found.text == f"rank correlation {wanted:.2f} over 36 units"


def test_units_held_at_their_mean(monkeypatch):
    """Unit by unit and case by case, with the sigmoid written out."""
    planted = Weights.random(2, 5, hidden=3, initial=1.5)
    model = TorqueModel(
        planted, Scaler(np.zeros(2), np.ones(2)), Scaler(-np.ones(2), np.full(2, 3.0))
    )
    windows, torque = RNG.uniform(size=(7, 2, 5)), RNG.normal(size=(7, 2))
    monkeypatch.setattr(committed, "networks", lambda width, *_: model)
    monkeypatch.setattr(networks, "cases", lambda run, width: (windows, torque))

    def sigmoid(x):
        return 1 / (1 + np.exp(-x))

    whole, still = np.empty((2, 2, 7, 2))
    for m in range(2):
        w = planted[m]
        hidden = np.array([
            [sigmoid(np.sum(w.hidden_weights[h] * x) + w.hidden_bias[h]) for h in range(3)]
            for x in windows
        ])  # fmt: skip
        for activity, out in ((hidden, whole), (np.tile(hidden.mean(0), (7, 1)), still)):
            for n, x in enumerate(windows):
                direct = [np.sum(w.direct_weights[j] * x) for j in range(2)]
                net = w.output_weights @ activity[n] + direct + w.output_bias
                out[m, n] = 4 * sigmoid(net) - 1
    found = networks._held_still(21)
    np.testing.assert_allclose(found[0], whole, rtol=1e-5)
    np.testing.assert_allclose(found[1], still, rtol=1e-5)
    assert found[2] is torque


def test_errors_without_hidden_units(monkeypatch):
    torque = RNG.normal(size=(40, 2))
    steps = torque.std(0)
    whole = np.stack([torque + f * steps for f in (0.1, 0.1, 0.2)])
    still = np.stack([torque + f * steps for f in (0.2, 0.5, 0.6)])
    monkeypatch.setattr(networks, "_held_still", lambda width, *_: (whole, still, torque))
    found = networks.without_hidden_units()
    assert found.value == pytest.approx(3.0)  # of 2, 5 and 3
    assert found.text == "error 3.0 times as large without them"


@pytest.mark.parametrize("noise, explained", [(0.0, 1.0), (1.0, 0.5)])
def test_friction_in_the_hidden_units(monkeypatch, noise, explained):
    """Hidden units whose sum is a line plus friction, and noise as large as its curved part."""
    t = np.arange(900) * 0.01
    q = np.stack([np.sin(2 * t), np.sin(3 * t + 1)], -1)
    qd = np.stack([2 * np.cos(2 * t), 3 * np.cos(3 * t + 1)], -1)
    run = SimpleNamespace(q_true=q, qd_true=qd, motion=slice(50, 850))
    windows = np.stack([q[k - 2 : k + 3].T for k in range(50, 850)])
    torque = STATE_FEEDBACK.effects.friction_torque(qd[50:850])
    line = np.column_stack([windows.reshape(800, -1), np.ones(800)])
    curved = torque - line @ np.linalg.pinv(line) @ torque
    parts = []
    for _ in range(3):
        extra = RNG.normal(size=curved.shape)
        parts.append(torque + noise * curved.std(0) * extra + line @ RNG.normal(size=(11, 2)))
    output = np.tile([[2.0, 0.0], [0.0, -1.0]], (3, 1, 1))
    hidden = np.array(parts) / [2.0, -1.0]
    own = SimpleNamespace(activity=lambda x: (hidden, None), output_weights=output)
    model = SimpleNamespace(weights=own, scaled=lambda x: x)
    monkeypatch.setattr(committed, "networks", lambda width, *_: model)
    monkeypatch.setattr(committed, "training", lambda: run)
    monkeypatch.setattr(networks, "cases", lambda run, width: (windows, None))
    found = networks.compensate_friction(5)
    assert found.value == pytest.approx(explained, abs=0.06)
    first, second = found.text.split("; ")
    assert first.startswith("friction: R² ") and second.startswith("rigid body: R² ")
    assert second.endswith(", shoulder and elbow")
    body = STATE_FEEDBACK.arm.inverse_dynamics(q, qd, np.gradient(qd, 0.01, axis=0))[50:850]
    left = body - line @ np.linalg.pinv(line) @ body
    fits = [
        np.median([np.corrcoef((p - line @ np.linalg.pinv(line) @ p)[:, j], left[:, j])[0, 1] ** 2
                   for p in parts]) for j in (0, 1)
    ]  # fmt: skip
    assert second == f"rigid body: R² {fits[0]:.2f} and {fits[1]:.2f}, shoulder and elbow"


def test_the_order_of_samples_does_not_matter():
    found = networks.adjacency(epochs=20)
    assert 0 <= found.value < 1e-4
    assert found.text.endswith("after 20 epochs")
