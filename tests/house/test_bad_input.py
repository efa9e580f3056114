"""Bad input: every argument of a public call, replaced by what it cannot be, is refused by name.

A new function joins by a line in `_calls`: a call that works, with its arguments by name. What an
argument cannot be follows from the kind of its value there (`_wrong`).
"""

import importlib
import inspect
import re
import warnings
from collections.abc import Mapping
from functools import cache

import numpy as np
import pytest

from ddlib import (
    analysis,
    control as joint_control,
    dynamics,
    effects,
    figures,
    learning,
    metrics,
    setups,
    simulation,
    trajectories,
)
from ddlib.dynamics import CMU_DD_ARM_II as ARM, PUMA_560, Link
from ddlib.trajectories import Trajectory

KP = (300.0, 90.0)
T = trajectories.time_grid(0.02, 0.2)
REFERENCE = trajectories.pick_and_place([30.0, 20.0], T)
STATE = np.array([[0.1, 0.2], [0.3, -0.4], [1.0, 2.0]])
LINK = Link(14.0, 0.5, 0.22, 0.4)
PLANT = joint_control.plant(1.0, 0.5)
PID = joint_control.PID(KP, kd=(60.0, 20.0))
FILTER = np.array([1.0, -2.0, 3.0, 0.5, -1.0])
BODY = dynamics.SpatialLink(0.0, 0.5, 0.0, 1.0, (0.0, 0.0, 0.0), np.eye(3))


@cache
def recording():
    return simulation.record(ARM, PID, [[45.0, 45.0], [38.0, 32.0], [5.0, 39.0]], log_step=0.02)


@cache
def one():
    return recording()[0]


@cache
def data():
    return learning.TrainingSet.from_recording(recording(), 7)


@cache
def windows():
    return learning.cases(recording(), 7)


@cache
def weights():
    return learning.Weights.random(2, 7, hidden=3)


@cache
def model():
    return learning.TorqueModel(weights(), data().inputs, data().outputs, 0.02)


@cache
def states():
    q, qd, tau = (
        x[:, recording().motion] for x in (one().q_true[None], one().qd_true[None], one().tau[None])
    )
    return np.stack([q, qd, ARM.forward_dynamics(q, qd, tau)], -1)[0]


# These are looked at when they are used, not when they are made


def _zero(angle):
    return effects.EncoderZero(angle).apply(STATE[0])


def _fed_forward(model, controller):
    return joint_control.Feedforward(model, controller).start(REFERENCE, 0.02)


def _explained(target, by):
    return analysis.explained(target, by)


def _torques(weights, inputs, outputs):
    return learning.TorqueModel(weights, inputs, outputs).torque(windows()[0])


def per_joint(*value):
    return np.array(value)


@cache
def _calls():
    """Public calls that work: function, then arguments by name."""
    run, runs, set_, net, nets = one(), recording(), data(), weights()[0], weights()
    x, torque = windows()
    few, single = windows()[0][: len(states())], model()[0]
    activity = nets[0].activity(set_.x)[0]
    pair = per_joint(0.4, 0.2)
    return [
        # trajectories
        (trajectories.pick_and_place, dict(extents_deg=pair, t=T, duration=3.0)),
        (trajectories.random_extents, dict(n=3, seed=1, max_deg=45.0)),
        (trajectories.time_grid, dict(step=0.02, rest=0.2, duration=3.0)),
        # dynamics
        (Link, dict(mass=14.0, length=0.5, com=0.22, inertia=0.4)),
        (dynamics.Arm, dict(name="arm", a=3.0, b=0.2, d=0.2, lengths=pair, gravity_moments=pair)),
        (dynamics.Arm.from_links, dict(name="arm", link1=LINK, link2=LINK, gravity=9.81)),
        (ARM.mass_matrix, dict(q=STATE[0])),
        (ARM.coriolis_matrix, dict(q=STATE[0], qd=STATE[1])),
        (ARM.gravity, dict(q=STATE[0])),
        (ARM.inverse_dynamics, dict(q=STATE[0], qd=STATE[1], qdd=STATE[2])),
        (ARM.torque_terms, dict(q=STATE[0], qd=STATE[1], qdd=STATE[2])),
        (ARM.forward_dynamics, dict(q=STATE[0], qd=STATE[1], tau=STATE[2])),
        (ARM.kinetic_energy, dict(q=STATE[0], qd=STATE[1])),
        (ARM.potential_energy, dict(q=STATE[0])),
        (ARM.regressor, dict(q=STATE[0], qd=STATE[1], qdd=STATE[2])),
        (ARM.forward_kinematics, dict(q=STATE[0])),
        (dynamics.with_load, dict(arm=ARM, mass=2.0)),
        (dynamics.count_operations, dict(
            formulation=dynamics.newton_euler, arm=PUMA_560.first(2), knowledge="arm"
        )),
        (dynamics.derive, dict(links=2, gravity=True)),
        (dynamics.derive(2).base_values, dict(links=[LINK, LINK], gravity=9.81)),
        (dynamics.operations_table, dict(joints=[1, 2], link=LINK)),
        (dynamics.locked, dict(arm=dynamics.DD_ARM_II_IN_SPACE, joints=2)),
        (dynamics.mass_matrix, dict(arm=PUMA_560, q=np.zeros(6))),
        (dynamics.regressor, dict(arm=PUMA_560, q=np.zeros(6), qd=np.zeros(6), qdd=np.ones(6))),
        (dynamics.end_point_error, dict(arm=ARM, wanted=STATE[0], q=STATE[1])),
        (dynamics.follow_hand, dict(
            arm=ARM, hand=np.full((4, 2), 0.5), velocity=np.ones((4, 2)),
            acceleration=np.ones((4, 2)), elbow="positive",
        )),
        (dynamics.inverse_kinematics, dict(arm=ARM, hand=per_joint(0.5, 0.5), elbow="positive")),
        (dynamics.jacobian, dict(arm=ARM, q=STATE[0])),
        (dynamics.reach, dict(arm=ARM)),
        (dynamics.SpatialLink, dict(
            twist_deg=90.0, length=0.4, offset=0.1, mass=2.0, com=np.zeros(3), inertia=np.eye(3)
        )),
        (dynamics.SerialArm, dict(links=[BODY, BODY], gravity=np.zeros(3))),
        (dynamics.SerialArm.planar, dict(links=[LINK, LINK], gravity=9.81)),
        (PUMA_560.first, dict(joints=2)),
        (PUMA_560.inverse_dynamics, dict(
            q=np.zeros(6), qd=np.zeros(6), qdd=np.ones(6), formulation=dynamics.newton_euler
        )),
        # effects
        (effects.ComputingTime, dict(seconds=1e-3)),
        (effects.DeadZone, dict(width=pair)),
        (effects.DeadZone(pair).inverse, dict(y=pair)),
        (effects.FlexibleJoint, dict(stiffness=pair, motor_inertia=pair, damping=pair, gap=pair)),
        (effects.FlexibleJoint(pair, pair / 10).mass_matrix, dict(arm=ARM, q=STATE[0])),
        (effects.FlexibleJoint(pair, pair / 10).mode_frequencies, dict(arm=ARM, q=STATE[0])),
        (effects.FlexibleJoint(pair, pair / 10).links, dict(arm=ARM)),
        (effects.Ripple, dict(cogging=pair, share=pair, cycles=per_joint(60, 60), phase=0.1)),
        (effects.Saturation, dict(limit=pair)),
        (effects.Saturation(pair).inverse, dict(y=pair)),
        (effects.CoulombFriction, dict(level=pair, smoothing=1e-3)),
        (effects.StickSlipFriction, dict(level=pair, breakaway=2 * pair, speed=0.02)),
        (effects.StribeckFriction, dict(
            level=pair, breakaway=2 * pair, speed=0.02, smoothing=1e-3
        )),
        (effects.ViscousFriction, dict(coefficient=pair)),
        (effects.Backlash, dict(gap=pair)),
        (effects.Delay, dict(periods=2)),
        (_zero, dict(angle=pair)),
        (effects.Noise, dict(std=pair)),
        (effects.Quantisation, dict(step=0.1)),
        (effects.Quantisation.encoder, dict(bits=16)),
        (effects.Effects, dict(friction=(effects.ViscousFriction(pair),), encoder=(), motor=())),
        # control
        (joint_control.PID, dict(kp=pair, ki=pair, kd=pair, integral_limit=10.0)),
        (joint_control.ComputedTorque, dict(arm=ARM, kp=pair, kd=pair)),
        (_fed_forward, dict(model=ARM, controller=PID)),
        (joint_control.as_controller, dict(controller=PID)),
        (joint_control.pd, dict(kp=pair, kd=pair)),
        (joint_control.proportional, dict(kp=pair)),
        (joint_control.plant, dict(inertia=np.eye(2), viscous=pair, stiffness=np.eye(2))),
        (joint_control.loop_gain, dict(inertia=1.0, viscous=0.5, kp=40.0, ki=1.0, kd=1.0)),
        (joint_control.closed_loop, dict(
            joints=PLANT, kp=4.0, ki=0.1, kd=1.0, period=0.01, delay=1
        )),
        (joint_control.opened_loop, dict(
            joints=PLANT, kp=4.0, ki=0.1, kd=1.0, period=0.01, delay=1, joint=0
        )),
        (joint_control.late_poles, dict(
            joints=PLANT, gain=np.ones((1, 2)), period=0.01, late=0.003
        )),
        (joint_control.margins, dict(loop=joint_control.loop_gain(1.0, 0.5, 40.0))),
        (joint_control.proportional_limit, dict(inertia=1.0, viscous=0.5, period=0.01)),
        (joint_control.difference, dict(periods=2, step=0.01)),
        (joint_control.end_slope, dict(width=5, degree=2, step=0.01)),
        (joint_control.noise_gain, dict(weights=FILTER)),
        (joint_control.stacked, dict(filters=[FILTER, FILTER])),
        (joint_control.EstimatedVelocity, dict(feedback=PID, weights=FILTER)),
        # simulation
        (simulation.record, dict(
            arm=ARM, controller=PID, extents_deg=pair, rest=0.2, control_step=0.01, log_step=0.02,
            duration=1.0, effects=effects.IDEAL, seed=1, velocity="tachometer", start=STATE[:2],
        )),
        (simulation.follow, dict(
            arm=ARM, controller=PID, reference=REFERENCE, t=T, effects=effects.IDEAL, seed=1,
            log_every=2, velocity="tachometer", start=STATE[:2], duration=3.0,
        )),
        (simulation.rms, dict(x=STATE, axis=0)),
        (simulation.residual_torque, dict(arm=ARM, recording=simulation.record(
            ARM, PID, pair, rest=0.2, control_step=0.02, log_step=0.02
        ))),
        (effects.Load, dict(torque=pair)),
        (dynamics.SecondOrderModel, dict(arm=ARM, posture=pair, viscous=pair)),
        (simulation.feedforward_system, dict(arm=ARM, model=ARM, kp=pair, kd=pair, viscous=pair)),
        (simulation.predicted_response, dict(
            arm=ARM, controller=PID, viscous=pair, posture=pair, joint=0, period=0.01, seconds=1.0
        )),
        (simulation.simulated_response, dict(
            arm=ARM, controller=PID, viscous=pair, posture=pair, joint=0, period=0.01, seconds=4.0,
            step_deg=1.0, effects=effects.IDEAL,
        )),
        (trajectories.smooth_pick_and_place, dict(extents_deg=pair, t=T, speed=1.0)),
        (simulation.run_system, dict(
            system=simulation.feedforward_system(ARM, ARM, KP, (60.0, 20.0)),
            reference=Trajectory(*(x[:20] for x in REFERENCE)), t=T[:20], start=STATE[:2],
        )),
        (simulation.score, dict(arm=ARM, recording=run, seconds=3.0)),
        # learning, without training
        (learning.sliding_windows, dict(q=run.q, width=7, cases=slice(10, 20))),
        (learning.check_width, dict(width=7)),
        (learning.Scaler, dict(
            low=per_joint(0.0, 1.0), high=per_joint(1.0, 2.0), target=(0.0, 1.0)
        )),
        (learning.Scaler.fit, dict(data=STATE, target=(0.0, 1.0), joint_axis=-1)),
        (set_.outputs.scale, dict(data=STATE, joint_axis=-1)),
        (set_.outputs.unscale, dict(data=STATE, joint_axis=-1)),
        (learning.cases, dict(recording=runs, width=7)),
        (learning.TrainingSet.from_arrays, dict(
            windows=x, torque=torque, target=(0.2, 0.8), scaling=(0.0, 1.0)
        )),
        (learning.TrainingSet.from_recording, dict(recording=runs, width=7)),
        (set_.transform, dict(windows=x, torque=torque)),
        (learning.default_rate, dict(width=7)),
        (learning.Weights.random, dict(
            members=2, width=7, hidden=3, joints=2, outputs=2, initial=0.1, seed=0
        )),
        (net.activity, dict(x=set_.x)),
        (_torques, dict(weights=net, inputs=set_.inputs, outputs=set_.outputs)),
        (model().torque, dict(windows=x)),
        (learning.Lazy, dict(weights=net, data=set_)),
        (learning.Directions.of, dict(data=set_)),
        (learning.effective_steps, dict(rates=FILTER**2, epochs=[1, 5], momentum=0.5, warm_up=2)),
        (learning.jacobian, dict(weights=net, x=set_.x)),
        (learning.with_change, dict(weights=net, change=np.zeros(net.count(biases=True)))),
        (learning.with_ones, dict(x=set_.x)),
        (learning.p_value, dict(value=0.5, draws=FILTER, side="two")),
        (learning.related, dict(target=torque, windows=x)),
        (learning.surrogate, dict(kind="shifted", torque=runs.tau, seed=0)),
        (learning.surrogates, dict(kind="shifted", torque=runs.tau, draws=2, seed=0)),
        (metrics.rmss, dict(predicted=STATE, target=STATE + 1, scale=pair, pooled=True)),
        # training
        (learning.train, dict(
            network=learning.WindowNetwork(7, 3), x=set_.x, y=set_.y, rate=0.1, momentum=0.5,
            epochs=2, progress=False,
        )),
        (learning.train_ensemble, dict(
            weights=nets, data=set_, rate=0.1, momentum=0.5, epochs=2, warm_up=1, snapshots=[1],
            progress=False, test=(set_.x, set_.y),
        )),
        (learning.solve, dict(
            weights=net, data=set_, decay=1e-3, steps=1, tolerance=1e-3, target_rmss=0.1,
            whiten=True, progress=False, test=(set_.x, set_.y),
        )),
        (learning.WindowNetwork, dict(width=7, hidden=3, joints=2, outputs=2, initial=0.1, seed=0)),
        # setups
        (setups.Setup, dict(
            name="mine", controller=PID, arm=ARM, effects=effects.IDEAL, epochs=10, momentum=0.5,
            warm_up=1, initial=0.1, rate=33.0, scaling=(0.0, 1.0), hidden=3, seed=0, steps=2,
            decay=0.1,
        )),
        (setups.inside_hull, dict(extents_deg=pair)),
        (setups.predict, dict(model=model(), recording=run)),
        (setups.STATE_FEEDBACK.repeated, dict(seed=1)),
        (setups.true_states, dict(recording=run, setup=setups.STATE_FEEDBACK, skip=0.1)),
        # analysis
        (analysis.cells_reached, dict(samples=STATE, radius=1.0, cells=4)),
        (analysis.log10_reachable_share, dict(width=7, step=0.1)),
        (analysis.principal_deviations, dict(samples=STATE)),
        (analysis.used_dimensions, dict(samples=STATE, resolution=0.1)),
        (analysis.half_penalty, dict(data=set_, states=np.tile(states(), (3, 1, 1)), joint=0)),
        (analysis.ridge_filters, dict(data=set_, penalties=FILTER**2)),
        (analysis.basis, dict(width=7)),
        (analysis.classify, dict(f=FILTER)),
        (analysis.content, dict(f=FILTER)),
        (analysis.decompose, dict(f=FILTER, convention="paper")),
        (analysis.frequency_response, dict(f=FILTER, frequencies=per_joint(1.0, 2.0), step=0.01)),
        (analysis.purest, dict(f=analysis.basis(7)[1:3], name="velocity")),
        (analysis.roughness, dict(f=FILTER)),
        (analysis.savitzky_golay, dict(width=7, derivative=1, step=0.01, degree=2)),
        (analysis.shares, dict(f=FILTER)),
        (analysis.upright, dict(f=FILTER)),
        (_explained, dict(target=FILTER, by=FILTER**2)),
        (analysis.filter_responses, dict(f=net.hidden_weights, windows=few, states=states())),
        (analysis.gains, dict(f=FILTER, step=0.01)),
        (analysis.mean_gradient, dict(model=model(), windows=x)),
        (analysis.ablation, dict(model=single, windows=x, torque=torque)),
        (analysis.matched_units, dict(first=activity, second=activity)),
        (analysis.net_inputs, dict(model=model(), windows=x)),
        (analysis.refitted, dict(features=set_.x[:, 0], torque=torque, held_out=set_.x[:, 0],
                                 answer=torque)),
        (analysis.saturated, dict(activity=activity, margin=0.1)),
        (analysis.transition_width, dict(net_input=activity, margin=0.1)),
        (analysis.acceleration_noise_gain, dict(width=7, period=0.01)),
        (analysis.noise_floor, dict(
            arm=ARM, deviation=pair, width=7, bits=16.0, torque_noise=0.1, period=0.01
        )),
        (analysis.calibrated, dict(model=model(), windows=x, step=0.01)),
        (analysis.unit_responses, dict(outputs=activity[: len(states())], states=states())),
        (analysis.unit_inputs, dict(model=model(), windows=x)),
        (analysis.input_shares, dict(weights=net)),
        (analysis.responses, dict(model=model(), values=FILTER)),
        (analysis.shuffled, dict(predict=single.torque, states=x, scale=pair, seed=0)),
        (analysis.transition_centre, dict(model=model())),
        (analysis.transition_range, dict(weights=net, margin=0.1)),
        (analysis.linear_residual, dict(arm=ARM, q=run.q, qd=run.qd_true, qdd=run.reference.qdd)),
        (analysis.share_of_other_joint, dict(
            arm=ARM, trajectory=REFERENCE, gears=per_joint(1.0, 10.0), rotor=0.1
        )),
        (analysis.share_of_velocity_terms, dict(
            arm=ARM, trajectory=REFERENCE, speed=2.0, effects=effects.IDEAL
        )),
        # figures
        (figures.hinton, dict(weights=net, scale="row")),
        (figures.network_diagram, dict(weights=net)),
        (figures.decomposed, dict(functions=FILTER, step=0.01)),
        (figures.curves, dict(
            x=FILTER, panels={"torque, N m": {"one": FILTER}}, x_label="time, s", alt="A line.",
            columns=1, height=2.0, x_log=False, y_log=False,
        )),
        (figures.families, dict(
            panels={"": {"one": (FILTER, np.ones((5, 2)))}}, labels=LABELS,
            alt="Lines.", height=2.0, x_log=False, y_log=False,
        )),
        (figures.by_case, dict(
            x=FILTER, cases={"one": FILTER}, x_label="time, s", y_label="torque, N m",
            alt="A line.", height=2.0,
        )),
        (figures.check_label, dict(label="torque, N m")),
        (figures.illustrate, dict(
            draw=lambda figure: None, alt="Nothing.", width=7.0, height=3.0, narrow_height=2.0
        )),
        (figures.rmss_by_window, dict(
            table={"one": {"test": {7: FILTER**2}}}, printed={"test": {7: 0.1}}
        )),
    ]  # fmt: skip


LABELS = ("time, s", "torque, N m")
RAGGED, EMPTY = [1.0, [2.0, 3.0]], np.zeros(0)
NEVER = (object(), "text", 1j)
FREE = {"name", "alt", "label", "x_label", "y_label"}  # texts of which any will do
# They keep their answers, so Python refuses a list by itself
HASHED = {"count_operations", "derive"}
OPTIONAL = {
    "x",
    "start",
    "duration",
    "axis",
    "scale",
}  # what may be None where the signature hides it


def _wrong(value, optional):
    """What cannot stand in place of a value, by its kind; None may where that is a default."""
    nothing = () if optional else (None,)
    if isinstance(value, (bool, np.bool_)):
        return (*NEVER, "no", 2, RAGGED, *nothing)
    if isinstance(value, (int, np.integer)):
        return (*NEVER, "3", 1.5, np.nan, True, -(10**30), RAGGED, EMPTY, *nothing)
    if isinstance(value, float):
        return (*NEVER, "9.81", np.nan, np.inf, True, 10**400, RAGGED, EMPTY, *nothing)
    if isinstance(value, str):
        return (*NEVER[::2], "no such", 3, ["a"], np.zeros(3), {}, *nothing)
    if isinstance(value, np.ndarray):
        bad = value.astype(float)
        bad.flat[0] = np.nan
        worse = np.where(np.isnan(bad), np.inf, bad)
        kinds = (value.astype(str), value.astype(complex), value.astype(object) * 1j, value != 0)
        return (*NEVER, {}, bad, worse, *kinds, RAGGED, *nothing)
    if isinstance(value, Trajectory):
        short = Trajectory(*value[:2], value[2][..., :1])
        return (*NEVER, 3, np.zeros(3), value[:2], short, {}, *nothing)
    if value is LABELS:
        return (*NEVER, 3, {"a": 1}, [None], ["a", 1], ["a"], RAGGED, *nothing)
    if isinstance(value, (list, tuple)):
        return (*NEVER, 3, np.nan, {"a": 1}, [None], ["a", "b"], RAGGED, *nothing)
    return (*NEVER, 3, np.zeros(3), np.zeros((3, 3)), {}, [1, 2], *nothing)


def _odd(value):
    """What a call may take or refuse, but never answer with NaN or an error of another library."""
    if isinstance(value, np.ndarray):
        stripes = np.stack([value.astype(float)] * 2, -1)[..., 0]  # not contiguous
        return EMPTY, np.zeros((0, *value.shape)), np.zeros((3, 5, 2, 9)), stripes
    return ()


def _plain_parts(found):
    """The arrays in an answer."""
    if isinstance(found, Mapping):
        found = tuple(found.values())
    if isinstance(found, (tuple, list)):
        return [part for item in found for part in _plain_parts(item)]
    return [found] if isinstance(found, (float, np.ndarray)) else []


def _has_nan(found):
    """Whether there is a NaN in an answer."""
    parts = [np.asarray(part) for part in _plain_parts(found)]
    return any(np.isnan(part).any() for part in parts if part.dtype.kind in "fc")


def _said(function, arguments, name, must):
    """What is wrong with the answer to bad input; nothing if it is refused by its name."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            warnings.simplefilter("error", RuntimeWarning)
            found = function(**arguments)
    except (TypeError, ValueError, IndexError) as error:
        told = str(error)
        if "\n" in told or len(told) > 300:
            return f"{len(told)} letters: {told[:90]!r}"
        names = [name] if must else list(arguments)  # shapes may be said to fit or not to fit
        if not any(re.search(rf"(?<!\w){re.escape(one)}(?!\w)", told) for one in names):
            return f"{type(error).__name__} without its name: {told[:110]}"
        return ""
    except Exception as error:
        return f"{type(error).__name__}: {str(error)[:110]}"
    if must:
        return f"accepted, gives {' '.join(repr(found).split())[:60]}"
    return "accepted, gives NaN" if _has_nan(found) else ""


def wrong_answers(function, arguments):
    """Lines on all bad values of a call's arguments that are not refused well."""
    known, lines = inspect.signature(function).parameters, []
    for name, value in arguments.items():
        optional = name in OPTIONAL or (name in known and known[name].default is None)
        for must, values in ((True, _wrong(value, optional)), (False, _odd(value))):
            for wrong in values:
                if isinstance(wrong, str) and name in FREE:
                    continue
                if function.__name__ in HASHED and type(wrong).__hash__ is None:
                    continue
                said = _said(function, {**arguments, name: wrong}, name, must)
                if said:
                    is_array = isinstance(wrong, np.ndarray)
                    shown = f"{wrong.shape} {wrong.dtype}" if is_array else repr(wrong)[:40]
                    lines.append(f"{function.__qualname__}({name}={shown}): {said}")
    return lines


def _room(function):
    """The room of ddlib that a call belongs to."""
    inside = {_zero: "effects", _fed_forward: "control", _torques: "learning"}
    inside[_explained] = "analysis"
    return inside.get(function) or function.__module__.split(".")[1]


ROOMS = ("trajectories", "dynamics", "effects", "control", "simulation", "learning", "metrics",
         "setups", "analysis", "figures")  # fmt: skip


@pytest.mark.parametrize("room", ROOMS)
def test_bad_input_is_refused_by_name(room):
    calls = [(f, arguments) for f, arguments in _calls() if _room(f) == room]
    assert calls
    for function, arguments in calls:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            function(**arguments)  # the call as it stands works
    assert [line for call in calls for line in wrong_answers(*call)] == []


# Public calls that have no line above: others test what they refuse, or they only hold what
# another call made, or they are steps of one
APART = {
    "dynamics": "Operations Tape lagrange_euler newton_euler recursive_lagrange",
    "control": "ControlLaw Controller",
    "simulation": "Recording",
    "learning": "Descent History Solution TorqueNetwork TrainingInterrupted kernels "
    "module_gradient prepare",
    "analysis": "",
    "effects": "",
    "figures": "COLOUR_MAP Illustration checked dots_in_one legend_above plain_ticks",
}


@pytest.mark.parametrize("room", APART)
def test_every_public_call_has_a_line(room):
    calls = [f for f, _ in _calls()]
    made_by = [getattr(f, "__self__", None) for f in calls]  # the class of a class method
    names = {getattr(f, "__name__", "") for f in (*calls, *made_by)}
    names |= {"EncoderZero", "Feedforward", "TorqueModel", "explained"}  # by the functions above
    here = importlib.import_module(f"ddlib.{room}")
    public = {name for name in here.__all__ if callable(getattr(here, name))}
    errors = {name for name in public if isinstance(getattr(here, name), type)
              and issubclass(getattr(here, name), Exception)}  # fmt: skip
    assert public - errors - names <= set(APART[room].split())
