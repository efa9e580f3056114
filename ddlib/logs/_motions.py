"""Findings by the equations of motion: sign, lag, how angles are counted, gravity, excitation.

Both sides are multiplied by bumps and integrated, so that no acceleration is computed (Shinbrot
1957; `ddlib.identification.by_modulation` says how). Each joint has friction and an offset.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from scipy.interpolate import BSpline
from scipy.signal import savgol_filter

from ddlib.logs._readings import lines_of_a_reading, unwrapped
from ddlib.logs._stamps import usual_step
from ddlib.logs._torques import at_rest, weak
from ddlib.logs.findings import JOINTS, Finding, finding
from ddlib.logs.log import LoggedRun
from ddlib.tables import significant

LEAST, MOST = 150, 6000  # equations of a joint, roughly: more tell a check nothing
ENOUGH = 120  # samples of a bump, up to twice as many
SHIFTS = np.arange(-8, 9)  # samples
GRAVITY = ("g1", "g2")
NAMES = ("a", "b", "d", "g1", "g2", "F_v1", "F_c1", "F_v2", "F_c2")


@dataclass(frozen=True)
class _Stretch:
    """An even piece of a run: its number, angles and torques (samples, 2)."""

    run: int
    q: np.ndarray
    tau: np.ndarray


@dataclass(frozen=True)
class _Averaged:
    """Equations under bumps: of each joint columns by name and torques by shift."""

    columns: tuple[dict, dict]
    torques: tuple[np.ndarray, np.ndarray]  #: Each (shifts, equations).
    block: np.ndarray  #: Which stretch of time an equation comes from.
    overlap: float  #: How many equations stand for one that is independent of the others.


def motions(runs: Sequence[LoggedRun]) -> Iterator[Finding]:
    """What the equations of motion show over all runs together."""
    step = float(np.median([usual_step(run.t) for run in runs] or [0.0]))
    stretches = _stretches(runs, step)
    width = _width(stretches, step)
    if not stretches or width < 12 or sum(len(s.q) for s in stretches) < 4 * width:
        yield finding(
            None, "too short", "note", (None, None), [],
            "There are too few samples of motion to compare torque and motion.",
            "Sign, lag and units of the torque are not checked.", "Record longer motions.",
        )  # fmt: skip
        return
    thinned = max(width // ENOUGH, 1)
    if _resting(stretches).all():
        return
    waits = float(np.median([lines_of_a_reading(run) for run in runs])) / thinned
    if thinned > 1:  # bumps do not need more samples
        stretches = [_Stretch(s.run, *_means((s.q, s.tau), thinned)) for s in stretches]
        width, step = width // thinned // 6 * 6, step * thinned
    equations = _averaged(stretches, width, step, lambda q: q, SHIFTS)
    if len(equations.block) < 40:
        return
    now = len(SHIFTS) // 2
    driven = [bool(np.ptp(np.concatenate([s.tau[:, j] for s in stretches]))) for j in range(2)]
    if not any(driven):
        return
    gravity = ("g1", "g2", "g1c", "g2c")
    with_gravity = _fit(equations, ("a", "b", "d", *gravity), now, driven)
    without = _fit(equations, ("a", "b", "d"), now, driven)
    weight = list(_gravity(with_gravity, without, driven))
    yield from weight
    rigid = ("a", "b", "d", *gravity)
    # a torque that is hardly more than noise says nothing of its sign
    idle = [all(weak(run, j) for run in runs) for j in range(2)]
    works = [driven[j] and not idle[j] for j in range(2)]
    others = []
    if works == driven:
        others = list(_other_readings(stretches, width, step, rigid, driven, with_gravity))
        yield from others
    if not others and any(works):
        if works == driven:
            yield from _lag(equations, rigid, driven, step, thinned, waits, bool(weight))
        yield from _signs(equations, gravity, works)
    yield from _excitation(stretches, equations, width, step, driven, with_gravity, bool(weight))


def _stretches(runs, step) -> list[_Stretch]:
    """Pieces of the runs without gaps, wraps or missing samples, on the usual step."""
    pieces = []
    for k, run in enumerate(runs):
        good = np.isfinite(run.q).all(-1) & np.isfinite(run.tau).all(-1) & np.isfinite(run.t)
        t, q, tau = run.t[good], run.q[good], run.tau[good]
        if t.size < 24:
            continue
        forward = np.concatenate([[True], t[1:] > np.maximum.accumulate(t)[:-1]])
        t, q, tau = t[forward], q[forward], tau[forward]
        if t.size < 24:
            continue
        q = np.stack([unwrapped(q[:, j]) for j in range(2)], -1)
        for part in np.split(np.arange(t.size), np.flatnonzero(np.diff(t) > 6 * step) + 1):
            if part.size < 24:
                continue
            grid = np.arange(t[part[0]], t[part[-1]] + 0.01 * step, step)
            if np.abs(np.diff(t[part]) / step - 1).max() < 1e-3:
                pieces.append(_Stretch(k, q[part], tau[part]))
            else:
                even = [
                    np.stack([np.interp(grid, t[part], x[part, j]) for j in range(2)], -1)
                    for x in (q, tau)
                ]
                pieces.append(_Stretch(k, *even))
    return pieces


def _means(series, count: int) -> list[np.ndarray]:
    """Series (samples, 2) as means of `count` samples."""
    whole = len(series[0]) // count * count
    return [x[:whole].reshape(-1, count, 2).mean(1) for x in series]


def _width(stretches, step) -> int:
    """Samples of a bump: two thirds of the motion's own period, a multiple of six."""
    if not stretches:
        return 0
    speed = size = 0.0
    for s in stretches:
        smooth = savgol_filter(s.q, min(15, len(s.q) // 2 * 2 - 1), 2, axis=0)
        speed = speed + np.sum(np.diff(smooth, axis=0) ** 2, 0)
        size = size + np.sum((smooth - smooth.mean(0)) ** 2, 0)
    moving = speed > 1e-12 * size.max() if size.max() else np.zeros(2, bool)
    if not moving.any():
        return 0
    period = 2 * np.pi * np.sqrt(size[moving] / speed[moving]).min()  # samples
    longest = max(len(s.q) for s in stretches) // 4
    return int(min(max(0.67 * period, 18), longest) // 6) * 6


def _averaged(stretches, width, step, reading: Callable, shifts, smoothing=4) -> _Averaged:
    """Equations under bumps of `width` samples, with angles read in some way."""
    place = np.arange(1, width) * (6.0 / width)
    shape = BSpline.basis_element(np.arange(7), extrapolate=False)
    knot = width / 6 * step
    w = shape(place)
    w /= w.sum()
    scale = shape(place).sum()
    w1 = shape.derivative()(place) / (knot * scale)
    w2 = shape.derivative(2)(place) / (knot**2 * scale)
    total = sum(len(s.q) for s in stretches)
    hop = max(min(width // 6, total // LEAST), total // MOST, 1)
    edge = int(np.max(np.abs(shifts)))
    columns, torques, blocks = ({}, {}), ([], []), []
    smooth = max(5, width // smoothing | 1)
    block = 0
    for s in stretches:
        if len(s.q) < width + 2 * edge + hop:
            continue
        q = reading(s.q)
        v = savgol_filter(q, smooth, 2, 1, step, axis=0)
        level = savgol_filter(q, smooth, 2, axis=0)

        def under(x, weights):
            windows = sliding_window_view(x[edge : len(x) - edge], len(weights), axis=0)[::hop]
            return windows @ weights

        q1, q2, v1, v2 = q[:, 0] - q[0, 0], q[:, 1] - q[0, 1], v[:, 0], v[:, 1]
        c2, s2 = np.cos(level[:, 1]), np.sin(level[:, 1])
        both = level.sum(-1)
        weight, weight_c = under(np.sin(both), w), under(np.cos(both), w)
        zero = np.zeros_like(weight)
        usual = np.sqrt(np.mean(v**2, 0)) + 1e-12
        shoulder = {
            "cos": under(c2, w),
            "a": under(q1, w2),
            "b": under(s2, w2) - 2 * under(c2 * v1, w1),
            "d": under(q2, w2),
            "g1": under(np.sin(level[:, 0]), w), "g1c": under(np.cos(level[:, 0]), w),
            "g2": weight, "g2c": weight_c,
            "F_v1": -under(q1, w1), "F_c1": under(np.tanh(v1 / (0.1 * usual[0])), w),
            "F_v2": zero, "F_c2": zero,
        }  # fmt: skip
        elbow = {
            "a": zero,
            "b": under(s2 * v1 * (v1 + v2), w) - under(c2 * v1, w1),
            "d": under(q1 + q2, w2),
            "g1": zero, "g1c": zero, "g2": weight, "g2c": weight_c,
            "F_v1": zero, "F_c1": zero,
            "F_v2": -under(q2, w1), "F_c2": under(np.tanh(v2 / (0.1 * usual[1])), w),
        }  # fmt: skip
        for place_of, one in zip(columns, (shoulder, elbow)):
            for name, column in one.items():
                place_of.setdefault(name, []).append(column)
        for j in range(2):
            shifted = [
                sliding_window_view(s.tau[edge + k : len(q) - edge + k, j], len(w))[::hop] @ w
                for k in shifts
            ]
            torques[j].append(np.stack(shifted))
        blocks.append(block + np.arange(zero.size) * 4 // zero.size)
        block += 4
    if not blocks:
        return _Averaged(({}, {}), (np.empty((1, 0)),) * 2, np.empty(0, int), 1.0)
    columns = tuple({name: np.concatenate(x) for name, x in one.items()} for one in columns)
    return _Averaged(
        columns,
        tuple(np.concatenate(x, -1) for x in torques),
        np.concatenate(blocks),
        width / (2 * hop),
    )


def _matrices(equations: _Averaged, rigid: Sequence[str], driven, keep=slice(None)):
    """Regressor of each driven joint: shared parameters, own friction and offset."""
    out = []
    for j in range(2):
        if not driven[j]:
            continue
        own = [equations.columns[j][name][keep] for name in rigid]
        count = own[0].size
        for i in range(2):
            for name in (f"F_v{i + 1}", f"F_c{i + 1}"):
                own.append(equations.columns[j][name][keep])
            own.append(np.full(count, float(i == j)))
        out.append((j, np.stack(own, -1)))
    return out


@dataclass(frozen=True)
class _Fit:
    """A fit of all driven joints together: parameters, what is left, each joint's noise."""

    values: np.ndarray
    left: np.ndarray  #: Variance left over of each joint, N^2 m^2; NaN without a torque.
    size: np.ndarray  #: Variance of each joint's torque.

    @property
    def share(self) -> float:
        """What is left of the torques: geometric mean over joints of the root of the share."""
        shares = self.left / self.size
        return float(np.exp(0.5 * np.nanmean(np.log(shares + 1e-14))))


def _fit(equations, rigid, shift, driven, keep=slice(None), rounds=3) -> _Fit:
    """Least squares with a weight for each joint by what it leaves over."""
    parts = _matrices(equations, rigid, driven, keep)
    torques = {j: equations.torques[j][shift][keep] for j, _ in parts}
    size = np.full(2, np.nan)
    for j, _ in parts:
        size[j] = torques[j].var()
    sigma, left = np.sqrt(size), size
    values = np.zeros(0)
    for _ in range(rounds):
        a = np.concatenate([m / sigma[j] for j, m in parts])
        y = np.concatenate([torques[j] / sigma[j] for j, _ in parts])
        norm = np.linalg.norm(a, axis=0)
        norm[norm == 0] = 1.0
        values = np.linalg.lstsq(a / norm, y, rcond=1e-7)[0] / norm
        left = np.full(2, np.nan)
        for j, m in parts:
            left[j] = np.mean((torques[j] - m @ values) ** 2)
        # a joint that is fitted by chance must not take all weight
        sigma = np.sqrt(np.maximum(left, 1e-4 * size))
    return _Fit(values, left, size)


def _gravity(with_gravity: _Fit, without: _Fit, driven) -> Iterator[Finding]:
    """Whether torques that only the pose explains are there."""
    explained = 1 - with_gravity.left / np.where(without.left > 0, without.left, np.nan)
    share = (without.left - with_gravity.left) / without.size
    seen = [j for j in range(2) if driven[j] and explained[j] > 0.5 and share[j] > 0.002]
    if seen:
        names = " and ".join(JOINTS[j] for j in seen)
        parts = ", ".join(f"{100 * explained[j]:.0f} %" for j in seen)
        yield finding(
            None, "gravity", "note", (None, None), [],
            f"Torques that depend on the pose explain {parts} of what the {names} would otherwise "
            "leave over: the arm seems to carry weight.",
            "Without it inertias and frictions are wrong.",
            "If the arm hangs, add `GRAVITY` to the names of the parameters, with angles from the "
            "vertical. A spring or a cable looks alike: these names do not hold it.",
        )  # fmt: skip


_READINGS = (
    (
        "elbow angle",
        "the elbow's angle were counted from a fixed direction, not from the upper arm",
        "Take q2 - q1 for the elbow's angle.",
        lambda q: np.stack([q[:, 0], q[:, 1] - q[:, 0]], -1), None,
    ),
    (
        "sign of the elbow",
        "the elbow's angle and torque were counted the other way round than the shoulder's",
        "Change the sign of the elbow's angle and of its torque.",
        lambda q: q * [1.0, -1.0], (1.0, -1.0),
    ),
    (
        "sign of a torque",
        "the sign of one joint's torque were wrong",
        "Change the sign of the torque of one joint.",
        lambda q: q, (1.0, -1.0),
    ),
    (
        "order of the joints",
        "the torques of the two joints were exchanged",
        "Exchange the columns of the torques.",
        lambda q: q, None,
    ),
    (
        "units of angle",
        "the angles were degrees",
        "Name the unit of the angles: deg.",
        np.deg2rad, None,
    ),
)  # fmt: skip


def _other_readings(stretches, width, step, rigid, driven, as_is: _Fit) -> Iterator[Finding]:
    """Whether the equations hold better if angles or torques are read in another way."""
    best = (as_is.share, None)
    for kind, words, advice, angles, signs in _READINGS:
        if kind != "units of angle" and _resting(stretches).any():
            continue
        changed, works = stretches, driven
        if kind == "order of the joints":
            changed = [_Stretch(s.run, s.q, s.tau[:, ::-1]) for s in stretches]
            works = driven[::-1]
        elif signs:
            changed = [_Stretch(s.run, s.q, s.tau * signs) for s in stretches]
        equations = _averaged(changed, width, step, angles, np.array([0]))
        fit = _fit(equations, rigid, 0, works)
        if fit.share < best[0] * 0.999 and fit.values[0] > 0:
            best = (fit.share, (kind, words, advice))
    share, reading = best
    if reading is None or share > 0.75 * as_is.share or as_is.share < 0.02:
        return
    kind, words, advice = reading
    yield finding(
        None, kind, "wrong" if share < 0.5 * as_is.share else "doubtful", (None, None), [],
        f"The equations leave {100 * as_is.share:.1f} % of the torques over; they would leave "
        f"{100 * share:.1f} % if {words}.",
        "Nothing that is fitted to these columns describes the arm.", advice,
    )  # fmt: skip


def _resting(stretches) -> np.ndarray:
    """Which joints rest in all stretches, (2,)."""
    q = np.concatenate([s.q - s.q[0] for s in stretches])
    return at_rest(LoggedRun("", np.arange(len(q)), q, q, None))


def _lag(equations, rigid, driven, step, thinned, waits, heavy) -> Iterator[Finding]:
    """The shift of the torque that fits the motion best, with its uncertainty by blocks of time.

    A reading stays for `waits` samples; half of that is no lag, as a torque is held so long.
    """
    blocks = np.unique(equations.block)
    groups = np.array_split(blocks, min(8, blocks.size))
    middle = _fit(equations, rigid, len(SHIFTS) // 2, driven)
    matrices = _matrices(equations, rigid, driven)
    sigma = np.sqrt(np.maximum(middle.left, 1e-4 * middle.size))
    weighted = [(j, m / sigma[j], equations.torques[j].T / sigma[j]) for j, m in matrices]

    def best(keep) -> float:
        a = np.concatenate([m[keep] for _, m, _ in weighted])
        y = np.concatenate([torque[keep] for _, _, torque in weighted])
        basis = np.linalg.qr(a / (np.linalg.norm(a, axis=0) + 1e-300))[0]
        left = y - basis @ (basis.T @ y)
        ends = np.cumsum([len(m[keep]) for _, m, _ in weighted])[:-1]
        left = np.prod([np.mean(x**2, 0) for x in np.split(left, ends)], axis=0)
        left **= 1 / len(weighted)
        k = int(np.argmin(left))
        if k in (0, len(SHIFTS) - 1):
            return float(SHIFTS[k])
        low, mid, high = left[k - 1 : k + 2]
        return float(SHIFTS[k] + 0.5 * (low - high) / (low - 2 * mid + high))

    lag = best(slice(None))
    parts = np.array([best(~np.isin(equations.block, group)) for group in groups])
    n = len(parts)
    error = float(np.sqrt((n - 1) / n * np.sum((parts - parts.mean()) ** 2)))
    # friction is no smooth step, and a torque is held from reading to reading
    error = np.hypot(error, 0.12 * max(waits, 1.0))
    now = middle.share
    at = _fit(equations, rigid, int(np.clip(np.round(lag), -8, 8)) + 8, driven).share
    least = (0.6 if lag > 0 else 0.8) * max(thinned * waits, 1.0)  # a hold alone is 0.5 early
    if thinned * abs(lag) < least or abs(lag) < 4 * error or at > 0.9 * now:
        return
    which = "later" if lag > 0 else "earlier"
    margin = f" ± {2 * thinned * error:.1f}"
    if abs(lag) == SHIFTS[-1]:  # no later one was tried
        margin = " or more"
    yield finding(
        None, "lag", "wrong" if at < 0.5 * now else "doubtful", (None, None), [],
        f"The torque fits the motion best if it is read {thinned * abs(lag):.1f}{margin} samples "
        f"({1000 * abs(lag) * step:.3g} ms) {which}; {100 * now:.1f} % of it are left over now, "
        f"{100 * at:.1f} % then.",
        "A torque that is logged late adds to the damping: inertia times delay times the square of "
        "the motion's frequency; an early one takes as much away.",
        "Look for a filter or a queue between the two columns, and shift one. Friction and "
        "backlash that the equations lack look alike, so before you do "
        + ("record a free swing." if heavy else "push the resting arm: which column moves first?"),
    )  # fmt: skip


def _signs(equations, gravity, driven) -> Iterator[Finding]:
    """The inertia of each joint as it alone tells it: a positive torque must accelerate.

    That is the mean of the mass matrix's entry, ``a + 2 b cos(q2)`` or ``d``, the other joint's
    acceleration being known: a joint that is held still gives way to the other's torque.
    """
    for j in range(2):
        if not driven[j]:
            continue
        columns = equations.columns[j]
        names = ("a", "b", "d") if j == 0 else ("d", "b")
        own = [*(columns[n] for n in (*names, *gravity))]
        own += [columns[f"F_v{j + 1}"], columns[f"F_c{j + 1}"], np.ones(own[0].size)]
        a, y = np.stack(own, -1), equations.torques[j][len(SHIFTS) // 2]
        inertia = np.zeros(a.shape[1])
        inertia[0] = 1.0
        if j == 0:
            inertia[1] = 2 * columns["cos"].mean()
        norm = np.linalg.norm(a, axis=0)
        norm[norm == 0] = 1.0
        basis, size, ways = np.linalg.svd(a / norm, full_matrices=False)
        ways, basis = ways[size > 1e-3 * size[0]], basis[:, size > 1e-3 * size[0]]
        size = size[: len(ways)]
        seen = ways @ (inertia / norm)
        left = y - basis @ (basis.T @ y)
        slope = float(seen / size @ (basis.T @ y))
        error = 2 * np.sqrt(equations.overlap * left.var()) * np.linalg.norm(seen / size)
        lost = np.linalg.norm(inertia / norm - ways.T @ seen)
        if lost > 0.1 * np.linalg.norm(inertia / norm):
            continue
        matters = y.std() > 2 * left.std()
        if slope < -4 * error and matters:
            yield finding(
                None, "sign of the torque", "wrong", (None, j), [],
                f"A positive torque of the {JOINTS[j]} slows it down: its inertia would be "
                f"{slope:.3g} kg m^2.",
                "Inertias come out negative.",
                "Change the sign of the torque, or of the angle, of both joints if both are so.",
            )  # fmt: skip
        elif matters and not 1e-6 < slope < 1e4 and slope > 4 * error:
            yield finding(
                None, "units of torque", "wrong", (None, j), [],
                f"The inertia of the {JOINTS[j]} would be {slope:.3g} kg m^2.",
                "No arm of this kind exists.",
                "Check the units of time (ms?), angle (deg?) and torque (mN m, A?).",
            )  # fmt: skip


def _excitation(stretches, equations, width, step, driven, fit, heavy) -> Iterator[Finding]:
    """Which parameters the motion tells, judged by noise of torques and of readings."""
    rigid = ("a", "b", "d", *GRAVITY)
    parts = _matrices(equations, rigid, driven)
    names = [*rigid, "F_v1", "F_c1", "offset 1", "F_v2", "F_c2", "offset 2"]
    sigma = np.sqrt(np.maximum(fit.left, 1e-8 * fit.size))
    a = np.concatenate([m / sigma[j] for j, m in parts])
    rng = np.random.default_rng(0)
    spread = np.concatenate([np.diff(s.q, 4, axis=0) for s in stretches]).std(0) / np.sqrt(70)
    noisy = [_Stretch(s.run, s.q + spread * rng.standard_normal(s.q.shape), s.tau)
             for s in stretches]  # fmt: skip
    # columns that only noise or smoothing tells apart are the same
    again = _averaged(noisy, width, step, lambda q: q, SHIFTS, 2 if width < 24 else 7)
    b = np.concatenate([m / sigma[j] for j, m in _matrices(again, rigid, driven)])
    norm = np.linalg.norm(a, axis=0)
    felt = norm > 0
    scaled, change = a[:, felt] / norm[felt], (b - a)[:, felt] / norm[felt]
    _, size, vectors = np.linalg.svd(scaled, full_matrices=False)
    noise = np.linalg.norm(change @ vectors.T, axis=0) + 1e-7
    sure = size**2 > 3 * noise**2  # as least_squares judges
    kept = vectors[sure] / size[sure, None]
    errors = np.sqrt(equations.overlap) * np.linalg.norm(kept, axis=0) / norm[felt]
    unsure = np.abs(vectors[~sure]).max(0, initial=0.0) > 0.2
    of = dict(zip(np.array(names)[felt], zip(errors, unsure)))
    scale = dict(zip(names, _by_name(fit)))
    measurable, nothing, lost = [], [], []
    for name in NAMES:
        if name in GRAVITY and not heavy:
            continue
        error, mixed = of.get(name, (np.inf, True))
        value = abs(scale[name])
        if mixed:
            lost.append(name)
        elif error > 0.25 * value:
            nothing.append(name)
        else:
            measurable.append(f"{name} to {significant(max(200 * error / value, 0.1), 1)} %")
    seen = f"The motion tells {', '.join(measurable) or 'no parameter by itself'}."
    seen += f" Not told apart from zero: {', '.join(nothing)}." if nothing else ""
    seen += f" It does not tell one by one: {', '.join(lost)}." if lost else ""
    advice = "Nothing to do. The percentages are rough, and a fit mostly does better."
    if lost:
        advice = f"Leave {' or '.join(lost)} out, or move so that they matter apart."
    if not measurable:
        advice = "Record longer motions in which both joints speed up and slow down, each its way."
    yield finding(
        None, "excitation", "doubtful" if lost or not measurable else "note", (None, None), [],
        seen, "What a motion does not tell comes out at random, and spoils the rest.", advice,
    )  # fmt: skip


def _by_name(fit: _Fit) -> np.ndarray:
    """Parameters of a fit with both kinds of gravity, without the cosines' share."""
    values = fit.values.copy()
    values[3:5] = np.hypot(values[3:5], values[5:7])
    return np.concatenate([values[:5], values[7:]])
