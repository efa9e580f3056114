"""A lesson by keyboard alone: predict, operate a widget, answer, open a solution."""

from __future__ import annotations

import pytest

NAME = """() => {
  const e = document.activeElement;
  const lost = e === document.body;
  const name = e.getAttribute("aria-label") || e.labels?.[0]?.textContent || e.textContent;
  return lost ? "" : name.trim().replace(/\\s+/g, " ");
}"""
OPEN = "() => document.activeElement.closest('details').open"
VALUE = "() => document.activeElement.getAttribute('aria-valuetext')"
OTHER = f"""async (before) => {{
  const read = {VALUE};
  for (let k = 0; k < 300 && read() === before; k++) await new Promise(requestAnimationFrame);
  return read() !== before;
}}"""
COPY = "(buttons) => buttons.map((button) => button.getAttribute('aria-label'))"


@pytest.mark.browser
@pytest.mark.chromium
def test_feedback(site, visit):
    """And buttons that copy have names of their own."""
    opened = visit(f"{site}/book/feedback.html", reduced_motion="reduce")
    page, press = opened.page, opened.page.keyboard.press

    def go(name):
        """Tab until what has the focus is called so."""
        for _ in range(300):
            press("Tab")
            if page.evaluate(NAME).startswith(name):
                return
        raise AssertionError(f"no stop is called {name}")

    def read(selector):
        page.wait_for_selector(f"{selector}:not(:empty)")
        return page.locator(selector).first.inner_text()

    names = page.locator("article button.copybtn").evaluate_all(COPY)
    assert len(names) == len(set(names)) > 5 and all(name.startswith("Copy code") for name in names)
    go("It swings for a shorter time")
    press("Space")
    go("Try it")
    press("Enter")
    assert page.evaluate(NAME) == "Next question" and read(".ask .told")
    go("Proportional gain")
    before = page.evaluate(VALUE)
    press("End")
    assert page.evaluate(OTHER, before)
    go("Question 1")
    press("Enter")
    go("A. ")
    press("Space")
    go("Check")
    press("Enter")
    assert page.locator("form.quiz .why:visible").count() == 1
    go("Your answer")
    press("1")
    press("Enter")
    assert "You gave 1" in read(".exercise-answer output")
    go("Solution of exercise 1")
    press("Enter")
    assert page.evaluate(OPEN) and not opened.problems
