"""Check yourself: what is asked, and how a page takes answers."""

import prose
import pytest
from axe import violations_in
from book_pages import ROOT, WALK
from lessons import questions

ASKED = {page: asked for page in WALK if (asked := questions(ROOT, page))}
PAGE = WALK[1]
DENIED = "Object.defineProperty(window, 'localStorage', {get() { throw new Error('denied'); }})"


def test_questions_explain_every_answer_and_one_is_right():
    assert len(ASKED) >= 20
    for question in (question for asked in ASKED.values() for question in asked):
        answers = question["answers"]
        assert sum(answer.get("right", False) for answer in answers) == 1, question
        assert 3 <= len(answers) == len({answer["text"] for answer in answers}), question
        assert all(len(answer["why"].split()) >= 5 for answer in answers), question
        texts = [answer[key] for answer in answers for key in ("text", "why")]
        texts.append(question["question"])
        assert not [t for t in texts if prose.typed_numbers(prose.sentence(t))]


def test_the_right_answer_does_not_stand_out():
    """By chance each place would have it in a third of the questions, and so would the longest."""
    answers = [question["answers"] for asked in ASKED.values() for question in asked]
    places = [[a.get("right", False) for a in each].index(True) for each in answers]
    assert min(places.count(k) for k in range(3)) > len(places) / 5
    longest = [max(each, key=lambda a: (len(a["text"]), a.get("right", False))) for each in answers]
    share = sum(answer.get("right", False) for answer in longest) / len(answers)
    assert 0.25 < share < 0.4


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
