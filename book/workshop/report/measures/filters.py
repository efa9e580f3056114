"""Sections 5 and 7: weights as filters, measured on the committed networks."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from ddlib.analysis import (
    LAYERS,
    QUANTITIES,
    classify,
    decompose,
    filter_responses,
    roughness,
    saturated,
    shares,
)
from ddlib.learning import Weights, cases
from ddlib.metrics import rmss
from ddlib.setups import STATE_FEEDBACK, WINDOWS, predict, true_states
from ddlib.tables import scientific, significant, spread
from workshop.report import committed
from workshop.report.evidence.verdicts import Measured, judged, largest_median, mean, median
from workshop.report.probes import zero_crossings


def _made(
    of: Callable, layer: str, widths: Sequence = WINDOWS, setup: str = STATE_FEEDBACK.name
) -> list[tuple]:
    """What a function makes of filters, a cell for each window; and the same before training."""
    return list(
        zip(*([of(f) for f in committed.filters_of_layer(w, layer, setup)] for w in widths))
    )


def of_class(
    width: int, name: str, layer: str = "hidden", setup: str = STATE_FEEDBACK.name
) -> Measured:
    """Share of filters that `ddlib.analysis.classify` gives a name, less untrained ones.

    `name` and `layer` may be several, with "|" between them.
    """
    trained, before = _named(width, name, layer, setup)
    text = f"{trained.sum()} of {trained.size} filters, {before.sum()} before training"
    return judged(lambda pair: mean(pair[0]) - mean(pair[1]), (trained, before), text=text)


def with_unit(
    width: int, name: str, layer: str = "hidden", setup: str = STATE_FEEDBACK.name
) -> Measured:
    """Share of the networks in which one filter or more has a name."""
    trained, before = _named(width, name, layer, setup)
    having = trained.any(-1)
    text = f"{having.sum()} of {having.size} networks, {trained.sum()} of {trained.size} filters; "
    text += f"before training {before.any(-1).sum()} networks"
    return judged(mean, having, text=text)


def _named(width: int, name: str, layer: str, setup: str) -> tuple[np.ndarray, np.ndarray]:
    """Which filters of each network have one of some names, and which had before training."""

    def has(f):
        return np.isin(classify(f), name.split("|"))

    cells = [_made(has, part, [width], setup) for part in layer.split("|")]
    return tuple(np.concatenate([cell[k][0] for cell in cells], -1) for k in (0, 1))


def not_analysable(wide: int = 41, narrow: int = 21) -> Measured:
    """Share of hidden filters that are not analysable after training; before it all are."""
    widths = wide, narrow
    cells, before = _made(lambda f: classify(f) == "not analysable", "hidden", widths)
    text = ", ".join(f"{c.sum()} of {c.size} at {w}" for c, w in zip(cells, widths))
    least = 100 * min(cell.mean() for cell in before)
    return judged(mean, cells[0], text=f"{text}; before training {least:.0f} %")


def untrained(width: int = 41) -> Measured:
    """Share of random weight functions that the rule calls not analysable."""
    names = classify(Weights.random(25, width).hidden_weights.reshape(-1, width))
    rough = names == "not analysable"
    return Measured(float(rough.mean()), f"{rough.sum()} of {rough.size} random functions")


def explained(layer: str = "direct", setup: str = STATE_FEEDBACK.name) -> Measured:
    """Median share of position, velocity and acceleration in filters; the least of 3 windows."""
    cells, before = _made(lambda f: shares(f)[..., :3].sum(-1), layer, setup=setup)
    text = ", ".join(f"{100 * np.median(c):.0f} % at {w}" for c, w in zip(cells, WINDOWS))
    text += f" of the energy; before training at most {100 * max(map(np.median, before)):.0f} %"
    return judged(lambda *cells: np.min(list(map(median, cells)), axis=0), *cells, text=text)


def constant_share(
    layer: str = "hidden", width: int = 21, setup: str = STATE_FEEDBACK.name
) -> Measured:
    """Median share of the constant term in the energy of the filters."""
    (trained,), (before,) = _made(lambda f: shares(f)[..., 0], layer, [width], setup)
    now, then = (100 * np.median(x) for x in (trained, before))
    return judged(median, trained, text=f"{now:.1f} % of the energy, {then:.1f} % before training")


def asymmetric(width: int = 21, shift: float = 0.5, setup: str = STATE_FEEDBACK.name) -> Measured:
    """Share of direct filters with two zero crossings whose middle is `shift` samples off."""
    (two, off), (before, _) = (
        zero_crossings(f, shift) for f in committed.filters_of_layer(width, "direct", setup)
    )

    def share(pair):
        return mean(pair[0]) / np.maximum(mean(pair[1]), 1 / two.size)

    text = f"{off.sum()} of {two.sum()} filters with two crossings; before training {before.sum()} "
    return judged(share, (off, two), text=f"{text}have two")


def follow(width: int = 21, name: str = "acceleration", layer: str = "direct") -> Measured:
    """Share of a layer's filters that follow a joint's true position, velocity or acceleration."""
    training = committed.training()
    states = true_states(training, STATE_FEEDBACK).reshape(-1, 2, 3)
    f = getattr(committed.networks(width).weights, LAYERS[layer])
    strongest = filter_responses(f, cases(training, width)[0], states).strongest
    following = (strongest == QUANTITIES.index(name)).mean((1, 2))
    counts = ", ".join(f"{n} {(strongest == k).sum()}" for k, n in enumerate(QUANTITIES))
    return judged(mean, following, text=f"best correlated with {counts} of {strongest.size}")


def rougher(wide: int = 41, narrow: int = 21, setup: str = STATE_FEEDBACK.name) -> Measured:
    """Ratio of the median roughness of hidden filters at two window sizes."""
    cells, before = _made(roughness, "hidden", (wide, narrow), setup)
    now, then = ([significant(np.median(x), 2) for x in xs] for xs in (cells, before))
    text = f"roughness {now[0]} at {wide}, {now[1]} at {narrow}; "
    text += f"before training {then[0]} and {then[1]}"
    return judged(lambda a, b: median(a) / median(b), *cells, text=text)


def direct_smoothness(setup: str = STATE_FEEDBACK.name) -> Measured:
    """Largest median roughness of the direct weights over the windows (white noise: 1)."""
    cells, before = _made(roughness, "direct", setup=setup)
    now, then = (", ".join(significant(np.median(x), 2) for x in xs) for xs in (cells, before))
    return judged(largest_median, *cells, text=f"roughness {now}; before training {then}")


def changed_roughness(width: int = 41, setup: str = STATE_FEEDBACK.name) -> Measured:
    """Roughness of what training adds to the initial weights of the hidden units."""
    trained, before = committed.filters_of_layer(width, "hidden", setup)
    change = roughness(trained - before)
    text = f"{spread(change)}; the filters have {spread(roughness(trained))}"
    return judged(median, change, text=text)


def parts_sum_up() -> Measured:
    """Largest difference between a filter and the sum of its parts as the paper prints them."""
    f = committed.filters_of_layer(21, "hidden")[0].reshape(-1, 21)
    gap = max(np.abs(decompose(f, c).sum() - f).max() for c in ("paper", "symmetric"))
    odd = decompose(f, "paper").odd
    skew = float(np.median(np.abs(odd + odd[:, ::-1]).max(-1) / np.abs(odd).max(-1)))
    text = f"the parts sum to f (to {scientific(gap)}); as printed, odd(x) + odd(-x) reaches "
    return Measured(skew, f"{text}{100 * skew:.0f} % of odd's peak in the median")


def saturation(width: int, setup: str = STATE_FEEDBACK.name) -> Measured:
    """Median share of cases in which a hidden unit is below 0.1 or above 0.9."""
    windows, _ = cases(committed.training(setup), width)

    def often(models):
        model = models(width, setup)
        return saturated(model.weights.activity(model.scaled(windows))[0])

    share, before = committed.both(often)
    now, then = (100 * np.median(x) for x in (share, before))
    return judged(median, share, text=f"{now:.0f} % of the time, {then:.0f} % before training")


def shoulder_profile(width: int, setup: str = STATE_FEEDBACK.name) -> Measured:
    """Error of the shoulder's torque alone on trajectory 6 (Figure 4-1), median of networks."""
    test = committed.recording(setup)[5]
    predicted = predict(committed.networks(width, setup), test)
    wrong = rmss(predicted, test.tau[test.motion], pooled=False)[..., 0]
    return judged(median, wrong, text=spread(wrong))
