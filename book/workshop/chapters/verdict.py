"""The ledger's picture: verdicts by section of the paper."""

from __future__ import annotations

from collections.abc import Mapping

from matplotlib.figure import Figure

from ddlib.figures import COLOURS, FAINT, INK, Illustration, illustrate, legend_above

# How a bar's parts look, in the order of the verdicts
_LOOKS = (
    {"color": COLOURS[2]},
    {"color": COLOURS[0], "alpha": 0.75},
    {"color": COLOURS[1]},
    {"color": COLOURS[3], "alpha": 0.75},
    {"facecolor": f"{COLOURS[2]}33", "edgecolor": COLOURS[2], "lw": 1},
    {"facecolor": "none", "edgecolor": FAINT, "lw": 1},
)

_DIGIT = 5.4  # Width of a digit in a bar, points


def verdicts(counts: Mapping[str, Mapping[str, int]]) -> Illustration:
    """Verdicts by section: one bar each below its title, a part for every verdict.

    A part has its number in it, unless it is too narrow to hold that.
    """
    if not counts:
        raise ValueError("counts must hold one section or more, got none")
    names = list(next(iter(counts.values())))

    def draw(figure: Figure):
        axis = figure.subplots()
        starts = [0] * len(counts)
        places = range(len(counts))
        most = max(sum(row.values()) for row in counts.values())
        room = (72 * figure.get_figwidth() - 24) / (1.05 * most)  # points for each claim
        for name, look in zip(names, _LOOKS):
            numbers = [row[name] for row in counts.values()]
            bars = axis.barh(places, numbers, left=starts, height=0.5, label=name, **look)
            fits = [number * room > _DIGIT * len(str(number)) + 1 for number in numbers]
            words = [str(number) if number and fit else "" for number, fit in zip(numbers, fits)]
            axis.bar_label(bars, words, label_type="center", color=INK, size=8.5)
            starts = [a + b for a, b in zip(starts, numbers)]
        for place, title in zip(places, counts):
            axis.text(0, place - 0.3, title, size=9, va="bottom")
        axis.set_yticks([])
        axis.set_ylim(len(counts) - 0.6, -0.85)
        axis.set_xlim(0, 1.05 * most)
        axis.spines["left"].set_visible(False)
        axis.set_xlabel("claims")
        legend_above(figure, *axis.get_legend_handles_labels())

    rows = "; ".join(
        f"{section}: " + ", ".join(f"{number} {name}" for name, number in row.items() if number)
        for section, row in counts.items()
    )
    height = 1.3 + 0.46 * len(counts)
    return illustrate(draw, f"Verdicts by section of the paper. {rows}.", 7.0, height)
