"""What the lesson *What feedforward adds* shows and asks, and what its claims measure."""

from __future__ import annotations

from functools import cache

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, FancyBboxPatch

from ddlib.control import PID, ComputedTorque, Feedforward, pd
from ddlib.dynamics import CMU_DD_ARM_II as ARM, PUMA_560_ROTORS, SecondOrderModel
from ddlib.effects import (
    CMU_DD_ARM_II_EFFECTS,
    IDEAL,
    CoulombFriction,
    Effects,
    ViscousFriction,
)
from ddlib.figures.style import FAINT, INK, NARROW, TONES, Illustration, illustrate
from ddlib.setups import (
    JOINT_DAMPING_COULOMB,
    JOINT_DAMPING_KP,
    JOINT_DAMPING_VISCOUS,
    KD,
    KP,
)
from ddlib.simulation import CONTROL_STEP, LOG_STEP, feedforward_system, follow, run_system
from ddlib.tables import quote, scientific, significant
from ddlib.trajectories import APPENDIX_I, Trajectory, pick_and_place, smooth_pick_and_place
from workshop.chapters.exercises import Exercise, judging
from workshop.report.evidence.verdicts import Measured


def _quoted() -> None:
    """The numbers of the prose: the lesson's motion with joints that turn against each other."""
    t = np.arange(0, 3, CONTROL_STEP)[:, None]
    size, w = -np.deg2rad((45.0, -45.0)) / 2, 2 * np.pi / 3
    wanted = size * (1 - np.cos(w * t)), size * w * np.sin(w * t), size * w**2 * np.cos(w * t)
    springs = np.array(JOINT_DAMPING_KP)
    laws = {
        "ahead": Feedforward(ARM, pd(springs, (0, 0))),
        "computed": ComputedTorque(ARM, tuple(springs / _OWN), (0, 0)),
    }
    rubs = Effects((ViscousFriction(JOINT_DAMPING_VISCOUS), CoulombFriction(JOINT_DAMPING_COULOMB)))
    for name, law in laws.items():
        run = follow(ARM, law, Trajectory(*wanted), t[:, 0], effects=rubs, log_every=1)
        quote(f"ff-opposed-{name}", np.rad2deg(_rms(run.tracking_error)))


def feedforward_loop() -> Illustration:
    """Figure 2-1: feedforward torque from the inverse arm, feedback at each joint, the arm."""

    def draw(figure: Figure):
        axis = figure.subplots()
        (_lying_loop if figure.get_figwidth() > NARROW else _standing_loop)(axis)
        axis.axis("off")

    alt = (
        "Block diagram. The reference trajectory feeds two branches: the inverse arm, which "
        "computes the feedforward torque off line, and a comparison with the measured motion, "
        "whose error drives a feedback law at each joint. Both torques are added and drive the "
        "arm; its measured motion returns to the comparison."
    )
    return illustrate(draw, alt, 7.0, 2.5, narrow_height=5.4)


def _lying_loop(axis: Axes):
    """The diagram of `feedforward_loop` from left to right."""
    _block(axis, 1.3, 1.1, "reference\ntrajectory")
    _block(axis, 5.0, 2.75, "inverse arm", colour=TONES["wanted"])
    _block(axis, 5.0, 1.1, "feedback\nat each joint")
    _block(axis, 9.2, 1.1, "arm")
    _sum(axis, 3.25, 1.1)
    _sum(axis, 7.0, 1.1)
    _arrow(axis, (2.2, 1.1), (3.07, 1.1), r"$q_r,\ \dot q_r$")
    _arrow(axis, (1.3, 1.5), (1.3, 2.75), (4.1, 2.75))
    axis.text(2.6, 2.85, r"$q_r,\ \dot q_r,\ \ddot q_r$", ha="center", va="bottom")
    _arrow(axis, (3.43, 1.1), (4.1, 1.1), "$e$")
    _arrow(axis, (5.9, 1.1), (6.82, 1.1), r"$\tau_{\mathrm{fb}}$")
    _arrow(axis, (5.9, 2.75), (7.0, 2.75), (7.0, 1.28))
    axis.text(6.45, 2.85, r"$\tau_{\mathrm{ff}}$", ha="center", va="bottom")
    _arrow(axis, (7.18, 1.1), (8.3, 1.1), r"$\tau$")
    _arrow(axis, (10.1, 1.1), (11.3, 1.1), r"$q,\ \dot q$")
    _arrow(axis, (10.6, 1.1), (10.6, 0.1), (3.25, 0.1), (3.25, 0.92))
    axis.plot(10.6, 1.1, "o", ms=3.5, color=INK)
    for x, y, sign in ((2.93, 0.9, "+"), (3.42, 0.78, "−"), (6.68, 0.9, "+"), (7.2, 1.4, "+")):
        axis.text(x, y, sign, ha="center", va="center", fontsize=9)
    axis.text(5.0, 3.25, "off line", ha="center", va="bottom", color=FAINT)
    axis.text(6.6, 0.18, "sensors", ha="center", va="bottom", color=FAINT)
    axis.set(xlim=(0.2, 11.5), ylim=(-0.1, 3.6), aspect="equal")


def _standing_loop(axis: Axes):
    """The diagram of `feedforward_loop` from top to bottom, for a narrow page."""
    _block(axis, 1.3, 6.6, "reference\ntrajectory")
    _block(axis, 4.2, 3.8, "inverse arm", colour=TONES["wanted"])
    _block(axis, 1.3, 3.8, "feedback\nat each joint")
    _block(axis, 1.3, 0.8, "arm")
    _sum(axis, 1.3, 5.2)
    _sum(axis, 1.3, 2.3)
    _arrow(axis, (1.3, 6.2), (1.3, 5.38))
    _arrow(axis, (2.2, 6.6), (4.2, 6.6), (4.2, 4.2))
    _arrow(axis, (1.3, 5.02), (1.3, 4.2))
    _arrow(axis, (1.3, 3.4), (1.3, 2.48))
    _arrow(axis, (4.2, 3.4), (4.2, 2.3), (1.48, 2.3))
    _arrow(axis, (1.3, 2.12), (1.3, 1.2))
    _arrow(axis, (1.3, 0.4), (1.3, -0.6))
    _arrow(axis, (1.3, 0.0), (0.1, 0.0), (0.1, 5.2), (1.12, 5.2))
    axis.plot(1.3, 0.0, "o", ms=3.5, color=INK)
    for x, y, name in (
        (1.45, 5.8, r"$q_r,\ \dot q_r$"), (1.45, 4.6, "$e$"), (1.45, 2.95, r"$\tau_{\mathrm{fb}}$"),
        (1.45, 1.65, r"$\tau$"), (1.45, -0.4, r"$q,\ \dot q$"),
    ):  # fmt: skip
        axis.text(x, y, name, ha="left", va="center")
    axis.text(3.2, 6.7, r"$q_r,\ \dot q_r,\ \ddot q_r$", ha="center", va="bottom")
    axis.text(2.8, 2.4, r"$\tau_{\mathrm{ff}}$", ha="center", va="bottom")
    for x, y, sign in ((1.08, 5.5, "+"), (0.95, 5.02, "−"), (1.08, 2.6, "+"), (1.6, 2.08, "+")):
        axis.text(x, y, sign, ha="center", va="center", fontsize=9)
    axis.text(5.2, 3.25, "off line", ha="right", va="top", color=FAINT)
    axis.text(0.2, 0.1, "sensors", ha="left", va="bottom", color=FAINT)
    axis.set(xlim=(-0.1, 5.3), ylim=(-0.75, 7.3), aspect="equal")


def _block(axis: Axes, x, y, text, colour=INK):
    """A box of the diagram with its centre at `x`, `y`."""
    style = "round,pad=0,rounding_size=0.08"
    box = FancyBboxPatch((x - 0.9, y - 0.4), 1.8, 0.8, style, fc="none", ec=colour, lw=1.6)
    axis.add_patch(box)
    axis.text(x, y, text, ha="center", va="center", linespacing=1.15)


def _sum(axis: Axes, x, y):
    """A summing point."""
    axis.add_patch(Circle((x, y), 0.18, fc="none", ec=INK, lw=1.2))


def _arrow(axis: Axes, *points):
    """A line through `points` with an arrow head at its end; a last text names the first part."""
    *points, name = points if isinstance(points[-1], str) else (*points, "")
    (x0, y0), (x1, _) = points[:2]
    axis.plot(*np.array(points).T, color=INK, lw=1.1, solid_joinstyle="miter")
    head = {"arrowstyle": "-|>", "color": INK, "lw": 1.1, "shrinkA": 0, "shrinkB": 0}
    axis.annotate("", points[-1], points[-2], arrowprops=head)
    axis.text((x0 + x1) / 2, y0 + 0.1, name, ha="center", va="bottom")


def _exercise(number: int, *given) -> Exercise:
    """An exercise, with what the lesson's cells found."""
    if number == 1:
        inertia, friction, omega = given
        slips = [(friction / (friction + inertia * omega), "J s and F are at right angles.")]
        return Exercise(
            "number",
            friction / np.hypot(friction, inertia * omega),
            "the model leaves friction out, so it misses F over |J s + F|.",
            slips,
            "Put 1 / P of the model and of the joint into 1 - P / P_model.",
        )
    elif number == 2:
        rigid, error = given
        return Exercise(
            "function",
            lambda model: error(model) < 0.1 * error(rigid),
            "friction can be known, and then less than a tenth of the error is left.",
            (),
            "it leaves too much. What brakes the arm that `inverse` does not know?",
        )
    else:
        slips = [
            (1 / 5, "a softer loop errs more."),
            (25, "for slow motions the error falls with k_p, not with its root."),
            (4, "a fifth of the error is left, not a fourth."),
        ]
        return Exercise(
            "number",
            5,
            "five times the stiffness for a fifth of the error.",
            slips,
            "What is S where J s² is small against k_p?",
        )


check = judging(_exercise)


# --- what the claims of the chapter measure

_EXTENTS = APPENDIX_I[0]
_TIMES = np.arange(1500) * CONTROL_STEP
# Inertia that each joint has by itself, the arm stretched, kg m^2
_OWN = np.diag(ARM.mass_matrix([0.0, 0.0]))


def _rms(x) -> np.ndarray:
    """Root mean square over time and joints, for each run."""
    return np.sqrt(np.mean(np.square(x), axis=(-2, -1)))


def _errors(factors, gains, effects: Effects = IDEAL, speed: float = 1.0):
    """Tracking errors on the smooth motion, degrees, ``(runs, time, 2)``.

    Each run has a factor, the share of the needed torque that its model gives, and another on
    the gains of the feedback.
    """
    factors, gains = (np.array(x, dtype=float)[:, None] for x in (factors, gains))
    t = np.arange(round(3 / speed / CONTROL_STEP)) * CONTROL_STEP
    reference = smooth_pick_and_place(np.broadcast_to(_EXTENTS, (len(factors), 2)), t, speed)

    def model(*motion):
        return factors[:, None] * ARM.inverse_dynamics(*motion)

    law = Feedforward(model, pd(gains * KP, gains * KD))
    return np.rad2deg(follow(ARM, law, reference, t, effects=effects).tracking_error)


@cache
def _real(speed: float) -> np.ndarray:
    """RMS errors with all effects: PD alone, models of 1, 0.8, 1.2 with PD, 0.8, 1.2 alone."""
    return _rms(
        _errors([0, 1, 0.8, 1.2, 0.8, 1.2], [1, 1, 1, 1, 0, 0], CMU_DD_ARM_II_EFFECTS, speed)
    )


def perfect_model() -> Measured:
    """Largest error of feedforward alone over the extent, ideal arm and smooth motion."""
    held, none = np.abs(_errors([1, 0], [0, 1])).max((1, 2))
    continuous = np.abs(_track(np.zeros((1, 2)), [False], ARM.inverse_dynamics, [[0, 0]])).max()
    text = f"{held:.2f}° on a smooth motion without feedback, torque held for 2 ms; "
    text += f"{scientific(continuous)}° with a continuous torque ({none:.1f}° by PD alone)"
    return Measured(float(held / _EXTENTS.max()), text)


def perfect_model_on_family() -> Measured:
    """Largest error over the extent on the paper's own references, perfect model and PD."""
    law = Feedforward(ARM, pd(KP, KD))
    run = follow(ARM, law, pick_and_place(APPENDIX_I, _TIMES), _TIMES)
    largest = np.rad2deg(np.abs(run.tracking_error).max((1, 2)))
    share = largest / APPENDIX_I.max(1)
    text = f"largest error {largest.min():.1f} to {largest.max():.1f}°, at the jump of the start"
    return Measured(float(share.max()), text)


def feedback() -> Measured:
    """How many times smaller feedback makes the error that a model 20 % off leaves."""
    with_, without = _real(1.0)[2:].reshape(2, 2)
    text = "model 20 % off, all effects: " + ", ".join(
        f"{significant(a, 2)}° for {significant(b, 2)}° without" for a, b in zip(with_, without)
    )
    return Measured(float((without / with_).min()), text)


def coupling() -> Measured:
    """Error under PID that models of the joints by themselves leave, over the coupled model's."""
    motion = smooth_pick_and_place(np.broadcast_to(_EXTENTS, (3, 2)), _TIMES)

    def model(q, qd, qdd):
        return np.stack([0 * qdd[0], _OWN * qdd[1], SecondOrderModel(ARM)(q, qd, qdd)[2]])

    law = Feedforward(model, PID(KP, np.array(KP) / 2, KD))
    alone, own, coupled = _rms(np.rad2deg(follow(ARM, law, motion, _TIMES).tracking_error))
    text = f"independent PID {significant(alone, 2)}°, with models of single joints "
    text += f"{significant(own, 2)}°, of second order with coupling {significant(coupled, 2)}°"
    return Measured(float(own / coupled), text)


def off_line() -> Measured:
    """Whether computed torque and feedforward give the same torque on the reference."""
    motion = smooth_pick_and_place(_EXTENTS, _TIMES)
    law = ComputedTorque(ARM, tuple(KP / _OWN), tuple(KD / _OWN)).start(motion, CONTROL_STEP)
    on_line = np.array([law(k, motion.q[k], motion.qd[k]) for k in range(_TIMES.size)])
    gap = np.abs(on_line - ARM.inverse_dynamics(*motion)).max()
    text = "the same torque wherever the arm is on its reference "
    text += f"(difference {significant(gap, 1)} N m)"
    return Measured(bool(gap < 1e-9), text)


def figure_2_1() -> Measured:
    """Largest difference between Figure 2-1 as a program and the sampled simulator, degrees."""
    t = _TIMES[::5]
    drawn = run_system(feedforward_system(ARM, ARM, KP, KD), smooth_pick_and_place(_EXTENTS, t), t)
    law = Feedforward(ARM, pd(KP, KD))
    built = follow(ARM, law, smooth_pick_and_place(_EXTENTS, _TIMES), _TIMES, log_every=5)
    gap = float(np.rad2deg(np.abs(drawn.q - built.q_true).max()))
    text = f"drawn and run: {significant(gap, 2)}° at most from the sampled simulation"
    return Measured(gap, text)


def _track(rotors, frozen, model, gains, speed: float = 1.0, extents=_EXTENTS) -> np.ndarray:
    """Tracking errors of changed arms under continuous control, ``(runs, time, 2)``, degrees."""
    frozen = np.asarray(frozen)[:, None]
    rotors = np.asarray(rotors, dtype=float)[:, None] * np.eye(2)
    kp, kd = np.asarray(gains) * KP, np.asarray(gains) * KD
    samples = round(3 / speed / LOG_STEP)
    half = np.arange(2 * samples + 1) * LOG_STEP / 2
    motion = smooth_pick_and_place(np.broadcast_to(extents, (len(frozen), 2)), half, speed)
    ahead = model(*motion)

    def rate(k, q, qd):
        tau = ahead[:, k] + kp * (motion.q[:, k] - q) + kd * (motion.qd[:, k] - qd)
        posture, turning = np.where(frozen, 0.0, q), np.where(frozen, 0.0, qd)
        torque = tau - ARM.inverse_dynamics(posture, turning, np.zeros_like(q))
        inertia = ARM.mass_matrix(posture) + rotors
        return np.stack([qd, np.linalg.solve(inertia, torque[..., None])[..., 0]])

    x = np.zeros((2, len(frozen), 2))
    errors = [x[0]]
    for k in range(0, 2 * samples - 2, 2):
        first = rate(k, *x)
        second = rate(k + 1, *(x + LOG_STEP / 2 * first))
        third = rate(k + 1, *(x + LOG_STEP / 2 * second))
        fourth = rate(k + 2, *(x + LOG_STEP * third))
        x = x + LOG_STEP / 6 * (first + 2 * second + 2 * third + fourth)
        errors.append(motion.q[:, k + 2] - x[0])
    return np.rad2deg(np.moveaxis(errors, 0, 1))


def linearised(speed: float = 2.0) -> Measured:
    """By how much feedforward shrinks what a linear arm does not explain of the error.

    That is an arm frozen in its stretched posture; the model of feedforward is 20 % too small.
    """
    frozen = np.array([False, True, False, True])

    def model(*motion):
        full = 0.8 * ARM.inverse_dynamics(*motion)
        full[:2] = 0.0
        full[3] = 0.8 * SecondOrderModel(ARM)(*motion)[3]
        return full

    errors = _track(np.zeros((4, 2)), frozen, model, np.ones((4, 2)), speed)
    alone, ahead = _rms(errors[0] - errors[1]), _rms(errors[2] - errors[3])
    text = f"what a linear arm does not explain falls from {significant(alone, 2)}° to "
    text += f"{significant(ahead, 2)}° (model 20 % off, {speed:g} times the speed)"
    return Measured(float(alone / ahead), text)


def faster(speed: float = 2.0) -> Measured:
    """The error of PD alone over that with a model, arm with all effects, at higher speed."""
    slow, fast = _real(1.0), _real(speed)
    text = f"{significant(fast[1], 2)}° with a model, {significant(fast[0], 2)}° without "
    text += f"at {speed:g} times the speed; "
    text += f"{significant(slow[1], 2)}° and {significant(slow[0], 2)}° at the paper's"
    return Measured(float(fast[0] / fast[1]), text)


def _geared(gear: float, own_model: bool, extents) -> np.ndarray:
    """Errors of the arm without and with gears, the joints' own loops equally fast."""
    rotors = np.array([[0.0, 0.0], [gear**2 * PUMA_560_ROTORS[0]] * 2])
    inertia = _OWN + rotors

    def model(q, qd, qdd):
        return own_model * inertia[:, None] * qdd

    return _track(rotors, [False, False], model, inertia / _OWN, extents=extents)


def target_for_models(gear: float = 100.0) -> Measured:
    """What a model of each joint by itself leaves of PD's error: without over behind gears."""
    errors = [_rms(_geared(gear, own, _EXTENTS)) for own in (True, False)]
    direct, geared = errors[0] / errors[1]
    text = f"a model without coupling leaves {100 * direct:.0f} % of PD's error, "
    text += f"{100 * geared:.0f} % behind gears of {gear:g} to 1"
    return Measured(float(direct / geared), text)
