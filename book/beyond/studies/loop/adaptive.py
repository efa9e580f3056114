"""Adaptive control on the arm: what is learnt, what is not, and where it breaks."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.integrate import solve_ivp

from beyond.control.adaptive import SlotineLi
from beyond.studies.loop import adaptive_laws as batch
from beyond.studies.loop.abreast import delayed
from beyond.studies.loop.adaptive_laws import LAWS
from beyond.studies.loop.feedforwards import rounded
from ddlib.dynamics import CMU_DD_ARM_II, with_load
from ddlib.effects import IDEAL, Backlash, DeadZone, Effects, Ripple, StribeckFriction
from ddlib.setups import (
    JOINT_DAMPING,
    JOINT_DAMPING_COULOMB,
    JOINT_DAMPING_VISCOUS,
    KD,
    STATE_FEEDBACK,
    Setup,
)
from ddlib.simulation import CONTROL_STEP, REST
from ddlib.trajectories import (
    APPENDIX_I,
    MOTION_SECONDS,
    Trajectory,
    pick_and_place,
    smooth_pick_and_place,
)
from workshop.report.code_hash import study

_SEEDS, TRIALS = 10, 4  # runs of a setting; motions of a course, and with a load after it
_LOADS = (2.0, 5.0, 10.0)  # kg: Han, Hemami & Yurkovich 1987
_PICKED = 5.0  # kg, taken up half-way
_DELAYS = (1, 2, 4)  # control periods, with `_PICKED`
_BITS = (10.0, 11.0, 12.5, 14.0, 16.0, 20.0)  # encoders, bits a turn
_BEGIN = 0.5  # share of the base parameters that is known at the start
_MOST = tuple(JOINT_DAMPING_COULOMB)  # N m, of the unmodelled effects
_PLAY = (3.5e-3, 3.5e-3)  # rad: backlash of 0.2 degrees
_CORNERS = (0.0, 0.1, 0.2)  # s over which a plan's corners are averaged, as in `run_time`

# What is added to the set-up's effects.
_BED = {
    "nothing else": lambda e: e,
    "Stribeck": lambda e: replace(
        e, friction=(e.friction[0], StribeckFriction(_MOST, tuple(2 * x for x in _MOST), 0.1))
    ),
    "backlash": lambda e: replace(e, encoder=(Backlash(_PLAY), *e.encoder)),
    "dead zone": lambda e: replace(e, actuator=(DeadZone(_MOST), *e.actuator)),
    "ripple": lambda e: replace(e, motor=(Ripple(cogging=_MOST),)),
}

_FRICTION_TRUTH = np.concatenate([batch.TRUTH, JOINT_DAMPING_VISCOUS, JOINT_DAMPING_COULOMB])
_ZONE = (0.17, 0.14)  # rad/s: friction at the largest speed over the damping term
_FACTORS = tuple(10.0 ** np.arange(-2, 3.5, 0.5))  # rates of the map of stops, over those elsewhere
_LATE = (0, 1, 2, 3, 5)  # delays of that map, control periods


def _course(setup: Setup, seed: int = 1) -> dict:
    """Errors and estimates from trial to trial, before and after a load is taken up."""
    start = np.broadcast_to(_BEGIN * batch.TRUTH, (_SEEDS, 3))
    laws = {
        **batch.fixed_laws(setup),
        **{law: batch.make(law, setup, start) for law in LAWS},
        "with friction, jumps": batch.make("with friction", setup, start, jumps=True),
    }
    extents = batch.drawn_extents(_SEEDS, 2 * TRIALS, seed)
    trials = _taken_up(setup, laws, extents[:TRIALS], extents[TRIALS:], seed)
    known = [n for n in laws if n.startswith(LAWS)]
    return {
        "settled": batch.errors_by_law(trials, laws),
        "hand": batch.errors_by_law(trials, laws, "hand"),
        "stopped": int(sum(t.stops.stopped.sum() for t in trials)),
        "estimates": {
            n: np.stack([np.median(t.laws[n].estimate, 0) for t in trials]) for n in known
        },
        "unloaded": {n: trials[TRIALS - 1].laws[n].estimate for n in known},
    }


def _taken_up(setup: Setup, laws, before, after, seed: int, **options) -> list:
    """Motions before and after a load is taken up."""
    effects = batch.with_rounding(setup, _SEEDS, seed)
    trials, laws = batch.run_trials(laws, before, setup.arm, effects, **options)
    return (
        trials + batch.run_trials(laws, after, with_load(setup.arm, _PICKED), effects, **options)[0]
    )


def _again(setup: Setup, seconds: float, seed: int = 1) -> dict:
    """Errors along the same motions before and after a load, corners averaged over so many seconds.

    A plan without a jump is followed itself, without the model that smooths one.
    """

    def plan(extents, t):
        first = round((t[0] + REST) / CONTROL_STEP)
        return Trajectory(*(x[..., first : first + len(t), :] for x in rounded(extents, seconds)))

    start = np.broadcast_to(_BEGIN * batch.TRUTH, (_SEEDS, 3))
    laws = {**batch.fixed_laws(setup), **{law: batch.make(law, setup, start) for law in LAWS}}
    if seconds:
        laws = {n: x.controller if isinstance(x, batch.BehindModel) else x for n, x in laws.items()}
    extents = batch.drawn_extents(_SEEDS, TRIALS, seed)
    trials = _taken_up(setup, laws, extents, extents, seed, plan=plan)
    return {
        "settled": batch.errors_by_law(trials, laws),
        "hand": batch.errors_by_law(trials, laws, "hand"),
        "stopped": int(sum(t.stops.stopped.sum() for t in trials)),
    }


def _loads(setup: Setup, delays=(), seed: int = 2) -> dict:
    """Errors with loads that nobody knows of, in the first and second motion."""
    laws = {**batch.fixed_laws(setup), **{law: batch.make(law, setup) for law in LAWS}}
    extents, effects = (
        batch.drawn_extents(_SEEDS, 2, seed),
        batch.with_rounding(setup, _SEEDS, seed),
    )
    rows: list = []
    settings = [(m, 0) for m in _LOADS] + [(_PICKED, late) for late in delays]
    for mass, late in settings:
        arm = with_load(setup.arm, mass)
        trials, _ = batch.run_trials(laws, extents, arm, delayed(effects, late))
        rows.append({"load": mass, "late": late, "settled": batch.errors_by_law(trials, laws)})
    return {"rows": rows}


def _sensors(seed: int = 3) -> dict:
    """The third and fourth motion over the encoder, with a tachometer and without."""
    runs, setup = len(_BITS) * _SEEDS, JOINT_DAMPING
    step = np.repeat(2 * np.pi / 2 ** np.array(_BITS), _SEEDS)
    effects, rows = batch.with_rounding(setup, runs, seed, step), {}
    extents = np.tile(batch.drawn_extents(_SEEDS, TRIALS, seed), (1, len(_BITS), 1))
    start = np.broadcast_to(_BEGIN * batch.TRUTH, (runs, 3))

    def exact(q, qd, torque):
        limited = effects.actuator[0].apply(torque)
        return setup.arm.forward_dynamics(q, qd, limited - effects.friction_torque(qd))

    laws = {
        "Slotine & Li": batch.make("with friction", setup, start),
        "Craig, differences": batch.make("measured acceleration", setup, start),
        "Craig, exact": batch.make("measured acceleration", setup, start, acceleration=exact),
    }
    for velocity in ("tachometer", "difference"):
        trials, after = batch.run_trials(laws, extents, setup.arm, effects, velocity=velocity)
        rows[velocity] = {
            name: {
                "settled": errors[-1].reshape(len(_BITS), _SEEDS),
                "estimate": after[name].estimate.reshape(len(_BITS), _SEEDS, -1),
            }
            for name, errors in batch.errors_by_law(trials, laws).items()
        }
    return rows


def _lyapunov() -> dict:
    """The function that never rises: in continuous time, and sampled with several sensors."""
    extents, (slope, _) = APPENDIX_I[0], batch.gains(STATE_FEEDBACK)
    law = SlotineLi(KD, slope, 3.0 * batch.SIZES[:3] ** 2, _BEGIN * batch.TRUTH)

    def rates(t, y):
        wanted = Trajectory(*(x[0] for x in smooth_pick_and_place(extents, [t])))
        torque, change = law.output(y[4:], wanted, y[:2], y[2:4])
        return np.concatenate(
            [y[2:4], CMU_DD_ARM_II.forward_dynamics(y[:2], y[2:4], torque), change]
        )

    t = np.arange(1, 1500) * 0.002
    y0 = np.concatenate([np.zeros(4), law.estimate])
    states = solve_ivp(rates, (0.0, t[-1]), y0, "DOP853", t, rtol=1e-11, atol=1e-13).y.T
    wanted = smooth_pick_and_place(extents, t)
    truth = law.lyapunov(
        CMU_DD_ARM_II, batch.TRUTH, states[:, 4:], wanted, states[:, :2], states[:, 2:4]
    )
    rows = {"continuous": _rises(truth)}
    grid = np.arange(-50, 1550) * 0.002
    step = 2 * np.pi / 2 ** np.array([np.inf, 16.0, 12.5])
    for name, reference in (
        ("smooth", smooth_pick_and_place(APPENDIX_I, grid)),
        ("family", pick_and_place(APPENDIX_I, grid)),
    ):
        reference = Trajectory(*(np.broadcast_to(x, (3, *x.shape)) for x in reference))
        effects = Effects(encoder=(batch.RoundedReadings(step[:, None, None], np.zeros(2)),))
        values = batch.sampled_lyapunov(law, reference, grid, effects)
        for bits, each in zip(("perfect", "16 bits", "12.5 bits"), values):
            rows[f"{name}, {bits}"] = [_rises(v, grid) for v in each]
    return rows


def _rises(values, t=None) -> dict:
    """Largest rise in one step over the start, also away from 0 and 3 s; shares; what is left."""
    steps = np.diff(values) / values[0]
    calm = np.ones(steps.size, bool)
    if t is not None:
        near = np.minimum(np.abs(t), np.abs(t - MOTION_SECONDS))[1:]
        calm = near > 0.005
    return {
        "largest": float(steps.max()),
        "elsewhere": float(steps[calm].max()),
        "share": float((steps > 1e-12).mean()),
        "left": float(values[-1] / values[0]),
    }


def _excited(seed: int = 4, count: int = 10) -> dict:
    """What is found along single motions, repeated, and along the family; no friction."""
    extents = np.concatenate([APPENDIX_I, APPENDIX_I[:1]])
    course = np.broadcast_to(extents, (count, *extents.shape)).copy()
    course[:, -1] = batch.drawn_extents(1, count, seed)[:, 0]
    start = np.broadcast_to(_BEGIN * batch.TRUTH, (len(extents), 3))
    laws = {
        "learning": batch.make("rigid body", STATE_FEEDBACK, start),
        "knowing": batch.make("rigid body", STATE_FEEDBACK, factor=0.0),
        "not learning": batch.make("rigid body", STATE_FEEDBACK, start, factor=0.0),
    }
    trials, laws = batch.run_trials(laws, course, CMU_DD_ARM_II, IDEAL)
    return {
        "eigenvalues": np.linalg.eigvalsh(batch.excitation(APPENDIX_I)),
        "settled": batch.errors_by_law(trials, laws),
        "estimate": laws["learning"].estimate / batch.TRUTH,
    }


def _drift(seed: int = 5, count: int = 10) -> dict:
    """Estimates along trajectory 5 again and again: with rounding (first), and without."""
    setup, runs = JOINT_DAMPING, 2 * _SEEDS
    whole = np.broadcast_to(_FRICTION_TRUTH, (runs, 7))
    laws = {
        "plain": batch.make("with friction", setup, whole, 10.0),
        "dead zone": batch.make("with friction", setup, whole, 10.0, dead_zone=_ZONE),
        "leakage": batch.make("with friction", setup, whole, 10.0, leakage=0.3),
        "friction unmodelled": batch.make("rigid body", setup, whole[:, :3], 10.0),
        "unmodelled, dead zone": batch.make(
            "rigid body", setup, whole[:, :3], 10.0, dead_zone=_ZONE
        ),
    }
    step = np.where(np.arange(runs) < _SEEDS, setup.effects.encoder[0].step, 0.0)
    course = np.broadcast_to(APPENDIX_I[4], (count, runs, 2))
    trials, _ = batch.run_trials(
        laws, course, setup.arm, batch.with_rounding(setup, runs, seed, step)
    )
    return {
        "settled": batch.errors_by_law(trials, laws),
        "estimates": {
            n: np.stack([t.laws[n].estimate for t in trials])[..., :3] / batch.TRUTH for n in laws
        },
    }


def _compensation(setup: Setup, seed: int = 6) -> dict:
    """Friction alone adapted, the rigid body known, after Canudas et al. 1987."""
    viscous, coulomb = (np.asarray(f.slope if k == 0 else f.level) for k, f in
                        enumerate(setup.effects.friction))  # fmt: skip
    right = np.concatenate([batch.TRUTH, viscous, coulomb])
    only = np.where(np.arange(len(batch.WITH_FRICTION)) < 3, 0.0, 1.0)
    laws = {
        "none": batch.make("with friction", setup, factor=0.0),
        "adapted": batch.make("with friction", setup, np.broadcast_to(batch.TRUTH, (_SEEDS, 3))),
        "known": batch.make("with friction", setup, right, factor=0.0),
    }
    inner = laws["adapted"].controller
    laws["adapted"] = replace(laws["adapted"], controller=replace(inner, rate=only * inner.rate))
    trials, after = batch.run_trials(
        laws,
        batch.drawn_extents(_SEEDS, TRIALS, seed),
        setup.arm,
        batch.with_rounding(setup, _SEEDS, seed),
    )
    return {
        "settled": batch.errors_by_law(trials, laws),
        "estimate": after["adapted"].estimate[:, 3:],
        "truth": right[3:],
    }


def _bed(seed: int = 7, count: int = 3) -> dict:
    """Unmodelled effects under laws that adapt what they have, from the right parameters."""
    setup, rows = JOINT_DAMPING, {}
    right = np.broadcast_to(_FRICTION_TRUTH, (_SEEDS, 7))
    laws = {
        "adapted": batch.make("with friction", setup, right),
        "held": batch.make("with friction", setup, _FRICTION_TRUTH, factor=0.0),
    }
    bare = {
        "rigid, adapted": batch.make("rigid body", setup, right[:, :3]),
        "rigid, held": batch.make("rigid body", setup, batch.TRUTH, factor=0.0),
    }
    for k, (name, added) in enumerate(_BED.items()):
        given = laws if k else {**laws, **bare}
        effects = added(batch.with_rounding(setup, _SEEDS, seed))
        trials, after = batch.run_trials(
            given, batch.drawn_extents(_SEEDS, count, seed), setup.arm, effects
        )
        rows[name] = {
            "settled": {n: x[-1] for n, x in batch.errors_by_law(trials, given).items()},
            "estimate": after["adapted"].estimate / _FRICTION_TRUTH,
        }
        if given is not laws:
            rows[name]["rigid"] = after["rigid, adapted"].estimate / batch.TRUTH
    return rows


def _map(setup: Setup = JOINT_DAMPING) -> dict:
    """Where runs are stopped: rate of adaptation against delay, and why."""
    extents = np.tile(APPENDIX_I[[0, 5]], (len(_FACTORS), 1))
    factor, names = np.repeat(_FACTORS, 2), LAWS[1:]
    start, rows = np.broadcast_to(_BEGIN * batch.TRUTH, (len(extents), 3)), []
    for late in _LATE:
        laws = {n: batch.make(n, setup, start, factor) for n in names}
        effects = delayed(setup.effects, late)
        first = batch.trial(laws, extents, setup.arm, effects)
        again = batch.trial(first.laws, extents, setup.arm, effects)
        ended = first.stops.stopped
        time = np.where(ended, first.stops.time, 3.2 + again.stops.time)
        reason = np.where(ended, first.stops.reason, again.stops.reason)
        shape = (len(names), len(_FACTORS), 2)
        rows.append(
            {
                "late": late,
                "time": np.where(np.isfinite(time), time, -1.0).reshape(shape),
                "reason": reason.reshape(shape),
                "settled": again.settled.reshape(shape),
            }
        )
    return {"laws": list(names), "factors": _FACTORS, "rows": rows}


@study
def _adaptive() -> dict:
    """Everything that the chapter on adaptive control says of runs."""
    both = {s.name: s for s in (JOINT_DAMPING, STATE_FEEDBACK)}
    return {
        "course": {name: _course(s) for name, s in both.items()},
        "same motions": {
            f"{seconds:g}": {name: _again(s, seconds) for name, s in both.items()}
            for seconds in _CORNERS
        },
        "loads": {
            JOINT_DAMPING.name: _loads(JOINT_DAMPING, _DELAYS),
            STATE_FEEDBACK.name: _loads(STATE_FEEDBACK),
        },
        "bits": _BITS,
        "sensors": _sensors(),
        "lyapunov": _lyapunov(),
        "excitation": _excited(),
        "drift": _drift(),
        "compensation": {name: _compensation(s) for name, s in both.items()},
        "bed": _bed(),
        "map": _map(),
    }
