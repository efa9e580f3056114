"""What moves the errors of Table 4-1: all that was fitted, changed together by a screening design.

Every quantity takes three values, at places -1, 0 and 1 of its range, in a *definitive screening
design* (Jones & Nachtsheim 2011). Main effects are orthogonal to each other, to all squares and to
all products of two quantities.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from ddlib._check import number, one_of
from ddlib.control import proportional
from ddlib.effects import (
    CMU_DD_ARM_II_EFFECTS,
    CoulombFriction,
    Noise,
    Quantisation,
    ViscousFriction,
)
from ddlib.setups import JOINT_DAMPING, KP, WINDOWS, Setup, train_windows
from ddlib.simulation import Recording
from workshop.report.code_hash import code_hash, study
from workshop.report.studies.table import errors_and_weights
from workshop.report.sweeps import _sweep

# Initial weights tried for a network at most: one that derails is begun anew, as anyone would
_TRIES = 3


@dataclass(frozen=True)
class _Range:
    """Bounds between which a quantity is varied."""

    low: float  # its value at place -1
    high: float  # and at 1
    logarithmic: bool = True  # whether equal steps are equal factors

    def value(self, place):
        """Value at a coded place, -1 to 1."""
        share = (np.asarray(place, dtype=float) + 1) / 2
        if self.logarithmic:
            return self.low * (self.high / self.low) ** share
        return self.low + (self.high - self.low) * share

    def place(self, value):
        """Coded place of a value."""
        if self.logarithmic:
            return 2 * np.log(np.asarray(value) / self.low) / np.log(self.high / self.low) - 1
        return 2 * (np.asarray(value) - self.low) / (self.high - self.low) - 1


# What a recording depends on. The damping is a factor of `JOINT_DAMPING`'s, which is the IMI arm's;
# friction, gain and noise are factors of the default ones; the start is in s.
_RECORDING = {
    "joint damping": _Range(0.35, 2.0),
    "Coulomb friction": _Range(0.5, 6.0),
    "position gain": _Range(0.7, 6.0),
    "encoder bits": _Range(11.5, 16.0, logarithmic=False),
    "torque noise": _Range(0.25, 4.0),
    "start left out": _Range(0.0, 0.3, logarithmic=False),
}

# What learning depends on, by method. The momentum is ``1 / (1 - momentum)``: how many steps go on
# together; the step is the rate times the width of the window.
_METHODS = {
    "descent": {
        "lowest input": _Range(-1.0, 0.0, logarithmic=False),
        "momentum": _Range(50.0, 200.0),
        "step": _Range(8.25, 33.0),
        "epochs": _Range(6_000.0, 24_000.0),
    },
    "solver": {
        "lowest input": _Range(-1.0, 0.0, logarithmic=False),
        "decay": _Range(1e-7, 1e-5),
        "steps": _Range(15.0, 60.0),
    },
}


def varied(method: str) -> dict[str, _Range]:
    """All that is varied for a method, what belongs to the recording first."""
    return {**_RECORDING, **_METHODS[one_of("method", method, tuple(_METHODS))]}


def screening() -> np.ndarray:
    """The definitive screening design for twelve quantities, shape ``(25, 12)``, of -1, 0 and 1.

    A conference matrix of order 12 (Paley's, from the squares modulo 11), its mirror image, and
    the centre. For fewer quantities leave out columns.
    """
    squares = {k * k % 11 for k in range(1, 11)}
    core = [[0 if i == j else 1 if (j - i) % 11 in squares else -1 for j in range(11)]
            for i in range(11)]  # fmt: skip
    conference = np.zeros((12, 12))
    conference[0, 1:], conference[1:, 0], conference[1:, 1:] = 1, -1, core
    return np.concatenate([conference, -conference, np.zeros((1, 12))])


def _setup(values: Mapping[str, float], method: str) -> Setup:
    """The experiment with everything that is varied at some value."""
    for name, its in varied(method).items():
        if name not in values:
            raise ValueError(f"values must have one for {name!r}, got {sorted(values)}")
        slack = 1e-9 * (its.high - its.low)  # of rounding
        number(name, values[name], its.low - slack, its.high + slack)
    default = CMU_DD_ARM_II_EFFECTS
    viscous, coulomb = JOINT_DAMPING.effects.friction[0], default.friction[1]

    def times(name, pair):
        return tuple(float(values[name]) * np.asarray(pair))

    effects = replace(
        default,
        friction=(
            ViscousFriction(times("joint damping", viscous.coefficient)),
            CoulombFriction(times("Coulomb friction", coulomb.level)),
        ),
        encoder=(Quantisation(2 * np.pi / 2 ** values["encoder bits"]),),
        torque_sensor=(Noise(times("torque noise", default.torque_sensor[0].std)),),
    )
    setup = replace(
        JOINT_DAMPING,
        name=method,
        controller=proportional(times("position gain", KP)),
        effects=effects,
        scaling=(float(values["lowest input"]), 1.0),
    )
    if method == "solver":
        return replace(setup, decay=float(values["decay"]), steps=round(values["steps"]))
    return replace(
        setup,
        steps=0,
        decay=0.0,
        momentum=1 - 1 / float(values["momentum"]),
        rate=float(values["step"]),
        epochs=round(values["epochs"]),
    )


def _without_start(recording: Recording, seconds: float) -> Recording:
    """A recording whose motion begins `seconds` later: less of the start transient."""
    delay = number("seconds", seconds, 0.0, 2.0)
    begin, end = recording.span
    return replace(recording, t=recording.t - delay, duration=end - begin - delay)


def _run(method: str, places: list, seeds: list) -> dict:
    """One run of the design: for each seed a recording and a network for each window."""
    values = {name: float(its.value(x)) for (name, its), x in zip(varied(method).items(), places)}
    here, rows, derailed = _setup(values, method), [], 0
    for seed in seeds:
        recording = _without_start(here.repeated(seed).record(), values["start left out"])
        rows.append({})
        for width in WINDOWS:
            for again in range(_TRIES):
                model, history, _ = train_windows(
                    here, recording, width, 1, seed=seed + 1000 * again, progress=False
                )
                derailed += bool(history.derailed[0])
                if not history.derailed[0]:
                    break
            rows[-1][width] = errors_and_weights(model, history, recording)
    cells = {
        str(w): {name: [float(row[w][name][0]) for row in rows] for name in rows[0][w]}
        for w in WINDOWS
    }
    return {"values": values, "places": list(places), "derailed": derailed, "windows": cells}


@study
def _screened(networks=2) -> dict:
    """The six errors at each run of the design, by both methods; every network has its own day."""
    settings = [
        {
            "method": method,
            "places": [float(x) for x in run[: len(varied(method))]],
            "seeds": [1 + networks * k + i for i in range(networks)],
        }
        for method in _METHODS
        for k, run in enumerate(screening())
    ]
    rows = _sweep(_run, settings, code=code_hash("screened"), backend="sequential", label="knobs")
    half = len(settings) // len(_METHODS)
    return {
        "networks": networks,
        "methods": {m: rows[k * half : (k + 1) * half] for k, m in enumerate(_METHODS)},
    }
