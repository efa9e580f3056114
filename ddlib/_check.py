"""Argument checks: every error names the argument, its value and its range, on one line."""

from __future__ import annotations

import difflib
import numbers
from collections.abc import Mapping

import numpy as np

_MOST = 10**9  # largest integer where no range is given
_LONGEST = 80  # letters of a value in a message


def told(value) -> str:
    """A value as a message shows it: on one line and short; of a large array its shape."""
    if isinstance(value, np.ndarray) and value.size > 8:
        return f"an array of shape {value.shape}"
    if isinstance(value, (list, tuple)) and len(value) > 40:
        return f"a {type(value).__name__} of {len(value)} items"
    try:
        text = " ".join(repr(value).split())
    except Exception:  # an object whose repr fails is named by its kind
        text = f"a {type(value).__name__}"
    return text if len(text) <= _LONGEST else f"{text[: _LONGEST - 4]} ..."


def finite_array(name: str, value, last: int | None = None) -> np.ndarray:
    """`value` as a float array; TypeError or ValueError otherwise.

    Refused are what is no real number, booleans and texts among them, NaN and infinity, masked
    entries, and a last axis that is not `last` long.
    """
    unmasked(name, value)
    array = None
    try:
        given = np.asarray(value)
        items = given.ravel() if given.dtype.kind == "O" else ()
        if given.dtype.kind in "iufO" and all(map(_is_real, items)):
            array = given.astype(float)
    except (TypeError, ValueError, OverflowError, RuntimeError):
        pass
    if array is None or array.shape != given.shape:
        raise TypeError(f"{name} must be an array of real numbers, got {told(value)}")
    if last is not None and (array.ndim == 0 or array.shape[-1] != last):
        raise ValueError(f"{name} must have a last axis of length {last}, got shape {array.shape}")
    if not np.isfinite(array).all():
        raise ValueError(f"{name} must be finite, got NaN or infinity")
    return array


def unmasked(name: str, value) -> None:
    """Refuse an array with masked entries: arithmetic would take what is under the mask."""
    masked = np.count_nonzero(np.ma.getmask(value))
    if masked:
        raise ValueError(
            f"{name} must have no masked entries, got {masked}: leave them out, or fill them in"
        )


def _is_real(x) -> bool:
    """Whether an item of an array of objects is a real number, and neither None nor a text."""
    return isinstance(x, numbers.Real) and not isinstance(x, (bool, np.bool_))


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


def filled(name: str, value) -> None:
    """Refuse an array without entries."""
    if finite_array(name, value).size == 0:
        raise ValueError(f"{name} must not be empty, got shape {np.shape(value)}")


def number(name: str, value, low=-np.inf, high=np.inf, *, open_low=False) -> float:
    """`value` as a float within `low` to `high` (`open_low` excludes `low` itself)."""
    try:
        single = np.ndim(value) == 0 and not isinstance(value, (bool, np.bool_))
    except (TypeError, ValueError):  # lists of unequal lengths
        single = False
    if single:
        try:
            x = float(finite_array(name, value))
        except TypeError:
            single = False
    if not single:
        raise TypeError(f"{name} must be a single number, got {told(value)}")
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
        raise ValueError(f"{name} must be positive, got {told(value)}")
    return array


def integer(name: str, value, low: int, high: int | None = None) -> int:
    """`value` as an int within `low` to `high`; TypeError or ValueError otherwise."""
    if isinstance(value, bool) or not isinstance(value, (int, np.integer)):
        raise TypeError(f"{name} must be an integer, got {told(value)}")
    if value < low or (high is not None and value > high):
        upper = "and up" if high is None else f"to {high}"
        raise ValueError(f"{name} must be an integer from {low} {upper}, got {told(value)}")
    if high is None and value > _MOST:
        raise ValueError(f"{name} must be an integer up to {_MOST}, got {told(value)}")
    return int(value)


def seed_number(name: str, value) -> int:
    """`value` as a seed of a random generator: any integer from 0 and up."""
    return integer(name, value, 0, 2**256)


def flag(name: str, value) -> bool:
    """`value` if it is True or False, otherwise a TypeError: a text like "no" would mean yes."""
    if not isinstance(value, (bool, np.bool_)):
        raise TypeError(f"{name} must be True or False, got {told(value)}")
    return bool(value)


def one_of(name: str, value, known) -> str:
    """`value` if it is among `known`, otherwise a ValueError that lists them."""
    if not any(value is item or (np.ndim(item) == 0 and _same(value, item)) for item in known):
        texts = [item for item in known if isinstance(item, str)]
        near = difflib.get_close_matches(value, texts, 1) if isinstance(value, str) else ()
        meant = f"; did you mean {near[0]!r}?" if near else ""
        raise ValueError(f"{name} must be one of {_listed(known)}, got {told(value)}{meant}")
    return value


def _same(value, item) -> bool:
    """Whether two things are equal, of which one may be an array."""
    same = value == item
    return isinstance(same, (bool, np.bool_)) and bool(same)


def _listed(known) -> str:
    """The first of what is known, as far as a message has room."""
    names = list(map(repr, known))
    while sum(map(len, names)) + 2 * len(names) > 180:
        names = [*names[: len(names) // 2], "..."]
    return ", ".join(names)


def instance(name: str, value, *kinds: type) -> None:
    """Refuse what is of none of these classes."""
    if not isinstance(value, kinds):
        names = " or ".join(kind.__name__ for kind in kinds)
        raise TypeError(f"{name} must be of class {names}, got {told(value)}")


def series(name: str, values, *kinds: type) -> list:
    """`values` as a list; TypeError if they are no series, or one is of none of these classes."""
    if isinstance(values, (str, Mapping)) or not hasattr(values, "__iter__"):
        raise TypeError(f"{name} must be a series, got {told(values)}")
    items = list(values)
    for item in items if kinds else ():
        instance(name, item, *kinds)
    return items


def function_of(name: str, value, signature: str) -> None:
    """Refuse what cannot be called; `signature` says how it will be."""
    if not callable(value):
        raise TypeError(f"{name} must be a function {signature}, got {told(value)}")


def text(name: str, value) -> None:
    """Refuse what is no text."""
    if not isinstance(value, str):
        raise TypeError(f"{name} must be a text, got {told(value)}")


def texts(name: str, value, count: int) -> None:
    """Refuse what are not so many texts."""
    fits = isinstance(value, (tuple, list)) and len(value) == count
    if not fits or not all(isinstance(item, str) for item in value):
        raise TypeError(f"{name} must be {count} texts, got {told(value)}")


def mapping(name: str, value) -> None:
    """Refuse what is no mapping, or an empty one."""
    if not isinstance(value, Mapping):
        raise TypeError(f"{name} must be a mapping of names, got {told(value)}")
    if not value:
        raise ValueError(f"{name} must hold one item or more, got none")


def pair(name: str, value, low=-np.inf, high=np.inf) -> None:
    """Refuse what is no increasing pair of numbers within `low` to `high`."""
    array = finite_array(name, value)
    if array.shape != (2,):
        raise ValueError(f"{name} must be a pair of numbers, got {told(value)}")
    if not low <= array[0] < array[1] <= high:
        where = "" if np.isinf(low) else f" within {low:g} to {high:g}"
        raise ValueError(f"{name} must be an increasing pair{where}, got {told(value)}")


def triple(name: str, value) -> list[np.ndarray]:
    """Positions, velocities and accelerations of a `Trajectory`, refused unless of one shape."""
    if not isinstance(value, (tuple, list)) or len(value) != 3:
        raise TypeError(
            f"{name} must be a Trajectory of positions, velocities and accelerations, as "
            f"pick_and_place(extents_deg, t) returns it, got {told(value)}"
        )
    arrays = [finite_array(f"{name}.{part}", x, 2) for part, x in zip(("q", "qd", "qdd"), value)]
    shapes = [array.shape for array in arrays]
    if len(set(shapes)) > 1:
        raise ValueError(f"{name} must have q, qd and qdd of one shape, got {told(shapes)}")
    return arrays


def cases_of(name: str, value) -> None:
    """Refuse what is neither None nor a pair of windows and targets that vary in each column."""
    if value is None:
        return
    if not isinstance(value, (tuple, list)) or len(value) != 2:
        raise TypeError(
            f"{name} must be a pair of windows and targets, as data.transform(*cases(recording, "
            f"width)) makes it, got {told(value)}"
        )
    x, y = (finite_array(f"{name}[{k}]", part) for k, part in enumerate(value))
    if x.ndim != 3 or y.ndim != 2 or len(x) != len(y):
        raise ValueError(
            f"{name} must hold windows (cases, joint, width) and targets (cases, output), "
            f"got shapes {x.shape} and {y.shape}"
        )
    varies(name, y, "take a run in which it does")


def along(name: str, value, axis: int, joints: int) -> None:
    """Refuse an array that has not so many joints along an axis."""
    shape = finite_array(name, value).shape
    if len(shape) < -axis or shape[axis] != joints:
        raise ValueError(f"{name} must have {joints} joints along axis {axis}, got shape {shape}")


def varies(name: str, torque, advice: str) -> None:
    """Refuse torques (..., cases, joint) of which one joint's never changes."""
    torque = np.asarray(torque)
    still = np.flatnonzero(np.ptp(torque, axis=-2).reshape(-1, torque.shape[-1]).max(0) == 0)
    if still.size:
        joint = still[0]
        raise ValueError(
            f"{name} must change at each joint, but joint {joint + 1} is "
            f"{torque[..., 0, joint].flat[0] + 0.0:g} throughout: {advice}"
        )
