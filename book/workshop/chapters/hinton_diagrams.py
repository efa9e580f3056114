"""What the chapter *Hinton diagrams* shows, says and judges, and what a claim of it measures."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from math import factorial

import numpy as np
from matplotlib.gridspec import GridSpec, GridSpecFromSubplotSpec
from scipy.optimize import linprog

from ddlib import figures, paper
from ddlib.analysis import mean_gradient, roughness
from ddlib.figures.weights import hinton_on
from ddlib.learning import INITIAL, TrainingSet, Weights, cases, train_ensemble
from ddlib.setups import JOINT_DAMPING, SETUPS, STATE_FEEDBACK, WINDOWS, split
from ddlib.simulation import LOG_STEP
from ddlib.tables import Table, quote, scientific, significant
from workshop.chapters.exercises import Between, Exercise, judging
from workshop.chapters.index import both
from workshop.chapters.start import named
from workshop.report import committed, results
from workshop.report.evidence.verdicts import Measured

NOTE = (
    "Press a row, or use the arrow keys in the diagram. Each grey bar is a unit: the two torques "
    "on top, the hidden units below. Its upper row weighs the shoulder's angles, its lower row "
    "the elbow's; time runs to the right."
)
"""What the widget on top of the lesson says of itself."""


def before_and_after() -> tuple[Weights, Weights]:
    """The network that the lesson trains with *Change this* as it is: its start, and trained."""
    data = TrainingSet.from_recording(JOINT_DAMPING.record()[:5], 21)
    how = {"momentum": 0.98, "warm_up": 500, "epochs": 4000, "progress": False}
    start = Weights.random(1, 21, initial=INITIAL)
    return start[0], train_ensemble(start, data, **how)[0].weights[0]


def printed_windows() -> figures.Illustration:
    """Figures 5-1 to 5-3: networks of windows 11, 21 and 41, with the largest weights."""
    networks = {w: results.median_network(w, JOINT_DAMPING.name).weights for w in WINDOWS}
    unit, joint = both(networks[21])  # the landing page's row
    rings = {21: (2 + unit, joint)}

    def draw(figure):
        lines = GridSpec(2, 1, figure)
        above = GridSpecFromSubplotSpec(1, 2, lines[0], width_ratios=(14, 24))
        places = dict(zip(WINDOWS, (above[0], above[1], lines[1])))
        for k, (width, place) in enumerate(places.items()):
            axis = figure.add_subplot(place)
            hinton_on(axis, networks[width], ring=rings.get(width))
            sizes = paper.LARGEST_WEIGHT[width], networks[width].largest
            largest = "largest printed {:g}, ours {:.1f}".format(*sizes)
            axis.set_title(f"Figure 5-{k + 1}, window {width}:\n{largest}")

    alt = (
        "Three Hinton diagrams, of windows of 11, 21 and 41 samples. At 21 one row of a hidden "
        "unit has a frame. In rows of the two torques a single square at the centre stands out."
    )
    return figures.illustrate(draw, alt, 7.0, 8.6)


def largest_weights() -> Table:
    """Largest weights, printed and ours: medians of 25 networks for each reading."""
    cells = results.read("table-4-1")["setups"]
    ours = {
        name: {w: np.median(cells[name][str(w)]["largest weight"]) for w in WINDOWS}
        for name in SETUPS
    }
    rows = [
        (w, f"{paper.LARGEST_WEIGHT[w]:g}", *(significant(sizes[w]) for sizes in ours.values()))
        for w in WINDOWS
    ]
    off = {
        s: max(np.exp(abs(np.log(sizes[w] / paper.LARGEST_WEIGHT[w]))) for w in WINDOWS)
        for s, sizes in ours.items()
    }
    last = "worst of the three, off by a factor of"
    rows.append((last, "", *(significant(x, 2) for x in off.values())))
    return Table(("window, samples", "printed", *ours), rows)


@cache
def _gradients(width: int = 41) -> np.ndarray:
    """How each joint's torque follows the samples of its own window, over all paths, N m/rad.

    Of each network of the damped arm, ``(network, joint, sample)``; in the mean over the windows
    of the training runs.
    """
    windows = cases(split(JOINT_DAMPING.record())[0], width)[0][::20]
    whole = mean_gradient(results.networks(width, JOINT_DAMPING.name), windows)
    return np.stack([whole[:, joint, joint] for joint in range(2)], 1)


def _dots() -> np.ndarray:
    """How far the centre is from its neighbours in `_gradients`, ``(network, joint)``."""
    at = _gradients()
    centre = at.shape[-1] // 2
    return at[..., centre] - (at[..., centre - 1] + at[..., centre + 1]) / 2


def notch() -> figures.Illustration:
    """The sum over all paths from each sample, with its notch at the centre."""
    time = 1000 * LOG_STEP * (np.arange(41) - 20)

    def draw(figure):
        axes = figure.subplots(1, 2)
        for joint, axis in enumerate(axes):
            tone = figures.TONES[figures.JOINTS[joint]]
            for gradient in _gradients()[:, joint]:
                axis.plot(time, gradient, color=tone, lw=0.6, alpha=0.5)
            median = np.median(_gradients()[:, joint], 0)
            axis.plot(time[19:22], median[19:22], "o-", color=figures.INK, ms=5, lw=1.5)
            axis.set(title=figures.JOINTS[joint], xlabel="time from the window's centre, ms")
        axes[0].set_ylabel("N m/rad")

    alt = "Smooth curves that all have one sharp notch downwards, at the centre of the window."
    return figures.illustrate(draw, alt, 7.0, 2.6, narrow_height=5.0)


def _quoted() -> None:
    """Numbers of the lesson's prose."""
    for joint, dot, gain in zip(figures.JOINTS, _dots().T, JOINT_DAMPING.controller.kp):
        quote(f"hinton-dot-{joint}", -np.median(dot))
        quote(f"hinton-gain-{joint}", gain)
    for name, size in (("small", INITIAL), ("large", 10 * INITIAL)):
        quote(f"hinton-named-{name}", 100 * named(JOINT_DAMPING.name, size).mean())
    days = results.read("recordings")["setups"][JOINT_DAMPING.name]
    found = [np.array(days[str(w)]["largest weight"]) for w in WINDOWS]
    quote("hinton-days", len(found[0]))
    *others, last = (significant(np.median(sizes)) for sizes in found)
    quote("hinton-over-days", f"{', '.join(others)} and {last}")


def _exercise(number: int, given) -> Exercise:
    """An exercise, `given` the hidden units, the window or the kept weights."""
    if number == 1:
        orders, turns = factorial(given), 2**given
        slips = (
            (orders, "each unit can also change its sign."),
            (turns, "units can also change places."),
        )
        return Exercise(
            "number",
            orders * turns,
            "all orders of the units, times both signs of each, give the same network.",
            slips,
        )
    elif number == 2:
        s = LOG_STEP * (np.arange(given) - given // 2)
        most = 7 / 6 * _least_weight(s)

        def moments(f, wanted=(0, 0, 1)):
            return np.allclose([np.sum(f), f @ s, f @ s**2 / 2], wanted, atol=1e-6 * most)

        slips = ((lambda f: not moments(f), "its sums with 1, s and s²/2 must be 0, 0 and 1."),)

        def fits(f):
            return moments(f) and max(abs(f)) <= most

        return Exercise(
            "array",
            fits,
            "blocks of equal weights measure it, and all weights stay small.",
            slips,
            "a weight is too large. How small could all be, if they had one size?",
            count=given,
        )
    elif number == 4:
        begun, stepped = (
            np.concatenate([w.direct_weights, w.hidden_weights]) for w in (given[0][0], given[1][0])
        )
        rough = roughness(np.array([stepped, stepped - begun]))  # what, row, joint
        picture, made = np.median(rough[:, 2:], (1, 2))
        slips = (
            (np.median(rough, (1, 2)), "leave out the two rows of the outputs."),
            ((made, picture), "the other way round: rows as they stand first."),
            (
                (picture, picture),
                "subtract the start, kept[0][0], from the weights after the step.",
            ),
        )
        return Exercise(
            "numbers",
            (picture, made),
            "training writes smooth rows at once, long before the picture shows them.",
            slips,
            "take roughness() of the hidden rows, and of what is added to kept[0].",
        )
    else:
        rough = {e: np.median(roughness(w.direct_weights)) for e, w in sorted(given.items())}
        tenth = next((e for e, value in rough.items() if value < 0.1 * rough[0]), np.inf)
        early = Between(-np.inf, tenth), "this is too early. How large is the start?"
        reason = f"in your network it happened by epoch {tenth:,}."
        return Exercise(
            "number",
            Between(tenth / 2, 2 * tenth),
            reason,
            [early],
            "this is too late.",
            unit="epochs",
        )


check = judging(_exercise)


def _least_weight(s) -> float:
    """The largest weight of the filter of an acceleration whose largest weight is least."""
    unit = s / s.max()  # numbers of one size for the linear programme
    sums = np.stack([0 * unit + 1, unit, unit**2 / 2])
    both = np.concatenate([np.eye(s.size), -np.eye(s.size)])
    optimum = linprog(
        np.append(np.zeros(s.size), 1.0),
        A_ub=np.column_stack([both, -np.ones(2 * s.size)]),
        b_ub=np.zeros(2 * s.size),
        A_eq=np.column_stack([sums, np.zeros(3)]),
        b_eq=[0, 0, 1],
        bounds=[*[(None, None)] * s.size, (0, None)],
    )
    return optimum.x[-1] / s.max() ** 2


def adjacency(width: int = 11, epochs: int = 100) -> Measured:
    """Change of trained weights, over the largest, when all windows' samples are shuffled alike."""
    data = TrainingSet.from_recording(committed.training(), width)
    order = np.random.default_rng(0).permutation(width)
    start = Weights.random(1, width, initial=STATE_FEEDBACK.initial)

    def trained(places):
        weights = replace(start, **{name: getattr(start, name)[..., places] for name in along})
        mixed = replace(data, x=data.x[..., places])
        return train_ensemble(weights, mixed, momentum=0.9, epochs=epochs, progress=False)[
            0
        ].weights

    along = ("hidden_weights", "direct_weights")
    plain, mixed, back = trained(np.arange(width)), trained(order), np.argsort(order)
    gaps = (np.abs(getattr(mixed, n)[..., back] - getattr(plain, n)).max() for n in along)
    relative = float(max(gaps) / plain.largest.max())
    return Measured(relative, f"the weights differ by {scientific(relative)} after {epochs} epochs")
