"""What several measures look at: the recordings, and the networks trained on them."""

from __future__ import annotations

from functools import cache

import numpy as np

from ddlib import results
from ddlib.experiment import STATE_FEEDBACK, split
from ddlib.network import TorqueModel
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


def filters(width: int, layer: str) -> np.ndarray:
    """Weights along the window of all their units, shape ``(filters, width)``.

    Parameters
    ----------
    width : int
        Window size.
    layer : {"hidden", "skip"}
        To the hidden units, or directly to the outputs.
    """
    return getattr(networks(width).weights, f"{layer}_weights").reshape(-1, width)
