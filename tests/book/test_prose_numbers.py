"""Numbers near results are computed and quoted, not typed: sentence by sentence."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import prose
import pytest
import yaml
from book_pages import API, PAGES, ROOT, source

ELSEWHERE = {"book/provenance", *API}  # pages of parameters and of signatures
ALLOWED = yaml.safe_load(
    (ROOT / "tests" / "support" / "allowed_numbers.yml").read_text(encoding="utf-8")
)
REASONS = {"parameter", "criterion", "mathematics", "literature", "printed"}
READ = [page for page in PAGES if page not in ELSEWHERE]


def allowed(page: str) -> list[str]:
    return [entry["text"] for entry in ALLOWED.get(page.removeprefix("book/"), [])]


@cache
def read(page: str) -> list[prose.Sentence]:
    path = source(page)
    return list(prose.sentences(path)) if path else []


@pytest.mark.parametrize("page", READ)
def test_results_are_quoted(page):
    found = {
        one.text: numbers
        for one in read(page)
        if (numbers := prose.typed_numbers(one, allowed(page)))
    }
    assert not found, "quote these with {glue:text}, or give a reason in allowed_numbers.yml"


def test_allowed_numbers_have_a_reason_and_a_page():
    assert set(ALLOWED) <= {page.removeprefix("book/") for page in READ}
    for entries in ALLOWED.values():
        for entry in entries:
            assert set(entry) == {"text", "why"} and entry["why"] in REASONS, entry


@pytest.mark.parametrize("page", [page for page in READ if allowed(page)])
def test_allowed_numbers_are_needed(page):
    """An entry that is not in the page, or that nothing complains about without, has to go."""
    for text in allowed(page):
        others = [other for other in allowed(page) if other != text]
        needed = any(text in one.bare and prose.typed_numbers(one, others) for one in read(page))
        assert needed, f"{text!r} is not needed"


@pytest.mark.parametrize(
    "planted, numbers",
    [
        ("The median error is 0.15 at window 21.", ["0.15"]),
        ("At window 21 the RMSS falls to 0.44, at 41 to 0.51.", ["0.44", "0.51"]),
        ("It costs 12.5 % of the torque.", ["12.5"]),
        ("Training is 18 times faster.", ["18"]),
        ("The knock reaches −3.2 N m.", ["−3.2"]),
        ("*Half a year later* the error is 1.2e-3 and falls.", ["1.2e-3"]),
        ("The test error is least at 33 samples.", ["33"]),
        ("Of the weights 1,234 are noise.", ["1,234"]),
        ("The error is {glue:text}`a-b:.2f`, or 23 % of the torque.", ["23"]),
        ("An overshoot of 1 %, or of 1 N m.", ["1", "1"]),
        ("The paper prints 0.22; the error here is 0.69.", ["0.69"]),
        ("Figure 5-4 has an error of 0.3 in trajectory 6.", ["0.3"]),
    ],
)
def test_typed_results_are_found(planted, numbers):
    assert prose.typed_numbers(prose.sentence(planted)) == numbers


@pytest.mark.parametrize(
    "fine",
    [
        "The median error is {glue:text}`size-test-21:.2f` at window 21.",
        "The paper prints an error of 0.22 at window 11.",
        "Torque and position were measured every 10 ms for 300 samples.",
        "In Figures 5-4 to 5-6 and Table 4-1 errors are pooled; see section 5.1.",
        "Goldberg's torques of 1988 are lost.",
        "An RMSS of 1 is no better than the mean, and 0 is perfect.",
        "The error $e = 0.5$ and `rmss(x, 0.5)` are mathematics and code.",
        "The 25 networks of windows 11, 21 and 41 have errors after 20,000 epochs.",
        "The joint weights of joint 2 and links 2 to 6.",
        "It lies 17 km from here.",
    ],
)
def test_names_and_settings_are_no_results(fine):
    assert prose.typed_numbers(prose.sentence(fine)) == []


def test_allowed_pieces_are_whole_numbers():
    one = prose.sentence("A torque of 0.5 N m is less than 5 N m.")
    assert prose.typed_numbers(one, ["5 N m"]) == ["0.5"]


def test_a_planted_sentence_in_a_page_is_found(tmp_path):
    path = tmp_path / "page.md"
    plain = "# Errors of 0.4\n\n```\nerror 0.5\n```\n\nAll is well.\n\n**1. Error.** Reach 0.6.\n"
    path.write_text(plain)
    assert [n for one in prose.sentences(path) for n in prose.typed_numbers(one)] == []
    path.write_text(plain + "\nHere the error is 0.7. It falls.\n")
    assert [n for one in prose.sentences(path) for n in prose.typed_numbers(one)] == ["0.7"]


def test_captions_and_alternative_texts_are_read(tmp_path):
    import nbformat

    code = (
        "figures.curves(x, 'The training error falls from 0.36 to the end.',"
        " f'The test error falls from {a:.2f} to 0.25 in the end.')"
    )
    cell = nbformat.v4.new_code_cell(code)
    cell.metadata["mystnb"] = {"figure": {"caption": "The error is 0.47.\n"}}
    notebook = nbformat.v4.new_notebook(cells=[cell])
    path = Path(tmp_path) / "page.ipynb"
    nbformat.write(notebook, path)
    found = [n for one in prose.sentences(path) for n in prose.typed_numbers(one)]
    assert sorted(found) == ["0.25", "0.36", "0.47"]
