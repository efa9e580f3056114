"""Handles for the numbers of *Change this*: sliders of a page that runs, beside the code.

The cell's metadata name what has a handle, like ``"dd": {"handles": {"kp": {"unit": "N m/rad"},
"window": {"from": 3, "to": 83, "step": 2}}}``. An entry stands for all numbers that are assigned
to its name in one line, or for one of them: ``"kp[0]"``, ``"link, mass"``. What it does not say is
as usual: from a tenth of the value (whole numbers: a quarter) to four times it, by about a
hundredth.
"""

from __future__ import annotations

import ast
import math
from collections.abc import Iterator
from decimal import Decimal


def handles(cell) -> list[dict]:
    """All handles of a cell, in its order: each is number `place` of `count` in a line."""
    entries = cell.metadata.get("dd", {}).get("handles", {})
    made, known = [], set()
    for node in ast.parse(cell.source).body:
        if not isinstance(node, ast.Assign) or node.lineno != node.end_lineno:
            continue
        numbers = list(_numbers_of(node))
        for place, (name, label, value) in enumerate(numbers):
            known |= {name, label}
            if name in entries or label in entries:
                about = {**entries.get(name, {}), **entries.get(label, {})}
                target = ast.unparse(node.targets[0]).strip("()")
                where = {"target": target, "place": place, "count": len(numbers)}
                made.append({"label": label, **where, **_range(value, about)})
    if strange := entries.keys() - known:
        raise ValueError(f"handles must be numbers of their cell, got {', '.join(strange)}")
    return made


def _numbers_of(node: ast.Assign) -> Iterator[tuple[str, str, float]]:
    """Name, label and value of each number of a line, as they stand in it."""
    target, value = node.targets[0], node.value
    several = isinstance(target, ast.Tuple) and isinstance(value, ast.Tuple)
    for name, part in zip(target.elts, value.elts) if several else [(target, value)]:
        for label, number in _numbers(part):
            yield ast.unparse(name), f"{ast.unparse(name)}{label}", number


def _numbers(node: ast.AST, label: str = "") -> list[tuple[str, float]]:
    """The numbers of a value, each with what tells it from the others."""
    if _is_number(node):
        return [(label, ast.literal_eval(node))]
    if isinstance(node, ast.Tuple | ast.List):
        parts = [(f"[{k}]", part) for k, part in enumerate(node.elts)]
    elif isinstance(node, ast.Call):
        only = len(node.args) == 1 or len(list(filter(_is_number, node.args))) == 1
        alone = only and not node.keywords
        parts = [("" if alone else f", number {k}", a) for k, a in enumerate(node.args, 1)]
        parts += [(f", {word.arg}", word.value) for word in node.keywords]
    else:
        parts = [("", part) for part in ast.iter_child_nodes(node)]
    return [number for more, part in parts for number in _numbers(part, label + more)]


def _is_number(node: ast.AST) -> bool:
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        node = node.operand
    return isinstance(node, ast.Constant) and type(node.value) in (int, float)


def _range(value: float, about: dict) -> dict:
    """Unit, ends and step of a handle, with the value on a step."""
    whole = isinstance(value, int)
    if whole:
        low, high = value // 4 if value >= 10 else min(1, value), max(10, 4 * value)
    else:
        low, high = value / 10, 4 * value or 10
    low, high = about.get("from", low), about.get("to", high)
    step = about.get("step") or _usual_step(value, high - low)
    low = value - step * math.floor((value - low) / step + 1e-9)
    high = value + step * math.floor((high - value) / step + 1e-9)
    digits = 0 if whole else max(1, _decimals(step), _decimals(value))
    low, high, step = (round(end) if whole else round(end, digits) for end in (low, high, step))
    unit = about.get("unit", "")
    return {"unit": unit, "low": low, "high": high, "step": step, "digits": digits}


def _usual_step(value: float, width: float) -> float:
    """A round step, a hundredth of the width or a little more: a mouse hits it.

    The value is a multiple of it, if that leaves ten steps.
    """
    power = math.floor(math.log10(width)) - 3
    steps = [factor * 10.0**k for k in range(power, power + 3) for factor in (1, 2, 2.5, 5)]
    steps = [step for step in steps if width / 100 <= step * (1 + 1e-9) <= width / 10]
    if isinstance(value, int):
        steps = [round(step) for step in steps if step >= 1 and step % 1 == 0] or [1]
    return next((s for s in steps if abs(value / s - round(value / s)) < 1e-6), steps[0])


def _decimals(value: float) -> int:
    return max(0, -Decimal(f"{value:.9g}").normalize().as_tuple().exponent)
