"""Section 7.1's next step: torques at run time, and what they do to the end-point error."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from beyond.control.adaptive import Watched
from beyond.control.guarded import Guarded
from beyond.control.windowed import (
    MeasuredWindows,
    WindowFeedforward,
    past_slopes,
    poles_inside,
)
from beyond.rivals.gaussian import GaussianProcess
from beyond.rivals.identified import Identified, Linear
from beyond.rivals.lagrangian import LagrangianNetwork
from beyond.rivals.networks import BySolver
from beyond.rivals.protocol import Cases, Estimating
from beyond.studies.loop import feedforwards as parts
from beyond.studies.loop.abreast import delayed
from ddlib.control import PID, plant
from ddlib.dynamics import end_point_error, with_load
from ddlib.effects import CoulombFriction, ViscousFriction
from ddlib.learning import sliding_windows
from ddlib.metrics import rmss
from ddlib.setups import JOINT_DAMPING, STATE_FEEDBACK, WINDOWS, Setup, errors, split
from ddlib.simulation import CONTROL_STEP, LOG_STEP, follow
from ddlib.trajectories import APPENDIX_I, OutsideFamilyWarning, Trajectory, smooth_pick_and_place
from workshop.report import results
from workshop.report.code_hash import study

_READINGS = (JOINT_DAMPING, STATE_FEEDBACK)
_MEMBERS, _FEW = 25, 10  # networks of a cell of Table 4-1, and in side experiments: one a day

# Learn the windows of five recordings and run on the same day.
_RIVALS: dict[str, Callable] = {
    "identified": lambda day: Estimating(Identified()),
    "linear filter": lambda day: Linear(),
    "Gaussian process": lambda day: GaussianProcess(directions=9, subset=150, restarts=0, seed=day),
    "Lagrangian network": lambda day: Estimating(
        LagrangianNetwork((16, 16), gravity="none", friction=True, epochs=150, seed=day)
    ),
    "network, two hidden units": lambda day: BySolver(2, steps=60, decay=1e-6, seed=day),
}

_ROUNDED = (0.0, 0.02, 0.05, 0.1, 0.2)  # s: corners of the reference are averaged over it
_LOADS = (0.0, 2.0, 5.0, 10.0)  # kg: Han, Hemami & Yurkovich 1987
_FRICTIONS = (0.5, 1.0, 2.0)  # factors
_LATE = (0, 1, 3, 5)  # control periods
_GAINS = (1 / 16, 1 / 8, 1 / 4, 1 / 2, 1.0, 2.0, 4.0)  # factors on the feedback

# Of the measured deviation, what a model inside the loop sees.
_SHARES = (0.0, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0)
_LATE_INSIDE = (0, 5)  # delays with a model inside the loop, control periods
_CORNERS = (16, 24, 32, 45, 48)  # trajectories of the square that are tried there
_LIMIT = (4.0, 4.0)  # joint speeds of the guard there, rad/s: five times the family's largest
_SHOWN = (-0.1, 1.0)  # s


def _nothing(q, qd, qdd):
    return np.zeros_like(q)


def _lines(setup: Setup) -> dict[str, list]:
    """Feedforwards by name: one model for all days, or one for each."""
    return {
        "none": [_nothing],
        "exact": [parts.exact(setup)],
        "exact, with its impulses": [parts.with_impulse(setup)],
        **{f"exact, window {w}": [parts.through_window(parts.exact(setup), w)] for w in WINDOWS},
        **{f"network, window {w}": parts.networks(setup, _MEMBERS, w) for w in WINDOWS},
    }


def _few(setup: Setup) -> dict[str, list]:
    """Those of the side experiments."""
    return {
        "none": [_nothing],
        "exact": [parts.exact(setup)],
        "exact, window": [parts.through_window(parts.exact(setup))],
        "network": parts.networks(setup, _FEW),
    }


def _days(models: list) -> range:
    return range(1, 1 + (len(models) if len(models) > 1 else _FEW))


def _square(setup: Setup, reference: Trajectory) -> tuple[dict, dict]:
    """Scores of all lines over the square, and the torques of the networks."""
    rows, torques = {}, {}
    for name, models in _lines(setup).items():
        torque = parts.torques_along(models, reference)
        log = parts.drive(setup, parts.given(torque, setup.controller), reference, _days(models))
        rows[name] = parts.median_scores(parts.score(setup.arm, log))
        if name.startswith("network"):
            torques[name] = torque
    days = range(1, 1 + _FEW)
    log = parts.drive(setup, parts.computed_torque(setup), reference, days)
    rows["computed torque"] = parts.median_scores(parts.score(setup.arm, log))
    return rows, torques


def _rivals(setup: Setup, reference: Trajectory) -> dict:
    """Rivals of windows as feedforwards, with their error on trajectory 6."""
    by_rival: dict = {name: ([], []) for name in _RIVALS}
    days = range(1, 1 + _FEW)
    for day in days:
        training, six = (
            Cases.windows(part, parts.WIDTH) for part in split(setup.repeated(day).record())
        )
        for name, make in _RIVALS.items():
            rival = make(day).fit(training)
            feedforward = WindowFeedforward(
                rival.torque, parts.WIDTH, between="line", step=LOG_STEP
            )
            torques, scores = by_rival[name]
            scores.append(rmss(rival.torque(six.x), six.torque))
            # run by run: a process keeps a product of all windows with all it has learnt
            runs = (Trajectory(*(x[k] for x in reference)) for k in range(len(reference.q)))
            torques.append(np.stack([feedforward(*run) for run in runs]))
    rows = {}
    for name, (torques, scores) in by_rival.items():
        log = parts.drive(setup, parts.given(np.stack(torques), setup.controller), reference, days)
        rows[name] = {**parts.median_scores(parts.score(setup.arm, log)), "RMSS": scores}
    return rows


def _course(setup: Setup) -> dict:
    """Trajectory 6 over time, on day 1: joint errors and end-point errors at the start."""
    reference = parts.rounded(APPENDIX_I[5:], 0.0)
    log, slices = parts.drive_lines(setup, _made(_lines(setup), reference), reference)
    shown = (log.t >= _SHOWN[0] - 1e-9) & (log.t <= _SHOWN[1] + 1e-9)
    gap = 1e3 * np.linalg.norm(end_point_error(setup.arm, log.reference.q, log.q_true), axis=-1)
    joints = np.rad2deg(log.tracking_error)
    by_line = {
        name: {
            "hand": np.median(gap[part], (0, 1))[shown],
            "joints": np.median(joints[part], (0, 1))[shown],
        }
        for name, part in slices.items()
    }
    return {**by_line, "time": log.t[shown]}


def _made(lines: dict, reference) -> dict:
    """Torques of lines along a reference, with the days of their members."""
    return {
        name: (parts.torques_along(models, reference), _days(models))
        for name, models in lines.items()
    }


def _with_computed(setup: Setup, made: dict, reference, **changed) -> dict:
    """The same, and computed torque."""
    days = range(1, 1 + _FEW)
    log = parts.drive(setup, parts.computed_torque(setup), reference, days, **changed)
    middle = np.median(parts.score(setup.arm, log).whole, -1)
    return parts.median_errors(setup, made, reference, **changed) | {"computed torque": middle}


def _corner(setup: Setup) -> dict:
    """Corners of the reference rounded, and a reference without corners."""
    lines = _few(setup)

    def along(reference):
        return parts.median_errors(setup, _made(lines, reference), reference)

    by_seconds = {
        f"{seconds:g}": along(parts.rounded(parts.FEWER_EXTENTS, seconds)) for seconds in _ROUNDED
    }
    return {
        "rounded": by_seconds,
        "smooth": along(smooth_pick_and_place(parts.FEWER_EXTENTS, parts.TIMES)),
    }


def _rates(setup: Setup, reference) -> dict:
    """What is done between the samples of the log, and windows at the wrong period."""
    options: dict = {between: {"between": between} for between in ("window", "line", "hold")}
    options["2 ms apart"] = {"every": 1, "step": None}
    lines = {name: parts.networks(setup, _FEW, **how) for name, how in options.items()}
    return parts.median_errors(setup, _made(lines, reference), reference)


def _changed(setup: Setup, made: dict, reference) -> dict:
    """Load, friction and delay that no feedforward was made for."""
    result: dict = {"load": {}, "friction": {}, "delay": {}}
    for load in _LOADS:
        arm = with_load(setup.arm, load)
        knows = _made(
            {"exact, window, knows": [parts.through_window(parts.exact(setup, arm))]}, reference
        )
        result["load"][f"{load:g}"] = _with_computed(setup, made | knows, reference, arm=arm)
    viscous, coulomb = setup.effects.friction
    for factor in _FRICTIONS:
        friction = (
            ViscousFriction(factor * np.asarray(viscous.coefficient)),
            CoulombFriction(factor * np.asarray(coulomb.level)),
        )
        effects = replace(setup.effects, friction=friction)
        result["friction"][f"{factor:g}"] = _with_computed(setup, made, reference, effects=effects)
    for late in _LATE:
        effects = delayed(setup.effects, late)
        result["delay"][f"{late}"] = _with_computed(setup, made, reference, effects=effects)
    return result


def _gains(setup: Setup, made: dict, reference) -> dict:
    """Softer and stiffer feedback, without and with feedforwards."""
    by_factor = {}
    for factor in _GAINS:
        kp, kd = (factor * np.asarray(k) for k in (setup.controller.kp, setup.controller.kd))
        other = replace(setup, controller=PID(tuple(kp), kd=tuple(kd)))
        by_factor[f"{factor:g}"] = parts.median_errors(other, made, reference)
    return by_factor


def _scatter(setup: Setup, rows: dict, torques: dict, reference) -> dict:
    """Each network's error as the report measures it, and other predictors of the end point's."""
    by_window = {}
    recording = setup.record()
    for width in WINDOWS:
        name = f"network, window {width}"
        model = results.networks(width, setup.name)
        by_window[str(width)] = {
            "end point": rows[name]["whole"],
            "RMSS": errors(model, recording).test,
            "through the loop": parts.error_of_logged(setup, model, split(recording)[1]),
            "planned": np.median(parts.predicted_error(setup, torques[name], reference), -1),
        }
    return by_window


def _bound(setup: Setup, torques: np.ndarray, reference) -> dict:
    """Largest answer of the linear loop to bounded torques, and what networks make of theirs."""
    elbow = float(reference.q[..., 1].mean())
    system = parts.linear_loop(setup, elbow)
    knock = np.zeros((2, 5000, 2))
    knock[[0, 1], 0, [0, 1]] = 1.0
    gain = np.abs(parts.through_loop(system, knock)).sum(1).T  # (angle, torque), rad/(N m)
    days = range(1, 1 + len(torques))
    other = parts.torques_along([parts.through_window(parts.exact(setup))], reference)
    runs = [
        parts.drive(setup, parts.given(torque, setup.controller), reference, days)
        for torque in (torques, other)
    ]
    apart = np.abs(runs[0].q_true - runs[1].q_true).max(-2)
    largest = np.abs(torques - other).max(-2)
    return {
        "gain": np.rad2deg(gain),
        "torque": np.median(largest, 1),
        "apart": np.rad2deg(np.median(apart, 1)),
        "share": (apart / (largest @ gain.T)).max((1, 2)),
    }


def _inside(setup: Setup) -> dict:
    """Models inside the loop: which runs the guard stops, the error of the others."""
    reference = parts.rounded(parts.EXTENTS[list(_CORNERS)], 0.0)
    shares, rows = np.array(_SHARES)[:, None], {}
    models = {name: _few(setup)[name] for name in ("exact, window", "network")}
    day = setup.repeated(1).effects
    for name, several in models.items():
        for late in _LATE_INSIDE:
            effects = delayed(day, late)
            row: dict = {"stopped": [], "error": [], "poles": []}
            for model in several:
                law = Watched(
                    Guarded(MeasuredWindows(model, setup.controller, shares), speeds=_LIMIT)
                )
                log = follow(setup.arm, law, reference, parts.TIMES, effects=effects, duration=3.0)
                row["stopped"].append(law.law.stops.stopped.mean(1))
                row["error"].append(np.median(parts.score(setup.arm, log).whole, 1))
                row["poles"].append(_largest_poles(setup, model, reference, late))
            rows[f"{name}, {late}"] = row
    return rows


def _largest_poles(setup: Setup, model: WindowFeedforward, reference, late: int) -> list[float]:
    """Size of the largest pole of the linear loop with a model inside, at each of `_SHARES`."""
    windows = sliding_windows(reference.q[..., 250:1750:5, :], parts.WIDTH).reshape(
        -1, 2, parts.WIDTH
    )
    past = past_slopes(model.model, windows[::10])
    viscous = np.asarray(setup.effects.friction[0].coefficient)
    joints = plant(setup.arm.mass_matrix([0.0, float(windows[:, 1].mean())]), viscous)
    poles = [
        poles_inside(joints, setup.controller, s * past, CONTROL_STEP, late=late) for s in _SHARES
    ]
    return [float(np.abs(each).max()) for each in poles]


@study
def _run_time() -> dict:
    """Feedforwards of the square of extents, two readings: end-point errors, RMS, mm."""
    reference = parts.rounded(parts.EXTENTS, 0.0)
    result: dict = {
        "points": parts.POINTS,
        "extents": parts.EXTENTS,
        "shares": _SHARES,
        "limit": _LIMIT,
    }
    result["readings"] = {}
    fewer = parts.rounded(parts.FEWER_EXTENTS, 0.0)
    for setup in _READINGS:
        lines = _made(_few(setup), fewer)
        rows, torques = _square(setup, reference)
        with warnings.catch_warnings(action="ignore", category=OutsideFamilyWarning):
            rows |= _rivals(setup, reference)
        result["readings"][setup.name] = {
            "square": rows,
            "course": _course(setup),
            "corner": _corner(setup),
            "rates": _rates(setup, fewer),
            "changed": _changed(setup, lines, fewer),
            "gains": _gains(setup, lines, fewer),
            "scatter": _scatter(setup, rows, torques, reference),
            "bound": _bound(setup, torques[f"network, window {parts.WIDTH}"], reference),
            "inside": _inside(setup),
        }
    return result
