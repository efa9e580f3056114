"""What the lesson *What hidden units do together* shows, quotes, and what its claims measure."""

from __future__ import annotations

from functools import cache
from itertools import product

import numpy as np
from matplotlib.figure import Figure
from scipy.linalg import orth

from ddlib.analysis import ablation, explained, net_inputs, refitted, saturated, transition_width
from ddlib.figures import legend_above
from ddlib.figures.style import COLOURS, DASHES, INK, TONES, Illustration, illustrate
from ddlib.learning import TrainingSet, cases
from ddlib.metrics import rmss
from ddlib.setups import (
    JOINT_DAMPING,
    SETUPS,
    STATE_FEEDBACK,
    WINDOWS,
    errors,
)
from ddlib.simulation import LOG_STEP
from ddlib.tables import quote, significant
from workshop.chapters.exercises import Between, Exercise, judging
from workshop.chapters.hinton_diagrams import before_and_after
from workshop.chapters.window_networks import intervals
from workshop.report import committed
from workshop.report.evidence import claims
from workshop.report.evidence.verdicts import Measured, judged, median, rank_correlation
from workshop.report.measures import filter_trial


def in_transition(width: int, setup: str = STATE_FEEDBACK.name) -> Measured:
    """Median share of cases in which a hidden unit is in its transition region, 0.1 to 0.9."""
    windows, _ = cases(committed.training(setup), width)

    def often(models):
        net = net_inputs(models(width, setup), windows)
        return 1 - saturated(1 / (1 + np.exp(-net))), transition_width(net)

    (share, region), (before, _) = committed.both(often)
    now, then = (100 * np.median(x) for x in (share, before))
    text = f"{now:.0f} % of the time, {then:.0f} % before training; the region is "
    text += f"{significant(np.median(region), 2)} standard deviations of the net input wide"
    return judged(median, share, text=text)


def spare_units(width: int, worse: float = 1.1) -> Measured:
    """Median number of units of ten without which the training error grows by less than `worse`."""
    windows, torque = cases(committed.training(), width)

    def spare_of(models):
        every = models(width)
        members = [every[k] for k in range(len(every.weights))]
        without = [ablation(member, windows, torque)[1] for member in members]
        whole = [rmss(member.torque(windows), torque) for member in members]
        return (np.array(without) < worse * np.array(whole)[:, None]).sum(1)

    spare, before = committed.both(spare_of)
    text = f"{np.median(spare):.0f} of 10 units can be spared ({spare.min()} to {spare.max()}), "
    return judged(median, spare, text=f"{text}{np.median(before):.0f} before training")


def weights_and_saturation() -> Measured:
    """Rank correlation of a unit's largest weight and the time it is saturated, all windows."""
    cells = []
    for width in WINDOWS:
        model, (windows, _) = committed.networks(width), cases(committed.training(), width)
        activity = model.weights.activity(model.scaled(windows))[0]
        largest = np.abs(model.weights.hidden_weights).max((-2, -1))
        cells.append((largest, saturated(activity)))

    def correlation(*drawn):
        x, y = (np.concatenate([c[k].reshape(len(c[k]), -1) for c in drawn], -1) for k in (0, 1))
        return rank_correlation(x, y)

    units = f"over {sum(largest.size for largest, _ in cells)} units"
    return judged(correlation, *cells, text=lambda value: f"rank correlation {value:.2f} {units}")


_RUNS = ("training", "trajectory 6")  # Where errors are taken


@cache
def _features(width: int, setup: str) -> tuple:
    """Windows and hidden activities in rows, and torques, in training and on trajectory 6."""
    runs = committed.training(setup), committed.recording(setup)[5]
    model, parts = committed.networks(width, setup), []
    for run in runs:
        windows, torque = cases(run, width)
        hidden = model.weights.activity(model.scaled(windows))[0]
        parts.append((windows.reshape(len(windows), -1), hidden, torque))
    return tuple(parts)


def linear_alone(width: int = 21, setup: str = JOINT_DAMPING.name) -> np.ndarray:
    """Errors of a linear filter of the window, by least squares: training, trajectory 6."""
    (x, _, y), (new, _, answer) = _features(width, setup)
    return refitted(x, y, new, answer)


@cache
def beside_linear() -> dict:
    """By set-up and window: training and test errors of a linear filter, and of the networks."""
    by_place = {(name, w): [linear_alone(w, name)] for name, w in product(SETUPS, WINDOWS)}
    for (name, w), each in by_place.items():
        networks = errors(committed.networks(w, name), committed.recording(name))
        each.append(np.stack([networks.training, networks.test], -1))
    return by_place


def at_work() -> Illustration:
    """Ten hidden units during the first motion, before training and after, above the torque."""
    run = JOINT_DAMPING.record()[:5]
    data = TrainingSet.from_recording(run, 21)
    time, end = run.t[run.motion], len(run.t[run.motion])
    panels = {}
    for name, weights in zip(("before training", "after training"), before_and_after()):
        hidden, output = weights.activity(data.x)
        panels[name] = hidden[:end], data.outputs.unscale(output)[:end, 1]
    wanted = data.outputs.unscale(data.y)[:end, 1]

    def draw(figure: Figure):
        axes = figure.subplots(2, 2, sharex=True, sharey="row", height_ratios=(1.4, 1))
        for (units, torques), (name, (hidden, predicted)) in zip(axes.T, panels.items()):
            for k, activity in enumerate(hidden.T):
                units.plot(time, activity, DASHES[k // 6], color=COLOURS[k % 6], lw=1.1)
            units.set_title(name)
            torques.plot(time, wanted, color=INK, lw=0.9, label="torque")
            torques.plot(time, predicted, "--", color=TONES["network"], label="the network's")
            torques.set_xlabel("time, s")
        axes[0, 0].set_ylabel("activity")
        axes[1, 0].set_ylabel("elbow's torque, N m")
        legend_above(figure, *torques.get_legend_handles_labels())

    alt = (
        "Activities of ten hidden units over three seconds, and the elbow's torque below. Before "
        "training the units drift apart slowly, and the network's torque is nearly level. After "
        "training they swing with the torque, and the network follows it."
    )
    return illustrate(draw, alt, 7.0, 3.6)


def over_linear() -> Illustration:
    """The networks' errors over those of a linear filter of the same window."""
    panels, alt = {}, "Errors of networks over those of a linear filter, medians."
    for k, where in enumerate(_RUNS):
        over = {f"{n}, {w}": whole[:, k] / a[k] for (n, w), (a, whole) in beside_linear().items()}
        row = {name: tuple(np.quantile(each, (0.1, 0.5, 0.9))) for name, each in over.items()}
        panels[where] = {"networks": row}
        alt += f" On {where}: {', '.join(f'{n} {m:.2f}' for n, (_, m, _) in row.items())}."
    return intervals(panels, "error / linear filter's", alt, log=True, band=(0.25, 1))


def _quoted() -> None:
    """Put the book's numbers into the lesson."""
    row, hidden = filter_trial.row(21), _features(21, JOINT_DAMPING.name)[0][1]
    quote("global-saturated-21", 100 * np.median(saturated(hidden)))
    quote("global-friction", claims.measured("compensate-friction").value)
    for w in (11, 21):
        often = filter_trial.row(w)["real"]["saturated"]
        quote(f"global-trial-saturated-{w}", 100 * np.median(often))
    unrelated = filter_trial.matched(filter_trial.row(11)).values()
    least = min(np.median(torques["saturated"]) for torques in unrelated)
    quote("global-trial-unrelated", 100 * least)
    for key in ("real", "untrained"):
        quote(f"global-cancel-{key}", 100 * np.median(row[key]["cancelled"]))
        velocity, acceleration = np.moveaxis(np.reshape(row[key]["probe"], (-1, 2, 2)), -1, 0)
        quote(f"global-read-{key}", np.median(velocity))
        quote(f"global-read-acceleration-{key}", np.median(acceleration.mean(1)))
    whole, pure, rest = (
        np.array(row["interventions"][name]["at once"])[:, 0]
        for name in ("as trained", "pure parts", "without pure parts")
    )
    quote("global-pure", np.median(pure / whole))
    quote("global-without-pure", np.median(rest / whole))


def _exercise(number: int, *given) -> Exercise:
    """An exercise of the lesson, for the reader's own cases."""
    if number == 1:
        slips = [
            (1 / np.sqrt(10), "that is the share that remains, not the share that cancels."),
            (0.9, "deviations do not add up. What does?"),
        ]
        reason, otherwise = "variances add up.", "what of unrelated signals adds up?"
        return Exercise("number", 1 - 1 / np.sqrt(10), reason, slips, otherwise)
    elif number == 2:
        units, window = given
        right = "larger" if units > window else "smaller"
        reason = f"the error is {units:.3f} from the units alone, {window:.3f} from the window."
        return Exercise(
            "word",
            right,
            reason,
            otherwise="how many numbers does a window have, and how many units are there?",
            options=("larger", "smaller"),
        )
    else:
        tried, alone = given
        share = np.mean(np.less(tried, alone), axis=0)[1]
        return Exercise(
            "number",
            Between(share - 0.1, share + 0.1),
            f"the share is {share:.2f}.",
            [(Between(0.95), "so it is in training. Count the test alone.")],
            "of each pair of errors, compare the second with that of the window.",
        )


check = judging(_exercise)


def hidden_units_add(
    width: int = 21, setup: str = JOINT_DAMPING.name, runs: str = "training"
) -> Measured:
    """Error of a linear filter alone over that with the hidden units, both fitted anew."""
    (x, hidden, y), (new, held, answer) = _features(width, setup)
    alone = linear_alone(width, setup)[_RUNS.index(runs)]
    pairs = [
        refitted(np.column_stack([x, h]), y, np.column_stack([new, t]), answer)
        for h, t in zip(hidden, held)
    ]
    both = np.array(pairs)[:, _RUNS.index(runs)]
    text = f"{significant(alone, 2)} alone, {significant(np.median(both), 2)} with hidden units"
    return judged(median, alone / both, text=text)


def compensate_friction(width: int = 21, setup: str = JOINT_DAMPING.name) -> Measured:
    """Share R² of the hidden units' non-linear part that friction and rigid body explain.

    Least squares takes what is linear in the window out of all three; the better of two joints.
    """
    run, chosen = committed.training(setup), SETUPS[setup]
    x, hidden, _ = _features(width, setup)[0]
    weights = committed.networks(width, setup).weights
    sums = np.einsum("mnh,moh->mno", hidden, weights.output_weights)
    speed = run.qd_true[..., run.motion, :]
    acceleration = np.gradient(run.qd_true, LOG_STEP, axis=-2)[..., run.motion, :]
    rigid = chosen.arm.inverse_dynamics(run.q_true[..., run.motion, :], speed, acceleration)
    axes = orth(np.column_stack([x, np.ones(len(x))]), rcond=1e-9)

    def curved(y):
        return y - axes @ (axes.T @ y)

    known = [curved(y.reshape(-1, 2)) for y in (chosen.effects.friction_torque(speed), rigid)]
    rest, medians = [curved(each) for each in sums], []
    for name, parts in (("friction", known[:1]), ("rigid body", known[1:]), ("together", known)):
        fits = np.array(
            [[explained(x[:, j], *(k[:, j] for k in parts)) for j in (0, 1)] for x in rest]
        )
        medians.append("{} {:.2f} and {:.2f}".format(name, *np.median(fits, axis=0)))
    text = f"R² {'; '.join(medians)}, shoulder and elbow"
    return judged(lambda each: np.median(each, axis=1).max(-1), fits, text=text)
