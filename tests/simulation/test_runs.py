"""Many runs at once, the loop against python-control's, torque beyond the rigid body's."""

import control
import numpy as np
import pytest

from ddlib.control import pd
from ddlib.dynamics import CMU_DD_ARM_II, REYES_KELLY_ARM
from ddlib.effects import (
    Backlash,
    ComputingTime,
    CoulombFriction,
    DeadZone,
    Delay,
    Effects,
    FlexibleJoint,
    Ripple,
    Saturation,
    StickSlipFriction,
    ViscousFriction,
)
from ddlib.setups import KD, KP
from ddlib.simulation import CONTROL_STEP, follow, record, residual_torque
from ddlib.trajectories import APPENDIX_I, pick_and_place, time_grid

ARM = CMU_DD_ARM_II
PD = pd((200.0, 80.0), (30.0, 12.0))
FRICTION = (ViscousFriction((0.5, 0.15)), CoulombFriction((0.5, 0.15)))
LEVEL = np.array([0.5, 0.15])


def short(seconds=0.4, step=0.002, extents=(45.0, 20.0), rest=0.1):
    """A reference cut short, for quick runs: `t` and the reference."""
    t = time_grid(step, rest)[: round(seconds / step)]
    return t, pick_and_place(extents, t)


def shaft(s):
    return FlexibleJoint(3e3 * (1 + 9 * s) * [1.0, 0.3], (0.4, 0.15), gap=s * LEVEL / 100)


KINDS = {
    "stick-slip": lambda s: Effects((StickSlipFriction(s * LEVEL, 1.3 * s * LEVEL),)),
    "amplifier": lambda s: Effects(
        actuator=(DeadZone(s * LEVEL), Saturation(20.0 / (1 + s) * [5.0, 1.0]), Delay(1))
    ),
    "backlash": lambda s: Effects(encoder=(Backlash(0.002 * s * [1.0, 2.0]), Delay(2))),
    "ripple": lambda s: Effects(motor=(Ripple(s * LEVEL, share=(0.02, 0.02)),)),
    "shaft": lambda s: Effects(FRICTION, transmission=(shaft(s),)),
}


@pytest.mark.parametrize("kind", KINDS)
def test_runs_may_differ_in_any_strength(kind):
    """From nothing to four times the usual; runs need different numbers of steps."""
    scale = np.array([[0.0, 0.0], [1.0, 1.0], [4.0, 4.0]])
    t, reference = short()
    together = follow(ARM, PD, reference, t, effects=KINDS[kind](scale))
    assert together.q.shape == (3, 40, 2)
    for i in range(3):
        alone = follow(ARM, PD, reference, t, effects=KINDS[kind](scale[i]))
        for name in ("q", "tau", "q_true", "qd_true", "tau_true"):
            got, expected = getattr(together, name)[i], getattr(alone, name)
            np.testing.assert_allclose(got, expected, rtol=0, atol=1e-12, err_msg=name)
    assert not np.allclose(together.q_true[1], together.q_true[2], atol=1e-6)


def test_computing_time_lies_between_no_delay_and_a_whole_period():
    t, reference = short()

    def end(*actuator):
        return follow(ARM, PD, reference, t, effects=Effects(actuator=actuator)).q_true[-1]

    none, whole = end(), end(Delay(1))
    np.testing.assert_allclose(end(ComputingTime(1e-10)), none, atol=1e-9)
    np.testing.assert_allclose(end(ComputingTime(0.002 - 1e-10)), whole, atol=1e-9)
    half = (end(ComputingTime(0.001)) - none) / (whole - none)
    assert ((half > 0.4) & (half < 0.6)).all()


RUNS = [
    (CMU_DD_ARM_II, (45.0, 20.0), (200.0, 80.0), (30.0, 12.0), (0.5, 0.15)),
    (REYES_KELLY_ARM, (30.0, 30.0), (150.0, 50.0), (20.0, 5.0), (2.3, 0.2)),
]


@pytest.mark.parametrize("arm, extents, kp, kd, viscous", RUNS)
def test_continuous_loop_against_python_control(arm, extents, kp, kd, viscous):
    """Interconnected nonlinear systems in continuous time: the limit of ever faster sampling.

    The held torque is half a period late, an error of first order in the period; two
    periods together cancel it. Agreement to 5e-7 rad where the motion covers 0.15 rad.
    """
    seconds, grid = 0.3, np.linspace(0, 0.3, 16)

    def law(t, x, u, params):
        r = pick_and_place(extents, np.array([t]))
        return np.array(kp) * (r.q[0] - u[:2]) + np.array(kd) * (r.qd[0] - u[2:])

    def rate(t, x, u, params):  # through the arm's matrices: not the code that `follow` runs
        q, qd = x[:2], x[2:]
        net = u - arm.coriolis_matrix(q, qd) @ qd - arm.gravity(q) - np.array(viscous) * qd
        return np.concatenate([qd, np.linalg.solve(arm.mass_matrix(q), net)])

    names, torques = [f"y{k}" for k in range(4)], ["u0", "u1"]
    plant = control.nlsys(rate, None, inputs=torques, states=4, outputs=names, name="arm")
    feedback = control.nlsys(None, law, inputs=names, outputs=torques, name="PD")
    loop = control.interconnect([plant, feedback], outputs=names, inputs=None)
    answer = control.input_output_response(
        loop, grid, 0, np.zeros(4), solve_ivp_method="DOP853",
        solve_ivp_kwargs={"rtol": 1e-11, "atol": 1e-13},
    )  # fmt: skip
    ends = []
    for step in (0.001, 0.0005):
        t = np.arange(round(seconds / step) + 1) * step
        own = follow(
            arm, pd(kp, kd), pick_and_place(extents, t), t,
            effects=Effects((ViscousFriction(viscous),)), log_every=round(0.02 / step),
        )  # fmt: skip
        ends.append(own.q_true)
    truth = answer.outputs[:2].T
    assert np.abs(truth).max() > 0.15
    assert np.abs(ends[1] - truth).max() < 0.6 * np.abs(ends[0] - truth).max() < 1e-3
    np.testing.assert_allclose(2 * ends[1] - ends[0], truth, rtol=0, atol=5e-7)


def drive(arm=ARM, log_step=CONTROL_STEP, **parts):
    return record(arm, pd(KP, KD), APPENDIX_I[5], effects=Effects(**parts), log_step=log_step)


@pytest.mark.parametrize("late, within", [((), 2e-6), ((ComputingTime(0.0006),), 1e-3)])
def test_friction_is_what_is_left(late, within):
    for friction in (ViscousFriction((0.5, 0.15)), CoulombFriction((0.5, 0.15))):
        run = drive(friction=(friction,), actuator=late)
        middle = (run.qd_true[1:] + run.qd_true[:-1]) / 2
        steady = np.abs(middle).min(-1) > 0.02
        left = residual_torque(ARM, run)
        np.testing.assert_allclose(left[steady], friction.torque(middle)[steady], 0, within)


@pytest.mark.parametrize("period", [0.001, 0.004])
def test_any_control_period_will_do(period):
    options = dict(control_step=period, duration=2.0, rest=0.4)
    made = record(ARM, pd(KP, KD), APPENDIX_I[5], log_step=period, **options)
    assert np.abs(residual_torque(ARM, made)).max() < 2e-6 * (period / CONTROL_STEP) ** 2 * 10
