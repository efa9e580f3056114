"""A network that knows Lagrange's equation: Deep Lagrangian Networks (Lutter et al. 2019).

The network gives a lower triangle L(q) and a potential V(q). Then ``M = L L' + floor I`` is a mass
matrix, and ``tau = M qdd + dM/dt qd - d(qd' M qd / 2)/dq + dV/dq`` follows, whatever the weights
are: the model has an energy, and conserves it. Only torques are learnt from.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
import torch
from torch import nn
from torch.nn import functional

from beyond.rivals.protocol import Rival
from ddlib.identification import SIGN_SPEED

AS_PUBLISHED = {  # options like those of the public code; there 10,000 epochs follow
    "hidden": (64, 64),
    "gravity": "potential",
    "diagonal": "relu",
    "floor": 0.01,
    "gain": 2**0.5,
    "bias": 1e-3,
    "rate": 5e-4,
    "annealed": False,
    "batch": 512,
    "decay": 1e-5,
    "scaled": False,
}


class _Units(NamedTuple):
    """Units of inputs, torque and acceleration, whose root velocities have; errors' weights."""

    mean: np.ndarray
    spread: np.ndarray
    torque: float
    acceleration: float
    weights: np.ndarray

    @classmethod
    def of(cls, x, torque, scaled: bool) -> _Units:
        """Units that make states and torques of size 1, or do nothing if not `scaled`."""
        ones = np.ones(x.shape[1])
        if not scaled:
            return cls(0 * ones, ones, 1.0, 1.0, ones)
        size = float(np.sqrt((torque**2).mean())) or 1.0
        each = torque.std(0)
        spread = x[..., 0].std(0)
        return cls(
            x[..., 0].mean(0),
            np.where(spread > 0, spread, 1.0),
            size,
            float(np.sqrt((x[..., 2] ** 2).mean())) or 1.0,
            size / np.where(each > 0, each, size),
        )


class _Energies(nn.Module):
    """The network: from positions to a lower triangle, a gravity torque, and their derivatives."""

    def __init__(self, joints, hidden, gravity, diagonal, gain, bias, friction, generator):
        super().__init__()
        self.joints, self.gravity, self.diagonal = joints, gravity, diagonal
        self.triangle = joints * (joints + 1) // 2
        widths = (joints, *hidden)
        self.layers = nn.ModuleList(map(nn.Linear, widths, hidden))
        outputs = {"potential": 1, "vector": joints, "none": 0}[gravity]
        self.head = nn.Linear(hidden[-1], self.triangle + outputs)
        for layer in self.layers:
            _draw(layer.weight, 2**0.5, generator)
            nn.init.constant_(layer.bias, 1e-4)
        with torch.no_grad():
            for part in (slice(0, joints), slice(joints, self.triangle)):
                _draw(self.head.weight[part], gain, generator)
            _draw(self.head.weight[self.triangle :], 0.125, generator)
            self.head.bias.zero_()[:joints] = bias
        self.friction = nn.Parameter(torch.zeros(2, joints)) if friction else None
        # places of the outputs in the triangle: the diagonal first, then row by row
        places = torch.zeros(self.triangle, joints, joints)
        below = [(i, j) for i in range(joints) for j in range(i)]
        for k, (i, j) in enumerate([(i, i) for i in range(joints)] + below):
            places[k, i, j] = 1.0
        self.register_buffer("places", places.flatten(1))

    def forward(self, q, slope):
        """Triangle ``(n, j, j)``, its derivatives ``(k, n, j, j)``, gravity and potential."""
        x, d = q, torch.diag(slope)[:, None]
        for layer in self.layers:
            a = layer(x)
            x = functional.softplus(a)
            d = torch.sigmoid(a) * (d @ layer.weight.T)
        out, d = self.head(x), d @ self.head.weight.T
        joints = self.joints
        a, rest = out[:, :joints], out[:, joints : self.triangle]
        size, rate = functional.softplus(a), torch.sigmoid(a)
        if self.diagonal == "relu":
            size, rate = functional.relu(a), (a > 0).to(a)
        values = torch.cat([size, rest], 1)
        changes = torch.cat([rate * d[..., :joints], d[..., joints : self.triangle]], -1)
        lower, lower_slopes = (
            (v @ self.places).unflatten(-1, (joints, joints)) for v in (values, changes)
        )
        if self.gravity == "potential":
            return lower, lower_slopes, d[..., -1].T, out[:, -1]
        return (
            lower,
            lower_slopes,
            out[:, self.triangle :] if self.gravity == "vector" else None,
            None,
        )


class LagrangianNetwork(Rival):
    """A Deep Lagrangian Network, trained on states and torques.

    Adam on minibatches with squared weights as penalty, then, if asked for, L-BFGS in double
    precision on all cases. `AS_PUBLISHED` has the settings of the public code; the defaults differ
    in scaled units, a larger step that falls to zero along half a cosine, and a smooth diagonal.
    """

    def __init__(
        self,
        hidden: Sequence[int] = (64, 64),  # softplus units of each layer
        *,
        gravity: str = "potential",  # "vector": outputs as in the paper; or "none"
        friction: bool = False,  # whether to learn viscous and Coulomb friction, too
        diagonal: str = "softplus",  # or "relu": what keeps the diagonal of L from being negative
        floor: float = 1e-4,  # least eigenvalue of the mass matrix, in the network's units
        gain: float = 0.1,  # size of the output weights that make L when training starts
        bias: float = 0.5,  # what is added on the diagonal of L then
        epochs: int = 300,  # of Adam
        batch: int = 256,  # cases of a step; what is left of a pass is skipped
        rate: float = 5e-3,
        annealed: bool = True,  # whether the rate falls to zero
        decay: float = 0.0,  # penalty on squared weights
        finish: int = 0,  # iterations of L-BFGS
        scaled: bool = True,  # whether positions, accelerations and torques are scaled
        seed: int = 0,  # of the initial weights and the order of cases
        watch: Callable[[int, LagrangianNetwork], None] | None = None,  # after each epoch of Adam
    ):
        self.hidden, self.gravity_from, self.friction = hidden, gravity, friction
        self.diagonal, self.floor, self.gain, self.bias = diagonal, floor, gain, bias
        self.epochs, self.batch, self.rate, self.annealed = epochs, batch, rate, annealed
        self.decay, self.finish, self.scaled = decay, finish, scaled
        self.seed, self.watch = seed, watch

    def _fit(self, x, torque):
        joints = x.shape[1]
        self.units = _Units.of(x, torque, self.scaled)
        generator = torch.Generator().manual_seed(self.seed)
        start = self.gain, self.bias, self.friction, generator
        self.network = _Energies(joints, self.hidden, self.gravity_from, self.diagonal, *start)
        target = torque / self.units.torque
        self._descend(self._tensors(x), torch.tensor(target, dtype=torch.float32), generator)
        self.network.double()
        if self.finish:
            self._finish(self._tensors(x), torch.tensor(target))

    def _descend(self, states, target, generator):
        network, cases = self.network, len(target)
        batch = min(self.batch, cases)
        steps = cases // batch
        adam = torch.optim.Adam(
            network.parameters(), self.rate, weight_decay=self.decay, amsgrad=True, fused=True
        )
        falling = torch.optim.lr_scheduler.CosineAnnealingLR(adam, max(1, self.epochs * steps))
        for epoch in range(1, self.epochs + 1):
            order = torch.randperm(cases, generator=generator)
            for k in range(steps):
                chosen = order[k * batch : (k + 1) * batch]
                adam.zero_grad()
                self._loss([s[chosen] for s in states], target[chosen]).backward()
                adam.step()
                if self.annealed:
                    falling.step()
            if self.watch is not None:
                self.watch(epoch, self)

    def _finish(self, states, target):
        solver = torch.optim.LBFGS(
            self.network.parameters(),
            max_iter=self.finish,
            max_eval=2 * self.finish,
            history_size=50,
            tolerance_grad=0.0,
            tolerance_change=0.0,
            line_search_fn="strong_wolfe",
        )

        def closure():
            solver.zero_grad()
            loss = self._loss(states, target)
            loss.backward()
            return loss

        solver.step(closure)

    def _loss(self, states, target):
        weights = torch.as_tensor(self.units.weights).to(target)
        error = weights * (self._dynamics(*states) - target)
        return (error * error).sum(1).mean()

    def _tensors(self, x):
        """Scaled positions, velocities, accelerations and signs, as the network's numbers."""
        q, qd, qdd = np.moveaxis(x, -1, 0)
        time = np.sqrt(self.units.acceleration)
        sign = np.clip(qd / SIGN_SPEED, -1.0, 1.0)
        scaled = ((q - self.units.mean) / self.units.spread, qd / time, qdd / time**2, sign)
        return [torch.tensor(s).to(self.network.places) for s in scaled]

    def _dynamics(self, q, qd, qdd, sign):
        slope = torch.tensor(1 / self.units.spread).to(q)
        lower, lower_slopes, gravity, _ = self.network(q, slope)
        along, pushed = _across(lower, qd), _across(lower, qdd)
        turned = _across(lower_slopes, qd)  # dL_k' qd, (k, n, joint)
        speed = qd.T[:, :, None]
        rate = (lower_slopes * speed[..., None]).sum(0)  # dL/dt
        torque = _times(lower, pushed + (turned * speed).sum(0)) + _times(rate, along)
        torque = torque - (turned * along).sum(-1).T + self.floor * qdd
        if gravity is not None:
            torque = torque + gravity
        if self.network.friction is not None:
            viscous, coulomb = self.network.friction
            torque = torque + viscous * qd + coulomb * sign
        return torque

    def _torque(self, x):
        with torch.no_grad():
            return self.units.torque * self._dynamics(*self._tensors(x)).double().numpy()

    def _parts(self, q):
        """Triangle, its derivatives by position, gravity and potential, in scaled units."""
        flat = (q.reshape(-1, q.shape[-1]) - self.units.mean) / self.units.spread
        position = torch.tensor(flat).to(self.network.places)
        with torch.no_grad():
            parts = self.network(position, torch.tensor(1 / self.units.spread).to(position))
        return q.shape[:-1], [None if f is None else f.double().numpy() for f in parts]

    def triangle(self, q) -> np.ndarray:
        """L(q), ``(..., joint, joint)``, in the network's units."""
        lead, (lower, *_) = self._parts(q)
        return lower.reshape(*lead, *lower.shape[1:])

    def mass_matrix(self, q) -> np.ndarray:
        """The mass matrix that was learnt, ``(..., joint, joint)``, at `q` in rad; kg m^2."""
        lower = self.triangle(q)
        mass = lower @ np.swapaxes(lower, -1, -2) + self.floor * np.eye(lower.shape[-1])
        return self.units.torque / self.units.acceleration * mass

    def potential_energy(self, q) -> np.ndarray:
        """Potential that was learnt, but for a constant, shape ``(...)``, J."""
        lead, (*_, potential) = self._parts(q)
        return self.units.torque * potential.reshape(lead)

    def count(self):
        """Stored numbers: the weights, and the units if scaled."""
        numbers = sum(p.numel() for p in self.network.parameters())
        return numbers + (2 * self.network.joints + 2 if self.scaled else 0)


def _across(lower, x):
    """``L' x`` of matrices ``(..., n, j, j)`` and vectors ``(n, j)``."""
    return (lower * x[:, :, None]).sum(-2)


def _times(lower, x):
    """``L x`` of matrices ``(n, j, j)`` and vectors ``(n, j)``."""
    return (lower * x[:, None]).sum(-1)


def _draw(weight, gain, generator):
    """Glorot's normal draw, in place."""
    if weight.numel():
        outputs, inputs = weight.shape
        with torch.no_grad():
            weight.normal_(0.0, gain * (2.0 / (inputs + outputs)) ** 0.5, generator=generator)
