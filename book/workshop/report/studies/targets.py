"""When networks grow velocity filters: targets that the windows explain, in part or not at all."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.ndimage import gaussian_filter1d

from ddlib.learning import Weights, surrogates
from ddlib.simulation import LOG_STEP
from workshop.report.code_hash import study
from workshop.report.studies.nulls import TRIAL, FilterTrial, names_counted

_TIMES = (0.02, 0.05, 0.1, 0.3, 1.0)  # s, time constants of the Gaussian processes

_SHARES = (0.0, 0.5, 0.9, 0.97, 0.99, 1.0)  # of the mixtures, explained by the windows

_MIXED = ("phases", "real torques")  # whose explained parts are mixed

_INITIAL = (0.01, 0.03, 0.1, 0.3, 1.0)  # sizes of the initial weights


class _Targets:
    """Targets ``(draws, runs, time, joint)``, with the mean and the spread of a trial's torques."""

    def __init__(self, trial: FilterTrial, draws: int):
        self.trial, self.draws = trial, draws
        x = trial.windows.reshape(len(trial.windows), -1)
        self.along = np.linalg.qr(np.column_stack([np.ones(len(x)), x]))[0]

    def scaled(self, target) -> np.ndarray:
        axes = {"axis": (-3, -2), "keepdims": True}
        torques = self.trial.torques
        relative = (target - target.mean(**axes)) / target.std(**axes)
        return torques.mean(**axes) + torques.std(**axes) * relative

    def fitted(self, target) -> np.ndarray:
        """What a linear filter of the windows, by least squares, makes of targets."""
        y = target.reshape(len(target), -1, target.shape[-1])
        return (self.along @ (self.along.T @ y)).reshape(target.shape)

    def process(self, time: float) -> np.ndarray:
        """Gaussian processes with a correlation of exp(-(s / time)² / 2) at a lag of s seconds."""
        runs, samples, joints = self.trial.torques.shape
        rng = np.random.default_rng(round(1000 * time))
        noise = rng.normal(size=(self.draws, runs, 3 * samples, joints))
        smooth = gaussian_filter1d(noise, time / np.sqrt(2) / LOG_STEP, axis=2)
        return self.scaled(smooth[:, :, samples : 2 * samples])

    def surrogates(self, kind: str) -> np.ndarray:
        return self.scaled(surrogates(kind, self.trial.torques, self.draws))

    def repeated(self, target, scaled: bool = True) -> np.ndarray:
        """One target of all cases for all networks."""
        target = target.reshape(self.trial.torques.shape)
        return np.repeat((self.scaled(target) if scaled else target)[None], self.draws, 0)

    def row(self) -> dict[str, np.ndarray]:
        """Targets by their names, from unrelated ones to the torques."""
        q, qd, qdd = np.moveaxis(self.trial.states[..., :3], -1, 0)
        setup = self.trial.setup
        friction = setup.effects.friction_torque(qd)
        return {
            **{f"Gaussian, {time:g} s": self.process(time) for time in _TIMES},
            **{kind: self.surrogates(kind) for kind in ("shuffled", "shifted", "phases")},
            "friction": self.repeated(friction),
            "friction, own size": self.repeated(friction, scaled=False),
            "position": self.repeated(q),
            "velocity": self.repeated(qd),
            "rigid arm": self.repeated(setup.arm.inverse_dynamics(q, qd, qdd)),
            "real torques": self.repeated(self.trial.torque),
        }

    def mixtures(self, target) -> list[np.ndarray]:
        """What the windows explain of a target, and what they leave of torques of random phases."""
        phases = self.surrogates("phases")
        own, rest = self.scaled(self.fitted(target)), self.scaled(phases - self.fitted(phases))
        return [self.scaled(np.sqrt(s) * own + np.sqrt(1 - s) * rest) for s in _SHARES]

    def learnt(self, targets: dict, seed: int) -> dict:
        """Networks of each target, all trained as one ensemble, and what became of them."""
        wanted = np.concatenate(list(targets.values()))
        weights, start = self.trial.train(wanted, seed)
        described = self.described(weights, start, wanted)
        parts = np.split(np.arange(len(wanted)), len(targets))
        return {
            name: {what: x[part] for what, x in described.items()}
            for name, part in zip(targets, parts)
        }

    def described(self, weights: Weights, start: Weights, wanted) -> dict:
        """Class shares of hidden filters and of what training added, one for each network.

        With shares of the variance that a linear filter explains and that was learnt, and how far
        the weights moved, relative to their start.
        """
        f, before = weights.hidden_weights, start.hidden_weights
        given = self.trial.model(weights).torque(self.trial.windows)
        residual = wanted.reshape(given.shape) - given
        counts = {"": names_counted(f), "added, ": names_counted(f - before)}
        variance = wanted.var((1, 2))
        return {
            "explained": (self.fitted(wanted).var((1, 2)) / variance).mean(-1),
            "learnt": 1 - (residual.var(1) / variance).mean(-1),
            "moved": np.sqrt(((f - before) ** 2).sum((1, 2, 3)) / (before**2).sum((1, 2, 3))),
            **{what + name: x for what, each in counts.items() for name, x in each.items()},
        }


@study
def _targets(members: int = 10, width: int = 21, epochs: int = TRIAL.epochs) -> dict:
    """Names of hidden filters by what was learnt, and by the size of the initial weights."""
    setup = replace(TRIAL, epochs=epochs)
    recording = setup.record()
    targets = _Targets(FilterTrial(setup, recording, width), members)
    row = targets.row()
    mixed = {
        (name, share): target
        for name in _MIXED
        for share, target in zip(_SHARES, targets.mixtures(row[name]))
    }
    learnt = targets.learnt({**row, **mixed}, 0)
    starts = [
        _Targets(FilterTrial(replace(setup, initial=size), recording, width), members).learnt(
            {name: row[name] for name in _MIXED}, 0
        )
        for size in _INITIAL
    ]
    return {
        **{"members": members, "width": width, "shares": _SHARES, "initial": _INITIAL},
        "targets": {name: learnt[name] for name in row},
        "mixed": {name: [learnt[name, share] for share in _SHARES] for name in _MIXED},
        "by initial": {name: [each[name] for each in starts] for name in _MIXED},
    }
