"""The claims file: whole, well formed, and each verdict what the measurement gives."""

import importlib
import inspect
import re

import pytest
import yaml
from book_pages import CHAPTERS

from ddlib import claims
from ddlib.claims import VERDICTS, Claim, Measured

ALL = claims.load()
MEASURED = [claim for claim in ALL if claim.measure]


def make(**changes) -> Claim:
    fields = dict(
        id="a", where="section 1", chapter="dynamics", claim="x", printed=2.0, why="because",
        verdict="reproduced", measure="networks.slope", band={"factor": 1.5},
    )  # fmt: skip
    return Claim(**{**fields, **changes})


@pytest.mark.parametrize("claim", MEASURED, ids=lambda claim: claim.id)
def test_verdicts_are_what_is_measured(claim):
    found = claim.measured()
    assert found.text.strip()
    assert claim.judge() == claim.verdict, f"measured: {found.text}"


@pytest.mark.parametrize("claim", MEASURED, ids=lambda claim: claim.id)
def test_measuring_functions_exist_and_take_the_arguments(claim):
    module, _, name = claim.measure.partition(".")
    function = getattr(importlib.import_module(f"ddlib.measures.{module}"), name)
    inspect.signature(function).bind(**claim.arguments)


def test_every_claim_has_its_chapter():
    pages = {chapter.removeprefix("book/") for chapter in CHAPTERS}
    assert {claim.chapter for claim in ALL} <= pages


@pytest.mark.parametrize(
    "value, wanted",
    [(2.0, "reproduced"), (2.9, "reproduced"), (1.4, "reproduced"), (1.3, "not reproduced")],
)
def test_factors_count_both_ways(monkeypatch, value, wanted):
    monkeypatch.setattr(Claim, "measured", lambda self: Measured(value, "text"))
    assert make().judge() == wanted


@pytest.mark.parametrize(
    "band, loose, value, wanted",
    [
        ({"from": 1.0}, {}, 1.0, "reproduced"),
        ({"from": 1.0}, {}, 0.9, "not reproduced"),
        ({"to": 1.0}, {"to": 2.0}, 1.5, "qualitative"),
        ({"to": 1.0}, {"to": 2.0}, 2.5, "not reproduced"),
        ({"from": 1.0, "to": 2.0}, {}, 2.5, "not reproduced"),
        ({"is": True}, {}, True, "reproduced"),
        ({"is": True}, {}, False, "not reproduced"),
        ({"from": 1.0}, {}, float("nan"), "not reproduced"),
    ],
)
def test_bands(monkeypatch, band, loose, value, wanted):
    monkeypatch.setattr(Claim, "measured", lambda self: Measured(value, "text"))
    assert make(band=band, loose=loose).judge() == wanted


@pytest.mark.parametrize(
    "changes, words",
    [
        (dict(verdict="maybe"), "verdict of claim 'a' must be one of"),
        (dict(why=" "), "why of claim 'a' must be text"),
        (dict(measure=""), "must have measure and band"),
        (dict(verdict="not testable"), "must have measure and band"),
        (dict(band={"about": 1}), "must be factor, is, from, to"),
        (dict(printed="by eye"), "the printed value a number"),
        (dict(band={"factor": 0.5}), "must be at least 1"),
    ],
)
def test_claims_refuse_bad_entries(changes, words):
    with pytest.raises(ValueError, match=words):
        make(**changes)


def test_the_file_is_checked(tmp_path):
    entry = dict(id="a", where="w", chapter="c", claim="x", printed="p", verdict="not testable",
                 why="y")  # fmt: skip
    path = tmp_path / "claims.yml"
    path.write_text(yaml.safe_dump([entry]))
    assert claims.load(path)[0].judge() == "not testable"
    path.write_text(yaml.safe_dump([entry, entry]))
    with pytest.raises(ValueError, match="id must be unique, got 'a' twice"):
        claims.load(path)
    path.write_text(yaml.safe_dump([{**entry, "colour": "red"}]))
    with pytest.raises(ValueError, match="claim 'a' must have the known fields"):
        claims.load(path)
    path.write_text(yaml.safe_dump([{k: v for k, v in entry.items() if k != "why"}]))
    with pytest.raises(ValueError, match="claim 'a' must have the known fields"):
        claims.load(path)


def test_tables():
    chapter = ALL[0].chapter
    table = claims.chapter_table(chapter)._repr_markdown_()
    assert len(table.splitlines()) == 2 + len(claims.of_chapter(chapter))
    assert all(
        re.search(rf"\\| ({'|'.join(VERDICTS)}) \\|", line) for line in table.splitlines()[2:]
    )
    with pytest.raises(ValueError, match=r"chapter must have claims in claims.yml, got 'nowhere'"):
        claims.of_chapter("nowhere")
    total = claims.summary(ALL)._repr_markdown_().splitlines()[-1]
    assert str(len(ALL)) in total
