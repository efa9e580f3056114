"""Prose says what was computed: numbers are quoted, words of direction are bound to a check."""

from __future__ import annotations

import ast
from functools import cache
from importlib import import_module

import nbformat
import prose
import pytest
import yaml
from book_pages import API, EVIDENCE, EVIDENCE_OF, PAGES, ROOT, WALK, module_of, source

SUPPORT = ROOT / "tests" / "support"
ALLOWED = yaml.safe_load((SUPPORT / "allowed_numbers.yml").read_text(encoding="utf-8"))
REASONS = {"parameter", "criterion", "mathematics", "literature", "printed"}
BOUND = yaml.safe_load((SUPPORT / "bound_words.yml").read_text(encoding="utf-8"))
ELSEWHERE = {"book/provenance", *API}  # pages of parameters and of signatures
NAMES = {page.removeprefix("book/"): page for page in PAGES if page not in ELSEWHERE}


@cache
def read(name: str) -> list[prose.Sentence]:
    return list(prose.sentences(source(NAMES[name])))


def allowed(name: str) -> list[str]:
    return [entry["text"] for entry in ALLOWED.get(name, [])]


def test_results_are_quoted():
    """Quote what is found with {glue:text}, or give a reason in allowed_numbers.yml."""
    typed = {
        (name, one.text): numbers
        for name in NAMES
        for one in read(name)
        if (numbers := prose.typed_numbers(one, allowed(name)))
    }
    assert not typed


def test_allowed_numbers_have_a_reason_and_are_needed():
    """An entry that is not in the page, or that nothing complains about without, has to go."""
    entries = [entry for page in ALLOWED.values() for entry in page]
    assert not [e for e in entries if set(e) != {"text", "why"} or e["why"] not in REASONS]
    idle = []
    for name in ALLOWED:
        for text in allowed(name):
            others = [other for other in allowed(name) if other != text]
            if not any(text in s.bare and prose.typed_numbers(s, others) for s in read(name)):
                idle.append((name, text))
    assert not idle


RESULTS = [
    ("At window 21 the RMSS falls to 0.44, at 41 to 0.51.", ["0.44", "0.51"]),
    ("The knock reaches −3.2 N m.", ["−3.2"]),
    ("The error is {glue:text}`a-b:.2f`, or 23 % of the torque.", ["23"]),
    ("The paper prints 0.22; the error here is 0.69.", ["0.69"]),
    ("Figure 5-4 has an error of 0.3 in trajectory 6.", ["0.3"]),
    ("Torque and position were measured every 10 ms for 300 samples.", []),
    ("In Figures 5-4 to 5-6 and Table 4-1 errors are pooled; see section 5.1.", []),
    ("The error $e = 0.5$ and `rmss(x, 0.5)` are mathematics and code.", []),
    ("The 25 networks of windows 11, 21 and 41 have errors after 20,000 epochs.", []),
    ("It lies 17 km from here.", []),
]


def test_typed_results_are_told_from_names_and_settings():
    for planted, numbers in RESULTS:
        assert prose.typed_numbers(prose.sentence(planted)) == numbers, planted


ALONE = [page for page in EVIDENCE if module_of(page) not in [*filter(None, map(module_of, WALK))]]
"""Evidence pages with a module of their own, or with none."""


def checks(page: str) -> list[str]:
    """Names of the `stated` calls of a notebook, or of a lesson's module, which a test runs.

    A constant that checks nothing is left out.
    """
    cells = nbformat.read(source(page), as_version=4).cells
    code = [cell.source for cell in cells if cell.cell_type == "code"]
    if page in (*WALK, "book/index", *ALONE):
        path = module_of(page)
        code += [path.read_text(encoding="utf-8")] if path else []
    trees = [ast.parse(text) for text in code]
    calls = [
        node.args
        for tree in trees
        for node in ast.walk(tree)
        if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "stated"
    ]
    return [
        name.value
        for name, holds, *_ in calls
        if isinstance(name, ast.Constant) and not isinstance(holds, ast.Constant)
    ]


def test_bound_sentences_stand_in_their_page_and_their_checks_too():
    """A piece that was reworded, a check that was renamed, a check behind no sentence."""
    wrong, bound = [], {}
    known_of = {n: checks(p) if source(p).suffix == ".ipynb" else [] for n, p in NAMES.items()}
    for name in NAMES:
        known, used = known_of[name], bound.setdefault(name, set())
        assert len(known) == len(set(known)), f"{name}: two checks of one name"
        for entry in BOUND.get(name, []):
            used |= {entry["by"]} if isinstance(entry["by"], str) else set(entry["by"])
            piece = prose.sentence(entry["text"]).bare
            if not any(piece in one.bare for one in read(name)):
                wrong.append((name, "no such sentence", entry["text"]))
    for name, known in known_of.items():  # an evidence page may call checks of its lesson's module
        lessons = [own for own, below in EVIDENCE_OF.items() if NAMES[name] in below]
        there = {*known, *(check for own in lessons for check in known_of[own[5:]])}
        used = bound[name].union(*(bound[below[5:]] for below in EVIDENCE_OF.get(NAMES[name], ())))
        wrong += [(name, "no such check", by) for by in bound[name] - there]
        wrong += [(name, "behind no sentence", check) for check in set(known) - used]
    assert not wrong
    assert set(BOUND) <= set(NAMES) and sum(map(len, BOUND.values())) > 200


@pytest.mark.parametrize("page", [*WALK, *ALONE])
def test_what_a_page_states_is_so(page):
    """By the `_said` of the page's module, if the page binds words at all."""
    path = module_of(page)
    if page.removeprefix("book/") in BOUND and path:
        module = import_module(".".join(path.relative_to(ROOT / "book").with_suffix("").parts))
        assert page not in WALK or hasattr(module, "_said"), path
        getattr(module, "_said", lambda: None)()
