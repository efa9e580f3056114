"""Handles for the numbers of *Change this*: sliders of a page that runs, beside the code.

A number has a handle if it stands in a line `name = ...` that is nothing but names and numbers, at
most four of them for each name. The words after `#` say of what range it is: "0 to 45", "from 5 to
101", "from 7 on", "up to 81", "above 0", "odd"; and what else to try: "; 0.3 hides the filters".
With no such words it goes from a tenth of the value to four times it (whole numbers from a quarter,
from 1000 on to twice it), angles to a right angle or a half turn, zero to 10, a seed to 20. A
fraction of at least a half that has no unit stays below 1, and a window of odd length odd.
"""

from __future__ import annotations

import ast
import math
import re
from typing import NamedTuple

MOST = 4  # numbers of one name: more are a list, to be typed
SEEDS = ("seed", "draw", "day")
WINDOWS = ("window", "width", "sizes", "lengths")  # have a sample in the middle, so they are odd
USUAL = {"bits": (6, 24), "late": (0, 10)}
UNITS = (
    "N m s/rad", "N m/rad", "rad/s²", "rad/s", "m/s²", "kg m²", "N m", "degrees", "samples",
    "trials", "units", "rad", "Hz", "kg", "°", "%", "m", "s",
)  # fmt: skip
NUMBER = r"(\d+(?:\.\d+)?)"
RANGE = re.compile(rf"(?<![\d.]){NUMBER} to {NUMBER}(?![\d.]| (?:a|the) )")
FROM, MORE = re.compile(rf"\bfrom {NUMBER} on\b"), re.compile(rf"\b{NUMBER} or more\b")
UP_TO, ABOVE = re.compile(rf"\bup to {NUMBER}\b"), re.compile(rf"\babove {NUMBER}\b")
TRY = re.compile(rf"; (?:try )?{NUMBER}\b")


class Handle(NamedTuple):
    """A number of a line of code, and where it may go.

    It is number `place` of `count` in the line that assigns to `target`.
    """

    target: str
    name: str
    label: str
    unit: str
    place: int
    count: int
    value: float
    low: float
    high: float
    step: float
    whole: bool


def handles(source: str) -> list[Handle]:
    """All handles of a cell, in its order."""
    found, lines = [], source.splitlines()
    for node in ast.parse(source).body:
        if isinstance(node, ast.Assign) and node.lineno == node.end_lineno:
            comment = lines[node.lineno - 1].encode()[node.end_col_offset :].decode()
            found += _of_line(node, comment.strip().removeprefix("#").strip())
    return found


def _of_line(node: ast.Assign, comment: str) -> list[Handle]:
    target, value = node.targets[0], node.value
    several = isinstance(target, ast.Tuple) and isinstance(value, ast.Tuple)
    pairs = list(zip(target.elts, value.elts) if several else [(target, value)])
    if not all(isinstance(name, ast.Name) for name, _ in pairs):
        return []
    found = [(name.id, label, number) for name, part in pairs for label, number in _numbers(part)]
    words = _pieces(comment, [name.id for name, _ in pairs], found)
    number_of = [name for name, *_ in found]
    return [
        _handle(ast.unparse(target).strip("()"), name, label, number, piece, place, len(found))
        for place, ((name, label, number), piece) in enumerate(zip(found, words))
        if number_of.count(name) <= MOST and _is_plain(dict((n.id, p) for n, p in pairs)[name])
    ]


def _numbers(node: ast.AST, label: str = "") -> list[tuple[str, ast.AST]]:
    """The numbers of a value, each with what tells it from the others."""
    if _is_number(node):
        return [(label, node)]
    if isinstance(node, ast.Tuple | ast.List):
        parts = [(f"[{k}]", part) for k, part in enumerate(node.elts)]
    elif isinstance(node, ast.Call):
        only = len(node.args) == 1 and not node.keywords
        only = only or (len(list(filter(_is_number, node.args))) == 1 and not node.keywords)
        parts = [("" if only else f", number {k}", a) for k, a in enumerate(node.args, 1)]
        parts += [(f", {word.arg}", word.value) for word in node.keywords]
    else:
        parts = [(label, part) for part in ast.iter_child_nodes(node)]
    return [found for more, part in parts for found in _numbers(part, label + more)]


def _is_number(node: ast.AST) -> bool:
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        node = node.operand
    return isinstance(node, ast.Constant) and type(node.value) in (int, float)


def _is_plain(node: ast.AST) -> bool:
    """A number, a tuple or list of some, or a call with such and with names."""
    if isinstance(node, ast.Call):
        return all(map(_is_plain, [*node.args, *(word.value for word in node.keywords)]))
    if isinstance(node, ast.Tuple | ast.List):
        return all(map(_is_number, node.elts))
    name = node.value if isinstance(node, ast.Attribute) else node
    return _is_number(node) or isinstance(name, ast.Name)


def _pieces(comment: str, targets: list[str], found: list) -> list[str]:
    """The words of a comment for each number: one piece a number, one a name, or all for all."""
    if len(targets) == 1 == len(found):
        return [comment]
    for sign in (r"[;,:]", r"[;,]", r";"):
        pieces = [p.strip() for p in re.split(sign + r"\s+(?![^(]*\))", comment)]
        for wanted in (found, targets):
            runs = [pieces[k : k + len(wanted)] for k in range(len(pieces) - len(wanted) + 1)]
            units = [run for run in runs if all(map(_unit, run))]
            whole = runs if len(runs) == 1 and wanted is targets else []
            for run in (units or whole) if len(wanted) > 1 else ():
                return run if wanted is found else [run[targets.index(n)] for n, *_ in found]
    return [comment if len(targets) == 1 else ""] * len(found)


def _unit(words: str) -> str:
    for unit in UNITS:
        if re.match(rf"{re.escape(unit)}(?![\w/²]| and )", words):
            return unit
    return ""


def _handle(target, name, label, node, words, place, count) -> Handle:
    value, unit = ast.literal_eval(node), _unit(words)
    whole = isinstance(value, int)
    low, high = _usual(name, value, unit)
    step = _step(value)
    named = any(word in name for word in WINDOWS)
    if whole and value % 2 == 1 and (named or re.search(r"\bodd\b", words) is not None):
        low, step = 3, 2
    if found := RANGE.search(words):
        low, high = map(float, found.groups())
    if found := FROM.search(words) or MORE.search(words):
        low = float(found[1])
    if found := UP_TO.search(words):
        high = float(found[1])
    if found := ABOVE.search(words):
        low = float(found[1]) + step
    if found := TRY.search(words):
        high = max(high, float(found[1]))
    below, above = ((value - end) / step for end in (low, high))
    low = value - step * math.floor(below + 1e-9)  # so that the value is on a step
    high = value + step * math.floor(1e-9 - above)
    digits = 0 if whole else max(1, -math.floor(math.log10(step)))
    low, high, step = (round(end) if whole else round(end, digits) for end in (low, high, step))
    return Handle(target, name, f"{name}{label}", unit, place, count, value, low, high, step, whole)


def _usual(name: str, value: float, unit: str) -> tuple[float, float]:
    """Where a number may go that says nothing of it."""
    size = abs(value)
    if any(word in name for word in SEEDS):
        return 0, max(20, 2 * size)
    if unit in ("degrees", "°"):
        most = 90 if size <= 90 else 180
        return (-most if value < 0 else 0), most
    if name in USUAL:
        return USUAL[name]
    if value == 0:
        return 0, 10
    if isinstance(value, int):
        low, high = min(1, size), max(10, 4 * size)
        if size >= 10:
            low = size // 4
        high = 2 * size if size >= 1000 else high
    else:
        low, high = size / 10, 4 * size
        if 0.5 <= size < 1 and not unit:
            high = 1 - _step(size)
    return (low, high) if value > 0 else (-high, -low)


def _step(value: float) -> float:
    """About a hundredth of a value, so that it is on a step itself."""
    size = abs(value)
    if isinstance(value, int):
        step = 10 ** max(0, math.floor(math.log10(max(size, 1))) - 1)
        while size % step:
            step //= 10
        return step
    if size == 0:
        return 0.1
    near = 1 - size if 0.9 <= size < 1 else size / 10  # of 0.999 the last digit counts
    step = 10.0 ** math.floor(math.log10(near) + 1e-9)
    for _ in range(2):
        step /= 1 if abs(size / step - round(size / step)) < 1e-6 else 10
    return step
