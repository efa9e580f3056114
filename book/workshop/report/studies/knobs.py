"""Which knobs decide Table 4-1: a screening design over recordings and learning."""

from __future__ import annotations

from ddlib.setups import WINDOWS, train_windows
from workshop.report.code_hash import code_hash, study
from workshop.report.knobs import METHODS, _screening, _setup, _without_start, knobs_of
from workshop.report.studies.table import _row
from workshop.report.sweeps import _sweep

# Initial weights tried for a network at most: one that derails is begun anew, as anyone would
_TRIES = 3


def _run(method: str, places: list, seeds: list) -> dict:
    """One run of the design: for each seed a recording and a network for each window."""
    values = {
        name: float(knob.value(x)) for (name, knob), x in zip(knobs_of(method).items(), places)
    }
    here, rows, derailed = _setup(values, method), [], 0
    for seed in seeds:
        recording = _without_start(here.repeated(seed).record(), values["start left out"])
        rows.append({})
        for width in WINDOWS:
            for again in range(_TRIES):
                model, history, _ = train_windows(
                    here, recording, width, 1, seed=seed + 1000 * again, progress=False
                )
                derailed += bool(history.derailed[0])
                if not history.derailed[0]:
                    break
            rows[-1][width] = _row(model, history, recording)
    cells = {
        str(w): {name: [float(one[w][name][0]) for one in rows] for name in rows[0][w]}
        for w in WINDOWS
    }
    return {"values": values, "places": list(places), "derailed": derailed, "windows": cells}


@study
def screened(networks=2) -> dict:
    """The six errors at each run of the design, by both methods; every network has its own day."""
    settings = [
        {
            "method": method,
            "places": [float(x) for x in run[: len(knobs_of(method))]],
            "seeds": [1 + networks * k + i for i in range(networks)],
        }
        for method in METHODS
        for k, run in enumerate(_screening())
    ]
    rows = _sweep(_run, settings, code=code_hash("screened"), backend="sequential", label="knobs")
    half = len(settings) // len(METHODS)
    return {
        "networks": networks,
        "methods": {m: rows[k * half : (k + 1) * half] for k, m in enumerate(METHODS)},
    }
