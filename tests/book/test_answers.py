"""Answers to exercises, judged with a kernel and in the page: both say the same."""

import numpy as np
import pytest
from book_pages import CHAPTERS, ROOT

from workshop.chapters.exercises import Between, Waiting, judge

CASES = {
    "number": (
        (12.0, "yes.", [(6.0, "half."), (Between(100), "too much.")], "no."),
        {"12": "Right: yes.", "12.1": "Right: yes.", "6,0": "Wrong: half.", "24/2": "Right: yes.",
         "1e3": "Wrong: too much.", "−12": "Wrong: no."},
    ),
    "range": (
        (Between(0.1, 0.3), "yes.", [], "no."),
        {"0.2": "Right: yes.", "1/5": "Right: yes.", "0.31": "Wrong: no.", "25 %": "Right: yes."},
    ),
    "word": (
        ("larger", "yes.", [("alike", "not quite.")], "no."),
        {"larger": "Right: yes.", '"Larger"': "Right: yes.", "alike": "Wrong: not quite.",
         "smaller": "Wrong: no."},
    ),
    "numbers": (
        ([1.0, -2.0], "yes.", [], "no."),
        {"1, -2": "Right: yes.", "(1, −2)": "Right: yes.", "1, 2": "Wrong: no."},
    ),
}  # fmt: skip
UNFIT = {"number": ["", "about 12", "NaN", "inf"], "numbers": ["1", "1, 2, 3", "one, two"]}


def value(text: str):
    """A text as the answer that it stands for."""
    text = text.replace("−", "-").replace("6,0", "6.0")
    if text.endswith("%"):
        return float(text[:-1]) / 100
    return eval(text, {}, {word: word for word in ("larger", "alike", "smaller")})


@pytest.mark.parametrize("kind", CASES)
def test_answers_with_a_kernel(kind, capsys):
    (right, told, slips, otherwise), answers = CASES[kind]
    for text, wanted in answers.items():
        judge(value(text), right, told, slips, otherwise)
        assert capsys.readouterr().out.strip() == wanted, text
    judge(..., right, told, slips, otherwise)
    assert "in place of the dots" in capsys.readouterr().out


def test_what_only_code_can_answer_is_not_judged_in_the_page():
    waiting = Waiting([(lambda x: x > 1, "Right: yes.")], "Wrong: no.", 0.02)
    assert waiting.data() is None and "data-judge" not in waiting._repr_html_()
    wide = Waiting([(np.zeros(21), "Right: yes.")], "Wrong: no.", 0.02)
    assert wide.data() is None


@pytest.mark.browser
def test_answers_in_the_page(tmp_path, visit):
    script = (ROOT / "book" / "_static" / "answers.js").read_text(encoding="utf-8")
    made = []
    for (right, told, slips, otherwise), _ in CASES.values():
        cases = [(right, f"Right: {told}"), *((s, f"Wrong: {why}") for s, why in slips)]
        made.append(Waiting(cases, f"Wrong: {otherwise}", 0.02)._repr_html_())
    path = tmp_path / "page.html"
    path.write_text(
        f"<!doctype html><meta charset='utf-8'>{''.join(made)}<script>{script}</script>"
    )
    page = visit(path.as_uri()).page
    for k, (kind, (_, answers)) in enumerate(CASES.items()):
        form = page.locator("form").nth(k)
        for text, wanted in answers.items():
            form.locator("input").fill(text)
            form.locator("input").press("Enter")
            assert form.locator("output").inner_text() == wanted, text
        for text in UNFIT.get(kind, ()):
            form.locator("input").fill(text)
            form.locator("button").click()
            assert form.locator("output").inner_text().startswith("Write"), text


@pytest.mark.built
def test_no_page_says_to_run_a_cell_again(parsed):
    judged = 0
    for page in CHAPTERS:
        places = parsed(page).select(".exercise-answer")
        assert len(places) >= 3, page
        judged += sum(place.has_attr("data-judge") for place in places)
    assert judged > len(CHAPTERS)
