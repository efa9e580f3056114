"""The study of acceleration: what it asks to be trained, and what it keeps of it."""

from types import SimpleNamespace

import numpy as np
import pytest

from ddlib.learning import History, default_rate
from ddlib.setups import INITIAL, STATE_FEEDBACK, WINDOWS
from workshop.report.studies import inputs

ALPHA = STATE_FEEDBACK.momentum


def falling(epochs, reached):
    """Errors that fall on a straight line to 0.75 at these epochs."""
    at = np.array([0.0, 2 * epochs])
    return History(at, 1.0 - 0.25 * at[:, None] / np.array(reached, float), None)


@pytest.fixture
def asked(monkeypatch):
    """What was asked for; training and parity answer with planted errors and epochs."""
    made = []

    def train_ensemble(weights, data, rate, momentum, epochs, label):
        hidden = weights.hidden_weights
        assert np.abs(hidden).max() == pytest.approx(INITIAL, rel=0.02)
        steps = np.broadcast_to(rate, len(weights)) / default_rate(data)
        assert hidden.shape[-1] == data
        made.append((data, momentum, epochs, [*np.round(steps, 6)]))
        if epochs != 7:
            slow, fast = [600.0, 800.0], [100.0, 9e9]
            return None, falling(epochs, slow if momentum == 0 else fast), None
        sets = hidden.reshape(3, 2, -1)
        assert (sets == sets[:1]).all() and (sets[:, 0] != sets[:, 1]).any()
        errors = data + 100 * momentum + steps + np.tile([0.0, 0.1], 3)
        return None, SimpleNamespace(training=np.array([0 * errors, errors])), None

    def learn(bits, hidden, members, momentum, epochs, every):
        assert (bits, hidden, members, every) == (3, 3, 4, 10)
        made.append((momentum, epochs))
        return None, np.array([np.inf, 60, 50, 40]) * (10 if momentum == 0 else 1)

    monkeypatch.setattr(inputs.TrainingSet, "from_recording", lambda run, width: width)
    monkeypatch.setattr(inputs, "train_ensemble", train_ensemble)
    monkeypatch.setattr(inputs.parity_networks, "learn", learn)
    return made


def test_every_network_is_trained_at_every_setting(asked):
    """The planted error of a network says which window, setting and network it was."""
    kept = inputs.acceleration(members=2, epochs=7)
    steps = [0.5, 0.5, 1.0, 1.0, 1.5, 1.5]
    long = [call for call in asked if 7 in call]
    assert long == [(w, alpha, 7, steps) for w in WINDOWS for alpha in (0.0, ALPHA)]
    assert list(kept["errors"]) == [str(width) for width in WINDOWS]
    for width, by_name in kept["errors"].items():
        for name, momentum in (("without", 0.0), ("with", ALPHA)):
            wanted = int(width) + 100 * momentum + np.array([[0.5, 1.0, 1.5], [0.6, 1.1, 1.6]])
            np.testing.assert_allclose(by_name[name], wanted)


def test_the_race_is_one_at_one_step(asked):
    kept = inputs.acceleration(members=2, epochs=7)
    raced = [call for call in asked if 7 not in call]
    plain = [1.0, 1.0]
    assert raced == [(21, 0.0, 2200, plain), (21, 0.9, 500, plain), (0.0, 4400), (0.9, 1000)]
    # parity that is never learnt counts with its length
    np.testing.assert_allclose(kept["parity"]["without"], [4400, 600, 500, 400])
    np.testing.assert_allclose(kept["parity"]["with"], [1000, 60, 50, 40])
