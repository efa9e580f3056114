"""Measures of windows and networks, on planted ones with answers known by hand."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from ddlib.analysis import savitzky_golay
from ddlib.effects import Quantisation
from ddlib.learning import cases
from ddlib.setups import STATE_FEEDBACK, split
from ddlib.simulation import LOG_STEP
from workshop.report import committed
from workshop.report.measures import windows

pytestmark = pytest.mark.usefixtures("planted_members")


def test_multiplications_and_weights_by_hand():
    """21 samples of two joints to 10 hidden and 2 output units, 20 between; no biases."""
    count = 42 * 10 + 42 * 2 + 10 * 2
    assert windows.multiplications(21).value == count * 5 * 300
    many = 42 * 20 + 42 * 2 + 20 * 2  # ten times as many hidden units as outputs
    assert windows.weights_against_nwh([21]).value == pytest.approx(many / (2 * 21 * 20))
    assert windows.weights_against_nwh([21], many=5).value == pytest.approx(count / (2 * 21 * 10))
    found = windows.weights_against_nwh()
    assert found.value == pytest.approx(1.1 + 1 / 11)  # n w h and direct weights, 40 more
    assert found.text.endswith(
        "with 10 hidden units 284 for 220 at 11, 524 for 420 at 21, 1004 for 820 at 41"
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
    monkeypatch.setattr(committed, "training", lambda setup: run)

    def cut(run, width):
        half = width // 2
        return np.stack([q[k - half : k + half + 1].T for k in range(40, 340)]), None

    monkeypatch.setattr(windows, "cases", cut)
    taps = np.arange(-10, 11) * LOG_STEP
    gain = savitzky_golay(21, order, LOG_STEP, degree=max(order, 2)) @ np.exp(1j * omega * taps)
    wanted = abs(gain / (1j * omega) ** order - 1)
    found = windows.estimates([order], [21], degrees=[max(order, 2)])
    # the true derivative of higher order is itself taken by differences
    assert found.value == pytest.approx(wanted, rel=0.02, abs=0.003)
    assert windows.estimates([order], [5, 21]).value <= found.value * 1.0001  # the best decides
    assert windows.estimates([order], [21]).value <= found.value * 1.0001


@pytest.mark.parametrize(("known", "wanted"), [(1.0, 1.0), (0.5, 2.0)])
def test_what_is_memorised_does_not_help_on_another_day(monkeypatch, known, wanted):
    """Planted: networks that miss by as much everywhere, and less on the day they have seen."""
    seen = committed.training(STATE_FEEDBACK.name)

    def torque(run):
        size = known if run is seen else 1.0
        return np.stack([cases(run, 3)[1] + size * k for k in range(1, 6)])

    monkeypatch.setattr(committed, "networks", lambda *_: SimpleNamespace(torque=torque))
    monkeypatch.setattr(windows, "cases", lambda run, width: (run, cases(run, 3)[1]))
    found = windows.memorised(41, days=1)
    assert found.value == pytest.approx(wanted, rel=0.02)  # days differ in their deviation


def test_the_short_window_turns_where_parabolas_say():
    """With the encoder found, parabolas through 11 samples miss by a tenth more than through 21."""
    bits = windows.short_window((13, 12, 11)).value
    effects = replace(STATE_FEEDBACK.effects, encoder=(Quantisation(2 * np.pi / 2**bits),))
    run = split(replace(STATE_FEEDBACK, effects=effects).record())[0]
    true = np.gradient(run.qd_true, LOG_STEP, axis=-2)[..., run.motion, :].reshape(-1, 2)
    wrong = []
    for width in (11, 21):
        taps = np.arange(width) - width // 2
        x = cases(run, width)[0].reshape(-1, width).T
        curvature = 2 * np.polynomial.polynomial.polyfit(taps, x, 2)[2] / LOG_STEP**2
        wrong.append(((curvature.reshape(-1, 2) - true) ** 2).mean())
    assert np.sqrt(wrong[0] / wrong[1]) == pytest.approx(1.1, rel=0.08)  # rounding jumps
    assert 11 < bits < 13


def test_courses_of_training_by_hand(planted_results):
    cell = {"errors": {"test": [1.0, 2.0]}, "best test": [1.0, 1.0]}
    weights = {"21": [8.0, 8.0, 9.0], "41": [2.0, 4.0, 6.0], "11": [1.0]}
    cells = {w: {**cell, "largest weight": weights[w]} for w in weights}
    rows = [{"width": w, "training": [e]} for w, e in ((3, 3.0), (5, 2.0), (7, 2.5))]
    history = {"training": [[4.0, 3.0, 3.5, 1.0]]}
    planted_results(
        **{"table-4-1": {"setups": {STATE_FEEDBACK.name: cells}}, "window-sizes": {"rows": rows}},
        longer={"windows": {"21": {"history": history}}},
    )
    assert windows.rises_again().value == 0.5  # one network of two, at each window
    assert windows.magnitudes().value == 0.5
    assert windows.training_error_falls().value == 0.5  # at one step of two
    assert windows.training_is_monotone().value == pytest.approx(2 / 3)


def test_directions_by_hand(planted_results):
    """A cell for each window with inputs of 0 to 1, then for each with -1 to 1."""
    errors = [4.0, 8.0, 16.0, 2.0, 2.0, 2.0]
    some = [{"rmss": [e], "halves": [[10.0, 40.0, 80.0]], "learnt": [2]} for e in errors]
    kept = [{"start kept": [0.7, k / 10, 0.95], "variance": [1.0] * 3} for k in (9, 9, 8, 7, 7, 7)]
    planted_results(
        span={"cells": [{"measured": x, "predicted": x, **y} for x, y in zip(some, kept)]}
    )
    assert windows.centred().value == 2.0  # the least of three ratios
    assert windows.halved([1, 2], [3]).value == pytest.approx(4.0)  # 80 over the mean of 10 and 40
    assert windows.noise_left(41).value == 0.8
