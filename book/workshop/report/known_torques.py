"""Torques with known numbers in them, along the motion of the arm, and networks that learn them.

Ten kinds: the arm's own; parts of them; another arm's, along this motion and along its own; and
three that go with no motion.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.ndimage import gaussian_filter1d

from ddlib.dynamics import IMI_ARM, Arm
from ddlib.effects import CoulombFriction, ViscousFriction
from ddlib.learning import (
    TARGET_RANGE,
    Scaler,
    TorqueModel,
    TrainingSet,
    Weights,
    cases,
    solve,
    surrogates,
    train_ensemble,
)
from ddlib.setups import Setup, split, true_states
from ddlib.simulation import LOG_STEP
from ddlib.trajectories import APPENDIX_I, MOTION_SECONDS

ARM, OWN = "the arm", "another arm along its own motion"

SOLVERS = {"solver": False, "solver, white inputs": True}
"""Methods beside descent: whether the inputs of `ddlib.learning.solve` are whitened."""

SLOWER = 1.5
"""The second motion on which networks are tried: trajectory 6 in so many times its seconds."""

_STEPS, _DECAY = 60, 1e-6  # of Levenberg-Marquardt, as in `start-solver`
_SMOOTH = 0.1  # s, time constant of the torques that are smooth at random


@dataclass(frozen=True)
class Kind:
    """Torques to learn, the numbers in them, and the units of the knobs."""

    torque: np.ndarray  # (networks, cases, joint), N m
    stiffness: np.ndarray  # (output, joint), N m/rad
    damping: np.ndarray  # (output, joint), N m s/rad
    inertia: Arm | np.ndarray  # whose mass matrix, kg m^2
    holds: str = ""  # which of K, B, M are in the torque; the others are units only
    outputs: Scaler | None = None  # default: fitted to the torque

    def terms(self, states) -> np.ndarray:
        """Torques of K, B and M along states ``(cases, joint, 3)``: ``(3, cases, joint)``."""
        q, qd, qdd = np.moveaxis(states, -1, 0)
        forces = np.einsum("...ij,...j->...i", self._mass(q), qdd)
        return np.stack([q @ self.stiffness.T, qd @ self.damping.T, forces])

    def truth(self, states) -> np.ndarray:
        """What a right reading finds: mean K, B, M that are in the torque, (output, joint, 3)."""
        mass = self._mass(states[..., 0])
        numbers = [self.stiffness, self.damping, mass.reshape(-1, 2, 2).mean(0)]
        return np.stack([x * (name in self.holds) for name, x in zip("KBM", numbers)], -1)

    def _mass(self, q) -> np.ndarray:
        return self.inertia.mass_matrix(q) if isinstance(self.inertia, Arm) else self.inertia


class Day:
    """One recording: what networks of a window size see of it, and what they may learn."""

    def __init__(self, setup: Setup, width: int):
        self.setup, self.width = setup, width
        training, test = split(setup.record())
        slower = setup.record(APPENDIX_I[5], duration=SLOWER * MOTION_SECONDS)
        self.training, self.motions = training, (test, slower)
        self.data = TrainingSet.from_recording(training, width, scaling=setup.scaling)
        self.windows, self.torque = cases(training, width)
        self.states = true_states(training, setup).reshape(-1, 2, 3)

    def kinds(self, networks: int, seed: int) -> dict[str, Kind]:
        """Torques by their names; of each unrelated kind a draw for each network.

        A spring and a damper have the deviation of the arm's torques; all other torques have
        their own size.
        """
        q, qd, qdd = np.moveaxis(self.states, -1, 0)
        friction = {type(law): law for law in self.setup.effects.friction}
        spring, damper = (np.diag(self.torque.std(0) / x.std(0)) for x in (q, qd))
        viscous = np.diag(friction[ViscousFriction].coefficient)
        runs = self.training.tau[:, self.training.motion]
        own = Kind(self.torque[None], spring, viscous, self.setup.arm, "BM", self.data.outputs)

        def other(torque, holds, **units):
            return replace(own, torque=torque[None], holds=holds, outputs=None, **units)

        def unrelated(draws):
            return replace(own, torque=draws.reshape(networks, -1, 2), holds="")

        along = IMI_ARM.inverse_dynamics(q, qd, qdd)
        return {
            ARM: own,
            "inertia alone": other(own.terms(self.states)[2], "M"),
            "position alone": other(q @ spring, "K"),
            "velocity alone": other(qd @ damper, "B", damping=damper),
            "dry friction alone": other(friction[CoulombFriction].torque(qd), ""),
            "another arm along this motion": other(along, "M", inertia=IMI_ARM),
            "shifted": unrelated(surrogates("shifted", runs, networks, seed)),
            "random phases": unrelated(surrogates("phases", runs, networks, seed)),
            "smooth at random": unrelated(self._smooth(networks, seed)),
        }

    def _smooth(self, networks: int, seed: int) -> np.ndarray:
        """Gaussian processes with the mean and the deviation of the torques."""
        shape = networks, len(self.training.q), -1, 2
        rest = np.random.default_rng(seed).normal(size=(networks, *self.torque.shape))
        smooth = gaussian_filter1d(rest.reshape(shape), _SMOOTH / np.sqrt(2) / LOG_STEP, axis=2)
        smooth = smooth.reshape(rest.shape)
        return self.torque.mean(0) + self.torque.std(0) * smooth / smooth.std(1, keepdims=True)

    def learnt(self, kinds: dict[str, Kind], networks: int, method: str, seed: int):
        """Name, model and start of each kind's networks; descent trains all side by side."""
        setup = self.setup
        start = Weights.random(networks, self.width, initial=setup.initial, seed=seed)
        scalers = [
            kind.outputs or Scaler.fit(kind.torque[0], TARGET_RANGE) for kind in kinds.values()
        ]
        targets = [
            np.broadcast_to(scaler.scale(kind.torque), (networks, *self.torque.shape))
            for scaler, kind in zip(scalers, kinds.values())
        ]
        if method == "descent":
            starts = Weights.concatenate([start] * len(kinds))
            how = {"momentum": setup.momentum, "warm_up": setup.warm_up, "epochs": setup.epochs}
            trained = train_ensemble(
                starts, self.data, targets=np.concatenate(targets), rate=setup.rate / self.width,
                progress=False, **how,
            )[0].weights  # fmt: skip
        else:
            how = {"steps": _STEPS, "decay": _DECAY, "whiten": SOLVERS[method], "progress": False}
            trained = Weights.concatenate(
                solve(start[k : k + 1], replace(self.data, y=target), **how).model.weights
                for each in targets
                for k, target in enumerate(each)
            )
        for k, (name, scaler) in enumerate(zip(kinds, scalers)):
            weights = trained[k * networks : (k + 1) * networks]
            yield name, TorqueModel(weights, self.data.inputs, scaler, LOG_STEP), start
