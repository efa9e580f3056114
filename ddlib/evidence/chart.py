"""The ledger's picture: verdicts by section of the paper."""

from __future__ import annotations

from collections.abc import Mapping

from matplotlib.figure import Figure

from ddlib.figures import COLOURS, FAINT, INK, Illustration, illustrate

LOOKS = (
    {"color": COLOURS[2]},
    {"color": COLOURS[0], "alpha": 0.75},
    {"color": COLOURS[1]},
    {"color": COLOURS[3], "alpha": 0.75},
    {"facecolor": "none", "edgecolor": COLOURS[2], "lw": 1, "hatch": "///"},
    {"facecolor": "none", "edgecolor": FAINT, "lw": 1},
)
"""How a bar's parts look, in the order of the verdicts."""


def verdicts(counts: Mapping[str, Mapping[str, int]]) -> Illustration:
    """Verdicts by section: one bar each, a part for every verdict with its number.

    Parameters
    ----------
    counts : mapping
        ``{section: {verdict: number}}``, up to six verdicts, the same for each section.
    """
    if not counts:
        raise ValueError("counts must hold one section or more, got none")
    names = list(next(iter(counts.values())))

    def draw(figure: Figure):
        axis = figure.subplots()
        starts = [0] * len(counts)
        places = range(len(counts))
        for name, look in zip(names, LOOKS):
            numbers = [row[name] for row in counts.values()]
            bars = axis.barh(places, numbers, left=starts, height=0.66, label=name, **look)
            words = [str(number or "") for number in numbers]
            axis.bar_label(bars, words, label_type="center", color=INK, size=8.5)
            starts = [a + b for a, b in zip(starts, numbers)]
        axis.set_yticks(places, list(counts))
        axis.invert_yaxis()
        axis.grid(visible=False, axis="y")
        axis.set_xlabel("claims")
        figure.legend(loc="outside upper center", ncols=3)

    rows = "; ".join(
        f"{section}: " + ", ".join(f"{number} {name}" for name, number in row.items() if number)
        for section, row in counts.items()
    )
    height = 1.4 + 0.32 * len(counts)
    return illustrate(draw, f"Verdicts by section of the paper. {rows}.", 7.0, height)
