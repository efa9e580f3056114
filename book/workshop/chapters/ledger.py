"""The ledger page: its cards, errata of the paper, and what its open questions decide."""

from __future__ import annotations

import html
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from string import Template

import numpy as np
import yaml
from scipy.stats import norm

from ddlib import paper
from ddlib.learning import Weights
from ddlib.setups import JOINT_DAMPING, KD, KP, SETUPS, WINDOWS
from ddlib.simulation import LOG_STEP
from ddlib.tables import Table, significant, typeset
from ddlib.trajectories import MAX_EXTENT_DEG, MOTION_SECONDS, pick_and_place, time_grid
from workshop import BOOK
from workshop.chapters.trajectories_and_recording import random_draws
from workshop.report import results
from workshop.report.evidence.cards import (
    LISTS,
    OWN,
    WORDS,
    Card,
    by_reading,
    of_kind,
    tally,
    worded,
)
from workshop.report.evidence.claims import Claim, load
from workshop.report.evidence.verdicts import DECIDED, share_told
from workshop.report.evidence.wall import Tiles, home, mark, rendered, window
from workshop.report.measures.filters import parts_sum_up

_FILE = BOOK / "errata.yml"  # Where the errata are kept

_QUESTIONS = _FILE.with_name("questions.yml")  # Where the open questions are kept

# Fields of an erratum: place, what is printed, what is wrong or unclear, what this book does
_FIELDS = ("where", "printed", "wrong", "here")

# Unit named inside a figure, window by the text of section 5.1, window by the caption
_FIGURE_UNITS = {"5-6": (52, 21, 41), "5-7": (93, 41, 81), "5-8": (85, 41, 81)}

# What a list of rows is headed
_LISTED = {
    "by construction": "definitions, algebra and choices made as printed, which could hardly fail",
    "not testable": "no measurement here could decide, or an assumed parameter does",
}

BOTH = {"cells of Table 4-1": "Table 4-1", "largest weights": "largest weight has"}
"""Two kinds of printed numbers, and words of their cards."""

_SETS = ("random set A", "random set B", "trajectory 6")  # The data sets of Table 6-1


@dataclass(frozen=True)
class _Markdown:
    """Text that a notebook shows as Markdown."""

    text: str

    def _repr_markdown_(self) -> str:
        return self.text


def cards(kind: str) -> _Markdown:
    """The cards of a kind: word, sentence and signs outside; a grid and all rows inside."""
    return _Markdown("\n\n".join(map(_card, of_kind(kind))))


def lists() -> _Markdown:
    """All rows that hold by construction, and all that cannot be tested: a list each."""
    folds = []
    for verdict in LISTS:
        rows = [claim for claim in load() if claim.verdict == verdict]
        head = f"{mark(verdict)} <b>{len(rows)} rows</b> <span>{verdict}: {_LISTED[verdict]}</span>"
        folds.append(_fold(verdict.replace(" ", "-"), verdict, head, [_tiles(rows)]))
    return _Markdown("\n\n".join(folds))


def folded(name: str, head: str, table: Table) -> _Markdown:
    """A table to open."""
    head = f'<span class="sign"></span> <b>table</b> <span>{head}</span>'
    return _Markdown(_fold(name, "", head, [table._repr_markdown_()]))


def legend() -> _Markdown:
    """What each sign means; with a script they are buttons that filter."""
    words = {word: f"{word}, {OWN[word]}" for word in ("reproduced", "not reproduced", "undecided")}
    signs = [(word, words.get(word, word)) for word in (*WORDS, *LISTS)]
    return _Markdown(rendered("legend", signs=signs))


def counts() -> Table:
    """How many cards on the paper have which word: whatever the reading is, and under each."""
    system, methods = of_kind("system"), of_kind("methods")
    rows = {"all readings": tally(system, Claim.judge), **by_reading(system, Claim.judge)}
    rows["methods of others"] = tally(methods, Claim.judge)
    cells = [(name, sum(by_word.values()), *by_word.values()) for name, by_word in rows.items()]
    return Table(("cards", "all", *WORDS), cells)


def findings() -> Table:
    """How many findings of this book held, failed and are open."""
    shown = [card.word(Claim.judge).partition(" (")[0] for card in of_kind("own")]
    words = "held", "failed", "open"
    return Table(("findings", *words), [(len(shown), *map(shown.count, words))])


def both() -> Table:
    """How many cells of Table 4-1 and largest weights each reading reproduces."""
    rows = []
    for name, words in BOTH.items():
        total, held = cells_by_reading(words)
        rows.append((name, total, *held.values()))
    return Table(("reproduced", "printed", *SETUPS), rows)


def cells_by_reading(words: str) -> tuple[int, dict[str, int]]:
    """Sentences with these words that all readings are judged by; how many each reproduces."""
    cells = [card.rows for card in of_kind("system") if words in f"{card.where}: {card.says}"]
    cells = [rows for rows in cells if set(SETUPS) <= set(rows)]
    held = {name: sum(r[name][0].judge() == "reproduced" for r in cells) for name in SETUPS}
    return len(cells), held


def _fold(name: str, verdict: str, head: str, inside: Iterable[str]) -> str:
    return rendered("fold", name=name, verdict=verdict, head=head, inside=inside)


def _card(card: Card) -> str:
    sign, spread = card.sign(Claim.judge), card.spread(Claim.judge)
    best = card.under(next(iter(spread), ""))
    better = best.verdict(Claim.judge) != card.verdict(Claim.judge)
    head = rendered(
        "card",
        sign=sign,
        word=card.word(Claim.judge),
        says=html.escape(card.says, quote=False),
        rows=[claim.judge() for claim in card.deciding],
        best={"word": best.word(Claim.judge), "sign": best.sign(Claim.judge)} if better else None,
        where=card.where,
    )
    rows = [claim for row in card.rows.values() for claim in row]
    readings = ", ".join(
        f"{verdict_word} with {reading}" for reading, verdict_word in spread.items()
    )
    inside = [readings and f"By reading, the best first: {readings}.", _grid(card), _tiles(rows)]
    if card.beside:
        inside += ["Beside it, not decisive:", _tiles(card.beside)]
    return _fold(card.id, sign, head, filter(None, inside))


def _tiles(claims: Iterable[Claim]) -> str:
    return Tiles(claims)._repr_markdown_()


def _grid(card: Card) -> str:
    """A table of the rows by their readings and windows; empty for a single row."""

    def size(claim: Claim) -> str:
        return str(window(claim) or "any")

    widths = sorted({size(claim) for row in card.rows.values() for claim in row})
    if len(widths) < 2 and len(card.rows) < 2:
        return ""
    lines = [
        (name or "rows", [[claim for claim in row if size(claim) == width] for width in widths])
        for name, row in card.rows.items()
    ]
    return rendered("grid", widths=widths, lines=lines)


def _unit_fits(unit: int, width: int) -> bool:
    """Whether a unit of this number is a hidden or an output unit of a window network."""
    inputs, others = 2 * width, paper.HIDDEN_UNITS + 2
    return inputs < unit <= inputs + others


def errata(path: Path = _FILE) -> Table:
    """Where the paper contradicts itself, a formula or arithmetic, computed where it can be."""
    rows = _filled("erratum", _FIELDS, path, _computed())
    return Table(("where", "printed", "wrong or unclear", "in this book"), rows)


def _filled(kind: str, fields: tuple, path: Path, values: dict[str, str]) -> list[tuple]:
    """The entries of a file, as rows, with values in place of their names."""
    rows = []
    for number, entry in enumerate(yaml.safe_load(path.read_text(encoding="utf-8")), 1):
        try:
            cells = [Template(entry[field]).substitute(values) for field in fields]
        except (KeyError, TypeError, ValueError) as error:
            known = ", ".join(f"${name}" for name in values)
            raise ValueError(
                f"{kind} {number} must have the texts {fields} and name computed values, {known}: "
                f"{error!r} in {entry!r}"
            ) from None
        rows.append(tuple(map(typeset, cells)))
    return rows


def _computed() -> dict[str, str]:
    """What the errata name and code can tell, from the paper's formulas and tables."""
    reference = pick_and_place([MAX_EXTENT_DEG] * 2, time_grid(LOG_STEP))
    cases = len(paper.TRAINING_TRAJECTORIES) * paper.SAMPLES_PER_TRAJECTORY
    products = (f"{Weights.random(1, w)[0].count() * cases:,} at {w}" for w in WINDOWS)
    units = (
        f"unit {unit} of Figure {figure} is "
        f"{'no input' if _unit_fits(unit, text) else 'an input'} at {text} and "
        f"{'no input' if _unit_fits(unit, caption) else 'an input'} at {caption}"
        for figure, (unit, text, caption) in _FIGURE_UNITS.items()
    )
    return {
        "rate": f"{1 / 1.2e-3:.0f}",
        "period": f"{2 * np.pi / (np.pi / MOTION_SECONDS):.0f}",
        "speed": f"{np.abs(reference.qd[0]).max():.2f}",
        "extent": f"{MAX_EXTENT_DEG:g}",
        "test": str(paper.TEST_TRAJECTORY),
        "parts": parts_sum_up().text.capitalize(),
        "units": "; ".join(units),
        "halves": ", ".join(f"{w // 2} for {w}" for w in WINDOWS),
        "samples": str(paper.SAMPLES_PER_TRAJECTORY),
        "lowest": f"{np.rad2deg(reference.q.min()):.0f}",
        "draws": random_draws().text,
        "products": "; ".join(products),
    }


def open_questions() -> Table:
    """What the questions that the paper leaves open decide, from the committed results."""
    fields = ("question", "decision", "decided", "otherwise")
    rows = _filled("question", fields, _QUESTIONS, {**_table_4_1(), **_table_6_1()})
    header = ("question", "decision", "as decided", "otherwise")
    return Table(header, [row for row in rows if all(row)])


def _medians(cells, column, first=None) -> list[float]:
    """Median error of the first networks of each window size."""
    columns = [cells[str(w)].get("errors", cells[str(w)])[column] for w in WINDOWS]
    return [float(np.median(values[:first])) for values in columns]


def _triple(values) -> str:
    return " · ".join(significant(np.median(x), 2) for x in values)


def _both(cells, first=None) -> str:
    test = _medians(cells, "test", first)
    least = WINDOWS[int(np.argmin(test))]
    training = _triple(_medians(cells, "training", first))
    return f"training {training}; test {_triple(test)}, least at {least}"


def _pair(row, columns=("training", "test")) -> str:
    return ", ".join(f"{name} {significant(np.median(row[name]), 2)}" for name in columns)


def _table_4_1() -> dict[str, str]:
    setups = results.read("table-4-1")["setups"]
    state, printed = setups["state feedback"], paper.HIDDEN_UNITS
    longer, clean = (results.read(name) for name in ("longer", "clean"))
    units = {row["units"]: row for row in results.read("hidden-units")["rows"]}
    sizes = {row["width"]: row for row in results.read("window-sizes")["rows"]}
    test = state["21"]["errors"]["test"]
    others = {
        "test": "test",
        "by_training": "test by training deviation",
        "desired": "test, desired positions",
    }
    weight = ("training", "test", "largest weight")
    return {
        "state": _both(state),
        "position": _both(setups["position feedback"]),
        "gains": f"kp {KP[0]:g} / {KP[1]:g} N m/rad, kd {KD[0]:g} / {KD[1]:g} N m s/rad",
        "damping": _both(results.read("recordings")["setups"][JOINT_DAMPING.name]),
        "runs": _runs(),
        "epochs": f"{paper.EPOCHS:,}",
        "state_beside_longer": _both(state, longer["members"]),
        "more_epochs": f"{longer['epochs']:,}",
        "longer": _both(longer["windows"]),
        "best": _triple([state[str(w)]["best test"] for w in WINDOWS]),
        "state_beside_clean": _both(state, clean["members"]),
        "clean": _both(clean["windows"]),
        "units": str(printed),
        "with_units": _pair(units[printed]),
        "other_units": "; ".join(f"{k}: {_pair(r)}" for k, r in units.items() if k != printed),
        **{name: _triple(_medians(state, column)) for name, column in others.items()},
        **{f"size_{w}": _pair(sizes[w], weight) for w in (41, 81)},
        "networks": str(len(test)),
        **{f.__name__: significant(f(test), 2) for f in (np.median, min, max)},
    }


def _runs() -> str:
    """Which window has the least test error in the runs of the screening design."""
    methods = results.read("screened")["methods"]
    runs = [run["windows"] for rows in methods.values() for run in rows]
    least = [WINDOWS[int(np.argmin(_medians(run, "test")))] for run in runs]
    times = ", ".join(f"{w} in {least.count(w)}" for w in WINDOWS)
    return f"of {len(runs)} runs with all choices changed at once, test least at window {times}"


def _table_6_1() -> dict[str, str]:
    study = results.read("table-6-1")
    first, *choices = results.read("state-space-choices")["rows"]

    def sets(errors, deviation="own deviation"):
        return _triple([errors[name][deviation] for name in _SETS])

    def options(row):
        return f"step {row['rate']:g}, momentum {row['momentum']:g}, initial ±{row['initial']:g}"

    drawn = [[np.median(d["errors"][s]["own deviation"]) for d in study["draws"]] for s in _SETS]
    return {
        "options": options(first),
        "chosen": sets(first["errors"]),
        "other_options": "; ".join(f"{options(row)}: {sets(row['errors'])}" for row in choices),
        "sets": sets(study["errors"]),
        "sets_by_a": sets(study["errors"], "deviation of set A"),
        "draws": str(len(study["draws"])),
        "drawn": " · ".join(f"{significant(min(x), 2)} to {significant(max(x), 2)}" for x in drawn),
    }


def nearest_the_edge(claims: Iterable[Claim], count: int = 10) -> Table:
    """Rows whose draws come nearest to deciding otherwise, on both sides of `DECIDED`."""
    drawn = [(claim, claim.shares()) for claim in claims if claim.band]
    near = sorted(
        (row for row in drawn if row[1]), key=lambda row: abs(max(row[1].values()) - DECIDED)
    )
    rows = [
        (
            f"{claim.claim} ({{doc}}`{home(claim)}`)",
            worded(claim, claim.judge()),
            worded(claim, ", ".join(f"{share_told(x)} {name}" for name, x in shares.items())),
        )
        for claim, shares in near[:count]
    ]
    return Table(("row", "verdict", "draws"), [tuple(map(typeset, row)) for row in rows])


def less_anew(share: float = DECIDED) -> float:
    """Share of the draws below which an ensemble trained anew falls in one case of six.

    Of one that had `share`: if its value is normal it moves by the square root of two standard
    errors, and one standard deviation below the mean lies a sixth.
    """
    return float(norm.cdf(norm.ppf(share) - np.sqrt(2)))
