"""Bad input: every argument of a public call, replaced by what it cannot be, is refused by name.

The calls are found: all that a room of ddlib hands on, with the methods of its classes. What an
argument is follows from the call (`meant`), its default, or its name (`examples`); what it cannot
be, from the kind of that. So a new function joins by itself, or the first test says which of its
arguments has no example. `ddlib.logs` and `ddlib.widgets` have tests of their own.
"""

import importlib
import inspect
import re
import warnings
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cache
from typing import NamedTuple

import numpy as np
import pytest
from hypothesis import HealthCheck, Phase, given, settings, strategies as st

from ddlib import (
    analysis,
    control,
    dynamics,
    effects,
    identification,
    learning,
    setups,
    simulation,
    trajectories,
)
from ddlib.dynamics import CMU_DD_ARM_II as ARM, PUMA_560, Link
from ddlib.trajectories import Trajectory

ROOMS = ("trajectories", "metrics", "setups", "dynamics", "effects", "control", "simulation",
         "identification", "learning", "analysis", "figures")  # fmt: skip

T = trajectories.time_grid(0.02, 0.2)
REFERENCE = trajectories.pick_and_place([30.0, 20.0], T)
Q, QD, QDD = np.array([[0.1, 0.2], [0.3, -0.4], [1.0, 2.0]])
SIX = dict(arm=PUMA_560, q=np.zeros(6), qd=np.zeros(6), qdd=np.ones(6))
PAIR, FILTER = np.array([0.4, 0.2]), np.array([1.0, -2.0, 3.0, 0.5, -1.0])
LINK = Link(14.0, 0.5, 0.22, 0.4)
BODY = dynamics.SpatialLink(0.0, 0.5, 0.0, 1.0, (0.0, 0.0, 0.0), np.eye(3))
LABELS = ("time, s", "torque, N m")


@cache
def made() -> dict:
    """What takes a moment to make, by the names of arguments and of classes."""
    pid = control.PID((300.0, 90.0), kd=(60.0, 20.0))
    extents = [[45.0, 45.0], [38.0, 32.0], [5.0, 39.0]]
    runs = simulation.record(
        ARM, pid, extents, log_step=0.02, effects=setups.STATE_FEEDBACK.effects
    )
    data = learning.TrainingSet.from_recording(runs, 7)
    windows, torque = learning.cases(runs, 7)
    nets = learning.Weights.random(2, 7, hidden=3)
    model = learning.TorqueModel(nets, data.inputs, data.outputs, 0.02)
    activity, inside = nets[0].activity(data.x)[0], runs[0].motion
    q, qd, tau = (x[0, inside] for x in (runs.q_true, runs.qd_true, runs.tau))
    states = np.stack([q, qd, ARM.forward_dynamics(q, qd, tau)], -1)
    equations = identification.by_modulation(runs, ("a", "b", "d"))
    return locals()


@cache
def examples() -> dict:
    """What an argument of a name is."""
    m = made()
    return {
        **{name: m[name] for name in ("windows", "torque", "model", "data", "states", "equations")},
        "arm": ARM, "q": Q, "qd": QD, "qdd": QDD, "tau": QDD, "wanted": Q,
        "hand": np.full((4, 2), 0.5),
        "velocity": np.ones((4, 2)), "acceleration": np.ones((4, 2)), "link1": LINK, "link2": LINK,
        "links": [LINK, LINK], "link": LINK, "joints": 2, "posture": PAIR, "viscous": PAIR,
        "formulation": dynamics.newton_euler, "lengths": PAIR, "gravity_moments": PAIR,
        "name": "mine",
        "a": 3.0, "b": 0.2, "d": 0.2, "mass": 2.0, "length": 0.5, "com": 0.22, "inertia": 0.4,
        "gravity": 9.81, "extents_deg": PAIR, "t": T, "n": 3, "seed": 1, "step": 0.02, "y": PAIR,
        "level": PAIR, "breakaway": 2 * PAIR, "coefficient": PAIR, "width": 7, "stiffness": PAIR,
        "motor_inertia": PAIR, "damping": PAIR, "gap": PAIR, "limit": PAIR, "std": PAIR,
        "angle": PAIR,
        "periods": 2, "bits": 16, "seconds": 1.5, "cogging": PAIR, "share": PAIR,
        "cycles": PAIR * 50,
        "kp": PAIR, "ki": PAIR, "kd": PAIR, "controller": m["pid"], "feedback": m["pid"],
        "period": 0.01, "late": 0.003, "gain": np.ones((1, 2)), "degree": 2,
        "weights": m["nets"][0],
        "filters": [FILTER, FILTER], "reference": REFERENCE, "trajectory": REFERENCE,
        "recording": m["runs"][0], "start": (Q, QD), "x": m["data"].x, "duration": 3.0,
        "target": m["torque"], "predicted": m["torque"], "scale": PAIR,
        "truth": np.ones(3), "repetitions": 2, "cutoff": 5.0, "skip": 0.1,
        "rates": FILTER**2, "epochs": [1, 5], "kind": "shifted", "draws": 2, "value": 0.5,
        "change": np.zeros(m["nets"][0].count(biases=True)), "members": 2, "low": PAIR,
        "high": 2 * PAIR,
        "samples": np.stack([Q, QD, QDD]), "radius": 1.0, "cells": 4, "resolution": 0.1,
        "f": FILTER,
        "frequencies": PAIR, "derivative": 1, "penalties": FILTER**2, "activity": m["activity"],
        "first": m["activity"], "second": m["activity"], "net_input": m["activity"],
        "values": FILTER,
        "deviation": PAIR, "torque_noise": 0.1, "gears": np.array([1.0, 10.0]), "rotor": 0.1,
        "features": m["data"].x[:, 0], "held_out": m["data"].x[:, 0], "answer": m["torque"],
        "outputs": m["activity"][: len(m["states"])], "predict": m["model"][0].torque,
        "label": "torque, N m", "x_label": "time, s", "y_label": "torque, N m", "alt": "A line.",
        "functions": FILTER, "labels": LABELS, "draw": lambda figure: None,
        "setup": setups.STATE_FEEDBACK, "effects": setups.STATE_FEEDBACK.effects,
        "parts": "friction",
    }  # fmt: skip


@cache
def meant() -> dict:
    """Arguments that mean something else in a call than by their name or default."""
    m, plant = made(), control.plant(1.0, 0.5)
    run, few, net = m["runs"][0], m["windows"][: len(m["states"])], m["nets"][0]
    loop = dict(joints=plant, kp=4.0, ki=0.1, kd=1.0, period=0.01, delay=1)
    one = dict(inertia=1.0, viscous=0.5, kp=40.0, ki=1.0, kd=1.0)
    test = (m["data"].x, m["data"].y)
    training = dict(rate=0.1, momentum=0.5, epochs=2, progress=False)
    return {
        **{name: SIX for name in ("mass_matrix", "regressor", "PUMA.inverse_dynamics")},
        "count_operations": dict(arm=PUMA_560.first(2), knowledge="arm"),
        "locked": dict(arm=dynamics.DD_ARM_II_IN_SPACE),
        "operations_table": dict(joints=[1, 2]),
        "derive": dict(links=2, gravity=True),
        "SpatialLink": dict(twist_deg=90.0, offset=0.1, com=np.zeros(3), inertia=np.eye(3)),
        "SerialArm": dict(links=[BODY, BODY], gravity=np.zeros(3)),
        "SerialArm.inverse_dynamics": {k: x[..., :2] for k, x in SIX.items() if k != "arm"},
        "inverse_kinematics": dict(hand=np.array([0.5, 0.5])),
        "DeadZone": dict(width=PAIR), "Load": dict(torque=PAIR), "Ripple": dict(phase=0.1),
        "FlexibleJoint": dict(motor_inertia=PAIR / 10),
        "Effects": dict(friction=(effects.ViscousFriction(PAIR),)),
        "Quantisation": dict(step=0.1), "ComputingTime": dict(seconds=1e-3),
        "plant": dict(inertia=np.eye(2), stiffness=np.eye(2)),
        "loop_gain": one, "closed_loop": loop, "opened_loop": {**loop, "joint": 0},
        "late_poles": dict(joints=plant), "margins": dict(loop=control.loop_gain(1.0, 0.5, 40.0)),
        "proportional_limit": dict(inertia=1.0, viscous=0.5),
        "poles_and_bode": dict(loops={"one": control.loop_gain(1.0, 0.5, 40.0)}, decay=1.0),
        "noise_gain": dict(weights=FILTER), "EstimatedVelocity": dict(weights=FILTER),
        "Feedforward": dict(model=ARM), "feedforward_system": dict(model=ARM),
        "keep": dict(extents_deg=trajectories.APPENDIX_I),
        "record": dict(rest=0.2, control_step=0.01, log_step=0.02, duration=1.0),
        "follow": dict(log_every=2), "rms": dict(x=m["torque"], axis=0),
        "predicted_response": dict(period=0.01, seconds=1.0),
        "simulated_response": dict(period=0.01, seconds=4.0),
        "residual_torque": dict(recording=simulation.record(
            ARM, m["pid"], PAIR, rest=0.2, control_step=0.02, log_step=0.02
        )),
        "run_system": dict(
            system=simulation.feedforward_system(ARM, ARM, PAIR, PAIR), t=T[:20],
            reference=Trajectory(*(x[:20] for x in REFERENCE)),
        ),
        "Recording": vars(run), "Setup": dict(steps=2, decay=0.1, hidden=3, initial=0.1),
        "from_states": dict(torque=QDD), "kalman_states": dict(q=run.q, noise=1e-3),
        "butterworth_states": dict(q=run.q), "encoder_step": dict(q=run.q),
        "by_modulation": dict(width=0.6),
        "FilteredEquations": dict(regressor=("a", "b", "d"), pull=0.1),
        "FilteredEquations.fit": dict(runs=m["runs"]),
        "FilteredEquations.predict": dict(runs=m["runs"]),
        "joint_columns": dict(states=np.ones((4, 6, 3)), joint=1),
        "joint_terms": dict(states=np.ones((4, 6, 3))),
        "true_parameters": dict(names=("a", "F_v1")),
        "RecursiveLeastSquares": dict(weights=np.zeros((2, 3))),
        "RecursiveLeastSquares.update": dict(features=np.ones(3), target=np.ones(2)),
        "Estimate": vars(identification.least_squares(m["equations"])),
        "Estimate.half_width": dict(level=0.9), "Estimate.covers": dict(level=0.9),
        "sliding_windows": dict(q=run.q, cases=slice(10, 20)),
        "Scaler.fit": dict(data=PAIR[None] * FILTER[:, None]),
        "Scaler.scale": dict(data=PAIR), "Scaler.unscale": dict(data=PAIR),
        "TorqueModel": dict(weights=m["nets"], inputs=m["data"].inputs, outputs=m["data"].outputs),
        "TrainingSet.from_arrays": dict(target=(0.2, 0.8)),
        "Weights.random": dict(hidden=3, joints=2, outputs=2),
        "WindowNetwork": dict(hidden=3, joints=2, outputs=2),
        "p_value": dict(draws=FILTER), "surrogate": dict(torque=m["runs"].tau),
        "surrogates": dict(torque=m["runs"].tau),
        "train": dict(network=learning.WindowNetwork(7, 3), y=m["data"].y, **training),
        "train_ensemble": dict(weights=m["nets"], warm_up=1, snapshots=[1], test=test, **training),
        "solve": dict(
            steps=1, decay=1e-3, tolerance=1e-3, target_rmss=0.1, progress=False, test=test
        ),
        "explained": dict(target=FILTER, by=FILTER**2),
        "filter_responses": dict(f=net.hidden_weights, windows=few),
        "frequency_response": dict(frequencies=np.array([1.0, 2.0]), step=0.01),
        "purest": dict(f=analysis.basis(7)[1:3], name="velocity"),
        "half_penalty": dict(states=np.tile(m["states"], (3, 1, 1)), joint=0),
        "ablation": dict(model=m["model"][0]), "shuffled": dict(states=m["windows"]),
        "linear_residual": dict(q=run.q, qd=run.qd_true, qdd=run.reference.qdd),
        "noise_floor": dict(bits=16.0), "hinton": dict(scale="row"),
        "curves": dict(x=FILTER, panels={"torque, N m": {"one": FILTER}}),
        "families": dict(panels={"": {"one": (FILTER, np.ones((5, 2)))}}),
        "by_case": dict(x=FILTER, cases={"one": FILTER}),
        "clouds": dict(panels={"one": (FILTER, FILTER)}, slope=1.0),
        "gallery": dict(groups={"": np.ones((3, 2, 5))}),
        "readings": dict(
            panels={"inertia, kg m²": {"one": FILTER}}, truth={"inertia, kg m²": {"one": 1.0}}
        ),
        "illustrate": dict(narrow_height=2.0), "looks": dict(names=["measured", "one"]),
        "squares": dict(rows=np.ones((2, 7)), names=LABELS, scale=np.ones((2, 7))),
        "rmss_by_window": dict(table={"one": {"test": {7: FILTER**2}}}, printed={"test": {7: 0.1}}),
        "quote": dict(value=1.0),
    }  # fmt: skip


# These only hold what another call made, are a part of one, or are looked at when they are used
APART = set(
    "AppendixErrors COLOUR_MAP Combination ControlLaw Controller Descent Directions Equations "
    "History Illustration Lazy Operations Solution Tape TorqueNetwork TrainingInterrupted "
    "TrainingSet Trajectory Weights checked dots_in_one errors kernels lagrange_euler legend_above "
    "module_gradient newton_euler plain_ticks prepare recursive_lagrange Recording repeat split "
    "train_windows".split()
)
# What our own loops call at every step, which takes what they hand on
INNER = {"apply", "friction_torque", "forward", "mapped", "save", "load", "shaft_torque",
         "spring_torque", "start", "constants", "module", "weights", "record"}  # fmt: skip
# What looks at its arguments when it is used
USED = {
    "EncoderZero": lambda zero: zero.apply(Q),
    "Feedforward": lambda law: law.start(REFERENCE, 0.02),
    "TorqueModel": lambda model: model.torque(made()["windows"]),
}
# Words for people, and a period that is only compared with that of a recording
ASIDE = {"Arm.provenance", "Arm.from_links.provenance", "as_controller.name", "solve.label",
         "train_ensemble.label", "TorqueModel.step"}  # fmt: skip
# What others make; its methods are for readers
MADE = {"Estimate"}
SIGNED = {"angle", "b", "com", "gravity", "gravity_moments", "inertia", "length", "offset", "phase",
          "posture", "slope", "twist_deg", "value"}  # fmt: skip
FREE = {"name", "alt", "label", "x_label", "y_label"}  # texts of which any will do


class Call(NamedTuple):
    """A call that works."""

    name: str
    function: Callable
    arguments: dict

    def answer(self, **changed):
        """What it gives."""
        arguments = {**self.arguments, **changed}
        starred = [p.name for p in parameters(self.function) if p.kind is p.VAR_POSITIONAL]
        rest = [arguments.pop(name) for name in starred]
        given = (*arguments.values(), *rest) if starred else ()
        found = self.function(*given, **({} if starred else arguments))
        return USED.get(self.name, lambda answer: answer)(found)


def parameters(function) -> list:
    return list(inspect.signature(function).parameters.values())


def arguments(name, function) -> dict:
    """Examples of a call's arguments; of one that has none, and no default, `inspect._empty`."""
    own, known, chosen = meant().get(name, {}), examples(), {}
    for p in parameters(function):
        if p.name in own:
            chosen[p.name] = own[p.name]
        elif p.kind is p.VAR_KEYWORD or f"{name}.{p.name}" in ASIDE:
            continue
        elif p.default is not None and p.default is not p.empty:
            chosen[p.name] = p.default
        elif p.name in known or p.default is p.empty:
            chosen[p.name] = known.get(p.name, p.empty)
    return chosen


@cache
def calls(room) -> tuple[Call, ...]:
    """All public calls of a room."""
    module = importlib.import_module(f"ddlib.{room}")
    own = (k for k, x in vars(module).items() if getattr(x, "__module__", "") == module.__name__)
    names = getattr(module, "__all__", None) or [name for name in own if name[0] != "_"]
    found = []
    for name in sorted(set(names) - APART):
        thing = getattr(module, name)
        if not callable(thing) or (isinstance(thing, type) and issubclass(thing, BaseException)):
            continue
        whole = Call(name, thing, arguments(name, thing))
        found += [whole] * (name not in MADE)
        if isinstance(thing, type):
            found += methods(whole, room)
    return tuple(found)


def methods(whole, room) -> list[Call]:
    """The calls of a class by itself, and of the instance that an example of its call makes."""
    skipped = INNER | ({"torque"} if room == "effects" else set())
    of_class = [k for k, x in vars(whole.function).items() if k[0] != "_" and k not in skipped]
    found, instance = [], None
    for name in of_class:
        kind = vars(whole.function)[name]
        if isinstance(kind, (classmethod, staticmethod)):
            function = getattr(whole.function, name)
        elif inspect.isfunction(kind):
            instance = whole.function(**whole.arguments) if instance is None else instance
            if whole.name == "FilteredEquations":
                instance.fit(made()["runs"])
            function = getattr(instance, name)
        else:
            continue
        found.append(
            Call(f"{whole.name}.{name}", function, arguments(f"{whole.name}.{name}", function))
        )
    return [call for call in found if call.arguments]


@pytest.mark.parametrize("room", ROOMS)
def test_every_public_call_has_an_example_that_works(room):
    without = {
        c.name: [k for k, x in c.arguments.items() if x is inspect.Parameter.empty]
        for c in calls(room)
    }
    assert not {name: missing for name, missing in without.items() if missing}
    for call in calls(room):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            call.answer()


# --- what an argument cannot be -----------------------------------------------------------------

OBJECTS = st.sampled_from([object(), 1j, {}, BODY])
WORDS = st.text("abcde", min_size=1, max_size=6).map(lambda word: f"no {word}")
NOT_FINITE = st.sampled_from([np.nan, np.inf, -np.inf])
RAGGED = st.sampled_from([[1.0, [2.0, 3.0]], [[1.0], [2.0, 3.0]]])


@st.composite
def spoilt(draw, value):
    """An array with one entry that is none, or of a kind that is no real number."""
    bad, place = value.astype(float), draw(st.integers(0, value.size - 1))
    bad.flat[place] = draw(NOT_FINITE)
    return draw(st.sampled_from([bad, value.astype(str), value.astype(complex), value != 0]))


def wrong(name, value, optional) -> list:
    """Strategies for what cannot stand in place of a value, by its kind."""
    kinds = [OBJECTS, WORDS] if name not in FREE else [OBJECTS]
    kinds += [] if optional else [st.none()]
    if isinstance(value, (bool, np.bool_)):
        return [*kinds, st.integers(2, 9), RAGGED]
    if isinstance(value, (int, np.integer)):
        return [*kinds, NOT_FINITE, st.floats(0.1, 0.9), st.integers(-(10**30), -(10**9)), RAGGED]
    if isinstance(value, float):
        below = [] if name in SIGNED else [st.floats(-1e9, -1e-3)]
        return [*kinds, NOT_FINITE, st.booleans(), st.just(10**400), RAGGED, *below]
    if isinstance(value, str):
        return [*kinds[:1], *kinds[2:], *([] if name in FREE else [WORDS]), st.integers(), RAGGED]
    if isinstance(value, np.ndarray):
        return [*kinds, spoilt(value), RAGGED]
    if isinstance(value, Trajectory):
        return [
            *kinds,
            st.just(value[:2]),
            st.just(value._replace(qdd=value.qdd[..., :1])),
            spoilt(value.q),
        ]
    if value is LABELS:
        return [*kinds, st.just(["a", 1]), st.just(["a"]), RAGGED]
    return [*kinds, st.integers(3, 9), NOT_FINITE, st.just([None]), st.just(["no", 3])]


def odd(value) -> list:
    """What a call may take or refuse, but never answer with NaN or an error of another library."""
    if isinstance(value, np.ndarray):
        return [st.just(np.zeros(shape)) for shape in ((0,), (3, 5, 2, 9), (0, *value.shape))]
    if isinstance(value, (float, int)) and not isinstance(value, bool):
        return [st.just(0), st.just(-1)]
    return []


def has_nan(answer) -> bool:
    """Whether there is a NaN in an answer."""
    if isinstance(answer, Mapping):
        answer = tuple(answer.values())
    if isinstance(answer, (tuple, list)):
        return any(map(has_nan, answer))
    is_numbers = isinstance(answer, (float, np.ndarray)) and np.asarray(answer).dtype.kind in "fc"
    return is_numbers and bool(np.isnan(answer).any())


def fault(call, name, value, must) -> str:
    """What is wrong with the answer to bad input; nothing if it is refused by its name."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            warnings.simplefilter("error", RuntimeWarning)
            answer = call.answer(**{name: value})
    except (TypeError, ValueError, IndexError) as error:
        words = str(error)
        if "unhashable" in words:  # it keeps its answers, so Python refuses a list by itself
            return ""
        if "\n" in words or len(words) > 300:
            return f"{len(words)} letters: {words[:90]!r}"
        named = [name] if must else list(call.arguments)  # shapes may be said to fit or not to fit
        if not any(re.search(rf"(?<!\w){re.escape(one)}(?!\w)", words) for one in named):
            return f"{type(error).__name__} without its name: {words[:110]}"
        return ""
    except Exception as error:
        return f"{type(error).__name__}: {str(error)[:110]}"
    if must:
        return f"accepted, gives {' '.join(repr(answer).split())[:60]}"
    return "accepted, gives NaN" if has_nan(answer) else ""


@pytest.mark.parametrize("room", ROOMS)
def test_bad_input_is_refused_by_name(room):
    faults = []

    @settings(max_examples=2, phases=[Phase.generate], suppress_health_check=list(HealthCheck))
    @given(data=st.data())
    def tried(data):
        for call in calls(room):
            known = {p.name: p for p in parameters(call.function)}
            for name, example in call.arguments.items():
                optional = "None" in str(known[name].annotation)
                optional |= known[name].default is None or name in MAY_BE_NONE
                for must, kinds in ((True, wrong(name, example, optional)), (False, odd(example))):
                    for value in map(data.draw, kinds):
                        if words := fault(call, name, value, must):
                            shown = " ".join(repr(value).split())[:60]
                            faults.append(f"{call.name}({name}={shown}): {words}")

    tried()
    assert not faults, "\n".join(faults)


MAY_BE_NONE = {"axis", "scale"}


# --- what no argument shows by itself: one of each kind, by hand --------------------------------


def kinds() -> dict:
    """Calls by the words that they are refused with."""
    m, pid = made(), made()["pid"]
    runs, still = m["runs"], np.tile(Q, (20, 1))
    law = dict(arm=ARM, controller=pid, reference=REFERENCE, t=T)
    three = dict(reference=Trajectory(*np.zeros((3, 3, T.size, 2))))
    late = effects.Effects(actuator=(effects.ComputingTime(0.1),))
    family = dict(arm=ARM, extents_deg=PAIR, controller=pid)
    smooth = np.stack([np.sin(2 * T), np.sin(3 * T)], -1)
    flat = learning.TrainingSet.from_arrays(learning.sliding_windows(smooth, 7), smooth[3:-3])
    silent = replace(runs, tau=runs.tau * [1.0, 0.0])
    return {
        "step must give a whole number": lambda: trajectories.time_grid(0.007),
        "a, b, d must make the mass matrix": lambda: dynamics.Arm("", 1.0, 2.0, 1.0, PAIR),
        "inertia must have no negative": lambda: replace(BODY, inertia=-np.eye(3)),
        "hand must be 0.102 to 0.900 m": lambda: dynamics.inverse_kinematics(ARM, (2.0, 0.0)),
        "arm must have its hand on the x axis": lambda: dynamics.locked(PUMA_560, 3),
        "breakaway must not be below": lambda: effects.StickSlipFriction(2 * PAIR, PAIR),
        "motor_inertia must be part of": lambda: effects.FlexibleJoint(PAIR, 99 * PAIR).links(ARM),
        "encoder must be a tuple": lambda: effects.Effects(encoder=(effects.ComputingTime(0.1),)),
        "inertia must be positive definite": lambda: control.plant([[1, 2], [2, 1]], 0.5),
        "delay must be 0 in continuous": lambda: control.closed_loop(
            control.plant(1.0, 1.0), 1.0, delay=1
        ),
        "loop must have a gain of 1": lambda: control.margins(control.loop_gain(1.0, 0.5, 0.0)),
        "loop must have one input": lambda: control.margins(control.plant(np.eye(2), PAIR)),
        "log_step must be a multiple": lambda: simulation.record(**family, log_step=0.003),
        "rest must be a multiple": lambda: simulation.record(**family, rest=0.502),
        "lower the gains": lambda: simulation.record(ARM, control.pd(1e6 * PAIR, 0 * PAIR), PAIR),
        "controller must return torques": lambda: simulation.follow(
            **law | dict(controller=lambda *_: np.ones(3))
        ),
        "finite torques, got NaN at t = -0.2": lambda: simulation.follow(
            **law | dict(controller=lambda *_: np.full(2, np.nan))
        ),
        "log_every must be an integer from 1 to": lambda: simulation.follow(**law, log_every=999),
        "start must fit to the runs": lambda: simulation.follow(
            **law | three, start=np.zeros((2, 4, 2))
        ),
        "seed must be one number or": lambda: simulation.follow(
            **law | three, seed=[0, 1], effects=setups.STATE_FEEDBACK.effects
        ),
        "effects must have a computing time": lambda: simulation.follow(**law, effects=late),
        "width must lie in [0.24, 3]": lambda: identification.by_modulation(runs, width=0.1),
        "cutoff must be above": lambda: identification.butterworth_states(runs.q, 0.01, 0.1),
        "names must be one of": lambda: identification.by_modulation(runs, ("mass",)),
        "determine some of a, b, d; they do not": lambda: identification.least_squares(
            identification.from_states(still, 0 * still, 0 * still, 1 + still)
        ),
        "pull must be given": lambda: identification.FilteredEquations(
            ("a",), 7, 0.02
        ).fit(runs[0]),
        "decay must be 0 for descent": lambda: replace(setups.STATE_FEEDBACK, decay=0.1),
        "recording must hold the six runs": lambda: setups.split(runs),
        "but joint 2 is 0 throughout": lambda: learning.TrainingSet.from_recording(silent, 7),
        "width must be at most": lambda: learning.TrainingSet.from_recording(runs, 103),
        "penalties must be above 0": lambda: analysis.ridge_filters(flat, [0.0]),
        "must not exceed half the sampling rate, 50 Hz": lambda: analysis.frequency_response(
            FILTER, 60.0, 0.01
        ),
    }  # fmt: skip


def test_what_does_not_fit_together_is_said_in_one_line():
    for words, call in kinds().items():
        with pytest.raises((ValueError, TypeError), match=re.escape(words)) as caught:
            call()
        assert "\n" not in str(caught.value) and len(str(caught.value)) <= 300
