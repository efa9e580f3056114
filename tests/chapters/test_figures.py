"""All figures of the book: sound and accessible, and what is drawn are the data that were given."""

import re

import figure_examples as given
import numpy as np
import pytest
from figure_examples import EXAMPLES, SHOWN, T, X, fitted, made
from matplotlib.collections import QuadMesh
from pictures import black_or_white, check_sound, ids, shapes, words

from beyond.figures import maps
from ddlib import figures
from ddlib.dynamics import CMU_DD_ARM_II
from ddlib.figures import COLOURS, INK

UPON_A_COLOUR = {
    "ranking": "#000000", "hinton": "#ffffff", "hinton_states": "#ffffff",
    "decomposed": "#ffffff", "decomposed, one": "#ffffff",
    "maps": "#ffffff", "arm_sketch": "#ffffff",
}  # fmt: skip
"""What these paint black or white lies on a colour, or has an edge in the page's ink."""


LOGARITHMIC = {
    **dict.fromkeys(("curves", "side_by_side, log"), "xy"),
    **dict.fromkeys(("ladders", "growth", "against", "traded"), "xy"),
    **dict.fromkeys(("families", "rmss_by_window", "operations", "courses", "by_trial"), "y"),
    **dict.fromkeys(("ranking", "intervals", "by_motion", "dots"), "x"),
}


@pytest.mark.parametrize("name", EXAMPLES)
def test_sound_accessible_and_true_to_the_data(name):
    picture, figure = made(name)
    check_sound(picture)
    assert black_or_white(picture) <= {UPON_A_COLOUR.get(name)}
    assert len(picture.svg) < (400_000 if name == "hinton" else 150_000)
    for axis, wanted in zip(figure.axes, SHOWN.get(name, [])):
        drawn = shapes(axis)
        for points in map(np.asarray, wanted):
            same = [part for part in drawn if part.shape == points.shape]
            assert any(np.allclose(part, points, equal_nan=True) for part in same), points
        if "map" not in name:
            scales = {"x": axis.get_xscale(), "y": axis.get_yscale()}
            logarithmic = {side for side, scale in scales.items() if scale == "log"}
            assert logarithmic == set(LOGARITHMIC.get(name, ""))


def test_no_two_figures_share_an_id():
    every = [name for key in EXAMPLES for name in ids(made(key)[0].svg)]
    assert len(every) == len(set(every)) > 20


def test_table_4_1_has_every_network_medians_and_printed_values():
    _, figure = made("rmss_by_window")
    for axis, (column, printed) in zip(figure.axes, given.PRINTED.items(), strict=True):
        cells = [errors for named in given.TABLE.values() for errors in named[column].values()]
        clouds = [line for line in axis.lines if line.get_marker() != "None"]
        bars = [line for line in axis.lines if line.get_color() == INK]
        for k, (cloud, bar, errors) in enumerate(zip(clouds, bars, cells, strict=True)):
            np.testing.assert_array_equal(cloud.get_ydata(), np.sort(errors))
            assert (np.abs(cloud.get_xdata() - k % 3) < 0.5).all()  # three windows
            assert cloud.get_color() == COLOURS[k // 3] and set(bar.get_ydata()) == {
                np.median(errors)
            }
        dashed = [line.get_ydata()[0] for line in axis.lines if line.get_linestyle() == "--"]
        assert dashed == list(printed.values())


def test_maps_have_a_cell_for_every_value():
    """Stopped runs are masked; of several maps there is one scale of colours."""

    def cells(axis):
        return next(part for part in axis.collections if isinstance(part, QuadMesh))

    for axis, (title, values) in zip(made("maps")[1].axes, given.SQUARES.items()):
        assert axis.get_title(loc="left") == title
        np.testing.assert_array_equal(cells(axis).get_array(), values.T)
        assert (cells(axis).norm.vmin, cells(axis).norm.vmax) == (0.5, 9.0)
    np.testing.assert_array_equal(
        cells(made("stops_map")[1].axes[0]).get_array().mask, given.STOPPED
    )


def test_shares_stand_beside_repeated_estimates_only():
    picture, _ = made("estimates")
    shares = [text.removesuffix(" %") for text in words(picture) if re.fullmatch(r"\d+ %", text)]
    fair = 100 * fitted(100).covers([1.0, 2.0]).mean(0)
    assert shares == [f"{fair[0]:.0f}", "0", f"{fair[1]:.0f}", "0"]  # two panels
    assert "off: x 50, y 25" in picture.alt and "fair: x" in picture.alt


def test_bars_stand_in_order_and_are_as_long_as_their_torques():
    _, figure = made("ranking")
    (axis,) = figure.axes
    assert axis.get_xscale() == "log" and axis.yaxis_inverted()
    for j, container in enumerate(axis.containers):
        ends = [bar.get_x() + bar.get_width() for bar in container]
        wanted = [given.SIZES[name][j] for name in ("large", "middle", "small")]
        np.testing.assert_allclose(ends, wanted)
        assert (np.diff([bar.get_y() for bar in container]) > 0).all()


BAD = np.nan
ARM = CMU_DD_ARM_II
LABELS = "x, s", "error, m"
REFUSALS = [
    (figures.curves, (T, {"y": {"a": T}}, "x", " "), "alt must describe"),
    (figures.families, ({}, LABELS, "A."), "panels must hold one item or more"),
    (figures.families, ({"": {"a": (X, given.FAN[:3])}}, LABELS, "A."), "y of 'a' must"),
    (figures.by_case, (X, given.CASES, "time, s", "elbow, °", "A."), "axis label must"),
    (
        figures.rmss_by_window,
        ({"a": {"test": {11: [0.1, 0.0]}}}, given.PRINTED),
        "errors of 'a' must be",
    ),
    (figures.decomposed, ({"a": np.ones(10)}, 0.01), "functions must have an odd"),
    (figures.decomposed, (np.ones((2, 11)), 0.01), "functions must have shape"),
    (figures.decomposed, ({}, 0.01), "functions must hold one"),
    (figures.decomposed, (np.ones(11), 0.0), "step must"),
    (maps, (X[:2], {"a": -np.ones((2, 2))}, (), "A."), "errors of 'a' must be positive"),
]


@pytest.mark.parametrize("draw, arguments, message", REFUSALS)
def test_refusals(draw, arguments, message):
    with pytest.raises(ValueError, match=message):
        draw(*arguments)
