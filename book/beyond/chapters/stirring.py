"""*From pick-and-place to circles*: errors, day by day; the lesson's numbers and checks."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from beyond.studies.loop.feedforwards import exact
from ddlib.figures import FAINT, Illustration, illustrate, legend_above, looks, plain_ticks
from ddlib.setups import JOINT_DAMPING, Setup
from ddlib.tables import Table, how_many, quote, spread
from ddlib.trajectories import APPENDIX_I, MOTION_SECONDS, pick_and_place
from workshop.chapters.exercises import Exercise, judging
from workshop.report import results
from workshop.report.evidence import claims
from workshop.report.evidence.verdicts import Measured

_FAMILIES = ("pick and place", "circles")
_DOTS = {
    "network, pick and place": "network: pick-and-place",
    "network, circles": "network: circles",
    "network, both": "network: both",
    "identified, pick and place": "equations: pick-and-place",
}


_BY_DESCENT = "network: pick-and-place, by descent"


def traded_figure() -> Illustration:
    """The hand's errors on one family against those on the other: a dot for each network."""
    points = {label: [hand(name, m) for m in _FAMILIES] for name, label in _DOTS.items()}
    points[_BY_DESCENT] = [np.array(_descended()[m]["network"]) for m in _FAMILIES]
    nothing = [hand("none", m)[0] for m in _FAMILIES]

    def draw(figure: Figure):
        axis = figure.subplots()
        axis.set(xscale="log", yscale="log")
        axis.axvline(nothing[0], color=FAINT, ls="--", lw=1)
        axis.axhline(nothing[1], color=FAINT, ls="--", lw=1)
        for (name, pair), marker in zip(points.items(), "os^DX"):
            look = {"color": looks(points)[name].colour, "ls": "", "ms": 6, "alpha": 0.85}
            hollow = {"mfc": "none"} if marker in "sD" else {"mew": 0}
            axis.plot(*pair, marker, label=name, **look, **hollow)
        axis.set(xlabel="error of the hand on pick-and-place, mm", ylabel="on circles, mm")
        axis.text(nothing[0] * 0.97, 1.0, "none", color=FAINT, fontsize=8, ha="right")
        axis.text(0.95, nothing[1] * 1.04, "none", color=FAINT, fontsize=8)
        axis.set(xlim=(0.9, None), ylim=(0.9, None))
        plain_ticks(axis.xaxis)
        plain_ticks(axis.yaxis)
        legend_above(figure, *axis.get_legend_handles_labels())

    medians = "; ".join(
        f"{name} {np.median(circles):.1f} and {np.median(pick):.1f} mm"
        for name, (pick, circles) in points.items()
    )
    alt = (
        "Errors of the hand on circles over errors on pick-and-place, logarithmic. Without "
        f"feedforward {nothing[1]:.1f} and {nothing[0]:.1f} mm. Medians: {medians}."
    )
    return illustrate(draw, alt, 6.2, 3.4)


def hands_table() -> Table:
    """Errors of the hand on both families, by what gave the torques in advance."""
    rows = [("none", *(f"{hand('none', motion)[0]:.1f}" for motion in _FAMILIES[::-1]))]
    filters = {"linear filter, pick and place": "linear filter: pick-and-place"}
    for name, label in (_DOTS | filters).items():
        rows.append((label, *(spread(hand(name, motion)) for motion in _FAMILIES[::-1])))
    of_descent = [_descended()[motion]["network"] for motion in _FAMILIES[::-1]]
    rows.append((_BY_DESCENT, *map(spread, of_descent)))
    return Table(("torques in advance", "on circles, mm", "on pick-and-place, mm"), rows)


def stopped_table() -> Table:
    """Errors of the hand with networks that stopped early, and after 60 steps."""
    rows = []
    for name, label in (("none", "none"), ("chosen", "stopped early"), ("60", "after 60 steps")):
        cells = [np.median(_stopped()["hands"][motion][name]) for motion in _FAMILIES[::-1]]
        rows.append((label, *(f"{x:.1f}" for x in cells)))
    return Table(("torques in advance", "on circles, mm", "on pick-and-place, mm"), rows)


def _descended() -> dict:
    """The hand's errors with networks of pick-and-place by the report's descent."""
    return results.read("stirring-descent")["hands"]


def _stopped() -> dict:
    """What the study of early stopping found under joint damping."""
    return results.read("loop-conditions")["stopped"]["joint damping"]


def error(
    rival: str, learnt: str, asked: str, setup: str = JOINT_DAMPING.name, width: int = 21
) -> np.ndarray:
    """RMS torque errors of both joints together on a test, N m, one for each day."""
    row = _row(setup)
    rows = row["errors"][rival] if width == 21 else row["wider"][str(width)]
    return np.sqrt((np.array(rows[learnt][asked])[:, 1:] ** 2).mean(-1))


def needed(setup: Setup, q, qd, qdd) -> np.ndarray:
    """Torque of the arm's equations with its friction, N m."""
    return exact(setup)(q, qd, qdd)


def _row(setup: str = JOINT_DAMPING.name) -> dict:
    """What the study found with one of its set-ups."""
    return results.read("stirring")["setups"][setup]


def hand(name: str, motion: str = "circles", setup: str = JOINT_DAMPING.name) -> np.ndarray:
    """The hand's RMS error with a feedforward: median over a family, one for each day, mm."""
    return np.median(_row(setup)["hands"][name][motion], axis=1)


def turns() -> Measured:
    """Whether each joint that moves turns back once, in the middle, in each of Appendix I."""
    t = np.linspace(0.0, MOTION_SECONDS, 3002)[1:-1]  # no sample lies on the middle
    qd = pick_and_place(APPENDIX_I, t).qd
    moving = np.abs(qd).max(1) > 0
    back = np.diff(np.sign(qd), axis=1) != 0
    reversals = back.sum(1)[moving]
    where = t[back.argmax(1)[moving]]
    once = bool((reversals == 1).all() and np.abs(where - MOTION_SECONDS / 2).max() < 0.002)
    return Measured(once, f"{reversals.max()} turn a joint, after {where.mean():.2f} s")


def _median(learnt: str, asked: str, rival: str = "network") -> float:
    return float(np.median(error(rival, learnt, asked)))


def _quoted() -> None:
    """The numbers of the prose."""
    nothing = [float(hand("none", motion)[0]) for motion in _FAMILIES]
    worse = hand("network, pick and place", "circles") > nothing[1]
    quote("stir-worse-count", how_many(int(worse.sum()), len(worse)))
    shared = _row()["coverage"]["all"]["circles"]
    for kind, short in (("other family", "share"), ("same family", "same")):
        quote(f"stir-{short}-circles-all", 100 * shared[kind]["shared"])
    for rival in ("network", "identified"):
        ratio = _median(*_FAMILIES, rival) / _median(*_FAMILIES[1:] * 2, rival)
        quote(f"stir-ratio-{rival}", ratio)
    quote("stir-ratio-both", _median("both", "circles") / _median(*_FAMILIES[1:] * 2))
    quote("stir-ratio-both-back", _median("both", "pick and place") / _median(*_FAMILIES[:1] * 2))
    quote("stir-network-circles", _median(*_FAMILIES))
    quote("stir-network-small", _median("pick and place", "small circles"))
    quote("stir-both-small", _median("both", "small circles"))
    quote("stir-steps", JOINT_DAMPING.steps)
    helping = np.array(_descended()["circles"]["network"]) < nothing[1]
    quote("stir-descent-count", int(helping.sum()))
    for key, name in (("five", ""), ("twenty", "-more-motions")):
        quote(f"stir-joints-{key}", claims.measured(f"joints-three-and-four{name}").value)


def _exercise(number: int, *given) -> Exercise:
    """An exercise of the lesson."""
    if number == 1:
        d = np.cos(np.deg2rad([2.5, 45.0]))  # both links are of one length
        right = d[0] / np.sin(np.deg2rad(5)) / d[1]
        slips = [
            (1 / np.sin(np.deg2rad(5)), "the hand's distance d is another one, too."),
            (1 / right, "the other way round."),
        ]
        reason = "d over the determinant of the Jacobian grows."
        return Exercise("number", right, reason, slips, "Differentiate the law of cosines.")
    elif number == 2:
        slips = [
            ((-1, 1, -1), "a film that runs backwards has the same accelerations."),
            ((1, -1, -1), "these torques are products of two velocities."),
            ((1, 1, 1), "friction opposes the velocity."),
        ]
        return Exercise(
            "numbers",
            (1, 1, -1),
            "backwards, the same motion differs in friction only.",
            slips,
            "What changes sign?",
        )
    else:
        (asked,) = given

        def right(place):
            radius, period, distance, bearing = map(float, place)
            return period >= 1 and asked(radius, period, distance, bearing) < 0.1

        otherwise = (
            "out of reach, too fast, or 0.1 or more is left. What must change for b to show?"
        )
        return Exercise("numbers", right, "one circle was enough.", [], otherwise, count=4)


check = judging(_exercise)
