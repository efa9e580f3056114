"""A Butterworth filter and a Kalman smoother before the equations, beside filters that are learnt.

Each is tuned as in `tuned`: four settings, the least error on training runs left out one at a time,
the same recordings. Fixed smoothers see the whole recording, and learnt filters see a window.
What differs from the report's arm, one thing at a time: it turns in a vertical plane; its torque is
logged late; its encoders are coarse, four times the step.

Expected before the study ran, from trials of days 1 to 3 with the first arm: .030 to .033 with a
Butterworth filter, .031 to .036 with a Kalman smoother, where learnt filters have .031. From a
referee: learnt filters lead on a vertical arm, with coarse encoders, and on a torque that is logged
late; but not on the torque that was applied, nor in the parameters.

Two smoothers came later, where the first ones had been given too little. One, for the late sensor,
tunes a delay beside its cutoff; the same referee found that it predicts the log as well as learnt
filters do, and the applied torque at .03. The other, for coarse encoders, has more cutoffs and
lower ones; he found that it halves the lead of learnt filters.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import NamedTuple

import joblib
import numpy as np

from beyond.studies.rivals import _EVERY, SQUARE_POINTS, square_recordings
from beyond.studies.tuned import _DAYS, _FEWER, _RUNS, OWN_RIVAL, RIVALS
from ddlib.effects import Delay, Quantisation
from ddlib.identification import (
    FRICTION,
    GRAVITY,
    RIGID,
    FilteredEquations,
    butterworth_states,
    from_states,
    kalman_states,
    least_squares,
    true_parameters,
)
from ddlib.metrics import rmss
from ddlib.setups import JOINT_DAMPING, Setup, split
from ddlib.simulation import LOG_STEP, Recording
from workshop.report.code_hash import study

_SENSOR_LATE = 2  # samples by which a torque sensor is late
_WEIGHT = (98.9, 12.4)  # N m: gravity moments of the arm's assumed links, at 9.81 m/s^2
_ROUNDING = JOINT_DAMPING.effects.encoder[0].step / np.sqrt(12)  # its deviation, rad
_LEARNT = OWN_RIVAL  # as in `tuned`


class _Kept(NamedTuple):
    """Rivals that learnt, and what they predict."""

    predict: Callable[[Recording], np.ndarray]  # torques of the motions, (..., time, joint)
    values: np.ndarray  # parameters
    applied: Callable[[Recording], np.ndarray] | None = None  # the same without a known delay


def _equations(recording: Recording, states, names, delay: int = 0) -> tuple:
    """The logged torque as that of the states `delay` samples before."""
    motion = slice(recording.motion.start - delay, recording.motion.stop - delay)
    moving = states[..., motion, :, :].reshape(-1, 2, 3)
    torque = recording.tau[..., recording.motion, :]
    return from_states(*np.moveaxis(moving, -1, 0), torque.reshape(-1, 2), names), torque.shape


def _smoothed(states_of, names, recording: Recording, delay: int = 0) -> _Kept:
    """The equations on states of the whole recording, with torques logged `delay` samples late."""
    values = least_squares(_equations(recording, states_of(recording.q), names, delay)[0]).values

    def predict(other, delay=delay):
        equations, shape = _equations(other, states_of(other.q), names, delay)
        return np.stack([y @ values for y in equations.regressor], -1).reshape(shape)

    return _Kept(predict, values, partial(predict, delay=0))


def _learnt(width, pull, names, recording: Recording) -> _Kept:
    equations = FilteredEquations(names, width, LOG_STEP, pull).fit(recording)
    return _Kept(equations.predict, equations.estimate.values)


def _butterworth(cutoff, delay=0):
    return partial(_smoothed, lambda q: butterworth_states(q, LOG_STEP, cutoff), delay=delay)


def _kalman(noise):
    return partial(_smoothed, lambda q: kalman_states(q, LOG_STEP, noise * _ROUNDING))


CUTOFFS, _NOISES = (4.0, 6.0, 9.0, 13.0), (2.0, 4.0, 8.0, 16.0)  # Hz; in roundings
_FINER = (2.0, 2.5, 3.0, 3.5, 4.0, 4.5, 5.0, 6.0)
_DELAYS = (0, 1, 2, 3, 4)  # samples
_WAYS: dict[str, dict[tuple, Callable]] = {
    "Butterworth filter": {(f,): _butterworth(f) for f in CUTOFFS},
    "Kalman smoother": {(n,): _kalman(n) for n in _NOISES},
    _LEARNT: {
        (w, pull): partial(_learnt, w, pull)
        for w in RIVALS[_LEARNT].windows
        for pull in RIVALS[_LEARNT].knobs["pull"]
    },
}
_MORE: dict[str, dict[str, dict[tuple, Callable]]] = {
    "late sensor": {
        "Butterworth filter and a delay": {
            (f, delay): _butterworth(f, delay) for f in CUTOFFS for delay in _DELAYS
        }
    },
    "coarse encoder": {"Butterworth filter, finer": {(f,): _butterworth(f) for f in _FINER}},
}


def _coarse(setup: Setup) -> Setup:
    (encoder,) = setup.effects.encoder
    rough = (Quantisation(4 * encoder.step),)
    return replace(setup, effects=replace(setup.effects, encoder=rough))


def _sensor(setup: Setup) -> Setup:
    sensor = (Delay(_SENSOR_LATE), *setup.effects.torque_sensor)
    return replace(setup, effects=replace(setup.effects, torque_sensor=sensor))


_ARMS: dict[str, tuple[Setup, Sequence[str], int]] = {
    "the report's arm": (JOINT_DAMPING, RIGID + FRICTION, _DAYS),
    "vertical": (
        replace(JOINT_DAMPING, arm=replace(JOINT_DAMPING.arm, gravity_moments=_WEIGHT)),
        RIGID + GRAVITY + FRICTION,
        _FEWER,
    ),
    "late sensor": (_sensor(JOINT_DAMPING), RIGID + FRICTION, _FEWER),
    "coarse encoder": (_coarse(JOINT_DAMPING), RIGID + FRICTION, _FEWER),
}


def _wrong(fitted: _Kept, recording: Recording, every=1, logged=True) -> float:
    torque = (recording.tau if logged else recording.tau_true)[..., recording.motion, :]
    predict = fitted.predict if logged or fitted.applied is None else fitted.applied
    pairs = (x.reshape(-1, 2)[::every] for x in (predict(recording), torque))
    return float(rmss(*pairs))


def _left_out(way, names, training: Recording) -> float:
    """As `tuned` judges a setting."""
    each = []
    for out in range(_RUNS):
        fitted = way(names, training[[k for k in range(_RUNS) if k != out]])
        each.append(_wrong(fitted, training[out]))
    return float(np.sqrt(np.mean(np.square(each))))


def _job(arm: str, day: int) -> dict:
    """All ways on one day: the chosen setting, errors, parameters."""
    setup, names, _ = _ARMS[arm]
    setup = setup.repeated(day)
    training, six = split(setup.record())
    whole, result = square_recordings(setup, SQUARE_POINTS), {}
    parts = {"training": (training, 1), "trajectory 6": (six, 1)}
    for name, chosen in (("inside", whole.inside), ("outside", ~whole.inside)):
        parts[name] = (whole.recording[chosen], _EVERY)
    true = true_parameters(setup.arm, JOINT_DAMPING.effects, names)
    for name, settings in (_WAYS | _MORE.get(arm, {})).items():
        lost = {s: _left_out(way, names, training) for s, way in settings.items()}
        best = min(lost, key=lost.get)
        fitted = settings[best](names, training)
        result[name] = {
            "setting": best,
            "errors": {part: _wrong(fitted, *at) for part, at in parts.items()},
            "applied": {part: _wrong(fitted, *at, logged=False) for part, at in parts.items()},
            "off": fitted.values / true - 1,
        }
    return result


@study
def _smoothers() -> dict:
    """Settings, errors and parameters of each way, by arm and day."""
    jobs = [(arm, day) for arm, (*_, days) in _ARMS.items() for day in range(1, days + 1)]
    with joblib.parallel_config("loky", n_jobs=-1, inner_max_num_threads=1):
        results = dict(zip(jobs, joblib.Parallel()(joblib.delayed(_job)(*job) for job in jobs)))
    arms = {}
    for arm, (_, names, days) in _ARMS.items():
        each = [results[arm, day] for day in range(1, days + 1)]
        arms[arm] = {"names": names, "ways": {}}
        for way in each[0]:
            rows = [day[way] for day in each]
            row = {key: [one[key] for one in rows] for key in ("setting", "off")}
            for key in ("errors", "applied"):
                row[key] = {part: [one[key][part] for one in rows] for part in rows[0][key]}
            arms[arm]["ways"][way] = row
    return {"learnt": _LEARNT, "arms": arms}
