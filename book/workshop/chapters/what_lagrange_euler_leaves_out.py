"""Figures of the chapter *What Lagrange-Euler leaves out*, and what its claims measure.

What the rigid body leaves out is measured on trajectory 6. Shares are judged against its torque on
the motion as driven, the scale of the networks' errors. More than half of it catches up with the
jump at the start; the share of what the reference asks for, without that, is told beside it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cache

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, MaxNLocator, NullFormatter
from numpy.lib.stride_tricks import sliding_window_view
from scipy.optimize import brentq

from ddlib.analysis import savitzky_golay
from ddlib.control import difference, end_slope, late_poles, linear, noise_gain, pd
from ddlib.control.velocity import EstimatedVelocity
from ddlib.effects import DeadZone, Effects, FlexibleJoint, Quantisation, Ripple, StribeckFriction
from ddlib.figures.style import (
    FAINT,
    INK,
    JOINTS,
    NARROW,
    TONES,
    Illustration,
    illustrate,
    looks,
)
from ddlib.paper import TEST_TRAJECTORY
from ddlib.setups import STATE_FEEDBACK
from ddlib.simulation import CONTROL_STEP, LOG_STEP, Recording, follow, record, residual_torque, rms
from ddlib.tables import quote, significant
from ddlib.trajectories import APPENDIX_I, MOTION_SECONDS, Trajectory, pick_and_place
from ddlib.widgets.switches import RealArmSwitches
from workshop.chapters.exercises import Exercise, judging
from workshop.report.evidence.verdicts import Measured, turns_at


def side_by_side(
    panels: Mapping[tuple[str, str], Mapping[str, tuple]],
    alt: str,
    height: float = 2.5,
    *,
    log: bool = False,
) -> Illustration:
    """Panels in one row, each with axes of its own."""
    shown = [name for panel in panels.values() if len(panel) > 1 for name in panel]
    look = looks(shown) if shown else {}

    def draw(figure: Figure):
        axes = figure.subplots(1, len(panels), squeeze=False, sharex=log, sharey=log)[0]
        for axis, ((x_label, y_label), curves) in zip(axes, panels.items()):
            for name, (x, y) in curves.items():
                style = look.get(name, looks([name])[name])
                axis.plot(x, y, label=name, **style.line)
            axis.set(xlabel=x_label, ylabel=y_label)
            if log:
                axis.set(xscale="log", yscale="log")
                axis.xaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
                for side in (axis.xaxis, axis.yaxis):
                    side.set_major_formatter("{x:g}")
                    side.set_minor_formatter(NullFormatter())
            else:
                axis.xaxis.set_major_locator(MaxNLocator(5))
            if len(curves) > 1:
                axis.legend(loc="best")

    return illustrate(draw, alt, 7.0, height)


def ranking(sizes: Mapping[str, np.ndarray]) -> Illustration:
    """Torques as bars on a logarithmic axis, largest first, one bar for each joint."""
    order = sorted(sizes, key=lambda name: sizes[name][0], reverse=True)
    values = np.array([sizes[name] for name in order])
    places = np.arange(len(order))

    def draw(figure: Figure):
        axis = figure.subplots()
        slim = figure.get_figwidth() <= NARROW  # names above their bars, not beside them
        height = (0.56 if slim else 0.8) / 2
        low = 10.0 ** np.floor(np.log10(values.min()))
        for j, joint in enumerate(JOINTS):
            rows = places + (j - 0.5) * height
            look = dict(color=TONES[joint], alpha=0.85, hatch="" if j == 0 else "///", lw=0)
            bars = axis.barh(rows, values[:, j] - low, height * 0.88, left=low, label=joint, **look)
            words = [significant(value, 2) for value in values[:, j]]
            axis.bar_label(bars, words, padding=3, fontsize=7, color=INK)
        axis.set_yticks(places, [""] * len(order) if slim else order)
        axis.set(xscale="log", xlim=(low, values.max() * 2.5), xlabel="torque, N m (RMS)")
        axis.set_ylim(len(order) - 0.4, -0.8 if slim else -0.6)
        for place, name in zip(places, order if slim else ()):
            axis.text(low * 1.03, place - 0.32, name, fontsize=8.5, color=INK, va="bottom")
        axis.grid(axis="y", visible=False)
        axis.tick_params(axis="y", length=0)
        axis.axhline(0.35 if slim else 0.5, color=FAINT, lw=0.8)
        axis.legend(loc="lower right")

    listed = "; ".join(
        f"{name} {' and '.join(significant(v, 2) for v in row)}" for name, row in zip(order, values)
    )
    alt = f"Bars of torque in N m for shoulder and elbow, largest first: {listed}."
    size = 7.0, 0.26 * len(order) + 0.9
    return illustrate(draw, alt, *size, narrow_height=0.46 * len(order) + 0.9)


# --- what the claims of the chapter measure

_SETUP = STATE_FEEDBACK
# A springy shaft with modes at 36 and 38 Hz: an example, no value of the real arm
_SHAFT = FlexibleJoint((2e4, 6e3), (0.4, 0.15), damping=(5.0, 1.0))
_SIGNIFICANT = 0.2  # Share of the rigid body's torque from which on an effect counts as significant


def _drive(runs: int | None = None, law=_SETUP.controller, **effects) -> Recording:
    extents = APPENDIX_I[TEST_TRAJECTORY - 1]
    extents = extents if runs is None else np.repeat([extents], runs, axis=0)
    options = dict(effects=Effects(**effects), log_step=CONTROL_STEP, rest=0.1)
    return record(_SETUP.arm, law, extents, **options)


@cache
def _ideal() -> Recording:
    return _drive()


def _left(runs: int | None, **effects) -> np.ndarray:
    """Torque that the rigid body leaves unexplained in some runs, the whole motion."""
    run = _drive(runs, **effects)
    return residual_torque(_SETUP.arm, run)[..., run.motion, :]


def _shares(torque_left) -> tuple[np.ndarray, str]:
    """RMS over the rigid body's as driven; of the first run a text that has the reference's too."""
    run = _ideal()
    reference = pick_and_place(APPENDIX_I[TEST_TRAJECTORY - 1], run.t[run.motion])
    driven, asked = (
        rms(torque_left) / rms(torque)
        for torque in (run.tau_true[run.motion], _SETUP.arm.inverse_dynamics(*reference))
    )
    (shoulder, elbow), (less, least) = (100 * x.reshape(-1, 2)[0] for x in (driven, asked))
    text = f"{shoulder:.0f} % of the torque at the shoulder, {elbow:.0f} % at the elbow; "
    return driven, f"{text}of what the reference asks for {less:.0f} and {least:.0f} %"


def torques_left() -> dict[str, np.ndarray]:
    """Torque that each effect leaves on trajectory 6, at the values assumed, RMS of both joints."""
    arm, ideal, own = _SETUP.arm, _ideal(), _SETUP.effects
    tau, qd = ideal.tau_true[ideal.motion], ideal.qd_true[ideal.motion]
    reference = pick_and_place(APPENDIX_I[TEST_TRAJECTORY - 1], ideal.t[ideal.motion])
    viscous, coulomb = own.friction
    level = np.array(coulomb.level)
    excess = StribeckFriction(level, 1.3 * level, 0.02).torque(qd) - coulomb.torque(qd)
    change = np.diff(tau, axis=0)  # from one period to the next, without the first jump
    estimated = EstimatedVelocity(_SETUP.controller, difference(1, CONTROL_STEP))
    rounding = (Quantisation.encoder(16),)
    exact, rounded = (
        _drive(law=estimated, friction=own.friction, encoder=e).tau_true for e in ((), rounding)
    )
    torques = {"rigid body": tau, "rigid body, reference": arm.inverse_dynamics(*reference)}
    for name, effects in {
        "viscous friction": {"friction": (viscous,)},
        "Coulomb friction": {"friction": (coulomb,)},
        "play of 0.06°, gears": {"transmission": (replace(_SHAFT, gap=(1e-3, 1e-3)),)},
        "flexible shaft": {"transmission": (_SHAFT,)},
        "ripple of 2 %": {"motor": (Ripple(share=(0.02, 0.02)),)},
    }.items():
        torques[name] = _left(None, **effects)
    torques |= {
        "Stribeck excess": excess,
        "dead zone": DeadZone((0.1, 0.1)).inverse(tau) - tau,
        "hold of 2 ms": change / np.sqrt(12),
        "computing, 1.2 ms": change * 0.0012 / CONTROL_STEP,
        "torque sensor": np.array(own.torque_sensor[0].std)[None],
        "encoder, velocity by difference": (rounded - exact)[ideal.motion],
    }
    log = ideal.q_true[:: round(LOG_STEP / CONTROL_STEP)]
    for name, width in (("by differences", 3), ("over 21 samples", 21)):
        smooth = [savitzky_golay(width, order, LOG_STEP, degree=2) for order in range(3)]
        one, other = (
            arm.inverse_dynamics(*(sliding_window_view(q, width, 0) @ w for w in smooth))
            for q in (log, rounding[0].apply(log))
        )
        torques[f"encoder, acceleration {name}"] = other - one
    return {name: rms(torque) for name, torque in torques.items()}


def _quoted() -> None:
    """Quote what the lesson says of the book's arm."""
    sizes, switches = torques_left(), RealArmSwitches()
    quote("left-rings", sizes["flexible shaft"][0])
    rubbing = rms(sum(_left(None, friction=(part,)) for part in _SETUP.effects.friction))
    for name, whole in {"driven": "rigid body", "asked": "rigid body, reference"}.items():
        quote(f"left-friction-{name}", 100 * (rubbing / sizes[whole])[0])
    for name in ("friction", "quantisation", "saturation"):
        alone = dict.fromkeys(switches.values, "off") | {name: "strong"}
        quote(f"left-{name}-position", switches.curves_at(**alone)["shoulder position"][0])


def _exercise(number: int, arm=None, kp=None, other=None, extents=None) -> Exercise:
    """An exercise of the lesson."""

    def jump(share):
        return lambda f: np.isclose(f(3.0, 1.0, 300.0), share * 2 / 300)

    def path(zone):
        effects = Effects(actuator=(DeadZone((zone, 0.0)),))
        return record(arm, pd(kp, other), extents, effects=effects).q_true

    def grows(answer):
        joints = linear.plant(arm.mass_matrix([0.0, 0.0]), other)
        gain = np.hstack([np.diag(answer[1] * np.asarray(kp)), np.zeros((2, 2))])
        return np.abs(late_poles(joints, gain, answer[0], 1.2e-3)).max() >= 1

    if number == 1:
        half = jump(1), "there the joint is at full speed. How far does it swing on?"
        return Exercise(
            "function", jump(2), "the joint overshoots by as much as it was held back.", [half]
        )
    elif number == 2:
        ideal, half, whole = map(path, (0.0, 0.5, 1.0))
        share = rms(half - ideal, None) / rms(whole - ideal, None)
        hint = "how wide is the dead zone after the correction?"
        return Exercise(
            "number",
            share,
            "the correction leaves a dead zone of half the width.",
            (),
            hint,
            tolerance=0.1,
        )
    else:
        slips = [
            (lambda m: m[0] < 1.2e-3, "the arithmetic does not fit into the period."),
            (lambda m: m[1] < 0.85, "that is less than 85 % of the gains."),
            (grows, "a swing grows. Which of the two delays can be shortened?"),
        ]
        return Exercise(
            "numbers",
            lambda m: not any(is_so(m) for is_so, _ in slips),
            "the two delays add up, and yours are short enough: no swing grows.",
            slips,
            count=2,
        )


check = judging(_exercise)


def friction(factors=(1, 1.5, 2, 2.5, 3, 4)) -> Measured:
    """How many times the assumed friction is significant, at the joint with the smaller share."""
    factor = np.outer(factors, (1.0, 1.0))
    viscous, coulomb = _SETUP.effects.friction
    scaled = (
        replace(viscous, coefficient=factor * viscous.coefficient),
        replace(coulomb, level=factor * coulomb.level),
    )
    share, text = _shares(_left(len(factors), friction=scaled))
    turn = turns_at(factors, share.min(-1), _SIGNIFICANT)
    text += f"; {100 * _SIGNIFICANT:g} % from {significant(turn, 2)} times the assumed friction on"
    return Measured(turn, text)


def differencing(width: int = 19) -> Measured:
    """Noise of velocities by differences over that of a parabola, both up to the newest reading."""
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
    """Frequency of a springy shaft, Hz, below which its torque exceeds the sensor's noise."""
    # The reference runs for a period before. From rest, the start's swing would never be over: this
    # torque weighs frequencies by their fourth power.
    t = np.arange(round(-2 * MOTION_SECONDS / CONTROL_STEP), round(MOTION_SECONDS / CONTROL_STEP))
    t = t * CONTROL_STEP
    omega, extents = np.pi / MOTION_SECONDS, np.deg2rad(APPENDIX_I[TEST_TRAJECTORY - 1])
    sine, cosine = (f(omega * t)[:, None] * extents for f in (np.sin, np.cos))
    reference = Trajectory(-sine, -omega * cosine, omega**2 * sine)
    options = dict(effects=Effects(transmission=(_SHAFT,)), log_every=1)
    run = follow(_SETUP.arm, _SETUP.controller, reference, t, **options)
    residual = rms(residual_torque(_SETUP.arm, run)[t[:-1] >= 0])[0]
    noise = _SETUP.effects.torque_sensor[0].std[0]
    modes = _SHAFT.mode_frequencies(_SETUP.arm, [0.0, 0.0]) / (2 * np.pi)
    turn = float(modes[0] * np.sqrt(residual / noise))  # torque goes with 1 / stiffness
    text = (
        f"{1e3 * residual:.2f} mN m with modes at {modes[0]:.0f} and {modes[1]:.0f} Hz, "
        f"{significant(noise / residual, 2)} times below the torque noise; as large with a mode at "
        f"{significant(turn, 2)} Hz"
    )
    return Measured(turn, text)


def backlash(gaps=(1e-3, 2e-3, 4e-3)) -> Measured:
    """Play behind a springy shaft that is significant, rad: share of the rigid body's torque."""
    loose = replace(_SHAFT, gap=np.outer((0, *gaps), (1, 1)))
    residual = _left(len(gaps) + 1, transmission=(loose,))
    share, text = _shares(residual[1:] - residual[0])
    turn = turns_at(gaps, share.max(-1), _SIGNIFICANT)
    text = f"if it had gears, play of {np.rad2deg(gaps[0]):.2f}°: {text}; "
    return Measured(turn, f"{text}{100 * _SIGNIFICANT:g} % from {np.rad2deg(turn):.2f}° on")


def high_frequency(softer=(0.3, 0.1)) -> Measured:
    """Torque that a springy shaft leaves over the rigid body's, ringing at the start included."""
    shafts = replace(_SHAFT, stiffness=np.outer((1, *softer), _SHAFT.stiffness))
    shares, text = _shares(_left(1 + len(softer), transmission=(shafts,)))
    share = shares.max(-1)
    others = ", ".join(f"{100 * x:.0f} % at {f:g}" for x, f in zip(share[1:], softer))
    text = f"springy shaft: {text}; the larger share is {others} of the stiffness"
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
    """Multiple of the viscous friction from which on late, held position feedback is stable."""
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
    turn = min(
        b for b, torque_noise in noise.items() if _shares(torque_noise)[0].max() < _SIGNIFICANT
    )
    text = f"16 bits, second differences at 100 a second: {_shares(noise[16])[1]}; below "
    return Measured(turn, f"{text}{100 * _SIGNIFICANT:g} % from {turn} bits on")
