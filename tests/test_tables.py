"""Tables: numbers as text, Markdown, verdicts."""

import html
import re

import numpy as np
import pytest
from hypothesis import given, strategies as st

from ddlib.tables import Table, how_many, quote, scientific, significant, spread, typeset


def test_three_significant_digits():
    for value, text in (
        (0.0, "0"),
        (0.078, "0.0780"),
        (1234.5678, "1,235"),
        (0.0000683, "6.83 · 10⁻⁵"),
        (9.999, "10.0"),  # rounding adds a digit
        (np.nan, "–"),
        (-np.inf, "–"),
        (20_000, "20,000"),  # counts keep all their digits
        (np.int64(1_234_567), "1,234,567"),
    ):
        assert significant(value) == text


@given(
    value=st.floats(1e-8, 1e8).flatmap(lambda x: st.sampled_from([x, -x])),
    digits=st.integers(1, 6),
)
def test_a_number_can_be_read_back_to_its_digits(value, digits):
    text = significant(value, digits)
    text = re.sub("^(-?)10(?=[⁻⁰¹²³⁴⁵⁶⁷⁸⁹])", r"\g<1>1 · 10", text)  # a power alone
    text = text.replace(" · 10", "e").translate(str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789"))
    read = float(text.replace(",", ""))
    assert read == pytest.approx(value, rel=0.500001 * 10.0 ** (1 - digits))
    mantissa = text.partition("e")[0].lstrip("-").replace(",", "").replace(".", "").lstrip("0")
    assert abs(value) >= 10.0 ** (digits - 1) or len(mantissa) == digits
    assert ("e" in text) == (not 1e-4 <= abs(float(f"{value:.{digits - 1}e}")) < 1e6)


def test_powers_are_set_as_mathematics():
    given = ((0.0, 1), (3.6e-14, 1), (1e-6, 1), (-9.7e11, 1), (-0.00123, 2))
    texts = [scientific(*one) for one in given]
    assert texts == ["0", "4 · 10⁻¹⁴", "10⁻⁶", "-10¹²", "-1.2 · 10⁻³"]


def test_numbers_in_text_are_set_as_mathematics():
    for text, wanted in (
        ("holds up to 1e-06", "holds up to 10⁻⁶"),
        ("-2.5e+07 N m", "−2.5 · 10⁷ N m"),
        ("grow by -0.013, (-68; from -.3)", "grow by −0.013, (−68; from −.3)"),
        ("Table 4-1, 16-bit, set-2, 1.5-fold, 3--4", "Table 4-1, 16-bit, set-2, 1.5-fold, 3--4"),
        ("[section](page-2.ipynb)", "[section](page-2.ipynb)"),
    ):
        assert typeset(text) == wanted == typeset(wanted)


def test_spread_is_median_and_range():
    for values, text in (
        ([0.1, 0.2, 0.6], "0.20 (0.10 to 0.60)"),
        ([0.1, np.nan, 0.2, 0.3, np.inf], "0.20 (0.10 to 0.30)"),
        ([np.nan], "–"),
    ):
        assert spread(values) == text


@pytest.mark.parametrize("value, plain", [(np.array(1 / 3), 1 / 3), (np.int64(3), 3)])
def test_quote_shows_what_glue_shows(monkeypatch, value, plain):
    import IPython.display
    import myst_nb.ext.glue as library

    ours, theirs = [], []
    monkeypatch.setattr(IPython.display, "display", lambda *a, **k: ours.append((a, k)))
    monkeypatch.setattr(library, "ipy_display", lambda *a, **k: theirs.append((a, k)))
    quote("chapter-value", value)
    library.glue("chapter-value", plain, display=False)
    assert ours == theirs and len(ours) == 1


def cells(line):
    """Cells of a row as a Markdown reader takes them: bars with a backslash are text."""
    assert line[0] == line[-1] == "|"
    bare = line[1:-1].replace(r"\|", "\0")
    return [c.strip().replace("\0", "|") for c in bare.split("|")]


texts = st.text(st.characters(codec="ascii", categories=["L", "N", "P", "S"]), max_size=12).filter(
    lambda s: "\\" not in s
)


@given(rows=st.lists(st.tuples(texts, texts, st.floats(0.1, 10)), max_size=4))
def test_any_text_stays_in_its_cell(rows):
    lines = Table(("|a|", "b", "c"), rows)._repr_markdown_().split("\n")
    lines = [html.unescape(line) for line in lines]
    assert len(lines) == 2 + len(rows)
    assert cells(lines[0]) == ["|a|", "b", "c"] and cells(lines[1]) == ["---"] * 3
    for line, row in zip(lines[2:], rows):
        assert cells(line) == [row[0], row[1], significant(row[2])]


@pytest.mark.parametrize("cell", ["<img src=x onerror=f()>", "</td><b>", "<!-- x", "a\n\n<b>b"])
def test_a_cell_begins_no_tag_and_no_row(cell):
    lines = Table(("a", cell), [(1, cell)])._repr_markdown_().split("\n")
    assert len(lines) == 3 and not re.search("<[a-z/!]", "".join(lines))
    assert html.unescape(lines[2]) == f"| 1 | {' '.join(cell.split())} |"


def test_rows_may_come_once_and_have_the_length_of_the_header():
    table = Table(("a",), ((k,) for k in range(3)))
    assert table._repr_markdown_() == table._repr_markdown_()
    with pytest.raises(ValueError, match="rows must have 2 cells like the header"):
        Table(("a", "b"), [(1, 2), (1, 2, 3)])


def test_a_count_reads_as_a_sentence_would_say_it():
    assert [how_many(n, 25) for n in (0, 3, 25)] == ["none of 25", "3 of 25", "all 25"]
