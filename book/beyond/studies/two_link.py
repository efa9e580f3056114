"""The report's experiment on a real two-link arm: what is identified, predicted and read.

Which runs take part was written down before any result of theirs was seen: all recordings in which
both torques were commanded, seventeen. In twelve planned torques drove the arm in open loop. Every
one of these but one trains and that one tests, in turn: in A0 five of six, as in the report; in C0
and C1 two of three, which is all there is. In the other five a controller followed a
reference up to the top. Nothing is trained or tuned on them: they are a test of another kind. One
reading and one identification take all seventeen, to see what changes.
"""

from __future__ import annotations

import warnings
from functools import cache
from itertools import combinations

import joblib
import numpy as np
from scipy.signal import butter, filtfilt, savgol_filter

from ddlib import paper
from ddlib.analysis import gains, mean_gradient, ridge_filters
from ddlib.dynamics import Arm
from ddlib.identification import FilteredEquations
from ddlib.learning import (
    NotConverged,
    TorqueModel,
    TrainingSet,
    Weights,
    sliding_windows,
    solve,
    train_ensemble,
)
from workshop import BOOK
from workshop.report.code_hash import study

STEP = 0.01  # seconds between two samples, as in the report

# Recordings of each design with both joints driven: in open loop, and by a controller
RUNS = {
    "A0": ("A0_00", "A0_01", "A0_02", "A0_03", "A0_04", "A0_05"),
    "C0": ("C0_00", "C0_01", "C0_02"),
    "C1": ("C1_143339", "C1_143524", "C1_143601"),
}
CONTROLLED = {
    "A0": ("A0_11",),
    "C0": ("C0_12", "C0_13"),
    "C1": ("C1_154220", "C1_154548"),
}
_WIDTHS = tuple(paper.TABLE_4_1)
_MARGIN, _EVERY = 20, 5  # samples: before the first case, from one case to the next
LENGTHS = (5, 7, 9, 11, 13, 17, 21, 25, 31, 41, 45)  # windows for derivatives, samples
_AVERAGE = 21  # samples over which both sides of the equations are averaged
_SETTLED = 13  # the window in front of it
_STILL, _ENCODER = 8.0, 3.8147e-4  # Hz: all that moves the arm is below; rad: the encoder's step
BANDS = ((6, 12), (12, 25), (25, 50))  # Hz
_PENALTIES = tuple(10.0**-k for k in range(1, 8))
_POINTS = (500, 1000, 2000, 4000, 8000)  # epochs of descent after which networks are tested
START = 0.3
"""Range of the initial weights: from the book's, 0.03, descent still rests on a plateau after the
epochs that it has here."""

_DECAYS, _STEPS = (1e-4, 1e-3), 60  # of the solver, at window 21
_MEMBERS, _ELBOW = 10, np.linspace(-1.5, 1.5, 7)  # networks that are read; rad


def _published(m1, m2, l1, r1, r2, i1, i2, rotor, f1, f2) -> dict[str, float]:
    """The builders' parameters (kg, m, kg m^2, N m) in the order of `regressor`."""
    a, d, g1 = i1 + i2 + m2 * l1**2 + 37 * rotor, i2 - 6 * rotor, 9.81 * (m1 * r1 + m2 * l1)
    parameters = {
        "a": a,
        "b": m2 * l1 * r2,
        "d": d,
        "g1": g1,
        "g2": 9.81 * m2 * r2,
        "r": 42 * rotor,
    }
    return parameters | {"F_v1": 0.001, "F_v2": 0.001, "F_c1": f1, "F_c2": f2, "o1": 0.0, "o2": 0.0}


# What the builders identified, by design: kg m^2, N m, N m s/rad; their gears are 6 to 1
PUBLISHED = {
    "A0": _published(0.55938, 0.60435, 0.3, 0.3, 0.18378, 0.05347, 0.02392, 7.659e-5, 0.093, 0.078),
    "C0": _published(0.64169, 0.56394, 0.2, 0.2, 0.32127, 0.02671, 0.05388, 9.937e-5, 0.093, 0.078),
    "C1": _published(0.52346, 0.62557, 0.2, 0.2, 0.25569, 0.03189, 0.05087, 6.287e-5, 0.16, 0.12),
}


@cache
def recorded_run(run: str, step: float = STEP) -> tuple[np.ndarray, np.ndarray]:
    """Positions (rad) and measured torques (N m), ``(samples, 2)`` each: means over `step` s."""
    with np.load(BOOK / "data" / "double-pendulum.npz") as by_run:
        t, *columns = by_run[run][:, :5].astype(float).T
    many = round(1000 * step)  # milliseconds
    samples = int((t[-1] - t[0]) / step)
    fine = t[0] + 1e-3 * np.arange(samples * many)
    q1, q2, tau1, tau2 = (np.interp(fine, t, x).reshape(samples, many).mean(1) for x in columns)
    return np.stack([q1, q2], -1), np.stack([tau1, tau2], -1)


def regressor(states) -> np.ndarray:
    """Y with ``torque = Y @ parameters`` for states ``(cases, joint, 3)``: ``(cases, 2, 12)``."""
    q, v, a = np.moveaxis(states, -1, 0)
    friction = [x[..., None] * np.eye(2) for x in (v, np.tanh(v / 0.05), np.ones_like(v))]
    return np.concatenate([Arm.regressor(q, v, a), (a * [0, 1])[..., None], *friction], -1)


def fitted_states(q, width, step=STEP, degree=3) -> np.ndarray:
    """Position, velocity and acceleration by polynomials in windows, ``(samples, joint, 3)``."""
    derivatives = [savgol_filter(q, width, degree, k, step, axis=0) for k in range(3)]
    return np.stack(derivatives, -1)


def parameters_of(rows, torque) -> np.ndarray:
    """Parameters by least squares, each joint in units of its torque's deviation."""
    spread = torque.std(0)
    a = (rows / spread[:, None]).reshape(-1, rows.shape[-1])
    return np.linalg.lstsq(a, (torque / spread).ravel())[0]


def smoothed(x, width=_AVERAGE) -> np.ndarray:
    """Cubics in windows of so many samples, at their centres."""
    return savgol_filter(x, width, 3, axis=0)


@cache
def _still(run: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The motion below 8 Hz, as it is and as rounded readings, and its published torque; 100 Hz."""
    fast = STEP / 2
    q = filtfilt(*butter(3, _STILL, fs=1 / fast), recorded_run(run, fast)[0], axis=0)
    torque = regressor(fitted_states(q, 5, fast, 4)) @ np.array(list(PUBLISHED[run[:2]].values()))
    every, cut = (q, _ENCODER * np.round(q / _ENCODER), torque), len(q) // 2 * 2
    return tuple(x[:cut].reshape(-1, 2, 2).mean(1) for x in every)


def _found(runs, width, kind="measured") -> np.ndarray:
    """Parameters from derivatives over windows of `width` samples."""
    rows, torques = [], []
    for run in runs:
        q, torque = recorded_run(run)
        if kind in ("smooth", "rounded", "wiggles"):
            smooth, rounded, torque = _still(run)
            q = {"smooth": smooth, "rounded": rounded, "wiggles": q}[kind]
        y = regressor(fitted_states(q, width))
        if kind == "averaged":
            y, torque = smoothed(y), smoothed(torque)
        inside = slice(width // 2 + _MARGIN, -width // 2 - _MARGIN)
        rows.append(y[inside])
        torques.append(torque[inside])
    return parameters_of(np.concatenate(rows), np.concatenate(torques))


def _jackknife(runs, *how) -> np.ndarray:
    """Standard errors of `_found` from leaving out one run at a time."""
    each = np.array([_found([r for r in runs if r != out], *how) for out in runs])
    return np.sqrt((len(runs) - 1) * ((each - each.mean(0)) ** 2).mean(0))


def _identified(runs) -> dict:
    kinds = ("measured", "averaged", "smooth", "rounded", "wiggles")
    by_length = {kind: [_found(runs, w, kind) for w in LENGTHS] for kind in kinds}
    errors = [_jackknife(runs, w) for w in LENGTHS]
    settled = {"values": _found(runs, _SETTLED, "averaged")}
    settled["errors"] = _jackknife(runs, _SETTLED, "averaged")
    every = runs + CONTROLLED[runs[0][:2]]
    settled["with controlled"] = _found(every, _SETTLED, "averaged")
    return {"by length": by_length, "errors by length": errors, "settled": settled}


def _together(run) -> list[float]:
    """Correlation of the two joints' accelerations in some bands of frequency."""
    fast = STEP / 2
    a = fitted_states(recorded_run(run, fast)[0], 5, fast)[..., 2]
    bands = (filtfilt(*butter(3, band, "bandpass", fs=1 / fast), a, axis=0) for band in BANDS)
    return [float(np.corrcoef(x[_MARGIN:-_MARGIN].T)[0, 1]) for x in bands]


def centred_windows(q, width, cases) -> np.ndarray:
    """Windows around some samples, turned by whole turns so that their centres are within pi."""
    half = width // 2
    x = sliding_windows(q, width)[cases - half]
    return x - 2 * np.pi * np.round(x[..., half] / (2 * np.pi))[..., None]


@cache
def _cases(run: str) -> dict:
    """What models see of a run, by name, and its torques."""
    q, torque = recorded_run(run)
    cases = np.arange(_MARGIN, len(q) - _MARGIN, _EVERY)
    seen = {width: centred_windows(q, width, cases) for width in _WIDTHS}
    for width in LENGTHS[:-4]:
        y = regressor(fitted_states(q, width))
        seen |= {(width, "plain"): y[cases], (width, "averaged"): smoothed(y)[cases]}
    return {"torque": torque[cases], "smooth torque": smoothed(torque)[cases], **seen}


def all_runs(runs, name) -> np.ndarray:
    """Cases of several runs one after another: states of a window size, or torques."""
    return np.concatenate([_cases(run)[name] for run in runs])


def _error(guess, run) -> float:
    torque = _cases(run)["torque"]
    return float(np.sqrt((((guess - torque) / torque.std(0)) ** 2).mean()))


def _linear(runs, others, setting) -> list[float]:
    width, penalty = setting
    x, y = all_runs(runs, width).reshape(-1, 2 * width), all_runs(runs, "torque")
    middle = x.mean(0)
    square = (x - middle).T @ (x - middle) + penalty * len(x) * np.eye(2 * width)
    w = np.linalg.solve(square, (x - middle).T @ (y - y.mean(0)))
    seen = (_cases(run)[width].reshape(-1, 2 * width) for run in others)
    return [_error((z - middle) @ w + y.mean(0), run) for z, run in zip(seen, others)]


def _rigid(runs, others, setting) -> list[float]:
    torque = "smooth torque" if setting[1] == "averaged" else "torque"
    parameters = parameters_of(all_runs(runs, setting), all_runs(runs, torque))
    return [_error(_cases(run)[setting] @ parameters, run) for run in others]


def _tuned(model, settings, runs, others) -> list[float]:
    """Errors on other runs; the setting has the least mean log error on runs left out of these."""
    splits = [([r for r in runs if r != out], [out]) for out in runs]
    wrong = [sum(np.log(model(few, out, s)[0]) for few, out in splits) for s in settings]
    return model(runs, others, settings[int(np.argmin(wrong))])


def _learnt(x, y, members, **targets) -> tuple[TorqueModel, np.ndarray, dict]:
    """Networks by descent, their training RMSS, and models after some epochs."""
    data, width = TrainingSet.from_arrays(x, y, scaling=(-1, 1)), x.shape[-1]
    how = {"rate": 66 / width, "momentum": 0.98, "warm_up": 500, "epochs": _POINTS[-1]}
    targets = {k: data.outputs.scale(v) for k, v in targets.items()}
    start = Weights.random(members, width, paper.HIDDEN_UNITS, initial=START)
    outcome = train_ensemble(start, data, snapshots=_POINTS, progress=False, **how, **targets)
    model, history, weights = outcome
    models = {e: TorqueModel(w, data.inputs, data.outputs, STEP) for e, w in weights.items()}
    return model, history.training[-1], models


def optimal_networks(x, y, members, decay, steps) -> TorqueModel:
    """Networks by Levenberg and Marquardt, with a trace of weight decay, converged or nearly."""
    data = TrainingSet.from_arrays(x, y, scaling=(-1, 1))
    start = Weights.random(members, x.shape[-1], paper.HIDDEN_UNITS, initial=START)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", NotConverged)
        return solve(start, data, decay=decay, steps=steps, progress=False).model


def _split(runs) -> dict:
    """Networks of each window trained on some runs: errors on all others, and moments."""
    others = _others(runs)
    tests, training = {}, []
    for width in _WIDTHS:
        x = all_runs(runs, width)
        model, error, models = _learnt(x, all_runs(runs, "torque"), 1)
        training.append(float(error[0]))
        if width == _WIDTHS[1]:
            models |= {
                d: optimal_networks(x, all_runs(runs, "torque"), 1, d, _STEPS) for d in _DECAYS
            }
        for how, one in models.items():
            for run in others:
                tests[width, how, run] = _error(one.torque(_cases(run)[width])[0], run)
    moments = gains(mean_gradient(model, x)[0], STEP)  # of the widest window
    return {"tests": tests, "training": training, "moments": moments}


def _others(runs) -> list[str]:
    """All runs of the same design but these, the controlled ones last."""
    design = runs[0][:2]
    return [run for run in RUNS[design] + CONTROLLED[design] if run not in runs]


def _few(runs) -> list[tuple]:
    """The runs without one of them."""
    return [tuple(r for r in runs if r != out) for out in runs]


def _predicted(design) -> list[dict]:
    """Every choice of runs to train on, and every other run as the test."""
    every = RUNS[design]
    chosen = list(combinations(every, min(5, len(every) - 1)))
    needed = sorted({few for runs in chosen for few in (runs, *_few(runs))})
    with joblib.parallel_config("loky", n_jobs=-1, inner_max_num_threads=1):
        split = dict(zip(needed, joblib.Parallel()(map(joblib.delayed(_split), needed))))
    settings = [(w, e) for w in _WIDTHS for e in _POINTS] + [(_WIDTHS[1], d) for d in _DECAYS]
    lengths = [(w, how) for w in LENGTHS[:-4] for how in ("plain", "averaged")]
    rows = []
    for runs in chosen:
        others = _others(runs)
        left_out = list(zip(_few(runs), runs))
        wrong = [
            sum(np.log(split[few]["tests"][*s, out]) for few, out in left_out) for s in settings
        ]
        best = settings[int(np.argmin(wrong))]
        linear = _tuned(_linear, [(w, p) for w in _WIDTHS for p in _PENALTIES], runs, others)
        rigid = _tuned(_rigid, lengths, runs, others)
        seen = [_cases(run)[_WIDTHS[1]] for run in (*runs, *others)]
        filtered = FilteredEquations(regressor, _WIDTHS[1], STEP)
        filtered.fit(seen[: len(runs)], [_cases(run)["torque"] for run in runs])
        for k, run in enumerate(others):
            tests = {str(w): split[runs]["tests"][w, _POINTS[-1], run] for w in _WIDTHS}
            tests["solved"] = split[runs]["tests"][_WIDTHS[1], _DECAYS[0], run]
            errors = {"linear filter": linear[k], "equations": rigid[k]}
            errors["equations with filters"] = _error(filtered.predict(seen[len(runs) + k]), run)
            errors["network"] = split[runs]["tests"][*best, run]
            rows.append({"training": runs, "test": run, "errors": errors, "by window": tests,
                         "training errors": split[runs]["training"], "tuned": best,
                         "moments": split[runs]["moments"]})  # fmt: skip
    return rows


def _slopes(states, parameters) -> np.ndarray:
    """How torques change with states, ``(cases, torque, joint, 3)``; friction by its best line."""
    rigid, slopes = np.where(np.arange(12) < 6, parameters, 0.0), np.zeros((len(states), 2, 2, 3))
    for j, k in np.ndindex(2, 3):
        nudge = np.zeros((2, 3))
        nudge[j, k] = 1e-4
        up, down = (regressor(states + sign * nudge) @ rigid for sign in (1, -1))
        slopes[..., j, k] = (up - down) / 2e-4
    force = regressor(states)[..., 6:10] @ parameters[6:10]
    v = states[..., 1]
    slopes[:, [0, 1], [0, 1], 1] += (force * v).mean(0) / (v**2).mean(0)
    return slopes


def _unrelated(runs, kind, seed) -> np.ndarray:
    """Torques of the same runs, or of others, moved in time around their ends."""
    rng, torques = np.random.default_rng(seed), [_cases(run)["torque"] for run in runs]
    sources = np.roll(np.arange(len(runs)), rng.integers(1, len(runs)))
    shifted = []
    for torque, source in zip(torques, sources):
        if kind == "other run":
            torque = np.resize(torques[source], torque.shape)
        samples = len(torque)
        shifted.append(
            np.roll(torque, rng.integers(samples // 10, samples - samples // 10), axis=0)
        )
    return np.concatenate(shifted)


def _read(design, width) -> dict:
    """Moments of networks of all runs, of unrelated torques, and of the published equations'."""
    runs, published = RUNS[design], np.array(list(PUBLISHED[design].values()))
    x, torque = all_runs(runs, width), all_runs(runs, "torque")

    def cut(values):
        return values[_MARGIN : len(values) - _MARGIN : _EVERY]

    def slopes_along(runs):
        states = [cut(fitted_states(recorded_run(run)[0], _SETTLED)) for run in runs]
        return _slopes(np.concatenate(states), published)

    slopes = slopes_along(runs)
    model, errors, _ = _learnt(x, torque, _MEMBERS)
    data = TrainingSet.from_arrays(x, torque, scaling=(-1, 1))
    row = {
        "published": slopes.mean(0),
        "networks": gains(mean_gradient(model, x), STEP),
        "linear": gains(ridge_filters(data, [1e-6])[0], STEP),
        "training": errors,
    }
    published_torque = np.concatenate([cut(_still(r)[-1]) for r in runs])
    smooth = [_still(r)[0] for r in runs]
    still = [centred_windows(q, width, cut(np.arange(len(q)))) for q in smooth]
    for name, seen, goal in (
        ("solved", x, torque),
        ("solved, known", np.concatenate(still), published_torque),
    ):
        solved = optimal_networks(seen, goal, _MEMBERS // 2, _DECAYS[0], 2 * _STEPS)
        row[name] = gains(mean_gradient(solved, seen), STEP)
    if width == _WIDTHS[-1]:
        exact, *_ = _learnt(x, published_torque, _MEMBERS)
        row["exact"] = gains(mean_gradient(exact, x), STEP)
        every = runs + CONTROLLED[design]
        seen = all_runs(every, width)
        more, *_ = _learnt(seen, all_runs(every, "torque"), _MEMBERS)
        row["with controlled"] = {
            "published": slopes_along(every).mean(0),
            "networks": gains(mean_gradient(more, seen), STEP),
        }
        for kind in ("shifted", "other run"):
            targets = np.stack([_unrelated(runs, kind, k) for k in range(_MEMBERS)])
            null, *_ = _learnt(x, torque, _MEMBERS, targets=targets)
            row[kind] = gains(mean_gradient(null, x), STEP)
        place = np.digitize(x[:, 1, width // 2], _ELBOW)
        bins = [place == k for k in range(1, len(_ELBOW))]
        row["by elbow"] = {
            "networks": [gains(mean_gradient(model, x[b]), STEP)[..., 2] for b in bins],
            "exact": [gains(mean_gradient(exact, x[b]), STEP)[..., 2] for b in bins],
            "published": [slopes[b].mean(0)[..., 2] for b in bins],
            "cases": [int(b.sum()) for b in bins],
        }
    return row


@study
def _two_link() -> dict:
    """What is identified, predicted and read, by design."""
    designs, tasks = {}, [(design, width) for design in RUNS for width in _WIDTHS]
    with joblib.parallel_config("loky", n_jobs=-1, inner_max_num_threads=1):
        outcomes = joblib.Parallel()(joblib.delayed(_read)(*task) for task in tasks)
    readings = dict(zip(tasks, outcomes))
    for design, runs in RUNS.items():
        designs[design] = {
            "runs": runs,
            "controlled": CONTROLLED[design],
            "published": PUBLISHED[design],
            "identified": _identified(runs),
            "together": [_together(run) for run in runs],
            "predicted": _predicted(design),
            "read": {str(width): readings[design, width] for width in _WIDTHS},
        }
    return {"lengths": LENGTHS, "elbow": _ELBOW, "bands": BANDS, "designs": designs}
