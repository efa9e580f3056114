"""Speed as ratios, each pair measured in the same run: ``make bench``.

Writes ``book/results/benchmarks.json``. Times vary with the machine and its load; ratios
much less.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable

import numpy as np
import torch

from ddlib import results
from ddlib.experiment import STATE_FEEDBACK, WINDOWS, split
from ddlib.network import Weights, WindowNetwork
from ddlib.simulate import record
from ddlib.training import TrainingSet, default_rate, train, train_ensemble
from ddlib.trajectories import random_extents


def seconds(work: Callable[[], object], repeats: int = 3) -> float:
    """Shortest of some runs, after one to warm up."""
    work()
    times = []
    for _ in range(repeats):
        started = time.perf_counter()
        work()
        times.append(time.perf_counter() - started)
    return min(times)


def training(width: int, members: int = 32, epochs: int = 200) -> dict:
    """Networks x epochs a second: the ensemble against an eager PyTorch loop."""
    data = TrainingSet.from_recording(split(STATE_FEEDBACK.record())[0], width)
    options = dict(rate=default_rate(width), momentum=0.95, epochs=epochs, progress=False)
    weights = Weights.random(members, width)
    eager = seconds(lambda: train(WindowNetwork(width), data.x, data.y, **options)) / epochs
    fast = seconds(lambda: train_ensemble(weights, data, **options)) / epochs / members
    return {
        "what": f"training, window {width}, {members} networks against an eager loop",
        "eager, microseconds": 1e6 * eager,
        "ensemble, microseconds": 1e6 * fast,
        "ratio": eager / fast,
    }


def simulation(runs: int = 200) -> dict:
    """Recordings a second: many at once against one by one."""
    extents = random_extents(runs, seed=0)
    setup = STATE_FEEDBACK
    options = dict(effects=setup.effects)
    one = seconds(lambda: record(setup.arm, setup.controller, extents[0], **options))
    all_at_once = seconds(lambda: record(setup.arm, setup.controller, extents, **options)) / runs
    return {
        "what": f"recording, {runs} runs at once against one by one",
        "single, microseconds": 1e6 * one,
        "batch, microseconds": 1e6 * all_at_once,
        "ratio": one / all_at_once,
    }


def main() -> None:
    """Run all pairs, print the table and write it."""
    rows = []
    started = time.monotonic()
    for work in [*(lambda w=w: training(w) for w in WINDOWS), simulation]:
        rows.append(work())
        print(f"{rows[-1]['what']:60s} {rows[-1]['ratio']:8.1f} times", flush=True)
    made_by = results.stamp(seconds=time.monotonic() - started)
    content = {"made by": made_by, "threads": torch.get_num_threads(), "rows": rows}
    results.write_json(results.FOLDER / "benchmarks.json", content)
    if not all(np.isfinite(row["ratio"]) for row in rows):
        sys.exit("a ratio is not finite")


if __name__ == "__main__":
    main()
