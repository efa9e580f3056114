"""The engine's equations in JavaScript, written from the sources that the simulator uses.

Rigid-body dynamics come from the symbolic derivation (`ddlib.dynamics.derive`). Friction laws and
the encoder come from the numpy code in `ddlib.effects`, which is run on symbols: an array of
objects calls their methods, and `_Traced` writes down what is done to it. What comes out is
committed as ``static/physics.js``; ``python -m ddlib.widgets.engine.physics`` writes it anew, and
a test compares.
"""

from __future__ import annotations

import operator
from pathlib import Path

import numpy as np
import sympy as sp
from sympy.printing.jscode import JavascriptCodePrinter

from ddlib.dynamics import derive
from ddlib.effects import CoulombFriction, Quantisation, ViscousFriction

FILE = Path(__file__).parents[1] / "static" / "physics.js"

HEAD = """\
// Equations of a two-link arm, its friction and its encoder. Written by engine/physics.py from
// ddlib's derivation and effects: change those, then run `python -m ddlib.widgets.engine.physics`.

// The nearest whole number, the even one of two that are as near.
function rint(x) {
  const near = Math.round(x);
  return near - x === 0.5 && near % 2 ? near - 1 : near;
}"""

ARM = sp.symbols("a b d g1 g2")  # base parameters (kg m^2), gravity moments (N m) of an `Arm`

_rint = sp.Function("rint")


class _Traced:
    """A number that stands for an expression, for numpy code over arrays of objects."""

    def __init__(self, expression):
        self.expression = sp.sympify(expression)

    def tanh(self):
        return _Traced(sp.tanh(self.expression))

    def rint(self):
        return _Traced(_rint(self.expression))


def _traced_operator(name):
    act = getattr(operator, name)

    def forward(self, other):
        return _Traced(act(self.expression, getattr(other, "expression", other)))

    def backward(self, other):
        return _Traced(act(other, self.expression))

    setattr(_Traced, f"__{name}__", forward)
    setattr(_Traced, f"__r{name}__", backward)


for _name in ("add", "sub", "mul", "truediv"):
    _traced_operator(_name)


def _law(kind, **values):
    """An effect whose values are symbols; its own checks are for numbers."""
    law = object.__new__(kind)
    for name, value in values.items():
        object.__setattr__(law, name, _Traced(value))
    return law


class _Printer(JavascriptCodePrinter):
    """Squares as products, and no name of a library but Math's."""

    def _print_Pow(self, expr):
        if expr.exp == 2 and expr.base.is_Symbol:
            name = self._print(expr.base)
            return f"{name}*{name}"
        return super()._print_Pow(expr)

    def parenthesize(self, item, level, strict=False):
        if item.is_Pow and item.exp == 2:  # a product now
            return f"({self._print(item)})"
        return super().parenthesize(item, level, strict)


def _function(name, about, arguments, results) -> str:
    """A JavaScript function that shares common subexpressions; returns a list of two or more."""
    shared, results = sp.cse(results, symbols=sp.numbered_symbols("x"))
    printer = _Printer({"user_functions": {"rint": "rint"}})
    lines = [f"  const {symbol} = {printer.doprint(part)};" for symbol, part in shared]
    texts = [printer.doprint(result) for result in results]
    answer = f"[{', '.join(texts)}]" if len(texts) > 1 else texts[0]
    lines = [f"// {about}", f"function {name}({arguments}) {{", *lines, f"  return {answer};", "}"]
    return "\n".join(lines)


def physics() -> str:
    """The text of ``static/physics.js``."""
    arm = derive(2, gravity=True)
    a, b, d, g1, g2 = ARM
    base = dict(zip(arm.base, (a - d, b, d, g1, g2)))
    torque = [part.subs(base) for part in arm.torque]
    applied = sp.symbols("t1 t2")
    mass = sp.Matrix([[sp.expand(part).coeff(x) for x in arm.qdd] for part in torque])
    still = dict.fromkeys(arm.qdd, 0)
    rest = [given - part.subs(still) for given, part in zip(applied, torque)]
    m12, m22 = sp.symbols("m12 m22")
    m11 = sp.Symbol("m11")
    names = {m11: mass[0, 0], m12: mass[0, 1], m22: mass[1, 1]}
    solved = sp.Matrix([[m22, -m12], [-m12, m11]]) * sp.Matrix(rest)
    determinant = m11 * m22 - m12 * m12
    acceleration = [(part / determinant).subs(names) for part in solved]
    speed, position = sp.symbols("v x")
    viscous, coulomb, smoothing, step = sp.symbols("viscous coulomb smoothing step")
    laws = (
        _law(ViscousFriction, coefficient=viscous),
        _law(CoulombFriction, level=coulomb, smoothing=smoothing),
    )
    friction = sum((law.torque(_Traced(speed)) for law in laws[1:]), laws[0].torque(_Traced(speed)))
    read = _law(Quantisation, step=step).apply(np.asarray(_Traced(position)))
    arm_names, q = "{ a, b, d, g1, g2 }", "q1, q2, qd1, qd2"
    entries = [mass[0, 0], mass[0, 1], mass[1, 1]]
    functions = [
        (
            "armTorque",
            "Torques (N m) of angles (rad), velocities (rad/s) and accelerations (rad/s^2).",
            f"{arm_names}, {q}, qdd1, qdd2",
            torque,
        ),
        (
            "armAcceleration",
            "Accelerations (rad/s^2) under torques t1, t2 (N m).",
            f"{arm_names}, {q}, t1, t2",
            acceleration,
        ),
        (
            "armMass",
            "Entries 11, 12 and 22 of the mass matrix (kg m^2).",
            "{ a, b, d }, q2",
            entries,
        ),
        (
            "frictionTorque",
            "Viscous and Coulomb friction (N m) of a joint at the velocity v (rad/s).",
            "viscous, coulomb, smoothing, v",
            [_plain(friction)],
        ),
        ("encoderReading", "An angle (rad) as the encoder reads it.", "step, x", [_plain(read)]),
    ]
    return "\n\n".join([HEAD, *(_function(*function) for function in functions)]) + "\n"


def _plain(traced):
    """The expression behind the result of traced code."""
    return np.asarray(traced).item().expression


if __name__ == "__main__":
    FILE.write_text(physics(), encoding="utf-8")
