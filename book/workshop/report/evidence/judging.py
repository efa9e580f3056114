"""Both verdicts of every claim: the written one, and the one its measurement gives by itself.

In ``book``, ``python -m workshop.report.evidence.judging`` lists them; with ``--write`` it also
keeps the fresh verdicts beside the results from which they follow, in
``book/results/verdicts.json``. Whoever commits other results or bands writes them anew, and then
each written verdict has to be the fresh one. Results made on another machine are other draws:
there it has to stand (`verdicts`).
"""

from __future__ import annotations

import argparse
import hashlib
import json
import math

from workshop.report import results
from workshop.report.evidence.claims import Claim, load

_NAME = "verdicts"  # Name of the result that keeps the fresh verdicts


def _distance(claim: Claim) -> float:
    """Relative distance of the value from the nearest edge of its bands; NaN if it has none."""
    value, edges = float(claim.measured().value), claim.edges()
    return min((abs(value - e) / max(abs(e), 1e-300) for e in edges), default=math.nan)


def _digest() -> str:
    """Hash of all committed numbers and networks, whoever made them and whenever."""
    total = hashlib.sha256()
    for path in sorted(results.FOLDER.glob("*.json")):
        content = json.loads(path.read_text(encoding="utf-8"))
        if "code" in content.pop("made by", {}):
            total.update(f"{path.stem} {json.dumps(content, sort_keys=True)}\n".encode())
    for path in sorted(results.FOLDER.glob("*.npz")):
        total.update(f"{path.stem} {hashlib.sha256(path.read_bytes()).hexdigest()}\n".encode())
    return total.hexdigest()[:16]


def _line(claim: Claim) -> str:
    """A claim in a line of the list.

    Id, value, relative distance from the nearest edge, shares of the draws, fresh verdict,
    written verdict, and "CONTRADICTED" if the written one does not stand, "stands" if it does
    though the fresh one differs.
    """
    fresh = claim.fresh()
    note = "stands" if fresh != claim.verdict else ""
    note = "CONTRADICTED" if claim.judge() != claim.verdict else note
    drawn = ", ".join(f"{100 * share:.1f} % {name}" for name, share in claim.shares().items())
    value, away = f"{float(claim.measured().value):.4g}", f"{100 * _distance(claim):.1f} %"
    cells = (claim.id, value, away, drawn or "-", fresh, claim.verdict, note)
    return " | ".join(cells).rstrip(" |")


def _main(arguments=None) -> int:
    """List the verdicts of all measured claims; 1 if a written one is contradicted."""
    parser = argparse.ArgumentParser(description=_main.__doc__)
    parser.add_argument("--write", action="store_true", help="keep the fresh ones, too")
    options = parser.parse_args(arguments)
    measured = [claim for claim in load() if claim.band]
    for claim in measured:
        print(_line(claim), flush=True)
    wrong = [claim.id for claim in measured if claim.judge() != claim.verdict]
    print(f"contradicted: {', '.join(wrong) or 'none'}")
    if options.write:
        kept = {"of results": _digest(), "fresh": {claim.id: claim.fresh() for claim in measured}}
        results.write_json(results.FOLDER / f"{_NAME}.json", kept)
    return bool(wrong)


if __name__ == "__main__":
    raise SystemExit(_main())
