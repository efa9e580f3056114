"""What *Use it on your arm* shows and asks."""

from __future__ import annotations

from functools import cache

import numpy as np

from ddlib import figures
from ddlib.analysis import gains, mean_gradient, ridge_filters
from ddlib.control import pd
from ddlib.dynamics import Arm, Link, with_load
from ddlib.effects import CoulombFriction, Effects, Quantisation, ViscousFriction
from ddlib.learning import TrainingSet, Weights, cases, surrogate, train_ensemble
from ddlib.simulation import record
from ddlib.trajectories import random_extents
from workshop.chapters.exercises import Exercise, judging

_ENTRIES = {"shoulder": (0, 0), "coupling": (0, 1), "elbow": (1, 1)}


def four_answers() -> figures.Illustration:
    """Inertia of the page's arm: its own, by least squares, by networks, and by a null."""
    links = Link(4.0, 0.35, 0.16, 0.050), Link(2.5, 0.30, 0.14, 0.025)
    arm = Arm.from_links("my arm", *links)
    friction = (ViscousFriction((0.4, 0.2)), CoulombFriction((0.1, 0.03)))
    effects = Effects(friction=friction, encoder=(Quantisation.encoder(bits=16),))
    controller = pd((60.0, 20.0), (0.0, 0.0))
    log = record(arm, controller, random_extents(6, seed=1), effects=effects)[:5]
    windows = cases(log, 21)[0]
    real = TrainingSet.from_recording(log, 21, scaling=(-1, 1))
    shifted_torque = surrogate("shifted", log.tau[:, log.motion], seed=0).reshape(-1, 2)
    shifted = TrainingSet.from_arrays(windows, shifted_torque, scaling=(-1, 1))
    start = Weights.random(members=3, width=21, hidden=10)
    how = {"momentum": 0.98, "warm_up": 500, "epochs": 3000, "progress": False}

    def in_networks(data):
        model = train_ensemble(start, data, **how)[0]
        return gains(mean_gradient(model, windows), log.step)[..., 2]

    return _drawn(
        {
            "the arm": arm.mass_matrix(log.q_true[:, log.motion]).mean((0, 1))[None],
            "least squares": gains(ridge_filters(real, [0.0]), log.step)[..., 2],
            "networks": in_networks(real),
            "networks, torques shifted": in_networks(shifted),
        }
    )


def _drawn(answers) -> figures.Illustration:
    def draw(figure):
        axis = figure.subplots()
        handles = []
        for k, (name, values) in enumerate(answers.items()):
            y = np.stack([values[:, i, j] for i, j in _ENTRIES.values()])
            x = np.broadcast_to(np.arange(3)[:, None] + 0.16 * (k - 1.5), y.shape)
            look = {"color": figures.looks(answers)[name].colour, "marker": "_os^"[k], "ls": ""}
            size = {"ms": 16, "mew": 3} if name == "the arm" else {"ms": 7}
            axis.plot(x.ravel(), y.ravel(), **look, **size)
            handles += axis.plot([], [], **look, ms=8, mew=2)
        axis.axhline(0, color=figures.FAINT, lw=0.7)
        axis.set_xticks(range(3), _ENTRIES)
        axis.set(ylabel="inertia, kg m²", xlim=(-0.5, 2.5))
        figures.legend_above(figure, handles, list(answers))

    medians = "; ".join(
        f"{name}: "
        + ", ".join(f"{e} {np.median(v[:, i, j]):.2f}" for e, (i, j) in _ENTRIES.items())
        for name, v in answers.items()
    )
    alt = f"Inertia of an arm in kg m². {medians}.".replace("-", "−")
    return figures.illustrate(draw, alt, 7.0, 2.7)


# --- what is judged


def _exercise(number: int, given=None) -> Exercise:
    """An exercise; `given` is the second's arm, or what drives the third's."""
    if number == 1:
        return Exercise(
            "number",
            1e6,
            "s is squared, so its factor counts twice.",
            [
                (1e3, "this is the factor of the damping. Which power of s has M?"),
                (1e-6, "you read times that are too long, so M is too large."),
            ],
            "write s in milliseconds, and take the factor out of the sum.",
        )
    if number == 2:
        if given is None:  # a file's
            unless = [(lambda mine: True, "set known in Change this.")]
            return Exercise("number", np.nan, "", unless=unless)
        reach = sum(given.lengths)
        stretched = np.zeros(2)
        loaded, bare = (a.mass_matrix(stretched)[0, 0] for a in (with_load(given, 0.5), given))
        return Exercise(
            "number",
            loaded - bare,
            "the load adds its mass times its distance squared.",
            [
                (0.5 * reach, "this is mass times distance. Which unit does it have?"),
                (loaded, "this is all of the inertia. Count the load alone, not the arm."),
                (0.5 * given.lengths[0] ** 2, "the hand is farther from the shoulder."),
            ],
            "how far is the hand from the shoulder?",
            unit="kg m²",
        )

    @cache
    def reached(shake):
        shares, most = given(*shake)
        return min(shares), most

    return Exercise(
        "numbers",
        lambda shake: reached(shake)[0] > 95 and reached(shake)[1] < 6,
        "the acceleration of a sine grows with the square of its frequency.",
        [
            (
                lambda shake: reached(shake)[0] <= 95,
                "training keeps too little. What makes the acceleration of a sine larger?",
            ),
        ],
        "a torque is too large. What does a fast, large sine ask of the motors?",
        count=2,
        unless=[(lambda shake: min(shake) <= 0, "give a positive size and frequency.")],
    )


check = judging(_exercise)
