"""The code that readers copy from a widget runs and gives what the widget shows."""

from __future__ import annotations

import ast
import json
from pathlib import Path

import numpy as np
import pytest

from ddlib.widgets import picker
from ddlib.widgets.parts.common import filled

BOOK = Path(__file__).parents[2] / "book"
STATES = {
    "EXPLORER_CODE": (
        "convolution-filters",
        {"width": 21, "seed": 15, "unit": "hidden 8", "joint": "shoulder"},
        "acceleration",
    ),
    "PLAYER_CODE": ("hinton-diagrams", {"epoch": 1000, "unit": "hidden 3"}, "training"),
    "SPECTRUM_CODE": (
        "why-smooth-filters",
        {"case": 1, "width": 11, "direction": 4, "epoch": 1000},
        "measured",
    ),
    "WINDOW_CODE": ("window-networks", {"width": 11, "sample": 75}, "[["),
    "PICKER_CODE": ("trajectories-and-recording", {"shoulder_deg": 39.5, "elbow_deg": 14.4}, "11 "),
    "CODE": ("index", {"motion": 1}, "[["),
}


def code_of(chapter: str, name: str) -> str:
    """The text that a cell of a chapter keeps under a name."""
    cells = json.loads((BOOK / f"{chapter}.ipynb").read_text(encoding="utf-8"))["cells"]
    for source in ("".join(cell["source"]) for cell in cells if cell["cell_type"] == "code"):
        for line in ast.parse(source).body if f"{name} = " in source else ():
            if isinstance(line, ast.Assign) and line.targets[0].id == name:
                return ast.literal_eval(line.value)
    raise AssertionError(f"{chapter} has no {name}")


@pytest.mark.parametrize("name", STATES)
def test_code_of_the_chapters_runs(name, capsys):
    chapter, values, printed = STATES[name]
    exec(filled(code_of(chapter, name), values), {})
    assert printed in capsys.readouterr().out


def test_code_gives_what_the_picker_shows():
    run = {}
    exec(filled(picker.MOTION, {"shoulder_deg": 30.0, "elbow_deg": 10.0}), run)
    shown = picker.TrajectoryPicker().interpolate(shoulder_deg=30, elbow_deg=10)
    for j, joint in enumerate(("shoulder", "elbow")):
        peak = np.abs(run["torque"][:, j]).max()
        assert peak == pytest.approx(shown[f"peak {joint}"][0], abs=0.05)
