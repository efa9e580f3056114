"""Sweeps: order, resumption, failures, other code, backends."""

from __future__ import annotations

import functools
import os
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from workshop.report.sweeps import _sweep

GAIN = 3.0


def experiment(x, seed=0, log=None):
    """Something that depends on its arguments; `log` gets a line for every call."""
    if log:
        with Path(log).open("a") as file:
            file.write(f"{x}\n")
    if x < 0:
        raise ValueError(f"{x} is bad")
    return {"value": GAIN * x + np.random.default_rng(seed).normal(size=3), "pid": os.getpid()}


def slow_experiment(x, seed):
    """One that lasts, so that quick ones do not go to a single worker in one batch."""
    time.sleep(0.2)
    return experiment(x, seed)


def rows(places, **others) -> list[dict]:
    return [{"x": x, **others} for x in places]


def values(outcome):
    return np.array([entry["value"] for entry in outcome])


@pytest.fixture
def log(tmp_path):
    """A file that `experiment` writes its calls to."""
    return str(tmp_path / "log")


def calls(log) -> list[int]:
    """The calls made so far, sorted."""
    return sorted(map(int, Path(log).read_text().split())) if Path(log).exists() else []


@pytest.fixture
def quick(tmp_path):
    """`sweep` in this process, into a folder of the test's own."""
    return functools.partial(_sweep, code="1", folder=tmp_path / "kept", backend="sequential")


@pytest.mark.parametrize("backend", ["sequential", "loky"])
def test_results_come_in_order(backend, quick, log):
    settings = [{"x": x, "seed": seed, "log": log} for x in (3, 1, 2) for seed in (0, 1)]
    plain = values([experiment(x=one["x"], seed=one["seed"]) for one in settings])
    for _ in ("computed", "read"):
        outcome = quick(experiment, settings, backend=backend, jobs=2)
        np.testing.assert_array_equal(values(outcome), plain)
    assert calls(log) == [1, 1, 2, 2, 3, 3]
    if backend == "loky":
        assert os.getpid() not in {entry["pid"] for entry in outcome}


def test_other_code_does_not_read_old_results(quick, monkeypatch):
    before = values(quick(experiment, rows([1])))
    monkeypatch.setattr(sys.modules[__name__], "GAIN", 5.0)
    assert (values(quick(experiment, rows([1]))) == before).all()
    assert (values(quick(experiment, rows([1]), code="2")) == before + 2).all()


@pytest.mark.parametrize("backend", ["sequential", "loky"])
def test_a_failure_is_told_and_loses_nothing(backend, quick, log):
    for _ in range(2):
        with pytest.raises(ValueError, match="-1 is bad"):
            quick(experiment, rows((0, 1, 2, -1), log=log), backend=backend, jobs=1)
    assert calls(log) == [-1, -1, 0, 1, 2]


def test_a_dask_cluster_gives_the_same(quick):
    from dask.distributed import Client, LocalCluster

    settings = [{"x": x, "seed": seed} for x in range(6) for seed in (0, 1)]
    with (
        LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster,
        Client(cluster),
    ):
        outcome = quick(slow_experiment, settings, backend="dask")
        workers = {worker.process.pid for worker in cluster.workers.values()}
        assert {row["pid"] for row in outcome} == workers
    np.testing.assert_array_equal(values(outcome), values(experiment(**row) for row in settings))
    again = quick(slow_experiment, settings)  # from the files
    assert [row["pid"] for row in again] == [row["pid"] for row in outcome]
