"""Sections 1 and 2: what the paper says of the arm's dynamics, of their cost and identification."""

from __future__ import annotations

from functools import cache

import numpy as np

from ddlib.analysis import linear_residual, share_of_other_joint, share_of_velocity_terms
from ddlib.dynamics import (
    CMU_DD_ARM_II,
    PUMA_560,
    PUMA_560_ROTORS,
    Link,
    costs,
    lagrange_euler,
    newton_euler,
    recursive_lagrange,
)
from ddlib.evidence.verdicts import Measured, over_members
from ddlib.experiments import STATE_FEEDBACK
from ddlib.identification import (
    FRICTION,
    RIGID,
    by_modulation,
    least_squares,
    repeat,
    true_parameters,
)
from ddlib.tables import scientific
from ddlib.trajectories import APPENDIX_I, pick_and_place, random_extents

ARM = CMU_DD_ARM_II
TIMES = np.arange(300) * 0.01
LINKS = (Link(14.0, 0.50, 0.22, 0.40), Link(14.0, 0.40, 0.09, 0.60))


def nonlinearity() -> Measured:
    """What a linear model leaves unexplained on the pick-and-place family (judged), on a cube."""
    family = linear_residual(ARM, *pick_and_place(random_extents(100, seed=0), TIMES))
    cube = np.random.default_rng(0).uniform(-np.pi, np.pi, (3, 20_000, 2))
    text = (
        f"a linear model leaves {100 * family:.0f} % on the pick-and-place family, "
        f"{100 * linear_residual(ARM, *cube):.0f} % on the cube of section 6"
    )
    return Measured(family, text)


def terms() -> Measured:
    """Whether the torque is the sum of terms of known origin; sizes of the velocity terms."""
    motion = pick_and_place(APPENDIX_I[0], TIMES)
    parts = ARM.torque_terms(*motion)
    bilinear = np.einsum("tij,tj->ti", ARM.mass_matrix(motion.q), motion.qdd)
    bilinear += np.einsum("tij,tj->ti", ARM.coriolis_matrix(motion.q, motion.qd), motion.qd)
    gap = np.abs(sum(parts.values()) - bilinear).max()
    share = 100 * share_of_velocity_terms(ARM, motion)
    text = f"velocity terms are {share[0]:.0f} % and {share[1]:.0f} % of the torque, trajectory 1"
    return Measured(bool(gap < 1e-12), text)


def multiplications() -> Measured:
    """Multiplications of one cycle by the recursive Lagrangian form (judged), and by others.

    Six general joints of which nothing is known; beside it the same form with the zeros of the
    method known, and customised to the arm.
    """
    recursive, zeros, custom = (
        costs.count(recursive_lagrange, PUMA_560, known).multiplications
        for known in costs.KNOWLEDGE
    )
    closed = costs.count(lagrange_euler, PUMA_560).multiplications
    newton = costs.count(newton_euler, PUMA_560).multiplications
    two = costs.count_closed_form(LINKS, shared=True).multiplications
    text = f"Lagrangian form of six joints: closed {closed:,}, recursive {recursive:,}, "
    text += f"{zeros:,} with its zeros known, {custom:,} customised to the Puma; "
    return Measured(recursive, f"{text}Newton-Euler {newton:,}; two joints, closed {two}")


def recursion() -> Measured:
    """How many times fewer multiplications the recursive Lagrangian form needs, six joints."""
    ways = lagrange_euler, recursive_lagrange, newton_euler
    closed, lagrange, newton = (costs.count(f, PUMA_560).multiplications for f in ways)
    text = f"six joints: {closed / lagrange:.0f} times fewer multiplications, "
    return Measured(closed / lagrange, f"{text}{closed / newton:.0f} times by Newton-Euler")


def extra_links(samples: int = 4000) -> Measured:
    """Share of coupling in the torque with four joints of a Puma moving over that with two.

    Coupling is what a joint needs because others move: its torque less that of the same state
    with the other joints at rest. RMS over the RMS torque without gravity, random states, all
    joints equally fast; the mean over the joints that move.

    Parameters
    ----------
    samples : int
        Random states: angles in a whole turn, velocities and accelerations up to 1 rad/s and
        rad/s^2.
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
        costs.count_closed_form(LINKS, shared=True, velocity_terms=v).multiplications
        for v in (True, False)
    )
    motion = pick_and_place(APPENDIX_I[[0, 1, 2, 5]], TIMES)
    lost = 100 * share_of_velocity_terms(ARM, motion, effects=STATE_FEEDBACK.effects)
    text = (
        f"{cheap} for {full} multiplications, at {lost[0]:.0f} % and {lost[1]:.0f} % of the torque"
    )
    return Measured(cheap / full, text)


@cache
def _coverage() -> np.ndarray:
    names = RIGID + FRICTION
    plant = (ARM, STATE_FEEDBACK.controller, APPENDIX_I[:5], STATE_FEEDBACK.effects)
    found = least_squares(by_modulation(repeat(*plant, repetitions=200, seed=1)))
    return found.covers(true_parameters(ARM, STATE_FEEDBACK.effects, names))


def identification() -> Measured:
    """How often 95 % intervals hold the true parameters in 200 recordings, the worst of seven."""
    covers = _coverage()
    share = 100 * covers.mean(0)
    value, replicates = over_members(lambda drawn: drawn.mean(1).min(-1), covers)
    text = f"95 % intervals hold the truth in {share.min():.0f} to {share.max():.0f} % of 200"
    return Measured(value, text, replicates)


def gears() -> Measured:
    """The shoulder's share of the elbow's torque without gears over that behind 100 to 1."""
    motion = pick_and_place(APPENDIX_I[0], TIMES)
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
