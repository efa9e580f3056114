"""What the lesson *What feedback does* shows, quotes and asks, and what its claims measure."""

from __future__ import annotations

import control
import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from scipy.optimize import brentq

from ddlib.control import linear
from ddlib.dynamics import CMU_DD_ARM_II
from ddlib.effects import Effects, Load
from ddlib.figures.style import FAINT, INK, TONES, Illustration, illustrate, legend_above, looks
from ddlib.setups import JOINT_DAMPING_KP as KP, JOINT_DAMPING_VISCOUS as VISCOUS
from ddlib.simulation import CONTROL_STEP
from ddlib.tables import quote, significant
from ddlib.trajectories import APPENDIX_I
from workshop.chapters.exercises import Exercise, OneOf, judging
from workshop.chapters.feedforward import _errors, _geared, _rms
from workshop.report.evidence.verdicts import Measured


def _quoted() -> None:
    """How stiff the shoulder's spring may be alone, as a multiple of its own limit."""
    joints = linear.plant(CMU_DD_ARM_II.mass_matrix([0.0, 0.0]), VISCOUS)

    def growth(times):
        """Of the fastest swing in a period, the shoulder's spring some times as stiff."""
        loop = linear.closed_loop(joints, (times * KP[0], KP[1]), period=CONTROL_STEP)
        return np.log(np.abs(loop.poles()).max())

    rule = 2 * VISCOUS[0] / CONTROL_STEP  # N m/rad
    quote("pid-alone", KP[0] / rule * brentq(growth, 1.0, 40.0))


def late_helper(lateness: float = 1 / 14) -> Illustration:
    """One swing of the elbow on its spring, which is late by a share of the swing.

    Over time, and as a loop of torque over angle, whose area is the energy that the swing gains.
    """
    stiffness, swing = KP[1], np.deg2rad(2.0)  # N m/rad, rad
    turn = 2 * np.pi * np.linspace(0, 1, 721)
    angle = swing * np.cos(turn)
    torques = {
        "spring on time": -stiffness * angle,
        "late spring": -stiffness * swing * np.cos(turn - 2 * np.pi * lateness),
    }
    look = looks(("angle", *torques), {"late spring": "elbow", "spring on time": "wanted"})
    late = torques["late spring"]
    helps = (late * torques["spring on time"] < 0) & (late * -np.sin(turn) > 0)

    def draw(figure: Figure):
        over_time, over_angle = figure.subplots(1, 2)
        over_time.axhline(0, color=FAINT, lw=0.8)
        over_time.fill_between(
            turn / (2 * np.pi), -1, 1, helps, color=TONES["elbow"], alpha=0.2, lw=0
        )
        shown = {"angle": angle / swing}
        shown |= {name: torque / (stiffness * swing) for name, torque in torques.items()}
        for name, values in shown.items():
            over_time.plot(turn / (2 * np.pi), values, label=name, **look[name].line)
        over_time.set(xlabel="time, swings", ylabel="share of the largest")
        x = np.rad2deg(angle)
        over_angle.fill(x, late, color=TONES["elbow"], alpha=0.2, lw=0)
        for name, torque in torques.items():
            over_angle.plot(x, torque, label=name, **look[name].line)
        over_angle.set(xlabel="angle, °", ylabel="torque, N m")
        for k in (190, 550):  # just past the middle, there and back
            way = {"arrowstyle": "->", "color": TONES["elbow"], "lw": 1.5}
            ends = [(x[at], late[at]) for at in (k - 25, k)]
            over_angle.annotate("", xytext=ends[0], xy=ends[1], arrowprops=way)
        place = {"transform": over_angle.transAxes, "ha": "right", "va": "top"}
        over_angle.text(0.98, 0.97, "area: energy\ngained in a swing", **place)
        legend_above(figure, *over_time.get_legend_handles_labels())

    alt = "A late spring pushes on after the middle; its torque runs round a loop over the angle."
    return illustrate(draw, alt, 7.0, 2.2)


def the_loop() -> Illustration:
    """The loop of one joint as a block diagram, cut open."""
    cut = 0.45  # where the line back is cut

    def draw(figure: Figure):
        axis = figure.subplots()
        axis.set(xlim=(0, 10), ylim=(0.25, 2.4), aspect="equal")
        axis.axis("off")
        words = {"ha": "center", "va": "center", "fontsize": 10}
        for x, name in ((3.6, "law C"), (7.2, "joint P")):
            axis.add_patch(Rectangle((x - 0.7, 1.25), 1.4, 0.7, fill=False, ec=INK, lw=1.5))
            axis.text(x, 1.6, name, **words)
        for x in (1.6, 5.4):
            axis.plot(x, 1.6, "o", ms=11, mfc="none", mec=INK, mew=1.5)
        along = [(0.5, 1.45), (1.75, 2.9), (4.3, 5.25), (5.55, 6.5), (7.9, 9.5)]
        ends = [((start, 1.6), (end, 1.6)) for start, end in along]
        ends += [((5.4, 2.3), (5.4, 1.75)), ((1.6, cut), (1.6, 1.45))]
        look = {"arrowstyle": "-|>", "color": INK, "shrinkA": 0, "shrinkB": 0}
        for start, end in ends:
            axis.annotate("", xy=end, xytext=start, arrowprops=look)
        axis.plot([9, 9, 5.6], [1.6, cut, cut], color=INK, lw=1)
        axis.plot([4.9, 1.6], [cut, cut], color=INK, lw=1)
        axis.plot([5.6, 4.9], [cut, cut], "o", mfc="white", mec=TONES["wanted"])
        axis.text(5.25, cut + 0.3, "the cut", color=TONES["wanted"], **words)
        names = {(0.3, 1.6): "qᵣ", (2.3, 1.85): "e", (4.7, 1.85): "torque", (5.95, 2.2): "load",
                 (9.75, 1.6): "q", (1.35, 1.2): "−"}  # fmt: skip
        for (x, y), name in names.items():
            axis.text(x, y, name, **words)

    alt = (
        "Target, sum, law C, sum with the load, joint P, angle; a line back, cut open, to the sum."
    )
    return illustrate(draw, alt, 7.0, 1.55)


def _exercise(number: int, inertia: float, friction: float, period: float) -> Exercise:
    """An exercise, for a joint and a control period."""

    def quick(gains):
        joint, t = linear.plant(inertia, friction), np.linspace(0, 4, 4001)
        loop = linear.closed_loop(joint, gains[0], kd=gains[1])
        angle = control.forced_response(loop, t, [1 + 0 * t, 0 * t]).outputs[0]
        late = linear.opened_loop(joint, gains[0], 0, gains[1], period, 5)
        return (
            angle.max() <= 1.05,
            np.abs(angle[t > 0.55] - 1).max() <= 0.01,
            linear.margins(late).phase_deg >= 60,
        )

    def only(place):
        """Whether the demand of this place is the first that is not met."""
        return lambda gains: not quick(gains)[place] and all(quick(gains)[:place])

    limit, root = friction / period, np.sqrt(2)
    if number == 1:
        slips = [
            (2 * limit, "that is the limit without the delay."),
            (limit, "the hold costs half a period, the delay a whole one. Add them."),
        ]
        return Exercise(
            "number",
            limit / 1.5,
            "the spring is one and a half periods late.",
            slips,
            "How late is the spring, and what torque along the velocity is that?",
            unit="N m/rad",
        )
    elif number == 2:
        slips = [
            (only(0), "it overshoots by more than 5 %. What raises the damping ratio?"),
            (only(1), "it has not settled after 0.55 s. What makes it die out sooner?"),
            (only(2), "the margin is below 60°. Is the crossover too high for the delay?"),
        ]
        return Exercise(
            "numbers",
            lambda gains: all(quick(gains)),
            "it is damped enough, and its crossover is low enough for the delay.",
            slips,
            count=2,
            unless=[(lambda gains: min(gains) <= 0, "give two positive gains, kp and kd.")],
        )
    else:
        any_ = np.nan
        alike, twice = (any_, 1, any_), (any_, 2, any_)
        slips = [
            ((2, any_, any_), "the natural frequency has a root in it."),
            (OneOf(alike, twice), "in ζ both gains stand, one under a root."),
            ((any_, any_, 2), "does a stiffer spring give way more?"),
            (
                OneOf((any_, any_, root / 2), (any_, any_, 0.25)),
                "a spring's angle is load over k_p.",
            ),
        ]
        return Exercise(
            "numbers",
            (root, root, 0.5),
            "frequency and damping by √2, the angle by a half.",
            slips,
            "put 2 k_p for k_p into ω, into ζ and into the angle.",
        )


check = judging(_exercise)


# --- what the claims of the chapter measure


def disturbances(load: float = 5.0) -> Measured:
    """How many times smaller feedback makes the error under a constant load."""
    effects = Effects(actuator=(Load((load, 0.0)),))
    with_, without = _rms(_errors([1, 1], [1, 0], effects))
    text = f"{load:g} N m on the shoulder: {significant(with_, 2)}° for "
    text += f"{significant(without, 2)}° without"
    return Measured(float(without / with_), text)


def backdriven(gear: float = 100.0) -> Measured:
    """How far the moving shoulder throws the elbow off, without gears over behind gears."""
    direct, geared = np.abs(_geared(gear, False, APPENDIX_I[3])[..., 1]).max(1)
    text = f"the shoulder throws a resting elbow off by {direct:.1f}°, "
    text += f"behind gears of {gear:g} to 1 by {geared:.2f}°"
    return Measured(float(direct / geared), text)
