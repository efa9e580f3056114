"""Levenberg-Marquardt against the long way of momentum descent."""

from __future__ import annotations

import time
import warnings

import numpy as np
import torch
from ensembles import eager_loop, threads, training_set
from measure import memory_row, ratio

from ddlib.learning import NotConverged, Weights, WindowNetwork, default_rate, solve
from ddlib.metrics import rmss
from ddlib.setups import STATE_FEEDBACK


def measure(width: int, starts: int = 25) -> list[dict]:
    """Rows of one window size: time to the error that descent has at its end, one thread."""
    with threads(1):
        return _measure(width, starts)


def _measure(width: int, starts: int) -> list[dict]:
    data, x, y = training_set(width)
    setup = STATE_FEEDBACK
    weights = Weights.random(starts, width, setup.hidden, initial=setup.initial)
    solve(weights[0], data, steps=2, target_rmss=1.0, progress=False)
    memory = memory_row(f"solver, window {width}")
    network = WindowNetwork(width, setup.hidden, initial=setup.initial)
    options = dict(rate=default_rate(width), momentum=setup.momentum, warm_up=setup.warm_up)
    eager_loop(network, x, y, epochs=50, **options)  # to warm up
    network = WindowNetwork(width, setup.hidden, initial=setup.initial)
    started = time.perf_counter()
    eager_loop(network, x, y, epochs=setup.epochs, **options)
    descent = time.perf_counter() - started
    with torch.no_grad():
        error = float(rmss(network(x).numpy().astype(float), data.y))
    taken, reached = [], 0
    for k in range(starts):
        started = time.perf_counter()
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", NotConverged)  # counted instead
            solution = solve(weights[k], data, target_rmss=error, progress=False)
        taken.append(time.perf_counter() - started)
        reached += int(solution.history.training[-1].max() <= error)
    row = ratio(
        f"Solver: to the training error of {setup.epochs:,} epochs",
        f"window {width}, 1 thread",
        (f"Levenberg-Marquardt, median of {starts} starts", float(np.median(taken))),
        ("eager PyTorch loop, one start", descent),
        **{
            "RMSS": error,
            "starts that reach it": reached,
            "starts": starts,
            "slowest start, seconds": max(taken),
        },
    )
    return [row, memory]
