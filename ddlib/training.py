"""Batch gradient descent with acceleration (momentum), as in 1988 (section 3.3).

``dw(t) = -eps dE/dw + alpha dw(t-1)`` with ``E`` half the summed squared error of all
cases and outputs (Rumelhart, Hinton & Williams 1986). `train` is the reference for
one network, by autograd; `train_ensemble` does the same sums for many at once.
"""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field

import numpy as np
import torch
from tqdm.auto import tqdm

from ddlib._check import finite_array, integer, number
from ddlib.metrics import rmss
from ddlib.network import TorqueModel, Weights, WindowNetwork
from ddlib.simulate import Recording
from ddlib.windows import Scaler, sliding_windows

TARGET_RANGE = (0.2, 0.8)
"""Range of the output units that the torques are scaled to (Lang 1988)."""


WORKERS = min(2, os.cpu_count() or 1)
"""Threads that `train_ensemble` uses."""


@dataclass(frozen=True)
class TrainingSet:
    """Scaled windows and torques, with the scaling that made them.

    Attributes
    ----------
    x : ndarray, shape (cases, joint, width)
        Windows scaled to 0..1 over the training cases.
    y : ndarray, shape (cases, joint)
        Torques scaled to the output units' range.
    inputs, outputs : Scaler
        Radians to `x` and N m to `y`.
    """

    x: np.ndarray
    y: np.ndarray
    inputs: Scaler
    outputs: Scaler

    @classmethod
    def from_arrays(cls, windows, torque, target=TARGET_RANGE) -> TrainingSet:
        """Scale windows ``(cases, joint, width)`` in rad and torques ``(cases, joint)`` in N m."""
        windows, torque = finite_array("windows", windows), finite_array("torque", torque)
        if windows.ndim != 3 or torque.ndim != 2 or len(windows) != len(torque):
            raise ValueError(
                "windows and torque must have shapes (cases, joint, width) and (cases, joint), "
                f"got {windows.shape} and {torque.shape}"
            )
        inputs, outputs = Scaler.fit(windows, joint_axis=-2), Scaler.fit(torque, target)
        return cls(inputs.scale(windows, -2), outputs.scale(torque), inputs, outputs)

    @classmethod
    def from_recording(cls, recording: Recording, width: int, target=TARGET_RANGE) -> TrainingSet:
        """All windows of the motions of a recording, runs joined into one list of cases."""
        return cls.from_arrays(*cases(recording, width), target)

    def transform(self, windows, torque) -> tuple[np.ndarray, np.ndarray]:
        """Other windows (rad) and torques (N m) with this set's scaling."""
        return self.inputs.scale(windows, -2), self.outputs.scale(torque)


def cases(recording: Recording, width: int) -> tuple[np.ndarray, np.ndarray]:
    """Windows and torques of the motions of a recording, unscaled.

    Returns
    -------
    windows : ndarray, shape (cases, joint, width)
        Measured positions, rad.
    torque : ndarray, shape (cases, joint)
        Measured torques, N m.
    """
    windows = sliding_windows(recording.q, width, recording.motion)
    torque = recording.tau[..., recording.motion, :]
    return windows.reshape(-1, *windows.shape[-2:]), torque.reshape(-1, torque.shape[-1])


@dataclass
class History:
    """Errors along a training run.

    Attributes
    ----------
    epochs : ndarray, shape (points,)
        Epochs at which the errors were taken.
    training, test : ndarray, shape (points, members)
        Pooled RMSS; `test` is normalised by the test set's own standard deviation
        and empty if there is no test set.
    """

    epochs: np.ndarray = field(default_factory=lambda: np.zeros(0, int))
    training: np.ndarray = field(default_factory=lambda: np.zeros((0, 0)))
    test: np.ndarray = field(default_factory=lambda: np.zeros((0, 0)))

    def append(self, epoch: int, training, test=None) -> None:
        """Add one point."""
        training = np.atleast_1d(training)
        self.epochs = np.append(self.epochs, epoch)
        self.training = np.vstack([self.training.reshape(-1, len(training)), training])
        if test is not None:
            test = np.atleast_1d(test)
            self.test = np.vstack([self.test.reshape(-1, len(test)), test])

    @property
    def best_test(self) -> np.ndarray:
        """Smallest test error on the way, per member."""
        return np.nanmin(self.test, axis=0)

    @property
    def derailed(self) -> np.ndarray:
        """Members that end worse than a constant guess (RMSS over 1) or not finite."""
        return ~(self.training[-1] < 1.0)

    def slope(self) -> np.ndarray:
        """``d ln(error) / d ln(epoch)`` at the end of the run, per member.

        Taken between the last point and the one nearest to half its epoch. The paper
        trains "to the point where the derivative of the error was nearly zero".
        """
        half = int(np.argmin(np.abs(self.epochs - self.epochs[-1] / 2)))
        ratio = np.log(self.training[-1] / self.training[half])
        return ratio / np.log(self.epochs[-1] / self.epochs[half])


class TrainingDiverged(RuntimeError):
    """Descent blew up; `history` keeps what was recorded until then."""

    def __init__(self, message: str, history: History):
        super().__init__(message)
        self.history = history


def default_rate(width: int) -> float:
    """Step size per case for a window of `width` samples: 33 / width.

    Larger windows mean more inputs that rise and fall together, hence a steeper error
    surface; a step in inverse proportion to the fan-in keeps descent stable for most
    initial weights, and a few networks still saturate early (`History.derailed`). It is
    this book's choice: the paper does not print its rates.
    """
    return 33.0 / integer("width", width, 1)


def check_points(epochs: int, points: int = 60) -> np.ndarray:
    """Epochs at which errors are recorded: about `points`, equally spaced on a log scale."""
    return np.unique(np.round(np.geomspace(1, epochs, points)).astype(int))


def _check(rate, momentum, epochs):
    number("rate", rate, 0.0, open_low=True)
    number("momentum", momentum, 0.0, 0.999)
    integer("epochs", epochs, 1)


def train(
    network: WindowNetwork, x, y, *, rate, momentum=0.95, epochs=1000, progress=True
) -> History:
    """Train one network in place by autograd: the plain reference.

    Parameters
    ----------
    network : WindowNetwork
    x, y : array_like, shapes (cases, joint, width) and (cases, output)
        Scaled windows and targets.
    rate : float
        Step size per case: ``eps = rate / cases``.
    momentum : float
        The factor alpha of the previous step, 0 to 0.999.
    epochs : int
        Passes over all cases, one step each.
    progress : bool
        Show a progress bar.

    Returns
    -------
    History
        Training errors before the step of each noted epoch, since they cost nothing
        there; `train_ensemble` takes them after it.

    Raises
    ------
    TrainingDiverged
        If the error is no longer finite.
    ValueError
        If an option is out of range.
    """
    _check(rate, momentum, epochs)
    x, y = finite_array("x", x), finite_array("y", y)
    if y.ndim != 2 or len(y) != len(x) or (np.ptp(y, axis=0) == 0).any():
        raise ValueError(
            f"y must have shape ({len(x)}, output) like x and vary in each column, got {y.shape}"
        )
    x, y = (torch.as_tensor(array, dtype=torch.float32) for array in (x, y))
    spread = y.std(0, correction=0)
    optimiser = torch.optim.SGD(network.parameters(), lr=rate / len(x), momentum=momentum)
    history, points = History(), set(check_points(epochs))
    bar = tqdm(range(1, epochs + 1), desc="epochs", disable=not progress)
    for epoch in bar:
        optimiser.zero_grad()
        error = network(x) - y
        loss = 0.5 * error.square().sum()
        loss.backward()
        optimiser.step()
        if epoch in points:
            value = float((error.detach() / spread).square().mean().sqrt())
            history.append(epoch, value)
            bar.set_postfix(rmss=f"{value:.3f}")
            if not np.isfinite(value):
                raise TrainingDiverged(
                    f"the error is not finite at epoch {epoch}: lower the rate ({rate:g})", history
                )
    return history


class _Ensemble:
    """Gradient descent of many networks on the same cases.

    The input-to-hidden and direct weights of all members share one product with the
    inputs: rows of `first` are member by member the hidden units, then the outputs,
    with the bias as the last column.
    """

    def __init__(self, weights: Weights, x, y):
        n, self.hidden = weights.hidden_bias.shape
        self.shape = weights.hidden_weights.shape[-2:]
        inputs = int(np.prod(self.shape))
        hidden = weights.hidden_weights.reshape(n, self.hidden, inputs)
        skip = weights.skip_weights.reshape(n, -1, inputs)
        columns = np.concatenate([hidden, skip], 1)
        biases = np.concatenate([weights.hidden_bias, weights.output_bias], 1)
        first = np.concatenate([columns, biases[..., None]], -1)
        self.first = torch.tensor(first, dtype=torch.float32)
        self.second = torch.tensor(weights.output_weights, dtype=torch.float32)
        x = torch.as_tensor(x.reshape(len(x), -1), dtype=torch.float32)
        self.x = torch.cat([x, torch.ones(len(x), 1)], 1).contiguous()
        self.xt = self.x.T.contiguous()
        self.yt = torch.as_tensor(y, dtype=torch.float32).T.contiguous()
        self.step_first = torch.zeros_like(self.first)
        self.step_second = torch.zeros_like(self.second)
        self.net = torch.empty(n, first.shape[1], len(x))
        self.back = torch.empty(n, self.hidden, len(x))

    def epoch(self, eps: float, momentum: float) -> None:
        """One step of every member, in place."""
        n, rows, inputs = self.first.shape
        torch.mm(self.first.view(n * rows, inputs), self.xt, out=self.net.view(n * rows, -1))
        hidden, output = self.net[:, : self.hidden], self.net[:, self.hidden :]
        hidden.sigmoid_()
        output.baddbmm_(self.second, hidden).sigmoid_()
        delta = (output - self.yt).mul_(output - output * output)
        gradient_second = torch.bmm(delta, hidden.transpose(1, 2))
        torch.bmm(self.second.transpose(1, 2), delta, out=self.back)
        self.back.mul_(hidden)
        torch.addcmul(self.back, self.back, hidden, value=-1, out=hidden)
        output.copy_(delta)
        gradient_first = torch.mm(self.net.view(n * rows, -1), self.x).view_as(self.first)
        self.step_first.mul_(momentum).add_(gradient_first, alpha=-eps)
        self.step_second.mul_(momentum).add_(gradient_second, alpha=-eps)
        self.first.add_(self.step_first)
        self.second.add_(self.step_second)

    def weights(self) -> Weights:
        """All members as plain arrays."""
        first = self.first.numpy().astype(float)
        hidden, skip = first[:, : self.hidden, :-1], first[:, self.hidden :, :-1]
        bias = first[..., -1]
        return Weights(
            hidden.reshape(*hidden.shape[:2], *self.shape),
            bias[:, : self.hidden],
            self.second.numpy().astype(float),
            skip.reshape(*skip.shape[:2], *self.shape),
            bias[:, self.hidden :],
        )


def train_ensemble(
    weights: Weights,
    data: TrainingSet,
    *,
    test: tuple | None = None,
    rate: float | None = None,
    momentum: float = 0.95,
    epochs: int = 20_000,
    snapshots=(),
    progress: bool = True,
    label: str = "training",
) -> tuple[TorqueModel, History, dict[int, Weights]]:
    """Train many networks on the same cases by the rule of `train`.

    Parameters
    ----------
    weights : Weights
        Initial weights with a leading axis of members.
    data : TrainingSet
        Cases and scaling.
    test : tuple of ndarray, optional
        Scaled windows and targets (`TrainingSet.transform`) on which to follow the error.
    rate : float, optional
        Step size per case; default `default_rate` of the window.
    momentum, epochs
        As in `train`.
    snapshots : sequence of int
        Epochs after which a copy of all weights is kept (0: the initial ones).
    progress : bool
        Show a progress bar with the median error.
    label : str
        What the bar says.

    Returns
    -------
    model : TorqueModel
        The trained ensemble.
    history : History
        Errors of every member; `History.derailed` marks those that went astray. They
        do not disturb the others.
    snapshots : dict
        Weights by epoch.

    Raises
    ------
    TrainingDiverged
        If no member's error is finite any more.
    """
    rate = default_rate(weights.width) if rate is None else rate
    _check(rate, momentum, epochs)
    if weights.hidden_weights.shape[-2:] != data.x.shape[-2:]:
        raise ValueError(
            f"weights must have the joints and width of the data, {data.x.shape[-2:]}, "
            f"got {weights.hidden_weights.shape[-2:]}"
        )
    blocks = np.array_split(np.arange(len(weights)), min(WORKERS, len(weights)))
    bar = tqdm(total=epochs, desc=label, disable=not progress, mininterval=0.5)

    def work(block):
        leader = bar if block[0] == 0 else None
        return _train_block(
            weights[block], data, test, rate, momentum, epochs, set(snapshots), leader
        )

    threads = torch.get_num_threads()
    torch.set_num_threads(1)  # one core for each block: no waiting at every product
    try:
        with ThreadPoolExecutor(len(blocks)) as pool:
            parts = list(pool.map(work, blocks))
    finally:
        torch.set_num_threads(threads)
        bar.close()
    trained, histories, kept = zip(*parts)
    history = History(
        histories[0].epochs,
        np.hstack([h.training for h in histories]),
        np.hstack([h.test for h in histories]),
    )
    if not np.isfinite(history.training[-1]).any():
        raise TrainingDiverged(
            f"no member's error is finite after {epochs} epochs: lower the rate ({rate:g})", history
        )
    model = TorqueModel(Weights.concatenate(trained), data.inputs, data.outputs)
    return model, history, {e: Weights.concatenate([k[e] for k in kept]) for e in kept[0]}


def _train_block(weights, data, test, rate, momentum, epochs, snapshots, bar):
    """Train some members in this thread; `bar`, if any, is told how far it is."""
    torch.set_num_threads(1)
    ensemble = _Ensemble(weights, data.x, data.y)
    history, points = History(), set(check_points(epochs))
    kept = {0: weights} if 0 in snapshots else {}
    eps = rate / len(data.x)
    for epoch in range(1, epochs + 1):
        ensemble.epoch(eps, momentum)
        if bar is not None and epoch % 50 == 0:
            bar.update(50)
        if epoch in snapshots:
            kept[epoch] = ensemble.weights()
        if epoch in points:
            current = ensemble.weights()
            errors = [_error(current, *pair) for pair in ([(data.x, data.y)] + [test] * bool(test))]
            history.append(epoch, *errors)
            if bar is not None:
                bar.set_postfix(median_rmss=f"{np.nanmedian(errors[0]):.3f}", refresh=False)
    return ensemble.weights(), history, kept


def _error(weights: Weights, x, y) -> np.ndarray:
    """Pooled RMSS per member; NaN for members whose weights are not finite."""
    fine = np.isfinite(weights.hidden_weights).all((-3, -2, -1))
    fine &= np.isfinite(weights.output_weights).all((-2, -1))
    errors = np.full(len(fine), np.nan)
    if fine.any():
        errors[fine] = rmss(weights[fine].activity(x)[1], y)
    return errors
