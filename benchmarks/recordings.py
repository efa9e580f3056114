"""Recordings: ours against MuJoCo's multi-threaded rollout and against python-control."""

from __future__ import annotations

import math

import control
import numpy as np
from measure import THREADS, interleaved, memory_row, not_measured, ratio
from scipy.integrate import solve_ivp

from ddlib.dynamics import Arm
from ddlib.effects import Effects
from ddlib.setups import STATE_FEEDBACK
from ddlib.simulation import CONTROL_STEP, record
from ddlib.trajectories import pick_and_place, random_extents, time_grid

RUNS = 1000
TITLE = f"{RUNS:,} recordings of three seconds"
SETUP = STATE_FEEDBACK
VISCOUS, COULOMB = SETUP.effects.friction


def ours(runs: int = RUNS, effects: Effects = SETUP.effects, **options):
    """Three seconds of each run, controlled every 2 ms, logged every 10 ms."""
    extents = random_extents(runs, seed=0)
    return record(SETUP.arm, SETUP.controller, extents, effects=effects, rest=0.0, **options)


# --- MuJoCo

INTEGRATORS = ("RK4", "implicitfast")
"""Of MuJoCo: our own method, and one of first order, which does less."""


def mjcf(arm: Arm, integrator: str, friction: bool) -> str:
    """The same arm in MuJoCo's format: any masses that give its three base parameters."""
    length, mass = arm.lengths[0], 10.0
    com = arm.b / (mass * length)
    inertia = [arm.a - arm.d - mass * length**2, arm.d - mass * com**2]
    joints = [
        f'<joint name="{name}" axis="0 0 1" damping="{viscous}" frictionloss="{coulomb}"/>'
        for name, viscous, coulomb in zip(
            ("shoulder", "elbow"),
            VISCOUS.coefficient if friction else (0, 0),
            COULOMB.level if friction else (0, 0),
        )
    ]
    links = [
        f'<inertial pos="{x} 0 0" mass="{mass}" diaginertia="{i} {i} {i}"/>'
        for x, i in zip((0, com), inertia)
    ]
    return f"""
    <mujoco>
      <option timestep="{CONTROL_STEP}" integrator="{integrator}" gravity="0 0 0">
        <flag contact="disable"/>
      </option>
      <worldbody>
        <body>{joints[0]}{links[0]}
          <body pos="{length} 0 0">{joints[1]}{links[1]}</body>
        </body>
      </worldbody>
      <actuator><motor joint="shoulder"/><motor joint="elbow"/></actuator>
    </mujoco>"""


class Rollout:
    """MuJoCo's rollout of runs under the torques of a recording, one step a control period."""

    def __init__(self, recording, integrator: str, friction: bool):
        import mujoco
        from mujoco import rollout

        full = mujoco.mjtState.mjSTATE_FULLPHYSICS
        self.model = mujoco.MjModel.from_xml_string(mjcf(SETUP.arm, integrator, friction))
        self.data = [mujoco.MjData(self.model) for _ in range(THREADS)]
        self.torque = np.ascontiguousarray(recording.tau_true)
        runs, steps, _ = self.torque.shape
        self.start = np.zeros((runs, mujoco.mj_stateSize(self.model, full)))
        self.start[:, 1:3] = recording.q_true[:, 0]  # after the time
        self.states = np.empty((runs, steps, self.start.shape[1]))
        self.pool = rollout.Rollout(nthread=THREADS)

    def __call__(self):
        self.pool.rollout(self.model, self.data, self.start, self.torque, state=self.states)
        return self.states[..., 1:3]


def distance(integrator: str) -> float:
    """Largest distance in rad between MuJoCo's motion and ours, without friction."""
    effects = SETUP.effects.without("friction")
    recording = ours(20, effects, log_step=CONTROL_STEP)
    moved = Rollout(recording, integrator, friction=False)()
    return float(np.abs(moved[:, :-1] - recording.q_true[:, 1:]).max())


def against_mujoco(repeats: int) -> list[dict]:
    """Rows for both integrators."""
    group = f"{TITLE}, against MuJoCo"
    try:
        import mujoco
    except ImportError:
        return [not_measured(group, name, "pip install .[bench]") for name in INTEGRATORS]
    apart = {name: distance(name) for name in INTEGRATORS}
    if apart["RK4"] > 1e-9:  # our own method; the other integrator is of first order
        raise RuntimeError(f"MuJoCo's arm does not move like ours: {apart['RK4']:.1e} rad apart")
    recording = ours(log_step=CONTROL_STEP)
    works = {name: Rollout(recording, name, friction=True) for name in INTEGRATORS}
    del recording
    taken = interleaved(repeats, ours=ours, **works)
    return [
        ratio(
            group,
            name,
            ("all at once, 1 thread", taken["ours"]["shortest"]),
            (f"MuJoCo rollout, {THREADS} threads", taken[name]["shortest"]),
            judged=name == "RK4",
            **{
                "largest distance without friction, rad": apart[name],
                "mujoco": mujoco.__version__,
            },
        )
        for name in INTEGRATORS
    ]


# --- python-control


class Written:
    """The loop as a user of python-control writes it, in plain floats: the fastest way there."""

    def __init__(self, arm: Arm = SETUP.arm):
        self.a, self.b, self.d = arm.a, arm.b, arm.d
        self.viscous, self.coulomb, self.small = (
            VISCOUS.coefficient,
            COULOMB.level,
            COULOMB.smoothing,
        )
        self.kp, self.kd = map(tuple, (SETUP.controller.kp, SETUP.controller.kd))
        self.encoder = SETUP.effects.encoder[0].step

    def acceleration(self, q2, v1, v2, tau1, tau2):
        """Of both joints under given torques."""
        r1 = tau1 - self.viscous[0] * v1 - self.coulomb[0] * math.tanh(v1 / self.small)
        r2 = tau2 - self.viscous[1] * v2 - self.coulomb[1] * math.tanh(v2 / self.small)
        c, h = self.b * math.cos(q2), self.b * math.sin(q2)
        r1, r2 = r1 + h * v2 * (2 * v1 + v2), r2 - h * v1 * v1
        m11, m12 = self.a + 2 * c, self.d + c
        determinant = m11 * self.d - m12 * m12
        return (self.d * r1 - m12 * r2) / determinant, (m11 * r2 - m12 * r1) / determinant

    def torque(self, u, q1, q2, v1, v2):
        """The controller's; `u` holds the reference's two positions and two velocities."""
        return (
            self.kp[0] * (u[0] - q1) + self.kd[0] * (u[2] - v1),
            self.kp[1] * (u[1] - q2) + self.kd[1] * (u[3] - v2),
        )

    def rate(self, t, x, u, params):
        """Time derivative of the loop if the controller sees the state at every instant."""
        q1, q2, v1, v2 = x.tolist()
        tau = self.torque(u.tolist(), q1, q2, v1, v2)
        return np.array([v1, v2, *self.acceleration(q2, v1, v2, *tau)])

    def step(self, t, x, u, params):
        """One control period: torque from the encoder's reading, held for one RK4 step."""
        q1, q2, v1, v2 = x.tolist()
        seen = q1, q2
        if params["quantised"]:
            seen = (round(q / self.encoder) * self.encoder for q in seen)
        tau, h = self.torque(u.tolist(), *seen, v1, v2), CONTROL_STEP
        a1, b1 = self.acceleration(q2, v1, v2, *tau)
        v12, v22 = v1 + h / 2 * a1, v2 + h / 2 * b1
        a2, b2 = self.acceleration(q2 + h / 2 * v2, v12, v22, *tau)
        v13, v23 = v1 + h / 2 * a2, v2 + h / 2 * b2
        a3, b3 = self.acceleration(q2 + h / 2 * v22, v13, v23, *tau)
        v14, v24 = v1 + h * a3, v2 + h * b3
        a4, b4 = self.acceleration(q2 + h * v23, v14, v24, *tau)
        q1 += h / 6 * (v1 + 2 * v12 + 2 * v13 + v14)
        q2 += h / 6 * (v2 + 2 * v22 + 2 * v23 + v24)
        v1 += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4)
        v2 += h / 6 * (b1 + 2 * b2 + 2 * b3 + b4)
        return np.array([q1, q2, v1, v2])

    def exact(self, t, u, x) -> np.ndarray:
        """The sampled loop without quantisation, by scipy to 11 digits: positions."""
        states = [x]
        for k in range(len(t) - 1):
            tau = self.torque(u[:, k], *states[-1])
            piece = solve_ivp(
                lambda _, x, tau=tau: [*x[2:], *self.acceleration(*x[1:], *tau)],
                (0, CONTROL_STEP), states[-1], method="DOP853", rtol=1e-11, atol=1e-13,
            )  # fmt: skip
            states.append(piece.y[:, -1])
        return np.array(states)[:, :2]


class Textbook(Written):
    """The same loop as the textbooks have it: vectors, a mass matrix, a linear solve."""

    def __init__(self, arm: Arm = SETUP.arm):
        super().__init__(arm)
        self.viscous, self.coulomb = np.array(self.viscous), np.array(self.coulomb)
        self.kp, self.kd = np.array(self.kp), np.array(self.kd)

    def acceleration(self, q, v, tau):
        """Of both joints; `q`, `v` and `tau` are vectors."""
        c, h = self.b * np.cos(q[1]), self.b * np.sin(q[1])
        mass = np.array([[self.a + 2 * c, self.d + c], [self.d + c, self.d]])
        velocity = h * np.array([-v[1] * (2 * v[0] + v[1]), v[0] ** 2])
        friction = self.viscous * v + self.coulomb * np.tanh(v / self.small)
        return np.linalg.solve(mass, tau - velocity - friction)

    def step(self, t, x, u, params):
        """One control period: torque from the encoder's reading, held for one RK4 step."""
        q, v = x[:2], x[2:]
        seen = np.round(q / self.encoder) * self.encoder if params["quantised"] else q
        tau = self.kp * (u[:2] - seen) + self.kd * (u[2:] - v)

        def rate(x):
            return np.concatenate([x[2:], self.acceleration(x[:2], x[2:], tau)])

        h = CONTROL_STEP
        k1 = rate(x)
        k2 = rate(x + h / 2 * k1)
        k3 = rate(x + h / 2 * k2)
        k4 = rate(x + h * k3)
        return x + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)


SIZES = dict(inputs=4, outputs=4, states=4)


def sampled_system(written: Written) -> control.NonlinearIOSystem:
    """The recorded loop as a discrete-time system: what happens in one control period."""
    return control.nlsys(written.step, dt=CONTROL_STEP, params={"quantised": True}, **SIZES)


def commands():
    """Times, references ``(4, time)`` and first state of one run for python-control."""
    t = time_grid(CONTROL_STEP)
    reference = pick_and_place(random_extents(1, seed=0)[0], t)
    start = np.concatenate([reference.q[0], np.zeros(2)])
    return t - t[0], np.concatenate([reference.q, reference.qd], -1).T, start


def respond(system, t, u, x, *, rtol=None, atol=None, **options) -> np.ndarray:
    """Positions ``(time, 2)`` by python-control."""
    if rtol:
        options["solve_ivp_kwargs"] = dict(rtol=rtol, atol=atol)
    return control.input_output_response(system, t, u, x, **options).outputs[:2].T


def largest(difference) -> float:
    """Largest absolute value."""
    return float(np.abs(difference).max())


def against_control(repeats: int) -> list[dict]:
    """Rows for the same sampled loop, and for a continuous one at a tolerance of our accuracy.

    The sampled loop is written in two ways: with vectors, as one writes it down, and in plain
    floats, the fastest form that python-control allows.
    """
    t, u, start = commands()
    vectors, floats = sampled_system(Textbook()), sampled_system(Written())
    continuous = control.nlsys(Written().rate, dt=0, **SIZES)

    def solver(method, tolerance):
        return dict(solve_ivp_method=method, rtol=tolerance, atol=1e-2 * tolerance)

    smooth = SETUP.effects.without("encoder", "torque_sensor")
    exact = Written().exact(t, u, start)
    our_error = largest(ours(1, smooth, log_step=CONTROL_STEP).q_true[0] - exact)
    same, alike = (
        largest(respond(system, t, u, start, params={"quantised": False}) - exact)
        for system in (floats, vectors)
    )
    truth = respond(continuous, t, u, start, **solver("DOP853", 1e-11))
    for tolerance in map(float, 10.0 ** -np.arange(3, 10)):
        continuous_error = largest(
            respond(continuous, t, u, start, **solver("RK45", tolerance)) - truth
        )
        if continuous_error <= our_error:
            break
    options = solver("RK45", tolerance)
    taken = interleaved(
        repeats,
        ours=ours,
        vectors=lambda: respond(vectors, t, u, start),
        floats=lambda: respond(floats, t, u, start),
        continuous=lambda: respond(continuous, t, u, start, **options),
    )
    notes = {"largest error here, rad": our_error, "control": control.__version__}
    about = {
        "vectors": ("sampled loop, in vectors", {"largest error there, rad": alike}),
        "floats": ("sampled loop, in plain floats", {"largest error there, rad": same}),
        "continuous": (
            "continuous loop, in plain floats",
            {"largest error there, rad": continuous_error, "its tolerance": tolerance},
        ),
    }
    return [
        ratio(
            f"{TITLE}, against python-control's input_output_response",
            what,
            ("all at once, 1 thread", taken["ours"]["shortest"]),
            (f"one run × {RUNS:,}", RUNS * taken[name]["shortest"]),
            **notes,
            **more,
        )
        for name, (what, more) in about.items()
    ]


def against_single(repeats: int) -> list[dict]:
    """The row of many at once against one by one: a figure, since both are ours."""
    taken = interleaved(repeats, ours=ours, single=lambda: ours(1))
    return [
        ratio(
            f"{TITLE}, one by one",
            "the same function",
            ("all at once", taken["ours"]["shortest"]),
            (f"one run × {RUNS:,}", RUNS * taken["single"]["shortest"]),
            judged=False,
        )
    ]


def measure(repeats: int = 3) -> list[dict]:
    """All rows of recordings."""
    ours()
    memory = memory_row(TITLE)
    rows = against_mujoco(repeats) + against_control(repeats) + against_single(repeats)
    return [*rows, memory]
