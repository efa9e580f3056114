"""Check yourself, and the questions before and after: what is asked, how a page takes answers."""

import shutil

import gains
import prose
import pytest
from axe import violations_in
from book_pages import ROOT, TEN, WALK
from lessons import questions

ASKED = {page: asked for page in WALK if (asked := questions(ROOT, page))}
TWELVE = questions(ROOT, "book/before-and-after")
PAGE = WALK[1]
DENIED = "Object.defineProperty(window, 'localStorage', {get() { throw new Error('denied'); }})"


def test_questions_explain_every_answer_and_one_is_right():
    assert len(ASKED) >= 20
    for question in (question for asked in [*ASKED.values(), TWELVE] for question in asked):
        answers = question["answers"]
        assert sum(answer.get("right", False) for answer in answers) == 1, question
        assert 3 <= len(answers) == len({answer["text"] for answer in answers}), question
        assert all(len(answer["why"].split()) >= 5 for answer in answers), question
        texts = [answer[key] for answer in answers for key in ("text", "why")]
        texts.append(question["question"])
        if question not in TWELVE:  # of invented machines
            assert not [t for t in texts if prose.typed_numbers(prose.sentence(t))]


def test_the_right_answer_does_not_stand_out():
    """By chance each place would have it in a third of the questions, and so would the longest."""
    answers = [question["answers"] for asked in ASKED.values() for question in asked]
    places = [[a.get("right", False) for a in each].index(True) for each in answers]
    assert min(places.count(k) for k in range(3)) > len(places) / 5
    longest = [max(each, key=lambda a: (len(a["text"]), a.get("right", False))) for each in answers]
    share = sum(answer.get("right", False) for answer in longest) / len(answers)
    assert 0.25 < share < 0.4


def test_twelve_questions_of_four_answers_give_nothing_away():
    """Nor do they repeat a lesson's own, which a class has seen in between."""
    assert len(TWELVE) == 12 and all(len(one["answers"]) == 4 for one in TWELVE)
    assert {f"book/{one['again']}" for one in TWELVE} <= {*TEN}
    letters = "".join(gains.RIGHT.values())
    assert max(map(letters.count, "ABCD")) < 6 and min(map(letters.count, "ABCD")) > 0
    lengths = [
        sorted((len(a["text"]), a.get("right", False)) for a in one["answers"]) for one in TWELVE
    ]
    assert 1 <= sum(four[-1][1] for four in lengths) <= 5 >= sum(four[0][1] for four in lengths)
    lessons = {one["question"] for asked in ASKED.values() for one in asked}
    assert not lessons & {one["question"] for one in TWELVE}


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


def taken(page, time, letters):
    """Answer all that has a letter, finish, and save; the file's path."""
    page.get_by_role("button", name=f"Begin: {time} the course").click()
    for form, letter in zip(page.locator("form.quiz").all(), letters):
        assert not form.locator(".whys").is_visible()
        if letter != "-":
            form.locator("input").nth("ABCD".index(letter)).check()
    page.get_by_role("button", name="Finish").click()
    if "-" in letters:
        page.get_by_role("button", name="Finish").click()
    with page.expect_download() as file:
        page.get_by_role("button", name="Save as a file").click()
    return file.value.path()


@pytest.mark.browser
@pytest.mark.parametrize("stored", [True, False])
def test_twelve_questions_before_and_after(stored, site, visit, tmp_path):
    """What is right is told at the second time; both files make a gain, which is known by hand."""
    page = visit(f"{site}/book/before-and-after.html").page
    if not stored:
        page.add_init_script(DENIED)
        page.reload()
    right = "".join(gains.RIGHT.values())
    before = "-" + right[1:4] + "".join("ABCD"["ABCD".index(x) - 1] for x in right[4:])
    after = right[:6] + before[6:]
    page.get_by_label("Your name or number").fill("ada")
    shutil.copy(taken(page, "before", before), tmp_path / "one.csv")
    assert not page.locator("form.quiz:visible").count()
    if stored:
        page.reload()
        assert page.get_by_label("Your name or number").input_value() == "ada"
        assert page.get_by_role("button", name="Begin: before the course").is_disabled()
    shutil.copy(taken(page, "after", after), tmp_path / "two.csv")
    first = page.locator("form.quiz").first
    assert f"Before the course: none. After the course: {right[0]}." in first.inner_text()
    assert first.locator(".why:visible").all_inner_texts()[0].startswith(f"{right[0]} is right.")
    assert first.get_by_role("link").get_attribute("href") == f"{TWELVE[0]['again']}.html"
    assert page.locator("form.quiz").last.locator(".why:visible").count() == 2
    assert not violations_in(page, "light", "dark")
    told = gains.told(gains.answered(tmp_path))
    assert "1 of 1 students" in told and f"gain {(6 - 3) / (12 - 3):.2f}" in told
    page.once("dialog", lambda dialog: dialog.accept())
    page.get_by_role("button", name="Erase my answers").click()
    assert not page.locator("form.quiz:visible").count()
    assert page.get_by_role("button", name="Save as a file").is_disabled()


def test_files_of_other_questions_are_refused(tmp_path):
    (tmp_path / "ada.csv").write_text("student,time,key,answer\nada,before,quiz-1,A\n", "utf-8")
    with pytest.raises(ValueError, match=r"ada\.csv must have the twelve questions"):
        gains.answered(tmp_path)


@pytest.mark.built
def test_without_scripts_the_twelve_questions_do_not_tell(parsed):
    forms = parsed("book/before-and-after").select(".twice form.quiz")
    assert len(forms) == 12
    for form in forms:
        assert len(form.select("label.choice")) == 4
        form.select_one("template").extract()
        assert "is right" not in form.get_text() and not form.select(".why, .right")
