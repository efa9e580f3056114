"""Both verdicts of every claim: the written one, and the one its measurement gives by itself.

In ``book``, ``python -m workshop.report.evidence.judging`` lists them. With ``--write`` it keeps in
``book/results/verdicts.json``, beside the digest of the results, what each claim measures: its
fresh verdict, its value and, of its replicates, the mean and the ends of the middle 95 %; and it
tells what changed, a line for each claim. Whoever commits other results, bands or measures writes
it anew, and looks.

While the results are those of the file, on whatever machine, a test measures all claims: each has
the written verdict, and the value that was kept but for rounding. A path that leads to another cell
so fails, though the verdict may stand. Results made on another machine are another draw, of which
only `Claim.judge` is asked.

How much rounding may move a value depends on what it is. An expression is arithmetic on committed
digits (`_EXACT`). Other measures simulate, record or run committed networks (`_MEASURED`): under
the settings of ``make foreign`` they moved by 4e-8 at most, without jogs by 1e-11; none trains a
network so long that rounding grows. A few values are nothing but rounding, another on each machine:
those are kept to an absolute bound, far below their bands (`_ROUNDING`).
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from workshop.report import results
from workshop.report.evidence.claims import Claim, load
from workshop.report.evidence.verdicts import Measured

_NAME = "verdicts"  # Name of the result that keeps what the claims measure

_MIDDLE = (0.025, 0.975)  # Quantiles of the replicates that are kept, beside their mean

_EXACT, _MEASURED = 1e-9, 1e-6  # Relative changes by which an expression, another measure may move

# Absolute changes of values that are rounding errors, in single and in double precision
_ROUNDING = {
    "chain-rule": 1e-5,
    "no-adjacency": 1e-5,
    "parity-polynomial-signs": 1e-12,
    "rmss-is-invariant": 1e-12,
    "sigmoid-unit": 1e-12,
    "updates-in-the-span": 1e-12,
}


def _distance(claim: Claim) -> float:
    """Relative distance of the value from the nearest edge of its bands that is not 0, or NaN."""
    value, edges = float(claim.measured().value), filter(None, claim.edges())
    return min((abs(value - edge) / abs(edge) for edge in edges), default=math.nan)


def _line(claim: Claim) -> str:
    """A claim in a line of the list.

    Id, value, relative distance from the nearest edge, shares of the draws, fresh verdict,
    written verdict, and "CONTRADICTED" if the written one is wrong, "stands" if it is not though
    the fresh one of other results differs.
    """
    fresh = claim.fresh()
    note = "stands" if fresh != claim.verdict else ""
    note = "CONTRADICTED" if claim.judge() != claim.verdict else note
    drawn = ", ".join(f"{100 * share:.1f} % {name}" for name, share in claim.shares().items())
    value, distance = f"{float(claim.measured().value):.4g}", _distance(claim)
    away = "-" if math.isnan(distance) else f"{100 * distance:.1f} %"
    cells = (claim.id, value, away, drawn or "-", fresh, claim.verdict, note)
    return " | ".join(cells).rstrip(" |")


def _numbers(measured: Measured) -> list[float]:
    """What is kept of a measured value: itself and, if it has replicates, their mean and spread."""
    if measured.replicates is None:
        return [float(measured.value)]
    draws = np.asarray(measured.replicates, dtype=float)
    low, high = np.quantile(draws, _MIDDLE, method="nearest").tolist()
    return [float(measured.value), float(draws.mean()), low, high]


def _same(claim: Claim, before: Sequence[float], now: Sequence[float]) -> bool:
    """Whether numbers of a claim are the kept ones but for rounding."""
    most = {"rel_tol": _EXACT if claim.find else _MEASURED, "abs_tol": _ROUNDING.get(claim.id, 0.0)}
    return len(before) == len(now) and all(math.isclose(a, b, **most) for a, b in zip(before, now))


def _entry(claim: Claim) -> str:
    """What is kept of a claim, in a line: "fresh verdict: numbers"."""
    return f"{claim.fresh()}: " + " ".join(f"{n:.12g}" for n in _numbers(claim.measured()))


def _parts(entry: str) -> tuple[str, list[float]]:
    """Verdict and numbers of what is kept of a claim."""
    verdict, _, numbers = entry.partition(": ")
    return verdict, [float(number) for number in numbers.split()]


def changes(claims: Iterable[Claim], before: Mapping[str, str]) -> list[str]:
    """A line "id: old -> new" for each claim that does not measure or get what was kept."""
    lines, gone = [], dict(before)
    for claim in claims:
        old, new = gone.pop(claim.id, "-"), _entry(claim)
        (verdict, numbers), (fresh, measured) = _parts(old), _parts(new)
        if verdict != fresh or not _same(claim, numbers, measured):
            lines.append(f"{claim.id}: {old} -> {new}")
    return lines + [f"{name}: {old} -> -" for name, old in gone.items()]


def main(arguments=None) -> int:
    """List the verdicts of all judged claims; 1 if a written one is wrong."""
    parser = argparse.ArgumentParser(description=main.__doc__)
    parser.add_argument("--write", action="store_true", help="keep what is measured, tell changes")
    options = parser.parse_args(arguments)
    measured = [claim for claim in load() if claim.is_measured]
    judged = [claim for claim in measured if claim.band]
    for claim in judged:
        print(_line(claim), flush=True)
    if options.write:
        path = results.FOLDER / f"{_NAME}.json"
        before = results.read(_NAME).get("claims", {}) if path.is_file() else {}
        changed = changes(measured, before)
        heading = f"changed against what was kept: {len(changed)} of {len(measured)}"
        print(heading, *changed, sep="\n")
        now = {claim.id: _entry(claim) for claim in measured}
        results.write_json(path, {"of results": results._digest(results.FOLDER), "claims": now})
    wrong = [claim.id for claim in judged if claim.judge() != claim.verdict]
    print(f"contradicted: {', '.join(wrong) or 'none'}")
    return bool(wrong)


if __name__ == "__main__":
    raise SystemExit(main())
