"""Table 4-1, and what the length of training and the sensors decide in it."""

from __future__ import annotations

from dataclasses import replace

from ddlib.experiments import results
from ddlib.experiments.setups import COURSE, SETUPS, STATE_FEEDBACK, WINDOWS, errors, train_windows
from ddlib.learning import TorqueModel, Weights


def _cell(setup, recording, width, members, snapshots=()):
    model, history, kept = train_windows(setup, recording, width, members, snapshots=snapshots)
    cell = {
        "errors": errors(model, recording).named(),
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
    """Table 4-1 for the readings of the controller; the networks go into ``.npz`` files."""
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
