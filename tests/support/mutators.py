"""Small changes to a module's source: what `mutation.py` calls mutants."""

from __future__ import annotations

import ast
import hashlib
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass

BINARY = {
    ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult,
    ast.FloorDiv: ast.Div, ast.Mod: ast.Mult, ast.Pow: ast.Mult, ast.MatMult: ast.Mult,
    ast.BitAnd: ast.BitOr, ast.BitOr: ast.BitAnd,
}  # fmt: skip
COMPARISON = {
    ast.Lt: (ast.LtE, ast.GtE), ast.LtE: (ast.Lt, ast.Gt),
    ast.Gt: (ast.GtE, ast.LtE), ast.GtE: (ast.Gt, ast.Lt),
    ast.Eq: (ast.NotEq,), ast.NotEq: (ast.Eq,), ast.Is: (ast.IsNot,), ast.IsNot: (ast.Is,),
    ast.In: (ast.NotIn,), ast.NotIn: (ast.In,),
}  # fmt: skip
PAIRS = (
    "min max", "any all", "argmin argmax", "nanmin nanmax", "minimum maximum", "floor ceil",
    "mean median", "sin cos", "zeros ones", "zeros_like ones_like", "sum prod", "std var",
)  # fmt: skip
SWAPPED = {a: b for pair in PAIRS for a, b in (pair.split(), pair.split()[::-1])}
UNWRAPPED = {
    "abs", "sqrt", "square", "exp", "expm1", "log", "log2", "log10", "sorted", "sort", "tanh",
    "rad2deg", "deg2rad", "diff", "cumsum", "reversed", "unique", "round", "conj", "real",
}  # fmt: skip
UNSEEN = {"tqdm", "trange", "warn", "print", "progress", "desc", "leave", "disable", "encoding"}
"""Calls and keywords that only show what goes on."""


@dataclass(frozen=True)
class Mutant:
    """One change: `text` in place of the source's characters from `start` to `stop`."""

    id: str
    module: str
    operator: str
    start: int
    stop: int
    text: str
    lines: tuple[int, ...]
    scope: tuple[int, int]
    """First and last line of the function or class around it."""
    at_import: bool
    """Whether the line runs when the module is imported, and in no test."""

    def apply(self, source: str) -> str:
        """The mutated source."""
        return source[: self.start] + self.text + source[self.stop :]

    def is_code(self, source: str) -> bool:
        """Whether the mutated source can be compiled."""
        try:
            compile(self.apply(source), self.module, "exec")
        except SyntaxError:
            return False
        return True


def mutants_of(module: str, source: str) -> list[Mutant]:
    """All mutants of a module.

    The identifier is made of the function, the line's text and the change, so that it stays
    while other lines change.
    """
    starts = [0]
    for line in source.splitlines(keepends=True):
        starts.append(starts[-1] + len(line))
    rows, seen, found = source.splitlines(), Counter(), []

    def offset(line, column):  # ast counts bytes
        return starts[line - 1] + len(rows[line - 1].encode()[:column].decode())

    for node, anchor, owner, statement, operator, text in _changes(ast.parse(source)):
        start = offset(anchor.lineno, anchor.col_offset)
        stop = offset(anchor.end_lineno, anchor.end_col_offset)
        names = ".".join(o.name for o in owner)
        line = rows[anchor.lineno - 1].strip()
        key = f"{module} {names} {line} {operator} {source[start:stop]} {text}"
        seen[key] += 1
        scope = (owner[-1].lineno, owner[-1].end_lineno) if owner else (1, len(rows))
        functions = [o for o in owner if isinstance(o, (ast.FunctionDef, ast.AsyncFunctionDef))]
        at_import = not functions or node.lineno < functions[0].body[0].lineno
        if at_import and functions:
            scope = (functions[0].body[0].lineno, functions[0].end_lineno)
        first, last = anchor.lineno, anchor.end_lineno
        if not hasattr(statement, "body"):
            first, last = statement.lineno, statement.end_lineno
        number = hashlib.sha256(f"{key} {seen[key]}".encode()).hexdigest()[:8]
        lines = tuple(range(first, last + 1))
        found.append(Mutant(number, module, operator, start, stop, text, lines, scope, at_import))
    return found


def _changes(tree: ast.Module) -> Iterator[tuple]:
    """``(node, anchor, owners, statement, operator, text of the anchor)`` of each change."""
    for parent, field, place, node, owner, statement, anchor in _walk(tree, (), None, None):
        for operator, new in _replacements(node, parent):
            if anchor is None or anchor is node:
                text = ast.unparse(new)
                yield node, node, owner, statement, operator, _bracketed(node, new, text)
            else:  # inside an f-string, whose parts have no places of their own before 3.12
                _put(parent, field, place, new)
                try:
                    yield node, anchor, owner, statement, operator, ast.unparse(anchor)
                except ValueError:
                    pass
                finally:
                    _put(parent, field, place, node)


def _bracketed(node, new, text):
    simple = (ast.Constant, ast.Name, ast.Attribute, ast.Subscript, ast.Call, ast.Slice, ast.stmt)
    whole = isinstance(new, simple) and not (isinstance(new, ast.Constant) and "-" in text)
    return text if whole or isinstance(node, (ast.Slice, ast.stmt)) else f"({text})"


def _put(parent, field, place, value):
    if place is None:
        setattr(parent, field, value)
    else:
        getattr(parent, field)[place] = value


def _name(call: ast.Call) -> str:
    return getattr(call.func, "attr", getattr(call.func, "id", ""))


def _skipped(node) -> bool:
    """What is not mutated: words, annotations, messages, what only shows progress."""
    if isinstance(node, (ast.Raise, ast.Import, ast.ImportFrom, ast.Assert)):
        return True
    if isinstance(node, ast.Call) and (
        _name(node) in UNSEEN or ast.unparse(node.func).startswith(("bar.", "progress."))
    ):
        return True
    if isinstance(node, ast.keyword) and node.arg in UNSEEN:
        return True
    if isinstance(node, ast.If) and "__name__" in ast.unparse(node.test):
        return True
    if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test):
        return True
    return isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "__all__"


def _walk(node, owner, statement, anchor):
    """``(parent, field, place, node, owners, statement, anchor)`` of all that may change."""
    if isinstance(node, (ast.FunctionDef, ast.ClassDef, ast.AsyncFunctionDef)):
        owner = (*owner, node)
    for field, value in ast.iter_fields(node):
        if field in ("annotation", "returns", "decorator_list", "format_spec", "type_params"):
            continue
        for place, child in enumerate(value) if isinstance(value, list) else [(None, value)]:
            if not isinstance(child, ast.AST) or _skipped(child):
                continue
            own = child if isinstance(child, ast.stmt) else statement
            within = anchor or (child if isinstance(child, ast.JoinedStr) else None)
            if hasattr(child, "lineno"):
                yield node, field, place, child, owner, own, within
            yield from _walk(child, owner, own, within)


def _replacements(node, parent) -> Iterator[tuple[str, ast.AST]]:
    """Names and results of the changes of one node."""
    match node:
        case ast.BinOp(left, op, right) if type(op) in BINARY and not _is_text(left, right):
            yield "arithmetic", ast.BinOp(left, BINARY[type(op)](), right)
        case ast.AugAssign(target, op, value) if type(op) in BINARY:
            yield "arithmetic", ast.AugAssign(target, BINARY[type(op)](), value)
        case ast.UnaryOp(ast.USub() | ast.Not() | ast.Invert(), operand):
            yield "sign or not", operand
        case ast.Compare(left, [op], right):
            for other in COMPARISON[type(op)]:
                yield "comparison", ast.Compare(left, [other()], right)
        case ast.Compare(left, [first, *rest], right):
            for other in COMPARISON[type(first)]:
                yield "comparison", ast.Compare(left, [other(), *rest], right)
            for other in COMPARISON[type(rest[-1])]:
                yield "comparison", ast.Compare(left, [first, *rest[:-1], other()], right)
        case ast.BoolOp(op, values):
            yield "and/or", ast.BoolOp(ast.And() if isinstance(op, ast.Or) else ast.Or(), values)
        case ast.Constant(bool() as value):
            yield "constant", ast.Constant(not value)
        case ast.Constant(int() as value):
            yield "constant", ast.Constant(value + 1)
        case ast.Constant(float() as value):
            yield "constant", ast.Constant(1.1 * value if value else 1.0)
        case ast.Slice(lower, upper, step):
            if upper is not None and not isinstance(upper, ast.Constant):
                yield "slice", ast.Slice(lower, _plus_one(upper), step)
            if lower is not None and not isinstance(lower, ast.Constant):
                yield "slice", ast.Slice(_plus_one(lower), upper, step)
        case ast.Call(func, arguments, keywords):
            yield from _changed_calls(node, func, arguments, keywords)
        case ast.Expr(ast.Call() as call) if not _skipped(call):
            yield "call left out", ast.Pass()
        case ast.Continue():
            yield "continue", ast.Break()
        case ast.Break():
            yield "break", ast.Continue()
    if getattr(parent, "test", None) is node and isinstance(
        node, (ast.Name, ast.Call, ast.Attribute, ast.BoolOp)
    ):
        yield "condition", ast.UnaryOp(ast.Not(), node)


def _changed_calls(node, func, arguments, keywords):
    name = _name(node)
    if name in SWAPPED:
        own = ast.Name(SWAPPED[name], ast.Load()) if isinstance(func, ast.Name) else None
        new = own or ast.Attribute(func.value, SWAPPED[name], ast.Load())
        yield "function", ast.Call(new, arguments, keywords)
    if name in UNWRAPPED and arguments:
        yield "call's argument", arguments[0]
    for i, keyword in enumerate(keywords):
        if keyword.arg is not None and keyword.arg not in UNSEEN:
            rest = keywords[:i] + keywords[i + 1 :]
            yield f"without {keyword.arg}", ast.Call(func, arguments, rest)


def _plus_one(node):
    return ast.BinOp(node, ast.Add(), ast.Constant(1))


def _is_text(*nodes):
    return any(
        isinstance(node, ast.JoinedStr) or isinstance(getattr(node, "value", None), str)
        for node in nodes
    )
