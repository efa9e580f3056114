"""The real arm's recording as cases, its blocks, models that are no networks, and networks."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from scipy.optimize import minimize

from beyond.others import RealArm, staubli
from ddlib.analysis import savitzky_golay
from ddlib.identification import joint_columns
from ddlib.learning import TorqueModel, TrainingSet, Weights, train_ensemble

BLOCKS = 5  # of the recording; each is predicted by what was learnt on the others
RATES = {
    100: (5, 11, 21, 41, 81),
    200: (11, 21, 41),
    500: (21, 81),
}  # windows, by samples a second
SLOTS = slice(40, 860)  # hundredths of a second that all windows fit around
RIDGES = tuple(10.0 ** np.arange(-10, 1))  # shares of the inputs' variance
_PIECES = 15  # of the recording, to choose a penalty by
_DEGREE = 3  # of the polynomial whose derivatives are a window's states


@cache
def _recorded(rate: int) -> RealArm:
    """The recording at so many samples a second."""
    return staubli().at(rate)


@dataclass(frozen=True)
class Windowed:
    """Windows of the real arm at the moments of `SLOTS`, and the currents there."""

    rate: int  # samples a second
    width: int
    x: np.ndarray  # (cases, 6, width): positions, rad
    current: np.ndarray  # (cases, 6), A

    @classmethod
    def of(cls, rate: int, width: int) -> Windowed:
        """The cases of 100, 200 or 500 samples a second and of a window size."""
        recording, many = _recorded(rate), rate // 100
        centres = np.arange(SLOTS.start, SLOTS.stop) * many + many // 2
        around = np.arange(width) - width // 2
        x = recording.q[centres[:, None] + around]
        return cls(rate, width, np.moveaxis(x, 1, 2), recording.current[centres])

    @property
    def step(self) -> float:
        """Sampling period, s."""
        return 1 / self.rate

    @property
    def states(self) -> np.ndarray:
        """Positions, velocities, accelerations by a cubic in each window, ``(cases, 6, 3)``."""
        degree = min(_DEGREE, self.width - 1)
        filters = [savitzky_golay(self.width, k, self.step, degree) for k in range(3)]
        return self.x @ np.stack(filters, -1)

    def fold(self, block: int) -> tuple[np.ndarray, np.ndarray]:
        """Masks of the cases to learn from and of those to be tested on, without common samples."""
        return _fold(len(self.x), block, self.gap)

    def folds(self) -> list[tuple[np.ndarray, np.ndarray]]:
        """The masks of each block."""
        return [self.fold(block) for block in range(BLOCKS)]

    @property
    def flat(self) -> np.ndarray:
        """Windows of all joints in a row, ``(cases, 6 * width)``."""
        return self.x.reshape(len(self.x), -1)

    @property
    def gap(self) -> int:
        """Cases from one to the next whose windows have no sample in common."""
        return -(-self.width * 100 // self.rate)


def _fold(cases: int, block: int, gap: int, blocks: int = BLOCKS) -> tuple[np.ndarray, np.ndarray]:
    """Masks of training and test cases: a block is tested, none within `gap` of it is learnt."""
    size, place = cases / blocks, np.arange(cases)
    first, last = (round((block + k) * size) for k in (0, 1))
    test = (place >= first) & (place < last)
    return (place <= first - gap) | (place >= last - 1 + gap), test


def least_squares(x, y, new) -> np.ndarray:
    """Predictions for `new` rows of the linear fit of `y` to the rows of `x`, with a constant."""
    centre, size = x.mean(0), x.std(0)
    size = np.where(size > 0, size, 1)
    factors = np.linalg.lstsq((x - centre) / size, y - y.mean(0), rcond=1e-10)[0]
    return y.mean(0) + (new - centre) / size @ factors


class Ridge:
    """Linear filters of the window with a penalty on their squares, one for each output."""

    def __init__(self, x, y):
        self.centre, self.mean = x.mean(0), y.mean(0)
        x = x - self.centre
        power, self.axes = np.linalg.eigh(x.T @ x)
        self.power = np.clip(power, 0, None)
        self.unit = self.power.mean()
        self.along = self.axes.T @ (x.T @ (y - self.mean))

    def filters(self, penalty) -> np.ndarray:
        """Factors ``(inputs, outputs)`` for a penalty, as a share of the inputs' mean variance."""
        return self.axes @ (self.along / (self.power[:, None] + np.asarray(penalty) * self.unit))

    def predict(self, new, penalty) -> np.ndarray:
        """Outputs for other rows, ``(cases, outputs)``."""
        return self.mean + (new - self.centre) @ self.filters(penalty)


def best_penalty(data: Windowed, training) -> float:
    """The penalty of `RIDGES` with the least error on pieces left out of the training cases."""
    x, total = data.flat, 0.0
    for piece in range(_PIECES):
        learnt, tried = _fold(len(x), piece, data.gap, _PIECES)
        learnt, tried = learnt & training, tried & training
        if tried.any():
            ridge = Ridge(x[learnt], data.current[learnt])
            error = [ridge.predict(x[tried], p) - data.current[tried] for p in RIDGES]
            total = total + (np.square(error) / data.current[training].var(0)).sum((1, 2))
    return RIDGES[int(np.argmin(total))]


def known_structure(states, current, new, friction: bool = True) -> np.ndarray:
    """Currents ``(others, 6)`` at `new` states by least squares on known terms, by joint."""
    return np.stack(
        [
            _fitted(joint_columns(states, j, friction), current[:, j])
            @ joint_columns(new, j, friction).T
            for j in range(current.shape[1])
        ],
        -1,
    )


def _fitted(a, y) -> np.ndarray:
    size = np.sqrt((a**2).mean(0))
    return np.linalg.lstsq(a / size, y, rcond=1e-8)[0] / size


@dataclass(frozen=True)
class _Identified:
    """Gains of the identified model, joint by joint."""

    inertia: np.ndarray  # on the joint's own acceleration, averaged over the cases, A s^2/rad
    slope: np.ndarray  # of friction on the joint's own velocity, along the motion, A s/rad
    viscous: np.ndarray  # A s/rad
    coulomb: np.ndarray  # A
    friction: np.ndarray  # current, (cases, 6), A
    rest: np.ndarray  # of all other terms


def identified(states, current) -> _Identified:
    """The known structure fitted to states ``(cases, 6, 3)`` and currents ``(cases, 6)``."""
    speed, by_joint = states[..., 1], []
    for j in range(current.shape[1]):
        a, free = joint_columns(states, j), joint_columns(states, j, friction=False)
        factors = _fitted(a, current[:, j])
        own = a.shape[1] - free.shape[1]
        place = free.shape[1] - 1  # the offset stands last in both
        rubbing = a[:, place : place + own] @ factors[place : place + own]
        pushed = states.copy()
        pushed[:, j, 2] += 1.0
        more = (joint_columns(pushed, j) - a) @ factors
        slope = np.linalg.lstsq(speed - speed.mean(0), rubbing - rubbing.mean(), rcond=None)[0][j]
        rest = a @ factors - rubbing
        by_joint.append((more.mean(), slope, *factors[place : place + 2], rubbing, rest))
    inertia, slope, viscous, coulomb, rubbing, rest = zip(*by_joint)
    arrays = map(np.array, (inertia, slope, viscous, coulomb))
    return _Identified(*arrays, np.stack(rubbing, -1), np.stack(rest, -1))


HIDDEN = 10  # as in 1988

# Per sample of a window: one of six joints has three times the inputs of one of two.
_DESCENT = {"rate": 22.0, "momentum": 0.995, "warm_up": 300}
_SCALING = (-1.0, 1.0)  # of the inputs
EPOCHS = 2000  # of all networks but the longest


def trained(x, y, members: int, seed: int, width: int, snapshots=(), targets=None, hidden=HIDDEN,
            epochs: int = EPOCHS) -> tuple[TorqueModel, dict, TrainingSet]:  # fmt: skip
    """Networks by descent on windows and currents; models of `snapshots`; the data."""
    data = TrainingSet.from_arrays(x, y, scaling=_SCALING)
    start = Weights.random(members, width, hidden, x.shape[1], y.shape[1], seed=seed)
    scaled = None if targets is None else data.outputs.scale(targets)
    model, _, weights = train_ensemble(
        start, data, targets=scaled, rate=_DESCENT["rate"] / width, momentum=_DESCENT["momentum"],
        warm_up=_DESCENT["warm_up"], epochs=epochs, snapshots=snapshots, progress=False,
    )  # fmt: skip
    models = {e: TorqueModel(w, data.inputs, data.outputs) for e, w in weights.items()}
    return model, models, data


def wrong(predicted, data: Windowed, cases) -> np.ndarray:
    """Mean squared error of each output over the whole recording's variance, ``(..., 6)``."""
    error = predicted - data.current[cases]
    return (error**2).mean(-2) / data.current.var(0)


def errors_of_fold(model: TorqueModel, data: Windowed, fold) -> list[np.ndarray]:
    """Errors of a fold: on what was learnt, and on the block left out."""
    return [wrong(model.torque(data.x[part]), data, part) for part in fold]


def decayed_network(x, y, start: Weights, decay: float, steps: int = 300) -> TorqueModel:
    """One network by quasi-Newton steps on half the mean squared error with weight decay."""
    data = TrainingSet.from_arrays(x, y, scaling=_SCALING)
    flat = data.x.reshape(len(data.x), -1)
    names = ("hidden_weights", "hidden_bias", "output_weights", "direct_weights", "output_bias")
    shapes = [getattr(start, name).shape for name in names]
    ends = np.cumsum([np.prod(shape) for shape in shapes])

    def parts(vector):
        return [v.reshape(s) for v, s in zip(np.split(vector, ends[:-1]), shapes)]

    def objective(vector):
        w1, b1, w2, w3, b2 = parts(vector)
        first, direct = w1.reshape(len(b1), -1), w3.reshape(len(b2), -1)
        hidden = 1 / (1 + np.exp(-np.clip(flat @ first.T + b1, -500, 500)))
        out = 1 / (1 + np.exp(-np.clip(flat @ direct.T + hidden @ w2.T + b2, -500, 500)))
        error = out - data.y
        delta = error * out * (1 - out) / len(flat)
        back = (delta @ w2) * hidden * (1 - hidden)
        slopes = [
            back.T @ flat + decay * first, back.sum(0), delta.T @ hidden + decay * w2,
            delta.T @ flat + decay * direct, delta.sum(0),
        ]  # fmt: skip
        value = (error**2).sum() / len(flat) + decay * sum((w**2).sum() for w in (w1, w2, w3))
        return value / 2, np.concatenate([s.ravel() for s in slopes])

    begin = np.concatenate([getattr(start, name).ravel() for name in names])
    optimum = minimize(objective, begin, jac=True, method="L-BFGS-B", options={"maxiter": steps})
    return TorqueModel(Weights(*parts(optimum.x)), data.inputs, data.outputs)
