"""The window over a hidden torque, in Python and in a page without a kernel."""

from __future__ import annotations

import numpy as np
import pytest
from widget_pages import assert_curves, drag, settings

from ddlib.setups import STATE_FEEDBACK, split
from workshop.chapters.widgets.window import HiddenTorque


@pytest.fixture(scope="module")
def test_run():
    return split(STATE_FEEDBACK.record())[1]


@pytest.fixture(scope="module")
def hidden(test_run):
    return HiddenTorque(test_run)


def test_the_torque_is_covered_from_the_window_on(hidden, test_run):
    motion = test_run.motion
    for values in settings(hidden, 30, seed=2):
        joint, k, shown = values["joint"], values["sample"], values["shown"]
        j, curves = ("shoulder", "elbow").index(joint), hidden.curves_at(**values)
        seen = np.isfinite(curves["torque"])
        last = 300 if shown else max(1, k - 9)
        assert seen[:last].all() and not seen[last:].any()
        np.testing.assert_array_equal(curves["torque"][seen], test_run.tau[motion, j][seen])
        at = motion.start + k
        around = np.degrees(test_run.q[at - 10 : at + 11, j])
        np.testing.assert_allclose(curves["inside"], around)
        np.testing.assert_allclose(np.diff(curves["chord"]), np.ptp(around[[0, -1]]) / 20 * np.sign(
            around[-1] - around[0]), atol=1e-9)  # fmt: skip
        assert curves["low"][0] < -np.abs(test_run.tau[motion, j]).max()


@pytest.mark.browser
def test_the_page_hides_and_uncovers_it(page_with, hidden):
    page = page_with(hidden, query="?hidden-torque=sample:75")
    slider = page.get_by_role("slider")
    assert_curves(page, hidden.curves_at(joint="shoulder", sample=75, shown=False))
    slider.press("ArrowRight")
    page.get_by_label("Uncover the torque").click()
    page.get_by_label("Joint").select_option(label="elbow")
    assert_curves(page, hidden.curves_at(joint="elbow", sample=76, shown=True))


@pytest.mark.browser
def test_the_window_follows_the_pointer(page_with, hidden):
    page = page_with(hidden, query="?hidden-torque=sample:75")
    for chart, place in ((0, 0.5), (2, 0.75)):  # the position, the torque
        frame = page.locator(".chart path.frame").nth(chart).bounding_box()
        drag(page, frame, (0.25, 0.5), (place, 0.5))
        sample = page.evaluate("document.querySelector('.ddlib-hidden').view.get('sample')")
        assert sample == pytest.approx(299 * place, abs=2)
