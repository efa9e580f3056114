"""Measures of filters against networks whose filters are known."""

import numpy as np
import pytest

from ddlib.analysis import savitzky_golay
from ddlib.learning import Scaler, TorqueModel, Weights
from ddlib.simulation import LOG_STEP
from workshop.report import committed
from workshop.report.measures import filters


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
