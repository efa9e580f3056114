"""Units of a log's columns: as told, as a head names them, or as the numbers leave no doubt."""

from __future__ import annotations

import re

import numpy as np

from ddlib._check import number
from ddlib.logs._text_files import fault, listed, shown

# Units in SI; what is above 1 divides, so that 17 ms are .017 s to the last digit
_KNOWN = {
    "time": {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9},
    "angle": {
        "rad": 1.0,
        "mrad": 1e-3,
        "deg": np.pi / 180,
        "rev": 2 * np.pi,
    },
    "torque": {"Nm": 1.0, "mNm": 1e-3, "kNm": 1e3, "Ncm": 1e-2},
    "current": {"A": 1.0, "mA": 1e-3},
}
_ALIKE = {
    "sec": "s", "secs": "s", "second": "s", "seconds": "s", "msec": "ms", "milliseconds": "ms",
    "millis": "ms", "µs": "us", "μs": "us", "usec": "us", "microseconds": "us", "micros": "us",
    "nsec": "ns", "nanoseconds": "ns", "nanos": "ns", "radian": "rad", "radians": "rad",
    "°": "deg", "degree": "deg", "degrees": "deg", "turn": "rev", "turns": "rev",
    "revolutions": "rev", "amp": "A", "ampere": "A", "amps": "A",
}  # fmt: skip
_EPOCH = (6e8, 4.2e9)  # s since 1970: 1989 to 2103
_STEPS = (5e-5, 0.25)  # s, that logs of arms have
_TURNS = 4 * np.pi  # rad: no joint of an arm goes further without a word
_WORDS = {"ms": "milliseconds", "us": "microseconds", "ns": "nanoseconds", "s": "seconds"}


def kind_of(quantity: str) -> tuple[str, ...]:
    """Kinds of unit that a quantity may have."""
    kinds = {"t": ("time",), "q": ("angle",)}
    return ("torque", "current") if quantity.startswith("tau") else kinds[quantity[0]]


def spelled(unit: str) -> str:
    """A unit as this module spells it, whatever stands between its letters."""
    plain = re.sub(r"[\s·⋅*.\-]", "", unit)
    for known in (*_ALIKE, *(u for units in _KNOWN.values() for u in units)):
        if plain.lower() == known.lower():
            return _ALIKE.get(known, known)
    return plain


def in_head(head: str, quantity: str) -> tuple[str, str | None]:
    """Name and unit of a head like "q1 [deg]", "time_ms", "tau1/Nm"; no unit: None."""
    if found := re.fullmatch(r"(.*?)\s*[\[(]([^\])]*)[\])]\s*", head):
        return found[1], spelled(found[2])
    known = [unit for kind in kind_of(quantity) for unit in _KNOWN[kind]]
    if found := re.fullmatch(r"(.+?)\s*[_/ ]\s*([^_/ ]+)", head):
        unit = spelled(found[2])
        if unit in known and not (unit == "A" and found[2] == "a"):
            return found[1], unit
    return head, None


def factor(quantity: str, unit) -> tuple[float, str]:
    """SI units in a unit, and the kind of it; a ValueError lists those that are known."""
    if not isinstance(unit, str):
        return number(f"units of {quantity}", unit, 0.0, open_low=True), kind_of(quantity)[0]
    for kind in kind_of(quantity):
        if spelled(unit) in _KNOWN[kind]:
            return _KNOWN[kind][spelled(unit)], kind
    known = listed(u for kind in kind_of(quantity) for u in _KNOWN[kind])
    raise ValueError(
        f"units of {quantity} must be one of {known}, or a number of SI units, got "
        f"{shown(repr(unit))}"
    )


def converted(values: np.ndarray, size: float) -> np.ndarray:
    """Numbers in SI units of which each was `size`."""
    inverse = round(1 / size) if 0 < abs(size) < 1 else 0
    if inverse and np.isclose(inverse * size, 1, rtol=1e-12, atol=0):
        return values / inverse
    return values * size


def unit_of_times(times: np.ndarray, steps: np.ndarray, place: str) -> tuple[str, bool]:
    """What times that grow by `steps` are in, and whether they count from 1970.

    A ValueError names the readings if there are several.
    """
    first = abs(float(times[0])) if times.size else 0.0
    step = float(np.median(steps[steps > 0])) if (steps > 0).any() else 0.0
    slow = []
    for unit, size in _KNOWN["time"].items():
        if _EPOCH[0] <= first * size <= _EPOCH[1]:
            if step == 0 or _STEPS[0] <= step * size <= _STEPS[1]:
                return unit, True
            slow = [unit] if step * size > _STEPS[1] else slow
    if step == 0 or _STEPS[0] <= step <= _STEPS[1]:
        return "s", False
    sizes = _KNOWN["time"]
    likely = [u for u, size in sizes.items() if _STEPS[0] <= step * size <= _STEPS[1]]
    likely = [unit for unit in slow if unit not in likely] + likely
    readings = [f'"{u}" ({step * sizes[u]:g} s a step)' for u in likely]
    if step < 2 and "s" not in likely:
        readings = [f'"s" ({step:g} s a step)', *readings]
    if step == 1:
        readings.append("numbers of samples (then give rate= and no time)")
    if len(readings) == 1 and likely:
        return likely[0], False
    raise fault(
        f"{place}: steps of {step:g} may be {' or '.join(readings) or 'no time'}; say which by "
        f'units={{"time": ...}}'
    )


def word(unit: str) -> str:
    """A unit of time in full."""
    return _WORDS[unit]


def check_angle(values: np.ndarray, place: str, quantity: str, lines) -> None:
    """Refuse angles without a unit that are too large for radians."""
    k = int(np.argmax(np.abs(values)))
    if abs(values[k]) > _TURNS:
        raise fault(
            f"{place}: {quantity} goes to {values[k]:g} (line {lines[k]}): degrees, or radians of "
            f'a joint that turns on? Say which by units={{"{quantity}": "deg"}} or '
            f'{{"{quantity}": "rad"}}; or is that sample wrong?'
        )
