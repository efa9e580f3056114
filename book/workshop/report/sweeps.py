"""Sweeps: one experiment over many settings; what is finished is kept on disk and resumed."""

from __future__ import annotations

import traceback
from collections.abc import Callable, Iterable, Mapping
from inspect import isfunction
from pathlib import Path

import joblib
from tqdm.auto import tqdm

from ddlib._check import integer, one_of
from workshop import BOOK

FOLDER = BOOK.parent / ".cache" / "sweeps"  # Where finished settings are kept. It may be deleted.

BACKENDS = ("loky", "threading", "sequential", "dask")  # Backends of joblib that a sweep runs on


class SweepFailed(RuntimeError):
    """Some settings failed. The others are kept: `results` and `failures` by their place.

    Parameters
    ----------
    message : str
    results : dict
        What a setting gave.
    failures : dict
        Traceback of a setting that failed.
    """

    def __init__(self, message: str, results: dict[int, object], failures: dict[int, str]):
        super().__init__(message)
        self.results, self.failures = results, failures


def sweep(
    experiment: Callable,
    settings: Iterable[Mapping],
    *,
    code: str,
    backend: str = "loky",
    jobs: int | None = None,
    label: str = "sweep",
    folder: str | Path = FOLDER,
) -> list:
    """``experiment(**setting)`` for every setting, in their order."""
    one_of("backend", backend, BACKENDS)
    jobs = joblib.cpu_count() if jobs is None else integer("jobs", jobs, 1)
    settings = list(settings)
    if not isfunction(experiment):
        raise TypeError(f"experiment must be a Python function, got {experiment!r}")
    for setting in settings:
        if not isinstance(setting, Mapping):
            raise TypeError(f"settings must be mappings of arguments to values, got {setting!r}")
    kept = joblib.Memory(Path(folder, code), verbose=0).cache(_kept, ignore=["result"])
    name = f"{experiment.__module__}.{experiment.__qualname__}"
    results, failures, tasks = {}, {}, []
    for place, setting in enumerate(settings):
        try:
            (results[place],) = kept(name, setting)
        except LookupError:
            tasks.append(joblib.delayed(_attempt)(experiment, place, setting))
    threads = {"inner_max_num_threads": 1} if backend == "loky" else {}
    with (
        tqdm(total=len(settings), initial=len(results), desc=label) as bar,
        joblib.parallel_config(backend, n_jobs=jobs, **threads),
    ):
        try:
            parallel = joblib.Parallel(return_as="generator_unordered", batch_size=1)
            for place, result, error in parallel(tasks):
                if error is None:
                    (results[place],) = kept(name, settings[place], (result,))
                else:
                    failures[place] = error
                bar.update()
        except Exception as error:
            done = f"{len(results)} of {len(settings)} settings are finished and kept"
            message = f"{label} broke off: {type(error).__name__}; {done}"
            raise SweepFailed(message, results, failures) from error
    if failures:
        named = "\n".join(f"{settings[place]!r:.200}:\n{failures[place]}" for place in failures)
        message = f"{label}: {len(failures)} of {len(settings)} settings failed\n{named}"
        raise SweepFailed(message, results, failures)
    return [results[place] for place in range(len(settings))]


def _kept(name, setting, result=None):
    """What joblib keeps: a result under its experiment and setting; without one, it looks."""
    if result is None:
        raise LookupError(f"{name} has no result for {setting!r:.200}")
    return result


def _attempt(experiment, place, setting):
    """One setting in a worker: its place, its result, its traceback."""
    try:
        return place, experiment(**setting), None
    except Exception:
        return place, None, traceback.format_exc()
