"""Section 1.1: what adaptive controllers reach on the arm, what they find, and what they miss."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ddlib.tables import significant
from workshop.beyond.studies.loop.adaptive import BED, BITS, LOADS, PICKED, TRIALS
from workshop.beyond.studies.loop.runs.adaptive import FULL, TRUTH
from workshop.report import results
from workshop.report.evidence.verdicts import Measured, judged, median

SETUPS = ("joint damping", "state feedback")
"""The two set-ups of the study."""


def kept(*path) -> np.ndarray | dict:
    """A part of the result; numbers as an array in which runs that were stopped are infinite.

    Parameters
    ----------
    *path : str or int
        Keys on the way.
    """
    found = results.read("adaptive")
    for key in path:
        found = found[key]
    if isinstance(found, dict):
        return found
    return np.nan_to_num(np.array(found, float), nan=np.inf)


def _ratio(pairs, names=SETUPS) -> Measured:
    """Largest ratio of medians of pairs of errors, seeds in pairs; the text has them all."""
    cells = [tuple(np.asarray(x) for x in pair) for pair in pairs]

    def worst(*drawn):
        return np.max([median(a) / median(b) for a, b in drawn], axis=0)

    told = [
        f"{significant(np.median(a), 2)} against {significant(np.median(b), 2)} mm ({name})"
        for (a, b), name in zip(cells, names)
    ]
    return judged(worst, *cells, text=", ".join(told))


def course_over(law: str, other: str, motion: int = TRIALS) -> Measured:
    """Error of a law over that of another in one of the motions, in the worse set-up.

    Parameters
    ----------
    law, other : str
        As in the result.
    motion : int
        Which, from 1; after `TRIALS` motions a load is in the hand.
    """
    rows = [kept("course", s, "settled") for s in SETUPS]
    return _ratio([[np.array(r[n], float)[motion - 1] for n in (law, other)] for r in rows])


def load_over(law: str, other: str, motion: int = 2) -> Measured:
    """Error with a load that is not known over that of another law, the worst of all loads.

    Parameters
    ----------
    law, other : str
    motion : int
        First or second.
    """
    pairs, names = [], []
    for setup in SETUPS:
        for mass in LOADS:
            row = load_row(setup, mass)
            pairs.append([row[n][motion - 1] for n in (law, other)])
            names.append(f"{setup}, {mass:g} kg")
    return _ratio(pairs, names)


def load_row(setup: str, mass: float, late: int = 0) -> dict[str, np.ndarray]:
    """Errors with a load and a delay by law, shape (motions, seeds), mm.

    Parameters
    ----------
    setup : str
    mass : float
        kg.
    late : int
        Control periods.
    """
    rows = kept("loads", setup)["rows"]
    (row,) = [r for r in rows if r["load"] == mass and r["late"] == late]
    return {n: np.nan_to_num(np.array(x, float), nan=np.inf) for n, x in row["settled"].items()}


def delay_costs(law: str, late: int) -> Measured:
    """Error with torques that come late over that without, with a load, second motion.

    Parameters
    ----------
    law : str
    late : int
        Control periods.
    """
    slow, quick = (load_row(SETUPS[0], PICKED, k)[law][1] for k in (late, 0))
    return _ratio([[slow, quick]], [f"{2 * late} ms late"])


def taken_up(law: str = "with friction") -> Measured:
    """Error in the last motion with a load over that in the last without.

    Parameters
    ----------
    law : str
    """
    rows = [np.array(kept("course", s, "settled")[law], float) for s in SETUPS]
    return _ratio([[r[-1], r[TRIALS - 1]] for r in rows])


# --- the function that never rises ---------------------------------------------------------


def never_rises() -> Measured:
    """Largest change of the Lyapunov function from sample to sample, continuous time."""
    largest = kept("lyapunov", "continuous")["largest"]
    return Measured(largest, f"{largest:.1e} of its start at most")


def sampled(case: str, where: str = "elsewhere", least: bool = False) -> Measured:
    """Largest rise of the function in one control period, over its start.

    Parameters
    ----------
    case : str
        Reference and sensors, as in the result.
    where : {"elsewhere", "largest"}
        Away from the ends of the motion, or anywhere.
    least : bool
        Of the six trajectories that with the least, else the largest.
    """
    each = [row[where] for row in kept("lyapunov")[case]]
    value = min(each) if least else max(each)
    return Measured(
        value, f"{significant(min(each), 2)} to {significant(max(each), 2)} of its start"
    )


# --- sensors -------------------------------------------------------------------------------


def sensors_over(law: str, other: str, velocity: str, bits: float = 12.5) -> Measured:
    """Error of a law over that of another with an encoder.

    Parameters
    ----------
    law, other : str
    velocity : {"tachometer", "difference"}
        Where the velocity comes from.
    bits : float
        Of the encoder.
    """
    rows = kept("sensors", velocity)
    k = BITS.index(bits)
    return _ratio([[np.array(rows[n]["settled"], float)[k] for n in (law, other)]], [velocity])


# --- what is found -------------------------------------------------------------------------


def blind(trajectory: int) -> Measured:
    """Least eigenvalue of the integral of Y'Y along a trajectory over the largest.

    Parameters
    ----------
    trajectory : int
        1 to 6.
    """
    values = kept("excitation", "eigenvalues")[trajectory - 1]
    return Measured(float(abs(values[0]) / values[-1]), f"{abs(values[0]) / values[-1]:.1e}")


def left_over(run: int, parameter: str | None = None) -> Measured:
    """Error of an estimate that is left along a motion, as a share of the true value.

    Parameters
    ----------
    run : int
        Trajectory 1 to 6, again and again; 7: other members of the family.
    parameter : {"a", "b", "d"}, optional
        Default: the one with the largest error.
    """
    off = np.abs(kept("excitation", "estimate")[run - 1] - 1)
    value = float(off.max() if parameter is None else off["abd".index(parameter)])
    text = ", ".join(f"{n} {100 * x:.0f} %" for n, x in zip("abd", off))
    return Measured(value, f"off by {text}")


def follows_all_the_same(run: int = 5) -> Measured:
    """Error along a motion after learning over that without.

    Parameters
    ----------
    run : int
        As in `left_over`.
    """
    rows = kept("excitation", "settled")
    new, old = (np.array(rows[n], float)[-1, run - 1] for n in ("learning", "not learning"))
    return Measured(float(new / old), f"{new:.2f} against {old:.2f} mm")


def inertia(law: str, least: bool) -> Measured:
    """The shoulder's inertia a after the motions without a load, over the true one.

    Parameters
    ----------
    law : str
    least : bool
        In the set-up where it is least, else where it is furthest from 1.
    """
    cells = [np.array(kept("course", s, "unloaded")[law], float)[:, 0] / TRUTH[0] for s in SETUPS]

    def which(*drawn):
        each = np.array([median(x) for x in drawn])
        return each.min(0) if least else np.abs(each - 1).max(0)

    told = ", ".join(f"{significant(np.median(x), 2)} ({name})" for x, name in zip(cells, SETUPS))
    return judged(which, *cells, text=f"{told} times the true a")


def drifted(law: str) -> Measured:
    """Change of a along trajectory 5, again and again, as a share of a; rounded readings.

    Parameters
    ----------
    law : str
    """
    off = _drift(law)[0]
    text = f"{100 * np.median(off):.2g} % of a"
    return judged(median, off, text=text)


def rounding_drives(law: str = "plain") -> Measured:
    """Drift with an encoder's rounding over that without.

    Parameters
    ----------
    law : str
    """
    rough, exact = _drift(law)
    text = f"{100 * np.median(rough):.2g} % of a against {100 * np.median(exact):.2g} %"
    return judged(lambda x, y: median(x) / median(y), rough, exact, text=text)


def _drift(law: str):
    course = kept("drift", "estimates")[law]
    off = np.abs(np.array(course, float)[-1, :, 0] - 1)
    return off[: len(off) // 2], off[len(off) // 2 :]


# --- friction, and what has no term ---------------------------------------------------------


def compensated() -> Measured:
    """Error with adapted friction over that without friction compensation, rigid body known."""
    rows = [kept("compensation", s, "settled") for s in SETUPS]
    return _ratio([[np.array(r[n], float)[-1] for n in ("adapted", "none")] for r in rows])


def friction_found() -> Measured:
    """Largest relative error of a friction parameter's median estimate, in the worse set-up."""
    cells = []
    for setup in SETUPS:
        row = kept("compensation", setup)
        cells.append(np.array(row["estimate"]) / np.array(row["truth"]))

    def worst(*drawn):
        return np.max([np.abs(np.median(x, axis=1) - 1).max(-1) for x in drawn], axis=0)

    told = [
        ", ".join(f"{x:.2f}" for x in np.median(cell, 0)) + f" ({name})"
        for cell, name in zip(cells, SETUPS)
    ]
    return judged(worst, *cells, text="; ".join(told) + " times the true ones")


def bed(effect: str, rigid: bool = False) -> Measured:
    """Error of a law that adapts under an effect over that of the same law held at the truth.

    Parameters
    ----------
    effect : str
        Of the study's bed.
    rigid : bool
        Without friction among its parameters.
    """
    row = kept("bed", effect, "settled")
    names = ("rigid, adapted", "rigid, held") if rigid else ("adapted", "held")
    return _ratio([[np.array(row[n], float) for n in names]], [effect])


def not_taken_up(effects: Sequence[str]) -> Measured:
    """The least of these ratios (`bed`) over several effects.

    Parameters
    ----------
    effects : sequence of str
    """
    rows = {e: kept("bed", e, "settled") for e in effects}
    cells = [tuple(np.array(r[n], float) for n in ("adapted", "held")) for r in rows.values()]

    def least(*drawn):
        return np.min([median(a) / median(b) for a, b in drawn], axis=0)

    told = [f"{np.median(a) / np.median(b):.2f} ({e})" for (a, b), e in zip(cells, rows)]
    return judged(least, *cells, text=", ".join(told))


def bias(effect: str) -> np.ndarray:
    """What an effect adds to the estimates, as shares of the true ones, shape (7,).

    Parameters
    ----------
    effect : str
    """
    own, none = (np.array(kept("bed", e, "estimate")) for e in (effect, next(iter(BED))))
    return np.median(own - none, axis=0)


def _told(parameter: str) -> str:
    """A parameter of `workshop.beyond.control.adaptive` in words, if it is a friction or a moment."""
    kinds = {"F_v": "viscous friction", "F_c": "Coulomb friction", "g": "gravity moment"}
    kind, joint = kinds.get(parameter[:-1]), parameter[-1]
    return f"the {('shoulder', 'elbow')[int(joint) - 1]}'s {kind}" if kind else parameter


def bent(effect: str) -> Measured:
    """Largest such bias.

    Parameters
    ----------
    effect : str
    """
    own, none = (np.array(kept("bed", e, "estimate")) for e in (effect, next(iter(BED))))
    off = own - none
    k = int(np.abs(np.median(off, 0)).argmax())
    return judged(
        lambda x: np.abs(np.median(x, axis=1)).max(-1),
        off,
        text=f"{100 * np.median(off, 0)[k]:+.0f} % of {_told(FULL[k])}",
    )
