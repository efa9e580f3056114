"""Findings on the times of a log: their order, gaps, rounding, jitter, and their unit."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ddlib.logs.findings import JOINTS, Finding, counted, finding
from ddlib.logs.log import LoggedRun

SLOWEST, FASTEST = 0.002, 100.0  #: Peak speeds of a joint, rad/s, outside of which units are wrong.
HIGHEST = 500.0  #: Torque of a joint, N m, from which its unit is doubted.
FARTHEST = 8 * np.pi  #: Range of a joint, rad, beyond which degrees are suspected.


def usual_step(t) -> float:
    """The step that most samples have, s; 0 without any."""
    steps = np.diff(t)
    steps = steps[np.isfinite(steps) & (steps > 0)]
    return float(np.median(steps)) if steps.size else 0.0


def stamps(k: int, run: LoggedRun) -> Iterator[Finding]:
    """What the times of run number `k` show."""
    steps, step = np.diff(run.t), usual_step(run.t)
    place = (k, None)
    if not step:
        yield finding(
            run, "time", "wrong", place, [], "No time is later than the one before.",
            "Speeds and accelerations cannot be computed.",
            "Name the column of the time, or a rate.",
        )  # fmt: skip
        return
    back, same = np.flatnonzero(steps < 0), np.flatnonzero(steps == 0)
    if back.size:
        yield finding(
            run, "time runs back", "wrong", place, back + 1,
            f"The time falls {counted(back.size, 'time')}, by up to {-steps[back].min():.3g} s.",
            "Samples are in a wrong order, or several runs are read as one.",
            "Split the log into its runs, or sort it by time.",
        )  # fmt: skip
    if same.size:
        share = same.size / steps.size
        yield finding(
            run, "repeated time", "doubtful" if share > 0.002 else "note", place, same + 1,
            f"Of {counted(run.t.size, 'sample')} {same.size:,} have the time of the one before.",
            "A difference between such samples has no speed.",
            "Resample the log: `resample` keeps one sample of each time.",
        )  # fmt: skip
    gaps = np.flatnonzero(steps > 1.75 * step)
    if gaps.size:
        missing = float(np.sum(steps[gaps] / step - 1))
        longest = steps[gaps].max()
        grave = missing > 0.02 * run.t.size or longest > 20 * step
        yield finding(
            run, "gaps", "doubtful" if grave else "note", place, gaps + 1,
            f"About {counted(round(missing), 'sample')} missing at "
            f"{counted(gaps.size, 'place')}; the longest gap is {1000 * longest:.4g} ms, where "
            f"{1000 * step:.4g} ms are usual.",
            "Counted as samples, the motion looks faster there than it was.",
            "Resample by the times, and leave long gaps out.",
        )  # fmt: skip
    usual = steps[(steps > 0) & (steps <= 1.75 * step)]
    spread = float(usual.std() / step) if usual.size else 0.0
    if spread > 0.005:
        unit = _rounding(run.t, step)
        if unit and spread < 1.2 * unit / step:
            yield finding(
                run, "rounded time", "note", place, [],
                f"Times are rounded to {1000 * unit:.3g} ms, so steps of {1000 * step:.4g} ms "
                f"jump by {100 * unit / step:.0f} %.",
                "Speeds from single steps are wrong by as much.",
                "Resample with the mean step, as `resample` does.",
            )  # fmt: skip
        else:
            yield finding(
                run, "jitter", "doubtful" if spread > 0.2 else "note", place, [],
                f"Steps vary by {100 * spread:.2g} % (standard deviation) about "
                f"{1000 * step:.4g} ms.",
                "Filters for equal steps put as large an error on speeds.",
                "Resample by the times; ask whether they are of reading or of writing.",
            )  # fmt: skip


def _rounding(t, step) -> float:
    """The decimal unit that all times are multiples of, if it is more than 0.5 % of a step."""
    for digits in range(1, 7):
        unit = 10.0**-digits
        if unit < 0.005 * step:
            break
        if unit < step and np.abs(t / unit - np.round(t / unit)).max() < 1e-3:
            return unit
    return 0.0


def units(k: int, run: LoggedRun) -> Iterator[Finding]:
    """Units that cannot be right, by the size of steps, ranges and speeds."""
    step = usual_step(run.t)
    if not step or run.t.size < 10:
        return
    ranges = np.nanmax(run.q, 0) - np.nanmin(run.q, 0)
    steps = np.diff(run.t)
    with np.errstate(divide="ignore", invalid="ignore"):
        speed = np.abs(np.diff(run.q, axis=0)) / np.where(steps > 0, steps, np.nan)[:, None]
    speed = np.nanpercentile(speed, 98, axis=0)  # no single jump decides
    fastest, farthest = float(np.max(speed)), float(np.max(ranges))
    seen = f"The fastest joint moves {farthest:.3g} rad in all, at {fastest:.3g} rad/s."
    if farthest > 0.05 and fastest < SLOWEST * min(1.0, farthest):
        yield finding(
            run, "units of time", "wrong", (k, None), [],
            f"{seen} The step is {step:.4g} s.",
            "If the times are milliseconds, inertias come out a million times too large.",
            "Name the unit of the time: ms, us or ns.",
        )  # fmt: skip
    elif farthest > FARTHEST and fastest > 0.2 * FASTEST:
        yield finding(
            run, "units of angle", "wrong", (k, None), [],
            seen,
            "If these are degrees, inertias come out 57 times too small, and sines are of nothing.",
            "Name the unit of the angles: deg.",
        )  # fmt: skip
    elif fastest > FASTEST:
        yield finding(
            run, "units of time", "wrong", (k, None), [],
            f"{seen} The step is {step:.4g} s.",
            "No arm is as fast: inertias come out far too small.",
            "Check the unit of the time, and the rate.",
        )  # fmt: skip
    highest = np.nanmax(np.abs(run.tau), axis=0, initial=0.0)
    if highest.max() > HIGHEST:
        j = int(np.argmax(highest))
        yield finding(
            run, "units of torque", "doubtful", (k, j), [],
            f"The torque of the {JOINTS[j]} goes to {highest[j]:.4g} N m, as in few arms.",
            "If these are mA or N mm, inertias come out a thousand times too large.",
            "Name the unit of the torque: mA, with N m per A as its factor, or mNm.",
        )  # fmt: skip
