"""The lesson *Rivals then and now*: its figures, numbers and checks; errors by seed and day."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from beyond.measures.rivals import better, row
from beyond.rivals.bases import Polynomial
from beyond.rivals.cmac import CMAC
from beyond.rivals.identified import Identified, Linear
from beyond.rivals.protocol import Cases
from beyond.rivals.tables import CellTable
from beyond.studies.checks.smoothers import CUTOFFS
from ddlib.figures import (
    COLOURS,
    FAINT,
    Illustration,
    check_label,
    illustrate,
)
from ddlib.figures.style import DASHES, INK, JOINTS, NARROW, TONES
from ddlib.setups import JOINT_DAMPING
from ddlib.simulation import LOG_STEP
from ddlib.tables import Table, quote
from workshop.chapters.exercises import Between, Exercise, judging
from workshop.report import committed, results

_RUBBING, _PARTS = "linear filter with friction", ("trajectory 6", "inside", "outside")
_BESIDE = {
    "nearest case": "most similar cases",
    "local planes": "plane through the nearest third",
    "linear filter": "linear filter",
    _RUBBING: "filter with friction",
    "identified": "equations",
    "filters and equations": "equations with learnt filters",
    "Butterworth filter": "equations after a Butterworth filter",
    "Kalman smoother": "equations after a Kalman smoother",
    "equations and networks": "equations and ensemble",
    "networks on states": "ensemble on states",
    "recurrent": "recurrent network",
    "network of 1988": "network of 1988",
}
_SMOOTHED = {
    "learnt": "filters and equations",
    "butterworth": "Butterworth filter",
}
_ELSEWHERE = {
    "equations": "identified",
    "linear filter with friction": _RUBBING,
}
_LABELS = {
    "identified": "equations",
    "filters and equations": "learnt filters",
    "Butterworth filter": "Butterworth, equations",
    "Kalman smoother": "Kalman, equations",
    "structure and process": "equations and process",
    "on states": "network on states",
    "networks on states": "ensemble on states",
    "equations and networks": "equations and ensemble",
    "recurrent": "recurrent network",
}


def _dots(
    rivals: Mapping[str, tuple], marked: str, floor: float, labels: tuple, alt: str
) -> Illustration:
    """Errors of rivals on a logarithmic axis, the least on top: the median, and least to largest.

    Of ``{rival: (errors, text, ...)}`` the texts stand in columns on the right, headed by
    ``labels[1:]``; a narrow page leaves them out.
    """
    order = sorted(rivals, key=lambda name: np.median(rivals[name][0]))
    places = np.arange(len(order))

    def draw(figure: Figure):
        wide = figure.get_figwidth() > NARROW
        axis, *beside = np.atleast_1d(
            figure.subplots(1, 1 + wide, sharey=True, width_ratios=(2.9, 1)[: 1 + wide])
        )
        axis.set(xscale="log", ylim=(len(order) - 0.4, -0.6), xlabel=check_label(labels[0]))
        axis.axvline(floor, color=FAINT, ls=":", lw=1.4)
        for k, name in enumerate(order):
            errors, look = (
                np.asarray(rivals[name][0], float),
                TONES["network"] if name == marked else INK,
            )
            axis.plot([errors.min(), errors.max()], [k, k], color=look, lw=1.4)
            axis.plot(np.median(errors), k, "D" if name == marked else "o", color=look, ms=5)
        axis.set_yticks(places, [check_label(name) for name in order])
        axis.tick_params(axis="y", length=0)
        axis.grid(axis="y", color=FAINT, lw=0.4, alpha=0.5)
        axis.minorticks_off()
        axis.set_xticks((0.03, 0.1, 0.3, 1.0), ("0.03", "0.1", "0.3", "1"))
        for words in beside:
            words.set_axis_off()
            for column, label in enumerate(labels[1:], 1):
                x = column / (len(labels) - 1)
                words.text(x, -0.8, label, ha="right", va="bottom")
                for k, name in enumerate(order):
                    words.text(x, k, rivals[name][column], ha="right", va="center")

    return illustrate(draw, alt, 7.0, 0.2 * len(order) + 0.7)


def _tuned() -> dict:
    return results.read("tuned")["rivals"]


def smoothed(arm: str = "the report's arm") -> dict:
    """What ``smoothers`` found on an arm: two smoothers and filters that are learnt, by name."""
    return results.read("smoothers")["arms"][arm]["ways"]


def learnt_over() -> list[np.ndarray]:
    """Errors of learnt filters over a Butterworth filter's: on the square, then on two arms."""
    places = [("the report's arm", "inside"), ("the report's arm", "outside")]
    places += [("vertical", "trajectory 6"), ("coarse encoder", "trajectory 6")]
    ratios = []
    for arm, part in places:
        ways = smoothed(arm)
        mine, other = (
            np.array(ways[name]["errors"][part])
            for name in ("filters and equations", "Butterworth filter")
        )
        ratios.append(mine / other)
    return ratios


def inertias_off(way: str, arm: str = "the report's arm") -> np.ndarray:
    """How far the three inertias are from the true ones, as shares, (days, 3)."""
    return np.array(smoothed(arm)[way]["off"])[:, :3]


@cache
def _entered() -> dict:
    """All rivals that were tuned, with errors, stored numbers and settings tried, by day."""
    names = results.read("smoothers")["arms"]["the report's arm"]["names"]
    more = {
        name: {"errors": one["errors"], "count": [len(names) + 1], "tried": [len(CUTOFFS)]}
        for name, one in smoothed().items()
        if name not in _tuned()
    }
    for name, days in _today()["rivals"].items():
        errors = {part: [day["errors"][part] for day in days] for part in days[0]["errors"]}
        kept = {key: [day[key] for day in days] for key in ("count", "tried")}
        more[name] = {"errors": errors, **kept}
    return _tuned() | more


def _today() -> dict:
    return results.read("tuned-today")


def elsewhere_table() -> Table:
    """Errors of some rivals on trajectory 6 and on circles, and how sure ensembles are of both."""
    rows = []
    for name, errors in _today()["circles"].items():
        six = np.median(_errors(_ELSEWHERE[name]))
        rows.append((_BESIDE[_ELSEWHERE[name]], f"{six:.3f}", f"{np.median(errors):.3f}", "–", "–"))
    for name in ("networks on states", "equations and networks"):
        days = [day["circles"] for day in _today()["rivals"][name]]
        told = {k: [np.median([d[part][k] for d in days]) for part in ("trajectory 6", "circles")]
                for k in ("rmss", "covered")}  # fmt: skip
        errors = [f"{x:.3f}" for x in told["rmss"]]
        rows.append((_BESIDE[name], *errors, *(f"{100 * x:.0f} %" for x in told["covered"])))
    heads = "trajectory 6", "circles", "inside its 95 %, trajectory 6", "on circles"
    return Table(("rival", *heads), rows)


def _errors(name: str, part: str = "trajectory 6") -> np.ndarray:
    return np.array(_entered()[name]["errors"][part])


def ratios_table() -> Table:
    """Errors of some rivals over the network's, on trajectory 6 and on the square, and counts."""
    rows = []
    for name, label in _BESIDE.items():
        cells = []
        for part in _PARTS:
            ratios = over(name, part)
            cells.append(f"{np.median(ratios):.2f} ({ratios.min():.2f} to {ratios.max():.2f})")
        one = _entered()[name]
        stored, tried = (f"{np.median(one[key]):,.0f}" for key in ("count", "tried"))
        rows.append((label, *cells, stored, tried))
    heads = "trajectory 6", "in the hull", "outside", "numbers stored", "settings tried"
    return Table(("rival", *heads), rows)


def errors_figure() -> Illustration:
    """Errors of every rival, tuned alike, and stored numbers."""
    marked = results.read("tuned")["reference"]
    shown = {}
    for name, one in _entered().items():
        errors, stored = _errors(name), np.median(one["count"])
        shown[_LABELS.get(name, name)] = errors, f"{np.median(errors):.3f}", f"{stored:,.0f}"
    order = sorted(shown, key=lambda name: np.median(shown[name][0]))
    medians = "; ".join(f"{name} {shown[name][1]}, {shown[name][2]} numbers" for name in order)
    floor = results.read("rivals")["floor"]["positions"]["trajectory 6"]
    labels = "error on trajectory 6, RMSS", "error", "numbers"
    return _dots(shown, marked, floor, labels, f"Rivals by their median error: {medians}.")


# --- how each rival of 1988 comes from a window to a torque

_WIDTH, _MOMENT = 21, 60  # samples of the window; sample of trajectory 6 that all are asked for
_SIGNED = LinearSegmentedColormap.from_list("signed", (COLOURS[2], "#d9d9d9", COLOURS[0]))
_QUANTITIES = ("1", "q₁", "v₁", "a₁", "q₂", "v₂", "a₂")


@cache
def _learnt() -> tuple[Cases, Cases]:
    """Windows of the five training motions, and of trajectory 6."""
    recording = committed.recording(JOINT_DAMPING.name)
    return Cases.windows(recording[:-1], _WIDTH), Cases.windows(recording[-1:], _WIDTH)


def _elbow(cases: Cases) -> Cases:
    """The elbow's angle and velocity alone, which is as much as a page can draw."""
    x = cases.estimated().x[:, 1:].copy()
    x[..., 2] = 0.0
    return Cases(x, cases.torque[:, 1:], "states", cases.step)


def _plane(axis: Axes, low, high, asked) -> None:
    """Trajectory 6 and its moment in the elbow's angle and velocity."""
    path = np.rad2deg(asked.x[:, 0, :2])
    axis.plot(*path.T, color=INK, lw=0.8)
    axis.plot(*path[_MOMENT], "o", color=INK, ms=5, mec=FAINT)
    (x0, y0), (x1, y1) = np.rad2deg(low[:2]), np.rad2deg(high[:2])
    axis.set(xlim=(x0, x1), ylim=(y0, y1), xlabel="elbow's angle, °", ylabel="velocity, °/s")
    axis.grid(False)


def _draw_table(axis: Axes) -> None:
    known, asked = map(_elbow, _learnt())
    cell_table = CellTable(12).fit(known)
    low, high = cell_table.low[0], cell_table.high[0]
    edges = [np.rad2deg(np.linspace(a, b, cell_table.cells + 1)) for a, b in zip(low[:2], high[:2])]
    torque = np.full((cell_table.cells, cell_table.cells), np.nan)
    torque[cell_table.filled[:, 1], cell_table.filled[:, 0]] = cell_table.coefficients[:, 0, 0]
    most = np.nanquantile(abs(torque), 0.95)
    axis.pcolormesh(*edges, torque, cmap=_SIGNED, vmin=-most, vmax=most, ec=FAINT, lw=0.3)
    _plane(axis, low, high, asked)
    axis.set_title("Table: look it up")


def _draw_cmac(axis: Axes) -> None:
    known, asked = map(_elbow, _learnt())
    cmac = CMAC(4, 0.4, epochs=1).fit(known)
    low, high = np.rad2deg([cmac.low[0, :2], cmac.high[0, :2]])
    here = (np.rad2deg(asked.x[_MOMENT, 0, :2]) - low) / (high - low)
    size = cmac.width * (high - low)
    for layer in range(cmac.layers):
        shift = layer / cmac.layers
        corner = low + (np.floor(here / cmac.width + shift) - shift) * size
        look = dict(color=COLOURS[layer], lw=0.6, alpha=0.6)
        for k in range(4):
            axis.axvline(low[0] + (k - shift) * size[0], **look)
            axis.axhline(low[1] + (k - shift) * size[1], **look)
        axis.add_patch(Rectangle(corner, *size, fc=COLOURS[layer], alpha=0.28))
        axis.add_patch(Rectangle(corner, *size, fill=False, ec=COLOURS[layer], lw=1.6))
    _plane(axis, cmac.low[0], cmac.high[0], asked)
    axis.set_title("CMAC: add four cells")


def _draw_polynomial(axis: Axes) -> None:
    known = _learnt()[0].estimated()
    polynomial = Polynomial(2, "monomials", ridge=1e-4).fit(known)
    cells = np.full((7, 7), np.nan)
    for powers, value in zip(polynomial.exponents, polynomial.coefficients[:, 1]):
        factors = np.repeat(np.arange(1, 7), powers)
        second, first = sorted([0, 0, *factors])[-2:]
        cells[first, second] = value
    most = np.nanmax(abs(cells))
    axis.pcolormesh(cells, cmap=_SIGNED, vmin=-most, vmax=most, ec=FAINT, lw=0.3)
    axis.set(xticks=np.arange(7) + 0.5, yticks=np.arange(7) + 0.5, xlabel="first factor")
    axis.set(xticklabels=_QUANTITIES, yticklabels=_QUANTITIES, ylabel="second factor")
    axis.invert_yaxis()
    axis.grid(False)
    axis.tick_params(length=0)
    axis.set_title("Polynomial: products")


def _draw_filter(axis: Axes) -> None:
    linear = Linear().fit(_learnt()[0])
    milliseconds = 1000 * LOG_STEP * (np.arange(_WIDTH) - _WIDTH // 2)
    for j, weights in enumerate(linear.matrix[:, 1].reshape(2, _WIDTH)):
        axis.plot(milliseconds, weights, DASHES[j], color=TONES[JOINTS[j]], label=JOINTS[j])
    axis.axhline(0, color=FAINT, lw=0.6)
    axis.set(xlabel="time in the window, ms", ylabel="weight, N m/rad")
    axis.legend(loc="lower left", handlelength=1.2, fontsize=8, borderaxespad=0.1)
    axis.set_title("Filter: weigh angles")


def _draw_equations(axis: Axes) -> None:
    known, asked = (cases.estimated() for cases in _learnt())
    parameters = Identified().fit(known).parameters()
    (_, v1, a1), (q2, v2, a2) = asked.x[_MOMENT]
    bars = {
        "b": parameters["b"] * (np.cos(q2) * a1 + np.sin(q2) * v1**2),
        "d": parameters["d"] * (a1 + a2),
        "viscous": parameters["F_v2"] * v2,
        "Coulomb": parameters["F_c2"] * np.sign(v2),
    }
    left = np.cumsum([0.0, *bars.values()])
    rows = np.arange(len(bars) + 1)
    axis.barh(rows[:-1], list(bars.values()), left=left[:-1], color=FAINT, height=0.6)
    axis.barh(rows[-1], left[-1], color=INK, height=0.6)
    axis.axvline(0, color=FAINT, lw=0.6)
    axis.set(yticks=rows, yticklabels=[*bars, "sum"], xlabel="elbow's torque, N m")
    axis.invert_yaxis()
    axis.grid(axis="y", visible=False)
    axis.tick_params(axis="y", length=0)
    axis.set_title("Equations: known terms")


def _draw_network(axis: Axes) -> None:
    model = results.median_network(_WIDTH, JOINT_DAMPING.name)
    weights, window = model.weights, _learnt()[1].x[_MOMENT : _MOMENT + 1]
    activity = weights.activity(model.scaled(window))[0].ravel()
    out = weights.output_weights.reshape(2, -1)[1]
    units = np.linspace(0.05, 0.95, len(activity))
    centred = window[0] - window[0].mean(-1, keepdims=True)
    for j, angles in enumerate(centred):
        x = np.linspace(0, 0.45, _WIDTH) + 0.55 * j
        axis.plot(x, 0.1 + 0.08 * angles / abs(centred).max(), ".", color=TONES[JOINTS[j]], ms=3)
        axis.text(x.mean(), -0.03, f"{JOINTS[j]}", ha="center", va="top", fontsize=8.5)
        for unit in units:
            axis.plot([x.mean(), unit], [0.2, 0.52], color=FAINT, lw=0.5, alpha=0.7)
        axis.plot([x.mean(), 0.5], [0.2, 1.0], "--", color=TONES["network"], lw=0.9, alpha=0.7)
    for unit, weight in zip(units, out / abs(out).max()):
        look = dict(color=TONES["network"], lw=0.6 + 2 * abs(weight))
        axis.plot([unit, 0.5], [0.52, 1.0], "-" if weight > 0 else ":", **look)
    look = dict(cmap="Greys_r", vmin=-0.1, vmax=1.1, ec=INK, zorder=3)
    axis.scatter(units, np.full(len(units), 0.52), s=70, c=activity, **look)
    axis.plot(0.5, 1.0, "o", color=INK, ms=8)
    axis.text(0.56, 1.0, "elbow's torque", va="center", fontsize=8.5)
    axis.set(xlim=(-0.03, 1.03), ylim=(-0.15, 1.1))
    axis.set_axis_off()
    axis.set_title("Network: bend, add up")


def from_window_to_torque() -> Illustration:
    """How six rivals come from one moment of trajectory 6 to the elbow's torque."""
    known = _draw_table, _draw_cmac, _draw_polynomial
    pictures = *known, _draw_filter, _draw_equations, _draw_network

    def draw(figure: Figure):
        for axis, picture in zip(figure.subplots(2, 3).ravel(), pictures):
            picture(axis)

    alt = (
        "Six pictures. A table: squares of angle and velocity, coloured where a training motion "
        "passed; trajectory 6 runs through empty ones, too. CMAC: four shifted grids, and the one "
        "cell of each in which a moment lies. A polynomial: a triangle of products of two "
        "quantities, coloured by their coefficients. A linear filter: a curve of weights for each "
        "joint. Equations: four bars that add up to the elbow's torque. A network: two windows, "
        "ten hidden units, one output, and direct weights past the units."
    )
    return illustrate(draw, alt, 7.2, 4.7)


def over(name: str, part: str = "trajectory 6", against: str = "network of 1988") -> np.ndarray:
    """A rival's error over another's, day by day."""
    a, b = _errors(name, part), _errors(against, part)
    days = min(len(a), len(b))
    return a[:days] / b[:days]


def _quoted() -> None:
    """The numbers of the prose."""
    study, untuned = results.read("tuned"), row("network of 1988", size=10)
    for short, name in (("network", study["reference"]), ("recurrent", "recurrent")):
        quote(f"rivals-{short}", np.median(_errors(name)))
    medians = {name: np.median(_errors(name)) for name in _entered()}
    quote("rivals-ahead-all", sum(x < medians[study["reference"]] for x in medians.values()))
    for end, value in (("least", np.min), ("most", np.max)):
        quote(f"rivals-network-{end}", value(_errors(study["reference"])))
    for short, name in _SMOOTHED.items():
        quote(f"rivals-{short}", np.median(_errors(name)))
    quote("rivals-lead-least", 100 * (1 - max(np.median(ratio) for ratio in learnt_over())))
    learnt, butterworth = (
        np.median(np.abs(inertias_off(way)).max(1)) for way in (study["own"], "Butterworth filter")
    )
    quote("rivals-off-times", learnt / butterworth)
    of_late_sensor = smoothed("late sensor")[study["own"]]
    quote("rivals-late-applied", np.median(of_late_sensor["applied"]["trajectory 6"]))
    beside = [day["circles"]["circles"] for day in _today()["rivals"]["equations and networks"]]
    quote("rivals-beside-circles", np.median([day["rmss"] for day in beside]))
    quote("rivals-beside-covered", 100 * np.median([day["covered"] for day in beside]))
    quote("rivals-equations-circles", np.median(_today()["circles"]["equations"]))
    quote("rivals-network-untuned", np.median(untuned["errors"]["trajectory 6"]))
    ahead = [better(part).text.split(":")[0].split(" of ") for part in _PARTS]
    (six, every), (inside, _), (outside, _) = ahead
    quote("rivals-better", int(six))
    quote("rivals-within", int(every))
    elsewhere = "as well as outside" if inside == outside else f"and {outside} outside"
    quote(
        "rivals-better-square", f"{inside} of these {every} are ahead inside the hull, {elsewhere}"
    )


def tested(rival: str, part: str = "torque", split: str = "loader") -> np.ndarray:
    """Errors of a rival on the test characters, one for each seed: squares, in (N m)²."""
    rows = results.read("characters")["rivals"][split][rival]["test"]
    return np.array([row[part] for row in rows])


def asked(process: str, part: str = "trajectory 6", what: str = "covered") -> np.ndarray:
    """What ``gaussian-intervals`` found each day: the share covered, or the "rmss"."""
    rows = results.read("gaussian-intervals")["processes"][process][part]
    return np.array([row[what] for row in rows])


def _exercise(number: int, *asked) -> Exercise:
    """An exercise of the lesson."""
    if number == 1:
        slips = [
            (0.2, "that is the share that is lost."),
            (0.25, "that is the penalty over the variance."),
            (0.75, "the penalty is a quarter of the variance, not of their sum."),
        ]
        return Exercise(
            "number", 0.8, "small variances lose most.", slips, "Set the slope in w' to zero."
        )
    elif number == 2:
        near = Between(0.5 * np.array(asked), 2 * np.array(asked))
        reason = "a known form carries over, free weights do not."
        return Exercise(
            "numbers", near, reason, [], "one error hardly grows, the other one grows a lot."
        )
    else:
        (with_these,) = asked

        def few(kept):
            return len(set(kept)) == 5 and with_these(kept) <= 1.5

        otherwise = "without which columns does nothing accelerate rightly?"
        return Exercise(
            "numbers",
            few,
            "one friction term a joint is nearly enough.",
            [],
            otherwise,
            count=5,
            whole=True,
        )


check = judging(_exercise)
