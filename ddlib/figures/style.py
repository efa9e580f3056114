"""The house style: figures as inline SVG that follow the page's theme and its width.

On a narrow page a figure has a form of its own, with its panels one below the other. Where texts
would lie on each other in it, there is none: the wide one keeps a width at which it can be read,
and scrolls in its own box.
"""

from __future__ import annotations

import hashlib
import io
import itertools
import re
import textwrap
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from xml.etree import ElementTree

import matplotlib as mpl
from matplotlib import ticker
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.gridspec import GridSpec
from matplotlib.text import Text
from matplotlib.transforms import Bbox

from ddlib._check import function_of, number, one_of, text
from ddlib._files import write_whole
from ddlib.tables import SUPERSCRIPT

_FONT = "'DejaVu Sans',Verdana,sans-serif"
"""Fonts of text in figures: the one they are laid out with, one as wide, the reader's own."""

INK = "#010203"
"""Colour of text and axes; becomes the page's own text colour in the SVG."""

FAINT = "#7f7f7f"
"""Colour of grids and secondary lines; legible on light and on dark pages."""

COLOURS = ("#a0504c", "#5ca074", "#7272ac", "#ac8c68", "#ac6c90", "#727e3c")
"""Of many curves that have no role; pale, so that none looks like one, and legible on any page."""

ROLES = {
    "shoulder": ("#1f76d2", "#4f9ff0"),
    "elbow": ("#bd4f00", "#f0803a"),
    "network": ("#a1105e", "#ff6bb0"),
    "window": ("#8f7000", "#ead36b"),
    "constant": ("#6b7685", "#98a4b3"),
    "even": ("#2f6f0d", "#9bdc6a"),
    "odd": ("#4a1fa8", "#cbb5ff"),
    "wanted": ("#007f86", "#2ec4d6"),
}
"""The colours of roles, on light and on dark pages; two more are drawn in ink and in grey."""

MEANINGS = {
    "shoulder": "of the shoulder: its link, its angle, its torque, its window",
    "elbow": "of the elbow",
    "measured": "what the arm did: a measured torque, a true value",
    "network": "what a network answers, and its weights",
    "window": "the samples that a network sees: a bracket or an area",
    "constant": "the constant part of a filter, which measures position",
    "even": "the even part, and what answers to acceleration",
    "odd": "the odd part, and what answers to velocity",
    "wanted": "a reference, a plan, a target",
    "before": "how it was before the last change",
}
"""What each of the ten roles stands for; the book's *Notation* shows them."""

TONES = {role: light for role, (light, _) in ROLES.items()} | {"measured": INK, "before": FAINT}
"""By role, the colour that a figure is drawn in; a dark page puts the other one in its place."""

DASHES = ("-", "--", "-.", ":", (0, (5, 1, 1, 1, 1, 1)), (0, (1, 1)))
"""Line styles that go with the colours, so that colour is never the only difference."""

_OWN_DASH = {"elbow": 1, "network": 1, "constant": 2, "odd": 1, "wanted": 3, "before": 1}
_WORDS = {
    "shoulder": r"shoulder",
    "elbow": r"elbow",
    "measured": r"measured|recorded|reading|real|true|truth|th(is|e) arm",
    "network": r"networks?|weights|gradient",
    "window": r"window(?! (of )?\d)",
    "constant": r"constant",
    "even": r"even|acceleration|parabola|inertial|coupling",
    "odd": r"odd|velocity|line|centrifugal|coriolis",
    "wanted": r"wanted|reference|planned|ideal|target",
    "before": r"before|untrained",
}
_NAMED = re.compile("|".join(rf"(?P<{role}>\b({words})\b)" for role, words in _WORDS.items()), re.I)


@dataclass(frozen=True)
class Look:
    """How a curve is drawn: by a role of `TONES` or a number of `COLOURS`, and of `DASHES`."""

    tone: str | int  #: A role, or a number of `COLOURS`.
    dash: int  #: A number of `DASHES`.

    @property
    def colour(self) -> str:
        """Its colour in a figure."""
        return TONES[self.tone] if isinstance(self.tone, str) else COLOURS[self.tone]

    @property
    def line(self) -> dict:
        """What matplotlib's `plot` takes of a line."""
        return {"color": self.colour, "ls": DASHES[self.dash]}

    @property
    def classes(self) -> str:
        """Classes that a widget's curve has, as in ``"elbow d1"``."""
        return f"{self.tone if isinstance(self.tone, str) else f'c{self.tone}'} d{self.dash}"


def looks(names: Iterable[str], roles: Mapping[str, str] | None = None) -> dict[str, Look]:
    """How the curves of a figure are drawn: **a name says its role**, and no two have one dash.

    The first word of a name that means a role gives it the role's colour: *elbow, trained* is the
    elbow's. What answers to acceleration (a parabola) is even, what answers to velocity (a line)
    odd; *this arm* and the *truth* are measured, a *reference* is wanted. One or two names without
    a role are ink and grey; more are unrelated things, and have `COLOURS`. A role has its own
    dash, if another curve of the figure has not got it already.

    Parameters
    ----------
    names : iterable of str
        All that are drawn, in order.
    roles : mapping, optional
        Roles of names that do not say them.

    Raises
    ------
    TypeError, ValueError
        If a name is no text, or a role is none of `TONES`.
    """
    if isinstance(names, str) or not isinstance(names, Iterable):
        raise TypeError(f"names must be texts, got {names!r:.60}")
    names = list(names)
    if not names:
        raise ValueError("names must hold one name or more, got none")
    for name in names:
        text("names", name)
    for name, role in (roles or {}).items():
        one_of(f"role of {name!r}", role, tuple(TONES))
    names = list(dict.fromkeys(names))
    named = {name: match.lastgroup for name in names if (match := _NAMED.search(name))}
    named |= {name: role for name, role in (roles or {}).items() if name in names}
    others = [name for name in names if name not in named]
    inks = [tone for tone in ("measured", "before") if tone not in named.values()]
    colours = list(range(len(COLOURS)))
    tones = [*inks, *colours] if len(others) < 3 else [*colours, *inks]
    tone_of = named | dict(zip(others, itertools.cycle(tones)))
    dash_of: dict[str, int] = {}
    for name in (*named, *others):
        own = _OWN_DASH.get(tone_of[name], 0)
        free = [k for k in (own, *range(len(DASHES))) if k not in dash_of.values()]
        dash_of[name] = free[0] if free else len(dash_of) % len(DASHES)
    return {name: Look(tone_of[name], dash_of[name]) for name in names}


JOINTS = ("shoulder", "elbow")
"""Names of joint 0 and joint 1."""

# What may follow the comma in an axis label, and never stands alone
_UNITS = ("rad", "rad/s", "rad/s²", "°", "°/s", "m", "mm", "s", "ms", "Hz", "N m", "J", "dB", "%")

_LEAST = 6.75  # points, of the smallest text of a figure: 9 pixels on a page
NARROW = 3.55  # inches, the width of a narrow form: what a screen of 390 pixels leaves it
_HEAVIEST = 90_000  # letters of SVG up to which a narrow form is worth its weight in the page

_RC = {
    "axes.edgecolor": INK,
    "axes.grid": True,
    "axes.labelcolor": INK,
    "axes.labelsize": 9.5,
    "axes.linewidth": 0.7,
    "axes.prop_cycle": mpl.cycler(color=(INK, *COLOURS)),  # of what says no role
    "axes.spines.right": False,
    "axes.spines.top": False,
    "axes.titlecolor": INK,
    "axes.titlelocation": "left",
    "axes.titlesize": 10,
    "figure.constrained_layout.use": True,
    "figure.facecolor": "none",
    "figure.labelsize": 9.5,
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
    """A finished figure with its alternative text; a notebook shows it as inline SVG."""

    svg: str  #: The picture.
    alt: str  #: What it shows, for those who cannot see it.
    #: What `illustrate` drew it from.
    draw: Callable[[Figure], None] | None = field(default=None, compare=False, repr=False)
    #: Of its narrow form, inches, before its panels are put one below the other.
    height: float = field(default=0.0, compare=False, repr=False)
    #: Width and height, inches.
    size: tuple[float, float] = field(default=(0.0, 0.0), compare=False, repr=False)

    def __repr__(self) -> str:
        return f"Illustration({textwrap.shorten(self.alt, 60, placeholder=' ...')!r})"

    @cached_property
    def figure(self) -> Figure:
        """The matplotlib figure, drawn anew; what you change in it, its own `savefig` writes."""
        if self.draw is None:
            raise ValueError("an Illustration without `draw` has no matplotlib figure")
        with mpl.rc_context(_RC):
            figure = Figure(figsize=self.size)
            self.draw(figure)
            _lay_out(figure)
        return figure

    @cached_property
    def narrow(self) -> str:
        """The same with its panels one below the other; empty where that cannot be read."""
        return "" if self.draw is None else _narrow(self.draw, self.alt, self.height)

    def _repr_html_(self) -> str:
        """Both forms; the page's style sheet shows one of them."""
        if not self.narrow:
            return f'<div class="ddlib-figure">{self.svg}</div>'
        return (
            f'<div class="ddlib-figure two-forms"><div class="wide">{self.svg}</div>'
            f'<div class="narrow" hidden>{self.narrow}</div></div>'
        )

    def save(self, path, dpi: float = 200) -> None:
        """Write the picture to an ``.svg``, ``.png`` or ``.pdf`` file, dark on white.

        Parameters
        ----------
        path : str or path
            Its suffix decides.
        dpi : float
            Dots per inch of a ``.png`` file.

        Raises
        ------
        ValueError
            If the suffix is another one.
        """
        suffix = one_of("suffix of path", Path(path).suffix.lower(), (".svg", ".png", ".pdf"))
        if suffix != ".svg":
            content = io.BytesIO()
            undated = {"CreationDate": None} if suffix == ".pdf" else None
            options = {"format": suffix[1:], "facecolor": "white", "metadata": undated}
            with mpl.rc_context({**_RC, "figure.constrained_layout.use": False}):
                self.figure.savefig(content, dpi=dpi, **options)
            write_whole(path, content.getvalue())
            return
        write_whole(path, fixed(self.svg))


def fixed(svg: str) -> str:
    """A figure's SVG at its size, in the colours of a light page, on white, wherever it stands."""
    svg = _WIDTH.sub(r' width="\1"\g<0>', svg, count=1)
    svg = svg.replace(' style="', ' style="background:#ffffff;', 1)
    return _ROLE.sub(r"\1", svg.replace("currentColor", "#1a1a1a"))


def illustrate(
    draw: Callable[[Figure], None], alt: str, width=7.0, height=3.0, narrow_height=None
) -> Illustration:
    """Draw a figure in the house style.

    Parameters
    ----------
    draw : callable
        ``draw(figure)`` puts axes and curves on an empty matplotlib figure.
    alt : str
        Alternative text; required.
    width, height : float
        Size in inches.
    narrow_height : float, optional
        Height of the narrow form, of a figure that `draw` arranges in another way there; by
        default it is as high as the wide one.

    Raises
    ------
    ValueError
        If the alternative text is empty.
    """
    text("alt", alt)
    number("width", width, 0.0, 50.0, open_low=True)
    number("height", height, 0.0, 100.0, open_low=True)
    if narrow_height is not None:
        number("narrow_height", narrow_height, 0.0, 100.0, open_low=True)
    if not alt.strip():
        raise ValueError("alt must describe the figure, got an empty text")
    function_of("draw", draw, "draw(figure)")
    with mpl.rc_context({**_RC, "svg.hashsalt": alt}):
        figure = Figure(figsize=(width, height))
        draw(figure)
        _lay_out(figure)
        svg = _written(figure)
    return Illustration(_inline(svg, alt), alt, draw, narrow_height or height, (width, height))


class _Powers(ticker.LogFormatterSciNotation):
    """Powers of ten as text, like 10⁻³: as formulas they take half of a figure's time."""

    def __call__(self, x, pos=None):
        label = super().__call__(x, pos).removeprefix(r"$\mathdefault{").removesuffix("}$")
        label = re.sub(r"\^{(.*)}", lambda power: power[1].translate(SUPERSCRIPT), label)
        return label.replace(r"\times", " · ")


def _lay_out(figure: Figure) -> None:
    """Give the axes of a figure their places, which then stay.

    Left to saving, it would be done again, with a drawing more than is needed.
    """
    for side in (side for axis in figure.axes for side in (axis.xaxis, axis.yaxis)):
        if isinstance(side.get_major_formatter(), ticker.LogFormatterSciNotation):
            side.set_major_formatter(_Powers(side.get_transform().base))
        if isinstance(side.get_minor_formatter(), ticker.LogFormatterSciNotation):
            side.set_minor_formatter(_Powers(side.get_transform().base))
    if figure.axes:
        figure.get_layout_engine().execute(figure)
    with mpl.rc_context({"figure.constrained_layout.use": False}):
        figure.set_layout_engine(None)  # "none" leaves an empty one, for which saving draws twice


def _written(figure: Figure, **options) -> str:
    """A matplotlib figure that is laid out, as the text of an SVG file."""
    stream = io.StringIO()
    figure.savefig(stream, format="svg", transparent=True, metadata={"Date": None}, **options)
    return stream.getvalue()


class _NarrowFigure(Figure):
    """A figure whose legends keep to its width."""

    def legend(self, *args, ncols=1, **options):
        """As matplotlib's, with as many columns as there is room for."""
        columns = min(ncols, _columns(self, list(args[1]))) if len(args) > 1 else ncols
        return super().legend(*args, ncols=columns, **options)


def _narrow(draw: Callable[[Figure], None], alt: str, height: float) -> str:
    """A figure drawn anew for a narrow page, or nothing if its texts do not fit there."""
    look = {"svg.hashsalt": alt + " narrow", "path.simplify_threshold": 0.3}
    with mpl.rc_context({**_RC, **look}):
        figure = _NarrowFigure(figsize=(NARROW, height))
        draw(figure)
        rows, stacked = _stack(figure)
        figure.set_figheight(height if stacked == rows else stacked * min(height / rows, 2.4))
        if figure.legends:  # they take lines that the wide form has not
            above = sum(legend.get_window_extent().height for legend in figure.legends)
            figure.set_figheight(figure.get_figheight() + max(0.0, above / figure.dpi - 0.3))
        _lay_out(figure)
        figure.draw_without_rendering()  # texts of axes find their places
        if not _legible(figure):
            return ""
        drawn = figure.get_tightbbox()  # maps to scale leave room above and below
        low, high = max(drawn.y0 - 0.04, 0.0), min(drawn.y1 + 0.04, figure.get_figheight())
        svg = _written(figure, bbox_inches=Bbox([[0.0, low], [NARROW, high]]))
    svg = _inline(svg, alt)
    return svg if len(svg) <= _HEAVIEST else ""


def _stack(figure: Figure) -> tuple[int, int]:
    """Put the panels of a figure below each other; returns how many rows it had and has.

    Row by row if every panel has its own title, else column by column.
    """
    panels = [axis for axis in figure.axes if axis.get_subplotspec() is not None]
    if not panels:
        return 1, 1
    grid = panels[0].get_gridspec()
    if grid.ncols == 1:
        return grid.nrows, grid.nrows

    def place(axis):
        spec = axis.get_subplotspec()
        return spec.rowspan.start, spec.colspan.start

    named = all(axis.get_title(loc="left") or axis.get_title() for axis in panels)
    by_rows = named or grid.nrows == 1
    first = {place(axis)[0]: axis for axis in reversed(sorted(panels, key=place))}
    last = max(place(axis)[0] for axis in panels)
    for axis in panels:
        row, column = place(axis)
        if column and not axis.yaxis.get_tick_params().get("labelleft", True):
            axis.tick_params(labelleft=True)  # it shared those of its neighbour
            if not axis.get_ylabel():
                axis.set_ylabel(first[row].get_ylabel())
        if row == last:
            axis.tick_params(labelbottom=True)
    order = sorted(panels, key=lambda axis: place(axis) if by_rows else place(axis)[::-1])
    rows = GridSpec(len(order), 1, figure=figure)
    for axis, spec in zip(order, rows):
        axis.set_subplotspec(spec)
    return grid.nrows, len(order)


def _legible(figure: Figure) -> bool:
    """Whether the texts of a drawn figure lie within it, on nothing else, beside wide panels."""
    hidden = set()
    for axis in figure.axes:
        for side in (axis.xaxis, axis.yaxis):
            low, high = sorted(side.get_view_interval())
            ticks = (*side.get_major_ticks(), *side.get_minor_ticks())
            beyond = [tick for tick in ticks if not low <= tick.get_loc() <= high]
            hidden |= {label for tick in beyond for label in (tick.label1, tick.label2)}
    texts = [t for t in figure.findobj(Text) if t.get_visible() and t.get_text().strip()]
    boxes = [t.get_window_extent() for t in texts if t not in hidden]
    whole, point = figure.bbox.padded(1), figure.dpi / 72
    if any(not (whole.x0 <= box.x0 and box.x1 <= whole.x1) for box in boxes):
        return False
    if any(not (whole.y0 <= box.y0 and box.y1 <= whole.y1) for box in boxes):
        return False
    for first, other in itertools.combinations(boxes, 2):
        common = Bbox.intersection(first, other)
        if common is not None and common.width > point and common.height > 4 * point:
            return False
    for axis in figure.axes:
        names = {axis.get_title(), axis.get_title(loc="left")} - {""}
        titles = [t.get_window_extent() for t in axis.findobj(Text) if t.get_text() in names]
        others = [other.get_window_extent() for other in figure.axes if other is not axis]
        if any(box.overlaps(other) for box in titles for other in others):
            return False
    panels = [axis for axis in figure.axes if axis.get_subplotspec() is not None]
    return all(axis.get_window_extent().width > 0.45 * figure.bbox.width for axis in panels)


def check_label(label: str) -> str:
    """An axis label as it is, if it names a quantity, with or without a unit after a comma.

    Raises
    ------
    ValueError
        If it names none: a unit alone, a joint alone or with a unit, nothing.
    """
    text("label", label)
    quantity = label.partition(",")[0].strip()
    if quantity in ("", "shoulder", "elbow", *_UNITS):
        raise ValueError(f"an axis label must be like 'torque, N m', got {label!r}")
    return label


def legend_above(figure: Figure, handles, names) -> None:
    """A legend of handles and their names above all axes of a figure.

    It takes as many columns as the figure's width has room for.
    """
    columns = _columns(figure, names)
    figure.legend(handles, names, loc="outside upper left", ncols=columns)


def _columns(figure: Figure, names) -> int:
    """How many columns a legend of these names may have."""
    letters = 12.5 * figure.get_figwidth()  # at the legend's size, a letter for a handle's unit
    widest = 5 + max(map(len, names))
    return max(1, min(len(names), int(letters // widest)))


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
        axis.set_major_locator(ticker.MaxNLocator(4))
    else:
        fine = (1, 2, 5) if high / low < 60 else (1, 3) if high / low < 200 else (1,)
        axis.set_major_locator(ticker.LogLocator(subs=fine))
    axis.set_major_formatter(ticker.StrMethodFormatter("{x:g}"))
    axis.set_minor_formatter(ticker.NullFormatter())


def _inline(svg: str, alt: str) -> str:
    """Matplotlib's SVG file as markup for a page: own ids, page colours, an accessible name."""
    root = _parsed(svg)
    for formula in [element for element in root.iter("text") if len(element)]:
        _put_in_reading_order(formula)
    prefix = "f" + hashlib.sha256((alt + svg).encode()).hexdigest()[:8]
    elements = list(root.iter())
    values = [value for element in elements for value in element.attrib.values()]
    named = {element.get("id") for element in elements}
    links = dict.fromkeys(name for value in values for name in _LINK.findall(value))
    used = {name: f"{prefix}-{k}" for k, name in enumerate(links) if name in named}

    def own(link: re.Match) -> str:
        return f"#{used[link[1]]}" if link[1] in used else link[0]

    sizes = []
    for element in elements:
        for name, value in list(element.items()):
            new = _LINK.sub(own, value).replace(INK, "currentColor")
            for role, (light, _) in ROLES.items():
                new = new.replace(light, f"var(--dd-{role}, {light})")
            if name == "id":
                new = used.get(value)
            elif name == "d":
                new = _GAP.sub(r"\1", _rounded(new))
            elif name in ("x", "y", "transform"):
                new = None if value.startswith("rotate(-0 ") else _rounded(new)
            elif name == "style":
                new = new.replace("; font-family: 'DejaVu Sans'", "")  # said once, on the whole
                new = _SIZE.sub(lambda size: _legible_size(size, sizes), new)
            element.set(name, new) if new is not None else element.attrib.pop(name)
    for group in root.iter("g"):  # the marks of a curve have one style, said once
        styles = {(mark.tag, mark.get("style", "")) for mark in group}
        if len(group) > 1 and len(styles) == 1 and group[0].tag == "use":
            group.set("style", group[0].get("style", ""))
            for mark in group:
                mark.attrib.pop("style", None)
    width = float(root.attrib.pop("width").removesuffix("pt"))
    del root.attrib["height"]
    least = f"--least:{width / min(sizes) * 9:.0f}px;" if sizes else ""
    style = f"width:{width / 72:.2f}in;{least}max-width:100%;height:auto;"
    style += f"font-family:{_FONT};"
    style += "text-rendering:geometricPrecision;stroke-linejoin:round;stroke-linecap:butt"
    for name, value in {"role": "figure", "aria-label": alt, "style": style}.items():
        root.set(name, value)
    return ElementTree.tostring(root, encoding="unicode").replace(" />", "/>")


_XLINK = "http://www.w3.org/1999/xlink"
_LINK = re.compile(r"(?:^|(?<=url\())#([^)\s]+)")  # in an attribute: to a part of the picture
_ROLE = re.compile(r"var\(--dd-\w+, (#\w+)\)")  # a colour that follows the page
_WIDTH = re.compile(r' style="width:([\d.]+in);')  # of the whole; an image needs it apart
_GAP = re.compile(r"\s*([A-Za-z])\s*")  # around a letter of a path
_SIZE = re.compile(r"(?<=font-size: )[\d.]+(?=px)|(?<=font: )[\d.]+(?=px)")
# A line of no length, which is a dot if its ends are round
_DOT = re.compile(r"M (\S+) (\S+)\s+L \1 \2\s*(?=M|$)")


def _parsed(svg: str) -> ElementTree.Element:
    """An SVG file as elements that have no prefixes, without what is not drawn.

    Matplotlib's own style sheet goes, too: it would reach every element of the page.
    """
    root = ElementTree.fromstring(re.sub(r"[\x00-\x08\v\f\x0e-\x1f\ufffe\uffff]", "\ufffd", svg))
    for element in root.iter():
        element.tag = element.tag.rpartition("}")[2]
        for part in [child for child in element if child.tag.endswith(("}metadata", "}style"))]:
            element.remove(part)
        if link := element.attrib.pop(f"{{{_XLINK}}}href", None):
            element.set("xlink:href", link)
        element.tail = "\n"
        if len(element):
            element.text = "\n"
    root.set("xmlns", "http://www.w3.org/2000/svg")
    root.set("xmlns:xlink", _XLINK)
    return root


def _legible_size(size: re.Match, sizes: list[float]) -> str:
    """A size of text, at least `_LEAST`; `sizes` gathers them."""
    sizes.append(max(float(size[0]), _LEAST))
    return f"{sizes[-1]:g}"


def _put_in_reading_order(formula: ElementTree.Element) -> None:
    """A formula's letters from left to right; matplotlib sorts them by their fonts.

    Neighbours of one font and height stand together, each at its place.
    """
    letters = sorted(formula, key=lambda letter: round(float(letter.get("x")), 2))
    formula[:], formula.text = [], None
    for (y, style), run in itertools.groupby(
        letters, lambda letter: (letter.get("y"), letter.get("style"))
    ):
        run = list(run)
        x = " ".join(letter.get("x") for letter in run)
        joined = ElementTree.SubElement(formula, "tspan", x=x, y=y, style=style)
        joined.text = "".join(letter.text for letter in run)


def _rounded(places: str) -> str:
    """Coordinates to hundredths of a point: nobody sees the rest."""
    places = re.sub(r"-?\d+\.\d{3,}", lambda x: f"{float(x[0]):.2f}", places)
    return _DOT.sub(r"M\1 \2h0", places)
