"""*Learning in the loop*: its results seed by seed, in mm; its numbers, figures, and checks."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, MaxNLocator
from scipy.signal import butter, cont2discrete, lfilter, sosfiltfilt

from ddlib.dynamics import CMU_DD_ARM_II, PUMA_560, count_operations, newton_euler
from ddlib.figures import FAINT, INK, Illustration, check_label, illustrate, legend_above, looks
from ddlib.setups import KD, KP
from ddlib.simulation import CONTROL_STEP
from ddlib.tables import Table, quote, significant, spread
from ddlib.trajectories import APPENDIX_I, smooth_pick_and_place
from workshop.chapters.exercises import Exercise, judging
from workshop.report import results
from workshop.report.evidence.verdicts import Measured

PLAIN = "no feedforward"  # the feedback alone, as the study calls it

# The shoulder of the stretched arm under state feedback, and a memory that learns its torque
_INERTIA = CMU_DD_ARM_II.mass_matrix([0.0, 0.0])[0, 0]  # kg m^2
_SPRING, _DAMPER, _FRICTION = KP[0], KD[0], 0.5  # N m/rad, N m s/rad
_RATE = 0.3
_MEMORIES = {  # lead in control periods, cut-off of the Q-filter in rad/s
    "no lead": (0, None),
    "lead of 50 ms": (25, None),
    "lead and Q-filter": (25, 40.0),
}

_MARKERS = "os^DvPX"
_PLAIN = FuncFormatter(lambda value, place: f"{value:g}")
_ONE_MOTION = ("exact terms", "generic terms", "linear filter", "network, last layer", "memory")
_WHEN = ("before the load", "with the load", "at the end", "without the load again")
_NOTHING = ("last layer", "linear filter", "replay", "one pass", "by feedback")
_TRAINED = {
    "left as it is": "off-line, as it is",
    "last layer": "off-line, last layer",
    "replay": "off-line, replay",
    "by feedback": "off-line, by feedback",
}  # networks of Table 4-1 that go on learning, as the figure calls them


def _by_trial(
    panels: dict[str, dict[str, tuple]],
    labels: tuple[str, str],
    alt: str,
    *,
    change: tuple[float, str] | None = None,  # where a dotted line stands, and what is said there
    x_log: bool = False,
) -> Illustration:
    """Errors over trials, or over a rate, logarithmic: medians, and the middle half of the seeds.

    Of ``{title: {learner: (x, errors)}}``, errors of shape (points, seeds), the first learner of
    each panel is in the page's ink: what the others are compared with.
    """
    first = {next(iter(learners)) for learners in panels.values()}
    names = [n for each in panels.values() for n in each]
    tones = looks(names, dict.fromkeys(first, "measured"))
    markers = dict(zip((name for name in tones if name not in first), _MARKERS))

    def draw(figure: Figure):
        axes = figure.subplots(len(panels), 1, sharex=True, sharey=True, squeeze=False)[:, 0]
        for axis, (title, learners) in zip(axes, panels.items()):
            axis.set(yscale="log", xscale="log" if x_log else "linear")
            axis.set_title(title, loc="left")
            for name, (x, errors) in learners.items():
                colour, marker = tones[name].colour, markers.get(name)
                low, middle, high = np.percentile(errors, (25, 50, 75), axis=1)
                axis.fill_between(x, low, high, color=colour, alpha=0.15, lw=0)
                look = {"marker": marker, "ms": 4} if marker else {"ls": "--"}
                axis.plot(x, middle, color=colour, lw=1.6, label=name, **look)
            if change:
                axis.axvline(change[0], color=FAINT, ls=":", lw=1.2)
                axis.annotate(
                    change[1], (change[0], 0.97), xycoords=("data", "axes fraction"), fontsize=8,
                    xytext=(3, 0), textcoords="offset points", va="top", color=FAINT,
                )  # fmt: skip
            axis.legend(
                loc="center left", bbox_to_anchor=(1.0, 0.5), fontsize=8, labelcolor="linecolor"
            )
            axis.set_ylabel(check_label(labels[1]))
            axis.yaxis.set_major_formatter(_PLAIN)
        axes[-1].xaxis.set_major_formatter(_PLAIN)
        if not x_log:
            axes[-1].xaxis.set_major_locator(MaxNLocator(integer=True))
        axes[-1].set_xlabel(check_label(labels[0]))

    return illustrate(draw, alt, 6.4, 1.8 * len(panels) + 0.4)


def motions_figure() -> Illustration:
    """Errors while one motion is practised, and then on others over that of the feedback alone."""
    motions = list(part("motion")["tests"])[1:]
    tones = looks(["measured", *_ONE_MOTION])  # ink is the feedback alone

    def draw(figure: Figure):
        left, right = figure.subplots(1, 2, width_ratios=(1, 1.25))
        alone = np.median(on("the same", PLAIN))
        left.axhline(alone, color=INK, ls="--", lw=1.2, label="feedback alone")
        right.axvline(1.0, color=INK, ls="--", lw=1.2)
        for k, name in enumerate(_ONE_MOTION):
            look = {"color": tones[name].colour, "marker": _MARKERS[k], "ms": 4}
            course = np.median(part("motion")["practice"][name], axis=1)
            left.plot(1 + np.arange(len(course)), course, lw=1.5, label=name, **look)
            for row, motion in enumerate(motions):
                ratio, place = on(motion, name) / on(motion, PLAIN), row + 0.14 * (k - 2)
                right.plot(
                    [ratio.min(), ratio.max()], [place] * 2, color=tones[name].colour, lw=1.2
                )
                right.plot(np.median(ratio), place, **look)
        left.set(yscale="log", xlabel="trial of one motion", ylabel="end-point error, mm")
        right.set(xscale="log", xlabel="error, over the feedback's alone")
        left.yaxis.set_major_formatter(_PLAIN)
        right.xaxis.set_major_formatter(_PLAIN)
        left.xaxis.set_major_locator(MaxNLocator(integer=True))
        right.set_yticks(range(len(motions)), motions)
        right.set_ylim(len(motions) - 0.5, -0.5)
        right.grid(visible=False, axis="y")
        legend_above(figure, *left.get_legend_handles_labels())

    medians = "; ".join(
        f"{m}: " + ", ".join(f"{n} {np.median(on(m, n) / on(m, PLAIN)):.2g}" for n in _ONE_MOTION)
        for m in motions
    )
    alt = (
        f"Errors over ten trials of one motion; then medians over the feedback's alone, {medians}."
    )
    return illustrate(draw, alt, 7.2, 3.1)


def course_figure() -> Illustration:
    """Errors on fixed members of the family, trial by trial, with a load from half-way on."""
    study = results.read("learning-in-the-loop")
    x, number = np.arange(2 * study["trials"] + 1), study["trials"]

    def course(name):
        return x, np.array([*part("family")["tests"][name], part("family")["at the end"][name]])

    panels = {
        title: {PLAIN: course(PLAIN)} | {short: course(name) for short, name in named.items()}
        for title, named in (
            ("from nothing", dict(zip(_NOTHING, _NOTHING))),
            ("from networks trained off-line", _TRAINED),
        )
    }
    medians = ", ".join(f"{n} {np.median(family(n, _WHEN[0])):.1f}" for n in _NOTHING)
    later = ", ".join(f"{n} {np.median(family(k, _WHEN[2])):.1f}" for n, k in _TRAINED.items())
    alt = (
        "Two panels of end-point error over trials on a logarithmic axis, with the load "
        f"from half-way on. Medians after {number} trials from nothing, mm: {medians}. At the "
        f"end, from networks trained off-line: {later}."
    )
    labels = "trials practised", "end-point error, mm"
    return _by_trial(panels, labels, alt, change=(number, f"{study['load']:.0f} kg in the hand"))


def rates_figure() -> Illustration:
    """Errors of feedback-error learning over its rate."""
    rates = np.array(results.read("learning-in-the-loop")["rates"])
    panels = {}
    for setup in ("joint damping", "state feedback"):
        alone, by_learner = on("the same", PLAIN, setup), part("rates", setup)
        panels[setup] = {PLAIN: (rates, np.tile(alone, (len(rates), 1)))} | {
            name.partition(",")[0]: (rates, np.array(x["error"])) for name, x in by_learner.items()
        }
    medians = "; ".join(
        f"{s}: " + ", ".join(f"{n} {np.median(y[-1]):.2g}" for n, (_, y) in p.items())
        for s, p in panels.items()
    )
    alt = (
        "Two panels of error over the rate, both logarithmic. Medians in mm at the largest "
        f"rate, {medians}."
    )
    labels = "multiple of the rate chosen", "end-point error, mm"
    return _by_trial(panels, labels, alt, x_log=True)


def _missing(lead: int, cut: float | None) -> np.ndarray:
    """Missing torque by trial, N m RMS, while the shoulder alone learns one motion by a memory."""
    held = cont2discrete(
        ([_DAMPER, _SPRING], [_INERTIA, _FRICTION + _DAMPER, _SPRING]), CONTROL_STEP
    )
    answer = held[0].ravel(), held[1]  # from the torque that is missing to the feedback's
    motion = smooth_pick_and_place(APPENDIX_I[0], np.arange(1500) * CONTROL_STEP)
    rubbing = 0.5 * np.tanh(motion.qd[:, 0] / 0.05)
    needed = _INERTIA * motion.qdd[:, 0] + _FRICTION * motion.qd[:, 0] + rubbing
    stored, missing = 0 * needed, []
    for _ in range(100):
        missing.append(np.sqrt(((needed - stored) ** 2).mean()))
        feedback = lfilter(*answer, needed - stored)
        stored[: len(stored) - lead] += _RATE * feedback[lead:]
        if cut:
            low = butter(2, cut * CONTROL_STEP / np.pi, output="sos")
            stored = sosfiltfilt(low, stored)
    return np.array(missing)


def converges_figure() -> Illustration:
    """What a trial multiplies a missing torque with, over its frequency; and a hundred trials."""
    omega = np.geomspace(1, 200, 400)
    factor, missing = {}, {}
    for name, (lead, cut) in _MEMORIES.items():
        spring = _SPRING + 1j * omega * _DAMPER
        answer = spring / (spring - _INERTIA * omega**2 + 1j * omega * _FRICTION)
        size = abs(1 - _RATE * answer * np.exp(1j * omega * lead * CONTROL_STEP))
        factor[name] = size / (1 + (omega / cut) ** 4) if cut else size  # there and back
        missing[name] = _missing(lead, cut)

    def draw(figure: Figure):
        over, course = figure.subplots(1, 2)
        for name, look in looks(_MEMORIES).items():
            over.plot(omega, factor[name], label=name, **look.line)
            course.plot(1 + np.arange(100), missing[name], **look.line)
        over.axhline(1.0, color=INK, ls="--", lw=1.2)
        over.axvline(np.sqrt(_SPRING / _INERTIA), color=FAINT, ls=":", lw=1.2)
        over.set(xscale="log", xlabel="frequency, rad/s", ylabel="factor of a trial")
        course.set(yscale="log", xlabel="trial", ylabel="missing torque, N m RMS")
        for axis in (over.xaxis, course.yaxis):
            axis.set_major_formatter(_PLAIN)
        legend_above(figure, *over.get_legend_handles_labels())

    factors = "; ".join(
        f"{n} {y.min():.2g} at best, {y[-1]:.2g} at last" for n, y in missing.items()
    )
    alt = (
        f"Factor of a trial over frequency, and the missing torque over 100 trials, N m: {factors}."
    )
    return illustrate(draw, alt, 7.2, 2.9)


def part(name: str, setup: str = "joint damping") -> dict:
    """The study's "motion", "family" or "rates" under a reading of the controller."""
    return results.read("learning-in-the-loop")["setups"][setup][name]


def on(
    motion: str, learner: str, setup: str = "joint damping", learning: bool = False
) -> np.ndarray:
    """End-point errors on a motion after practice of another one, one for each seed.

    With `learning` it goes on learning during this one trial.
    """
    errors = part("motion", setup)["tests"][motion]
    if learner not in errors:
        errors = errors["learning" if learning else "frozen"]
    return np.array(errors[learner])


def family(learner: str, when: str, setup: str = "joint damping") -> np.ndarray:
    """End-point errors on the family's test motions, one for each seed."""
    errors, trials = part("family", setup), results.read("learning-in-the-loop")["trials"]
    if when in ("at the end", "without the load again"):
        return np.array(errors[when][learner])
    return np.array(errors["tests"][learner])[trials if when == "with the load" else trials - 1]


def _trials_to_half(errors, start) -> np.ndarray:
    """Trials after which errors, ``(trials, seeds)``, stay at half of a first value or below."""
    above = np.asarray(errors) > 0.5 * np.asarray(start)
    last = np.array([np.flatnonzero(each)[-1] if each.any() else -1 for each in above.T])
    return np.where(last == len(above) - 1, np.inf, last + 1.0)


def halved(learner: str, loaded: bool = False, setup: str = "joint damping") -> Measured:
    """Trials of the family to half the error of the feedback alone, or of the first loaded one."""
    number = results.read("learning-in-the-loop")["trials"]
    of_family = part("family", setup)
    errors = np.array(of_family["tests"][learner])
    if loaded:
        errors = np.concatenate([errors[number:], [of_family["at the end"][learner]]])
        start = errors[0]
    else:
        errors, start = errors[:number], np.array(of_family["tests"][PLAIN])[0]
    counts = _trials_to_half(errors, start)
    got = np.isfinite(counts).sum()
    text = f"{spread(counts)}, {got} of {counts.size} seeds" if got else "no seed"
    return Measured(float(np.median(counts)), text)


def multiplications(hidden: int = 10, inputs: int = 42, every: int = 5, replay: int = 15) -> dict:
    """Multiplications of the torque and of each way to learn, in a control period on average."""
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
    """Multiplications of torque and learning over what 1986 did in a control period."""
    each = multiplications()
    total = each["torque"] + (each[learner] if learner != "torque" else 0.0)
    could = count_operations(newton_euler, PUMA_560, "arm").multiplications * 2.0 / 1.2
    return Measured(total / could, f"{total:,.0f} of {could:,.0f} in 2 ms")


def courses() -> Table:
    """Median errors in the first trial, and on the family before, with and after the load."""
    names = {"feedback alone": PLAIN, "network's last layer": "last layer"}
    names |= {n: n for n in ("linear filter", "by feedback")}
    names |= {f"trained off-line, {n}": n_ for n, n_ in _TRAINED.items() if n != "replay"}
    rows = []
    for name, key in names.items():
        first = np.median(part("family")["practice"][key][0])
        cells = [first, *(np.median(family(key, when)) for when in _WHEN)]
        rows.append((name, *(significant(cell, 2) for cell in cells)))
    heads = "first trial", "ten trials later", "load comes", "ten trials later", "load goes"
    return Table(("error, mm", *heads), rows)


def _quoted() -> None:
    """The numbers of the prose."""
    quote("loop-seeds", on("the same", PLAIN).size)
    quote("loop-none-circle", np.median(on("circle", PLAIN)))
    again = results.read("loop-conditions")["practised"]["joint damping"]["in step"]
    quote("loop-memory-scaled", np.median(again["in half the time"]["memory, scaled"]))
    quote("loop-none-faster", np.median(on("in half the time", PLAIN)))
    quote("loop-linear-circle", np.median(on("circle", "linear filter")))
    practised = results.read("loop-conditions")["practised"]["joint damping"]
    quote("loop-step", np.median(practised["out of step"]["circle"]["linear filter"]))
    quote("loop-layer-affordable", affordable("last layer").value)
    share = _DAMPER * (_FRICTION + _DAMPER) / (_SPRING * _INERTIA)
    quote("loop-real-share", share)
    quote("loop-real-until", 1 / np.sqrt(1 - share))


def _exercise(number: int, *given) -> Exercise:
    """An exercise of the lesson."""
    if number == 1:
        M, F, k, gamma = given
        size = gamma * np.sqrt(k * M) / F
        wrong = "G is imaginary there: what is the size of 1 - γ G?"
        slips = [(1 - size, wrong), (1 + size, wrong), (1 + size**2, "that is the square.")]
        reason = "above 1, whatever the rate: the resonance grows from trial to trial."
        return Exercise("number", np.sqrt(1 + size**2), reason, slips, "Put ω² = k / M into G.")
    elif number == 2:
        (quick,) = given

        def right(rate):
            return all(third < alone / 30 for alone, third in quick(float(rate)))

        reason = "all three motions are learnt in two trials."
        return Exercise(
            "number", right, reason, [], "some motion has more than a thirtieth left. Try another."
        )
    else:
        (torque,) = given
        slips = [(1, "it plays something."), (0, "it plays the old torque, with the old sign.")]
        reason = f"found {torque:.2f}. What was missing is missing twice."
        return Exercise(
            "number", torque, reason, slips, "What is missing, and what is played?", 0.15
        )


check = judging(_exercise)
