"""The lesson *The inertia in the weights*: what it weighs, its numbers, words and answers."""

from __future__ import annotations

from functools import cache

import numpy as np
from matplotlib.figure import Figure

from ddlib.analysis import gains, mean_gradient
from ddlib.dynamics import with_load
from ddlib.figures.style import FAINT, INK, TONES, Illustration, illustrate
from ddlib.learning import TorqueModel, Weights, cases
from ddlib.setups import INITIAL, JOINT_DAMPING, split, true_states
from ddlib.simulation import LOG_STEP, Recording
from ddlib.tables import Table, quote, spread
from workshop.chapters import excitation, planted
from workshop.chapters.exercises import Exercise, judging
from workshop.chapters.index import both
from workshop.chapters.whose_filters import given, trained
from workshop.chapters.widgets.hero import twins
from workshop.chapters.widgets.knob import TurnTheParabola
from workshop.chapters.widgets.weigh import WeighTheArm
from workshop.report import committed, results
from workshop.report.measures import filter_trial as trial
from workshop.report.studies.nulls import TRIAL

_WIDTH = 21
_TURNED = {
    "own": "the arm's torques",
    "position": "position alone",
    "velocity": "velocity alone",
    "shifted": "shifted in time",
}


@cache
def _networks() -> dict[str, TorqueModel]:
    """One network for each kind of torques that the knob is tried on."""
    begin = Weights.random(1, _WIDTH, TRIAL.hidden, initial=INITIAL)
    weights = trained(list(_TURNED), Weights.concatenate([begin] * len(_TURNED)))
    return {
        name: TorqueModel(weights[k : k + 1], given(kind).inputs, given(kind).outputs, LOG_STEP)
        for k, (kind, name) in enumerate(_TURNED.items())
    }


def turn() -> TurnTheParabola:
    """The knob, along trajectory 6."""
    test = split(TRIAL.record())[1]
    q, _, qdd = np.moveaxis(true_states(test, TRIAL).reshape(-1, 2, 3), -1, 0)
    inertial = np.einsum("nij,nj->ni", TRIAL.arm.mass_matrix(q), qdd)
    return TurnTheParabola(_networks(), cases(test, _WIDTH)[0], inertial)


@cache
def _training() -> Recording:
    """The motions that the networks learnt."""
    return split(TRIAL.record())[0]


def _added(load: float) -> np.ndarray:
    """What a load in the hand adds to the arm's mean mass matrix, kg m²."""
    q = _training().q[:, _training().motion]
    masses = (arm.mass_matrix(q).mean((0, 1)) for arm in (with_load(TRIAL.arm, load), TRIAL.arm))
    return np.subtract(*masses)


def weigh() -> WeighTheArm:
    """The scales, for the landing page's networks and one of shifted torques."""
    a, b = twins()
    networks = {
        "this arm's (A)": a.model,
        "a spring's (B)": b.model,
        "shifted in time": _networks()["shifted in time"][0],
    }
    windows, _ = cases(_training(), _WIDTH)
    return WeighTheArm(networks, windows, _arm(), _added)


@cache
def paths() -> np.ndarray:
    """What each path of the landing page's network answers to the shoulder's motion.

    From the shoulder's window to its torque: the direct weights first, then each hidden unit;
    stiffness (N m/rad), damping (N m s/rad) and inertia (kg m²), shape (path, 3).
    """
    model = results.median_network(_WIDTH, JOINT_DAMPING.name)
    windows, _ = cases(committed.training(JOINT_DAMPING.name), _WIDTH)
    weights = model.weights
    hidden, output = weights.activity(model.scaled(windows))
    bend, slope = hidden * (1 - hidden), output[:, 0] * (1 - output[:, 0])
    through = slope @ bend / len(windows) * weights.output_weights[0]
    direct = slope.mean() * weights.direct_weights[:1, 0]
    filters = np.concatenate([direct, through[:, None] * weights.hidden_weights[:, 0]])
    return gains(filters * model.inputs.gain[0] / model.outputs.gain[0], LOG_STEP)


def _carried() -> int:
    """The path of the landing page's row."""
    unit, joint = both(results.median_network(_WIDTH, JOINT_DAMPING.name).weights)
    assert joint == 0
    return 1 + unit


def paths_beside() -> Illustration:
    """Inertia of each path of the landing page's network, and their sum."""
    by_path, carried = paths()[:, 2], _carried()
    names = ["direct", *(f"unit {k}" for k in range(1, len(by_path))), "all"]
    names[carried] += ", the row"
    colours = [TONES["network"] if k == carried else FAINT for k in range(len(by_path))]

    def draw(figure: Figure):
        axis = figure.subplots()
        axis.barh(names[:-1], by_path, color=colours)
        axis.barh(names[-1:], by_path.sum(), color=TONES["network"])
        axis.plot([_arm()] * 2, [len(by_path) - 0.6, len(by_path) + 0.6], color=INK, lw=3)
        axis.axvline(0, color=INK, lw=0.8)
        axis.grid(visible=False, axis="y")
        axis.set(xlabel="inertia, kg m²", ylim=(len(names) - 0.4, -0.6))

    whole = by_path.sum()
    alt = f"Bars for {len(by_path)} paths, of both signs, and for their sum, {whole:.1f} kg m²."
    return illustrate(draw, alt, 7.0, 2.4)


def readings() -> Table:
    """What each of the book's networks of this arm's torques weighs, by its training."""
    ours = results.networks(_WIDTH, JOINT_DAMPING.name)
    windows, _ = cases(committed.training(JOINT_DAMPING.name), _WIDTH)
    alike, page = results.read("twins"), results.read("page-training")
    long = results.read("filter-trial")["epochs"][str(_WIDTH)]
    weighed = {
        "A of the landing page, and its like": (
            f"descent, {alike['how']['epochs']:,} epochs, from ±{alike['how']['initial']}",
            alike["kinds"]["the arm"]["inertia"],
        ),
        "the book's trial": (
            f"descent, {long:,} epochs, from ±{INITIAL}",
            np.array(trial.row(_WIDTH)["real"]["gains"])[:, 0, 0, 2],
        ),
        "our row's network, and its like": (
            f"solver, {JOINT_DAMPING.steps} steps, from ±{INITIAL}",
            gains(mean_gradient(ours, windows), LOG_STEP)[:, 0, 0, 2],
        ),
        "the trainer in the page": (
            f"descent, {page['epochs']:,} epochs, one window in {page['every']}",
            page["rows"]["as printed, real"]["inertia"],
        ),
    }
    rows = [(who, how, len(read), spread(read)) for who, (how, read) in weighed.items()]
    return Table(
        ("who", "trained by", "networks", "inertia of the shoulder, kg m²"),
        [("the arm itself", "–", "–", f"{_arm():.1f}"), *rows],
    )


def _arm() -> float:
    return float(trial.arm_gains()[0, 0, 2])


def _quoted() -> None:
    """Numbers of the lesson."""
    row = trial.row(_WIDTH)
    shoulder, *unrelated = (
        np.array(cell["gains"])[:, 0, 0, 2] for cell in (row["real"], *trial.matched(row).values())
    )
    quote("inertia-least", shoulder.min())
    quote("inertia-unrelated", max(map(np.max, unrelated)))
    quote("inertia-off", 100 * trial.calibrated("inertia", _WIDTH).value)
    lost = excitation.cell("state feedback", 1.0)
    quote("inertia-lost", np.median(np.array(lost["descent"]["M11"])[-1]))
    quote("inertia-lost-arm", lost["arm"])
    halves = {"inertia-half-damped": "damped joints", "inertia-half-state": "state feedback"}
    for name, drive in halves.items():
        half = np.median(excitation.cell(drive, 1.0)["half"])
        if "state" in name:
            quote(name, 1e6 * half)
        quote(name.replace("half", "left"), 100 * half / (half + 1e-5))
    for name, kind in (("arm", "the arm"), ("position", "position alone"), ("shifted", "shifted")):
        answers = planted.every(kind, "knob")
        quote(f"inertia-knob-{name}", answers.mean())
        quote(f"inertia-knob-{name}-least", answers.min())
        quote(f"inertia-knob-{name}-most", answers.max())
    for model in ("unedited", "written", "retrained", "one factor"):
        loaded = planted.loaded(JOINT_DAMPING.name, model)
        quote(f"inertia-load-{model.removeprefix('one ')}", loaded)
    carried, whole = paths()[_carried()], paths().sum(0)
    for name, values in {"row": carried, "row-network": whole}.items():
        quote(f"inertia-{name}", values[2])
        quote(f"inertia-{name}-damping", values[1])


def _exercise(number: int, *given) -> Exercise:
    """An exercise.

    `given` stiffness, inertia, frequency; the window's time; or a direct row, the output's mean
    slope, gains of positions and torques, the window's time, and the whole network's inertia.
    """
    if number == 1:
        K, M, omega = given
        slips = (
            (M, "this would be right without stiffness."),
            (
                M + K / omega**2,
                "mind the sign: along a sine, acceleration has the opposite sign of position.",
            ),
        )
        return Exercise(
            "number",
            M - K / omega**2,
            "stiffness hides inertia, and most of it on slow motions.",
            slips,
            "put q = sin(ωt) into K q + M q̈ and divide by q̈.",
            unit="kg m²",
        )
    elif number == 3:
        weights, slope, window, torque, x, M = given
        alone = weights @ x**2 / 2
        mass = slope * alone * window / torque
        slips = (
            (M, "this is the whole network. Leave the hidden units out."),
            (M - mass, "this is what the hidden units have."),
            (alone * window / torque, "the output's slope passes on only a part of a change."),
            (slope * alone, "this is in scaled numbers. What are the gains of data for?"),
            (2 * mass, "the second moment counts half."),
        )
        return Exercise(
            "number",
            mass,
            f"the whole network has {M:.1f} kg m², so the hidden units have {M - mass:.1f}.",
            slips,
            "take the first part of the gradient, and its second moment.",
            unit="kg m²",
            tolerance=5e-3,
        )
    else:
        (x,) = given
        moments = np.array([x**0, x, x**2 / 2])
        least = np.linalg.pinv(moments) @ np.array([0.0, 3.0, 2.0])

        def fits(g):
            return np.allclose(moments @ g, [0, 3, 2], atol=1e-3)

        return Exercise(
            "array",
            lambda g: fits(g) and np.sum(np.square(g)) < 1.001 * least @ least,
            "your filter has the three moments with the least energy.",
            [(fits, "the moments are right, but a filter of less energy has them as well.")],
            "your filter must have the moments K = 0, B = 3 and M = 2.",
            count=x.size,
        )


check = judging(_exercise)
