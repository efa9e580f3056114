"""A window whose weights the reader draws, to measure acceleration from an encoder's readings."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import traitlets as t

from ddlib.analysis import savitzky_golay
from ddlib.learning import sliding_windows
from ddlib.metrics import rmss
from ddlib.setups import JOINT_DAMPING, Setup, split, true_states
from ddlib.simulation import LOG_STEP
from ddlib.widgets.base import PageWidget
from ddlib.widgets.engine._plain import plant
from ddlib.widgets.parts.panels import Panel
from ddlib.widgets.scripts import bundle, styles
from ddlib.widgets.still import still_picture

_HERE = Path(__file__).parent

_WIDTH = 21  # stems of the window
_ZEROS = 20  # other zeros of the encoder by which the same motion is read again
_FINEST = 1e-9  # step that stands for no encoder, rad
_LEVELS = 600  # a stem stands at a whole multiple of one part in so many of its largest height
_TALL = 0.9  # largest stem of a starting point, of the height there is

_HINT = (
    "Drag the dots, or sweep across them in one stroke. By touch, begin beside the dots and sweep "
    "sideways. By keyboard, the arrow keys choose a stem and move it, with Shift faster. Only the "
    "shape counts: the page finds the best factor and constant. An error of 1 is as bad as always "
    "guessing the mean."
)


@cache
def readings(setup: Setup = JOINT_DAMPING) -> tuple[np.ndarray, np.ndarray, float]:
    """The shoulder along trajectory 6, by default of the set-up with damped joints.

    Returns true positions (rad, half a window more than the motion at either end), true
    accelerations in the motion (rad/s^2), and the step of the encoder that reads them (rad).
    """
    run = split(setup.record())[1]
    half, step = _WIDTH // 2, plant(setup.arm, setup.effects)["encoder"] or _FINEST
    q = run.q_true[run.motion.start - half : run.motion.stop + half, 0]
    return q, true_states(run, setup)[:, 0, 2], step


def _zeros(setup: Setup) -> np.ndarray:
    """Zeros of the encoder, rad: that of the recording, then `ZEROS` drawn within a step."""
    drawn = np.random.default_rng(15).uniform(0.0, readings(setup)[2], _ZEROS)
    return np.concatenate([[0.0], drawn])


def windows(zero: float = 0.0, setup: Setup = JOINT_DAMPING) -> np.ndarray:
    """Windows of the positions as an encoder with this zero (rad) reads them, shape (300, 21)."""
    q, _, step = readings(setup)
    read = np.round((q + zero) / step) * step - zero
    return sliding_windows(read[:, None], _WIDTH, slice(_WIDTH // 2, len(q) - _WIDTH // 2))[:, 0]


def _fitted(f, zero: float = 0.0, setup: Setup = JOINT_DAMPING) -> np.ndarray:
    """Output of a filter (rad/s^2) with the factor and the constant that fit best, shape (300,)."""
    output, truth = windows(zero, setup) @ f, readings(setup)[1]
    output = output - output.mean()
    power = output @ output
    factor = output @ truth / power if power > 1e-20 else 0.0
    return truth.mean() + factor * output


def score(f, zero: float = 0.0) -> float:
    """RMSS of its fitted output against the true acceleration: 1 is a constant guess."""
    return float(rmss(_fitted(f, zero)[:, None], readings()[1][:, None]))


def _least_squares(setup: Setup = JOINT_DAMPING) -> np.ndarray:
    """The weights with the least `score` there is on the recording, shape (21,)."""
    seen = windows(0.0, setup)
    seen = np.column_stack([seen, np.ones(len(seen))])
    return np.linalg.lstsq(seen, readings(setup)[1], rcond=None)[0][:-1]


def starts() -> dict[str, np.ndarray]:
    """Starting points by name, shape (21,) each, with a largest weight of 0.9."""
    filters = {
        "Second difference": _textbook(3),
        "Savitzky–Golay, 5": _textbook(5),
        "Savitzky–Golay, 11": _textbook(11),
        "Savitzky–Golay, 21": _textbook(21),
        "Velocity": _textbook(21, 1),
    }
    tall = {name: _TALL * f / np.abs(f).max() for name, f in filters.items()}
    return {**tall, "Zero": np.zeros(_WIDTH)}


def _textbook(width: int, derivative: int = 2) -> np.ndarray:
    """A filter of Savitzky and Golay with zeros around it."""
    f = savitzky_golay(width, derivative, LOG_STEP, degree=2 if width == 3 else 3)
    return np.pad(f, (_WIDTH - width) // 2)


class FilterBuilder(PageWidget):
    """Draw 21 weights that measure acceleration; see output and error at once.

    Everything is computed in the page, with a kernel and without. Least squares and a trained
    unit can be laid over one's own filter once it has been changed.

    Parameters
    ----------
    unit : array_like, shape (21,)
        The trained unit: its weights, oldest sample first.
    setup : Setup
        Whose shoulder moves along trajectory 6, and whose encoder, if any, reads it.
    """

    _esm = bundle(_HERE / "builder.js")
    _css = styles(_HERE / "builder.css")

    motion = t.Bytes(help="true positions, then accelerations, as float64", read_only=True)
    motion.tag(sync=True)

    def __init__(self, unit, setup: Setup = JOINT_DAMPING):
        unit = np.asarray(unit, float)
        q, truth, step = readings(setup)
        time = np.arange(truth.size) * LOG_STEP
        most = 1.25 * np.abs(truth).max()

        others = {"unit output": "a trained unit", "least output": "least squares"}
        output = {"own output": "yours", "truth": "true", **others}
        own = {"yours": "network", "a trained unit": "network", "least squares": "before"}
        panel = Panel(
            "Acceleration, rad/s²", output, "time, s", time, y_range=(-most, most), roles=own
        )
        spec = {
            "title": "Draw a filter by hand: measure acceleration",
            "hint": _HINT,
            "width": _WIDTH,
            "samples": len(q),
            "period": LOG_STEP,
            "step": step,
            "zeros": _zeros(setup).tolist(),
            "levels": _LEVELS,
            "starts": [[name, f.tolist()] for name, f in starts().items()],
            "rivals": [
                ["unit", "A trained unit", unit.tolist()],
                ["bare", "That unit without its mean", (unit - unit.mean()).tolist()],
                ["least", "Least squares on this recording", _least_squares(setup).tolist()],
            ],
            "panels": [panel.description()],
            "curves": [{"name": name, "low": -most, "high": most} for name in output],
        }
        motion = np.concatenate([q, truth]).astype("<f8").tobytes()
        still, alt = _still(time, truth, setup)
        self._keep(spec=spec, motion=motion, still=still, still_alt=alt)
        super().__init__()


def _still(time, truth, setup) -> tuple[str, str]:
    """A textbook filter and its output, and what the picture shows."""
    name = "Savitzky–Golay, 11"
    f = starts()[name]
    half = _WIDTH // 2 * LOG_STEP * 1e3
    curves = {"weights": f, "output": _fitted(f, 0.0, setup)}
    panels = [
        Panel(
            "Weights", {"weights": name}, "time from the centre, ms",
            np.linspace(-half, half, _WIDTH), kind="stems", roles={name: "network"},
        ),
        Panel(
            "Acceleration, rad/s²", {"output": "filter"}, "time, s", time, fixed={"true": truth},
            roles={"filter": "network"},
        ),
    ]  # fmt: skip
    alt = (
        "A window of 21 weights as stems. Its output over the true acceleration of the shoulder "
        "along trajectory 6."
    )
    return still_picture(curves, panels, {}, None, alt), alt
