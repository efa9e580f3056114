"""Sections 1.1, 1.2 and 3.3: the unit, the rule, acceleration, and parity as an example."""

from __future__ import annotations

from functools import cache

import numpy as np

from ddlib import paper
from ddlib.learning import Descent, History, TrainingSet, Weights, WindowNetwork
from ddlib.setups import STATE_FEEDBACK, WINDOWS
from ddlib.tables import scientific, significant, spread
from workshop.report import committed, parity_networks, results
from workshop.report.evidence.verdicts import Measured, judged, median

_LEVEL = 0.75  # Training RMSS to which runs with and without acceleration are timed


@cache
def _data(width: int = 21) -> TrainingSet:
    return TrainingSet.from_recording(committed.training(), width)


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


def reach(history: History, level: float = _LEVEL) -> np.ndarray:
    """Epochs after which each member's training error first falls below a level."""
    found = []
    for error in history.training.T:
        below = np.flatnonzero(error < level)
        if not below.size:
            found.append(np.inf)
        elif below[0] == 0:
            found.append(float(history.epochs[0]))
        else:
            k = slice(below[0] - 1, below[0] + 1)
            found.append(float(np.interp(-level, -error[k], history.epochs[k])))
    return np.array(found)


def acceleration() -> Measured:
    """How much more acceleration speeds up learning here than in another domain, parity.

    The speed-up is the median number of epochs without over that with acceleration, at the same
    step size and from the same initial weights: to a training RMSS of `_LEVEL` on the windows of
    21, and to the first time that all inputs are right on parity. A run that does not get there
    counts with its length.
    """
    kept = results.read("acceleration")
    runs = [kept["race"][name] for name in ("without", "with")]
    histories = [History(np.array(run["epochs"]), np.array(run["training"])) for run in runs]
    here = tuple(np.minimum(reach(h), h.epochs[-1]) for h in histories)
    cells = [here, tuple(kept["parity"][name] for name in ("without", "with"))]

    def faster(pair):
        return median(pair[0]) / median(pair[1])

    here, there = (significant(np.median(a) / np.median(b), 2) for a, b in cells)
    text = f"{here} times faster here, {there} times on parity of {kept['bits']} bits"
    return judged(lambda here, there: faster(here) / faster(there), *cells, text=text)


def fine_distinctions(bits: int = 3, noise: float = 0.25) -> Measured:
    """Right answers on fresh noisy patterns, as a part of the best that is possible.

    The task is parity of a few bits, so that neighbours in every direction differ, with
    Gaussian noise on the inputs of training and test. Best possible: the nearest corner.
    """
    x, y = parity_networks.parity_cases(bits)
    rng = np.random.default_rng(0)

    def draw(copies):
        clean, wanted = np.repeat(x, copies, axis=0), np.repeat(y, copies, axis=0)
        return clean + rng.normal(0.0, noise, clean.shape), wanted

    (training, targets), (fresh, wanted) = draw(50), draw(250)
    start = Weights.random(20, bits, 2 * bits, 1, 1, initial=1.0)
    descent = Descent(start, training, targets, 8.0 / len(training), 0.9)
    for _ in range(1500):
        descent.epoch()
    share = parity_networks.right(descent.weights(), fresh, wanted)
    corner = np.round(fresh[:, 0]).clip(0, 1)
    best = np.mean(
        parity_networks.parity(corner) == parity_networks.parity(np.repeat(x[:, 0], 250, axis=0))
    )
    text = f"{spread(100 * share, 3)} % right, at best {significant(100 * best, 3)} %"
    return judged(median, share / best, text=text)


def polynomial(coding: str = "bits", most: int = 10) -> Measured:
    """Growth of the number of coefficients of parity as a polynomial, in doublings per bit."""
    bits = np.arange(2, most + 1)
    counts = [
        np.count_nonzero(
            parity_networks.monomials(parity_networks.parity(parity_networks.patterns(n)), coding)
        )
        for n in bits
    ]
    growth = float(np.polyfit(bits, np.log2(counts), 1)[0])
    return Measured(growth, f"{counts[0]} at {bits[0]} bits, {counts[-1]:,} at {most}")


def network(name: str = "binary counter", most: int = 10, large: int = 1024) -> Measured:
    """Growth of a network's coefficients beyond ``n log2 n``, from few bits to many."""
    make = parity_networks.NETWORKS[name]
    for n in range(2, most + 1):
        x = parity_networks.patterns(n)
        if (make(n).output(x) != parity_networks.parity(x)).any():
            raise AssertionError(f"{name} is wrong at {n} bits")
    x = np.tri(large + 1, large, -1)
    if (make(large).output(x) != parity_networks.parity(x)).any():
        raise AssertionError(f"{name} is wrong at {large} bits")
    few, many = (make(n).coefficients for n in (most, large))
    ratio = many / (large * np.log2(large)) / (few / (most * np.log2(most)))
    return Measured(float(ratio), f"{few} coefficients at {most} bits, {many:,} at {large:,}")


def stable(widths=WINDOWS) -> Measured:
    """Change of all weights over the second half of training, relative to their size.

    The largest over windows, each the median of its networks. Two networks of each are kept:
    too few to draw from, so there are no replicates.
    """
    found = {width: _late_change(width) for width in widths}
    half, last, _ = found[widths[0]]
    value = max(change for *_, change in found.values())
    text = ", ".join(f"{significant(100 * c, 2)} % at {w}" for w, (*_, c) in found.items())
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
    """Epochs from which on the median slope of the error stays flat, the largest over windows.

    The end of the longest runs if it is still steep there: then it is a lower bound.
    """
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


# --- ddlib.learning.span: what is learnt along them


def learning(width: int, case: int) -> dict:
    """A cell of the study "span": `case` 0, inputs 0 to 1; 1, -1 to 1; 2, damped joints."""
    return results.read("span")["cells"][len(WINDOWS) * case + WINDOWS.index(width)]


def halved(first: list, then: list, width: int = 21, case: int = 0) -> Measured:
    """Epoch at which some directions' parts of the error are half, over that of others.

    Of several directions the geometric mean counts.
    """
    cell, epochs = learning(width, case), {}
    for who in ("measured", "predicted"):
        halves = np.log(np.array(cell[who]["halves"], float))
        epochs[who] = [halves[:, np.array(group) - 1].mean(1) for group in (first, then)]
    ratios = {who: np.exp(late - early) for who, (early, late) in epochs.items()}
    text = f"{spread(ratios['measured'])}; predicted {spread(ratios['predicted'])}"
    return judged(median, ratios["measured"], text=text)


def centred(name: str = "rmss") -> Measured:
    """Median error with inputs from 0 to 1 over that with -1 to 1, the least of three windows."""
    cells = [[learning(w, case) for case in (0, 1)] for w in WINDOWS]
    pairs = {
        who: [tuple(np.array(c[who][name]) for c in both) for both in cells]
        for who in ("measured", "predicted")
    }
    shown = {
        who: ", ".join(significant(np.median(a) / np.median(b), 2) for a, b in each)
        for who, each in pairs.items()
    }

    def least(*drawn):
        return np.min([median(a) / median(b) for a, b in drawn], axis=0)

    text = f"{shown['measured']}; predicted {shown['predicted']}"
    return judged(least, *[(a, b) for a, b in pairs["measured"]], text=text)
