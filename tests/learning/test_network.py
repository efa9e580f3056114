"""The window network: sums by hand, counts of the paper, symmetries and files."""

import warnings
import zipfile
from dataclasses import fields

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from ddlib import paper
from ddlib.learning import Scaler, TorqueModel, Weights, WindowNetwork

NAMES = tuple(field.name for field in fields(Weights))
RNG = np.random.default_rng(2)


def changed(weights, **arrays) -> Weights:
    return Weights(*(arrays.get(name, getattr(weights, name)) for name in NAMES))


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
    by_arrays = network.weights().activity(x)[1]
    assert by_torch.shape == (40, outputs) and np.ptp(by_torch) > 0.1
    np.testing.assert_allclose(by_arrays, by_torch, atol=2e-6)


def test_the_module_takes_the_drawn_weights_and_gives_copies():
    network = WindowNetwork(7, initial=0.2, seed=9)
    drawn = Weights.random(1, 7, initial=0.2, seed=9)[0]
    copy = network.weights()
    for name in NAMES:
        np.testing.assert_allclose(getattr(copy, name), getattr(drawn, name), rtol=1e-6)
    copy.hidden_bias[:] = 9.0
    assert (network.hidden_bias < 1).all()
    assert sum(p.numel() for p in network.parameters()) == drawn.count(biases=True)


def test_members_of_an_ensemble_do_not_see_each_other():
    many = Weights.random(4, 5, initial=2.0)
    x = RNG.uniform(size=(30, 2, 5))
    hidden, output = many.activity(x)
    assert hidden.shape == (4, 30, 10) and output.shape == (4, 30, 2)
    for k in range(4):
        for together, alone in zip((hidden, output), many[k].activity(x)):
            np.testing.assert_allclose(together[k], alone[...], rtol=1e-12)


def test_large_nets_saturate_without_a_warning():
    weights = Weights.random(1, 5, initial=1e5)[0]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        hidden, output = weights.activity(RNG.uniform(size=(20, 2, 5)))
    for y in (hidden, output):
        assert ((y < 1e-6) | (y > 1 - 1e-6)).mean() > 0.95 and (y >= 0).all() and (y <= 1).all()


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


@pytest.mark.parametrize(
    "x, words",
    [
        (np.zeros((4, 2, 7)), r"x must have shape \(cases, 2, 5\)"),
        (np.zeros((4, 3, 5)), r"x must have shape \(cases, 2, 5\)"),
        (np.full((4, 2, 5), np.nan), "x must be finite"),
    ],
)
def test_activity_refuses_bad_windows(x, words):
    with pytest.raises(ValueError, match=words):
        Weights.random(2, 5).activity(x)


# --- counts and records --------------------------------------------------------------------


@pytest.mark.parametrize("width", paper.TABLE_4_1)
def test_counts(width):
    """2 x w inputs to 10 hidden and 2 output units, hidden to outputs; 12 biases."""
    weights = Weights.random(2, width)
    assert weights.count() == 2 * width * 10 + 2 * width * 2 + 10 * 2
    assert weights.count(biases=True) == weights.count() + 12
    assert weights[0].count() == weights.count()
    assert weights.width == width


def test_the_paper_counts_its_multiplications_at_window_21():
    """ "Over 700,000 multiplications an epoch": 524 weights times 1500 cases."""
    counts = {w: 1500 * Weights.random(1, w).count() for w in paper.TABLE_4_1}
    assert counts == {11: 426_000, 21: 786_000, 41: 1_506_000}
    fits = [w for w, n in counts.items() if 0 <= n - paper.MULTIPLICATIONS_PER_EPOCH < 100_000]
    assert fits == [21]


def test_count_of_another_shape():
    weights = Weights.random(1, 7, hidden=4, joints=3, outputs=5)
    assert weights.count() == 4 * 21 + 5 * 21 + 5 * 4
    assert weights.count(biases=True) == weights.count() + 9


@given(seed=st.integers(0, 50), k=st.integers(0, 4))
def test_a_member_depends_on_its_own_seed_only(seed, k):
    many, alone = Weights.random(5, 5, seed=seed), Weights.random(1, 5, seed=seed + k)
    for name in NAMES:
        np.testing.assert_array_equal(getattr(many, name)[k], getattr(alone, name)[0])
    assert not np.array_equal(many.hidden_weights[k], many.hidden_weights[k - 1])


@pytest.mark.parametrize("initial", [0.1, 0.3, 2.0])
def test_initial_weights_fill_their_range(initial):
    weights = Weights.random(20, 21, initial=initial)
    for name in NAMES:
        x = getattr(weights, name).ravel()
        assert np.abs(x).max() <= initial
        assert x.min() < -0.8 * initial and x.max() > 0.8 * initial
        assert abs(x.mean()) < 4 * initial / np.sqrt(3 * x.size)
    assert 0.95 * initial < weights.largest.min() and weights.largest.max() <= initial


def test_largest_is_found_wherever_it_is():
    for name in NAMES:
        weights = Weights.random(3, 5)
        array = getattr(weights, name).copy()
        array[1].flat[-1] = -7.5
        found = changed(weights, **{name: array}).largest
        assert found.shape == (3,) and found[1] == 7.5
        assert (found[[0, 2]] <= 0.3).all()
    assert Weights.random(1, 5)[0].largest.shape == ()


def test_members_come_apart_and_together():
    many = Weights.random(5, 5)
    assert len(many) == 5 and len(many[1:3]) == 2
    joined = Weights.concatenate([many[3:], many[:3]])
    for name in NAMES:
        np.testing.assert_array_equal(
            getattr(joined, name), np.roll(getattr(many, name), 2, axis=0)
        )
    with pytest.raises(TypeError, match="a single network has no length"):
        len(many[0])


@pytest.mark.parametrize("name", NAMES[1:])
def test_shapes_must_fit(name):
    weights = Weights.random(2, 5, hidden=4, joints=2, outputs=3)
    cut = getattr(weights, name)[..., :-1]
    with pytest.raises(ValueError, match="must have shape"):
        changed(weights, **{name: cut})


@pytest.mark.parametrize(
    "change, error, words",
    [
        (dict(members=0), ValueError, "members"),
        (dict(width=0), ValueError, "width"),
        (dict(hidden=0), ValueError, "hidden"),
        (dict(initial=0.0), ValueError, "initial"),
        (dict(initial=-0.3), ValueError, "initial"),
        (dict(initial=np.nan), ValueError, "initial"),
        (dict(seed=-1), ValueError, "seed"),
        (dict(members=2.0), TypeError, "members"),
        (dict(seed=0.5), TypeError, "seed"),
    ],
)
def test_random_refuses_bad_values(change, error, words):
    with pytest.raises(error, match=rf"^{words} must"):
        Weights.random(**{**dict(members=2, width=5), **change})


# --- radians to newton metres ---------------------------------------------------------------


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
    assert trained.torque(windows).shape == (3, 20, 2)
    np.testing.assert_allclose(trained[1].torque(windows), wanted[1], rtol=1e-10)


def test_torque_refuses_bad_windows():
    with pytest.raises(ValueError, match="windows must be finite"):
        model().torque(np.full((3, 2, 11), np.nan))
    with pytest.raises(ValueError, match="x must have shape"):
        model().torque(np.zeros((3, 2, 21)))


# --- files ------------------------------------------------------------------------------


@pytest.mark.parametrize("pick", [slice(None), 1], ids=["ensemble", "single"])
def test_a_file_keeps_the_model(tmp_path, pick):
    saved, path = model()[pick], tmp_path / "deep" / "er" / "model.npz"
    saved.save(path)
    loaded = TorqueModel.load(path)
    for name in NAMES:
        before, after = getattr(saved.weights, name), getattr(loaded.weights, name)
        assert after.dtype == float and after.shape == before.shape
        np.testing.assert_array_equal(after, before.astype(np.float32))
    for name in ("inputs", "outputs"):
        before, after = getattr(saved, name), getattr(loaded, name)
        np.testing.assert_array_equal(after.low, before.low)  # in full precision
        np.testing.assert_array_equal(after.high, before.high)
        assert after.target == before.target
    windows = RNG.uniform(-0.7, 0.1, (20, 2, 11))
    np.testing.assert_allclose(loaded.torque(windows), saved.torque(windows), atol=1e-4)
    assert [p.name for p in path.parent.iterdir()] == ["model.npz"]


def test_saving_again_replaces(tmp_path):
    path = tmp_path / "model.npz"
    model(3).save(path)
    model(2).save(path)
    assert len(TorqueModel.load(path).weights) == 2
    assert [p.name for p in tmp_path.iterdir()] == ["model.npz"]


def test_an_interrupted_save_leaves_the_old_file(tmp_path, monkeypatch):
    path = tmp_path / "model.npz"
    model(3).save(path)

    def interrupted(file, **arrays):
        file.write(b"half")
        raise KeyboardInterrupt

    monkeypatch.setattr(np, "savez_compressed", interrupted)
    with pytest.raises(KeyboardInterrupt):
        model(2).save(path)
    assert len(TorqueModel.load(path).weights) == 3


def test_a_missing_file(tmp_path):
    with pytest.raises(FileNotFoundError):
        TorqueModel.load(tmp_path / "none.npz")


def damaged(path, kind):
    if kind == "empty":
        path.write_bytes(b"")
    elif kind == "text":
        path.write_text("not a model")
    elif kind == "cut short":
        path.write_bytes(path.read_bytes()[:-200])
    elif kind == "flipped bytes":
        data = bytearray(path.read_bytes())
        with zipfile.ZipFile(path) as file:
            start = file.getinfo("hidden_weights.npy").header_offset
        data[start + 120 : start + 160] = bytes(40)
        path.write_bytes(data)
    elif kind == "an array":
        with open(path, "wb") as file:
            np.save(file, np.zeros(3))
    elif kind == "other arrays":
        np.savez(path, a=np.zeros(3))
    elif kind == "wrong shape":
        with np.load(path) as file:
            arrays = dict(file)
        np.savez(path, **{**arrays, "hidden_bias": np.zeros(4)})


@pytest.mark.parametrize(
    "kind",
    [
        "empty",
        "text",
        "cut short",
        "flipped bytes",
        "an array",
        "other arrays",
        "wrong shape",
    ],
)
def test_a_damaged_file(tmp_path, kind):
    path = tmp_path / "model.npz"
    model().save(path)
    damaged(path, kind)
    with pytest.raises(ValueError, match="is not a model file"):
        TorqueModel.load(path)


def test_activity_wants_a_list_of_windows():
    with pytest.raises(ValueError, match=r"x must have shape \(cases, 2, 5\), got \(2, 5\)"):
        Weights.random(1, 5)[0].activity(np.zeros((2, 5)))


def test_stacked_networks_keep_their_places():
    parts = [Weights.random(3, 5, seed=k) for k in (0, 10)]
    stacked = Weights.stack(parts)
    assert stacked.hidden_weights.shape == (2, 3, 10, 2, 5)
    np.testing.assert_array_equal(stacked[1].direct_weights, parts[1].direct_weights)
