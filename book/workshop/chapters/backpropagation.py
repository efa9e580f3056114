"""What *Backpropagation* shows and asks, parity in two forms, and what its claims measure."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from ddlib import paper
from ddlib.figures import Illustration, families
from ddlib.learning import Descent, History, TrainingSet, Weights, WindowNetwork, train_ensemble
from ddlib.setups import JOINT_DAMPING, STATE_FEEDBACK, WINDOWS
from ddlib.tables import quote, scientific, significant, spread
from workshop.chapters.exercises import Between, Exercise, judging
from workshop.chapters.widgets.weight import OneWeight as OneWeight
from workshop.report import committed, results
from workshop.report.evidence.verdicts import Measured, judged, median
from workshop.report.parity import parity, parity_cases, patterns, right


def monomials(values, coding: str = "bits") -> np.ndarray:
    """Coefficients of the polynomial that equals a function of bits on all its inputs, exactly.

    No variable is squared in it, so it is unique: the Möbius transform for bits, the Walsh-Hadamard
    transform for signs.
    """
    values = np.asarray(values, dtype=np.int64)
    bits = values.size.bit_length() - 1
    values_by_bits = values.reshape((2,) * bits)  # one axis for each bit
    for axis in range(bits):
        off, on = np.split(values_by_bits, 2, axis)
        pair = (off, on - off) if coding == "bits" else (off + on, off - on)
        values_by_bits = np.concatenate(pair, axis)
    flat = values_by_bits.ravel()
    return flat if coding == "bits" else flat / 2**bits


@dataclass(frozen=True)
class _UnitNetwork:
    """Units in a row, each seeing the inputs and any before it; the last is the output."""

    weights: np.ndarray  # (units, inputs + units); 0 means no connection
    bias: np.ndarray  # (units,)

    @property
    def inputs(self) -> int:
        """Number of inputs."""
        return self.weights.shape[1] - self.bias.size

    @property
    def connections(self) -> int:
        """Number of weights that are not zero, biases not counted."""
        return int(np.count_nonzero(self.weights))

    @property
    def coefficients(self) -> int:
        """Number of weights and biases."""
        return self.connections + self.bias.size

    @property
    def depth(self) -> int:
        """Units on the longest way from an input to the output."""
        depth = np.zeros(self.bias.size, int)
        for k, row in enumerate(self.weights[:, self.inputs :]):
            depth[k] = 1 + max(depth[row != 0], default=0)
        return int(depth[-1])

    def activity(self, x, gain: float = np.inf) -> np.ndarray:
        """Activities of all units, shape (..., units)."""
        seen = np.concatenate([x, np.zeros((*x.shape[:-1], self.bias.size))], -1)
        for k, (row, bias) in enumerate(zip(self.weights, self.bias)):
            net = seen @ row + bias
            on = net > 0 if gain == np.inf else 0.5 * (1 + np.tanh(0.5 * gain * net))
            seen[..., self.inputs + k] = on
        return seen[..., self.inputs :]

    def output(self, x, gain: float = np.inf) -> np.ndarray:
        """Activity of the last unit, shape (...), for inputs and gain as for `activity`."""
        return self.activity(x, gain)[..., -1]


def _build(inputs: int, rows) -> _UnitNetwork:
    """A network from a pair for each unit: weights by place, units after the inputs, and bias."""
    weights = np.zeros((len(rows), inputs + len(rows)))
    for k, (links, _) in enumerate(rows):
        weights[k, list(links)] = list(links.values())
    return _UnitNetwork(weights, np.array([bias for _, bias in rows], float))


def _one_layer(bits: int) -> _UnitNetwork:
    """Parity by one hidden layer: unit k is on if k bits or more are on (Rumelhart et al. 1986)."""
    hidden = [(dict.fromkeys(range(bits), 1), 0.5 - k) for k in range(1, bits + 1)]
    return _build(bits, [*hidden, ({bits + k: -((-1) ** k) for k in range(bits)}, 0.5)])


def _direct(bits: int) -> _UnitNetwork:
    """Parity by half as many hidden units and direct weights (Hohil, Liu & Smith 1999)."""
    hidden = [(dict.fromkeys(range(bits), 1), 0.5 - 2 * k) for k in range(1, bits // 2 + 1)]
    above = dict.fromkeys(range(bits, bits + len(hidden)), 2)
    return _build(bits, [*hidden, (dict.fromkeys(range(bits), -1) | above, 0.5)])


def _counter(bits: int) -> _UnitNetwork:
    """Parity by a counter: units are binary digits of the number of bits that are on.

    Each sees the inputs and the higher digits, which take their value away; the lowest is parity.
    """
    higher = [2**j for j in range(bits.bit_length() - 1, 0, -1)]
    places, inputs = range(bits, bits + len(higher)), dict.fromkeys(range(bits), 1)
    known = dict(zip(places, (-value for value in higher)))
    rows = [(inputs | {i: known[i] for i in range(bits, p)}, 0.5 + known[p]) for p in places]
    lowest = {place: -weight for place, weight in (inputs | known).items()}
    return _build(bits, [*rows, (lowest, 0.5)])


def _tree(bits: int) -> _UnitNetwork:
    """Parity by a tree of two-bit parities, two units each: seven coefficients for a bit more."""
    rows, ends = [], list(range(bits))  # places of what is still to be joined
    while len(ends) > 1:
        joined = []
        for a, b in zip(ends[::2], ends[1::2]):
            both = bits + len(rows)
            rows.append(({a: 1, b: 1}, -1.5))
            rows.append(({a: 1, b: 1, both: -2}, -0.5))
            joined.append(both + 1)
        ends = joined + ends[len(joined) * 2 :]
    if not rows:  # a single bit
        rows = [({0: 1}, -0.5)]
    links, bias = rows[-1]
    rows[-1] = ({place: -weight for place, weight in links.items()}, -bias)  # odd to even
    return _build(bits, rows)


# Networks that compute parity, by name: functions of the number of bits
NETWORKS = {
    "one hidden layer": _one_layer,
    "with direct weights": _direct,
    "binary counter": _counter,
    "tree of pairs": _tree,
}


# --- the lesson

_LEVEL = 0.75  # Training RMSS to which runs with and without acceleration are timed


def race() -> Illustration:
    """Eight networks of the lesson's recordings without and with momentum, at the same step."""
    data = TrainingSet.from_recording(JOINT_DAMPING.record()[:-1], 21, scaling=(-1, 1))
    momenta = {"no momentum": 0.0, "momentum 0.9": 0.9, "momentum 0.98": 0.98}
    how = {"epochs": 2000, "warm_up": 500, "progress": False}
    start, lines = Weights.random(8, 21), {}
    for name, momentum in momenta.items():
        run = train_ensemble(start, data, momentum=momentum, **how)[1]
        lines[name] = run.epochs, run.training
    ends = "; ".join(f"{name} {np.median(y[-1]):.2f}" for name, (_, y) in lines.items())
    alt = f"Families of curves over the epochs; medians at the end: {ends}."
    return families({"": lines}, ("epoch", "training RMSS"), alt, height=2.3, y_log=True)


def _needed() -> tuple[np.ndarray, ...]:
    """Epochs to `_LEVEL` of the networks that learn as in 1988, without and with momentum."""
    races = map(results.read("acceleration")["race"].get, ("without", "with"))
    runs = [History(np.array(run["epochs"]), np.array(run["training"])) for run in races]
    return tuple(np.minimum(_reach(run), run.epochs[-1]) for run in runs)


def _quoted() -> None:
    """The book's numbers in the lesson's prose."""
    plain, quick = map(np.median, _needed())
    on_parity = results.read("acceleration")["parity"]
    weights = Weights.random(1, 21)[0].count(biases=True)
    quote("backpropagation-weights", weights)
    quote("backpropagation-tries", 2 * weights)
    quote("backpropagation-needed-without", plain)
    quote("backpropagation-needed-with", quick)
    quote(
        "backpropagation-parity-race",
        np.median(on_parity["without"]) / np.median(on_parity["with"]),
    )


def _exercise(number: int, *given) -> Exercise:
    """An exercise of the lesson."""
    if number == 1:
        alpha = np.array([0.0, 0.5, 0.9])

        def bound(f):
            return lambda mine: np.allclose([mine(a) for a in alpha], f(alpha))

        slips = [
            (bound(lambda a: 2 + 0 * a), "this is the bound without momentum."),
            (
                bound(lambda a: 1 / (1 - a)),
                "this is how far equal steps add up.",
            ),
            (bound(lambda a: 2 * (1 - a)), "momentum allows larger steps, not smaller."),
        ]
        reason = "at this step size a root leaves the unit circle, at −1."
        hint = "for which r does the first root reach size 1?"
        return Exercise("function", bound(lambda a: 2 * (1 + a)), reason, slips, hint)
    elif number == 2:
        misses = {eta: abs(given[0](eta)) for eta in 10.0 ** -np.arange(1, 13)}
        best = min(misses, key=misses.get)
        slips = [
            (Between(5e-324, best), "such a small change drowns in rounding."),  # above 0
            (Between(best), "with such a large change the curvature spoils the slope."),
        ]
        reason = f"{scientific(best)} is best; it misses {scientific(misses[best])} of the slope."
        return Exercise("number", Between(best / 11, 11 * best), reason, slips)
    elif number == 4:
        (h, *_), (y,), (d,), V = (*map(np.ravel, given[:1]), *given[1:])
        delta, slope = (y - d) * y * (1 - y), h * (1 - h)
        right = V[1, 0] * delta[1] * slope
        slips = [
            (V[:, 0] @ delta * slope, "the shoulder was right. What is its δ?"),
            (V[0, 0] * delta[0] * slope, "that is the shoulder's blame."),
            (-right, "the sign: δ begins with y − d."),
            (delta[1] * slope, "the blame comes through a weight of V."),
            (right / slope, "a slope is missing, h (1 − h) or y (1 − y)."),
        ]
        hint = "whose δ arrives, through which weight, and how far is the unit on?"
        return Exercise("number", right, "it collects the elbow's δ alone.", slips, hint)
    else:
        descend, x, d, level = given
        end = cache(lambda mine: descend(x, d, *mine, epochs=1000, warm_up=0)[1][-1])
        slips = [
            (lambda mine: not end(mine) <= 1, "the descent went astray: the steps are too large.")
        ]
        hint = f"the training RMSS must fall below {level / 2:.2f} within 1,000 epochs."
        reason = "with momentum many small steps add up, so you need less patience."
        return Exercise(
            "numbers",
            lambda mine: end(mine) < level / 2,
            reason,
            slips,
            hint,
            count=2,
            unless=[(lambda mine: mine[0] <= 0, "the step size must be above 0.")],
        )


check = judging(_exercise)


# --- what the claims of the chapter measure


@cache
def _data() -> TrainingSet:
    return TrainingSet.from_recording(committed.training(), 21)


def unit() -> Measured:
    """Largest difference between the networks' hidden activities and the printed formula."""
    data, weights = _data(), Weights.random(1, 21, initial=STATE_FEEDBACK.initial)[0]
    x = data.x.reshape(len(data.x), -1)
    net = x @ weights.hidden_weights.reshape(-1, x.shape[1]).T + weights.hidden_bias
    gap = np.abs(weights.activity(data.x)[0] - (1 + np.exp(-net)) ** -1).max()
    return Measured(float(gap), f"largest difference {scientific(gap)}")


def chain_rule() -> Measured:
    """Largest difference between a step of `Descent` and one by autograd, over the largest."""
    data, network = _data(), WindowNetwork(21)
    start = Weights.stack([network.weights()])
    descent = Descent(start, data.x, data.y, 1 / len(data.x), 0.0)
    descent.epoch()
    x, y = (network.output_bias.new_tensor(part) for part in (data.x, data.y))
    (0.5 * (network(x) - y).square().sum() / len(data.x)).backward()
    after, largest, gap = descent.weights(), 0.0, 0.0
    for name, parameter in network.named_parameters():
        step = getattr(after, name)[0] - getattr(start, name)[0]
        wanted = -parameter.grad.numpy()
        gap = max(gap, float(np.abs(step - wanted).max()))
        largest = max(largest, float(np.abs(wanted).max()))
    return Measured(gap / largest, f"{scientific(gap / largest)} of the largest derivative")


def _reach(history: History, level: float = _LEVEL) -> np.ndarray:
    """Epochs after which each member's training error first falls below a level."""
    epochs = []
    for error in history.training.T:
        first = next(iter(np.flatnonzero(error < level)), None)
        k = slice(max((first or 0) - 1, 0), (first or 0) + 1)
        there = np.interp(-level, -error[k], history.epochs[k])
        epochs.append(np.inf if first is None else float(there))
    return np.array(epochs)


def acceleration() -> Measured:
    """How much more momentum speeds up learning on the windows than on parity, in epochs."""
    kept = results.read("acceleration")
    cells = [_needed(), tuple(kept["parity"][name] for name in ("without", "with"))]

    def faster(pair):
        return median(pair[0]) / median(pair[1])

    here, there = (significant(np.median(a) / np.median(b), 2) for a, b in cells)
    text = f"{here} times faster here, {there} times on parity of {kept['bits']} bits"
    return judged(lambda here, there: faster(here) / faster(there), *cells, text=text)


def fine_distinctions(bits: int = 3, noise: float = 0.25) -> Measured:
    """Right answers to parity of noisy bits, as a part of the best possible: the nearest corner."""
    x, y = parity_cases(bits)
    rng = np.random.default_rng(0)

    def draw(copies):
        clean, wanted = np.repeat(x, copies, axis=0), np.repeat(y, copies, axis=0)
        return clean + rng.normal(0.0, noise, clean.shape), wanted

    (training, targets), (fresh, wanted) = draw(50), draw(250)
    start = Weights.random(20, bits, 2 * bits, 1, 1, initial=1.0)
    descent = Descent(start, training, targets, 8.0 / len(training), 0.9)
    for _ in range(1500):
        descent.epoch()
    share = right(descent.weights(), fresh, wanted)
    corner = np.round(fresh[:, 0]).clip(0, 1)
    best = np.mean(parity(corner) == parity(np.repeat(x[:, 0], 250, axis=0)))
    text = f"{spread(100 * share, 3)} % right, at best {significant(100 * best, 3)} %"
    return judged(median, share / best, text=text)


def polynomial(coding: str = "bits", most: int = 10) -> Measured:
    """Growth of the number of coefficients of parity as a polynomial, in doublings per bit."""
    bits = np.arange(2, most + 1)
    counts = [np.count_nonzero(monomials(parity(patterns(n)), coding)) for n in bits]
    growth = float(np.polyfit(bits, np.log2(counts), 1)[0])
    return Measured(growth, f"{counts[0]} at {bits[0]} bits, {counts[-1]:,} at {most}")


def network(name: str = "binary counter", most: int = 10, large: int = 1024) -> Measured:
    """Growth of a network's coefficients beyond ``n log2 n``, from few bits to many."""
    make = NETWORKS[name]
    inputs = {n: patterns(n) for n in range(2, most + 1)}
    inputs[large] = np.tri(large + 1, large, -1)  # one for each number of bits that are on
    wrong = [n for n, x in inputs.items() if (make(n).output(x) != parity(x)).any()]
    if wrong:
        raise AssertionError(f"{name} is wrong at {wrong} bits")
    few, many = (make(n).coefficients for n in (most, large))
    ratio = many / (large * np.log2(large)) / (few / (most * np.log2(most)))
    return Measured(float(ratio), f"{few} coefficients at {most} bits, {many:,} at {large:,}")


def stable(widths=WINDOWS) -> Measured:
    """Change of all weights over the second half of training, the largest median of a window."""
    changes = {width: _late_change(width) for width in widths}
    half, last, _ = changes[widths[0]]
    value = max(change for *_, change in changes.values())
    text = ", ".join(f"{significant(100 * c, 2)} % at {w}" for w, (*_, c) in changes.items())
    return Measured(value, f"{text}, from epoch {half:,} to {last:,}")


def _late_change(width: int) -> tuple[int, int, float]:
    """Two epochs, half-way and last, and the median change of the weights between them."""
    epochs, model = results.course(width)
    half = int(np.argmin(np.abs(epochs - paper.EPOCHS / 2)))
    last = int(np.flatnonzero(epochs == paper.EPOCHS)[0])
    names = ("hidden_weights", "hidden_bias", "output_weights", "direct_weights", "output_bias")
    parts = [getattr(model.weights, name) for name in names]
    weights = np.concatenate([p.reshape(*p.shape[:2], -1) for p in parts], -1)
    change = np.linalg.norm(weights[last] - weights[half], axis=-1)
    share = change / np.linalg.norm(weights[last], axis=-1)
    return int(epochs[half]), int(epochs[last]), float(np.median(share))


def settling(steepest: float = 0.1) -> Measured:
    """Epochs until the median slope of the error stays flat, at least; the largest over windows."""
    cells, epochs = [], []
    for record in results.read("longer")["windows"].values():
        at = np.array(record["history"]["epochs"])
        errors = np.array(record["history"]["training"]).T
        slopes = [History(at[:k], errors[:k]).slope() for k in range(2, len(at) + 1)]
        cells.append(np.abs(slopes).T)
        epochs.append(at)

    def settled(at, slopes):
        """Epoch after the last record at which the median is steep; the end if that is the last."""
        steep = np.median(slopes, axis=1) > steepest
        last = np.where(steep.any(-1), steep.shape[-1] - 1 - steep[..., ::-1].argmax(-1), -1)
        return at[np.minimum(last + 2, len(at) - 1)], last < steep.shape[-1] - 1

    def latest(*drawn):
        return np.max([settled(at, slopes)[0] for at, slopes in zip(epochs, drawn)], axis=0)

    words = []
    for at, slopes in zip(epochs, cells):
        (needed,), (flat,) = settled(at, slopes[None])
        words.append(f"{needed:,}" if flat else f"over {needed:,}")
    return judged(latest, *cells, text="epochs: " + ", ".join(words))
