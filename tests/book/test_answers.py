"""Answers to exercises, judged with a kernel and in the page: both say the same."""

import numpy as np
import pytest
from book_pages import CHAPTERS, ROOT

from workshop.chapters.exercises import Between, MultipleOf, OneOf, Waiting, fitting, judge

ANY = np.nan
CASES = {
    "number": (
        (12.0, "yes.", [(6.0, "half."), (Between(100), "too much.")], "no."),
        {"12": "Right: yes.", "12.1": "Right: yes.", "[12]": "Right: yes.", "6,0": "Wrong: half.",
         "24/2": "Right: yes.", "1e3": "Wrong: too much.", "−12": "Wrong: no."},
    ),
    "range": (
        (Between(0.1, 0.3), "yes.", [], "no."),
        {"0.2": "Right: yes.", "1/5": "Right: yes.", "0.31": "Wrong: no.", "25 %": "Right: yes.",
         "[.2]": "Right: yes."},
    ),
    "word": (
        ("larger", "yes.", [("alike", "not quite.")], "no."),
        {"larger": "Right: yes.", '"Larger"': "Right: yes.", '"larger "': "Right: yes.",
         "alike": "Wrong: not quite.", "smaller": "Wrong: no."},
    ),
    "words": (
        (OneOf("up", "down"), "yes.", [], "no."),
        {'"up"': "Right: yes.", '"Down"': "Right: yes.", '"left"': "Wrong: no."},
    ),
    "numbers": (
        ([1.0, -2.0], "yes.", [((ANY, 2.0), "its sign.")], "no."),
        {"1, -2": "Right: yes.", "(1, −2)": "Right: yes.", "[[1, -2]]": "Right: yes.",
         "1, 2": "Wrong: its sign.", "9, 2": "Wrong: its sign.", "2, 1": "Wrong: no."},
    ),
    "one of several": (
        (OneOf(3.0, 5.0, Between(7, 9)), "yes.", [(OneOf(2.0, 4.0), "odd.")], "no.", 1e-9),
        {"3": "Right: yes.", "5.0": "Right: yes.", "8": "Right: yes.", "4": "Wrong: odd.",
         "3.01": "Wrong: no."},
    ),
    "multiple": (
        (MultipleOf([-2.0, 1.0]), "yes.", [], "no."),
        {"-2, 1": "Right: yes.", "4, −2": "Right: yes.", "0, 0": "Wrong: no.",
         "2, 1": "Wrong: no."},
    ),
    "where it fits": (
        (fitting(lambda x: 1 < abs(x) < 2, range(-4, 4)), "never.", [], "no."),
        {"1.5": "Wrong: no."},
    ),
    "where it fits, closely enough": (
        (fitting(lambda x: 1 < abs(x) < 2, np.arange(-2, 2, 0.1)), "yes.", [], "no."),
        {"1.001": "Right: yes.", "-1.001": "Right: yes.", "-1.999": "Right: yes.",
         "0.999": "Wrong: no.", "2.001": "Wrong: no."},
    ),
}  # fmt: skip
UNFIT = {
    "number": ["", "about 12", "NaN", "inf", "12 or 13", "1, 2", "alert(1)", "4pi", "(12", "12)"],
    "numbers": ["1", "1, 2, 3", "one, two"],
}
JUDGED = [kind for kind in CASES if kind != "where it fits"]
# What stands for the same number in the page alone.
TWELVE = ["12.", "12 kg m²", "12 s", "12°", "mine = 12", "10 + 2", "4 * 3", "3·4", "2 * (1 + 5)",
          "144 ** 0.5", "144**(1/2)", "np.sqrt(144)", "√144", "sqrt(144)", "-(-12)", "2**3 + 2^2",
          "4!/2", "1,200/100", "1 200 %", "1_200 / 100", "24 - 3 * 4", "12 rad/s^2",
          "12 N m/rad", "(12)", "6 * 6 / 3"]  # fmt: skip


def value(text: str):
    """A text as the answer that it stands for."""
    text = text.replace("−", "-").replace("6,0", "6.0")
    if text.endswith("%"):
        return float(text[:-1]) / 100
    return eval(text, {}, {word: word for word in ("larger", "alike", "smaller")})


@pytest.mark.parametrize("kind", CASES)
def test_answers_with_a_kernel(kind, capsys):
    case, answers = CASES[kind]
    for text, wanted in answers.items():
        judge(value(text), *case)
        assert capsys.readouterr().out.strip() == wanted, text
    judge(..., *case)
    assert "in place of the dots" in capsys.readouterr().out


def test_what_only_code_can_answer_is_not_judged_in_the_page():
    waiting = Waiting([(lambda x: x > 1, "Right: yes.")], "Wrong: no.", 0.02)
    assert waiting.data() is None and "data-judge" not in waiting._repr_html_()
    never = Waiting([(OneOf(), "Right: yes.")], "Wrong: no.", 0.02)
    assert never.data() is None
    wide = Waiting([(np.zeros(21), "Right: yes.")], "Wrong: no.", 0.02)
    assert wide.data() is None


@pytest.mark.browser
def test_answers_in_the_page(tmp_path, visit):
    script = (ROOT / "book" / "_static" / "answers.js").read_text(encoding="utf-8")
    made = []
    for kind in JUDGED:
        (right, told, slips, otherwise, *tolerance), _ = CASES[kind]
        cases = [(right, f"Right: {told}"), *((s, f"Wrong: {why}") for s, why in slips)]
        made.append(Waiting(cases, f"Wrong: {otherwise}", *tolerance or [0.02])._repr_html_())
    path = tmp_path / "page.html"
    above = "<div class='cell'><pre>mine = ...  # a share, from 0 to 1\n</pre></div>"
    style = "<style>.is-asked-below { display: none }</style>"
    cells = above + "".join(f"<div class='cell'>{one}</div>" for one in made)
    path.write_text(f"<!doctype html><meta charset='utf-8'>{style}{cells}<script>{script}</script>")
    page = visit(path.as_uri()).page
    assert page.locator("pre").is_hidden()
    labels = page.locator("label").all_inner_texts()
    assert labels[0] == "Your answer: a share, from 0 to 1" and labels[4].startswith("Your answers")
    for k, kind in enumerate(JUDGED):
        form = page.locator("form").nth(k)
        same = dict.fromkeys(TWELVE, "Right: yes.") if kind == "number" else {}
        for text, wanted in {**CASES[kind][1], **same}.items():
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
