"""Where filters come from: targets unrelated to the motion, other starts, other ends."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ddlib import learning
from ddlib.analysis import (
    CLASSES,
    LAYERS,
    calibrated,
    classify,
    heard,
    mean_gradient,
    refitted,
    roughness,
    saturated,
    transition_width,
    unit_inputs,
)
from ddlib.learning import (
    MATCHED,
    TorqueModel,
    TrainingSet,
    Weights,
    cases,
    related,
    sliding_windows,
    surrogates,
)
from ddlib.metrics import rmss
from ddlib.setups import JOINT_DAMPING, STATE_FEEDBACK, WINDOWS, Setup, split, true_states
from ddlib.simulation import LOG_STEP, Recording
from workshop.report.code_hash import study
from workshop.report.probes import (
    cancellation,
    decoded,
    decoded_sign,
    pure_part,
    with_filters,
    with_jerk,
)
from workshop.report.two_harmonics import record_circle, record_quintic, record_two_harmonics

_EPOCHS = 4000  # Epochs of the trial, for real and surrogate torques alike

_LONGER = 50_000  # Epochs of the row that asks what the rest of the training adds

# How the trial descends: as the lessons do, on inputs from 0 to 1
_DESCENT = {"warm_up": 500, "steps": 0, "decay": 0.0, "epochs": _EPOCHS}

# Penalty of the probes: of 1e-8 to 0.1 the one with which networks trained on the real torques do
# best, so that the comparison favours them
_RIDGE = 1e-2

# The walk's network: the recording of the third set-up, with descent in place of its solver
TRIAL = replace(JOINT_DAMPING, **_DESCENT)

_WAITS = {11: 12_000}  # epochs of a window that rests on a plateau for about 3,500 of them

_STARTS = 1000  # seed of the first null network: none shares its start with a real one


class FilterTrial:
    """One recording and window size: its cases, and what networks make of them."""

    def __init__(self, setup: Setup, recording: Recording, width: int):
        self.setup, self.width = setup, width
        training, test = split(recording)
        self.torques = training.tau[..., training.motion, :]
        self.data = TrainingSet.from_recording(training, width, scaling=setup.scaling)
        self.windows, self.torque = cases(training, width)
        self.test_windows, self.answer = cases(test, width)
        states = with_jerk(true_states(training, setup))
        self.states = states.reshape(-1, 2, 4)
        self.test_states = with_jerk(true_states(test, setup))

    def train(self, targets, seed: int) -> tuple[Weights, Weights]:
        """Networks of one target each, ``(members, runs, time, joint)`` N m: trained, untrained."""
        setup, networks = self.setup, len(targets)
        scaled = self.data.outputs.scale(targets.reshape(networks, -1, 2))
        start = Weights.random(networks, self.width, setup.hidden, initial=setup.initial, seed=seed)
        label = f"{setup.name}, window {self.width}"
        if setup.steps:
            weights = [
                learning.solve(
                    start[k : k + 1], replace(self.data, y=scaled[k]), steps=setup.steps,
                    decay=setup.decay, label=label,
                ).model.weights
                for k in range(networks)
            ]  # fmt: skip
            return Weights.concatenate(weights), start
        model, *_ = learning.train_ensemble(
            start, self.data, targets=scaled, rate=setup.rate / self.width,
            momentum=setup.momentum, warm_up=setup.warm_up, epochs=setup.epochs, label=label,
        )  # fmt: skip
        return model.weights, start

    def model(self, weights: Weights) -> TorqueModel:
        """Weights as a model of the trial's windows and torques."""
        return TorqueModel(weights, self.data.inputs, self.data.outputs, LOG_STEP)

    def described(self, weights: Weights, start: Weights, targets) -> dict:
        """What is counted and measured on networks, one value or array for each of them."""
        model = self.model(weights)
        wanted = targets.reshape(len(targets), -1, 2)
        row: dict = {"error": rmss(model.torque(self.windows), wanted)}
        hidden = weights.activity(self.data.x)[0]
        held = weights.activity(model.scaled(self.test_windows))[0]
        inputs = unit_inputs(model, self.windows)
        for layer, attribute in LAYERS.items():
            f, before = getattr(weights, attribute), getattr(start, attribute)
            row[layer] = {"classes": names_counted(f), **_responded(inputs[layer], self.states)}
            changed = (np.abs(f - before) > 1e-9).any()
            row[layer]["changes"] = names_counted(f - before) if changed else names_counted(f)
            row[layer]["roughness"] = np.median(roughness(f), (1, 2))
        row["saturated"] = np.median(saturated(hidden), -1)
        row["cancelled"] = cancellation(model, self.windows).mean(-1)
        row["transition"] = np.median(transition_width(inputs["hidden"]), -1)
        gained = calibrated(model, self.windows, LOG_STEP)
        row |= {"gains, direct": gained.direct, "gains": gained.whole}
        row |= self._probed(hidden, held)
        row["refitted"] = np.array([self.refit(h, t) for h, t in zip(hidden, held)])
        return row

    def _probed(self, hidden, held) -> dict:
        target = self.states[..., 1:3].reshape(len(self.states), -1)
        answer = self.test_states[..., 1:3].reshape(len(held[0]), -1)
        speed, speed_there = target[:, [0, 2]], answer[:, [0, 2]]
        return {
            "probe": np.array(
                [decoded(h, target, t, answer, _RIDGE) for h, t in zip(hidden, held)]
            ),
            "probe of sign": np.array(
                [decoded_sign(h, speed, t, speed_there, _RIDGE) for h, t in zip(hidden, held)]
            ),
        }

    def refit(self, hidden, held, direct: bool = True) -> np.ndarray:
        """Errors with the output layer fitted anew: training, trajectory 6."""
        parts = [hidden], [held]
        if direct:
            parts[0].append(self.windows.reshape(len(self.windows), -1))
            parts[1].append(self.test_windows.reshape(len(self.test_windows), -1))
        x, new = (np.column_stack(part) for part in parts)
        return refitted(x, self.torque, new, self.answer)

    def errors(self, model: TorqueModel) -> np.ndarray:
        """RMSS in training and on trajectory 6, shape (members, 2)."""
        pair = ((self.windows, self.torque), (self.test_windows, self.answer))
        return np.stack([rmss(model.torque(x), y) for x, y in pair], -1)

    def replaced(self, weights: Weights, filters) -> dict:
        """Errors when hidden filters are replaced: as it is, and with the output layer refitted."""
        other = with_filters(self.model(weights), filters)
        x = self.data.x, other.scaled(self.test_windows)
        pairs = zip(*(other.weights.activity(inputs)[0] for inputs in x))
        return {
            "at once": self.errors(other),
            "refitted": np.array([self.refit(h, t) for h, t in pairs]),
        }


def names_counted(f) -> dict:
    """Share of each name among the filters of each network."""
    names = classify(f)
    return {name: (names == name).mean((1, 2)) for name in CLASSES}


def _responded(inputs, states) -> dict:
    """Medians over the units of a network of what they follow, and how many follow what best."""
    responses = heard(inputs, states)
    best = responses.strongest
    return {
        "alone": np.median(responses.alone, 1),
        "unique": np.median(responses.unique, 1),
        "together": np.median(responses.together, 1),
        "strongest": np.stack([(best == k).mean(1) for k in range(states.shape[-1])], -1),
    }


def _mean(found, draws: int):
    """Means over the networks of each draw, all through a dictionary."""
    if isinstance(found, dict):
        return {name: _mean(part, draws) for name, part in found.items()}
    return found.reshape(draws, -1, *found.shape[1:]).mean(1)


def _nulls(trial: FilterTrial, kinds, draws: int, each: int) -> tuple[dict, dict]:
    """Networks of each kind of surrogate, `each` for a draw: means by draw, and the weights."""
    by_kind, networks = {}, {}
    for number, kind in enumerate(kinds):
        drawn = surrogates(kind, trial.torques, draws, seed=100 * number)
        targets = np.repeat(drawn, each, 0)
        weights, start = trial.train(targets, _STARTS * (number + 1))
        by_kind[kind] = _mean(trial.described(weights, start, targets), draws)
        by_kind[kind]["related"] = np.array(
            [related(d.reshape(-1, 2), trial.windows) for d in drawn]
        )
        networks[kind] = weights[::each]
    return by_kind, networks


def _row(setup: Setup, recording: Recording, width: int, members: int, draws: int, each: int,
         kinds=MATCHED, more: bool = False) -> dict:  # fmt: skip
    """Real torques, no training, and surrogates, on one recording and window size."""
    trial = FilterTrial(setup, recording, width)
    targets = np.repeat(trial.torques[None], members, 0)
    weights, start = trial.train(targets, 0)
    row = {
        "real": trial.described(weights, start, targets),
        "real, errors": trial.errors(trial.model(weights)),
        "untrained": _mean(trial.described(start, start, targets), min(members, 5)),
    }
    row["nulls"], networks = _nulls(trial, kinds, draws, each)
    if more:
        white, _ = _nulls(trial, ("shuffled",), 5, members // 5)
        row["nulls"] |= white
        row["interventions"] = _intervened(trial, weights, start, networks)
        row["other motions"] = _elsewhere(trial, {"real": weights, "untrained": start, **networks})
    return row


def _intervened(trial: FilterTrial, weights: Weights, start: Weights, nulls: dict) -> dict:
    f = weights.hidden_weights
    others = {kind: kept.hidden_weights for kind, kept in nulls.items()}
    cycled = {k: x[np.arange(len(f)) % len(x)] for k, x in others.items()}
    hidden, held = (
        weights.activity(x)[0]
        for x in (trial.data.x, trial.model(weights).scaled(trial.test_windows))
    )
    nothing = np.zeros((len(trial.windows), 0)), np.zeros((len(trial.test_windows), 0))
    return {
        "as trained": trial.replaced(weights, f),
        "pure parts": trial.replaced(weights, pure_part(f)),
        "without pure parts": trial.replaced(weights, f - pure_part(f)),
        "untrained": trial.replaced(weights, start.hidden_weights),
        **{kind: trial.replaced(weights, x) for kind, x in cycled.items()},
        "linear filter alone": trial.refit(*nothing),
        "hidden units alone": np.array(
            [trial.refit(h, t, direct=False) for h, t in zip(hidden, held)]
        ),
    }


def _elsewhere(trial: FilterTrial, networks: dict) -> dict:
    """What the same units follow on motions whose acceleration is not their position."""
    setup = trial.setup
    motions = {
        "two sines": split(record_two_harmonics(setup))[0],
        "quintic": record_quintic(setup),
        "circle": record_circle(setup),
    }
    by_name: dict = {}
    for name, motion in motions.items():
        windows = cases(motion, trial.width)[0]
        states = with_jerk(true_states(motion, setup)).reshape(-1, 2, 4)
        by_name[name] = {}
        for kind, weights in networks.items():
            inputs = unit_inputs(trial.model(weights), windows)
            responses = {layer: _responded(inputs[layer], states) for layer in LAYERS}
            by_name[name][kind] = {layer: _mean(x, 5) for layer, x in responses.items()}
    return by_name


@study
def _filter_trial(members: int = 25, draws: int = 20, each: int = 4) -> dict:
    """Filters of networks trained on real torques beside those trained on surrogates."""
    recording = TRIAL.record()
    windows = {
        str(w): _row(_as_long_as(w), recording, w, members, draws, each, more=True) for w in WINDOWS
    }
    epochs = {str(w): _as_long_as(w).epochs for w in WINDOWS}
    return {"members": members, "draws": draws, "each": each, "epochs": epochs, "windows": windows}


def _as_long_as(width: int) -> Setup:
    """The trial's set-up with as many epochs as a window needs."""
    return replace(TRIAL, epochs=_WAITS.get(width, _EPOCHS))


@study
def _filter_trial_elsewhere(
    members: int = 10, draws: int = 20, each: int = 1, width: int = 21
) -> dict:
    """The trial of the filters with one thing changed at a time, smaller.

    Other noise and another zero of the encoders, two sines in place of one, a window between those
    of Table 4-1, state feedback with its own descent on inputs of 0 to 1; shifted and
    phase-randomised torques. Then `_LONGER` epochs, and the third set-up with its own solver in
    place of descent: half as many networks, phase-randomised torques only.
    """
    kinds = ("shifted", "phases")
    other = TRIAL.repeated(1)
    old = replace(STATE_FEEDBACK, epochs=_EPOCHS)
    rows = {
        "other noise": (other, other.record(), width),
        "two sines": (TRIAL, record_two_harmonics(TRIAL), width),
        "window 31": (TRIAL, TRIAL.record(), 31),
        "state feedback": (old, old.record(), width),
    }
    results = {name: _row(*row, members, draws, each, kinds) for name, row in rows.items()}
    slow = {"longer": replace(TRIAL, epochs=_LONGER), "solver": JOINT_DAMPING}
    for name, setup in slow.items():
        results[name] = _row(setup, setup.record(), width, members // 2, draws // 2, 1, ("phases",))
    return {"members": members, "draws": draws, "each": each, "longer": _LONGER, "rows": results}


_SLOW = (1, 2, 6)  # Trajectories that move the shoulder by more than 30 degrees


def _response(torque, states) -> np.ndarray:
    """Torques ``(..., time)`` per acceleration, of `states` ``(time, 3)`` of a joint, kg m^2."""
    # Without the position: along a sine it is the acceleration's mirror image, so that a stiffness
    # takes away from what an inertia gives
    known = np.column_stack([states[:, 2], states[:, 1], np.ones(len(states))])
    return np.linalg.lstsq(known, np.moveaxis(torque, -1, 0), rcond=None)[0][0]


@study
def _filter_responses(members: int = 15) -> dict:
    """How the first networks of `filter_trial` answer the shoulder's motion, kg m^2 (`_response`).

    Along trajectories `_SLOW`: as they were recorded, swings included, and as they were desired, a
    slow sine. There the ends are left out, where the sine starts with a jump of velocity. For each
    window the responses ``(networks, trajectories)`` of the networks, and of their mean gradient as
    a linear filter. Beside them that of the rigid arm.
    """
    recording = TRIAL.record()
    margin, chosen = max(WINDOWS) // 2 + 1, np.array(_SLOW) - 1
    desired = np.stack(recording.reference, -1)[:, recording.motion]
    motions = {  # positions, states, samples that count
        "recorded": (recording.q, true_states(recording, TRIAL), slice(None)),
        "slow": (recording.reference.q, desired, slice(margin, -margin)),
    }
    by_motion: dict = {name: {"arm": [], "windows": {}} for name in motions}
    for name, (_, states, inside) in motions.items():
        for k in chosen:
            torque = TRIAL.arm.inverse_dynamics(*np.moveaxis(states[k], -1, 0))[:, 0]
            by_motion[name]["arm"].append(_response(torque[inside], states[k, inside, 0]))
    for width in WINDOWS:
        trial = FilterTrial(_as_long_as(width), recording, width)
        weights, _ = trial.train(np.repeat(trial.torques[None], members, 0), 0)
        model = trial.model(weights)
        filters = mean_gradient(model, trial.windows)[:, 0]
        for name, (positions, states, inside) in motions.items():
            cell: dict = {"network": [], "filter": []}
            for k in chosen:
                windows = sliding_windows(positions[k], width, recording.motion)
                linear = np.einsum("mjw,njw->mn", filters, windows)
                for way, torque in (("network", model.torque(windows)[..., 0]), ("filter", linear)):
                    cell[way].append(_response(torque[:, inside], states[k, inside, 0]))
            by_motion[name]["windows"][str(width)] = {
                way: np.stack(each, -1) for way, each in cell.items()
            }
    return {"members": members, "trajectories": _SLOW, **by_motion}


@study
def _null_controls(
    members: int = 4, steps: int = 400, few: int = 120, tolerance: float = 1e-4
) -> dict:
    """Networks of window 21 that started elsewhere, or went on to an optimum.

    The starts are other initial weights, descended for `_EPOCHS`. The optima are those of the error
    with a penalty on the squared weights ("weight decay"), reached by Levenberg-Marquardt: the
    gradient is kept, in the measure of `ddlib.learning.solve`, with how each network ended. The
    error alone has no end within reach: its row is what `few` steps give.
    """
    trial = FilterTrial(TRIAL, TRIAL.record(), 21)
    targets = np.repeat(trial.torques[None], members, 0)
    test = trial.data.transform(trial.test_windows, trial.answer)

    def row(weights: Weights) -> dict:
        errors = trial.errors(trial.model(weights))
        return {
            "training": errors[:, 0],
            "test": errors[:, 1],
            "largest weight": weights.largest,
            "roughness, hidden": np.median(roughness(weights.hidden_weights), (-2, -1)),
            "classes": names_counted(weights.hidden_weights),
            "direct": names_counted(weights.direct_weights),
        }

    rows = []
    for initial in (0.03, 0.3, 1.0):
        other = FilterTrial(replace(TRIAL, initial=initial), TRIAL.record(), 21)
        weights, _ = other.train(targets, 0)
        rows.append({"kind": "descent", "initial": initial, **row(weights)})
    for penalty in ({"decay": 1e-5}, {"decay": 1e-3}, {}):
        solution = learning.solve(
            Weights.random(members, 21, initial=TRIAL.initial),
            trial.data,
            test=test,
            steps=steps if penalty else few,
            tolerance=tolerance,
            label=f"optimum {penalty or 'without penalty'}",
            **penalty,
        )
        optimum = {"kind": "optimum", "penalty": penalty, "gradient": solution.gradient}
        optimum |= {"ended": list(map(str, solution.ended)), "steps": solution.steps}
        rows.append({**optimum, **row(solution.model.weights)})
    return {"members": members, "tolerance": tolerance, "few": few, "rows": rows}
