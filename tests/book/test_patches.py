"""What the build changes inside other libraries is still there, and takes what it took."""

import ast
import inspect
import subprocess
import sys

import pytest
from book_pages import ROOT

sys.path.insert(0, str(ROOT / "book" / "_ext"))
import patches

LEFT = """
import inspect
from myst_nb import sphinx_
from jupyter_cache.cache import db
print(*inspect.signature(sphinx_.notebook_to_tokens).parameters)
print(*inspect.signature(db.create_engine).parameters)
print(inspect.getsource(db.create_db).count("create_engine("))
print(inspect.getsource(sphinx_.Parser.parse).count("notebook_to_tokens("))
"""


def test_what_is_changed_is_there_as_it_was():
    """In a process of its own, where nothing is changed."""
    answer = subprocess.run([sys.executable, "-c", LEFT], capture_output=True, text=True)
    tokens, engine, *calls = answer.stdout.splitlines()
    assert tokens == "notebook mdit_parser mdit_env logger", answer.stderr
    assert engine.split()[0] == "url" and calls == ["1", "1"]


@pytest.mark.parametrize("name", ["why?", "50%41", "plain"])
def test_a_database_lies_where_its_path_says(name, tmp_path):
    (tmp_path / name).mkdir()
    patches.by_path(f"sqlite:///{tmp_path / name}/global.db").connect().close()
    assert (tmp_path / name / "global.db").is_file()
    assert "address" in inspect.signature(patches.by_path).parameters


def changed_in_others(text: str) -> list[str]:
    """Attributes of what a module imports that the module sets."""
    tree = ast.parse(text)
    kinds = ast.Import, ast.ImportFrom
    imports = [alias for node in ast.walk(tree) if isinstance(node, kinds) for alias in node.names]
    names = {(alias.asname or alias.name).partition(".")[0] for alias in imports}
    stored = (
        node.value
        for node in ast.walk(tree)
        if isinstance(node, (ast.Attribute, ast.Subscript)) and isinstance(node.ctx, ast.Store)
    )
    told = [ast.unparse(value) for value in stored]
    return [name for name in told if name.partition(".")[0] in names and name != "os.environ"]


def test_no_other_module_changes_a_library():
    assert changed_in_others("from a import b\nb.c = 1\nb.d['x'] = 2\nself.b = 3") == ["b", "b.d"]
    own = "patches.py", "graded_run.py"  # that shuts the network for a returned notebook
    paths = [p for p in (ROOT / "book" / "_ext").glob("*.py") if p.name not in own]
    told = {path.name: changed_in_others(path.read_text(encoding="utf-8")) for path in paths}
    assert len(told) > 20 and not {name: found for name, found in told.items() if found}
