"""Measure anew what is too slow for a chapter: ``make reproduce``.

Every part is a function that returns a plain dictionary. A part whose result is there
already, made by the same code, is skipped; so an interrupted run resumes.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable

import numpy as np

from ddlib import results
from ddlib.controllers import pd
from ddlib.experiment import (
    KD,
    KP,
    SETUPS,
    STATE_FEEDBACK,
    WINDOWS,
    Setup,
    errors,
    train_windows,
)
from ddlib.network import TorqueModel

MEMBERS = 25
"""Networks per cell of Table 4-1."""

SNAPSHOTS = (0, 10, 30, 100, 300, 1000, 3000, 10_000, 20_000)
"""Epochs at which the first networks' weights are kept."""

GAIN_FACTORS = ((0.5, 0.5), (2.0, 1.4), (10.0, 3.2), (0.5, 0.0), (2.0, 0.0), (10.0, 0.0))
"""Factors on the position and velocity gains whose influence is shown."""

GAIN_MEMBERS = 8
"""Networks per cell of that comparison."""


def _cell(setup, recording, width, members, snapshots=()):
    model, history, kept = train_windows(setup, recording, width, members, snapshots=snapshots)
    cell = {
        "errors": errors(model, recording),
        "best test": history.best_test,
        "largest weight": model.weights.largest,
        "slope": history.slope(),
        "derailed": history.derailed,
        "history": {
            "epochs": history.epochs,
            "training": history.training.T,
            "test": history.test.T,
        },
    }
    return cell, model, kept


def table_4_1() -> dict:
    """Table 4-1 for both readings of the controller; the networks go into ``.npz`` files."""
    table = {}
    for setup in SETUPS.values():
        recording = setup.record()
        table[setup.name] = {}
        for width in WINDOWS:
            cell, model, kept = _cell(setup, recording, width, MEMBERS, SNAPSHOTS)
            table[setup.name][str(width)] = cell
            model.save(results.FOLDER / f"networks-{setup.name.replace(' ', '-')}-{width}.npz")
            if setup is STATE_FEEDBACK:
                first = {f"epoch {e}": TorqueModel(w[:2], model.inputs, model.outputs)
                         for e, w in kept.items()}  # fmt: skip
                for epoch, snapshot in first.items():
                    name = f"snapshot-{width}-{epoch.split()[1]}.npz"
                    snapshot.save(results.FOLDER / "snapshots" / name)
    return {"members": MEMBERS, "setups": table}


def gains() -> dict:
    """What the assumed gains decide: Table 4-1 for other controllers."""
    rows = []
    for position, velocity in GAIN_FACTORS:
        kp, kd = position * np.array(KP), velocity * np.array(KD)
        setup = Setup(f"kp x {position:g}, kd x {velocity:g}", pd(tuple(kp), tuple(kd)))
        recording = setup.record()
        tracking = np.rad2deg(np.abs(recording.tracking_error[:, recording.motion]).max())
        row = {"kp": kp, "kd": kd, "largest tracking error, degrees": tracking, "windows": {}}
        for width in WINDOWS:
            cell, *_ = _cell(setup, recording, width, GAIN_MEMBERS)
            row["windows"][str(width)] = {
                "training": cell["errors"]["training"],
                "test": cell["errors"]["test"],
                "largest weight": cell["largest weight"],
            }
        rows.append(row)
    return {"members": GAIN_MEMBERS, "rows": rows}


PARTS: dict[str, Callable[[], dict]] = {"table-4-1": table_4_1, "gains": gains}
"""The parts by the name of their result."""


def main(arguments=None) -> None:
    """Run the parts that are missing or stale; ``--force`` runs them all."""
    parser = argparse.ArgumentParser(description=main.__doc__)
    parser.add_argument("parts", nargs="*", help=f"among {', '.join(PARTS)}; default: all")
    parser.add_argument("--force", action="store_true", help="also what is up to date")
    options = parser.parse_args(arguments)
    for name in options.parts:
        if name not in PARTS:
            parser.error(f"parts must be among {', '.join(PARTS)}, got {name!r}")
    (results.FOLDER / "snapshots").mkdir(parents=True, exist_ok=True)
    for name in options.parts or PARTS:
        path = results.FOLDER / f"{name}.json"
        fresh = path.is_file() and results.read(name)["made by"]["code"] == results.code_hash()
        if fresh and not options.force:
            print(f"==> {name}: up to date", flush=True)
            continue
        print(f"==> {name}", flush=True)
        started = time.monotonic()
        content = PARTS[name]()
        seconds = time.monotonic() - started
        results.write_json(path, {"made by": results.stamp(seconds), **content})
        print(f"==> {name}: {seconds:.0f} s, written to {path}", flush=True)


if __name__ == "__main__":
    main()
