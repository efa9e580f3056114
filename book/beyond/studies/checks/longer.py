"""A real two-link arm, after a referee's trial: longer windows, more epochs, and what wiggles."""

import numpy as np
from scipy.signal import butter, filtfilt

from beyond.studies import two_link as arm
from ddlib.analysis import gains, mean_gradient
from ddlib.learning import TorqueModel, TrainingSet, Weights, train_ensemble
from workshop.report.code_hash import study

_WIDTHS, _MARGIN, _SEEDS = (41, 61, 81), 40, 3  # the same cases for each window
_EPOCHS, _DESCENTS = (4000, 12000, 24000), 4
_FAST, _SHAKEN = arm.STEP / 2, (12, 40)  # s, Hz
_TURNS = np.arange(6.0, 18.5, 0.5)  # cycles of an error in one turn of the elbow


def _band(x, band) -> np.ndarray:
    return filtfilt(*butter(3, band, "bandpass", fs=1 / _FAST), x, axis=0)


def _solved(runs, width) -> np.ndarray:
    records = [arm.recorded_run(run) for run in runs]
    cases = [np.arange(_MARGIN, len(q) - _MARGIN, arm._EVERY) for q, _ in records]
    x = np.concatenate([arm.centred_windows(q, width, at) for (q, _), at in zip(records, cases)])
    torque = np.concatenate([measured[at] for (_, measured), at in zip(records, cases)])
    networks = arm.optimal_networks(x, torque, _SEEDS, arm._DECAYS[0], arm._STEPS)
    return gains(mean_gradient(networks, x), arm.STEP)


def _descended(runs, width=41) -> list[np.ndarray]:
    x, start = arm.all_runs(runs, width), Weights.random(_DESCENTS, width, 10, initial=arm.START)
    data = TrainingSet.from_arrays(x, arm.all_runs(runs, "torque"), scaling=(-1, 1))
    how = {"rate": 66 / width, "momentum": 0.98, "warm_up": 500, "epochs": _EPOCHS[-1]}
    *_, weights = train_ensemble(start, data, snapshots=_EPOCHS, progress=False, **how)
    models = [TorqueModel(weights[e], data.inputs, data.outputs, arm.STEP) for e in _EPOCHS]
    return [gains(mean_gradient(model, x), arm.STEP) for model in models]


def _shaken(run) -> dict:
    """Torque that a rigid arm needs for fast motion, and has, N m; elbow's error by its angle."""
    (q, torque), inside = arm.recorded_run(run, _FAST), slice(arm._MARGIN, -arm._MARGIN)
    inertias = np.array(list(arm.PUBLISHED[run[:2]].values())) * np.isin(range(12), (0, 1, 2, 5))
    fast = [_band(arm.fitted_states(q, 5, _FAST)[..., 2], band) for band in arm.BANDS]
    needed = [arm.regressor(np.stack([q, 0 * q, a], -1)) @ inertias for a in fast]
    error, angle = _band(q[:, 1], _SHAKEN)[inside], q[:, 1:]
    waves = [np.hstack([np.cos(k * angle), np.sin(k * angle)]) for k in _TURNS]
    seen = [_band(wave, _SHAKEN)[inside] for wave in waves]
    fits = [(wave, np.linalg.lstsq(wave, error)[0]) for wave in seen]
    residuals = [((error - wave @ factors) ** 2).sum() for wave, factors in fits]
    has = [_band(torque, band)[inside].std(0) for band in arm.BANDS]
    result = {"needed": [x[inside].std(0) for x in needed], "has": has}
    result["amplitude"] = [np.hypot(*factors) for _, factors in fits]  # rad
    return result | {"share": 1 - np.array(residuals) / (error**2).sum()}


@study
def _two_link_longer() -> dict:
    """Moments after longer windows and descent, and fast motion."""
    solved = {d: {str(w): _solved(r, w) for w in _WIDTHS} for d, r in arm.RUNS.items()}
    row = {"epochs": _EPOCHS, "turns": _TURNS, "solved": solved}
    row["descended"] = {design: _descended(runs) for design, runs in arm.RUNS.items()}
    return row | {"shaken": {r: _shaken(r) for runs in arm.RUNS.values() for r in runs}}
