"""Findings on single readings: wraps, jumps, spikes, values that are held, zero or at a limit."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ddlib.logs._stamps import usual_step
from ddlib.logs.findings import Finding, counted, finding
from ddlib.logs.log import LoggedRun

TURN = 2 * np.pi
SPIKE = np.array([1.0, -4.0, 6.0, -4.0, 1.0])  # what fourth differences make of one wrong sample


def readings(k: int, run: LoggedRun) -> Iterator[Finding]:
    """What the angles and torques of run number `k` show, joint by joint."""
    yield from _slow_readings(k, run)
    for j in range(2):
        if run.t.size < 12:
            return
        q, tau = run.q[:, j], run.tau[:, j]
        missing = np.flatnonzero(~np.isfinite(q) | ~np.isfinite(tau))
        if missing.size:
            yield finding(
                run, "missing", "note" if missing.size < 0.05 * q.size else "doubtful", (k, j),
                missing, f"{missing.size} samples have no angle or no torque.",
                "Nothing can be computed across them.", "Leave these stretches out of a fit.",
            )  # fmt: skip
            if missing.size > q.size - 12:
                return
            q, tau = without_gaps(q), without_gaps(tau)
        yield from _wraps(k, j, run, q)
        whole = unwrapped(q)
        lost = dropouts(whole, q, run.t)
        yield from _dropouts(k, j, run, q, lost)
        mended = _without(whole, lost)
        yield from _spikes(k, j, run, mended, lost)
        yield from _held_torque(k, j, run, q, tau)
        yield from _limit(k, j, run, tau)
        yield from _one_sign(k, j, run, q, tau)


def _spikes(k, j, run, q, lost):
    """Single wrong angles, those that matter apart from those that hardly do."""
    rows, sizes = spikes(q)
    steps = np.diff(run.t)
    with np.errstate(invalid="ignore"):
        uneven = np.abs(steps / np.median(steps) - 1) > 0.25
    gaps_at = np.flatnonzero(uneven)  # beside such a step a motion looks like a spike
    if gaps_at.size:
        apart = np.abs(rows[:, None] - gaps_at).min(-1, initial=len(q)) > 3
        rows, sizes = rows[apart], sizes[apart]
    spread = np.ptp(q)
    for severity, chosen in (
        ("wrong", sizes > 0.01 * spread),
        ("doubtful", sizes <= 0.01 * spread),
    ):
        if chosen.any():
            yield finding(
                run, "spike", severity, (k, j), rows[chosen],
                f"{counted(chosen.sum(), 'angle')} far from the neighbours, by up to "
                f"{sizes[chosen].max():.3g} rad of a range of {spread:.3g} rad.",
                "An acceleration sees a spike first: one of half a radian can make an inertia a "
                "tenth of what it is.",
                "Replace such a sample by the mean of its neighbours.",
            )  # fmt: skip


def without_gaps(x):
    """Samples that are missing, on a line between those that are not."""
    at = np.arange(x.size)
    good = np.isfinite(x)
    return np.interp(at, at[good], x[good])


def unwrapped(q) -> np.ndarray:
    """Angles without jumps of a turn, in rad; only jumps are taken that a turn explains."""
    jumps = np.diff(q)
    if not jumps.size:
        return q
    turns = np.where(wrapped(jumps), np.round(jumps / TURN), 0.0)
    return q - TURN * np.concatenate([[0.0], np.cumsum(turns)])


def wrapped(jumps) -> np.ndarray:
    """Which steps from sample to sample are whole turns, but for what a step usually is."""
    usual = 6 * np.percentile(np.abs(jumps), 90) + 1e-3
    rest = jumps - TURN * np.round(jumps / TURN)
    return (np.abs(jumps) > np.pi) & (np.abs(rest) < min(usual, 0.5))


def _wraps(k, j, run, q):
    jumps = np.diff(q)
    rows = np.flatnonzero(wrapped(jumps))
    if rows.size:
        yield finding(
            run, "wrap", "wrong", (k, j), rows + 1,
            f"The angle jumps by a whole turn {counted(rows.size, 'time')}.",
            "A jump looks like a speed of hundreds of rad/s; inertias come out too small.",
            "Take `numpy.unwrap(q, axis=-2)`, with period=360 before degrees are converted.",
        )  # fmt: skip
    degrees = jumps - 360.0 * np.round(jumps / 360.0)
    usual = 6 * np.percentile(np.abs(jumps), 90) + 1e-3
    rows = np.flatnonzero((np.abs(jumps) > 180.0) & (np.abs(degrees) < min(usual, 30.0)))
    if rows.size:
        yield finding(
            run, "wrap", "wrong", (k, j), rows + 1,
            f"The angle jumps by 360 {counted(rows.size, 'time')}: it seems to be in degrees.",
            "Speeds, sines and inertias are all wrong.",
            "Name the unit deg, and take `numpy.unwrap` with period=360.",
        )  # fmt: skip


def grain(x) -> float:
    """The step of a quantiser, if values lie on one: the smallest gap that is not rounding."""
    values = np.unique(x[:: max(1, x.size // 20_000)])
    if values.size < 3:
        return float(np.ptp(values))
    gaps = np.diff(values)
    gaps = gaps[gaps > 1e-9 * np.ptp(values)]
    return float(gaps.min()) if gaps.size else 0.0


def spikes(q, least: float = 8.0) -> tuple[np.ndarray, np.ndarray]:
    """Samples that stand alone beside their neighbours, and by how much.

    Fourth differences turn one wrong sample into 1, -4, 6, -4, 1 times its error. A finding has
    this shape, stands out of the fourth differences around it `least` times, and out of what the
    quantiser can do, which is 1.3 of its steps.
    """
    if q.size < 12:
        return np.empty(0, int), np.empty(0)
    fourth = np.diff(q, 4)
    size = np.abs(fourth) / 6
    floor = 4 * grain(q) if np.unique(np.diff(q)).size < 0.5 * q.size else 0.0
    floor = max(floor, least * float(np.median(size)), 1e-9)
    rows, sizes = [], []
    for c in np.flatnonzero(size > floor):
        near = fourth[max(c - 2, 0) : c + 3]
        shape = SPIKE[max(2 - c, 0) : 5 - max(c + 3 - fourth.size, 0)]
        s = near @ shape / (shape @ shape)
        left = near - s * shape
        if left @ left > 0.1 * (near @ near) or abs(near @ shape) == 0:
            continue
        low, high = max(c - 25, 0), min(c + 26, fourth.size)
        around = np.abs(np.concatenate([fourth[low : max(c - 4, 0)], fourth[c + 5 : high]])) / 6
        if abs(s) < least * (np.percentile(around, 90) if around.size else 0.0):
            continue
        rows.append(c + 2)
        sizes.append(abs(s))
    return np.array(rows, int), np.array(sizes)


def constant(x) -> tuple[np.ndarray, np.ndarray]:
    """Begin and length of each stretch of two or more equal values."""
    same = np.concatenate([[False], np.diff(x) == 0, [False]])
    edges = np.flatnonzero(np.diff(same.astype(np.int8)))
    begin, end = edges[::2], edges[1::2]
    return begin, end - begin + 1


def dropouts(whole, raw, t) -> list[tuple[int, int, str]]:
    """Stretches (begin, end, how) at which a moving angle stood still, or read exactly zero.

    A joint that rests speeds up from rest. After a drop-out the angle jumps to where it is: by
    about its speed times the length of the stretch.
    """
    steps = np.abs(np.diff(whole))
    spans = np.diff(t)
    speeds = steps / np.where(spans > 0, spans, np.inf)
    step, lost = grain(whole), []
    begin, length = constant(whole)
    for b, n in zip(begin, length):
        e = b + n  # the first sample after
        if n < 3 or b < 3 or e > whole.size - 4 or raw[b] == 0.0:
            continue
        before = (whole[b] - whole[b - 3]) / 3
        after = (whole[e + 3] - whole[e]) / 3
        jump = whole[e] - whole[e - 1]
        travel = (before + after) / 2 * n
        beside = max(speeds[b - 3 : b].max(), speeds[e : e + 3].max())
        if (
            before * after > 0
            and 0.5 < jump / travel < 2.0
            and speeds[e - 1] > 2 * beside
            and abs(jump) > 3 * step
        ):
            lost.append((b, e, "held"))
    zero = np.concatenate([[False], raw == 0.0, [False]])
    edges = np.flatnonzero(np.diff(zero.astype(np.int8)))
    for b, e in zip(edges[::2], edges[1::2]):
        if b < 3 or e > raw.size - 3:
            continue
        usual = max(np.abs(np.diff(raw[b - 3 : b])).max(), np.abs(np.diff(raw[e : e + 3])).max())
        least = max(5 * usual, 5 * step, 1e-6)
        if abs(raw[b - 1]) > least and abs(raw[e]) > least and raw[b - 1] * raw[e] > 0:
            lost.append((b, e, "zero"))
    return lost


def _without(q, lost):
    """Angles with a line across what was lost."""
    if not lost:
        return q
    q = q.copy()
    for b, e, how in lost:
        q[b + (how == "held") : e] = np.nan
    return without_gaps(q)


def _dropouts(k, j, run, q, lost):
    for how, what in (("held", "stands still and then jumps on"), ("zero", "reads exactly zero")):
        stretches = [(b, e) for b, e, kind in lost if kind == how]
        if not stretches:
            continue
        rows = np.concatenate([np.arange(b, e) for b, e in stretches])
        longest = max(e - b for b, e in stretches)
        yield finding(
            run, f"drop-outs ({how})", "wrong" if rows.size > 0.003 * q.size else "doubtful",
            (k, j), rows,
            f"The angle {what} in {counted(len(stretches), 'stretch')} of up to {longest} samples, "
            "while the joint moves.",
            "Each ends with a jump, which looks like a large speed: frictions and inertias are "
            "wrong.",
            "Take these samples out and resample across them, or leave the stretches out.",
        )  # fmt: skip


def _held_torque(k, j, run, q, tau):
    """A torque that stays while the joint moves on, and torques that come at a slower rate."""
    if np.ptp(tau) == 0:
        return
    steps = np.diff(tau)
    begin, length = constant(tau)
    moving = np.abs(np.diff(q)) > 0
    still = np.mean(steps[moving] == 0) if moving.any() else 1.0
    if length.size and still > 0.3:
        usual = np.median(length)
        if usual >= 2 and length.size * usual > 0.7 * tau.size and np.ptp(length) <= 2:
            yield finding(
                run, "slow torque", "note", (k, j), [],
                f"The torque changes every {usual:.0f} samples only.",
                f"It is late by {(usual - 1) / 2:.1f} samples in the mean.",
                "Log at the rate of the torque, or shift it.",
            )  # fmt: skip
        return
    usual, low, high = np.median(np.abs(steps)), tau.min(), tau.max()
    span, zero_steps = 0.3 * tau.std(), np.count_nonzero(steps == 0)
    held, zeros = [], []
    for b, n in zip(begin, length):
        e = b + n
        if b < 3 or e > tau.size - 3 or tau[b] in (low, high):
            continue
        jumps = abs(tau[b] - tau[b - 1]), abs(tau[e] - tau[e - 1])
        if tau[b] == 0 and min(jumps) > max(span, 5 * usual):
            zeros.append((b, e))
        elif (
            tau[b] != 0
            and n >= 10
            and np.ptp(q[b:e]) > 0.01 * np.ptp(q)
            and (jumps[1] > 3 * usual or zero_steps - n < 0.02 * steps.size)
        ):
            held.append((b, e))
    for stretches, what, value in (
        (zeros, "is exactly zero between large values", "zero"),
        (held, "does not change while the joint moves", "held"),
    ):
        if stretches:
            rows = np.concatenate([np.arange(b, e) for b, e in stretches])
            share = rows.size / tau.size
            yield finding(
                run, f"torque {value}", "wrong" if value == "zero" and share < 0.1 else "doubtful",
                (k, j), rows, f"The torque {what} in {counted(len(stretches), 'stretch')}.",
                "Equations are told a torque that did not act.",
                "Leave these samples out, unless the torque was switched so.",
            )  # fmt: skip


def lines_of_a_reading(run: LoggedRun) -> float:
    """How many lines repeat a reading of angles and torques, usually; 1 if each line has its own.

    Readings of a quantiser change one by one, and a joint that rests waits at its ends only.
    """
    readings = np.concatenate([run.q, run.tau], axis=1)
    if len(readings) < 40:
        return 1.0
    with np.errstate(invalid="ignore"):
        changes = np.diff(readings, axis=0) != 0
    changes = changes[:, changes.sum(axis=0) >= 20]
    new = np.flatnonzero(changes.any(axis=1))
    if changes.shape[1] < 2 or new.size < 20:
        return 1.0
    waits = np.diff(new)
    usual = float(np.median(waits))
    if usual < 2 or changes[new].mean() < 0.8 or np.percentile(waits, 90) > 3 * usual:
        return 1.0
    return usual


def _slow_readings(k, run):
    """Lines that repeat all readings of the line before: the log is faster than what it logs."""
    usual = lines_of_a_reading(run)
    if usual > 1:
        yield finding(
            run, "slow readings", "doubtful", (k, None), [],
            f"Angles and torques change together, every {usual:.0f} samples only.",
            "From line to line the arm stands still and jumps; readings are up to "
            f"{usual - 1:.0f} samples old.",
            f"Take a step of {usual * usual_step(run.t):.3g} s or more, and no differences of "
            "lines.",
        )  # fmt: skip


def _one_sign(k, j, run, q, tau):
    """A torque that comes down to zero and never changes its sign, of a joint that swings."""
    size = np.abs(tau)
    high = size.max()
    if not high or (tau.min() < -0.01 * high and tau.max() > 0.01 * high):
        return
    small, moves = size < 0.1 * high, np.diff(q)
    path = np.abs(moves).sum()
    both = min(moves[moves > 0].sum(), -moves[moves < 0].sum()) > 0.1 * path
    touches = np.count_nonzero(np.diff(small.astype(np.int8)) == 1)  # times it comes down to zero
    if both and path > 0.1 and touches >= 3 and 0.03 < small.mean() < 0.7:
        yield finding(
            run, "torque of one sign", "doubtful", (k, j), [],
            f"The torque comes down to zero {counted(touches, 'time')} and never changes its sign, "
            "while the joint moves both ways.",
            "If only the amount of a current was logged, inertia and friction are wrong.",
            "Log the current with its sign, or give it that of the command.",
        )  # fmt: skip


def _limit(k, j, run, tau):
    """Many samples at exactly the largest or smallest value."""
    if np.ptp(tau) == 0:
        return
    waits = np.diff(np.flatnonzero(np.diff(tau)))
    usual = np.median(waits) if waits.size else 1  # a slow torque stays so long at any value
    for value, name in ((tau.max(), "highest"), (tau.min(), "lowest")):
        rows = np.flatnonzero(tau == value)
        begin, length = constant(tau)
        longest = max((n for b, n in zip(begin, length) if tau[b] == value), default=1)
        if value == 0 or longest < 4 * usual or rows.size < max(5, 0.003 * tau.size):
            continue
        if longest > 0.6 * tau.size or np.unique(tau).size < 12:
            continue  # a torque of few values, as of pulses
        yield finding(
            run, "saturation", "doubtful", (k, j), rows,
            f"{rows.size} torques are exactly {value:.4g} N m, the {name} value, up to {longest} "
            "in a row.",
            "If the sensor was at its limit, the torque was larger; if the drive was, all is well.",
            "Compare with the drive's limit; else leave these samples out.",
        )  # fmt: skip
