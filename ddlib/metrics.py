"""The paper's error measure, with its denominator named."""

from __future__ import annotations

import numpy as np

from ddlib._check import finite_array, flag, told


def rmss(predicted, target, *, scale=None, pooled: bool = True) -> np.ndarray:
    """Root mean square error divided by a standard deviation (section 4).

    Parameters
    ----------
    predicted, target : array_like, shape (..., cases, joint)
        Torques in the same unit.
    scale : array_like, shape (joint,), optional
        Standard deviation to divide by; default: that of `target` itself over its cases.
        The paper does not say which data set's it used for the test trajectory.
    pooled : bool
        Whether to join the joints, by the root of their mean squared RMSS, or give each its own.
    """
    flag("pooled", pooled)
    predicted, target = finite_array("predicted", predicted), finite_array("target", target)
    if target.ndim < 2 or not target.shape[-2] or predicted.shape[-2:] != target.shape[-2:]:
        raise ValueError(
            "predicted and target must both have shape (..., cases, joint), "
            f"got {predicted.shape} and {target.shape}"
        )
    scale = target.std(-2) if scale is None else finite_array("scale", scale, target.shape[-1])
    if (scale == 0).any() and (target.std(-2) == 0).any():
        raise ValueError(
            f"target must change at each joint, got standard deviations {told(target.std(-2))}: of "
            "a run at rest give scale, like the deviation of the training torques"
        )
    if (scale <= 0).any():
        raise ValueError(f"scale must be positive for each joint, got {told(scale)}")
    mean_square = ((predicted - target) ** 2).mean(-2) / scale**2
    return np.sqrt(mean_square.mean(-1) if pooled else mean_square)
