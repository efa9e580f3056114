"""Six joints of which only the axes are known: what each motor's current may depend on.

Each joint has equations linear in unknown factors, by Lagrange's equation. Axis 1 is vertical, axis
2 crosses it and is level, axis 3 is parallel to axis 2; axis 4 lies in the plane of that pair, axes
5 and 6 cross the one before at a right angle. Motor 6 turns joint 5, too, so that both feel
friction of the sum of their velocities. The zeros of joints 2 and 3 need not be known. Assumed are
masses symmetric about the plane of the pair, and a wrist that joints 1 to 3 carry as a part of the
forearm and that has no velocity terms.
"""

from __future__ import annotations

import numpy as np

from ddlib._check import flag, integer, shaped
from ddlib.identification.regression import SIGN_SPEED

_JOINTS = 6
_FRICTION = ("velocity", "sign", "velocity, motor 6", "sign, motor 6")


def joint_terms(states) -> tuple[dict[str, np.ndarray], ...]:
    """What each joint's current is a weighted sum of: by joint ``{name: column (cases,)}``.

    `states` holds position (rad), velocity and acceleration of six joints, ``(cases, 6, 3)``.
    """
    states = shaped("states", states, f"(cases, {_JOINTS}, 3)")
    q, v, a = np.moveaxis(states, -1, 0)
    sign = np.clip(v / SIGN_SPEED, -1, 1)
    rows = [_vertical(q, v, a), *_pair(q, v, a), *_wrist(q, a)]
    for j, row in enumerate(rows):
        row |= {"velocity": v[:, j], "sign": sign[:, j]}
        if j in (4, 5):
            both = v[:, 4] + v[:, 5]
            row |= {
                "velocity, motor 6": v[:, 9 - j],
                "sign, motor 6": np.clip(both / SIGN_SPEED, -1, 1),
            }
        row["offset"] = np.ones(len(q))
    return tuple(rows)


def joint_columns(states, joint: int, friction: bool = True) -> np.ndarray:
    """The `joint_terms` of one joint (0 to 5) as a matrix, ``(cases, factors)``."""
    flag("friction", friction)
    row = joint_terms(states)[integer("joint", joint, 0, _JOINTS - 1)]
    columns = [x for name, x in row.items() if friction or name not in _FRICTION]
    return np.stack(columns, -1)


def _angles(q) -> dict[str, tuple]:
    """Angles that the inertia about axis 1 depends on, and what multiplies ``q2', q3'`` in each."""
    return {
        "2 q2": (2 * q[:, 1], 2, 0),
        "2 q2 + q3": (2 * q[:, 1] + q[:, 2], 2, 1),
        "q3": (q[:, 2], 0, 1),
        "2 q2 + 2 q3": (2 * (q[:, 1] + q[:, 2]), 2, 2),
    }


def _vertical(q, v, a) -> dict:
    """Joint 1: ``d/dt (b(q) q1') = b q1'' + b' q1'`` for each part b of its inertia."""
    row = {"q1''": a[:, 0]}
    for name, (angle, second, third) in _angles(q).items():
        rate = second * v[:, 1] + third * v[:, 2]
        c, s = np.cos(angle), np.sin(angle)
        row[f"cos({name}) q1''"] = c * a[:, 0] - s * rate * v[:, 0]
        row[f"sin({name}) q1''"] = s * a[:, 0] + c * rate * v[:, 0]
    return row


def _pair(q, v, a) -> tuple[dict, dict]:
    c3, s3, both = np.cos(q[:, 2]), np.sin(q[:, 2]), q[:, 1] + q[:, 2]
    turned = 2 * a[:, 1] + a[:, 2]
    mixed = 2 * v[:, 1] * v[:, 2] + v[:, 2] ** 2
    second = {
        "q2''": a[:, 1],
        "q3''": a[:, 2],
        "cos(q3)": c3 * turned - s3 * mixed,
        "sin(q3)": s3 * turned + c3 * mixed,
        "cos(q2)": np.cos(q[:, 1]),
        "sin(q2)": np.sin(q[:, 1]),
        "cos(q2 + q3)": np.cos(both),
        "sin(q2 + q3)": np.sin(both),
    }
    third = {
        "q3''": a[:, 2],
        "q2''": a[:, 1],
        "cos(q3)": c3 * a[:, 1] + s3 * v[:, 1] ** 2,
        "sin(q3)": s3 * a[:, 1] - c3 * v[:, 1] ** 2,
        "cos(q2 + q3)": np.cos(both),
        "sin(q2 + q3)": np.sin(both),
    }
    for name, (angle, *factors) in _angles(q).items():
        for row, factor in zip((second, third), factors):
            if factor:
                row[f"cos({name}) q1'²"] = np.cos(angle) * v[:, 0] ** 2
                row[f"sin({name}) q1'²"] = np.sin(angle) * v[:, 0] ** 2
    return second, third


def _wrist(q, a) -> tuple[dict, dict, dict]:
    both = q[:, 1] + q[:, 2]
    c4, s4, c5, s5 = np.cos(q[:, 3]), np.sin(q[:, 3]), np.cos(q[:, 4]), np.sin(q[:, 4])
    slopes = {"cos(q2 + q3)": np.cos(both), "sin(q2 + q3)": np.sin(both)}
    fourth = {"q4''": a[:, 3], "cos(q5) q6''": c5 * a[:, 5]}
    fifth = {"q5''": a[:, 4], "q6''": a[:, 5], "cos(q4) (q2'' + q3'')": c4 * (a[:, 1] + a[:, 2])}
    sixth = {"q6''": a[:, 5], "q5''": a[:, 4], "cos(q5) q4''": c5 * a[:, 3]}
    for name, slope in slopes.items():
        fourth |= {f"{name} q1''": slope * a[:, 0], f"{name} sin(q4) sin(q5)": slope * s4 * s5}
        fifth |= {f"{name} cos(q4) cos(q5)": slope * c4 * c5, f"{name} sin(q5)": slope * s5}
    return fourth, fifth, sixth
