"""The article for ReScience C has the book's numbers."""

from operator import attrgetter

from book_pages import ROOT

from workshop.chapters import window_networks
from workshop.report.evidence.cards import by_reading, of_kind, tally


def test_both_tables_are_those_of_the_results():
    article = (ROOT / "paper" / "content.tex").read_text(encoding="utf-8")
    errors = window_networks.table_4_1()
    system, verdict = of_kind("system"), attrgetter("verdict")
    words = {"all readings": tally(system, verdict), **by_reading(system, verdict)}
    counts = [(name, sum(row.values()), *row.values()) for name, row in words.items()]
    lines = [" & ".join(map(str, row)).replace("*", "") for row in (*errors.rows, *counts)]
    assert not [line for line in lines if line not in article]
