"""What several measures look at: the recordings, and the networks trained on them."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np

from ddlib import results
from ddlib.experiment import STATE_FEEDBACK, split
from ddlib.network import TorqueModel, Weights
from ddlib.simulate import Recording


@cache
def recording() -> Recording:
    """The six runs of Appendix I under state feedback."""
    return STATE_FEEDBACK.record()


@cache
def training() -> Recording:
    """Runs 1 to 5 of `recording`."""
    return split(recording())[0]


@cache
def networks(width: int) -> TorqueModel:
    """The networks of one window size trained on them, from ``book/results``."""
    return results.networks(width)


@cache
def untrained(width: int) -> TorqueModel:
    """The same networks before training: their initial weights, their scaling.

    The null of what training is said to make. It is not a fair null of smooth filters, which
    any smooth target gives.
    """
    trained = networks(width)
    start = Weights.random(len(trained.weights), width, initial=STATE_FEEDBACK.initial)
    return TorqueModel(start, trained.inputs, trained.outputs)


def filters(width: int, layer: str, model: Callable = networks) -> np.ndarray:
    """Weights along the window of all units, shape ``(networks, filters, width)``.

    Parameters
    ----------
    width : int
        Window size.
    layer : {"hidden", "skip"}
        To the hidden units, or directly to the outputs.
    model : callable
        `networks` or `untrained`.
    """
    weights = getattr(model(width).weights, f"{layer}_weights")
    return weights.reshape(len(weights), -1, width)
