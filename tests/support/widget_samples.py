"""Small widgets for tests: of quantities with a pad; of choices, with every kind of chart."""

from __future__ import annotations

import numpy as np

from ddlib.widgets import Choice, CurveWidget, Mark, Pad, Panel, Parameter, Scalar

T = np.linspace(0, 1, 41)


def oscillation(gain, decay, phase):
    """Smooth in three parameters; one of them on a logarithmic scale."""
    y = np.exp(-decay * T) * np.cos(6 * T + phase) * np.log(gain)
    return {"position": y, "square": y**2 + gain, "constant": np.full(3, 2.5), "final": y[-1]}


def parameters(grid=21):
    return [
        Parameter("gain", "Gain", 1, 100, 10, "N m/rad", 3, "log"),
        Parameter("decay", "Decay", 0, 2, 0.5, "1/s", grid),
        Parameter("phase", "Phase", -1, 1, 0, "rad", grid),
    ]


def panels():
    return [
        Panel("Position, m", {"position": "hand"}, "time, s", T),
        Panel("Square, m²", ("square",), "time, s", T),
    ]


def make(**changes):
    pad = Pad("decay", "phase", [Mark(0.5, 0.5, "1", "training"), Mark(1, 0, "2", "test")])
    options = {
        "alt": "Two curves",
        "scalars": [Scalar("final", "Final position", "m")],
        "pad": pad,
        **changes,
    }
    return CurveWidget(oscillation, parameters(), panels(), **options)


def wave(gain, shape, twice, bits):
    """Options of every kind beside a quantity."""
    y = {"sine": np.sin, "cosine": np.cos}[shape](6 * T) * gain * (2 if twice else 1)
    coarse = np.round(y[::4] * 2.0**bits) / 2.0**bits
    return {"y": y, "taps": coarse, "share": np.abs(y[:3]), "from": 0.1 * gain, "to": 0.5}


def options():
    return [
        Parameter("gain", "Gain", 1, 5, 2, "N m", 3),
        Choice("shape", "Shape", {"sine": "a sine", "cosine": "a cosine"}, "sine"),
        Choice("twice", "Twice as much", {False: "off", True: "on"}, False, "switch"),
        Choice("bits", "Encoder", {3: "3 bits", 5: "5 bits", 8: "8 bits"}, 5, "slider"),
    ]


def kinds():
    return [
        Panel("Line", {"y": "wave"}, "x", T, fixed={"one": np.ones(41)}, cursor="from", y_fit=True),
        Panel("Stems", {"taps": "taps"}, "x", T[::4], kind="stems", cursor=("from", "to")),
        Panel("Bars", {"share": "share"}, "x", [0, 1, 2], kind="bars", ticks=[(0, "a"), (2, "c")]),
        Panel("Fixed range", {"y": "wave"}, "x", T, y_range=(-2, "to")),
    ]


def make_kinds(**changes):
    scalars = [Scalar("from", "Begin", "s", digits=1)]
    given = {"alt": "Waves", "note": "A note.", "scalars": scalars, **changes}
    return CurveWidget(wave, options(), kinds(), **given)


def parts(a, b, k):
    return {"a": np.sin(a * T), "all": T * (a + b) * (1 + k), "k": np.full(2, k), "c": T**2}
