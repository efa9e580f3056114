"""The lesson *Whose filters are they?*: galleries, starts, numbers, words and answers."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache

import numpy as np
from matplotlib.figure import Figure

from ddlib.dynamics import IMI_ARM
from ddlib.figures.style import COLOURS, INK, Illustration, illustrate
from ddlib.learning import TrainingSet, Weights, p_value, surrogates, train_ensemble
from ddlib.setups import INITIAL, JOINT_DAMPING, SETUPS, split, true_states
from ddlib.tables import quote
from ddlib.widgets import GuessRound
from workshop.chapters import start
from workshop.chapters.convolution_filters import _dots
from workshop.chapters.exercises import judge
from workshop.chapters.widgets.starts import UnitFromFiveStarts as UnitFromFiveStarts
from workshop.report import results
from workshop.report._measures import filter_trial as trial
from workshop.report.evidence.statements import resampled, stated
from workshop.report.studies.nulls import TRIAL
from workshop.report.studies.start import RANGES

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
        "This round was not fair: both torques go with the motion's acceleration.",
    ),
}
"""What the other network of each round learnt, and what is said to it after the guess."""


@cache
def training_set() -> TrainingSet:
    """The walk's windows and torques."""
    return TrainingSet.from_recording(split(TRIAL.record())[0], _WIDTH, scaling=TRIAL.scaling)


@cache
def torques(kind: str) -> np.ndarray:
    """Torques along the walk's five training motions, N m, shape (cases, joint).

    The arm's "own", or another kind by its name in `ROUNDS`.
    """
    training = split(TRIAL.record())[0]
    own = training.tau[:, training.motion]
    if kind == "another arm":
        own = IMI_ARM.inverse_dynamics(*np.moveaxis(true_states(training, TRIAL), -1, 0))
    elif kind != "own":
        name, _, again = kind.partition(", ")
        own = surrogates(name, own, 1, seed=7 + bool(again))[0]
    return own.reshape(-1, 2)


def trained(kinds, starts: Weights) -> Weights:
    """One network for each kind of torques, from the start in its place; trained as here."""
    data = training_set()
    targets = np.stack([data.outputs.scale(torques(kind)) for kind in kinds])
    how = {"momentum": TRIAL.momentum, "warm_up": TRIAL.warm_up, "epochs": TRIAL.epochs}
    rate = TRIAL.rate / _WIDTH
    return train_ensemble(starts, data, targets=targets, rate=rate, progress=False, **how)[
        0
    ].weights


def rounds() -> list[GuessRound]:
    """The rounds of the guess: the two networks of a round have the same start."""
    count = len(ROUNDS)
    begin = Weights.random(count, _WIDTH, TRIAL.hidden, initial=INITIAL)
    kinds = ["own"] * count + list(ROUNDS)
    every = trained(kinds, Weights.concatenate([begin, begin])).hidden_weights
    rows = every.reshape(2, count, -1, _WIDTH)
    return [GuessRound(*pair, *told) for *pair, told in zip(*rows, ROUNDS.values())]


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
                _dots(axis, values, k, 0, kind, colour=COLOURS[min(k, 1)])
                axis.plot([np.mean(values)] * 2, [k - 0.3, k + 0.3], color=INK, lw=2)
            axis.grid(visible=False, axis="y")
            axis.set(xlabel=label, ylim=(len(kinds) - 0.5, -0.6))
        if arm is not None:
            axes[-1].axvline(arm, color=INK, ls="--", lw=1.0)
            axes[-1].annotate(" the arm", (arm, -0.55), ha="right", va="top")
        axes[0].set_yticks(range(len(kinds)), [_TORQUES[kind] for kind in kinds])

    told = "; ".join(
        f"{label}: " + ", ".join(f"{_TORQUES[k]} {np.mean(x):.0f}" for k, x in shown.items())
        for label, shown in panels.items()
    )
    alt = f"Means of networks, by the torques that they were trained on. {told}."
    return illustrate(draw, alt, 7.0, 2.3, narrow_height=2.3 * len(panels))


def names_beside() -> Illustration:
    """Shares of velocity and acceleration filters, of the arm's torques and of unrelated ones."""
    row = trial.row(_WIDTH)
    sets = {"real": row["real"], **trial.matched(row)}
    return of_torques({
        f"{name} filters, % of hidden ones": {
            kind: 100 * trial.share(found, "hidden", [name]) for kind, found in sets.items()
        }
        for name in ("acceleration", "velocity")
    })  # fmt: skip


def _named(name: str) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Share of a name in the hidden filters of the trial: the arm's torques, and each null."""
    row = trial.row(_WIDTH)
    nulls = {k: trial.share(x, "hidden", [name]) for k, x in trial.matched(row).items()}
    return trial.share(row["real"], "hidden", [name]), nulls


def _quoted() -> None:
    """Numbers of the lesson."""
    for name in ("velocity", "acceleration"):
        real, nulls = _named(name)
        means = {kind: 100 * each.mean() for kind, each in nulls.items()}
        quote(f"whose-{name}", 100 * real.mean())
        if name == "velocity":
            quote("whose-velocity-least", min(means.values()))
            quote("whose-velocity-most", max(means.values()))
        else:
            quote("whose-acceleration-most", max(means["shifted"], means["phases"]))
            quote("whose-acceleration-run", means["other run"])
    for name, size in (("small", 0.03), ("large", 0.3)):
        quote(f"whose-named-{name}", 100 * start.named(JOINT_DAMPING.name, size).mean())


def _said() -> None:
    """What the lesson says in words about committed results, and of networks trained as in it."""
    real, nulls = _named("velocity")
    stated("whose-velocity-any", resampled(real, np.mean) < min(map(np.mean, nulls.values())))
    real, nulls = _named("acceleration")
    chances = [p_value(real.mean(), nulls[kind], "more") for kind in ("shifted", "phases")]
    apart = real.mean() > max(nulls[kind].max() for kind in ("shifted", "phases"))
    stated("whose-acceleration-more", max(chances) < 0.06 and apart)
    places = [(r, s) for r in SETUPS for s in results.read("start-nulls")["ranges"]]
    means = [
        [start.shares_beside(*place, "velocity")[kind].mean() for place in places]
        for kind in ("real", "shifted", "phases")
    ]
    own, *unrelated = (np.mean(each) for each in means)
    stated("whose-velocity-elsewhere", own < min(unrelated))
    other = start.other_torques()
    stated("whose-other-arm", other["another arm"][0] > other["own"][0] / 2)
    named = [start.named(JOINT_DAMPING.name, size) for size in (0.03, 0.3)]
    more = [resampled(x, np.mean, seed=k) for k, x in enumerate(named)]
    stated("whose-start-hides", more[0] > more[1])
    study = results.read("targets")
    unnamed = {
        size: resampled(found["not analysable"], np.mean)
        for size, found in zip(study["initial"], study["by initial"]["real torques"])
    }
    stated("whose-few-names", (unnamed[0.03] < 0.5) & (unnamed[0.3] > 0.5))
    turn = [start.turned().replicates > 0]
    stated("whose-small-turns", turn[0])


def check(number: int, mine, given) -> None:
    """Judge an answer: `given` the seconds of a motion, or step times variance by direction."""
    if number == 1:
        slips = (
            (given / 2, "half a period turns the torque's sign, and nothing else."),
            (given, "after a whole period it is the old torque again."),
        )
        judge(mine, given / 4, "then the arm's acceleration filter would become a velocity filter.",
              slips, "write the shifted sine as a sum of a sine and a cosine.")  # fmt: skip
    elif number == 2:
        half = np.log(0.5) / np.log1p(-given[4])
        slips = (
            (1 / given[4], "then 37 % are left."),
            (-np.log(0.5) / given[2], "that is velocity."),
        )
        judge(mine, half, "so many steps for acceleration.", slips)
    else:
        slips = ((100, "the arm's network counts as one of the draws, too."),
                 (given, "that is one in twenty."))  # fmt: skip
        judge(mine, 99, "one of a hundred, if the arm's network counts as a draw, too.", slips,
              "count the draws that are as far out, and the arm's own among them.",
              tolerance=1e-6)  # fmt: skip
