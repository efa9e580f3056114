"""Measures of networks and windows, on planted ones with answers known by hand."""

from types import SimpleNamespace

import numpy as np
import pytest

from ddlib.analysis import savitzky_golay
from ddlib.simulation import LOG_STEP
from workshop.report import committed
from workshop.report.measures import windows

# --- windows -------------------------------------------------------------------------------------


def test_multiplications_and_weights_by_hand():
    """21 samples of two joints to 10 hidden and 2 output units, 20 between; no biases."""
    count = 42 * 10 + 42 * 2 + 10 * 2
    assert windows.multiplications(21).value == count * 5 * 300
    assert windows.weights_against_nwh([21]).value == pytest.approx(count / (2 * 21 * 10))
    found = windows.weights_against_nwh()
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
