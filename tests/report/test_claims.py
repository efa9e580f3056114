"""The claims file: whole, well formed, and each verdict what the measurement gives."""

import re

import numpy as np
import pytest
import yaml
from book_pages import CHAPTERS

from workshop.report import results
from workshop.report.evidence import claims, wall
from workshop.report.evidence.claims import LEDGER, SECTIONS, Claim
from workshop.report.evidence.verdicts import Measured

ALL = claims.load()
MEASURED = [claim for claim in ALL if claim.is_measured]
PLAIN = dict(
    id="a", where="section 1", chapter="dynamics", claim="x", printed="p", why="y", refuted="z",
    verdict="not testable",
)  # fmt: skip
FLOATS = [
    "Figure 2-1", "Figure 2-2", "Figure 3-1", "Figure 4-1", "Table 4-1",
    *(f"Figure 5-{k}" for k in range(1, 9)), "Figure 6-1", "Figure 6-2", "Table 6-1",
    "Appendix I",
]  # fmt: skip


def make(**changes) -> Claim:
    measure = dict(verdict="reproduced", measure="filters.untrained", band={"factor": 1.5})
    return Claim(**{**PLAIN, "printed": 2.0, **measure, **changes})


def judged(claim) -> str:
    """What a tile says of the verdict and of the bands that decide it."""
    return "".join(re.findall(r"Judged: (.*)\. y", wall.Tiles([claim])._repr_markdown_()))


@pytest.fixture
def finds(monkeypatch):
    """``finds(value, draws)``: what every claim measures from then on, of results made anew."""
    monkeypatch.setattr(results, "_committed", lambda: False)

    def plant(value, draws=None):
        found = Measured(value, "text", None if draws is None else np.asarray(draws))
        monkeypatch.setattr(Claim, "measured", lambda self: found)

    return plant


@pytest.fixture
def file(tmp_path):
    """``file(*entries)``: the claims of a file with these changes of a plain entry."""

    def load(*entries):
        path = tmp_path / "claims.yml"
        path.write_text(yaml.safe_dump([PLAIN | entry for entry in entries]))
        return claims.load(path)

    return load


def test_verdicts_are_what_is_measured():
    wrong = {c.id: c.measured().text for c in MEASURED if c.judge() != c.verdict}
    assert not wrong


def test_the_paper_is_covered():
    assert {claim.place()[0] for claim in ALL} == set(SECTIONS)
    assert not [x for x in FLOATS if not any(re.search(rf"\b{x}\b", c.where) for c in ALL)]
    pages = {chapter.removeprefix("book/") for chapter in CHAPTERS}
    # evidence pages without a lesson of their name
    alone = {"start", "real-two-link-arm", "joints-three-and-four"}
    assert {claim.chapter for claim in ALL} <= pages | {LEDGER} | alone


def test_places_in_the_paper():
    for where, place in (
        ("Abstract", ("0", 0, 0)),
        ("section 1", ("1", 0, 0)),
        ("section 3.1", ("3", 1, 0)),
        ("section 4, footnote", ("4", 0, 0)),
        ("Table 4-1", ("4", 10, 1)),
        ("Figure 5-8 and section 5.1", ("5", 20, 8)),
        ("Appendix I", ("8", 0, 0)),
    ):
        assert make(where=where).place() == place


def test_a_failing_measure_names_its_claim():
    told = r"claim 'a' could not be measured by .*untrained\(colour='red'\): TypeError"
    with pytest.raises(RuntimeError, match=told):
        make(arguments={"colour": "red"}).judge()


def test_bands(finds):
    for band, loose, value, wanted in (
        ({"factor": 1.5}, {}, 2.9, "reproduced"),  # of the printed 2
        ({"factor": 1.5}, {}, 1.4, "reproduced"),
        ({"factor": 1.5}, {}, 1.3, "not reproduced"),
        ({"from": 1.0}, {}, 1.0, "reproduced"),
        ({"from": 1.0}, {}, 0.9, "not reproduced"),
        ({"to": 1.0}, {"to": 2.0}, 1.5, "qualitative"),
        ({"to": 1.0}, {"to": 2.0}, 2.5, "not reproduced"),
        ({"from": 1.0, "to": 2.0}, {}, 2.5, "not reproduced"),
        ({"is": True}, {}, True, "reproduced"),
        ({"is": True}, {}, False, "not reproduced"),
        ({"is": True}, {}, 0.3, "not reproduced"),
        ({"from": 1.0}, {}, float("nan"), "not reproduced"),
    ):
        finds(value)
        assert make(band=band, loose=loose).judge() == wanted, (band, value)
    claim = make(band={"factor": 1.25}, loose={"from": 1.0, "to": 4.0})
    assert claim.edges() == [1.0, 1.6, 2.5, 4.0] and make(band={"is": True}).edges() == []


def test_replicates_decide(finds, monkeypatch):
    for good, fresh, sure in (
        (100, "reproduced", "reproduced, more than 95 % of draws"),
        (95, "reproduced", "reproduced, 95 % of draws"),
        (90, "undecided", "reproduced, 90 % of draws"),  # what is written still stands
        (60, "undecided", "reproduced, 60 % of draws"),
        (3, "not reproduced", "not reproduced, more than 95 % of draws"),
    ):
        finds(2.0, np.repeat([2.0, 9.0], [good, 100 - good]))
        claim = make()
        assert (claim.fresh(), claim.verdict_with_share()) == (fresh, sure)
        assert claim.judge() == sure.split(",")[0]
    finds(2.0, np.repeat([2.0, 9.0], [60, 40]))
    told = make(verdict="undecided").verdict_with_share()
    assert told == "undecided: 60 % reproduced, 40 % not reproduced of draws"
    for good, verdict in ((99, "undecided"), (100, "reproduced"), (0, "not reproduced")):
        finds(2.0, np.repeat([2.0, 9.0], [good, 100 - good]))
        assert make(verdict="undecided").judge() == verdict
    for planted in ("undecided", "qualitative", "not reproduced", "reproduced"):
        for draws in ([2.0] * 100, None):  # all agree; without draws one value decides
            finds(2.0, draws)
            assert make(verdict=planted).judge() == "reproduced"
    assert make().shares() == {} and make().verdict_with_share() == "reproduced"
    finds(2.0, np.repeat([2.0, 9.0], [90, 10]))
    assert make().judge() == "reproduced"
    monkeypatch.setattr(results, "_committed", lambda: True)  # nothing stands that is not fresh
    assert make().judge() == "undecided"


def test_a_verdict_that_could_not_come_out_otherwise_is_found(finds):
    """The word follows from `certain`: written the other way round it is wrong, either way."""
    finds(2.0)
    assert make(verdict="by construction").judge() == "reproduced"
    assert make(refuted="", certain="z").judge() == "by construction"
    assert all((claim.verdict == "by construction") == bool(claim.certain) for claim in ALL)
    for changes in ({"certain": "z"}, {"refuted": ""}):
        with pytest.raises(ValueError, match="claim 'a' must have either refuted or certain"):
            make(**changes)


def test_by_construction_is_measured_all_the_same(finds):
    claim = make(verdict="by construction", refuted="", certain="z")
    finds(2.0)
    assert claim.judge() == "by construction"
    assert judged(claim) == "by construction (2.0; holds within a factor of 1.5)"
    finds(9.0)
    assert claim.judge() == claim.fresh() == "not reproduced"


def test_not_testable_may_tell_where_it_would_turn(finds):
    claim = make(verdict="not testable", band={})
    finds(2.0, [2.0, 9.0])
    assert claim.judge() == claim.fresh() == "not testable"
    assert claim.our_value() == "text" and judged(claim) == ""
    assert claim.shares() == {}


def test_bad_entries_are_refused(file):
    for entries, words in (
        (({}, {}), "id must be unique, got 'a' twice"),
        (({"verdict": "reproduced"},), "claim 'a' must have measure or find, and band"),
    ):
        with pytest.raises(ValueError, match=words):
            file(*entries)


def test_what_claims_have_in_common_is_said_once(file):
    """Each has what is said around it, but where it says otherwise; its arguments join theirs."""
    entry = {
        "id": "a-{width}", "claim": "small at {width}", "printed": 0.5, "measure": "m.f",
        "with": {"layer": "direct"}, "band": {"to": 0.1}, "loose": {"to": 0.25},
        "refuted": "More than {} or {a quarter}.", "verdict": "reproduced",
    }  # fmt: skip
    first = {"with": {"width": 11}, "why": "w"}
    damped = {"reading": "joint damping", "claims": [{"with": {"width": k}} for k in (11, 21)]}
    plain = {
        "id": "b",
        "claim": "x",
        "verdict": "not testable",
        "band": {},
        "loose": {},
        "refuted": "r",
    }
    one, two, three, other = file({**entry, "claims": [first, damped, plain]})
    assert (one.id, two.id, three.id, other.id) == ("a-11", "a-11-damping", "a-21-damping", "b")
    assert three.claim == "small at 21, with damping in the joints" and one.claim == "small at 11"
    assert one.arguments == {"layer": "direct", "width": 11}
    assert three.arguments == {"layer": "direct", "width": 21, "setup": "joint damping"}
    assert (one.why, two.why) == ("w", PLAIN["why"]) and two.printed == 0.5
    assert one.refuted == "More than 0.25 or a quarter." and not other.band


def test_printed_numbers_keep_their_digits(tmp_path):
    path = tmp_path / "claims.yml"
    entry = "- {id: a, where: section 1, chapter: dynamics, claim: x, printed: %s, "
    entry += "verdict: not testable, why: y, refuted: z}"
    for text, shown in (("0.10", "0.10"), ("700000", "700,000"), ("1.2 ms", "1.2 ms")):
        path.write_text(entry % text)
        (claim,) = claims.load(path)
        assert claim.as_printed() == shown
        assert isinstance(claim.printed, str) or claim.printed == float(text)


def test_bands_in_words(finds):
    for value, changes, words in (
        (0.5, {}, "0.50; reproduced within a factor of 1.5"),
        (0.5, {"band": {"to": 0.1}, "loose": {"from": 0.2, "to": 1}},
         "0.50; reproduced up to 0.1, qualitative from 0.2 to 1"),
        (True, {"band": {"is": True}}, "yes; reproduced if yes"),
        (2e5, {"band": {"from": 200, "to": 100000}}, "200,000; reproduced from 200 to 100,000"),
        (0.985, {"band": {"to": 0.9}, "loose": {"to": 0.98}}, "0.985; "),  # shows its side
    ):  # fmt: skip
        finds(value)
        assert f"({words}" in judged(make(**changes))


def test_the_window_of_a_claim():
    expression = {"median": "x/{width}", "text": "y"}
    for changes, width in (
        ({"measure": "filters.of_class", "arguments": {"width": 41, "name": "velocity"}}, 41),
        ({"measure": "filters.constant_share"}, 21),  # what it takes if it is not told
        ({"measure": "chapters.whole_state_space.shoulder_position"}, None),
        ({"measure": "", "find": expression, "arguments": {"width": 11}}, 11),
        ({"measure": "", "verdict": "not testable", "band": {}}, None),
    ):
        assert wall.window(make(**changes)) == width


def test_a_sentence_is_judged_again_on_another_arm():
    """By the bands of the first, but where it has none, or measures another thing."""
    other = {"differencing-real-arm", "tailored-to-the-sensor-real-arm", "rises-again-real-arm"}
    other |= {"unmodelled-real-arm", "unmodelled-error-real-arm"}
    pairs = claims.judged_again("a real arm")
    assert len(pairs) >= 9 and len(claims.judged_again("a fish")) == 0
    kept = {claim.id for claim in claims.of_the_paper()}
    for first, again in pairs:
        assert first.id == again.again and first.id in kept and again.id not in kept
        assert first.place() == again.place(), "another place of the paper"
        assert first.as_printed() == again.as_printed()
        same = (first.band, first.loose) == (again.band, again.loose)
        assert same or again.id in other, again.id
