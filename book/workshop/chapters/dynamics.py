"""Figures of the chapter *Dynamics*."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from ddlib._check import finite_array, number
from ddlib.dynamics import Arm, Operations
from ddlib.figures.style import COLOURS, DASHES, FAINT, INK, NARROW, Illustration, illustrate
from ddlib.identification import Estimate
from ddlib.trajectories import MOTION_SECONDS, pick_and_place

_MARKERS = "os^DvPX"
_CENTRED = dict(ha="center", va="center")


def hand_paths(arm: Arm, extents_deg) -> Illustration:
    """Paths of the hand on pick-and-place trajectories, with the arm where each turns back."""
    extents = finite_array("extents_deg", extents_deg, 2).reshape(-1, 2)
    t = np.linspace(0.0, MOTION_SECONDS / 2, 60)
    points = arm.forward_kinematics(pick_and_place(extents, t).q)  # (runs, time, point, xy)
    reach = np.linalg.norm(points[:, -1, 1], axis=-1)

    def draw(figure: Figure):
        axis = figure.subplots()
        turned = np.concatenate([np.zeros((len(points), 1, 2)), points[:, -1]], 1)
        along = np.linspace(0.0, 1.0, 40)[:, None, None, None]
        arms = turned[:, :-1] + along * np.diff(turned, axis=1)
        drawn = np.concatenate([points[:, :, 1].reshape(-1, 2), arms.reshape(-1, 2)])
        for k, path in enumerate(points):
            joints = np.vstack([np.zeros(2), path[-1]])
            axis.plot(*joints.T, color=FAINT, lw=2.5, alpha=0.45, solid_joinstyle="round")
            colour = COLOURS[k % len(COLOURS)]
            axis.plot(*path[:, 1].T, color=colour, ls=DASHES[k % len(DASHES)], lw=2)
            axis.plot(*path[-1, 1], "o", color=colour, ms=5)
            axis.text(*_free_place(path[-1, 1], drawn), str(k + 1), color=colour, **_CENTRED)
        rest = np.vstack([np.zeros(2), points[0, 0]])
        axis.plot(*rest.T, color=INK, lw=3.5, marker="o", ms=6, mfc="white", mec=INK)
        axis.set(xlabel="x, m", ylabel="y, m", aspect="equal")
        axis.margins(0.06)

    alt = (
        f"The arm from above at rest and at the turning points of {len(extents)} trajectories, "
        f"with the path of the hand; its distance from the shoulder at the turning points runs "
        f"from {reach.min():.2f} to {reach.max():.2f} m."
    )
    return illustrate(draw, alt, 5.2, 3.9)


def _free_place(point, drawn, distance: float = 0.035):
    """Where a label near a point is farthest from what is drawn, all in metres."""
    angle = np.arange(0.0, 2 * np.pi, np.pi / 12)
    places = point + distance * np.stack([np.cos(angle), np.sin(angle)], -1)
    room = np.linalg.norm(places[:, None] - drawn, axis=-1).min(-1)
    return places[room.argmax()]


def operations(
    counts: Mapping[str, Mapping[int, Operations]],
    published: Mapping[str, tuple[int, int]],
    band: tuple[float, float],
) -> Illustration:
    """Multiplications of each formulation by number of joints."""

    def draw(figure: Figure):
        axis = figure.subplots()
        axis.axhspan(*band, color=FAINT, alpha=0.16, lw=0)
        for k, (name, by_joints) in enumerate(counts.items()):
            look = dict(color=(*COLOURS, INK)[k % 7], ls=DASHES[k % len(DASHES)])
            values = [o.multiplications for o in by_joints.values()]
            axis.plot(
                list(by_joints), values, marker=_MARKERS[k % len(_MARKERS)], label=name, **look
            )
        for k, (name, point) in enumerate(published.items()):
            axis.plot(*point, "x+1*"[k % 4], color=INK, ms=10, mew=2, ls="none", label=name)
        axis.set(xlabel="joints", ylabel="multiplications", yscale="log")
        axis.set_xticks(sorted({n for by_joints in counts.values() for n in by_joints}))
        if figure.get_figwidth() <= NARROW:
            figure.legend(*axis.get_legend_handles_labels(), loc="outside upper left", ncols=2)
        else:
            axis.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))

    most = {name: max(v.items()) for name, v in counts.items()}
    listed = "; ".join(f"{name}: {o.multiplications:,}" for name, (_, o) in most.items())
    alt = f"Multiplications by number of joints, logarithmic. With most joints, {listed}."
    return illustrate(draw, alt, 7.4, 3.6)


def estimates(
    found: Mapping[str, Estimate], truth, names: Sequence[str], limit: float
) -> Illustration:
    """Estimated parameters and their stated confidence, as errors in percent.

    A thick bar holds the middle 95 % of repeated estimates, a dot their median. The thin line is as
    wide as the confidence interval that is stated on average. A number at the right says how often
    the interval held the truth. What lies beyond the axis is marked by an arrow.
    """
    number("limit", limit, 0.0, open_low=True)
    rows = list(found.items())
    shown = {name: [_summary(e, truth, name) for e in found.values()] for name in names}

    def draw(figure: Figure):
        axes = figure.subplots(1, len(names), sharey=True, squeeze=False)[0]
        for axis, name in zip(axes, names):
            axis.axvline(0.0, color=INK, lw=1)
            for y, (middle, low, high, half, share) in enumerate(shown[name]):
                colour = COLOURS[y % len(COLOURS)]
                centre = np.clip(middle, -limit, limit)
                ends = np.clip([middle - half, middle + half], -limit, limit)
                axis.plot(ends, [y, y], color=colour, lw=1.2)
                axis.plot(
                    np.clip([low, high], -limit, limit), [y, y], color=colour, lw=6, alpha=0.5
                )
                beyond = "<" if middle < -limit else ">" if middle > limit else "o"
                axis.plot(centre, y, beyond, color=colour, ms=6, clip_on=False)
                if share is not None:
                    axis.annotate(
                        f"{100 * share:.0f} %", (1.0, y), (3, 0), ("axes fraction", "data"),
                        textcoords="offset points", va="center", fontsize=8,
                    )  # fmt: skip
            axis.set(xlim=(-1.04 * limit, 1.04 * limit), xlabel=f"error of {name}, %")
            axis.set_yticks(range(len(rows)), [label for label, _ in rows])
            axis.set_ylim(len(rows) - 0.5, -0.5)

    alt = "Errors of estimated parameters in percent. "
    for y, (label, _) in enumerate(rows):
        parts = (f"{name} {shown[name][y][0]:.2g}" for name in names)
        alt += f"{label}: {', '.join(parts)}. "
    return illustrate(draw, alt.strip(), 7.4, 0.42 * len(rows) + 0.9)


def _summary(estimate: Estimate, truth, name: str):
    """Median, 2.5 % and 97.5 % points, stated half width (in %), share of hits or None."""
    k = list(estimate.names).index(name)
    true = finite_array("truth", truth, len(estimate.names))[k]
    error = 100 * (estimate.values[..., k] / true - 1)
    half = np.mean(100 * estimate.half_width()[..., k] / abs(true))
    share = estimate.covers(truth)[..., k].mean() if error.ndim else None
    return (*np.percentile(error, (50, 2.5, 97.5)), half, share)


def arm_sketch(arm: Arm, q) -> Illustration:
    """The arm seen from above at joint angles `q` (rad, shape (2,)), with its angles named."""
    q = finite_array("q", q, 2)
    (ex, ey), (hx, hy) = arm.forward_kinematics(q)

    def draw(figure: Figure):
        axis = figure.subplots()
        l1 = arm.lengths[0]
        axis.plot([0, 1.25 * l1], [0, 0], color=FAINT, ls=":")
        reach = 1.55
        axis.plot([ex, ex * reach], [ey, ey * reach], color=FAINT, ls=":")
        axis.plot([0, ex], [0, ey], color=COLOURS[0], lw=9, solid_capstyle="round", alpha=0.85)
        axis.plot([ex, hx], [ey, hy], color=COLOURS[1], lw=7, solid_capstyle="round", alpha=0.85)
        for x, y in ((0, 0), (ex, ey)):
            axis.add_patch(Circle((x, y), 0.022, facecolor="white", edgecolor=INK, zorder=3))
        for centre, start, angle, radius, name in (
            ((0, 0), 0.0, q[0], 0.20, "$q_1$"),
            ((ex, ey), q[0], q[1], 0.15, "$q_2$"),
        ):
            arc = np.linspace(start, start + angle, 40)
            x, y = centre[0] + radius * np.cos(arc), centre[1] + radius * np.sin(arc)
            axis.plot(x, y, color=INK, lw=1)
            middle = start + angle / 2
            axis.text(
                centre[0] + 1.3 * radius * np.cos(middle),
                centre[1] + 1.3 * radius * np.sin(middle),
                name, ha="center", va="center", fontsize=12,
            )  # fmt: skip
        axis.text(ex * 0.62 - 0.04, ey * 0.62 + 0.05, "link 1", ha="right")
        axis.text((ex + hx) / 2 - 0.05, (ey + hy) / 2 + 0.03, "link 2", ha="right")
        axis.text(0.02, -0.07, "shoulder", ha="left")
        axis.text(ex - 0.05, ey + 0.03, "elbow", ha="right")
        axis.text(hx + 0.03, hy + 0.02, "hand", ha="left")
        axis.set_aspect("equal")
        axis.margins(0.1)
        axis.axis("off")

    alt = (
        f"The arm from above: link 1 turned by q1 = {np.rad2deg(q[0]):.0f} degrees from the "
        f"x axis, link 2 by q2 = {np.rad2deg(q[1]):.0f} degrees from link 1's direction."
    )
    return illustrate(draw, alt, 4.6, 3.0)
