"""The arm that swings in *Real arms*: its measures, numbers, figures and table."""

from __future__ import annotations

from functools import cache

import numpy as np
from scipy.stats import t as student

from ddlib import figures, paper
from ddlib.tables import Table
from workshop.report import results
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
    parameters = np.array(_designs()[design]["identified"]["by length"][kind])
    return parameters[:, 3:5] / _published(design)[3:5]


def _by(design: str, way: str) -> np.ndarray:
    """Gravity of shoulder and elbow over the published one by another way, (settings, 2)."""
    rows = results.read("two-link-instruments")["designs"][design][way]
    return np.array([row["values"][3:5] for row in rows]) / _published(design)[3:5]


def _read(design: str, width: int, who: str) -> np.ndarray:
    """Moments, ([networks,] torque, joint, order)."""
    return np.array(_designs()[design]["read"][str(width)][who])


def _nulls(design: str) -> np.ndarray:
    return np.concatenate([_read(design, 41, kind) for kind in ("shifted", "other run")])


def errors(design: str, model: str, runs: str = "runs") -> np.ndarray:
    """Errors of a model, one for each choice of training runs and each test run.

    Tests are the open-loop `runs` that were left out, one of them, or the "controlled" ones.
    """
    entry = _designs()[design]
    tests = entry.get(runs, (runs,))
    rows = [row for row in entry["predicted"] if row["test"] in tests]
    return np.array([row["errors"].get(model, row["by window"].get(model)) for row in rows])


@cache
def _inertia(width: int = 41) -> dict[str, np.ndarray]:
    """Inertia of each joint's own motion in ten networks of each design, (networks, 2)."""
    every = {design: _read(design, width, "networks") for design in _designs()}
    return {design: moments[:, [0, 1], [0, 1], 2] for design, moments in every.items()}


def _root(x) -> np.ndarray:
    return np.sqrt((x**2).mean(-1))


def predicts() -> Measured:
    """Error at window 21 on the run that was left out, all choices of runs of design A0."""
    each = errors("A0", "21")
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

    each = [moments[:, 1] for moments in _inertia().values()]
    true = [_read(design, 41, "published")[1, 1, 2] for design in _inertia()]
    value = float(least(*each))
    text = f"{value:.2f} times; by the published parameters {min(true[1:]) / true[0]:.2f} times"
    return Measured(value, text, bootstrap(least, *each))


def numbers() -> dict[str, float]:
    """The numbers of the lesson's prose."""
    short = [_gravity(design, "measured")[0, 0] for design in _designs()]
    tuned = {"linear": "linear filter", "network": "network", "equations": "equations"}
    middle = {
        f"{name}-{design}-{runs}": np.median(errors(design, model, runs))
        for name, model in tuned.items()
        for design in _designs()
        for runs in ("runs", "controlled")
    }
    true = {design: _read(design, 41, "published")[0, 0, 2] for design in _designs()}
    two_of_three = [
        row["moments"][0][0][2] / true[design]
        for design in ("C0", "C1")
        for row in _designs()[design]["predicted"]
    ]
    instruments = [100 * _by(design, "instruments")[0, 0] for design in _designs()]
    inertia = {f"inertia-short-{d}": np.median(_inertia(11)[d][:, 0]) / m for d, m in true.items()}
    elbow = {w: [np.median(x[:, 1]) for x in _inertia(w).values()] for w in (11, 41)}
    pairs = [row["moments"][1][1][2] for row in _designs()["C1"]["predicted"]]
    shares = {
        "short-most": 100 * max(short),
        "off": inertia_off().value,
        "moves": elbow_moves().value,
        "sets-least": min(two_of_three),
        "instruments-least": min(instruments),
        "instruments-most": max(instruments),
        "pairs-least": min(pairs) / elbow[41][0],
        "elbow-short-most": max(elbow[11][1:]) / elbow[11][0],
    }
    return shares | middle | inertia


def window_figure() -> figures.Illustration:
    """The first figure: gravity by window, of least squares and of networks."""
    x, colours = 10 * np.array(results.read("two-link")["lengths"]), figures.COLOURS

    def draw(figure):
        left, right = figure.subplots(1, 2, sharey=True)
        for k, (design, entry) in enumerate(_designs().items()):
            sure = student.ppf(0.975, len(entry["runs"]) - 1) / _published(design)[3]
            bars = sure * np.array(entry["identified"]["errors by length"])[:, 3]
            y = _gravity(design, "measured")[:, 0]
            left.errorbar(x + 3 * k, y, bars, color=colours[k], elinewidth=0.7, label=design)
            estimates = _by(design, "instruments")[:, 0]
            with_instruments = "with instruments" if k == 0 else None
            left.plot(x + 3 * k, estimates, ":", color=colours[k], label=with_instruments)
            for width in (11, 21, 41):
                true = _read(design, width, "published")[0, 0, 0]
                looks = [("networks", ".", colours[k], 0), ("solved", "x", colours[k], 20)]
                looks += [("", "_", figures.FAINT, 0)] * (width == 41)
                for who, look, colour, aside in looks:
                    estimates = _read(design, width, who) if who else _nulls(design)
                    place = np.full(len(estimates), 10 * width + 6 * k + aside)
                    right.plot(place, estimates[:, 0, 0, 0] / true, look, color=colour, ms=4)
        for axis, title in ((left, "Least squares"), (right, "Networks of 1988")):
            axis.axhline(1, color=figures.INK, lw=0.7, ls="--")
            axis.set(title=title, xlabel="window, ms", ylabel="gravity, share")
        figures.legend_above(figure, *left.get_legend_handles_labels())

    ratios = "; ".join(
        design + ", ".join(f" {_gravity(design, 'measured')[at, 0]:.2f}" for at in (0, 6, -1))
        for design in _designs()
    )
    alt = (
        "The shoulder's gravity over that of the builders, by window. Plain least squares at 50, "
        f"210 and 450 ms: {ratios}. With instruments (dotted) it is near 1 from 50 ms on, "
        "and above 1 with long windows. Networks rise from 110 to 410 ms; unrelated torques "
        "scatter about 0."
    )
    return figures.illustrate(draw, alt, 7.2, 2.4)


def elbow_figure() -> figures.Illustration:
    """The elbow's inertia in the networks of three designs."""

    def draw(figure):
        axis = figure.subplots()
        tones = {
            "networks": ("o", figures.TONES["network"]),
            "exact": ("D", figures.COLOURS[1]),
            "nulls": ("_", figures.FAINT),
        }
        labels = {"exact": "of known torques", "nulls": "of unrelated torques"}
        for k, design in enumerate(_designs()):
            for n, (who, (marker, colour)) in enumerate(tones.items()):
                moments = _nulls(design) if who == "nulls" else _read(design, 41, who)
                place = np.full(len(moments), k + 0.15 * (n - 1))
                label = labels.get(who, who) if k == 0 else None
                axis.plot(place, moments[:, 1, 1, 2], marker, color=colour, ms=4, label=label)
            true = _read(design, 41, "published")[1, 1, 2]
            label = "builders" if k == 0 else None
            axis.hlines(true, k - 0.3, k + 0.3, color=figures.INK, lw=1, label=label)
        names = [f"{design}: {'short' if design == 'A0' else 'long'}" for design in _designs()]
        axis.set(ylabel="inertia, kg m²", xlabel="design and its forearm",
                 xticks=range(3), xticklabels=names)  # fmt: skip
        figures.legend_above(figure, *axis.get_legend_handles_labels())

    medians = ", ".join(f"{design} {np.median(x[:, 1]):.3f}" for design, x in _inertia().items())
    true = ", ".join(f"{_read(d, 41, 'published')[1, 1, 2]:.3f}" for d in _designs())
    alt = (
        f"Elbow's inertia in networks: {medians} kg m², builders {true}; "
        "unrelated torques scatter about 0."
    )
    return figures.illustrate(draw, alt, 6.0, 1.7)


def _spread(x) -> str:
    low, middle, high = np.percentile(x, (10, 50, 90))
    return f"{middle:.2f}\u00a0({low:.2f}\u2060–\u2060{high:.2f})"


def errors_table() -> Table:
    """Errors on runs that were left out, by model and design, beside the report's."""
    surrogate = results.read("table-4-1")["setups"]["joint damping"]
    rows = []
    for model, name in _MODELS.items():
        cells = [
            _spread(errors(design, model, runs))
            for runs in ("runs", "controlled")
            for design in _designs()
        ]
        beside = ""
        if model.isdigit():
            ours = np.median(surrogate[model]["errors"]["test"])
            beside = f"{paper.TABLE_4_1[int(model)].test:.2f}, {ours:.2f}"
        rows.append((name, *cells, beside))
    controlled = (f"{design}, controlled" for design in _designs())
    return Table(("model", *_designs(), *controlled, "printed, simulated"), rows)
