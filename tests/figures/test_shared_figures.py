"""Figures that chapters share: what is drawn are the data that were given."""

import figure_examples as given
import numpy as np
import pytest
from figure_examples import T, X, made
from pictures import curves, words

from ddlib import figures
from ddlib.figures import COLOURS, INK


def test_curves_go_where_the_data_goes():
    """And the same curve looks the same in every panel."""
    _, figure = made("curves")
    first, second, none = (curves(figure, colour) for colour in COLOURS[:3])
    for line, data in zip([*first, *second], ((X, X), (X, X**2), (X[1:], 1 / X[1:])), strict=True):
        np.testing.assert_array_equal(line, np.stack(data, -1))
    assert not none
    assert {axis.get_xscale() for axis in figure.axes} == {"log"}
    assert {axis.get_yscale() for axis in figure.axes} == {"log"}


@pytest.mark.parametrize("count, columns", [(1, 2), (3, 2), (2, 3)])
def test_curves_label_every_bottom_axis(count, columns):
    panels = {f"panel {k}": {"a": T} for k in range(count)}
    texts = words(figures.curves(T, panels, "the common axis", "Panels.", columns=columns))
    assert texts.count("the common axis") == min(count, columns)
    assert all(texts.count(label) == 1 for label in panels)


def test_every_network_is_fine_and_the_median_bold():
    _, figure = made("families")
    left, right = figure.axes
    *fine, median = left.lines
    for line, values in zip([*fine, median], [*given.FAN.T, 2 * X], strict=True):
        np.testing.assert_array_equal(line.get_xydata(), np.stack([X, values], -1))
    assert median.get_linewidth() > max(line.get_linewidth() for line in fine)
    assert [line.get_color() for line in right.lines] == [COLOURS[1]] * 4 + [COLOURS[0]] * 4
    assert {axis.get_yscale() for axis in figure.axes} == {"log"}


def test_each_case_has_a_title_and_the_quantity_on_its_axis():
    picture, figure = made("by_case")
    texts = words(picture)
    assert [text for text in texts if text in given.CASES] == list(given.CASES)
    assert texts.count("error, °") == 3 and texts.count("time, s") == 1
    for swing, values in zip(curves(figure, COLOURS[0]), given.CASES.values(), strict=True):
        np.testing.assert_array_equal(swing, np.stack([X, values], -1))


def test_table_4_1_has_every_network_medians_and_printed_values():
    picture, figure = made("rmss_by_window")
    for axis, (column, printed) in zip(figure.axes, given.PRINTED.items(), strict=True):
        cells = [
            (k, v) for k, named in enumerate(given.TABLE.values()) for v in named[column].items()
        ]
        clouds = [line for line in axis.lines if line.get_marker() != "None"]
        bars = [line for line in axis.lines if line.get_color() == INK]
        for cloud, bar, (k, (window, errors)) in zip(clouds, bars, cells, strict=True):
            x, y = cloud.get_xydata().T
            np.testing.assert_array_equal(y, np.sort(errors))
            assert (np.abs(x - [11, 21, 41].index(window)) < 0.5).all()
            assert cloud.get_color() == COLOURS[k]
            assert set(bar.get_ydata()) == {np.median(errors)}
        dashed = [line.get_ydata()[0] for line in axis.lines if line.get_linestyle() == "--"]
        assert dashed == list(printed.values()) and axis.get_yscale() == "log"
    median = np.median(given.TABLE["one"]["test"][11])
    assert f"one, median test error 11: {median:.3f}" in picture.alt
    assert words(picture).count("printed") == 1


def test_a_network_has_its_layers():
    picture, _ = made("network_diagram")
    assert "2 times 21 inputs, 10 hidden units and 2 outputs" in picture.alt
    assert {"10 hidden", "direct", "weights", "shoulder:", "elbow:"} <= set(words(picture))


def test_parts_of_a_filter_make_it_up():
    picture, figure = made("decomposition")
    for axis, (title, weights) in zip(figure.axes, given.FILTERS.items(), strict=True):
        lines = {line.get_label(): line.get_ydata() for line in axis.lines}
        np.testing.assert_array_equal(lines["weights"], weights)
        constant = weights.mean()
        np.testing.assert_allclose(lines["even"], (weights + weights[::-1]) / 2 - constant)
        np.testing.assert_allclose(lines["odd"], (weights - weights[::-1]) / 2)
        np.testing.assert_allclose(lines["constant"], constant)
        np.testing.assert_allclose(axis.lines[0].get_xdata(), 10.0 * np.arange(-10, 11))  # ms
        assert title in picture.alt and axis.get_title(loc="left") == title


LABELS = "x, s", "error, m"


@pytest.mark.parametrize(
    "make, message",
    [
        (lambda: figures.curves(T, {"y": {"a": T}}, "x", " "), "alt must describe"),
        (lambda: figures.families({}, LABELS, "text"), "panels must hold one panel or more"),
        (lambda: figures.families({"": {"a": (X, X)}}, LABELS, "text"), "y of 'a' must have shape"),
        (
            lambda: figures.families({"": {"a": (X, given.FAN[:3])}}, LABELS, "text"),
            "y of 'a' must",
        ),
        (lambda: figures.families({"": {"a": (X, np.nan * given.FAN)}}, LABELS, "text"), "finite"),
        (lambda: figures.by_case(X, {}, *LABELS, "text"), "cases must hold one case or more"),
        (lambda: figures.by_case(X, given.CASES, "time, s", "elbow, °", "text"), "axis label must"),
        (
            lambda: figures.rmss_by_window({"one": {"test": {11: [0.1, 0.0]}}}, given.PRINTED),
            "errors of 'one' must be above 0",
        ),
        (lambda: figures.decomposition({"a": np.ones(10)}, 0.01), "f must have an odd"),
    ],
)
def test_refusals(make, message):
    with pytest.raises(ValueError, match=message):
        make()
