"""Two tables of the ledger page: errata of the paper, and what its open questions decide."""

from __future__ import annotations

from pathlib import Path
from string import Template

import numpy as np
import yaml

from ddlib import paper
from ddlib._check import book_file
from ddlib.evidence.measures.filters import parts_sum_up
from ddlib.experiments import KD, KP, WINDOWS, results
from ddlib.learning import Weights
from ddlib.simulation import LOG_STEP
from ddlib.tables import Table, significant, spread, typeset
from ddlib.trajectories import APPENDIX_I, MAX_EXTENT_DEG, MOTION_SECONDS, pick_and_place, time_grid

FILE = Path(__file__).parents[2] / "book" / "errata.yml"
"""Where the errata are kept."""

FIELDS = ("where", "printed", "wrong", "here")
"""Fields of an erratum: place, what is printed, what is wrong or unclear, what this book does."""

FIGURE_UNITS = {"5-6": (52, 21, 41), "5-7": (93, 41, 81), "5-8": (85, 41, 81)}
"""Unit named inside a figure, window by the text of section 5.1, window by the caption."""

SETS = ("random set A", "random set B", "trajectory 6")
"""The data sets of Table 6-1."""


def unit_fits(unit: int, width: int) -> bool:
    """Whether a unit of this number is a hidden or an output unit of a window network.

    Inputs are numbered first, from 0 or from 1.

    Parameters
    ----------
    unit, width : int
        Number of the unit; window size.
    """
    inputs, others = 2 * width, paper.HIDDEN_UNITS + 2
    return inputs < unit <= inputs + others


def errata(path: Path = FILE) -> Table:
    """Where the paper contradicts itself, a formula or arithmetic; what is computable is computed.

    Parameters
    ----------
    path : path
        The errata: a list of entries with the `FIELDS`.

    Returns
    -------
    Table
        Place, what is printed, what is wrong or unclear, what this book does.

    Raises
    ------
    ValueError
        If an entry has unknown or missing fields, one that is no text, or an unknown ``$name``.
    """
    text = book_file(Path(path)).read_text(encoding="utf-8")
    rows, values = [], computed()
    for count, entry in enumerate(yaml.safe_load(text), 1):
        if not isinstance(entry, dict) or set(entry) != set(FIELDS):
            raise ValueError(f"erratum {count} must have the fields {FIELDS}, got {entry!r}")
        if not all(isinstance(text, str) and text.strip() for text in entry.values()):
            raise ValueError(f"erratum {count} must be of texts that are not empty, got {entry!r}")
        try:
            cells = [Template(entry[field]).substitute(values) for field in FIELDS]
        except (KeyError, ValueError) as error:
            known = ", ".join(f"${name}" for name in values)
            raise ValueError(
                f"erratum {count} ({entry['where']}) must name computed values, {known}: {error}"
            ) from None
        rows.append(tuple(map(typeset, cells)))
    return Table(("where", "printed", "wrong or unclear", "in this book"), rows)


def computed() -> dict[str, str]:
    """What the errata name and code can tell, from the paper's formulas and tables."""
    reference = pick_and_place([MAX_EXTENT_DEG] * 2, time_grid(LOG_STEP))
    extents = np.array(APPENDIX_I)
    cases = len(paper.TRAINING_TRAJECTORIES) * paper.SAMPLES_PER_TRAJECTORY
    products = (f"{Weights.random(1, w)[0].count() * cases:,} at {w}" for w in WINDOWS)
    units = (
        f"unit {unit} of Figure {figure} is "
        f"{'no input' if unit_fits(unit, text) else 'an input'} at {text} and "
        f"{'no input' if unit_fits(unit, caption) else 'an input'} at {caption}"
        for figure, (unit, text, caption) in FIGURE_UNITS.items()
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
        "limits": str(np.isin(extents, (0.0, MAX_EXTENT_DEG)).sum()),
        "extents": str(extents.size),
        "products": "; ".join(products),
    }


def open_questions() -> Table:
    """What the questions that the paper leaves open decide, from the committed results.

    Returns
    -------
    Table
        Question, decision, errors as decided, errors otherwise. Both sides of a row have
        the same number of networks.
    """
    rows = [tuple(map(typeset, row)) for row in (*_table_4_1(), *_table_6_1())]
    return Table(("question", "decision", "as decided", "otherwise"), rows)


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


def _table_4_1() -> list[tuple]:
    table = results.read("table-4-1")["setups"]
    state, position = table["state feedback"], table["position feedback"]
    longer, clean = (results.read(name) for name in ("longer", "clean"))
    units = {row["units"]: row for row in results.read("hidden-units")["rows"]}
    sizes = {row["width"]: row for row in results.read("window-sizes")["rows"]}
    one = state["21"]["errors"]["test"]

    def pair(row, columns=("training", "test")):
        return ", ".join(f"{name} {significant(np.median(row[name]), 2)}" for name in columns)

    weight = ("training", "test", "largest weight")
    test = f"test {_triple(_medians(state, 'test'))}"
    shifted = _triple(_medians(state, "test by training deviation"))
    return [
        (
            "What is “a proportional controller”?",
            "position and velocity are fed back",
            _both(state),
            f"position alone: {_both(position)}",
        ),
        *_arms(state),
        (
            "When is the asymptote reached?",
            f"after {paper.EPOCHS:,} epochs",
            _both(state, longer["members"]),
            f"after {longer['epochs']:,}: {_both(longer['windows'])}",
        ),
        (
            "Which test error counts?",
            "the last",
            test,
            f"the best: test {_triple([state[str(w)]['best test'] for w in WINDOWS])}",
        ),
        (
            "How much friction and sensor noise?",
            "little; {doc}`provenance`",
            _both(state, clean["members"]),
            f"none: {_both(clean['windows'])}",
        ),
        (
            "How many hidden units (window 21)?",
            f"{paper.HIDDEN_UNITS}, as printed",
            pair(units[paper.HIDDEN_UNITS]),
            "; ".join(f"{k}: {pair(row)}" for k, row in units.items() if k != paper.HIDDEN_UNITS),
        ),
        (
            "Whose standard deviation divides the test error?",
            "the test set's own",
            test,
            f"the training set's: test {shifted}",
        ),
        (
            "Which positions does the test show to a network?",
            "measured ones",
            test,
            f"desired ones: test {_triple(_medians(state, 'test, desired positions'))}",
        ),
        (
            "Is the largest window 41, or 81 as in the captions?",
            "41",
            pair(sizes[41], weight),
            f"81: {pair(sizes[81], weight)}",
        ),
        (
            "What is the error of one network worth (window 21)?",
            f"the median of {len(one)} counts",
            f"test {significant(np.median(one), 2)}",
            f"one of the {len(one)}: test {significant(min(one), 2)} to {significant(max(one), 2)}",
        ),
    ]


def _arms(state) -> list[tuple]:
    """Table 4-1 on arms drawn at random, if that study has been run."""
    try:
        rows = results.read("arms")["rows"]
    except FileNotFoundError:
        return []
    least = [WINDOWS[int(np.argmin(_medians(row, "test")))] for row in rows]
    times = ", ".join(f"{w} on {least.count(w)}" for w in WINDOWS)
    training = " · ".join(spread(x) for x in zip(*(_medians(row, "training") for row in rows)))
    return [
        (
            "Which gains, friction, noise and momentum?",
            f"kp {KP[0]:g} / {KP[1]:g} N m/rad, kd {KD[0]:g} / {KD[1]:g} N m s/rad; "
            "{doc}`provenance`",
            _both(state),
            f"{len(rows)} arms at random: training {training}; test least at window {times}",
        )
    ]


def _table_6_1() -> list[tuple]:
    table = results.read("table-6-1")
    first, *choices = results.read("state-space-choices")["rows"]

    def sets(errors, deviation="own deviation"):
        return _triple([errors[name][deviation] for name in SETS])

    def options(row):
        return f"step {row['rate']:g}, momentum {row['momentum']:g}, initial ±{row['initial']:g}"

    drawn = [[np.median(d["errors"][s]["own deviation"]) for d in table["draws"]] for s in SETS]
    ranges = " · ".join(f"{significant(min(x), 2)} to {significant(max(x), 2)}" for x in drawn)
    return [
        (
            "Table 6-1 (set A · set B · trajectory 6): how was it trained?",
            options(first),
            sets(first["errors"]),
            "; ".join(f"{options(row)}: {sets(row['errors'])}" for row in choices),
        ),
        (
            "Table 6-1: whose standard deviation?",
            "each set's own",
            sets(table["errors"]),
            f"set A's: {sets(table['errors'], 'deviation of set A')}",
        ),
        (
            "Table 6-1: which random points?",
            "one draw of each set",
            sets(table["errors"]),
            f"{len(table['draws'])} other draws: {ranges}",
        ),
    ]
