"""Two tables of the ledger page: errata of the paper, and what its open questions decide."""

from __future__ import annotations

from pathlib import Path
from string import Template

import numpy as np
import yaml

from ddlib import paper
from ddlib.learning import Weights
from ddlib.setups import JOINT_DAMPING, KD, KP, WINDOWS
from ddlib.simulation import LOG_STEP
from ddlib.tables import Table, significant, typeset
from ddlib.trajectories import APPENDIX_I, MAX_EXTENT_DEG, MOTION_SECONDS, pick_and_place, time_grid
from workshop import BOOK
from workshop.report import results
from workshop.report.measures.filters import parts_sum_up

_FILE = BOOK / "errata.yml"  # Where the errata are kept

_QUESTIONS = _FILE.with_name("questions.yml")  # Where the open questions are kept

# Fields of an erratum: place, what is printed, what is wrong or unclear, what this book does
_FIELDS = ("where", "printed", "wrong", "here")

# Unit named inside a figure, window by the text of section 5.1, window by the caption
_FIGURE_UNITS = {"5-6": (52, 21, 41), "5-7": (93, 41, 81), "5-8": (85, 41, 81)}

_SETS = ("random set A", "random set B", "trajectory 6")  # The data sets of Table 6-1


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
    text, rows = path.read_text(encoding="utf-8"), []
    for count, entry in enumerate(yaml.safe_load(text), 1):
        if not isinstance(entry, dict) or set(entry) != set(fields):
            raise ValueError(f"{kind} {count} must have the fields {fields}, got {entry!r}")
        if not all(isinstance(text, str) and text.strip() for text in entry.values()):
            raise ValueError(f"{kind} {count} must be of texts that are not empty, got {entry!r}")
        try:
            cells = [Template(entry[field]).substitute(values) for field in fields]
        except (KeyError, ValueError) as error:
            known = ", ".join(f"${name}" for name in values)
            raise ValueError(
                f"{kind} {count} ({entry[fields[0]]}) must name computed values, {known}: {error}"
            ) from None
        rows.append(tuple(map(typeset, cells)))
    return rows


def _computed() -> dict[str, str]:
    """What the errata name and code can tell, from the paper's formulas and tables."""
    reference = pick_and_place([MAX_EXTENT_DEG] * 2, time_grid(LOG_STEP))
    extents = np.array(APPENDIX_I)
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
        "limits": str(np.isin(extents, (0.0, MAX_EXTENT_DEG)).sum()),
        "extents": str(extents.size),
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
    table = results.read("table-4-1")["setups"]
    state, printed = table["state feedback"], paper.HIDDEN_UNITS
    longer, clean = (results.read(name) for name in ("longer", "clean"))
    units = {row["units"]: row for row in results.read("hidden-units")["rows"]}
    sizes = {row["width"]: row for row in results.read("window-sizes")["rows"]}
    one = state["21"]["errors"]["test"]
    others = {
        "test": "test",
        "by_training": "test by training deviation",
        "desired": "test, desired positions",
    }
    weight = ("training", "test", "largest weight")
    return {
        "state": _both(state),
        "position": _both(table["position feedback"]),
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
        "networks": str(len(one)),
        **{f.__name__: significant(f(one), 2) for f in (np.median, min, max)},
    }


def _runs() -> str:
    """Which window has the least test error in the runs of the screening design."""
    methods = results.read("screened")["methods"]
    runs = [run["windows"] for rows in methods.values() for run in rows]
    least = [WINDOWS[int(np.argmin(_medians(run, "test")))] for run in runs]
    times = ", ".join(f"{w} in {least.count(w)}" for w in WINDOWS)
    return f"of {len(runs)} runs with all choices changed at once, test least at window {times}"


def _table_6_1() -> dict[str, str]:
    table = results.read("table-6-1")
    first, *choices = results.read("state-space-choices")["rows"]

    def sets(errors, deviation="own deviation"):
        return _triple([errors[name][deviation] for name in _SETS])

    def options(row):
        return f"step {row['rate']:g}, momentum {row['momentum']:g}, initial ±{row['initial']:g}"

    drawn = [[np.median(d["errors"][s]["own deviation"]) for d in table["draws"]] for s in _SETS]
    return {
        "options": options(first),
        "chosen": sets(first["errors"]),
        "other_options": "; ".join(f"{options(row)}: {sets(row['errors'])}" for row in choices),
        "sets": sets(table["errors"]),
        "sets_by_a": sets(table["errors"], "deviation of set A"),
        "draws": str(len(table["draws"])),
        "drawn": " · ".join(f"{significant(min(x), 2)} to {significant(max(x), 2)}" for x in drawn),
    }
