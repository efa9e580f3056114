"""Section 5: weights as filters and hidden units at work, measured on the committed networks."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np
from scipy.linalg import orth

from ddlib.analysis import (
    LAYERS,
    QUANTITIES,
    ablation,
    classify,
    decompose,
    explained,
    followed,
    net_inputs,
    refitted,
    roughness,
    saturated,
    shares,
    transition_width,
)
from ddlib.learning import cases
from ddlib.metrics import rmss
from ddlib.setups import JOINT_DAMPING, SETUPS, STATE_FEEDBACK, WINDOWS, predict, true_states
from ddlib.simulation import LOG_STEP
from ddlib.tables import scientific, significant, spread
from workshop.report import committed
from workshop.report.evidence.verdicts import Measured, judged, largest_median, mean, median


def _pair(width: int, layer: str, setup: str = STATE_FEEDBACK.name) -> list[np.ndarray]:
    """Filters of the trained networks, and of the same before training."""
    models = committed.networks, committed._untrained
    return [committed.filters(width, layer, model, setup) for model in models]


def of_class(
    width: int, name: str, layer: str = "hidden", setup: str = STATE_FEEDBACK.name
) -> Measured:
    """Share of a layer's filters that `ddlib.analysis.classify` gives a name, less untrained."""
    trained, before = (classify(f) == name for f in _pair(width, layer, setup))
    text = f"{trained.sum()} of {trained.size} filters, {before.sum()} before training"
    return judged(lambda pair: mean(pair[0]) - mean(pair[1]), (trained, before), text=text)


def not_analysable(wide: int = 41, narrow: int = 21) -> Measured:
    """Share of hidden filters that are not analysable after training; a narrower window's beside.

    Before training all are, at every window: that some are left says little.
    """
    cells = [classify(committed.filters(w, "hidden")) == "not analysable" for w in (wide, narrow)]
    text = ", ".join(f"{c.sum()} of {c.size} at {w}" for c, w in zip(cells, (wide, narrow)))
    before = [(classify(_pair(w, "hidden")[1]) == "not analysable").mean() for w in (wide, narrow)]
    return judged(mean, cells[0], text=f"{text}; before training {100 * min(before):.0f} %")


def follow(width: int = 21, name: str = "acceleration", layer: str = "direct") -> Measured:
    """Share of a layer's filters whose output correlates best with a quantity.

    Along the training motions, with the true position, velocity and acceleration of the joint
    whose window the filter sees.
    """
    training = committed.training()
    states = true_states(training, STATE_FEEDBACK).reshape(-1, 2, 3)
    f = getattr(committed.networks(width).weights, LAYERS[layer])
    strongest = followed(f, cases(training, width)[0], states).strongest
    each = (strongest == QUANTITIES.index(name)).mean((1, 2))
    counts = ", ".join(f"{n} {(strongest == k).sum()}" for k, n in enumerate(QUANTITIES))
    return judged(mean, each, text=f"best correlated with {counts} of {strongest.size}")


def rougher(wide: int = 41, narrow: int = 21) -> Measured:
    """Ratio of the median roughness of hidden filters at two window sizes."""
    cells = [roughness(committed.filters(w, "hidden")) for w in (wide, narrow)]
    before = [roughness(_pair(w, "hidden")[1]) for w in (wide, narrow)]
    wide_, narrow_, *null = (significant(np.median(x), 2) for x in (*cells, *before))
    text = f"roughness {wide_} at {wide}, {narrow_} at {narrow}; "
    text += "before training {} and {}".format(*null)
    return judged(lambda a, b: median(a) / median(b), *cells, text=text)


def direct_smoothness() -> Measured:
    """Largest median roughness of the direct weights over the windows (white noise: 1)."""
    cells, before = zip(*(map(roughness, _pair(w, "direct")) for w in WINDOWS))
    now, then = (", ".join(significant(np.median(x), 2) for x in xs) for xs in (cells, before))
    return judged(largest_median, *cells, text=f"roughness {now}; before training {then}")


def changed_roughness(width: int = 41) -> Measured:
    """Roughness of what training adds to the initial weights of the hidden units."""
    trained, before = _pair(width, "hidden")
    change = roughness(trained - before)
    text = f"{spread(change)}; the filters have {spread(roughness(trained))}"
    return judged(median, change, text=text)


def constant_share(layer: str = "hidden", width: int = 21) -> Measured:
    """Median share of the constant term in the energy of the filters."""
    trained, before = (shares(f)[..., 0] for f in _pair(width, layer))
    now, then = (100 * np.median(x) for x in (trained, before))
    return judged(median, trained, text=f"{now:.1f} % of the energy, {then:.1f} % before training")


def parts_sum_up() -> Measured:
    """Largest difference between a filter and the sum of its parts as the paper prints them."""
    f = committed.filters(21, "hidden").reshape(-1, 21)
    gap = max(np.abs(decompose(f, c).sum() - f).max() for c in ("paper", "symmetric"))
    odd = decompose(f, "paper").odd
    skew = float(np.median(np.abs(odd + odd[:, ::-1]).max(-1) / np.abs(odd).max(-1)))
    text = f"the parts sum to f (to {scientific(gap)}); as printed, odd(x) + odd(-x) reaches "
    return Measured(skew, f"{text}{100 * skew:.0f} % of odd's peak in the median")


def _both(of: Callable) -> list:
    """What a function makes of the trained networks, and of the same before training."""
    return [of(models) for models in (committed.networks, committed._untrained)]


def saturation(width: int, setup: str = STATE_FEEDBACK.name) -> Measured:
    """Median share of cases in which a hidden unit is below 0.1 or above 0.9."""
    windows, _ = cases(committed.training(setup), width)

    def often(models):
        model = models(width, setup)
        return saturated(model.weights.activity(model.scaled(windows))[0])

    share, before = _both(often)
    now, then = (100 * np.median(x) for x in (share, before))
    return judged(median, share, text=f"{now:.0f} % of the time, {then:.0f} % before training")


def in_transition(width: int) -> Measured:
    """Median share of cases in which a hidden unit is in its transition region, 0.1 to 0.9."""
    windows, _ = cases(committed.training(), width)

    def often(models):
        net = net_inputs(models(width), windows)
        return 1 - saturated(1 / (1 + np.exp(-net))), transition_width(net)

    (share, region), (before, _) = _both(often)
    now, then = (100 * np.median(x) for x in (share, before))
    text = f"{now:.0f} % of the time, {then:.0f} % before training; the region is "
    text += f"{significant(np.median(region), 2)} standard deviations of the net input wide"
    return judged(median, share, text=text)


def spare_units(width: int, worse: float = 1.1) -> Measured:
    """Median number of hidden units of ten that can be held still at almost no loss.

    The training error then grows by less than the factor `worse`.
    """
    windows, torque = cases(committed.training(), width)

    def spare_of(models):
        every = models(width)
        return np.array(
            [
                (
                    ablation(one, windows, torque)[1] < worse * rmss(one.torque(windows), torque)
                ).sum()
                for one in (every[k] for k in range(len(every.weights)))
            ]
        )

    spare, before = _both(spare_of)
    text = f"{np.median(spare):.0f} of 10 units can be spared ({spare.min()} to {spare.max()}), "
    return judged(median, spare, text=f"{text}{np.median(before):.0f} before training")


def shoulder_profile(width: int) -> Measured:
    """Error of the shoulder's torque alone on trajectory 6 (Figure 4-1), median of networks."""
    test = committed.recording()[5]
    predicted = predict(committed.networks(width), test)
    wrong = rmss(predicted, test.tau[test.motion], pooled=False)[..., 0]
    return judged(median, wrong, text=spread(wrong))


_RUNS = ("training", "trajectory 6")  # Where errors are taken


@cache
def _features(width: int, setup: str) -> tuple:
    """Windows and hidden activities in rows, and torques, in training and on trajectory 6."""
    runs = committed.training(setup), committed.recording(setup)[5]
    model, found = committed.networks(width, setup), []
    for run in runs:
        windows, torque = cases(run, width)
        hidden = model.weights.activity(model.scaled(windows))[0]
        found.append((windows.reshape(len(windows), -1), hidden, torque))
    return tuple(found)


def linear_alone(width: int = 21, setup: str = JOINT_DAMPING.name) -> np.ndarray:
    """Errors of a linear filter of the window, by least squares: training, trajectory 6."""
    (x, _, y), (new, _, answer) = _features(width, setup)
    return refitted(x, y, new, answer)


def hidden_units_add(
    width: int = 21, setup: str = JOINT_DAMPING.name, runs: str = "training"
) -> Measured:
    """Error of a linear filter alone over that with the hidden units, both fitted anew."""
    (x, hidden, y), (new, held, answer) = _features(width, setup)
    alone = linear_alone(width, setup)[_RUNS.index(runs)]
    pairs = [
        refitted(np.column_stack([x, h]), y, np.column_stack([new, t]), answer)
        for h, t in zip(hidden, held)
    ]
    both = np.array(pairs)[:, _RUNS.index(runs)]
    text = f"{significant(alone, 2)} alone, {significant(np.median(both), 2)} with hidden units"
    return judged(median, alone / both, text=text)


def compensate_friction(width: int = 21, setup: str = JOINT_DAMPING.name) -> Measured:
    """Share of the hidden units' non-linear part that friction and rigid body explain.

    Least squares takes what is linear in the window out of the hidden units' sum, of the true
    friction torque and of the rigid body's. What is left of the sum is fitted by what is left of
    both together; R², the better of two joints, medians over networks.
    """
    run, chosen = committed.training(setup), SETUPS[setup]
    x, hidden, _ = _features(width, setup)[0]
    weights = committed.networks(width, setup).weights
    sums = np.einsum("mnh,moh->mno", hidden, weights.output_weights)
    speed = run.qd_true[..., run.motion, :]
    acceleration = np.gradient(run.qd_true, LOG_STEP, axis=-2)[..., run.motion, :]
    rigid = chosen.arm.inverse_dynamics(run.q_true[..., run.motion, :], speed, acceleration)
    axes = orth(np.column_stack([x, np.ones(len(x))]), rcond=1e-9)

    def curved(y):
        return y - axes @ (axes.T @ y)

    known = [curved(y.reshape(-1, 2)) for y in (chosen.effects.friction_torque(speed), rigid)]
    rest, told = [curved(each) for each in sums], []
    for name, parts in (("friction", known[:1]), ("rigid body", known[1:]), ("together", known)):
        fits = np.array(
            [[explained(x[:, j], *(k[:, j] for k in parts)) for j in (0, 1)] for x in rest]
        )
        told.append("{} {:.2f} and {:.2f}".format(name, *np.median(fits, axis=0)))
    text = f"R² {'; '.join(told)}, shoulder and elbow"
    return judged(lambda each: np.median(each, axis=1).max(-1), fits, text=text)
