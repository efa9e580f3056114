"""Arm, effects, controller and network as the plain data that the page's engine takes."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import fields
from math import prod

import numpy as np

from ddlib.control import PID
from ddlib.dynamics import Arm
from ddlib.effects import CoulombFriction, Effects, Quantisation, Saturation, ViscousFriction
from ddlib.learning import Scaler, TorqueModel, Weights
from ddlib.setups import Setup
from ddlib.simulation import CONTROL_STEP, Recording
from ddlib.trajectories import MOTION_SECONDS


def plant(arm: Arm, effects: Effects) -> dict:
    """An arm and what acts on it, as the engine's functions take it.

    At most one viscous and one Coulomb friction, one saturation and one quantisation; the torque
    sensor is ignored, since the page shows the applied torque.
    """
    by_kind = {}
    parts = {
        "friction": (ViscousFriction, CoulombFriction),
        "actuator": (Saturation,),
        "encoder": (Quantisation,),
        "motor": (),
        "transmission": (),
    }
    for part, kinds in parts.items():
        for effect in getattr(effects, part):
            if type(effect) not in kinds or type(effect) in by_kind:
                names = ", ".join(kind.__name__ for kind in kinds) or "no effect"
                raise TypeError(f"{part} must hold at most one each of {names}, got {effect!r}")
            by_kind[type(effect)] = effect
    viscous = by_kind.get(ViscousFriction, ViscousFriction((0.0, 0.0)))
    coulomb = by_kind.get(CoulombFriction, CoulombFriction((0.0, 0.0)))
    g1, g2 = arm.gravity_moments
    return {
        "arm": {"a": arm.a, "b": arm.b, "d": arm.d, "g1": g1, "g2": g2},
        "lengths": list(arm.lengths),
        "viscous": _pair(viscous.coefficient),
        "coulomb": _pair(coulomb.level),
        "smoothing": coulomb.smoothing,
        "encoder": by_kind[Quantisation].step if Quantisation in by_kind else 0,
        "limit": _pair(by_kind[Saturation].limit) if Saturation in by_kind else None,
    }


def gains(controller: PID) -> dict:
    """The fields of a `PID` for the engine's ``pid``; one pair each of gains and limit."""
    if not isinstance(controller, PID):
        raise TypeError(f"controller must be a PID, got {controller!r}")
    pairs = {name: _pair(getattr(controller, name)) for name in ("kp", "ki", "kd")}
    return {
        **pairs,
        "limit": None if controller.limit is None else _pair(controller.limit),
        "anti_windup": controller.anti_windup,
        "derivative_filter": controller.derivative_filter,
    }


def loop(setup: Setup, recording: Recording) -> dict:
    """What the engine's ``recordingOf`` takes to record as a set-up did; times in periods."""
    motion, every = recording.motion, round(recording.step / CONTROL_STEP)
    return {
        "plant": plant(setup.arm, setup.effects),
        "gains": gains(setup.controller),
        "motion": MOTION_SECONDS,
        "step": CONTROL_STEP,
        "every": every,
        "periods": every * recording.t.size,
        "rest": every * motion.start,
        "during": [motion.start, motion.stop],
    }


def network(model: TorqueModel) -> dict:
    """Layout and scaling of one network; `weight_bytes` has its weights."""
    weights = model.weights if isinstance(model, TorqueModel) else None
    if weights is None or weights.hidden_bias.ndim != 1:
        raise TypeError(f"model must be a single network, got {model!r}")
    hidden, joints, width = weights.hidden_weights.shape
    return {
        "layout": {
            "hidden": hidden,
            "outputs": len(weights.output_bias),
            "joints": joints,
            "width": width,
        },
        "inputs": _scaling(model.inputs),
        "outputs": _scaling(model.outputs),
    }


def weight_bytes(model: TorqueModel) -> bytes:
    """All weights of one network as little-endian float32, as committed: field after field."""
    parts = [np.ravel(getattr(model.weights, field.name)) for field in fields(Weights)]
    return np.concatenate(parts).astype("<f4").tobytes()


def weights_of(numbers, layout: dict) -> Weights:
    """The network whose weights the page has in one array, in the order of `weight_bytes`."""
    hidden, outputs, joints, width = (layout[n] for n in ("hidden", "outputs", "joints", "width"))
    shapes = [(hidden, joints, width), (hidden,), (outputs, hidden)]
    shapes += [(outputs, joints, width), (outputs,)]
    parts = np.split(numbers, np.cumsum([prod(shape) for shape in shapes])[:-1])
    return Weights(*(part.reshape(shape) for part, shape in zip(parts, shapes)))


def networks(models: Iterable[TorqueModel]) -> tuple[list[dict], bytes]:
    """What ``static/sliding.js`` takes: `network` of each model, and the weights of all."""
    models = list(models)
    return [network(model) for model in models], b"".join(map(weight_bytes, models))


def _scaling(scaler: Scaler) -> dict:
    low, gain = (np.asarray(x, dtype=float).tolist() for x in (scaler.low, scaler.gain))
    return {"low": low, "gain": gain, "first": float(scaler.target[0])}


def _pair(values) -> list[float]:
    pair = np.asarray(values, dtype=float)
    if pair.shape != (2,):
        raise TypeError(f"values must be one pair, got shape {pair.shape}")
    return pair.tolist()
