"""Figures of the chapter *Trajectories and recording*, and what its claims measure."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from scipy.spatial import ConvexHull, Delaunay
from scipy.stats import binom

from ddlib import paper
from ddlib.analysis import cells_reached, log10_reachable_share, used_dimensions
from ddlib.control import proportional
from ddlib.figures.style import FAINT, INK, Illustration, illustrate, looks
from ddlib.learning import sliding_windows
from ddlib.paper import TRAINING_TRAJECTORIES
from ddlib.setups import (
    JOINT_DAMPING as JOINT_DAMPING,
    KP,
    POSITION_FEEDBACK,
    SETUPS,
    STATE_FEEDBACK,
    WINDOWS,
    true_states,
)
from ddlib.simulation import LOG_STEP, Recording, rms
from ddlib.tables import quote, scientific, significant
from ddlib.trajectories import (
    APPENDIX_I,
    MAX_EXTENT_DEG,
    MOTION_SECONDS,
    pick_and_place,
    random_extents,
)
from ddlib.widgets import TrajectoryPicker as TrajectoryPicker
from workshop.chapters.exercises import Between, Exercise, fitting, judging
from workshop.report import committed, results
from workshop.report.evidence.verdicts import Measured, turns_at
from workshop.report.exact_states import RADIUS
from workshop.report.two_harmonics import record_two_harmonics

_TRAINING = len(TRAINING_TRAJECTORIES)


def reached(states: Mapping[str, np.ndarray], radius: float) -> Illustration:
    """Where recordings lie in the cube of states: shoulder against elbow, three planes."""
    units = {"position": "rad", "velocity": "rad/s", "acceleration": "rad/s²"}
    edge = 1.15 * radius

    def draw(figure: Figure):
        axes = figure.subplots(1, 3)
        for k, (axis, (title, unit)) in enumerate(zip(axes, units.items())):
            box = Rectangle((-radius, -radius), 2 * radius, 2 * radius, fill=False)
            box.set(edgecolor=INK, lw=1.0)
            axis.add_patch(box)
            for j, (name, x) in enumerate(states.items()):
                for run, line in enumerate(x[..., 2 * k : 2 * k + 2]):
                    label = name if run == 0 else None
                    axis.plot(
                        *line.T, color=looks(states)[name].colour, lw=0.6 + 0.5 * j, label=label
                    )
            axis.set(xlim=(-edge, edge), ylim=(-edge, edge), aspect="equal", title=title)
            axis.axhline(0, color=FAINT, lw=0.5)
            axis.axvline(0, color=FAINT, lw=0.5)
            axis.set(xlabel=f"shoulder, {unit}", ylabel=f"elbow, {unit}")
        figure.legend(*axes[0].get_legend_handles_labels(), loc="outside upper left", ncols=3)

    largest = ", ".join(
        f"{name}: {np.abs(x[..., :2]).max():.1f} rad, {np.abs(x[..., 2:4]).max():.1f} rad/s, "
        f"{np.abs(x[..., 4:]).max():.1f} rad/s²"
        for name, x in states.items()
    )
    alt = (
        "Three squares, shoulder against elbow, for position, velocity and acceleration, each "
        f"with the box of ±{radius:.2f}; the recordings are thin curves in a part of it. Largest "
        f"values: {largest}."
    )
    return illustrate(draw, alt, 7.0, 2.9)


def rounding(t, steps, estimates: Mapping[str, np.ndarray]) -> Illustration:
    """Readings of an encoder sample by sample, and accelerations computed from them."""
    tones = looks(estimates)

    def draw(figure: Figure):
        top, bottom = figure.subplots(2, 1, sharex=True)
        top.step(t, steps, where="mid", color=FAINT, lw=0.9)
        top.plot(t, steps, ".", color=INK, ms=5)
        top.set_ylabel("angle, encoder steps")
        for k, (name, x) in enumerate(estimates.items()):
            look = dict(ls="", marker=".", ms=5) if k == 0 else dict(lw=2)
            bottom.plot(t, x, color=tones[name].colour, label=name, **look)
            if k == 0:
                bottom.vlines(t, 0, x, color=tones[name].colour, lw=0.7, alpha=0.6)
        bottom.set(xlabel="time, s", ylabel="acceleration, rad/s²")
        figure.legend(*bottom.get_legend_handles_labels(), loc="outside upper left", ncols=3)

    sizes = ", ".join(f"{name} {np.std(x):.3f}" for name, x in estimates.items())
    alt = (
        f"Above, readings that change by whole steps, {int(np.ptp(steps))} in all; below, "
        f"accelerations computed from them, with standard deviations in rad/s²: {sizes}."
    )
    return illustrate(draw, alt, 7.0, 4.0)


def tied(panels: Mapping[str, Mapping[str, np.ndarray]]) -> Illustration:
    """Acceleration against position: a line where one follows from the other, a cloud where not."""
    first = next(iter(next(iter(panels.values()))))
    look = looks((name for named in panels.values() for name in named), {first: "measured"})

    def draw(figure: Figure):
        axes = figure.subplots(1, len(panels), squeeze=False, sharex=True)[0]
        for axis, (title, named) in zip(axes, panels.items()):
            for place, (name, points) in enumerate(named.items()):
                q, qdd = np.rad2deg(points[..., 0]), points[..., 1]
                if place:
                    mark, colour = "os^"[(list(look).index(name) - 1) % 3], look[name].colour
                    axis.plot(q.ravel(), qdd.ravel(), mark, color=colour, ms=1.6, mew=0, alpha=0.7,
                              label=name)  # fmt: skip
                else:
                    lines = axis.plot(q.T, qdd.T, color=INK, lw=1.3, zorder=3)
                    lines[0].set_label(name)
            axis.set(xlabel="position, °", title=title)
        axes[0].set_ylabel("acceleration, rad/s²")
        handles, labels = axes[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside upper left", ncols=3, markerscale=3)

    def correlation(points):
        q, qdd = points[..., 0].ravel(), points[..., 1].ravel()
        return f"correlation {np.corrcoef(q, qdd)[0, 1]:.2f}"

    parts = [
        f"{title}: " + ", ".join(f"{name}, {correlation(points)}" for name, points in named.items())
        for title, named in panels.items()
    ]
    alt = f"Acceleration against position. {'; '.join(parts)}."
    return illustrate(draw, alt, 7.0, 3.0)


def three_recordings() -> dict[str, dict[str, np.ndarray]]:
    """Position and acceleration of the shoulder, for `tied`: ringing, quiet, and by two sines."""
    panels = {}
    for title, setup, recording in (
        ("position feedback", POSITION_FEEDBACK, POSITION_FEEDBACK.record()),
        ("state feedback", STATE_FEEDBACK, STATE_FEEDBACK.record()),
        ("two sines", STATE_FEEDBACK, record_two_harmonics()),
    ):
        wanted = np.stack(recording.reference, -1)[:_TRAINING, recording.motion, 0]
        states = true_states(recording, setup)[:_TRAINING, :, 0, ::2]
        panels[title] = {
            "reference": wanted[:, ::10, ::2],
            "recorded, first 0.5 s": states[:, :50:5],
            "recorded, later": states[:, 50::10],
        }
    return panels


def _quoted() -> None:
    """Quote what the lesson says of the book's recordings."""
    training, step = committed.training(), STATE_FEEDBACK.effects.encoder[0].step
    windows = sliding_windows(training.q, 21, training.motion).reshape(-1, 42)
    quote("recording-dimensions", used_dimensions(windows, step))
    quote("recording-cells", 100 * coverage().value)
    errors = results.read("table-4-1")["setups"][JOINT_DAMPING.name]["21"]["errors"]
    quote("recording-known", np.median(errors["training"]))
    quote("recording-test", np.median(errors["test by training deviation"]))


def _exercise(number: int, given=None) -> Exercise:
    """An exercise of the lesson; `given` the extents, or what moves the arm."""

    def states(share):
        return (x[0, :, 0] for x in given([[45.0, 45.0]], share))

    def speed(share):
        _, qd, _ = states(share)
        return np.abs(qd).max()

    def explained(share):
        q, qd, qdd = states(share)
        moving = qd != 0
        return np.corrcoef(q[moving], qdd[moving])[0, 1] ** 2

    if number == 1:
        slip = (
            4.0,
            "that is twice the frequency. But how large is the wave of a squared sine?",
        )
        return Exercise(
            "number", 2.0, "it is twice as large, and in return the velocity does not jump.", [slip]
        )
    elif number == 2:
        inside, everywhere = (ConvexHull(x).volume / MAX_EXTENT_DEG**2 for x in (given[:-1], given))
        slips = [
            (inside, "that is how often it lies inside."),
            (1 - everywhere, "leave the test out of the hull."),
        ]
        hint = "which share of the square's area lies outside?"
        reason = "a few motions leave much of the square outside."
        return Exercise("number", 1 - inside, reason, slips, hint, tolerance=0.01)
    else:
        fastest = 1.2 * speed(0.0) * (1 + 1e-9)  # 20 % is still right
        shares = np.arange(-500, 501) / 500
        slow = fitting(lambda x: speed(x) <= fastest, shares)
        right = fitting(lambda x: explained(x) < 0.1 and speed(x) <= fastest, shares)
        slips = [
            (slow, "you could still predict too much of the acceleration from the position."),
            (Between(-np.inf), "the arm would have to move too fast."),
        ]
        return Exercise(
            "number", right, "now the recording tells position and acceleration apart.", slips
        )


check = judging(_exercise)


# --- what the claims of the chapter measure


def ends_and_middle() -> Measured:
    """Whether all six begin and end at zero and have their extents half-way, in size."""
    middle = np.rad2deg(pick_and_place(APPENDIX_I, [0.0, MOTION_SECONDS / 2]).q)
    ends = np.abs(pick_and_place(APPENDIX_I, [0.0, MOTION_SECONDS - 1e-9]).q).max()
    holds = ends < 1e-8 and np.allclose(middle[:, 1], -APPENDIX_I)
    text = "0° at 0 s and 3 s, the extent half-way; the formula's sign turns both joints the "
    text += "negative way"
    return Measured(bool(holds), text)


def members() -> Measured:
    """Whether all six pairs of extents lie in the square; where the test lies."""
    inside = ((APPENDIX_I >= 0) & (APPENDIX_I <= MAX_EXTENT_DEG)).all()
    hull = Delaunay(APPENDIX_I[:_TRAINING])
    draws = random_extents(2000 * (_TRAINING + 1), seed=3).reshape(2000, _TRAINING + 1, 2)
    outside = np.mean([Delaunay(d[:-1]).find_simplex(d[-1]) < 0 for d in draws])
    place = "outside" if hull.find_simplex(APPENDIX_I[-1]) < 0 else "inside"
    text = f"six of six; number {paper.TEST_TRAJECTORY} lies {place} the hull of the others, as in "
    text += f"{100 * outside:.0f} % of random draws"
    return Measured(bool(inside), text)


def random_draws(resolution: float = 0.1) -> Measured:
    """Chance that uniform draws put as many of the extents on a limit as are there."""
    on_limit = int(np.isin(APPENDIX_I, (0.0, MAX_EXTENT_DEG)).sum())
    chance = binom.sf(on_limit - 1, APPENDIX_I.size, resolution / MAX_EXTENT_DEG)
    text = f"{on_limit} of {APPENDIX_I.size} extents lie on a limit; uniform draws do that with "
    text += f"a chance of {scientific(chance)}"
    return Measured(float(chance), text)


def samples() -> Measured:
    """Samples of one motion in the log."""
    recording = committed.recording()
    size = recording.t[recording.motion].size
    return Measured(size, f"{size} at {1 / LOG_STEP:.0f} a second")


def cases() -> Measured:
    """Windows of the five training recordings: with the rests, and inside the motions."""
    q, motion = committed.training().q, committed.training().motion
    whole = sliding_windows(q, WINDOWS[0], motion)[..., 0, 0].size  # as many for all windows
    inside = [sliding_windows(q[:, motion], w)[..., 0, 0].size for w in WINDOWS]
    text = f"{whole:,} with the rests; windows within the motions give "
    return Measured(whole, text + ", ".join(f"{n:,}" for n in inside))


def _missed(recording: Recording) -> float:
    """RMS tracking error over RMS angle on the six motions."""
    error, wanted = recording.tracking_error, recording.reference.q
    return float(np.divide(*(rms(x[:, recording.motion], None) for x in (error, wanted))))


def driven(close: float = 0.1, factors=(1, 2, 3)) -> Measured:
    """Multiple of the assumed gains from which on position feedback alone follows closely."""

    def missed(factor):
        gains = tuple(factor * np.array(KP))
        return _missed(replace(POSITION_FEEDBACK, controller=proportional(gains)).record())

    position, state = (
        _missed(committed.recording(s.name)) for s in (POSITION_FEEDBACK, STATE_FEEDBACK)
    )
    turn = turns_at(factors, [position, *map(missed, factors[1:])], close)
    text = f"RMS error {100 * position:.0f} % of the angle by position feedback, "
    text += f"{100 * state:.0f} % by state feedback; {100 * close:g} % from "
    text += f"{significant(turn, 2)} times the assumed gains on"
    return Measured(float(turn), text)


def unreachable(width: int = 21) -> Measured:
    """Upper bound on the reachable share of the windows' cube, as a power of ten."""
    power = 2 * log10_reachable_share(width, RADIUS * LOG_STEP / np.pi)
    training = committed.training()
    windows = sliding_windows(training.q, width, training.motion)
    step = STATE_FEEDBACK.effects.encoder[0].step
    used = used_dimensions(windows.reshape(-1, 2 * width), step)
    share = scientific(10.0 ** np.ceil(power))
    text = f"a share below {share} (window {width}, speeds up to {RADIUS:.2f} "
    text += f"rad/s); the recordings use {used} of {2 * width} dimensions"
    return Measured(float(power), text)


def coverage(cells: int = 10) -> Measured:
    """Share of the cells of section 6's cube that the training recordings reach."""
    shares = {}
    for name in SETUPS:
        states = true_states(committed.training(name), SETUPS[name])
        shares[name] = cells_reached(states.reshape(-1, 6), RADIUS, cells) / cells**6
    text = f"of {cells**6:,} cells " + ", ".join(
        f"{100 * x:.2g} % ({n})" for n, x in shares.items()
    )
    return Measured(max(shares.values()), text)
