"""What the lesson *Window size against generalisation* shows, quotes and judges."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np

from ddlib import figures, paper
from ddlib.analysis import refitted, savitzky_golay
from ddlib.effects import Quantisation
from ddlib.figures.style import Illustration
from ddlib.learning import cases, sliding_windows
from ddlib.setups import JOINT_DAMPING
from ddlib.tables import quote, significant
from ddlib.widgets import Choice, CurveWidget, Panel, Scalar
from workshop.chapters.exercises import Exercise, fitting, judging
from workshop.chapters.window_networks import order_medians
from workshop.report import committed, results
from workshop.report.evidence import claims
from workshop.report.evidence.verdicts import Measured, judged, median


def _medians(name: str) -> tuple[np.ndarray, np.ndarray]:
    """The ten windows, and the medians of a quantity over the networks of each."""
    rows = results.read("window-sizes")["rows"]
    return np.array([row["width"] for row in rows]), np.array([np.median(r[name]) for r in rows])


@cache
def least_squares_by_size() -> np.ndarray:
    """Training and test errors of least squares, state feedback, shape (10 windows, 2)."""
    errors, runs = [], (committed.training(), committed.recording()[5])
    for width in _medians("test")[0]:
        (x, y), (new, answer) = (cases(run, width) for run in runs)
        errors.append(refitted(x.reshape(len(x), -1), y, new.reshape(len(new), -1), answer))
    return np.array(errors)


def behind_least_squares() -> np.ndarray:
    """At which of the ten windows networks have more error in training than least squares."""
    return _medians("training")[1] > least_squares_by_size()[:, 0]


def least_error() -> Measured:
    """Which of ten windows has the least median test error, by state feedback."""
    rows = results.read("window-sizes")["rows"]
    (sizes, test), behind = _medians("test"), behind_least_squares()
    text = f"{sizes[test.argmin()]} samples ({significant(test.min(), 2)}); at {behind.sum()} of "
    text += f"{len(sizes)} sizes least squares has less error in training than the networks"

    def least(*cells):
        return sizes[np.argmin([median(cell) for cell in cells], axis=0)]

    return judged(least, *(np.array(row["test"]) for row in rows), text=text)


def acceleration_by_window() -> CurveWidget:
    """The shoulder's acceleration by a parabola in a window, for three encoders."""
    sizes, encoders = np.arange(3, 62, 2), {10.5: "10.5 bits", 12.5: "12.5 bits", 16.0: "16 bits"}
    estimates, errors, true = {}, {}, {}
    for bits in encoders:
        rounding = Quantisation(2 * np.pi / 2**bits)
        setup = replace(JOINT_DAMPING, effects=replace(JOINT_DAMPING.effects, encoder=(rounding,)))
        run = setup.record(paper.APPENDIX_I_EXTENTS_DEG)[0]
        truth = true[bits] = np.gradient(run.qd_true, run.step, axis=0)[run.motion, 0]
        for w in map(int, sizes):
            windows = sliding_windows(run.q, w, run.motion)[:, 0]
            estimates[bits, w] = windows @ savitzky_golay(w, 2, run.step, degree=2)
        misses = [estimates[bits, w] - truth for w in map(int, sizes)]
        errors[bits] = np.sqrt(np.mean(np.square(misses), 1) / truth.var())
    time, most = run.t[run.motion], 2.0 * np.abs(truth).max()

    def curves(width, bits):
        k = int(np.flatnonzero(sizes == width)[0])
        estimate = np.clip(estimates[bits, width], -most, most)
        error = {"errors": errors[bits], "error": errors[bits][k], "at": float(width)}
        return {"estimate": estimate, "true": true[bits], **error}

    label = "error / deviation of the acceleration"
    return CurveWidget(
        curves,
        [
            Choice("width", "Window", {int(w): f"{w} samples" for w in sizes}, 5, "slider"),
            Choice("bits", "Encoder", encoders, 12.5),
        ],
        [
            Panel(
                "Shoulder's acceleration, rad/s²",
                {"estimate": "by a parabola in the window", "true": "true"},
                "time, s",
                time,
                y_range=(-most, most),
                limits=(-most, most),
            ),
            Panel(label.capitalize(), {"errors": "error"}, "window, samples", sizes.astype(float),
                  cursor="at", y_scale="log"),
        ],
        title="Acceleration by window",
        alt="The shoulder's acceleration along the first motion, true and by a parabola in a short "
        "window, which shows the encoder's steps; and its error over windows.",
        scalars=[Scalar("error", "Error over the deviation of the acceleration")],
    )  # fmt: skip


def errors_by_size() -> Illustration:
    """Median errors over ten window sizes by state feedback, and what the paper prints."""
    (sizes, training), (_, test), (_, best) = map(_medians, ("training", "test", "best test"))
    printed = np.array(list(paper.TABLE_4_1))
    in_paper = np.array([(t.training, t.test) for t in paper.TABLE_4_1.values()])
    lines = {
        "training": training,
        "test, after 20,000 epochs": test,
        "test, best on the way": best,
        "test, least squares": least_squares_by_size()[:, 1],
        "printed, training": (printed, in_paper[:, 0]),
        "printed, test": (printed, in_paper[:, 1]),
    }
    alt = "Six curves over window sizes on logarithmic axes. From the shortest window to the "
    alt += f"longest the training error goes from {training[0]:.2f} to {training[-1]:.2f}, the "
    alt += f"test error from {test[0]:.1f} to {test[-1]:.1f}."
    how = {"x_log": True, "y_log": True, "height": 3.2}
    return figures.curves(sizes, {"RMSS": lines}, "window, samples", alt, **how)


def _quoted() -> None:
    """Put the book's numbers into the lesson."""
    sizes, test = _medians("test")
    for width, error in order_medians().items():
        quote(f"size-order-{width}", error)
    quote("size-linear-most", least_squares_by_size()[sizes >= 11, 1].max())
    quote("size-networks-least", test[sizes >= 11].min())
    quote("size-behind", behind_least_squares().sum())
    cell = next(c for c in results.read("span")["cells"] if c["width"] == 41)
    quote("size-learnt", np.median(cell["measured"]["learnt"]))
    quote("size-directions", len(cell["variance"]))
    quote("size-encoder", claims.measured("short-window").value)
    quote("size-another-day", claims.measured("memorises").value)
    quote("size-another-day-damped", claims.measured("memorises-damping").value)
    shuffled = results.read("memory")["rows"][-1]
    quote("size-memory-descent", np.median(shuffled["training"]))
    quote("size-memory-solver", np.median(shuffled["solver"]["training"]))


def _exercise(number: int, floor=None) -> Exercise:
    """An exercise of the lesson; `floor` is the reader's, over bits."""
    if number == 1:
        slips = [
            (2**0.5, "that is averaging alone; the window's times grow, too."),
            (4.0, "that is the times alone; more samples are averaged, too."),
            (8.0, "averaging goes with the root of the number of samples."),
        ]
        return Exercise("number", 2**2.5, "times enter twice, the samples by their root.", slips)
    elif number == 2:
        reason = "odd powers of s do not touch the middle curvature of a symmetric window."
        otherwise = "s runs from -h to h. Which sums over powers of s are zero?"
        return Exercise("number", 1.0, reason, otherwise=otherwise, tolerance=1e-3)
    else:
        reason = "this one is fine enough, and half a bit less is not."
        otherwise = "either its floor is above 0.05, or half a bit less is enough."
        right = fitting(lambda b: floor(b) <= 0.05 < floor(b - 0.5), np.arange(1.5, 40, 0.25))
        return Exercise("number", right, reason, otherwise=otherwise, unit="bits")


check = judging(_exercise)
