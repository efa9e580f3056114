"""The landing page: its hero; ten pictures of one motion, one window, one row of one network."""

from __future__ import annotations

import warnings
from functools import cache
from types import SimpleNamespace

import numpy as np
from matplotlib.patches import Rectangle

from ddlib import figures
from ddlib.analysis import basis, gains, shares
from ddlib.figures.weights import dots
from ddlib.learning import NotConverged, TrainingSet, Weights, cases, solve, surrogate
from ddlib.setups import JOINT_DAMPING, predict
from ddlib.simulation import LOG_STEP
from ddlib.tables import quote
from workshop.chapters import planted
from workshop.report import committed, results
from workshop.report.evidence import cards
from workshop.report.evidence.statements import resampled, stated
from workshop.report.measures import filter_trial as trial

WIDTH = 21
_SHOWN = 150  # samples of the motion
_TONE = SimpleNamespace(**figures.TONES)


def both(weights: Weights) -> tuple[int, int]:
    """Hidden unit and joint whose row is most of a line and of a parabola, both at once."""
    parts = shares(weights.hidden_weights)
    large = parts[..., 1] * parts[..., 2]
    return tuple(map(int, np.unravel_index(large.argmax(), large.shape)))


@cache
def _network():
    return results.median_network(WIDTH, JOINT_DAMPING.name)


@cache
def carried_row() -> np.ndarray:
    """The row that is carried through all pictures."""
    return _network().weights.hidden_weights[both(_network().weights)]


@cache
def _motion() -> dict:
    """The first second and a half of trajectory 6, from one sample to the next."""
    run = JOINT_DAMPING.record()[5]
    shown = slice(run.motion.start, run.motion.start + _SHOWN)
    wanted = run.reference
    beforehand = JOINT_DAMPING.arm.inverse_dynamics(wanted.q, wanted.qd, wanted.qdd)
    whole = {
        "q": run.q,
        "wanted": wanted.q,
        "tau": run.tau_true,
        "beforehand": beforehand + JOINT_DAMPING.effects.friction_torque(wanted.qd),
    }
    kept = {name: x[shown] for name, x in whole.items()}
    kept["predicted"] = predict(_network(), run)[:_SHOWN]
    kept["hand"] = JOINT_DAMPING.arm.forward_kinematics(kept["q"])
    return kept


@cache
def _window() -> slice:
    """The samples around the moment at which the shoulder's torque is largest."""
    centre = int(_motion()["tau"][:, 0].argmax())
    return slice(centre - WIDTH // 2, centre + WIDTH // 2 + 1)


@cache
def unrelated_row() -> np.ndarray:
    """The same row of a network that learnt torques which were shifted in time."""
    runs, how = JOINT_DAMPING.record()[:5], JOINT_DAMPING
    torque = surrogate("shifted", runs.tau[:, runs.motion]).reshape(-1, 2)
    data = TrainingSet.from_arrays(cases(runs, WIDTH)[0], torque, scaling=how.scaling)
    start = Weights.random(1, WIDTH, how.hidden, initial=how.initial)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", NotConverged)  # it is stopped, as the table's networks are
        solution = solve(start, data, decay=how.decay, steps=how.steps, progress=False)
    weights = solution.model.weights[0]
    return weights.hidden_weights[both(weights)]


@cache
def _inertias() -> dict[str, float]:
    """What the row, the whole network and the arm make of the shoulder's acceleration, kg m²."""
    model, (unit, joint) = _network(), both(_network().weights)
    windows, _ = cases(committed.training(JOINT_DAMPING.name), WIDTH)
    hidden, output = model.weights.activity(model.scaled(windows))
    slopes = (hidden * (1 - hidden))[:, unit] * (output * (1 - output))[:, 0]
    path = slopes.mean() * model.weights.output_weights[0, unit]
    scale = model.inputs.gain[joint] / model.outputs.gain[0]
    whole = trial.gains_of(model, windows, LOG_STEP).whole[0, 0, 2]
    row = gains(path * scale * carried_row(), LOG_STEP)[2]
    return {"the row": row, "its network": whole, "the arm": trial.arm_gains()[0, 0, 2]}


def _dynamics(axis):
    links = _motion()["hand"]
    for k, alpha in ((0, 0.3), ((_window().start + _window().stop) // 2, 0.6), (-1, 1.0)):
        joints = np.vstack([[0, 0], links[k]])
        for link, colour in enumerate((_TONE.shoulder, _TONE.elbow)):
            axis.plot(*joints[link : link + 2].T, "o-", color=colour, alpha=alpha, ms=5, lw=3)
    axis.plot(*links[:, 1].T, color=figures.FAINT, lw=1)
    axis.plot(*links[_window(), 1].T, color=_TONE.window, lw=3.5)
    axis.set(aspect="equal", xlim=(-0.05, 1.0), ylim=(-0.75, 0.05))


def _feedback(axis):
    axis.plot(_motion()["wanted"][:, 0], "--", color=_TONE.wanted, lw=1.2)
    axis.plot(_motion()["q"][:, 0], color=_TONE.shoulder, lw=2)


def _feedforward(axis):
    axis.axhline(0, color=figures.FAINT, lw=0.7)
    torque = _motion()["beforehand"][:, 0]
    axis.fill_between(np.arange(_SHOWN), 0, torque, color=_TONE.wanted, alpha=0.35, lw=0)
    axis.plot(torque, "--", color=_TONE.wanted, lw=2)
    axis.plot(_motion()["tau"][:, 0], color=figures.INK, lw=1)


def _recording(axis):
    at = np.arange(0, _SHOWN, 4)
    for joint, colour in enumerate((_TONE.shoulder, _TONE.elbow)):
        axis.plot(at, _motion()["q"][at, joint], ".", color=colour, ms=4)


def _unit(axis):
    row = carried_row()
    at = np.linspace(0, 1, WIDTH)
    for x, weight in zip(at, row / np.abs(row).max()):
        colour = _TONE.network if weight > 0 else figures.INK
        axis.plot([x, 0.5], [0, 0.8], color=colour, lw=2.5 * abs(weight), zorder=1)
    axis.plot([0.5, 0.5], [0.8, 1.2], color=figures.INK, lw=1.5, zorder=1)
    axis.plot(at, 0 * at, "o", color=_TONE.shoulder, ms=4.5)
    axis.plot(0.5, 0.8, "o", ms=13, mfc=_TONE.network, mec=figures.INK)
    axis.text(0.6, 0.95, "unit", fontsize=8.5)
    axis.set(ylim=(-0.15, 1.2))


def _network_at_work(axis):
    q, tau, predicted = (_motion()[name][:, 0] for name in ("q", "tau", "predicted"))
    axis.plot(1.3 + (q - q.max()) / np.ptp(q), color=_TONE.shoulder, lw=2)
    look = {"color": _TONE.window, "alpha": 0.25, "lw": 0}
    axis.add_patch(Rectangle((_window().start, 0.25), WIDTH, 1.1, **look))
    centre = _window().start + WIDTH // 2
    axis.plot(0.75 * tau / np.ptp(tau) - 0.4, color=figures.INK, lw=1)
    axis.plot(0.75 * predicted[: centre + 1] / np.ptp(tau) - 0.4, "--", color=_TONE.network, lw=2.5)
    axis.annotate(
        "", (centre, 0.75 * predicted[centre] / np.ptp(tau) - 0.36), (centre, 0.3),
        arrowprops={"arrowstyle": "->", "color": figures.INK},
    )  # fmt: skip


def _squares(axis):
    weights = _network().weights.hidden_weights
    unit, joint = both(_network().weights)
    rows = weights[:, joint] / np.abs(weights[:, joint]).max(-1, keepdims=True)
    axis.add_patch(Rectangle((-1, -1), WIDTH + 1, len(rows) + 1, facecolor="#8c8c8c", lw=0))
    dots(axis, rows, 0, 0, 1, 1, 1)
    frame = {"fill": False, "ec": _TONE.network, "lw": 2.5}
    axis.add_patch(Rectangle((-0.8, unit - 0.6), WIDTH + 0.6, 1.2, **frame))
    axis.set(xlim=(-1.2, WIDTH + 0.2), ylim=(-1.2, len(rows) + 0.2))


def _folded(axis):
    row, along = carried_row(), basis(WIDTH)
    axis.axhline(0, color=figures.FAINT, lw=0.7)
    axis.vlines(np.arange(WIDTH), 0, row, color=_TONE.network, alpha=0.45, lw=1.5)
    axis.plot(row, "o", color=_TONE.network, alpha=0.45, ms=3.5)
    for degree, colour in ((1, _TONE.odd), (2, _TONE.even)):
        axis.plot(along[degree] * (along[degree] @ row), color=colour, lw=2.2)


def _whose(axis):
    axis.axhline(0, color=figures.FAINT, lw=0.7)
    look = {"color": _TONE.network, "ms": 2.5, "lw": 1.2}
    for name, row, x in (("ours?", carried_row(), 0), ("ours?", unrelated_row(), WIDTH + 3)):
        axis.plot(x + np.arange(WIDTH), row / np.abs(row).max(), "o-", **look)
        axis.text(x + 1, -0.9, name, fontsize=10, fontweight="bold")
    axis.set(ylim=(-1.1, 1.1))


def _area(axis):
    along = basis(WIDTH)[2]
    parabola = along * np.sign(along @ carried_row())
    x = np.linspace(0, 1, WIDTH)
    axis.fill_between(
        x * 8, 4.2, 4.2 + 2.5 * parabola / np.ptp(parabola), color=_TONE.even, alpha=0.5
    )
    for k, (name, value) in enumerate(_inertias().items()):
        axis.barh(2 - k, value, color=(_TONE.even, _TONE.network, figures.INK)[k], height=0.7)
        axis.text(value + 0.2, 2 - k, f"{name} {value:.1f}", fontsize=8.5, va="center")
    axis.text(8.3, 4.2, "kg m²", fontsize=8.5, va="center")
    axis.set(xlim=(0, 12), ylim=(-0.6, 6))


_PICTURES = {
    "dynamics": (_dynamics, "An arm in three poses; a part of its hand's path is thick."),
    "feedback": (_feedback, "A wanted angle, and the arm's, which swings around it."),
    "feedforward": (
        _feedforward,
        "A torque that a model predicts; thin, the loop's torque.",
    ),
    "trajectories-and-recording": (_recording, "Dots: both joints' angles, sample by sample."),
    "backpropagation": (
        _unit,
        "A window's dots, joined to one unit by thick and thin weights.",
    ),
    "window-networks": (
        _network_at_work,
        "A window on an angle; below, a torque predicted so far.",
    ),
    "hinton-diagrams": (_squares, "Ten rows of black and white squares; one row is framed."),
    "convolution-filters": (_folded, "The framed row as stems, with its line and its parabola."),
    "whose-filters": (
        _whose,
        "Two smooth rows that look much alike, each with the question whether it is ours.",
    ),
    "inertia-in-the-weights": (_area, "A parabola's area, and bars for row, its network and arm."),
}
_BANDED = _feedback, _feedforward, _recording


def station(lesson: str) -> figures.Illustration:
    """The small picture of a lesson of the walk."""
    picture, alt = _PICTURES[lesson]

    def draw(figure):
        axis = figure.subplots()
        picture(axis)
        if picture in _BANDED:
            axis.axvspan(_window().start, _window().stop - 1, color=_TONE.window, alpha=0.25, lw=0)
        axis.set_xticks([])
        axis.set_yticks([])
        axis.grid(False)
        for side in axis.spines.values():
            side.set_visible(False)

    made = figures.illustrate(draw, alt, 2.0, 1.4)
    return figures.Illustration(made.svg, made.alt)  # as small on a phone


def _quoted() -> None:
    """The numbers of the page, and what its comparisons rest on."""
    quote("twins-pairs", results.read("twins")["pairs"])
    quote("twins-least", results.read("twins")["alike"]["least"])
    tried = cards.of_kind("system")  # as the page *Verdict* counts
    quote("index-sentences", len(tried))
    quote("index-reproduced", cards.tally(tried)["reproduced"])
    at = trial.row(WIDTH)
    by_torques = {"real": at["real"], **{kind: at["nulls"][kind] for kind in ("shifted", "phases")}}
    velocity = {kind: trial.share(x, "hidden", ["velocity"]) for kind, x in by_torques.items()}
    least = min(velocity[kind].mean() for kind in ("shifted", "phases"))
    stated("index-velocity-of-any", bool(least >= velocity["real"].mean()))
    inertia, own = np.array(at["real"]["gains"])[:, 0, 0, 2], trial.arm_gains()[0, 0, 2]
    quote("index-inertia", np.median(inertia))
    quote("index-inertia-arm", own)
    off = np.abs(resampled(inertia) / own - 1)
    stated("index-inertia-near", off < 0.25)
    spring = "position alone"
    short, long = (planted.acceleration(spring, long) for long in (False, True))
    quote("index-spring", short)
    quote("index-spring-long", long)
    stated("index-shapes-of-the-motion", short > 90 and long < 10)
    quote("index-knob", planted.every("the arm", "knob").mean())
    stated("index-spring-adds-nothing", abs(planted.every(spring, "knob")).max() < 0.05)
    nulls = [planted.every(kind, "M11").max() for kind in ("shifted", "random phases")]
    stated("index-draws-come-near", max(nulls) > 0.75 * own)
    load = {m: planted.loaded(JOINT_DAMPING.name, m) for m in ("unedited", "written")}
    stated("index-load-written", load["written"] < 0.3 * load["unedited"])
    rivals = results.read("tuned")["rivals"]
    network, known = (
        np.array(rivals[name]["errors"]["trajectory 6"])
        for name in ("network of 1988", "identified")
    )
    stated("index-rivals", resampled(known / network[: len(known)]) < 1)
