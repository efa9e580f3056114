"""Many runs at once: each as if it ran alone; the loop against python-control's simulation."""

import control
import numpy as np
import pytest

from ddlib.control import pd
from ddlib.dynamics import CMU_DD_ARM_II, IMI_ARM, REYES_KELLY_ARM
from ddlib.effects import (
    Backlash,
    ComputingTime,
    CoulombFriction,
    DeadZone,
    Delay,
    Effects,
    FlexibleJoint,
    Noise,
    Ripple,
    Saturation,
    StickSlipFriction,
    StribeckFriction,
    ViscousFriction,
)
from ddlib.simulation import follow, record
from ddlib.trajectories import pick_and_place, random_extents, time_grid

ARM = CMU_DD_ARM_II
PD = pd((200.0, 80.0), (30.0, 12.0))
FRICTION = (ViscousFriction((0.5, 0.15)), CoulombFriction((0.5, 0.15)))
LEVEL = np.array([0.5, 0.15])
ARRAYS = ("q", "tau", "q_true", "qd_true", "tau_true")


def short(seconds=0.4, step=0.002, extents=(45.0, 20.0), rest=0.1):
    """A reference cut short, for quick runs: `t` and the reference."""
    t = time_grid(step, rest)[: round(seconds / step)]
    return t, pick_and_place(extents, t)


def assert_same(together, k, alone, tolerance):
    for name in ARRAYS:
        got, expected = getattr(together, name)[k], getattr(alone, name)
        np.testing.assert_allclose(got, expected, rtol=0, atol=tolerance, err_msg=name)


def shaft(s):
    return FlexibleJoint(3e3 * (1 + 9 * s) * [1.0, 0.3], (0.4, 0.15), gap=s * LEVEL / 100)


KINDS = {
    "stick-slip": lambda s: Effects((StickSlipFriction(s * LEVEL, 1.3 * s * LEVEL),)),
    "Stribeck": lambda s: Effects((StribeckFriction(s * LEVEL, 1.3 * s * LEVEL),)),
    "amplifier": lambda s: Effects(
        actuator=(DeadZone(s * LEVEL), Saturation(20.0 / (1 + s) * [5.0, 1.0]), Delay(1))
    ),
    "computing time": lambda s: Effects(
        (ViscousFriction(s * LEVEL),), actuator=(ComputingTime(0.0012),)
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
        assert_same(together, i, alone, 1e-12)
    assert not np.allclose(together.q_true[1], together.q_true[2], atol=1e-6)


def test_a_run_does_not_depend_on_its_company():
    """Steep friction in one run needs many steps a period; the others keep their one."""
    steep = np.array([[0.0, 0.0], [0.5, 0.15], [8.45, 2.35]])
    options = dict(rest=0.0, log_step=0.1)

    def run(level, extents):
        effects = Effects((CoulombFriction(level),))
        return record(IMI_ARM, PD, extents, effects=effects, **options)

    extents = random_extents(3, seed=1)
    together = run(steep, extents)
    for i in range(3):
        assert_same(together, i, run(tuple(steep[i]), extents[i]), 1e-12)


# --- seeds ------------------------------------------------------------------------------

NOISY = (Noise((1e-4, 2e-4)),), (Noise((0.4, 0.1)),)


def test_everything_at_once_in_arrays():
    """Extents, gains, friction levels and seeds, one of each for every run."""
    n = 5
    extents, seeds = random_extents(n, seed=0), np.array([7, 0, 7, 123, 2**31])
    kp = np.linspace(100, 300, n)[:, None] * [1.0, 0.3]
    level = np.linspace(0, 2, n)[:, None] * LEVEL

    def run(extents, kp, level, seed):
        friction = ViscousFriction(level), CoulombFriction(level)
        effects = Effects(friction, encoder=NOISY[0], torque_sensor=NOISY[1])
        return record(
            ARM, pd(kp, 0.1 * kp), extents, effects=effects, seed=seed, velocity="difference"
        )

    together = run(extents, kp, level, seeds)
    assert together.q.shape == (n, 400, 2)
    for i in range(n):
        assert_same(together, i, run(extents[i], kp[i], level[i], int(seeds[i])), 1e-10)


def test_noise_is_what_numpy_draws():
    """One number: one generator for the whole batch. Several: one for each run."""
    t, reference = short(extents=[(45.0, 20.0)] * 3)
    effects = Effects(torque_sensor=(Noise((1.0, 1.0)),))
    shared = follow(ARM, PD, reference, t, effects=effects, seed=11)
    drawn = np.random.default_rng(11).standard_normal((40, 3, 2)).swapaxes(0, 1)
    np.testing.assert_allclose(shared.tau - shared.tau_true, drawn, atol=1e-12)
    own = follow(ARM, PD, reference, t, effects=effects, seed=[11, 12, 13])
    drawn = [np.random.default_rng(s).standard_normal((40, 2)) for s in (11, 12, 13)]
    np.testing.assert_allclose(own.tau - own.tau_true, drawn, atol=1e-12)


# --- delays in the loop -----------------------------------------------------------------


def test_a_late_encoder_reads_the_past():
    t, reference = short()
    late = follow(ARM, PD, reference, t, effects=Effects(encoder=(Delay(3),)), log_every=1)
    np.testing.assert_array_equal(late.q[3:], late.q_true[:-3])
    assert not late.q[:3].any()


def test_computing_time_lies_between_no_delay_and_a_whole_period():
    t, reference = short()

    def end(*actuator):
        return follow(ARM, PD, reference, t, effects=Effects(actuator=actuator)).q_true[-1]

    none, whole = end(), end(Delay(1))
    np.testing.assert_allclose(end(ComputingTime(1e-10)), none, atol=1e-9)
    np.testing.assert_allclose(end(ComputingTime(0.002 - 1e-10)), whole, atol=1e-9)
    half = (end(ComputingTime(0.001)) - none) / (whole - none)
    assert ((half > 0.4) & (half < 0.6)).all()


# --- python-control -----------------------------------------------------------------------

RUNS = [
    (CMU_DD_ARM_II, (45.0, 20.0), (200.0, 80.0), (30.0, 12.0), (0.5, 0.15)),
    (REYES_KELLY_ARM, (30.0, 30.0), (150.0, 50.0), (20.0, 5.0), (2.3, 0.2)),
]


def plant_for_control(arm, viscous):
    """The arm for python-control, through its matrices: not the code that `follow` runs."""

    def update(t, x, u, params):
        q, qd = x[:2], x[2:]
        net = u - arm.coriolis_matrix(q, qd) @ qd - arm.gravity(q) - np.array(viscous) * qd
        return np.concatenate([qd, np.linalg.solve(arm.mass_matrix(q), net)])

    return control.nlsys(update, None, inputs=["u0", "u1"], states=4, outputs=4, name="arm")


@pytest.mark.parametrize("arm, extents, kp, kd, viscous", RUNS)
def test_sampled_loop_against_python_control(arm, extents, kp, kd, viscous):
    """The same loop, period by period: read, compute, hold. Agreement to 1e-9 rad."""
    t, reference = short(0.16, rest=0.0, extents=extents)
    own = follow(
        arm, pd(kp, kd), reference, t, effects=Effects((ViscousFriction(viscous),)), log_every=1
    )
    plant, x = plant_for_control(arm, viscous), np.zeros(4)
    for k in range(t.size):
        np.testing.assert_allclose(own.q_true[k], x[:2], rtol=0, atol=1e-9)
        np.testing.assert_allclose(own.qd_true[k], x[2:], rtol=0, atol=1e-8)
        tau = np.array(kp) * (reference.q[k] - x[:2]) + np.array(kd) * (reference.qd[k] - x[2:])
        np.testing.assert_allclose(own.tau_true[k], tau, rtol=0, atol=1e-6)
        x = control.input_output_response(
            plant, [0, 0.002], np.outer(tau, [1, 1]), x,
            solve_ivp_method="DOP853", solve_ivp_kwargs={"rtol": 1e-11, "atol": 1e-13},
        ).states[:, -1]  # fmt: skip
    assert np.abs(own.q_true[-1]).max() > 0.01


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

    names = [f"y{k}" for k in range(4)]
    plant = control.nlsys(
        plant_for_control(arm, viscous).updfcn, None,
        inputs=["u0", "u1"], states=4, outputs=names, name="arm",
    )  # fmt: skip
    feedback = control.nlsys(None, law, inputs=names, outputs=["u0", "u1"], name="PD")
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
