"""What single readings show, before any equation: units, jumps, values that are held or lost.

The equations of motion show more: `ddlib.identification.check_recording`.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from scipy.signal import savgol_filter

from ddlib.logs.findings import JOINTS, Finding, grouped, place
from ddlib.logs.log import LoggedRecording
from ddlib.simulation import Recording
from ddlib.tables import plural

TURN = 2 * np.pi
SLOWEST, FASTEST = 0.002, 100.0  # peak speeds of a joint, rad/s, outside of which units are wrong
FARTHEST = 8 * np.pi  # range of a joint, rad, beyond which degrees are suspected
HIGHEST = 500.0  # torque of a joint, N m, from which its unit is doubted
ALIKE = 0.45  # correlation of fast changes from which a torque counts as computed from a velocity
SPIKE = np.array([1.0, -4.0, 6.0, -4.0, 1.0])  # what fourth differences make of one wrong sample


class DoubtfulRecording(UserWarning):
    """A recording shows something that makes results wrong."""


def warn_of(recording: Recording) -> None:
    """Warn in one line of what makes every fit to a log wrong; silent if nothing does.

    Only what single readings show: units, wraps, spikes, drop-outs, no torque at all. A simulated
    recording is what it is, and has none of these.

    Parameters
    ----------
    recording : Recording
        Arrays (runs, time, 2).

    Warns
    -----
    DoubtfulRecording
        With the worst findings and their places.
    """
    if not isinstance(recording, LoggedRecording):
        return
    groups = grouped(f for f in readings(recording) if f.severity == "wrong")
    if not groups:
        return
    places = [f"{first.kind} ({place(first, runs)})" for first, runs in groups]
    more = f" and {len(places) - 3} more" if len(places) > 3 else ""
    warnings.warn(
        f"the recording shows what makes a fit wrong: {'; '.join(places[:3])}{more}. "
        "check_recording(recording) says where, and what to do.",
        DoubtfulRecording,
        stacklevel=4,
    )


def readings(recording: Recording) -> Iterator[Finding]:
    """What the readings of each run and joint show; arrays of `recording` are (runs, time, 2)."""
    lines = getattr(recording, "lines", None)
    for run, (q, tau) in enumerate(zip(recording.q, recording.tau)):
        found = [*_units(q, tau, recording.step), *_repeated(q, tau, recording.step)]
        for joint in range(2):
            for look in (_angle, _torque, _limits, _command):
                found += [
                    replace(f, joint=joint)
                    for f in look(q[:, joint], tau[:, joint], recording.step, JOINTS[joint])
                ]
        found += _at_work(q, tau)
        for finding in found:
            rows = None if lines is None else lines[run][finding.rows]
            yield replace(finding, run=run, lines=rows)


def at_rest(q) -> np.ndarray:
    """Which joints of angles (time, 2) do not move, but for a noise of their reading, (2,)."""
    low, high = np.percentile(q, (0.5, 99.5), axis=0)
    return (high - low < 1e-3) | (high - low < 0.005 * (high - low).max())


def _finding(kind, severity, what, effect, advice, rows=(), joint=None) -> Finding:
    return Finding(kind, severity, None, joint, what, effect, advice, np.asarray(rows, int))


def _units(q, tau, step) -> Iterator[Finding]:
    """Units that cannot be right, by the size of ranges, speeds and torques."""
    speed = np.percentile(np.abs(np.diff(q, axis=0)) / step, 98, axis=0).max()
    farthest, highest = np.ptp(q, axis=0).max(), np.abs(tau).max(axis=0)
    seen = (
        f"The fastest joint moves {farthest:.3g} rad in all, at {speed:.3g} rad/s; the step is "
        f"{step:.4g} s."
    )
    if farthest > 0.05 and speed < SLOWEST * min(1.0, farthest):
        yield _finding(
            "units of time", "wrong", seen,
            "If the times are milliseconds, inertias come out a million times too large.",
            "Name the unit of the time: ms, us or ns.",
        )  # fmt: skip
    elif farthest > FARTHEST and speed > 0.2 * FASTEST:
        yield _finding(
            "units of angle", "wrong", seen,
            "If these are degrees, inertias come out 57 times too small, and sines are of nothing.",
            "Name the unit of the angles: deg.",
        )  # fmt: skip
    elif speed > FASTEST:
        yield _finding(
            "units of time", "wrong", seen, "No arm is as fast: inertias come out far too small.",
            "Check the unit of the time, and the rate.",
        )  # fmt: skip
    if highest.max() > HIGHEST:
        joint = int(highest.argmax())
        yield _finding(
            "units of torque", "doubtful",
            f"The torque of the {JOINTS[joint]} goes to {highest[joint]:.4g} N m, as in few arms.",
            "If these are mA or N mm, inertias come out a thousand times too large.",
            "Name the unit of the torque: mA, with N m per A as its factor, or mNm.", joint=joint,
        )  # fmt: skip


def _repeated(q, tau, step) -> Iterator[Finding]:
    """Lines that repeat all readings of the line before: the log is faster than what it logs."""
    changes = np.diff(np.concatenate([q, tau], axis=1), axis=0) != 0
    changes = changes[:, changes.sum(axis=0) >= 20]
    new = np.flatnonzero(changes.any(axis=1))
    if changes.shape[1] < 2 or new.size < 20:
        return
    waits = np.diff(new)
    usual = float(np.median(waits))
    if usual >= 2 and changes[new].mean() > 0.8 and np.percentile(waits, 90) <= 3 * usual:
        yield _finding(
            "slow readings", "doubtful",
            f"Angles and torques change together, every {usual:.0f} samples only.",
            "From line to line the arm stands still and jumps; readings are up to "
            f"{usual - 1:.0f} samples old.",
            f"Read the log with step={usual * step:.3g} or more.",
        )  # fmt: skip


def _angle(q, tau, step, name) -> Iterator[Finding]:
    """Whole turns, single wrong samples, and stretches that were lost."""
    if q.size < 12:
        return
    jumps = np.diff(q)
    for turn, unit, advice in (
        (TURN, "a whole turn", "Take `numpy.unwrap(q, axis=-2)`."),
        (360.0, "360", "Name the unit deg, after `numpy.unwrap` with period=360."),
    ):
        rest = jumps - turn * np.round(jumps / turn)
        usual = min(6 * np.percentile(np.abs(jumps), 90) + 1e-3, turn / 12)
        rows = np.flatnonzero((np.abs(jumps) > turn / 2) & (np.abs(rest) < usual))
        if rows.size:
            yield _finding(
                "wrap", "wrong", f"The angle jumps by {unit} {plural(rows.size, 'time')}.",
                "A jump looks like a speed of hundreds of rad/s; inertias come out too small.",
                advice, rows + 1,
            )  # fmt: skip
    whole = np.unwrap(q)
    lost = lost_stretches(whole, q)
    for how, what in (("held", "stands still and then jumps on"), ("zero", "reads exactly zero")):
        rows = [np.arange(begin, end) for begin, end, kind in lost if kind == how]
        if rows:
            number, rows = plural(len(rows), "stretch"), np.concatenate(rows)
            yield _finding(
                f"drop-outs ({how})", "wrong" if rows.size > 0.003 * q.size else "doubtful",
                f"The angle {what} in {number}, while the joint moves.",
                "Each ends with a jump, which looks like a large speed: frictions and inertias are "
                "wrong.",
                "Take these samples out of the file, and read it again.", rows,
            )  # fmt: skip
    for begin, end, how in lost:  # a line across what was lost, so that its ends are no spikes
        inside = np.arange(begin + (how == "held"), end)
        whole[inside] = np.interp(inside, [inside[0] - 1, end], whole[[inside[0] - 1, end]])
    yield from _spikes(whole, max(0.01 * np.ptp(whole), 1e-3))


def _spikes(x, least) -> Iterator[Finding]:
    """Single wrong samples, those that matter apart from those that hardly do."""
    rows, sizes = spikes(x)
    for severity, chosen in (("wrong", sizes > least), ("doubtful", sizes <= least)):
        if chosen.any():
            yield _finding(
                "spike", severity,
                f"{plural(int(chosen.sum()), 'sample')} out of line with those beside it, by up to "
                f"{sizes[chosen].max():.2g} rad.",
                "One wrong sample acts on every filter and bump around it.",
                "Take these samples out of the file, and read it again.", rows[chosen],
            )  # fmt: skip


def grain(x) -> float:
    """The step of a quantiser, if values lie on one: the smallest gap that is not rounding."""
    gaps = np.diff(np.unique(x[:: max(1, x.size // 20_000)]))
    gaps = gaps[gaps > 1e-9 * np.ptp(x)]
    return float(gaps.min()) if gaps.size else 0.0


def spikes(x, least: float = 8.0) -> tuple[np.ndarray, np.ndarray]:
    """Samples that stand alone beside their neighbours, and by how much.

    Fourth differences turn one wrong sample into 1, -4, 6, -4, 1 times its error. A spike has this
    shape, stands out of the fourth differences around it `least` times, and out of what the
    quantiser can do, which is 1.3 of its steps.
    """
    fourth = np.diff(x, 4)
    size = np.abs(fourth) / 6
    floor = 4 * grain(x) if np.unique(np.diff(x)).size < 0.5 * x.size else 0.0
    floor = max(floor, least * float(np.median(size)), 1e-9)
    rows, sizes = [], []
    for k in np.flatnonzero(size > floor):
        near = fourth[max(k - 2, 0) : k + 3]
        shape = SPIKE[max(2 - k, 0) : 5 - max(k + 3 - fourth.size, 0)]
        error = near @ shape / (shape @ shape)
        rest = near - error * shape
        around = np.r_[size[max(k - 25, 0) : max(k - 4, 0)], size[k + 5 : k + 26]]
        usual = np.percentile(around, 90) if around.size else 0.0
        if error and rest @ rest < 0.1 * (near @ near) and abs(error) > least * usual:
            rows.append(k + 2)
            sizes.append(abs(error))
    return np.array(rows, int), np.array(sizes)


def constant(x) -> Iterator[tuple[int, int]]:
    """Begin and end of each stretch of two or more equal values."""
    edges = np.flatnonzero(np.diff(np.r_[False, np.diff(x) == 0, False].astype(np.int8)))
    return zip(edges[::2], edges[1::2] + 1)


def lost_stretches(whole, raw) -> list[tuple[int, int, str]]:
    """Stretches (begin, end, how) at which a moving angle stood still, or read exactly zero.

    A joint that rests speeds up from rest. After a drop-out the angle jumps to where it is: by
    about its speed times the length of the stretch.
    """
    step, lost, jumps = grain(whole), [], np.abs(np.diff(whole))
    for begin, end in constant(whole):
        if end - begin < 3 or begin < 3 or end > whole.size - 4 or raw[begin] == 0:
            continue
        before = (whole[begin] - whole[begin - 3]) / 3
        after = (whole[end + 3] - whole[end]) / 3
        jump, travel = whole[end] - whole[end - 1], (before + after) / 2 * (end - begin)
        beside = max(jumps[begin - 3 : begin].max(), jumps[end : end + 3].max())
        if before * after > 0 and 0.5 < jump / travel < 2 and abs(jump) > max(2 * beside, 3 * step):
            lost.append((begin, end, "held"))
    for begin, end in _zeros(raw):
        beside = np.r_[np.diff(raw[begin - 3 : begin]), np.diff(raw[end : end + 3])]
        least = max(5 * np.abs(beside).max(), 5 * step, 1e-6)
        if min(abs(raw[begin - 1]), abs(raw[end])) > least and raw[begin - 1] * raw[end] > 0:
            lost.append((begin, end, "zero"))
    return lost


def _zeros(x) -> Iterator[tuple[int, int]]:
    """Begin and end of each stretch of exact zeros, but at the ends."""
    edges = np.flatnonzero(np.diff(np.r_[False, x == 0, False].astype(np.int8)))
    return ((b, e) for b, e in zip(edges[::2], edges[1::2]) if b >= 3 and e <= x.size - 3)


def _torque(q, tau, step, name) -> Iterator[Finding]:
    """A torque that is lost for some samples."""
    if tau.size < 12 or steady(tau):
        return
    steps, moves = np.abs(np.diff(tau)), np.diff(q) != 0
    if np.mean(steps[moves] == 0) > 0.3:  # it comes at a slower rate, or in few steps
        return
    usual, zeros = np.median(steps), []
    for begin, end in _zeros(tau):
        sides = np.r_[tau[begin - 3 : begin], tau[end : end + 3]]
        same = np.all(sides > 0) or np.all(sides < 0)
        if same and np.abs(sides).min() > max(6 * usual, 3 * np.ptp(sides) / 2, 0.05 * tau.std()):
            zeros.append(np.arange(begin, end))
    if zeros:
        yield _finding(
            "torque zero", "wrong",
            f"The torque is exactly zero between others in {plural(len(zeros), 'stretch')}.",
            "Equations are told a torque that did not act.",
            "Take these samples out of the file, unless the torque was switched so.",
            np.concatenate(zeros),
        )  # fmt: skip


def _limits(q, tau, step, name) -> Iterator[Finding]:
    """A torque at a limit."""
    if steady(tau):
        return
    waits = np.diff(np.flatnonzero(np.diff(tau)))
    usual = np.median(waits) if waits.size else 1  # a slow torque stays so long at any value
    for value, where in ((tau.max(), "highest"), (tau.min(), "lowest")):
        rows = np.flatnonzero(tau == value)
        longest = max((e - b for b, e in constant(tau) if tau[b] == value), default=1)
        several = np.unique(tau).size >= 12 and longest <= 0.6 * tau.size
        if value and several and longest >= 4 * usual and rows.size >= max(5, 0.003 * tau.size):
            yield _finding(
                "saturation", "doubtful",
                f"{rows.size} torques are exactly {value:.4g} N m, the {where} value, up to "
                f"{longest} in a row.",
                "If the sensor was at its limit, the torque was larger; if the drive was, all is "
                "well.",
                "Compare with the drive's limit; else leave these samples out.", rows,
            )  # fmt: skip


def steady(x) -> bool:
    """Whether values are one value, but for the rounding of a computation."""
    return bool(np.ptp(x) <= 1e-9 * np.abs(x).max())


def _at_work(q, tau) -> Iterator[Finding]:
    """Joints that rest, or whose torque says nothing."""
    rest, moved = at_rest(q), np.round(np.ptp(q, axis=0), 9)
    if rest.all():
        yield _finding(
            "at rest", "wrong", f"No joint moves: the angles stay within {moved.max():.3g} rad.",
            "No inertia and no friction can be told from this run, of an arm that hangs only the "
            "torque of its weight in this pose.",
            "Leave the run out, unless it is one of many poses of an arm that hangs.",
        )  # fmt: skip
    for joint, name in enumerate(JOINTS):
        torque, other = tau[:, joint], tau[:, 1 - joint]
        if rest[joint] and not rest.all():
            yield _finding(
                "at rest", "doubtful", f"The {name} moves by {moved[joint]:.3g} rad only.",
                "Its own inertia, the coupling and its friction cannot be told one by one, only "
                "the inertia of both links together.",
                "Add runs in which it moves, or fit the sum alone.", joint=joint,
            )  # fmt: skip
        if steady(torque):
            yield _finding(
                "no torque", "wrong" if steady(other) else "doubtful",
                f"The {name}'s torque is {torque[0]:.4g} N m throughout.",
                "Equations of a joint without a motor hold, but those of a motor whose torque was "
                "not logged do not. A network has nothing to learn there.",
                "If the joint has a motor, log its torque.", joint=joint,
            )  # fmt: skip


def _command(q, tau, step, name) -> Iterator[Finding]:
    """A torque whose fast changes go with those of the velocity: a controller computed it.

    Those of a measured torque do not: an arm's inertia leaves none of them in its angle.
    """
    if tau.size < 300 or steady(tau):
        return
    angle, torque = _fast(np.unwrap(q)), _fast(tau)
    velocity = _fast(np.diff(np.unwrap(q)))
    if _alike(torque[1:], torque[:-1]) > 0.5:  # smooth, which goes with anything
        return
    late = range(-2, 3)  # samples
    with_velocity = max((_alike(np.roll(torque[1:], k), velocity) for k in late), key=abs)
    with_angle = max((_alike(np.roll(torque, k), angle) for k in late), key=abs)
    if abs(with_velocity) > max(ALIKE, 0.9 * abs(with_angle)):
        yield _finding(
            "command", "doubtful",
            f"The {name}'s torque looks like a command: its fast changes go with those of the "
            f"measured velocity ({with_velocity:+.2f}).",
            "What the motor gave may differ by half; then inertias and friction are those of the "
            "command.",
            "Log the measured current, or leave these runs out of a fit. A fast drive on the same "
            "encoder looks alike: then all is well.",
        )  # fmt: skip


def _alike(x, y) -> float:
    """Correlation of two series of mean 0, as a median over stretches: no single jump decides."""
    pairs = zip(*(np.array_split(part, max(2, min(20, x.size // 40))) for part in (x, y)))
    return float(np.median([a @ b / (np.sqrt(a @ a * (b @ b)) + 1e-300) for a, b in pairs]))


def _fast(x) -> np.ndarray:
    """What a parabola through seven samples leaves over: noise and steps of a quantiser."""
    return x - savgol_filter(x, 7, 2)
