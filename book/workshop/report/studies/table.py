"""Table 4-1, and what the length of training and the sensors decide in it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ddlib.analysis import roughness, saturated
from ddlib.control import pd
from ddlib.effects import CMU_DD_ARM_II_EFFECTS
from ddlib.learning import Directions, TorqueModel, TrainingSet, Weights, cases
from ddlib.setups import (
    COURSE,
    JOINT_DAMPING,
    KP,
    LITERATURE,
    SETUPS,
    STATE_FEEDBACK,
    WINDOWS,
    errors,
    split,
    train_windows,
)
from workshop.report import results
from workshop.report.code_hash import study


def errors_and_weights(model, history, recording) -> dict:
    """What is written of trained networks: errors in training and test, the largest weights."""
    measured = errors(model, recording)
    return {
        "training": measured.training,
        "test": measured.test,
        "best test": history.best_test,
        "largest weight": model.weights.largest,
    }


def _cell(setup, recording, width, members, snapshots=()):
    model, history, weights = train_windows(setup, recording, width, members, snapshots=snapshots)
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
    return cell, model, weights


@study
def _table_4_1(members=25) -> dict:
    """Table 4-1 for the readings of the controller; the networks go into ``.npz`` files."""
    cells = {}
    for setup in SETUPS.values():
        recording = setup.record()
        cells[setup.name] = {}
        for width in WINDOWS:
            epochs = COURSE if setup is STATE_FEEDBACK else ()
            cell, model, weights = _cell(setup, recording, width, members, epochs)
            cells[setup.name][str(width)] = cell
            model.save(results._networks_path(setup.name, width))
            if weights:
                course = Weights.stack([weights[epoch][:2] for epoch in COURSE])
                TorqueModel(course, model.inputs, model.outputs).save(results._course_path(width))
    return {"members": members, "setups": cells}


def _ablations() -> dict:
    """`JOINT_DAMPING` with one thing changed at a time, and with nothing tuned, by name."""
    whole = JOINT_DAMPING
    viscous, coulomb = whole.effects.friction
    default = CMU_DD_ARM_II_EFFECTS

    def effects(**parts):
        return replace(whole, effects=replace(whole.effects, **parts))

    descent = replace(whole, steps=0, decay=0.0)
    return {
        "joint damping": whole,
        "damping in the controller": replace(
            effects(friction=(default.friction[0], coulomb)),
            controller=pd(whole.controller.kp, viscous.coefficient),
        ),
        "no Coulomb friction": effects(friction=(viscous,)),
        "16 bits": effects(encoder=default.encoder),
        "default gain": replace(whole, controller=replace(whole.controller, kp=KP)),
        "default descent": descent,
        "descent, inputs -1 to 1": replace(
            descent, scaling=(-1.0, 1.0), epochs=50_000, momentum=0.995, rate=66.0
        ),
        "nothing tuned, solver": replace(LITERATURE, steps=whole.steps, decay=whole.decay),
        LITERATURE.name: LITERATURE,
    }


def _on_days(setup, days, networks, whiten=True) -> dict:
    """By window `errors_and_weights`, each of shape ``(days, networks)`` (`Setup.repeated`)."""
    cells = {str(w): [] for w in WINDOWS}
    for day in range(1, days + 1):
        recording = setup.repeated(day).record()
        for w in WINDOWS:
            model, history, _ = train_windows(
                setup, recording, w, networks, seed=100 * day, whiten=whiten, progress=False
            )
            ends = _saturated(model, recording, w)
            cells[str(w)].append(
                {**errors_and_weights(model, history, recording), "saturated": ends}
            )
    return {w: {key: [row[key] for row in cell] for key in cell[0]} for w, cell in cells.items()}


@study
def _recordings(days=5, networks=5, fewer=1) -> dict:
    """Joint damping and its ablations on several days.

    `networks` for each day and window of the set-up itself, `fewer` of the ablations.
    """
    rows = {
        name: _on_days(setup, days, networks if setup is JOINT_DAMPING else fewer)
        for name, setup in _ablations().items()
    }
    return {"days": days, "networks": networks, "fewer": fewer, "setups": rows}


@study
def _whitening(days=5, networks=2, members=8, width=41) -> dict:
    """Joint damping without whitening, on the days of `recordings`; and what whitening learns.

    Along each direction of the windows of one recording, the steepest first: the change of the
    weights over their start, by the solver with whitening and without, and by descent.
    """
    recording = JOINT_DAMPING.record()
    along = Directions.of(TrainingSet.from_recording(split(recording)[0], width))
    start = Weights.random(members, width, initial=JOINT_DAMPING.initial)
    ways = {
        "whitened": (JOINT_DAMPING, True),
        "whitened, no decay": (replace(JOINT_DAMPING, decay=0.0), True),
        "plain": (JOINT_DAMPING, False),
        "plain, twice the steps": (replace(JOINT_DAMPING, steps=2 * JOINT_DAMPING.steps), False),
        "descent": (replace(JOINT_DAMPING, steps=0, decay=0.0), True),
    }
    directions = {}
    for name, (setup, whiten) in ways.items():
        model, history, _ = train_windows(setup, recording, width, members, whiten=whiten)
        change = along.energy(model.weights, start) / along.energy(start)
        hidden = model.weights.hidden_weights
        rough = {"trained": hidden, "change": hidden - start.hidden_weights}
        directions[name] = {
            **errors_and_weights(model, history, recording),
            "learnt": (change > 1).sum(-1),
            "change over start": np.sqrt(np.median(change, 0)),
            **{f"roughness, {k}": np.median(roughness(w), (-2, -1)) for k, w in rough.items()},
        }
    return {
        **{"days": days, "networks": networks, "members": members, "width": width},
        "variance": (along.values / along.values[0]) ** 2,
        "directions": directions,
        "plain": _on_days(JOINT_DAMPING, days, networks, whiten=False),
    }


def _saturated(model, recording, width) -> np.ndarray:
    """Share of the hidden units' activities at one of their ends on runs 1 to 5, per network."""
    windows, _ = cases(split(recording)[0], width)
    members = (model[k] for k in range(len(model.weights)))
    return np.array([saturated(m.weights.activity(m.scaled(windows))[0]).mean() for m in members])


@study
def _longer(members=8, epochs=60_000) -> dict:
    """State feedback trained three times as long: where do the errors go?"""
    setup = replace(STATE_FEEDBACK, epochs=epochs)
    recording = setup.record()
    windows = {str(w): _cell(setup, recording, w, members)[0] for w in WINDOWS}
    return {"members": members, "epochs": epochs, "windows": windows}


@study
def _clean(members=8) -> dict:
    """State feedback on an arm without friction, quantisation and torque noise."""
    effects = STATE_FEEDBACK.effects.without("friction", "encoder", "torque_sensor")
    setup = replace(STATE_FEEDBACK, effects=effects, name="perfect sensors, no friction")
    recording = setup.record()
    windows = {str(w): _cell(setup, recording, w, members)[0] for w in WINDOWS}
    return {"members": members, "windows": windows}
