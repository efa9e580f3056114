"""Damaged data, and kernels that are silent, go and come back; in a browser."""

from __future__ import annotations

import pytest
from widget_pages import LIVE, NEXT_FRAME, PATHS, READ, VIEW, page_of, shown_values
from widget_samples import make

pytestmark = pytest.mark.browser


@pytest.fixture(scope="module")
def widget():
    return make()


# Damage


def cut(entry):
    """Damage of the table of curves: its end is lost."""
    table = next(buffer for buffer in entry["buffers"] if buffer["path"] == ["baked"])
    table["data"] = table["data"][:-4]


def state(value, *path):
    """Damage of the state: another value at a place, or none."""

    def damage(entry):
        node = entry["state"]
        for key in path[:-1]:
            node = node[key]
        node.pop(path[-1]) if value is GONE else node.update({path[-1]: value})

    return damage


GONE = object()


def test_any_damage_is_reported_in_place(page_with, widget):
    """Of what cannot be drawn, broken one at a time."""
    broken = [cut, state(GONE, "spec"), state(GONE, "spec", "curves")]
    page = page_with(widget, damages=broken)
    texts = page.evaluate(
        "[...document.querySelectorAll('main > div')].map((el) => [el.className, el.textContent])"
    )
    assert len(texts) == 1 + len(broken)
    for name, text in texts[1:]:
        assert "ddlib-widget-error" in name and "are damaged: " in text
    before = page.evaluate(PATHS)
    page.get_by_label("Gain").press("End")  # the undamaged one lives
    page.evaluate(NEXT_FRAME)
    assert page.evaluate(PATHS) != before and len(before) == 2


def test_unfit_values_are_brought_into_the_range(page_with, widget):
    unfit = {101: 100, -5: 1, 11: 10, "10": 10, GONE: 10}
    damages = [state(value, "gain") for value in unfit]
    page = page_with(widget, damages=damages)
    assert shown_values(page)[3::3] == list(unfit.values())


def test_scripts_that_fail_are_told_and_two_views_share_a_model(tmp_path, visit, widget):
    scripts = ("export default {", "export default {render() { nope() }}")
    absent = VIEW % '{"model_id": "absent"}'
    broken = [state(script, "_esm") for script in scripts]
    url = page_of(tmp_path / "page.html", widget, widget, damages=broken, extra=absent)
    page = visit(url).page
    page.get_by_label("Gain").first.press("End")
    page.evaluate(NEXT_FRAME)
    assert shown_values(page) == [100, 0.5, 0] * 2
    _, run, absent = page.locator(".ddlib-widget-error[role=alert]").all_inner_texts()
    assert "nope is not defined" in run and "its state is not in the page" in absent


# A kernel that answers, one that does not, and one that goes and comes back

SILENCE = "The kernel does not answer, so you see values that were computed beforehand."


@pytest.fixture
def live(page_with, widget):
    page = page_with(widget, extra=LIVE)
    page.evaluate(f"kernel.reply = Array({len(widget.exact) // 4}).fill(1.25)")
    return page


def usable(page):
    """Whether a key press changes the picture."""
    before = page.evaluate(PATHS)
    page.get_by_role("slider", name="Decay").press("ArrowRight")
    page.evaluate(NEXT_FRAME)
    return page.evaluate(PATHS) != before


ALL_ANSWERED = """(before) => {
  const request = kernel.model.get("request");
  return request > before && kernel.model.get("answer")?.request === request;
}"""
"""Nothing is under way: a look at the page does not tell, as an answer to the first of two requests
can hold the values of the second."""


def answers(page):
    page.evaluate("kernel.alive = true; kernel.closed = false")
    before = page.evaluate("kernel.model.get('request')")
    phase = page.get_by_role("slider", name="Phase")
    phase.press("ArrowRight")
    phase.press("ArrowRight")
    page.wait_for_function(ALL_ANSWERED, arg=before)
    page.evaluate(NEXT_FRAME)  # values are drawn with the next one
    assert page.locator("[data-values=exact]").count() == 1
    assert not page.locator(".note").is_visible()
    return page.evaluate(READ, 0)[0] == pytest.approx([1.25] * 41, abs=0.01)


@pytest.mark.parametrize("status, words", [("unknown", "does not answer"), ("busy", "is busy")])
def test_a_kernel_that_is_silent_and_then_answers(live, status, words):
    live.evaluate("(status) => (kernel.model.widget_manager.kernel.status = status)", status)
    live.get_by_label("Gain").press("ArrowRight")
    live.wait_for_selector(".note:not([hidden])", timeout=5000)
    assert live.locator(".note").inner_text() == SILENCE.replace("does not answer", words)
    assert usable(live)
    assert answers(live)


def test_a_kernel_that_goes_is_noted_without_a_move(live):
    assert answers(live)
    tell = "([which, ...status]) => kernel.watchers[which].forEach((f) => f(null, ...status))"
    live.evaluate(tell, [0, "busy"])
    assert not live.locator(".note").is_visible()
    live.evaluate("kernel.alive = false")
    live.evaluate(tell, [0, "dead"])
    assert live.locator(".note").inner_text() == SILENCE
    assert usable(live)
    assert answers(live)
