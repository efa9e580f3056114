"""The arm's mass under a penalty: figure of *The inertia in the weights*."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from ddlib.analysis import gains, half_penalty, ridge_filters
from ddlib.figures.style import INK, Illustration, illustrate, legend_above, looks
from ddlib.learning import TrainingSet
from ddlib.setups import Setup, split, true_states
from ddlib.simulation import LOG_STEP, Recording
from workshop.report import results
from workshop.report.evidence.verdicts import Measured, judged, median
from workshop.report.studies.nulls import TRIAL

_SWINGS = {
    "damped joints": ("damped joints", 0.0),
    "damped joints, first second cut": ("damped joints", 1.0),
    "state feedback": ("state feedback", 0.0),
    "state feedback, first second cut": ("state feedback", 1.0),
    "two sines, first second cut": ("state feedback, two sines", 1.0),
}
"""What the figure shows, as `cell` takes it."""


def cell(drive: str, seconds: float = 0.0) -> dict:
    """A cell of the study "excitation": of a drive, with some seconds of the motion left out."""
    cells = results.read("excitation")["cells"]
    return next(c for c in cells if (c["drive"], c["left out"]) == (drive, seconds))


def half_measured(row: Mapping) -> np.ndarray:
    """Penalty at which half of the arm's inertia is left, by day; NaN where it is never reached."""
    places = np.log(results.read("excitation")["penalties"])
    halves = []
    for mass in np.array(row["ridge"]) / row["arm"] - 0.5:
        k = np.flatnonzero(mass > 0)[-1:]  # the last penalty with more than half
        share = mass[k] / (mass[k] - mass[k + 1])
        halves.append(np.exp(places[k] + share * (places[k + 1] - places[k])) if k.size else np.nan)
    return np.array([float(np.squeeze(half)) for half in halves])


def half_foretold() -> Measured:
    """Largest factor between the penalty that leaves half of the mass and its prediction.

    Of the recordings in which a small penalty finds more than half of the mass on every day.
    """
    pairs = [(half_measured(c), np.array(c["half"])) for c in results.read("excitation")["cells"]]
    pairs = [pair for pair in pairs if np.isfinite(pair[0]).all()]

    def worst(*drawn):
        factors = [np.abs(np.median(np.log(a / b), -1)) for a, b in drawn]
        return np.exp(np.max(factors, axis=0))

    text = "off by a factor of {:.2f} at most, " + f"{len(pairs)} recordings"
    return judged(worst, *pairs, text=text.format)


def foretold_over_found(recording: Recording, setup: Setup, width: int = 21) -> float:
    """How many times the penalty that leaves half of the mass its prediction is; NaN: never half.

    Of one recording of the six runs and a window of `width` samples.
    """
    training = split(recording)[0]
    data = TrainingSet.from_recording(training, width, scaling=TRIAL.scaling)
    states = true_states(training, setup)
    arm = setup.arm.mass_matrix(states[..., 0])[..., 0, 0].mean()
    mass = gains(ridge_filters(data, results.read("excitation")["penalties"]), LOG_STEP)[:, 0, 0, 2]
    half = half_penalty(data, states.reshape(-1, 2, 3))
    return half / float(half_measured({"ridge": [mass], "arm": arm})[0])


def mass_of_networks(drive: str, seconds: float = 0.0) -> Measured:
    """Inertia of networks after all epochs, as a share of the arm's: the median."""
    row = cell(drive, seconds)
    share = np.array(row["descent"]["M11"])[-1] / row["arm"]
    error = np.median(row["descent"]["error"][-1])
    text = "{:.2f} of the arm's inertia, " + f"training RMSS {error:.2f}"
    return judged(median, share, text=text.format)


def mass_survives() -> Illustration:
    """The shoulder's inertia in linear filters over the penalty, in networks over the epochs."""
    chosen = {name: cell(*key) for name, key in _SWINGS.items()}
    study = results.read("excitation")
    penalties, epochs = np.array(study["penalties"]), np.array(study["epochs"])
    apart = epochs[-1] * 3.0  # where the solver's networks stand

    def draw(figure: Figure):
        left, right = figure.subplots(1, 2, sharey=True)
        arm = np.mean([row["arm"] for row in chosen.values()])
        for axis in (left, right):
            axis.axhline(arm, color=INK, ls="--", lw=1.0)
            axis.set(xscale="log", ylim=(-0.5, 9.0))
        for k, (name, row) in enumerate(chosen.items()):
            style = {"color": looks(chosen)[name].colour, "ls": ("-", "--")[row["left out"] > 0]}
            left.plot(penalties, np.median(row["ridge"], 0), lw=1.9, **style)
            half = np.median(row["half"])
            left.plot(half, row["arm"] / 2, "D", color=style["color"], mfc="none", ms=6, mew=1.6)
            mass = np.array(row["descent"]["M11"])  # epoch, member
            right.plot(epochs, np.median(mass, 1), lw=1.9, label=name, **style)
            for x, values in ((epochs[-1], mass[-1]), (apart * 1.3**k, row["solver"]["M11"])):
                low, middle, high = np.percentile(values, (0, 50, 100))
                right.plot([x, x], [low, high], color=style["color"], lw=1.2)
                right.plot(x, middle, "os^Dv*"[k % 6], color=style["color"], ms=4)
        left.set(xlabel="penalty on squared weights", ylabel="inertia in the filters, kg m²")
        left.set_title("linear filters, by ridge")
        right.set(xlabel="epochs of descent")
        right.set_title("networks")
        solver = apart * 1.3 ** (len(chosen) / 2)
        right.axvline(epochs[-1] * 1.7, color=INK, lw=0.6)
        right.minorticks_off()
        right.set_xticks([100, 1000, 10_000, solver], ["100", "1,000", "10,000", "solver"])
        handles, names = right.get_legend_handles_labels()
        handles += [
            Line2D([], [], color=INK, ls="--", lw=1.0),
            Line2D([], [], color=INK, ls="", marker="D", mfc="none", mew=1.6),
        ]
        legend_above(figure, handles, [*names, "the arm", "half of it, predicted"])

    sentences = []
    for name, row in chosen.items():
        ridge, trained = np.median(row["ridge"], 0), np.median(row["descent"]["M11"], 1)
        sentences.append(
            f"{name}: linear filters {ridge[0]:.1f} with the least penalty, half of the arm's at "
            f"a penalty of {np.median(row['half']):.0e} by theory; networks {trained[-1]:.1f} "
            f"after {epochs[-1]:,} epochs, {np.median(row['solver']['M11']):.1f} by the "
            "solver"
        )
    alt = "Inertia of the shoulder, kg m². " + "; ".join(sentences) + "."
    return illustrate(draw, alt, 7.0, 3.6)
