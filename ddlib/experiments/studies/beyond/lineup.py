"""Who takes part in the study of rivals, at which sizes; a new rival is a line here."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from ddlib.experiments.setups import INITIAL, JOINT_DAMPING, STATE_FEEDBACK
from ddlib.identification import FRICTION, RIGID
from ddlib.rivals import (
    ByAdam,
    ByDescent,
    BySolver,
    Convolution,
    Identified,
    Linear,
    Recurrent,
    Rival,
)

DAYS = 5
"""Recordings of a rival; a rival that starts at random starts otherwise on each."""


class Line(NamedTuple):
    """A rival at several sizes.

    Attributes
    ----------
    make : callable
        ``make(size, seed)`` gives a `Rival` that has learnt nothing.
    sizes : tuple
        What is varied, from small to large.
    varied : str
        What that is, in words.
    shown : object
        The size that tables and the widget show.
    family : str
        What it belongs to: tables, bases, known structure, kernels, networks.
    year : int
        Of the source that proposes it for torques, or of the method.
    days : int
        On how many recordings it is tried.
    """

    make: Callable[[object, int], Rival]
    sizes: tuple
    varied: str
    shown: object
    family: str
    year: int
    days: int = DAYS


def _descent(hidden, seed, **options):
    """As `STATE_FEEDBACK` is trained: the book's reading of 1988."""
    here = STATE_FEEDBACK
    options = {"epochs": here.epochs, "rate": here.rate / 21, **options}
    return ByDescent(
        hidden, momentum=here.momentum, warm_up=here.warm_up, initial=INITIAL, seed=seed, **options
    )


def _solver(hidden, seed, **options):
    """As `JOINT_DAMPING` is trained: what reaches Table 4-1."""
    here = JOINT_DAMPING
    options = {"steps": here.steps, "decay": here.decay, **options}
    return BySolver(hidden, initial=INITIAL, seed=seed, **options)


def _identified(count, _seed):
    return Identified((RIGID + FRICTION)[:3] if count == 3 else RIGID + FRICTION)


LINES: dict[str, Line] = {
    # known structure
    "identified equations": Line(_identified, (3, 7), "parameters", 7, "known structure", 1986),
    "linear filter": Line(
        lambda width, _: Linear(width=width), (5, 11, 21), "samples", 21, "networks", 1960
    ),
    # networks
    "network of 1988": Line(_descent, (2, 10), "hidden units", 10, "networks", 1988),
    "its optimum": Line(_solver, (1, 2, 5, 10, 20), "hidden units", 10, "networks", 1994),
    "Adam": Line(
        lambda hidden, seed: ByAdam(hidden, seed=seed), (2, 10, 20), "hidden units", 10,
        "networks", 2019,
    ),
    "network on states": Line(
        lambda hidden, seed: _solver(hidden, seed, kind="states"), (2, 5, 10), "hidden units", 10,
        "networks", 1988,
    ),
    "convolutions": Line(
        lambda channels, seed: Convolution(channels, seed=seed), (4, 8, 16), "channels", 8,
        "networks", 1989,
    ),
    "recurrent": Line(
        lambda channels, seed: Recurrent(channels, seed=seed), (8, 16), "units", 16,
        "networks", 2014,
    ),
}  # fmt: skip
"""All rivals by the name that tables and figures use."""
