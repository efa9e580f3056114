"""The window network of 1988 on a real arm, beside linear filters and an identified model."""

from __future__ import annotations

import warnings

import numpy as np

from beyond.rivals.gaussian import GaussianProcess
from beyond.rivals.protocol import Cases
from beyond.studies.tx40 import (
    BLOCKS,
    EPOCHS,
    HIDDEN,
    RATES,
    Ridge,
    Windowed,
    best_penalty,
    decayed_network,
    errors_of_fold,
    identified,
    known_structure,
    least_squares,
    trained,
    wrong,
)
from ddlib import paper
from ddlib.analysis import (
    CLASSES,
    LAYERS,
    classify,
    explained,
    filter_responses,
    gains,
    mean_gradient,
    shares,
)
from ddlib.learning import TorqueModel, Weights, surrogates
from ddlib.trajectories import OutsideFamilyWarning
from workshop.report.code_hash import study

_COURSE = (10, 30, 100, 300, 1000, 2000, 5000)  # epochs of tests on the way to those of 1988
_MAIN = (100, 21)  # samples a second and window where variants are tried
_FILTERS = (11, 21)  # windows, at 100 samples a second, whose filters are taken apart
_KINDS = ("shifted", "phases")  # unrelated currents, as smooth as the recorded ones
_DECAYS = (0.0, 1e-5, 1e-4, 1e-3, 1e-2)  # per case
_STARTS = 1000  # seed of the first null network: none shares its start with a real one


def _grid(members: int) -> list[dict]:
    """Every window of `_RATES`: errors of networks and of the models that are no networks."""
    rows = []
    for rate, widths in RATES.items():
        for width in widths:
            data = Windowed.of(rate, width)
            cells = [_cell(data, fold, members) for fold in data.folds()]
            row = {name: np.stack([cell[name] for cell in cells]) for name in cells[0]}
            rows.append({"rate": rate, "width": width, **row})
    return rows


def _cell(data: Windowed, fold, members: int) -> dict:
    """Errors in one fold, means over the outputs: of networks ``(members,)``, of others one."""
    training, test = fold
    flat, states, given = data.flat, data.states, data.current[training]
    plain = states.reshape(len(states), -1)
    model, *_ = trained(data.x[training], given, members, 0, data.width)
    network = errors_of_fold(model, data, fold)
    penalty = best_penalty(data, training)
    others = {
        "ridge": Ridge(flat[training], given).predict(flat[test], penalty),
        "least squares": least_squares(flat[training], given, flat[test]),
        "states": least_squares(plain[training], given, plain[test]),
        "identified": known_structure(states[training], given, states[test]),
        "no friction": known_structure(states[training], given, states[test], friction=False),
    }
    own = known_structure(states[training], given, states[training])
    return {
        "network, training": network[0].mean(-1),
        "network": network[1].mean(-1),
        "largest weight": model.weights.largest,
        "penalty": penalty,
        "identified, training": wrong(own, data, training).mean(),
        **{name: wrong(answer, data, test).mean() for name, answer in others.items()},
    }


# --- what would change it -----------------------------------------------------------------


def _variants(members: int) -> dict:
    """The main window with one thing changed at a time: errors ``(blocks, members)``."""
    data, rows = Windowed.of(*_MAIN), {}

    def put(name, pair):
        row = rows.setdefault(name, {"training": [], "test": []})
        for side, error in zip(row, pair):
            row[side].append(np.mean(error, -1))

    for fold in data.folds():
        training, _ = fold
        x, y = data.x[training], data.current[training]
        last, snapshots, _ = trained(x, y, members, 0, data.width, _COURSE, epochs=paper.EPOCHS)
        for epoch, model in {**snapshots, paper.EPOCHS: last}.items():
            put(f"{epoch} epochs", errors_of_fold(model, data, fold))
        for units in (1, 3, 20):
            model, *_ = trained(x, y, members, 0, data.width, hidden=units)
            put(f"{units} units", errors_of_fold(model, data, fold))
        start = Weights.random(members, data.width, HIDDEN, 6, 6)
        for decay in _DECAYS:
            each = [
                errors_of_fold(decayed_network(x, y, start[k], decay), data, fold)
                for k in range(members)
            ]
            put(f"decay {decay:g}", map(np.stack, zip(*each)))
        for decay in _DECAYS[-2:]:
            put(f"on the rest, decay {decay:g}", _structured(data, fold, members, decay))
    return {n: {side: np.array(v) for side, v in row.items()} for n, row in rows.items()}


def _structured(data: Windowed, fold, members: int, decay: float) -> list[np.ndarray]:
    """Networks that learn what the identified model leaves over, and both together."""
    training, _ = fold
    states, given = data.states, data.current[training]
    known = known_structure(states[training], given, states)
    residual = data.current - known
    start = Weights.random(members, data.width, HIDDEN, 6, 6)
    models = [
        decayed_network(data.x[training], residual[training], start[k], decay)
        for k in range(members)
    ]
    return [
        np.stack([wrong(known[part] + m.torque(data.x[part]), data, part) for m in models])
        for part in fold
    ]


# --- filters, beside networks trained on unrelated currents ---------------------------------


def _described(model: TorqueModel, data: Windowed, targets) -> dict:
    """Of each network: errors, gains on the joint's own motion, names and shares of filters."""
    w = model.weights
    whole = gains(mean_gradient(model, data.x), data.step)
    own = np.arange(6)
    direct = shares(w.direct_weights)[:, own, own]
    layers = {
        layer: np.stack([(classify(getattr(w, at)) == c).mean((1, 2)) for c in CLASSES], -1)
        for layer, at in LAYERS.items()
    }
    error = ((model.torque(data.x) - targets) ** 2).mean(-2) / targets.var(-2)
    unique = filter_responses(w.direct_weights, data.x, data.states).unique[:, own, own]
    return {
        "error": np.sqrt(error.mean(-1)),
        "velocity": whole[:, own, own, 1],
        "acceleration": whole[:, own, own, 2],
        "share of velocity": direct[..., 1],
        "unique velocity": unique[..., 1],
        "unique acceleration": unique[..., 2],
        "pairs": np.percentile(whole[..., 1:], (2.5, 50, 97.5), axis=0),
        "classes": layers,
    }


def _curved(model: TorqueModel, data: Windowed, known) -> np.ndarray:
    """Share of the hidden units' non-linear part that the known structure explains, by output."""
    flat = data.flat - data.flat.mean(0)
    left, values, _ = np.linalg.svd(flat, full_matrices=False)
    axes = np.column_stack(
        [left[:, values > 1e-9 * values[0]], np.full(len(flat), len(flat) ** -0.5)]
    )

    def curved(y):
        return y - axes @ (axes.T @ y)

    hidden = model.weights.activity(model.scaled(data.x))[0]
    sums = np.einsum("mnh,moh->mno", hidden, model.weights.output_weights)
    both = [curved(part) for part in known]
    return np.array(
        [
            [explained(curved(part)[:, j], *(k[:, j] for k in both)) for j in range(6)]
            for part in sums
        ]
    )


def _filters(width: int, members: int, draws: int) -> dict:
    """Networks of one window on the whole recording, and on unrelated currents."""
    data = Windowed.of(100, width)
    y = data.current
    same = np.repeat(y[None], members, 0)
    model, _, training_set = trained(data.x, y, members, 0, width)
    start = Weights.random(members, width, HIDDEN, 6, 6)
    untrained = TorqueModel(start, training_set.inputs, training_set.outputs)
    structure = identified(data.states, y)
    known = structure.friction, structure.rest
    flat = data.flat
    penalty = best_penalty(data, np.ones(len(flat), bool))

    fitted = Ridge(flat, y).filters(penalty).T.reshape(6, 6, width)
    own = np.arange(6)
    row = {
        "real": _described(model, data, same),
        "untrained": _described(untrained, data, same),
        "curved": _curved(model, data, known),
        "identified": {
            name: getattr(structure, name) for name in ("inertia", "slope", "viscous", "coulomb")
        },
        "friction": structure.friction.std(0) / y.std(0),
        "deviations": {
            name: data.states[..., k].std(0) / y.std(0)
            for k, name in ((1, "velocity"), (2, "acceleration"))
        },
        "linear": gains(fitted[own, own], data.step)[:, 1:],
        "nulls": {},
    }
    for number, kind in enumerate(_KINDS):
        drawn = surrogates(kind, y[None], draws, seed=100 * number)[:, 0]
        null, *_ = trained(data.x, y, draws, _STARTS * (number + 1), width, targets=drawn)
        row["nulls"][kind] = _described(null, data, drawn) | {"curved": _curved(null, data, known)}
    return row


def _by_block() -> dict:
    """Inertia and friction from each part of the recording but one, and what friction is worth."""
    data, fits = Windowed.of(*_MAIN), []
    states = data.states
    for training, _ in data.folds():
        equations = identified(states[training], data.current[training])
        fits.append((equations.inertia, equations.slope, equations.viscous, equations.coulomb))
    return dict(zip(("inertia", "slope", "viscous", "coulomb"), map(np.array, zip(*fits))))


def _hidden_units(members: int) -> dict:
    """Errors of an output layer fitted anew, without hidden units ``(blocks,)`` and with them."""
    data, errors = Windowed.of(*_MAIN), {"training": [], "test": []}
    flat = data.flat
    for cases in data.folds():
        training, given = cases[0], data.current[cases[0]]
        model, *_ = trained(data.x[training], given, members, 0, data.width)
        hidden = model.weights.activity(model.scaled(data.x))[0]
        features = [flat, *(np.column_stack([flat, h]) for h in hidden)]
        for row, part in zip(errors.values(), cases):
            fits = [least_squares(x[training], given, x[part]) for x in features]
            row.append([wrong(fit, data, part).mean() for fit in fits])
    return {
        side: {"alone": np.array(x)[:, 0], "with hidden units": np.array(x)[:, 1:]}
        for side, x in errors.items()
    }


def _differences() -> dict:
    """Errors with states from three samples, one for each block, by samples a second."""
    rows: dict = {}
    for rate in RATES:
        data, row = Windowed.of(rate, 3), {"states": [], "identified": []}
        states = data.states
        plain = states.reshape(len(states), -1)
        for training, test in data.folds():
            given = data.current[training]
            linear = least_squares(plain[training], given, plain[test])
            known = known_structure(states[training], given, states[test])
            for name, fit in zip(row, (linear, known)):
                row[name].append(wrong(fit, data, test).mean())
        rows[str(rate)] = {name: np.array(each) for name, each in row.items()}
    return rows


def _processes(subset: int = 120) -> dict:
    """Errors of Gaussian processes by block: of windows, of states, beside known structure."""
    data, rows = Windowed.of(*_MAIN), {"windows": [], "states": [], "on the rest": []}
    states = data.states
    for training, test in data.folds():
        known = known_structure(states[training], data.current[training], states)
        residual = data.current - known
        for name, x, y, more in (
            ("windows", data.x, data.current, {"directions": 18}),
            ("states", states, data.current, {}),
            ("on the rest", states, residual, {}),
        ):
            kind = "windows" if name == "windows" else "states"
            process = GaussianProcess(kind, subset=subset, restarts=0, **more)
            process.fit(Cases(x[training], y[training], kind, data.step))
            # beyond its training inputs on purpose
            with warnings.catch_warnings(action="ignore", category=OutsideFamilyWarning):
                answer = process.torque(x[test])
            answer += known[test] if name == "on the rest" else 0
            rows[name].append(wrong(answer, data, test).mean())
    return {name: np.array(each) for name, each in rows.items()}


def _memory(members: int) -> dict:
    """Training errors on currents that have nothing to do with the motion, by window."""
    rows: dict = {}
    for width in (21, 41):
        data = Windowed.of(100, width)
        for kind in ("phases", "shuffled"):
            drawn = surrogates(kind, data.current[None], members, seed=500)[:, 0]
            model, *_ = trained(data.x, data.current, members, 0, width, targets=drawn)
            error = ((model.torque(data.x) - drawn) ** 2).mean(-2) / drawn.var(-2)
            rows.setdefault(kind, {})[str(width)] = np.sqrt(error.mean(-1))
    return rows


@study
def _real_arm(members: int = 3, filters: int = 10, draws: int = 20) -> dict:
    """Errors by blocks and windows, what changes them, and the filters beside their nulls."""
    return {
        "members": members,
        "filters": filters,
        "draws": draws,
        "epochs": EPOCHS,
        "blocks": BLOCKS,
        "grid": _grid(members),
        "differences": _differences(),
        "variants": _variants(members),
        "identified": _by_block(),
        "hidden units": _hidden_units(members),
        "processes": _processes(),
        "memory": _memory(filters // 2),
        "windows": {str(w): _filters(w, filters, draws) for w in _FILTERS},
    }
