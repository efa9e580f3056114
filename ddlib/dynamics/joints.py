"""More joints: an arm of seven in space whose first two are the book's, and tools for any number.

Nothing beyond the second joint of the real arm is known but that there are six joints, and that
the first three position the hand. Here axes 3, 5 and 7 are level and lie across the forearm, axes
4 and 6 are upright, all with the arm stretched; masses and lengths are assumed. Link 2 is what the
forearm of `ddlib.dynamics.arm.CMU_DD_ARM_II` leaves when links 3 to 7 are taken out of it, so that
with those joints locked the arm is the one of all other chapters. The seventh joint is the book's.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ddlib._check import finite_array, integer, shaped
from ddlib.dynamics.arm import STANDARD_GRAVITY
from ddlib.dynamics.serial import SerialArm, SpatialLink

PER_LINK = 10
"""Inertial parameters of a link: mass, three first moments, six second moments."""

_SECOND = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))  # xx, yy, zz, xy, xz, yz


def mass_matrix(arm: SerialArm, q) -> np.ndarray:
    """Mass matrix of an arm, from its torques for one acceleration at a time.

    Parameters
    ----------
    arm : SerialArm
    q : array_like, shape (..., joints)
        Angles, rad.

    Returns
    -------
    ndarray, shape (..., joints, joints)
        kg m^2; column j is the torque that accelerates joint j by 1 rad/s^2 from rest.
    """
    q = finite_array("q", q, arm.joints)
    weightless, one = SerialArm(arm.links), np.eye(arm.joints)
    rest = np.zeros_like(q)
    columns = [weightless.inverse_dynamics(q, rest, rest + row) for row in one]
    return np.stack(columns, -1)


def frames(arm: SerialArm, q) -> np.ndarray:
    """Places and orientations of all links, base first.

    Parameters
    ----------
    arm : SerialArm
    q : array_like, shape (..., joints)
        Angles, rad.

    Returns
    -------
    ndarray, shape (..., joints + 1, 4, 4)
        Homogeneous matrices; the last column holds the frame's origin, m.
    """
    q = finite_array("q", q, arm.joints)
    found = [np.broadcast_to(np.eye(4), (*q.shape[:-1], 4, 4))]
    for j, link in enumerate(arm.constants().links):
        c, s, ct, st = np.cos(q[..., j]), np.sin(q[..., j]), link.cos_twist, link.sin_twist
        step = np.zeros((*q.shape[:-1], 4, 4))
        step[..., 0, :3] = np.stack([c, -s * ct, s * st], -1)
        step[..., 1, :3] = np.stack([s, c * ct, -c * st], -1)
        step[..., 2, 1:3] = st, ct
        step[..., :3, 3] = np.stack([link.length * c, link.length * s, link.offset + 0 * c], -1)
        step[..., 3, 3] = 1
        found.append(found[-1] @ step)
    return np.stack(found, -3)


def hand(arm: SerialArm, q) -> np.ndarray:
    """End of the last link, shape ``(..., 3)``, m: x and y level, z up.

    Parameters
    ----------
    arm, q
        As in `frames`.
    """
    return frames(arm, q)[..., -1, :3, 3]


def inertial_parameters(link: SpatialLink) -> np.ndarray:
    """What a link's torques are linear in, shape (10,).

    Mass (kg), first moments x, y, z (kg m) and second moments xx, yy, zz, xy, xz, yz (kg m^2),
    all about the origin of the link's frame; the second moments are the elements of the tensor of
    inertia, products with their sign in it.
    """
    com = np.array(link.com)
    tensor = np.array(link.inertia) + link.mass * (com @ com * np.eye(3) - np.outer(com, com))
    return np.concatenate([[link.mass], link.mass * com, [tensor[place] for place in _SECOND]])


def regressor(arm: SerialArm, q, qd, qdd) -> np.ndarray:
    """Matrix Y with ``tau = Y p``, p the `inertial_parameters` of all links in their order.

    Force and moment of a link are linear in its parameters, and each joint feels the moments of
    all links beyond it about its axis.

    Parameters
    ----------
    arm : SerialArm
        Its geometry and gravity count, its masses do not.
    q, qd, qdd : array_like, shape (..., joints)
        Angles (rad), velocities (rad/s), accelerations (rad/s^2).

    Returns
    -------
    ndarray, shape (..., joints, 10 joints)
        Many columns depend on others, or are zero: only some combinations of parameters move a
        joint (Khosla 1986).
    """
    q, qd, qdd = (finite_array(n, x, arm.joints) for n, x in (("q", q), ("qd", qd), ("qdd", qdd)))
    q, qd, qdd = np.broadcast_arrays(q, qd, qdd)
    placed = frames(arm, q)
    axes, places = placed[..., :3, 2], placed[..., :3, 3]
    found = np.zeros((*q.shape, PER_LINK * arm.joints))
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
            found[..., i, PER_LINK * j : PER_LINK * (j + 1)] = row[..., 0, :]
    return found


def _wrenches(spin, spin_rate, fall) -> tuple[np.ndarray, np.ndarray]:
    """Force and moment at a link's origin for each of its parameters, ``(..., 3, 10)`` both.

    From the link's angular velocity and acceleration and its origin's acceleration ``(..., 3)``,
    all in its own frame.
    """
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
    found = np.zeros((*x.shape, 6))
    for k, (row, column) in enumerate(_SECOND):
        found[..., row, k] = x[..., column]
        found[..., column, k] = x[..., row]
    return found


def locked(arm: SerialArm, joints: int, posture=None) -> SerialArm:
    """The arm with only its first joints free: what lies beyond is one body with the last link.

    Parameters
    ----------
    arm : SerialArm
    joints : int
        Joints that stay free, 1 or more.
    posture : array_like, shape (arm.joints,), optional
        Angles at which the others are locked, rad. Default: all zero.

    Returns
    -------
    SerialArm
        Its last link ends where the arm's does.
    """
    integer("joints", joints, 1, arm.joints)
    rest = np.zeros(arm.joints) if posture is None else shaped("posture", posture, (arm.joints,))
    if joints == arm.joints:
        return arm
    angles = np.where(np.arange(arm.joints) < joints, 0.0, rest)
    placed = frames(arm, angles)[1:]
    last = placed[joints - 1]
    bodies = [_moved(link, np.linalg.inv(last) @ f) for link, f in zip(arm.links, placed)]
    bodies = bodies[joints - 1 :]
    mass = sum(m for m, _, _ in bodies)
    com = sum(m * c for m, c, _ in bodies) / mass if mass else np.zeros(3)
    inertia = sum(t + m * _steiner(c - com) for m, c, t in bodies)
    end = (np.linalg.inv(last) @ placed[-1])[:3, 3]
    # In the frame of the last free link its own far end; the hand lies `end` beyond it.
    near = arm.links[joints - 1]
    if np.abs(end[1:]).max() > 1e-12 * max(1.0, np.abs(end).max()):
        raise ValueError(
            f"posture must leave the hand on the x axis of link {joints}, got it at {end} m"
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
    return arm @ arm * np.eye(3) - np.outer(arm, arm)


FOREARM = {
    "mass": (3.0, 1.8, 1.2, 0.7, 0.3),
    "length": (0.10, 0.07, 0.05, 0.04, 0.04),
    "gyration": (0.07, 0.05, 0.04, 0.03, 0.03),
}
"""Links 3 to 7: mass (kg), length (m), radius of gyration about their middles (m). All assumed."""

TO_THIRD_AXIS = 0.10
"""From axis 2 to axis 3, m. Assumed; with the lengths of links 3 to 7 it makes 0.40 m."""


def _arm_in_space() -> SerialArm:
    """Links 3 to 7 as assumed; link 2 is what they leave of the two-link arm's forearm."""
    mass, length, gyration = (np.array(FOREARM[name]) for name in ("mass", "length", "gyration"))
    ends = TO_THIRD_AXIS + np.cumsum(length)
    middle = ends - length / 2
    own = mass * gyration**2
    whole, centre, inertia = 14.0, 0.09, 0.60  # of `ddlib.dynamics.arm.CMU_DD_ARM_II`'s forearm
    left = float(whole - mass.sum())
    com = float((whole * centre - mass @ middle) / left)
    about_axis = inertia + whole * centre**2 - (own + mass * middle**2).sum()
    about_com = about_axis - left * com**2
    twists = (-90.0, 90.0, -90.0, 90.0, 0.0)
    first = SpatialLink(0.0, 0.50, 0.0, 14.0, (0.22 - 0.50, 0.0, 0.0), np.diag([0, 0, 0.40]))
    place = com - TO_THIRD_AXIS, 0.0, 0.0
    second = SpatialLink(90.0, TO_THIRD_AXIS, 0.0, left, place, np.eye(3) * about_com)
    rest = [
        SpatialLink(twist, a, 0.0, m, (-a / 2, 0.0, 0.0), np.eye(3) * i)
        for twist, a, m, i in zip(twists, length, mass, own)
    ]
    return SerialArm((first, second, *rest), (0.0, 0.0, -STANDARD_GRAVITY))


DD_ARM_II_IN_SPACE = _arm_in_space()
"""Stand-in for all six joints of the CMU Direct-Drive Arm II, and a seventh; see the module."""
