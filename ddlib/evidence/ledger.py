"""Two tables of the ledger page: errata of the paper, and what its open questions decide."""

from __future__ import annotations

import numpy as np

from ddlib import paper
from ddlib.evidence.measures.filters import parts_sum_up
from ddlib.experiments import KD, KP, WINDOWS, results
from ddlib.learning import Weights
from ddlib.simulation import LOG_STEP
from ddlib.tables import Table, significant, spread, typeset
from ddlib.trajectories import APPENDIX_I, MAX_EXTENT_DEG, MOTION_SECONDS, pick_and_place, time_grid

FIGURE_UNITS = {"5-6": (52, 21, 41), "5-7": (93, 41, 81), "5-8": (85, 41, 81)}
"""Unit named inside a figure, window by the text of section 5.1, window by the caption."""

SETS = ("random set A", "random set B", "trajectory 6")
"""The data sets of Table 6-1."""


def unit_fits(unit: int, width: int) -> bool:
    """Whether a unit of this number is a hidden or an output unit of a window network.

    Inputs are numbered first, from 0 or from 1.

    Parameters
    ----------
    unit, width : int
        Number of the unit; window size.
    """
    inputs, others = 2 * width, paper.HIDDEN_UNITS + 2
    return inputs < unit <= inputs + others


def errata() -> Table:
    """Where the paper contradicts itself, a formula or arithmetic; what is computable is computed.

    Returns
    -------
    Table
        Place, what is printed, what is wrong or unclear, what this book does.
    """
    reference = pick_and_place([MAX_EXTENT_DEG] * 2, time_grid(LOG_STEP))
    speed = np.abs(reference.qd[0]).max()
    lowest = np.rad2deg(reference.q.min())
    period = 2 * np.pi / (np.pi / MOTION_SECONDS)
    extents = np.array(APPENDIX_I)
    at_limits = int(np.isin(extents, (0.0, MAX_EXTENT_DEG)).sum())
    cases = len(paper.TRAINING_TRAJECTORIES) * paper.SAMPLES_PER_TRAJECTORY
    products = "; ".join(f"{Weights.random(1, w)[0].count() * cases:,} at {w}" for w in WINDOWS)
    halves = ", ".join(f"{w // 2} for {w}" for w in WINDOWS)
    units = "; ".join(
        f"unit {unit} of Figure {figure} is "
        f"{'no input' if unit_fits(unit, text) else 'an input'} at {text} and "
        f"{'no input' if unit_fits(unit, caption) else 'an input'} at {caption}"
        for figure, (unit, text, caption) in FIGURE_UNITS.items()
    )
    rows = [
        (
            "section 1.1",
            "PID is “Position Integral Derivative”",
            "The P is for proportional.",
            "“proportional”",
        ),
        (
            "section 1.1",
            "1.2 ms (830 Hz)",
            f"1/1.2 ms is {1 / 1.2e-3:.0f} Hz; the frequency is rounded.",
            "The period counts.",
        ),
        (
            "section 1.1",
            "parity requires O(2^n) coefficients as a polynomial",
            "It does for inputs 0 and 1; for inputs −1 and 1 it is one product of all of them.",
            "Both are counted: {doc}`backpropagation`.",
        ),
        (
            "sections 1.1 to 5.1",
            "n and w",
            "n is bits of a string, then the window, half a window and the number of joints; "
            "w is the window in section 3.2 and half of it in section 5.1.",
            "w is the window in samples, n its half; {doc}`notation`.",
        ),
        (
            "section 2",
            "joint 0 and joint 1",
            "Joint 1 is the shoulder in section 4, and figures have a joint 2.",
            "Joints 1 and 2 in prose, index 0 and 1 in code.",
        ),
        (
            "section 2",
            "the period of the trajectory is 3 seconds",
            f"The sine of Appendix I has a period of {period:.0f} s; the motion is half of it.",
            "The formula holds.",
        ),
        (
            "section 2",
            "“pick-and-place”, initial and final position",
            f"The reference passes both at full speed, {speed:.2f} rad/s for {MAX_EXTENT_DEG:g}°.",
            "The formula holds; the arm starts from rest.",
        ),
        (
            "section 2",
            "a hypercube of size π",
            f"The angles of the family fill {MAX_EXTENT_DEG:g}°; section 6 has a radius of π.",
            "Not used.",
        ),
        (
            "section 3",
            "a window of desired positions",
            "Section 4 trains on measured ones.",
            "Trained on measured positions, tested on both.",
        ),
        (
            "section 4",
            "better than on “the new trajectories”",
            f"One new trajectory was tested, number {paper.TEST_TRAJECTORY}.",
            f"Trajectory {paper.TEST_TRAJECTORY}.",
        ),
        (
            "section 5.1",
            "odd(x) = (f(x) − f(−x))/2 − const",
            f"The constant belongs to the even part. {parts_sum_up().text.capitalize()}.",
            "`decompose` takes it from the even part.",
        ),
        (
            "Figures 5-4 to 5-8",
            "windows of 41 and 81 in captions, of 21 and 41 in the text",
            "The units named inside the figures fit the text alone, if inputs are numbered "
            f"first: {units}.",
            "The text holds.",
        ),
        (
            "sections 5.2, 5.3",
            "weights “quite large”, then “surprisingly low”",
            "The second is said of window 41; the first then leaves it out.",
            "Measured for each window.",
        ),
        (
            "section 5.3",
            "windows of five, ten and twenty",
            f"They are half widths: {halves}.",
            "The sizes of Table 4-1.",
        ),
        (
            "section 6",
            "a hypercube of radius π",
            "Half its edge is meant, in rad, rad/s and rad/s² alike.",
            "Uniform from −π to π.",
        ),
        (
            "section 6",
            "298 points of a trajectory",
            f"A trajectory has {paper.SAMPLES_PER_TRAJECTORY} samples; second differences would "
            "lose two [I].",
            "298 points.",
        ),
        (
            "Table 6-1",
            "“testing data”",
            "Its first row, random set A, is the training set.",
            "Listed as a training error.",
        ),
        (
            "section 7",
            "“generating accurate feedforward torques … on a physical robot arm”",
            "They were compared with recorded torques, not applied: section 7.1 plans that.",
            "Judged as a prediction.",
        ),
        (
            "Appendix I",
            "“maximum extent” and a minus sign",
            f"Extents are positive, angles negative: down to {lowest:.0f}°.",
            "The formula holds.",
        ),
        (
            "Appendix I",
            "random extents",
            f"{at_limits} of {extents.size} lie on a limit of the family exactly.",
            "Kept as printed.",
        ),
        (
            "Appendix I",
            "over 700,000 multiplications for the largest network",
            f"By window: {products}.",
            "Taken to mean window 21.",
        ),
    ]
    header = ("where", "printed", "wrong or unclear", "in this book")
    return Table(header, [tuple(map(typeset, row)) for row in rows])


def open_questions() -> Table:
    """What the questions that the paper leaves open decide, from the committed results.

    Returns
    -------
    Table
        Question, decision, errors as decided, errors otherwise. Both sides of a row have
        the same number of networks.
    """
    rows = [tuple(map(typeset, row)) for row in (*_table_4_1(), *_table_6_1())]
    return Table(("question", "decision", "as decided", "otherwise"), rows)


def _medians(cells, column, first=None) -> list[float]:
    """Median error of the first networks of each window size."""
    columns = [cells[str(w)].get("errors", cells[str(w)])[column] for w in WINDOWS]
    return [float(np.median(values[:first])) for values in columns]


def _triple(values) -> str:
    return " · ".join(significant(np.median(x), 2) for x in values)


def _both(cells, first=None) -> str:
    test = _medians(cells, "test", first)
    least = WINDOWS[int(np.argmin(test))]
    training = _triple(_medians(cells, "training", first))
    return f"training {training}; test {_triple(test)}, least at {least}"


def _table_4_1() -> list[tuple]:
    table = results.read("table-4-1")["setups"]
    state, position = table["state feedback"], table["position feedback"]
    longer, clean = (results.read(name) for name in ("longer", "clean"))
    units = {row["units"]: row for row in results.read("hidden-units")["rows"]}
    sizes = {row["width"]: row for row in results.read("window-sizes")["rows"]}
    one = state["21"]["errors"]["test"]

    def pair(row, columns=("training", "test")):
        return ", ".join(f"{name} {significant(np.median(row[name]), 2)}" for name in columns)

    weight = ("training", "test", "largest weight")
    test = f"test {_triple(_medians(state, 'test'))}"
    shifted = _triple(_medians(state, "test by training deviation"))
    return [
        (
            "What is “a proportional controller”?",
            "position and velocity are fed back",
            _both(state),
            f"position alone: {_both(position)}",
        ),
        *_arms(state),
        (
            "When is the asymptote reached?",
            f"after {paper.EPOCHS:,} epochs",
            _both(state, longer["members"]),
            f"after {longer['epochs']:,}: {_both(longer['windows'])}",
        ),
        (
            "Which test error counts?",
            "the last",
            test,
            f"the best: test {_triple([state[str(w)]['best test'] for w in WINDOWS])}",
        ),
        (
            "How much friction and sensor noise?",
            "little; {doc}`provenance`",
            _both(state, clean["members"]),
            f"none: {_both(clean['windows'])}",
        ),
        (
            "How many hidden units (window 21)?",
            f"{paper.HIDDEN_UNITS}, as printed",
            pair(units[paper.HIDDEN_UNITS]),
            "; ".join(f"{k}: {pair(row)}" for k, row in units.items() if k != paper.HIDDEN_UNITS),
        ),
        (
            "Whose standard deviation divides the test error?",
            "the test set's own",
            test,
            f"the training set's: test {shifted}",
        ),
        (
            "Which positions does the test show to a network?",
            "measured ones",
            test,
            f"desired ones: test {_triple(_medians(state, 'test, desired positions'))}",
        ),
        (
            "Is the largest window 41, or 81 as in the captions?",
            "41",
            pair(sizes[41], weight),
            f"81: {pair(sizes[81], weight)}",
        ),
        (
            "What is the error of one network worth (window 21)?",
            f"the median of {len(one)} counts",
            f"test {significant(np.median(one), 2)}",
            f"one of the {len(one)}: test {significant(min(one), 2)} to {significant(max(one), 2)}",
        ),
    ]


def _arms(state) -> list[tuple]:
    """Table 4-1 on arms drawn at random, if that study has been run."""
    try:
        rows = results.read("arms")["rows"]
    except FileNotFoundError:
        return []
    least = [WINDOWS[int(np.argmin(_medians(row, "test")))] for row in rows]
    times = ", ".join(f"{w} on {least.count(w)}" for w in WINDOWS)
    training = " · ".join(spread(x) for x in zip(*(_medians(row, "training") for row in rows)))
    return [
        (
            "Which gains, friction, noise and momentum?",
            f"kp {KP[0]:g} / {KP[1]:g} N m/rad, kd {KD[0]:g} / {KD[1]:g} N m s/rad; "
            "{doc}`provenance`",
            _both(state),
            f"{len(rows)} arms at random: training {training}; test least at window {times}",
        )
    ]


def _table_6_1() -> list[tuple]:
    table = results.read("table-6-1")
    first, *choices = results.read("state-space-choices")["rows"]

    def sets(errors, deviation="own deviation"):
        return _triple([errors[name][deviation] for name in SETS])

    def options(row):
        return f"step {row['rate']:g}, momentum {row['momentum']:g}, initial ±{row['initial']:g}"

    drawn = [[np.median(d["errors"][s]["own deviation"]) for d in table["draws"]] for s in SETS]
    ranges = " · ".join(f"{significant(min(x), 2)} to {significant(max(x), 2)}" for x in drawn)
    return [
        (
            "Table 6-1 (set A · set B · trajectory 6): how was it trained?",
            options(first),
            sets(first["errors"]),
            "; ".join(f"{options(row)}: {sets(row['errors'])}" for row in choices),
        ),
        (
            "Table 6-1: whose standard deviation?",
            "each set's own",
            sets(table["errors"]),
            f"set A's: {sets(table['errors'], 'deviation of set A')}",
        ),
        (
            "Table 6-1: which random points?",
            "one draw of each set",
            sets(table["errors"]),
            f"{len(table['draws'])} other draws: {ranges}",
        ),
    ]
