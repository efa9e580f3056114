"""Sections 1.2 and 7.1: learners in the loop, trial by trial."""

from __future__ import annotations

import copy

import numpy as np

from beyond.control.feedback_error import GenericTerms, RigidBodyTerms
from beyond.studies.loop import learners
from beyond.studies.loop.abreast import repeated, run_abreast
from ddlib.control import Feedforward
from ddlib.dynamics import Arm, with_load
from ddlib.setups import JOINT_DAMPING, STATE_FEEDBACK
from ddlib.trajectories import Trajectory, pick_and_place
from workshop.report.code_hash import study

_LOAD = 5.0  # kg, in the hand from half-way on
_TESTS = ((15.0, 15.0), (40.0, 20.0), (20.0, 40.0))  # extents, degrees
_RATES = (0.1, 0.3, 1.0, 3.0, 10.0)  # multiples of the rates chosen


def trial(draw: learners.Draw, controllers, rows, references, t, arm: Arm | None = None):
    """End-point errors (mm, RMS), (rows, seeds), and stops of one trial of controllers abreast."""
    arm = arm or draw.setup.arm
    log, gap, stops, _ = run_abreast(arm, controllers, rows, references, t, effects=draw.effects)
    during = (log.t > -1e-9) & (log.t < -10 * t[0] - 1e-9)  # the rest is a tenth of the motion
    return 1e3 * np.sqrt((gap[..., during] ** 2).mean(-1)), stops


def practise(draw, pupils, reference, t, tested: Trajectory | None = None):
    """Trials of one motion: errors by trial of each learner, and of a second motion on the way."""
    errors = {name: [] for name in pupils}
    rows = [1] * len(pupils) * (2 if tested else 1)
    for _ in range(learners.TRIALS):
        now = [learner.controller() for learner in pupils.values()]
        frozen = [x.controller(False) for x in pupils.values()] if tested else []
        every = repeated(reference, len(now))
        if tested:
            more = repeated(tested, len(now))
            every = Trajectory(*(np.concatenate(pair) for pair in zip(every, more)))
        of_trial = trial(draw, now + frozen, rows, every, t)[0].reshape(-1, len(now), draw.seeds)
        for k, (name, learner) in enumerate(pupils.items()):
            errors[name].append(of_trial[:, k])
            learner.keep(now[k])
    return {name: np.array(each) for name, each in errors.items()}


def _motion(draw: learners.Draw) -> dict:
    """Practise one motion, be asked for others, go on to the other extents."""
    pupils, asked = learners.motion_learners(draw), learners.motions(draw)
    t, reference = asked["the same"]
    first = practise(draw, pupils, reference, t)
    tests = {}
    plain = [draw.plain, Feedforward(draw.equations, draw.setup.controller)]
    for name, (times, wanted) in asked.items():
        frozen = [learner.controller(False) for learner in pupils.values()]
        learning = [copy.deepcopy(learner).controller() for learner in pupils.values()]
        runs = len(plain) + 2 * len(pupils)
        every = repeated(wanted, runs)
        errors, _ = trial(draw, plain + frozen + learning, [1] * runs, every, times)
        tests[name] = {
            "no feedforward": errors[0],
            "exact equations": errors[1],
            "frozen": dict(zip(pupils, errors[2:])),
            "learning": dict(zip(pupils, errors[2 + len(pupils) :])),
        }
    second = practise(draw, pupils, asked["other extents"][1], t, reference)
    return {
        "practice": {name: x[:, 0] for name, x in first.items()},
        "tests": tests,
        "other": {name: x[:, 0] for name, x in second.items()},
        "forgetting": {name: x[:, 1] for name, x in second.items()},
    }


def _family(draw: learners.Draw) -> dict:
    """Practise members of the paper's family; a load from half-way on; tests on three motions."""
    pupils, t = learners.family_learners(draw), learners.grid()
    loaded = with_load(draw.setup.arm, _LOAD)
    tests = [pick_and_place(np.tile(extents, (draw.seeds, 1)), t) for extents in _TESTS]
    practice, tested = ({name: [] for name in ("no feedforward", *pupils)} for _ in range(2))
    rows, size = [1 + len(_TESTS)] + [1, len(_TESTS)] * len(pupils), 1 + len(_TESTS)

    def once(trial_number, arm, learning=True):
        own = pick_and_place(draw.family[:, trial_number], t)
        every = (np.stack(parts) for parts in zip(own, *tests))
        every = Trajectory(*(np.concatenate([x] * (1 + len(pupils))) for x in every))
        controllers = [draw.plain]
        for learner in pupils.values():
            controllers += [learner.controller(learning), learner.controller(False)]
        errors = trial(draw, controllers, rows, every, t, arm)[0]
        return errors.reshape(1 + len(pupils), size, draw.seeds)

    for k in range(2 * learners.TRIALS):
        arm = draw.setup.arm if k < learners.TRIALS else loaded
        for name, errors in zip(practice, once(k, arm)):
            practice[name].append(errors[0])
            tested[name].append(errors[1:].mean(0))
    after = once(0, draw.setup.arm, learning=False)
    last = once(0, loaded, learning=False)
    return {
        "practice": {name: np.array(x) for name, x in practice.items()},
        "tests": {name: np.array(x) for name, x in tested.items()},
        "at the end": {name: x[1:].mean(0) for name, x in zip(practice, last)},
        "without the load again": {name: x[1:].mean(0) for name, x in zip(practice, after)},
    }


def _rates(draw: learners.Draw) -> dict:
    """Six trials of one motion at several rates: the last error, and who was stopped."""
    t, reference = learners.motions(draw)["the same"]
    many, rates = len(_RATES), np.array(_RATES)[:, None]
    model = draw.untrained[[0] * many]
    pupils = {
        "exact terms": learners.Terms(
            RigidBodyTerms(learners.NAMES), draw, learners.TERMS_RATE * rates
        ),
        "generic terms": learners.Terms(GenericTerms(), draw, learners.TERMS_RATE * rates),
        "network, by feedback": learners.taught_by_feedback(
            model, draw, rates + np.zeros(draw.seeds)
        ),
    }
    every, stopped = repeated(reference, many * len(pupils)), False
    for _ in range(learners.TRIALS // 2):
        now = [learner.controller() for learner in pupils.values()]
        errors, stops = trial(draw, now, [many] * len(now), every, t)
        stopped = stopped | stops.stopped
        for learner, controller in zip(pupils.values(), now):
            learner.keep(controller)
    shape = (len(pupils), many, draw.seeds)
    errors, stopped = errors.reshape(shape), np.reshape(stopped, shape)
    return {name: {"error": e, "stopped": s} for name, e, s in zip(pupils, errors, stopped)}


@study
def _learning_in_the_loop() -> dict:
    """End-point errors of all learners, mm, for each reading of section 4."""
    by_setup = {}
    for setup in (JOINT_DAMPING, STATE_FEEDBACK):
        draw = learners.Draw(setup)
        parts = {"motion": _motion(draw), "family": _family(draw), "rates": _rates(draw)}
        by_setup[setup.name] = parts
    return {"setups": by_setup, "rates": _RATES, "trials": learners.TRIALS, "load": _LOAD}
