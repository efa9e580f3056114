"""Answers to exercises, judged with a kernel and in the page: both say the same."""

from decimal import Decimal
from fractions import Fraction

import numpy as np
import pytest
import sympy
import torch
from book_pages import CHAPTERS, ROOT

from workshop.chapters.exercises import (
    Between,
    Exercise,
    MultipleOf,
    OneOf,
    Waiting,
    fitting,
    judge,
    judging,
)

ANY = np.nan
CASES = {
    "number": (
        Exercise("number", 12.0, "yes.", [(6.0, "half."), (Between(100), "too much.")], "no.",
                 unit="kg"),
        {"12": "Right: yes.", "12.1": "Right: yes.", "[12]": "Right: yes.", "6,0": "Wrong: half.",
         "24/2": "Right: yes.", "1e3": "Wrong: too much.", "−12": "Wrong: no.",
         "12.3": "Wrong: close, but not within 2 %", "14.3": "Wrong: close", "14.5": "Wrong: no.",
         "1e20": "Wrong: too much.", "1.25e-7": "Wrong: no.", "1e25": "Wrong: too much."},
    ),
    "range": (
        Exercise("number", Between(0.1, 0.3), "yes.", [], "no."),
        {"0.2": "Right: yes.", "1/5": "Right: yes.", "0.31": "Wrong: close, but not close",
         "0.34": "Wrong: no.", "25 %": "Right: yes.",
         "[.2]": "Right: yes."},
    ),
    "word": (
        Exercise("word", "larger", "yes.", [("alike", "not quite.")], "no.",
                 options=("larger", "alike", "smaller")),
        {"larger": "Right: yes.", '"Larger"': "Right: yes.", '"larger "': "Right: yes.",
         "alike": "Wrong: not quite.", "smaller": "Wrong: no.",
         '"banana"': 'Not judged: write "larger", "alike" or "smaller".'},
    ),
    "words": (
        Exercise("word", OneOf("up", "down"), "yes.", [], "no."),
        {'"up"': "Right: yes.", '"Down"': "Right: yes.", '"left"': "Wrong: no."},
    ),
    "numbers": (
        Exercise("numbers", [1.0, -2.0], "yes.", [((ANY, 2.0), "its sign.")], "no."),
        {"1, -2": "Right: yes.", "(1, −2)": "Right: yes.", "[[1, -2]]": "Right: yes.",
         "1, 2": "Wrong: its sign.", "9, 2": "Wrong: its sign.", "2, 1": "Wrong: no."},
    ),
    "one of several": (
        Exercise("number", OneOf(3.0, 5.0, Between(7, 9)), "yes.", [(OneOf(2.0, 4.0), "odd.")],
                 "no.", 1e-9),
        {"3": "Right: yes.", "5.0": "Right: yes.", "8": "Right: yes.", "4": "Wrong: odd.",
         "3.01": "Wrong: no."},
    ),
    "multiple": (
        Exercise("numbers", MultipleOf([-2.0, 1.0]), "yes.", [], "no."),
        {"-2, 1": "Right: yes.", "4, −2": "Right: yes.", "0, 0": "Wrong: no.",
         "2, 1": "Wrong: no."},
    ),
    "where it fits": (
        Exercise("number", fitting(lambda x: 1 < abs(x) < 2, range(-4, 4)), "never.", [], "no."),
        {"1.5": "Wrong: no."},
    ),
    "where it fits, closely enough": (
        Exercise("number", fitting(lambda x: 1 < abs(x) < 2, np.arange(-2, 2, 0.1)), "yes.", [],
                 "no."),
        {"1.001": "Right: yes.", "-1.001": "Right: yes.", "-1.999": "Right: yes.",
         "0.999": "Wrong: close", "2.001": "Wrong: close", "2.3": "Wrong: no."},
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


def printed(answer, case, capsys) -> str:
    judge(answer, case)
    return capsys.readouterr().out.strip()


@pytest.mark.parametrize("kind", CASES)
def test_answers_with_a_kernel(kind, capsys):
    case, answers = CASES[kind]
    for text, wanted in answers.items():
        assert printed(value(text), case, capsys).startswith(wanted), text
    assert "in place of the dots" in printed(..., case, capsys)


NUMBER = Exercise("number", 11.0, "yes.", unit="kg")
PAIR = Exercise("numbers", (1.0, 2.0), "yes.")
ARRAY = Exercise("array", lambda x: x @ x == 3, "yes.", count=3)
WORD = Exercise("word", "larger", "yes.", options=("larger", "smaller"))
DOUBLE = Exercise("function", lambda f: np.isclose(f(3.0), 6.0), "yes.")
WHOLE = Exercise("numbers", lambda x: [10, 20, 30][x[0]] == 20, "yes.", count=2, whole=True)


@pytest.mark.parametrize(
    "case, answer",
    [
        *((NUMBER, a) for a in (11, 11.0, np.float32(11), np.array(11), [11], (11,), [[11]], "11")),
        *((NUMBER, a) for a in (Fraction(11), Decimal(11), sympy.Integer(11), torch.tensor(11.0))),
        *((PAIR, a) for a in ([1, 2], (1, 2.0), np.array([1, 2]), [[1], [2]], [Fraction(1), 2])),
        *((ARRAY, a) for a in ([1, 1, 1], (1.0, 1, 1), np.ones(3), np.ones((1, 3)))),
        *((WORD, a) for a in ("larger", " LARGER. ", ["Larger"], np.array("larger"), "'larger'")),
        *((DOUBLE, a) for a in (lambda x: 2 * x, lambda x: np.array([2 * x]))),
        *((WHOLE, a) for a in ((1, 0), [1.0, 0.0], np.array([1, 0]))),
    ],
)
def test_what_means_the_same_is_right(case, answer, capsys):
    assert printed(answer, case, capsys).startswith("Right: yes.")


@pytest.mark.parametrize(
    "case, answer, said",
    [
        (NUMBER, np.nan, "Not judged: NaN is no number."),
        (NUMBER, np.inf, "Not judged: infinity is no answer here."),
        (NUMBER, 11 + 1j, "Not judged: your answer is complex, (11+1j)."),
        (NUMBER, "eleven", "Not judged: one number is asked, and your answer is 'eleven'."),
        (NUMBER, [11, 11], "Not judged: one number is asked, and you gave 2."),
        (PAIR, (1, ...), "Not judged: 2 numbers are asked, and your answer is (1, Ellipsis)."),
        (ARRAY, np.ones(4), "Not judged: 3 numbers are asked, and you gave 4."),
        (WORD, "lager", 'Not judged: write "larger" or "smaller".'),
        (DOUBLE, 6, "Not judged: a function is asked, and your answer is 6."),
        (DOUBLE, lambda x: 1 / 0, "Your function raised ZeroDivisionError: division by zero; not"),
        (DOUBLE, lambda x: None, "Your function returned None; not judged."),
        (WHOLE, (9, 0), "Not judged: with your answer the check raised IndexError: list index"),
        (WHOLE, (0.5, 0), "Not judged: whole numbers are asked, and your answer is (0.5, 0)."),
    ],
)
def test_what_is_no_answer_is_refused_with_the_reason(case, answer, said, capsys):
    assert printed(answer, case, capsys).startswith(said)


def test_no_answer_is_judged_twice(capsys):
    space = {"check": judging(lambda number: NUMBER), "mine": 11}
    for begins in ("Right: yes. You gave 11 kg.", "Put your answer in place of the dots"):
        exec("check(1, mine)", space)
        assert capsys.readouterr().out.startswith(begins)
    exec("mine = 11\ncheck(1, 3)", space)
    assert space["mine"] == 11  # what was judged is another answer


def test_what_only_code_can_answer_is_not_judged_in_the_page():
    waiting = Waiting(Exercise("number", lambda x: x > 1, "yes."))
    assert waiting.data() is None and "data-judge" not in waiting._repr_html_()
    assert Waiting(Exercise("number", OneOf(), "yes.")).data() is None
    assert Waiting(Exercise("array", np.zeros(21), "yes.")).data() is None


@pytest.mark.browser
def test_answers_in_the_page(tmp_path, visit, capsys):
    script = (ROOT / "book" / "_static" / "answers.js").read_text(encoding="utf-8")
    made = [Waiting(CASES[kind][0])._repr_html_() for kind in JUDGED]
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
        case, answers = CASES[kind]
        said = {text: printed(value(text), case, capsys) for text in answers}
        said |= dict.fromkeys(TWELVE, said["12"]) if kind == "number" else {}
        for text, wanted in said.items():
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
