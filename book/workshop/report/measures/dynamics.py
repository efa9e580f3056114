"""Sections 1, 2 and 3.1: the arm's dynamics, their cost and identification, what they leave out.

What the rigid body leaves out is measured on trajectory 6. Shares are judged against its torque on
the motion as driven, the scale of the networks' errors. More than half of it catches up with the
jump at the start; the share of what the reference asks for, without that, is told beside it.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from scipy.optimize import brentq

from ddlib.analysis import (
    linear_residual,
    savitzky_golay,
    share_of_other_joint,
    share_of_velocity_terms,
)
from ddlib.control import difference, end_slope, late_poles, linear, noise_gain
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
from ddlib.effects import DeadZone, Effects, FlexibleJoint, Quantisation
from ddlib.identification import (
    FRICTION,
    RIGID,
    by_modulation,
    least_squares,
    repeat,
    true_parameters,
)
from ddlib.paper import TEST_TRAJECTORY
from ddlib.setups import STATE_FEEDBACK
from ddlib.simulation import CONTROL_STEP, LOG_STEP, Recording, follow, record, residual_torque, rms
from ddlib.tables import scientific, significant
from ddlib.trajectories import (
    APPENDIX_I,
    MOTION_SECONDS,
    Trajectory,
    pick_and_place,
    random_extents,
)
from workshop.report.evidence.verdicts import Measured, judged, turns_at

_SETUP = STATE_FEEDBACK
ARM = CMU_DD_ARM_II
_TIMES = np.arange(300) * 0.01
_LINKS = (Link(14.0, 0.50, 0.22, 0.40), Link(14.0, 0.40, 0.09, 0.60))
# A springy shaft with modes at 36 and 38 Hz: an example, no value of the real arm
_SHAFT = FlexibleJoint((2e4, 6e3), (0.4, 0.15), damping=(5.0, 1.0))

_SIGNIFICANT = 0.2  # Share of the rigid body's torque from which on an effect counts as significant


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
    two = costs.count_closed_form(_LINKS, shared=True).multiplications
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
    plant = (ARM, _SETUP.controller, APPENDIX_I[:5], _SETUP.effects)
    found = least_squares(by_modulation(repeat(*plant, repetitions=200, seed=1)))
    return found.covers(true_parameters(ARM, _SETUP.effects, RIGID + FRICTION))


def identification() -> Measured:
    """How often 95 % intervals hold the true parameters in 200 recordings, the worst of seven."""
    share = 100 * _coverage().mean(0)
    text = f"95 % intervals hold the truth in {share.min():.0f} to {share.max():.0f} % of 200"
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


# --- section 3.1: what the rigid body leaves out


def _drive(runs: int | None = None, **effects) -> Recording:
    extents = APPENDIX_I[TEST_TRAJECTORY - 1]
    extents = extents if runs is None else np.repeat([extents], runs, axis=0)
    options = dict(effects=Effects(**effects), log_step=CONTROL_STEP, rest=0.1)
    return record(_SETUP.arm, _SETUP.controller, extents, **options)


@cache
def _ideal() -> Recording:
    return _drive()


def _shares(left) -> tuple[np.ndarray, str]:
    """RMS over the rigid body's as driven, and a text that has the reference's too."""
    run = _ideal()
    reference = pick_and_place(APPENDIX_I[TEST_TRAJECTORY - 1], run.t[run.motion])
    driven, asked = (
        rms(left) / rms(torque)
        for torque in (run.tau_true[run.motion], _SETUP.arm.inverse_dynamics(*reference))
    )
    text = f"{100 * driven[0]:.0f} % of the torque at the shoulder, {100 * driven[1]:.0f} % at the "
    text += f"elbow; of what the reference asks for {100 * asked[0]:.0f} and {100 * asked[1]:.0f} %"
    return driven, text


def friction(factors=(1, 1.5, 2, 2.5, 3, 4)) -> Measured:
    """How many times the assumed friction is significant: share of the rigid body's torque.

    The joint with the smaller share counts, both as RMS.
    """
    factor = np.outer(factors, (1.0, 1.0))
    viscous, coulomb = _SETUP.effects.friction
    scaled = (
        replace(viscous, coefficient=factor * viscous.coefficient),
        replace(coulomb, level=factor * coulomb.level),
    )
    run = _drive(len(factors), friction=scaled)
    left = residual_torque(_SETUP.arm, run)[:, run.motion]
    share = rms(left) / rms(_ideal().tau_true[_ideal().motion])
    turn = turns_at(factors, share.min(-1), _SIGNIFICANT)
    text = f"{_shares(left[0])[1]}; {100 * _SIGNIFICANT:g} % from {significant(turn, 2)} times the "
    return Measured(turn, f"{text}assumed friction on")


def differencing(width: int = 19) -> Measured:
    """Noise of velocities by differences over that of a parabola, both up to the newest reading.

    Rounding of the encoder on trajectory 6, 500 readings a second; the text gives the torque
    that it makes through the derivative gain of the shoulder. `width`: readings of the parabola.
    """
    q = _ideal().q_true[:, 0]
    rounding = _SETUP.effects.encoder[0].apply(q) - q
    noise = [
        _SETUP.controller.kd[0] * np.std(sliding_window_view(rounding, len(w)) @ w)
        for w in (difference(1, CONTROL_STEP), end_slope(width, 2, CONTROL_STEP))
    ]
    simple, fitted = (f"{significant(n, 2)} N m" for n in noise)
    text = f"{simple} at the shoulder, {fitted} by a parabola over {width} readings"
    return Measured(float(noise[0] / noise[1]), text)


def looking_ahead(width: int = 21) -> Measured:
    """Noise of a velocity without lag: from the past alone, over noise from both sides."""
    past = end_slope(width, 2, LOG_STEP)
    centred = savitzky_golay(width, 1, LOG_STEP, degree=2)
    ratio = float(noise_gain(past) / noise_gain(centred))
    return Measured(ratio, f"{ratio:.1f} times less noise than from the past alone")


def snap() -> Measured:
    """Frequency of a springy shaft, Hz, below which its torque exceeds the torque sensor's noise.

    Measured at the assumed shaft; the torque is in proportion to the inverse of the stiffness.

    The reference has been running for a period when the measured motion begins. On the motion
    from rest the swing of the start is never over: this torque weighs frequencies by their
    fourth power, so at the end of the three seconds the swing's still outweighs the reference's.
    """
    t = np.arange(round(-2 * MOTION_SECONDS / CONTROL_STEP), round(MOTION_SECONDS / CONTROL_STEP))
    t = t * CONTROL_STEP
    omega, extents = np.pi / MOTION_SECONDS, np.deg2rad(APPENDIX_I[TEST_TRAJECTORY - 1])
    sine, cosine = (f(omega * t)[:, None] * extents for f in (np.sin, np.cos))
    reference = Trajectory(-sine, -omega * cosine, omega**2 * sine)
    options = dict(effects=Effects(transmission=(_SHAFT,)), log_every=1)
    run = follow(_SETUP.arm, _SETUP.controller, reference, t, **options)
    left = rms(residual_torque(_SETUP.arm, run)[t[:-1] >= 0])[0]
    noise = _SETUP.effects.torque_sensor[0].std[0]
    modes = _SHAFT.mode_frequencies(_SETUP.arm, [0.0, 0.0]) / (2 * np.pi)
    turn = float(modes[0] * np.sqrt(left / noise))
    text = (
        f"{1e3 * left:.2f} mN m with modes at {modes[0]:.0f} and {modes[1]:.0f} Hz, "
        f"{significant(noise / left, 2)} times below the torque noise; as large with a mode at "
        f"{significant(turn, 2)} Hz"
    )
    return Measured(turn, text)


@cache
def _rattle(gaps: tuple) -> np.ndarray:
    """Torque that play of the springy shaft adds at both joints, the whole motion."""
    run = _drive(len(gaps) + 1, transmission=(replace(_SHAFT, gap=np.outer((0, *gaps), (1, 1))),))
    left = residual_torque(_SETUP.arm, run)[:, run.motion]
    return left[1:] - left[0]


def backlash(gaps=(1e-3, 2e-3, 4e-3)) -> Measured:
    """Play behind a springy shaft that is significant, rad: share of the rigid body's torque."""
    left = _rattle(tuple(gaps))
    share = rms(left) / rms(_ideal().tau_true[_ideal().motion])
    turn = turns_at(gaps, share.max(-1), _SIGNIFICANT)
    text = f"if it had gears, play of {np.rad2deg(gaps[0]):.2f}°: {_shares(left[0])[1]}; "
    return Measured(turn, f"{text}{100 * _SIGNIFICANT:g} % from {np.rad2deg(turn):.2f}° on")


def high_frequency(softer=(0.3, 0.1)) -> Measured:
    """Torque that a springy shaft leaves over the rigid body's, ringing at the start included."""
    factors = (1, *softer)
    stiffness = np.outer(factors, _SHAFT.stiffness)
    run = _drive(len(factors), transmission=(replace(_SHAFT, stiffness=stiffness),))
    left = residual_torque(_SETUP.arm, run)[:, run.motion]
    share = (rms(left) / rms(_ideal().tau_true[_ideal().motion])).max(-1)
    others = ", ".join(f"{100 * x:.0f} % at {f:g}" for x, f in zip(share[1:], softer))
    text = f"springy shaft: {_shares(left[0])[1]}; the larger share is {others} of the stiffness"
    return Measured(float(share[0]), text)


def dead_zone(width: float = 0.1) -> Measured:
    """Half width of a dead zone that is significant, N m: share of the rigid body's torque."""
    tau = _ideal().tau_true[_ideal().motion]
    lost = DeadZone((width, width)).inverse(tau) - tau
    share, text = _shares(lost)
    turn = float(width * _SIGNIFICANT / share.max())
    text = f"dead zone of {width:g} N m: {text}; "
    text += f"{100 * _SIGNIFICANT:g} % from {significant(turn, 2)} N m on"
    return Measured(turn, text)


def saturation() -> Measured:
    """Torque limit below which the motion saturates over the assumed one, the nearer joint."""
    limit = np.array(_SETUP.effects.actuator[0].limit)
    largest = np.abs(_ideal().tau_true).max(0)
    share = (largest / limit).max()
    text = f"the motion takes {100 * share:.0f} % of the assumed limit at most; limits below "
    text += f"{largest[0]:.0f} or {largest[1]:.0f} N m would cut it"
    return Measured(float(share), text)


def sampling(late: float = 1.2e-3) -> Measured:
    """Multiple of the assumed viscous friction from which on late position feedback is stable.

    The torque is held over a control period, and late.
    """
    viscous = np.array(_SETUP.effects.friction[0].coefficient)
    gain = np.hstack([np.diag(_SETUP.controller.kp), np.zeros((2, 2))])

    def growth(factor, delay):
        joints = linear.plant(_SETUP.arm.mass_matrix([0.0, 0.0]), factor * viscous)
        return np.log(np.abs(late_poles(joints, gain, CONTROL_STEP, delay)).max()) / CONTROL_STEP

    turn = brentq(growth, 0.1, 10.0, args=(late,))
    held, delayed = (growth(1.0, delay) for delay in (0.0, late))
    text = f"position feedback: swings grow at {significant(delayed, 2)} 1/s if the torque is "
    text += f"{1e3 * late:g} ms late, {significant(held, 2)} 1/s if it is only held; stable from "
    text += f"{significant(turn, 2)} times the assumed viscous friction on"
    return Measured(float(turn), text)


def sensor_noise(bits=(14, 15, 16, 17, 18, 19, 20)) -> Measured:
    """Bits of an encoder from which on its noise in torque by second differences is slight."""
    run = _ideal()
    log = run.q_true[:: round(LOG_STEP / CONTROL_STEP)]

    def torque(q):
        qd, qdd = (q[2:] - q[:-2]) / (2 * LOG_STEP), np.diff(q, 2, axis=0) / LOG_STEP**2
        return _SETUP.arm.inverse_dynamics(q[1:-1], qd, qdd)

    noise = {b: torque(Quantisation.encoder(b).apply(log)) - torque(log) for b in bits}
    turn = min(b for b, left in noise.items() if _shares(left)[0].max() < _SIGNIFICANT)
    text = f"16 bits, second differences at 100 a second: {_shares(noise[16])[1]}; below "
    return Measured(turn, f"{text}{100 * _SIGNIFICANT:g} % from {turn} bits on")
