"""Sliding windows of positions, and scaling to the range of a sigmoid unit (section 3)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ddlib._check import filled, finite_array, integer, number, pair, shaped, told, varies


def check_width(width) -> int:
    """`width` as an odd number of samples, 3 or more; TypeError or ValueError otherwise."""
    width = integer("width", width, 3)
    if width % 2 == 0:
        raise ValueError(f"width must be odd, so that a window has a centre, got {width}")
    return width


def sliding_windows(q, width: int, cases: slice | None = None) -> np.ndarray:
    """The window of positions around each sample, ``(..., cases, joint, width)``, oldest first.

    Parameters
    ----------
    q : array_like, shape (..., time, joint)
        Positions at equal steps.
    width : int
        Window size w in samples: odd, ``(w - 1) / 2`` on either side of the centre
        (section 4: "a window of size 11 ... 5 time steps before and 5 time steps after").
    cases : slice, optional
        Samples to centre a window on; default: all that have a whole window.
    """
    q = shaped("q", q, "(..., time, joint)")
    width, time = check_width(width), q.shape[-2]
    if width > time:
        raise ValueError(f"width must not exceed the {time} samples of the recording, got {width}")
    if not isinstance(cases, slice | None):
        raise TypeError(f"cases must be a slice, got {told(cases)}")
    half = width // 2
    start, stop, step = (cases or slice(half, time - half)).indices(time)
    if step == 1 and 0 <= start < stop <= time and min(start, time - stop) < half:
        raise ValueError(
            f"width must be at most {2 * min(start, time - stop) + 1}, as the recording has "
            f"{min(start, time - stop)} samples beside its motion, got {width}: record a longer "
            "rest, or take a smaller window"
        )
    if step != 1 or start - half < 0 or stop + half > time or start >= stop:
        raise ValueError(
            f"cases must be consecutive samples from {half} to {time - half} for width {width}, "
            f"got {told(cases)}"
        )
    whole = np.lib.stride_tricks.sliding_window_view(q, width, axis=-2)
    return whole[..., start - half : stop - half, :, :]


@dataclass(frozen=True)
class Scaler:
    """An affine map of each joint's data range, `low` to `high`, to `target` and back."""

    low: np.ndarray
    high: np.ndarray
    target: tuple[float, float] = (0.0, 1.0)

    def __post_init__(self):
        pair("target", self.target)
        low, high = finite_array("low", self.low), finite_array("high", self.high)
        if low.shape != high.shape or not (high > low).all():
            raise ValueError(
                f"high must exceed low for each joint, got low={told(low)}, high={told(high)}"
            )
        first, last = (number("target", x) for x in self.target)
        if not last > first:
            raise ValueError(f"target must be an increasing pair, got {self.target}")
        object.__setattr__(self, "low", low)
        object.__setattr__(self, "high", high)

    @classmethod
    def fit(cls, data, target=(0.0, 1.0), joint_axis: int = -1) -> Scaler:
        """The scaler that maps the range of `data` per joint to `target`."""
        pair("target", target)
        integer("joint_axis", joint_axis, -10, 10)
        filled("data", data)
        data = np.moveaxis(finite_array("data", data), joint_axis, -1)
        data = data.reshape(-1, data.shape[-1])
        varies("data", data, "without a range it has no scale")
        return cls(data.min(0), data.max(0), tuple(target))

    @property
    def gain(self) -> np.ndarray:
        """Scaled units per unit of data, shape (joint,)."""
        return (self.target[1] - self.target[0]) / (self.high - self.low)

    def scale(self, data, joint_axis: int = -1) -> np.ndarray:
        """`data` in scaled units; `joint_axis` says where the joints are."""
        data, low, gain = self._along(data, joint_axis)
        return self.target[0] + (data - low) * gain

    def unscale(self, data, joint_axis: int = -1) -> np.ndarray:
        """Scaled `data` back in its own unit."""
        data, low, gain = self._along(data, joint_axis)
        return low + (data - self.target[0]) / gain

    def _along(self, data, axis):
        """Checked data, and `low` and `gain` in a shape that fits them."""
        integer("joint_axis", axis, -10, 10)
        data, shape = finite_array("data", data), [1] * np.ndim(data)
        if not -data.ndim <= axis < data.ndim or data.shape[axis] != self.low.size:
            raise ValueError(
                f"data must have {self.low.size} joints along axis {axis}, got {data.shape}"
            )
        shape[axis] = -1
        return data, self.low.reshape(shape), self.gain.reshape(shape)
