"""Sweeps: order, resumption, failures, other code, bad arguments, backends."""

from __future__ import annotations

import functools
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from workshop.report.sweeps import SweepFailed, sweep

GAIN = 3.0


def experiment(x, seed=0, log=None, bad=()):
    """Something that depends on its arguments; `log` gets a line for every call."""
    if log:
        with Path(log).open("a") as file:
            file.write(f"{x}\n")
    if x in bad:
        raise ValueError(f"{x} is bad")
    return {"value": GAIN * x + np.random.default_rng(seed).normal(size=3), "pid": os.getpid()}


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
    return functools.partial(sweep, code="1", folder=tmp_path / "kept", backend="sequential")


@pytest.mark.parametrize("backend", ["sequential", "threading", "loky"])
def test_results_come_in_order(backend, quick):
    settings = [{"x": x, "seed": seed} for x in (3, 1, 2) for seed in (0, 1)]
    plain = values([experiment(**setting) for setting in settings])
    for _ in ("computed", "read"):
        outcome = quick(experiment, settings, backend=backend, jobs=2)
        np.testing.assert_array_equal(values(outcome), plain)


def nothing(x):
    return None


def test_a_result_may_be_none(quick):
    assert quick(nothing, rows((1, 2))) == quick(nothing, rows((1, 2))) == [None, None]


def test_no_settings_give_nothing(quick):
    assert quick(experiment, []) == []


# --- what is kept


def test_only_what_is_missing_is_computed(quick, log):
    quick(experiment, rows((1, 2), log=log))
    outcome = quick(experiment, rows((1, 2, 3), log=log))
    assert calls(log) == [1, 2, 3]
    np.testing.assert_array_equal(values(outcome), values(experiment(x) for x in (1, 2, 3)))


def test_other_code_does_not_read_old_results(quick, monkeypatch):
    before = values(quick(experiment, rows([1])))
    monkeypatch.setattr(sys.modules[__name__], "GAIN", 5.0)
    assert (values(quick(experiment, rows([1]))) == before).all()
    assert (values(quick(experiment, rows([1]), code="2")) == before + 2).all()


@pytest.mark.filterwarnings("ignore:Exception while loading")
def test_a_damaged_file_is_computed_anew(quick, log, tmp_path):
    first = quick(experiment, rows((1, 2), log=log))
    damaged = min((tmp_path / "kept").rglob("output.pkl"))
    damaged.write_bytes(damaged.read_bytes()[:-7])
    np.testing.assert_array_equal(values(quick(experiment, rows((1, 2), log=log))), values(first))
    assert len(calls(log)) == 3


def interrupted(x, log, stop):
    if x == 2 and Path(stop).exists():
        raise KeyboardInterrupt
    return experiment(x, log=log)


def test_an_interrupted_sweep_resumes(quick, log, tmp_path):
    stop = tmp_path / "stop"
    stop.touch()
    with pytest.raises(KeyboardInterrupt):
        quick(interrupted, rows(range(5), log=log, stop=str(stop)))
    assert calls(log) == [0, 1]
    stop.unlink()
    outcome = quick(interrupted, rows(range(5), log=log, stop=str(stop)))
    assert calls(log) == [0, 1, 2, 3, 4]
    np.testing.assert_array_equal(values(outcome), values(experiment(x) for x in range(5)))


def slow(x, log):
    time.sleep(0.3)
    experiment(x, log=log)
    return x


KILLED = "import sys, test_sweeps as t\nt.sweep(t.slow, t.rows(range(8), log=sys.argv[1]), "
KILLED += "code='1', jobs=2, folder=sys.argv[2])"


def test_a_killed_sweep_resumes(quick, log, tmp_path):
    command = [sys.executable, "-c", KILLED, log, str(tmp_path / "kept")]
    there = {**os.environ, "PYTHONPATH": os.pathsep.join([str(Path(__file__).parent), *sys.path])}
    process = subprocess.Popen(command, env=there, start_new_session=True)
    deadline = time.monotonic() + 60
    try:
        while len(list((tmp_path / "kept").rglob("output.pkl"))) < 3:
            assert process.poll() is None and time.monotonic() < deadline
            time.sleep(0.01)
    finally:
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()
    time.sleep(0.1)
    done, made = len(list((tmp_path / "kept").rglob("output.pkl"))), len(calls(log))
    assert 3 <= done < 8
    assert quick(slow, rows(range(8), log=log)) == list(range(8))
    assert len(calls(log)) - made == 8 - done


# --- failures


@pytest.mark.parametrize("backend", ["sequential", "loky"])
def test_a_failure_is_named_and_loses_nothing(backend, quick, log):
    settings = rows(range(6), log=log, bad=(2, 4))
    for _ in range(2):
        with pytest.raises(SweepFailed, match="2 of 6 settings failed") as caught:
            quick(experiment, settings, backend=backend, jobs=2)
    message = str(caught.value)
    assert "{'x': 2, " in message and "ValueError: 4 is bad" in message
    assert "in experiment" in caught.value.failures[4]  # the traceback
    assert set(caught.value.failures) == {2, 4} and set(caught.value.results) == {0, 1, 3, 5}
    assert calls(log) == [0, 1, 2, 2, 3, 4, 4, 5]


def crash(x):
    if x == 3:
        time.sleep(1)  # the others' results are on their way
        os._exit(1)
    return x


def test_a_dead_worker_is_reported_and_the_finished_ones_are_kept(quick, tmp_path):
    with pytest.raises(SweepFailed, match="broke off: TerminatedWorker") as caught:
        quick(crash, rows(range(5)), backend="loky", jobs=2)
    assert {0: 0, 1: 1}.items() <= caught.value.results.items()
    assert f"{len(caught.value.results)} of 5 settings are finished" in str(caught.value)
    assert len(list((tmp_path / "kept").rglob("output.pkl"))) == len(caught.value.results)


@pytest.mark.parametrize(
    ("bad", "error", "complaint"),
    [
        (dict(backend="spark"), ValueError, "backend must be one of"),
        (dict(jobs=0), ValueError, "jobs must be an integer from 1"),
        (dict(settings=[{"x": 1}, 3]), TypeError, "settings must be mappings"),
        (dict(experiment=len), TypeError, "experiment must be a Python function"),
    ],
)
def test_bad_arguments_are_refused_before_any_work(quick, log, bad, error, complaint):
    arguments = dict(experiment=experiment, settings=[{"x": 1, "log": log}]) | bad
    with pytest.raises(error, match=complaint):
        quick(arguments.pop("experiment"), arguments.pop("settings"), **arguments)
    assert not calls(log)


# --- backends


def threads(x):
    import torch

    return torch.get_num_threads(), os.environ["OMP_NUM_THREADS"], os.getpid()


def test_processes_have_one_thread_each(quick):
    outcome = quick(threads, rows(range(4)), backend="loky", jobs=2)
    assert {entry[:2] for entry in outcome} == {(1, "1")}
    assert os.getpid() not in {entry[2] for entry in outcome}


def test_the_bar_says_how_far_it_is(quick, capsys):
    quick(experiment, rows(range(2)), label="gains")
    first = capsys.readouterr().err
    assert "gains" in first and "2/2" in first and "<" in first
    quick(experiment, rows(range(4)))
    second = capsys.readouterr().err
    assert " 2/4" in second and " 4/4" in second and " 0/4" not in second  # two were there


def test_a_dask_cluster_gives_the_same(quick):
    from dask.distributed import Client, LocalCluster

    settings = [{"x": x, "seed": seed} for x in range(6) for seed in (0, 1)]
    with (
        LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster,
        Client(cluster),
    ):
        outcome = quick(experiment, settings, backend="dask")
        workers = {worker.process.pid for worker in cluster.workers.values()}
        assert {row["pid"] for row in outcome} == workers
        with pytest.raises(SweepFailed, match="7 is bad"):
            quick(experiment, rows((6, 7), bad=(7,)), backend="dask")
    np.testing.assert_array_equal(values(outcome), values(experiment(**row) for row in settings))
    again = quick(experiment, settings)  # from the files
    assert [row["pid"] for row in again] == [row["pid"] for row in outcome]
