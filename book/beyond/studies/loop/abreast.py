"""Many controllers in one batch, guarded: where the hand went, who was stopped, what was learnt.

The studies of adaptive control, of learners in the loop and of their conditions run by it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from beyond.control.adaptive import Watched
from beyond.control.guarded import Guarded, Stops
from beyond.control.online import Abreast
from ddlib.control import ControlLaw, Controller
from ddlib.dynamics import Arm, end_point_error
from ddlib.effects import Delay, Effects
from ddlib.simulation import Recording, follow
from ddlib.trajectories import Trajectory


class Batch(NamedTuple):
    """What became of a batch; arrays have the shape of its runs first."""

    log: Recording
    gap: np.ndarray  # of the hand from where it should be, m, (..., time)
    stops: Stops
    laws: list[ControlLaw]  # of each controller, after the run


def run_abreast(
    arm: Arm, controllers: Sequence[Controller], rows: Sequence[int], reference, t, **options
) -> Batch:
    """Follow a reference, whose first axis the controllers share: so many rows for each.

    Options are those of `ddlib.simulation.follow`.
    """
    watched = Watched(Guarded(Abreast(controllers, rows)))
    log = follow(arm, watched, reference, t, **options)
    gap = np.linalg.norm(end_point_error(arm, log.reference.q, log.q_true), axis=-1)
    return Batch(log, gap, watched.law.stops, watched.law.inner.laws)


def repeated(reference: Trajectory, count: int) -> Trajectory:
    """A reference several times, along a new first axis."""
    return Trajectory(*(np.broadcast_to(x, (count, *x.shape)) for x in reference))


def delayed(effects: Effects, periods: int) -> Effects:
    """Effects with torques that come so many control periods late."""
    return replace(effects, actuator=(*effects.actuator, Delay(periods)))
