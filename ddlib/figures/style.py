"""The house style: figures as inline SVG that follow the page's light or dark theme."""

from __future__ import annotations

import hashlib
import html
import io
import itertools
import re
from collections.abc import Callable
from dataclasses import dataclass

import matplotlib as mpl
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, MaxNLocator, NullFormatter, StrMethodFormatter

FONT = "'DejaVu Sans',Verdana,sans-serif"
"""Fonts of text in figures: the one they are laid out with, one as wide, the reader's own."""

INK = "#010203"
"""Colour of text and axes; becomes the page's own text colour in the SVG."""

FAINT = "#7f7f7f"
"""Colour of grids and secondary lines; legible on light and on dark pages."""

COLOURS = ("#2f7fd1", "#d4680b", "#219a6c", "#c2559d", "#8c7ae6", "#a08100")
"""Line colours, each with a contrast of 3:1 or more on white and on near-black."""

DASHES = ("-", "--", "-.", ":", (0, (5, 1, 1, 1, 1, 1)), (0, (1, 1)))
"""Line styles that go with the colours, so that colour is never the only difference."""

JOINTS = ("shoulder", "elbow")
"""Names of joint 0 and joint 1."""

UNITS = ("rad", "rad/s", "rad/s²", "°", "°/s", "m", "mm", "s", "ms", "Hz", "N m", "J", "dB", "%")
"""What may follow the comma in an axis label, and never stands alone."""

RC = {
    "axes.edgecolor": INK,
    "axes.grid": True,
    "axes.labelcolor": INK,
    "axes.labelsize": 9.5,
    "axes.linewidth": 0.7,
    "axes.spines.right": False,
    "axes.spines.top": False,
    "axes.titlecolor": INK,
    "axes.titlelocation": "left",
    "axes.titlesize": 10,
    "figure.constrained_layout.use": True,
    "figure.facecolor": "none",
    "axes.facecolor": "none",
    "font.family": ["DejaVu Sans"],
    "font.size": 9.5,
    "grid.alpha": 0.28,
    "grid.color": FAINT,
    "grid.linewidth": 0.6,
    "legend.fontsize": 8.5,
    "legend.frameon": False,
    "legend.labelcolor": INK,
    "lines.linewidth": 1.5,
    "svg.fonttype": "none",  # text stays text
    "text.color": INK,
    "xtick.color": INK,
    "xtick.labelsize": 8.5,
    "ytick.color": INK,
    "ytick.labelsize": 8.5,
}


@dataclass(frozen=True)
class Illustration:
    """A finished figure with its alternative text; a notebook shows it as inline SVG.

    Attributes
    ----------
    svg : str
        The picture.
    alt : str
        What it shows, for those who cannot see it.
    """

    svg: str
    alt: str

    def _repr_html_(self) -> str:
        return f'<div class="ddlib-figure">{self.svg}</div>'

    def save(self, path, ink="#1a1a1a", paper="#ffffff") -> None:
        """Write the picture to an ``.svg`` file with fixed colours."""
        svg = self.svg.replace("currentColor", ink)
        svg = svg.replace(' style="', f' style="background:{paper};', 1)
        with open(path, "w", encoding="utf-8") as file:
            file.write(svg)


def illustrate(draw: Callable[[Figure], None], alt: str, width=7.0, height=3.0) -> Illustration:
    """Draw a figure in the house style.

    Parameters
    ----------
    draw : callable
        ``draw(figure)`` puts axes and curves on an empty matplotlib figure.
    alt : str
        Alternative text; required.
    width, height : float
        Size in inches.

    Raises
    ------
    ValueError
        If the alternative text is empty.
    """
    if not alt.strip():
        raise ValueError("alt must describe the figure, got an empty text")
    with mpl.rc_context({**RC, "svg.hashsalt": alt}):
        figure = Figure(figsize=(width, height))
        draw(figure)
        stream = io.StringIO()
        figure.savefig(stream, format="svg", transparent=True, metadata={"Date": None})
    return Illustration(_inline(stream.getvalue(), alt), alt)


def check_label(label: str) -> str:
    """An axis label as it is, if it names a quantity, with or without a unit after a comma.

    Raises
    ------
    ValueError
        If it names none: a unit alone, a joint alone or with a unit, nothing.
    """
    quantity = label.partition(",")[0].strip()
    if quantity in ("", "shoulder", "elbow", *UNITS):
        raise ValueError(f"an axis label must be like 'torque, N m', got {label!r}")
    return label


def legend_above(figure: Figure, handles, names) -> None:
    """A legend of handles and their names above all axes of a figure.

    It takes as many columns as the figure's width has room for.
    """
    letters = 12.5 * figure.get_figwidth()  # at the legend's size, a letter for a handle's unit
    widest = 5 + max(map(len, names))
    columns = max(1, min(len(names), int(letters // widest)))
    figure.legend(handles, names, loc="outside upper left", ncols=columns)


def plain_ticks(axis: Axis) -> None:
    """Plain numbers on a logarithmic axis that spans few decades, at 1, 2, 5 where there is room.

    Parameters
    ----------
    axis : matplotlib.axis.Axis
        Its data must be there already. An axis over three decades or more stays as it is.
    """
    low, high = axis.get_view_interval()
    if high / low >= 1000:
        return
    if high / low < 4:
        axis.set_major_locator(MaxNLocator(4))
    else:
        fine = (1, 2, 5) if high / low < 60 else (1, 3) if high / low < 200 else (1,)
        axis.set_major_locator(LogLocator(subs=fine))
    axis.set_major_formatter(StrMethodFormatter("{x:g}"))
    axis.set_minor_formatter(NullFormatter())


def _inline(svg: str, alt: str) -> str:
    """Matplotlib's SVG file as markup for a page: own ids, page colours, an accessible name."""
    svg = svg[svg.index("<svg ") :]
    # Matplotlib's style sheet would reach every element of the page
    svg = re.sub(r"<metadata>.*?</metadata>|<style.*?</style>|<!--.*?-->", "", svg, flags=re.DOTALL)
    prefix = "f" + hashlib.sha256((alt + svg).encode()).hexdigest()[:8]
    used = set(re.findall(r'(?:href="|url\()#([^")]*)', svg))
    svg = re.sub(r' id="([^"]*)"', lambda i: f' id="{prefix}-{i[1]}"' if i[1] in used else "", svg)
    svg = re.sub(r'(href="#|url\(#)', rf"\g<1>{prefix}-", svg)
    svg = svg.replace(INK, "currentColor")
    svg = re.sub(r' transform="rotate\(-0 [^"]*"', "", svg)
    svg = re.sub(r' (d|x|y|transform)="[^"]*"', _rounded, svg)
    svg = re.sub(r"; font-family: 'DejaVu Sans'", "", svg)  # said once, on the whole picture
    svg = FORMULA.sub(_in_reading_order, svg)
    size = re.search(r'width="([\d.]+)pt" height="([\d.]+)pt"', svg)
    style = f"width:{float(size[1]) / 72:.2f}in;max-width:100%;height:auto;font-family:{FONT};"
    style += "text-rendering:geometricPrecision;stroke-linejoin:round;stroke-linecap:butt"
    label = html.escape(alt, quote=True)
    attributes = f'role="figure" aria-label="{label}" style="{style}"'
    svg = svg.replace(size[0], attributes, 1)
    return re.sub(r"\n\s*", "\n", svg)


FORMULA = re.compile(r"<text>\s*(<tspan.*?)</text>", re.DOTALL)
LETTER = re.compile(r'<tspan x="([^"]*)" y="([^"]*)" style="([^"]*)">(.*?)</tspan>')


def _in_reading_order(formula: re.Match) -> str:
    """A formula's letters from left to right; matplotlib sorts them by their fonts.

    Neighbours of one font and height stand together, each at its place.
    """
    letters = sorted(LETTER.findall(formula[1]), key=lambda letter: float(letter[0]))
    text = ""
    for (y, style), run in itertools.groupby(letters, key=lambda letter: letter[1:3]):
        run = list(run)
        x, words = " ".join(letter[0] for letter in run), "".join(letter[3] for letter in run)
        text += f'<tspan x="{x}" y="{y}" style="{style}">{words}</tspan>'
    return f"<text>{text}</text>"


def _rounded(places: re.Match) -> str:
    """Coordinates to hundredths of a point: nobody sees the rest."""
    return re.sub(r"-?\d+\.\d{3,}", lambda x: f"{float(x[0]):.2f}", places[0])
