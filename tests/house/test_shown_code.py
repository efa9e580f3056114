"""Code that widgets show: every name of ours that it imports or reads is there."""

import ast
import json
import re
from importlib import import_module
from types import ModuleType

from book_pages import ROOT

SOURCES = {
    **{path: [path.read_text("utf-8")] for path in (ROOT / "ddlib" / "widgets").rglob("*.py")},
    **{
        path: ["".join(c["source"]) for c in json.loads(path.read_text("utf-8"))["cells"]
               if c["cell_type"] == "code"]
        for path in (ROOT / "book").glob("*.ipynb")
    },
}  # fmt: skip


def shown(source: str) -> list[str]:
    """Python code in the strings of a source, with a number where a value of the page goes."""
    strings = [n.value for n in ast.walk(ast.parse(source)) if isinstance(n, ast.Constant)]
    codes = [
        s
        for s in strings
        if isinstance(s, str) and re.search(r"^(from [\w.]+ import|import [\w.]+$)", s, re.M)
    ]
    return [re.sub(r"\{\w+\}", "0", code) for code in codes]


def missing(code: str) -> list[str]:
    tree, bound, wrong = ast.parse(code), {}, []
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and node.module.split(".")[0] in ("ddlib", "workshop"):
            module = import_module(node.module)
            for name in (alias.name for alias in node.names):
                if not hasattr(module, name) and hasattr(module, "__path__"):
                    import_module(f"{node.module}.{name}")
                if not hasattr(module, name):
                    wrong.append(f"{node.module}.{name}")
            bound |= {a.asname or a.name: getattr(module, a.name, None) for a in node.names}
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
            module = bound.get(node.value.id)
            if isinstance(module, ModuleType) and not hasattr(module, node.attr):
                wrong.append(f"{module.__name__}.{node.attr}")
    return wrong


def test_names_in_shown_code_exist():
    codes = {
        (path.name, code) for path, cells in SOURCES.items() for s in cells for code in shown(s)
    }
    assert len(codes) > 10
    wrong = [f"{name}: {word}" for name, code in sorted(codes) for word in missing(code)]
    assert not wrong, "\n".join(wrong)


def test_a_name_that_is_not_there_is_found():
    code = "from workshop.report.studies.page import training as page\npage.nothing({x})"
    assert missing(shown(repr(code))[0]) == ["workshop.report.studies.page.training.nothing"]
    assert missing("from ddlib.setups import nothing") == ["ddlib.setups.nothing"]
