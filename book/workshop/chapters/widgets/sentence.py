"""Sentences whose numbers the reader moves, and whose end the page computes."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import traitlets as t

from ddlib.dynamics import CMU_DD_ARM_II
from ddlib.effects import IDEAL
from ddlib.figures import illustrate
from ddlib.setups import JOINT_DAMPING_KP as KP, JOINT_DAMPING_VISCOUS
from ddlib.simulation import CONTROL_STEP
from ddlib.widgets.base import PageWidget
from ddlib.widgets.engine._plain import plant
from ddlib.widgets.parts._common import key_of
from ddlib.widgets.parts.parameters import Parameter
from ddlib.widgets.scripts import bundle, styles
from ddlib.widgets.still import START, encoded
from workshop.chapters.widgets.loops import linear, modes

_HERE = Path(__file__).parent

# Friction of the joints, over the shoulder's
_SHARE = np.array([1.0, JOINT_DAMPING_VISCOUS[1] / JOINT_DAMPING_VISCOUS[0]])


class _LiveSentence(PageWidget):
    """A sentence with numbers to drag or to step, and the consequence in the same sentence.

    `parts` are its pieces: plain text, a name of a number in braces, and once or more a name of a
    result in angle brackets. `steps` says how far an arrow key or six pixels move a number; `data`
    is what the script's function (static/sentence.js) needs, with the name of it in ``kind``; in
    the Python `code` names of numbers in braces stand for their values.
    """

    _esm = bundle(_HERE / "sentence.js")
    _css = styles(_HERE / "sentence.css")

    values = t.Dict(help="the numbers by name").tag(sync=True)

    def __init__(
        self,
        parts: Sequence[str],
        parameters: Sequence[Parameter],
        steps: Mapping[str, float],
        data: Mapping,
        code: str,
    ):
        self._numbers = {p.name: p for p in parameters}
        numbers = [{**p.description(), "step": steps[p.name]} for p in parameters]
        spec = {"key": key_of(type(self)), "code": code, "parts": list(parts), "numbers": numbers}
        self.set_trait("spec", {**spec, **data})
        super().__init__(values={p.name: p.value for p in parameters})
        text = self.text()
        self._keep(still=_picture(text), still_alt=text)

    @t.validate("values")
    def _whole(self, proposal):
        return {**{name: p.value for name, p in self._numbers.items()}, **proposal["value"]}

    def results(self, **values) -> dict[str, str]:
        """The texts that end the sentence, by ddlib; what the page must show."""
        raise NotImplementedError

    def text(self) -> str:
        """The whole sentence as it stands."""
        shown = {f"{{{name}}}": self.number(name, value) for name, value in self.values.items()}
        shown |= {f"<{name}>": text for name, text in self.results(**self.values).items()}
        return "".join(shown.get(part, part) for part in self.spec["parts"])

    def number(self, name, value) -> str:
        """A number with its unit, with as many decimals as its step has."""
        step = next(n["step"] for n in self.spec["numbers"] if n["name"] == name)
        digits = max(0, -int(np.floor(np.log10(step) + 1e-9)))
        unit = self._numbers[name].unit
        return f"{_signed(value, digits)}{'' if unit == '°' else ' '}{unit}"


class TorqueSentence(_LiveSentence):
    """Joints that turn at constant speeds, and the torques that this takes."""

    def __init__(self):
        data = {"kind": "torque", "arm": plant(CMU_DD_ARM_II, IDEAL)["arm"]}
        super().__init__(
            [
                "Bend the elbow by ", "{elbow}", ". Let the shoulder turn at ", "{first}",
                " and the elbow at ", "{second}", ", both at constant speed. Then the shoulder's "
                "motor must give ", "<shoulder>", " and the elbow's motor ", "<forearm>", ".",
            ],
            [
                Parameter("elbow", "Elbow angle", -180, 180, 90, "°"),
                Parameter("first", "Speed of the shoulder", -4, 4, 1, "rad/s"),
                Parameter("second", "Speed of the elbow", -4, 4, 2, "rad/s"),
            ],
            {"elbow": 5, "first": 0.1, "second": 0.1},
            data,
            "import numpy as np\n\nfrom ddlib.dynamics import CMU_DD_ARM_II\n\n"
            "q, qd = [0, np.deg2rad({elbow})], [{first}, {second}]\n"
            "CMU_DD_ARM_II.inverse_dynamics(q, qd, [0, 0])",
        )  # fmt: skip

    def results(self, **values) -> dict[str, str]:
        """Torques of both motors, by `ddlib.dynamics.Arm.inverse_dynamics`."""
        q, qd = [0.0, np.deg2rad(values["elbow"])], [values["first"], values["second"]]
        torque = CMU_DD_ARM_II.inverse_dynamics(q, qd, [0.0, 0.0])
        return dict(zip(("shoulder", "forearm"), (f"{_signed(x, 2)} N m" for x in torque)))


class LoopSentence(_LiveSentence):
    """Friction, a period and two gains, and whether the sampled loop is stable.

    The loop is the linear one of the stretched arm, as in the tuner; friction and gains are the
    shoulder's, the elbow's in the ratio of the book's; its damper has a fifth.
    """

    FRICTION = JOINT_DAMPING_VISCOUS[0]  # of the shoulder at which the modes are given, N m s/rad

    def __init__(self):
        super().__init__(
            [
                "A computer reads the arm every ", "{period}", ". It acts as a spring of ", "{kp}",
                " and a damper of ", "{kd}", ". The joint itself has a friction of ", "{friction}",
                ". Then the loop is ", "<verdict>", ".",
            ],
            [
                Parameter("period", "Control period", 0.5, 40, 1e3 * CONTROL_STEP, "ms"),
                Parameter("kp", "Proportional gain", 50, 12000, KP[0], "N m/rad"),
                Parameter("kd", "Derivative gain", 0, 150, 0, "N m s/rad"),
                Parameter("friction", "Viscous friction", 0.1, 10, self.FRICTION, "N m s/rad"),
            ],
            {"period": 0.5, "kp": 50, "kd": 0.5, "friction": 0.1},
            {
                "kind": "loop",
                "modes": modes(CMU_DD_ARM_II, self.FRICTION * _SHARE),
                "friction": self.FRICTION,
                "ratios": {"kp": KP[1] / KP[0], "kd": 0.2},
            },
            "from workshop.chapters.widgets.sentence import LoopSentence\n\n"
            "LoopSentence().growth(period={period}, kp={kp}, kd={kd}, friction={friction})",
        )  # fmt: skip

    def growth(self, *, period, kp, kd, friction) -> float:
        """Growth of the slowest or least stable motion, 1/s, by python-control."""
        ratios = self.spec["ratios"]
        law = {"kp": [kp, kp * ratios["kp"]], "ki": [0.0, 0.0], "kd": [kd, kd * ratios["kd"]]}
        return linear(CMU_DD_ARM_II, friction * _SHARE, law, 0, 1e-3 * period).growth

    def results(self, **values) -> dict[str, str]:
        """Whether the loop is stable, and how soon a disturbance has halved or doubled."""
        growth = self.growth(**values)
        seconds = np.log(2) / abs(growth)
        time = f"{seconds:.2f} s" if seconds < 10 else f"{seconds:.0f} s"
        stable = f"stable, and a disturbance halves in {time}"
        return {"verdict": stable if growth < 0 else f"unstable, and a swing doubles in {time}"}


def _signed(value, digits) -> str:
    text = f"{value:.{digits}f}"
    return text.removeprefix("-") if not float(text) else text.replace("-", "−")


def _picture(text) -> str:
    lines = textwrap.wrap(text, 90)

    def draw(figure):
        figure.text(0.02, 0.5, "\n".join(lines), va="center", fontsize=10)

    return START + encoded(illustrate(draw, text, width=7.0, height=0.15 + 0.2 * len(lines)).svg)
