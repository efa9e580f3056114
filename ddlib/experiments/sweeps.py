"""Sweeps: one experiment over a table of settings, kept on disk and resumed.

Every finished setting is a file of its own, named by a hash of the experiment's code and
the setting. A sweep that was interrupted, or whose table has grown, computes what is
missing; other code or other settings make other files, so nothing stale is ever read.
"""

from __future__ import annotations

import functools
import hashlib
import itertools
import os
import pickle
import tempfile
import traceback
import types
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path

import joblib
from tqdm.auto import tqdm

from ddlib._check import integer, one_of

PACKAGE = Path(__file__).parent

FOLDER = PACKAGE.parent / ".cache" / "sweeps"
"""Where finished settings are kept, a folder for each experiment. It may be deleted."""

PRESENTATION = ("style", "tables", "figures", "diagrams", "widgets")
"""Modules that show results and do not make them."""

BACKENDS = ("loky", "threading", "sequential", "dask")
"""Backends of joblib that a sweep runs on."""


class SweepFailed(RuntimeError):
    """Some settings failed. The others are finished and kept.

    Parameters
    ----------
    message : str
    failures : dict
        Traceback of each failed setting, by its name.
    results : dict
        What the other settings gave, by their names.
    """

    def __init__(self, message: str, failures: dict[str, str], results: dict[str, object]):
        super().__init__(message)
        self.failures, self.results = failures, results


def table(**axes: Iterable) -> list[dict]:
    """All combinations of the values of some axes: the last axis varies fastest.

    Parameters
    ----------
    **axes : iterable
        Values by the name of the experiment's argument.
    """
    return [dict(zip(axes, values)) for values in itertools.product(*axes.values())]


def sweep(
    experiment: Callable,
    settings: Sequence[Mapping] | Mapping[str, Mapping],
    *,
    backend: str = "loky",
    jobs: int | None = None,
    folder: str | Path = FOLDER,
    progress: bool = True,
    label: str = "sweep",
) -> list | dict:
    """``experiment(**setting)`` for every setting of a table.

    Parameters
    ----------
    experiment : callable
        A function of keyword arguments; what it returns must pickle. It takes its random
        numbers from a seed that is an argument.
    settings : sequence of mapping, or mapping of mappings
        The arguments of each call (see `table`), by name if the settings have names.
    backend : {"loky", "threading", "sequential", "dask"}
        joblib's backend. "loky": processes, which share out the cores among their threads.
        "dask": the cluster of the ``dask.distributed.Client`` that is open.
    jobs : int, optional
        Calls at a time, default one for each core. A Dask cluster decides by itself.
    folder : path
        Where finished settings are kept. Only this process writes there, so the workers of
        a cluster need no common disk.
    progress : bool
        Show a bar with the number of finished settings and the time left.
    label : str
        What the bar says.

    Returns
    -------
    list or dict
        Results in the order of `settings`, a dict if the settings have names.

    Raises
    ------
    SweepFailed
        When all settings have been tried and some failed, or when a worker died.
    TypeError, ValueError
        If an argument is of the wrong kind, before anything is computed.
    """
    one_of("backend", backend, BACKENDS)
    jobs = joblib.cpu_count() if jobs is None else integer("jobs", jobs, 1)
    names, rows = _rows(settings)
    code = code_hash(experiment)
    run = _Run(experiment, Path(folder) / _name(experiment), label, names)
    for place, row in enumerate(rows):
        run.add(_key(code, row, names[place]), row, place)
    run.take_kept()
    # each process gets its share of the cores for its threads
    share = {"inner_max_num_threads": max(1, joblib.cpu_count() // jobs)}
    with (
        tqdm(total=len(rows), initial=run.done, desc=label, disable=not progress) as bar,
        joblib.parallel_config(backend, n_jobs=jobs, **(share if backend == "loky" else {})),
    ):
        run.compute(bar)
    return dict(zip(names, run.in_order())) if isinstance(settings, Mapping) else run.in_order()


class _Run:
    """One call of `sweep`: what is to do, what is done, what failed."""

    def __init__(self, experiment, folder, label, names):
        self.experiment, self.folder, self.label, self.names = experiment, folder, label, names
        self.places: dict[str, list[int]] = {}  # equal settings are computed once
        self.rows: dict[str, dict] = {}
        self.results: dict[str, object] = {}
        self.failures: dict[str, str] = {}
        self.under_way: set[str] = set()

    def add(self, key, row, place):
        self.rows[key] = row
        self.places.setdefault(key, []).append(place)

    @property
    def done(self) -> int:
        """Settings of the table that have a result or failed."""
        return sum(len(self.places[key]) for key in (*self.results, *self.failures))

    def in_order(self) -> list:
        by_place = {p: self.results[key] for key, places in self.places.items() for p in places}
        return [by_place[place] for place in sorted(by_place)]

    def name(self, key) -> str:
        return self.names[self.places[key][0]]

    def take_kept(self) -> None:
        for key in self.rows:
            self.kept(key)

    def kept(self, key) -> bool:
        """Take over the result that is on disk, if one is there and whole."""
        try:
            content = (self.folder / f"{key}.pkl").read_bytes()
            self.results[key] = pickle.loads(content)
        except Exception:  # absent, or damaged in any way: computed anew
            return False
        return True

    def keep(self, key, content: bytes) -> None:
        """Write a result under a name of its own, then rename: no other sweep sees half."""
        self.folder.mkdir(parents=True, exist_ok=True)
        handle, part = tempfile.mkstemp(dir=self.folder, prefix=key, suffix=".part")
        try:
            with os.fdopen(handle, "wb") as file:
                file.write(content)
            os.replace(part, self.folder / f"{key}.pkl")
        except BaseException:
            Path(part).unlink(missing_ok=True)
            raise

    def tasks(self):
        """Calls still to make; what another sweep has finished meanwhile is taken over."""
        for key in [key for key in self.rows if key not in self.results]:
            if not self.kept(key):
                self.under_way.add(key)
                yield joblib.delayed(_attempt)(self.experiment, self.rows[key], key)

    def compute(self, bar) -> None:
        parallel = joblib.Parallel(return_as="generator_unordered", batch_size=1)
        try:
            for key, content, error in parallel(self.tasks()):
                self.under_way.remove(key)
                if error is None:
                    self.keep(key, content)
                    self.results[key] = pickle.loads(content)
                else:
                    self.failures[key] = error
                    bar.set_postfix(failed=len(self.failures), refresh=False)
                bar.update(self.done - bar.n)
        except Exception as error:
            lost = ", ".join(map(self.name, self.under_way)) or "none"
            raise self.failed(
                f"{self.label} broke off: {type(error).__name__}; under way were: {lost}"
            ) from error
        bar.update(self.done - bar.n)
        if self.failures:
            first = [f"{self.name(k)}: {t.splitlines()[-1]}" for k, t in self.failures.items()]
            count = f"{len(self.failures)} of {len(self.rows)} settings failed"
            more = [f"and {len(first) - 5} more"] if len(first) > 5 else []
            raise self.failed("\n  ".join([f"{self.label}: {count}", *first[:5], *more]))

    def failed(self, message) -> SweepFailed:
        failures = {self.name(key): text for key, text in self.failures.items()}
        return SweepFailed(message, failures, {self.name(k): r for k, r in self.results.items()})


def _attempt(experiment, row, key):
    """Run one setting in a worker: its key, and the pickled result or the traceback."""
    try:
        return key, pickle.dumps(experiment(**row), protocol=5), None
    except Exception:
        return key, None, traceback.format_exc().rstrip()


def _rows(settings) -> tuple[list[str], list[dict]]:
    """Names and arguments of all settings, checked."""
    named = isinstance(settings, Mapping)
    rows = list(settings.values()) if named else list(settings)
    for row in rows:
        if not isinstance(row, Mapping) or not all(isinstance(key, str) for key in row):
            raise TypeError(f"settings must be mappings of argument names to values, got {row!r}")
    if named:
        return [str(name) for name in settings], rows
    return [", ".join(f"{k}={v!r:.60}" for k, v in row.items()) for row in rows], rows


def _key(code: str, row: dict, name: str) -> str:
    try:
        return joblib.hash((code, row), hash_name="sha1")
    except (pickle.PicklingError, AttributeError, TypeError) as error:
        raise TypeError(f"settings must pickle, got {name}: {error}") from error


def _name(experiment) -> str:
    return getattr(_function(experiment), "__name__", "experiment").strip("<>")


def _function(experiment) -> types.FunctionType:
    """The plain function in a partial or a method."""
    while not isinstance(experiment, types.FunctionType):
        if isinstance(experiment, functools.partial):
            experiment = experiment.func
        elif isinstance(experiment, types.MethodType):
            experiment = experiment.__func__
        else:
            raise TypeError(f"experiment must be a Python function, got {experiment!r}")
    return experiment


# --- which code an experiment consists of


def code_hash(experiment: Callable) -> str:
    """Hash of an experiment's code.

    It covers the function, the functions, classes and constants of its own module that it
    uses, directly or not, and the whole of ddlib but `PRESENTATION`. Other libraries do not
    count.

    Parameters
    ----------
    experiment : callable
        A Python function, or a partial or method of one.

    Raises
    ------
    TypeError
        If it is not a Python function.
    """
    function = _function(experiment)
    parts = {"package": _package_hash()}
    if isinstance(experiment, functools.partial):
        parts["bound"] = joblib.hash((experiment.args, experiment.keywords))
    elif isinstance(experiment, types.MethodType):
        parts["bound"] = joblib.hash(experiment.__self__)
    _walk(function.__name__, function, function.__module__, parts, [])
    return hashlib.sha256(repr(sorted(parts.items())).encode()).hexdigest()


@functools.cache  # the code that is loaded does not change with its files
def _package_hash() -> str:
    total = hashlib.sha256()
    for path in sorted(PACKAGE.rglob("*.py")):
        place = path.relative_to(PACKAGE).with_suffix("")
        if place.parts[0] not in PRESENTATION:
            total.update(place.as_posix().encode() + path.read_bytes())
    return total.hexdigest()


def _walk(name, value, home, parts, functions) -> None:
    """Add to `parts` what `value` is, and what it uses of its module `home`."""
    if name in parts or isinstance(value, types.ModuleType):
        return
    own = getattr(value, "__module__", None) == home
    if isinstance(value, types.FunctionType) and own:
        if value in functions:
            return
        functions.append(value)
        looked_up: set[str] = set()
        parts[name] = repr(list(_code(value.__code__, looked_up)))
        uses = {n: value.__globals__[n] for n in looked_up if n in value.__globals__}
        cells = zip(value.__code__.co_freevars, value.__closure__ or ())
        uses |= {f"{name}.{n}": cell.cell_contents for n, cell in cells}
        uses[f"{name}.defaults"] = (value.__defaults__, value.__kwdefaults__)
        for used in uses.items():
            _walk(*used, home, parts, functions)
    elif isinstance(value, type) and own:
        parts[name] = name
        for key, part in vars(value).items():
            if isinstance(part, types.FunctionType) or not key.startswith("__"):
                _walk(f"{name}.{key}", part, home, parts, functions)
    else:
        parts[name] = joblib.hash(value) if _pickles(value) else type(value).__qualname__


def _pickles(value) -> bool:
    try:
        pickle.dumps(value)
    except (pickle.PicklingError, AttributeError, TypeError):
        return False
    return True


def _code(code: types.CodeType, looked_up: set[str]):
    """What a code object computes, without line numbers; adds the names that it looks up."""
    looked_up.update(code.co_names)
    yield from (code.co_code, code.co_names, code.co_varnames, code.co_freevars)
    for constant in code.co_consts:
        if isinstance(constant, types.CodeType):
            yield from _code(constant, looked_up)
        else:
            yield sorted(map(repr, constant)) if isinstance(constant, frozenset) else constant
