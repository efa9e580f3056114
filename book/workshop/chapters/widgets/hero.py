"""The hero of the first page: two rows of weights that look alike; a balance tells them apart."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
import traitlets as t
from matplotlib.patches import Circle, PathPatch, Polygon
from matplotlib.path import Path as Curve

from ddlib.figures import FAINT, INK, TONES, Illustration, illustrate
from ddlib.learning import Scaler, TorqueModel, Weights
from ddlib.paper import TEST_TRAJECTORY
from ddlib.setups import JOINT_DAMPING
from ddlib.simulation import CONTROL_STEP, LOG_STEP
from ddlib.trajectories import APPENDIX_I, MOTION_SECONDS
from ddlib.widgets.base import PageWidget
from ddlib.widgets.engine._plain import gains, networks, plant
from ddlib.widgets.scripts import bundle, styles
from ddlib.widgets.still import START, encoded
from workshop import BOOK
from workshop.report import results

_HERE = Path(__file__).parent

_REST = 0.4  # s before the motion begins
_SHOWN = 150  # samples of the motion in which the arm stops where the shoulder's torque is largest
_FORCE = 35.0  # N, most that the reader's pull can be: its torques are among those of the training
_SPRING = 150.0  # N/m, stiffness of the pull on the hand
_STOPS = {
    "low": np.deg2rad([-80.0, -120.0]).tolist(),
    "high": np.deg2rad([50.0, 120.0]).tolist(),
    "stiffness": [300.0, 60.0],
    "damping": [10.0, 2.0],
}
"""Rubber stops that keep the arm in the picture, N m/rad and N m s/rad."""

_FACING = np.deg2rad(85.0)  # which way the arm points at zero angles, as in hero.js

_SPOKEN = (
    "Two networks, A and B, read the positions of an arm's joints in a window of 21 samples. You "
    "see one row of weights of each, from the shoulder's window to a hidden unit: both are bent "
    "like a parabola. One network learnt the torques of this arm. Choose which, then press Weigh, "
    "or the key W: a balance holds each network's inertia against the arm's. To move the arm, go "
    "to its hand and hold an arrow key."
)
_ALT = (
    "A two-link arm in the middle of a motion. The path of each joint in a window of 21 samples "
    "hangs below the straight line between its ends. From the shoulder's window, threads lead to "
    "two rows of weights, A and B: both are bent like a parabola. Beside each row is a balance, "
    "the arm's {arm:.1f} kg m² on one pan, a question mark on the other."
)


@dataclass(frozen=True)
class Twin:
    """One of the two networks."""

    name: str  #: Its letter.
    learnt: str  #: Whose torques it learnt.
    model: TorqueModel  #: One network; its first hidden unit's row for the shoulder is shown.
    inertia: float  #: What is read from all of its rows, kg m²: the shoulder's.


@cache
def twins() -> tuple[Twin, Twin]:
    """The two of the study `twins`."""
    kinds = results.read("twins")["kinds"]
    told = {"A": ("this arm", "the arm"), "B": ("a spring", "position alone")}
    return tuple(
        Twin(name, learnt, _model(kinds[kind]), float(kinds[kind]["inertia"][0]))
        for name, (learnt, kind) in told.items()
    )


def _model(kept) -> TorqueModel:
    weights = Weights(**{name: np.array(x, float) for name, x in kept["weights"].items()})
    scalers = (
        Scaler(kept[name]["low"], kept[name]["high"], tuple(kept[name]["target"]))
        for name in ("inputs", "outputs")
    )
    return TorqueModel(weights, *scalers, step=LOG_STEP)


class Hero(PageWidget):
    """An arm to throw, two rows of weights that look alike, and a balance for each network.

    The arm, and what the networks make of its motion, are computed in the page.

    Parameters
    ----------
    pair : sequence of Twin
        Two networks of one window.
    arm : float
        The arm's own inertia at the shoulder, kg m²: the mean of the motion that A learnt.
    """

    _esm = bundle(_HERE / "hero.js")
    _css = styles(_HERE / "hero.css", _HERE / "balance.css")

    weights = t.Bytes(help="both networks' weights as float32", read_only=True).tag(sync=True)
    guess = t.Enum(("", "A", "B"), "", help="which one has met the arm").tag(sync=True)
    weighed = t.Bool(False, help="whether the networks lie on the balances").tag(sync=True)

    def __init__(self, pair: Sequence[Twin], arm: float):
        specs, weights = networks(twin.model for twin in pair)
        for spec, twin in zip(specs, pair):
            spec.update(name=twin.name, learnt=twin.learnt, weight=twin.inertia)
        width = pair[0].model.weights.width
        outputs = pair[0].model.outputs
        spec = {
            "title": "Which row has met this arm?",
            "spoken": _SPOKEN,
            "plant": plant(JOINT_DAMPING.arm, JOINT_DAMPING.effects),
            "gains": gains(JOINT_DAMPING.controller),
            "networks": specs,
            "width": width,
            "arm": arm,
            "step": CONTROL_STEP,
            "every": round(LOG_STEP / CONTROL_STEP),
            "motion": MOTION_SECONDS,
            "rest": _REST,
            "extents": np.deg2rad(APPENDIX_I[TEST_TRAJECTORY - 1]).tolist(),
            "moment": LOG_STEP
            * (_moment() + width // 2),  # the arm is drawn in the window's middle
            "force": _FORCE,
            "spring": _SPRING,
            "stops": _STOPS,
            "torques": np.maximum(-outputs.low, outputs.high).tolist(),
        }
        picture = still(pair, arm)
        self._keep(spec=spec, weights=weights, still=START + encoded(picture.svg))
        self._keep(still_alt=picture.alt)
        super().__init__()


@cache
def _run():
    return JOINT_DAMPING.record(APPENDIX_I[[TEST_TRAJECTORY - 1]])[0]


def _moment() -> int:
    """The sample of the motion at which the arm stops."""
    return int(_run().tau_true[_run().motion][:_SHOWN, 0].argmax())


def still(pair: Sequence[Twin], arm: float) -> Illustration:
    """What one sees before the reader does anything."""
    centre = _run().motion.start + _moment()
    half = pair[0].model.weights.width // 2
    paths = np.rad2deg(_run().q[centre - half : centre + half + 1]).T

    def draw(figure):
        axis = figure.subplots()
        axis.set(xlim=(0, 1120), ylim=(550, 0), aspect="equal")
        axis.axis("off")
        _draw_arm(axis, _run().q_true[centre], _run().tau_true[centre, 0])
        beads = _draw_window(axis, "shoulder", paths[0], (482, 736, 258), (440, 232, "right"), 32)
        _draw_window(axis, "elbow", paths[1], (230, 370, 52), (230, 36, "left"), 40)
        for twin, level, scale in zip(pair, (92, 424), (40, 336)):
            _draw_row(axis, twin, level, beads)
            _draw_balance(axis, twin.name, arm, scale)
        largest = " and ".join(f"{_row(x)[1]:.2g} in {x.name}" for x in pair)
        words = f"each row to its own height: the largest weight is {largest}"
        axis.text(609, 518, words, ha="center", fontsize=10.5)

    return illustrate(draw, _ALT.format(arm=arm), 1120 / 96, 550 / 96)


def _row(twin: Twin) -> tuple[np.ndarray, float]:
    """The row that is shown, to a height of one, and its height."""
    row = twin.model.weights.hidden_weights[0, 0]
    return row / np.abs(row).max(), float(np.abs(row).max())


def _draw_arm(axis, q, torque):
    base = np.array([122.0, 444.0])
    turned = np.cumsum(q) + _FACING
    lengths = 335 * np.array(JOINT_DAMPING.arm.lengths)
    steps = lengths[:, None] * np.stack([np.cos(turned), -np.sin(turned)], -1)
    places = np.vstack([base, base + np.cumsum(steps, 0)])
    axis.plot([78, 158], [475, 475], color=FAINT, lw=1.2)
    axis.plot([100, 92], [432, 475], color=FAINT, lw=1.2)
    axis.plot([136, 144], [432, 475], color=FAINT, lw=1.2)
    for k, joint in enumerate(("shoulder", "elbow")):
        axis.plot(*places[k : k + 2].T, color=TONES[joint], lw=17, solid_capstyle="round")
    for place, joint, size in zip(places, ("shoulder", "elbow", "elbow"), (19, 16, 14)):
        axis.plot(*place, "o", ms=size, mfc="white", mec=TONES[joint], mew=4)
    shoulder, elbow = (places[1:] + places[:-1]) / 2
    bowed = shoulder, np.add(shoulder, (100, 30)), (350, 258), (472, 258)
    _thread(axis, bowed, color=TONES["shoulder"], ls=":", lw=1.4)
    rising = elbow, np.subtract(elbow, (0, 60)), (300, 150), (300, 86)
    _thread(axis, rising, color=TONES["elbow"], ls=":", lw=1.4)
    angles = turned[0] + np.linspace(0, 1.7 * torque / 62, 40)
    arc = base[:, None] + 62 * np.stack([np.cos(angles), -np.sin(angles)])
    axis.plot(*arc[:, :-4], color=INK, lw=3.5)
    axis.annotate("", arc[:, -1], arc[:, -5], arrowprops={"color": INK, "width": 1, "headwidth": 9})
    axis.text(38, 20, "torque", fontsize=11)
    axis.plot([0, 30], [15, 15], color=INK, lw=3.5)


def _draw_window(axis, joint, path, place, name, scale):
    """Beads against their chord; where they are."""
    left, right, level = place
    x = np.linspace(left, right, path.size)
    bent = path - np.linspace(path[0], path[-1], path.size)
    y = level - scale * bent
    axis.add_patch(Polygon(np.stack([x, y], -1), color=TONES["window"], alpha=0.26, lw=0, zorder=3))
    axis.plot([left, right], [level, level], "--", color=FAINT, lw=1.2, zorder=3)
    axis.plot(x, y, "o", ms=6, color=TONES[joint], mec="white", zorder=4)
    words = {"color": TONES[joint], "fontweight": "bold", "fontsize": 11}
    axis.text(name[0], name[1], f"{joint}, 0.2 s", ha=name[2], **words)
    return x, y


def _thread(axis, along, **look):
    codes = [Curve.MOVETO, *[Curve.CURVE4] * 3]
    axis.add_patch(PathPatch(Curve(along, codes), fill=False, capstyle="butt", **look))


def _draw_row(axis, twin, level, beads):
    row, _ = _row(twin)
    x = np.linspace(462, 756, row.size)
    for weight, left, start, end in zip(row, *beads, x):
        middle = (start + level) / 2
        along = (left, start), (left, middle), (end, middle), (end, level)
        _thread(axis, along, color=TONES["network"], alpha=0.4, lw=5.2 * abs(weight) + 0.6)
        if weight < 0:
            _thread(axis, along, color="white", lw=5.2 * abs(weight))
    axis.plot([454, 764], [level, level], color=FAINT, lw=1)
    tips = level - 54 * row
    axis.vlines(x, level, tips, color=TONES["network"], lw=2)
    for sign, fill in ((row > 0, TONES["network"]), (row <= 0, "white")):
        axis.plot(x[sign], tips[sign], "o", ms=6.5, mfc=fill, mec=TONES["network"], mew=1.6)
    axis.plot(414, level, "o", ms=24, color=TONES["network"])
    look = {"ha": "center", "va": "center_baseline", "color": "white", "fontweight": "bold"}
    axis.text(414, level, twin.name, fontsize=13, **look)


def _draw_balance(axis, name, arm, top):
    post = np.array([(958, 0), (954, 128), (926, 138), (998, 138), (970, 128), (966, 0)])
    axis.add_patch(Polygon(np.add(post, (0, top)), color=FAINT, lw=0))
    axis.plot([858, 1066], [top, top], color=INK, lw=3.5, solid_capstyle="round")
    axis.plot(962, top, "o", ms=10, mfc="white", mec=INK, mew=2.2)
    floor = top + 58
    for x in (858, 1066):
        axis.plot([x - 32, x, x + 32], [floor, top, floor], color=FAINT, lw=1.1)
        axis.plot([x - 40, x + 40], [floor, floor], color=FAINT, lw=2.5)
    block = np.array([(829, 0), (833, -38), (883, -38), (887, 0)])
    axis.add_patch(Polygon(np.add(block, (0, floor)), color=INK, lw=0, zorder=3))
    axis.add_patch(Circle((858, floor - 42), 7, color=INK, lw=0, zorder=3))
    look = {"ha": "center", "fontweight": "bold"}
    axis.text(858, floor - 19, f"{arm:.1f}", color="white", fontsize=12, zorder=4, **look)
    axis.text(858, floor - 6, "kg m²", color="white", fontsize=8.5, zorder=4, **look)
    axis.text(1066, floor - 12, "?", color=TONES["network"], fontsize=14, **look)
    axis.text(858, floor + 24, "this arm", ha="center", fontsize=11)
    axis.text(1066, floor + 24, name, color=TONES["network"], fontsize=11, **look)


if __name__ == "__main__":  # README's picture
    still(twins(), results.read("twins")["arm"]).save(BOOK / "_static" / "readme.svg")
