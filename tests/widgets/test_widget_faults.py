"""Damaged data, and kernels that are silent, go and come back; in a browser."""

from __future__ import annotations

import base64

import pytest
from widget_pages import LIVE, NEXT_FRAME, PATHS, READ, VIEW, page_of, shown_values
from widget_samples import make

pytestmark = pytest.mark.browser


@pytest.fixture(scope="module")
def widget():
    return make()


# Damage


def buffer(change):
    """Damage of the table of curves."""

    def damage(entry):
        where = next(b for b in entry["buffers"] if b["path"] == ["baked"])
        data = bytearray(base64.b64decode(where["data"]))
        where["data"] = base64.b64encode(change(data)).decode()

    return damage


def state(value, *path):
    """Damage of the state: another value at a place, or none."""

    def damage(entry):
        node = entry["state"]
        for key in path[:-1]:
            node = node[key]
        node.pop(path[-1]) if value is GONE else node.update({path[-1]: value})

    return damage


GONE = object()


NEEDED = ("parameters", "curves", "panels", "scalars")


def damages() -> list:
    """What cannot be drawn, broken one at a time; each must be reported."""
    changes = (lambda data: data[:-2], lambda data: data + data, lambda data: b"")
    broken = [buffer(change) for change in changes]
    broken += [lambda entry: entry.update(buffers=[])]
    broken += [state(value, "spec") for value in (GONE, 3)]
    return broken + [state(GONE, "spec", key) for key in NEEDED]


def test_any_damage_is_reported_in_place(tmp_path, visit, widget):
    broken = damages()
    opened = visit(page_of(tmp_path / "page.html", widget, damages=broken))
    page = opened.page
    page.evaluate(NEXT_FRAME)
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
    assert not opened.problems


def test_unfit_values_are_brought_into_the_range(tmp_path, visit, widget):
    unfit = {101: 100, -5: 1, 11: 10, "10": 10, GONE: 10}
    damages = [state(value, "gain") for value in unfit]
    opened = visit(page_of(tmp_path / "page.html", widget, damages=damages))
    assert shown_values(opened.page)[3::3] == list(unfit.values()) and not opened.problems


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
def live(tmp_path, visit, widget):
    opened = visit(page_of(tmp_path / "page.html", widget, extra=LIVE))
    samples = len(widget.exact) // 4
    opened.page.evaluate(f"kernel.reply = Array({samples}).fill(1.25)")
    yield opened.page
    assert not opened.problems


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
