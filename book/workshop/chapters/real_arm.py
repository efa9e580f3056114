"""*A real arm*: the lesson's numbers, figure and judges; what the result "real-arm" holds.

Errors are mean squares over five blocks and six joints, in deviations of the whole recording.
"""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from ddlib import paper
from ddlib.analysis import CLASSES
from ddlib.figures import COLOURS, FAINT, INK, Illustration, check_label, illustrate
from ddlib.learning import p_value
from ddlib.tables import quote, significant
from workshop.chapters.exercises import Between, judge
from workshop.report import results
from workshop.report.evidence.statements import stated
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
                axis.plot(x, gains, "o", color=COLOURS[0], ms=3.5, mew=0, alpha=0.8, label=name)
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
    found = _row(width)
    return np.array(found["real"][name]), [np.array(x[name]) for x in found["nulls"].values()]


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
    found = _row(width)
    real, nulls = named(found["real"]), {n: named(x) for n, x in found["nulls"].items()}
    told = "; ".join(
        f"{n} {100 * x.mean():.0f} % (p {p_value(real.mean(), x, 'more'):.2f})"
        for n, x in nulls.items()
    )
    before = 100 * named(found["untrained"]).mean()
    return judged(
        lambda one, *others: mean(one) - np.max([mean(x) for x in others], axis=0),
        real,
        *nulls.values(),
        text=f"{100 * real.mean():.0f} %; {told}; untrained {before:.0f} %",
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
    told = ", ".join(f"{significant(a, 2)} for {significant(b, 2)}" for a, b in pairs)
    text = f"{told} {_UNITS[what]} at joints 1 to 6; as near by chance: p {chance:.2f}"
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
    told = ", ".join(f"{100 * a:.0f} % ({100 * b:.0f} %)" for a, b in zip(off, edge))
    return judged(joints, real, text=f"off by {told} at joints 1 to 6, in brackets by chance")


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
    told = ", ".join(f"{100 * a:.0f} ({100 * b:.0f})" for a, b in pairs)
    return judged(
        lambda drawn: (np.median(drawn, axis=-2) > edge).sum(-1),
        real,
        text=f"{told} % at joints 1 to 6, in brackets by chance",
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
    found = _row(width)
    curved = np.array(found["curved"])
    told = ", ".join(significant(x, 2) for x in np.median(curved, 0))
    nulls = [np.median(x["curved"], axis=-1) for x in found["nulls"].values()]
    chance = max(float(np.percentile(x, 95)) for x in nulls)
    text = f"R² {told} at joints 1 to 6; unrelated currents reach {chance:.2f} in one of twenty"
    return judged(median, curved, text=text)


# --- the lesson -----------------------------------------------------------------------------

_ALIKE = {
    "network": "network, all windows",
    "linear filter": "linear, all windows",
    "network, by joint": "network, own window",
    "linear filter, by joint": "linear, own window",
    "equations": "equations",
}


def _alike() -> dict[str, np.ndarray]:
    """Mean squared errors ``(blocks, networks)`` of the models that were tuned alike."""
    models = results.read("real-arm-wired")["models"]
    return {name: np.array(models[name]["test"]) for name in _ALIKE}


def _closed() -> float:
    """Share of the network's gap to the equations that the wiring closes."""
    every, own, least = (rms(_alike()[n]) for n in ("network", "network, by joint", "equations"))
    return float((every - own) / (every - least))


def _quoted() -> None:
    """The numbers of the prose."""
    for name, each in _alike().items():
        quote("real-alike-" + name.replace(", by joint", "-own").replace(" filter", ""), rms(each))
    quote("real-alike-closed", 100 * _closed())
    rest = results.read("real-arm-wired")["rest"]
    quote("real-still", 100 * rest[-1])
    quote("real-still-others", 100 * max(rest[:-1]))
    for what, each in results.read("learnt-filters")["real"]["100, 5"].items():
        if what in ("equations", "learnt"):
            quote(f"real-front-{what}", np.sqrt(np.mean(each)))
    friction = 100 * np.array(_row(11)["friction"])
    quote("real-friction-least", friction.min())
    quote("real-friction-most", friction.max())
    for what in WORTH:
        quote(f"real-{what}-joints", int(beyond_null(what).value))
    true, real, _ = _gains("inertia", 11)
    quote("real-inertia-off", 100 * _off(real, true))


def _said() -> None:
    """What stands behind words of the prose."""
    alike = {name: rms(each) for name, each in _alike().items()}
    stated("real-wired", bool(0.6 < _closed() < 0.73))
    own = alike["linear filter, by joint"], alike["network, by joint"]
    stated("real-wired-linear", bool(own[0] < 1.05 * own[1]))
    stated("real-friction-everywhere", bool(min(_row(11)["friction"]) > 0.5))
    best = {
        model: min(rms(squares(w, model)) for w in (5, 11, 21, 41, 81))
        for model in ("network", "ridge", "identified")
    }
    stated("real-network-loses", bool(best["network"] > best["ridge"] > best["identified"]))
    stated("real-decay", bool(rms(variant("decay 0.0001")) < rms(variant("decay 0"))))
    rest = min(rms(variant(f"on the rest, decay {decay}")) for decay in ("0.001", "0.01"))
    stated("real-nothing-learnt", bool(rest > 0.9 * rms(squares(21, "identified"))))
    stated("real-fewer-names", excess(21).replicates < 0)
    stated("real-tuned-turns", bool(alike["network"] < alike["linear filter"]))


def _wired_figure() -> Illustration:
    """Errors of models that were tuned alike, by block and together."""

    def draw(figure: Figure):
        axis = figure.subplots()
        for k, each in enumerate(_alike().values()):
            blocks = np.sqrt(each.mean(1))
            axis.plot(blocks[:-1], [k] * 4, "o", ms=5, color=COLOURS[0])
            axis.plot(blocks[-1], k, "o", ms=5, color=COLOURS[0], mfc="none")
            axis.plot(rms(each), k, "|", ms=20, mew=2.4, color=INK)
        axis.set(xscale="log", xlabel="error over the deviation")
        axis.set_yticks(range(len(_ALIKE)), _ALIKE.values())
        axis.set_xticks([0.1, 0.2, 0.5, 1], ["0.1", "0.2", "0.5", "1"])
        axis.minorticks_off()
        axis.invert_yaxis()

    told = ", ".join(f"{_ALIKE[name]} {rms(each):.2f}" for name, each in _alike().items())
    return illustrate(draw, f"Errors on blocks that were left out, pooled: {told}.", 7.0, 2.3)


def show(name: str) -> Illustration:
    """A figure of the lesson."""
    return {"wired": _wired_figure}[name]()


def check(number: int, mine, *given) -> None:
    """Judge an answer to an exercise of the lesson."""
    if number == 1:
        right = (0.065, -0.02, 0.06, -0.06, -0.045)
        slips = [((0.065, -0.02, 0.06, 0.06, -0.045), "2 sin a sin b is a difference of cosines."),
                 ((0.13, -0.04, 0.12, -0.12, -0.09), "a sine squared is (1 − cos)/2.")]  # fmt: skip
        judge(mine, right, "so the inertia has these four angles.", slips, "Expand the square.")
    elif number == 2:
        at_random, error, model = given
        near = lambda size: Between(0.6 * size, 1.4 * size)  # noqa: E731
        slips, right = [(near(error(model)), "so large it is by blocks.")], near(at_random(model))
        otherwise = "how much of a window do its neighbours share?"
        judge(mine, right, "and it says little about other motions.", slips, otherwise)
    elif number == 3:
        fitted, error = given

        def few(columns):
            many = sum(columns(j).shape[1] for j in range(6))
            return many <= 30 and error(fitted(columns)) <= 0.25

        judge(mine, few, "no coupling, no centrifugal torque.", [], "Too many, or too far off.")
    else:
        linear, error = given
        alone = {j: [j] for j in range(1, 7)}

        def better(wires):
            two = all(len(wires[j]) <= 2 for j in alone)
            return two and error(linear(wires)) < 0.95 * error(linear(alone))

        judge(mine, better, "these two share a load.", [], "Which two axes are parallel?")
