"""The lesson *Motor models of walking robots*: its numbers, figure of copies, widget, checks."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import numpy as np
import torch

from beyond.studies.walking import STEP, gradient, layers, torque
from ddlib import figures
from ddlib.tables import quote
from ddlib.widgets.base import CurveWidget
from ddlib.widgets.parts.panels import Panel
from ddlib.widgets.parts.parameters import Choice
from workshop import BOOK
from workshop.chapters.exercises import Between, Exercise, judging
from workshop.report import results
from workshop.report.evidence.verdicts import Measured

_REACH = 41  # samples of the memory that are read
_SMALL = 0.05, 2.0  # rad, Hz: histories of the first figure
_SIZES = 0.02, 0.1, 0.3, 0.8  # of the widget's jump, rad
_KINDS = {
    "copies": "copies, 1,500 epochs",
    "longer": "copies, 20,000 epochs",
    "held": "copies, jumping targets",
    "slow": "copies, 20,000 epochs, slow targets",
    "fixed": "copies, fixed targets",
    "shuffled": "shuffled",
}
_JUMPS = 24  # samples that a jump of the widget may be old


def _sines(size, frequency, samples, cases=300, speed=0.0):
    t, w = -STEP * np.arange(samples), 2 * np.pi * frequency
    phase = np.random.default_rng(0).uniform(0, 2 * np.pi, (cases, 1))
    return size * np.sin(w * t + phase), speed + size * w * np.cos(w * t + phase)


def _squashed(s):
    return 1 / (1 + np.exp(-s))


@cache
def _memory() -> dict[str, np.ndarray]:
    with np.load(BOOK / "data" / "anydrive-lstm.npz") as stored:
        return dict(stored)


def _remembered(x) -> np.ndarray:
    """Torque of ANYmal's network after each sample of histories, shape (cases, samples)."""
    weights = _memory()
    h, c, torques = np.zeros((2, len(x), 8)), np.zeros((2, len(x), 8)), []
    for z in np.moveaxis(x * weights["in_scale"], 1, 0):
        for k in (0, 1):
            s = z @ weights[f"lstm_weight_ih_l{k}"].T + weights[f"lstm_bias_ih_l{k}"]
            s += h[k] @ weights[f"lstm_weight_hh_l{k}"].T + weights[f"lstm_bias_hh_l{k}"]
            i, f, new, o = np.split(s, 4, axis=-1)
            c[k] = _squashed(f) * c[k] + _squashed(i) * np.tanh(new)
            z = h[k] = _squashed(o) * np.tanh(c[k])
        torques.append(z @ weights["linear_weight"][0] + weights["linear_bias"][0])
    return np.stack(torques, axis=1) * weights["out_scale"][0]


def _answers(size, frequency, speed=0.0, cases=100) -> np.ndarray:
    """Gradient of the last torque by age of error and velocity, shape (cases, 2, samples)."""
    error, velocity = _sines(size, frequency, 2 * _REACH, cases, speed)
    history = torch.tensor(np.stack([error, velocity], -1)[:, ::-1].copy(), requires_grad=True)
    weights = {name: torch.tensor(value).double() for name, value in _memory().items()}
    lstm = torch.nn.LSTM(2, 8, 2, batch_first=True).double()
    lstm.load_state_dict({name: weights[f"lstm_{name}"] for name in lstm.state_dict()})
    output = lstm(history * weights["in_scale"])[0][:, -1]
    torque = output @ weights["linear_weight"][0] * weights["out_scale"][0]
    (slopes,) = torch.autograd.grad(torque.sum(), history)
    return np.moveaxis(slopes.numpy()[:, ::-1][:, :_REACH], 1, 2)


def _moments(g) -> np.ndarray:
    """Stiffness (N m/rad), delay (ms) and damping (N m s/rad) of answers, shape (..., 3)."""
    g = np.asarray(g, dtype=float)
    position, velocity = np.split(g, 2, axis=-1)
    stiffness = position.sum(-1)
    delay = position @ (1e3 * STEP * np.arange(position.shape[-1])) / stiffness
    return np.stack([stiffness, delay, velocity.sum(-1)], axis=-1)


def _of_go1(size, frequency, speed=0.0) -> np.ndarray:
    x = np.concatenate(_sines(size, frequency, 3, speed=speed), axis=1)
    return -gradient(x, layers())


def _of_memory(size, frequency, speed=0.0) -> np.ndarray:
    return (_answers(size, frequency, speed) * [[1], [-1]]).reshape(100, -1)


def _study() -> dict:
    slow = results.read("walking-slow")
    return {**results.read("walking"), "slow": slow["slow"], "network, slow": slow["network"]}


def _rows(name: str) -> np.ndarray:
    return -np.array([row["gradient"] for row in _study()[name]])


def _own(kind: str) -> np.ndarray:
    study = _study()
    return -np.array(study.get(f"network, {kind}", study["network"]))


def _named(g) -> dict[str, np.ndarray]:
    stiffness, delay, damping = np.moveaxis(_moments(g), -1, 0)
    net = damping - stiffness * delay / 1e3
    return {"stiffness": stiffness, "delay": delay, "net damping": net}


def moments_agree(kind: str = "copies", names: Sequence[str] = ("stiffness", "delay")) -> Measured:
    """Largest relative departure of a copy's moments from the network's own."""
    own, others = _named(_own(kind)), _named(_rows(kind))
    off = np.abs([others[name] / own[name] - 1 for name in names])
    text = f"{100 * off.max():.1f} % at most, of {off.shape[1]} copies"
    return Measured(off.max(), text)


def lags_differ() -> Measured:
    """Range over the copies of the share of the stiffness that the middle sample has."""
    shares = _middle(_rows("copies"))
    text = f"{100 * shares.min():.0f} to {100 * shares.max():.0f} % of the stiffness"
    return Measured(np.ptp(shares), text)


def shape_off() -> Measured:
    """Largest departure of that share from the network's, trained longer or on jumps."""
    off = [np.abs(_middle(_rows(kind)) - _middle(_own(kind))) for kind in ("longer", "held")]
    longer, held = (100 * part.max() for part in off)
    text = f"{longer:.1f} % of the stiffness (longer) and {held:.1f} % (jumps) at most"
    return Measured(np.max(off), text)


def _middle(g) -> np.ndarray:
    position = g[..., :3]
    return position[..., 1] / position.sum(-1)


def _quoted() -> None:
    """The numbers of the lesson's prose."""
    quote("walk-fixed-off", 100 * moments_agree("fixed", ["stiffness", "net damping"]).value)
    quote("walk-quick-go1", _moments(_of_go1(0.02, 2.0, -15.0).mean(0))[0])
    for robot in ("Go1", "ANYmal"):
        percent = _jumped(robot, _JUMPS, _SIZES[1])["torque"]
        quote(f"walk-half-{robot.lower()}", round(1e3 * STEP * np.argmax(percent >= 50)))
    shuffled = _rows("shuffled")[:, :3]
    quote("walk-null-bar", np.abs(shuffled).max())
    quote("walk-null-stiffness", np.abs(shuffled.sum(1)).max())


def by_lag() -> figures.Illustration:
    """Answers to the error by its age, of both networks and of copies."""
    own, memory = _own("copies"), _of_memory(*_SMALL).mean(0)
    age = 1e3 * STEP * np.arange(_REACH)
    lines = {
        "trained briefly": _rows("copies"),
        "longer, or jumps": np.concatenate([_rows("longer"), _rows("held")]),
    }
    (go1, delay, _), (anymal, its_delay, _) = _moments(own), _moments(memory)

    def draw(figure):
        left, right = figure.subplots(1, 2, width_ratios=(1, 2))
        left.bar(age[:3], own[:3], 3.5, color=figures.TONES["network"])
        for name, answers in lines.items():
            drawn = left.plot(age[:3], answers[:, :3].T, lw=0.8, **figures.looks(lines)[name].line)
            drawn[0].set_label(name)
        figures.legend_above(figure, *left.get_legend_handles_labels())
        left.set(title=f"Go1: {go1:.0f} N m/rad, {delay:.0f} ms late", xticks=age[:3])
        right.bar(age, memory[:_REACH], 3.5, color=figures.TONES["network"])
        right.set(title=f"ANYmal: {anymal:.0f} N m/rad, {its_delay:.0f} ms late")
        for axis in (left, right):
            axis.axhline(0, color=figures.INK, lw=0.7)
            axis.set(xlabel="the error is so old, ms", ylabel="answer, N m/rad")

    alt = (
        f"Answers to the position error by its age. Go1: nearly all of {go1:.0f} N m/rad at 5 ms, "
        "as in copies trained for longer or on jumps; brief ones spread it over 0 to 10 ms. "
        f"ANYmal: a hump over 70 ms with the sum {anymal:.0f} N m/rad and the mean "
        f"{its_delay:.0f} ms."
    )
    return figures.illustrate(draw, alt, 7.2, 2.4)


def over_sizes() -> tuple[Sequence[str], list]:
    """Table of moments over sizes and frequencies, with their spread."""
    rows = []
    for name, of in (("Go1", _of_go1), ("ANYmal", _of_memory)):
        for frequency in (1, 3, 10):
            for size in (0.01, 0.1, 0.4):
                moments = _moments(of(size, frequency))
                whole = _moments(of(size, frequency).mean(0))
                cells = (f"{m:.2f} ({s:.2f})" for m, s in zip(whole, moments.std(0)))
                rows.append((name, f"{frequency} Hz", f"{size:g} rad", *cells))
    heads = ("network", "frequency", "size", "stiffness, N m/rad", "delay, ms")
    return (*heads, "damping, N m s/rad"), rows


def shares() -> tuple[Sequence[str], list]:
    """Table of the middle bar's share, stiffness and delay: the network, and ranges of copies."""
    rows = [("network", *_ends(_own("copies")[None]))]
    for kind, name in list(_KINDS.items())[:-1]:
        rows.append((name, *_ends(_rows(kind))))
    heads = ("the Go1's network and its copies", "middle bar, % of K", "K, N m/rad")
    return (*heads, "d, ms"), rows


def _ends(g) -> list[str]:
    values = (100 * _middle(g), 0), *((part, 1) for part in _moments(g).T[:2])
    ends = [[f"{x:.{n}f}" for x in (v.min(), v.max())] for v, n in values]
    cells = (low if low == high else f"{low} to {high}" for low, high in ends)
    return [cell.replace("-", "−") for cell in cells]


def copies() -> tuple[Sequence[str], list]:
    """Table of the network, and of the ranges of its copies and of the nulls."""
    study = _study()
    rows = [("network", "0", *_ranges(_own("copies")[None]))]
    for kind, name in _KINDS.items():
        errors = [row["error"] for row in study[kind]]
        ranges = f"{min(errors):.3f} to {max(errors):.3f}"
        rows.append((name, ranges, *_ranges(_rows(kind), kind != "shuffled")))
    random = -np.array(study["random"])
    ends = np.percentile([random[:, 1], random[:, :3].sum(1)], (5, 95), axis=1)
    ranges = [f"{a:.1f} to {b:.1f}" for a, b in ends.T]
    rows.append(("random, nine tenths of 100", "", *ranges, "", "", ""))
    rows = [tuple(cell.replace("-", "−") for cell in row) for row in rows]
    heads = ("who", "error, RMSS", "middle bar", "K, N m/rad", "d, ms")
    return (*heads, "B, N m s/rad", "B − Kd"), rows


def _ranges(g, sure: bool = True) -> list[str]:
    ranges = []
    for k, values in enumerate((g[:, 1], *_named(g).values(), _moments(g)[:, 2])):
        least, most = (f"{v:.{2 if k > 2 else 1}f}" for v in (values.min(), values.max()))
        ranges.append(least if least == most else f"{least} to {most}")
    middle, stiffness, delay, net, damping = ranges
    return [middle, stiffness, delay if sure else "", damping, net if sure else ""]


def _exercise(number: int, left: float | None = None) -> Exercise:
    """An exercise of the lesson."""
    if number == 1:
        slips = [(85 / 0.011, "divide or multiply?"), (85 * 11, "the delay is in milliseconds.")]
        return Exercise(
            "number",
            85 * 0.011,
            "a late spring takes away damping, by stiffness times delay.",
            slips,
            "Expand the late error in d.",
            unit="N m s/rad",
        )
    elif number == 2:
        slips = [
            (Between(0, left), "the share is larger."),
            (Between(left, 1), "the share is smaller."),
        ]
        return Exercise(
            "number", left, "that close is no guess.", slips, "A share lies between 0 and 1.", 0.2
        )
    else:

        def apart(e):
            now, one, two = e
            return abs(20 * (one - (now + one + two) / 3)) >= 2 and max(map(abs, e)) <= 0.1

        slips = [(lambda e: max(map(abs, e)) > 0.1, "an error is above 0.1 rad.")]
        reason = "it turns at every sample, as no smooth motion does."
        return Exercise(
            "numbers",
            apart,
            reason,
            slips,
            "Write down the difference of the two torques first.",
            count=3,
        )


check = judging(_exercise)


class LateSpring(CurveWidget):
    """An error jumps; its age and size are turned, and each sample's share of the answer shown."""

    def __init__(self, **options):
        age = 1e3 * STEP * np.arange(_JUMPS + 1)
        super().__init__(
            _jumped,
            [
                Choice("robot", "Network of", ["Go1", "ANYmal"], "Go1"),
                Choice(
                    "old", "Age of the jump", {n: f"{5 * n} ms" for n in range(25)}, 0, "slider"
                ),
                Choice("size", "Size of the jump", {s: f"{s:g} rad" for s in _SIZES}, 0.1),
            ],
            [
                Panel(
                    "Position error, by how old it is, rad",
                    ("error",),
                    "age, ms",
                    age,
                    kind="stems",
                    y_range=(0.0, 0.8),
                ),
                Panel(
                    "Torque, % of that 120 ms after the jump",
                    {"torque": "so far"},
                    "time, ms",
                    age,
                    y_range=(-10.0, 140.0),
                ),
                Panel(
                    "What the torque listens to, N m/rad",
                    ("answer",),
                    "age, ms",
                    age,
                    kind="stems",
                    y_fit=True,
                ),
            ],
            **{
                "title": "A target jumps",
                "alt": "The error's history, the torque since it jumped, and the share of each "
                "sample in the answer.",
                "note": "The joint is held. Positive torque would turn it towards its target. "
                "The line is level from the jump's age on, because the future is not known yet. "
                "What the torque listens to: how much it would change with an error of that age.",
                **options,
            },
        )


def _jumped(robot: str, old: int, size: float) -> dict[str, np.ndarray]:
    """The error by age, the torque since the jump (%), and the gradient by age."""
    reach = _JUMPS + 1
    error = np.where(np.arange(reach) <= old, size, 0.0)
    steps = np.concatenate([np.zeros(reach + 16), np.full(reach, size)])
    if robot == "Go1":
        seen = np.stack([steps[2 - k : len(steps) - k] for k in range(3)], -1)
        torques = -torque(np.column_stack([seen, np.zeros_like(seen)]), layers())
        torques = (torques - torques[-reach - 1])[-reach:]
        now = np.concatenate([error[:3], np.zeros(3)])
        answer = np.zeros(reach)
        answer[:3] = -gradient(now[None], layers())[0, :3]
    else:
        torques = _remembered(np.stack([steps, np.zeros_like(steps)], -1)[None])[0]
        torques = (torques - torques[-reach - 1])[-reach:]
        now = np.concatenate([np.zeros(40), error[::-1]])
        push = 1e-5 * np.eye(len(now))[::-1][:reach]
        ends = [
            _remembered(np.stack([now + s * push, np.zeros_like(push)], -1))[:, -1] for s in (1, -1)
        ]
        answer = (ends[0] - ends[1]) / 2e-5
    torques = 100 * torques / torques[-1]
    so_far = np.where(np.arange(reach) <= old, torques, np.nan)
    return {"error": error, "torque": np.nan_to_num(so_far, nan=torques[old]), "answer": answer}
