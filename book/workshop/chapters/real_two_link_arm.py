"""The lesson *A real two-link arm*: its numbers, figures, tables, and checks."""

from __future__ import annotations

from functools import cache

import numpy as np
from scipy.stats import t as student

from ddlib import figures, paper
from ddlib.tables import Table, quote
from workshop.chapters.exercises import judge
from workshop.report import results
from workshop.report.evidence.statements import stated
from workshop.report.evidence.verdicts import Measured, bootstrap

_NAMES = ("a", "b", "d", "g1", "g2", "r", "F_v1", "F_v2", "F_c1", "F_c2", "o1", "o2")
_MODELS = {
    "linear filter": "linear filter",
    "11": "window 11",
    "21": "window 21",
    "solved": "21, solver",
    "41": "window 41",
    "network": "tuned",
    "equations with filters": "equations, filters",
    "equations": "equations",
}


def _designs() -> dict:
    return results.read("two-link")["designs"]


def _published(design: str) -> np.ndarray:
    return np.array([_designs()[design]["published"][name] for name in _NAMES])


def _gravity(design: str, kind: str) -> np.ndarray:
    """Gravity of shoulder and elbow over the published one, by length, (lengths, 2)."""
    found = np.array(_designs()[design]["identified"]["by length"][kind])
    return found[:, 3:5] / _published(design)[3:5]


def _read(design: str, width: int, who: str) -> np.ndarray:
    """Moments, ([networks,] torque, joint, order)."""
    return np.array(_designs()[design]["read"][str(width)][who])


def _nulls(design: str) -> np.ndarray:
    return np.concatenate([_read(design, 41, kind) for kind in ("shifted", "other run")])


def _errors(design: str, model: str) -> np.ndarray:
    rows = _designs()[design]["predicted"]
    return np.array([row["errors"].get(model, row["by window"].get(model)) for row in rows])


@cache
def _inertia(width: int = 41) -> dict[str, np.ndarray]:
    """Inertia of each joint's own motion in ten networks of each design, (networks, 2)."""
    every = {design: _read(design, width, "networks") for design in _designs()}
    return {design: found[:, [0, 1], [0, 1], 2] for design, found in every.items()}


def _root(x) -> np.ndarray:
    return np.sqrt((x**2).mean(-1))


def predicts() -> Measured:
    """Error at window 21 on the run that was left out, all choices of runs of design A0."""
    each = _errors("A0", "21")
    text = f"{_root(each):.2f}, {each.min():.2f} to {each.max():.2f} in {len(each)} choices"
    return Measured(_root(each), text, bootstrap(_root, each))


def inertia_off() -> Measured:
    """Largest factor between the networks' inertia and the published one."""
    true = [_read(design, 41, "published")[[0, 1], [0, 1], 2] for design in _inertia()]

    def worst(*each):
        off = [np.abs(np.log(np.median(x, -2) / m)).max(-1) for x, m in zip(each, true)]
        return np.exp(np.max(off, axis=0))

    each = tuple(_inertia().values())
    value = float(worst(*each))
    return Measured(value, f"a factor of {value:.2f} at most", bootstrap(worst, *each))


def elbow_moves() -> Measured:
    """Elbow's inertia with the long forearm over that with the short one, the smaller of two."""

    def least(short, *long):
        return np.min([np.median(x, -1) for x in long], axis=0) / np.median(short, -1)

    each = [found[:, 1] for found in _inertia().values()]
    true = [_read(design, 41, "published")[1, 1, 2] for design in _inertia()]
    value = float(least(*each))
    text = f"{value:.2f} times; by the published parameters {min(true[1:]) / true[0]:.2f} times"
    return Measured(value, text, bootstrap(least, *each))


def _quoted() -> None:
    """The numbers of the prose."""
    short = [_gravity(design, "measured")[0, 0] for design in _designs()]
    quote("two-short-least", 100 * min(short))
    quote("two-short-most", 100 * max(short))
    quote("two-off", inertia_off().value)
    quote("two-moves", elbow_moves().value)
    true = [_read(design, 41, "published")[1, 1, 2] for design in _designs()]
    quote("two-moves-published", min(true[1:]) / true[0])
    middle = [[np.median(_errors(d, m)) for m in ("network", "equations")] for d in _designs()]
    network, equations = min(middle)
    quote("two-network-least", network)
    quote("two-equations-best", equations)
    sets = [row["moments"][0][0][2] for row in _designs()["A0"]["predicted"]]
    quote("two-sets-least", min(sets) / _read("A0", 41, "published")[0, 0, 2])
    quote("two-sets-most", max(sets) / _read("A0", 41, "published")[0, 0, 2])
    quote("two-solved-least", 100 * min(_solved("solved", 11)))
    quote("two-solved-most", 100 * max(_solved("solved", 11)))
    quote("two-known-least", 100 * min(_solved("solved, known", 11)))
    quote("two-solver-off", 100 * max(abs(share - 1) for share in _solved("solved", 41)))
    single = [x[:, 0, 0, 2] / true[0, 0, 2] for x, true in _each_solved("solved", 41)]
    quote("two-single-off", 100 * max(abs(x - 1).max() for x in single))
    longer = results.read("two-link-longer")
    quote("two-apart", longer["apart"][1])
    needed = [x["needed"][1][0] for x in longer["shaken"].values()]
    quote("two-needs-least", min(needed))
    quote("two-needs-most", max(needed))


def _longer(width: str, of) -> list[float]:
    """Shoulder's inertia over the published one in networks of a longer window, by design."""
    solved = results.read("two-link-longer")["solved"]
    true = {design: _read(design, 41, "published")[0, 0, 2] for design in solved}
    return [of(np.array(x[width])[:, 0, 0, 2]) / true[design] for design, x in solved.items()]


def _said() -> None:
    """What stands behind words of the prose."""
    ours = {m: [_errors(d, m) for d in _designs()] for m in ("network", "equations")}
    won = [x < y for x, y in zip(ours["equations"], ours["network"])]
    stated("two-equations-win", np.hstack(won).mean() > 0.95)
    less = [np.mean(x < _errors(d, "linear filter")) for x, d in zip(ours["network"], _designs())]
    stated("two-beats-linear", less[0] > 0.6 and less[2] > 0.6 and less[1] < 0.6)
    lost = [1 - _gravity(d, kind)[0, 0] for kind in ("measured", "wiggles") for d in _designs()]
    stated("two-wiggles-cost", bool((np.array(lost[3:]) > 0.6 * np.array(lost[:3])).all()))
    fast = list(results.read("two-link-longer")["shaken"].values())
    stated("two-not-rigid", min(x["needed"][1][0] / x["has"][1][0] for x in fast) > 7)
    error = results.read("two-link-longer")["turns"].index(12)
    stated("two-encoder", min(x["share"][error] for x in fast[:7]) > 0.2)
    stated("two-apart-more", results.read("two-link-longer")["apart"][1] > 0.15)
    shorter, longer = _longer("41", np.min), _longer("81", np.max)
    stated("two-longer-less", bool((np.array(longer) < shorter).all()))
    null = [
        max(np.abs(_nulls(d)[:, k, k, 2]).max() / _inertia()[d][:, k].min() for d in _designs())
        for k in (0, 1)
    ]
    stated("two-beyond-nulls", null[0] < 1)
    stated("two-elbow-nulls", null[1] > 1)
    linear = [_read(d, 41, "linear")[0, 0, 2] / np.median(_inertia()[d][:, 0]) for d in _designs()]
    stated("two-linear-blind", max(linear) < 0.25)
    gains = [[np.median(_inertia(w)[d][:, 0]) for w in (11, 21, 41)] for d in _designs()]
    stated("two-window-matters", bool((np.array(gains)[:, 0] < 0.3 * np.array(gains)[:, 2]).all()))


def _each_solved(who: str, width: int) -> list[tuple]:
    """Moments by the solver, and the published ones, of each design."""
    return [(_read(d, width, who), _read(d, width, "published")) for d in _designs()]


def _solved(who: str, width: int) -> list[float]:
    """Shoulder's inertia over the published one, by the solver, of each design."""
    pairs = _each_solved(who, width)
    return [np.median(found[:, 0, 0, 2]) / true[0, 0, 2] for found, true in pairs]


def _window_figure() -> figures.Illustration:
    """The first figure: gravity by window, of least squares and of networks."""
    x, colours = 10 * np.array(results.read("two-link")["lengths"]), figures.COLOURS

    def draw(figure):
        left, right = figure.subplots(1, 2, sharey=True)
        for k, (design, kept) in enumerate(_designs().items()):
            sure = student.ppf(0.975, len(kept["runs"]) - 1) / _published(design)[3]
            bars = sure * np.array(kept["identified"]["errors by length"])[:, 3]
            y = _gravity(design, "measured")[:, 0]
            left.errorbar(x + 3 * k, y, bars, color=colours[k], elinewidth=0.7, label=design)
            for width in (11, 21, 41):
                true = _read(design, width, "published")[0, 0, 0]
                looks = [("networks", ".", colours[k], 0), ("solved", "x", colours[k], 20)]
                looks += [("", "_", figures.FAINT, 0)] * (width == 41)
                for who, look, colour, aside in looks:
                    found = _read(design, width, who) if who else _nulls(design)
                    place = np.full(len(found), 10 * width + 6 * k + aside)
                    right.plot(place, found[:, 0, 0, 0] / true, look, color=colour, ms=4)
        for axis, title in ((left, "Least squares"), (right, "Networks of 1988")):
            axis.axhline(1, color=figures.INK, lw=0.7, ls="--")
            axis.set(title=title, xlabel="window, ms", ylabel="gravity, share")
        figures.legend_above(figure, *left.get_legend_handles_labels())

    told = "; ".join(
        design + ", ".join(f" {_gravity(design, 'measured')[at, 0]:.2f}" for at in (0, 6, -1))
        for design in _designs()
    )
    alt = (
        "The shoulder's gravity over that of the builders, by window. Least squares at 50, 210 and "
        f"450 ms: {told}. Networks rise from 110 to 410 ms; unrelated torques scatter about 0."
    )
    return figures.illustrate(draw, alt, 7.2, 2.4)


def _elbow_figure() -> figures.Illustration:
    """The elbow's inertia in the networks of three designs."""

    def draw(figure):
        axis = figure.subplots()
        looks = {"networks": ("o", 0), "exact": ("D", 2), "nulls": ("_", None)}
        labels = {"exact": "of known torques", "nulls": "of unrelated torques"}
        for k, design in enumerate(_designs()):
            for n, (who, (marker, colour)) in enumerate(looks.items()):
                found = _nulls(design) if who == "nulls" else _read(design, 41, who)
                place = np.full(len(found), k + 0.15 * (n - 1))
                ink = figures.FAINT if colour is None else figures.COLOURS[colour]
                label = labels.get(who, who) if k == 0 else None
                axis.plot(place, found[:, 1, 1, 2], marker, color=ink, ms=4, label=label)
            true = _read(design, 41, "published")[1, 1, 2]
            label = "builders" if k == 0 else None
            axis.hlines(true, k - 0.3, k + 0.3, color=figures.INK, lw=1, label=label)
        names = [f"{design}: {'short' if design == 'A0' else 'long'}" for design in _designs()]
        axis.set(ylabel="inertia, kg m²", xlabel="design and its forearm",
                 xticks=range(3), xticklabels=names)  # fmt: skip
        figures.legend_above(figure, *axis.get_legend_handles_labels())

    told = ", ".join(f"{design} {np.median(x[:, 1]):.3f}" for design, x in _inertia().items())
    true = ", ".join(f"{_read(d, 41, 'published')[1, 1, 2]:.3f}" for d in _designs())
    alt = (
        f"Elbow's inertia in networks: {told} kg m², builders {true}; "
        "unrelated torques scatter about 0."
    )
    return figures.illustrate(draw, alt, 6.0, 1.7)


def _spread(x) -> str:
    low, middle, high = np.percentile(x, (10, 50, 90))
    return f"{middle:.2f}\u00a0({low:.2f}\u2060–\u2060{high:.2f})"


def _errors_table() -> Table:
    """Errors on runs that were left out, by model and design, beside the report's."""
    surrogate = results.read("table-4-1")["setups"]["joint damping"]
    rows = []
    for model, name in _MODELS.items():
        cells = [_spread(_errors(design, model)) for design in _designs()]
        beside = ""
        if model.isdigit():
            ours = np.median(surrogate[model]["errors"]["test"])
            beside = f"{paper.TABLE_4_1[int(model)].test:.2f}, {ours:.2f}"
        rows.append((name, *cells, beside))
    return Table(("model", *_designs(), "printed, simulated"), rows)


_SHOWN = {"window": _window_figure, "elbow": _elbow_figure, "errors": _errors_table}


def show(name: str) -> figures.Illustration | Table:
    """A figure or table of the lesson or its evidence page."""
    return _SHOWN[name]()


def check(number: int, mine, gravity=None) -> None:
    """Judge an answer to an exercise of the lesson."""
    if number == 1:
        slips = [(0.25, "noise adds to the variance; it is not a share of the sum."),
                 (3, "the other way round.")]  # fmt: skip
        judge(mine, 1 / 3, "gravity shrinks with inertia.", slips, "Solve v / (v + n) = 0.75.")
    elif number == 2:
        right = gravity(5) / gravity(21)
        otherwise = "which joint's motor adds less to what gravity does?"
        judge(mine, right, "that close is no guess.", [], otherwise, 0.2)
    else:

        def near(pair):
            off = [np.abs(gravity(*pair, design) - 1).max() for design in ("A0", "C0", "C1")]
            return max(off) < 0.07

        told = "derivatives may be short if the equations are averaged."
        otherwise = "some design is more than 7 % off. Which window smooths what?"
        judge(mine, near, told, [], otherwise)
