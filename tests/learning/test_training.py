"""Training sets, descent with momentum against plain sums, and what a run says of itself."""

import re
import warnings

import numpy as np
import pytest
import torch
from hypothesis import given, strategies as st
from small_networks import WIDTH, close, parts

from ddlib.learning import (
    History,
    TrainingDiverged,
    TrainingSet,
    Weights,
    WindowNetwork,
    WorseThanMean,
    cases,
    train,
    train_ensemble,
)
from ddlib.learning.training import recorded_epochs
from ddlib.metrics import rmss
from ddlib.setups import STATE_FEEDBACK

# --- the data ---------------------------------------------------------------------------


def test_cases_pair_each_window_with_the_torque_at_its_centre():
    recording = STATE_FEEDBACK.record([(30.0, 20.0), (10.0, 40.0)])
    windows, torque = cases(recording, 11)
    assert windows.shape == (600, 2, 11) and torque.shape == (600, 2)
    for run, sample in ((0, 0), (0, 299), (1, 0), (1, 123)):
        k, moment = 300 * run + sample, 50 + sample
        np.testing.assert_array_equal(windows[k], recording.q[run, moment - 5 : moment + 6].T)
        np.testing.assert_array_equal(torque[k], recording.tau[run, moment])
    made = TrainingSet.from_recording(recording, 11)
    np.testing.assert_allclose(made.inputs.unscale(made.x, -2), windows, atol=1e-12)
    assert made.step == recording.step


# --- history ----------------------------------------------------------------------------


def test_history_and_snapshots_are_those_of_their_epochs(data, other):
    start = Weights.random(5, WIDTH, seed=2)
    options = dict(rate=5.0, momentum=0.9, progress=False)
    snapshots = (0, 13, 40)
    model, history, kept = train_ensemble(
        start, data, test=other, epochs=40, snapshots=snapshots, **options
    )
    np.testing.assert_array_equal(history.epochs, recorded_epochs(40))
    assert history.training.shape == history.test.shape == (len(history.epochs), 5)
    assert tuple(kept) == snapshots
    close(kept[0], parts(start), rtol=0)
    close(kept[40], parts(model.weights), rtol=0)
    for epoch in (1, 13, 40):
        shorter, *_ = train_ensemble(start, data, epochs=epoch, **options)
        if epoch in kept:
            close(kept[epoch], parts(shorter.weights), rtol=0, atol=1e-6)
        point = list(history.epochs).index(epoch)
        for errors, x, y in ((history.training, data.x, data.y), (history.test, *other)):
            own = rmss(shorter.weights.activity(x)[1], y)
            np.testing.assert_allclose(errors[point], own, rtol=1e-5)


@given(power=st.floats(-2, 1), start=st.floats(0.01, 10))
def test_slope_of_a_power_law_is_its_exponent_and_small_ones_are_settled(power, start):
    """Fast descent that has stopped by half the epochs counts as stopped."""
    history = History()
    for epoch in recorded_epochs(20_000):
        history.append(int(epoch), [start * epoch**power, 1.0, 1.0 / min(epoch, 5000)])
    np.testing.assert_allclose(history.slope(), [power, 0.0, 0.0], atol=1e-9)
    assert history.settled()[1:].all() and history.settled(2.1).all()
    if abs(abs(power) - 0.1) > 1e-6:
        assert history.settled()[0] == (abs(power) < 0.1)


# --- runs that go astray -----------------------------------------------------------------


def with_member(start, k, value):
    """`start` with all weights of member `k` multiplied by a value."""
    arrays = [p.copy() for p in parts(start)]
    for p in arrays:
        p[k] = p[k] * value
    return Weights(*arrays)


@pytest.mark.parametrize("value", [1e4, np.nan])
def test_a_derailed_member_does_not_disturb_the_others(data, other, value):
    start = Weights.random(4, WIDTH)
    options = dict(test=other, epochs=60, momentum=0.9, progress=False)
    alone, clean, _ = train_ensemble(start, data, **options)
    model, history, _ = train_ensemble(with_member(start, 2, value), data, **options)
    np.testing.assert_array_equal(history.derailed, [False, False, True, False])
    assert not clean.derailed.any()
    for k in (0, 1, 3):
        close(model.weights[k], parts(alone.weights[k]), rtol=1e-5, atol=1e-6)
        np.testing.assert_allclose(history.training[:, k], clean.training[:, k], rtol=1e-5)
        np.testing.assert_allclose(history.test[:, k], clean.test[:, k], rtol=1e-5)


def test_divergence_is_an_error_that_keeps_the_history_and_gives_threads_back(data):
    """Sigmoid units saturate at large steps; it takes one beyond float32 to lose the sum."""
    before = torch.get_num_threads()
    torch.set_num_threads(2)
    start = with_member(Weights.random(1, WIDTH), 0, np.nan)
    with pytest.raises(TrainingDiverged, match=r"after 30 epochs: lower the rate \(2\.5\)") as info:
        train_ensemble(start, data, rate=2.5, epochs=30, progress=False)
    np.testing.assert_array_equal(info.value.history.epochs, recorded_epochs(30))
    assert info.value.history.derailed.all()
    train_ensemble(Weights.random(3, WIDTH), data, epochs=3, progress=False)
    assert torch.get_num_threads() == 2
    torch.set_num_threads(before)
    with pytest.raises(TrainingDiverged, match=r"lower the rate \(1e\+38\)") as info:
        train(WindowNetwork(WIDTH), data.x, data.y, rate=1e38, momentum=0.999, progress=False)
    history = info.value.history
    at = int(re.search(r"at epoch (\d+)", str(info.value))[1])
    assert history.epochs[-1] == at > 1 and not np.isfinite(history.training[-1]).any()


def test_a_far_too_large_rate_is_told(data):
    """But not of an ensemble of which one member has learnt, or has targets of its own."""
    start, options = Weights.random(3, WIDTH), dict(epochs=200, progress=False)
    with pytest.warns(WorseThanMean, match=r"an RMSS of [\d.]+, worse .* rate \(1e\+06\)") as w:
        _, history, _ = train_ensemble(start, data, rate=1e6, **options)
    assert history.derailed.all() and w[0].filename == __file__
    targets = np.stack([data.y] * 3)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        train_ensemble(start, data, rate=[1e6, 1e6, 3.0], **options)
        train_ensemble(start, data, rate=1e6, targets=targets, **options)
