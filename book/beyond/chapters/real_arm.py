"""*Real arms*: the lesson's numbers, figures and judges; what the result "real-arm" holds.

Errors are mean squares over five blocks and six joints, in deviations of the whole recording. The
arm that swings has its measures in `real_two_link_arm`.
"""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from beyond.chapters import real_two_link_arm as swinging
from beyond.studies.tx40 import Windowed, identified
from ddlib import paper
from ddlib.analysis import CLASSES
from ddlib.figures import FAINT, INK, Illustration, check_label, illustrate, legend_above, looks
from ddlib.identification import joint_terms
from ddlib.learning import p_value
from ddlib.tables import quote, significant
from workshop.chapters.exercises import Between, Exercise, judging
from workshop.report import results
from workshop.report.evidence.verdicts import Measured, judged, mean, median

# from the configuration of the TX40's source
REDUCTION = (32.0, 32.0, 45.0, -48.0, 45.0, 32.0)  # turns of a motor; motor 6 turns joint 5, too
COULOMB = (7.14, 8.26, 6.34, 2.48, 3.03, 0.28)  # friction of the joints, N m

_RATE = 100  # samples a second of the paper, and of all rows that name no other

_NAMED = ("velocity", "acceleration", "velocity + acceleration")  # filters that the paper finds

# Gains of a network, and what the identified model has in their place
WORTH = {"inertia": ("acceleration", "inertia"), "friction": ("velocity", "slope")}

_UNITS = {"inertia": "A s²/rad", "friction": "A s/rad"}


def gains_by_joint(panels: dict[str, tuple], label: str, alt: str) -> Illustration:
    """Gains of networks over the arm's, joint by joint, beside those on unrelated currents.

    Of ``{title: (real, unrelated)}``, shape (networks, joint), as multiples of the identified
    value, every real one is a dot; a bar holds the middle nine tenths of the others.
    """

    def draw(figure: Figure):
        axes = figure.subplots(1, len(panels), squeeze=False, sharey=True)[0]
        for axis, (title, (real, unrelated)) in zip(axes, panels.items()):
            place = np.arange(1, np.shape(real)[1] + 1)
            low, high = np.percentile(unrelated, (5, 95), axis=0)
            axis.bar(
                place, high - low, 0.55, low, color=FAINT, alpha=0.4, label="unrelated currents"
            )
            axis.axhline(1, color=INK, ls="--", lw=1, label="as identified")
            for k, gains in enumerate(real):
                x = place + 0.3 * (k / max(len(real) - 1, 1) - 0.5)
                name = "real currents" if k == 0 else None
                axis.plot(x, gains, "o", color=INK, ms=3.5, mew=0, alpha=0.8, label=name)
            axis.set(title=title, xticks=place)
            axis.grid(visible=False, axis="x")
        axes[0].set_ylabel(check_label(label))
        figure.supxlabel("joint")
        handles = axes[0].get_legend_handles_labels()
        figure.legend(*handles, loc="outside upper left", ncols=3)

    return illustrate(draw, alt, 5.4, 3.0)


def _cell(width: int, rate: int = _RATE) -> dict:
    """What the grid has for a window and a rate."""
    grid = results.read("real-arm")["grid"]
    (row,) = [r for r in grid if (r["width"], r["rate"]) == (width, rate)]
    return row


def squares(width: int, model: str = "network", rate: int = _RATE) -> np.ndarray:
    """Mean squared errors of a model of the grid, ``(blocks, networks)``; others stand alone."""
    errors = np.array(_cell(width, rate)[model])
    return errors if model.startswith("network") else errors[:, None]


def rms(cell) -> np.ndarray:
    """Root of the mean square, over blocks and networks, one for each draw."""
    return np.sqrt(cell.mean((-2, -1)))


def variant(name: str, side: str = "test") -> np.ndarray:
    """Mean squared errors of window 21 with one thing changed, ``(blocks, networks)``."""
    return np.array(results.read("real-arm")["variants"][name][side])


def _row(width: int) -> dict:
    """Networks of a window on the whole recording, and on unrelated currents."""
    return results.read("real-arm")["windows"][str(width)]


def _members(width: int, name: str) -> tuple[np.ndarray, list[np.ndarray]]:
    """An entry of the networks, and of each kind of nulls."""
    row = _row(width)
    return np.array(row["real"][name]), [np.array(x[name]) for x in row["nulls"].values()]


def _gains(what: str, width: int) -> tuple[np.ndarray, np.ndarray, list[np.ndarray]]:
    """What a gain is in the identified model, in the networks, and in each kind of nulls."""
    name, wanted = WORTH[what]
    return np.array(_row(width)["identified"][wanted]), *_members(width, name)


def named(ensemble: dict) -> np.ndarray:
    """Share of an ensemble's filters that have one of the names in `_NAMED`."""
    which = [CLASSES.index(name) for name in _NAMED]
    hidden, direct = (
        np.array(ensemble["classes"][x])[:, which].sum(-1) for x in ("hidden", "direct")
    )
    return (paper.HIDDEN_UNITS * hidden + 6 * direct) / (paper.HIDDEN_UNITS + 6)


def excess(width: int = 21) -> Measured:
    """Share of velocity and acceleration filters, less the most that a kind of nulls gives."""
    row = _row(width)
    real, nulls = named(row["real"]), {n: named(x) for n, x in row["nulls"].items()}
    of_nulls = "; ".join(
        f"{n} {100 * x.mean():.0f} % (p {p_value(real.mean(), x, 'more'):.2f})"
        for n, x in nulls.items()
    )
    before = 100 * named(row["untrained"]).mean()
    return judged(
        lambda one, *others: mean(one) - np.max([mean(x) for x in others], axis=0),
        real,
        *nulls.values(),
        text=f"{100 * real.mean():.0f} %; {of_nulls}; untrained {before:.0f} %",
    )


def _off(gains, true) -> np.ndarray:
    """How far the median gains are from the arm's, in the worst joint."""
    return np.abs(np.median(gains, axis=-2) / true - 1).max(-1)


def calibrated(what: str = "inertia", width: int = 21) -> Measured:
    """How far gains on a joint's own motion are from the arm's, in the worst joint."""
    true, real, nulls = _gains(what, width)
    typical = np.median(_off(real[:, None], true))  # of one network, as each of the nulls is
    chance = max(p_value(typical, _off(x[:, None], true), "less") for x in nulls)
    pairs = zip(np.median(real, 0), true)
    compared = ", ".join(f"{significant(a, 2)} for {significant(b, 2)}" for a, b in pairs)
    text = f"{compared} {_UNITS[what]} at joints 1 to 6; as near by chance: p {chance:.2f}"
    return judged(lambda each: _off(each, true), real, text=text)


def _pearson(a, b) -> np.ndarray:
    a, b = (x - x.mean(-1, keepdims=True) for x in (np.asarray(a), np.asarray(b)))
    size = np.linalg.norm(a, axis=-1) * np.linalg.norm(b, axis=-1)
    return (a * b).sum(-1) / np.where(size > 0, size, 1)


def beyond_null(what: str = "friction", width: int = 11) -> Measured:
    """At how many joints the typical gain is nearer the identified one than 19 of 20 nulls."""
    true, real, nulls = _gains(what, width)
    edge = np.min([np.percentile(np.abs(x / true - 1), 5, axis=0) for x in nulls], axis=0)

    def joints(drawn):
        return (np.median(np.abs(drawn / true - 1), axis=-2) < edge).sum(-1)

    off = np.median(np.abs(real / true - 1), 0)
    compared = ", ".join(f"{100 * a:.0f} % ({100 * b:.0f} %)" for a, b in zip(off, edge))
    return judged(joints, real, text=f"off by {compared} at joints 1 to 6, in brackets by chance")


def follow(what: str = "friction", width: int = 11) -> Measured:
    """Correlation over joints of gains with identified values, less that by chance (95 %)."""
    unit = np.array(_row(width)["deviations"][WORTH[what][0]])
    true, real, nulls = _gains(what, width)
    true, real = true * unit, real * unit
    chance = max(float(np.percentile(_pearson(x * unit, true), 95)) for x in nulls)
    r = np.median(_pearson(real, true))
    return judged(
        lambda drawn: np.median(_pearson(drawn, true), axis=-1) - chance,
        real,
        text=f"r {r:.2f}; unrelated currents reach {chance:.2f} in one of twenty",
    )


def unique_beyond(what: str = "velocity", width: int = 21) -> Measured:
    """At how many joints the own filter follows a quantity more than 19 of 20 nulls."""
    real, nulls = _members(width, f"unique {what}")
    edge = np.max([np.percentile(x, 95, axis=0) for x in nulls], axis=0)
    pairs = zip(np.median(real, 0), edge)
    compared = ", ".join(f"{100 * a:.0f} ({100 * b:.0f})" for a, b in pairs)
    return judged(
        lambda drawn: (np.median(drawn, axis=-2) > edge).sum(-1),
        real,
        text=f"{compared} % at joints 1 to 6, in brackets by chance",
    )


def shares_follow(width: int = 21) -> Measured:
    """Correlation over joints of velocity's share in the own filter and friction's in current."""
    true, (real, nulls) = np.array(_row(width)["friction"]), _members(width, "share of velocity")
    r = float(_pearson(np.median(real, 0), true))
    typical = np.median(_pearson(real, true))  # of one network, as each of the nulls is
    chance = max(p_value(typical, _pearson(x, true), "more") for x in nulls)
    text = f"r {r:.2f}; as high by chance: p {chance:.2f}"
    return judged(lambda drawn: _pearson(np.median(drawn, axis=-2), true), real, text=text)


def compensate_friction(width: int = 21) -> Measured:
    """Share of the hidden units' non-linear part that friction and rigid body explain."""
    row = _row(width)
    curved = np.array(row["curved"])
    medians = ", ".join(significant(x, 2) for x in np.median(curved, 0))
    nulls = [np.median(x["curved"], axis=-1) for x in row["nulls"].values()]
    chance = max(float(np.percentile(x, 95)) for x in nulls)
    text = f"R² {medians} at joints 1 to 6; unrelated currents reach {chance:.2f} in one of twenty"
    return judged(median, curved, text=text)


# --- the lesson -----------------------------------------------------------------------------

_ALIKE = {
    "network": "network",
    "linear filter": "linear",
    "network, by joint": "network-own",
    "linear filter, by joint": "linear-own",
    "equations": "equations",
}
"""Models that were tuned alike, and their names in the prose."""


def _alike() -> dict[str, float]:
    """Errors of the models that were tuned alike, all blocks together."""
    models = results.read("real-arm-wired")["models"]
    return {name: float(rms(np.array(models[name]["test"]))) for name in _ALIKE}


def coulomb_apart() -> float:
    """How far newton metres for an ampere of Coulomb friction are apart at joints 1 to 5."""
    data = Windowed.of(_RATE, 11)
    friction = identified(data.states, data.current).coulomb
    ratio = (np.array(COULOMB) / np.abs(REDUCTION) / friction)[:5]
    return float(ratio.max() / ratio.min() - 1)


def viscosity(arm: str, name: str) -> np.ndarray:
    """What a joint's window reads over the viscous friction, median over parts left out."""
    parts = results.read("viscosity")[arm]
    return np.median([[joint["read"][name] for joint in part] for part in parts], axis=0)


def left_out_squares(arm: str, name: str) -> np.ndarray:
    """Squared errors of a model on parts that were left out, ``(parts, joints)``."""
    parts = results.read("viscosity")[arm]
    return np.array([[joint["errors"][name] for joint in part] for part in parts])


def _quoted() -> None:
    """The numbers of the prose."""
    alike = _alike()
    for name, short in _ALIKE.items():
        quote(f"real-alike-{short}", alike[name])
    friction = 100 * np.array(_row(11)["friction"])
    quote("real-friction-least", friction.min())
    quote("real-friction-most", friction.max())
    quote("real-coulomb-off", 100 * coulomb_apart())
    quote("real-inertia-joints", int(beyond_null("inertia").value))
    for model, short in (("network", "network"), ("ridge", "linear"), ("identified", "equations")):
        best = min(rms(squares(width, model)) for width in (5, 11, 21, 41, 81))
        quote(f"real-best-{short}", best)
    unrelated = min(named(x).mean() for x in _row(21)["nulls"].values())
    quote("real-names-times", unrelated / named(_row(21)["real"]).mean())
    read = _row(21)["real"]["velocity"] / np.array(_row(21)["identified"]["viscous"])
    ranges = {"network": np.median(read, 0)}
    ranges |= {"kr": viscosity("KR 300", "measured"), "kr-none": viscosity("KR 300", "no viscous")}
    for name, by_joint in ranges.items():
        quote(f"viscosity-{name}-least", by_joint.min())
        quote(f"viscosity-{name}-most", by_joint.max())
    for arm, short in (("KR 300", "kr"), ("TX40", "tx")):
        plain, signs = (
            left_out_squares(arm, name) for name in ("window", "window and three signs")
        )
        quote(f"viscosity-{short}-better", int((signs < plain).sum()))
        quote(f"viscosity-{short}-all", plain.size)
    for name, value in swinging.numbers().items():
        quote(f"two-{name}", value)


def parts_figure() -> Illustration:
    """The current of joint 2 and three parts of it, without their names."""
    data, joint = Windowed.of(_RATE, 11), 2
    row, current = joint_terms(data.states)[joint], data.current[:, joint]
    a = np.stack(list(row.values()), -1)
    size = np.sqrt((a**2).mean(0))
    terms = a / size * np.linalg.lstsq(a / size, current, rcond=1e-8)[0]
    rubs = np.array([name.startswith(("velocity", "sign")) for name in row])
    weighs = np.array([name.startswith(_WEIGHT) and "q1'" not in name for name in row])
    kinds = {"A": ~rubs & ~weighs, "B": rubs, "C": weighs}
    parts = {name: terms[:, kind].sum(1) for name, kind in kinds.items()}
    time = 0.01 * np.arange(len(current))
    turns = time[1:][np.diff(np.sign(data.states[:, joint, 1])) != 0]

    def draw(figure: Figure):
        axis = figure.subplots()
        for turn in turns[turns < _MOVES]:
            axis.axvline(turn, color=FAINT, lw=0.8, ls=":")
        axis.plot(time, current, color=INK, lw=3, alpha=0.4, label="measured")
        for name, part in parts.items():
            axis.plot(time, part, lw=1.6, label=name, **looks(parts)[name].line)
        axis.set(xlabel="time, s", ylabel="current, A", xlim=(0, _MOVES))
        legend_above(figure, *axis.get_legend_handles_labels())

    alt = (
        "Current of joint 2 over time. Part B jumps wherever the joint turns back, part A swings "
        "smoothly and fast, part C slowly."
    )
    return illustrate(draw, alt, 7.0, 2.8)


_WEIGHT = ("cos(q2)", "sin(q2)", "cos(q2 + q3)", "sin(q2 + q3)", "offset")
_MOVES = 7.2  # seconds for which the arm moves


def _exercise(number: int, *given) -> Exercise:
    """An exercise of the lesson."""
    if number == 1:
        at_random, error, model = given
        slips = [
            (Between(0.6 * error(model), 1.4 * error(model)), "so large it is by blocks."),
            (Between(0.8, 1.2), "a constant does as well as that."),
        ]
        right = Between(0.5 * at_random(model), 1.7 * at_random(model))
        reason = "the neighbours of each window were learnt, so it says little about other motions."
        return Exercise(
            "number", right, reason, slips, "How much of a window do its neighbours share?"
        )
    elif number == 2:
        fitted, error = given

        def few(columns):
            many = sum(columns(j).shape[1] for j in range(6))
            return many <= 30 and error(fitted(columns)) <= 0.25

        reason = "friction, inertia and weight are enough, without coupling or centrifugal torque."
        return Exercise(
            "function",
            few,
            reason,
            [],
            "There are more than 30 numbers, or the error is above 0.25.",
        )
    elif number == 3:
        slips = [
            (0.25, "the noise adds to the variance; it is not a share of the sum."),
            (3, "it is the other way round."),
        ]
        return Exercise(
            "number", 1 / 3, "gravity shrinks with inertia.", slips, "Solve v / (v + n) = 0.75."
        )
    else:
        (gravity,) = given

        def near(pair):
            off = [np.abs(gravity(*pair, design) - 1).max() for design in ("A0", "C0", "C1")]
            return max(off) < 0.07

        reason = "both kinds of smoothing share the work."
        return Exercise(
            "numbers",
            near,
            reason,
            [],
            "One design is more than 7 % off. Which window smooths what?",
            count=2,
            whole=True,
        )


check = judging(_exercise)
