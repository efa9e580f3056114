"""What all benchmarks share: interleaved timing, rows of the table, peak memory."""

from __future__ import annotations

import json
import os
import sys
import time
from collections.abc import Callable
from pathlib import Path
from statistics import median

try:
    import resource
except ImportError:  # Windows
    resource = None

THREADS = min(2, os.cpu_count() or 1)
"""Threads that both sides of a pair may use, unless the row says otherwise."""

MEMORY_LIMIT = 2.0
"""GiB that no benchmark, chapter or result may need."""

AHEAD = 2.0
"""How many times faster than a peer its user notices."""

KEPT = 2 / 3
"""Part of the last committed ratio that a new one must keep: less is no noise."""

COMMITTED = Path(__file__).resolve().parent.parent / "book" / "results" / "benchmarks.json"


def interleaved(repeats: int, **works: Callable[[], object]) -> dict[str, dict[str, float]]:
    """Shortest and median time of each work, in s; the works take turns.

    Every work runs once before, untimed. Taking turns, a slow spell of the machine hits
    all of them.
    """
    times: dict[str, list[float]] = {name: [] for name in works}
    for turn in range(repeats + 1):
        for name, work in works.items():
            started = time.perf_counter()
            work()
            if turn:
                times[name].append(time.perf_counter() - started)
    return {
        name: {"shortest": min(taken), "median": median(taken), "times": len(taken)}
        for name, taken in times.items()
    }


def committed() -> dict[tuple[str, str], dict]:
    """The rows of the last committed run, by group and what was measured."""
    rows = json.loads(COMMITTED.read_text(encoding="utf-8"))["rows"] if COMMITTED.is_file() else []
    return {(row["group"], row["what"]): row for row in rows}


def goal(group: str, what: str) -> float:
    """The least ratio of a row: ahead of the peer, and no third below the last committed ratio."""
    return max(AHEAD, KEPT * committed().get((group, what), {}).get("ratio", 0.0))


def ratio(group: str, what: str, ours: tuple, other: tuple, *, judged=True, **details) -> dict:
    """A row: how many times less `ours` takes than the `other`; each is (name, seconds).

    Rows of one `group` make one table; `details` are numbers that stand beside the ratio. A row
    that is not `judged` is a figure without a verdict.
    """
    return {
        "group": group,
        "what": what,
        "ours": {"name": ours[0], "seconds": ours[1]},
        "other": {"name": other[0], "seconds": other[1]},
        "ratio": other[1] / ours[1],
        **({"at least": goal(group, what)} if judged else {}),
        "details": details,
    }


def quantity(group: str, what: str, value: float, unit: str, most: float | None = None) -> dict:
    """A row: a quantity, with the limit below which a reader of the book needs it, if any."""
    row = {"group": group, "what": what, "value": value, "unit": unit}
    return row if most is None else {**row, "at most": most}


def not_measured(group: str, what: str, why: str) -> dict:
    """A row for what could not be measured here."""
    return {"group": group, "what": what, "not measured": why}


def met(row: dict) -> bool | None:
    """Whether a row reaches its goal; None without one."""
    if "at least" in row:
        return row["ratio"] >= row["at least"]
    return row["value"] <= row["at most"] if "at most" in row else None


def peak_memory(who: str = "self") -> float | None:
    """Peak resident memory so far in GiB: of this process, or of the largest of its children."""
    if resource is None:
        return None
    usage = resource.getrusage(getattr(resource, f"RUSAGE_{who.upper()}"))
    return usage.ru_maxrss / (2**30 if sys.platform == "darwin" else 2**20)


def memory_row(what: str, who: str = "self") -> dict:
    """The row of the peak memory so far."""
    peak, group = peak_memory(who), "Peak memory"
    if peak is None:
        return not_measured(group, what, "this system does not tell")
    return quantity(group, what, peak, "GiB", MEMORY_LIMIT)
