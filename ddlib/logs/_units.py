"""Units of a log's columns: as told, as a head names them, or as the numbers leave no doubt."""

from __future__ import annotations

import re

import numpy as np

from ddlib._check import number, told

_UNITS = {  # in SI units
    "time": {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9},
    "angle": {"rad": 1.0, "mrad": 1e-3, "deg": np.pi / 180, "rev": 2 * np.pi},
    "torque": {"Nm": 1.0, "mNm": 1e-3, "Ncm": 1e-2, "kNm": 1e3, "A": 1.0, "mA": 1e-3},
}
_KINDS = {"time": "time", "q1": "angle", "q2": "angle", "tau1": "torque", "tau2": "torque"}
_WORDS = {
    "s": "sec secs second seconds",
    "ms": "msec millis millisecond milliseconds",
    "us": "µs μs usec micros microsecond microseconds",
    "ns": "nsec nanos nanosecond nanoseconds",
    "rad": "radian radians",
    "deg": "° degree degrees",
    "rev": "turn turns revolutions",
    "A": "amp amps ampere amperes",
}
_SPELLED = {unit.lower(): unit for units in _UNITS.values() for unit in units}
_SPELLED |= {word: unit for unit, words in _WORDS.items() for word in words.split()}
_STEPS = (5e-5, 0.25)  # s, that logs of arms have


def spelled(unit: str) -> str:
    """A unit as this module spells it, whatever stands between its letters."""
    plain = "".join(letter for letter in unit if letter not in " ·⋅*.-")
    return _SPELLED.get(plain.lower(), plain)


def are_units(row: list[str]) -> bool:
    """Whether most cells are units, like s, [deg] and (N m)."""
    words = [cell.strip("[]()") for cell in row if cell]
    return 2 * sum(spelled(word) in _SPELLED.values() for word in words) > len(words)


def in_head(head: str, quantity: str) -> tuple[str, str | None]:
    """Name and unit of a head like "q1 [deg]", "time_ms", "tau1/Nm"; no unit: None.

    A head that speaks of a current is in amperes.
    """
    for opening, closing in ("[]", "()"):
        name, bracket, unit = head.removesuffix(closing).rpartition(opening)
        if bracket and head.endswith(closing):
            return name.strip(), spelled(unit)
    for sign in "_/ ":
        name, _, unit = head.rpartition(sign)
        if name and unit != "a" and spelled(unit) in _UNITS.get(_KINDS.get(quantity), {}):
            return name.strip(), spelled(unit)
    currents = {"current", "currents"}.intersection(re.split(r"[^a-z]+", head.lower()))
    return head, "A" if currents and _KINDS.get(quantity) == "torque" else None


def size_of(unit, quantity: str) -> float:
    """A unit in SI units; a ValueError lists those that are known."""
    if not isinstance(unit, str):
        return number(f"units of {quantity}", unit, 0.0, open_low=True)
    sizes = _UNITS[_KINDS[quantity]]
    if spelled(unit) not in sizes:
        raise ValueError(
            f"units of {quantity} must be one of {', '.join(sizes)}, or a number of SI units, got "
            f"{told(unit)}"
        )
    return sizes[spelled(unit)]


def in_si(values, size: float) -> np.ndarray:
    """Numbers in SI units of which each was `size`; 17 ms are 0.017 s to the last digit."""
    inverse = round(1 / size) if size < 1 else 0
    if inverse and np.isclose(inverse * size, 1, rtol=1e-12, atol=0):
        return values / inverse
    return values * size


def since_1970(first: float) -> bool:
    """Whether a time in s is one of a clock that counts from 1970, from 1989 to 2103."""
    return 6e8 <= first <= 4.2e9


def check_precision(times) -> None:
    """Refuse times that were kept in single precision when they had grown too large for it."""
    apart = float(np.spacing(np.float32(np.abs(times).max())))
    mean = float(np.ptp(times)) / max(len(times) - 1, 1)
    if (times == times.astype(np.float32)).all() and apart > max(1.5 * mean, 1e-3):
        raise ValueError(
            f"numbers near {times[0]:.6g} in single precision (float32) are {apart:g} apart, where "
            f"samples are {mean:.3g}; write times in double precision, or give rate="
        )


def guessed_unit(times) -> str:
    """The unit of times, by their first and their usual step; a ValueError if it is in doubt."""
    steps = np.diff(times)
    step = float(np.median(steps[steps > 0])) if (steps > 0).any() else 0.0
    sizes, first = _UNITS["time"], abs(float(times[0]))
    usual = [unit for unit in sizes if step == 0 or _STEPS[0] <= step * sizes[unit] <= _STEPS[1]]
    clocks = [unit for unit in sizes if since_1970(first * sizes[unit])]
    for unit in (*clocks, "s"):
        if unit in usual:
            return unit
    likely = [u for u in sizes if u in usual or u in clocks or (u == "s" and step < 2)]
    if len(likely) == 1:
        return likely[0]
    readings = [f'"{unit}" ({step * sizes[unit]:g} s a step)' for unit in likely]
    readings += ["numbers of samples (then give rate= and no time)"] * (step == 1)
    raise ValueError(
        f"steps of {step:g} may be {' or '.join(readings) or 'no time'}; say which by "
        f'units={{"time": ...}}'
    )
