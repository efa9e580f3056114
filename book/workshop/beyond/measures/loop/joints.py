"""Joints three and four: errors by joints and motions, growth, filters, cost.

Read from the result "joints". The replicates draw the seeds of each cell: motions, noise, weights.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ddlib.tables import significant
from workshop.report import results
from workshop.report.evidence.verdicts import Measured, bootstrap, judged, median

DAMPED, FED = "windows", "windows, state feedback"
"""Parts of the result with the errors of window networks, by the reading of the controller."""

FURTHER = slice(2, 4)
"""Joints three and four."""


def read(part: str):
    """A part of the result.

    Parameters
    ----------
    part : str
        Like "windows" or "costs".
    """
    return results.read("joints")[part]


def cell(joints: int, motions: int, reading: str = DAMPED) -> dict:
    """Errors of the networks of one cell.

    Parameters
    ----------
    joints, motions : int
    reading : str
        `DAMPED` or `FED`.
    """
    (found,) = [r for r in read(reading) if (r["joints"], r["motions"]) == (joints, motions)]
    return found


def errors(joints: int, motions: int, what: str = "test", reading: str = DAMPED) -> np.ndarray:
    """One error for each seed of a cell.

    Parameters
    ----------
    joints, motions, reading
        As of `cell`.
    what : {"test", "training", "linear"}
    """
    return np.array(cell(joints, motions, reading)[what])


def ladder(joints: int, what: str = "test") -> tuple[np.ndarray, list[np.ndarray]]:
    """Numbers of motions that were tried, and the errors of each.

    Parameters
    ----------
    joints : int
    what
        As of `errors`.
    """
    rows = [r for r in read(DAMPED) if r["joints"] == joints]
    return np.array([r["motions"] for r in rows]), [np.array(r[what]) for r in rows]


def numbers() -> list[int]:
    """Numbers of joints that were tried."""
    return sorted({row["joints"] for row in read(DAMPED)})


def by_group(motions: int, joints: int = 4) -> Measured:
    """Error of the networks on joints three and four alone.

    Parameters
    ----------
    motions : int
        Training motions.
    joints : int
        Joints of the arm.
    """
    found = np.array(cell(joints, motions)["by joint"])

    def pooled(x):
        return median(np.sqrt((x[..., FURTHER] ** 2).mean(-1)))

    first = np.median(np.sqrt((found[:, :2] ** 2).mean(-1)))
    each = np.sqrt((found[:, FURTHER] ** 2).mean(-1))
    less = significant(float(first), 2)
    text = f"RMSS {_spread(each)} at joints 3 and 4, {less} at joints 1 and 2"
    return judged(pooled, found, text=text)


def over_two(joints: int = 4, motions: int = 5, reading: str = DAMPED) -> Measured:
    """Test error of longer arms over that of the arm of two joints, of as many motions.

    Parameters
    ----------
    joints, motions, reading
        As of `cell`.
    """
    return _ratio(errors(joints, motions, reading=reading), errors(2, motions, reading=reading))


def over_rival(joints: int = 4, motions: int = 5, rival: str = "linear") -> Measured:
    """Test error of the networks over a rival's, of the same motions.

    Parameters
    ----------
    joints, motions : int
    rival : {"linear", "known structure"}
    """
    if rival == "linear":
        pair = errors(joints, motions), errors(joints, motions, rival)
        told = f"{_spread(pair[0])} over {_spread(pair[1])}"
        return judged(
            lambda drawn: median(drawn[0]) / median(drawn[1]),
            pair,
            text=lambda v: f"{significant(v, 2)}: {told}",
        )
    (row,) = [r for r in read(rival) if (r["joints"], r["motions"]) == (joints, motions)]
    wanted = float(np.median(row["test"]))
    return judged(
        lambda x: median(x) / wanted,
        errors(joints, motions),
        text=lambda v: f"{significant(v, 2)}; {significant(wanted, 2)} of the equations",
    )


def _ratio(one, other) -> Measured:
    def statistic(a, b):
        return median(a) / median(b)

    told = f"{_spread(one)} over {_spread(other)}"
    return judged(statistic, one, other, text=lambda v: f"{significant(v, 2)}: {told}")


def _spread(x) -> str:
    return f"{significant(float(np.median(x)), 2)} ({min(x):.2g} to {max(x):.2g})"


# --- growth -------------------------------------------------------------------------------


def needed(joints: int, level: float) -> tuple[float, np.ndarray]:
    """Training motions from which on the median error is below a level, with replicates.

    Between the numbers tried both go linearly on logarithmic scales.

    Parameters
    ----------
    joints : int
    level : float
        RMSS.

    Returns
    -------
    value : float
        Infinite if 80 motions are not enough; the least number tried if that is.
    replicates : ndarray, shape (draws,)
    """
    motions, cells = ladder(joints)
    crossing = _crossing(motions, level)
    # a seed's motions are among those of its longer draws: seeds are drawn for a whole ladder
    replicates = bootstrap(lambda drawn: crossing(*drawn), tuple(cells), seed=joints)
    return float(crossing(*(c[None] for c in cells))[0]), replicates


def _crossing(motions, level) -> Callable:
    x = np.log(motions)

    def crossing(*cells):
        y = np.log(np.stack([median(c) for c in cells])) - np.log(level)
        late = np.full(y.shape[1], np.inf)
        for k in range(y.shape[1]):
            above = np.flatnonzero(y[:, k] > 0)
            last = above.max() if above.size else -1
            if last < 0:
                late[k] = motions[0]
            elif last + 1 < len(x):
                share = y[last, k] / (y[last, k] - y[last + 1, k])
                late[k] = np.exp(x[last] + share * (x[last + 1] - x[last]))
        return late

    return crossing


def law(level: float = 0.2, least: int = 2) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Motions needed by joints, and the exponent of a power law through them.

    Parameters
    ----------
    level : float
        RMSS to be reached.
    least : int
        Joints from which on the law is fitted.

    Returns
    -------
    joints : ndarray
    motions : ndarray, shape (draws + 1, joints)
        The medians first, then the replicates.
    exponents : ndarray, shape (draws + 1,)
    """
    joints = np.array([n for n in numbers() if n >= least])
    each = [needed(n, level) for n in joints]
    motions = np.column_stack([np.append(value, drawn) for value, drawn in each])
    x = np.log(joints) - np.log(joints).mean()
    return joints, motions, np.log(motions) @ x / (x @ x)


def growth(level: float = 0.2) -> Measured:
    """Exponent of the motions needed over the number of joints, from two to seven.

    Parameters
    ----------
    level : float
        RMSS to be reached.
    """
    _, motions, exponents = law(level)
    low, high = np.percentile(exponents[1:], [5, 95])
    shown = ", ".join(f"{m:.0f}" for m in motions[0])
    text = f"{exponents[0]:.1f} ({low:.1f} to {high:.1f}): {shown} motions"
    return Measured(float(exponents[0]), text, exponents[1:])


def states_over_two(joints: int = 4, samples: int = 1000, units: int = 10) -> Measured:
    """Error on random states over that of two joints, of as many samples.

    Parameters
    ----------
    joints, samples, units : int
    """
    return _ratio(states(joints, samples, units), states(2, samples, units))


def states(joints: int, samples: int, units: int = 10) -> np.ndarray:
    """Test errors on random states, one for each seed.

    Parameters
    ----------
    joints, samples, units : int
    """
    wanted = (joints, units, samples)
    (row,) = [r for r in read("random states") if (r["joints"], r["units"], r["samples"]) == wanted]
    return np.array(row["test"])


# --- interactions, filters, cost ----------------------------------------------------------


def interactions(joints: int = 4) -> Measured:
    """Share of the torques that the other joints make, over that of two joints.

    Parameters
    ----------
    joints : int
    """
    kept = read("interactions")
    pooled = [float(np.sqrt(np.mean(np.square(kept[str(n)])))) for n in (joints, 2)]
    text = f"{pooled[0]:.2f} of the deviation over {pooled[1]:.2f}"
    return Measured(pooled[0] / pooled[1], text)


def scaled(kind: str = "real") -> tuple[np.ndarray, np.ndarray]:
    """Gains on acceleration by pair, and the arm's inertia, as shares of each torque.

    Both are multiplied by the joint's acceleration and divided by the torque's deviation.

    Parameters
    ----------
    kind : {"real", "unrelated"}

    Returns
    -------
    gains : ndarray, shape (networks, torque, joint)
    inertia : ndarray, shape (torque, joint)
    """
    kept = read("pairs")
    unit = np.array(kept["acceleration"]) / np.array(kept["deviation"])[:, None]
    return np.array(kept["gains"][kind]) * unit, np.array(kept["inertia"]) * unit


def together(kind: str = "real", others: bool = True) -> np.ndarray:
    """Correlation of gains with inertia over pairs, one for each network.

    Parameters
    ----------
    kind
        As of `scaled`.
    others : bool
        Pairs of two different joints only.
    """
    found, inertia = scaled(kind)
    chosen = ~np.eye(len(inertia), dtype=bool) if others else np.ones_like(inertia, dtype=bool)
    return np.array([np.corrcoef(g[chosen], inertia[chosen])[0, 1] for g in found])


def couplings(kind: str = "real") -> Measured:
    """Correlation of the gains by pairs of different joints with the arm's inertia.

    Parameters
    ----------
    kind
        As of `scaled`.
    """
    real, null = together("real"), together("unrelated")
    text = f"{_spread(real)}; {_spread(null)} on unrelated torques"
    return judged(median, real if kind == "real" else null, text=text)


def gain_error() -> Measured:
    """Largest miss of the median gain of a pair, as a share of the torque's own inertia."""
    found, inertia = scaled()
    own = np.sqrt((inertia**2).sum(1, keepdims=True))

    def worst(drawn):
        miss = np.abs(np.median(drawn, axis=1) - inertia) / own
        return miss.max((-2, -1))

    return judged(worst, found, text=lambda v: f"{100 * v:.0f} %")


def used_together() -> Measured:
    """Correlation of what each torque takes from each window with what the arm's torque does."""
    kept = read("pairs")
    exact = np.array(kept["exact"]).ravel()

    def of(kind):
        return np.array([np.corrcoef(np.ravel(u), exact)[0, 1] for u in kept["used"][kind]])

    text = f"{_spread(of('real'))}; {_spread(of('unrelated'))} on unrelated torques"
    return judged(median, of("real"), text=text)


def cost_over(rival: str, joints: int = 7) -> Measured:
    """Multiplications of the network over those of a formulation.

    Parameters
    ----------
    rival : str
        Like "Newton-Euler, general".
    joints : int
    """
    (row,) = [r for r in read("costs") if r["joints"] == joints]
    text = f"{row['network']:,} over {row[rival]:,}"
    return Measured(row["network"] / row[rival], text)


def cost_grows(what: str) -> Measured:
    """Exponent of the multiplications over the number of joints, between the last two.

    Parameters
    ----------
    what : str
        "network", or a formulation.
    """
    rows = {r["joints"]: r[what] for r in read("costs")}
    last = max(rows)
    value = float(np.log(rows[last] / rows[last - 1]) / np.log(last / (last - 1)))
    return Measured(value, f"{value:.1f}: {rows[last - 1]:,} to {rows[last]:,}")


def followed(reading: str = "joint damping", motions: int = 20) -> Measured:
    """Error on motions followed exactly over that on closed loops: two joints, same networks.

    Parameters
    ----------
    reading : {"joint damping", "state feedback"}
    motions : int
    """
    return _ratio(two_joints(reading, motions, "answered"), two_joints(reading, motions))


def two_joints(
    reading: str, motions: int, kind: str = "closed loop", taps: int = 5, what: str = "test"
) -> np.ndarray:
    """Errors on two joints, one for each seed.

    Parameters
    ----------
    reading, motions
        As of `followed`.
    kind : {"closed loop", "answered", "sine"}
    taps : {5, 21}
        Samples of a window.
    what : {"test", "training"}
    """
    wanted = (reading, motions, kind, taps)
    (row,) = [
        r
        for r in read("closed loops")
        if (r["reading"], r["motions"], r["kind"], r["taps"]) == wanted
    ]
    return np.array(row[what])
