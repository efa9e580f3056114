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


def test_units_of_the_figures_belong_to_one_window():
    for unit in (52, 85, 93):
        fitting = [w for w in (11, 21, 41, 81) if ledger._unit_fits(unit, w)]
        assert fitting == [21 if unit == 52 else 41]
    fits = [ledger._unit_fits(unit, 21) for unit in (42, 43, 54, 55)]
    assert fits == [False, True, True, False]  # 42 inputs, 10 hidden units, 2 outputs


def test_errata_are_computed(errata):
    assert "833 Hz" in found(errata, "section 1.1", "830")
    assert "period of 6 s" in found(errata, "section 2", "period")
    assert f"{np.pi / 3 * np.pi / 4:.2f} rad/s" in found(errata, "section 2", "pick-and-place")
    assert found(errata, "Appendix I", "random").startswith("5 of 12 ")
    assert "−45°" in found(errata, "Appendix I", "minus")
    weights = 2 * 21 * 10 + 2 * 42 + 2 * 10
    assert f"{1500 * weights:,} at 21" in found(errata, "Appendix I", "700,000")
    text = found(errata, "Figures 5-4 to 5-8", "captions")
    assert text.count("is no input at") == text.count("and an input at") == 3


def test_a_damaged_erratum_is_named(tmp_path):
    path = tmp_path / "errata.yml"
    for damage, complaint in (
        ("- {where: section 1, printed: a, wrong: b}", "erratum 2 must have the fields"),
        ("- {where: section 1, printed: a, wrong: ' ', here: c}", "must be of texts"),
        ("- {where: section 1, printed: a, wrong: $nothing, here: c}", r"section 1.*'nothing'"),
    ):
        path.write_text("- {where: Table 4-1, printed: a, wrong: $rate Hz, here: b}\n" + damage)
        with pytest.raises(ValueError, match=complaint):
            ledger.errata(path)
        path.write_text(path.read_text().removesuffix(damage))
        assert ledger.errata(path).rows == [("Table 4-1", "a", "833 Hz", "b")]


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
