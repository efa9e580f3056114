"""Small widgets for tests: of quantities with a pad; of choices, with every kind of chart; and one
of each kind that the book shows.
"""

from __future__ import annotations

import importlib
import inspect
import pkgutil
from functools import cache

import numpy as np

from ddlib.learning import TorqueModel, TrainingSet, Weights, cases
from ddlib.setups import STATE_FEEDBACK, split
from ddlib.widgets import Choice, CurveWidget, Mark, Pad, PageWidget, Panel, Parameter, Scalar

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


PACKAGES = "ddlib.widgets", "workshop.chapters.widgets", "beyond.chapters.widgets"


def widget_kinds() -> list[type[PageWidget]]:
    """Every public widget of the packages, by name."""
    found = {}
    for name in PACKAGES:
        package = importlib.import_module(name)
        for part in pkgutil.walk_packages(package.__path__, f"{name}."):
            members = inspect.getmembers(importlib.import_module(part.name), inspect.isclass)
            found.update(
                pair for pair in members if issubclass(pair[1], PageWidget) and pair[0][0] != "_"
            )
    return [kind for _, kind in sorted(found.items()) if kind is not PageWidget]


@cache
def sample_of(kind: type[PageWidget]) -> PageWidget:
    """A widget of a kind at its start; a kind that needs arguments has a line in `_arguments`."""
    return kind(**_arguments().get(kind.__name__, {}))


@cache
def _arguments() -> dict[str, dict]:
    """What kinds are made of, by their names; others need nothing."""
    learnt, last = split(STATE_FEEDBACK.record())
    scalings = TrainingSet.from_recording(learnt, 7)
    rng = np.random.default_rng(0)

    def network(width, seed=0):
        weights = Weights.random(3, width, hidden=4, seed=seed)
        return TorqueModel(weights, scalings.inputs, scalings.outputs)

    models = {width: network(width) for width in (7, 11)}
    single = {width: model[0] for width, model in models.items()}
    pair = tuple(Weights.random(2, 7, hidden=3))
    rows = rng.normal(size=(2, 5, 9))
    rounds = [_guess(*rows)] * 2
    windows, _ = cases(last, 7)
    return {
        "CurveWidget": {
            "function": wave, "parameters": options(), "panels": kinds(), "alt": "Waves",
            "scalars": [Scalar("from", "Begin", "s", digits=1)], "code": "{shape}, {gain}",
        },
        "FilterBuilder": {"unit": np.arange(-10, 11.0) ** 2},
        "FoldBench": {"rows": {"up": rows[0, 0]}, "step": 0.01, "motion": np.zeros((60, 3))},
        "Hero": {"pair": [_twin("A", single[7], 6.0), _twin("B", single[7], 0.0)], "arm": 6.0},
        "HiddenTorque": {"recording": last},
        "TurnTheParabola": {
            "networks": {"an arm": models[7], "a spring": network(7, 5)},
            "windows": windows, "inertial": rng.normal(size=(len(windows), 2)),
        },
        "UnitFromFiveStarts": {"networks": {0.1: pair, 0.5: pair[::-1]}},
        "WeighTheArm": {
            "networks": {"an arm": single[7], "a spring": network(7, 5)[0]}, "windows": windows,
            "own": 6.0, "inertia": lambda load: load * np.eye(2),
        },
        "WeightReader": {"start": pair[0], "trained": pair[1], "step": 0.01},
        "WhoseFilters": {"rounds": rounds},
    }  # fmt: skip


def _twin(name, model, inertia):
    from workshop.chapters.widgets.hero import Twin

    return Twin(name, "something", model, inertia)


def _guess(own, other):
    from workshop.chapters.widgets.whose import GuessRound

    return GuessRound(own, other, "learnt noise", "A remark.")
