"""Section 7.1: on what four findings about closed loops hang, tried after they were found."""

from __future__ import annotations

import copy
import warnings
from dataclasses import replace

import numpy as np

from beyond.control.feedback_error import RigidBodyTerms
from beyond.control.windowed import WindowFeedforward
from beyond.rivals.identified import Identified
from beyond.rivals.networks import BySolver
from beyond.rivals.protocol import Cases, Estimating
from beyond.studies.loop import (
    feedforwards as run_time,
    joints,
    learners,
    learning,
    motions,
    stirring,
)
from beyond.studies.loop.abreast import repeated
from beyond.studies.loop.chain import Sample, chain, extents, recorded
from ddlib.setups import INITIAL, JOINT_DAMPING, STATE_FEEDBACK, Setup
from ddlib.trajectories import (
    APPENDIX_I,
    MOTION_SECONDS,
    OutsideFamilyWarning,
    Trajectory,
    pick_and_place,
    random_extents as random_members,
    smooth_pick_and_place,
)
from workshop.report.code_hash import study

_COPIES = (0.0, 0.02, 0.05, 0.07, 0.1)  # s: smoothing of the plan that exact equations are given
_STEPS = (5, 15, 60)  # of the solver, to choose from
_DECAYS = (1e-6, 1e-3, 1e-2)  # to choose from, with four joints
_LATER, _MEMBERS, _TEST = 500, 12, 4711  # first day; test motions, and their seed


def _copies(setup: Setup, days) -> dict:
    """End-point errors on the paper's own plan, equations given a smoothed copy of it, mm."""
    plan, equations = run_time.rounded(run_time.FEWER_EXTENTS, 0.0), run_time.exact(setup)
    torques = {"none": 0 * plan.q[None]}
    torques |= {
        f"{s:g}": equations(*run_time.rounded(run_time.FEWER_EXTENTS, s))[None] for s in _COPIES
    }
    torques["network"] = run_time.torques_along(run_time.networks(setup, len(days)), plan)
    lines = {name: (torque, days) for name, torque in torques.items()}
    return run_time.median_errors(setup, lines, plan)


def _cases(run, every: int) -> Cases:
    return Cases.windows(run, stirring._WIDTH)[::every]


def _fitted(steps: int, cases: Cases, day: int) -> BySolver:
    rival = BySolver(10, steps, decay=JOINT_DAMPING.decay, initial=INITIAL, seed=day)
    return stirring.fitted(rival, cases)


def _chosen_steps(run, day: int) -> int:
    """Steps, of `_STEPS`, with the least error on runs of pick-and-place left out in turn."""
    wrong = np.zeros(len(_STEPS))
    for out in range(len(run.q)):
        rest = _cases(run[[k for k in range(len(run.q)) if k != out]], 4)
        asked = _cases(run[[out]], 4)
        course = joints.solved(
            rest.x, rest.torque, (asked.x, asked.torque), seed=day,
            steps=max(_STEPS), decay=JOINT_DAMPING.decay,
        ).history.test[:, 0]  # fmt: skip
        wrong += course[np.minimum(_STEPS, len(course) - 1)] ** 2
    return _STEPS[int(wrong.argmin())]


def _stopped(setup: Setup, days, circles: bool) -> dict:
    """Hands with training stopped by pick-and-place itself, and after twenty circles if asked."""
    t = motions.times()
    asked = {
        "circles": motions.stirred(setup.arm, motions.random_circles(_MEMBERS, _TEST), t),
        "pick and place": pick_and_place(random_members(_MEMBERS, _TEST), t),
    }
    steps, models = [], {"chosen": [], "60": [], "identified": []}
    for day, run in zip(
        days, motions.on_several_days(setup, [pick_and_place(APPENDIX_I[:5], t)] * len(days), days)
    ):
        whole = _cases(run, 1)
        steps.append(_chosen_steps(run, day))
        models["60"].append(_fitted(_STEPS[-1], whole, day))
        stops = steps[-1] < _STEPS[-1]
        models["chosen"].append(_fitted(steps[-1], whole, day) if stops else models["60"][-1])
        models["identified"].append(Estimating(Identified()).fit(whole))
    if circles:
        drawn = [motions.stirred(setup.arm, motions.random_circles(20, day), t) for day in days]
        models["twenty circles"] = [
            _fitted(_STEPS[-1], _cases(run, 4), day)
            for day, run in zip(days, motions.on_several_days(setup, drawn, days))
        ]
    today = setup.repeated(_TEST)
    hands = {motion: _hands(today, models, reference) for motion, reference in asked.items()}
    return {"steps": steps, "hands": hands}


def _hands(setup: Setup, models: dict, reference: Trajectory) -> dict:
    """Median over a family of the hand's error, one for each model of each name, mm."""
    with warnings.catch_warnings(action="ignore", category=OutsideFamilyWarning):
        torques = {
            name: [WindowFeedforward(m._torque, stirring._WIDTH)(*reference) for m in several]
            for name, several in models.items()
        }
    torques = {"none": [0 * reference.q], **torques}
    hands = stirring.hand_errors(setup, torques, reference)
    return {name: np.median(errors, -1) for name, errors in hands.items()}


def _windows(seeds: int) -> dict:
    """Errors with four joints: fewer windows of twenty motions, and five with chosen training."""
    arm = chain(4)
    test, errors = joints.tested(arm), {"300 of twenty": [], "750 of twenty": [], "chosen": []}
    errors["as it is"] = []
    for seed in range(_LATER, _LATER + seeds):
        for number in (300, 750):
            part = recorded(arm, extents(4, 20, seed), seed).thinned(number)
            errors[f"{number} of twenty"].append(_error(part, test, seed))
        five = recorded(arm, extents(4, 5, seed), seed).thinned(joints.TRAINING_CASES)
        errors["as it is"].append(_error(five, test, seed))
        decay, steps = chosen_decay(five, seed)
        errors["chosen"].append(_error(five, test, seed, decay=decay, steps=steps))
    return errors


def _course(training: Sample, test: Sample, seed: int, **options) -> np.ndarray:
    """Errors on a test after each step of the solver."""
    return joints.solved(*training.pair, test.pair, seed=seed, **options).history.test


def _error(training: Sample, test: Sample, seed: int, **options) -> float:
    return float(_course(training, test, seed, **options)[-1, 0])


def chosen_decay(five: Sample, seed: int) -> tuple[float, int]:
    """Decay and number of steps with the least error on motions that are left out in turn."""
    run, best = np.repeat(np.arange(5), len(five.torque) // 5), (np.inf, 0.0, 1)
    for decay in _DECAYS:
        courses = []
        for out in range(5):
            rest, asked = (_part(five, np.flatnonzero(keep)) for keep in (run != out, run == out))
            courses.append(_course(rest, asked, seed, decay=decay)[:, 0])
        length = min(map(len, courses))
        mean = np.median([course[:length] for course in courses], 0)
        step = int(mean[1:].argmin()) + 1
        best = min(best, (float(mean[step]), decay, step))
    return best[1:]


def _part(sample: Sample, cases: np.ndarray) -> Sample:
    runs = len(cases) * sample.runs // len(sample.torque)
    return Sample(sample.windows[cases], sample.torque[cases], sample.states[cases], runs)


def _practised(setup: Setup, seeds: int) -> dict:
    """One motion practised, then frozen on others, mm: three motions, and a scaled memory."""
    draw = learners.Draw(setup, first=_LATER, seeds=seeds)
    asked = learners.motions(draw)
    practise = {
        "in step": asked["the same"],
        "out of step": (learners.grid(), _out_of_step(draw)),
        "two harmonics": asked["two harmonics"],
    }
    return {name: _after(draw, *motion, asked) for name, motion in practise.items()}


def _out_of_step(draw) -> Trajectory:
    """The extents of the practised motion; the elbow starts three tenths of it later."""
    share, t = 0.7, learners.grid()
    shoulder, elbow = (
        smooth_pick_and_place(draw.learnt, (t - wait) / share, 1.0)
        for wait in (0.0, (1 - share) * MOTION_SECONDS)
    )
    pairs = zip(shoulder, elbow, (1, share, share**2))
    return Trajectory(*(np.stack([a[..., 0], b[..., 1]], -1) / s for a, b, s in pairs))


def _after(draw, t, reference: Trajectory, asked: dict) -> dict:
    terms = RigidBodyTerms(learners.NAMES)
    taught = {
        "exact terms": learners.Terms(terms, draw),
        "exact terms, slower": learners.Terms(terms, draw, 0.3 * learners.TERMS_RATE),
        "network, last layer": learners.last_layer(draw.untrained, draw),
        "linear filter": learners.linear_filter(draw),
        "memory": learners.Memory(draw),
    }
    learning.practise(draw, taught, reference, t)
    by_motion: dict = {}
    for motion, (times, wanted) in asked.items():
        speed = {"in 2/3 of the time": 1.5, "in half the time": 2.0}.get(motion, 1.0)
        scaled = copy.deepcopy(taught["memory"].memory)
        scaled.torque = scaled.torque * speed**2
        every = {"none": draw.plain} | {k: x.controller(False) for k, x in taught.items()}
        every["memory, scaled"] = scaled
        many = repeated(wanted, len(every))
        errors, _ = learning.trial(draw, list(every.values()), [1] * len(every), many, times)
        by_motion[motion] = dict(zip(every, errors))
    return by_motion


@study
def _loop_conditions(days: int = 10, seeds: int = 10) -> dict:
    """Four findings under other conditions, both set-ups where they were found in both."""
    both = (JOINT_DAMPING, STATE_FEEDBACK)
    solved = replace(STATE_FEEDBACK, steps=JOINT_DAMPING.steps, decay=JOINT_DAMPING.decay)
    later = range(_LATER, _LATER + days)
    return {
        "copies": {s.name: _copies(s, later) for s in both},
        "stopped": {
            s.name: _stopped(s, later, circles)
            for s, circles in ((JOINT_DAMPING, True), (solved, False))
        },
        "windows": _windows(seeds),
        "practised": {JOINT_DAMPING.name: _practised(JOINT_DAMPING, seeds)},
    }
