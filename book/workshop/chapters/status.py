"""Tables of the page *Status*: what `make bench` measured, and how long the results took."""

from __future__ import annotations

from ddlib.tables import Table, significant
from workshop.report import results
from workshop.report.code_hash import places

# Targets for the parts of `make reproduce` on two cores, s; for all of it, their sum
_REPRODUCE_SECONDS = {"the report": 900, "rivals, a real arm": 300, "the loop": 360}

_GAP = "\N{NO-BREAK SPACE}"


def _duration(seconds: float) -> str:
    """A time for a table, in the unit that suits it."""
    units = (("s", 1.0), ("ms", 1e-3), ("µs", 1e-6))
    unit, size = next((u for u in units if seconds >= u[1]), units[-1])
    return f"{significant(seconds / size)}{_GAP}{unit}"


def _outcome(row: dict) -> str:
    """The target of a row of `benchmarks.json`, and whether it is met."""
    if "not measured" in row:
        return f"not measured: {row['not measured']}"
    if "at least" in row:
        met = row["ratio"] >= row["at least"]
        return f"≥{_GAP}{significant(row['at least'], 2)}: {'met' if met else 'missed'}"
    if "at most" in row:
        met = row["value"] <= row["at most"]
        return f"≤{_GAP}{significant(row['at most'], 2)}: {'met' if met else 'missed'}"
    return "none"


def benchmark_machine() -> str:
    """When and where `make bench` ran, in a sentence."""
    made = results.read("benchmarks")["made by"]
    versions = ", ".join(f"{name} {version}" for name, version in made["versions"].items())
    load = "" if made["load before"] is None else f"load {made['load before']:.1f} before, "
    return (
        f"Measured on {made['date']}: {made['processor']}, {made['cores']} cores, {load}"
        f"Python {made['python']}, {versions}; {made['seconds']:.0f} s in all."
    )


def benchmarks() -> dict[str, Table]:
    """The table of each group of measurements: pairs of times, or quantities with a limit."""
    groups: dict[str, list[dict]] = {}
    for row in results.read("benchmarks")["rows"]:
        groups.setdefault(row["group"], []).append(row)
    return {group: _pairs(rows) or _quantities(rows) for group, rows in groups.items()}


def _quantities(rows: list[dict]) -> Table:
    cells = (f"{significant(r['value'])}{_GAP}{r['unit']}" if "value" in r else "–" for r in rows)
    lines = [(row["what"], cell, _outcome(row)) for row, cell in zip(rows, cells)]
    return Table(("what", "measured", "target"), lines)


def _pairs(rows: list[dict]) -> Table | None:
    first = next((row for row in rows if "ratio" in row), None)
    if first is None:
        return None
    beside = [key for key in first["details"] if key.startswith(("share", "largest"))]
    lines = []
    for row in rows:
        cells = ["–"] * (3 + len(beside))
        if "ratio" in row:
            cells = [_duration(row[side]["seconds"]) for side in ("ours", "other")]
            cells.append(f"{significant(row['ratio'])}{_GAP}×")
            details = ((key, row["details"][key]) for key in beside)
            cells += [f"{x:.0%}" if k.startswith("share") else significant(x) for k, x in details]
        lines.append((row["what"], *cells, _outcome(row)))
    names = (first["ours"]["name"], first["other"]["name"])
    return Table(("what", *names, "ratio", *beside, "target"), lines)


def made_results() -> Table:
    """Processor time of each committed result, and how long all took together."""
    read = {path.stem: results.read(path.stem) for path in sorted(results.FOLDER.glob("*.json"))}
    made = {name: content["made by"] for name, content in read.items() if "made by" in content}
    times = {name: by["seconds"] for name, by in made.items() if "code" in by}
    rows = [(name, f"{seconds:.1f} s") for name, seconds in times.items()]
    rows.append(("sum", f"{sum(times.values()):.0f} s"))
    for part, most in _REPRODUCE_SECONDS.items():
        spent = sum(seconds for name, seconds in times.items() if _part(name) == part)
        rows.append((f"results of {part}, half of it", _held(spent / 2, most)))
    if whole := made.get("reproduce"):
        fewer = "" if whole.get("parts") == len(times) else ", before results were added"
        words = _held(whole["seconds"], sum(_REPRODUCE_SECONDS.values()), fewer)
        rows.append((f"make reproduce, {whole['jobs']} at a time, by the clock", words))
    return Table(("result", "processor time to make it"), rows)


def _held(seconds: float, most: float, beside: str = "") -> str:
    verdict = "met" if seconds <= most else "missed"
    return f"{seconds:.0f} s{beside}; target ≤ {most} s: {verdict}"


def _part(name: str) -> str:
    """The part of `_REPRODUCE_SECONDS` to which a result belongs, by the folder of its study."""
    report, rivals, loop = _REPRODUCE_SECONDS
    module, _ = places().get(name, ("", ""))
    if "beyond.studies" not in module or ".page." in module:
        return report
    return loop if ".loop." in module else rivals
