"""The whole experiment in a built page: no kernel, nothing from outside, in under two minutes."""

from __future__ import annotations

import re
import time

import pytest
from widget_pages import write

pytestmark = pytest.mark.browser


def test_other_trajectories_are_recorded_learnt_and_weighed(site, visit):
    """A newcomer's way on a phone: other trajectories, a guess, the inertia beside the arm's."""
    began = time.monotonic()
    here = visit(f"{site}/book/window-networks.html", width=390)
    page = here.page
    trainer = page.locator(".ddlib-trainer")
    trainer.get_by_text("Your own experiment").click()
    for joint, trajectory, extent in (("shoulder", 1, "30"), ("elbow", 4, "20")):
        write(trainer.get_by_label(f"{joint} in trajectory {trajectory}"), extent)
    assert "not recorded" in trainer.locator(".recorded").inner_text()
    trainer.locator(".guess button").first.click()
    trainer.get_by_role("button", name="Record and train").click()
    trainer.get_by_text("Training is over").wait_for(timeout=100_000)
    inertia, error = trainer.locator(".weighed b").all_inner_texts()
    told, arm = map(float, re.findall(r"\d+\.\d+", inertia))
    assert time.monotonic() - began < 120
    assert arm == pytest.approx(6.4, abs=0.05)  # of the arm with a little bent elbow
    assert abs(told / arm - 1) < 0.2
    assert float(error) < 0.5
    assert "Recorded in your browser" in trainer.locator(".recorded").inner_text()
    assert not here.problems
