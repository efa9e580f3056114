"""Least squares one sample at a time: what a controller can afford while it runs."""

from __future__ import annotations

import numpy as np

from ddlib._check import number, shaped


class RecursiveLeastSquares:
    """Estimates of ``target = weights @ features``, sample by sample.

    After every sample they are what batch least squares would give for all samples so far, with a
    `penalty` (above 0) on the distance from the first guess (Ljung 1999, section 11.2). `weights`
    are ``(..., outputs, features)``; leading axes are runs, each with an estimate of its own. A
    sample that is n steps old counts ``forgetting ** n``; features that are not excited are
    forgotten all the same: the estimate's uncertainty then grows without bound.
    """

    def __init__(self, weights, penalty: float = 1e-3, forgetting: float = 1.0):
        self.weights = shaped("weights", weights, "(..., outputs, features)").copy()
        number("penalty", penalty, 0.0, open_low=True)
        self.forgetting = number("forgetting", forgetting, 0.0, 1.0, open_low=True)
        *runs, _, features = self.weights.shape
        self.covariance = np.broadcast_to(np.eye(features) / penalty, (*runs, features, features))

    def update(self, features, target) -> np.ndarray:
        """Learn from one sample; what the estimate before it would have said, (..., outputs)."""
        *runs, outputs, count = self.weights.shape
        features = shaped("features", features, (*runs, count))
        target = shaped("target", target, (*runs, outputs))
        seen = (self.covariance @ features[..., None])[..., 0]
        weight = self.forgetting + (features * seen).sum(-1, keepdims=True)
        gain = seen / weight
        predicted = (self.weights @ features[..., None])[..., 0]
        missed = (target - predicted)[..., None]
        self.weights = self.weights + missed * gain[..., None, :]
        reduced = (self.covariance - gain[..., None] * seen[..., None, :]) / self.forgetting
        self.covariance = (reduced + np.swapaxes(reduced, -1, -2)) / 2
        return predicted
