"""An arm written by hand: other loads, links and frictions in the weights of trained networks.

The change of the mean mass matrix along the training motion, or of the viscous friction, goes into
the direct weights by filters of least energy (`workshop.report.pencil`); nothing is trained, and no
torque of the changed arm is used. What would speak against calling this writing:

- *turned sign*: the opposite change does as well.
- *random filters*: filters of the same energy, but without those moments, do as well. (*rough
  filters* have the moments, and twice the energy: what they do belongs to the size, not the shape.)
- *one factor*: it is enough to multiply the torques of each joint by the ratio of its inertias.
- *equations, written*: the same change on the true equations of the unchanged arm; what it leaves
  is the mean's fault, not the network's.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np

from beyond.control.windowed import reference_windows
from beyond.studies.loop.feedforwards import exact, through_window
from ddlib.analysis import gains, mean_gradient
from ddlib.control import Feedforward
from ddlib.dynamics import Arm, Link, with_load
from ddlib.effects import CoulombFriction, ViscousFriction
from ddlib.learning import (
    NotConverged,
    TorqueModel,
    TrainingSet,
    Weights,
    cases,
    solve,
    train_ensemble,
)
from ddlib.metrics import rmss
from ddlib.setups import (
    JOINT_DAMPING,
    JOINT_DAMPING_VISCOUS,
    SETUPS,
    STATE_FEEDBACK,
    WINDOWS,
    Setup,
    split,
)
from ddlib.simulation import CONTROL_STEP, LOG_STEP, REST, Recording, score
from ddlib.trajectories import APPENDIX_I, pick_and_place, time_grid
from workshop.report.code_hash import code_hash, study
from workshop.report.pencil import moment_filters, written
from workshop.report.studies.planted import summary
from workshop.report.sweeps import _sweep

LOADS = (1.0, 3.0, 5.0)
"""Loads in the hand, kg."""

LIGHT = Arm.from_links("light forearm", Link(14.0, 0.50, 0.22, 0.40), Link(7.0, 0.40, 0.09, 0.30))
"""The surrogate arm with half of its second link's mass and inertia."""

METHODS = {"descent": 4000, "longer descent": 20_000, "solver": 60}
"""Epochs, or steps, of the ways to train."""

DAYS = (61, 62, 63)
"""Seeds of `Setup.repeated`: recordings that no other study has used."""

_NETWORKS = {"descent": 4, "longer descent": 4, "solver": 2}  # of each recording
_WARM_UP, _DECAY, _SETTLED = 500, 1e-6, 8
_READINGS = (JOINT_DAMPING.name, STATE_FEEDBACK.name)
_Model = Callable[[np.ndarray], np.ndarray]  # windows to torques, (..., cases, joint)


def changed(setup: Setup) -> dict[str, Setup]:
    """The same experiment with other arms, by what is changed."""
    laws = {type(law): law for law in setup.effects.friction}
    own, more = laws[ViscousFriction].coefficient, JOINT_DAMPING_VISCOUS

    def rubbing(viscous) -> Setup:
        friction = ViscousFriction(tuple(map(float, viscous))), laws[CoulombFriction]
        return replace(setup, effects=replace(setup.effects, friction=friction))

    return {
        **{f"{kg:g} kg": replace(setup, arm=with_load(setup.arm, kg)) for kg in LOADS},
        "light forearm": replace(setup, arm=LIGHT),
        "more viscous friction": rubbing(np.add(own, more)),
        "no viscous friction": rubbing((0.0, 0.0)),
    }


def difference(setup: Setup, other: Setup, q) -> np.ndarray:
    """Stiffness, damping and mean inertia along q that another set-up has more, (2, 2, 3)."""
    dampings = [np.diag(one.effects.friction[0].coefficient) for one in (setup, other)]
    mass = (other.arm.mass_matrix(q) - setup.arm.mass_matrix(q)).reshape(-1, 2, 2).mean(0)
    return np.stack([np.zeros((2, 2)), dampings[1] - dampings[0], mass], -1)


@cache
def _recorded(setup: Setup) -> tuple[Recording, Recording]:
    return split(setup.record())


def learnt(setup: Setup, width: int, method: str, seed: int) -> TorqueModel:
    """Networks of the training runs of a set-up."""
    data = TrainingSet.from_recording(_recorded(setup)[0], width, scaling=setup.scaling)
    start = Weights.random(_NETWORKS[method], width, initial=setup.initial, seed=seed)
    if method == "solver":
        how = {"steps": METHODS[method], "decay": _DECAY, "whiten": False, "progress": False}
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", NotConverged)
            return solve(start, data, **how).model
    return train_ensemble(
        start, data, rate=setup.rate / width, momentum=setup.momentum, warm_up=_WARM_UP,
        epochs=METHODS[method], progress=False,
    )[0]  # fmt: skip


def other_filters(width: int, seed: int) -> dict[str, np.ndarray]:
    """Nulls for `moment_filters`, as many: of the same energy, and with the same moments."""
    f = moment_filters(width, LOG_STEP)
    noise = np.random.default_rng(seed).normal(size=f.shape)
    cubics = np.linalg.qr(np.linspace(-1, 1, width)[:, None] ** np.arange(4))[0]
    rough = noise - noise @ cubics @ cubics.T

    def as_large(x):
        return x * np.linalg.norm(f, axis=1, keepdims=True) / np.linalg.norm(x, axis=1)[:, None]

    return {"random filters": as_large(noise), "rough filters": f + as_large(rough)}


def _tracked(setup: Setup, models: dict[str, _Model], width: int) -> dict[str, np.ndarray]:
    """RMS tracking error of trajectory 6, degrees, with models as feedforward; all side by side."""
    desired = pick_and_place(APPENDIX_I[5], time_grid(CONTROL_STEP, REST)).q
    windows = reference_windows(desired, width, round(LOG_STEP / CONTROL_STEP))
    torques = [np.reshape(model(windows), (-1, *desired.shape)) for model in models.values()]
    every = np.concatenate(torques)
    driven = replace(setup, controller=Feedforward(lambda *_: every, setup.controller))
    errors = score(setup.arm, driven.record(np.tile(APPENDIX_I[5], (len(every), 1)))).whole
    return dict(zip(models, np.split(errors, np.cumsum([len(each) for each in torques])[:-1])))


def _row(setup: Setup, other: Setup, model: TorqueModel, method: str, seed: int) -> dict:
    """Errors on the changed arm's trajectory 6, and in its loop, of everything compared."""
    width, own = model.weights.width, _recorded(setup)[0]
    windows, _ = cases(own, width)
    change = difference(setup, other, own.q[:, own.motion])
    filters = moment_filters(width, LOG_STEP)
    networks = {
        "unedited": model,
        "written": written(model, windows, change, filters),
        "written, slope settled": written(model, windows, change, filters, _SETTLED),
        "turned sign": written(model, windows, -change, filters),
        "retrained": learnt(other, width, method, seed),
        **{
            name: written(model, windows, change, others)
            for name, others in other_filters(width, seed).items()
        },
    }
    mass = setup.arm.mass_matrix(own.q[:, own.motion]).mean((0, 1))
    ratio = 1 + np.diag(change[..., 2]) / np.diag(mass)
    before, after = (through_window(exact(one), width).model for one in (setup, other))
    models = {
        **{name: each.torque for name, each in networks.items()},
        "one factor": lambda x: ratio * model.torque(x),
        "equations": after,
        "equations, written": lambda x: before(x) + np.einsum("ijk,njk->ni", change, x @ filters.T),
        "nothing": lambda x: np.zeros((len(x), 2)),
    }
    x, torque = cases(_recorded(other)[1], width)
    return {
        "change": change[None],
        "error": {name: np.atleast_1d(rmss(each(x), torque)) for name, each in models.items()},
        "tracking": _tracked(other, models, width),
        "read": {
            name: gains(mean_gradient(networks[name], windows), LOG_STEP)
            for name in ("unedited", "written", "retrained")
        },
    }


def _cell(reading: str, width: int, method: str) -> dict:
    """All changes on all recordings, for networks of one setting."""
    base = replace(SETUPS[reading], steps=0, decay=0.0)
    days: dict = {}
    for k in DAYS:
        setup, seed = base.repeated(k), 1000 * k
        model = learnt(setup, width, method, seed)
        x, torque = cases(_recorded(setup)[1], width)
        days.setdefault("own arm", []).append({"error": rmss(model.torque(x), torque)})
        for name, other in changed(base).items():
            row = _row(setup, other.repeated(k), model, method, seed)
            days.setdefault(name, []).append(row)
    return {name: summary(rows, True) for name, rows in days.items()}


@study
def _written() -> dict:
    """Errors, tracking and what is read, by reading, window, method and change."""
    settings = [
        {"reading": reading, "width": width, "method": method}
        for method in METHODS
        for reading in _READINGS
        for width in WINDOWS
        if method != "longer descent" or width == 21
    ]
    how = {"code": code_hash("written"), "backend": "sequential"}
    found = _sweep(_cell, settings, label="written", **how)
    rows = [{"setting": setting, "changes": row} for setting, row in zip(settings, found)]
    return {"methods": METHODS, "networks": _NETWORKS, "days": DAYS, "rows": rows}
