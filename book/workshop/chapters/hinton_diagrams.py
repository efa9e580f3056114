"""What the chapter *Hinton diagrams* shows, says and judges, and what a claim of it measures."""

from __future__ import annotations

from dataclasses import replace
from math import factorial

import numpy as np
from matplotlib.patches import Rectangle

from ddlib import figures
from ddlib.analysis import roughness, savitzky_golay
from ddlib.figures.weights import dots
from ddlib.learning import TrainingSet, Weights, cases, surrogate, train_ensemble
from ddlib.setups import JOINT_DAMPING, STATE_FEEDBACK
from ddlib.simulation import LOG_STEP
from ddlib.tables import scientific
from workshop.chapters.exercises import judge
from workshop.report import committed
from workshop.report.evidence.statements import resampled, stated
from workshop.report.evidence.verdicts import Measured


def _trained(members: int, shifted: bool = False) -> tuple[Weights, Weights]:
    """Random starts, and what training as in the lesson makes of them."""
    runs = JOINT_DAMPING.record()[:5]
    torque = runs.tau[:, runs.motion]
    torque = (surrogate("shifted", torque) if shifted else torque).reshape(-1, 2)
    data = TrainingSet.from_arrays(cases(runs, 21)[0], torque, scaling=(-1, 1))
    how = {"momentum": 0.98, "warm_up": 500, "epochs": 2000, "progress": False}
    start = Weights.random(members, 21)
    return start, train_ensemble(start, data, **how)[0].weights


def diagram() -> figures.Illustration:
    """Rows of the lesson's network for the shoulder's window: start, what was added, their sum."""
    pair = _trained(1)
    start, end = (np.concatenate([w.direct_weights[0], w.hidden_weights[0]])[:, 0] for w in pair)
    parts = {"random start": start, "added by training": end - start, "trained": end}
    largest = np.max([*map(np.abs, parts.values())], axis=(0, 2))[:, None]

    def draw(figure):
        for axis, (title, rows) in zip(figure.subplots(1, 3), parts.items()):
            axis.add_patch(Rectangle((-0.7, -0.7), 21.4, 12.4, facecolor="#8c8c8c"))
            dots(axis, rows / largest, 0, 0, 1, 1, 1)
            axis.set(title=title, xlim=(-0.7, 20.7), ylim=(11.7, -0.7), aspect="equal")
            axis.axis("off")

    alt = "Rows of squares in three columns: without order, smooth, and the sum of both."
    return figures.illustrate(draw, alt, 7.0, 1.8)


def _said() -> None:
    """What the lesson says of smooth and rough parts, in eight networks."""
    smooth, like = [], []
    for shifted in (False, True):
        start, trained = _trained(8, shifted)
        rows = [np.concatenate([w.direct_weights, w.hidden_weights], 1) for w in (start, trained)]
        smooth.append(resampled(np.median(roughness(rows[1] - rows[0]), (1, 2))) < 0.05)
        second = [np.diff(x, 2).reshape(8, -1) for x in rows]
        like.append(resampled([np.corrcoef(*pair)[0, 1] for pair in zip(*second)]) > 0.9)
    stated("hinton-added-smooth", np.all(smooth, 0))
    stated("hinton-rough-start", np.all(like, 0))


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
        early = lambda mine: mine < tenth, "too early. When does momentum go up?"
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
