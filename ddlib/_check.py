"""Argument checks: every error names the argument, its value and its range."""

from __future__ import annotations

import numpy as np


def finite_array(name: str, value, last: int | None = None) -> np.ndarray:
    """`value` as a float array; TypeError or ValueError otherwise.

    Refused are what is no real number, NaN and infinity, and a last axis that is not `last` long.
    """
    try:
        given = np.asarray(value)
        kind = given.dtype.kind
        if kind not in "biufO" or (kind == "O" and (given == None).any()):  # noqa: E711
            raise TypeError(f"numbers of kind {given.dtype}")
        array = given.astype(float)
    except (TypeError, ValueError) as error:
        raise TypeError(f"{name} must be an array of real numbers, got {value!r}") from error
    if last is not None and (array.ndim == 0 or array.shape[-1] != last):
        raise ValueError(f"{name} must have a last axis of length {last}, got shape {array.shape}")
    if not np.isfinite(array).all():
        raise ValueError(f"{name} must be finite, got NaN or infinity")
    return array


def shaped(name: str, value, shape: tuple | str) -> np.ndarray:
    """`value` as a finite array of a shape, like (3, 2) or "(..., time, 2)"; ValueError otherwise.

    In text an axis that is a word has any length, and dots at the front are any number of axes.
    """
    array = finite_array(name, value)
    axes = list(shape)
    if isinstance(shape, str):
        axes = [axis.strip() for axis in shape.strip("()").split(",") if axis.strip()]
    lengths = list(array.shape)
    if axes[:1] == ["..."]:
        axes = axes[1:]
        lengths = lengths[max(len(lengths) - len(axes), 0) :]
    fits = (str(axis) == str(n) or str(axis).isidentifier() for axis, n in zip(axes, lengths))
    if len(axes) != len(lengths) or not all(fits):
        raise ValueError(f"{name} must have shape {shape}, got {array.shape}")
    return array


def number(name: str, value, low=-np.inf, high=np.inf, *, open_low=False) -> float:
    """`value` as a float within `low` to `high` (`open_low` excludes `low` itself)."""
    if isinstance(value, bool) or np.ndim(value) != 0:
        raise TypeError(f"{name} must be a single number, got {value!r}")
    x = float(finite_array(name, value))
    if x < low or x > high or (open_low and x == low):
        bracket = "(" if open_low else "["
        raise ValueError(f"{name} must lie in {bracket}{low:g}, {high:g}], got {x:g}")
    return x


def non_negative(name: str, value, last: int | None = None) -> np.ndarray:
    """`value` as a finite array without negative entries, otherwise a ValueError."""
    array = finite_array(name, value, last)
    if (array < 0).any():
        raise ValueError(f"{name} must not be negative, got {array.min():g}")
    return array


def positive(name: str, value, shape: tuple | str = "(..., 2)") -> np.ndarray:
    """`value` as a finite array of numbers above 0, of a shape as in `shaped`."""
    array = shaped(name, value, shape)
    if (array <= 0).any():
        raise ValueError(f"{name} must be positive, got {value}")
    return array


def integer(name: str, value, low: int, high: int | None = None) -> int:
    """`value` as an int within `low` to `high`; TypeError or ValueError otherwise."""
    if isinstance(value, bool) or not isinstance(value, (int, np.integer)):
        raise TypeError(f"{name} must be an integer, got {value!r}")
    if value < low or (high is not None and value > high):
        upper = "and up" if high is None else f"to {high}"
        raise ValueError(f"{name} must be an integer from {low} {upper}, got {value}")
    return int(value)


def one_of(name: str, value, known) -> str:
    """`value` if it is among `known`, otherwise a ValueError that lists them."""
    if value not in known:
        raise ValueError(f"{name} must be one of {', '.join(map(repr, known))}, got {value!r}")
    return value
