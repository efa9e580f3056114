"""*Run this page*: what ours import and the browser does not have.

`train_ensemble` descends by the sums of its own module, in numpy; a single run of a plain arm goes
by plain numbers, as numpy takes long for so few. What stands in for PyTorch and for widgets is in
the folder `instead`.
"""

from __future__ import annotations

import importlib.machinery
import math
import sys
import types
from concurrent.futures import Future
from contextlib import contextmanager

import numpy as np

OURS = ("ddlib", "workshop", "beyond")
ABSENT = ("yaml", "joblib", "sklearn")
"""What ours may import and then not use; only in a cell itself is it an error to import it."""

INERT = ("tqdm",)
"""Modules in which every name is a class that takes anything and does nothing."""

DESCENT = "ddlib.learning.descent"
PLANT = "ddlib.simulation.plant"
PICTURE = "ddlib.widgets.still"  # of a widget's start, for pages without script


class _Absent(type):
    """A name of a package that is not there: it can be inherited from, not called."""

    def __getattr__(cls, name):
        if name.startswith("__"):
            raise AttributeError(name)
        return _Absent(name, (), {"package": cls.package})

    def __call__(cls, *args, **options):
        raise ModuleNotFoundError(f"needs {cls.package}", name=cls.package)


class _Inert(type):
    def __iter__(cls):
        return iter(())


class Inert(metaclass=_Inert):
    """A progress bar: it stands for nothing and takes everything."""

    def __init__(self, *args, **options):
        pass

    def __call__(self, *args, **options):
        return self

    def __enter__(self):
        return self

    def __exit__(self, *error):
        return False

    def __add__(self, other):
        return self

    def __getattr__(self, name):
        if name.startswith("_"):
            raise AttributeError(name)
        return Inert()


class _Stub(types.ModuleType):
    """A module whose names are made when they are asked for."""

    def __init__(self, name, make):
        super().__init__(name)
        self.__path__ = []
        self._make = make

    def __getattr__(self, name):
        if name.startswith("__"):
            raise AttributeError(name)
        return self._make(name)


def _absent(package: str) -> _Stub:
    """A package that is not there."""
    return _Stub(package, lambda name: _Absent(name, (), {"package": package}))


class Finder:
    """Imports modules of ours with stubs for what is absent, and inert modules."""

    deep = 0

    def find_spec(self, name, path=None, target=None):
        if any(name == inert or name.startswith(f"{inert}.") for inert in INERT):
            return importlib.machinery.ModuleSpec(name, self, is_package=True)
        if name.partition(".")[0] not in OURS:
            return None
        spec = importlib.machinery.PathFinder.find_spec(name, path, target)
        if spec is not None and hasattr(spec.loader, "exec_module"):
            usual = spec.loader.exec_module
            spec.loader.exec_module = lambda module: self._ours(module, usual)
        return spec

    def create_module(self, spec):
        return _Stub(spec.name, lambda name: _Inert(name, (Inert,), {}))

    def exec_module(self, module):
        pass

    def _ours(self, module, usual):
        with self.stubs():
            usual(module)
        if module.__name__ == DESCENT:
            vars(module).update(Descent=Descent, prepare=_prepare, kernels=lambda: "numpy")
        if module.__name__ == PLANT:
            module.Plant._advance = plainly(module.Plant._advance)
        if module.__name__ == PICTURE:
            module.still_picture = lambda *given: ""
        if hasattr(module, "ThreadPoolExecutor"):
            module.ThreadPoolExecutor = _Serial

    @contextmanager
    def stubs(self):
        Finder.deep += 1
        for name in ABSENT:
            if name not in sys.modules:
                sys.modules[name] = _absent(name)
        try:
            yield
        finally:
            Finder.deep -= 1
            if not Finder.deep:
                stubs = [n for n, module in sys.modules.items() if isinstance(module, _Stub)]
                for name in stubs:
                    if name.partition(".")[0] in ABSENT:
                        del sys.modules[name]


class _Serial:
    """In place of a pool of threads: the page has one."""

    def __init__(self, workers, **options):
        pass

    def __enter__(self):
        return self

    def __exit__(self, *error):
        return False

    def shutdown(self, **options):
        pass

    map = staticmethod(map)

    @staticmethod
    def submit(work, *given):
        done = Future()
        try:
            done.set_result(work(*given))
        except Exception as error:
            done.set_exception(error)
        return done


def _prepare(x, y):
    x = np.asarray(x, dtype=float).reshape(len(x), -1)
    return np.vstack([x.T, np.ones(len(x))]), np.swapaxes(np.asarray(y, dtype=float), -1, -2)


def _sigmoid(x):
    with np.errstate(over="ignore"):
        return 1.0 / (1.0 + np.exp(-x))


class Descent:
    """`ddlib.learning.Descent` by numpy, in double precision."""

    def __init__(self, weights, x, y, eps, momentum):
        n, self.hidden = weights.hidden_bias.shape
        self.shape, self.members = weights.hidden_weights.shape[-2:], n
        first = weights.rows
        self.rows = first.shape[1]
        self.first = first.reshape(n * self.rows, -1).astype(float)
        self.second = weights.output_weights.astype(float)
        self.inputs, self.targets = _prepare(x, y)
        self._back = np.ascontiguousarray(self.inputs.T)
        eps, momentum = (np.broadcast_to(value, n) for value in (eps, momentum))
        self.eps = np.repeat(eps, self.rows)[:, None], eps[:, None, None]
        self.momentum = np.repeat(momentum, self.rows)[:, None], momentum[:, None, None]
        self.steps = np.zeros_like(self.first), np.zeros_like(self.second)

    def _activities(self, inputs):
        net = (self.first @ inputs).reshape(self.members, self.rows, -1)
        hidden = _sigmoid(net[:, : self.hidden])
        return hidden, _sigmoid(net[:, self.hidden :] + self.second @ hidden)

    def epoch(self, wanted=False, most=1.0):
        hidden, output = self._activities(self.inputs)
        delta = output - self.targets
        errors = self._mean_square(delta) if wanted else None
        delta *= output * (1 - output)
        back = np.swapaxes(self.second, 1, 2) @ delta
        back *= hidden * (1 - hidden)
        net = np.concatenate([back, delta], axis=1).reshape(len(self.first), -1)
        gradients = net @ self._back, delta @ np.swapaxes(hidden, 1, 2)
        parts = self.steps, (self.first, self.second), gradients, self.eps, self.momentum
        for step, weight, gradient, eps, alpha in zip(*parts):
            step *= np.minimum(alpha, most)
            step -= eps * gradient
            weight += step
        return errors

    def mean_square(self, inputs, targets):
        return self._mean_square(self._activities(inputs)[1] - targets)

    def _mean_square(self, delta):
        errors = np.square(delta).mean(-1)
        fine = np.isfinite(self.first).all(1).reshape(-1, self.rows).all(1)
        errors[~(fine & np.isfinite(self.second).all((1, 2)))] = np.nan
        return errors

    def weights(self):
        from ddlib.learning.network import from_rows

        first = self.first.reshape(self.members, self.rows, -1).copy()
        return from_rows(first, self.second.copy(), self.shape)


def plainly(usual):
    """`Plant._advance`, by Python's own numbers where it can: the same sums in the same order."""

    def advance(plant, x, v, tau, step):
        if x.shape == (2,) == np.shape(tau) and isinstance(step, float):
            if not hasattr(plant, "_plain"):
                plant._plain = _plain(plant)
            if plant._plain:
                try:
                    return _runge_kutta(*plant._plain, x, v, tau, step)
                except (ValueError, ArithmeticError):  # numpy goes on with what is no number
                    pass
        return usual(plant, x, v, tau, step)

    return advance


def _plain(plant):
    """Numbers of an arm and of its smooth frictions; None if it has more than these."""
    from ddlib.effects import CoulombFriction, ViscousFriction

    arm, frictions = plant.arm, []
    more = plant._joint or plant.motor or plant._sticking or plant._remembering
    if more or arm.gravity_moments != (0.0, 0.0):
        return None
    for friction in plant._smooth.friction:
        if type(friction) not in (ViscousFriction, CoulombFriction):
            return None
        dry = type(friction) is CoulombFriction
        size = np.asarray(friction.level if dry else friction.coefficient, dtype=float)
        if size.shape != (2,):
            return None
        frictions.append((*size.tolist(), float(friction.smoothing) if dry else None))
    return (float(arm.a), float(arm.b), float(arm.d)), frictions


def _runge_kutta(arm, frictions, x, v, tau, step):
    a, b, d = arm
    shoulder, elbow = map(float, tau)
    half, sixth = 0.5 * step, step / 6

    def acceleration(q2, v1, v2):
        held1 = held2 = None
        for size1, size2, smoothing in frictions:
            if smoothing is None:
                one, two = size1 * v1, size2 * v2
            else:
                one, two = size1 * math.tanh(v1 / smoothing), size2 * math.tanh(v2 / smoothing)
            held1, held2 = (one, two) if held1 is None else (held1 + one, held2 + two)
        t1, t2 = (shoulder, elbow) if held1 is None else (shoulder - held1, elbow - held2)
        c2, h = math.cos(q2), b * math.sin(q2)
        r1, r2 = t1 + h * v2 * (2 * v1 + v2), t2 - h * v1 * v1
        m11, m12 = a + 2 * b * c2, d + b * c2
        determinant = m11 * d - m12 * m12
        return (d * r1 - m12 * r2) / determinant, (m11 * r2 - m12 * r1) / determinant

    def moved(k, by):
        return [at + by * rate for at, rate in zip(start, k)]

    def rates(state):
        _, q2, v1, v2 = state
        return v1, v2, *acceleration(q2, v1, v2)

    start = [*x.tolist(), *v.tolist()]
    k1 = rates(start)
    k2 = rates(moved(k1, half))
    k3 = rates(moved(k2, half))
    k4 = rates(moved(k3, step))
    each = zip(start, k1, k2, k3, k4)
    end = [at + sixth * (one + 2 * two + 2 * three + four) for at, one, two, three, four in each]
    return np.array(end[:2]), np.array(end[2:])


def start() -> None:
    sys.meta_path.insert(0, Finder())
