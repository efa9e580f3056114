"""Measures of committed results and networks, on planted ones with answers known by hand."""

from types import SimpleNamespace

import numpy as np
import pytest

from ddlib import results
from ddlib.experiment import STATE_FEEDBACK, WINDOWS
from ddlib.filters import basis, savitzky_golay
from ddlib.measures import backpropagation, committed, filters, networks, state_space, weights
from ddlib.measures import windows as of_windows
from ddlib.simulate import LOG_STEP

STATE, POSITION = "state feedback", "position feedback"


@pytest.fixture
def plant(monkeypatch):
    """``plant(name, content)`` puts a result in place of the committed one."""
    planted = {}

    def read(name):
        return planted[name]

    monkeypatch.setattr(results, "read", read)
    return planted.__setitem__


@pytest.fixture
def plant_filters(monkeypatch):
    """``plant_filters(hidden={width: array}, skip={...})`` in place of trained weights."""

    def put(**layers):
        monkeypatch.setattr(committed, "filters", lambda width, layer: layers[layer][width])

    return put


def table(cells):
    """Table 4-1 with the same cells for both readings but for a factor of ten."""
    setups = {}
    for name, factor in ((STATE, 1.0), (POSITION, 10.0)):
        setups[name] = {
            str(width): {
                "errors": {k: list(factor * np.array(v)) for k, v in cell["errors"].items()},
                **{k: list(factor * np.array(v)) for k, v in cell.items() if k != "errors"},
            }
            for width, cell in cells.items()
        }
    return {"setups": setups}


def cell(training, test, **more):
    return {"errors": {"training": training, "test": test}, **more}


# --- Table 4-1 and its neighbours ------------------------------------------------------------


CELLS = {
    11: cell([0.1, 0.2, 0.9], [0.4, 0.3, 0.5], slope=[-0.2, 0.1, -0.4]),
    21: cell([0.1, 0.1, 0.3], [0.2, 0.3, 0.1], slope=[0.01, 0.02, 0.03]),
    41: cell([0.05, 0.04, 0.06], [0.6, 0.5, 0.4], slope=[-0.3, -0.25, -0.1]),
}


def test_cells_are_medians_over_networks(plant):
    plant("table-4-1", table(CELLS))
    assert networks.table_4_1(11, "training").value == pytest.approx(0.2)
    assert networks.table_4_1(21, "test").value == pytest.approx(0.2)
    assert networks.table_4_1(41, "test", POSITION).value == pytest.approx(5.0)


def test_the_ratio_of_errors_is_the_least_of_three(plant):
    plant("table-4-1", table(CELLS))
    found = networks.worse_on_test()
    assert found.value == pytest.approx(2.0)  # 0.4/0.2, 0.2/0.1, 0.5/0.05
    assert found.text == "test / training 2.0, 2.0, 10"


def test_the_steepest_end_of_training(plant):
    plant("table-4-1", table(CELLS))
    assert networks.slope().value == pytest.approx(0.25)  # medians of sizes .2, .02, .25


@pytest.mark.parametrize(
    "order, share", [([21, 11, 41], 1.0), ([11, 21, 41], 0.0), ([[21, 11], 41], 1.0)]
)
def test_orders_that_no_draw_can_change(plant, order, share):
    cells = {w: cell([1], list(np.array([1, 1.1, 1.2]) * f)) for w, f in zip(WINDOWS, (2, 1, 4))}
    plant("table-4-1", table(cells))
    assert networks.share_in_order("test", order).value == share


def test_orders_that_half_of_the_draws_change(plant):
    """Two cells alike: each order comes out in a half of the draws, less the ties."""
    same = list(np.linspace(1, 2, 31))
    plant("table-4-1", table({11: cell([1], same), 21: cell([1], same), 41: cell([1], [9.0] * 31)}))
    up, down = (networks.share_in_order("test", [*o, 41]).value for o in ((11, 21), (21, 11)))
    assert up == pytest.approx(0.47, abs=0.05) and down == pytest.approx(0.47, abs=0.05)
    assert 0.8 < up + down < 1


def test_largest_weights(plant):
    cells = {w: cell([1], [1], **{"largest weight": [w, 1.0, 9.0 * w]}) for w in WINDOWS}
    plant("table-4-1", table(cells))
    assert networks.largest_weight(21).value == pytest.approx(21.0)


def test_sizes_from_three_to_eighty_one(plant):
    rows = [
        {"width": w, "training": [a, 9 * a, a], "test": [b, b, 9.0]}
        for w, a, b in ((3, 0.9, 0.8), (11, 0.5, 0.3), (21, 0.6, 0.2), (41, 0.4, 0.5))
    ]
    plant("window-sizes", {"rows": rows})
    assert networks.best_window().value == 21
    assert networks.best_window().text == "21 samples (0.20)"
    assert networks.training_error_falls().value == pytest.approx(2 / 3)
    assert networks.training_error_falls().text.startswith("2 of 3 steps")


def test_memory_is_of_one_window(plant):
    plant("memory", {"rows": [{"width": w, "training": [w, w, 1.0]} for w in (11, 21)]})
    assert networks.memory(21).value == 21


def test_multiplications_and_weights_by_hand():
    """21 samples of two joints to 10 hidden and 2 output units, 20 between; no biases."""
    count = 42 * 10 + 42 * 2 + 10 * 2
    assert networks.multiplications(21).value == count * 5 * 300
    assert networks.weights_against_nwh(21).value == pytest.approx(count / (2 * 21 * 10))


# --- windows: costs, courses, comparisons ------------------------------------------------------


def test_networks_have_two_paths():
    found = of_windows.paths(11)
    assert found.value is True
    assert found.text == "220 weights into hidden units, 20 from them, 44 direct ones at window 11"


def test_growth_when_something_doubles():
    def count(joints, width, hidden):  # with as many outputs as joints
        return joints * width * (hidden + joints) + hidden * joints

    base = count(2, 21, 10)
    ratios = [
        count(2, 41, 10) / (41 / 21 * base), count(2, 21, 20) / (2 * base),
        count(4, 21, 10) / (2 * base),
    ]  # fmt: skip
    found = of_windows.growth(21)
    assert found.value == pytest.approx(max(ratios, key=lambda r: abs(np.log(r))))
    for ratio in ratios:
        assert f"{ratio:.2f} for" in found.text


def test_sigmoids_are_few():
    assert of_windows.sigmoids(11).value == pytest.approx((22 * 10 + 32 * 2) / 12)


def test_what_clean_data_change(plant):
    cells = {w: cell([1], [1], **{"largest weight": [2.0, 4.0, 1000.0]}) for w in WINDOWS}
    clean = {str(w): {"largest weight": [2 * f, 4 * f]} for w, f in zip(WINDOWS, (1.1, 0.7, 1.2))}
    plant("table-4-1", table(cells))
    plant("clean", {"windows": clean})
    found = of_windows.without_noise()
    assert found.value == pytest.approx(0.3)
    assert found.text.endswith("1.1 at 11, 0.70 at 21, 1.2 at 41")


def test_hidden_units_furthest_from_one(plant):
    rows = [(10, [1.0, 1.0, 8.0]), (20, [0.5, 0.5, 9.0]), (40, [1.5, 1.5, 0.1])]
    plant("hidden-units", {"rows": [{"units": n, "test": e} for n, e in rows]})
    found = of_windows.more_hidden_units()
    assert found.value == pytest.approx(0.5)
    assert found.text == "test: 1.0 with 10, 0.50 with 20, 1.5 with 40"


def test_courses_that_fall(plant):
    histories = {
        "11": {"history": {"training": [[3, 2, 1], [3, 4, 1]]}},
        "21": {"history": {"training": [[3, 2, 1], [1, 1, 0.5]]}},
    }
    plant("longer", {"windows": histories})
    found = of_windows.training_is_monotone()
    assert found.value == pytest.approx(0.75)
    assert found.text == "falls at 75 %, 75 % of the records"


def test_tests_that_rise_again(plant):
    best = {"best test": [1.0, 1.0, 1.0, 1.0]}
    last = ([1.0, 1.04, 1.06, 2.0], [1.0] * 4, [1.1] * 4)
    plant("table-4-1", table({w: cell([1], e, **best) for w, e in zip(WINDOWS, last)}))
    found = of_windows.rises_again()
    assert found.value == pytest.approx(0.5)
    assert found.text == "2 of 4 at 11, 0 of 4 at 21, 4 of 4 at 41"
    assert of_windows.rises_again(1.5).value == pytest.approx(1 / 12)


def test_short_windows_see_less_acceleration(plant):
    rows = [{"width": w, "acceleration error": e} for w, e in ((11, 0.6), (21, 0.2), (41, 0.1))]
    plant("window-sizes", {"rows": rows})
    found = of_windows.short_window()
    assert found.value == pytest.approx(3.0)
    assert found.text == "0.60 at 11, 0.20 at 21"


def test_weights_fall_as_filters_do(plant):
    """Weights that are the filters' largest taps fall as they do; others in proportion."""

    def largest(width):
        x = np.arange(width) - width // 2
        parabola = np.linalg.pinv(np.vander(x * LOG_STEP, 3))[0] * 2  # second derivative
        return np.abs(parabola).max()

    sizes = {w: [largest(w) * f] * 3 for w, f in zip(WINDOWS, (1, 1, 0.5))}
    plant(
        "table-4-1", table({w: cell([1], [1], **{"largest weight": s}) for w, s in sizes.items()})
    )
    assert of_windows.magnitudes().value == pytest.approx(0.5, rel=1e-6)
    assert of_windows.magnitudes(11, 21).value == pytest.approx(1.0, rel=1e-6)


def test_scaling_leaves_the_error():
    assert of_windows.scaling().value < 1e-12


def test_the_best_of_momentum_and_step_size(monkeypatch):
    best = {0.0: 0.8, STATE_FEEDBACK.momentum: 0.2}
    monkeypatch.setattr(of_windows, "_momentum_errors", lambda *_: best)
    found = of_windows.acceleration()
    assert found.value == pytest.approx(4.0)
    assert found.text == "0.80 without, 0.20 with it after 2,000 epochs"


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

    def windows(run, width):
        half = width // 2
        return np.stack([q[k - half : k + half + 1].T for k in range(40, 340)]), None

    monkeypatch.setattr(of_windows, "cases", windows)
    taps = np.arange(-10, 11) * LOG_STEP
    gain = savitzky_golay(21, order, LOG_STEP, degree=max(order, 2)) @ np.exp(1j * omega * taps)
    wanted = abs(gain / (1j * omega) ** order - 1)
    found = of_windows.estimates([order], [21])
    # the true derivative of higher order is itself taken by differences
    assert found.value == pytest.approx(wanted, rel=0.02, abs=0.003)
    assert of_windows.estimates([order], [5, 21]).value <= found.value * 1.0001


# --- weights as filters ------------------------------------------------------------------------


def mix(width, *parts):
    """A filter with these shares of energy along position, velocity, acceleration and jerk."""
    return np.sqrt(np.array(parts)) @ basis(width)[: len(parts)]


def test_explained_energy_is_the_least_of_the_medians(plant_filters):
    plant_filters(
        skip={
            11: np.array([mix(11, 0.2, 0.3, 0.4, 0.1), mix(11, 0, 0, 0, 1), mix(11, 1)]),
            21: np.array([mix(21, 0.5, 0.2, 0.1, 0.2)] * 2),
            41: np.array([mix(41, 0, 0, 1)] * 3),
        }
    )
    found = weights.explained("skip")
    assert found.value == pytest.approx(0.8)
    assert found.text == "90 % at 11, 80 % at 21, 100 % at 41 of the energy"


def test_middle_between_two_crossings(plant_filters):
    x = np.arange(-10.0, 11)
    parabolas = [(x - s) ** 2 - 9.3 for s in (0.0, 0.4, 0.6, -0.7)]  # crossings at s ± 3.05
    plant_filters(skip={21: np.array([*parabolas, x - 0.5, x**3 - 20 * x + 3])})
    found = weights.asymmetric(21)
    assert found.value == pytest.approx(0.5)
    assert found.text == "2 of 4 filters with two crossings"
    assert weights.asymmetric(21, 0.3).value == pytest.approx(0.75)
    # straight between its samples, a parabola has its middle where it has
    plant_filters(skip={21: np.array([(x - 0.5) ** 2 - 9.3])})
    assert weights.asymmetric(21, 0.499).value == 1 and weights.asymmetric(21, 0.501).value == 0


def test_filters_that_control_theory_uses(plant_filters):
    pure = {k: np.eye(4)[k] for k in range(4)}
    hidden = [mix(21, *pure[k]) for k in (1, 2, 3)] + [mix(21, 0, 0.5, 0.5)]
    plant_filters(hidden={21: np.array(hidden)}, skip={21: np.array([mix(21, *pure[3])])})
    found = weights.interpretable(21)
    assert found.value == pytest.approx(3 / 5)
    assert found.text == "3 of 4 hidden, 0 of 1 direct filters"


def test_classes_of_a_layer(plant_filters):
    found = np.array([mix(41, 0, 1), mix(41, 0, 0, 1), mix(41, 0, 0, 1), mix(41, 0, 0, 0, 1)])
    plant_filters(hidden={41: found}, skip={41: found[:1]})
    assert filters.of_class(41, "acceleration").value == 0.5
    assert filters.of_class(41, "acceleration").text == "2 of 4 filters"
    assert filters.of_class(41, "velocity", "skip").value == 1.0


def alternating(width, share):
    """Straight line and an alternating part with this share of the energy about the mean."""
    line = np.linspace(-1, 1, width)
    sign = (-1.0) ** np.arange(width)
    sign -= sign.mean() + line * (sign @ line) / (line @ line)
    return np.sqrt(1 - share) * line / np.linalg.norm(line) + np.sqrt(
        share
    ) * sign / np.linalg.norm(sign)


def by_hand(f):
    """Roughness from its definition: six times a white noise's variance is its reference."""
    second = f[2:] - 2 * f[1:-1] + f[:-2]
    return (second**2).mean() / (6 * f.var())


def test_roughness_of_wide_over_narrow(plant_filters):
    rough = {w: np.array([alternating(w, s) for s in p]) for w, p in
             ((11, (0.2, 0.2)), (21, (0.1, 0.1, 0.5)), (41, (0.3, 0.01, 0.3)))}  # fmt: skip
    plant_filters(hidden=rough, skip=rough)
    found = filters.rougher()
    assert found.value == pytest.approx(by_hand(rough[41][0]) / by_hand(rough[21][0]))
    middle = {w: np.median([by_hand(f) for f in rough[w]]) for w in rough}
    assert filters.direct_smoothness().value == pytest.approx(max(middle.values()))
    assert max(middle.values()) == middle[41]


def test_what_training_adds(monkeypatch):
    """The course keeps all weights; what counts is the last less the first."""
    first = np.random.default_rng(0).normal(size=(2, 3, 2, 21))
    added = np.broadcast_to(alternating(21, 0.4), first.shape)
    hidden = np.stack([first, first * 7, first + added])
    model = SimpleNamespace(weights=SimpleNamespace(hidden_weights=hidden))
    monkeypatch.setattr(results, "course", lambda width: (np.arange(3), model))
    assert filters.changed_roughness(21).value == pytest.approx(by_hand(alternating(21, 0.4)))


def test_shares_of_the_constant(plant_filters):
    found = np.array([mix(21, s, 1 - s) for s in (0.1, 0.3, 0.9)])
    plant_filters(hidden={21: found}, skip={21: found[:1]})
    assert filters.constant_share().value == pytest.approx(0.3)
    assert filters.constant_share().text == "30.0 % of the energy"
    assert filters.constant_share("skip").value == pytest.approx(0.1)


def test_printed_parts_are_not_odd(plant_filters):
    """The constant c is taken from the odd part o: then o(x) + o(-x) is -2 c."""
    line = np.linspace(-1, 1, 21)
    functions = np.array([3 * line + c for c in (0.5, 1.0, -2.0)])
    plant_filters(hidden={21: functions})
    found = filters.parts_sum_up()
    assert found.value == pytest.approx(2 * 1 / (3 + 1))  # of 1/3.5, 2/4, 4/5
    assert "reaches 50 % of odd's peak" in found.text
    assert float(found.text.split("(to ")[1].split(")")[0]) < 1e-14


def test_crossings_of_odd_parts(plant_filters):
    x = np.arange(-20.0, 21)
    cubic, line = x**3 - 100 * x, x
    late = x**3 - 19.5**2 * x  # crosses at the edge
    rough = np.where(np.abs(x) % 2 == 0, 1.0, -1.0) * np.sign(x)
    plant_filters(hidden={41: np.array([cubic, line, line + x**2, late, rough])})
    found = filters.zero_crossings()
    assert found.value == pytest.approx(0.5)
    assert found.text == "2 of 4 smooth filters"


def test_structure_beyond_chance(plant_filters):
    found = np.array([mix(21, 0, 1)] * 3 + [alternating(21, 0.99)])
    plant_filters(hidden={21: found})
    chance = weights.untrained(21).value
    assert filters.structured(21).value == pytest.approx(0.75 - (1 - chance))
    assert 0.5 < chance <= 1


def test_random_filters_are_not_analysable():
    """White noise puts 4 of 41 parts into a cubic, of which 3 vary: far below 80 %."""
    found = weights.untrained(41)
    assert found.value == 1.0 and found.text == "500 of 500 random functions"
    short = weights.untrained(5)  # three of four varying parts: often enough
    assert 0.1 < short.value < 0.9 and short.text.endswith("of 500 random functions")


# --- the network of states -----------------------------------------------------------------------


def test_rows_of_table_6_1(plant):
    errors = {
        "random set A": {"own deviation": [0.1, 0.2, 0.4], "other": [1.0, 1.0, 3.0]},
        "random set B": {"own deviation": [0.3, 0.2, 0.4], "other": [2.0, 2.0, 2.0]},
    }
    plant(
        "table-6-1",
        {"errors": errors, "largest weight": [5.0, 1.0, 9.0], "slope": [-0.3, 0.1, 0.2]},
    )
    assert state_space.table_6_1("random set A").value == pytest.approx(0.2)
    assert state_space.table_6_1("random set B", "other").value == pytest.approx(2.0)
    assert state_space.largest_weight().value == 5.0
    assert state_space.slope().value == pytest.approx(0.2)
    assert state_space.generalisation().value == pytest.approx(1.0)  # of 3, 1 and 1


def test_the_best_number_of_units(plant):
    rows = [(10, [0.3, 0.2, 0.9]), (20, [0.1, 0.2, 0.15]), (40, [0.4, 0.4, 0.01])]
    units = [{"units": n, "solver": {"test": e}} for n, e in rows] + [{"units": 80, "solver": None}]
    plant("state-space-sizes", {"units": units, "solver's samples in units": 12_000})
    found = state_space.best_of_sizes()
    assert found.value == pytest.approx(0.15)
    assert found.text.endswith("with 20 units, 12,000 samples")


# --- courses of training ---------------------------------------------------------------------


def test_the_change_of_the_second_half(monkeypatch):
    epochs = np.array([0, 9_000, 10_100, 20_000, 30_000])

    def part(*shape):
        half, last = np.full(shape, 3.0), np.full(shape, 4.0)
        return np.stack([last * 0, half * 5, half, last, half * 9])

    shapes = {
        "hidden_weights": (2, 3, 2, 5), "hidden_bias": (2, 3), "output_weights": (2, 2, 3),
        "skip_weights": (2, 2, 2, 5), "output_bias": (2, 2),
    }  # fmt: skip
    model = SimpleNamespace(weights=SimpleNamespace(**{k: part(*s) for k, s in shapes.items()}))
    monkeypatch.setattr(results, "course", lambda width: (epochs, model))
    found = backpropagation.stable(21)
    assert found.value == pytest.approx(0.25)
    assert found.text == "25 % from epoch 10,100 to 20,000"


@pytest.mark.parametrize(
    "power, flat_from, words",
    [((-0.5, -0.05), 1000, "epochs: "), ((-0.5, -0.5), 10_000, "epochs: over ")],
)
def test_errors_settle_where_their_power_law_bends(plant, power, flat_from, words):
    epochs = np.unique(np.round(np.geomspace(10, 10_000, 31))).astype(int)
    early, late = power
    error = np.where(epochs < 1000, (epochs / 1000.0) ** early, (epochs / 1000.0) ** late)
    history = {"epochs": epochs.tolist(), "training": [error.tolist()] * 3}
    plant("longer", {"windows": {"11": {"history": history}, "21": {"history": history}}})
    found = backpropagation.settling()
    assert flat_from <= found.value <= 2.2 * flat_from
    value = f"{found.value:,.0f}"
    assert found.text == f"{words}{value}, {words.removeprefix('epochs: ')}{value}"


def test_when_errors_reach_a_level():
    from ddlib.training import History

    errors = np.array([[1.0, 0.5, 3.0], [0.8, 0.4, 2.0], [0.6, 0.3, 1.0]])
    history = History(np.array([10, 20, 40]), errors, None)
    np.testing.assert_allclose(backpropagation.reach(history, 0.75), [25.0, 10.0, np.inf])
    np.testing.assert_allclose(backpropagation.reach(history, 0.9), [15.0, 10.0, np.inf])
