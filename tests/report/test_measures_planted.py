"""Measures of committed results and networks, on planted ones with answers known by hand."""

import re
from types import SimpleNamespace

import numpy as np
import pytest

from ddlib.analysis import basis, savitzky_golay
from ddlib.learning import History
from ddlib.setups import WINDOWS
from ddlib.simulation import LOG_STEP
from ddlib.tables import significant
from workshop.report import committed, results
from workshop.report.measures import backpropagation, filters, networks
from workshop.report.measures import windows as of_windows

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
    """``plant_filters(trained, before)`` in place of weights, ``{layer: {width: filters}}``.

    Every filter is a network's only one.
    """

    def put(trained, before=None):
        def read(width, layer, model=committed.networks, setup=STATE):
            from_ = before if model is committed.untrained else trained
            return np.asarray((from_ or trained)[layer][width])[:, None]

        monkeypatch.setattr(committed, "filters", read)

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
    "order, holds", [([21, 11, 41], True), ([11, 21, 41], False), ([[21, 11], 41], True)]
)
def test_orders_that_no_draw_can_change(plant, order, holds):
    cells = {w: cell([1], list(np.array([1, 1.1, 1.2]) * f)) for w, f in zip(WINDOWS, (2, 1, 4))}
    plant("table-4-1", table(cells))
    found = networks.in_order("test", order)
    assert found.value is holds and (found.replicates == holds).all()
    assert found.text == f"medians 2.2, 1.1, 4.4; in {100 * holds} % of draws"


def test_orders_that_half_of_the_draws_change(plant):
    """Two cells alike: each order comes out in a half of the draws, less the ties."""
    same = list(np.linspace(1, 2, 31))
    plant("table-4-1", table({11: cell([1], same), 21: cell([1], same), 41: cell([1], [9.0] * 31)}))
    orders = [networks.in_order("test", [*o, 41]) for o in ((11, 21), (21, 11))]
    assert [found.value for found in orders] == [False, False]  # equal is not in order
    up, down = (found.replicates.mean() for found in orders)
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
    row = {"largest weight": [2.0, 3.0, 4.0]}
    plant("memory", {"rows": [{"width": w, "training": [w, w, 1.0], **row} for w in (11, 21)]})
    assert networks.memory(21).value == 21


def test_multiplications_and_weights_by_hand():
    """21 samples of two joints to 10 hidden and 2 output units, 20 between; no biases."""
    count = 42 * 10 + 42 * 2 + 10 * 2
    assert networks.multiplications(21).value == count * 5 * 300
    assert networks.weights_against_nwh([21]).value == pytest.approx(count / (2 * 21 * 10))
    found = networks.weights_against_nwh()
    assert found.value == pytest.approx(1.2 + 1 / 11)  # n w h and direct weights, 20 more
    assert (
        found.text == "weights for n w h: 284 for 220 at 11, 524 for 420 at 21, 1004 for 820 at 41"
    )


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
    assert found.text == "falls at 75 %, 75 % of the records: 0.750 of all, 1.00 at 1 record in 2"


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
    fall = largest(41) / largest(21)
    found = of_windows.magnitudes()
    assert found.value == pytest.approx(fall / 2, rel=1e-6)
    assert found.text == f"{fall / 2:.2g} of the weight at 21, the filter {fall:.2g}"
    assert of_windows.magnitudes(11, 21).value == pytest.approx(largest(21) / largest(11), rel=1e-6)
    beside = of_windows.magnitudes(beside_filters=True)
    assert beside.value == pytest.approx(0.5, rel=1e-6)
    assert beside.text == f"0.50 times the filter's ratio, as printed {4.2 / 11.7 / fall:.2g} times"


def test_the_largest_tap_may_be_a_negative_one(plant):
    """Three samples have the taps 1, -2, 1 over the step squared; 41 their largest at the ends."""
    cells = {str(w): {"largest weight": [1.0, 1.0]} for w in (3, 41)}
    plant("table-4-1", {"setups": {STATE: cells}})
    x = np.arange(-20, 21)
    parabola = x**2 - (x**2).mean()
    ends = 2 * parabola[0] / (parabola**2).sum()
    assert of_windows.magnitudes(3, 41).text.endswith(f"the filter {significant(ends / 2, 2)}")


def test_scaling_leaves_the_error():
    assert of_windows.scaling().value < 1e-12


def test_the_best_of_momentum_and_step_size(plant):
    """Three networks at two step sizes: medians .8 and .9 without, .5 and .2 with momentum.

    At the other window it is .8 without and .4 with, and that one is judged.
    """
    without = np.array([[0.8, 0.9], [0.7, 0.9], [2.0, 0.1]])
    with_it = np.array([[0.5, 0.2], [0.1, 0.2], [2.0, 0.2]])
    errors = {
        "11": {"without": without.tolist(), "with": with_it.tolist()},
        "21": {"without": without.tolist(), "with": (0 * with_it + 0.4).tolist()},
    }
    plant("acceleration", {"errors": errors, "epochs": 2000})
    found = of_windows.acceleration()
    assert found.value == pytest.approx(2.0)
    assert found.text == (
        "with and without: 0.20 and 0.80 at window 11, 0.40 and 0.80 at window 21, "
        "after 2,000 epochs"
    )


def test_cells_that_are_not_accurate(plant):
    cells = {w: cell([1], [e, e, 9.0]) for w, e in zip(WINDOWS, (0.02, 0.005, 0.2))}
    plant("table-4-1", table(cells))
    found = of_windows.accurate()
    assert found.value == pytest.approx(2.0)
    assert found.text == (
        "RMSS 0.0050 to 2.0; above 0.1 are 3 of 6 cells: "
        "state feedback 41: 0.20, position feedback 11: 0.20, position feedback 41: 2.0"
    )
    assert "above 0.01 are 5 of 6 cells" in of_windows.accurate(0.01).text
    assert of_windows.accurate(0.2).text.endswith(
        "above 0.2 are 1 of 6 cells: position feedback 41: 2.0"
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
    trained = {
        11: [mix(11, 0.2, 0.3, 0.4, 0.1), mix(11, 0, 0, 0, 1), mix(11, 1)],
        21: [mix(21, 0.5, 0.2, 0.1, 0.2)] * 2,
        41: [mix(41, 0, 0, 1)] * 3,
    }
    before = {w: [mix(w, 0.1, 0.1, s, 0.8 - s)] for w, s in ((11, 0.1), (21, 0.3), (41, 0.2))}
    plant_filters({"direct": trained}, {"direct": before})
    found = networks.explained("direct")
    assert found.value == pytest.approx(0.8)
    assert found.text == (
        "90 % at 11, 80 % at 21, 100 % at 41 of the energy; before training at most 50 %"
    )


def test_middle_between_two_crossings(plant_filters):
    x = np.arange(-10.0, 11)
    parabolas = [(x - s) ** 2 - 9.3 for s in (0.0, 0.4, 0.6, -0.7)]  # crossings at s ± 3.05
    trained = [*parabolas, x - 0.5, x**3 - 20 * x + 3]
    plant_filters({"direct": {21: trained}}, {"direct": {21: [x - 0.3, *parabolas[:2]]}})
    found = networks.asymmetric(21)
    assert found.value == pytest.approx(0.5)
    assert found.text == "2 of 4 filters with two crossings; before training 2 have two"
    assert networks.asymmetric(21, 0.3).value == pytest.approx(0.75)
    # the crossings are between samples: a parabola has its middle where it has
    plant_filters({"direct": {21: [(x - 0.5) ** 2 - 9.3]}})
    assert networks.asymmetric(21, 0.499).value == 1 and networks.asymmetric(21, 0.501).value == 0


def pure(width, *derivatives):
    return [mix(width, *np.eye(4)[k]) for k in derivatives]


def test_classes_of_a_layer(plant_filters):
    trained = {"hidden": {41: pure(41, 1, 2, 2, 3)}, "direct": {41: pure(41, 1)}}
    before = {"hidden": {41: pure(41, 1, 3, 3, 2)}, "direct": {41: pure(41, 3)}}
    plant_filters(trained, before)
    found = filters.of_class(41, "acceleration")
    assert found.value == pytest.approx(0.25)
    assert found.text == "2 of 4 filters, 1 before training"
    assert filters.of_class(41, "velocity", "direct").value == 1.0


def alternating(width, share):
    """Straight line and an alternating part with this share of the energy about the mean."""
    line = np.linspace(-1, 1, width)
    sign = (-1.0) ** np.arange(width)
    sign -= sign.mean() + line * (sign @ line) / (line @ line)
    line, sign = (part / np.linalg.norm(part) for part in (line, sign))
    return np.sqrt(1 - share) * line + np.sqrt(share) * sign


def by_hand(f):
    """Roughness from its definition: six times a white noise's variance is its reference."""
    second = f[2:] - 2 * f[1:-1] + f[:-2]
    return (second**2).mean() / (6 * f.var())


ROUGH = {
    w: [alternating(w, share) for share in of]
    for w, of in ((11, (0.02, 0.02)), (21, (0.1, 0.1, 0.5)), (41, (0.3, 0.01, 0.3)))
}


def test_roughness_of_wide_over_narrow(plant_filters):
    plant_filters({"hidden": ROUGH}, {"hidden": {w: f[:1] * 3 for w, f in ROUGH.items()}})
    found = filters.rougher()
    assert found.value == pytest.approx(by_hand(ROUGH[41][0]) / by_hand(ROUGH[21][0]))
    wide, narrow = (f"{by_hand(ROUGH[w][0]):.2f}" for w in (41, 21))
    words = f"roughness {wide} at 41, {narrow} at 21; before training {wide} and {narrow}"
    assert found.text == words


def test_the_roughest_of_three_windows(plant_filters):
    plant_filters({"direct": ROUGH})
    middle = {w: np.median([by_hand(f) for f in ROUGH[w]]) for w in ROUGH}
    found = filters.direct_smoothness()
    assert found.value == pytest.approx(middle[41]) and middle[41] == max(middle.values())


def test_what_training_adds(plant_filters):
    first = np.random.default_rng(0).normal(size=(3, 41))
    added = alternating(41, 0.4)
    plant_filters({"hidden": {41: first + added}}, {"hidden": {41: first}})
    assert filters.changed_roughness().value == pytest.approx(by_hand(added))


def test_shares_of_the_constant(plant_filters):
    trained = [mix(21, s, 1 - s) for s in (0.1, 0.3, 0.9)]
    before = [mix(21, s, 1 - s) for s in (0.2, 0.25, 0.9)]
    plant_filters(
        {"hidden": {21: trained}, "direct": {21: trained[:1]}},
        {"hidden": {21: before}, "direct": {21: before}},
    )
    found = filters.constant_share()
    assert found.value == pytest.approx(0.3)
    assert found.text == "30.0 % of the energy, 25.0 % before training"
    assert filters.constant_share("direct").value == pytest.approx(0.1)


def test_printed_parts_are_not_odd(plant_filters):
    """The constant c is taken from the odd part o: then o(x) + o(-x) is -2 c."""
    line = np.linspace(-1, 1, 21)
    plant_filters({"hidden": {21: [3 * line + c for c in (0.5, 1.0, -2.0)]}})
    found = filters.parts_sum_up()
    assert found.value == pytest.approx(2 * 1 / (3 + 1))  # of 1/3.5, 2/4, 4/5
    assert "reaches 50 % of odd's peak" in found.text
    assert re.match(r"the parts sum to f \(to (0|\d · 10⁻¹[⁴⁵⁶⁷⁸⁹])\)", found.text)


def test_what_is_left_at_the_wide_window(plant_filters):
    """Noise is not analysable, an acceleration filter is; before training all is noise."""
    noise = np.random.default_rng(0).normal(size=(4, 41))

    def some(width, rough):
        clean = savitzky_golay(width, 2, LOG_STEP, degree=2)
        return [*noise[:rough, :width], *[clean] * (4 - rough)]

    before = {"hidden": {w: noise[:, :w] for w in (21, 41)}}
    for wide, share in ((3, 0.75), (1, 0.25), (0, 0.0)):
        plant_filters({"hidden": {21: some(21, 1), 41: some(41, wide)}}, before)
        found = filters.not_analysable()
        assert found.value == pytest.approx(share)
        assert found.text == f"{wide} of 4 at 41, 1 of 4 at 21; before training 100 %"


def test_readings_are_told_apart(plant):
    cells = {w: cell([1], [2], **{"largest weight": [w]}) for w in WINDOWS}
    plant("table-4-1", table(cells))
    assert networks.largest_weight(21, POSITION).value == pytest.approx(210.0)


@pytest.mark.parametrize("setup", [STATE, POSITION])
def test_filters_are_of_the_reading_asked_for(monkeypatch, setup):
    asked = []
    model = SimpleNamespace(weights=SimpleNamespace(hidden_weights=np.ones((2, 10, 2, 21))))
    monkeypatch.setattr(results, "networks", lambda *a: asked.append(a) or model)
    committed.networks.cache_clear()
    assert committed.filters(21, "hidden", setup=setup).shape == (2, 20, 21)
    committed.networks.cache_clear()
    assert asked == [(21, setup)]


def test_random_filters_are_not_analysable():
    """White noise puts 4 of 41 parts into a cubic, of which 3 vary: far below 80 %."""
    found = networks.untrained(41)
    assert found.value == 1.0 and found.text == "500 of 500 random functions"
    short = networks.untrained(5)  # three of four varying parts: often enough
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
    assert networks.table_6_1("random set A").value == pytest.approx(0.2)
    assert networks.table_6_1("random set B", "other").value == pytest.approx(2.0)
    assert networks.largest_state_weight().value == 5.0
    assert networks.state_slope().value == pytest.approx(0.2)
    assert networks.generalisation().value == pytest.approx(1.0)  # of 3, 1 and 1


def test_the_best_number_of_units(plant):
    rows = [(10, [0.3, 0.2, 0.9]), (20, [0.1, 0.3, 0.15]), (40, [0.4, 0.4, 0.01])]
    units = [{"units": n, "solver": {"test": e}} for n, e in rows] + [{"units": 80, "solver": None}]
    plant("state-space-sizes", {"units": units, "solver's samples in units": 12_000})
    found = networks.best_of_sizes()
    assert found.value == pytest.approx(0.15) and found.replicates is None
    assert found.text.endswith("with 20 units, 12,000 samples")


# --- courses of training ---------------------------------------------------------------------


def test_the_change_of_the_second_half(monkeypatch):
    epochs = np.array([0, 9_000, 10_100, 20_000, 30_000])

    def part(*shape):
        half, last = np.full(shape, 3.0), np.full(shape, 4.0)
        return np.stack([last * 0, half * 5, half, last, half * 9])

    shapes = {
        "hidden_weights": (2, 3, 2, 5), "hidden_bias": (2, 3), "output_weights": (2, 2, 3),
        "direct_weights": (2, 2, 2, 5), "output_bias": (2, 2),
    }  # fmt: skip
    model = SimpleNamespace(weights=SimpleNamespace(**{k: part(*s) for k, s in shapes.items()}))
    still = {k: np.repeat(v[-2:-1], 5, axis=0) for k, v in vars(model.weights).items()}
    still = SimpleNamespace(weights=SimpleNamespace(**still))
    models = {11: still, 21: model, 41: still}
    monkeypatch.setattr(results, "course", lambda width: (epochs, models[width]))
    found = backpropagation.stable()
    assert found.value == pytest.approx(0.25) and found.replicates is None
    assert found.text == "0 % at 11, 25 % at 21, 0 % at 41, from epoch 10,100 to 20,000"


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


def race(length, reached):
    """Errors that fall on a straight line to 0.75 at these epochs."""
    epochs = np.array([0.0, length])
    training = 1.0 - 0.25 * epochs[:, None] / np.array(reached, float)
    return {"epochs": epochs.tolist(), "training": training.tolist()}


@pytest.mark.parametrize("late, wanted", [(9e9, 1000), (200.0, 200)])
def test_speed_ups_here_and_elsewhere(plant, late, wanted):
    """Medians: 800 over that of the later two, or the length of the run; 600 over 60 there."""
    runs = {"without": race(9000, [600, 800, 8000]), "with": race(1000, [late, late, 160])}
    parity = {"without": [4400, 600, 500], "with": [70, 60, 50]}
    plant("acceleration", {"race": runs, "parity": parity, "bits": 3})
    found = backpropagation.acceleration()
    assert found.value == pytest.approx(800 / wanted / 10)
    faster = significant(800 / wanted, 2)
    assert found.text == f"{faster} times faster here, 10 times on parity of 3 bits"


def test_when_errors_reach_a_level():
    errors = np.array([[1.0, 0.5, 3.0], [0.8, 0.4, 2.0], [0.6, 0.3, 1.0]])
    history = History(np.array([10, 20, 40]), errors, None)
    np.testing.assert_allclose(backpropagation.reach(history, 0.75), [25.0, 10.0, np.inf])
    np.testing.assert_allclose(backpropagation.reach(history, 0.9), [15.0, 10.0, np.inf])
