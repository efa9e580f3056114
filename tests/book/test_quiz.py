"""Check yourself: what is asked, and how a page takes answers."""

import sys

import prose
import pytest
from axe import violations_in
from book_pages import ROOT, WALK

sys.path.insert(0, str(ROOT / "book" / "_ext"))
import dd_quiz
import dd_search

ASKED = {page: dd_quiz.questions(ROOT, page) for page in WALK}
PAGE = WALK[1]
DENIED = "Object.defineProperty(window, 'localStorage', {get() { throw new Error('denied'); }})"


def test_each_lesson_asks_and_explains_every_answer():
    assert all(3 <= len(asked) <= 5 for asked in ASKED.values())
    places = []
    for one in (one for asked in ASKED.values() for one in asked):
        answers = one["answers"]
        right = [k for k, answer in enumerate(answers) if answer.get("right")]
        assert len(right) == 1 and 3 <= len(answers) == len({a["text"] for a in answers}), one
        assert all(len(answer["why"].split()) >= 5 for answer in answers), one
        texts = [one["question"], *(answer[key] for answer in answers for key in ("text", "why"))]
        assert not [t for t in texts if prose.typed_numbers(prose.sentence(t))]
        places += right
    assert min(places.count(k) for k in range(3)) > len(places) / 5  # none stands out


def test_the_right_answer_does_not_stand_out_by_its_length():
    """By chance it would be the longest in a third of the questions."""
    answers = [one["answers"] for asked in ASKED.values() for one in asked]
    longest = [max(each, key=lambda answer: (len(answer["text"]), answer.get("right", False)))
               for each in answers]  # fmt: skip
    share = sum(answer.get("right", False) for answer in longest) / len(answers)
    assert 0.25 < share < 0.4


def test_a_readers_notebook_asks_with_folded_answers():
    told = dd_quiz.with_markdown("Before.\n\n## On your own\n\nAfter.", ROOT, PAGE)
    assert told.startswith("Before.\n\n## Check yourself\n\n**1.** ")
    assert told.endswith("</details>\n\n## On your own\n\nAfter.")
    assert told.count("<details>") == len(ASKED[PAGE])


@pytest.mark.built
def test_pages_ask_before_the_exercises(parsed, built):
    """With answers in folds, for whoever has no script; the search does not find them."""
    texts = (built / "_static" / dd_search.FILE).read_text("utf-8")
    assert '"check-yourself":' not in texts
    for page, asked in ASKED.items():
        section = parsed(page).select_one("#check-yourself")
        assert section.find_next_sibling("section")["id"] == "on-your-own"
        assert len(section.select("form fieldset > legend")) == len(asked)
        assert len(section.select("details.answer:not([open]) .why.right")) == len(asked)


@pytest.mark.browser
@pytest.mark.parametrize("stored", [True, False])
def test_answers_by_keyboard_alone(stored, site, visit):
    """A wrong one is explained, a right one told and kept, until all are erased."""
    page = visit(f"{site}/{PAGE}.html").page
    if not stored:
        page.add_init_script(DENIED)
        page.reload()
    form, told = page.locator("form.quiz").nth(1), page.locator(".quiz-told")
    number, inputs = page.locator(".quiz-numbers button").nth(1), form.locator("input")
    assert not page.locator("form.quiz:visible").count()
    number.press("Enter")
    right = [bool(answer.get("right")) for answer in ASKED[PAGE][1]["answers"]]
    inputs.nth(0).focus()
    for k in sorted(range(3), key=right.__getitem__):
        page.keyboard.press("Space")
        while not inputs.nth(k).is_checked():
            page.keyboard.press("ArrowDown")
        page.keyboard.press("Tab")
        page.keyboard.press("Enter")
        (said,) = form.locator("[aria-live] > :visible").all_inner_texts()
        assert said.startswith(f"{'ABC'[k]} is {'right' if right[k] else 'wrong'}")
        assert told.inner_text().startswith(f"{int(right[k])} of")
        page.keyboard.press("Shift+Tab")
    assert not violations_in(page, "light", "dark")
    page.reload()
    number.press("Enter")
    assert told.inner_text().startswith(f"{int(stored)} of")
    assert inputs.nth(right.index(True)).is_checked() is stored
    page.get_by_role("button", name="Erase my answers").press("Enter")
    page.reload()
    assert not page.locator(".quiz-numbers .done").count()


def test_the_script_is_small():
    assert (ROOT / "book" / "_static" / "quiz.js").stat().st_size < 6000
