"""Table 4-1, and what the controller, the length of training and the sensors decide in it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ddlib import results
from ddlib.controllers import pd
from ddlib.experiment import (
    COURSE,
    KD,
    KP,
    SETUPS,
    STATE_FEEDBACK,
    WINDOWS,
    Setup,
    errors,
    train_windows,
)
from ddlib.network import TorqueModel, Weights


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


def table_4_1(members=25) -> dict:
    """Table 4-1 for both readings of the controller; the networks go into ``.npz`` files."""
    table = {}
    for setup in SETUPS.values():
        recording = setup.record()
        table[setup.name] = {}
        for width in WINDOWS:
            followed = COURSE if setup is STATE_FEEDBACK else ()
            cell, model, kept = _cell(setup, recording, width, members, followed)
            table[setup.name][str(width)] = cell
            model.save(results.networks_path(setup.name, width))
            if kept:
                course = Weights.stack([kept[epoch][:2] for epoch in COURSE])
                TorqueModel(course, model.inputs, model.outputs).save(results.course_path(width))
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
