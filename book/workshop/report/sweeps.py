"""Sweeps: one experiment over many settings; what is finished is kept on disk and resumed."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from pathlib import Path

import joblib
from tqdm.auto import tqdm

from ddlib._check import one_of
from workshop import BOOK

_FOLDER = BOOK.parent / ".cache" / "sweeps"  # Where finished settings are kept. It may be deleted.

_BACKENDS = ("loky", "threading", "sequential", "dask")  # Backends of joblib that a sweep runs on


def _sweep(
    experiment: Callable,
    settings: Iterable[Mapping],
    *,
    code: str,
    backend: str = "loky",
    jobs: int = -1,
    label: str = "sweep",
    folder: str | Path = _FOLDER,
) -> list:
    """``experiment(**setting)`` for every setting, in their order.

    If one fails, its exception ends the sweep; those that have finished are kept for the next
    one with the same `code`, a name for the code that the results depend on.
    """
    one_of("backend", backend, _BACKENDS)
    settings = list(settings)
    cached = joblib.Memory(Path(folder, code), verbose=0).cache(experiment)
    tasks = (joblib.delayed(cached)(**setting) for setting in settings)
    threads = {"inner_max_num_threads": 1} if backend == "loky" else {}
    with joblib.parallel_config(backend, n_jobs=jobs, **threads):
        results = joblib.Parallel(return_as="generator", batch_size=1)(tasks)
        return list(tqdm(results, total=len(settings), desc=label))
