"""*Run this page*: runs cells in the browser; packages come as cells need them."""

from __future__ import annotations

import ast
import importlib
import io
import json
import linecache
import os
import sys
import traceback
import types
from contextlib import redirect_stderr, redirect_stdout, suppress

os.environ["MPLBACKEND"] = "Agg"

space = {"__name__": "__main__"}
blocked: set[str] = set()  # names that a cell would have made which cannot run here
emitting = None  # what shows something below the cell that runs
page = None  # `page(text, buffers)` tells the widgets of the page something; the worker sets it


class Stream:
    """What a cell prints, handed on line by line."""

    encoding = "utf-8"

    def __init__(self, emit, kind):
        self.emit, self.kind, self.kept = emit, kind, ""

    def write(self, text):
        self.kept += text
        if "\n" in self.kept:
            told, _, self.kept = self.kept.rpartition("\n")
            self.emit(self.kind, told + "\n")
        return len(text)

    def flush(self):
        if self.kept:
            self.emit(self.kind, self.kept)
            self.kept = ""

    def isatty(self):
        return False


async def run(source: str, name: str, emit, fetch) -> bool:
    """Run a cell; whether it ran through.

    `emit(kind, text)` shows something; `await fetch(package)` gets a package, and tells whether
    there is one of that name.
    """
    linecache.cache[name] = len(source), None, source.splitlines(True), name
    try:
        tree = ast.parse(source, name)
    except SyntaxError as error:
        emit("error", "".join(traceback.format_exception_only(error)))
        return False
    await _imports(tree, fetch)
    if _twin(tree) and sys.modules.get("torch"):
        emit("twin", "")
    tried: set[str] = set()
    while True:
        try:
            _execute(tree, name, emit)
            blocked.difference_update(_defined(tree))
            return True
        except ImportError as error:
            # A function imported something as it ran: it gets it, and the cell starts again.
            package = _missing(error)
            if package not in tried and await _got(package, fetch):
                tried.add(package)
                emit("again", "")
                continue
            _tell(error, tree, name, emit)
            return False
        except BaseException as error:
            _tell(error, tree, name, emit)
            return False


def _missing(error: ImportError) -> str:
    """What is not there; ours say so of PyTorch in their own words."""
    absent = isinstance(error, ModuleNotFoundError) or error.name == "torch"
    return (error.name or "") if absent else ""


async def _got(package: str, fetch) -> bool:
    """Get what is not there: a part of a package that comes by itself, or all of it."""
    got = bool(package) and (
        await fetch(package) or ("." in package and await fetch(package.partition(".")[0]))
    )
    importlib.invalidate_caches()
    return got


async def _imports(tree, fetch) -> None:
    """Do what a cell imports, until all packages behind it are there. Errors come as it runs."""
    names: dict = {}
    nodes = list(ast.walk(tree))
    dotted = [n for n in nodes if isinstance(n, ast.Attribute) and isinstance(n.value, ast.Name)]

    async def do(step):
        for _ in range(20):
            try:
                return step()
            except ImportError as error:
                if not await _got(_missing(error), fetch):
                    return None
            except Exception:
                return None

    for step in _imports_of(tree):
        await do(lambda step=step: exec(compile(step, "imports", "exec"), names))
    for node in dotted:  # `figures.curves` imports, too: names of ours are lazy
        module = {**space, **names}.get(node.value.id)
        if isinstance(module, types.ModuleType):
            await do(lambda module=module, node=node: getattr(module, node.attr))


def _execute(tree, name: str, emit) -> None:
    body = list(tree.body)
    last = body.pop() if body and isinstance(body[-1], ast.Expr) else None
    global emitting
    emitting = emit
    out, err = Stream(emit, "text"), Stream(emit, "warning")
    with redirect_stdout(out), redirect_stderr(err):
        try:
            exec(compile(ast.Module(body, []), name, "exec"), space)
            if last is not None:
                value = eval(compile(ast.Expression(last.value), name, "eval"), space)
        finally:
            out.flush()
            err.flush()
    if last is not None and value is not None:
        show(value, emit)
    pyplot = sys.modules.get("matplotlib.pyplot")
    for number in pyplot.get_fignums() if pyplot else ():
        show(pyplot.figure(number), emit)
    if pyplot:
        pyplot.close("all")


def show(value, emit) -> None:
    """A value as a notebook would show it."""
    widgets = sys.modules.get("anywidget")
    if widgets and isinstance(value, widgets.AnyWidget):
        return emit("widget", str(value.show()))
    for kind in ("html", "svg", "latex", "markdown"):
        told = getattr(value, f"_repr_{kind}_", None)
        text = told() if told and not isinstance(value, type) else None
        if text:
            return emit("html" if kind == "svg" else kind, text)
    if hasattr(value, "savefig"):
        return emit("html", _svg(value))
    emit("text", f"{value!r}\n")


def display(*values) -> None:
    """Show values below the cell that runs."""
    sys.stdout.flush()  # what was printed comes first
    for value in values:
        show(value, emitting)


def heard(text: str, buffers) -> str:
    """Take what a widget of the page says; returns the names of the widget if it changed."""
    told = {"number": json.loads(text)["number"]}
    out = Stream(lambda _, said: page(json.dumps({**told, "said": said}), []), "text")
    widget = None
    with redirect_stdout(out), redirect_stderr(out):
        try:
            widget = sys.modules["anywidget"].heard(text, buffers)
        except Exception as error:
            out.write(f"{type(error).__name__}: {error}\n")
    out.flush()
    page(json.dumps({**told, "applied": True}), [])
    names = [name for name, value in space.items() if widget is not None and value is widget]
    return json.dumps(names)


def _svg(figure) -> str:
    made = io.StringIO()
    figure.savefig(made, format="svg", bbox_inches="tight")
    return made.getvalue().partition("<svg")[1] + made.getvalue().partition("<svg")[2]


def _tell(error, tree, name: str, emit) -> None:
    """What went wrong, from the cell's own line on; and in plain words what cannot be had here."""
    if isinstance(error, ImportError) and _missing(error).partition(".")[0] == "torch":
        emit("torch", "PyTorch")
    elif lacks := getattr(error, "lacks", ""):
        emit("torch", lacks)
    elif isinstance(error, NameError) and error.name in blocked:
        emit("above", error.name)
    else:
        inside = error.__traceback__
        while inside and inside.tb_frame.f_code.co_filename != name:
            inside = inside.tb_next
        lines = traceback.format_exception(type(error), error, inside)
        emit("error", "".join(lines))
        if blocked:  # what a cell above did not do may be missed in many ways
            emit("after", "")
        elif isinstance(error, NameError):
            emit("hint", error.name or "")
        return
    for step in _imports_of(tree):  # what it imports beside, cells below may need
        with suppress(ImportError):
            exec(compile(step, "imports", "exec"), space)
    for lost in _defined(tree) - {"mine"}:
        blocked.add(lost)
        space.pop(lost, None)  # half of it may be there
    blocked.update({"torch"} - space.keys())


def _twin(tree) -> bool:
    """Whether a cell itself imports what stands in for PyTorch."""
    steps = [step.body[0] for step in _imports_of(tree)]
    named = [alias.name for step in steps if isinstance(step, ast.Import) for alias in step.names]
    named += [step.module or "" for step in steps if isinstance(step, ast.ImportFrom)]
    return "torch" in {name.partition(".")[0] for name in named}


def _imports_of(tree) -> list[ast.Module]:
    nodes = (n for n in ast.walk(tree) if isinstance(n, (ast.Import, ast.ImportFrom)))
    return [ast.Module([node], []) for node in nodes]


def _defined(tree) -> set[str]:
    """Names that a cell gives a value to."""
    nodes = list(ast.walk(tree))
    named = {n.name for n in nodes if isinstance(n, (ast.FunctionDef, ast.ClassDef))}
    names = (n for n in nodes if isinstance(n, ast.Name))
    return named | {n.id for n in names if isinstance(n.ctx, ast.Store)}
