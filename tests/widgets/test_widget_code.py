"""The code that readers copy from a widget runs and gives what the widget shows."""

from __future__ import annotations

import pytest
from widget_pages import code_of

from ddlib.widgets.parts._common import filled

STATES = {
    "EXPLORER_CODE": (
        "evidence/convolution-filters",
        {"width": 21, "seed": 15, "unit": "hidden 8", "joint": "shoulder"},
        "acceleration",
    ),
    "_SPECTRUM_CODE": (
        "evidence/why-smooth-filters",
        {"case": 1, "width": 11, "direction": 4, "epoch": 1000},
        "measured",
    ),
    "PICKER_CODE": (
        "evidence/trajectories-and-recording",
        {"shoulder_deg": 39.5, "elbow_deg": 14.4},
        "11 ",
    ),
}


@pytest.mark.parametrize("name", STATES)
def test_code_of_the_chapters_runs(name, capsys):
    chapter, values, printed = STATES[name]
    exec(filled(code_of(chapter, name), values), {})
    assert printed in capsys.readouterr().out
