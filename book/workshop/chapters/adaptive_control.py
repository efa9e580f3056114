"""*Adaptive control*: figures; what controllers reach on the arm, what they find and miss."""

from __future__ import annotations

import numpy as np
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from ddlib.figures import (
    COLOUR_MAP,
    COLOURS,
    DASHES,
    FAINT,
    INK,
    Illustration,
    check_label,
    illustrate,
    legend_above,
)
from workshop.beyond.studies.loop.runs.adaptive import _FULL
from workshop.report import results
from workshop.report.evidence.verdicts import Measured, judged


def courses(
    panels: dict[str, dict[str, np.ndarray]], change: int, told: str, label: str, alt: str
) -> Illustration:
    """Errors ``{title: {controller: (motions, runs)}}``: medians, and the middle half of all runs.

    After the motion `change` something happens, as `told`.
    """

    def draw(figure: Figure):
        axes = figure.subplots(1, len(panels), squeeze=False, sharey=True)[0]
        for axis, (title, controllers) in zip(axes, panels.items()):
            for k, errors in enumerate(controllers.values()):
                low, middle, high = np.percentile(errors, (25, 50, 75), axis=1)
                x = 1 + np.arange(len(errors))
                style = {"color": COLOURS[k % len(COLOURS)]}
                axis.fill_between(x, low, high, alpha=0.15, lw=0, **style)
                axis.plot(
                    x, middle, ls=DASHES[k % len(DASHES)], marker="os^Dv*"[k % 6], ms=3.5, **style
                )
            axis.set(title=title, yscale="log", xticks=x)
            axis.axvline(change + 0.5, color=INK, lw=0.8)
            axis.text(
                change + 0.6, 0.02, told, ha="left", va="bottom", fontsize=8,
                transform=axis.get_xaxis_transform(),
            )  # fmt: skip
            axis.set_xlabel("motion, number")
        axes[0].set_ylabel(check_label(label))
        handles = [line for line in axes[0].lines if line.get_marker() not in ("", "None")]
        legend_above(figure, handles, list(next(iter(panels.values()))))

    return illustrate(draw, alt, 7.0, 3.6)


def stops_map(x, y, panels: dict[str, tuple], labels: tuple[str, ...], alt: str) -> Illustration:
    """Errors over two settings, ``{title: (errors, stopped)}`` with a row for each of `y`.

    A run that was stopped gets a cross. The labels are of x, y and the errors.
    """
    shown = np.concatenate([errors[~stopped] for errors, stopped in panels.values()])

    def draw(figure: Figure):
        axes = figure.subplots(1, len(panels), squeeze=False, sharey=True)[0]
        norm = LogNorm(shown.min(), shown.max())
        places = np.arange(len(x))
        for axis, (title, (errors, stopped)) in zip(axes, panels.items()):
            masked = np.ma.masked_array(errors, stopped)
            picture = axis.pcolormesh(places, np.arange(len(y)), masked, norm=norm, cmap=COLOUR_MAP)
            rows, columns = np.nonzero(stopped)
            axis.plot(columns, rows, "x", color=FAINT, ms=6, mew=1.6)
            ticks = [k for k in places if abs(np.log10(x[k]) % 1) < 1e-6]
            axis.set_xticks(ticks, [f"{x[k]:g}" for k in ticks])
            axis.tick_params("x", labelsize=7.5)
            axis.set_yticks(np.arange(len(y)), [f"{v:g}" for v in y])
            axis.grid(visible=False)
            axis.set_title(title)
        axes[0].set_ylabel(check_label(labels[1]))
        figure.supxlabel(check_label(labels[0]))
        figure.colorbar(picture, ax=list(axes), label=check_label(labels[2]), shrink=0.95)

    return illustrate(draw, alt, 7.0, 2.9)


def kept(*path) -> np.ndarray | dict:
    """A part of the result; among its numbers, runs that were stopped are infinite."""
    found = results.read("adaptive")
    for key in path:
        found = found[key]
    return found if isinstance(found, dict) else _finite(found)


def _finite(numbers) -> np.ndarray:
    return np.nan_to_num(np.array(numbers, float), nan=np.inf)


def load_row(setup: str, mass: float, late: int = 0) -> dict[str, np.ndarray]:
    """Errors in mm by law, ``(motions, seeds)``, with a load in kg and torques periods late."""
    rows = kept("loads", setup)["rows"]
    (row,) = [r for r in rows if r["load"] == mass and r["late"] == late]
    return {name: _finite(errors) for name, errors in row["settled"].items()}


def _added(effect: str) -> np.ndarray:
    """What an effect adds to the estimates of each day, as shares of the true ones."""
    own, none = (np.array(kept("bed", e, "estimate")) for e in (effect, next(iter(kept("bed")))))
    return own - none


def bias(effect: str) -> np.ndarray:
    """What an effect adds to the seven estimates in the median, as shares of the true ones."""
    return np.median(_added(effect), axis=0)


def _told(parameter: str) -> str:
    """A parameter of adaptive controllers in words, if it is a friction or a moment."""
    kinds = {"F_v": "viscous friction", "F_c": "Coulomb friction", "g": "gravity moment"}
    kind, joint = kinds.get(parameter[:-1]), parameter[-1]
    return f"the {('shoulder', 'elbow')[int(joint) - 1]}'s {kind}" if kind else parameter


def bent(effect: str) -> Measured:
    """Largest such bias."""
    off = bias(effect)
    k = int(np.abs(off).argmax())
    return judged(
        lambda x: np.abs(np.median(x, axis=1)).max(-1),
        _added(effect),
        text=f"{100 * off[k]:+.0f} % of {_told(_FULL[k])}",
    )
