"""*Run this page*: the names that a cell takes from the cells above, and gives to those below.

By its code alone, before it runs; rather a name too many than one too few.
"""

from __future__ import annotations

import ast
from collections.abc import Collection
from dataclasses import dataclass, field

IN_PLACE = frozenset(
    "add append appendleft clear discard extend fill insert load_state_dict pop popitem popleft "
    "put remove resize reverse seed set setdefault setflags shuffle sort step train update "
    # a generator of random numbers goes on with each draw
    "beta binomial choice exponential gamma integers multivariate_normal normal permutation "
    "permuted poisson random standard_normal uniform".split()
)
"""Methods by which an object changes, or gives something else at the next call."""

HARMLESS = frozenset({"print", "len", "repr", "display"})
FUNCTIONS = ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda
SCOPES = FUNCTIONS | ast.ClassDef
COMPREHENSIONS = ast.ListComp | ast.SetComp | ast.DictComp | ast.GeneratorExp


@dataclass
class Names:
    """What a cell does with the names that all cells share.

    Attributes
    ----------
    reads : set of str
        What has to be there before; with what its functions read when they are called.
    writes : set of str
        What it binds whenever it runs through.
    perhaps : set of str
        What it binds or deletes in one case and not in another.
    changes : set of str
        What it may change in place.
    imports : set of str
        What it binds by an import: a module, a function, a class, a constant.
    carries, alters : dict of str to set of str
        What its functions read, and change in place, when they are called from below: by the names
        in which they are to be had.
    holds : dict of str to set of str
        What a name was made from, of the names that were there before.
    """

    reads: set[str] = field(default_factory=set)
    writes: set[str] = field(default_factory=set)
    perhaps: set[str] = field(default_factory=set)
    changes: set[str] = field(default_factory=set)
    imports: set[str] = field(default_factory=set)
    carries: dict[str, set[str]] = field(default_factory=dict)
    alters: dict[str, set[str]] = field(default_factory=dict)
    holds: dict[str, set[str]] = field(default_factory=dict)

    def as_dict(self) -> dict:
        """For the page, without what is empty."""
        lists = {}
        for kind, known in vars(self).items():
            if isinstance(known, dict):
                known = {name: sorted(of) for name, of in sorted(known.items()) if of}
            if known:
                lists[kind] = known if isinstance(known, dict) else sorted(known)
        return lists


def names(source: str, imported: Collection[str] = ()) -> Names:
    """The names of a cell, below cells that imported some; none of a cell that is no Python."""
    try:
        body = ast.parse(source).body
    except (SyntaxError, ValueError):
        return Names()
    cell = _Cell(imported)
    cell.statements(body)
    cell.close()
    return cell.names


class _Cell(ast.NodeVisitor):
    """Goes through statements as they run, and knows what is bound by then."""

    def __init__(self, imported: Collection[str]):
        self.names = Names()
        self.imported = set(imported)
        self.bound: list[set[str]] = [set()]  # bound by now, in each branch around
        self.parts: dict[str, set[str]] = {}  # of a loop's names: what they are parts of

    def statements(self, body):
        for node in body:
            self.visit(node)
            self.hold(node)

    def hold(self, node):
        """What its names are made from by a statement."""
        if isinstance(node, SCOPES):
            return
        headers = [node]
        if isinstance(node, ast.For | ast.AsyncFor):
            headers = [node.target, node.iter]
        elif isinstance(node, ast.With | ast.AsyncWith):
            headers = node.items
        elif hasattr(node, "body"):
            return
        nodes = [part for header in headers for part in ast.walk(header)]
        loads = {n.id for n in nodes if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Load)}
        for name in set().union(*map(_stored, nodes)):
            self.names.holds.setdefault(name, set()).update(loads - {name})
            for inner in (_Function(n) for n in nodes if isinstance(n, ast.Lambda)):
                self.names.carries.setdefault(name, set()).update(inner.reads)
                self.names.alters.setdefault(name, set()).update(inner.changes - self.imported)

    def close(self):
        """Take what names hold through each other together; keep what the page can use."""
        cell = self.names
        given = cell.writes | cell.perhaps | cell.changes
        sources = {name: _reached(name, cell.holds) for name in given}
        for kind in ("carries", "alters"):
            direct = getattr(cell, kind)
            total = {n: set().union(*(direct.get(m, ()) for m in sources[n])) for n in given}
            setattr(cell, kind, {n: names for n, names in total.items() if names})
        outer = {n: (sources[n] & cell.reads) - {n} for n in given}
        cell.holds = {n: names for n, names in outer.items() if names}

    def branch(self, *bodies):
        """Bodies of which each may run or not: what they bind is bound perhaps."""
        for body in bodies:
            self.bound.append(set(self.bound[-1]))
            self.statements(body)
            self.bound.pop()

    def read(self, name):
        if name not in self.bound[-1]:
            self.names.reads.add(name)

    def write(self, name):
        (self.names.writes if len(self.bound) == 1 else self.names.perhaps).add(name)
        self.bound[-1].add(name)
        self.imported.discard(name)

    def change(self, name, whole=True):
        """In place: it had to be there, and is another one afterwards. Modules stay as they are.

        With a loop's name `whole` changes, too: what it is a part of.
        """
        if whole and name in self.parts:
            of = self.parts.pop(name)  # loops may lead in a circle
            for other in of - {name}:
                self.change(other)
            self.parts[name] = of
        if name not in self.bound[-1] and name not in self.imported:
            self.names.reads.add(name)
            self.names.changes.add(name)

    # --- names ---
    def visit_Name(self, node):
        (self.read if isinstance(node.ctx, ast.Load) else self.write)(node.id)
        if isinstance(node.ctx, ast.Del):
            self.names.perhaps.add(node.id)

    def visit_alias(self, node):
        name = node.asname or node.name.partition(".")[0]
        self.write(name)
        self.imported.add(name)
        self.names.imports.add(name)

    def visit_Assign(self, node):
        self.visit(node.value)
        for target in node.targets:
            self.visit(target)

    def visit_AnnAssign(self, node):
        if node.value is not None:
            self.visit(node.value)
            self.visit(node.target)

    def visit_NamedExpr(self, node):
        self.visit(node.value)
        self.visit(node.target)

    def visit_AugAssign(self, node):
        self.visit(node.value)
        for name in _bases(node.target):
            self.change(name)
        if isinstance(node.target, ast.Name):
            self.write(node.target.id)
        else:
            self.generic_visit(node.target)

    def _store(self, node):
        if not isinstance(node.ctx, ast.Load):
            for name in _bases(node):
                self.change(name)
        self.generic_visit(node)

    visit_Attribute = visit_Subscript = _store

    def visit_Expr(self, node):
        """What a call is made for whose value nobody takes: a change of what it was given."""
        call = node.value
        self.generic_visit(node)
        if not isinstance(call, ast.Call):
            return
        if isinstance(call.func, ast.Name) and call.func.id in HARMLESS:
            return
        method = isinstance(call.func, ast.Attribute)
        if method and _bases(call.func) <= self.imported:
            return  # a figure
        if method and call.func.attr in IN_PLACE:
            return  # what it is given stays as it is
        given = [*call.args, *(keyword.value for keyword in call.keywords)]
        for part in [call.func, *given] if method else given:
            for name in _bases(part):
                self.change(name, whole=part is call.func)

    def visit_Call(self, node):
        self.generic_visit(node)
        if isinstance(node.func, ast.Attribute) and node.func.attr in IN_PLACE:
            for name in _bases(node.func):
                self.change(name)
                made_for = self.names.holds.get(name, ()) if node.func.attr == "step" else ()
                for other in made_for:
                    self.change(other)  # an optimiser takes its step with what it was made for

    # --- what may run, or not, or again ---
    def visit_If(self, node):
        self.visit(node.test)
        self.branch(node.body, node.orelse)

    def visit_While(self, node):
        self.visit(node.test)
        self.branch(node.body, node.orelse)

    def visit_For(self, node):
        """Its body is taken to run at least once."""
        self.visit(node.iter)
        targets, sources = [node.target], [node.iter]
        if isinstance(node.iter, ast.Call) and isinstance(node.target, ast.Tuple):
            if getattr(node.iter.func, "id", "") == "zip":
                targets, sources = node.target.elts, node.iter.args
        for target, source in zip(targets, sources):
            if isinstance(source, ast.Name | ast.Attribute | ast.Subscript):
                for name in _stored(target):
                    self.parts[name] = set(_bases(source))
        self.statements([node.target, *node.body, *node.orelse])

    def visit_Try(self, node):
        handlers = [[*([h.type] if h.type else []), *h.body] for h in node.handlers]
        self.branch(node.body, *handlers, node.orelse)
        self.statements(node.finalbody)

    visit_TryStar = visit_Try

    def visit_Match(self, node):
        self.visit(node.subject)
        self.branch(*([case.pattern, *case.body] for case in node.cases))

    def visit_MatchAs(self, node):
        if node.name:
            self.write(node.name)
        self.generic_visit(node)

    visit_MatchStar = visit_MatchAs

    # --- scopes of their own ---
    def _inside(self, node):
        """Names that a function's body shares with the cell, read and changed at a call."""
        inner = _Function(node)
        for name in inner.reads:
            self.read(name)
        if hasattr(node, "name"):
            self.names.carries.setdefault(node.name, set()).update(inner.reads)
            self.names.alters.setdefault(node.name, set()).update(inner.changes - self.imported)

    def _scope(self, node):
        for part in _run_at_definition(node):
            self.visit(part)
        if hasattr(node, "name"):
            self.write(node.name)
        self._inside(node)

    visit_FunctionDef = visit_AsyncFunctionDef = visit_Lambda = visit_ClassDef = _scope

    def _comprehension(self, node):
        inner = _Function(node)
        for name in inner.reads:
            self.read(name)
        for name in inner.changes:
            self.change(name)
        for name in inner.given:
            self.write(name)

    visit_ListComp = visit_SetComp = visit_DictComp = visit_GeneratorExp = _comprehension


class _Function:
    """Names that a scope reads and changes and that are not its own."""

    def __init__(self, node):
        args = getattr(node, "args", None)
        own = set()
        if args is not None:
            every = [*args.posonlyargs, *args.args, *args.kwonlyargs, args.vararg, args.kwarg]
            own = {arg.arg for arg in every if arg is not None}
        in_comprehension = isinstance(node, COMPREHENSIONS)
        if in_comprehension:
            todo = list(ast.iter_child_nodes(node))
        else:
            todo = list(node.body) if isinstance(node.body, list) else [node.body]
        shared, loads, self.changes, inner = set(), set(), set(), []
        self.given = set()  # by `:=` in a comprehension: to the scope around it
        while todo:
            part = todo.pop()
            if isinstance(part, SCOPES):
                inner.append(part)
                if hasattr(part, "name"):
                    own.add(part.name)
                todo += _run_at_definition(part)
                continue
            if isinstance(part, COMPREHENSIONS):
                inner.append(part)
                continue
            if isinstance(part, ast.NamedExpr) and in_comprehension:
                self.given.add(part.target.id)
                todo.append(part.value)
                continue
            if isinstance(part, ast.Global):
                shared |= set(part.names)
            elif isinstance(part, ast.Name):
                (loads if isinstance(part.ctx, ast.Load) else own).add(part.id)
            elif isinstance(part, ast.alias):
                own.add(part.asname or part.name.partition(".")[0])
            elif isinstance(part, ast.ExceptHandler | ast.MatchAs | ast.MatchStar) and part.name:
                own.add(part.name)
            elif isinstance(part, ast.Attribute | ast.Subscript | ast.Call):
                self.changes |= _stored(part)
            todo += ast.iter_child_nodes(part)
        for scope in map(_Function, inner):
            (self.given if in_comprehension else own).update(scope.given)
            loads |= scope.reads
            self.changes |= scope.changes
        own -= shared
        self.reads = (loads | shared) - own
        self.changes = (self.changes | shared) - own


def _run_at_definition(scope) -> list[ast.AST]:
    """What of a function or class runs where it stands, and not in its body."""
    parts = [*getattr(scope, "decorator_list", ()), *getattr(scope, "bases", ())]
    parts += [keyword.value for keyword in getattr(scope, "keywords", ())]
    if not isinstance(scope, ast.ClassDef):
        parts += [*scope.args.defaults, *filter(None, scope.args.kw_defaults)]
    return parts


def _reached(name: str, steps: dict[str, set[str]]) -> set[str]:
    """A name, and all to which steps lead from it."""
    reached, new = set(), {name}
    while new:
        reached |= new
        new = set().union(*(steps.get(n, ()) for n in new)) - reached
    return reached


def _bases(node) -> set[str]:
    """The name of which a part is meant: `a` of `a.b[0].c()`."""
    while True:
        if isinstance(node, ast.Subscript | ast.Attribute | ast.Starred):
            node = node.value
        elif isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
            node = node.func
        else:
            break
    if isinstance(node, ast.Tuple | ast.List):
        return set().union(*map(_bases, node.elts))
    return {node.id} if isinstance(node, ast.Name) else set()


def _stored(node) -> set[str]:
    """Names that a node binds or changes in place."""
    if isinstance(node, ast.Name | ast.Attribute | ast.Subscript):
        return set() if isinstance(node.ctx, ast.Load) else _bases(node)
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
        return _bases(node.func) if node.func.attr in IN_PLACE else set()
    return set()
