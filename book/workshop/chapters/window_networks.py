"""What the lesson *Window networks* quotes and judges, and what its evidence page draws."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure

from ddlib import paper
from ddlib.figures.maps import SIGNS, rmss_by_window
from ddlib.figures.style import (
    FAINT,
    Illustration,
    illustrate,
    legend_above,
    looks,
    plain_ticks,
)
from ddlib.learning import (
    TrainingSet,
    Weights,
    cases,
    default_rate,
    train_ensemble,
)
from ddlib.metrics import rmss
from ddlib.setups import JOINT_DAMPING, SETUPS, WINDOWS, split
from ddlib.simulation import LOG_STEP
from ddlib.tables import Table, how_many, quote, significant
from workshop.chapters.exercises import Between, Exercise, OneOf, judging
from workshop.chapters.widgets.window import HiddenTorque
from workshop.report import results
from workshop.report.evidence import claims

_KINDS = ("training", "test")
_NEAR = 1.5  # factor within which a median counts as that of the paper
_CELLS = [(what, w) for what in _KINDS for w in WINDOWS]
_PRINTED = {what: {w: getattr(paper.TABLE_4_1[w], what) for w in WINDOWS} for what in _KINDS}


def _errors() -> dict:
    """RMSS of the book's networks: ``{reading: {column: {window: errors}}}``."""
    days, cells = results.read("recordings")["setups"], results.read("table-4-1")["setups"]

    def of(name, what, w):
        cell = days[name][str(w)] if name in days else cells[name][str(w)]["errors"]
        return np.ravel(cell[what])

    return {
        name: {what: {w: of(name, what, w) for w in WINDOWS} for what in _KINDS} for name in SETUPS
    }


def hidden_torque() -> HiddenTorque:
    """A window that slides over the shoulder's or the elbow's path on trajectory 6."""
    return HiddenTorque(split(JOINT_DAMPING.record())[1])


_READINGS = {
    "damped joints": "-damping",
    "damped by the controller": "",
    "hardly damped": "-position",
}


def table_4_1() -> Table:
    """Table 4-1 as printed, beside medians and 95 % intervals of the book's networks.

    Bold: within a factor of 1.5 of what is printed.
    """
    rows = []
    for what, w in _CELLS:
        row = [f"{what}, {w}", significant(_PRINTED[what][w], 2)]
        for ending in _READINGS.values():
            measured = claims.measured(f"table-4-1-{what}-{w}{ending}")
            ends = np.quantile(measured.replicates, (0.025, 0.975))
            middle, low, high = (significant(x, 2) for x in (measured.value, *ends))
            near = abs(np.log(measured.value / _PRINTED[what][w])) <= np.log(_NEAR)
            row.append(f"{f'**{middle}**' if near else middle} ({low} to {high})")
        rows.append(row)
    return Table(("motions, window", "printed in 1988", *_READINGS), rows)


def figure_4_1() -> Illustration:
    """Measured torque of the shoulder on trajectory 6, and a network's, for the three windows.

    The networks with damped joints whose test error is the median; printed and own RMSS in titles.
    """
    test = split(JOINT_DAMPING.record())[1]
    time, panels = test.t[test.motion], {}
    for w in WINDOWS:
        inputs, torque = cases(test, w)
        predicted = results.median_network(w, JOINT_DAMPING.name).torque(inputs)
        printed, own = (significant(x, 2) for x in (_PRINTED["test"][w], rmss(predicted, torque)))
        panels[f"window {w}: RMSS {printed} printed, {own} here"] = torque[:, 0], predicted[:, 0]

    def draw(figure: Figure):
        axes = figure.subplots(len(panels), 1, sharex=True, sharey=True)
        for axis, (title, both) in zip(axes, panels.items()):
            for (name, look), y in zip(looks(["measured", "network"]).items(), both):
                axis.plot(time, y, label=name, **look.line)
            axis.set(title=title, ylabel="N m")
        axes[-1].set_xlabel("time, s")
        legend_above(figure, *axes[0].get_legend_handles_labels())

    alt = f"Measured torque of the shoulder, and a network's upon it. {'; '.join(panels)}."
    return illustrate(draw, alt, 7.0, 5.0)


def order_medians() -> dict[int, float]:
    """Median test errors by window, with damped joints."""
    return {w: claims.measured(f"table-4-1-test-{w}-damping").value for w in WINDOWS}


def errors_by_reading() -> Illustration:
    """The printed errors and those of all networks, under the three readings."""
    return rmss_by_window(_errors(), _PRINTED)


def _schooled(width: int, slower: tuple[float, ...], members: int = 5):
    """The lesson's networks of a window size, at parts of its step: epochs and training errors."""
    data = TrainingSet.from_recording(split(JOINT_DAMPING.record())[0], width, scaling=(0, 1))
    start = Weights.random(members, width, initial=JOINT_DAMPING.initial)
    many = Weights.concatenate([start] * len(slower))
    rate = default_rate(width) * np.repeat(slower, members)
    how = {"rate": rate, "momentum": 0.98, "warm_up": 500, "epochs": 4000, "progress": False}
    run = train_ensemble(many, data, **how)[1]
    return run.epochs, run.training.reshape(len(run.epochs), len(slower), members)


def _steepest(width: int, every: int = 50) -> tuple[np.ndarray, np.ndarray]:
    """Epochs, and step size times the error's largest curvature, along the first network's way."""
    import torch

    data = TrainingSet.from_recording(split(JOINT_DAMPING.record())[0], width, scaling=(0, 1))
    x = torch.tensor(data.x.reshape(len(data.x), -1))
    y, rng = torch.tensor(data.y), torch.Generator().manual_seed(0)
    first = Weights.random(1, width, initial=JOINT_DAMPING.initial)[0]
    parts = (
        first.hidden_weights.reshape(-1, x.shape[1]),
        first.hidden_bias,
        first.output_weights,
        first.direct_weights.reshape(-1, x.shape[1]),
        first.output_bias,
    )
    w = [torch.tensor(part).requires_grad_() for part in parts]
    axes = [torch.randn(part.shape, generator=rng, dtype=part.dtype) for part in w]
    last = [torch.zeros_like(part) for part in w]
    rate, steepness, epochs = default_rate(width), [], []
    for epoch in range(1, 4001):
        h = torch.sigmoid(x @ w[0].T + w[1])
        error = (torch.sigmoid(h @ w[2].T + x @ w[3].T + w[4]) - y).square().sum() / (2 * len(x))
        look = epoch % every == 0
        slopes = torch.autograd.grad(error, w, create_graph=look)
        for _ in range(10 * look):  # power iteration; it goes on where the last one ended
            size = sum(a.square().sum() for a in axes).sqrt()
            axes = [a / size for a in axes]
            along = sum((s * a).sum() for s, a in zip(slopes, axes))
            turned = torch.autograd.grad(along, w, retain_graph=True)
            curvature = float(sum((t * a).sum() for t, a in zip(turned, axes)))
            axes = list(turned)
        if look:
            steepness.append(rate * curvature)
            epochs.append(epoch)
        share = 0.5 if epoch <= 500 else 0.98
        with torch.no_grad():
            for part, step, slope in zip(w, last, slopes):
                step.mul_(share).sub_(rate * slope)
                part.add_(step)
    return np.array(epochs), np.array(steepness)


def unsteady() -> Illustration:
    """Training at window 11, at the lesson's step and at a quarter; its steepest curvature."""
    parts = {"the lesson's step": 1.0, "a quarter": 0.25}
    epochs, errors = _schooled(11, tuple(parts.values()))
    at, steep = _steepest(11)
    bound = 2 * (1 + 0.98)
    look = looks([*parts, "largest that is stable"])
    quote("window-quarter-end", np.median(errors[-1, 1]))

    def draw(figure: Figure):
        left, right = figure.subplots(1, 2)
        for k, name in enumerate(parts):
            for error in errors[:, k].T:
                left.plot(epochs, error, lw=0.8, **look[name].line)
            left.plot([], [], label=name, **look[name].line)
        left.set(xlabel="epoch", ylabel="training RMSS", yscale="log")
        right.plot(at, steep, **look[next(iter(parts))].line)
        right.axhline(bound, label="largest that is stable", **look["largest that is stable"].line)
        right.set(xlabel="epoch", ylabel="step × curvature", ylim=(0, None))
        plain_ticks(left.yaxis)
        named = [axis.get_legend_handles_labels() for axis in (left, right)]
        legend_above(figure, *(a + b for a, b in zip(*named)))

    alt = (
        "Left: training errors of five networks of window 11 that jump up again and again, and "
        "of five that fall slowly. Right: step times curvature, which grows to the bound, falls "
        "and grows again."
    )
    return illustrate(draw, alt, 7.0, 2.6)


def _bends() -> tuple[np.ndarray, np.ndarray]:
    """How far a window's path on trajectory 6 sags below the line of its ends; the torque."""
    test = split(JOINT_DAMPING.record())[1]
    windows, torque = cases(test, 21)
    share = np.linspace(0, 1, windows.shape[-1])
    line = windows[..., :1] * (1 - share) + windows[..., -1:] * share
    return (line - windows).mean(-1), torque


def _worst(name: str) -> float:
    """By what factor a reading's medians are off the printed errors at most, up or down."""
    off = [np.median(_errors()[name][what][w]) / _PRINTED[what][w] for what, w in _CELLS]
    return float(np.exp(np.abs(np.log(off)).max()))


def _quoted() -> None:
    """Numbers of the lesson's prose."""
    live = results.read("page-training")
    reached = live["rows"]["as printed, real"]  # epochs of the page's events, if they came
    direct, error = (
        np.nan_to_num(np.array(reached[event], float), nan=np.inf) for event in ("direct", "error")
    )
    quote("window-live-first", how_many(int((direct < error).sum()), live["members"]))
    quote("window-live-level", live["level"])
    shifted = live["rows"]["as printed, shifted"]
    quote("window-live-shifted", np.median(shifted["test"]))
    quote("window-live-named", 100 * np.mean(shifted["named"]))
    bends, torque = _bends()
    quote("window-bend-sign", 100 * (np.sign(bends) == np.sign(torque)).mean())
    for w in WINDOWS:
        weights = Weights.random(1, w)[0].count()
        quote(f"window-rule-{w}", 2 * w * JOINT_DAMPING.hidden)
        quote(f"window-count-{w}", weights)
        quote(f"window-passes-{w}", 1500 * weights)
    quote("window-worst", _worst(JOINT_DAMPING.name))
    quote("window-worst-state", _worst("state feedback"))


def _exercise(number: int, *given) -> Exercise:
    """An exercise; what is given comes from the lesson's open cells."""
    if number == 1:
        window, hidden = given
        direct, biases = 4 * window, hidden + 2
        right = hidden * (2 * window + 2) + direct
        slips = (
            (right + biases, "you counted the biases, too. Leave them out."),
            (right - direct, "the inputs also lead straight to the outputs."),
            (right - hidden * window - direct // 2, "each joint has a window of its own."),
        )
        return Exercise(
            "number",
            right,
            "weights lead from inputs to hidden units, from these to outputs, and straight across.",
            slips,
            "count each of the three bundles of the figure, dots included.",
            1e-9,
        )
    elif number == 2:
        (left,) = given
        most = paper.TABLE_4_1[21].test
        small = [w for w in range(1, 50, 2) if 2 * (2 * w + 1) < 50]
        right = OneOf(*(w for w in small if left(w) < most))
        slips = (
            (OneOf(*small), "this window is small enough, but its error is too large."),
            (Between(-np.inf), "the window must be odd, and its weights must be fewer."),
        )
        return Exercise(
            "number",
            right,
            "no hidden unit, and the error is below 0.10.",
            slips,
            tolerance=1e-9,
        )
    elif number == 4:
        x, torque, own = given
        half = x.shape[1] // 4  # samples on either side
        shoulder, elbow = (
            (each[:, 0] - 2 * each[:, half] + each[:, -1]) / (half * LOG_STEP) ** 2
            for each in np.split(x, 2, axis=1)
        )

        def inertia(a, joint):
            return a @ torque[:, joint] / (a @ a)

        right = inertia(shoulder, 0)
        slips = (
            (
                right / (half * LOG_STEP) ** 2,
                "this is torque per bend. Scale it to acceleration.",
            ),
            (right / half**2, "the ends are n samples from the middle, not one."),
            (right / 2, "the bend is a (n Δt)², without a factor of a half."),
            (inertia(elbow, 1), "this is the elbow's."),
            (own, "this is the arm's own. What do three positions of the window find?"),
            (np.polyfit(shoulder, torque[:, 0], 1)[0], "fit without a constant."),
        )
        return Exercise(
            "number",
            right,
            f"three positions weigh it roughly. The arm's own mean is {own:.1f} kg m².",
            slips,
            "divide the bend by (n Δt)², and find the multiple by least squares.",
            unit="kg m²",
        )
    else:
        factor = given[0] / given[1]
        reason = f"the error is {factor:.0f} times as large, about as for a guess of the mean."
        word = "larger" if factor > 2 else "smaller" if factor < 0.5 else "alike"
        return Exercise(
            "word",
            word,
            reason,
            otherwise="along which of the two paths did this torque drive the arm?",
            options=("smaller", "alike", "larger"),
        )


check = judging(_exercise)


def intervals(
    panels: Mapping[str, Mapping[str, Mapping[str, tuple]]],
    x_label: str,
    alt: str,
    *,
    log: bool = False,
    band: tuple[float, float] | None = None,
) -> Illustration:
    """Panels of rows, each with a point and an interval for every series."""
    rows = list(dict.fromkeys(r for series in panels.values() for s in series.values() for r in s))
    tones = looks(name for series in panels.values() for name in series)

    def draw(figure: Figure):
        axes = figure.subplots(1, len(panels), sharex=True, sharey=True, squeeze=False)[0]
        for axis, (title, series) in zip(axes, panels.items()):
            if band is not None:
                axis.axvspan(*band, color=FAINT, alpha=0.2, lw=0)
            for k, (name, points) in enumerate(series.items()):
                offset = (k - (len(series) - 1) / 2) * 0.6 / len(series)
                for row, (low, middle, high) in points.items():
                    y = rows.index(row) + offset
                    axis.plot([low, high], [y, y], color=tones[name].colour, lw=1.6)
                    axis.plot([middle], [y], SIGNS[k], color=tones[name].colour, ms=5, label=name)
            axis.set_yticks(range(len(rows)), rows)
            axis.set_ylim(len(rows) - 0.5, -0.5)
            axis.set(xlabel=x_label, title=title, xscale="log" if log else "linear")
            axis.grid(False, axis="y")
            if log:
                plain_ticks(axis.xaxis)
        named = {}
        for axis in axes:
            named |= dict(zip(*reversed(axis.get_legend_handles_labels())))
        if len(named) > 1:
            legend_above(figure, list(named.values()), list(named))

    return illustrate(draw, alt, 7.0, 1.1 + 0.33 * len(rows))


def effects(design, logs, count: int) -> tuple[np.ndarray, float]:
    """Factors by which `count` quantities move each error from their low end to their high one.

    Main effects of a screening design, shape (count, errors), on errors given as logarithms, shape
    (runs, errors). The largest factor of the columns that are left over, which move nothing, is
    the second value.
    """
    slopes = design.T @ logs / (design**2).sum(0)[:, None]
    factors = np.exp(2 * slopes)
    return factors[:count], float(np.exp(2 * np.abs(slopes[count:])).max())
