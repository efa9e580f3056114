"""The lesson *Dynamics*: figures, exercises, and what its claims measure."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from ddlib.analysis import linear_residual, share_of_other_joint, share_of_velocity_terms
from ddlib.dynamics import (
    CMU_DD_ARM_II as ARM,
    PUMA_560,
    PUMA_560_ROTORS,
    Arm,
    Link,
    Operations,
    costs,
    lagrange_euler,
    newton_euler,
    recursive_lagrange,
)
from ddlib.figures.style import (
    FAINT,
    INK,
    NARROW,
    TONES,
    Illustration,
    illustrate,
    looks,
)
from ddlib.identification import (
    FRICTION,
    RIGID,
    Estimate,
    by_modulation,
    excitation,
    least_squares,
    repeat,
    true_parameters,
)
from ddlib.setups import JOINT_DAMPING, STATE_FEEDBACK
from ddlib.tables import quote, scientific
from ddlib.trajectories import APPENDIX_I, pick_and_place, random_extents
from workshop.chapters.exercises import Exercise, MultipleOf, judging
from workshop.report.evidence.verdicts import Measured, judged

_MARKERS = "os^DvPX"
_LINKS = (Link(14.0, 0.50, 0.22, 0.40), Link(14.0, 0.40, 0.09, 0.60))
_TIMES = np.arange(300) * 0.01


def _quoted() -> None:
    """What gears hide."""
    motion = pick_and_place(APPENDIX_I[0], _TIMES)
    share = 100 * share_of_other_joint(ARM, motion, [1.0, 100.0], PUMA_560_ROTORS[0])[:, 1]
    quote("dynamics-gear-direct", share[0])
    quote("dynamics-gear-hundred", share[1])


def _exercise(number: int, given: float = 0.0) -> Exercise:
    """An exercise; the first needs the lesson's b / d, the fourth its b."""
    if number == 1:
        lag = 1 + given
        slips = (
            (lag, "the sign. Which way does the forearm turn?"),
            (-1.0, "then the forearm would keep its direction. Does it?"),
        )
        reason = "seen from above, the forearm even turns backwards."
        return Exercise(
            "number",
            -lag,
            reason,
            slips,
            "the elbow's torque is zero. What follows from the second row?",
            unit="rad/s²",
        )
    elif number == 2:
        reason, unseen = (
            "this change leaves both torques as they are.",
            MultipleOf((-2.0, 1.0, -1.0)),
        )
        return Exercise(
            "numbers", unseen, reason, otherwise="write down both torques with the elbow straight."
        )
    elif number == 4:
        slips = (
            (6 * given, "the sign. Does the elbow, as it bends further, make M larger or smaller?"),
            (0.0, "no joint accelerates, but the elbow turns, and M depends on its angle."),
            (-12 * given, "a half: the energy has one before its M."),
        )
        hint = "no joint accelerates. Which part of the energy still changes in time?"
        reason = "no motor took this energy, so the model lacks something."
        return Exercise("number", -6 * given, reason, slips, hint, unit="W")
    else:
        size = lambda x: excitation(pick_and_place(np.reshape(x, (2, 2)), _TIMES))  # noqa: E731
        slips = (
            (lambda x: np.min(x) < 0 or np.max(x) > 45, "extents must lie between 0 and 45°."),
            (
                lambda x: np.isinf(size(x)),
                "some combination of the three parameters leaves no trace.",
            ),
            (lambda x: size(x) >= 7, "the condition number must be below 7, and yours is not yet."),
        )
        right = lambda x: np.min(x) >= 0 and np.max(x) <= 45 and size(x) < 7  # noqa: E731
        otherwise = "give two pairs of extents."
        return Exercise(
            "numbers",
            right,
            "a few well-chosen motions can do better than many.",
            slips,
            otherwise,
            count=4,
        )


check = judging(_exercise)


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
            look = looks(counts)[name].line
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
    by_method: Mapping[str, Estimate], truth, names: Sequence[str], limit: float
) -> Illustration:
    """Estimated parameters and their stated confidence, as errors in percent.

    A thick bar holds the middle 95 % of repeated estimates, a dot their median. The thin line is as
    wide as the confidence interval that is stated on average. A number at the right says how often
    the interval held the truth. What lies beyond the axis is marked by an arrow.
    """
    rows = list(by_method.items())
    shown = {name: [_summary(e, truth, name) for e in by_method.values()] for name in names}

    def draw(figure: Figure):
        axes = figure.subplots(1, len(names), sharey=True, squeeze=False)[0]
        for axis, name in zip(axes, names):
            axis.axvline(0.0, color=INK, lw=1)
            for y, (middle, low, high, half, share) in enumerate(shown[name]):
                centre = np.clip(middle, -limit, limit)
                ends = np.clip([middle - half, middle + half], -limit, limit)
                axis.plot(ends, [y, y], color=INK, lw=1.2)
                axis.plot(np.clip([low, high], -limit, limit), [y, y], color=INK, lw=6, alpha=0.4)
                beyond = "<" if middle < -limit else ">" if middle > limit else "o"
                axis.plot(centre, y, beyond, color=INK, ms=6, clip_on=False)
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
    error = 100 * (estimate.values[..., k] / truth[k] - 1)
    half = np.mean(100 * estimate.half_width()[..., k] / abs(truth[k]))
    share = estimate.covers(truth)[..., k].mean() if error.ndim else None
    return (*np.percentile(error, (50, 2.5, 97.5)), half, share)


def arm_sketch(arm: Arm, q) -> Illustration:
    """The arm seen from above at joint angles `q` (rad, shape (2,)), with its angles named."""
    (ex, ey), (hx, hy) = arm.forward_kinematics(q)

    def draw(figure: Figure):
        axis = figure.subplots()
        l1 = arm.lengths[0]
        axis.plot([0, 1.25 * l1], [0, 0], color=FAINT, ls=":")
        reach = 1.55
        axis.plot([ex, ex * reach], [ey, ey * reach], color=FAINT, ls=":")
        axis.plot(
            [0, ex], [0, ey], color=TONES["shoulder"], lw=9, solid_capstyle="round", alpha=0.85
        )
        axis.plot(
            [ex, hx], [ey, hy], color=TONES["elbow"], lw=7, solid_capstyle="round", alpha=0.85
        )
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
    return illustrate(draw, alt, 3.4, 2.2)


# --- what the claims of the chapter measure

_SETUP = STATE_FEEDBACK


def nonlinearity() -> Measured:
    """What a linear model leaves unexplained on the pick-and-place family (judged), on a cube."""
    family = linear_residual(ARM, *pick_and_place(random_extents(100, seed=0), _TIMES))
    cube = np.random.default_rng(0).uniform(-np.pi, np.pi, (3, 20_000, 2))
    text = (
        f"a linear model leaves {100 * family:.0f} % on the pick-and-place family, "
        f"{100 * linear_residual(ARM, *cube):.0f} % on the cube of section 6"
    )
    return Measured(family, text)


def terms() -> Measured:
    """Whether the torque is the sum of terms of known origin; sizes of the velocity terms."""
    motion = pick_and_place(APPENDIX_I[0], _TIMES)
    parts = ARM.torque_terms(*motion)
    bilinear = np.einsum("tij,tj->ti", ARM.mass_matrix(motion.q), motion.qdd)
    bilinear += np.einsum("tij,tj->ti", ARM.coriolis_matrix(motion.q, motion.qd), motion.qd)
    gap = np.abs(sum(parts.values()) - bilinear).max()
    share = 100 * share_of_velocity_terms(ARM, motion)
    text = f"velocity terms are {share[0]:.0f} % and {share[1]:.0f} % of the torque, trajectory 1"
    return Measured(bool(gap < 1e-12), text)


def multiplications() -> Measured:
    """Fewest multiplications by the recursive Lagrangian form of six joints; by others."""
    recursive, zeros, custom = (
        costs.count_operations(recursive_lagrange, PUMA_560, known).multiplications
        for known in costs.KNOWLEDGE
    )
    closed = costs.count_operations(lagrange_euler, PUMA_560).multiplications
    newton = costs.count_operations(newton_euler, PUMA_560).multiplications
    two = costs.count_closed_form(_LINKS, shared=True).multiplications
    text = f"Lagrangian form of six joints: closed {closed:,}, recursive {recursive:,}, "
    text += f"{zeros:,} with its zeros known, {custom:,} customised to the Puma; "
    text += f"Newton-Euler {newton:,}; two joints, closed {two}"
    return Measured(min(recursive, zeros, custom), text)


def recursion() -> Measured:
    """How many times fewer multiplications the recursive Lagrangian form needs, six joints."""
    ways = lagrange_euler, recursive_lagrange, newton_euler
    closed, lagrange, newton = (costs.count_operations(f, PUMA_560).multiplications for f in ways)
    text = f"six joints: {closed / lagrange:.0f} times fewer multiplications, "
    return Measured(closed / lagrange, f"{text}{closed / newton:.0f} times by Newton-Euler")


def extra_links(samples: int = 4000) -> Measured:
    """Share of coupling in the torque with four joints of a Puma moving over that with two.

    Coupling is a joint's torque less that of the same state with the other joints at rest.
    """
    arm = PUMA_560.first(4)
    rng = np.random.default_rng(0)
    q = rng.uniform(-np.pi, np.pi, (samples, 4))
    motion = rng.uniform(-1, 1, (2, samples, 4))

    def torque(*moving):
        held = np.isin(np.arange(4), moving)
        return arm.inverse_dynamics(q, *(held * part for part in motion)) - arm.inverse_dynamics(
            q, *(0 * motion)
        )

    alone = np.stack([torque(joint)[:, joint] for joint in range(4)], -1)
    share = {}
    for n in (2, 4):
        whole = torque(*range(n))[:, :n]
        share[n] = np.sqrt(((whole - alone[:, :n]) ** 2).mean(0) / (whole**2).mean(0))
    two, four = (", ".join(f"{100 * x:.0f}" for x in share[n]) for n in (2, 4))
    text = f"other joints cause {two} % of the torques of a Puma's two joints, {four} % of its four"
    return Measured(float(share[4].mean() / share[2].mean()), text)


def ignoring_terms() -> Measured:
    """Share of the multiplications that is left without velocity terms, and the error."""
    full, cheap = (
        costs.count_closed_form(_LINKS, shared=True, velocity_terms=v).multiplications
        for v in (True, False)
    )
    motion = pick_and_place(APPENDIX_I[[0, 1, 2, 5]], _TIMES)
    lost = 100 * share_of_velocity_terms(ARM, motion, effects=_SETUP.effects)
    text = (
        f"{cheap} for {full} multiplications, at {lost[0]:.0f} % and {lost[1]:.0f} % of the torque"
    )
    return Measured(cheap / full, text)


@cache
def _coverage() -> np.ndarray:
    """Whether each interval holds the truth: 400 recordings, seven parameters of two setups."""
    held = []
    for setup in (STATE_FEEDBACK, JOINT_DAMPING):
        plant = (setup.arm, setup.controller, APPENDIX_I[:5], setup.effects)
        many = repeat(*plant, repetitions=400, seed=1, spread=0.01)
        truth = true_parameters(setup.arm, setup.effects, RIGID + FRICTION)
        held.append(least_squares(by_modulation(many)).covers(truth))
    return np.concatenate(held, -1)


def identification() -> Measured:
    """How often 95 % intervals hold the truth in 400 recordings, the worst of two setups."""
    share = 100 * _coverage().mean(0)
    text = f"95 % intervals hold the truth in {share.min():.0f} to {share.max():.0f} % of 400"
    return judged(lambda drawn: drawn.mean(1).min(-1), _coverage(), text=text)


def gears() -> Measured:
    """The shoulder's share of the elbow's torque without gears over that behind 100 to 1."""
    motion = pick_and_place(APPENDIX_I[0], _TIMES)
    direct, geared = share_of_other_joint(ARM, motion, [1.0, 100.0], PUMA_560_ROTORS[0])[:, 1]
    text = f"the shoulder causes {100 * direct:.0f} % of the elbow's torque, "
    text += f"{100 * geared:.0f} % behind gears of 100 to 1"
    return Measured(float(direct / geared), text)


def shoulder_position() -> Measured:
    """Largest change of the torque when the whole arm is turned about its shoulder, N m."""
    q, qd, qdd = np.random.default_rng(0).uniform(-np.pi, np.pi, (3, 1000, 2))
    turned = ARM.inverse_dynamics(q + np.array([1.0, 0.0]), qd, qdd)
    change = float(np.abs(turned - ARM.inverse_dynamics(q, qd, qdd)).max())
    return Measured(change, f"absent from the equations (largest change {scientific(change)} N m)")
