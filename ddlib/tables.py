"""Tables for notebook and page: rows in, Markdown out."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_POWER = re.compile(r"(?<![\w.])(-?)(\d(?:\.\d+)?)e([-+]\d+)\b")
_MINUS = re.compile(r"(?<![\w.)\-])-(?=\.?\d)|(?<=[(^])-(?=\w)")
_GLUE = "application/papermill.record/"  # before the MIME type of what only the prose quotes


def significant(value, digits: int = 3) -> str:
    """A number for a table cell: `digits` significant digits, a power of ten if need be."""
    if isinstance(value, (int, np.integer)) and not isinstance(value, bool):
        return f"{value:,}"
    value = float(value)
    if not np.isfinite(value):
        return "–"
    if value == 0:
        return "0"
    size = int(f"{value:.{digits - 1}e}".partition("e")[2])  # of the rounded value
    if -4 <= size < 6:
        return f"{value:,.{max(digits - 1 - size, 0)}f}"
    return scientific(value, digits)


def scientific(value, digits: int = 1) -> str:
    """A number with a power of ten, to some significant digits: ``4 · 10⁻¹⁴``, ``10⁻⁶``."""
    if value == 0:
        return "0"
    first, _, power = f"{value:.{digits - 1}e}".partition("e")
    power = "10" + str(int(power)).translate(SUPERSCRIPT)
    return {"1": power, "-1": f"-{power}"}.get(first, f"{first} · {power}")


def typeset(text: str) -> str:
    """Text with its numbers as mathematics sets them: ``1e-05`` is ``10⁻⁵``, ``-3`` is ``−3``.

    Hyphens between words or parts of a name, as in "Table 4-1", stay.
    """

    def power(match):
        sign, factor, exponent = match.groups()
        return sign + scientific(float(f"{factor}e{exponent}"), sum(map(str.isdigit, factor)))

    return _MINUS.sub("−", _POWER.sub(power, text))


def spread(values, digits: int = 2) -> str:
    """Median and range of a sample's finite values: ``0.10 (0.08 to 0.14)``."""
    values = np.asarray(values, dtype=float)
    values = values[np.isfinite(values)]
    if values.size == 0:
        return "–"
    parts = [significant(v, digits) for v in (np.median(values), values.min(), values.max())]
    return "{} ({} to {})".format(*parts)


def how_many(count: int, total: int) -> str:
    """A count for a sentence: ``all 25``, ``none of 25``, ``3 of 25``."""
    return f"all {total}" if count == total else f"{count or 'none'} of {total}"


def plural(count: int, thing: str) -> str:
    """A count of things for a sentence: ``1 stretch``, ``2,000 samples``."""
    ending = "es" if thing.endswith(("ch", "s")) else "s"
    return f"{count:,} {thing}{'' if count == 1 else ending}"


def quote(name: str, value) -> None:
    """Keep a computed number under a name, for the prose of the page to quote."""
    from IPython.display import display

    # what myst_nb's `glue` displays; its import would take every chapter more than a second
    plain = np.asarray(value)[()].item()
    metadata = {"scrapbook": {"name": name, "mime_prefix": _GLUE}}
    display({f"{_GLUE}text/plain": repr(plain)}, raw=True, metadata=metadata)


@dataclass(frozen=True)
class Table:
    """A table that a notebook shows as Markdown; what looks like HTML in a cell stays text."""

    header: Sequence[str]  #: Column heads.
    rows: Iterable[Sequence]  #: Cells: text as it is, numbers by `significant`.

    def __post_init__(self):
        if not all(str(head).strip() for head in self.header):
            raise ValueError(f"header must name every column, got {tuple(self.header)}")
        rows = [tuple(row) for row in self.rows]
        for row in rows:
            if len(row) != len(self.header):
                raise ValueError(
                    f"rows must have {len(self.header)} cells like the header, got {row}"
                )
        object.__setattr__(self, "rows", rows)

    def _repr_markdown_(self) -> str:
        def line(cells):
            texts = (c if isinstance(c, str) else significant(c).replace("-", "−") for c in cells)
            return f"| {' | '.join(map(_in_a_cell, texts))} |"

        rule = "|" + "|".join(" --- " for _ in self.header) + "|"
        return "\n".join([line(self.header), rule, *map(line, self.rows)])


def _in_a_cell(text: str) -> str:
    """Text that neither ends its cell or its row, nor begins a tag."""
    text = re.sub(r"<(?=[A-Za-z/!?])", "&lt;", text.replace("|", r"\|"))
    return re.sub(r"\s*[\n\r\v\f\x85\u2028\u2029]\s*", " ", text)
