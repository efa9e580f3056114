"""Control loops around the arm: predicted, interconnected, measured."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import control
import numpy as np

from ddlib._check import (
    function_of,
    instance,
    integer,
    non_negative,
    number,
    shaped,
    triple,
)
from ddlib.control import PID, closed_loop, plant
from ddlib.dynamics import Arm
from ddlib.effects import IDEAL, Effects, Load, ViscousFriction
from ddlib.simulation.recording import Recording
from ddlib.simulation.simulate import CONTROL_STEP, follow
from ddlib.trajectories import Trajectory


class LoopResponse(NamedTuple):
    """How a position loop answers its reference and a load."""

    overshoot: float  #: Of a step of the reference, as a share of the step.
    bandwidth: float  #: Frequency from which a sine comes out below 1/sqrt(2) of its size, rad/s.
    compliance: float  #: Angle by which 1 N m displaces the joint for good, rad/(N m).


def predicted_response(
    arm: Arm, controller: PID, *, viscous, posture=(0.0, 0.0), joint=0, period=CONTROL_STEP,
    seconds=12.0,
) -> LoopResponse:  # fmt: skip
    """Linear analysis of the sampled loop around a posture (rad), `viscous` friction in N m s/rad.

    Gravity's torque in the posture is compensated; what it adds beside it is part of the loop.
    """
    instance("arm", arm, Arm)
    instance("controller", controller, PID)
    number("period", period, 1e-6, 10.0)
    number("seconds", seconds, 2 * period, 1e6 * period)
    posture = shaped("posture", posture, (2,))
    integer("joint", joint, 0, 1)
    joints = plant(arm.mass_matrix(posture), viscous, _gravity_stiffness(arm, posture))
    loop = closed_loop(joints, controller.kp, controller.ki, controller.kd, period)
    t = np.arange(round(seconds / period)) * period
    inputs = np.zeros((4, t.size))
    inputs[joint] = 1.0
    step = control.forced_response(loop, t, inputs).outputs[joint]
    omega = np.geomspace(0.5, 0.1 * np.pi / period, 4000)
    answer = np.abs(loop(np.exp(1j * omega * period))[joint, joint])
    overshoot, compliance = float(step.max() - 1), loop.dcgain()[joint, 2 + joint]
    return LoopResponse(overshoot, _half_power(omega, answer), compliance)


def simulated_response(
    arm: Arm, controller: PID, *, viscous, posture=(0.0, 0.0), joint=0, period=CONTROL_STEP,
    seconds=12.0, step_deg=1.0, effects: Effects = IDEAL,
) -> LoopResponse:  # fmt: skip
    """The same measures from the full, non-linear simulation, held against gravity in the posture.

    One run steps the reference by `step_deg`, a second one carries a load that would displace a
    spring of stiffness ``kp`` by as much. A loop that rings on has a bandwidth of NaN.
    """
    instance("arm", arm, Arm)
    instance("controller", controller, PID)
    number("period", period, 1e-6, 10.0)
    number("seconds", seconds, 10 * period, 1e6 * period)
    posture = shaped("posture", posture, (2,))
    shaped("viscous", non_negative("viscous", viscous), "(2,)")
    instance("effects", effects, Effects)
    integer("joint", joint, 0, 1)
    number("step_deg", step_deg, 0.0, open_low=True)
    size = np.deg2rad(step_deg)
    t = np.arange(round(seconds / period)) * period
    target = np.zeros((2, t.size, 2)) + posture
    target[0, 1:, joint] += size
    holding, push = arm.gravity(posture), size * controller.kp[joint]
    load = np.zeros((2, 2)) + holding
    load[1, joint] += push
    effects = replace(
        effects,
        friction=(ViscousFriction(viscous), *effects.friction),
        actuator=(*effects.actuator, Load(load)),
    )
    still = np.zeros_like(target)
    recording = follow(
        arm, controller, Trajectory(target, still, still), t, effects=effects, log_every=1
    )
    deviation = recording.q_true[..., joint] - posture[joint]
    step = deviation[0, 1:] / size
    averaging = np.hanning(t.size // 2)  # a window that averages what still swings
    compliance = (deviation[1, -averaging.size :] * averaging).sum() / averaging.sum() / push
    overshoot = float(step.max() - 1)
    if np.ptp(step[-t.size // 10 :]) > 0.01:
        return LoopResponse(overshoot, np.nan, compliance)
    # the Fourier transform of the step response's rate is the frequency response
    omega = np.geomspace(0.5, 0.1 * np.pi / period, 400)
    answer = np.abs(np.exp(-1j * np.outer(omega, t[1:])) @ np.diff(step, prepend=0.0))
    return LoopResponse(overshoot, _half_power(omega, answer), compliance)


def _gravity_stiffness(arm: Arm, posture) -> np.ndarray:
    """Derivative of an arm's gravity torque by its angles, N m/rad, shape (2, 2)."""
    g1, g2 = arm.gravity_moments * np.cos([posture[0], posture.sum()])
    return np.array([[g1 + g2, g2], [g2, g2]])


def _half_power(omega, answer) -> float:
    """Highest frequency at which the answer is still 1/sqrt(2), between samples."""
    level = np.log(answer * np.sqrt(2))
    above = np.flatnonzero(level > 0)
    if not above.size or above[-1] == omega.size - 1:
        return np.nan
    k = above[-1]
    share = level[k] / (level[k] - level[k + 1])
    return float(omega[k] * (omega[k + 1] / omega[k]) ** share)


def feedforward_system(arm: Arm, model, kp, kd, viscous=(0.0, 0.0)) -> control.InterconnectedSystem:
    """Figure 2-1 of the paper as an interconnected python-control system, in continuous time.

    Inputs are ``reference[0..5]``: positions, velocities, accelerations (shoulder, elbow); outputs
    ``motion[0..3]``: positions and velocities, then ``tau[0..1]``.

    Parameters
    ----------
    model : Arm or callable
        ``model(q, qd, qdd) -> tau``, the box "inverse arm".
    kp, kd, viscous : array_like, shape (2,)
        Feedback gains, N m/rad and N m s/rad, and the arm's viscous friction, N m s/rad.
    """
    instance("arm", arm, Arm)
    inverse = model.inverse_dynamics if isinstance(model, Arm) else model
    function_of("model", inverse, "model(q, qd, qdd) -> tau, or an Arm")
    kp, kd, viscous = (
        non_negative(name, shaped(name, value, (2,)))
        for name, value in (("kp", kp), ("kd", kd), ("viscous", viscous))
    )

    def torque(t, x, u, params):
        return np.asarray(inverse(u[:2], u[2:4], u[4:]), dtype=float)

    def motion(t, x, u, params):
        return np.concatenate([x[2:], arm.forward_dynamics(x[:2], x[2:], u - viscous * x[2:])])

    def named(name, count):
        return [f"{name}[{k}]" for k in range(count)]

    blocks = [
        control.nlsys(None, torque, name="inverse_arm", inputs=named("reference", 6),
                      outputs=named("feedforward", 2)),
        control.summing_junction(["reference", "-motion"], "error", dimension=4, name="comparison"),
        control.ss([], [], [], np.hstack([np.diag(kp), np.diag(kd)]), name="feedback",
                   inputs=named("error", 4), outputs=named("correction", 2)),
        control.summing_junction(["feedforward", "correction"], "tau", dimension=2, name="sum"),
        control.nlsys(motion, None, name="arm", states=4, inputs=named("tau", 2),
                      outputs=named("motion", 4)),
    ]  # fmt: skip
    return control.interconnect(
        blocks,
        inputs=named("reference", 6),
        outputs=[*named("motion", 4), *named("tau", 2)],
        name="figure_2_1",
    )


def run_system(
    system: control.InterconnectedSystem, reference: Trajectory, t, start=None
) -> Recording:
    """Simulate a `feedforward_system` along a reference at `t` (s), with perfect sensors.

    `start` are angles (rad) and velocities (rad/s); default: at rest at the first position.
    """
    instance("system", system, control.InterconnectedSystem)
    reference = Trajectory(*triple("reference", reference))
    t = shaped("t", t, "(time,)")
    shaped("reference.q", reference.q, (t.size, 2))
    start = np.stack([reference.q[0], [0.0, 0.0]]) if start is None else start
    start = shaped("start", start, (2, 2)).ravel()
    answer = control.input_output_response(
        system, t, np.concatenate(reference, axis=1).T, start, solve_ivp_kwargs={"rtol": 1e-6}
    )
    q, qd, tau = np.split(answer.outputs.T, 3, axis=1)
    return Recording(t, reference, q, tau, q, qd, tau, control_step=0.0)
