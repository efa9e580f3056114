"""What the chapter *Window networks* draws, and what its screening design tells."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from matplotlib.colorbar import Colorbar
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.patches import Polygon
from matplotlib.ticker import NullLocator
from scipy.spatial import ConvexHull
from scipy.special import softmax
from scipy.stats import qmc
from sklearn.linear_model import BayesianRidge
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import PolynomialFeatures

from ddlib._check import finite_array
from ddlib.analysis import gains, mean_gradient
from ddlib.figures.maps import COLOUR_MAP, SIGNS
from ddlib.figures.style import (
    COLOURS,
    FAINT,
    INK,
    Illustration,
    illustrate,
    legend_above,
    plain_ticks,
)
from ddlib.learning import TrainingSet, Weights, cases, default_rate, train_ensemble
from ddlib.setups import INITIAL, JOINT_DAMPING, split
from workshop.report import results
from workshop.report.studies.page import training as page


def overlay(t, measured, predicted: Mapping[str, np.ndarray]) -> Illustration:
    """Figure 4-1: measured torque (fine) under the networks' (bold), one panel each."""

    def draw(figure: Figure):
        axes = figure.subplots(len(predicted), 1, sharex=True, sharey=True, squeeze=False)[:, 0]
        for axis, (title, torque) in zip(axes, predicted.items()):
            axis.plot(t, torque, color=COLOURS[1], lw=2.6, alpha=0.85, label="network")
            axis.plot(t, measured, color=INK, lw=0.8, label="measured")
            axis.set_title(title)
            axis.set_ylabel("torque, N m")
        figure.legend(*axes[0].get_legend_handles_labels(), loc="outside upper left", ncols=2)
        axes[-1].set_xlabel("time, s")

    worst = max(np.sqrt(np.mean((np.asarray(p) - measured) ** 2)) for p in predicted.values())
    alt = (
        f"Measured shoulder torque on the test trajectory with the torque of networks "
        f"({', '.join(predicted)}) laid over it; largest root mean square difference "
        f"{worst:.2f} N m."
    )
    return illustrate(draw, alt, 7.0, 1.7 * len(predicted) + 0.4)


def plane(
    x,
    y,
    values,
    labels: tuple[str, str, str],
    alt: str,
    *,
    levels,
    training,
    test,
) -> Illustration:
    """A positive quantity over a plane, as colours on a logarithmic scale, with contour lines."""
    x, y, values = (finite_array(n, v) for n, v in (("x", x), ("y", y), ("values", values)))
    if x.ndim != 1 or y.ndim != 1 or values.shape != (y.size, x.size):
        raise ValueError(
            f"values must have shape (len(y), len(x)) = ({y.size}, {x.size}), got {values.shape}"
        )
    if not (values > 0).all():
        raise ValueError(f"values must be above 0, got {values.min():g}")

    def draw(figure: Figure):
        axis = figure.subplots()
        norm = LogNorm(values.min(), values.max())
        mesh = axis.pcolormesh(x, y, values, norm=norm, cmap=COLOUR_MAP, shading="nearest",
                               linewidth=0.2, edgecolor="face")  # fmt: skip
        lines = axis.contour(x, y, values, levels=sorted(levels), colors="white", linewidths=1.0)
        axis.clabel(lines, fmt="%g", fontsize=8)
        axis.add_patch(Polygon(_hull(training), fill=False, ec="white", ls="--", lw=1.2))
        look = {"ls": "", "clip_on": False, "zorder": 3}
        axis.plot(*np.transpose(training), marker="o", color="white", mec=INK, ms=7, **look)
        axis.plot(*np.transpose(test), marker="D", color=COLOURS[1], mec="white", ms=8, **look)
        axis.set(xlabel=labels[0], ylabel=labels[1])
        axis.grid(False)
        _finish(figure.colorbar(mesh, ax=axis, label=labels[2]))

    return illustrate(draw, alt, 5.6, 3.6)


def _finish(bar: Colorbar):
    plain_ticks(bar.ax.yaxis)
    bar.ax.yaxis.set_minor_locator(NullLocator())
    bar.outline.set_visible(False)


def _hull(points):
    points = np.asarray(points, dtype=float)
    return points[ConvexHull(points).vertices]


def intervals(
    panels: Mapping[str, Mapping[str, Mapping[str, tuple]]],
    x_label: str,
    alt: str,
    *,
    log: bool = False,
    band: tuple[float, float] | None = None,
) -> Illustration:
    """Panels of rows, each with a point and an interval for every series."""
    rows = list(dict.fromkeys(r for series in panels.values() for s in series.values() for r in s))
    for series in panels.values():
        for points in series.values():
            for row, point in points.items():
                low, middle, high = finite_array(row, point)
                if not low <= middle <= high:
                    raise ValueError(f"interval of {row!r} must be in order, got {tuple(point)}")

    def draw(figure: Figure):
        axes = figure.subplots(1, len(panels), sharex=True, sharey=True, squeeze=False)[0]
        for axis, (title, series) in zip(axes, panels.items()):
            if band is not None:
                axis.axvspan(*band, color=FAINT, alpha=0.2, lw=0)
            for k, (name, points) in enumerate(series.items()):
                offset = (k - (len(series) - 1) / 2) * 0.6 / len(series)
                for row, (low, middle, high) in points.items():
                    y = rows.index(row) + offset
                    axis.plot([low, high], [y, y], color=COLOURS[k], lw=1.6)
                    axis.plot([middle], [y], SIGNS[k], color=COLOURS[k], ms=5, label=name)
            axis.set_yticks(range(len(rows)), rows)
            axis.set_ylim(len(rows) - 0.5, -0.5)
            axis.set(xlabel=x_label, title=title, xscale="log" if log else "linear")
            axis.grid(False, axis="y")
            if log:
                plain_ticks(axis.xaxis)
        named = {}
        for axis in axes:
            named |= dict(zip(*reversed(axis.get_legend_handles_labels())))
        if len(named) > 1:
            legend_above(figure, list(named.values()), list(named))

    return illustrate(draw, alt, 7.0, 1.1 + 0.33 * len(rows))


def effects(design, logs, count: int) -> tuple[np.ndarray, float]:
    """Factors by which `count` quantities move each error from their low end to their high one.

    Main effects of a screening design, shape (count, errors), on errors given as logarithms, shape
    (runs, errors). The largest factor of the columns that are left over, which move nothing, is
    the second value.
    """
    slopes = design.T @ logs / (design**2).sum(0)[:, None]
    factors = np.exp(2 * slopes)
    return factors[:count], float(np.exp(2 * np.abs(slopes[count:])).max())


def width_left(places, logs, printed, settings: int = 2**14) -> dict[str, float]:
    """Width of the ranges that printed errors leave, in percent, as a geometric mean.

    A polynomial of second order through the runs of a design (places: (runs, quantities); logs of
    errors: (runs, networks, errors)) stands in for all settings. Each is weighed by how likely it
    prints the table, with the polynomial's own error "counted", or as if it were "exact".
    """
    runs, networks, count = logs.shape
    apart = (logs - logs.mean(1, keepdims=True)).reshape(-1, count)
    scatter = apart.T @ apart / (runs * (networks - 1))  # of one network on one recording
    x = 2 * qmc.Sobol(np.shape(places)[1], rng=0).random(settings) - 1
    fits = [
        make_pipeline(PolynomialFeatures(2, include_bias=False), BayesianRidge())
        .fit(places, values)
        .predict(x, return_std=True)
        for values in logs.mean(1).T
    ]
    means, errors = np.transpose(fits, (1, 2, 0))
    left = {}
    for name, own in (("counted", errors), ("exact", np.zeros_like(errors))):
        total = scatter + own[:, :, None] ** 2 * np.eye(count)
        miss = printed - means
        fit = (miss * np.linalg.solve(total, miss[..., None])[..., 0]).sum(1)
        weights = softmax(-0.5 * (fit + np.linalg.slogdet(total)[1]))
        deviation = np.sqrt(np.cov(x.T, aweights=weights, ddof=0).diagonal())
        left[name] = float(100 * np.exp(np.mean(np.log(np.sqrt(3) * deviation))))
    return left


def own_inertia(extents_deg, members: int = 4) -> tuple[float, float]:
    """Inertia at the shoulder, kg m²: in networks that learn as in the page, median, and the arm's.

    They learn from the first five trajectories, every fifth window of width 21.
    """
    training, _ = split(JOINT_DAMPING.record(extents_deg))
    windows, torque = cases(training, 21)
    data = TrainingSet.from_arrays(windows, torque, scaling=(-1, 1))
    windows, data = windows[::5], replace(data, x=data.x[::5], y=data.y[::5])
    start = Weights.random(members, 21, initial=INITIAL)
    epochs = results.read("page-training")["epochs"]
    how = {"rate": default_rate(21), "momentum": page.MOMENTUM, "epochs": epochs}
    model, *_ = train_ensemble(start, data, **how, progress=False)
    inertia = gains(mean_gradient(model, windows))[:, 0, 0, 2]
    return float(np.median(inertia)), float(
        JOINT_DAMPING.arm.mass_matrix(windows[..., 10])[:, 0, 0].mean()
    )
