"""Tables of curves: interpolation, choices, dependencies."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from widget_pages import settings
from widget_samples import DEPENDS, axes, make, make_kinds, oscillation, parts, wave

from ddlib.widgets import Parameter
from ddlib.widgets._baking.baked import Baked


@pytest.fixture(scope="module")
def waves():
    """For tests that leave it as it is."""
    return make_kinds()


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


def test_spline_is_scipys_not_a_knot():
    axis = Parameter("a", "a", 0, 3, 0, grid=7)
    spline = CubicSpline(axis.points(), np.exp(axis.points()), bc_type="not-a-knot")
    ours = Baked(lambda a: {"y": np.exp(a)}, [axis], tolerance=1e-5)
    for a in np.linspace(0, 3, 40):
        assert ours.interpolate(a=a)["y"][0] == pytest.approx(spline(a), abs=2e-3)
    both = [Parameter("a", "a", -1, 3, 0, grid=5), Parameter("b", "b", 0, 1, 0, grid=4)]
    cubic = Baked(lambda a, b: {"y": [a**3 - 3 * a * b + b**3, 1.0]}, both, tolerance=1e-4)
    assert cubic.error(100) < 3e-5


def test_choice_is_exact_at_each_option_and_never_between(waves):
    for shape in ("sine", "cosine"):
        for bits in (3, 5, 8):
            got = waves.interpolate(gain=5, shape=shape, twice=True, bits=bits)
            exact = wave(5, shape, True, bits)
            for curve in waves.spec["curves"]:
                allowed = 0.004 * (curve["high"] - curve["low"] or 1)
                np.testing.assert_allclose(got[curve["name"]], exact[curve["name"]], atol=allowed)


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


def test_unfit_functions_are_refused():
    axis = [Parameter("a", "a", 0, 1, 0, grid=3)]
    with pytest.raises(ValueError, match="y must be finite"):
        Baked(lambda a: {"y": [1.0, np.nan]}, axis)
    with pytest.raises(ValueError, match="same curves everywhere"):
        Baked(lambda a: {"y": np.zeros(2 if a < 0.5 else 3)}, axis)
    with pytest.raises(TypeError, match="must return a dict"):
        Baked(lambda a: np.zeros(3), axis)
