"""Widgets: their Python side."""

from __future__ import annotations

import numpy as np
import pytest
from traitlets import TraitError
from widget_samples import T, make, oscillation

from ddlib.setups import STATE_FEEDBACK
from ddlib.simulation import record
from ddlib.trajectories import APPENDIX_I
from ddlib.widgets import (
    CurveWidget,
    Pad,
    Panel,
    Parameter,
    Presets,
    Scalar,
)
from workshop.chapters.widgets.window import HiddenTorque


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


def test_what_does_not_fit_is_refused_by_name():
    """A value by its trait, and names that belong to nothing."""
    with pytest.raises(TraitError, match=r"gain must lie in \[1, 100\], got 101"):
        make().gain = 101
    for changes, message in (
        ({"presets": Presets({"both": {"nothing": 1}})}, "preset 'both' must set some of gain"),
        ({"scalars": [Scalar("square", "Square")]}, "square must be one number"),
        ({"pad": Pad("decay", "nothing")}, "parameter of the pad"),
    ):
        with pytest.raises(ValueError, match=message):
            make(**changes)


def test_widgets_keep_to_the_recordings_step():
    """At 4 ms: windows in the recording's own time."""
    setup, step = STATE_FEEDBACK, 0.004
    log = record(setup.arm, setup.controller, APPENDIX_I, log_step=step, rest=0.2)
    times = HiddenTorque(log[5], 21).spec["panels"][1]["x"]
    np.testing.assert_allclose(np.diff(times), 1e3 * step, rtol=1e-6)
