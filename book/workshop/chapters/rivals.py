"""The lesson *Rivals then and now*: its figure, numbers and checks; errors by seed and day."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure

from ddlib.figures import COLOURS, FAINT, Illustration, check_label, illustrate
from ddlib.figures.style import NARROW
from ddlib.tables import quote
from workshop.beyond._measures.rivals import better, row
from workshop.chapters.exercises import Between, judge
from workshop.report import results
from workshop.report.evidence.statements import stated

_RUBBING, _PARTS = "linear filter with friction", ("trajectory 6", "inside", "outside")
_TOLD = {
    "identified": "equations",
    "filters and equations": "learnt filters",
    "structure and process": "equations and process",
    "on states": "network on states",
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
            errors, look = np.asarray(rivals[name][0], float), COLOURS[int(name == marked)]
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


def _errors(name: str, part: str = "trajectory 6") -> np.ndarray:
    return np.array(_tuned()[name]["errors"][part])


def show(_name: str = "errors") -> Illustration:
    """Error on trajectory 6 and stored numbers of every rival, tuned alike."""
    marked = results.read("tuned")["reference"]
    shown = {}
    for name, one in _tuned().items():
        errors, count = _errors(name), np.median(one["count"])
        shown[_TOLD.get(name, name)] = errors, f"{np.median(errors):.3f}", f"{count:,.0f}"
    order = sorted(shown, key=lambda name: np.median(shown[name][0]))
    told = "; ".join(f"{name} {shown[name][1]}, {shown[name][2]} numbers" for name in order)
    floor = results.read("rivals")["floor"]["positions"]["trajectory 6"]
    labels = "error on trajectory 6, RMSS", "error", "numbers"
    return _dots(shown, marked, floor, labels, f"Rivals by their median error: {told}.")


def _over(name: str, part: str = "trajectory 6", against: str = "network of 1988") -> np.ndarray:
    """A rival's error over another's, day by day."""
    a, b = _errors(name, part), _errors(against, part)
    days = min(len(a), len(b))
    return a[:days] / b[:days]


def _quoted() -> None:
    """The numbers of the prose."""
    study, untuned = results.read("tuned"), row("network of 1988", size=10)
    named = {"network": study["reference"], "linear": "linear filter", "filters": study["own"],
             "rubbing": _RUBBING, "planes": "local planes",
             "identified": "identified", "recurrent": "recurrent"}  # fmt: skip
    for short, name in named.items():
        quote(f"rivals-{short}", np.median(_errors(name)))
    for end, value in (("least", np.min), ("most", np.max)):
        quote(f"rivals-network-{end}", value(_errors(study["reference"])))
        quote(f"rivals-linear-{end}", value(_over("linear filter")))
    won = _over("Lagrangian network") < 1
    quote("rivals-lagrangian-won", int(won.sum()))
    quote("rivals-lagrangian-days", len(won))
    quote("rivals-recurrent-training", np.median(_errors("recurrent", "training")))
    quote("rivals-network-untuned", np.median(untuned["errors"]["trajectory 6"]))
    for short, name in (("identified", "identified"), ("nearest", "nearest case")):
        quote(f"rivals-ratio-{short}", np.median(_over(name)))
    quote("rivals-times-nearest", np.median(_tuned()["nearest case"]["count"]) / study["budget"])
    for part in ("inside", "outside"):
        quote(f"rivals-{part}", np.median(_over("linear filter", part)))
    for part in _PARTS:
        fewer, all_of_them = better(part).text.split(":")[0].split(" of ")
        quote(f"rivals-better-{part}" if part != "trajectory 6" else "rivals-better", int(fewer))
    quote("rivals-within", int(all_of_them))


def _said() -> None:
    """What stands behind words of the prose."""
    study = results.read("tuned")
    stated("rivals-equations-ahead", _over("identified").max() < 0.8)
    draw = _over("linear filter")
    stated("rivals-linear-draws", draw.min() < 1 < draw.max())
    hull = [_over("linear filter", part).max() for part in ("inside", "outside")]
    stated("rivals-linear-hull", max(hull) < 1)
    stated("rivals-memory-behind", _over("nearest case").min() > 1)
    within = [n for n, one in _tuned().items() if one["within"] and n != study["own"]]
    clear = {name for name in within if _over(name).max() < 1}
    stated("rivals-clearly", clear == {"identified", "table of configurations", _RUBBING})
    stated("rivals-rubbing-ahead", max(_over(_RUBBING, part).max() for part in _PARTS) < 0.9)
    stated("rivals-planes-ahead", _over("local planes").max() < 1)
    networks = {name for name in within if np.median(_over(name)) < 1} & {
        "on states",
        "second-order steps",
    }
    stated("rivals-networks-among", len(networks) == 2)
    cells = [setting[1] for setting in _tuned()["table of configurations"]["setting"]]
    stated("rivals-one-cell", set(cells) == {1})
    stated("rivals-recurrent-behind", _over("recurrent").min() > 1)
    turned = [better(part).value > better().value for part in ("inside", "outside")]
    stated("rivals-square-turns", all(turned))
    others = [name for name in within if name != study["reference"] and name not in clear]
    stated("rivals-others-not", all(_over(name).max() > 1 for name in others))


def tested(rival: str, part: str = "torque", split: str = "loader") -> np.ndarray:
    """Errors of a rival on the test characters, one for each seed: squares, in (N m)²."""
    rows = results.read("characters")["rivals"][split][rival]["test"]
    return np.array([row[part] for row in rows])


def asked(process: str, part: str = "trajectory 6", what: str = "covered") -> np.ndarray:
    """What ``gaussian-intervals`` found each day: the share covered, or the "rmss"."""
    rows = results.read("gaussian-intervals")["processes"][process][part]
    return np.array([row[what] for row in rows])


def check(number: int, mine, *asked) -> None:
    """Judge an answer to an exercise of the lesson."""
    if number == 1:
        slips = [(0.2, "that is the share that is lost."),
                 (0.25, "that is the penalty over the variance.")]  # fmt: skip
        judge(mine, 0.8, "small inputs lose most.", slips, "Set the slope in w' to zero.")
    elif number == 2:
        near = Between(0.5 * np.array(asked), 2 * np.array(asked))
        told = "form carries over what free weights cannot know."
        judge(mine, near, told, [], "one of them hardly minds, the other is lost.")
    else:
        (with_these,) = asked

        def few(kept):
            return len(set(kept)) == 5 and with_these(kept) <= 1.5

        otherwise = "without which columns does nothing accelerate rightly?"
        judge(mine, few, "one friction term a joint is nearly enough.", [], otherwise)
