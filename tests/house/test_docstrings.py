"""Every public function, class and method says what it does and what its arguments are."""

import ast
import re
from pathlib import Path

import pytest

import ddlib

ROOT = Path(ddlib.__file__).parent
FILES = sorted(ROOT.rglob("*.py"))
FUNCTION = (ast.FunctionDef, ast.AsyncFunctionDef)


def arguments(node) -> list[str]:
    """Names that a caller can pass: a function's arguments, a dataclass's fields."""
    if isinstance(node, FUNCTION):
        a = node.args
        named = [*a.posonlyargs, *a.args, *a.kwonlyargs]
        stars = [x for x in (a.vararg, a.kwarg) if x is not None]
        names = [x.arg for x in named + stars]
        return [n for n in names if n not in ("self", "cls") and not n.startswith("_")]
    for item in node.body:
        if isinstance(item, FUNCTION) and item.name == "__init__":
            return arguments(item)
    if not is_record(node):
        return []
    fields = (x.target.id for x in node.body if isinstance(x, ast.AnnAssign))
    return [n for n in fields if not n.startswith("_")]


def is_record(node) -> bool:
    """Whether the class takes its annotated fields as arguments."""
    marks = [ast.unparse(x) for x in (*node.decorator_list, *node.bases)]
    return any(mark.split("(")[0] in ("dataclass", "NamedTuple") for mark in marks)


def public(tree, path):
    """``(label, node)`` of everything public in a module."""
    for node in tree.body:
        if isinstance(node, (*FUNCTION, ast.ClassDef)) and not node.name.startswith("_"):
            yield f"{path}:{node.name}", node
            if isinstance(node, ast.ClassDef):
                for item in node.body:
                    if isinstance(item, FUNCTION) and not item.name.startswith("_"):
                        yield f"{path}:{node.name}.{item.name}", item


def listed(docstring) -> list[str] | None:
    """Names that Parameters and Attributes list, None where there is no such section."""
    lines = docstring.splitlines()
    names, inside, found = [], False, False
    for line, below in zip(lines, [*lines[1:], ""]):
        if below and set(below) == {"-"}:  # a section's title
            inside = line in ("Parameters", "Attributes")
            found = found or inside
        elif inside and line and not line.startswith((" ", "-")):
            names += [name.strip(" *") for name in line.split(":")[0].split(",")]
    return names if found else None


MODULES = {path: ast.parse(path.read_text()) for path in FILES}
ENTRIES = [
    entry for path, tree in MODULES.items() for entry in public(tree, path.relative_to(ROOT))
]
each_entry = pytest.mark.parametrize("node", [pytest.param(n, id=i) for i, n in ENTRIES])


def test_the_search_finds_the_package():
    labels = {label for label, _ in ENTRIES}
    assert {
        "dynamics/arm.py:Arm.inverse_dynamics",
        "simulation/simulate.py:record",
        "effects/real_arm.py:Noise",
    } <= labels
    assert all(not label.split(":")[1].startswith("_") for label in labels)


def test_the_reader_of_sections_reads():
    """The check itself: names, stars, several to a line; prose and other sections are not names."""
    text = (
        "Do it.\n\nParameters\n----------\nq, qd : array\n    An angle: rad.\n*parts\n    Rest.\n"
    )
    assert listed(text) == ["q", "qd", "parts"]
    assert listed(text + "\nReturns\n-------\nresult : array\n    It.\n") == ["q", "qd", "parts"]
    assert listed("Do it.") is None


@pytest.mark.parametrize("path", FILES, ids=lambda p: str(p.relative_to(ROOT)))
def test_modules_say_what_they_are_for(path):
    if path.name == "__init__.py" and not path.read_text().strip():
        return  # an empty package file
    summary = (ast.get_docstring(MODULES[path]) or "").partition("\n")[0]
    assert 10 <= len(summary) <= 100


@each_entry
def test_summary_line(node):
    docstring = ast.get_docstring(node)
    assert docstring, "no docstring"
    first, _, rest = docstring.partition("\n")
    assert 10 <= len(first) <= 100, first
    assert first[-1] in ".:!?", f"the first line is not a sentence: {first!r}"
    assert not rest or rest.startswith("\n"), "no blank line after the summary"


@each_entry
def test_parameters_section_lists_every_argument_and_no_other(node):
    names = listed(ast.get_docstring(node) or "")
    if names is None:
        return
    wanted = arguments(node)
    assert set(wanted) <= set(names), f"not listed: {sorted(set(wanted) - set(names))}"
    if isinstance(node, FUNCTION):
        assert set(names) <= set(wanted), f"no such argument: {sorted(set(names) - set(wanted))}"


@pytest.mark.parametrize(
    "node",
    [
        pytest.param(n, id=i)
        for i, n in ENTRIES
        if isinstance(n, FUNCTION) and "." not in i.split(":")[1] and i[0] != "_"
    ],
)
def test_functions_of_several_arguments_mention_them_all(node):
    """One or two arguments speak for themselves in the signature; three or more need words."""
    wanted = arguments(node)
    words = set(re.findall(r"\w+", ast.get_docstring(node) or ""))
    assert len(wanted) < 3 or set(wanted) <= words, f"not mentioned: {sorted(set(wanted) - words)}"
