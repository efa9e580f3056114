"""Words of direction about trained networks are bound to a check: sentence by sentence."""

from __future__ import annotations

import json
from functools import cache

import directions
import prose
import pytest
import yaml
from book_pages import API, PAGES, source

ELSEWHERE = {*API, "book/bibliography"}
READ = [page for page in PAGES if page not in ELSEWHERE]
BOUND = yaml.safe_load(directions.BOUND.read_text(encoding="utf-8")) or {}

NOT_YET: set[str] = set()
"""Pages whose sentences are still to be bound; a page that is done has to leave this set."""


def entries(page: str) -> list[dict]:
    return BOUND.get(page.removeprefix("book/"), [])


@cache
def read(page: str) -> list[prose.Sentence]:
    return list(prose.sentences(source(page)))


def loose(page: str, bound: list[dict]) -> dict[str, list[str]]:
    found = directions.loose(read(page), directions.pieces(bound), directions.subject(page))
    return {one.text: words for one, words in found}


@pytest.mark.parametrize(
    "page",
    [
        pytest.param(page, marks=pytest.mark.xfail(strict=True) if page in NOT_YET else ())
        for page in READ
    ],
)
def test_words_of_direction_are_bound(page):
    found = loose(page, entries(page))
    assert not found, "tie these to a `stated` in bound_words.yml, or quote the value instead"


@pytest.mark.parametrize("page", [page for page in READ if entries(page)])
class TestEntries:
    def test_reason_or_check(self, page):
        there = directions.checks(source(page))
        for entry in entries(page):
            assert set(entry) in ({"text", "by"}, {"text", "why"}), entry
            by = entry.get("by", [])
            missing = {by} - set(there) if isinstance(by, str) else set(by) - set(there)
            assert not missing, f"no `stated` in the page is called {missing}"
            assert entry.get("why", "setting") in directions.REASONS, entry
            if entry.get("why") == "conjecture":
                assert directions.HEDGED.search(entry["text"]), f"says so of itself? {entry}"

    def test_each_is_needed(self, page):
        """An excuse that nothing complains about without has to go; checks may bind any words."""
        for entry in [entry for entry in entries(page) if "why" in entry]:
            others = [other for other in entries(page) if other is not entry]
            needed = set(loose(page, others)) - set(loose(page, entries(page)))
            assert needed, f"{entry['text']!r} is not needed"

    def test_pieces_are_in_the_page(self, page):
        whole = [one.bare for one in read(page)]
        for piece in directions.pieces(entries(page)):
            assert any(piece in bare for bare in whole), f"{piece!r} is not in the page"


def test_pages_exist():
    assert set(BOUND) <= {page.removeprefix("book/") for page in READ}
    assert NOT_YET <= set(READ)


@pytest.mark.parametrize("page", [page for page in READ if source(page).suffix == ".ipynb"])
def test_each_check_stands_behind_a_sentence(page):
    there = directions.checks(source(page))
    assert len(there) == len(set(there)), "two checks of one name"
    used = set()
    for entry in entries(page):
        by = entry.get("by", [])
        used |= {by} if isinstance(by, str) else set(by)
    assert set(there) <= used, "a `stated` that no entry of bound_words.yml refers to"


# --- planted sentences on both sides ------------------------------------------------------


def words(*texts: str, bound=(), about=directions.TRAINED) -> list[str]:
    read = [prose.sentence(text) for text in texts]
    return [word for _, found in directions.loose(read, bound, about) for word in found]


@pytest.mark.parametrize(
    "planted, found",
    [
        ("The training error falls with the window.", ["falls"]),
        ("On trajectory 6 the error is more than twice as large.", ["more", "twice"]),
        ("Most of the fall of the error is over by then.", ["Most", "fall"]),
        ("The weights rise in a straight line.", ["rise"]),
        ("In both networks A and B come out alike.", ["both", "alike"]),
        ("The unit with the largest share is the smoothest filter.", ["largest", "smoothest"]),
        ("Eight of the networks go astray.", ["Eight of"]),
        ("The networks first learn the mass, then friction.", ["first learn the mass, then"]),
        ("The error at 41 is {glue:text}`a-b:.2f`, nearly the same.", ["nearly", "the same"]),
        ("The median rises to {…} at 21.", ["rises"]),
        ("Trained weights are tenfold.", ["tenfold"]),
    ],
)
def test_planted_words_are_found(planted, found):
    assert words(planted) == found


def test_a_sentence_speaks_of_what_the_one_before_spoke_of():
    assert words("Look at the error.", "At window 41 it is larger.") == ["larger"]
    assert words("Look at the error.", "It is quoted here.", "A house is larger.") == []


@pytest.mark.parametrize(
    "fine",
    [
        "The error at window 21 is {glue:text}`size-test-21:.2f`.",
        "The training error {glue:text}`size-direction` with the window.",
        "From the first window to the last the error {…} to {glue:text}`size-last:.2f`.",
        'The paper says of its network that "the errors fall to nearly zero".',
        "The heavier arm falls faster than the lighter one.",
        "An error of $a > b$ in the network.",
        "Is the error of the network larger?",
    ],
)
def test_quoted_words_and_other_things_are_fine(fine):
    assert words(fine) == []


def test_a_bound_piece_frees_its_own_words_only():
    text = "The training error falls with the window, the test error rises."
    assert words(text, bound=["The training error falls"]) == ["rises"]
    assert words(text, bound=["training error falls", "test error rises"]) == []


def test_in_other_chapters_only_networks_count():
    arm = "The error of the controller is larger than its gain error."
    assert words(arm, about=directions.NETWORKS) == []
    assert words(arm + " ", "A network does better.", about=directions.NETWORKS) == ["better"]


def notebook(path, *cells: str):
    import nbformat

    made = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(c) for c in cells])
    nbformat.write(made, path)
    return path


def test_captions_and_alternative_texts_are_read(tmp_path):
    path = notebook(tmp_path / "page.ipynb", "plot(x, 'A curve of the network error that rises.')")
    content = json.loads(path.read_text())
    caption = {"figure": {"caption": "The weights of the network fall.\n"}}
    content["cells"][0]["metadata"]["mystnb"] = caption
    path.write_text(json.dumps(content))
    found = [w for _, found in directions.loose(prose.sentences(path)) for w in found]
    assert sorted(found) == ["fall", "rises"]


def test_checks_of_a_notebook(tmp_path):
    path = notebook(
        tmp_path / "page.ipynb",
        "stated('a', x > 1)\nstated('empty', True)",
        "for w in (1, 2):\n    stated(f'b-{w}', w > 0)\nstated('c', draws, share=0.99)",
    )
    assert directions.checks(path) == ["a", "c"]
    assert directions.checks(tmp_path / "page.md") == []
