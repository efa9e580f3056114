"""What several measures look at: the recordings, and the networks trained on them."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np

from ddlib.learning import TorqueModel, Weights
from ddlib.setups import SETUPS, STATE_FEEDBACK, split
from ddlib.simulation import Recording
from workshop.report import results


@cache
def recording(setup: str = STATE_FEEDBACK.name) -> Recording:
    """The six runs of Appendix I under a reading of the controller, one of `SETUPS`."""
    return SETUPS[setup].record()


@cache
def training(setup: str = STATE_FEEDBACK.name) -> Recording:
    """Runs 1 to 5 of `recording`."""
    return split(recording(setup))[0]


@cache
def networks(width: int, setup: str = STATE_FEEDBACK.name) -> TorqueModel:
    """The networks of one window size trained on them, from ``book/results``."""
    return results.networks(width, setup)


@cache
def _untrained(width: int, setup: str = STATE_FEEDBACK.name) -> TorqueModel:
    """The same networks before training: their initial weights, their scaling."""
    trained = networks(width, setup)
    start = Weights.random(len(trained.weights), width, initial=SETUPS[setup].initial)
    return TorqueModel(start, trained.inputs, trained.outputs)


def both(of: Callable) -> list:
    """What a function makes of the trained networks, and of the same before training."""
    return [of(models) for models in (networks, _untrained)]


def filters_of_layer(width: int, layer: str, setup: str = STATE_FEEDBACK.name) -> list[np.ndarray]:
    """Weights along the window of all units, shape ``(networks, filters, width)``; as in `both`."""
    every = both(lambda models: getattr(models(width, setup).weights, f"{layer}_weights"))
    return [weights.reshape(len(weights), -1, width) for weights in every]
