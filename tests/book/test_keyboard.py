"""Three lessons by keyboard alone: predict, operate a widget, answer, open a solution."""

from __future__ import annotations

import pytest

pytestmark = [pytest.mark.browser, pytest.mark.chromium]

NAME = """() => {
  const e = document.activeElement;
  const lost = e === document.body;
  const name = e.getAttribute("aria-label") || e.labels?.[0]?.textContent || e.textContent;
  return lost ? "" : name.trim().replace(/\\s+/g, " ");
}"""
OPEN = "() => document.activeElement.closest('details').open"
VALUE = """() => {
  const e = document.activeElement;
  return e.getAttribute("aria-valuetext") ?? e.value;
}"""
OTHER = f"""async (before) => {{
  const read = {VALUE};
  for (let k = 0; k < 300 && read() === before; k++) await new Promise(requestAnimationFrame);
  return read();
}}"""


class Keys:
    """A page whose reader has nothing but a keyboard."""

    def __init__(self, opened):
        self.opened, self.page = opened, opened.page

    def at(self) -> str:
        return self.page.evaluate(NAME)

    def go(self, name: str, key: str = "Tab") -> None:
        """Tab until what has the focus is called so."""
        for _ in range(300):
            self.page.keyboard.press(key)
            if self.at().startswith(name):
                return
        raise AssertionError(f"no stop is called {name}")

    def moves(self, *keys: str) -> str:
        """Where the handle in focus stands after some keys, which is not where it stood."""
        before = self.page.evaluate(VALUE)
        self.press(*keys)
        now = self.page.evaluate(OTHER, before)
        assert now != before
        return now

    def press(self, *keys: str) -> None:
        for key in keys:
            self.page.keyboard.press(key)

    def read(self, selector: str) -> str:
        self.page.wait_for_selector(f"{selector}:not(:empty)")
        return self.page.locator(selector).first.inner_text()

    def question_and_solution(self) -> None:
        """The first question of *Check yourself*, and the first exercise."""
        self.go("Question 1")
        self.press("Enter")
        self.go("A. ")
        self.press("Space")
        self.go("Check")
        self.press("Enter")
        assert self.page.locator("form.quiz .why:visible").count() == 1
        self.go("Your answer")
        self.press("1", "Enter")
        assert "You gave 1" in self.read(".exercise-answer output")
        self.go("Solution of exercise 1")
        self.press("Enter")
        assert self.page.evaluate(OPEN) and not self.opened.problems


@pytest.fixture
def lesson(site, visit):
    return lambda name: Keys(visit(f"{site}/book/{name}.html", reduced_motion="reduce"))


def test_feedback(lesson):
    """And buttons that copy have names of their own."""
    keys = lesson("feedback")
    names = keys.page.locator("article button.copybtn").evaluate_all(
        "(buttons) => buttons.map((button) => button.getAttribute('aria-label'))"
    )
    assert len(names) == len(set(names)) > 5 and all(name.startswith("Copy code") for name in names)
    keys.go("It swings for a shorter time")
    keys.press("Space")
    keys.go("Try it")
    keys.press("Enter")
    assert keys.at() == "Next question" and keys.read(".ask .told")
    keys.go("Proportional gain")
    keys.moves("End")
    keys.question_and_solution()
