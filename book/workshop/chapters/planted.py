"""What networks of known torques show: shapes, sizes, answers to a knob; and what is written."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache

import numpy as np
from matplotlib.figure import Figure

from ddlib.figures.style import FAINT, INK, Illustration, illustrate
from ddlib.setups import INITIAL, JOINT_DAMPING, SETUPS, STATE_FEEDBACK, WINDOWS
from ddlib.tables import Table, how_many, quote
from workshop.report import results

KINDS = {
    "the arm": "the arm's own",
    "another arm along this motion": "another arm's",
    "position alone": "position alone",
    "velocity alone": "velocity alone",
    "shifted": "shifted in time",
    "random phases": "random phases",
}
"""Kinds of torques in the order of the figure, and what it calls them; with inertia first."""

_WITH_INERTIA = 2


@cache
def of_kinds(long: bool = True, reading: str = JOINT_DAMPING.name) -> Mapping[str, Mapping]:
    """Networks of each kind of torques from the book's start, by descent as long as the lessons'.

    Or, in the study with most networks, five times as `long`.
    """
    wanted = {"reading": reading, "width": 21, "initial": INITIAL}
    return _row("long" if long else "grid", wanted)["kinds"]


def _row(part: str, wanted: Mapping) -> Mapping:
    """The row of a part of the study with the wanted settings."""
    rows = results.read("planted")[part]
    (row,) = (x for x in rows if {k: x["setting"].get(k) for k in wanted} == wanted)
    return row


def _knob(kind: Mapping) -> tuple[float, float]:
    """The shoulder's answer to the parabola, and the half of its interval."""
    return tuple(float(kind["knobs"]["shape"][what][2][0][0]) for what in ("mean", "half"))


def _read(kind: Mapping) -> float:
    """The shoulder's inertia that is read, kg m²."""
    return float(kind["read"]["mean"][0][0][2])


def acceleration(kind: str, long: bool = False, reading: str = JOINT_DAMPING.name) -> float:
    """Share of acceleration names among what training added to hidden filters, per cent."""
    return _shapes(of_kinds(long, reading)[kind])


def solved(kind: str) -> float:
    """The same share, by the solver."""
    wanted = {"reading": JOINT_DAMPING.name, "width": 21, "method": "solver"}
    return _shapes(_row("solved", wanted)["kinds"][kind])


def _shapes(kind: Mapping) -> float:
    return 100 * float(kind["names"]["hidden"]["added"]["acceleration"])


def every(kind: str, what: str) -> np.ndarray:
    """Of each network of a kind its read "M11", kg m², or the answer to the parabola's "knob"."""
    return np.asarray(of_kinds()[kind]["every"][what])


def elbow_of_the_other(reading: str) -> float:
    """How much too heavy another arm's elbow is read on its own recording, as a share."""
    kind = of_kinds(False, reading)["another arm along its own motion"]
    return float(kind["read"]["mean"][1][1][2] / kind["truth"][1][1][2] - 1)


def _changes(reading: str, width: int, method: str) -> Mapping[str, Mapping]:
    """What was written into the networks of a setting, by the change."""
    wanted = {"reading": reading, "width": width, "method": method}
    (row,) = (x for x in results.read("written")["rows"] if x["setting"] == wanted)
    return row["changes"]


def loaded(reading: str, model: str, change: str = "3 kg") -> float:
    """RMSS of networks, or what else, on trajectory 6 of a changed arm, like one with a load."""
    return float(_changes(reading, 21, "descent")[change]["error"][model]["mean"])


def shapes_and_sizes() -> Illustration:
    """Shapes, sizes and answers of networks, by the torques that they learnt."""
    own = float(of_kinds()["the arm"]["truth"][0][0][2])
    panels = {
        "acceleration shapes, %": (
            {k: [acceleration(k), acceleration(k, True)] for k in KINDS},
            None,
        ),
        "inertia read, kg m²": ({kind: every(kind, "M11") for kind in KINDS}, own),
        "answer to the knob": ({kind: every(kind, "knob") for kind in KINDS}, 1.0),
    }

    def draw(figure: Figure):
        axes = figure.subplots(1, len(panels), sharey=True)
        for axis, (label, (shown, arm)) in zip(axes, panels.items()):
            for k, values in enumerate(shown.values()):
                colour = INK if k < _WITH_INERTIA else FAINT
                if arm is None:
                    axis.plot(values, [k, k], color=colour, lw=1)
                    axis.plot(values[:1], [k], "o", color=colour, ms=7)
                    axis.plot(values[1:], [k], "o", color=colour, ms=7, mfc="none")
                else:
                    axis.plot(values, np.full(len(values), k), "o", color=colour, ms=4)
                    axis.plot([np.mean(values)] * 2, [k - 0.3, k + 0.3], color=INK, lw=2)
                    axis.axvline(arm, color=INK, ls="--", lw=1.0)
            axis.axvline(0, color=INK, lw=0.7)
            axis.grid(visible=False, axis="y")
            axis.set(xlabel=label, ylim=(len(KINDS) - 0.5, -0.6))
        axes[0].set_yticks(range(len(KINDS)), list(KINDS.values()))

    means = "; ".join(
        f"{label}: " + ", ".join(f"{KINDS[k]} {np.mean(x):.2g}" for k, x in shown.items())
        for label, (shown, _) in panels.items()
    )
    alt = f"Means of networks by the torques that they learnt. {means}.".replace("-", "−")
    return illustrate(draw, alt, 7.0, 3.0, narrow_height=3 * 2.6)


def known_torques() -> Table:
    """Shapes, inertia read and answer to the knob, by the kind of torques that were learnt."""
    damped, calm = (of_kinds(reading=setup.name) for setup in (JOINT_DAMPING, STATE_FEEDBACK))
    rows = []
    for name, kind in damped.items():
        shapes = ", ".join(f"{acceleration(name, long):.0f}" for long in (False, True))
        told = [f"{kind['truth'][0][0][2]:.1f}"]
        for each in (kind, calm[name]):
            told += [_minus(_read(each), 1), "{} ± {}".format(*(_minus(x, 3) for x in _knob(each)))]
        rows.append((name.replace(" along", ",").replace("the arm", "this arm"), shapes, *told))
    heads = "shapes, %", "inertia, kg m²", "read", "knob", "state feedback: read", "knob"
    return Table(("torques", *heads), rows)


def _minus(value: float, digits: int) -> str:
    return f"{round(value, digits) + 0.0:.{digits}f}".replace("-", "−")


def by_window() -> Table:
    """Inertia read of networks of the arm, over the arm's own, and answer to the knob."""

    def told(part: str, **wanted) -> str:
        kind = _row(part, wanted)["kinds"]["the arm"]
        return f"{_read(kind) / kind['truth'][0][0][2]:.2f}, {_knob(kind)[0]:.2f}"

    rows = []
    for reading in SETUPS:
        cells = (told("grid", reading=reading, width=w, initial=INITIAL) for w in WINDOWS)
        rows.append((f"{reading}, 4,000 epochs", *cells))
    for setup in (JOINT_DAMPING, STATE_FEEDBACK):
        longer = told("long", reading=setup.name, width=21)
        rows.append((f"{setup.name}, 20,000 epochs", "–", longer, "–"))
        solved = told("solved", reading=setup.name, width=21, method="solver")
        rows.append((f"{setup.name}, solver", "–", solved, "–"))
    return Table(("networks of this arm", *(f"window {w}" for w in WINDOWS)), rows)


_WRITTEN = {
    "unedited": "as trained", "written": "written", "retrained": "trained anew",
    "one factor": "one factor", "rough filters": "rough filters",
    "random filters": "random filters", "turned sign": "opposite sign",
}  # fmt: skip
_TRACKED = ("unedited", "written", "retrained", "one factor")


def written_loads() -> Table:
    """RMSS and tracking error, degrees, on the changed arm, by what was done to the networks."""
    damped, calm = JOINT_DAMPING.name, STATE_FEEDBACK.name
    main = damped, 21, "descent"
    shown = {name: (*main, name) for name in _changes(*main) if name != "own arm"}
    for reading, more in ((damped, ""), (calm, f", {calm}")):
        for width in WINDOWS:
            if (reading, width) != main[:2]:
                shown[f"3 kg{more}, window {width}"] = reading, width, "descent", "3 kg"
        shown[f"3 kg{more}, solver"] = reading, 21, "solver", "3 kg"
    rows = []
    for label, (*setting, change) in shown.items():
        found = _changes(*setting)[change]
        cells = []
        for name in _WRITTEN:
            told = f"{found['error'][name]['mean']:.2f}"
            if name in _TRACKED:
                told += f", {found['tracking'][name]['mean']:.1f}°"
            cells.append(told)
        rows.append((label, *cells))
    return Table(("change", *_WRITTEN.values()), rows)


def _quoted() -> None:
    """Numbers of the evidence page."""
    (setting,) = (
        x["setting"] for x in results.read("planted")["long"]
        if x["setting"]["reading"] == JOINT_DAMPING.name
    )  # fmt: skip
    quote("planted-networks", setting["networks"])
    quote("planted-days", setting["days"])
    for name, kind in (("arm", "the arm"), ("position", "position alone")):
        quote(f"planted-{name}-state", acceleration(kind, True, STATE_FEEDBACK.name))
        quote(f"planted-{name}-solver", solved(kind))
    every_shift = every("shifted", "knob")
    quote("planted-shifted-least", every_shift.min())
    quote("planted-shifted-most", every_shift.max())
    reach = {what: every("the arm", what).min() for what in ("M11", "knob")}
    without = [name for name, kind in of_kinds().items() if not kind["truth"][0][0][2]]
    beyond = [
        np.any([every(name, what) >= least for what, least in reach.items()], 0) for name in without
    ]
    quote("planted-beyond", how_many(int(np.sum(beyond)), np.size(beyond)))
    pencil = _row("control", {"reading": JOINT_DAMPING.name, "width": 21, "epochs": None})
    quote("planted-pencil", _knob(pencil["kinds"]["the arm's mean by pencil"])[0])
    calm = of_kinds(reading=STATE_FEEDBACK.name)["the arm"]
    quote("planted-damping", calm["read"]["mean"][0][0][1])
    quote("planted-damping-arm", calm["truth"][0][0][1])
    rows = results.read("written")["rows"]
    pairs = [
        (row["changes"]["own arm"]["error"]["mean"], change["error"])
        for row in rows
        for name, change in row["changes"].items()
        if name != "own arm"
    ]
    worse = [own for own, e in pairs if e["written"]["mean"] >= e["unedited"]["mean"]]
    quote("planted-written-rows", len(pairs))
    quote("planted-written-better", len(pairs) - len(worse))
    quote("planted-written-own", min(worse))
    real = [run["error"] for row in results.read("written-pendulum")["rows"]
            for run in row["runs"].values()]  # fmt: skip
    for name, model in (("alone", "inertia written"),
                        ("gravity", "inertia written, gravity by formula")):  # fmt: skip
        better = [np.mean(e[model]) < np.mean(e["unedited"]) for e in real]
        quote(f"planted-pendulum-{name}", int(np.sum(better)))
    quote("planted-pendulum-cases", len(real))
