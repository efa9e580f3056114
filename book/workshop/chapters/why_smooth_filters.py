"""What the evidence page *Why the filters are smooth* shows and quotes; its widget."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from ddlib._check import integer
from ddlib.analysis import content
from ddlib.figures import curves
from ddlib.figures.style import COLOURS, NARROW, Illustration, illustrate
from ddlib.learning import Directions, TrainingSet, Weights, train_ensemble
from ddlib.setups import JOINT_DAMPING, WINDOWS
from ddlib.simulation import LOG_STEP
from ddlib.tables import quote
from ddlib.widgets.base import SCRIPT, STYLE, CurveWidget, module
from ddlib.widgets.hinton import CENTRE, EXACT, JOINTS, share_panel, width_choice, zero_padded
from ddlib.widgets.parts.panels import Panel, Scalar
from ddlib.widgets.parts.parameters import Choice
from workshop.report import results
from workshop.report.evidence.statements import resampled
from workshop.report.studies.span import LAZY, READINGS

_WHO = ("measured", "predicted")
_FLOOR = -8.0  # lowest change shown, as a power of ten of the random start
_SHARES = dict(enumerate(("bias", "pos.", "vel.", "acc.", "jerk", "rest")))

_CHARTS = 'extras.push((view) => view.el.classList.add("ddlib-spectrum"));\n'
_TWO_BY_TWO = """
.ddlib-spectrum .charts { grid-template-columns: repeat(auto-fit, minmax(min(100%, 17rem), 1fr)); }
"""


_SPECTRUM_CODE = """\
from workshop.report import results

study = results.read("span")
names = list(dict.fromkeys((x["setup"], *x["scaling"]) for x in study["cells"]))
cell = next(
    x
    for x in study["cells"]
    if (x["setup"], *x["scaling"]) == names[{case}] and x["width"] == {width}
)
place, direction = study["epochs"].index({epoch}), {direction} - 1
for who in ("measured", "predicted"):
    print(who, cell[who]["change over start"][place][direction])"""


def _windows() -> tuple[TrainingSet, np.ndarray, np.ndarray]:
    """The walk's training set on centred windows, their variances, and their directions."""
    data = TrainingSet.from_recording(JOINT_DAMPING.record()[:5], 21, scaling=(-1, 1))
    data = replace(data, x=data.x - data.x.mean(0))
    _, values, axes = np.linalg.svd(data.x.reshape(len(data.x), -1), full_matrices=False)
    return data, values**2 / len(data.x), axes


def four_directions() -> Illustration:
    """Directions of three kinds and of noise, and what descent leaves of the error along them."""
    _, variance, axes = _windows()
    filters, steps = axes.reshape(-1, 2, 21), np.geomspace(1, 1e5, 200)
    named = {"position": 0, "velocity": 2, "acceleration": 4, "noise": 41}

    def draw(figure):
        axis, columns = figure.subplots(), 4 if figure.get_figwidth() > NARROW else 2
        for place, (name, k) in enumerate(named.items()):
            row, column = divmod(place, columns)
            colour, shape = COLOURS[place], filters[k, (filters[k] ** 2).sum(-1).argmax()]
            corner = 0.01 + column / columns, (0.66 if columns == 4 else 0.8) - 0.27 * row
            inset = axis.inset_axes([*corner, 0.88 / columns, 0.24 if columns == 4 else 0.14])
            inset.plot(shape * np.sign(shape[-1]), color=colour)
            inset.set(title=name, ylim=(-0.6, 0.6), xticks=[], yticks=[])
            axis.semilogx(steps, (1 - variance[k] / (2 * variance[0])) ** steps, color=colour)
        axis.set(xlabel="steps of descent", ylabel="error left, share")
        axis.set(ylim=(-0.05, 1.8 if columns == 4 else 2.2))
        axis.set_yticks([0, 0.5, 1])

    alt = "A flat filter, a line, a parabola and noise; their errors go in this order, noise last."
    return illustrate(draw, alt, 7.0, 3.0, narrow_height=4.2)


def _quoted() -> None:
    """When errors along directions are halved, and how far the tangent is off, in the study."""
    for name, half in _halves().items():
        quote(f"smooth-{name}", round(float(np.exp(np.median(half))), -1))
    study = results.read("span")
    factors = study["cells"][WINDOWS.index(21)]["factor"]
    quote("smooth-factor", float(np.median(factors, 0)[-1]))
    for size, cell in zip(study["ranges"], study["by range"]):
        way = [cell[who]["moved"][-1] for who in _WHO]
        name = {0.03: "rich", LAZY: "lazy"}.get(size)
        if name:
            quote(f"smooth-{name}", way[0] / way[1])


def _halves() -> dict[str, np.ndarray]:
    """Logarithms of the epochs at which networks have halved the error along two directions."""
    cell = results.read("span")["cells"][WINDOWS.index(21)]
    half = np.log(np.array(cell["measured"]["halves"], dtype=float))
    return {"velocity": half[:, 3:5].mean(1), "acceleration": half[:, 5:7].mean(1)}


def said_of_descent() -> dict[str, np.ndarray | bool]:
    """What is said of networks: of the book's, and of eight that are trained for it."""
    velocity, acceleration = _halves().values()
    ways = results.read("whitening")["directions"]
    directions = len(ways["plain"]["change over start"])
    learnt = {way: resampled(found["learnt"]) / directions for way, found in ways.items()}
    solvers = np.min([learnt["whitened"], learnt["plain"]], 0)
    further = [
        np.divide(*(cell[who]["moved"][-1] for who in _WHO))
        for cell in results.read("span")["by range"]
    ]
    ratio = _moved(8, ["plain"])["plain"].direct
    return {
        "velocity first": resampled(acceleration - velocity) > 0,
        "solvers all": (solvers > 0.9) & (learnt["descent"] < 0.5),
        "rich beyond": further[0] > 4 * further[2],
        "flat stay": resampled(np.median(ratio[:, 12:], 1)) < 0.2,
        "acceleration most": resampled(ratio[:, 4:6].min(1) / ratio[:, :4].max(1)) > 1,
    }


class _Ways(NamedTuple):
    """How far training moved weights along each direction, over their start, by network."""

    direct: np.ndarray
    hidden: np.ndarray


def _whiten(variance, axes) -> np.ndarray:
    return axes.T @ np.diag(1 / np.sqrt(variance)) @ axes


def _moved(members: int, kinds: Sequence[str]) -> dict[str, _Ways]:
    """Networks trained for 2,000 epochs from ±0.3 on centred windows, plain or whitened."""
    data, variance, axes = _windows()
    start = Weights.random(members, 21, initial=LAZY)
    how = {"momentum": 0.98, "warm_up": 500, "epochs": 2000, "progress": False}
    found = {}
    for kind in kinds:
        given = data
        if kind == "whitened":
            seen = data.x.reshape(len(data.x), -1) @ _whiten(variance, axes)
            given = replace(data, x=seen.reshape(data.x.shape))
        after = train_ensemble(start, given, **how)[0].weights
        ratios = []
        for name in ("direct_weights", "hidden_weights"):
            before, trained = (
                getattr(w, name).reshape(members, -1, 42) @ axes.T for w in (start, after)
            )
            ratios.append(np.sqrt(((trained - before) ** 2).sum(1) / (before**2).sum(1)))
        found[kind] = _Ways(*ratios)
    return found


def directions_moved(members: int = 3) -> Illustration:
    """How far training moves weights along each direction, on windows as they are and whitened."""
    numbers, panel = np.arange(1, 43), {}
    for kind, (direct, hidden) in _moved(members, ["plain", "whitened"]).items():
        told = "as they are" if kind == "plain" else kind
        panel[f"outputs, {told}"] = np.sqrt((direct**2).mean(0))
        panel[f"hidden, {told}"] = np.sqrt((hidden**2).mean(0))
    panel["as large as the start"] = np.ones(42)
    alt = "Changes of weights over directions of the windows, plain and whitened; a line at 1."
    return curves(
        numbers, {"change over start": panel}, "direction, number", alt, height=2.6, y_log=True
    )


def whitened_filters(target: int = 0) -> Illustration:
    """A linear filter after plain steps, and after one step on whitened windows."""
    data, variance, axes = _windows()
    x, y = data.x.reshape(len(data.x), -1), data.y[:, target] - data.y[:, target].mean()
    along = axes @ (x.T @ y) / len(x) / variance  # of the least-squares filter
    learnt = {"one whitened step": along @ axes}
    for steps in (10_000, 1_000_000):
        gone = 1 - (1 - variance / (2 * variance[0])) ** steps
        learnt[f"{steps:,} plain steps"] = gone * along @ axes
    shown = {name: f.reshape(2, 21)[target] / y.std() for name, f in learnt.items()}
    time = 1000 * LOG_STEP * np.arange(-10, 11)
    alt = "Three filters: after two numbers of plain steps, and after one whitened step."
    return curves(time, {"weight": shown}, "time from the centre, ms", alt, height=2.2)


def explorer() -> _SpectrumExplorer:
    """The widget, of the networks of the study."""
    known = {}
    for setup in READINGS:
        known[setup.name] = known.get(setup.name) or setup.record()[:5]
    sets = (
        TrainingSet.from_recording(known[setup.name], width, scaling=setup.scaling)
        for setup in READINGS
        for width in WINDOWS
    )
    return _SpectrumExplorer(results.read("span"), [*map(Directions.of, sets)], code=_SPECTRUM_CODE)


class _SpectrumExplorer(CurveWidget):
    """Pick a direction of the windows; see its shape, and watch it being learnt.

    Curves are medians over the networks of the study "span". The slider steps over the epochs
    that it kept; nothing is interpolated.

    Parameters
    ----------
    study : mapping
        What `workshop.report.studies.span.span` returns, or `results.read` of it.
    directions : sequence of Directions
        Of the training set of each cell of the study, in their order.
    **options
        Passed on to `CurveWidget`.
    """

    _esm = module(*SCRIPT, "player.js") + _CHARTS
    _css = module(*STYLE, "player.css") + _TWO_BY_TWO

    def __init__(self, study: Mapping, directions: Sequence[Directions], **options):
        cells = study["cells"]
        if len(directions) != len(cells):
            raise ValueError(
                f"directions must be one for each of {len(cells)} cells, got {len(directions)}"
            )
        names, self._cells = [], {}
        for cell, along in zip(cells, directions):
            width = integer("width", cell["width"], 3)
            if along.filters.shape[-1] != width:
                raise ValueError(
                    f"directions must be of window {width} like its cell, "
                    f"got {along.filters.shape[-1]}"
                )
            name = "{}, inputs {:g} to {:g}".format(cell["setup"], *cell["scaling"])
            names += [name] if name not in names else []
            self._cells[names.index(name), width] = cell, along
        epochs = study["epochs"][1:]  # at epoch 0 nothing has changed
        shown = len(cells[0]["measured"]["error"][0])
        self._index = {epoch: k for k, epoch in enumerate(epochs, 1)}
        self._reach = max(width for _, width in self._cells) // 2
        places = np.log10(epochs)
        self._places = np.clip(places, 1e-3 * places[-1], (1 - 1e-3) * places[-1])
        time = np.arange(-self._reach, self._reach + 1) * LOG_STEP * 1e3
        over = {"cursor": "place", "x_scale": "power"}
        cell, per_epoch = ("case", "width", "direction"), ("case", "width", "direction", "epoch")
        shape = [f"{joint} shape" for joint in JOINTS]
        courses = [f"{what} {who}" for what in ("change", "error") for who in _WHO]
        super().__init__(
            self._curves,
            [
                Choice("case", "Recording", dict(enumerate(names)), 0),
                width_choice({width for _, width in self._cells}),
                Choice("direction", "Direction", range(1, shown + 1), 4, display="slider"),
                Choice(
                    "epoch", "Epoch", {e: f"{e:,}" for e in epochs}, epochs[-1], display="slider"
                ),
            ],
            [
                Panel(
                    "The direction as a filter",
                    dict(zip(shape, JOINTS)),
                    CENTRE,
                    time,
                    kind="stems",
                    cursor=("first", "last"),
                    y_fit=True,
                ),
                share_panel("What it responds to, share", "part of the window", _SHARES),
                Panel(
                    "Change over the start, times",
                    {f"change {who}": who for who in _WHO},
                    "epoch",
                    places,
                    fixed={"as large as the start": np.zeros(len(places))},
                    y_scale="power",
                    y_range=(_FLOOR, 3.0),
                    **over,
                ),
                Panel(
                    "Its part of the RMSS",
                    {f"error {who}": who for who in _WHO},
                    "epoch",
                    places,
                    y_fit=True,
                    **over,
                ),
            ],
            title="Learning along a direction",
            alt=(
                "A direction of the windows as a filter, the derivatives that it responds to, and "
                "over the epochs how far training has changed the weights along it, measured and "
                "predicted, and what it leaves of the error."
            ),
            scalars=[
                Scalar("variance", "Variance, times that of direction 1", scale="power"),
                *(
                    Scalar(f"now {who}", f"Change, {who}, times the start", scale="power")
                    for who in _WHO
                ),
            ],
            depends={
                **dict.fromkeys((*shape, *courses, "shares", "variance"), cell),
                **dict.fromkeys((f"now {who}" for who in _WHO), per_epoch),
                **dict.fromkeys(("first", "last"), ("width",)),
                "place": ("epoch",),
            },
            note="Where the change is below 1, the random start outweighs what was learnt.",
            **{"tolerance": EXACT, **options},
        )

    def _curves(self, case, width, direction, epoch) -> dict:
        cell, along = self._cells[case, width]
        k, row = direction - 1, self._index[epoch]
        f, half = along.filters[k], (width // 2 + 0.5) * LOG_STEP * 1e3
        energy = [along.axes[k, -1] ** 2, *(content(f) ** 2).sum(0)]
        curves = {f"{joint} shape": zero_padded(g, self._reach) for joint, g in zip(JOINTS, f)}
        for who in _WHO:
            change = np.array(cell[who]["change over start"])[1:, k]
            change = np.log10(np.maximum(change, 10**_FLOOR))
            curves |= {f"change {who}": change, f"now {who}": change[row - 1]}
            curves[f"error {who}"] = np.array(cell[who]["error"])[1:, k]
        return {
            **curves,
            "shares": np.array([*energy, max(0.0, 1 - sum(energy))]),
            "variance": np.log10(cell["variance"][k]),
            "place": self._places[row - 1],
            "first": -half,
            "last": half,
        }
