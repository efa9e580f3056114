"""The code that readers copy from a widget runs and gives what the widget shows."""

from __future__ import annotations

import numpy as np
import pytest

from ddlib.widgets import explorer, picker, player, spectrum, window
from ddlib.widgets.parts.common import filled

STATES = {
    "explorer": (
        explorer.CODE,
        {"width": 21, "seed": 15, "unit": "hidden 8", "joint": "shoulder"},
        "acceleration",
    ),
    "player": (player.CODE, {"epoch": 1000, "unit": "hidden 3"}, "training"),
    "spectrum": (
        spectrum.CODE,
        {"case": 1, "width": 11, "direction": 4, "epoch": 1000},
        "measured",
    ),
    "window": (window.CODE, {"width": 11, "sample": 75}, "[["),
    "picker": (picker.CODE, {"shoulder_deg": 39.5, "elbow_deg": 14.4}, "11 "),
}


@pytest.mark.parametrize("name", STATES)
def test_code_runs(name, capsys):
    code, values, printed = STATES[name]
    exec(filled(code, values), {})
    assert printed in capsys.readouterr().out


def test_code_gives_what_the_picker_shows(capsys):
    found = {}
    exec(filled(picker.MOTION, {"shoulder_deg": 30.0, "elbow_deg": 10.0}), found)
    shown = picker.TrajectoryPicker().interpolate(shoulder_deg=30, elbow_deg=10)
    for j, joint in enumerate(("shoulder", "elbow")):
        peak = np.abs(found["torque"][:, j]).max()
        assert peak == pytest.approx(shown[f"peak {joint}"][0], abs=0.05)
