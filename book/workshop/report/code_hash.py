"""Which code made a result: a hash of the definitions that its study reaches.

Every function, class and constant that a study uses, directly or through others, goes into the
hash by what it does. What cannot change a number is left out: where a definition stands and what
it is called, names of local variables, docstrings, comments, annotations, and statements that
only refuse bad input. So code can be moved, renamed and tidied up while its results stay fresh.
Code that is chosen while running, as by `getattr` with a computed name, is not seen.
"""

from __future__ import annotations

import ast
import hashlib
import importlib
from functools import cache, partial
from pathlib import Path

import ddlib
from ddlib._check import one_of
from workshop import BOOK

# Folders of the packages whose code is followed
_ROOTS = {
    "ddlib": Path(ddlib.__file__).parent,
    **{name: BOOK / name for name in ("workshop", "beyond")},
}

# Module of functions ``check(name, value, ...)`` that hand a value on or refuse it
_CHECKS = "_check"

# Last names of modules that decide no number: what is used of them counts by its name alone
_ASIDE = (_CHECKS, "checking", "workshop", "results", "sweeps", "code_hash")

# Functions of `results` that load networks, and the study that trains them.
_TRAINED = dict.fromkeys(("networks", "median_network", "course"), "table-4-1")

# Fields of a syntax tree that mean nothing here, or differ between versions of Python
_SILENT = {"annotation", "returns", "ctx", "kind", "type_params", "type_comment", "simple"}

_COMPREHENSIONS = (ast.ListComp, ast.SetComp, ast.DictComp, ast.GeneratorExp)
_SCOPES = (ast.FunctionDef, ast.Lambda, *_COMPREHENSIONS)
_IMPORTS = (ast.Import, ast.ImportFrom)


def study(function):
    """Mark a function of a ``studies`` folder: its dictionary is the result of its name."""
    return function


def code_hash(result: str) -> str:
    """Hash of the code that makes a result."""
    return _hashes(result)[places()[result]][:16]


def places() -> dict[str, tuple[str, str]]:
    """Module and function that make each result: those with the decorator `study`.

    They have no other use, so their names begin with an underscore, which results do without.
    """
    studies = {}
    for root, folder in _ROOTS.items():
        for path in sorted(folder.rglob("studies/**/*.py")):
            module = ".".join((root, *path.relative_to(folder).with_suffix("").parts))
            for name in _studies(path.read_text(encoding="utf-8")):
                studies[name.strip("_").replace("_", "-")] = module, name
    return studies


def run_study(result: str) -> dict:
    """Call the study that makes a result."""
    module, name = places()[result]
    return getattr(importlib.import_module(module), name)()


@cache
def _studies(text: str) -> list[str]:
    functions = (node for node in ast.parse(text).body if isinstance(node, ast.FunctionDef))
    return [f.name for f in functions if any(_is_study(mark) for mark in f.decorator_list)]


def _is_study(decorator) -> bool:
    return isinstance(decorator, ast.Name) and decorator.id == study.__name__


def _hashes(result: str) -> dict[tuple[str, str], str]:
    """Hashes of all definitions behind a result, by module and name."""
    known: dict[tuple[str, str], str] = {}
    under_way: list[tuple[str, str]] = []

    def of(place) -> str:
        if place in under_way:  # it calls itself, perhaps by way of others
            return f"recursion {len(under_way) - under_way.index(place)}"
        if place not in known:
            under_way.append(place)
            total = hashlib.sha256()
            for part in _form(*place, _text(place[0])):
                total.update((part if isinstance(part, str) else of(part)).encode() + b"\n")
            under_way.pop()
            known[place] = total.hexdigest()
        return known[place]

    one_of("result", result, places())
    of(places()[result])
    return known


# --- where a name is defined ------------------------------------------------------------------
# A place is a module and one of its names, or a module and None for the module itself.


def _file(module: str) -> Path | None:
    """The file of a module of ours; of a package that with its names."""
    top, *inside = module.split(".")
    if top not in _ROOTS:
        return None
    path = _ROOTS[top].joinpath(*inside)
    files = (path / "__init__.pyi", path / "__init__.py", path.with_name(path.name + ".py"))
    return next((file for file in files if file.is_file()), None)


def _text(module: str) -> str:
    """The source of a module of ours; of others nothing."""
    file = _file(module)
    return file.read_text(encoding="utf-8") if file else ""


def _home(module: str, name: str | None) -> tuple[str, str | None]:
    """The place where a name is defined, through all packages that hand it on."""
    origin = _names(module, _text(module)).get(name)
    if isinstance(origin, tuple) and origin != (module, name):
        return _home(*origin)
    if not isinstance(origin, list) and _file(f"{module}.{name}") is not None:
        return f"{module}.{name}", None
    return module, name


def _imported(node, module: str) -> dict[str, tuple[str, str | None]]:
    """The places behind the names that an import binds."""
    if isinstance(node, ast.Import):
        whole = {alias.asname: (alias.name, None) for alias in node.names if alias.asname}
        tops = [alias.name.split(".")[0] for alias in node.names if not alias.asname]
        return whole | {top: (top, None) for top in tops}
    file = _file(module)
    package = module.split(".")[: None if file and file.stem == "__init__" else -1]
    above = package[: len(package) + 1 - node.level] if node.level else []
    source = ".".join([*above, *filter(None, [node.module])])
    return {alias.asname or alias.name: (source, alias.name) for alias in node.names}


@cache
def _names(module: str, text: str) -> dict[str, list[ast.stmt] | tuple[str, str | None]]:
    """By name at the top of a module: the statements that make it, or where it comes from."""
    names: dict = {}
    for statement in ast.parse(text).body:
        if isinstance(statement, _IMPORTS):
            names |= _imported(statement, module)
            continue
        if isinstance(statement, (ast.FunctionDef, ast.ClassDef)):
            names_made = [statement.name]
        elif _only_tells(statement):
            continue
        else:  # an assignment, or a call that changes what has been made before
            used = [n.id for n in ast.walk(statement) if isinstance(n, ast.Name)]
            names_made = _stored(statement, _SCOPES)
            if not names_made or hasattr(statement, "body"):
                changed = [n for n in used if n in names and not _is_imported(names[n])]
                names_made = list(dict.fromkeys([*names_made, *changed]))
        for name in names_made:
            earlier = names.get(name)
            names[name] = [*(earlier if isinstance(earlier, list) else []), statement]
    return names


def _is_imported(origin) -> bool:
    """Whether a name comes from another module of ours."""
    return isinstance(origin, tuple) and _file(origin[0]) is not None


def _stored(node, apart=(), context=ast.Store) -> list[str]:
    """Names that a syntax tree assigns to, or reads, without parts of the kinds `apart`."""
    if isinstance(node, ast.Name):
        return [node.id] if isinstance(node.ctx, context) else []
    inner = [child for child in ast.iter_child_nodes(node) if not isinstance(child, apart)]
    return list(dict.fromkeys(name for child in inner for name in _stored(child, apart, context)))


_loaded = partial(_stored, context=ast.Load)


def _outer(scope) -> list[str]:
    """Names that a function takes from outside, whatever scopes within it call theirs."""
    if isinstance(scope, _COMPREHENSIONS):
        return []
    parameters, body = scope.args, scope.body if isinstance(scope.body, list) else [scope.body]
    before = [*parameters.defaults, *filter(None, parameters.kw_defaults)]
    before += getattr(scope, "decorator_list", [])
    own = {a.arg for a in ast.walk(parameters) if isinstance(a, ast.arg)}
    own |= {n for s in body for n in _stored(s, _SCOPES)}
    inside = {n for s in body for n in _loaded(s, _SCOPES)} - own
    return sorted(inside.union(*map(_loaded, before)))


# --- what a definition says -------------------------------------------------------------------


def _only_tells(node) -> bool:
    """A docstring, an assertion, a refusal, a warning: what leaves every number as it is."""
    if isinstance(node, (ast.If, ast.Assert)) and _stored(node.test, _COMPREHENSIONS):
        return False
    if isinstance(node, (ast.Raise, ast.Assert, ast.Pass, *_IMPORTS)):
        return True
    if isinstance(node, ast.FunctionDef):
        return node.name in ("__str__", "__repr__")
    if isinstance(node, ast.If):
        return not node.orelse and all(_only_tells(inner) for inner in node.body)
    if not isinstance(node, ast.Expr):
        return False
    if isinstance(node.value, ast.Constant):
        return True
    called = ast.unparse(node.value.func) if isinstance(node.value, ast.Call) else ""
    return called.rpartition(".")[2].startswith("warn")


@cache
def _form(module: str, name: str, text: str) -> list[str | tuple[str, str]]:
    """A definition as pieces of text and places of other definitions."""
    names, form = _names(module, text), []
    for statement in names[name]:
        writer = _Writer(module, name, names)
        for node in ast.walk(statement):
            if isinstance(node, _IMPORTS):
                writer.names |= _imported(node, module)
        writer.write(statement)
        form += writer.form
    return form


class _Writer:
    """Writes a statement as text in which names of ours and of local variables do not count."""

    def __init__(self, module: str, own: str, names: dict):
        self.module, self.own, self.names = module, own, dict(names)
        self.form: list[str | tuple[str, str]] = []
        self.local: dict[str, str] | None = None  # inside a function: what stands for its names

    def write(self, node) -> None:
        if isinstance(node, _SCOPES) and self.local is None:
            self.local = self._locals(node)
            self.write(node)
            shadowed, self.local = [n for n in _outer(node) if n in self.local], None
            for name in shadowed:
                if self._place(ast.Name(name, ast.Load())) is not None:
                    self.write(ast.Name(name, ast.Load()))
        elif isinstance(node, list):
            self.form.append("[")
            for item in node:
                if not self._is_idle(item):
                    self.write(item)
            self.form.append("]")
        elif isinstance(node, ast.Call) and self._is_check(node):
            self.write(node.args[min(1, len(node.args) - 1)])  # the value that it hands on
        elif isinstance(node, (ast.Name, ast.Attribute)) and self._place(node) is not None:
            self._write_place(*self._place(node))
        elif isinstance(node, ast.Name):
            self.form.append(self._called(node.id))
        elif isinstance(node, ast.AST):
            self._write_fields(node)
        else:
            self.form.append(repr(node))

    def _write_fields(self, node: ast.AST) -> None:
        self.form.append(type(node).__name__)
        for field, value in ast.iter_fields(node):
            if value not in (None, []) and field not in _SILENT:
                is_name = field == "name" and isinstance(value, str)
                self.form.append(field)
                self.write(self._called(value) if is_name else value)

    def _write_place(self, module: str, name: str | None) -> None:
        if module.rpartition(".")[2] in _ASIDE:
            self.form.append(f"aside {name}")
            if name in _TRAINED:  # what is loaded is of a class of ours, and a study made it
                self.form += [("ddlib.learning.network", "TorqueModel"), places()[_TRAINED[name]]]
        elif name is not None and isinstance(_names(module, _text(module)).get(name), list):
            self.form.append((module, name))
        else:
            self.form.append(f"of {module} {name}")

    def _locals(self, function) -> dict[str, str]:
        """Names of a function and all inside it; arguments are what callers call them."""
        nodes = list(ast.walk(function))
        arguments = {n.arg for n in nodes if isinstance(n, ast.arg)}
        inner = [n.name for n in nodes if isinstance(n, ast.FunctionDef) and n is not function]
        made = [name for name in [*_stored(function), *inner] if name not in arguments]
        numbers = {name: f"local {k}" for k, name in enumerate(dict.fromkeys(made))}
        return {name: name for name in arguments} | numbers

    def _called(self, name: str) -> str:
        """What stands for a name that is no other definition's."""
        if self.local and name in self.local:
            return self.local[name]
        return "itself" if name == self.own else name

    def _place(self, node) -> tuple[str, str | None] | None:
        """Where a name or a module's attribute is defined; None if it is local or built in."""
        if isinstance(node, ast.Attribute):
            module, name = self._place(node.value) or ("", "")
            return _home(module, node.attr) if module and name is None else None
        if not isinstance(node, ast.Name) or (self.local and node.id in self.local):
            return None
        origin = self.names.get(node.id)
        if isinstance(origin, tuple):
            return _home(*origin)
        is_other = origin is not None and node.id != self.own and isinstance(node.ctx, ast.Load)
        return (self.module, node.id) if is_other else None

    def _is_check(self, node: ast.Call) -> bool:
        module, _ = self._place(node.func) or ("", None)
        return module.rpartition(".")[2] == _CHECKS and len(node.args) > 1

    def _is_idle(self, node) -> bool:
        called = isinstance(node, ast.Expr) and isinstance(node.value, ast.Call)
        return _only_tells(node) or _is_study(node) or (called and self._is_check(node.value))
