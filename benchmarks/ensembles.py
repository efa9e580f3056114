"""Training many networks against an eager PyTorch loop over one."""

from __future__ import annotations

from contextlib import contextmanager

import torch
from measure import THREADS, interleaved, memory_row, ratio

from ddlib.learning import Weights, WindowNetwork, descent, training
from ddlib.setups import STATE_FEEDBACK, split

MEMBERS = 32
MOMENTUM = 0.95


def floating_point_operations(cases: int, inputs: int, hidden: int, outputs: int) -> int:
    """Of one epoch of one network: a multiplication and an addition for each weight and case,
    forward, for the gradient, and, hidden to output, backward. Sigmoids are not counted.
    """
    first = (2 * inputs + 1) * (hidden + outputs)  # two joints and the bias
    return cases * (4 * first + 6 * hidden * outputs)


def eager_loop(network, x, y, rate, momentum, epochs, warm_up=0):
    """The plain way: one network, autograd, one step of SGD for all cases."""
    optimiser = torch.optim.SGD(network.parameters(), lr=rate / len(x), momentum=momentum)
    (group,) = optimiser.param_groups
    for epoch in range(epochs):
        group["momentum"] = training.WARM_UP_MOMENTUM if epoch < warm_up else momentum
        optimiser.zero_grad()
        loss = 0.5 * (network(x) - y).square().sum()
        loss.backward()
        optimiser.step()


@contextmanager
def threads(count: int):
    """Let torch, and `train_ensemble`, use so many threads."""
    before = torch.get_num_threads(), descent.WORKERS
    torch.set_num_threads(count)
    descent.WORKERS = count
    try:
        yield
    finally:
        torch.set_num_threads(before[0])
        descent.WORKERS = before[1]


def training_set(width: int):
    """Training set of the state-feedback recording, and its windows and targets for torch."""
    data = training.TrainingSet.from_recording(split(STATE_FEEDBACK.record())[0], width)
    return data, *(torch.as_tensor(array, dtype=torch.float32) for array in (data.x, data.y))


def measure(width: int, epochs: int = 300, repeats: int = 5) -> list[dict]:
    """Rows of one window size."""
    data, x, y = training_set(width)
    weights = Weights.random(MEMBERS, width)
    rate = training.default_rate(width)
    options = dict(rate=rate, momentum=MOMENTUM, epochs=epochs, progress=False)
    square = torch.rand(2048, 2048)

    def ours(count):
        with threads(count):
            descent.train_ensemble(weights, data, **options)

    def eager(count):
        with threads(count):
            eager_loop(WindowNetwork(width), x, y, rate, MOMENTUM, epochs)

    def product(count):
        with threads(count):
            torch.mm(square, square)

    ours(THREADS)
    memory = memory_row(f"training of {MEMBERS} networks, window {width}")
    works = {
        f"{work.__name__} {count}": lambda work=work, count=count: work(count)
        for work in (ours, eager, product)
        for count in {1, THREADS}
    }
    taken = {name: t["shortest"] for name, t in interleaved(repeats, **works).items()}
    operations = floating_point_operations(len(x), width, weights.hidden_bias.shape[-1], 2)
    rows = []
    for count in sorted({1, THREADS}, reverse=True):
        per_epoch = taken[f"ours {count}"] / epochs / MEMBERS
        loops = {n: taken[f"eager {n}"] / epochs for n in (1, THREADS)}
        best = min(loops, key=loops.get)
        rate_here = 2 * len(square) ** 3 / taken[f"product {count}"]
        rows.append(
            ratio(
                "Training: one epoch of one network",
                f"window {width}, {count} thread{'s' * (count > 1)}",
                (f"ensemble of {MEMBERS}", per_epoch),
                ("eager PyTorch loop", loops[count]),
                **{
                    "ratio to the loop's best thread count": loops[best] / per_epoch,
                    "best thread count of the loop": best,
                    "floating-point operations": operations,
                    "matrix products, GFLOP/s": rate_here / 1e9,
                    "share of the matrix products' rate": operations / per_epoch / rate_here,
                },
            )
        )
    return [*rows, memory]
