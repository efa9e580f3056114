"""What the chapter *Hinton diagrams* shows, says and judges, and what a claim of it measures."""

from __future__ import annotations

from dataclasses import replace
from math import factorial

import numpy as np
from matplotlib.patches import Rectangle

from ddlib import figures
from ddlib.analysis import classify, roughness, savitzky_golay
from ddlib.figures.weights import dots
from ddlib.learning import INITIAL, TrainingSet, Weights, cases, surrogate, train_ensemble
from ddlib.setups import JOINT_DAMPING, STATE_FEEDBACK
from ddlib.simulation import LOG_STEP
from ddlib.tables import scientific
from workshop.chapters.exercises import judge
from workshop.report import committed
from workshop.report.evidence.statements import resampled, stated
from workshop.report.evidence.verdicts import Measured


def _trained(members: int, initial: float, shifted: bool = False) -> tuple[Weights, Weights]:
    """Random starts of a size, and what training as in the lesson makes of them."""
    runs = JOINT_DAMPING.record()[:5]
    torque = runs.tau[:, runs.motion]
    torque = (surrogate("shifted", torque) if shifted else torque).reshape(-1, 2)
    data = TrainingSet.from_arrays(cases(runs, 21)[0], torque)
    how = {"momentum": 0.98, "warm_up": 500, "epochs": 4000, "progress": False}
    start = Weights.random(members, 21, initial=initial)
    return start, train_ensemble(start, data, **how)[0].weights


def _rows(weights: Weights) -> np.ndarray:
    """All rows of networks, those of the outputs first: (network, unit, joint, sample)."""
    return np.concatenate([weights.direct_weights, weights.hidden_weights], 1)


def diagram() -> figures.Illustration:
    """Rows for the shoulder's window, from a small and a large start: start, added, their sum."""
    sizes, parts = (INITIAL, 10 * INITIAL), []
    for initial in sizes:
        start, end = (_rows(weights)[0, :, 0] for weights in _trained(1, initial))
        parts.append((start, end - start, end))

    def draw(figure):
        for line, initial, three in zip(figure.subplots(2, 3), sizes, parts):
            largest = np.abs(three).max((0, 2))[:, None]
            titles = f"random start, ±{initial:g}", "added by training", "trained"
            for axis, title, rows in zip(line, titles, three):
                axis.add_patch(Rectangle((-0.7, -0.7), 21.4, 12.4, facecolor="#8c8c8c"))
                dots(axis, rows / largest, 0, 0, 1, 1, 1)
                axis.set(title=title, xlim=(-0.7, 20.7), ylim=(11.7, -0.7), aspect="equal")
                axis.axis("off")

    alt = (
        "Rows of squares in three columns: without order, smooth, and the sum of both. In the "
        "first line most of the start is too small to see; in the second its dots stand on the sum."
    )
    return figures.illustrate(draw, alt, 7.0, 3.5)


def _said() -> None:
    """What the lesson says of smooth and rough parts, in eight networks of each start."""
    smooth, like, named = [], [], {}
    for initial in (INITIAL, 10 * INITIAL):
        for shifted in (False, True):
            pair = _trained(8, initial, shifted)
            before, after = map(_rows, pair)
            smooth.append(resampled(np.median(roughness(after - before), (1, 2))) < 0.05)
            if not shifted:
                share = (classify(pair[1].hidden_weights) != "not analysable").mean((1, 2))
                named[initial] = resampled(share, np.mean)
            if initial > INITIAL:
                second = [np.diff(x, 2).reshape(8, -1) for x in (before, after)]
                like.append(resampled([np.corrcoef(*x)[0, 1] for x in zip(*second)]) > 0.9)
    stated("hinton-added-smooth", np.all(smooth, 0))
    stated("hinton-rough-start", np.all(like, 0))
    small, large = named.values()
    stated("hinton-small-shows", (small > 0.5) & (large < 0.5))


def check(number: int, mine, given) -> None:
    """Judge an answer, `given` the hidden units, the window or the kept weights."""
    if number == 1:
        orders, turns = factorial(given), 2**given
        slips = (orders, "each unit can also be turned."), (turns, "units also change places.")
        judge(mine, orders * turns, "all orders, and each unit either way round.", slips)
    elif number == 2:
        s = LOG_STEP * (np.arange(given) - given // 2)
        most = 2 / 3 * np.abs(savitzky_golay(given, 2, LOG_STEP, degree=2)).max()

        def moments(f, wanted=(0, 0, 1)):
            return np.allclose([np.sum(f), f @ s, f @ s**2 / 2], wanted, atol=1e-6 * most)

        slips = (
            (lambda f: np.shape(f) != s.shape, f"it must have {given} weights."),
            (lambda f: not moments(f), "take its sum with 1, s and s²/2: 0, 0 and 1 are wanted."),
        )

        def fits(f):
            return moments(f) and max(abs(f)) <= most

        judge(mine, fits, "in blocks weights are smallest.", slips, "a weight is too large.")
    else:
        rough = {e: np.median(roughness(w.direct_weights)) for e, w in sorted(given.items())}
        tenth = next((e for e, value in rough.items() if value < 0.1 * rough[0]), np.inf)
        early = lambda mine: mine < tenth, "too early. How large is the start?"
        told = f"here it is epoch {tenth:,}."
        judge(mine, lambda mine: tenth <= 2 * mine <= 4 * tenth, told, [early], "too late.")


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
