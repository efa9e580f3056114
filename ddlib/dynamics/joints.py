"""An arm of seven joints in space whose first two are the book's, and tools for any number."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ddlib._check import finite_array, instance, integer
from ddlib.dynamics.arm import STANDARD_GRAVITY, checked_state
from ddlib.dynamics.formulations import link_frame
from ddlib.dynamics.serial import SerialArm, SpatialLink

_PER_LINK = 10  # inertial parameters of a link: mass, three first moments, six second moments
_SECOND = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))  # xx, yy, zz, xy, xz, yz


def mass_matrix(arm: SerialArm, q) -> np.ndarray:
    """Mass matrix of an arm at angles `q` (rad), shape (..., joints, joints), kg m^2.

    Column j is the torque that accelerates joint j alone by 1 rad/s^2 from rest.
    """
    instance("arm", arm, SerialArm)
    q = finite_array("q", q, arm.joints)
    weightless, identity = SerialArm(arm.links), np.eye(arm.joints)
    rest = np.zeros_like(q)
    columns = [weightless.inverse_dynamics(q, rest, rest + row) for row in identity]
    return np.stack(columns, -1)


def _frames(arm: SerialArm, q) -> np.ndarray:
    """Homogeneous matrices (..., joints + 1, 4, 4) of all links' frames, base first, m."""
    q = finite_array("q", q, arm.joints)
    placed = [np.broadcast_to(np.eye(4), (*q.shape[:-1], 4, 4))]
    for link, angle in zip(arm.constants().links, np.moveaxis(q, -1, 0)):
        rows = link_frame(link, angle, 0.0, 1.0)
        step = [np.stack(np.broadcast_arrays(*row, angle)[:4], -1) for row in rows]
        placed.append(placed[-1] @ np.stack(step, -2))
    return np.stack(placed, -3)


def regressor(arm: SerialArm, q, qd, qdd) -> np.ndarray:
    """Matrix Y ``(..., joints, 10 joints)`` with ``tau = Y p``; angles in rad.

    p are ten parameters of each link, in their order, about the origin of its frame: mass (kg),
    first moments x, y, z (kg m), second moments xx, yy, zz, xy, xz, yz (kg m^2, signed). Force and
    moment of a link are linear in them, and each joint feels the moments of all links beyond it
    about its axis. Many columns depend on others, or are zero: only some combinations of parameters
    move a joint (Khosla 1986).
    """
    instance("arm", arm, SerialArm)
    q, qd, qdd = checked_state(q, qd, qdd, arm.joints)
    placed = _frames(arm, q)
    axes, places = placed[..., :3, 2], placed[..., :3, 3]
    matrix = np.zeros((*q.shape, _PER_LINK * arm.joints))
    spin, spin_rate = np.zeros((2, *q.shape[:-1], 3))
    fall = spin - np.array(arm.gravity)  # acceleration of the frame, as a weight feels it
    for j in range(arm.joints):
        axis, tip = axes[..., j, :], places[..., j + 1, :] - places[..., j, :]
        own = axis * qd[..., j, None]
        spin_rate = spin_rate + axis * qdd[..., j, None] + np.cross(spin, own)
        spin = spin + own
        fall = fall + np.cross(spin_rate, tip) + np.cross(spin, np.cross(spin, tip))
        turn = placed[..., j + 1, :3, :3]
        force, moment = _wrenches(
            *((x[..., None, :] @ turn)[..., 0, :] for x in (spin, spin_rate, fall))
        )
        force, moment = turn @ force, turn @ moment
        for i in range(j + 1):
            lever = np.cross(axes[..., i, :], places[..., j + 1, :] - places[..., i, :])
            row = axes[..., i, None, :] @ moment + lever[..., None, :] @ force
            matrix[..., i, _PER_LINK * j : _PER_LINK * (j + 1)] = row[..., 0, :]
    return matrix


def _wrenches(spin, spin_rate, fall) -> tuple[np.ndarray, np.ndarray]:
    """Force and moment at a link's origin per parameter, ``(..., 3, 10)``, in its own frame."""
    swing = _across(spin_rate) + _across(spin) @ _across(spin)
    force = np.concatenate([fall[..., None], swing, np.zeros((*spin.shape, 6))], -1)
    second = _tensor_times(spin_rate) + _across(spin) @ _tensor_times(spin)
    moment = np.concatenate([np.zeros((*spin.shape, 1)), -_across(fall), second], -1)
    return force, moment


def _across(x) -> np.ndarray:
    """The matrix that multiplies by the vector product with x ``(..., 3)``, from the left."""
    return np.cross(x[..., None, :], np.eye(3)).swapaxes(-1, -2)


def _tensor_times(x) -> np.ndarray:
    """The matrix by which a tensor's six elements give its product with x, ``(..., 3, 6)``."""
    matrix = np.zeros((*x.shape, 6))
    for k, (row, column) in enumerate(_SECOND):
        matrix[..., row, k] = x[..., column]
        matrix[..., column, k] = x[..., row]
    return matrix


def locked(arm: SerialArm, joints: int) -> SerialArm:
    """The arm with only its first joints free, what lies beyond locked at angle zero: one body."""
    instance("arm", arm, SerialArm)
    integer("joints", joints, 1, arm.joints)
    if joints == arm.joints:
        return arm
    placed = _frames(arm, np.zeros(arm.joints))[1:]
    last = placed[joints - 1]
    bodies = [_moved(link, np.linalg.inv(last) @ f) for link, f in zip(arm.links, placed)]
    bodies = bodies[joints - 1 :]
    mass = sum(m for m, _, _ in bodies)
    com = sum(m * c for m, c, _ in bodies) / mass if mass else np.zeros(3)
    inertia = sum(t + m * _steiner(c - com) for m, c, t in bodies)
    end = (np.linalg.inv(last) @ placed[-1])[:3, 3]
    # the hand lies `end` beyond the last free link's own far end, in that link's frame
    near = arm.links[joints - 1]
    if np.abs(end[1:]).max() > 1e-12 * max(1.0, np.abs(end).max()):
        raise ValueError(
            f"arm must have its hand on the x axis of link {joints} at angles zero, got {end} m"
        )
    whole = replace(
        near,
        length=near.length + end[0],
        mass=float(mass),
        com=com - np.array([end[0], 0.0, 0.0]),
        inertia=(inertia + inertia.T) / 2,
    )
    return SerialArm((*arm.links[: joints - 1], whole), arm.gravity)


def _moved(link: SpatialLink, place) -> tuple:
    """Mass, centre and tensor of inertia about it of a link, seen from another frame."""
    turn = place[:3, :3]
    com = turn @ link.com + place[:3, 3]
    return link.mass, com, turn @ np.array(link.inertia) @ turn.T


def _steiner(arm) -> np.ndarray:
    """What a unit mass at a place adds to the tensor of inertia (Steiner's parallel axes)."""
    return arm @ arm * np.eye(3) - np.outer(arm, arm)


def _arm_in_space() -> SerialArm:
    """Links 3 to 7 as assumed; link 2 is what they leave of the two-link arm's forearm."""
    to_third_axis = 0.10  # from axis 2, m; with the lengths of links 3 to 7 it makes 0.40 m
    mass = np.array((3.0, 1.8, 1.2, 0.7, 0.3))  # of links 3 to 7, kg
    length = np.array((0.10, 0.07, 0.05, 0.04, 0.04))  # m
    gyration = np.array((0.07, 0.05, 0.04, 0.03, 0.03))  # radius about their middles, m
    ends = to_third_axis + np.cumsum(length)
    middle = ends - length / 2
    own = mass * gyration**2
    whole, centre, inertia = 14.0, 0.09, 0.60  # of the forearm of `CMU_DD_ARM_II`
    own_mass = float(whole - mass.sum())
    com = float((whole * centre - mass @ middle) / own_mass)
    about_axis = inertia + whole * centre**2 - (own + mass * middle**2).sum()
    about_com = about_axis - own_mass * com**2
    twists = (-90.0, 90.0, -90.0, 90.0, 0.0)
    first = SpatialLink(0.0, 0.50, 0.0, 14.0, (0.22 - 0.50, 0.0, 0.0), np.diag([0, 0, 0.40]))
    place = com - to_third_axis, 0.0, 0.0
    second = SpatialLink(90.0, to_third_axis, 0.0, own_mass, place, np.eye(3) * about_com)
    rest = [
        SpatialLink(twist, a, 0.0, m, (-a / 2, 0.0, 0.0), np.eye(3) * i)
        for twist, a, m, i in zip(twists, length, mass, own)
    ]
    return SerialArm((first, second, *rest), (0.0, 0.0, -STANDARD_GRAVITY))


DD_ARM_II_IN_SPACE = _arm_in_space()
"""Stand-in for all six joints of the CMU Direct-Drive Arm II, and a seventh of the book's.

Nothing beyond the second joint of the real arm is known but that there are six joints, and that
the first three position the hand. Here axes 3, 5 and 7 are level and lie across the forearm, axes
4 and 6 are upright, all with the arm stretched; masses and lengths are assumed, so that with
joints 3 to 7 locked the arm is `CMU_DD_ARM_II`.
"""
