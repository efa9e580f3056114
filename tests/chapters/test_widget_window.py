"""The sliding window, in Python and in a page without a kernel."""

from __future__ import annotations

import numpy as np
import pytest
from widget_pages import assert_curves, settings

from ddlib.learning import sliding_windows
from ddlib.setups import STATE_FEEDBACK, WINDOWS, split
from workshop.chapters.widgets.window import HiddenTorque, SlidingWindow
from workshop.report import results

MEMBER = 1


@pytest.fixture(scope="module")
def test_run():
    return split(STATE_FEEDBACK.record())[1]


@pytest.fixture(scope="module")
def models():
    return {width: results.networks(width)[MEMBER] for width in WINDOWS}


@pytest.fixture(scope="module")
def widget(models, test_run):
    return SlidingWindow(models, test_run)


def test_truths_at_every_sample(widget, models, test_run):
    for values in settings(widget, 40, seed=1):
        width, sample = values["width"], values["sample"]
        model, shown = models[width], widget.curves_at(**values)
        windows = sliding_windows(test_run.q, width, test_run.motion)
        torque = model.torque(windows)
        at = test_run.motion.start + sample
        for j, joint in enumerate(("shoulder", "elbow")):
            wide = np.ptp(torque[:, j])
            np.testing.assert_allclose(shown[f"{joint} torque"], torque[:, j], atol=1e-12 * wide)
            assert shown[f"{joint} network"][0] == pytest.approx(torque[sample, j])
            assert shown[f"{joint} measured"][0] == pytest.approx(test_run.tau[at, j])
            strip = shown[f"{joint} position"]
            inside = strip[20 - width // 2 : 21 + width // 2]
            np.testing.assert_allclose(inside, model.scaled(windows)[sample, j], atol=1e-4)
            around = test_run.q[at - 20 : at + 21, j]
            np.testing.assert_allclose(np.corrcoef(strip, around)[0, 1], 1, atol=1e-4)
        hidden, output = model.weights.activity(model.scaled(windows[[sample]]))
        expected = np.concatenate([hidden[0], output[0]])
        np.testing.assert_allclose(shown["activity"], expected, atol=1e-4)
        # the output activities are the torque
        back = model.outputs.unscale(shown["activity"][-2:])
        np.testing.assert_allclose(back, torque[sample], atol=0.02)
        assert shown["last"][0] - shown["first"][0] == pytest.approx(10 * width, abs=0.02)


@pytest.mark.browser
def test_the_page_computes_what_ddlib_does(page_with, widget):
    page = page_with(widget, query="?sliding-window=sample:75")
    slider = page.get_by_role("slider")

    def shows(width, sample):
        assert_curves(page, widget.curves_at(width=width, sample=sample))
        assert page.locator("output[for$=sample]").inner_text() == f"{0.01 * sample:.2f} s"

    shows(21, 75)
    slider.press("End")
    shows(21, 299)
    page.get_by_label("Window size").select_option(label="41 samples")
    shows(41, 299)
    page.get_by_label("Window size").press("Home")
    slider.press("Home")
    shows(11, 0)


# The torque that is hidden


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
