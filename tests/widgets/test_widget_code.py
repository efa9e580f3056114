"""The code that readers copy from a widget runs and gives what the widget shows."""

from __future__ import annotations

import pytest
from widget_pages import code_of

from ddlib.widgets.parts._common import filled

STATES = {
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
