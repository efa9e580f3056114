"""*Run this page*: runs cells in the browser; packages come as cells need them.

A cell finds the names that the cells above it gave when they ran last, and no others: whatever the
order in which a reader runs cells, a page shows what it would show if it were run from the top.
"""

from __future__ import annotations

import ast
import builtins
import concurrent.futures
import hashlib
import importlib
import inspect
import io
import json
import linecache
import marshal
import os
import pickle
import random
import re
import sys
import time
import traceback
import types
from collections.abc import Collection
from contextlib import nullcontext, redirect_stderr, redirect_stdout, suppress

from names import Names, names

os.environ["MPLBACKEND"] = "Agg"

BARE = {"__name__": "__main__"}
# of a class: what Python keeps beside its content
WITHOUT_CONTENT = {"__dict__", "__weakref__", "__doc__", "__module__", "__slotnames__"}
# Python and numpy say in these words of 2 GB and more that nobody can even ask for them
TOO_BIG = re.compile("index-sized integer|array is too big|Maximum allowed dimension exceeded")
GONE = object()  # a name that a cell deleted
space = dict(BARE)
made: dict[str, dict] = {}  # what each cell gave to names when it ran last
known: dict[str, Names] = {}
seen: dict[int, tuple] = {}  # by its id, a value that a cell gave, and its footprint since
blocked: set[str] = set()  # names that a cell would have made which cannot run here
emitting = None  # what shows something below the cell that runs
drawn: dict[str, tuple] = {}  # cells above, and figures shown without their narrow forms
leaving: list | None = None  # those of the cell that runs, if it leaves narrow forms for later
page = None  # `page(text, buffers)` tells the widgets of the page something; the worker sets it


class Stream:
    """What a cell prints, handed on line by line."""

    encoding = "utf-8"

    def __init__(self, emit, kind):
        self.emit, self.kind, self.line = emit, kind, ""

    def write(self, text):
        self.line += text
        if "\n" in self.line:
            lines, _, self.line = self.line.rpartition("\n")
            self.emit(self.kind, lines + "\n")
        return len(text)

    def flush(self):
        if self.line:
            self.emit(self.kind, self.line)
            self.line = ""

    def isatty(self):
        return False


async def run(
    source: str, name: str, emit, fetch, above=None, keep=True, quiet=False, wide=False
) -> bool:
    """Run a cell; whether it ran through.

    `emit(kind, text)` shows something; `await fetch(package)` gets a package, and tells whether
    there is one of that name. With the names of the cells `above`, it finds what these gave, in
    their order, and nothing else. What it gives itself is not kept without `keep`, and what it
    shows is not shown if it is `quiet`, unless it does not run through. On a `wide` page figures
    come without their forms for a narrow one, until `forms` is asked for these.
    """
    if above is not None:
        _stand(above)
    linecache.cache[name] = len(source), None, source.splitlines(True), name
    try:
        tree = ast.parse(source, name)
    except (SyntaxError, ValueError) as error:
        emit("error", "".join(traceback.format_exception_only(error)))
        emit("syntax", json.dumps([getattr(error, "lineno", None), getattr(error, "msg", "")]))
        return False
    await _imports(tree, fetch)
    if _twin(tree) and sys.modules.get("torch") and not quiet:
        emit("twin", "")
    own = names(source, {n for n, value in space.items() if isinstance(value, types.ModuleType)})
    before = dict(space)
    altered = _perhaps_altered(own)
    prints = {n: _print_now(before[n]) for n in (altered | _reached(own)) & before.keys()}
    loud = emit
    if quiet:
        emit = _only_problems(emit)
    Progress.emit, Progress.last = emit, 0.0
    global leaving
    leaving = [] if quiet or (wide and keep) else None
    if not quiet:
        drawn[name] = [*(above or ()), name], [] if leaving is None else leaving
    try:
        return await _until_it_runs(tree, name, emit, fetch)
    finally:
        Progress.emit = None
        if keep:
            here = {n: v for n, v in space.items() if n in own.writes or before.get(n) is not v}
            made[name] = here | dict.fromkeys(before.keys() - space.keys(), GONE)
            # what nobody sees in its code: by a function's `global`, by `exec`
            own.perhaps.update(n for n in here.keys() - own.writes if not n.startswith("__"))
            known[name] = own
            own_prints = {
                n: footprint(value) for n, value in made[name].items() if value is not GONE
            }
            altered = sorted(_altered(before, prints, altered))
            _keep_prints(before, made[name], own_prints, prints)
            more = {"prints": own_prints, "altered": altered, "handled": _handled(made[name])}
            loud("names", json.dumps({**own.as_dict(), **more}))


def _perhaps_altered(own: Names) -> set[str]:
    """What a cell may change in place, by its code or by a function of any cell.

    Nobody can compare widgets: of these only what its own code or a function that it names changes.
    """
    altering = [pair for cell in (*known.values(), own) for pair in cell.alters.items()]
    named = own.reads | own.writes
    surely = own.changes.union(*(changed for name, changed in altering if name in named))
    every = surely.union(*(changed for _, changed in altering))
    return every.difference(set(_handled(space)) - surely)


def _reached(own: Names) -> set[str]:
    """What a cell can come to: what it reads, and what functions of any cell read for it."""
    reached, new = set(), own.reads - set(_handled(space))
    while new:
        reached |= new
        carried = [cell.carries.get(n, ()) for cell in known.values() for n in new]
        new = set().union(*carried) - reached
    return reached - set(_handled(space))


def _print_now(value) -> str | None:
    """Its footprint, from when a cell last had to do with it."""
    return seen[id(value)][1] if id(value) in seen else footprint(value)


def _altered(before: dict, prints: dict, perhaps: set[str]) -> set[str]:
    """Names whose values are others than before a cell; `prints` get what these are now.

    What nobody can compare is taken to be changed if it goes on with each use, or if the code of
    the cell may change it: `perhaps`. If anything was, a part of it may have more names.
    """
    altered = set()

    def compare(name, was, value):
        prints[name] = footprint(value)
        if prints[name] is None or was is None:
            return name in perhaps or hasattr(type(value), "__next__")
        return prints[name] != was

    for name, was in list(prints.items()):
        if compare(name, was, before[name]):
            altered.add(name)
    if altered:
        others = [(n, v) for n, v in before.items() if n not in prints and id(v) in seen]
        altered.update(n for n, v in others if compare(n, seen[id(v)][1], v))
    return altered


def _keep_prints(before: dict, given: dict, own_prints: dict, prints: dict) -> None:
    """Remember the footprints of values that are still to be had."""
    for values, known_prints in ((before, prints), (given, own_prints)):
        seen.update((id(values[n]), (values[n], of)) for n, of in known_prints.items())
    alive = {id(value) for names in made.values() for value in names.values()}
    for gone in seen.keys() - alive:
        del seen[gone]


def parts(path: str, imported: bool, above) -> str:
    """Names that an object or an imported module has, for the editor, as JSON; of a path with dots.

    Nothing of a cell is called. A path leads through what lies in modules, instances and classes
    (`getattr_static`), not through properties or `__getattr__`; of its last object, `dir` may ask
    a class that says itself what it has. A module of ddlib is imported, no other.
    """
    names = _of_module(path) if imported else _of_object(path, above)
    return json.dumps(sorted(name for name in names if not name.startswith("_")))


def _of_module(path: str) -> Collection[str]:
    """What it says that it has, or else what it did not import from elsewhere itself."""
    root = path.partition(".")[0]
    if root == "ddlib":
        with suppress(ImportError):
            importlib.import_module(path)
    there = vars(sys.modules.get(path, types.ModuleType(path)))
    homes = {name: str(getattr(value, "__module__", path)) for name, value in there.items()}
    modules = {name for name, value in there.items() if isinstance(value, types.ModuleType)}
    own = [n for n, home in homes.items() if home.partition(".")[0] == root and "._" not in home]
    return there.get("__all__", set(own) - modules)


def _of_object(path: str, above) -> list[str]:
    root, *rest = path.split(".")
    given = [made[cell][root] for cell in above if root in made.get(cell, {})]
    value = given[-1] if given else vars(builtins).get(root, GONE)
    for name in rest:
        value = _lying(value, name)
    return [] if value is GONE else dir(value)


def _lying(value, name: str):
    """What lies in an object under a name; GONE, if it had to be computed."""
    found = inspect.getattr_static(value, name, GONE)
    if isinstance(found, types.GetSetDescriptorType | types.MemberDescriptorType):
        return getattr(value, name)  # of an array, of slots
    return GONE if hasattr(type(found), "__get__") else found


def _handled(values: dict) -> list[str]:
    """Names of widgets: they change by hand, and nothing has to make them again for that."""
    widgets = sys.modules.get("anywidget")
    return sorted(n for n, v in values.items() if widgets and isinstance(v, widgets.AnyWidget))


def _stand(above) -> None:
    """Give names what the cells above gave them."""
    space.clear()
    space.update(BARE)
    for name in above:
        space.update(made.get(name, {}))
    for name in [n for n, value in space.items() if value is GONE]:
        del space[name]


def _only_problems(emit):
    kinds = {"error", "syntax", "hint", "memory", "stopped", "torch", "above", "after", "progress"}

    def only(kind, text):
        if kind in kinds:
            emit(kind, text)

    only.quiet = True
    return only


class _Printer(pickle.Pickler):
    """Pickles, with functions that have no name of their own by their code, to be compared."""

    def reducer_override(self, value):
        own = isinstance(value, types.FunctionType) and value.__globals__ is space
        if own or (isinstance(value, types.FunctionType) and "<locals>" in value.__qualname__):
            inside = [cell.cell_contents for cell in value.__closure__ or ()]
            code = marshal.dumps(value.__code__, 2)
            more = [value.__defaults__, value.__kwdefaults__, inside, value.__dict__]
            return tuple, ([code, *more],)
        if isinstance(value, type) and value.__module__ == BARE["__name__"]:
            parts = {n: v for n, v in vars(value).items() if n not in WITHOUT_CONTENT}
            return tuple, ([value.__qualname__, value.__bases__, parts],)
        if isinstance(value, types.ModuleType):
            return str, (value.__name__,)
        return NotImplemented


class _Digest:
    def __init__(self):
        self.sum = hashlib.sha1(usedforsecurity=False)

    def write(self, content):
        self.sum.update(content)
        return len(content)


def footprint(value) -> str | None:
    """The same for the same value, another one for another; None if nobody can tell."""
    digest = _Digest()
    try:
        _Printer(digest).dump(value)
    except Exception:  # what cannot be pickled says so in many ways
        return None
    return digest.sum.hexdigest()


class Progress:
    """In place of `tqdm`: the page draws it."""

    emit = None
    last = 0.0

    def __init__(self, iterable=None, desc="", total=None, **options):
        self.iterable, self.desc, self.n = iterable, desc or "", 0
        self.total = len(iterable) if total is None and hasattr(iterable, "__len__") else total

    def __iter__(self):
        for value in self.iterable:
            yield value
            self.update()

    def update(self, n=1):
        self.n += n
        now = time.monotonic()
        if self.emit is None or now - Progress.last < 0.1:
            return
        Progress.last = now
        if self.total:
            Progress.emit("progress", json.dumps([self.n / self.total, self.desc]))

    def __enter__(self):
        return self

    def __exit__(self, *error):
        self.close()

    @staticmethod
    def get_lock():
        return nullcontext()

    def __getattr__(self, name):
        if name.startswith("_"):
            raise AttributeError(name)
        return lambda *args, **options: None


def trange(*args, **options):
    return Progress(range(*args), **options)


class OneThread:
    """In place of a pool of threads: a page has one."""

    def __init__(self, workers, **options):
        pass

    def __enter__(self):
        return self

    def __exit__(self, *error):
        pass

    @staticmethod
    def submit(work, *given):
        """The future of work that is done."""
        future = concurrent.futures.Future()
        try:
            future.set_result(work(*given))
        except Exception as error:
            future.set_exception(error)
        return future


def start() -> None:
    """Take the place of `tqdm` and of threads; the memory that Python began with was made once."""
    random.seed()
    concurrent.futures.ThreadPoolExecutor = OneThread
    for name in ("tqdm", "tqdm.auto"):
        sys.modules[name] = types.ModuleType(name)
        vars(sys.modules[name]).update(tqdm=Progress, trange=trange)
    sys.modules["tqdm"].auto = sys.modules["tqdm.auto"]


async def _until_it_runs(tree, name: str, emit, fetch) -> bool:
    """Run it, again after each package that it turns out to need."""
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
                if leaving:
                    leaving.clear()
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
    quiet = getattr(emit, "quiet", False)
    if last is not None and value is not None and not quiet:
        show(value, emit)
    pyplot = sys.modules.get("matplotlib.pyplot")
    for number in pyplot.get_fignums() if pyplot and not quiet else ():
        show(pyplot.figure(number), emit)
    if pyplot:
        pyplot.close("all")


def show(value, emit) -> None:
    """A value as a notebook would show it."""
    widgets = sys.modules.get("anywidget")
    if widgets and isinstance(value, widgets.AnyWidget):
        return emit("widget", str(value.show()))
    if leaving is not None and hasattr(type(value), "narrow"):  # it is drawn when it is asked for
        leaving.append(value)
        return emit("figure", f'<div class="ddlib-figure">{value.svg}</div>')
    for kind in ("html", "svg", "latex", "markdown"):
        represent = getattr(value, f"_repr_{kind}_", None)
        text = represent() if represent and not isinstance(value, type) else None
        if text:
            return emit("html" if kind == "svg" else kind, text)
    if hasattr(value, "savefig"):
        return emit("html", _svg(value))
    emit("text", f"{value!r}\n")


def forms(emit) -> None:
    """Tell `emit(cell, number, text)` of the shown figures with their forms for a narrow page."""
    for name, (cells, figures) in drawn.items():
        _stand(cells)  # a figure's function finds the names of its cell
        for number, figure in enumerate(figures):
            with suppress(Exception):  # the wide one stays
                emit(name, number, figure._repr_html_())
    drawn.clear()


def display(*values) -> None:
    """Show values below the cell that runs."""
    sys.stdout.flush()  # what was printed comes first
    for value in values:
        show(value, emitting)


def heard(text: str, buffers) -> str:
    """Take what a widget of the page says; returns the names of the widgets that this changed."""
    widget = {"number": json.loads(text)["number"]}
    out = Stream(lambda _, line: page(json.dumps({**widget, "said": line}), []), "text")
    moved = []
    with redirect_stdout(out), redirect_stderr(out):
        try:
            moved = sys.modules["anywidget"].heard(text, buffers)
        except Exception as error:
            out.write(f"{type(error).__name__}: {error}\n")
    out.flush()
    page(json.dumps({**widget, "applied": True}), [])
    given = (pair for names in (*made.values(), space) for pair in names.items())
    return json.dumps(sorted({n for n, value in given if any(value is w for w in moved)}))


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
    elif isinstance(error, KeyboardInterrupt):
        sys.last_value = error  # as in a notebook: what a training reached is to be had from it
        emit("stopped", str(error))
        return
    else:
        inside = error.__traceback__
        while inside and inside.tb_frame.f_code.co_filename != name:
            inside = inside.tb_next
        lines = traceback.format_exception(type(error), error, inside)
        emit("error", "".join(lines))
        if isinstance(error, MemoryError) or TOO_BIG.search(str(error)):
            emit("memory", "")
            return
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
