"""A model of windows as the box "inverse arm" of Figure 2-1: it sees the desired motion.

The log has a sample every 10 ms and the controller runs every 2 ms, so a model that was trained on
the log must be told what to do between its samples.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ddlib._check import integer, one_of, shaped

BETWEEN = ("window", "line", "hold")
"""What happens between two samples of the log: a window of its own around each control sample, a
straight line from torque to torque, or the last torque is held."""


@dataclass(frozen=True)
class WindowFeedforward:
    """Torques of a reference by a model of windows; for `ddlib.control.Feedforward`.

    Parameters
    ----------
    model : callable
        ``model(windows) -> torque`` over windows ``(cases, joint, width)``, rad, oldest sample
        first; torques ``(cases, joint)``, N m.
    width : int
        Window size, odd.
    every : int
        Control periods between two samples of a window: 5 for 10 ms and 2 ms.
    between : {"window", "line", "hold"}
        As in `BETWEEN`.

    Notes
    -----
    Before its first and after its last sample the reference is taken to rest.
    """

    model: Callable
    width: int
    every: int = 5
    between: str = "window"

    def __post_init__(self):
        if integer("width", self.width, 3) % 2 == 0:
            raise ValueError(f"width must be odd, so that a window has a centre, got {self.width}")
        integer("every", self.every, 1)
        one_of("between", self.between, BETWEEN)

    def __call__(self, q, qd, qdd) -> np.ndarray:
        """Torque for every control sample of a reference.

        Parameters
        ----------
        q : array_like, shape (..., time, joint)
            Desired positions, rad.
        qd, qdd : array_like
            Not used: a window of positions is all that the model sees.

        Returns
        -------
        ndarray, shape (..., time, joint)
        """
        q = shaped("q", q, "(..., time, joint)")
        time, half = q.shape[-2], self.width // 2
        stride = 1 if self.between == "window" else self.every
        centres = np.arange(0, time + (stride - 1), stride)
        taps = centres[:, None] + self.every * np.arange(-half, half + 1)
        windows = np.moveaxis(q[..., np.clip(taps, 0, time - 1), :], -1, -2)
        cases = windows.reshape(-1, *windows.shape[-2:])
        torque = shaped("model(windows)", self.model(cases), f"({len(cases)}, {q.shape[-1]})")
        torque = torque.reshape(*q.shape[:-2], len(centres), q.shape[-1])
        if stride == 1:
            return torque
        now = np.arange(time)
        before = torque[..., now // stride, :]
        if self.between == "hold":
            return before
        share = (now % stride / stride)[:, None]
        after = torque[..., np.minimum(now // stride + 1, len(centres) - 1), :]
        return before + share * (after - before)
