"""Descent with momentum of many networks at once: the sums of `ddlib.learning.train`."""

from __future__ import annotations

import math
from contextlib import closing
from threading import Event

import numpy as np
import torch
from tqdm.auto import tqdm

from ddlib._check import cases_of, finite_array, flag, instance, integer, shaped
from ddlib.learning._packed import product_with
from ddlib.learning._threads import in_threads
from ddlib.learning.network import TorqueModel, Weights, from_rows
from ddlib.learning.training import (
    WARM_UP_MOMENTUM,
    History,
    TrainingDiverged,
    TrainingInterrupted,
    TrainingSet,
    _warn_if_worse_than_mean,
    check_descent,
    default_rate,
    recorded_epochs,
)

WORKERS = min(2, torch.get_num_threads())  # threads of `train_ensemble`: OMP_NUM_THREADS, or two
_BLOCK = 8  # most members that a thread trains side by side: what fits into a core's cache

_times_slope = torch.ops.aten.sigmoid_backward.grad_input  # g, s -> g s (1 - s), one pass


def kernels() -> str:
    """Instruction set of PyTorch's kernels here, like "AVX512": it decides how sums are rounded."""
    return torch.backends.cpu.get_cpu_capability()


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
        Scaled targets of each member in place of ``data.y``, to whose spread errors are relative.
    rate, momentum, epochs
        As in `train`; the first two may be arrays, shape (members,). Default: `default_rate`.
    warm_up : int
        Epochs at the start with a momentum of `WARM_UP_MOMENTUM`, if that is smaller. Large
        steps before the units have found their parts saturate them for good.
    snapshots : sequence of int
        Epochs after which a copy of all weights is kept (0: the initial ones).
    progress, label
        Whether to show a progress bar, and what it says.

    Returns
    -------
    tuple of TorqueModel, History and dict
        The trained ensemble, the errors of every member, and weights by epoch. If no error is
        finite: a `TrainingDiverged` error; if all of several end above 1: `WorseThanMean`.

    Raises
    ------
    TrainingInterrupted
        On Ctrl-C or the kernel's stop, within one epoch; it holds the networks as they are then.
    """
    instance("weights", weights, Weights)
    instance("data", data, TrainingSet)
    flag("progress", progress)
    shaped("snapshots", snapshots, "(epochs,)")
    if weights.hidden_bias.ndim != 2:
        raise ValueError(
            "weights must have one leading axis of members (of one network: weights[None]), got "
            f"hidden_bias of shape {weights.hidden_bias.shape}"
        )
    cases_of("test", test)
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
    block_count = WORKERS * math.ceil(members / (WORKERS * _BLOCK))
    blocks = np.array_split(np.arange(members), min(block_count, members))
    bar = tqdm(total=epochs * members, desc=label, disable=not progress, mininterval=0.5)
    stop = Event()

    def work(block):
        y = data.y if targets is None else targets[block]
        start = weights[block]
        descent = Descent(start, data.x, y, rate[block] / len(data.x), momentum[block])
        return _train_block(descent, start, data, test, epochs, warm_up, snapshots, bar, stop)

    with closing(bar):
        parts, interrupted = in_threads(work, blocks, WORKERS, stop)
    trained, histories, kept = zip(*parts)
    model = TorqueModel(Weights.concatenate(trained), data.inputs, data.outputs, data.step)
    history = _side_by_side(histories)
    kept = {
        epoch: Weights.concatenate([part[epoch] for part in kept])
        for epoch in sorted(set.intersection(*map(set, kept)))
    }
    if interrupted:
        reached = np.repeat([h.epochs[-1] for h in histories], [len(w) for w in trained])
        raise TrainingInterrupted(model, history, reached, epochs, kept)
    if not np.isfinite(history.training[-1]).any():
        raise TrainingDiverged(
            f"no member's error is finite after {epochs} epochs: lower the rate ({rate.min():g})",
            history,
        )
    if targets is None and members > 1:  # a few networks saturate early at any rate
        _warn_if_worse_than_mean(history, rate.min())
    return model, history, kept


def _side_by_side(histories) -> History:
    """One history of several blocks; those that were stopped earlier keep their last errors."""
    longest = max(histories, key=lambda history: history.epochs[-1])
    points = len(longest.epochs)

    def joined(errors):
        return np.hstack([np.pad(e, ((0, points - len(e)), (0, 0)), "edge") for e in errors])

    training, test = [h.training for h in histories], [h.test for h in histories]
    return History(longest.epochs, joined(training), joined(test) if len(test[0]) else test[0])


def _per_member(rate, momentum, epochs, members):
    """Checked rates and momenta as arrays of shape (members,)."""
    arrays = [finite_array("rate", rate), finite_array("momentum", momentum)]
    for name, array in zip(("rate", "momentum"), arrays):
        if array.shape not in ((), (members,)):
            raise ValueError(f"{name} must be one number or {members}, got shape {array.shape}")
    for pair in np.broadcast(*arrays):
        check_descent(*map(float, pair), epochs)
    return [np.broadcast_to(array, members) for array in arrays]


def _train_block(descent, initial, data, test, epochs, warm_up, snapshots, bar, stop):
    """Train some members in this thread until `stop`; `bar` is told how far they are."""
    history, points = History(), set(recorded_epochs(epochs))
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

    reached = 0
    for epoch in range(1, epochs + 1):
        if stop.is_set():
            break
        due = epoch - 1 in points  # the errors after one step show in the next one
        test_square = [descent.mean_square(*test_cases)] if due and test is not None else []
        square = descent.epoch(due, WARM_UP_MOMENTUM if epoch <= warm_up else 1.0)
        reached = epoch
        if due:
            note(epoch - 1, square, test_square)
        if epoch in snapshots:
            kept[epoch] = descent.weights()
        if epoch % 50 == 0 or epoch == epochs:
            with bar.get_lock():
                bar.update((epoch % 50 or 50) * descent.members)
    test_square = [descent.mean_square(*test_cases)] if test is not None else []
    note(reached, descent.mean_square(descent.inputs, descent.targets), test_square)
    return descent.weights() if reached else initial, history, kept


class Descent:
    """The arithmetic of `train_ensemble`: one epoch of many networks on the same inputs at once.

    One matrix product serves all members, the rest is done in place. The weights from the window
    are rows of one matrix: member by member the hidden units, then the outputs; its last column
    holds the biases. Targets `y` are shared, or one set per member; `eps` is the step of the summed
    gradient.
    """

    def __init__(self, weights: Weights, x, y, eps, momentum):
        n, self.hidden = weights.hidden_bias.shape
        self.shape, self.members = weights.hidden_weights.shape[-2:], n
        first = weights.rows
        self.rows = first.shape[1]
        self.first = _tensor(first.reshape(n * self.rows, -1))
        self.second = _tensor(weights.output_weights)
        self.inputs = _with_ones(x)
        self.targets = _tensor(np.swapaxes(y, -1, -2))
        per_member = [np.broadcast_to(value, n) for value in (eps, momentum)]
        self.eps, self.momentum = (
            [_tensor(np.repeat(v, self.rows))[:, None], _tensor(v)[:, None, None]]
            for v in per_member
        )
        self.step_first = torch.zeros_like(self.first)
        self.step_second = torch.zeros_like(self.second)
        cases = self.inputs.shape[1]
        self.back = torch.empty(n, self.hidden, cases)
        self.delta = torch.empty(n, self.rows - self.hidden, cases)
        self._net = product_with(self.inputs, len(self.first))
        self._gradient = product_with(self.inputs.t().contiguous(), len(self.first))

    def _activities(self, net):
        """Activities of the hidden and output units, in place, as views of `net`."""
        net = net.view(self.members, self.rows, -1)
        hidden, output = net[:, : self.hidden], net[:, self.hidden :]
        hidden.sigmoid_()
        output.baddbmm_(self.second, hidden).sigmoid_()
        return hidden, output

    @torch.inference_mode()
    def epoch(self, wanted: bool = False, most: float = 1.0) -> np.ndarray | None:
        """One step of every member, in place, with a momentum of `most` at most.

        If `wanted`, return the `mean_square` errors before the step; they cost nothing here.
        """
        net = self._net(self.first)
        hidden, output = self._activities(net)
        torch.sub(output, self.targets, out=self.delta)
        errors = self._mean_square(self.delta) if wanted else None
        _times_slope(self.delta, output, grad_input=self.delta)
        gradient_second = torch.bmm(self.delta, hidden.transpose(1, 2))
        torch.bmm(self.second.transpose(1, 2), self.delta, out=self.back)
        _times_slope(self.back, hidden, grad_input=hidden)
        output.copy_(self.delta)
        gradients = (self._gradient(net), gradient_second)
        steps, weights = (self.step_first, self.step_second), (self.first, self.second)
        for step, weight, gradient, eps, alpha in zip(
            steps, weights, gradients, self.eps, self.momentum
        ):
            step.mul_(alpha.clamp(max=most) if most < 1 else alpha).sub_(gradient.mul_(eps))
            weight.add_(step)
        return errors

    def mean_square(self, inputs, targets) -> np.ndarray:
        """Mean squared error of each member and output in cases that `prepare` made ready.

        NaN for members whose weights are not finite.
        """
        _, output = self._activities(torch.mm(self.first, inputs))
        return self._mean_square(output.sub_(targets))

    def _mean_square(self, delta) -> np.ndarray:
        errors = delta.square().mean(-1).numpy().astype(float)
        fine = torch.isfinite(self.first).all(1).view(-1, self.rows).all(1)
        fine &= torch.isfinite(self.second).all(2).all(1)
        errors[~fine.numpy()] = np.nan
        return errors

    def weights(self) -> Weights:
        """All members as plain arrays."""
        first = self.first.numpy().astype(float).reshape(self.members, self.rows, -1)
        return from_rows(first, self.second.numpy().astype(float), self.shape)


def prepare(x, y) -> tuple[torch.Tensor, torch.Tensor]:
    """Windows ``(cases, joint, width)`` and targets ``(cases, output)`` for `mean_square`."""
    return _with_ones(x), _tensor(np.swapaxes(y, -1, -2))


def _tensor(array) -> torch.Tensor:
    return torch.tensor(np.ascontiguousarray(array), dtype=torch.float32)


def _with_ones(x) -> torch.Tensor:
    """Inputs as columns, with a row of ones for the biases."""
    x = np.asarray(x).reshape(len(x), -1)
    return _tensor(np.vstack([x.T, np.ones(len(x))]))
