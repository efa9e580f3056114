"""Measures of hidden units at work, on planted activities and networks."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.stats import spearmanr

from ddlib.setups import STATE_FEEDBACK, WINDOWS
from workshop.report import committed
from workshop.report.measures import filters, networks

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


def _planted_features(monkeypatch, x, hidden, torque, new, held, answer, **weights):
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


def test_features_are_of_the_set_up_that_is_asked_for(monkeypatch):
    model = SimpleNamespace(
        weights=SimpleNamespace(activity=lambda x: (x + 1, None)), scaled=lambda x: x[None, :, 0]
    )
    monkeypatch.setattr(committed, "networks", lambda width, setup: model)
    monkeypatch.setattr(committed, "training", lambda setup: f"{setup} 1 to 5")
    monkeypatch.setattr(committed, "recording", lambda setup: {5: f"{setup} 6"})
    made = {"day 1 to 5": np.ones((4, 2, 3)), "day 6": np.zeros((2, 2, 3))}
    monkeypatch.setattr(filters, "cases", lambda run, width: (made[run], (run, width)))
    (x, hidden, torque), (new, held, answer) = filters._features(7, "day")
    assert x.shape == (4, 6) and (x == 1).all() and (hidden == 2).all()
    assert new.shape == (2, 6) and (held == 1).all() and held.shape == (1, 2, 3)
    assert torque == ("day 1 to 5", 7) and answer == ("day 6", 7)


def test_the_order_of_samples_does_not_matter():
    found = networks.adjacency(epochs=20)
    assert 0 <= found.value < 1e-4
    assert found.text.endswith("after 20 epochs")
