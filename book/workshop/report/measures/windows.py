"""Sections 2 to 4, 5.3 and 7.1: what windows hold, what networks cost, how training goes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ddlib import paper
from ddlib.analysis import content, savitzky_golay
from ddlib.effects import Quantisation
from ddlib.learning import (
    Directions,
    TrainingSet,
    Weights,
    cases,
    jacobian,
    with_change,
    with_ones,
)
from ddlib.metrics import rmss
from ddlib.setups import SETUPS, STATE_FEEDBACK, WINDOWS, split
from ddlib.simulation import LOG_STEP
from ddlib.tables import scientific, significant, spread
from workshop.report import committed, results
from workshop.report.evidence.verdicts import (
    Measured,
    judged,
    mean,
    median,
    turns_at,
)
from workshop.report.studies.windows import acceleration_error


def estimates(
    orders: Sequence[int],
    widths: Sequence[int] = WINDOWS,
    setup: str = STATE_FEEDBACK.name,
    degrees: Sequence[int] = (2, 3, 4, 5),
) -> Measured:
    """Relative error of derivatives by a filter: the worst order, each at its best filter.

    Filters are least-squares polynomials over the window, of all widths and degrees that are given.
    """
    run, names = committed.training(setup), {1: "velocity", 2: "acceleration", 3: "jerk"}
    true, errors = run.qd_true, {}
    windows = {w: cases(run, w)[0] for w in widths}
    for order in range(1, max(orders) + 1):
        if order > 1:
            true = np.gradient(true, LOG_STEP, axis=-2)
        exact = true[..., run.motion, :].reshape(-1, 2)
        errors[order] = min(
            (_missed(x @ savitzky_golay(w, order, LOG_STEP, degree=k), exact), w)
            for w, x in windows.items()
            for k in degrees
            if order <= k < w
        )
    shown = (f"{names[k]} {significant(errors[k][0], 2)} at {errors[k][1]}" for k in orders)
    return Measured(max(errors[k][0] for k in orders), f"relative error {', '.join(shown)}")


def _missed(predicted, exact) -> float:
    return float(np.sqrt(((predicted - exact) ** 2).mean() / exact.var(0).mean()))


def multiplications(width: int = 21) -> Measured:
    """Weights of a network times the cases of an epoch."""
    cases = len(paper.TRAINING_TRAJECTORIES) * paper.SAMPLES_PER_TRAJECTORY
    products = Weights.random(1, width)[0].count() * cases
    return Measured(float(products), f"{products:,} at window {width}")


def weights_against_nwh(widths: Sequence[int] = WINDOWS, many: int = 10) -> Measured:
    """Weights of a network over ``n w h``, two joints; the window furthest from 1.

    Judged with `many` times as many hidden units as outputs; told of the paper's ten, too.
    """

    def against(width, hidden):
        return Weights.random(1, width, hidden)[0].count(), 2 * width * hidden

    most = {w: against(w, 2 * many) for w in widths}
    ratios = [weights / product for weights, product in most.values()]
    comparisons = (
        f"with {hidden} hidden units "
        + ", ".join("{} for {} at {}".format(*against(w, hidden), w) for w in widths)
        for hidden in (2 * many, paper.HIDDEN_UNITS)
    )
    worst = max(ratios, key=lambda r: abs(np.log(r)))
    return Measured(worst, f"weights for n w h: {'; '.join(comparisons)}")


def paths(width: int = 11) -> Measured:
    """Whether inputs reach the outputs through hidden units and directly, and no other way."""
    network = Weights.random(1, width)[0]
    hidden, output = network.hidden_weights.size, network.output_weights.size
    direct = network.direct_weights.size
    text = f"{hidden} weights into hidden units, {output} from them, {direct} direct ones"
    joined = hidden + output + direct == network.count() and min(hidden, output, direct) > 0
    x = np.random.default_rng(0).uniform(0, 1, (2, 2, width))
    silent = {name: 0 * getattr(network, name) for name in ("hidden_weights", "hidden_bias")}
    blind = replace(network, **silent)
    differs = np.ptp(blind.activity(x)[1], axis=0).min() > 0
    return Measured(bool(joined and differs), text + f" at window {width}")


def growth(width: int = 21, many: int = 10) -> Measured:
    """Weights over proportion as window, joints or hidden units double; the one furthest from 1.

    From a network with `many` times as many hidden units as outputs.
    """
    base = {"width": width, "hidden": 2 * many, "joints": 2, "outputs": 2}
    before = Weights.random(1, **base)[0].count()
    larger = {
        "window": ((2 * width - 1) / width, {"width": 2 * width - 1}),
        "hidden units": (2, {"hidden": 4 * many}),
        "joints": (2, {"joints": 4, "outputs": 4}),
    }
    ratios = {
        name: Weights.random(1, **(base | change))[0].count() / (factor * before)
        for name, (factor, change) in larger.items()
    }
    text = ", ".join(f"{r:.2f} for {name}" for name, r in ratios.items())
    worst = max(ratios.values(), key=lambda r: abs(np.log(r)))  # furthest from 1
    return Measured(worst, f"weights over what proportion gives: {text}")


def sigmoids(width: int = 11) -> Measured:
    """Multiplications for each sigmoid of a network."""
    network = Weights.random(1, width)[0]
    units = network.hidden_bias.size + network.output_bias.size
    text = f"{network.count()} multiplications, {units} sigmoids at window {width}"
    return Measured(network.count() / units, text)


def scaling() -> Measured:
    """Largest change of the RMSS when torque is shifted and scaled, relative."""
    rng = np.random.default_rng(0)
    torque = rng.normal(size=(300, 2)) * [20.0, 3.0]
    predicted = torque + rng.normal(size=torque.shape)
    before = rmss(predicted, torque, pooled=False)
    after = rmss(0.6 * predicted / 50 + 0.5, 0.6 * torque / 50 + 0.5, pooled=False)
    change = float(np.abs(after / before - 1).max())
    return Measured(change, f"changes by {scientific(change)}")


def _mean_of_cells(*cells) -> np.ndarray:
    return np.mean([mean(cell) for cell in cells], axis=0)


def training_error_falls() -> Measured:
    """Share of steps to the next larger window at which the median training error falls."""
    rows = results.read("window-sizes")["rows"]
    sizes = {row["width"]: np.array(row["training"]) for row in rows}
    steps = len(sizes) - 1

    def falls(*cells):
        return (np.diff([median(cell) for cell in cells], axis=0) < 0).mean(0)

    text = f"of {steps} steps from {min(sizes)} to {max(sizes)} samples"
    return judged(falls, *sizes.values(), text=lambda value: f"{value * steps:.0f} {text}")


def training_is_monotone(other: int = 2) -> Measured:
    """Share of the steps between records, over 60,000 epochs, at which the error falls."""
    windows = results.read("longer")["windows"].values()
    histories = [np.array(w["history"]["training"]) for w in windows]
    falls, apart = ([np.diff(h[:, ::k], axis=-1) < 0 for h in histories] for k in (1, other))
    shares = ", ".join(f"{100 * f.mean():.0f} %" for f in falls)
    wider = significant(np.mean([f.mean() for f in apart]), 3)

    def text(value):
        text = f"falls at {shares} of the records: {significant(value, 3)} of all, "
        return f"{text}{wider} at 1 record in {other}"

    return judged(_mean_of_cells, *falls, text=text)


def rises_again(factor: float = 1.05, setup: str = STATE_FEEDBACK.name) -> Measured:
    """Share of networks whose last test error is well above their best one."""
    cells = results.read("table-4-1")["setups"][setup]
    worse = {
        w: np.array(cells[str(w)]["errors"]["test"]) > factor * np.array(cells[str(w)]["best test"])
        for w in WINDOWS
    }
    text = ", ".join(f"{x.sum()} of {x.size} at {w}" for w, x in worse.items())
    return judged(_mean_of_cells, *worse.values(), text=text)


def magnitudes(
    narrow: int = 21, wide: int = 41, beside_filters: bool = False, setup: str = STATE_FEEDBACK.name
) -> Measured:
    """Largest weight of a wide window over a narrow one's; beside it least-squares taps."""
    by_width = results.read("table-4-1")["setups"][setup]
    cells = [np.array(by_width[str(w)]["largest weight"]) for w in (wide, narrow)]
    taps = [np.abs(savitzky_golay(w, 2, LOG_STEP, degree=2)).max() for w in (wide, narrow)]
    fall = taps[0] / taps[1]
    unit = fall if beside_filters else 1.0
    if beside_filters:
        printed = paper.LARGEST_WEIGHT[wide] / paper.LARGEST_WEIGHT[narrow]
        text = f"times the filter's ratio, as printed {significant(printed / fall, 2)} times"
    else:
        text = f"of the weight at {narrow}, the filter {significant(fall, 2)}"
    return judged(
        lambda a, b: median(a) / median(b) / unit,
        *cells,
        text=lambda value: f"{significant(value, 2)} {text}",
    )


# --- ddlib.learning.span: the directions of the windows


def _learning(width: int, case: int) -> dict:
    """A cell of the study "span": `case` 0, inputs 0 to 1; 1, -1 to 1; 2, damped joints."""
    return results.read("span")["cells"][len(WINDOWS) * case + WINDOWS.index(width)]


def halved(first: list, then: list) -> Measured:
    """Epoch at which some directions' parts of the error are half over others', geometric means."""
    cell, ratios = _learning(21, 0), {}
    for who in ("measured", "predicted"):
        halves = np.log(np.array(cell[who]["halves"], float))
        half_first, half_then = (halves[:, np.array(group) - 1].mean(1) for group in (first, then))
        ratios[who] = np.exp(half_then - half_first)
    text = f"{spread(ratios['measured'])}; predicted {spread(ratios['predicted'])}"
    return judged(median, ratios["measured"], text=text)


def centred() -> Measured:
    """Median error with inputs from 0 to 1 over that with -1 to 1, the least of three windows."""

    def pairs(who):
        return [tuple(np.array(_learning(w, k)[who]["rmss"]) for k in (0, 1)) for w in WINDOWS]

    def least(*drawn):
        return np.min([median(a) / median(b) for a, b in drawn], axis=0)

    measured, predicted = (
        ", ".join(significant(np.median(a) / np.median(b), 2) for a, b in pairs(who))
        for who in ("measured", "predicted")
    )
    return judged(least, *pairs("measured"), text=f"{measured}; predicted {predicted}")


def outside_the_span(taken: int = 12, epochs: int = 100) -> Measured:
    """Share of a change of the input weights that no combination of the (few) windows gives."""
    data = TrainingSet.from_recording(committed.training(), 11)
    picked = np.linspace(0, len(data.x) - 1, taken).astype(int)
    x, y, start = data.x[picked], data.y[picked], Weights.random(1, 11)[0]
    now, step = start, 0.0
    for _ in range(epochs):
        error = (now.activity(x)[1] - y).ravel()
        step = 0.9 * step - 0.1 * error @ jacobian(now, x).reshape(error.size, -1)
        now = with_change(now, step)
    change, windows = now.rows - start.rows, with_ones(x)
    residual = change - np.linalg.lstsq(windows.T, change.T, rcond=None)[0].T @ windows
    share = float(np.linalg.norm(residual) / np.linalg.norm(change))
    return Measured(share, f"{scientific(share)}, {taken} windows of {windows.shape[1] - 1} inputs")


def direction_purity(count: int = 9) -> Measured:
    """Least share of one derivative, or the bias, in the first directions of three windows."""
    least = {}
    for width in WINDOWS:
        along = Directions.of(TrainingSet.from_recording(committed.training(), width))
        parts = (content(along.filters[:count]) ** 2).sum(1), along.axes[:count, -1] ** 2
        least[width] = float(np.column_stack(parts).max(1).min())
    text = ", ".join(f"{significant(v, 2)} at {w}" for w, v in least.items())
    return Measured(min(least.values()), f"least share {text}")


def noise_left(width: int = 41) -> Measured:
    """Correlation of trained with initial weights in directions predicted not to be learnt."""
    cell = _learning(width, 0)
    learnt, every = int(np.median(cell["predicted"]["learnt"])), len(cell["variance"])
    correlation = np.array(cell["start kept"])
    text = f"{spread(correlation)} in {every - learnt} of {every} directions"
    return judged(median, correlation, text=text)


def memorised(width: int = 41, days: int = 5, setup: str = STATE_FEEDBACK.name) -> Measured:
    """Error on the training motions recorded anew over that on the training set.

    On other days noise and the encoders' zero differ, motions and arm do not.
    """
    training, ratios = committed.training(setup), []
    anew = [split(SETUPS[setup].repeated(1 + k).record())[0] for k in range(days)]
    for size in (width, 21):
        model = committed.networks(size, setup)
        errors = [rmss(model.torque(x), y) for x, y in (cases(r, size) for r in (training, *anew))]
        ratios.append(np.array(errors[1:]).T / errors[0][:, None])
    text = (
        f"{spread(ratios[0], 3)} times the training error; {significant(np.median(ratios[1]), 3)}"
    )
    return judged(median, ratios[0], text=f"{text} at 21")


def short_window(bits: tuple = (16, 15, 14, 13, 12, 11), more: float = 1.1) -> Measured:
    """Resolution of the encoders from which on window 11 has the worse acceleration than 21.

    In bits a turn: where the error at 11 is `more` times that at 21.
    """
    ratios = []
    for count in bits:
        rounded = Quantisation(2 * np.pi / 2**count)
        effects = replace(STATE_FEEDBACK.effects, encoder=(rounded,))
        run = split(replace(STATE_FEEDBACK, effects=effects).record())[0]
        ratios.append(acceleration_error(run, 11) / acceleration_error(run, 21))
    turn = turns_at([2.0**-count for count in bits], ratios, more)
    text = f"{significant(ratios[0], 2)} times the error at 21 with the assumed {bits[0]} bits"
    text += f"; {significant(more, 2)} times with {-np.log2(turn):.1f} bits"
    return Measured(float(-np.log2(turn)), text)
