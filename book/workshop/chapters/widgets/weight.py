"""One unit with one weight: its error over the weight, the slope there, and steps downhill."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ddlib.widgets import CurveWidget, Live, Panel, Parameter, Scalar, bundle, styles

_HERE = Path(__file__).parent

WANTED = 0.7  # What the unit should answer to an input of 1
_WEIGHTS = np.linspace(-8.0, 8.0, 161)
_STEEPEST = 0.1  # more than any slope of the error


class OneWeight(CurveWidget):
    """Turn the weight of a single unit by hand, then let it step against the slope.

    The unit has an input of 1 and no bias, so its sum is the weight. It should answer 0.7. The page
    keeps the steps it was told to make as points on the curve, and repeats a share `momentum` of
    the last one; whoever moves the weight by hand begins anew.
    """

    _esm = bundle(_HERE / "weight.js")
    _css = styles(_HERE / "weight.css")

    def __init__(self):
        weight = "weight"
        lines = {"error": "error", "tangent": "slope at this weight"}
        middle = WANTED**2 / 2
        super().__init__(
            _curves,
            [
                Parameter("weight", "Weight", -8, 8, -2),
                Parameter("size", "Step size", 1, 100, 10, scale="log"),
                Parameter("momentum", "Share of the last step repeated", 0, 0.95, 0),
            ],
            [
                Panel("Error", lines, weight, _WEIGHTS, cursor="at", y_range=(0.0, 1.1 * middle)),
                Panel(
                    "Answer",
                    {"answer": "answer"},
                    weight,
                    _WEIGHTS,
                    fixed={"wanted": np.full(_WEIGHTS.size, WANTED)},
                    cursor="at",
                    y_range=(0.0, 1.0),
                    roles={"answer": "network"},
                ),
            ],
            title="One weight",
            alt="Left, the error of a unit over its weight: flat, then a valley, then flat; "
            "a straight line touches it at the weight as it stands; a ring is where the next step "
            "lands. Right, the unit's answer, "
            "an S from 0 to 1, with the answer that is wanted.",
            scalars=[
                Scalar("answers", f"Answer (wanted: {WANTED})", digits=3),
                Scalar("errs", "Error", digits=4),
                Scalar("slope", "Slope of the error", digits=4),
                Scalar("step", "Next step of the weight", digits=3),
            ],
            live=Live(
                ranges={
                    **dict.fromkeys(("error", "tangent", "errs"), (0.0, middle)),
                    **dict.fromkeys(("answer", "answers"), (0.0, 1.0)),
                    "slope": (-_STEEPEST, _STEEPEST),
                    "at": (-8.0, 8.0),
                    "step": (-8.0, 8.0),
                }
            ),
        )


def _curves(weight: float, size: float, momentum: float) -> dict:
    """What the unit does at a weight; the first step, which has no momentum yet."""
    answer, error, slope = _unit(weight)
    all_answers, all_errors, _ = _unit(_WEIGHTS)
    return {
        "error": all_errors,
        "tangent": error + slope * (_WEIGHTS - weight),
        "answer": all_answers,
        "at": weight,
        "answers": answer,
        "errs": error,
        "slope": slope,
        "step": -size * slope,
    }


def _unit(weight):
    """Answer, error, and the error's slope."""
    y = 0.5 + 0.5 * np.tanh(np.asarray(weight) / 2)
    return y, (y - WANTED) ** 2 / 2, (y - WANTED) * y * (1 - y)
