"""Section 5: weights as filters and hidden units at work, measured on the committed networks."""

from __future__ import annotations

import numpy as np

from ddlib import results
from ddlib.experiment import STATE_FEEDBACK, predict, run
from ddlib.filters import classify, decompose, roughness, shares
from ddlib.harmonics import true_states
from ddlib.measures import committed
from ddlib.metrics import rmss
from ddlib.network import Weights
from ddlib.responses import LAYERS, QUANTITIES, responses
from ddlib.tables import number, scientific, spread
from ddlib.training import cases
from ddlib.units import ablation, cancellation, net_inputs, saturated, transition_width
from ddlib.verdicts import Measured, over_members


def of_class(width: int, name: str, layer: str = "hidden") -> Measured:
    """Share of the filters of a layer that `ddlib.filters.classify` gives a name.

    Parameters
    ----------
    width : int
        Window size.
    name : str
        One of `ddlib.filters.CLASSES`.
    layer : {"hidden", "skip"}
        To the hidden units, or directly to the outputs.
    """
    found = classify(committed.filters(width, layer)) == name
    return Measured(float(found.mean()), f"{found.sum()} of {found.size} filters")


def follow(width: int = 21, name: str = "acceleration", layer: str = "direct") -> Measured:
    """Share of a layer's filters whose output correlates best with a quantity (judged).

    Along the training motions, with the true position, velocity and acceleration of the joint
    whose window the filter sees. The replicates draw networks.

    Parameters
    ----------
    width : int
        Window size.
    name : str
        One of `ddlib.responses.QUANTITIES`.
    layer : str
        One of `ddlib.responses.LAYERS`.
    """
    training = committed.training()
    states = true_states(training, STATE_FEEDBACK).reshape(-1, 2, 3)
    f = getattr(committed.networks(width).weights, LAYERS[layer])
    strongest = responses(f, cases(training, width)[0], states).strongest
    each = (strongest == QUANTITIES.index(name)).mean((1, 2))
    share, draws = over_members(lambda x: x.mean(-1), each)
    counts = ", ".join(f"{n} {(strongest == k).sum()}" for k, n in enumerate(QUANTITIES))
    return Measured(share, f"best correlated with {counts} of {strongest.size}", draws)


def rougher(wide: int = 41, narrow: int = 21) -> Measured:
    """Ratio of the median roughness of hidden filters at two window sizes."""
    values = [float(np.median(roughness(committed.filters(w, "hidden")))) for w in (wide, narrow)]
    text = f"roughness {number(values[0], 2)} at {wide}, {number(values[1], 2)} at {narrow}"
    return Measured(values[0] / values[1], text)


def direct_smoothness() -> Measured:
    """Largest median roughness of the direct weights over the windows (white noise: 1)."""
    medians = {w: float(np.median(roughness(committed.filters(w, "skip")))) for w in (11, 21, 41)}
    return Measured(
        max(medians.values()), "roughness " + ", ".join(number(m, 2) for m in medians.values())
    )


def changed_roughness(width: int = 41) -> Measured:
    """Roughness of what training adds to the initial weights of the hidden units."""
    _, model = results.course(width)
    weights = model.weights.hidden_weights
    change = roughness(weights[-1] - weights[0])
    return Measured(float(np.median(change)), spread(change))


def constant_share(layer: str = "hidden", width: int = 21) -> Measured:
    """Median share of the constant term in the energy of the filters."""
    constants = shares(committed.filters(width, layer))[:, 0]
    return Measured(
        float(np.median(constants)), f"{100 * np.median(constants):.1f} % of the energy"
    )


def parts_sum_up() -> Measured:
    """Largest difference between a filter and the sum of its parts as the paper prints them."""
    f = committed.filters(21, "hidden")
    gap = max(np.abs(decompose(f, c).sum() - f).max() for c in ("paper", "symmetric"))
    odd = decompose(f, "paper").odd
    skew = float(np.median(np.abs(odd + odd[:, ::-1]).max(-1) / np.abs(odd).max(-1)))
    return Measured(
        skew,
        f"the parts sum to f (to {scientific(gap)}); as printed, odd(x) + odd(-x) reaches "
        f"{100 * skew:.0f} % of odd's peak in the median",
    )


def zero_crossings(width: int = 41) -> Measured:
    """Share of hidden filters whose odd part changes sign between the centre and the edge."""
    odd = decompose(committed.filters(width, "hidden")).odd[:, width // 2 + 1 :]
    smooth = shares(committed.filters(width, "hidden"))[:, 4] < 0.2
    crosses = (np.diff(np.sign(odd), axis=-1) != 0).any(-1) & smooth
    return Measured(
        float(crosses[smooth].mean()), f"{crosses.sum()} of {smooth.sum()} smooth filters"
    )


def _activities(width: int):
    windows, torque = cases(committed.training(), width)
    model = committed.networks(width)
    return windows, torque, model.weights.activity(model.scaled(windows))[0]


def saturation(width: int) -> Measured:
    """Median share of cases in which a hidden unit is below 0.1 or above 0.9."""
    share = saturated(_activities(width)[2])
    return Measured(float(np.median(share)), f"{100 * np.median(share):.0f} % of the time")


def transition(width: int) -> Measured:
    """Median width of the transition region in standard deviations of the net input."""
    found = transition_width(net_inputs(committed.networks(width), _activities(width)[0]))
    return Measured(float(np.median(found)), f"{number(np.median(found), 2)} standard deviations")


def cancel(width: int) -> Measured:
    """Median share of the hidden units' influence that cancels at the outputs."""
    found = cancellation(committed.networks(width), _activities(width)[0])
    return Measured(float(np.median(found)), f"{100 * np.median(found):.0f} %")


def spare_units(width: int, worse: float = 1.1) -> Measured:
    """Median number of hidden units of ten that can be held still at almost no loss.

    Parameters
    ----------
    width : int
        Window size.
    worse : float
        "Almost no loss": the training error grows by less than this factor.
    """
    windows, torque = cases(committed.training(), width)
    spare = []
    for k in range(len(committed.networks(width).weights)):
        one = committed.networks(width)[k]
        before = rmss(one.torque(windows), torque)
        spare.append(int((ablation(one, windows, torque)[1] < worse * before).sum()))
    text = f"{np.median(spare):.0f} of 10 units can be spared ({min(spare)} to {max(spare)})"
    return Measured(float(np.median(spare)), text)


def structured(width: int) -> Measured:
    """Share of hidden filters that are analysable, less that of untrained networks."""
    untrained = Weights.random(25, width).hidden_weights.reshape(-1, width)
    trained = (classify(committed.filters(width, "hidden")) != "not analysable").mean()
    chance = (classify(untrained) != "not analysable").mean()
    text = f"{100 * trained:.0f} % of the filters have a name, untrained {100 * chance:.0f} %"
    return Measured(float(trained - chance), text)


def shoulder_profile(width: int) -> Measured:
    """Error of the shoulder's torque alone on trajectory 6 (Figure 4-1), median of networks."""
    test = run(committed.recording(), 5)
    predicted = predict(committed.networks(width), test)
    wrong = rmss(predicted, test.tau[test.motion], pooled=False)[..., 0]
    return Measured(float(np.median(wrong)), spread(wrong))
