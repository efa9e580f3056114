"""Shapes from the motion, sizes from the arm? Networks that learnt torques with known numbers.

Torques of ten kinds (`workshop.report.known_torques`). Of each the names of the networks' filters;
the stiffness K, damping B and inertia M that are read from them; and knobs: one part of every row
is turned up by a fifth, and the change of torque is held against that of an arm, or a spring, with
a fifth more. What would speak against the sentence:

- A kind without an M whose read M, or whose answer to the parabola's knob, reaches the arm's.
- A kind with another M that reads like this arm.
- Position alone: a parabola that moves the torque by more than the constant's second moment asks
  for, ``-K mean(x^2) / 2`` with x the times of the window: that much a row draws against it.
- Planted numbers that the reading does not find (`control_kind`). A planted arm's answer to the
  knobs is what a perfect network could give: less than 1, as a parabola in a window smooths.
- A shape that all kinds with an M have, and no other: then it is the arm's.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.special import logit
from scipy.stats import t as student

from ddlib.analysis import LAYERS, calibrated, gains, mean_gradient
from ddlib.dynamics import IMI_ARM
from ddlib.learning import (
    TARGET_RANGE,
    WARM_UP_MOMENTUM,
    Descent,
    Scaler,
    TorqueModel,
    Weights,
    cases,
)
from ddlib.metrics import rmss
from ddlib.setups import JOINT_DAMPING, SETUPS, STATE_FEEDBACK, WINDOWS, Setup, true_states
from ddlib.simulation import LOG_STEP
from workshop.report.code_hash import code_hash, study
from workshop.report.known_torques import ARM, OWN, SLOWER, SOLVERS, Day, Kind
from workshop.report.pencil import knobs, moment_filters, turned, written
from workshop.report.studies.nulls import names_counted
from workshop.report.sweeps import _sweep

STARTS = (0.003, 0.03, 0.3)
"""Initial weights are uniform in plus or minus one of these."""

FACTOR = 1.2
"""By which a knob multiplies one part of every row."""

DAYS = (51, 52, 53, 54)
"""Seeds of `Setup.repeated`: recordings that no other study has used."""

MAIN = (JOINT_DAMPING.name, STATE_FEEDBACK.name)
"""Readings of the main rows: window 21 from 0.03, by more networks, for longer, by the solver."""

CONTROL = np.stack(
    [[[-20.0, 5.0], [0.0, 8.0]], [[9.0, 0.0], [0.0, 3.0]], [[4.0, -1.0], [0.5, 0.6]]], -1
)
"""N m/rad, N m s/rad and kg m^2 of the positive control, ``(output, joint, 3)``: no arm's, since
its inertia is not symmetric and two entries are negative."""

_EPOCHS, _LONG, _WARM_UP = 4000, 20_000, 500
_ROUNDS = 8  # until the slope of the outputs is that of the network as it is written


# --- what is read of networks -----------------------------------------------------------------


def described(day: Day, kind: Kind, model: TorqueModel, start=None, more: bool = False) -> dict:
    """Names, numbers and knobs of networks that learnt a kind; the first axis is networks.

    Of what training added the names are counted, too, if `start` is given; with `more` there are
    numbers of the direct weights alone, and knobs on one layer and in one regression.
    """
    names: dict = {}
    for layer, attribute in LAYERS.items():
        f = getattr(model.weights, attribute)
        names[layer] = {"trained": names_counted(f)}
        if start is not None:
            names[layer]["added"] = names_counted(f - getattr(start, attribute))
    sets = knobs(day.width)
    row = {
        "names": names,
        "error": rmss(model.torque(day.windows), kind.torque),
        "read": gains(mean_gradient(model, day.windows), LOG_STEP),
        "knobs": {name: answers(day, kind, model, pairs)[..., 0] for name, pairs in sets.items()},
    }
    if more:
        row["direct"] = calibrated(model, day.windows, LOG_STEP).direct
        row["together"] = answers(day, kind, model, sets["shape"])[:, 2, ..., 1:]
        row["one layer"] = {
            layer: answers(day, kind, model, sets["shape"], (layer,))[..., 0] for layer in LAYERS
        }
    return row


def answers(day: Day, kind: Kind, model: TorqueModel, pairs, layers=tuple(LAYERS)) -> np.ndarray:
    """Change of torque by each of three knobs, per change of K q, B q' or M q'' by a fifth.

    By least squares without a constant, on trajectory 6 and on the slower one: ``(networks, knob,
    motion, joint, 4)``; first on the knob's own term alone, then on all three together. An arm, or
    a spring, with a fifth more would answer with 1.
    """
    found = np.empty((len(model.weights), 3, len(day.motions), 2, 4))
    for m, motion in enumerate(day.motions):
        windows, _ = cases(motion, day.width)
        terms = (FACTOR - 1) * kind.terms(true_states(motion, day.setup).reshape(-1, 2, 3))
        before = model.torque(windows)
        for k, knob in enumerate(zip(*pairs)):
            change = turned(model, knob, FACTOR, layers).torque(windows) - before
            found[:, k, m, :, 0] = (change * terms[k]).sum(-2) / (terms[k] ** 2).sum(-2)
            for joint in range(2):
                together = np.linalg.lstsq(terms[..., joint].T, change[..., joint].T)[0]
                found[:, k, m, joint, 1:] = together.T
    return found


# --- by setting -------------------------------------------------------------------------------


def summary(days: list, more: bool):
    """Of each number its mean and the half of its 95 % interval; with `more` its extremes, too.

    The interval is of the mean over recordings, each the mean of its networks; the extremes are
    those of networks.
    """
    if isinstance(days[0], dict):
        return {name: summary([day[name] for day in days], more) for name in days[0]}
    means = np.array([day.mean(0) for day in days])
    half = student.ppf(0.975, len(days) - 1) * means.std(0, ddof=1) / np.sqrt(len(days))
    every = np.concatenate(days)
    extremes = {"least": every.min(0), "most": every.max(0)} if more else {}
    return {"mean": means.mean(0), "half": half, **extremes}


def _means(days: list):
    """Of each share its mean alone."""
    if isinstance(days[0], dict):
        return {name: _means([day[name] for day in days]) for name in days[0]}
    return np.mean(days, (0, 1))


def _together(days: list[dict], truth: list, more: bool = False) -> dict:
    """One row of all recordings; with `more` M11 and the shoulder's knob network by network."""
    row = {"truth": np.mean(truth, 0), "names": _means([day.pop("names") for day in days])}
    row |= summary(days, more)
    if more:
        row["every"] = {
            "M11": np.concatenate([day["read"][:, 0, 0, 2] for day in days]),
            "knob": np.concatenate([day["knobs"]["shape"][:, 2, 0, 0] for day in days]),
        }
    return row


def _reading(name: str, initial: float, epochs: int) -> Setup:
    how = {"steps": 0, "decay": 0.0, "warm_up": _WARM_UP}
    return replace(SETUPS[name], initial=initial, epochs=epochs, **how)


def _cell(reading, width, initial, method="descent", epochs=_EPOCHS, days=4, networks=2) -> dict:
    """Networks of one setting, by kind."""
    setup, more = _reading(reading, initial, epochs), days * networks > 8
    found: dict = {}
    truth: dict = {}
    for k in DAYS[:days]:
        day, other = (
            Day(replace(setup, arm=arm).repeated(k), width) for arm in (setup.arm, IMI_ARM)
        )
        for its, kinds in (
            (day, day.kinds(networks, seed=1000 * k)),
            (other, {OWN: other.kinds(networks, seed=1000 * k)[ARM]}),
        ):
            for name, *trained in its.learnt(kinds, networks, method, seed=1000 * k):
                row = described(its, kinds[name], *trained, more)
                found.setdefault(name, []).append(row)
                truth.setdefault(name, []).append(kinds[name].truth(its.states))
    return {name: _together(each, truth[name], more) for name, each in found.items()}


# --- the positive control -----------------------------------------------------------------------


def control_kind(day: Day) -> Kind:
    """Torques in which `CONTROL` is all that there is."""
    stiffness, damping, inertia = np.moveaxis(CONTROL, -1, 0)
    kind = Kind(day.torque[None], stiffness, damping, inertia, "KBM")
    return replace(kind, torque=kind.terms(day.states).sum(0)[None])


def by_pencil(day: Day, kind: Kind, share: float, networks: int, seed: int) -> TorqueModel:
    """A share of a kind's numbers in direct weights that were zero, beside random hidden units."""
    start = Weights.random(networks, day.width, initial=day.setup.initial, seed=seed)
    start = replace(start, direct_weights=np.zeros_like(start.direct_weights))
    outputs = Scaler.fit(kind.torque[0], TARGET_RANGE)
    blank = TorqueModel(start, day.data.inputs, outputs, LOG_STEP)
    rest = start.activity(blank.scaled(np.zeros((1, 2, day.width))))[1][:, 0]
    start.output_bias[:] += logit(outputs.scale(np.zeros(2))) - logit(rest)  # no torque at zero
    numbers = share * kind.truth(day.states)
    filters = moment_filters(day.width, LOG_STEP)
    return written(blank, day.windows, numbers, filters, rounds=_ROUNDS)


def hidden_trained(day: Day, kind: Kind, model: TorqueModel) -> TorqueModel:
    """The networks after descent to a kind's torques in which direct weights are held."""
    setup, start = day.setup, model.weights
    target = model.outputs.scale(kind.torque[0])
    rate = setup.rate / day.width / len(target)
    descent = Descent(start, day.data.x, target, rate, setup.momentum)
    rows = descent.first.view(len(start), descent.rows, -1)[:, descent.hidden :, :-1]
    held = rows.clone()
    for epoch in range(setup.epochs):
        descent.epoch(most=WARM_UP_MOMENTUM if epoch < setup.warm_up else 1.0)
        rows.copy_(held)
    return replace(model, weights=descent.weights())


def _control(reading, width, epochs=_EPOCHS, days=4, networks=2) -> dict:
    """What is read where numbers were planted, by how they were."""
    setup = _reading(reading, SETUPS[reading].initial, epochs)
    found: dict = {}
    truth: dict = {}
    for k in DAYS[:days]:
        day, seed = Day(setup.repeated(k), width), 1000 * k
        kind, own = control_kind(day), day.kinds(networks, seed)[ARM]
        whole, half = (by_pencil(day, kind, share, networks, seed) for share in (1.0, 0.5))
        [(_, trained, _)] = day.learnt({"control": kind}, networks, "descent", seed)
        for name, planted, model in (
            ("by pencil", kind, whole),
            ("half by pencil, hidden units trained", kind, hidden_trained(day, kind, half)),
            ("trained", kind, trained),
            ("the arm's mean by pencil", own, by_pencil(day, own, 1.0, networks, seed)),
        ):
            found.setdefault(name, []).append(described(day, planted, model, more=True))
            truth.setdefault(name, []).append(planted.truth(day.states))
    return {name: _together(each, truth[name]) for name, each in found.items()}


@study
def _planted() -> dict:
    """Cells by method, reading, window, start and kind; then the control."""
    grid = [
        {"reading": reading, "width": width, "initial": initial}
        for reading in SETUPS
        for width in WINDOWS
        for initial in STARTS
    ]
    main = [{"reading": reading, "width": 21, "initial": 0.03, "days": 3} for reading in MAIN]
    longer = [{**row, "epochs": _LONG, "networks": 20} for row in main]
    solved = [{**row, "method": method, "networks": 3} for method in SOLVERS for row in main]
    control = [{"reading": reading, "width": width} for reading in SETUPS for width in WINDOWS]
    control += [{"reading": reading, "width": 21, "epochs": _LONG} for reading in MAIN]
    how = {"code": code_hash("planted"), "backend": "sequential"}

    def rows(settings, label, experiment=_cell):
        found = _sweep(experiment, settings, label=label, **how)
        return [{"setting": setting, "kinds": row} for setting, row in zip(settings, found)]

    return {
        **{"starts": STARTS, "factor": FACTOR, "epochs": [_EPOCHS, _LONG], "slower": SLOWER},
        "grid": rows(grid, "grid"),
        "long": rows(longer, "long"),
        "solved": rows(solved, "solved"),
        "planted": CONTROL,
        "control": rows(control, "control", _control),
    }
