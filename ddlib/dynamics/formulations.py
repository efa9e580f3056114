"""Three formulations of inverse dynamics, written in plain arithmetic.

The same code runs on numbers, on arrays and on the counting numbers of `ddlib.dynamics.counting`:
how much a formulation costs is found by running it.
"""

from __future__ import annotations

import functools
import operator
from typing import NamedTuple

import numpy as np


class LinkConstants(NamedTuple):
    """What a formulation needs to know of a link, in Denavit-Hartenberg's frames."""

    cos_twist: float
    sin_twist: float
    length: float
    offset: float
    tip: list  # from the joint to the frame's origin, in the frame, m
    mass: float
    com: list  # centre of mass in the frame, m
    inertia: list  # 3 x 3, about the centre of mass, kg m^2
    second_moments: list  # 4 x 4, integral of r r' over the mass, with r = (x, y, z, 1)


class ArmConstants(NamedTuple):
    """The links of an arm, and the acceleration of its base against gravity (m/s^2)."""

    links: list
    base: list


def newton_euler(constants, q, qd, qdd, zero=0.0, one=1.0) -> list:
    """Recursive Newton-Euler (Luh, Walker & Paul 1980): torques, one per joint.

    Motion goes outwards, forces come inwards, equal work for every joint. `constants` are from
    `SerialArm.constants`; angles (rad), velocities and accelerations of the joints are numbers,
    arrays or counting numbers, for which `zero` and `one` stand for 0 and 1.
    """
    links, acceleration = constants
    z, rest = [zero, zero, one], [zero, zero, zero]
    turns = [_rotation(link, angle, zero) for link, angle in zip(links, q)]
    spin, spin_rate = rest, rest
    forces, moments = [], []
    for link, turn, v, a in zip(links, turns, qd, qdd):
        inwards = _transposed(turn)
        own = _scaled(v, z)
        spin_rate = _turned(inwards, _sum(spin_rate, _scaled(a, z), _cross(spin, own)))
        spin = _turned(inwards, _sum(spin, own))
        acceleration = _sum(_swing(spin, spin_rate, link.tip), _turned(inwards, acceleration))
        force = _scaled(link.mass, _sum(_swing(spin, spin_rate, link.com), acceleration))
        momentum = _turned(link.inertia, spin)
        forces.append(force)
        moments.append(_sum(_turned(link.inertia, spin_rate), _cross(spin, momentum)))
    tau, force, moment = [], None, None
    for i in reversed(range(len(links))):
        own = _sum(_cross(_sum(links[i].tip, links[i].com), forces[i]), moments[i])
        if force is None:  # nothing beyond the last link
            force, moment = forces[i], own
        else:
            beyond = _turned(turns[i + 1], force)
            moment = _sum(_turned(turns[i + 1], moment), _cross(links[i].tip, beyond), own)
            force = _sum(beyond, forces[i])
        tau.append(_dot(moment, _turned(_transposed(turns[i]), z)))
    return tau[::-1]


def lagrange_euler(constants, q, qd, qdd, zero=0.0, one=1.0) -> list:
    """The closed Lagrange-Euler form (Uicker 1965, Kahn 1969): torques, one per joint.

    ``tau_i = sum_j D_ij qdd_j + sum_jk D_ijk qd_j qd_k - sum_p m_p g' U_pi r_p`` with
    ``D_ij = sum_p tr(U_pj J_p U_pi')`` and ``D_ijk = sum_p tr(U_pjk J_p U_pi')``; ``U_pi`` and
    ``U_pjk`` are derivatives of link p's 4 x 4 frame, ``J_p`` its second moments and ``r_p`` its
    centre. Each product in ``D_ijk`` is done anew, as in programs that Hollerbach (1980) counts.
    """
    links, base = constants
    first, second = _sweeps([link_frame(link, x, zero, one) for link, x in zip(links, q)], zero)
    inertia = {}
    for p, i in first:
        weighted = _product(first[p, i], links[p].second_moments)
        for j in range(i, p + 1):
            part = _trace(_product(weighted, _transposed(first[p, j])))
            inertia[i, j] = inertia[i, j] + part if (i, j) in inertia else part
    n, tau = len(links), []
    for i in range(n):
        parts = [inertia[min(i, j), max(i, j)] * qdd[j] for j in range(n)]
        for p in range(i, n):
            outwards = _transposed(first[p, i])
            for j, k in ((j, k) for j in range(p + 1) for k in range(p + 1)):
                weighted = _product(second[p, min(j, k), max(j, k)], links[p].second_moments)
                parts.append(_trace(_product(weighted, outwards)) * qd[j] * qd[k])
            centre = _turned(first[p, i][:3], [*links[p].com, one])
            parts.append(links[p].mass * _dot(base, centre))
        tau.append(functools.reduce(operator.add, parts))
    return tau


def recursive_lagrange(constants, q, qd, qdd, zero=0.0, one=1.0) -> list:
    """Recursive Lagrangian form with 3 x 3 matrices (Hollerbach 1980): torques, one per joint.

    Outwards go the orientations ``W_i`` with their first and second derivatives in time and the
    accelerations of the frames' origins; inwards come ``D_i``, the integral of ``r a'`` over all
    mass beyond joint i (``r`` from the joint, in frame i; ``a`` its acceleration), and the first
    moments ``c_i``. Then ``tau_i = tr(dW_i/dq_i D_i) - g' dW_i/dq_i c_i``.
    """
    links, base = constants
    turns = [_rotation(link, angle, zero) for link, angle in zip(links, q)]
    frame = [[one if i == j else zero for j in range(3)] for i in range(3)]
    rate = twice = [[zero] * 3 for _ in range(3)]
    origin = [zero] * 3
    swept, outwards = [], []  # dW/dq, and second derivative of W and acceleration of the origin
    for link, turn, v, a in zip(links, turns, qd, qdd):
        along = _quarter_turn(turn, zero)[:3]
        own, across = _product(frame, along), _product(rate, along)
        bent = _product(frame, _quarter_turn(along, zero)[:3])
        coriolis = [_scaled(v, row) for row in across]
        twice_coriolis = _added(coriolis, coriolis)
        pulled = _added([_scaled(v * v, row) for row in bent], [_scaled(a, row) for row in own])
        twice = _added(_product(twice, turn), _added(twice_coriolis, pulled))
        rate = _added(_product(rate, turn), [_scaled(v, row) for row in own])
        frame = _product(frame, turn)
        origin = _sum(origin, _turned(twice, link.tip))
        swept.append(own)
        outwards.append((twice, origin))
    tau, inwards, force, moment, beyond = [], None, None, None, None
    for i in reversed(range(len(links))):
        link, (twice, origin) = links[i], outwards[i]
        weighted = _scaled(link.mass, link.com)
        own_force = _sum(_scaled(link.mass, origin), _turned(twice, weighted))
        second = [row[:3] for row in link.second_moments[:3]]
        own = _added(_outer(weighted, origin), _product(second, _transposed(twice)))
        if inwards is None:  # nothing beyond the last link
            force, mass, carried = own_force, link.mass, weighted
        else:
            own = _added(own, _product(turns[i + 1], inwards))
            force, mass = _sum(force, own_force), beyond + link.mass
            carried = _sum(weighted, _turned(turns[i + 1], moment))
        inwards, beyond = _added(_outer(link.tip, force), own), mass
        moment = _sum(carried, _scaled(mass, link.tip))
        trace = functools.reduce(operator.add, map(_dot, swept[i], _transposed(inwards)))
        tau.append(trace + _dot(base, _turned(swept[i], moment)))
    return tau[::-1]


def _sweeps(frames, zero):
    """First and second derivatives of every link's frame: ``[p, j]`` and ``[p, j, k]``, j <= k."""
    n = len(frames)
    chain, first, second = {}, {}, {}  # chain[i, p]: link p's frame, seen from before joint i
    for p in range(n):
        for i in range(p + 1):
            chain[i, p] = _product(chain[i, p - 1], frames[p]) if i < p else frames[p]

    def carried(i, swept):
        return _product(chain[0, i - 1], swept) if i else swept

    for p in range(n):
        for k in range(p + 1):
            swept = _quarter_turn(chain[k, p], zero)
            first[p, k] = carried(k, swept)
            for j in range(k):
                second[p, j, k] = _product(first[k - 1, j], swept)
            second[p, k, k] = carried(k, _quarter_turn(swept, zero))
    return first, second


def _rotation(link, angle, zero):
    """Orientation of a link's frame in the one before."""
    c, s, ct, st = np.cos(angle), np.sin(angle), link.cos_twist, link.sin_twist
    return [[c, -s * ct, s * st], [s, c * ct, -c * st], [zero, st, ct]]


def link_frame(link, angle, zero, one):
    """Orientation and origin of a link's frame in the one before, 4 x 4."""
    turn = _rotation(link, angle, zero)
    origin = (link.length * turn[0][0], link.length * turn[1][0], link.offset)
    return [*([*row, x] for row, x in zip(turn, origin)), [zero, zero, zero, one]]


def _quarter_turn(frame, zero):
    """Derivative of a turn about z: rows 1 and 2 change places, the others vanish."""
    nothing = [zero] * len(frame[0])
    return [[-x for x in frame[1]], frame[0], nothing, nothing]


def _swing(spin, spin_rate, arm):
    """Acceleration of a point of a turning body relative to the body's origin."""
    return _sum(_cross(spin_rate, arm), _cross(spin, _cross(spin, arm)))


def _cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def _dot(a, b):
    return functools.reduce(operator.add, (x * y for x, y in zip(a, b)))


def _sum(first, *others):
    for other in others:
        first = [x + y for x, y in zip(first, other)]
    return first


def _scaled(factor, vector):
    return [factor * x for x in vector]


def _turned(matrix, vector):
    return [_dot(row, vector) for row in matrix]


def _transposed(matrix):
    return [list(column) for column in zip(*matrix)]


def _added(a, b):
    return [_sum(x, y) for x, y in zip(a, b)]


def _outer(a, b):
    return [_scaled(x, b) for x in a]


def _product(a, b):
    columns = _transposed(b)
    return [[_dot(row, column) for column in columns] for row in a]


def _trace(matrix):
    return functools.reduce(operator.add, (row[i] for i, row in enumerate(matrix)))
