"""*Run this page*: a widget in the page and its object in Python are one, in a browser."""

import live_pages
import pytest
from axe import violations
from live_pages import IDLE

PAGE = "book/feedback"
PICKER = "from ddlib.widgets import TrajectoryPicker\npicker = TrajectoryPicker()\npicker"
PICKED = "print(*picker.extents_deg, abs(picker.recording.q).max())"
TRAINER = "from ddlib.widgets import NetworkTrainer\ntrainer = NetworkTrainer()\ntrainer"
TRAINED = "print(trainer.epoch, trainer.model.weights.width, trainer.error)"


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """A page with cells alone, live."""
    with live_pages.served(tmp_path_factory.mktemp("site"), [PAGE]) as address:
        yield address


@pytest.mark.browser
@pytest.mark.slow
def test_what_is_picked_and_trained_in_the_page_python_has(browser, site):
    tab, wrong = browser.new_page(viewport={"width": 1000, "height": 900}), []
    tab.on("pageerror", lambda error: wrong.append(str(error)))
    tab.on("console", lambda message: message.type == "error" and wrong.append(message.text))
    tab.goto(f"{site}/{PAGE}.html")
    tab.get_by_role("button", name="Run this page").click()
    tab.get_by_role("button", name="Stop").click()
    outputs = tab.locator(".live-output")

    def run(number, source):
        field = tab.get_by_role("textbox").nth(number - 1)
        field.fill(source)
        field.press("Control+Enter")
        tab.locator(IDLE).wait_for(timeout=600_000)
        assert not tab.locator(".live-error").all_inner_texts()
        return outputs.nth(number - 1)

    shown = run(1, PICKER).locator(".ddlib-widget")
    before = run(2, PICKED).inner_text().split()
    square = shown.locator("svg").first
    square.scroll_into_view_if_needed()
    box = square.bounding_box()
    x, y = (box[a] + box[size] / 2 for a, size in (("x", "width"), ("y", "height")))
    tab.mouse.move(x, y)
    tab.mouse.down()
    tab.mouse.move(x - 40, y + 30, steps=8)
    tab.mouse.up()
    told = [t.rstrip("°") for t in shown.locator(".slider output").all_inner_texts()[:2]]
    after = run(2, PICKED).inner_text().split()
    assert after[0] != before[0] and after[2] != before[2]
    assert [f"{float(value):.1f}" for value in after[:2]] == told
    run(2, "picker.extents_deg = 12, 34\n" + PICKED)  # and the other way
    assert shown.locator(".slider output").all_inner_texts()[:2] == ["12.0°", "34.0°"]
    assert not violations(tab)

    page = run(3, TRAINER).locator(".ddlib-widget")
    run(4, "trainer.epoch = 100")
    page.get_by_text("100", exact=False).first.wait_for()
    tab.wait_for_timeout(6_000)  # the page trains
    told = run(5, TRAINED).inner_text().split()
    assert told[:2] == ["100", "21"] and 0 < float(told[2]) < 2
    assert not wrong


@pytest.mark.browser
@pytest.mark.slow
def test_what_follows_a_drag_leaves_it(browser, site):
    """The cells that take the picker run; neither its own cell nor one that sets it does."""
    tab = browser.new_page(viewport={"width": 1000, "height": 900})
    tab.on("dialog", lambda dialog: dialog.accept())
    tab.goto(f"{site}/{PAGE}.html")
    tab.get_by_role("button", name="Run this page").click()
    tab.get_by_role("button", name="Stop").click()  # the page was loaded anew
    book = '<div class="cell_output"><div class="ddlib-widget" id="book">of the book</div></div>'
    add = f"(el) => el.insertAdjacentHTML('beforeend', `{book}`)"
    tab.locator(".cell[data-live]").first.evaluate(add)
    code = [
        PICKER,
        "at = picker.extents_deg\nprint(*at)",
        "def go_to(*at):\n    picker.extents_deg = at\n\ngo_to(12, 34)",
        "print(at)",
    ]
    for k, source in enumerate(code):
        field = tab.get_by_role("textbox").nth(k)
        field.fill(source)
        field.press("Control+Enter")
        tab.locator(IDLE).wait_for(timeout=600_000)
    assert not tab.locator(".live-error").all_inner_texts()
    shown = tab.locator(".ddlib-widget").first
    shown.evaluate("(el) => (el.dataset.seen = 'before')")
    extents = shown.locator(".slider output")
    assert extents.all_inner_texts()[:2] == ["12.0°", "34.0°"]
    square = shown.locator("svg").first
    square.scroll_into_view_if_needed()
    box = square.bounding_box()
    tab.mouse.click(box["x"] + 0.6 * box["width"], box["y"] + 0.4 * box["height"])
    dragged = [told.rstrip("°") for told in extents.all_inner_texts()[:2]]
    assert dragged != ["12.0", "34.0"]
    follows = tab.get_by_role("button", name="Run what follows")
    tab.locator(".live-mark >> text=May show").first.wait_for()
    follows.click()
    tab.wait_for_timeout(200)
    tab.locator(IDLE).wait_for(timeout=600_000)
    outputs = tab.locator(".live-output")
    assert [f"{float(told):.1f}" for told in outputs.nth(1).inner_text().split()] == dragged
    told = outputs.nth(3).inner_text().strip("()\n").split(", ")
    assert [f"{float(each):.1f}" for each in told] == dragged
    assert [told.rstrip("°") for told in extents.all_inner_texts()[:2]] == dragged
    assert shown.get_attribute("data-seen") == "before"
    # Cells below miss what the book's first four gave, and say so.
    assert tab.locator(".live-mark").all_inner_texts()[: len(code)] == [""] * len(code)
    assert not tab.locator("#book").count()  # it made room for the reader's own
    tab.get_by_role("button", name="Reset: code and output").click()
    assert tab.locator("#book").count() and not shown.get_attribute("data-seen")
