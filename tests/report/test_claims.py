"""The claims file: whole, well formed, and each verdict what the measurement gives."""

import inspect
import re

import numpy as np
import pytest
import yaml
from book_pages import CHAPTERS

from workshop.report.evidence import claims, ledger_tables
from workshop.report.evidence.claims import LEDGER, SECTIONS, Claim, MeasureError
from workshop.report.evidence.verdicts import VERDICTS, Measured

ALL = claims.load()
MEASURED = [claim for claim in ALL if claim.measure]


def make(**changes) -> Claim:
    fields = dict(
        id="a", where="section 1", chapter="dynamics", claim="x", printed=2.0, why="because",
        refuted="1", verdict="reproduced", measure="networks.slope", band={"factor": 1.5},
    )  # fmt: skip
    return Claim(**{**fields, **changes})


@pytest.mark.parametrize("claim", MEASURED, ids=lambda claim: claim.id)
def test_verdicts_are_what_is_measured(claim):
    found = claim.measured()
    assert found.text.strip()
    assert claim.judge() == claim.verdict, f"measured: {found.text}"


@pytest.mark.parametrize("claim", MEASURED, ids=lambda claim: claim.id)
def test_measuring_functions_exist_and_take_the_arguments(claim):
    inspect.signature(claims.function(claim.measure)).bind(**claim.arguments)


def test_every_claim_has_its_chapter():
    pages = {chapter.removeprefix("book/") for chapter in CHAPTERS}
    assert {claim.chapter for claim in ALL} <= pages | {LEDGER}


FLOATS = [
    "Figure 2-1", "Figure 2-2", "Figure 3-1", "Figure 4-1", "Table 4-1",
    *(f"Figure 5-{k}" for k in range(1, 9)), "Figure 6-1", "Figure 6-2", "Table 6-1",
    "Appendix I",
]  # fmt: skip


@pytest.mark.parametrize("name", FLOATS)
def test_every_table_and_figure_of_the_paper_has_a_claim(name):
    assert [c.id for c in ALL if re.search(rf"\b{name}\b", c.where)], f"no claim names {name}"


def test_the_paper_is_covered():
    assert len(ALL) >= 60
    assert {claim.place()[0] for claim in ALL} == set(SECTIONS)


@pytest.mark.parametrize(
    "where, place",
    [
        ("Abstract", ("0", 0, 0)),
        ("section 1", ("1", 0, 0)),
        ("section 3.1", ("3", 1, 0)),
        ("section 4, footnote", ("4", 0, 0)),
        ("Table 4-1", ("4", 10, 1)),
        ("Figure 5-8 and section 5.1", ("5", 20, 8)),
        ("Appendix I", ("8", 0, 0)),
    ],
)
def test_places_in_the_paper(where, place):
    assert make(where=where).place() == place


@pytest.mark.parametrize("where", ["page 3", "section 8", "section 0", "Figure 9-1", "Appendix II"])
def test_places_that_the_paper_does_not_have(where):
    with pytest.raises(ValueError, match="where of claim 'a' must name a section from 1 to 7"):
        make(where=where)


@pytest.mark.parametrize(
    "measure, arguments, words",
    [
        ("networks.nowhere", {}, "AttributeError"),
        ("nowhere.slope", {}, "ModuleNotFoundError"),
        ("networks.slope", {"colour": "red"}, r"slope\(colour='red'\): TypeError"),
        ("networks.memory", {"width": 12}, r"memory\(width=12\): KeyError: 12"),
    ],
)
def test_a_failing_measure_names_its_claim(measure, arguments, words):
    claim = make(measure=measure, arguments=arguments)
    for ask in (claim.measured, claim.judge):
        with pytest.raises(MeasureError, match=f"claim 'a' could not be measured by .*{words}"):
            ask()


@pytest.mark.parametrize("result", [Measured(float("nan"), "text"), Measured(1.0, " "), 1.0])
def test_measures_that_cannot_be_judged(monkeypatch, result):
    from workshop.report.measures import networks

    monkeypatch.setattr(networks, "slope", lambda wrong: result)
    with pytest.raises(MeasureError, match=r"claim 'a' could not be measured.* must return"):
        make(arguments={"wrong": repr(result)}).measured()


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


def spread_over(monkeypatch, low, high, value=None):
    """Let every claim measure `high` reproduced draws of ten and `low` others."""
    draws = np.repeat([2.0, 9.0], [high, low])
    found = Measured(2.0 if value is None else value, "text", draws)
    monkeypatch.setattr(Claim, "measured", lambda self: found)


@pytest.mark.parametrize(
    "good, fresh, sure",
    [
        (100, "reproduced", "reproduced, 100 % of draws"),
        (95, "reproduced", "reproduced, 95 % of draws"),
        (90, "undecided", "reproduced, 90 % of draws"),  # what is written still stands
        (60, "undecided", "reproduced, 60 % of draws"),
        (3, "not reproduced", "not reproduced, 97 % of draws"),
    ],
)
def test_replicates_decide(monkeypatch, good, fresh, sure):
    spread_over(monkeypatch, 100 - good, good)
    claim = make()
    assert claim.fresh() == fresh
    assert claims.sure(claim) == sure
    assert claim.judge() == sure.split(",")[0]


def test_an_undecided_claim_tells_its_shares(monkeypatch):
    spread_over(monkeypatch, 40, 60)
    told = claims.sure(make(verdict="undecided"))
    assert told == "undecided: 60 % reproduced, 40 % not reproduced of draws"


def test_an_undecided_claim_stays_so_until_nearly_all_draws_agree(monkeypatch):
    for good, verdict in ((99, "undecided"), (100, "reproduced"), (0, "not reproduced")):
        spread_over(monkeypatch, 100 - good, good)
        assert make(verdict="undecided").judge() == verdict


@pytest.mark.parametrize("planted", ["qualitative", "not reproduced", "undecided"])
def test_a_planted_verdict_is_contradicted(monkeypatch, planted):
    spread_over(monkeypatch, 0, 100)
    assert make(verdict=planted).judge() == "reproduced"


def test_without_replicates_one_value_decides(monkeypatch):
    monkeypatch.setattr(Claim, "measured", lambda self: Measured(2.0, "text"))
    for planted in ("undecided", "qualitative", "not reproduced", "reproduced"):
        assert make(verdict=planted).judge() == "reproduced"
    assert make().shares() == {} and claims.sure(make()) == "reproduced"


def test_by_construction_is_measured_all_the_same(monkeypatch):
    claim = make(verdict="by construction")
    monkeypatch.setattr(Claim, "measured", lambda self: Measured(2.0, "text"))
    assert claim.judge() == "by construction"
    assert ledger_tables.bands(claim) == "2.0; holds within a factor of 1.5"
    monkeypatch.setattr(Claim, "measured", lambda self: Measured(9.0, "text"))
    assert claim.judge() == claim.fresh() == "not reproduced"


def test_not_testable_may_tell_where_it_would_turn(monkeypatch):
    claim = make(verdict="not testable", band={})
    spread_over(monkeypatch, 1, 1)
    assert claim.judge() == claim.fresh() == "not testable"
    assert claims.here(claim) == "text" and ledger_tables.bands(claim) == "not judged"
    assert claim.shares() == {}


def test_edges(monkeypatch):
    monkeypatch.setattr(Claim, "measured", lambda self: Measured(2.5, "text"))
    claim = make(band={"factor": 1.25}, loose={"from": 1.0, "to": 4.0})
    assert claim.edges() == [1.0, 1.6, 2.5, 4.0]
    assert make(band={"is": True}).edges() == []


@pytest.mark.parametrize(
    "changes, words",
    [
        (dict(verdict="maybe"), "verdict of claim 'a' must be one of"),
        (dict(why=" "), "why of claim 'a' must be text"),
        (dict(refuted=""), "refuted of claim 'a' must be text"),
        (dict(measure=""), "must have measure and band"),
        (dict(verdict="not testable"), "must have measure and band"),
        (dict(verdict="by construction", loose={"from": 1}), "by construction: it must not have"),
        (dict(verdict="not testable", band={}, loose={"to": 1}), "not testable: it must not have"),
        (dict(band={"about": 1}), "must be factor, is, from, to"),
        (dict(printed="by eye"), "the printed value a number"),
        (dict(band={"factor": 0.5}), "must be at least 1"),
    ],
)
def test_claims_refuse_bad_entries(changes, words):
    with pytest.raises(ValueError, match=words):
        make(**changes)


def test_the_file_is_checked(tmp_path):
    entry = dict(
        id="a", where="section 1", chapter="c", claim="x", printed="p",
        verdict="not testable", why="y", refuted="z",
    )  # fmt: skip
    path = tmp_path / "claims.yml"
    path.write_text(yaml.safe_dump([entry]))
    assert claims.load(path)[0].judge() == "not testable"
    path.write_text(yaml.safe_dump([entry, entry]))
    with pytest.raises(ValueError, match="id must be unique, got 'a' twice"):
        claims.load(path)
    path.write_text(yaml.safe_dump([{**entry, "colour": "red"}]))
    with pytest.raises(ValueError, match="claim 'a' must have the known fields"):
        claims.load(path)
    for missing in ("why", "refuted"):
        path.write_text(yaml.safe_dump([{k: v for k, v in entry.items() if k != missing}]))
        with pytest.raises(ValueError, match="claim 'a' must have the known fields"):
            claims.load(path)


def test_notebooks_of_one_build_share_what_they_measured(monkeypatch, tmp_path):
    claim = next(c for c in MEASURED if c.measure == "networks.multiplications")
    monkeypatch.setenv(claims.SHARED, str(tmp_path))
    claims._measured.cache_clear()
    first = claim.measured()
    claims._measured.cache_clear()
    from workshop.report.measures import networks

    monkeypatch.setattr(networks, "multiplications", lambda **_: Measured(-1.0, "again"))
    assert claim.measured() == first and isinstance(claim.measured(), Measured)
    monkeypatch.delenv(claims.SHARED)
    claims._measured.cache_clear()
    assert claim.measured() == Measured(-1.0, "again")
    claims._measured.cache_clear()


def test_tables():
    with pytest.raises(ValueError, match=r"chapter must have claims in claims.yml, got 'nowhere'"):
        claims.of_chapter("nowhere")
    total = ledger_tables.summary(ALL)._repr_markdown_().splitlines()[-1]
    assert str(len(ALL)) in total


def test_the_ledger_holds_every_claim_once_in_the_order_of_the_paper():
    listed = [claim for section in SECTIONS for claim in claims.of_section(section)]
    of_the_paper = claims.of_the_paper()
    assert sorted(c.id for c in listed) == sorted(c.id for c in of_the_paper)
    assert [c.place() for c in listed] == sorted(c.place() for c in of_the_paper)
    with pytest.raises(ValueError, match="section must be one of"):
        claims.of_section("9")


def test_bands_in_words(monkeypatch):
    monkeypatch.setattr(Claim, "measured", lambda self: Measured(0.5, "text"))
    assert ledger_tables.bands(make()) == "0.50; reproduced within a factor of 1.5"
    both = make(band={"to": 0.1}, loose={"from": 0.2, "to": 1})
    assert ledger_tables.bands(both) == "0.50; reproduced up to 0.1, qualitative from 0.2 to 1"
    monkeypatch.setattr(Claim, "measured", lambda self: Measured(True, "text"))
    assert ledger_tables.bands(make(band={"is": True})) == "yes; reproduced if yes"


def test_a_value_near_an_edge_shows_its_side(monkeypatch):
    monkeypatch.setattr(Claim, "measured", lambda self: Measured(0.985, "text"))
    assert ledger_tables.bands(make(band={"to": 0.9}, loose={"to": 0.98})).startswith("0.985; ")
    monkeypatch.setattr(Claim, "measured", lambda self: Measured(3.004, "text"))
    assert ledger_tables.bands(make()).startswith("3.004; ")  # an edge by its factor


def test_counts_in_bands_are_grouped(monkeypatch):
    monkeypatch.setattr(Claim, "measured", lambda self: Measured(2e5, "text"))
    told = ledger_tables.bands(make(band={"from": 200, "to": 100000}))
    assert told == "200,000; reproduced from 200 to 100,000"


@pytest.mark.parametrize(
    "arguments, measure, width",
    [
        ({"width": 41, "name": "velocity"}, "filters.of_class", 41),
        ({}, "filters.constant_share", 21),  # what it takes if it is not told
        ({}, "networks.slope", None),
        ({}, "", None),
    ],
)
def test_the_window_of_a_claim(arguments, measure, width):
    changes = {} if measure else {"verdict": "not testable", "band": {}}
    assert ledger_tables.window(make(measure=measure, arguments=arguments, **changes)) == width


@pytest.mark.parametrize("claim", ALL, ids=lambda claim: claim.id)
def test_refutations_have_one_form(claim):
    """An outcome, with no word on whether it came out; a reason; or what is needed."""
    assert re.match(r"[A-Z0-9]", claim.refuted) and claim.refuted.endswith(".")
    assert not re.match(r"None|Nothing|It would", claim.refuted) and ":" not in claim.refuted
    if claim.verdict in ("reproduced", "qualitative", "not reproduced", "undecided"):
        assert re.match(r"An? ", claim.refuted)


def test_the_claims_that_are_left_out():
    rows = ledger_tables.left_out(ALL).rows
    expected = [c for c in ALL if c.verdict == "not testable"]
    assert sorted(row[1] for row in rows) == sorted(c.claim for c in expected)
    assert ledger_tables.left_out([make()]).rows == []


def test_printed_numbers_keep_their_digits(tmp_path):
    path = tmp_path / "claims.yml"
    entry = "- {id: a, where: section 1, chapter: dynamics, claim: x, printed: %s, "
    entry += "verdict: not testable, why: y, refuted: z}"
    for text, shown in (("0.10", "0.10"), ("700000", "700,000"), ("1.2 ms", "1.2 ms")):
        path.write_text(entry % text)
        (claim,) = claims.load(path)
        assert claims.printed(claim) == shown
        assert isinstance(claim.printed, str) or claim.printed == float(text)


def test_counts_add_up():
    table = ledger_tables.counts(ALL)
    assert list(table) == [title for title in SECTIONS.values() if title in table]
    assert sum(sum(row.values()) for row in table.values()) == len(ALL)
    found = [claim.judge() for claim in ALL]
    for verdict in VERDICTS:
        assert sum(row[verdict] for row in table.values()) == found.count(verdict)


def test_the_books_own_claims_are_not_the_papers():
    paper, own = claims.of_the_paper(), [c for c in ALL if c.printed == claims.OWN]
    again = [c for c in ALL if c.arm and c.printed != claims.OWN]
    assert own and again and len(paper) + len(own) + len(again) == len(ALL)
    assert {c.chapter for c in own} <= {
        "why-smooth-filters", "rivals", "real-arm", "run-time", "adaptive-control",
        "learning-in-the-loop", "stirring", "joints-three-and-four", "verdict",
    }  # fmt: skip
    assert {c.chapter for c in again} == {"real-arm"}


def test_a_sentence_is_judged_again_on_another_arm():
    pairs = claims.judged_again("a real arm")
    assert len(pairs) >= 9 and len(claims.judged_again("a fish")) == 0
    kept = {claim.id for claim in claims.of_the_paper()}
    for first, again in pairs:
        assert first.id == again.again and first.id in kept and again.id not in kept
        assert first.place() == again.place(), "another place of the paper"
        assert claims.printed(first) == claims.printed(again)
    rows = ledger_tables.again_table("a real arm").rows
    assert len(rows) == len(pairs)
    for row, (first, again) in zip(rows, sorted(pairs, key=lambda pair: pair[1].place())):
        assert row[0].startswith(again.claim)
        assert row[2].startswith(first.judge()) and row[3].startswith(again.judge())
    with pytest.raises(ValueError, match="arm must be named by claims, got 'a fish'"):
        ledger_tables.again_table("a fish")


def test_bands_of_a_second_row_are_those_of_the_first():
    """But where the first has none, or measures another thing."""
    other = {"differencing-real-arm", "tailored-to-the-sensor-real-arm", "rises-again-real-arm"}
    other |= {"unmodelled-real-arm", "unmodelled-error-real-arm"}
    for first, again in claims.judged_again("a real arm"):
        if again.id not in other:
            assert (first.band, first.loose) == (again.band, again.loose), again.id


@pytest.mark.parametrize(
    "changes, complaint",
    [
        ({"again": "b"}, "claim 'a' must name the arm on which it judges 'b' again"),
        ({"again": "c", "arm": "a fish"}, "again of claim 'a' must be an id, got 'c'"),
    ],
)
def test_what_is_judged_again_must_be_there(tmp_path, changes, complaint):
    entry = dict(
        id="a", where="section 1", chapter="c", claim="x", printed="p",
        verdict="not testable", why="y", refuted="z",
    )  # fmt: skip
    path = tmp_path / "claims.yml"
    path.write_text(yaml.safe_dump([{**entry, "id": "b"}, {**entry, **changes}]))
    with pytest.raises(ValueError, match=complaint):
        claims.load(path)
