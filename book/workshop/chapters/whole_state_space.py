"""Figures of *The whole state space*, what it says and asks, and what its claims measure."""

from __future__ import annotations

from functools import cache

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from ddlib import paper
from ddlib.analysis import input_shares, shuffled, transition_range
from ddlib.figures.style import INK, JOINTS, TONES, Illustration, illustrate
from ddlib.figures.weights import dots, largest_weight
from ddlib.learning import TorqueModel, Weights
from ddlib.metrics import rmss
from ddlib.tables import Table, quote, significant, spread
from workshop.chapters.exercises import Between, Exercise, judging
from workshop.report import results
from workshop.report.evidence import claims
from workshop.report.evidence.verdicts import Measured, judged, mean, median
from workshop.report.exact_states import random_states, states_along, torque

_SYMBOLS = ("$q_1$", "$v_1$", "$a_1$", "$q_2$", "$v_2$", "$a_2$")  # the six inputs in their order
_WIDTH, _BLOB = 12.0, "#8c8c8c"


def hinton_states(weights: Weights) -> Illustration:
    """Figure 6-1: all weights of a network of states, one row of six for each unit.

    Every grey blob is a unit: the outputs on top (shoulder left, elbow right), the hidden units
    below. The bottom row of a blob holds the weights from position, velocity and acceleration of
    the shoulder, then of the elbow. The bias is at the upper left; the two dots at the upper right
    of a hidden unit, and the middle row of an output unit, are the weights between them. A row of
    more than ten is squeezed.
    """
    largest = largest_weight(weights)
    hidden, outputs = len(weights.hidden_bias), len(weights.output_bias)
    rows = -(-hidden // 2)
    tall, low, step = 5.1, 3.6, 4.4

    def blob(axis, x, y, height, bias, top, inputs):
        axis.add_patch(Rectangle((x, y), _WIDTH, -height, facecolor=_BLOB, lw=0))
        dots(axis, bias, x + 1.0, y - 0.9, 1.0, -1.0, largest)
        if len(top) == 2:
            dots(axis, top, x + _WIDTH - 2.2, y - 0.9, 1.2, -1.0, largest)
        else:
            gap = min(1.1, 10.0 / max(len(top) - 1, 1))
            dots(axis, top, x + 1.05, y - 2.35, gap, -1.0, largest)
        dots(axis, inputs.ravel(), x + 1.5, y - height + 0.95, 1.8, -1.0, largest)

    def draw(figure: Figure):
        axis = figure.subplots()
        for k in range(outputs):
            blob(axis, k * (_WIDTH + 1.2), 0, tall, weights.output_bias[k],
                 weights.output_weights[k], weights.direct_weights[k])  # fmt: skip
        for k in range(hidden):
            x, y = (k % 2) * (_WIDTH + 1.2), -tall - 0.9 - step * (k // 2)
            blob(axis, x, y, low, weights.hidden_bias[k], weights.output_weights[:, k],
                 weights.hidden_weights[k])  # fmt: skip
        bottom = -tall - 0.9 - step * (rows - 1) - low
        for column in range(2):
            for k, symbol in enumerate(_SYMBOLS):
                x = column * (_WIDTH + 1.2) + 1.5 + 1.8 * k
                axis.text(x, bottom - 0.25, symbol, ha="center", va="top", fontsize=9)
            title = f"output: {JOINTS[column]} torque"
            axis.text(column * (_WIDTH + 1.2), 0.25, title, ha="left", va="bottom", fontsize=9)
        axis.set(xlim=(-0.2, 2 * _WIDTH + 1.4), ylim=(bottom - 1.6, 1.6), aspect="equal")
        axis.axis("off")

    mean = np.abs(weights.hidden_weights).mean(0).ravel()
    sizes = ", ".join(f"{s} {m:.1f}" for s, m in zip(("q1", "v1", "a1", "q2", "v2", "a2"), mean))
    alt = (
        f"Hinton diagram of a network of states: {outputs} output units on top, {hidden} hidden "
        "units below; white squares are positive, black negative weights, the largest has "
        f"magnitude {largest:.1f}. Mean magnitude of the hidden units' weights by input: {sizes}."
    )
    height = (tall + 0.9 + step * rows + 2.6) / (2 * _WIDTH + 1.6)
    return illustrate(draw, alt, 5.6, 5.6 * height)


def _torque_along(t, exact, predicted) -> Illustration:
    """Figure 6-2: the exact torque (fine) and networks' torque (bold) along a trajectory.

    The bold line is the network whose root mean square error, each joint in units of its torque's
    standard deviation, is the median; the shade holds the middle 80 % of all networks at each
    time.
    """
    square = ((predicted - exact) ** 2).mean(1)
    error = (square / exact.var(0)).mean(-1)
    middle = predicted[np.argsort(error)[len(error) // 2]]
    low, high = np.quantile(predicted, [0.1, 0.9], axis=0)

    def draw(figure: Figure):
        axes = figure.subplots(exact.shape[1], 1, sharex=True, squeeze=False)[:, 0]
        for j, axis in enumerate(axes):
            axis.fill_between(t, low[:, j], high[:, j], color=TONES["network"], alpha=0.25, lw=0,
                              label="80 % of the networks")  # fmt: skip
            axis.plot(t, middle[:, j], "--", color=TONES["network"], lw=2.0, label="median network")
            axis.plot(t, exact[:, j], color=INK, lw=0.9, label="analytic model")
            axis.set_ylabel(f"{JOINTS[j]} torque, N m")
        figure.legend(*axes[0].get_legend_handles_labels(), loc="outside upper left", ncols=3)
        axes[-1].set_xlabel("time, s")

    size = np.sqrt(np.median(square, axis=0))
    listed = ", ".join(f"{n} {e:.2f} N m" for n, e in zip(JOINTS, size))
    alt = (
        f"Torque along a trajectory: the analytic model's and that of {len(predicted)} networks. "
        f"Median root mean square error: {listed}."
    )
    return illustrate(draw, alt, 7.0, 1.8 * exact.shape[1] + 0.5)


# --- the lesson


def _errors() -> dict[str, np.ndarray]:
    """Errors of the book's 25 networks on each set, by its own deviation."""
    by_set = results.read("table-6-1")["errors"]
    return {name: np.array(each["own deviation"]) for name, each in by_set.items()}


def _states() -> np.ndarray:
    return states_along(paper.APPENDIX_I_EXTENTS_DEG[paper.TEST_TRAJECTORY - 1])


def on_trajectory() -> Illustration:
    """Torque along trajectory 6, by the equations and by the book's 25 networks."""
    states = _states()
    t = np.arange(len(states)) * 3.0 / len(states)
    return _torque_along(t, torque(states), _networks().torque(states))


def figure_6_1() -> Illustration:
    """The weights of a network whose error on set A is the median."""
    errors = _errors()["random set A"]
    return hinton_states(_networks()[int(np.argsort(errors)[len(errors) // 2])].weights)


def table_6_1(yours) -> Table:
    """Table 6-1 as printed, beside medians and 95 % intervals of 25 networks, and the reader's.

    `yours` are errors on sets A and B, and on trajectory 6 by its own deviation and by set A's.
    """
    a, b, six = paper.TABLE_6_1.values()
    rows = []
    for name, printed, claim, mine in zip(
        ("random set A", "random set B", "trajectory 6, over its own deviation",
         "trajectory 6, over the deviation of A"),
        (a, b, six, six),
        ("a", "b", "trajectory-own", "trajectory"),
        yours,
        strict=True,
    ):  # fmt: skip
        measured = claims.measured(f"table-6-1-{claim}")
        ends = np.quantile(measured.replicates, (0.025, 0.975))
        middle, low, high = (significant(x, 2) for x in (measured.value, *ends))
        ours = f"{middle} ({low} to {high})"
        rows.append((name, significant(printed, 2), ours, significant(mine, 2)))
    return Table(("states", "printed in 1988", "25 networks", "your network"), rows)


def _quoted() -> None:
    """The book's numbers in the lesson's prose."""
    quote("states-largest", claims.measured("figure-6-1").value)
    quote("states-largest-printed", next(c.printed for c in claims.load() if c.id == "figure-6-1"))
    for key, errors in zip(("a", "b", "six"), _errors().values()):
        quote(f"states-book-{key}", float(np.median(errors)))
    quote("states-book-other", claims.measured("table-6-1-trajectory").value)
    quote("states-book-printed", paper.TABLE_6_1["trajectory 6"])
    for key, share in zip(("q2", "v1"), _watched().mean(1)):
        quote(f"states-book-{key}", 100 * share)


def _watched() -> np.ndarray:
    """Share of each network's hidden units that depend on q2 and on v1 most, (2, networks)."""
    shares = input_shares(_networks().weights)
    largest = shares.reshape(*shares.shape[:2], 6).argmax(-1)
    return np.stack([(largest == k).mean(1) for k in (3, 1)])


def _exercise(number: int, *given) -> Exercise:
    """An exercise of the lesson."""
    if number == 1:
        b, d = given[0].b, given[0].d
        shared = (2 * d**2 + b**2 / 2) * np.pi**2 / 3
        right = b**2 * np.pi**4 / 18 / (shared + b**2 * np.pi**4 / 10)
        slips = [
            (0.0, "so it is for the velocity. Average over that, and keep the angle."),
            (right * 1.8, "v₁⁴ has the mean π⁴/5, and (v₁²)'s mean is π²/3."),
        ]
        return Exercise(
            "number", right, "the angle alone is worth something, the velocity nothing.", slips
        )
    elif number == 2:
        turned, before = given
        grown = turned / before
        slips = [
            (Between(1), "does the torque change when you turn the arm?"),
            (Between(5e-324, 1), "why should the error get smaller?"),  # above 0
        ]
        return Exercise(
            "number",
            Between(grown / 2, 2 * grown),
            f"the error grows {grown:.2f} times, though turning the arm changes no torque.",
            slips,
        )
    else:
        error_from, before = given
        error_with = cache(lambda m: error_from(np.array(m)))
        reason = "near zero the torque is almost linear, and the samples lie where they count."
        return Exercise(
            "numbers",
            lambda m: 3 * error_with(m) < before,
            reason,
            [(lambda m: error_with(m) > 0, "the error on the trajectory is not below a third.")],
            "Give three limits.",
            count=3,
            unless=[(lambda m: min(m) <= 0, "the limits must be above 0.")],
        )


check = judging(_exercise)


# --- what the claims of the chapter measure


def _networks() -> TorqueModel:
    return TorqueModel.load(results.FOLDER / "networks-state-space.npz")


def trajectory_shoulder() -> Measured:
    """Error of the shoulder's torque on trajectory 6, by its own deviation: the median."""
    states = _states()
    errors = rmss(_networks().torque(states), torque(states), pooled=False)[:, 0]
    return judged(median, errors, text=f"RMSS {spread(errors)}")


def shoulder_position() -> Measured:
    """Change of the torque when q1 is shuffled over the mean change for the other inputs."""
    states = random_states(2000, seed=77)
    scale = torque(states).std(0)
    changes = shuffled(_networks().torque, states, scale).reshape(6, -1)
    ratio = changes[0] / changes[1:].mean(0)
    text = f"RMSS of the change {spread(changes[0])}, other inputs {spread(changes[1:].mean(0))}"
    return judged(median, ratio, text=text)


def velocity_ranges() -> Measured:
    """Share of hidden units with a transition region within the range of shoulder velocity."""
    along = transition_range(_networks().weights)
    within = {name: along[..., j, k] < 1 for name, j, k in (("v1", 0, 1), ("q2", 1, 0))}
    velocity, elbow = (f"{100 * share.mean():.0f} %" for share in within.values())
    return judged(mean, within["v1"], text=f"{velocity} of the units; of elbow position {elbow}")


def best_of_sizes() -> Measured:
    """Least median error on 5,000 random states over all numbers of hidden units.

    There are three networks of each, too few to draw from: no replicates.
    """
    study = results.read("state-space-sizes")
    rows = {row["units"]: row["solver"]["test"] for row in study["units"] if row["solver"]}
    best = min(rows, key=lambda units: np.median(rows[units]))
    samples = study["solver's samples in units"]
    text = f"RMSS {spread(rows[best])} with {best} units, {samples:,} samples"
    return Measured(float(np.median(rows[best])), text)
