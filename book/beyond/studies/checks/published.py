"""Characters: the ten published Lagrangian networks by their weights, and larger plain networks."""

import numpy as np
import torch
from torch import nn

from beyond.others import DATA
from beyond.studies.characters import SEEDS, SPLITS, data, states, tested
from workshop.report.code_hash import study

_TEN = 10  # published networks, by their seeds
_SHIFT, _FLOOR = 2.0, 0.1  # of the diagonal of L
_HIDDEN, _STEPS = 32, 2000  # tanh units of both layers of a plain network; iterations of L-BFGS


def _published(seed: int) -> dict[str, np.ndarray]:
    """Weights of a published network."""
    with np.load(DATA / "delan-published.npz") as file:
        return {name: values[seed].astype(float) for name, values in file.items()}


def _layers(weights: dict, part: str, q) -> tuple[np.ndarray, np.ndarray]:
    """Outputs ``(cases, output)`` of a network of cos q, sin q, and their slopes by each angle."""
    cos, sin, one = np.cos(q), np.sin(q), np.eye(q.shape[-1])
    x = np.concatenate([cos, sin], -1)
    slope = np.concatenate([-sin[..., None] * one, cos[..., None] * one], -1)
    for k in range(3):
        w, b = (weights[f"{part}_linear_{k}_{name}"] for name in "wb")
        x, slope = x @ w + b, slope @ w
        if k < 2:
            x = np.tanh(x)
            slope = slope * (1 - x**2)[:, None]
    return x, slope


def _lagrangian(weights: dict, x) -> np.ndarray:
    """Torques at states ``(cases, 2, 3)``, the first angle from the horizontal."""
    q, speed, pushed = np.moveaxis(x, -1, 0)
    out, slope = _layers(weights, "mass_matrix", q)
    lower, lower_slopes = np.zeros((len(q), 2, 2)), np.zeros((len(q), 2, 2, 2))
    for j in range(2):
        lower[:, j, j] = np.logaddexp(0, out[:, j] + _SHIFT) + _FLOOR
        lower_slopes[..., j, j] = slope[..., j] / (1 + np.exp(-out[:, j, None] - _SHIFT))
    lower[:, 1, 0], lower_slopes[..., 1, 0] = out[:, 2], slope[..., 2]
    half = lower_slopes @ lower.mT[:, None]
    along = ((half + half.mT) @ speed[:, None, :, None])[..., 0]  # (cases, angle, joint)
    torque = (lower @ lower.mT @ pushed[..., None])[..., 0] + (along * speed[..., None]).sum(1)
    gravity = _layers(weights, "potential_energy", q)[1][..., 0]
    return torque - (along * speed[:, None]).sum(-1) / 2 + gravity


def _inputs(x) -> np.ndarray:
    q, speed, pushed = np.moveaxis(x, -1, 0)
    return np.concatenate([np.cos(q), np.sin(q), speed, pushed], -1)


def _plain(cases, seed: int) -> tuple:
    """Torque of a plain network trained on cases, and how many weights it has."""
    given, torque = _inputs(cases.x), cases.torque
    centre, size, mean, spread = given.mean(0), given.std(0), torque.mean(0), torque.std(0)
    with torch.random.fork_rng(devices=[]):
        torch.manual_seed(seed)
        layers = [nn.Linear(given.shape[1], _HIDDEN), nn.Tanh(), nn.Linear(_HIDDEN, _HIDDEN)]
        layers += [nn.Tanh(), nn.Linear(_HIDDEN, torque.shape[1])]
    network = nn.Sequential(*layers).double()
    scaled, wanted = map(torch.tensor, ((given - centre) / size, (torque - mean) / spread))
    solver = torch.optim.LBFGS(
        network.parameters(), max_iter=_STEPS, max_eval=2 * _STEPS, history_size=50,
        tolerance_grad=0.0, tolerance_change=0.0, line_search_fn="strong_wolfe",
    )  # fmt: skip

    def closure():
        solver.zero_grad()
        loss = (network(scaled) - wanted).square().sum(1).mean()
        loss.backward()
        return loss

    solver.step(closure)

    def answer(x):
        return mean + spread * network(torch.tensor((_inputs(x) - centre) / size)).detach().numpy()

    return answer, sum(values.numel() for values in network.parameters())


@study
def _characters_published() -> dict:
    """Errors on the test characters, as in the study of characters; published for one split."""
    _, test = data().split()
    turned = states(test).x[0] - states(test, 0.0).x[0]
    ten = [_published(seed) for seed in range(_TEN)]
    lagrangian = [tested(lambda x, w=w: _lagrangian(w, x - turned), test) for w in ten]
    stored = sum(values.size for values in ten[0].values())
    result: dict = {"published": {"count": stored, "loader": lagrangian}, "plain": {}}
    for split, labels in SPLITS.items():
        training, test = data().split(labels)
        networks = [_plain(states(training), seed) for seed in range(SEEDS)]
        result["plain"] |= {
            split: [tested(torque, test) for torque, _ in networks],
            "count": networks[0][1],
        }
    return result
