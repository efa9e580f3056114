"""What inverse dynamics cost: operations counted by running each formulation."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import cache
from typing import NamedTuple

import numpy as np

from ddlib._check import flag, function_of, instance, one_of, series
from ddlib.dynamics.arm import Link
from ddlib.dynamics.counting import Operations, Tape
from ddlib.dynamics.derivation import derive
from ddlib.dynamics.formulations import lagrange_euler, newton_euler, recursive_lagrange
from ddlib.dynamics.serial import PUMA_560, SerialArm

# What may be known off-line: nothing at all; the zeros of the method (the base at rest, the axis
# of a joint in its own frame); or also every constant of one arm.
KNOWLEDGE = ("nothing", "zeros", "arm")


class PublishedCount(NamedTuple):
    """A count in the literature, as polynomials in the number of joints, highest power first."""

    multiplications: tuple[float, ...]
    additions: tuple[float, ...]
    six_joints: Operations
    source: str


# For arms of `n` general revolute joints. The first polynomial for multiplications gives 67,143 for
# six joints where the same table prints 66,271; the others agree.
PUBLISHED = {
    "Lagrange-Euler": PublishedCount(
        (32 + 1 / 2, 86 + 5 / 12, 171 + 1 / 4, 53 + 1 / 3, -128),
        (25, 66 + 1 / 3, 129 + 1 / 2, 42 + 1 / 3, -96),
        Operations(66271, 51548),
        "Hollerbach 1980, read in Corke 2002, Table 1",
    ),
    "Newton-Euler": PublishedCount(
        (150, -48), (131, -48), Operations(852, 738), "Hollerbach 1980, read in Corke 2002, Table 1"
    ),
}
# Newton-Euler after symbolic simplification by the program ARM (Corke 2002, Table 1)
PUBLISHED_CUSTOMISED = Operations(224, 174)


@cache
def count_operations(
    formulation: Callable, arm: SerialArm, knowledge: str = "nothing"
) -> Operations:
    """Operations of one evaluation of an arm's torques, by `newton_euler` or another formulation.

    `knowledge` says what is known off-line: "nothing", the "zeros" of the method, or also the
    constants of the "arm"; then the formula is customised: nothing is computed twice or in vain.
    """
    function_of("formulation", formulation, "like newton_euler")
    instance("arm", arm, SerialArm)
    one_of("knowledge", knowledge, KNOWLEDGE)
    tape = Tape()
    state = [[tape.unknown(x) for x in row] for row in _state(arm.joints)]
    constant = tape.known if knowledge == "arm" else tape.unknown
    number = tape.unknown if knowledge == "nothing" else tape.known
    torques = formulation(arm.constants(constant), *state, number(0.0), number(1.0))
    return tape.needed(torques) if knowledge == "arm" else tape.executed


def count_closed_form(
    links: Iterable[Link], shared: bool, velocity_terms: bool = True
) -> Operations:
    """Operations of the closed form of a planar arm, its base parameters known.

    `shared` subexpressions are computed once; velocity terms may be left out (Bejczy 1974).
    """
    flag("shared", shared)
    flag("velocity_terms", velocity_terms)
    links = series("links", links, Link)
    derivation = derive(len(links))
    tape = Tape()
    q, qd, qdd = ([tape.unknown(x) for x in row] for row in _state(len(links)))
    if not velocity_terms:
        qd = [tape.known(0.0)] * len(links)
    base = [tape.known(x) for x in derivation.base_values(links)]
    torques = (derivation.function if shared else derivation.printed_function)(*q, *qd, *qdd, *base)
    return tape.needed(torques) if shared else tape.executed


def operations_table(joints: Iterable[int], link: Link) -> dict[str, dict[int, Operations]]:
    """Operations ``{formulation: {joints: ...}}`` of planar arms and of the `PUMA_560`."""
    joints = series("joints", joints, int, np.integer)
    instance("link", link, Link)

    def planar(n):
        return SerialArm.planar([link] * n)

    puma = PUMA_560.first
    ways = {
        "Lagrange-Euler, general": lambda n: count_operations(lagrange_euler, puma(n)),
        "recursive Lagrange, general": lambda n: count_operations(recursive_lagrange, puma(n)),
        "Newton-Euler, general": lambda n: count_operations(newton_euler, puma(n)),
        "Newton-Euler, zeros skipped": lambda n: count_operations(newton_euler, puma(n), "zeros"),
        "Newton-Euler, customised": lambda n: count_operations(newton_euler, puma(n), "arm"),
        "closed form, planar, as printed": lambda n: count_closed_form([link] * n, False),
        "closed form, planar, shared": lambda n: count_closed_form([link] * n, True),
        "Newton-Euler, planar, customised": lambda n: count_operations(
            newton_euler, planar(n), "arm"
        ),
    }
    return {name: {n: way(n) for n in joints} for name, way in ways.items()}


def _state(joints: int) -> np.ndarray:
    """Angles, velocities and accelerations of no special kind: no zeros, no equals."""
    return np.random.default_rng(0).uniform(0.1, 1.0, (3, joints))
