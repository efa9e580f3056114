"""The lesson *Whose filters are they?*: galleries, starts, numbers, words and answers."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache

import numpy as np
from matplotlib.figure import Figure

from ddlib.analysis import CLASSES
from ddlib.dynamics import IMI_ARM
from ddlib.figures.style import FAINT, INK, Illustration, illustrate
from ddlib.learning import (
    MATCHED,
    TrainingSet,
    Weights,
    cases,
    surrogate,
    train_ensemble,
)
from ddlib.setups import INITIAL, JOINT_DAMPING, split, true_states
from ddlib.tables import quote
from workshop.chapters import planted, start
from workshop.chapters.convolution_filters import _dots, named_in_trial
from workshop.chapters.exercises import Exercise, judging
from workshop.chapters.widgets.starts import UnitFromFiveStarts as UnitFromFiveStarts
from workshop.chapters.widgets.whose import GuessRound, WhoseFilters as WhoseFilters
from workshop.report import results
from workshop.report.measures import filter_trial as trial
from workshop.report.studies.nulls import TRIAL
from workshop.report.studies.random_starts import RANGES

_WIDTH = 21

ROUNDS = {
    "shifted": ("learnt them shifted in time", "Shifted torques belong to other moments."),
    "phases": (
        "learnt torques with the same spectrum",
        "Each of their frequencies began at a random moment.",
    ),
    "shifted, again": ("learnt them shifted in time", "This shift was another one."),
    "another arm": (
        "learnt what another arm would need for the same motion",
        "This round was not fair: both torques go with the motion, and so do both shapes.",
    ),
    "position": (
        "learnt a spring's torques, of position alone",
        "Their random start is subtracted here. No arm and no acceleration is in them, and yet the "
        "shapes are the same.",
    ),
}
"""What the other network of each round learnt, and what is said to it after the guess."""


def typical(row: Mapping) -> np.ndarray:
    """Numbers of the trial's networks, or draws, from the most typical one on.

    Typical: in its shares of the rule's names it is next to their medians over all of them.
    """
    shares = np.stack([trial.share(row, "hidden", [name]) for name in CLASSES], -1)
    away = np.abs(shares - np.median(shares, 0)).sum(-1)
    return np.argsort(away.round(9), kind="stable")


@cache
def torques(kind: str) -> np.ndarray:
    """Torques along the walk's five training motions, N m, shape (cases, joint).

    The arm's "own", or another kind by its name in `ROUNDS`: of unrelated ones the most typical
    draw of the trial, and `again` the next one. A spring's go with "position", and a damper's with
    "velocity"; both have the size of the arm's.
    """
    training = split(TRIAL.record())[0]
    own = training.tau[:, training.motion]
    q, qd, qdd = np.moveaxis(true_states(training, TRIAL), -1, 0)
    size = own.std((0, 1))
    if kind == "another arm":
        own = IMI_ARM.inverse_dynamics(q, qd, qdd)
    elif kind == "position":
        own = size / q.std((0, 1)) * q
    elif kind == "velocity":
        own = size / qd.std((0, 1)) * qd
    elif kind != "own":
        name, _, again = kind.partition(", ")
        draw = typical(trial.row(_WIDTH)["nulls"][name])[int(bool(again))]
        own = surrogate(name, own, int(draw) + 100 * MATCHED.index(name))  # as in the study
    return own.reshape(-1, 2)


@cache
def given(kind: str) -> TrainingSet:
    """The walk's windows with torques of a kind, each kind scaled by its own range."""
    windows, _ = cases(split(TRIAL.record())[0], _WIDTH)
    return TrainingSet.from_arrays(windows, torques(kind), scaling=TRIAL.scaling)


def trained(kinds, starts: Weights) -> Weights:
    """One network for each kind of torques, from the start in its place; trained as here."""
    targets = np.stack([given(kind).y for kind in kinds])
    how = {"momentum": TRIAL.momentum, "warm_up": TRIAL.warm_up, "epochs": TRIAL.epochs}
    rate = TRIAL.rate / _WIDTH
    return train_ensemble(starts, given("own"), targets=targets, rate=rate, progress=False, **how)[
        0
    ].weights


def typical_starts(count: int) -> Weights:
    """Random starts whose networks of the arm's torques are the most typical of the trial."""
    seeds = typical(trial.row(_WIDTH)["real"])[:count]
    start = [Weights.random(1, _WIDTH, TRIAL.hidden, initial=INITIAL, seed=int(k)) for k in seeds]
    return Weights.concatenate(start)


def rounds() -> list[GuessRound]:
    """The rounds of the guess: the two networks of a round have the same start."""
    number = len(ROUNDS)
    begin = typical_starts(number)
    kinds = ["own"] * number + list(ROUNDS)
    every = trained(kinds, Weights.concatenate([begin, begin])).hidden_weights
    rows = every.reshape(2, number, -1, _WIDTH)
    rows[:, -1] -= begin.hidden_weights.reshape(number, -1, _WIDTH)[-1]  # a spring's are small
    return [GuessRound(*pair, *names) for *pair, names in zip(*rows, ROUNDS.values())]


def five_starts(seed: int = 0) -> dict[float, tuple[Weights, Weights]]:
    """One network of the arm's torques from starts of five sizes: before training, and after."""
    begin = [Weights.random(1, _WIDTH, TRIAL.hidden, initial=size, seed=seed) for size in RANGES]
    after = trained(["own"] * len(RANGES), Weights.concatenate(begin))
    return {size: (one[0], after[k]) for k, (size, one) in enumerate(zip(RANGES, begin))}


_TORQUES = {
    "real": "the arm's own", "shifted": "shifted in time", "other run": "another run's",
    "phases": "random phases",
}  # fmt: skip


def of_torques(panels: Mapping[str, Mapping[str, np.ndarray]], arm: float | None = None):
    """Values of networks by the torques they learnt, a panel for each quantity; `arm`: a line."""
    kinds = list(next(iter(panels.values())))

    def draw(figure: Figure):
        axes = figure.subplots(1, len(panels), sharey=True, squeeze=False)[0]
        for axis, (label, shown) in zip(axes, panels.items()):
            for k, (kind, values) in enumerate(shown.items()):
                _dots(axis, values, k, 0, kind, INK if k == 0 else FAINT)
                axis.plot([np.mean(values)] * 2, [k - 0.3, k + 0.3], color=INK, lw=2)
            axis.grid(visible=False, axis="y")
            axis.set(xlabel=label, ylim=(len(kinds) - 0.5, -0.6))
        if arm is not None:
            axes[-1].axvline(arm, color=INK, ls="--", lw=1.0)
            axes[-1].annotate(
                "the arm", (arm, -0.55), (-7, 0), textcoords="offset points", ha="right", va="top"
            )
        axes[0].set_yticks(range(len(kinds)), [_TORQUES[kind] for kind in kinds])

    means = "; ".join(
        f"{label}: " + ", ".join(f"{_TORQUES[k]} {np.mean(x):.0f}" for k, x in shown.items())
        for label, shown in panels.items()
    )
    alt = f"Means of networks, by the torques that they were trained on. {means}."
    return illustrate(draw, alt, 7.0, 2.3, narrow_height=2.3 * len(panels))


def names_beside() -> Illustration:
    """Shares of velocity and acceleration filters, of the arm's torques and of unrelated ones."""
    row = trial.row(_WIDTH)
    sets = {"real": row["real"], **trial.matched(row)}
    return of_torques({
        f"{name} filters, % of hidden ones": {
            kind: 100 * trial.share(cell, "hidden", [name]) for kind, cell in sets.items()
        }
        for name in ("acceleration", "velocity")
    })  # fmt: skip


def _quoted() -> None:
    """Numbers of the lesson."""
    for name in ("velocity", "acceleration"):
        real, nulls = named_in_trial(name)
        means = {kind: 100 * each.mean() for kind, each in nulls.items()}
        quote(f"whose-{name}", 100 * real.mean())
        if name == "velocity":
            quote("whose-velocity-least", min(means.values()))
            quote("whose-velocity-most", max(means.values()))
        else:
            quote("whose-acceleration-most", max(means["shifted"], means["phases"]))
            quote("whose-acceleration-run", means["other run"])
    study = results.read("filter-trial")
    quote("whose-networks", study["members"])
    quote("whose-draws", study["draws"])
    for name, size in (("small", 0.03), ("large", 0.3)):
        quote(f"whose-named-{name}", 100 * start.named(JOINT_DAMPING.name, size).mean())
    for name, kind in (("arm", "the arm"), ("position", "position alone")):
        quote(f"whose-added-{name}", planted.acceleration(kind))


def _exercise(number: int, given, *others) -> Exercise:
    """An exercise: `given` the seconds of a motion, a number of draws, or six filters."""
    if number == 1:
        slips = (
            (given, "a shift of half a period only changes the torque's sign."),
            (2 * given, "a shift of a whole period gives the old torque again."),
            (given / 4, "out and back is only half a period of the sine."),
        )
        return Exercise(
            "number",
            given / 2,
            "then the arm's acceleration filter would become a velocity filter.",
            slips,
            "write the shifted sine as a sum of a sine and a cosine.",
            unit="s",
        )
    elif number == 3:
        X, real = others
        torque = real[..., 0].ravel() - real[..., 0].mean()
        answers = np.asarray(given) @ X.T
        off = np.sqrt(((answers - torque) ** 2).mean(1)) / torque.std()
        along = answers @ torque
        best, second, *_ = np.argsort(off)

        def why(k):
            if along[k] < 0:
                return "its torques go down where the arm's go up, whatever its shape."
            return "this filter misses by as much, but another one misses by less."

        slips = [(off[k], why(k)) for k in range(len(off)) if k != best]
        slips.append((off[best] * torque.std(), "divide by the torque's standard deviation."))
        return Exercise(
            "number",
            off[best],
            f"filter {1 + best} is the arm's; filter {1 + second} comes next, {off[second]:.2f}.",
            slips,
            "what do the torques of each filter leave of the arm's?",
            tolerance=2e-3,
        )
    else:
        slips = (
            (100, "count the arm's own network among them, too."),
            (given, "this gives one in twenty."),
        )
        return Exercise(
            "number",
            99,
            "with the arm's own network there are a hundred, and it is one.",
            slips,
            "how many are as far out as the arm's network, itself included?",
            tolerance=1e-6,
        )


check = judging(_exercise)
