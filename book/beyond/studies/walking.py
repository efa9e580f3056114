"""Copies of the actuator network of a walking robot, and networks that learnt shuffled pairs."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import torch

from workshop import BOOK
from workshop.report.code_hash import study

STEP = 0.005
"""Seconds between two entries of an error's history."""

_UNITS = 32
_MEMBERS, _CASES, _EPOCHS, _LONGER, _RATE = 10, 1500, 1500, 20_000, 0.01
_HOLD = 4  # samples for which a target stays that jumps: of a policy of 50 Hz
_SIZES, _FREQUENCIES = (0.0, 0.15), (0.5, 8.0)  # of a sine in a history: rad, Hz


def layers(file: str = "unitree-go1-actuator") -> list[tuple[np.ndarray, np.ndarray]]:
    """Weights and biases of the published network, layer by layer."""
    with np.load(BOOK / "data" / f"{file}.npz") as stored:
        return [(stored[f"{k}_weight"], stored[f"{k}_bias"]) for k in (0, 2, 4)]


def torque(x, network) -> np.ndarray:
    """Torque (N m) for histories of error and velocity at lags 0, 1, 2, shape (cases, 6)."""
    for k, (weight, bias) in enumerate(network):
        x = x @ weight.T + bias
        x = x / (1 + np.abs(x)) if k < len(network) - 1 else x
    return x[..., 0]


def gradient(x, network) -> np.ndarray:
    """Change of the torque with each entry of the histories, shape (cases, 6)."""
    chain = np.eye(x.shape[-1])
    for k, (weight, bias) in enumerate(network):
        x, chain = x @ weight.T + bias, weight @ chain
        if k < len(network) - 1:
            chain = chain / (1 + np.abs(x))[..., None] ** 2
            x = x / (1 + np.abs(x))
    return chain[..., 0, :]


def _histories(cases: int, seed: int, target: str = "smooth") -> np.ndarray:
    """Histories of three sines in position and three in target, shape (cases, 6).

    A "held" target has its sines' values of every 20 ms, a "fixed" one stays as it is.
    """
    rng, t = np.random.default_rng(seed), -STEP * np.arange(3)
    error, velocity = np.zeros((2, cases, 3))
    when = 0 * t if target == "fixed" else t
    if target == "held":
        since = np.arange(cases)[:, None] % _HOLD  # samples since the last jump
        when = -STEP * (since + _HOLD * np.ceil((np.arange(3) - since) / _HOLD))
    for _ in range(3):
        swings, wanted = rng.uniform(*_SIZES, (2, cases, 1))
        w = 2 * np.pi * rng.uniform(*_FREQUENCIES, (cases, 1))
        first, second = rng.uniform(0, 2 * np.pi, (2, cases, 1))
        error += swings * np.sin(w * t + first) - wanted * np.sin(w * when + second)
        velocity += swings * w * np.cos(w * t + first)
    return np.concatenate([error, velocity], axis=1)


def trained_copy(x, y, seed: int, longer: bool = False) -> tuple[list, float]:
    """A network of the same sizes that learnt y from x, and its training RMSS.

    The longer training is annealed, and in single precision, which takes half the time.
    """
    generator = torch.Generator().manual_seed(seed)
    sizes = (x.shape[1], _UNITS, _UNITS, 1)
    kind = torch.float32 if longer else torch.float64
    start = [
        ((2 * torch.rand(n, m + 1, generator=generator) - 1).to(kind) / m**0.5).requires_grad_()
        for m, n in pairwise(sizes)
    ]
    middle, spread = x.mean(0), x.std(0)
    z, goal = (
        torch.tensor(a, dtype=kind) for a in ((x - middle) / spread, (y - y.mean()) / y.std())
    )

    def output():
        h = z
        for k, w in enumerate(start):
            h = h @ w[:, :-1].T + w[:, -1]
            h = torch.nn.functional.softsign(h) if k < 2 else h
        return h[:, 0]

    descent = torch.optim.Adam(start, _RATE)
    epochs = _LONGER if longer else _EPOCHS
    slower = torch.optim.lr_scheduler.CosineAnnealingLR(descent, epochs)
    for _ in range(epochs):
        descent.zero_grad()
        loss = ((output() - goal) ** 2).mean()
        loss.backward()
        descent.step()
        if longer:
            slower.step()
    arrays = [w.detach().double().numpy() for w in start]
    copy = [(w[:, :-1].copy(), w[:, -1].copy()) for w in arrays]
    copy[0] = copy[0][0] / spread, copy[0][1] - copy[0][0] / spread @ middle
    copy[-1] = copy[-1][0] * y.std(), copy[-1][1] * y.std() + y.mean()
    return copy, float(np.sqrt(loss.detach()))


@study
def _walking() -> dict:
    """Mean gradients of the network, of copies, of networks on shuffled pairs, of random ones.

    Copies learn from smooth histories, for longer from the same, or from those of other targets.
    """
    network, x = layers(), _histories(_CASES, seed=0)
    y, rows = torque(x, network), {}
    others = {target: _histories(_CASES, 0, target) for target in ("held", "fixed")}
    for seed in range(_MEMBERS):
        shuffled = np.random.default_rng(seed).permutation(y)
        learnt = {"copies": (x, y), "shuffled": (x, shuffled), "longer": (x, y)}
        learnt |= {target: (z, torque(z, network)) for target, z in others.items()}
        for name, (z, goal) in learnt.items():
            copy, error = trained_copy(z, goal, seed, name == "longer")
            row = {"error": error, "gradient": gradient(z, copy).mean(0)}
            rows.setdefault(name, []).append(row)
    drawn = []
    for seed in range(100):
        rng = np.random.default_rng(seed)
        random = [
            (rng.uniform(-1, 1, w.shape) / w.shape[1] ** 0.5, rng.uniform(-1, 1, b.shape))
            for w, b in network
        ]
        drawn.append(gradient(x, random).mean(0) * y.std() / torque(x, random).std())
    own = gradient(x, network).mean(0)
    by_target = {f"network, {target}": gradient(z, network).mean(0) for target, z in others.items()}
    return {"step": STEP, "network": own, **by_target, "random": np.array(drawn), **rows}
