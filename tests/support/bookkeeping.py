"""Lines of a piece of code that keep books and do not teach."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator

MAX_TEXT = 60  # characters of a literal: longer ones are alternative texts and sentences

# Calls that show something, name a number for the prose, check, or load what was made before.
CALLS = re.compile(
    r"quote|glue|stated|display|show|Markdown|Math|Table"
    r"|(figures|drawn|wall|results|measured|pictures|np\.testing)\..*|.*\bassert_\w+|by_case"
)
# What tables, pictures and alternative texts are made of.
NAMES = set("alt captions columns head heads labels panels rows titles told".split())


def lines_of_bookkeeping(code: str) -> list[str]:
    """The statements of a cell that keep books rather than teach, as far as their first line.

    Those are imports, assertions, quoted numbers, tables, figures and what they are made of,
    alternative texts, loaded results, and formatted prints; within functions and loops, too.
    """
    found = []
    for node in statements(ast.parse(code).body):
        if isinstance(node, (ast.Import, ast.ImportFrom, ast.Assert)) or any(marks(node)):
            found.append(ast.unparse(node).partition("\n")[0])
    return found


def statements(body: list[ast.stmt]) -> Iterator[ast.stmt]:
    """The statements of a cell; in place of a compound one, those within it."""
    for node in body:
        parts = [getattr(node, part, []) for part in ("body", "orelse", "finalbody")]
        parts += [handler.body for handler in getattr(node, "handlers", ())]
        if any(parts):
            for part in parts:
                yield from statements(part)
        else:
            yield node


def marks(node: ast.stmt) -> Iterator[bool]:
    """Whether the parts of a simple statement keep books."""
    docstring = isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
    yield re.fullmatch(r"[A-Z]\w*", called(node)) is not None  # shows a widget
    for part in ast.walk(node):
        if isinstance(part, ast.Call):
            name = ast.unparse(part.func)
            prints = name == "print" and any(map(is_formatted, part.args))
            yield prints or CALLS.fullmatch(name) is not None
        if isinstance(part, ast.Name):
            yield part.id in NAMES
        if isinstance(part, ast.Constant) and isinstance(part.value, str):
            yield len(part.value) > MAX_TEXT and not docstring


def is_formatted(node: ast.expr) -> bool:
    return isinstance(node, ast.JoinedStr) or isinstance(getattr(node, "value", None), str)


def called(node: ast.stmt) -> str:
    """The function that a statement calls for its own sake, if it is one."""
    if isinstance(node, ast.Expr) and isinstance(node.value, ast.Call):
        return ast.unparse(node.value.func)
    return ""
