"""Sweeps: order, resumption, failures, two at a time, other code, backends."""

from __future__ import annotations

import functools
import os
import pickle
import signal
import subprocess
import sys
import time
import types
from pathlib import Path

import joblib
import numpy as np
import pytest

from ddlib.experiments import sweeps
from ddlib.experiments.sweeps import SweepFailed, code_hash, sweep, table

GAIN = 3.0


def experiment(x, seed=0, log=None, bad=()):
    """Something that depends on its arguments; `log` gets a line for every call."""
    if log:
        with Path(log).open("a") as file:
            file.write(f"{x}\n")
    if x in bad:
        raise ValueError(f"{x} is bad")
    return {"value": GAIN * x + np.random.default_rng(seed).normal(size=3), "pid": os.getpid()}


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
    options = dict(folder=tmp_path / "kept", backend="sequential", progress=False)
    return functools.partial(sweep, **options)


def kept(folder) -> list[str]:
    return sorted(path.suffix for path in (folder / "experiment").iterdir())


# --- what comes back


def test_a_table_is_every_combination():
    rows = table(width=(11, 21), seed=range(3))
    assert rows[:2] == [{"width": 11, "seed": 0}, {"width": 11, "seed": 1}]
    assert len(rows) == 6


@pytest.mark.parametrize("backend", ["sequential", "threading", "loky"])
def test_results_come_in_order(backend, tmp_path):
    rows = table(x=(3, 1, 2), seed=(0, 1))
    plain = values([experiment(**row) for row in rows])
    options = dict(folder=tmp_path, backend=backend, jobs=2, progress=False)
    np.testing.assert_array_equal(values(sweep(experiment, rows, **options)), plain)
    np.testing.assert_array_equal(values(sweep(experiment, rows, **options)), plain)


def test_named_settings_come_back_by_name(quick):
    outcome = quick(experiment, {"one": {"x": 1}, "ten": {"x": 10}})
    assert list(outcome) == ["one", "ten"]
    np.testing.assert_array_equal(outcome["ten"]["value"], experiment(10)["value"])


def test_an_empty_table_gives_nothing(quick):
    assert quick(experiment, []) == []


def test_equal_settings_are_computed_once(quick, log):
    outcome = quick(experiment, [{"x": 1, "log": log}, {"x": 2, "log": log}, {"x": 1, "log": log}])
    assert calls(log) == [1, 2]
    np.testing.assert_array_equal(outcome[0]["value"], outcome[2]["value"])


# --- what is kept


def test_only_what_is_missing_is_computed(quick, log):
    quick(experiment, table(x=(1, 2), log=[log]))
    outcome = quick(experiment, table(x=(1, 2, 3), log=[log]))
    assert calls(log) == [1, 2, 3]
    np.testing.assert_array_equal(values(outcome), values(experiment(x) for x in (1, 2, 3)))


@pytest.mark.parametrize("damage", [b"", b"\x80\x05 no pickle", None])
def test_a_damaged_file_is_computed_anew(quick, log, tmp_path, damage):
    rows = table(x=(1, 2), log=[log])
    first = quick(experiment, rows)
    path = min((tmp_path / "kept" / "experiment").glob("*.pkl"))
    path.write_bytes(path.read_bytes()[:-7] if damage is None else damage)
    np.testing.assert_array_equal(values(quick(experiment, rows)), values(first))
    assert len(calls(log)) == 3
    pickle.loads(path.read_bytes())


def test_an_interrupted_sweep_resumes(quick, log, monkeypatch):
    rows = table(x=range(5), log=[log])
    keep, count = sweeps._Run.keep, []

    def interrupted(run, key, content):
        keep(run, key, content)
        count.append(key)
        if len(count) == 2:
            raise KeyboardInterrupt

    monkeypatch.setattr(sweeps._Run, "keep", interrupted)
    with pytest.raises(KeyboardInterrupt):
        quick(experiment, rows)
    done = calls(log)
    monkeypatch.undo()
    quick(experiment, rows)
    assert calls(log) == sorted([*done, *range(2, 5)])


def test_an_interrupted_write_leaves_nothing(quick, tmp_path, monkeypatch):
    def full(*_):
        raise OSError("no space left")

    monkeypatch.setattr(sweeps.os, "replace", full)
    with pytest.raises(SweepFailed, match="broke off: OSError"):
        quick(experiment, table(x=(1, 2)))
    assert kept(tmp_path / "kept") == []


SCRIPT = """
import sys, time
from pathlib import Path
from ddlib.sweeps import sweep, table

def experiment(x, log, wait):
    time.sleep(wait)
    with Path(log).open("a") as file:
        file.write(f"{x}\\n")
    return bytes([x]) * 1_000_000

if __name__ == "__main__":
    folder, log, count, wait, jobs = sys.argv[1:]
    rows = table(x=range(int(count)), log=[log], wait=[float(wait)])
    outcome = sweep(experiment, rows, folder=folder, jobs=int(jobs), progress=False)
    assert outcome == [bytes([x]) * 1_000_000 for x in range(int(count))]
    print("whole")
"""


@pytest.fixture
def start(tmp_path):
    """Start a process that sweeps; arguments as in SCRIPT."""
    script = tmp_path / "script.py"
    script.write_text(SCRIPT)
    running = []

    def go(*arguments):
        command = [sys.executable, str(script), str(tmp_path / "kept"), *map(str, arguments)]
        pipes = dict(stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        running.append(subprocess.Popen(command, start_new_session=True, **pipes))
        return running[-1]

    yield go
    for process in running:
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
        process.communicate()


def test_two_sweeps_of_one_table_do_not_disturb_each_other(start, log, tmp_path):
    both = [start(log, 24, 0.05, 1) for _ in range(2)]
    for process in both:
        out, err = process.communicate(timeout=120)
        assert out == "whole\n", err
    assert kept(tmp_path / "kept") == [".pkl"] * 24
    assert set(calls(log)) == set(range(24))


def meanwhile(x, log, folder):
    """While the first setting is computed, another sweep computes the second one."""
    experiment(x, log=log)
    if x == 0:
        rows = table(x=[1], log=[log], folder=[folder])
        sweep(meanwhile, rows, backend="sequential", folder=folder, progress=False)
    return x


def test_what_another_sweep_has_finished_is_taken_over(quick, log, tmp_path):
    rows = table(x=range(3), log=[log], folder=[str(tmp_path / "kept")])
    assert quick(meanwhile, rows) == [0, 1, 2]
    assert calls(log) == [0, 1, 2]


def test_a_killed_sweep_resumes(start, log, tmp_path):
    process = start(log, 8, 0.3, 2)
    folder, deadline = tmp_path / "kept" / "experiment", time.monotonic() + 60
    while len(list(folder.glob("*.pkl"))) < 3:
        assert process.poll() is None and time.monotonic() < deadline
        time.sleep(0.01)
    os.killpg(process.pid, signal.SIGKILL)
    process.wait()
    done, made = len(list(folder.glob("*.pkl"))), len(calls(log))
    assert 3 <= done < 8
    out, err = start(log, 8, 0.3, 2).communicate(timeout=120)
    assert out == "whole\n", err
    assert len(calls(log)) - made == 8 - done


# --- failures


@pytest.mark.parametrize("backend", ["sequential", "loky"])
def test_a_failure_is_named_and_loses_nothing(backend, tmp_path, log):
    rows = {f"run {x}": {"x": x, "log": log, "bad": (2, 4)} for x in range(6)}
    options = dict(folder=tmp_path / "kept", backend=backend, jobs=2, progress=False)
    with pytest.raises(SweepFailed, match="2 of 6 settings failed") as caught:
        sweep(experiment, rows, **options)
    assert "run 2: ValueError: 2 is bad" in str(caught.value)
    assert set(caught.value.failures) == {"run 2", "run 4"}
    assert "in experiment" in caught.value.failures["run 4"]  # the traceback
    assert set(caught.value.results) == {"run 0", "run 1", "run 3", "run 5"}
    with pytest.raises(SweepFailed):
        sweep(experiment, rows, **options)
    assert calls(log) == [0, 1, 2, 2, 3, 4, 4, 5]


def test_settings_without_names_are_named_by_their_arguments(quick):
    with pytest.raises(SweepFailed, match=r"x=2, bad=\(2,\): ValueError"):
        quick(experiment, table(x=(1, 2), bad=[(2,)]))


def unpicklable(x):
    return (lambda: x) if x else 0


def test_a_result_that_does_not_pickle_is_a_failure_of_its_setting(quick):
    with pytest.raises(SweepFailed, match="x=1") as caught:
        quick(unpicklable, table(x=(0, 1)))
    assert caught.value.results == {"x=0": 0}


def crash(x):
    if x == 3:
        time.sleep(1)  # the others' results are on their way
        os._exit(1)
    return x


def test_a_dead_worker_is_reported_and_the_finished_ones_are_kept(tmp_path):
    options = dict(folder=tmp_path, jobs=2, progress=False)
    with pytest.raises(SweepFailed, match=r"under way were: .*x=3") as caught:
        sweep(crash, table(x=range(5)), **options)
    assert {"x=0", "x=1"} <= set(caught.value.results)
    assert len(list((tmp_path / "crash").iterdir())) == len(caught.value.results)


@pytest.mark.parametrize(
    ("bad", "error", "complaint"),
    [
        (dict(backend="spark"), ValueError, "backend must be one of"),
        (dict(jobs=0), ValueError, "jobs must be an integer from 1"),
        (dict(settings=[3]), TypeError, "settings must be mappings"),
        (dict(settings=[{1: 2}]), TypeError, "settings must be mappings"),
        (dict(settings=[{"x": (i for i in "ab")}]), TypeError, "x=<generator"),
        (dict(experiment=len), TypeError, "experiment must be a Python function"),
    ],
)
def test_bad_arguments_are_refused_before_any_work(quick, log, bad, error, complaint):
    arguments = dict(experiment=experiment, settings=[{"x": 1, "log": log}]) | bad
    with pytest.raises(error, match=complaint):
        quick(arguments.pop("experiment"), arguments.pop("settings"), **arguments)
    assert not calls(log)


# --- which code made a result

CODE = '''
"""A module."""
import math
SCALE = 2.0
class Shape:
    side = 4
    def area(self):
        return self.side ** 2
def helper(x, power=2):
    return SCALE * x ** power
def made(x):
    """Words."""
    inner = lambda y: y in {"a", "b"}  # remark
    return helper(x) + math.sin(x) + Shape().area() + inner(x)
def unused(x):
    return 1
'''


def module(source):
    made = types.ModuleType("some_module")
    exec(source, made.__dict__)
    return made


def hash_with(old, new):
    assert old in CODE
    return code_hash(module(CODE.replace(old, new)).made)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("SCALE = 2.0", "SCALE = 2.5"),
        ("x ** power", "x * power"),
        ("power=2", "power=3"),
        ("side = 4", "side = 5"),
        ("self.side ** 2", "self.side ** 3"),
        ("math.sin", "math.cos"),
        ('{"a", "b"}', '{"a", "c"}'),
    ],
)
def test_other_code_makes_another_hash(old, new):
    assert hash_with(old, new) != code_hash(module(CODE).made)


@pytest.mark.parametrize(
    ("old", "new"),
    [("# remark", "# another"), ("return 1", "return 2"), ('"""A module."""', "\n\n")],
)
def test_what_does_not_matter_does_not_count(old, new):
    assert hash_with(old, new) == code_hash(module(CODE).made)


def test_the_hash_is_the_same_in_every_process():
    code = f"from test_sweeps import *\nprint(code_hash(module({CODE!r}).made))"
    environment = {**os.environ, "PYTHONPATH": str(Path(__file__).parent)}
    command = [sys.executable, "-c", code]
    found = {
        subprocess.check_output(command, env={**environment, "PYTHONHASHSEED": seed}, text=True)
        for seed in ("1", "2")
    }
    assert found == {code_hash(module(CODE).made) + "\n"}


def test_what_a_function_closes_over_counts():
    def make(k):
        def inner(x):
            return inner(x - 1) if x else k

        return inner

    assert code_hash(make(1)) == code_hash(make(1)) != code_hash(make(2))
    assert len({code_hash(functools.partial(make, k=k)) for k in (1, 1, 2)}) == 2


def test_code_of_the_package_counts(tmp_path, monkeypatch):
    monkeypatch.setattr(sweeps, "PACKAGE", tmp_path)
    (tmp_path / "widgets").mkdir()

    def hash_after(name, text):
        (tmp_path / name).write_text(text)
        sweeps._package_hash.cache_clear()
        return code_hash(experiment)

    try:
        before = hash_after("arm.py", "G = 9.81\n")
        assert hash_after("figures.py", "WIDTH = 3\n") == before
        assert hash_after("widgets/pad.py", "WIDTH = 3\n") == before
        assert hash_after("arm.py", "G = 9.80665\n") != before
    finally:
        sweeps._package_hash.cache_clear()


def test_other_code_does_not_read_old_results(tmp_path):
    options = dict(folder=tmp_path, backend="sequential", progress=False)
    assert sweep(module(CODE).made, [{"x": 0}], **options) == [16.0]
    assert sweep(module(CODE.replace("side = 4", "side = 5")).made, [{"x": 0}], **options) == [25.0]


# --- backends


def threads(x):
    import torch

    return torch.get_num_threads(), int(os.environ["OMP_NUM_THREADS"]), os.getpid()


def test_processes_share_the_cores(tmp_path):
    outcome = sweep(threads, table(x=range(4)), folder=tmp_path, jobs=2, progress=False)
    share = max(1, joblib.cpu_count() // 2)
    assert {entry[:2] for entry in outcome} == {(share, share)}
    assert os.getpid() not in {entry[2] for entry in outcome}


def test_the_bar_counts_what_was_there_and_shows_the_time_left(tmp_path, capsys):
    options = dict(folder=tmp_path, backend="sequential", label="gains")
    sweep(experiment, table(x=range(2)), **options)
    first = capsys.readouterr().err
    assert "gains" in first and "2/2" in first and "<" in first
    sweep(experiment, table(x=range(4)), **options)
    second = capsys.readouterr().err
    assert " 2/4" in second and " 4/4" in second and " 0/4" not in second


def test_a_dask_cluster_gives_the_same(tmp_path):
    from dask.distributed import Client, LocalCluster

    rows = table(x=range(6), seed=(0, 1))
    options = dict(backend="dask", folder=tmp_path, progress=False)
    with (
        LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster,
        Client(cluster),
    ):
        outcome = sweep(experiment, rows, **options)
        assert {row["pid"] for row in outcome} <= {w.process.pid for w in cluster.workers.values()}
        assert len({row["pid"] for row in outcome}) == 2
        with pytest.raises(SweepFailed, match="x=7"):
            sweep(experiment, table(x=(6, 7), bad=[(7,)]), **options)
    np.testing.assert_array_equal(values(outcome), values(experiment(**row) for row in rows))
    again = sweep(experiment, rows, **{**options, "backend": "sequential"})  # from the files
    assert [row["pid"] for row in again] == [row["pid"] for row in outcome]
