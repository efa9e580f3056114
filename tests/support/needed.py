"""Which cells of a notebook must run so that its widgets are there."""

from __future__ import annotations

import ast
import re

MADE = re.compile(  # by modules: calls that make one
    r"widgets\.|chapter\.((hidden_torque|acceleration_by_window|weigh|turn)$|[A-Z]+[a-z])"
)


def needed(cells: list[str]) -> list[int]:
    """Places of the cells that make widgets, and of those whose names they need.

    By names alone: a cell counts that gives, or gives something in, a name that is needed further
    down. A cell whose only effect is inside what another one has made does not.
    """
    trees = [ast.parse(re.sub(r"^\s*[%!].*$", "pass", source, flags=re.M)) for source in cells]
    makers = {
        alias.asname or alias.name
        for tree in trees
        for node in ast.walk(tree)
        if isinstance(node, ast.ImportFrom)
        and re.match(r"ddlib\.widgets\b|(workshop|beyond)\.chapters\b", node.module or "")
        for alias in node.names
        if re.match(r"[A-Z]+[a-z]", alias.name)
    }
    found, wanted = [], set()
    for place in reversed(range(len(cells))):
        gives, uses = names(trees[place])
        if makes(trees[place], makers) or gives & wanted:
            found.append(place)
            wanted |= uses
    return found[::-1]


def makes(tree: ast.AST, makers: set[str]) -> bool:
    """Whether one of the makers is called."""
    calls = [ast.unparse(node.func) for node in ast.walk(tree) if isinstance(node, ast.Call)]
    return any(call in makers or MADE.match(call) for call in calls)


def names(tree: ast.AST) -> tuple[set[str], set[str]]:
    """Names that a cell gives, and those that it uses."""
    gives, uses = set(), set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Name):
            (uses if isinstance(node.ctx, ast.Load) else gives).add(node.id)
        elif isinstance(node, ast.FunctionDef | ast.ClassDef):
            gives.add(node.name)
        elif isinstance(node, ast.Import | ast.ImportFrom):
            gives |= {(alias.asname or alias.name).partition(".")[0] for alias in node.names}
        elif isinstance(node, ast.Subscript | ast.Attribute) and isinstance(node.ctx, ast.Store):
            gives.add(re.match(r"\w*", ast.unparse(node))[0])
    return gives, uses
