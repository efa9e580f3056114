"""Widgets: their Python side."""

from __future__ import annotations

import base64
import subprocess
import sys
import zlib

import numpy as np
import pytest
from traitlets import TraitError
from widget_pages import saved
from widget_samples import T, make, make_kinds, options, oscillation, wave

from ddlib.widgets import CurveWidget, Pad, Panel, Parameter, Scalar


@pytest.fixture(scope="module")
def widget():
    """For tests that leave it as it is."""
    return make()


WITHOUT_TORCH = """
import importlib, pkgutil, sys
class NoTorch:
    def find_spec(self, name, *_):
        assert name.split(".")[0] != "torch", "torch is imported"
sys.meta_path.insert(0, NoTorch())
from ddlib import widgets
for module in pkgutil.walk_packages(widgets.__path__, "ddlib.widgets."):
    importlib.import_module(module.name)
outside = [name for name in sys.modules if name.split(".")[0] == "workshop"]
assert not outside, outside
"""


def test_widgets_need_neither_torch_nor_the_book(tmp_path):
    command = [sys.executable, "-c", WITHOUT_TORCH]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


# Traits and errors


def test_parameters_are_traits_and_the_page_is_answered():
    widget, seen = make(), []
    widget.observe(lambda change: seen.append(change["new"]), "gain")
    widget.gain = 50
    assert seen == [50.0] and widget.values == {"gain": 50.0, "decay": 0.5, "phase": 0.0}
    assert widget.answer == {"request": 0, "values": [50.0, 0.5, 0.0]}
    exact = np.frombuffer(widget.exact, "<f4")
    np.testing.assert_allclose(exact, np.concatenate([*map(np.atleast_1d, widget.curves.values())]))
    np.testing.assert_allclose(widget.curves["position"], oscillation(50, 0.5, 0)["position"])
    widget.set_state({"decay": 1.5, "phase": 0.25, "request": 7})
    assert widget.answer == {"request": 7, "values": [50.0, 1.5, 0.25]}
    exact = np.frombuffer(widget.exact, "<f4")[:41]
    assert exact == pytest.approx(oscillation(50, 1.5, 0.25)["position"], abs=1e-6)


def test_failing_function_is_reported_to_the_page():
    def fragile(gain):
        if gain == 3:
            raise ZeroDivisionError("gain of three")
        return {"y": gain * T}

    gain = Parameter("gain", "Gain", 0, 10, 1, grid=2)
    widget = CurveWidget(fragile, [gain], [Panel("y", "y", "x", T)], alt="A line")
    widget.gain = 3
    assert widget.answer["error"] == "ZeroDivisionError: gain of three" and widget.exact == b""
    widget.gain = 4
    assert "error" not in widget.answer and len(widget.exact) == 4 * 41


def test_bad_values_name_parameter_value_and_range(widget):
    message = r"gain must (lie in \[1, 100\], got 101|lie in \[1, 100\], got 0.5|be finite)"
    for bad in (0.5, 101, np.nan, -np.inf):
        with pytest.raises(TraitError, match=message):
            widget.gain = bad
        with pytest.raises(ValueError, match=message):
            widget.interpolate(gain=bad)
    for bad in ("x", None, [1, 2], True, np.zeros(1), {}, 1j):
        with pytest.raises(TraitError, match=r"gain must be .*, got "):
            widget.gain = bad
        with pytest.raises(TypeError, match=r"gain must be .*, got "):
            widget.interpolate(gain=bad)
    with pytest.raises(TypeError, match="values must be among gain, decay, phase, got gian, x"):
        widget.interpolate(gian=3, decay=1, x=2)
    with pytest.raises(TraitError, match='"spec" trait is read-only'):
        widget.spec = {}
    assert widget.gain == 10


def test_a_still_is_a_picture_in_its_own_address(widget):
    before = widget.still
    for address in ("https://example.org/still.svg", "data:image/svg+xml;base64,<svg/>"):
        with pytest.raises(TraitError, match="still must be an address that begins with 'data:im"):
            widget.set_trait("still", address)
    assert widget.still == before


@pytest.mark.parametrize(
    "changes, message",
    [
        ({"name": "two words"}, "identifier.*'two words'"),
        ({"low": 5, "high": 5}, r"high of k must lie in \(5"),
        ({"value": 11}, r"k must lie in \[1, 10\], got 11"),
        ({"low": 0, "scale": "log"}, r"low of k must lie in \(0"),
        ({"grid": 1}, "grid of k"),
        ({"scale": "cubic"}, "scale of k"),
    ],
)
def test_bad_parameters(changes, message):
    with pytest.raises(ValueError, match=message):
        Parameter(**{"name": "k", "label": "k", "low": 1, "high": 10, "value": 2, **changes})


@pytest.mark.parametrize(
    "changes, message",
    [
        ({"tolerance": 1e-6}, "tolerance|interpolate to 1e-06"),
        ({"scalars": [Scalar("final!", "Final")]}, "curve must be one of"),
        ({"scalars": [Scalar("square", "Square")]}, "square must be one number"),
        ({"pad": Pad("decay", "nothing")}, "parameter of the pad"),
        ({"alt": " "}, "alt must describe"),
    ],
)
def test_arguments_that_do_not_fit(changes, message):
    with pytest.raises(ValueError, match=message):
        make(**changes)


@pytest.mark.parametrize(
    "changes, message",
    [
        ({"kind": "pie"}, "kind of 'y, m'"),
        ({"kind": "bars", "y_scale": "log"}, "y_scale of 'y, m'"),
        ({"kind": "bars", "x_scale": "log"}, "x_scale of 'y, m'"),
        ({"x": [0, 0, 1]}, "x of 'y, m' must increase"),
        ({"x_scale": "log"}, r"x of 'y, m' must lie in \(0"),
        ({"fixed": {"f": [1, 2]}}, r"f of 'y, m' must have shape \(3,\)"),
        ({"cursor": ("a", "b", "c")}, "cursor of 'y, m' must be one or two"),
        ({"ticks": [(np.inf, "far")]}, "ticks of 'y, m'"),
        ({"y_range": (2, 1)}, "y_range of 'y, m' must increase"),
        ({"y_range": (0, 1), "y_scale": "log"}, "y_range of 'y, m' must be positive"),
        ({"limits": (1, 0)}, "limits of 'y, m' must be a pair that increases"),
    ],
)
def test_bad_panels(changes, message):
    with pytest.raises(ValueError, match=message):
        Panel(**{"y_label": "y, m", "curves": "y", "x_label": "x", "x": [0, 1, 2], **changes})


def test_numbers_of_panels_must_be_numbers_of_the_function():
    for bad in ({"cursor": "y"}, {"y_range": ("y", 1)}):
        with pytest.raises(ValueError, match="y must be one number, got 41"):
            CurveWidget(wave, options(), [Panel("y", "y", "x", T, **bad)], alt="a", tolerance=1)
    with pytest.raises(ValueError, match="curve must be one of"):
        CurveWidget(wave, options(), [Panel("y", "y", "x", T, cursor="z")], alt="a", tolerance=1)
    with pytest.raises(ValueError, match="digits of y"):
        Scalar("y", "y", digits=-1)


# What is saved


def test_state_embeds_a_script_and_a_still(widget):
    state = saved(widget)["state"][widget.model_id]["state"]
    assert "export default" in state["_esm"] and "import " not in state["_esm"]
    assert state["spec"]["checksum"] == zlib.crc32(widget.baked)

    def svg(widget):
        return base64.b64decode(widget.still.split(",")[1]).decode()

    for text in ("Position, m", "Decay, 1/s", "Phase, rad", ">1<", ">2<"):
        assert text in svg(widget)
    kinds = svg(make_kinds())
    for text in ("Line", "Stems", "Bars", "Fixed range", "wave", "one", ">a<", ">c<"):
        assert text in kinds
