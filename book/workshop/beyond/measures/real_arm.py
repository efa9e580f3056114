"""The window network of 1988 on a real arm: its errors, its filters, and what beats it.

Read from the result "real-arm". Errors are pooled over five blocks of the recording, each
predicted by what was learnt on the others, and over all six joints, and divided by the deviation
of the whole recording. The replicates draw blocks and, in each, networks. Five blocks are few: an
undecided verdict often means just that.
"""

from __future__ import annotations

import numpy as np

from ddlib import paper
from ddlib.analysis import savitzky_golay
from ddlib.tables import significant
from workshop.report import results
from workshop.report.evidence.verdicts import Measured, judged, median

RATE = 100
"""Samples a second of the paper, and of all rows that name no other."""


def cell(width: int, rate: int = RATE) -> dict:
    """A window of the grid.

    Parameters
    ----------
    width, rate : int
        Window size; samples a second.
    """
    (found,) = [
        row
        for row in results.read("real-arm")["grid"]
        if (row["width"], row["rate"]) == (width, rate)
    ]
    return found


def squares(width: int, model: str = "network", rate: int = RATE) -> np.ndarray:
    """Mean squared errors of a model, ``(blocks, networks)``; others than networks stand alone.

    Parameters
    ----------
    width, rate : int
        As of `cell`.
    model : str
        A name of the grid, like "network", "network, training" or "ridge".
    """
    found = np.array(cell(width, rate)[model])
    return found if model.startswith("network") else found[:, None]


def of(cell) -> np.ndarray:
    """Root of the mean square, over blocks and networks, one for each draw."""
    return np.sqrt(cell.mean((-2, -1)))


def variant(name: str, side: str = "test") -> np.ndarray:
    """Mean squared errors of the main window with one thing changed, ``(blocks, networks)``.

    Parameters
    ----------
    name : str
        Like "20 units", "decay 0.001" or "on the rest, decay 0.01".
    side : {"training", "test"}
    """
    return np.array(results.read("real-arm")["variants"][name][side])


def named(begin: str) -> dict[str, np.ndarray]:
    """Test errors of all variants whose names begin or end so."""
    found = results.read("real-arm")["variants"]
    return {n: variant(n) for n in found if n.startswith(begin) or n.endswith(begin)}


def _over(one: list, other: list, text: str) -> Measured:
    """Least error of some models over the least of others, all of the same blocks (judged).

    Models without networks are repeated for each network.
    """
    members = max(x.shape[1] for x in (*one, *other))
    arrays = tuple(np.broadcast_to(x, (len(x), members)) for x in (*one, *other))

    def ratio(drawn):
        each = [of(x) for x in drawn]
        return np.min(each[: len(one)], axis=0) / np.min(each[len(one) :], axis=0)

    return judged(ratio, arrays, text=text, nested=True)


def _told(*arrays) -> list[str]:
    return [significant(float(of(x)), 2) for x in arrays]


def _least(named: dict) -> tuple[str, str]:
    """Name and error of the best of some models."""
    best = min(named, key=lambda name: of(named[name]))
    return best, _told(named[best])[0]


# --- errors -------------------------------------------------------------------------------


def error(width: int = 21, column: str = "test") -> Measured:
    """Error of the networks at the paper's rate.

    Parameters
    ----------
    width : int
        Window size.
    column : {"test", "training"}
    """
    found = _network(width, column)
    each = [_told(block[None])[0] for block in found]
    return judged(of, found, text=f"blocks: {', '.join(each)}", nested=True)


def _network(width: int, column: str) -> np.ndarray:
    return squares(width, "network" if column == "test" else f"network, {column}")


def worst_window() -> Measured:
    """The largest test error of the paper's three windows."""
    cells = tuple(_network(w, "test") for w in paper.TABLE_4_1)
    text = ", ".join(_told(*cells)) + " at 11, 21, 41"
    return judged(lambda drawn: np.max([of(x) for x in drawn], 0), cells, text=text, nested=True)


def worse_on_test() -> Measured:
    """Least ratio of test to training error over the paper's windows."""
    cells = tuple(_network(w, side) for w in paper.TABLE_4_1 for side in ("test", "training"))

    def least(drawn):
        each = [of(x) for x in drawn]
        return np.min([a / b for a, b in zip(each[::2], each[1::2])], axis=0)

    told = _told(*cells)
    text = "test and training " + ", ".join(f"{a} and {b}" for a, b in zip(told[::2], told[1::2]))
    return judged(least, cells, text=text, nested=True)


def in_order(column: str, order: list) -> Measured:
    """Whether the errors of the paper's windows rise in this order.

    Parameters
    ----------
    column : {"test", "training"}
    order : sequence of int
        Windows from the least to the largest error; those of equal rank in a list.
    """
    flat = [w for level in order for w in np.atleast_1d(level)]
    cells = tuple(_network(int(w), column) for w in flat)
    ranks = [k for k, level in enumerate(order) for _ in np.atleast_1d(level)]

    def holds(drawn):
        each = list(zip(ranks, (of(x) for x in drawn)))
        pairs = [(a, b) for i, a in each for j, b in each if i < j]
        return np.all([a < b for a, b in pairs], axis=0)

    told = ", ".join(f"{t} at {w}" for t, w in zip(_told(*cells), flat))
    found = judged(holds, cells, text=told, nested=True)
    return found._replace(value=bool(found.value))


def best_window() -> Measured:
    """The window with the least test error, of all at the paper's rate."""
    widths = [row["width"] for row in results.read("real-arm")["grid"] if row["rate"] == RATE]
    cells = tuple(_network(w, "test") for w in widths)
    told = ", ".join(f"{t} at {w}" for t, w in zip(_told(*cells), widths))

    def best(drawn):
        return np.array(widths)[np.argmin([of(x) for x in drawn], axis=0)]

    return judged(best, cells, text=told, nested=True)


def memory(kind: str = "shuffled", width: int = 41) -> Measured:
    """Training error on currents that have nothing to do with the motion.

    Parameters
    ----------
    kind : {"shuffled", "phases"}
        In random order, or as smooth as the recorded ones.
    width : int
        Window size.
    """
    found = results.read("real-arm")["memory"]
    both = {name: np.median(rows[str(width)]) for name, rows in found.items()}
    names = {"shuffled": "shuffled", "phases": "with random phases"}
    text = ", ".join(f"{significant(x, 2)} {names[name]}" for name, x in both.items())
    return judged(median, np.array(found[kind][str(width)]), text=text)


def magnitudes(narrow: int = 21, wide: int = 41) -> Measured:
    """Largest weight of a wide window over that of a narrow one, medians over networks.

    Parameters
    ----------
    narrow, wide : int
        Window sizes.
    """
    cells = tuple(np.array(cell(w)["largest weight"]) for w in (wide, narrow))
    taps = [np.abs(savitzky_golay(w, 2, 1 / RATE, degree=2)).max() for w in (wide, narrow)]
    told = [significant(np.median(x), 2) for x in cells]
    text = f"{told[0]} at {wide}, {told[1]} at {narrow}; the ratio of acceleration filters is "
    return judged(
        lambda drawn: median(drawn[0]) / median(drawn[1]),
        cells,
        text=text + significant(taps[0] / taps[1], 2),
        nested=True,
    )


def differencing(rate: int = 500, width: int = 21) -> Measured:
    """Error of a linear model of states by differences over that of states by a polynomial.

    Differences are those of three neighbouring samples.

    Parameters
    ----------
    rate, width : int
        Samples a second; window of the polynomial.
    """
    found = results.read("real-arm")["differences"]
    ends = [np.array(found[str(rate)][n])[:, None] for n in ("states", "identified")]
    fitted = [squares(width, name, rate) for name in ("states", "identified")]
    a, b, c, d = _told(ends[0], fitted[0], ends[1], fitted[1])
    slow = np.array(found[str(RATE)]["states"])[:, None]
    text = f"{a} and {b} at {rate} samples a second, {_told(slow)[0]} by differences at {RATE}; "
    return _over(ends[:1], fitted[:1], f"{text}with known axes and friction {c} and {d}")


def tailored(width: int = 21) -> Measured:
    """Error of the polynomial's states over that of a linear filter of the window (judged).

    Parameters
    ----------
    width : int
        Window size.
    """
    given, learnt = squares(width, "states"), squares(width, "ridge")
    text = "{} with the polynomial's, {} with its own".format(*_told(given, learnt))
    return _over([given], [learnt], text)


def network_over(other: str = "ridge") -> Measured:
    """Error of the network over that of another model, each at its best window.

    Parameters
    ----------
    other : str
        A model of the grid.
    """
    widths = [row["width"] for row in results.read("real-arm")["grid"] if row["rate"] == RATE]
    ours, theirs = ({w: squares(w, name) for w in widths} for name in ("network", other))
    (a, x), (b, y) = _least(ours), _least(theirs)
    return _over([*ours.values()], [*theirs.values()], f"{x} at {a} against {y} at {b}")


def over_identified(other: str = "ridge") -> Measured:
    """Error of another model over that of known axes with friction, each at its best window.

    Parameters
    ----------
    other : str
        A model of the grid.
    """
    widths = [row["width"] for row in results.read("real-arm")["grid"] if row["rate"] == RATE]
    theirs, ours = ({w: squares(w, name) for w in widths} for name in (other, "identified"))
    (a, x), (b, y) = _least(theirs), _least(ours)
    return _over([*theirs.values()], [*ours.values()], f"{x} at {a} against {y} at {b}")


def process_over(other: str = "network", process: str = "windows") -> Measured:
    """Error of another model over that of a Gaussian process, both at window 21 (judged).

    Parameters
    ----------
    other : str
        A model of the grid.
    process : {"windows", "states", "on the rest"}
        What the process sees; "on the rest": the states, to learn what the known structure leaves.
    """
    found = {n: np.array(x)[:, None] for n, x in results.read("real-arm")["processes"].items()}
    theirs = squares(21, other)
    text = f"{_told(theirs)[0]} against "
    text += ", ".join(f"{_told(x)[0]} {n}" for n, x in found.items())
    return _over([theirs], [found[process]], text)


def without_friction(width: int = 21) -> Measured:
    """Error of the rigid body alone over that with friction (judged).

    Parameters
    ----------
    width : int
        Window size.
    """
    bare, whole = squares(width, "no friction"), squares(width, "identified")
    return _over([bare], [whole], "{} without, {} with friction".format(*_told(bare, whole)))


def friction_share(width: int = 21) -> Measured:
    """Deviation of the identified friction over that of the current, median of six joints.

    Parameters
    ----------
    width : int
        Window size.
    """
    found = np.array(results.read("real-arm")["windows"][str(width)]["friction"])
    text = ", ".join(significant(x, 2) for x in found) + " at joints 1 to 6"
    return judged(median, found, text=text)


def more_hidden_units(units: int = 20) -> Measured:
    """Test error with more hidden units over that with ten.

    Parameters
    ----------
    units : int
        How many more: 20.
    """
    ours, ten = variant(f"{units} units"), squares(21)
    return _over([ours], [ten], "{} with {}, {} with 10".format(*_told(ours), units, *_told(ten)))


def rises_again() -> Measured:
    """Test error after all epochs over the least one on the way."""
    course = {n: v for n, v in named("epochs").items()}
    last, least = list(course)[-1], _least(course)
    text = f"{_told(course[last])[0]} after {last}, {least[1]} after {least[0]}"
    return _over([course[last]], [*course.values()], text)


def decay_over_ridge() -> Measured:
    """Test error with the best of some weight decays over that of the linear filter (judged)."""
    ours, linear = named("decay"), squares(21, "ridge")
    (name, x), (y,) = _least(ours), _told(linear)
    bare = _told(ours["decay 0"])[0]
    return _over([*ours.values()], [linear], f"{x} with {name}, {bare} without; linear {y}")


def on_the_rest() -> Measured:
    """Error of identified model and network together over that of the identified model alone."""
    ours, alone = named("on the rest"), squares(21, "identified")
    text = "{1} with {0}; alone {2}".format(*_least(ours), *_told(alone))
    return _over([*ours.values()], [alone], text.replace("on the rest, ", ""))


def hidden_units_add(column: str = "training") -> Measured:
    """Error of a linear filter alone over that with the hidden units, both fitted anew (judged).

    Parameters
    ----------
    column : {"training", "test"}
    """
    found = results.read("real-arm")["hidden units"][column]
    alone, both = np.array(found["alone"])[:, None], np.array(found["with hidden units"])
    return _over([alone], [both], "{} alone, {} with hidden units".format(*_told(alone, both)))
