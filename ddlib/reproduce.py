"""Measure anew what is too slow for a chapter: ``make reproduce``.

Every part is a function that returns a plain dictionary. A part whose result is there
already, made by the same code, is skipped; so an interrupted run resumes.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ddlib import figures, results
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
from ddlib.filters import purest
from ddlib.network import TorqueModel
from ddlib.simulate import LOG_STEP


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


def table_4_1(members=25, snapshots=(0, 10, 30, 100, 300, 1000, 3000, 10_000, 20_000)) -> dict:
    """Table 4-1 for both readings of the controller; the networks go into ``.npz`` files."""
    table = {}
    for setup in SETUPS.values():
        recording = setup.record()
        table[setup.name] = {}
        for width in WINDOWS:
            cell, model, kept = _cell(setup, recording, width, members, snapshots)
            table[setup.name][str(width)] = cell
            model.save(results.networks_path(setup.name, width))
            for epoch, weights in kept.items() if setup is STATE_FEEDBACK else ():
                first = TorqueModel(weights[:2], model.inputs, model.outputs)
                first.save(results.snapshot_path(width, epoch))
    return {"members": members, "setups": table}


def gains(members=8) -> dict:
    """What the assumed gains decide: Table 4-1 for softer and stiffer controllers."""
    factors = ((0.25, 0.5), (0.5, 0.7), (2.0, 1.4), (4.0, 2.0), (0.5, 0.0), (4.0, 0.0))
    rows = []
    for position, velocity in factors:
        kp, kd = position * np.array(KP), velocity * np.array(KD)
        setup = Setup(f"kp x {position:g}, kd x {velocity:g}", pd(tuple(kp), tuple(kd)))
        recording = setup.record()
        tracking = np.rad2deg(np.abs(recording.tracking_error[:, recording.motion]).max())
        row = {"kp": kp, "kd": kd, "largest tracking error, degrees": tracking, "windows": {}}
        for width in WINDOWS:
            cell, *_ = _cell(setup, recording, width, members)
            row["windows"][str(width)] = {
                "training": cell["errors"]["training"],
                "test": cell["errors"]["test"],
                "best test": cell["best test"],
                "largest weight": cell["largest weight"],
            }
        rows.append(row)
    return {"members": members, "rows": rows}


def longer(members=8, epochs=60_000) -> dict:
    """State feedback trained three times as long: where do the errors go?"""
    setup = replace(STATE_FEEDBACK, epochs=epochs)
    recording = setup.record()
    windows = {str(w): _cell(setup, recording, w, members)[0] for w in WINDOWS}
    return {"members": members, "epochs": epochs, "windows": windows}


def clean(members=8) -> dict:
    """State feedback on an arm without friction, quantisation and torque noise."""
    effects = STATE_FEEDBACK.effects.without("friction", "encoder", "torque_sensor")
    setup = replace(STATE_FEEDBACK, effects=effects, name="perfect sensors, no friction")
    recording = setup.record()
    windows = {str(w): _cell(setup, recording, w, members)[0] for w in WINDOWS}
    return {"members": members, "windows": windows}


def picture() -> None:
    """The README's picture: two filters found in the networks of window 21."""
    networks = TorqueModel.load(results.networks_path(STATE_FEEDBACK.name, 21)).weights
    found = {
        f"{name} filter": purest(networks.hidden_weights, name)
        for name in ("velocity", "acceleration")
    }
    target = results.FOLDER.parent / "_static" / "readme.svg"
    figures.decomposition(found, LOG_STEP).save(target)


PARTS: dict[str, Callable[[], dict]] = {
    "table-4-1": table_4_1,
    "gains": gains,
    "longer": longer,
    "clean": clean,
}
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
    results.FOLDER.mkdir(parents=True, exist_ok=True)
    codes = {name: results.code_hash(name) for name in PARTS}  # now: files may change meanwhile
    for name in options.parts or PARTS:
        path = results.FOLDER / f"{name}.json"
        fresh = path.is_file() and results.read(name)["made by"]["code"] == codes[name]
        if fresh and not options.force:
            print(f"==> {name}: up to date", flush=True)
            continue
        print(f"==> {name}", flush=True)
        started = time.monotonic()
        content = PARTS[name]()
        seconds = time.monotonic() - started
        made_by = {**results.stamp(seconds, name), "code": codes[name]}
        results.write_json(path, {"made by": made_by, **content})
        print(f"==> {name}: {seconds:.0f} s, written to {path}", flush=True)
    picture()


if __name__ == "__main__":
    main()
