"""The ledger's tables: their numbers against the results and the paper's own counts."""

import numpy as np
import pytest

from ddlib.tables import significant
from workshop.chapters import ledger
from workshop.report import results


@pytest.fixture(scope="module")
def errata() -> list[tuple]:
    return ledger.errata().rows


@pytest.fixture(scope="module")
def questions() -> dict[str, tuple]:
    return {row[0]: row[1:] for row in ledger.open_questions().rows}


def found(rows, where, words) -> str:
    (text,) = [row[2] for row in rows if row[0] == where and words in row[1]]
    return text


def test_errata_are_computed(errata):
    assert "833 Hz" in found(errata, "section 1.1", "830")
    assert "period of 6 s" in found(errata, "section 2", "period")
    assert f"{np.pi / 3 * np.pi / 4:.2f} rad/s" in found(errata, "section 2", "pick-and-place")
    assert found(errata, "Appendix I", "random").startswith("5 of 12 ")
    assert "−45°" in found(errata, "Appendix I", "minus")
    weights = 2 * 21 * 10 + 2 * 42 + 2 * 10
    assert f"{1500 * weights:,} at 21" in found(errata, "Appendix I", "700,000")
    text = found(errata, "Figures 5-4 to 5-8", "captions")
    for units in (  # two inputs for each sample of a window, then ten hidden units and two outputs
        "unit 52 of Figure 5-6 is no input at 21 and an input at 41",
        "unit 93 of Figure 5-7 is no input at 41 and an input at 81",
        "unit 85 of Figure 5-8 is no input at 41 and an input at 81",
    ):
        assert units in text


def test_a_damaged_erratum_is_named(tmp_path):
    path = tmp_path / "errata.yml"
    path.write_text("- {where: Table 4-1, printed: a, wrong: $rate Hz, here: b}\n")
    assert ledger.errata(path).rows == [("Table 4-1", "a", "833 Hz", "b")]
    path.write_text(path.read_text() + "- {where: section 1, printed: a, wrong: $nothing, here: c}")
    with pytest.raises(ValueError, match=r"erratum 2 must .* name computed values.*'nothing'"):
        ledger.errata(path)


def test_open_questions_quote_the_results(questions):
    table = results.read("table-4-1")["setups"]
    for name, column in (("state feedback", 1), ("position feedback", 2)):
        text = questions["What is “a proportional controller”?"][column]
        for what in ("training", "test"):
            for w in ("11", "21", "41"):
                assert significant(np.median(table[name][w]["errors"][what]), 2) in text
    six = results.read("table-6-1")["errors"]["trajectory 6"]
    eight = results.read("clean")["members"]  # as many networks on both sides of a row
    median = significant(np.median(table["state feedback"]["21"]["errors"]["test"][:eight]), 2)
    assert f" · {median} · " in questions["How much friction and sensor noise?"][1]
    row = questions["Table 6-1: whose standard deviation?"]
    assert row[1].endswith(significant(np.median(six["own deviation"]), 2))
    assert row[2].endswith(significant(np.median(six["deviation of set A"]), 2))
