"""Every public name says what it is; no private function is explained at greater length than done.

Names that a module defines, and methods of its classes.
"""

import ast

from test_imports import MODULES

FUNCTIONS = (ast.FunctionDef, ast.AsyncFunctionDef)


def definitions(tree: ast.AST, private: bool = False):
    """``(node, whether it or what it lies in is private)`` of functions and classes."""
    for node in tree.body:
        if isinstance(node, (*FUNCTIONS, ast.ClassDef)):
            hidden = private or node.name.startswith("_")
            yield node, hidden
            if isinstance(node, ast.ClassDef):
                yield from definitions(node, hidden)


def faults(source: str) -> list[str]:
    wrong = []
    for node, private in definitions(ast.parse(source)):
        docstring = ast.get_docstring(node) or ""
        if not private and not docstring:
            wrong.append(f"{node.name} has no docstring")
        if private and docstring and isinstance(node, FUNCTIONS):
            words = len(docstring.splitlines())
            code = node.end_lineno - node.body[0].end_lineno + 1
            wrong += [f"{node.name} has {words} lines of docstring"] * (words > code)
    return wrong


def test_public_names_say_what_they_are_and_private_ones_are_brief():
    texts = {module: path.read_text(encoding="utf-8") for module, path in MODULES.items()}
    assert len(texts) > 50
    wrong = [f"{module}: {fault}" for module, text in texts.items() for fault in faults(text)]
    assert not wrong, "\n".join(wrong)
