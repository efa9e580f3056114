"""Learners in the loop, seed by seed: the study ``learning-in-the-loop``."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ddlib.dynamics import PUMA_560, count, newton_euler
from ddlib.tables import significant, spread
from workshop.report import results
from workshop.report.evidence.verdicts import Measured, judged, mean, median

PLAIN = "no feedforward"
"""The feedback alone, as the study calls it."""

DIFFERENT = ("two harmonics", "circle")
"""Motions that are quite different from the one that was practised."""


def part(name: str, setup: str = "joint damping") -> dict:
    """A part of the study.

    Parameters
    ----------
    name : {"motion", "family", "rates"}
    setup : str
        Name of a reading of section 4.

    Raises
    ------
    ValueError
        If there is no such part.
    """
    setups = results.read("learning-in-the-loop")["setups"]
    if setup not in setups or name not in setups[setup]:
        raise ValueError(f"name and setup must be of the study, got {name!r}, {setup!r}")
    return setups[setup][name]


def on(
    motion: str, learner: str, setup: str = "joint damping", learning: bool = False
) -> np.ndarray:
    """End-point errors on a motion after practice of another one, shape (seeds,), mm.

    Parameters
    ----------
    motion : str
        As the study names it.
    learner : str
        As the study names it, `PLAIN` or "exact equations".
    setup : str
        As in `part`.
    learning : bool
        Whether it goes on learning during this one trial.
    """
    found = part("motion", setup)["tests"][motion]
    if learner not in found:
        found = found["learning" if learning else "frozen"]
    return np.array(found[learner])


def _over(mine, others, what: str = "mm") -> Measured:
    """The median of a ratio, with both errors in the text."""
    text = f"{spread(mine)} {what} against {spread(others)}"
    return judged(median, mine / others, text=lambda value: f"{significant(value, 2)}: {text}")


def elsewhere(
    learner: str, motions: Sequence[str], setup: str = "joint damping", learning: bool = False
) -> Measured:
    """Error of a learner on motions, over that of the feedback alone: the median over seeds.

    Parameters
    ----------
    learner, setup, learning
        As in `on`.
    motions : sequence of str
        Their errors are averaged, seed by seed.
    """
    mine = np.mean([on(m, learner, setup, learning) for m in motions], axis=0)
    return _over(mine, np.mean([on(m, PLAIN, setup) for m in motions], axis=0))


def forgotten(learner: str, setup: str = "joint damping") -> Measured:
    """Error on the motion learnt first after another one was practised, over that before.

    Parameters
    ----------
    learner, setup
        As in `on`.
    """
    after = np.array(part("motion", setup)["forgetting"][learner])[-1]
    return _over(after, on("the same", learner, setup))


def family(learner: str, when: str, setup: str = "joint damping") -> np.ndarray:
    """End-point errors on the family's test motions, shape (seeds,), mm.

    Parameters
    ----------
    learner : str
        As the study names it.
    when : {"before the load", "with the load", "at the end", "without the load again"}
        The second is the first trial with it, before anything was learnt of it.
    setup : str
        As in `part`.
    """
    found, trials = part("family", setup), results.read("learning-in-the-loop")["trials"]
    if when in ("at the end", "without the load again"):
        return np.array(found[when][learner])
    return np.array(found["tests"][learner])[trials if when == "with the load" else trials - 1]


def ratio(learner: str, when: str, against: str = PLAIN, setup: str = "joint damping") -> Measured:
    """Error of one learner over that of another on the family's tests, the median over seeds.

    Parameters
    ----------
    learner, when, setup
        As in `family`.
    against : str
        The other one.
    """
    return _over(family(learner, when, setup), family(against, when, setup))


def first(learner: str, against: str = PLAIN, setup: str = "joint damping") -> Measured:
    """Error in the very first trial of the family, learning, over another one's.

    Parameters
    ----------
    learner, against, setup
        As in `ratio`.
    """
    practice = part("family", setup)["practice"]
    return _over(*(np.array(practice[name])[0] for name in (learner, against)))


def trials_to_half(errors, start) -> np.ndarray:
    """Trials after which errors stay at half of a first value or below, shape (seeds,).

    Parameters
    ----------
    errors : array_like, shape (trials, seeds)
        Before each trial.
    start : array_like, shape (seeds,)

    Returns
    -------
    ndarray
        Infinite for seeds that do not get there.
    """
    above = np.asarray(errors) > 0.5 * np.asarray(start)
    last = np.array([np.flatnonzero(each)[-1] if each.any() else -1 for each in above.T])
    return np.where(last == len(above) - 1, np.inf, last + 1.0)


def halved(learner: str, loaded: bool = False, setup: str = "joint damping") -> Measured:
    """Trials of the family to half the error of the feedback alone, or of the first loaded trial.

    Parameters
    ----------
    learner, setup
        As in `family`.
    loaded : bool
        Whether the trials with the load are counted.
    """
    number = results.read("learning-in-the-loop")["trials"]
    found = part("family", setup)
    errors = np.array(found["tests"][learner])
    if loaded:
        errors = np.concatenate([errors[number:], [found["at the end"][learner]]])
        start = errors[0]
    else:
        errors, start = errors[:number], np.array(found["tests"][PLAIN])[0]
    counts = trials_to_half(errors, start)
    got = np.isfinite(counts).sum()
    return judged(
        median,
        np.where(np.isfinite(counts), counts, 1e3),
        text=f"{spread(counts)}, {got} of {counts.size} seeds" if got else "no seed",
    )


def practised(learner: str, setup: str = "joint damping") -> Measured:
    """Error in the last trial of one motion over that of the feedback alone.

    Parameters
    ----------
    learner, setup
        As in `on`.
    """
    last = np.array(part("motion", setup)["practice"][learner])[-1]
    return _over(last, on("the same", PLAIN, setup))


def lost(learner: str, times: float, setup: str = "joint damping") -> Measured:
    """Share of the seeds that end worse than the feedback alone at a multiple of the rate.

    Parameters
    ----------
    learner, setup
        As in `on`.
    times : float
        Of the rate chosen, one of those tried.
    """
    rates = results.read("learning-in-the-loop")["rates"]
    if times not in rates:
        raise ValueError(f"times must be one of {rates}, got {times!r}")
    found, place = part("rates", setup)[learner], rates.index(times)
    worse = np.array(found["error"])[place] > on("the same", PLAIN, setup)
    stopped = np.sum(found["stopped"][place])
    text = f"{worse.sum()} of {worse.size}, {stopped} stopped"
    return judged(mean, worse.astype(float), text=text)


def multiplications(hidden: int = 10, inputs: int = 42, every: int = 5, replay: int = 15) -> dict:
    """Multiplications of each way to learn in a control period, in the mean, exact.

    Parameters
    ----------
    hidden, inputs : int
        Units, and numbers in a window; two output units.
    every : int
        Control periods between two samples; a learner works once a sample.
    replay : int
        Samples that are learnt again.

    Returns
    -------
    dict
        The torque itself in each period, and what each learner adds to it. Sigmoids, divisions
        and scaling are not counted.
    """
    features = hidden + inputs + 1
    torque = hidden * inputs + 2 * (hidden + inputs)
    # delta: o (1 - o) e; through the output weights and h (1 - h); all products times the rate
    back = 2 * 2 + 2 + 2 * hidden + 2 * hidden + hidden
    gradient = back + 2 * (features - 1) + hidden * inputs
    one = torque + gradient
    squares = features**2
    least = (torque - 2 * (hidden + inputs)) + 2 * (features - 1) + 2 * features
    least += 3 * squares + 2 * features
    plain = inputs + 1
    return {
        "torque": float(torque),
        "one pass": one / every,
        "by feedback": gradient / every,
        "replay": (1 + replay) * one / every,
        "last layer": least / every,
        "linear filter": (3 * plain**2 + 6 * plain - 2) / every,
    }


def affordable(learner: str) -> Measured:
    """Multiplications of torque and learning over what 1986 did in a control period.

    A floating-point processor computed six joints in 1.2 ms (Khosla 1986, as the report cites it):
    in 2 ms that is 5/3 of the multiplications of the Newton-Euler equations, customised.

    Parameters
    ----------
    learner : str
        As in `multiplications`; "torque" for the network alone.
    """
    each = multiplications()
    total = each["torque"] + (each[learner] if learner != "torque" else 0.0)
    could = count(newton_euler, PUMA_560, "arm").multiplications * 2.0 / 1.2
    return Measured(total / could, f"{total:,.0f} of {could:,.0f} in 2 ms")
