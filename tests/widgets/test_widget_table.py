"""Tables of curves: exact at every setting of the grids, and nothing between."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from widget_samples import T, make, make_kinds, oscillation, parameters, parts, wave

from ddlib.widgets import Choice, CurveWidget, Live, Panel, Parameter
from ddlib.widgets.table import tabled, tobytes

HALF_A_STEP = 0.5 / 65_535
"""Of a curve's range: what rounding to an integer of two bytes may cost."""


def every_setting(widget):
    points = [p.points() for p in widget._parameters.values()]
    return [dict(zip(widget.values, setting)) for setting in itertools.product(*points)]


@pytest.mark.parametrize("make, function", [(make, oscillation), (make_kinds, wave)])
def test_every_setting_of_the_grid_is_the_functions_own(make, function):
    widget = make()
    width = {c["name"]: c["high"] - c["low"] for c in widget.spec["curves"]}
    settings = every_setting(widget)
    reached = {name: [np.inf, -np.inf] for name in width}
    for values in settings:
        exact = function(**values)
        for name, curve in widget.at_grid(**values).items():
            allowed = 1.0001 * HALF_A_STEP * width[name] + 1e-12
            np.testing.assert_allclose(curve, np.ravel(exact[name]), rtol=0, atol=allowed)
            low, high = reached[name]
            reached[name] = [min(low, *curve), max(high, *curve)]
    assert len(settings) == np.prod([p.grid for p in widget._parameters.values()])
    for curve in widget.spec["curves"]:  # the ends are exact
        assert reached[curve["name"]] == pytest.approx([curve["low"], curve["high"]], rel=1e-15)


def test_a_value_between_is_that_of_the_nearest_point():
    widget = make()
    gain, decay, _ = parameters()
    for value, place in ((3.1, 0), (3.2, 1), (99, 2)):  # the middle on a logarithmic scale: 3.16
        nearest = gain.points()[place]
        for name, curve in widget.at_grid(gain=value, decay=0.34).items():
            same = widget.at_grid(gain=nearest, decay=decay.points()[3])[name]
            np.testing.assert_array_equal(curve, same)
    exact = widget.curves_at(gain=1.3)["position"]
    np.testing.assert_array_equal(exact, oscillation(1.3, 0.5, 0)["position"])


def test_a_curve_takes_room_for_what_changes_it_alone():
    a, b = (Parameter(name, name, 0, 2, 1, grid=6) for name in "ab")
    axes = [a, b, Choice("k", "k", [0, 1, 5], 1)]
    curves = tabled(parts, axes)
    assert {c.name: c.description()["axes"] for c in curves} == {
        "a": [0], "all": [0, 1, 2], "k": [2], "c": []}  # fmt: skip
    assert len(tobytes(curves)) == 2 * (6 * 41 + 6 * 6 * 3 * 41 + 3 * 2 + 41)
    got = {c.name: c.at([2, 5, 1]) for c in curves}
    for name, values in parts(0.8, 2.0, 1).items():
        np.testing.assert_allclose(got[name], values, atol=2e-4)


def test_what_the_page_computes_has_no_room_and_may_end():
    def function(a):
        return {"own": np.where(T > a, np.nan, T), "baked": a * T}

    a, panel = Parameter("a", "a", 0.5, 1, 1, grid=3), Panel("y", ("own",), "x", T)
    live = Live(examples=[{"a": 0.5}], ranges={"baked": (0, 9)})
    whole = CurveWidget(function, [a], [panel], alt="a", live=live)
    assert whole.baked_bytes == 0 and whole.at_grid() == {}
    assert np.isnan(whole.curves_at(a=0.5)["own"][-1]) and whole.exact == b""
    ranges = {c["name"]: (c["low"], c["high"], c["axes"]) for c in whole.spec["curves"]}
    assert ranges == {"own": (0, 1, None), "baked": (0, 9, None)}
    own, baked = np.sin, np.cos
    mixed = CurveWidget(
        lambda a: {"own": own(a * T), "baked": baked(a * T)}, [a], [panel], alt="a",
        live=Live(["own"]),
    )  # fmt: skip
    assert mixed.baked_bytes == 2 * 3 * 41 and list(mixed.at_grid()) == ["baked"]
