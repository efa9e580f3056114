"""Section 7.1: circles of the hand, several via points, and what transfers between families."""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable
from dataclasses import replace
from itertools import product

import numpy as np

from beyond.control.windowed import WindowFeedforward
from beyond.rivals.identified import Identified, Linear
from beyond.rivals.networks import BySolver
from beyond.rivals.protocol import Cases, Estimating, Rival
from beyond.studies.loop import motions
from beyond.studies.loop.feedforwards import exact, through_window
from beyond.studies.loop.motions import training
from ddlib.analysis import CLASSES, calibrated, classify, unit_inputs, unit_responses
from ddlib.control import Feedforward
from ddlib.dynamics import ELBOWS, end_point_error, reach
from ddlib.learning import NotConverged, TorqueModel, related, surrogate
from ddlib.metrics import rmss
from ddlib.setups import INITIAL, JOINT_DAMPING, STATE_FEEDBACK, Setup, true_states
from ddlib.simulation import CONTROL_STEP, LOG_STEP, Recording
from ddlib.trajectories import (
    MOTION_SECONDS,
    OutsideFamilyWarning,
    Trajectory,
    pick_and_place,
    random_extents,
)
from workshop.report import results
from workshop.report.code_hash import study

_DAYS, _MEMBERS = 10, 40  # of training; members of each family in a test
_WIDTH, _WIDER = 21, (11, 41)

_NAMES = ("network", "two units", "linear filter", "identified")
_PICKER = results.FOLDER / "stirring-picker.npz"  # read by `beyond.chapters.widgets.stirring`

# Circles of the picker: centre (m, degrees), radius (m), time of a turn (s), sign of the elbow.
PLACES = {
    "distance": (0.45, 0.55, 0.65, 0.75, 0.85),
    "bearing": (-90, -75, -60, -45, -30),
    "radius": (0.04, 0.08, 0.12, 0.16),
    "period": (1.5, 2.0, 3.0),
    "elbow": ELBOWS,
}

SHOWN = 5  # of the samples, every so many are kept for the picker


def _maker(setup: Setup, name: str, seed: int) -> Rival:
    """One of `_NAMES` that has learnt nothing."""
    if name == "identified":
        return Estimating(Identified())
    if name == "linear filter":
        return Linear()
    hidden = setup.hidden if name == "network" else 2
    return BySolver(hidden, setup.steps, decay=setup.decay, initial=INITIAL, seed=seed)


def _errors(model: Callable, tests: dict[str, Cases]) -> dict[str, list[float]]:
    """RMSS by the test's own deviation, and RMS errors of both joints (N m), of each test."""
    errors = {}
    with warnings.catch_warnings(action="ignore", category=OutsideFamilyWarning):
        for name, cases in tests.items():
            torque = model(cases.x)
            left = np.sqrt(((torque - cases.torque) ** 2).mean(0))
            errors[name] = [float(rmss(torque, cases.torque)), *left]
    return errors


def fitted(rival: Rival, cases: Cases) -> Rival:
    """The rival, trained for as many steps as it has."""
    with warnings.catch_warnings(action="ignore", category=NotConverged):
        return rival.fit(cases)


def _answers(tests: dict, width: int) -> dict[str, Cases]:
    """Every third window of recordings."""
    return {name: Cases.windows(run, width)[::3] for name, run in tests.items()}


def _transfer(setup: Setup, names, width: int, families, runs: list, tests: dict) -> tuple:
    """Every rival trained on each family, day by day, and tested: rivals, and errors by day."""
    answers = _answers(tests, width)
    rivals: dict = {pair: [] for pair in product(names, families)}
    errors: dict = {name: {family: {} for family in families} for name in names}
    for day, run in enumerate(runs):
        cases = motions.training_cases(run, width)
        for (name, family), trained in rivals.items():
            trained.append(fitted(_maker(setup, name, day), cases[family]))
            every = _errors(trained[-1].torque, {"training": cases[family], **answers})
            for part, error in every.items():
                errors[name][family].setdefault(part, []).append(error)
    return rivals, errors


def _wider(setup: Setup, runs: list, tests: dict) -> dict:
    """Networks of other windows: those of Table 4-1, and as many that learnt circles."""
    by_width = {}
    for width in _WIDER:
        answers, networks = _answers(tests, width), results.networks(width, setup.name)
        mine: dict = {}
        for k in range(len(runs)):
            for part, error in _errors(networks[k].torque, answers).items():
                mine.setdefault(part, []).append(error)
        other = _transfer(setup, _NAMES[:1], width, motions.FAMILIES[1:2], runs, tests)[1]
        by_width[str(width)] = {"pick and place": mine, **other["network"]}
    return by_width


def through(setup: Setup, torques, reference: Trajectory) -> Recording:
    """Drive an arm with feedforward torques ``(models, runs, time, 2)`` over its own feedback."""
    tiled = Trajectory(*(np.broadcast_to(x, torques.shape) for x in reference))
    return motions.recorded(
        setup, tiled, controller=Feedforward(lambda *_: torques, setup.controller)
    )


def off(setup: Setup, log: Recording) -> np.ndarray:
    """RMS distance of the hand from where it should be during the motion, shape (...), mm."""
    error = end_point_error(setup.arm, log.reference.q, log.q_true)[..., log.motion, :]
    return 1000 * np.sqrt((error**2).sum(-1).mean(-1))


def hand_errors(setup: Setup, torques: dict[str, list], reference: Trajectory) -> dict:
    """Errors of the hand (mm), shape (models, runs), by the name of the feedforward torques."""
    every = np.stack([torque for several in torques.values() for torque in several])
    ends = np.cumsum([len(several) for several in torques.values()])[:-1]
    return dict(zip(torques, np.split(off(setup, through(setup, every, reference)), ends)))


def boxes(setup: Setup, models: dict[str, list]) -> dict[str, list[Callable]]:
    """All that may stand in the box "inverse arm" of Figure 2-1, by name."""
    return {
        "none": [lambda q, qd, qdd: np.zeros_like(q)],
        "exact equations": [exact(setup)],
        "exact behind a window": [through_window(exact(setup))],
        **{n: [WindowFeedforward(model, _WIDTH) for model in ms] for n, ms in models.items()},
    }


def _hands(setup: Setup, rivals: dict, members: int) -> dict:
    """End-point errors (mm) on circles and on pick-and-place, shape (models, runs)."""
    t, today = motions.times(), setup.repeated(motions.TEST_DAY)
    references = {
        "circles": motions.stirred(setup.arm, motions.random_circles(members, motions.TEST_DAY), t),
        "pick and place": pick_and_place(random_extents(members, motions.TEST_DAY), t),
    }
    models = {
        f"{name}, {family}": [r._torque for r in trained]
        for (name, family), trained in rivals.items()
        if name != "two units"
    }
    named = boxes(setup, models)
    errors: dict = {name: {} for name in named}
    for motion, reference in references.items():
        torques = {name: [f(*reference) for f in ms] for name, ms in named.items()}
        for name, off_by in hand_errors(today, torques, reference).items():
            errors[name][motion] = off_by
    return errors


def _described(rivals: list, runs: list, family: str, setup: Setup) -> dict:
    """What the hidden filters of networks look like and follow, one row for each network."""
    rows = []
    for rival, day in zip(rivals, runs):
        x = Cases.windows(day[family], _WIDTH).x
        names = classify(rival.model.weights.hidden_weights)
        motion = true_states(day[family], setup).reshape(-1, 2, 3)
        follows = unit_responses(unit_inputs(rival.model, x)["hidden"], motion)
        rows.append({
            "classes": [(names == name).mean() for name in CLASSES],
            "alone": np.median(follows.alone, 0),
            "unique": np.median(follows.unique, 0),
            "gains": calibrated(rival.model, x, LOG_STEP).whole,
        })  # fmt: skip
    return {key: np.array([row[key] for row in rows]) for key in rows[0]}


def _filters(setup: Setup, rivals: dict, runs: list) -> dict:
    """Filters on the real torques and on torques with random phases, a draw for each day."""
    row: dict = {"classes": list(CLASSES)}
    for family in ("circles", "pick and place"):
        null, explained = [], []
        for day, run in enumerate(runs):
            cases = Cases.windows(run[family], _WIDTH)
            drawn = surrogate("phases", cases.torque.reshape(5, -1, 2), day).reshape(-1, 2)
            explained.append(related(drawn, cases.x))
            null.append(fitted(_maker(setup, "network", day), replace(cases, torque=drawn)))
        row[family] = {
            "real": _described(rivals["network", family], runs, family, setup),
            "phases": _described(null, runs, family, setup),
            "related": explained,
        }
    return row


def network_path(family: str):
    """File of the network of window 21 (joint damping) that learnt one of `FAMILIES`."""
    return results.FOLDER / f"networks-stirring-{family.replace(' ', '-')}.npz"


def _keep(setup: Setup, rivals: dict, table: dict) -> dict[str, TorqueModel]:
    """Save, of each family, the network with the median error on its own test."""
    models = {}
    for family in motions.FAMILIES[:3]:
        part = family if family != "both" else "circles"
        order = np.argsort([error[0] for error in table["network"][family][part]])
        models[family] = rivals["network", family][order[len(order) // 2]].model
        models[family].save(network_path(family))
    return models


def _picker(setup: Setup, kept: dict[str, TorqueModel], places=None) -> None:
    """Torques and hand errors on a grid of circles, for the picker; unreachable ones stay zero."""
    *extents, elbows = (PLACES if places is None else places).values()
    named = {n: ms[0] for n, ms in boxes(setup, {f: [m.torque] for f, m in kept.items()}).items()}
    del named["exact equations"]
    shape, t = tuple(map(len, (*extents, elbows))), motions.times()
    distance, bearing, radius, period = (x.ravel() for x in np.meshgrid(*extents, indexing="ij"))
    near, far = reach(setup.arm)
    fine = np.flatnonzero((distance - radius > near) & (distance + radius < far))
    circles = motions.Circles(radius, period, distance, bearing, np.zeros(len(radius), bool))[fine]
    first = round(-t[0] / CONTROL_STEP)
    shown = slice(first, first + round(MOTION_SECONDS / CONTROL_STEP), SHOWN * 5)
    reached = np.zeros((len(distance), len(elbows)), bool)
    torque = np.zeros((3, *reached.shape, len(t[shown]), 2))
    hand_errors = np.zeros((len(named), *reached.shape))
    for e, elbow in enumerate(elbows):
        reference = motions.stirred(setup.arm, circles, t, elbow)
        torques = np.stack([model(*reference) for model in named.values()])
        reached[fine, e] = True
        hand_errors[:, fine, e] = off(setup, through(setup, torques, reference))
        torque[:, fine, e] = torques[1:4][:, :, shown]
    part = _PICKER.with_name(_PICKER.name + ".part")
    with open(part, "wb") as file:
        np.savez_compressed(
            file,
            names=list(named),
            reached=reached.reshape(shape),
            hand=hand_errors.reshape(-1, *shape).astype(np.float32),
            torque=torque.reshape(3, *shape, -1, 2).astype(np.float16),
        )
    os.replace(part, _PICKER)


@study
def _stirring(days: int = _DAYS, members: int = _MEMBERS) -> dict:
    """Networks and rivals of each family of motions on all others, and their hands' errors."""
    result: dict = {"days": days, "members": members, "width": _WIDTH, "setups": {}}
    every = (
        (JOINT_DAMPING, _NAMES, motions.FAMILIES),
        (STATE_FEEDBACK, _NAMES[::2], motions.FAMILIES[:3]),
    )
    for setup, names, families in every:
        main = setup is JOINT_DAMPING
        setup = replace(setup, steps=JOINT_DAMPING.steps, decay=JOINT_DAMPING.decay)
        runs = training(setup, range(days))
        tests = motions.test_recordings(setup, members, vias=main)
        if not main:
            names = (*names, "identified")
        rivals, errors = _transfer(setup, names, _WIDTH, families, runs, tests)
        row = {
            "deviations": {n: Cases.windows(r, _WIDTH).torque.std(0) for n, r in tests.items()},
            "errors": errors,
            "coverage": motions.coverage(setup, tests, members),
            "hands": _hands(setup, rivals, members // 2),
        }
        if main:
            row["wider"] = _wider(setup, runs, tests)
            row["filters"] = _filters(setup, rivals, runs)
            _picker(setup.repeated(motions.TEST_DAY), _keep(setup, rivals, errors))
        result["setups"][setup.name] = row
    return result
