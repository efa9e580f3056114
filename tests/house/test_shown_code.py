"""Code that widgets show: every name of ours that it imports or reads is there."""

import ast
import re
from types import ModuleType

from book_pages import ROOT, code_cells

OURS = ("ddlib", "workshop", "beyond")


def shown(source: str) -> list[str]:
    """Python code in the strings of a source, with a number where a value of the page goes."""
    strings = [n.value for n in ast.walk(ast.parse(source)) if isinstance(n, ast.Constant)]
    start = re.compile(r"^(from [\w.]+ import|import [\w.]+$)", re.M)
    codes = [s for s in strings if isinstance(s, str) and start.search(s)]
    return [re.sub(r"\{\w+\}", "0", code) for code in codes]


def missing(code: str) -> list[str]:
    bound, wrong = {}, []
    for node in ast.walk(ast.parse(code)):  # imports come before all that stands inside lines
        if isinstance(node, ast.ImportFrom) and node.module.split(".")[0] in OURS:
            exec(ast.unparse(node), bound)
        elif isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
            module = bound.get(node.value.id)
            if isinstance(module, ModuleType) and not hasattr(module, node.attr):
                wrong.append(f"{module.__name__}.{node.attr}")
    return wrong


def test_names_in_shown_code_exist():
    homes = ROOT / "ddlib" / "widgets", ROOT / "book" / "workshop", ROOT / "book" / "beyond"
    sources = [path.read_text("utf-8") for home in homes for path in home.rglob("*.py")]
    sources += [
        code for path in (ROOT / "book").glob("**/[!.]*.ipynb") for code in code_cells(path)
    ]
    codes = {code for source in sources for code in shown(source)}
    assert len(codes) > 5
    assert not [name for code in codes for name in missing(code)]
