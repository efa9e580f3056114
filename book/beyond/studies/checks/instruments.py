"""A real two-link arm: gravity by instrumental variables and smoothers, beside plain least squares.

The recordings have no reference: these arms were driven by planned torques, in open loop. So the
commanded torque is what no encoder's noise has touched. A first model, by least squares with the
same window, says which acceleration it causes at each state of the motion, smoothed over 210 ms;
the columns of the equations with that acceleration are the instruments. The parameters that come
out make the instruments once more. (Where a controller followed a reference, the command has the
encoder's noise: these runs are out.)

Expected before the study ran, from a referee's trial on A0 and C0: .94 and .98 of the builders'
gravity at the shoulder with derivatives over 50 ms.
"""

from __future__ import annotations

import joblib
import numpy as np

from beyond.studies import two_link as arm
from ddlib.identification import butterworth_states, kalman_states
from workshop import BOOK
from workshop.report.code_hash import study

_CUTOFFS = (3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 13.0, 16.0, 20.0, 25.0)  # Hz
_SMOOTH, _ROUNDS = 21, 2  # samples of 10 ms; how often instruments are made
_INSIDE = slice(40, -40)  # samples that count


def _commanded(run: str) -> np.ndarray:
    """Commanded torques (N m), ``(samples, 2)``, on the grid of `two_link.recorded_run`."""
    with np.load(BOOK / "data" / "double-pendulum.npz") as by_run:
        t, *columns = by_run[run][:, [0, 5, 6]].astype(float).T
    fine = t[0] + 1e-3 * np.arange(int((t[-1] - t[0]) / arm.STEP) * 10)
    return np.stack([np.interp(fine, t, x).reshape(-1, 10).mean(1) for x in columns], -1)


def _caused(parameters, states, torque) -> np.ndarray:
    """Accelerations (rad/s^2) that torques cause at states, by the equations."""
    still = states * [1, 1, 0]
    rest = arm.regressor(still) @ parameters
    units = [still + np.array([[0, 0, 1], [0, 0, 0]]), still + np.array([[0, 0, 0], [0, 0, 1]])]
    mass = np.stack([arm.regressor(x) @ parameters - rest for x in units], -1)
    return np.linalg.solve(mass, (torque - rest)[..., None])[..., 0]


def _joined(parts) -> np.ndarray:
    return np.concatenate([x[_INSIDE] for x in parts])


def _by_instruments(runs, width) -> np.ndarray:
    recordings = [arm.recorded_run(run) for run in runs]
    rows = _joined([arm.regressor(arm.fitted_states(q, width)) for q, _ in recordings])
    torque = _joined([measured for _, measured in recordings])
    spread = torque.std(0)
    a, y = (rows / spread[:, None]).reshape(torque.size, -1), (torque / spread).ravel()
    parameters = np.linalg.lstsq(a, y)[0]
    smooth = [arm.fitted_states(q, _SMOOTH) for q, _ in recordings]
    for _ in range(_ROUNDS):
        simulated = [
            np.concatenate([s[..., :2], _caused(parameters, s, _commanded(run))[..., None]], -1)
            for run, s in zip(runs, smooth)
        ]
        z = _joined([arm.regressor(s) for s in simulated])
        z = (z / spread[:, None]).reshape(torque.size, -1)
        parameters = np.linalg.solve(z.T @ a, z.T @ y)
    return parameters


def _by_states(runs, states_of, both) -> np.ndarray:
    """Least squares on a smoother's states; perhaps with both sides averaged over 210 ms."""
    recordings = [arm.recorded_run(run) for run in runs]
    average = arm.smoothed if both else np.asarray
    rows = _joined([average(arm.regressor(states_of(q))) for q, _ in recordings])
    return arm.parameters_of(rows, _joined([average(torque) for _, torque in recordings]))


def _butterworth(runs, cutoff, both) -> np.ndarray:
    return _by_states(runs, lambda q: butterworth_states(q, arm.STEP, cutoff), both)


def _kalman(runs, both) -> np.ndarray:
    """With the noise that is likeliest."""
    return _by_states(runs, lambda q: kalman_states(q, arm.STEP), both)


def _sure(runs, way, *how) -> dict:
    """Parameters, and their standard errors from leaving out one run at a time."""
    each = np.array([way([r for r in runs if r != out], *how) for out in runs])
    errors = np.sqrt((len(runs) - 1) * ((each - each.mean(0)) ** 2).mean(0))
    return {"values": way(runs, *how), "errors": errors}


@study
def _two_link_instruments() -> dict:
    """Parameters of each design by window, by cutoff, and by the likeliest smoother."""
    tasks = {"instruments": (_by_instruments, [(w,) for w in arm.LENGTHS])}
    for both, suffix in ((False, ""), (True, ", both sides")):
        tasks["Butterworth" + suffix] = _butterworth, [(f, both) for f in _CUTOFFS]
        tasks["Kalman" + suffix] = _kalman, [(both,)]
    jobs = [
        (design, name, way, how)
        for design in arm.RUNS
        for name, (way, hows) in tasks.items()
        for how in hows
    ]
    with joblib.parallel_config("loky", n_jobs=-1, inner_max_num_threads=1):
        run = joblib.delayed(lambda d, way, how: _sure(arm.RUNS[d], way, *how))
        estimates = joblib.Parallel()(run(design, way, how) for design, _, way, how in jobs)
    designs = {design: {name: [] for name in tasks} for design in arm.RUNS}
    for (design, name, *_), parameters in zip(jobs, estimates):
        designs[design][name].append(parameters)
    return {"lengths": arm.LENGTHS, "cutoffs": _CUTOFFS, "designs": designs}
