"""Prose says what was computed: numbers are quoted, words of three pages are bound to a check."""

from __future__ import annotations

import re
from functools import cache

import numpy as np
import prose
import pytest
import yaml
from book_pages import API, PAGES, ROOT, code_cells, module_of, source

from beyond.chapters import verdict
from workshop.chapters import index

SUPPORT = ROOT / "tests" / "support"
ALLOWED = yaml.safe_load((SUPPORT / "allowed_numbers.yml").read_text(encoding="utf-8"))
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


def checks(name: str) -> set[str]:
    """Names of the `stated` calls of a page's notebook and module."""
    page = NAMES[name]
    code = [*code_cells(source(page)), module_of(page).read_text(encoding="utf-8")]
    return set(re.findall(r'\bstated\(\s*"([\w-]+)"', "\n".join(code)))


@pytest.mark.parametrize("name", BOUND)
def test_bound_sentences_stand_in_their_page_and_their_checks_too(name):
    """A piece that was reworded, a check that was renamed, a check behind no sentence."""
    pieces = [prose.sentence(entry["text"]).bare for entry in BOUND[name]]
    assert not [piece for piece in pieces if not any(piece in one.bare for one in read(name))]
    assert {by for entry in BOUND[name] for by in np.atleast_1d(entry["by"])} == checks(name)


def test_what_the_verdict_and_the_landing_page_say_in_words_is_so():
    verdict._said()
    index._quoted()
