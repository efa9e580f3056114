"""The window network: sums by hand, counts of the paper, symmetries and files."""

import copy
import pickle
import zipfile

import numpy as np
import pytest
import torch
from hypothesis import given, settings, strategies as st

from ddlib import paper
from ddlib.learning import Scaler, TorqueModel, Weights, WindowNetwork
from ddlib.learning.network import WEIGHT_NAMES

RNG = np.random.default_rng(2)


def model(members=3, width=11) -> TorqueModel:
    inputs = Scaler([-0.8, -0.6], [0.1, 0.2])
    outputs = Scaler([-40.0, -9.0], [35.0, 12.0], (0.2, 0.8))
    return TorqueModel(Weights.random(members, width, initial=2.0, seed=5), inputs, outputs)


# --- what a network computes --------------------------------------------------------------


def test_a_tiny_network_by_hand():
    """One joint, three samples, two hidden units, one output."""
    weights = Weights(
        hidden_weights=[[[1.0, 0.0, -2.0]], [[0.5, 1.0, 0.0]]],
        hidden_bias=[0.5, -1.0],
        output_weights=[[2.0, -3.0]],
        direct_weights=[[[0.0, 1.0, 4.0]]],
        output_bias=[0.25],
    )
    x = [[[0.2, 0.6, 0.9]], [[1.0, 0.0, 0.0]]]
    # hidden nets: 0.2 - 1.8 + 0.5 = -1.1; 0.1 + 0.6 - 1 = -0.3; then 1.5 and -0.5
    h = 1 / (1 + np.exp([[1.1, 0.3], [-1.5, 0.5]]))
    nets = [0.6 + 3.6 + 2 * h[0, 0] - 3 * h[0, 1] + 0.25, 2 * h[1, 0] - 3 * h[1, 1] + 0.25]
    hidden, output = weights.activity(x)
    np.testing.assert_allclose(hidden, h, rtol=1e-12)
    np.testing.assert_allclose(output, 1 / (1 + np.exp(-np.array(nets)[:, None])), rtol=1e-12)


@pytest.mark.parametrize("width, hidden, joints, outputs", [(11, 10, 2, 2), (5, 3, 1, 4)])
def test_arrays_and_torch_agree(width, hidden, joints, outputs):
    network = WindowNetwork(width, hidden, joints, outputs, initial=1.5, seed=3)
    x = RNG.uniform(size=(40, joints, width))
    with torch.no_grad():
        by_torch = network(torch.tensor(x, dtype=torch.float32)).numpy()
    weights = network.weights()
    assert by_torch.shape == (40, outputs) and np.ptp(by_torch) > 0.1
    np.testing.assert_allclose(weights.activity(x)[1], by_torch, atol=2e-6)
    drawn = Weights.random(1, width, hidden, joints, outputs, initial=1.5, seed=3)[0]
    np.testing.assert_allclose(weights.direct_weights, drawn.direct_weights, rtol=1e-6)
    weights.hidden_bias[:] = 9.0  # a copy
    assert (network.hidden_bias < 2).all()
    assert sum(p.numel() for p in network.parameters()) == drawn.count(biases=True)


@settings(max_examples=25)
@given(order=st.permutations(range(6)), flip=st.lists(st.sampled_from([1, -1]), min_size=6))
def test_order_and_sign_of_hidden_units_do_not_show_outside(order, flip):
    """Order: obvious. Sign: sigmoid(-x) = 1 - sigmoid(x), the output bias takes the rest."""
    weights = Weights.random(1, 5, 6, initial=2.0, seed=1)[0]
    flip = np.array(flip[:6])
    out = weights.output_weights
    other = Weights(
        (flip[:, None, None] * weights.hidden_weights)[order],
        (flip * weights.hidden_bias)[order],
        (flip * out)[:, order],
        weights.direct_weights,
        weights.output_bias + (out * (flip < 0)).sum(-1),
    )
    x = np.random.default_rng(0).uniform(size=(30, 2, 5))
    (h, y), (h2, y2) = weights.activity(x), other.activity(x)
    np.testing.assert_allclose(y2, y, atol=1e-13)
    np.testing.assert_allclose(h2, np.where(flip < 0, 1 - h, h)[:, order], atol=1e-13)


# --- counts and members --------------------------------------------------------------------


def test_counts():
    """2 x w inputs to 10 hidden and 2 output units, hidden to outputs; 12 biases.

    "Over 700,000 multiplications an epoch" fits window 21: 524 weights times 1500 cases.
    """
    for width in paper.TABLE_4_1:
        weights = Weights.random(2, width)
        assert weights.count() == 2 * width * 10 + 2 * width * 2 + 10 * 2
        assert weights.count(biases=True) == weights.count() + 12
        assert weights[0].count() == weights.count() and weights.width == width
        excess = 1500 * weights.count() - paper.MULTIPLICATIONS_PER_EPOCH
        assert (0 <= excess < 100_000) == (width == 21)


@given(seed=st.integers(0, 50), k=st.integers(0, 4))
def test_a_member_depends_on_its_own_seed_only(seed, k):
    many, alone = Weights.random(5, 5, seed=seed), Weights.random(1, 5, seed=seed + k)
    for name in WEIGHT_NAMES:
        np.testing.assert_array_equal(getattr(many, name)[k], getattr(alone, name)[0])
    assert not np.array_equal(many.hidden_weights[k], many.hidden_weights[k - 1])


# --- two matrices and their views -----------------------------------------------------------


@pytest.mark.parametrize("lead", [(), (3,), (2, 3)])
def test_rows_hold_each_units_window_and_bias(lead):
    """Hidden units first, then outputs; joint by joint, the oldest sample first."""
    parts = [RNG.normal(size=(*lead, *s)) for s in ((4, 2, 5), (4,), (3, 4), (3, 2, 5), (3,))]
    weights = Weights(*parts)
    for part, name in zip(parts, WEIGHT_NAMES):
        np.testing.assert_array_equal(getattr(weights, name), part)
    assert weights.rows.shape == (*lead, 4 + 3, 2 * 5 + 1)
    np.testing.assert_array_equal(weights.rows[..., 1, 5 + 2], parts[0][..., 1, 1, 2])
    np.testing.assert_array_equal(weights.rows[..., 4 + 2, 3], parts[3][..., 2, 0, 3])
    np.testing.assert_array_equal(weights.rows[..., -1], np.concatenate([parts[1], parts[4]], -1))


REMADE = {
    "itself": lambda weights: weights,
    "some members": lambda weights: weights[1:],
    "joined": lambda weights: Weights.concatenate([weights, weights]),
    "stacked": lambda weights: Weights.stack([weights, weights]),
    "copied": copy.deepcopy,
    "from another process": lambda weights: pickle.loads(pickle.dumps(weights)),
}


@pytest.mark.parametrize("make", REMADE.values(), ids=REMADE)
def test_what_is_written_into_a_field_is_in_the_rows(make):
    weights = make(Weights.random(3, 5, 4, joints=2, outputs=3, initial=2.0))
    x = RNG.uniform(size=(6, 2, 5))
    for name in WEIGHT_NAMES:
        before = weights.activity(x)[1]
        getattr(weights, name)[..., 0] += 0.5
        again = Weights(**{name: getattr(weights, name) for name in WEIGHT_NAMES})
        np.testing.assert_array_equal(weights.rows, again.rows)
        np.testing.assert_array_equal(weights.output_weights, again.output_weights)
        assert np.abs(weights.activity(x)[1] - before).max() > 1e-3


# --- radians to newton metres, and files ----------------------------------------------------


def test_torque_is_scaled_activity():
    trained = model()
    windows = RNG.uniform(-0.7, 0.1, (20, 2, 11))
    x = np.empty_like(windows)
    for j, (low, high) in enumerate([(-0.8, 0.1), (-0.6, 0.2)]):
        x[:, j] = (windows[:, j] - low) / (high - low)
    np.testing.assert_allclose(trained.scaled(windows), x, atol=1e-12)
    y = trained.weights.activity(x)[1]
    wanted = [-40.0, -9.0] + (y - 0.2) / 0.6 * [75.0, 21.0]
    np.testing.assert_allclose(trained.torque(windows), wanted, rtol=1e-10)


@pytest.mark.parametrize("pick", [slice(None), 1], ids=["ensemble", "single"])
def test_a_file_keeps_the_model(tmp_path, pick):
    saved, path = model()[pick], tmp_path / "deep" / "er" / "model.npz"
    model(2).save(path)  # is replaced
    saved.save(path)
    loaded = TorqueModel.load(path)
    for name in WEIGHT_NAMES:
        before, after = getattr(saved.weights, name), getattr(loaded.weights, name)
        np.testing.assert_array_equal(after, before.astype(np.float32))
    for name in ("inputs", "outputs"):
        for field in ("low", "high", "target"):  # in full precision
            before, after = (getattr(getattr(m, name), field) for m in (saved, loaded))
            np.testing.assert_array_equal(after, before)


def test_damaged_files(tmp_path):
    path = tmp_path / "model.npz"
    model().save(path)
    good = path.read_bytes()
    with zipfile.ZipFile(path) as file:
        start = file.getinfo("hidden_weights.npy").header_offset + 120
    flipped = good[:start] + bytes(40) + good[start + 40 :]
    for damaged in (b"not a model", flipped):
        path.write_bytes(damaged)
        with pytest.raises(ValueError, match="is not a model file"):
            TorqueModel.load(path)
