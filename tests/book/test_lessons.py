"""Lessons: what the build knows of one, and what pages and readers' notebooks make of that."""

import dd_quiz
import lessons
import nbformat
import pytest
from book_pages import ROOT

EVERY = lessons.lessons(ROOT)
WITH_OBJECTIVES = [each for each in EVERY if each.objectives]
BARE, FULL = (
    "# Bare\n\nNothing else.\n",
    """# Full\n\nWords.\n\n## Try it yourself

**1. Weigh it** (a derivation). How heavy?\n
**2. Turn it** (a design). How far?\n\n## Further reading\n\n**3. No exercise.**
""",
)


@pytest.fixture
def two(tmp_path):
    """A book of two lessons, of which one has everything, and the other a notebook alone."""
    (tmp_path / "book").mkdir()
    files = "".join(f"  - file: book/{name}\n" for name in ("bare", "full"))
    contents = (
        f"format: jb-book\nroot: book/index\nparts:\n- caption: The walk\n  chapters:\n{files}"
    )
    (tmp_path / "_toc.yml").write_text(contents)
    for name, text in {"bare": BARE, "full": FULL}.items():
        notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_markdown_cell(text)])
        nbformat.write(notebook, tmp_path / "book" / f"{name}.ipynb")
    answers = "[{text: ten, why: w, right: true}, {text: two, why: w}]"
    quiz = f"full:\n- question: How many?\n  answers: {answers}\n"
    (tmp_path / "book" / "quizzes.yml").write_text(quiz)
    objectives = "full:\n- can: count it\n  by: [exercise 2, question 1]\n"
    (tmp_path / "book" / "objectives.yml").write_text(objectives)
    return tmp_path


def test_a_lesson_needs_a_notebook_and_a_line_in_the_contents(two):
    bare, full = lessons.walk(two)
    assert lessons.chapters(two) == [bare.path, full.path] and bare.headings == ["Bare"]
    assert not (bare.exercises or bare.questions or bare.objectives)
    assert dd_quiz.with_questions("## Try it yourself\n", bare) == "## Try it yourself\n"
    assert lessons.lesson(two, "book/none") is None


def test_what_stands_beside_a_lesson_is_found_by_its_name(two):
    full = lessons.lesson(two, "book/full")
    assert full.exercises == [
        lessons.Exercise(1, "Weigh it", "derivation", 15),
        lessons.Exercise(2, "Turn it", "design", 20),
    ]
    (question,) = full.questions
    right = [answer["verdict"] for answer in question["answers"] if answer.get("right")]
    assert right[0] in ("A is right.", "B is right.")
    assert [full.anchor(test) for test in full.objectives[0].by] == [
        "exercise-2",
        f"quiz-{question['key']}",
    ]
    text = dd_quiz.with_questions("Before.\n\n## Try it yourself\n\nAfter.", full)
    assert "## Try it yourself\n\n### Check yourself\n\n**1.** How many?" in text
    assert text.count("<details>") == 1 and text.endswith("</details>\n\nAfter.")


def test_exercises_are_numbered_in_order():
    numbers = {each.name: [exercise.number for exercise in each.exercises] for each in EVERY}
    assert sum(map(bool, numbers.values())) >= 20
    assert not {name: n for name, n in numbers.items() if n != list(range(1, 1 + len(n)))}


@pytest.mark.parametrize("of", WITH_OBJECTIVES, ids=lambda of: of.name)
def test_each_objective_is_tested_and_each_test_has_its_objective(of):
    """And what is more than to say or tell, by something that is computed, derived or designed."""
    tests = {f"exercise {each.number}" for each in of.exercises}
    tests |= {f"question {k}" for k in range(1, 1 + len(of.questions))}
    assert {test for each in of.objectives for test in each.by} == tests
    skills = [each for each in of.objectives if not each.can.startswith(("say ", "tell "))]
    assert skills and all(any("exercise" in test for test in each.by) for each in skills)


@pytest.mark.built
def test_pages_have_their_sections_and_links_that_lead_somewhere(parsed):
    """Questions before exercises; the search does not find wrong answers."""
    for of in EVERY:
        page = parsed(of.page)
        if of.questions:
            first = page.select_one("#try-it-yourself section[id]")
            assert first["id"] == "check-yourself", of.name
        assert len(page.select("#check-yourself form fieldset > legend")) == len(of.questions)
        folds = page.select("#check-yourself details.answer:not([open]) .why.right")
        assert len(folds) == len(of.questions)
    listed = parsed("book/lessons").select("#what-each-lesson-teaches li a[href]")
    assert len(listed) == sum(len(each.by) for of in EVERY for each in of.objectives)
    for link in listed:
        page, _, target = link["href"].partition(".html#")
        assert parsed(f"book/{page}").find(id=target), link
