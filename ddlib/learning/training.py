"""Batch gradient descent with acceleration (momentum), as in 1988 (section 3.3).

``dw(t) = -eps dE/dw + alpha dw(t-1)`` with ``E`` half the summed squared error of all
cases and outputs (Rumelhart, Hinton & Williams 1986). `train` is the reference for
one network, by autograd; `train_ensemble` does the same sums for many at once.
"""

from __future__ import annotations

import math
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace

import numpy as np
import torch
from tqdm.auto import tqdm

from ddlib._check import finite_array, integer, number, shaped
from ddlib.learning.descent import Descent, prepare
from ddlib.learning.network import TorqueModel, Weights, WindowNetwork
from ddlib.learning.windows import Scaler, sliding_windows
from ddlib.simulation import Recording

TARGET_RANGE = (0.2, 0.8)
"""Range of the output units that the torques are scaled to (Lang 1988)."""

WORKERS = min(2, torch.get_num_threads())
"""Threads that `train_ensemble` uses: as many as torch may (OMP_NUM_THREADS), two at most."""
BLOCK = 8
"""Most members that a thread trains side by side: what fits into a core's cache."""


@dataclass(frozen=True)
class TrainingSet:
    """Scaled windows and torques, with the scaling that made them.

    Attributes
    ----------
    x : ndarray, shape (cases, joint, width)
        Windows scaled to a range, 0..1 by default, over the training cases.
    y : ndarray, shape (cases, joint)
        Torques scaled to the output units' range.
    inputs, outputs : Scaler
        Radians to `x` and N m to `y`.
    step : float, optional
        Sampling period of the windows, s, if known.
    """

    x: np.ndarray
    y: np.ndarray
    inputs: Scaler
    outputs: Scaler
    step: float | None = None

    @classmethod
    def from_arrays(cls, windows, torque, target=TARGET_RANGE, scaling=(0.0, 1.0)) -> TrainingSet:
        """Scale windows ``(cases, joint, width)``, rad, to `scaling`, torques, N m, to `target`."""
        windows = shaped("windows", windows, "(cases, joint, width)")
        torque = shaped("torque", torque, f"({len(windows)}, joint)")
        inputs, outputs = Scaler.fit(windows, scaling, -2), Scaler.fit(torque, target)
        return cls(inputs.scale(windows, -2), outputs.scale(torque), inputs, outputs)

    @classmethod
    def from_recording(cls, recording: Recording, width: int, *options, **named) -> TrainingSet:
        """All windows of the motions of a recording, runs joined; options of `from_arrays`."""
        made = cls.from_arrays(*cases(recording, width), *options, **named)
        return replace(made, step=recording.step)

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
        self.epochs = np.append(self.epochs, epoch)
        for name, errors in (("training", training), ("test", test)):
            if errors is not None:
                before = getattr(self, name).reshape(-1, np.size(errors))
                setattr(self, name, np.vstack([before, np.atleast_1d(errors)]))

    @property
    def best_test(self) -> np.ndarray:
        """Smallest test error on the way, per member; NaN if none is finite."""
        if not self.test.size:
            raise ValueError("history has no test errors: give `test` to train_ensemble")
        return np.fmin.reduce(self.test, axis=0)

    @property
    def derailed(self) -> np.ndarray:
        """Members that end worse than a constant guess (RMSS over 1) or not finite."""
        return ~(self.training[-1] < 1.0)

    def slope(self) -> np.ndarray:
        """``d ln(error) / d ln(epoch)`` at the end of the run, per member.

        Taken between the last point and the one nearest to half its epoch. The paper
        trains "to the point where the derivative of the error was nearly zero".
        """
        if len(self.epochs) < 2:
            raise ValueError(f"history must hold two points or more, got {len(self.epochs)}")
        half = int(np.argmin(np.abs(self.epochs - self.epochs[-1] / 2)))
        ratio = np.log(self.training[-1] / self.training[half])
        return ratio / np.log(self.epochs[-1] / self.epochs[half])

    def settled(self, steepest: float = 0.1) -> np.ndarray:
        """Members at their asymptote: error over epochs no steeper than `steepest`.

        The criterion is on a log-log scale (`slope`): with 0.1, twice the epochs would
        lower the error by less than 7 %. A derailed member counts as settled if it rests.
        """
        number("steepest", steepest, 0.0)
        return np.abs(self.slope()) <= steepest


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


WARM_UP_MOMENTUM = 0.5
"""Momentum of the first epochs; Lang (1988) began with it."""

MAX_RATE = 1e38
"""Largest step size that single precision can hold."""


def _check(rate, momentum, epochs):
    number("rate", rate, 0.0, MAX_RATE, open_low=True)
    number("momentum", momentum, 0.0, 0.999)
    integer("epochs", epochs, 1)


def _per_member(rate, momentum, epochs, members):
    """Checked rates and momenta as arrays of shape (members,)."""
    arrays = [finite_array("rate", rate), finite_array("momentum", momentum)]
    for name, array in zip(("rate", "momentum"), arrays):
        if array.shape not in ((), (members,)):
            raise ValueError(f"{name} must be one number or {members}, got shape {array.shape}")
    for pair in np.broadcast(*arrays):
        _check(*map(float, pair), epochs)
    return [np.broadcast_to(array, members) for array in arrays]


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
        Passes over all cases, a step each.
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


def train_ensemble(
    weights: Weights,
    data: TrainingSet,
    *,
    test: tuple | None = None,
    targets=None,
    rate=None,
    momentum=0.95,
    epochs: int = 20_000,
    warm_up: int = 0,
    snapshots=(),
    progress: bool = True,
    label: str = "training",
) -> tuple[TorqueModel, History, dict[int, Weights]]:
    """Train many networks on the same windows by the rule of `train`.

    Parameters
    ----------
    weights : Weights
        Initial weights with a leading axis of members.
    data : TrainingSet
        Cases and scaling.
    test : tuple of ndarray, optional
        Scaled windows and targets (`TrainingSet.transform`) on which to follow the error.
    targets : array_like, shape (members, cases, output), optional
        Scaled targets of each member in place of ``data.y``, for instance with noise of
        different levels. Errors are relative to the spread of ``data.y`` all the same.
    rate : float or array_like, shape (members,), optional
        Step size per case, one for all or one per member; default `default_rate`.
    momentum : float or array_like, shape (members,)
        The factor alpha of the previous step, 0 to 0.999.
    epochs : int
        As in `train`.
    warm_up : int
        Epochs at the start with a momentum of `WARM_UP_MOMENTUM`, if that is smaller. Large
        steps before the units have found their parts saturate them for good.
    snapshots : sequence of int
        Epochs after which a copy of all weights is kept (0: the initial ones).
    progress : bool
        Show a progress bar with the median error and the time left.
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
    ValueError
        If an option is out of range or shapes do not fit.
    """
    members = len(weights)
    rate = default_rate(weights.width) if rate is None else rate
    rate, momentum = _per_member(rate, momentum, epochs, members)
    if weights.hidden_weights.shape[-2:] != data.x.shape[-2:]:
        raise ValueError(
            f"weights must have the joints and width of the data, {data.x.shape[-2:]}, "
            f"got {weights.hidden_weights.shape[-2:]}"
        )
    if targets is not None:
        targets = shaped("targets", targets, (members, *data.y.shape))
    integer("warm_up", warm_up, 0)
    snapshots = {integer("snapshots", e, 0, epochs) for e in snapshots}
    count = WORKERS * math.ceil(members / (WORKERS * BLOCK))
    blocks = np.array_split(np.arange(members), min(count, members))
    bar = tqdm(total=epochs * members, desc=label, disable=not progress, mininterval=0.5)

    def work(block):
        y = data.y if targets is None else targets[block]
        start = weights[block]
        descent = Descent(start, data.x, y, rate[block] / len(data.x), momentum[block])
        return _train_block(descent, start, data, test, epochs, warm_up, snapshots, bar)

    threads = torch.get_num_threads()
    torch.set_num_threads(1)  # one core for each block: no waiting at every product
    try:
        with ThreadPoolExecutor(min(WORKERS, len(blocks))) as pool:
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
            f"no member's error is finite after {epochs} epochs: lower the rate ({rate.min():g})",
            history,
        )
    model = TorqueModel(Weights.concatenate(trained), data.inputs, data.outputs, data.step)
    return model, history, {e: Weights.concatenate([k[e] for k in kept]) for e in sorted(kept[0])}


def _train_block(descent, initial, data, test, epochs, warm_up, snapshots, bar):
    """Train some members in this thread; `bar` is told how far they are."""
    torch.set_num_threads(1)
    history, points = History(), set(check_points(epochs))
    kept = {0: initial} if 0 in snapshots else {}
    spread = data.y.std(0)
    if test is not None:
        test_cases, test_spread = prepare(*test), np.std(test[1], axis=0)

    def relative(mean_square, spread):
        return np.sqrt((mean_square / spread**2).mean(-1))

    def note(epoch, square, test_square):
        training = relative(square, spread)
        history.append(epoch, training, *(relative(s, test_spread) for s in test_square))
        if np.isfinite(training).any():
            bar.set_postfix(median_rmss=f"{np.nanmedian(training):.3f}", refresh=False)

    for epoch in range(1, epochs + 1):
        due = epoch - 1 in points  # the errors after one step show in the next one
        test_square = [descent.mean_square(*test_cases)] if due and test is not None else []
        square = descent.epoch(due, WARM_UP_MOMENTUM if epoch <= warm_up else 1.0)
        if due:
            note(epoch - 1, square, test_square)
        if epoch in snapshots:
            kept[epoch] = descent.weights()
        if epoch % 50 == 0 or epoch == epochs:
            with bar.get_lock():
                bar.update((epoch % 50 or 50) * descent.members)
    test_square = [descent.mean_square(*test_cases)] if test is not None else []
    note(epochs, descent.mean_square(descent.inputs, descent.targets), test_square)
    return descent.weights(), history, kept
