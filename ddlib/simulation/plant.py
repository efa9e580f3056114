"""The plant: an arm with its frictions, motors and shafts, integrated under held torques.

Positions and velocities are ``(..., 2)``: the joints. With a `FlexibleJoint` they are
``(..., 4)``: the links, then the motors. Leading axes are runs; no run depends on another.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ddlib.dynamics import Arm
from ddlib.effects import IDEAL, Effects, StickSlipFriction

# Largest turn of the fastest swing in one Runge-Kutta step, rad: its energy then decays by less
# than 2e-5 of itself a radian.
_PHASE = 0.25


class Plant:
    """An arm with those effects that act inside it: friction, motor, transmission."""

    def __init__(self, arm: Arm, effects: Effects = IDEAL):
        self.arm, self.motor = arm, effects.motor
        sticks = [isinstance(f, StickSlipFriction) for f in effects.friction]
        self._sticking = tuple(f for f, s in zip(effects.friction, sticks) if s)
        self._smooth = Effects(friction=tuple(f for f, s in zip(effects.friction, sticks) if not s))
        self._joint = effects.transmission[0] if effects.transmission else None
        self._links = self._joint.links(arm) if self._joint else arm

    def rest(self, q):
        """Positions and velocities of an arm at rest at joint angles `q` (rad, ``(..., 2)``)."""
        x = np.concatenate([q, q], -1) if self._joint else q.copy(order="K")
        return x, np.zeros_like(x)

    def _response(self, x, v, shaft):
        """Accelerations under `shaft` torques at the motors, friction already taken off."""
        if self._joint is None:
            return self.arm._acceleration(x, v, shaft)
        spring = self._joint.spring_torque(x[..., 2:] - x[..., :2], v[..., 2:] - v[..., :2])
        net = shaft - spring
        drive = np.stack([spring[..., 0] - net[..., 1], spring[..., 1]], -1)
        links = self._links._acceleration(x[..., :2], v[..., :2], drive)
        shoulder, elbow = self._joint.motor_inertia
        motors = np.stack([net[..., 0] / shoulder, net[..., 1] / elbow - links[..., 0]], -1)
        return np.concatenate(np.broadcast_arrays(links, motors), -1)

    def _shaft(self, x, v, tau):
        """Torque on the shafts: `tau` with the motors' ripple, less all smooth friction."""
        for effect in self.motor:
            tau = effect.shaft_torque(tau, x[..., -2:])
        if self._smooth.friction:
            tau = tau - self._smooth.friction_torque(v[..., -2:])
        return tau

    def advance(self, x, v, tau, step):
        """State after one Runge-Kutta step (s; runs may differ) under constant torque."""
        if self._sticking:
            return self._advance_sticking(x, v, tau, step)
        return _rk4(lambda x, v: self._response(x, v, self._shaft(x, v, tau)), x, v, step)

    def _advance_sticking(self, x, v, tau, step):
        """`advance` with joints that stick, in pieces that end where a joint comes to rest."""
        for last in (False, False, True):
            way = self._directions(x, v, tau)
            if self._joint is None and not way.any():  # all at rest and held: nothing changes
                return x, v
            ends = self._slide(x, v, tau, step, way)
            stops = _stops(way * v[..., -2:], way * ends[1][..., -2:])
            part = stops.min(-1, keepdims=True)
            if last or (part == 1).all():
                return self._halt(*ends, way == 0, way)
            ends = self._slide(x, v, tau, part * step, way)
            x, v = self._halt(*ends, (way == 0) | (stops == part) & (part < 1), way)
            step = (1 - part) * step

    def _slide(self, x, v, tau, step, way):
        """One Runge-Kutta step in which the joints slide the given way, or stick if it is 0."""
        stuck = way == 0

        def acceleration(x, v):
            shaft = self._shaft(x, v, tau) - way * self._size(v)
            free = self._response(x, v, shaft)
            if not stuck.any():
                return free
            rate = _brake(self._mobility(x), free, stuck)
            rate[..., -2:][np.broadcast_to(stuck, rate[..., -2:].shape)] = 0.0  # no rounding left
            return rate

        return _rk4(acceleration, x, v, step)

    def _halt(self, x, v, halt, way):
        """Bring joints to rest by an impulse: those named and those that slide backwards."""
        halt = halt | (way * v[..., -2:] <= 0)
        if not halt.any():
            return x, v
        v = _brake(self._mobility(x), v, halt)
        v[..., -2:][halt] = 0.0
        return x, v

    def _size(self, v):
        return sum(f.size(v[..., -2:]) for f in self._sticking)

    def _mobility(self, x):
        """Accelerations of all coordinates per torque on each motor, shape ``(..., n, 2)``."""
        links, bc = self._links, self._links.b * np.cos(x[..., 1])
        m11, m12, m22 = links.a + 2 * bc, links.d + bc, links.d
        inverse = np.stack([m22 + 0 * bc, -m12, m11], -1) / (m11 * m22 - m12**2)[..., None]
        columns = np.zeros((*x.shape, 2))
        if self._joint is None:
            columns[..., 0, :], columns[..., 1, :] = inverse[..., :2], inverse[..., 1:]
        else:
            shoulder, elbow = self._joint.motor_inertia
            columns[..., :2, 1] = -inverse[..., :2]  # link 1 takes the elbow motor's reaction
            columns[..., 2, 0] = 1 / shoulder
            columns[..., 3, 1] = 1 / elbow + inverse[..., 0]
        return columns

    def _directions(self, x, v, tau):
        """Which way each joint slides: -1 or 1, and 0 for joints that stick.

        Of all torques f, up to the breakaway torques, that could hold the joints the one to choose
        minimises ``f' B f / 2 - a' f``, with the mobility B and the accelerations a without it
        (Gauss's principle); for two joints the minimum is found by trying every edge.
        """
        way = np.sign(v[..., -2:])
        resting = way == 0
        if not resting.any():
            return way
        size = self._size(v)
        a = self._response(x, v, self._shaft(x, v, tau) - way * size)[..., -2:]
        B = self._mobility(x)[..., -2:, :]
        limit = np.broadcast_to(np.where(resting, size, 0.0), a.shape)
        inside = _holding(B, a, resting)
        trials = [np.clip(inside, -limit, limit)]
        for k in (0, 1):
            for side in (-1, 1):
                edge = side * limit[..., k]
                other = (a[..., 1 - k] - B[..., 1 - k, k] * edge) / B[..., 1 - k, 1 - k]
                other = np.clip(other, -limit[..., 1 - k], limit[..., 1 - k])
                trials.append(np.stack([edge, other] if k == 0 else [other, edge], -1))
        f = np.stack(trials)
        cost = 0.5 * np.einsum("...i,...ij,...j", f, B, f) - (a * f).sum(-1)
        best = np.take_along_axis(f, cost.argmin(0)[None, ..., None], 0)[0]
        holds = (np.abs(inside) <= limit).all(-1, keepdims=True)
        best = np.where(holds, inside, best)
        broken = ~holds & (np.abs(best) >= limit) & resting
        driving = a - (B @ best[..., None])[..., 0]
        return np.where(broken, np.sign(np.where(limit > 0, best, driving)), way)


def _rk4(acceleration, x, v, step):
    """One classical Runge-Kutta step of ``x'' = acceleration(x, x')``."""
    half, n = 0.5 * step, x.shape[-1]
    first = acceleration(x, v)  # of all runs, even where they begin alike
    start = np.concatenate(np.broadcast_arrays(x, v, first)[:2], -1)
    k1 = np.concatenate([start[..., n:], first], -1)

    def rate(state):
        x, v = state[..., :n], state[..., n:]
        derivative = np.empty_like(state)
        derivative[..., :n], derivative[..., n:] = v, acceleration(x, v)
        return derivative

    k2 = rate(start + half * k1)
    k3 = rate(start + half * k2)
    k4 = rate(start + step * k3)
    end = start + step / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    return end[..., :n], end[..., n:]


def _stops(before, after):
    """Share of a step after which each joint comes to rest, from its speeds; 1 if it does not."""
    stopping = (before > 0) & (after < 0)
    return np.where(stopping, before / np.where(stopping, before - after, 1.0), 1.0)


def _brake(columns, a, stuck):
    """Accelerations (or velocities) `a` less what brings those of the stuck motors to zero."""
    held = _holding(columns[..., -2:, :], a[..., -2:], stuck)
    return a - (columns @ held[..., None])[..., 0]


def _holding(B, a, stuck):
    """Torques ``f`` on the stuck joints with ``(B f) = a`` there; 0 on the others."""
    b11, b12, b21, b22 = (B[..., i, j] for i in (0, 1) for j in (0, 1))
    a1, a2, s1, s2 = a[..., 0], a[..., 1], stuck[..., 0], stuck[..., 1]
    det = b11 * b22 - b12 * b21
    f1 = np.where(s2, (b22 * a1 - b12 * a2) / det, a1 / b11)
    f2 = np.where(s1, (b11 * a2 - b21 * a1) / det, a2 / b22)
    return np.stack([np.where(s1, f1, 0.0), np.where(s2, f2, 0.0)], -1)


def runge_kutta_steps(arm: Arm, effects: Effects, step: float) -> np.ndarray:
    """Runge-Kutta steps that one control period needs, for each run by itself.

    Friction acts like a first-order decay of joint speed, fastest at rest; RK4 is stable up to 2.78
    times its time constant, 2 is used. Of the fastest swing of springs a step covers a quarter of a
    radian.
    """
    slope = sum((np.asarray(f.slope) for f in effects.friction if hasattr(f, "slope")), np.zeros(2))
    elbow = np.linspace(0.0, np.pi, 13)
    q = np.stack([0 * elbow, elbow], -1)
    slope = slope[..., None, :, None] * np.eye(2)
    if not effects.transmission:
        return _count(np.linalg.eigvals(np.linalg.solve(arm.mass_matrix(q), slope)), step / 2)
    joint = effects.transmission[0]
    twist = np.asarray(joint.damping, dtype=float)[..., None, :, None] * np.eye(2)
    twist, slope = np.broadcast_arrays(twist, slope)
    decay = np.block([[twist, -twist], [-twist, twist + slope]])
    decay = np.linalg.eigvals(np.linalg.solve(joint.mass_matrix(arm, q), decay))
    swing = replace(joint, stiffness=np.asarray(joint.stiffness)[..., None, :])
    swing = swing.mode_frequencies(arm, q)
    return np.maximum(_count(decay, step / 2), _count(swing, step / _PHASE))


def _count(rates, share):
    """Whole steps for the fastest of the rates over postures (..., posture, mode)."""
    return np.maximum(1, np.ceil(rates.real.max((-2, -1)) * share)).astype(int)
