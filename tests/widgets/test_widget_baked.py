"""Tables of curves: interpolation, choices, dependencies."""

from __future__ import annotations

import re

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from traitlets import TraitError
from widget_pages import settings
from widget_samples import DEPENDS, T, axes, make, make_kinds, oscillation, parameters, parts, wave

from ddlib.widgets import Choice, CurveWidget, Pad, Panel, Parameter
from ddlib.widgets.baking.baked import MAX_BYTES, MAX_VALUES, Baked
from ddlib.widgets.baking.compress import SHARE


@pytest.fixture(scope="module")
def waves():
    """For tests that leave it as it is."""
    return make_kinds()


# Interpolation


def test_interpolation_is_within_what_the_widget_states(waves):
    widget = make()
    for each in (widget, waves):
        assert each.interpolation_error(200, seed=0) == each.spec["error"]
        assert each.interpolation_error(300, seed=5) < 2 * each.spec["error"]
    assert widget.interpolation_error(400, seed=2) <= 0.01
    width = {c["name"]: c["high"] - c["low"] or 2.5 for c in widget.spec["curves"]}
    worst = 0.0
    for values in settings(widget, 50, seed=3):
        exact = oscillation(**values)
        for name, curve in widget.interpolate(**values).items():
            worst = max(worst, np.abs(curve - exact[name]).max() / width[name])
    assert worst == pytest.approx(widget.interpolation_error(50, seed=3))


def test_grid_points_come_back_within_the_share_of_the_tolerance():
    baked = Baked(oscillation, parameters(4), tolerance=0.002)
    assert baked.tables[0].rank > 0
    for gain in parameters()[0].points()[::4]:
        for decay in parameters(4)[1].points():
            values = {"gain": gain, "decay": decay, "phase": 1.0}
            exact, got = oscillation(**values), baked.interpolate(**values)
            for low, high, name in zip(baked.low, baked.high, got):
                # leaving components out, and the rounding to int16
                allowed = (SHARE * 0.002 + 0.0001) * (high - low) + 1e-12
                np.testing.assert_allclose(got[name], exact[name], atol=allowed)
    assert np.abs(baked.tables[0].table.astype(int)).max() == 32767


def test_without_components_grid_points_come_back_within_half_a_step():
    noise = np.random.default_rng(0).normal(size=(9, 4))
    baked = Baked(lambda a: {"y": noise[a]}, [Choice("a", "a", range(9), 0)])
    assert baked.tables[0].rank == 0 and baked.tables[0].table.shape == (9, 4)
    for k in range(9):
        got = baked.interpolate(a=k)["y"]
        np.testing.assert_allclose(got, noise[k], atol=0.51 * np.ptp(noise) / 65534)


@pytest.mark.parametrize("grid, degree", [(2, 1), (3, 2), (4, 3), (9, 3)])
def test_few_points_make_a_polynomial_of_their_degree(grid, degree):
    axis = [Parameter("a", "a", 1, 3, 2, grid=grid)]
    assert Baked(lambda a: {"y": a**degree}, axis, tolerance=1e-4).error(50) < 3e-5
    assert Baked(lambda a: {"y": a ** (degree + 1)}, axis, tolerance=1e-4).error(50) > 3e-5


def test_spline_is_scipys_not_a_knot():
    axis = Parameter("a", "a", 0, 3, 0, grid=7)
    spline = CubicSpline(axis.points(), np.exp(axis.points()), bc_type="not-a-knot")
    ours = Baked(lambda a: {"y": np.exp(a)}, [axis], tolerance=1e-5)
    for a in np.linspace(0, 3, 40):
        assert ours.interpolate(a=a)["y"][0] == pytest.approx(spline(a), abs=2e-3)
    both = [Parameter("a", "a", -1, 3, 0, grid=5), Parameter("b", "b", 0, 1, 0, grid=4)]
    cubic = Baked(lambda a, b: {"y": [a**3 - 3 * a * b + b**3, 1.0]}, both, tolerance=1e-4)
    assert cubic.error(100) < 3e-5


def test_faint_components_take_one_byte():
    axis = [Parameter("a", "a", 0, 3, 0, grid=200)]
    x = np.linspace(0, 1, 300)
    sines = np.sin(np.outer(np.arange(40), x + 0.1)) / (1 + np.arange(40)[:, None]) ** 1.5
    baked = Baked(lambda a: {"y": np.sin(np.arange(40) * a) @ sines}, axis, tolerance=0.01)
    (table,) = baked.tables
    assert 0 < table.wide < table.rank
    for narrow in (table.table[:, table.wide :], table.shapes[table.wide :]):
        assert np.abs(narrow).max() == 127
    assert len(table.tobytes()) == (table.rank + table.wide) * (202 + 300)
    assert baked.error(300) < 0.01


# Choices


def test_choice_is_exact_at_each_option_and_never_between(waves):
    for shape in ("sine", "cosine"):
        for bits in (3, 5, 8):
            got = waves.interpolate(gain=5, shape=shape, twice=True, bits=bits)
            exact = wave(5, shape, True, bits)
            for curve in waves.spec["curves"]:
                allowed = 0.004 * (curve["high"] - curve["low"] or 1)
                np.testing.assert_allclose(got[curve["name"]], exact[curve["name"]], atol=allowed)


def test_choice_is_a_trait_that_holds_the_key():
    widget, seen = make_kinds(), []
    widget.observe(lambda change: seen.append(change["new"]), ["shape", "bits"])
    widget.shape, widget.bits = "cosine", np.int64(8)
    assert seen == ["cosine", 8] and type(widget.bits) is int
    assert widget.answer["values"] == [2.0, "cosine", False, 8]
    np.testing.assert_allclose(widget.curves["y"], wave(2, "cosine", False, 8)["y"])
    widget.set_state({"twice": True, "bits": 3, "request": 4})
    assert widget.answer == {"request": 4, "values": [2.0, "cosine", True, 3]}


def test_wrong_keys_name_choice_value_and_options(waves):
    known = {"bits": "3, 5, 8", "shape": "'sine', 'cosine'", "twice": "False, True"}
    wrong = {"bits": [4, True, np.nan, "3", [3], None], "shape": ["Sine", 0], "twice": [1, "on"]}
    for name, values in wrong.items():
        for bad in values:
            message = re.escape(f"{name} must be one of {known[name]}, got {bad!r}")
            with pytest.raises(TraitError, match=message):
                setattr(waves, name, bad)
            with pytest.raises(ValueError, match=message):
                waves.interpolate(**{name: bad})
    assert waves.values == {"gain": 2.0, "shape": "sine", "twice": False, "bits": 5}


@pytest.mark.parametrize(
    "changes, error, message",
    [
        ({"options": [1]}, ValueError, "options of k must be two or more"),
        ({"options": "ab"}, TypeError, "options of k must be a mapping or sequence"),
        ({"options": [1, 1]}, ValueError, "options of k must differ"),
        ({"options": [1, np.nan]}, TypeError, "texts or finite numbers, got nan"),
        ({"options": [1, None]}, TypeError, "texts or finite numbers, got None"),
        ({"value": 3}, ValueError, "k must be one of 1, 2, got 3"),
        ({"display": "radio"}, ValueError, "display of k"),
        ({"display": "switch"}, ValueError, "options of the switch k"),
        ({"name": "two words"}, ValueError, "identifier"),
    ],
)
def test_bad_choices(changes, error, message):
    given = {"name": "k", "label": "k", "options": [1, 2], "value": 1, **changes}
    with pytest.raises(error, match=message):
        Choice(**given)


# Curves that depend on some parameters only


def test_curves_of_fewer_parameters_have_their_own_tables():
    calls = []
    baked = Baked(lambda **v: calls.append(v) or parts(**v), axes(), depends=DEPENDS)
    assert [(g["parameters"], g["curves"]) for g in baked.groups] == [
        ([0], [0]), ([0, 1, 2], [1]), ([2], [2]), ([], [3])]  # fmt: skip
    assert len(calls) == 1 + 6 + 6 * 6 * 3 + 3 + 1
    assert baked.error(100) < 0.004
    assert len(baked.tobytes()) < len(Baked(parts, axes()).tobytes())
    got = baked.interpolate(a=0.3, b=1.7, k=5)
    assert list(got) == ["a", "all", "k", "c"] and got["k"] == pytest.approx([5, 5], abs=1e-3)
    assert Baked(parts, axes(), depends={**DEPENDS, "all": ["a"]}).error(100) > 0.1
    for bad in ({"z": ["a"]}, {"a": ["z"]}):
        with pytest.raises(ValueError, match=r"(in|of) depends"):
            Baked(parts, axes(), depends=bad)


# Unfit functions


def test_too_large_grids_and_tables_are_refused():
    calls = []

    def wide(a, b):
        calls.append(a)
        return {"y": np.zeros(3000)}

    axes = [Parameter(n, n, 0, 1, 0, grid=50) for n in "ab"]
    with pytest.raises(ValueError, match=f"at most {MAX_VALUES} values, got 7500000"):
        Baked(wide, axes)
    assert len(calls) == 1  # before the work
    noise = np.random.default_rng(0).normal(size=(50, 50, 100))
    axes = [Choice(n, n, range(50), 0) for n in "ab"]
    with pytest.raises(ValueError, match=f"at most {MAX_BYTES} baked bytes, got 500000"):
        Baked(lambda a, b: {"y": noise[a, b]}, axes)


def test_unfit_functions_are_refused():
    axis = [Parameter("a", "a", 0, 1, 0, grid=3)]
    with pytest.raises(ValueError, match="y must be finite"):
        Baked(lambda a: {"y": [1.0, np.nan]}, axis)
    with pytest.raises(ValueError, match="same curves everywhere"):
        Baked(lambda a: {"y": np.zeros(2 if a < 0.5 else 3)}, axis)
    with pytest.raises(TypeError, match="must return a dict"):
        Baked(lambda a: np.zeros(3), axis)
    with pytest.raises(ValueError, match="position must have 40 samples"):
        CurveWidget(oscillation, parameters(3), [Panel("y", "position", "x", T[1:])], alt="a")
    with pytest.raises(ValueError, match="attribute of widgets"):
        layout = Parameter("layout", "Layout", 0, 1, 0)
        CurveWidget(lambda layout: {"y": T}, [layout], [Panel("y", "y", "x", T)], alt="a")
    with pytest.raises(ValueError, match="parameter of the pad must be one of 'gain', got 'bits'"):
        make_kinds(pad=Pad("gain", "bits"))
