"""One weight turned by hand: its curves, its slope, and its steps in a browser without a kernel."""

import numpy as np
import pytest
from widget_pages import NEXT_FRAME, assert_curves, drag, shown_values

from workshop.chapters.widgets.weight import WANTED, OneWeight


@pytest.fixture
def widget():
    return OneWeight()


def steps(weight, size, momentum, count):
    """Weights after so many steps, by the formulas of the lesson."""
    last, path = 0.0, [weight]
    for _ in range(count):
        y = 1 / (1 + np.exp(-path[-1]))
        last = momentum * last - size * (y - WANTED) * y * (1 - y)
        path.append(path[-1] + last)
    return path


def test_the_slope_is_that_of_the_error(widget):
    x = widget.spec["panels"][0]["x"]
    for weight in (-7.9, -2.0, 0.0, 0.8, 5.0):
        widget.weight = weight
        curves = widget.curves
        error = np.interp([weight - 0.1, weight + 0.1], x, curves["error"])
        assert curves["slope"][0] == pytest.approx(np.diff(error)[0] / 0.2, abs=2e-4)
        # the straight line touches the curve there
        assert np.interp(weight, x, curves["tangent"]) == pytest.approx(curves["errs"][0])
        assert np.diff(curves["tangent"]) == pytest.approx(0.1 * curves["slope"][0])
        assert curves["step"][0] == -widget.size * curves["slope"][0]
    widget.weight = np.log(WANTED / (1 - WANTED))
    assert (
        widget.curves["answers"][0] == pytest.approx(WANTED)
        and abs(widget.curves["slope"][0]) < 1e-12
    )


@pytest.mark.browser
def test_the_page_computes_what_python_does(page_with, widget):
    page = page_with(widget)
    assert_curves(page, widget.curves)
    page.locator("input[id$=weight]").press("End")
    page.locator("input[id$=size]").press("ArrowRight")
    page.evaluate(NEXT_FRAME)
    widget.weight = shown_values(page)[0]
    widget.size = page.evaluate("document.querySelector('.ddlib-weight').view.get('size')")
    assert widget.weight == 8 and widget.size > 10
    assert_curves(page, widget.curves)


@pytest.mark.browser
def test_the_ball_is_dragged(page_with, widget):
    page = page_with(widget)
    frame = page.locator(".chart path.frame").first.bounding_box()
    drag(page, frame, (0.375, 0.5), (0.4, 0.2), (0.55, 0.5))  # −2 is at 6 of 16
    assert shown_values(page)[0] == pytest.approx(0.8, abs=0.05)


@pytest.mark.browser
def test_steps_go_downhill(page_with, widget):
    page = page_with(widget, query="?one-weight=momentum:0.5")
    wanted = steps(-2.0, 10.0, 0.5, 11)
    now = "document.querySelector('.ddlib-weight').view.get('weight')"
    landing = page.locator("circle.next").bounding_box()
    page.get_by_role("button", name="Step", exact=True).click()
    assert page.evaluate(now) == pytest.approx(wanted[1])
    page.evaluate(NEXT_FRAME)
    here = page.locator(".walked.now").bounding_box()  # where the ring was
    for side, size in (("x", "width"), ("y", "height")):
        middles = [box[side] + box[size] / 2 for box in (landing, here)]
        assert middles[0] == pytest.approx(middles[1], abs=0.6)
    page.get_by_role("button", name="Ten steps").click()
    words = page.locator(".walk p")
    words.get_by_text("11 steps from −2.00").wait_for()
    assert page.evaluate(now) == pytest.approx(wanted[-1])
    assert page.locator(".walked").first.get_attribute("d").count("M") == 11
    page.locator("input[id$=weight]").press("ArrowLeft")  # by hand: it begins anew
    page.evaluate(NEXT_FRAME)
    assert words.inner_text() == "" and not page.locator(".walked").first.get_attribute("d")


@pytest.mark.browser
def test_a_weight_that_runs_away_stays_in_its_range(page_with, widget):
    widget.weight, widget.size, widget.momentum = -1.0, 100.0, 0.9
    page = page_with(widget)
    step, words = page.get_by_role("button", name="Step", exact=True), page.locator(".walk p")
    for _ in range(2):
        step.click()
    page.evaluate(NEXT_FRAME)
    assert "the weight ran to the end of its range" in words.inner_text()
    step.click()  # where it stands still: it forgets the step before
    page.evaluate(NEXT_FRAME)
    now = page.evaluate("document.querySelector('.ddlib-weight').view.get('weight')")
    assert words.inner_text() == "3 steps from −1.00." and 7.9 < now < 8
