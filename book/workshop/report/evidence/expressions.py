"""Measures that only read committed results, written down in ``book/claims.yml`` as ``find``.

A *path* leads into a result: ``table-6-1/slope``. At a list a number takes one place, ``:`` goes on
from each, ``:5`` from the first five, ``width=21&rate=100`` takes the one row with these entries;
``a|b`` adds two up, and ``path or path`` is the first that exists. The numbers at its end are a
*cell*, one for each member (a network, a day, a seed); null, a run that was stopped, counts as
infinite. Cells are combined member by member by `_CELLS`, the members pooled by `_POOLED` (the
median, if none is named), pooled values compared by `_FORMS`::

    find: {median: table-6-1/slope, text: "{0:spread}"}

    find:
      ratio: ["hidden-units/rows/units=20/{column}", "hidden-units/rows/units=10/{column}"]
      text: "{0} with 20, {1} with 10"
    with: {column: test}

    find:
      least: {paired: {ratio: ["{table}/{w}/errors/test", "{table}/{w}/errors/training"]}}
      for: {w: [11, 21, 41]}
      text: "test / training {each}"
    with: {table: table-4-1/setups/state feedback}

``{name}`` stands for an argument in ``with`` or, with ``for``, for one value after another. Members
are drawn anew as `verdicts.bootstrap` does, cell by cell as they are named; those
below ``paired`` belong to the same members and are drawn together; ``nested: true`` draws the
members of each member, too. A cell of one member, or below ``fixed``, is not drawn. ``of`` gives
names to cells, in the order in which they are drawn; what only the text names is not drawn.

The text shows ``{0}``, ``{1}``, … or a name: a cell's median to two digits. After a colon may stand
another statistic (`_STATISTICS`), then digits, "power" or a format of Python: ``{0:mean .0%}``.
Further there are ``{value}``, what is judged; ``{each}``, all that the outermost form compares, of
which ``{each[0]}`` is the first; ``{draws}``, the value in all draws; and of each ``least`` that
goes through values with ``for``, what it is and where: ``{least[0]} at {at[0]}``.
"""

from __future__ import annotations

import itertools
import json
import re
from collections.abc import Callable, Mapping

import numpy as np

from ddlib.learning import p_value
from ddlib.tables import scientific, significant, spread
from workshop.report import results
from workshop.report.evidence.verdicts import Measured, bootstrap, mean, median


def _furthest(*parts) -> np.ndarray:
    """Of some ratios the one furthest from 1, for each draw."""
    parts = np.array(parts)
    return np.take_along_axis(parts, np.abs(np.log(parts)).argmax(0)[None], 0)[0]


# What makes one cell of others, member by member; cut to the fewest members
_CELLS = {
    "over": np.divide,
    "times": np.multiply,
    "plus": np.add,
    "less": np.subtract,
    "lesser": np.minimum,
    "above": np.greater,
    "size": np.abs,
    "average": lambda *cells: np.mean(cells, axis=0),
    "medians": lambda cell: np.median(cell, axis=1),  # of what each member has
    "rms": lambda cell: np.sqrt((cell**2).mean(-1)),  # of what each member has
}

# What pools the members of a cell, in each draw
_POOLED = {
    "median": median,
    "mean": mean,
    "root mean": lambda cell: np.sqrt(cell.mean(tuple(range(1, cell.ndim)))),
    "max": lambda cell: cell.max(tuple(range(1, cell.ndim))),
    "min": lambda cell: cell.min(tuple(range(1, cell.ndim))),
}

# What compares pooled values. Two more need what ``for`` goes through: ``best`` tells of which of
# it the least value is, ``rising`` whether the values rise in an ``order``.
_FORMS = {
    "ratio": lambda a, b: a / b,
    "difference": lambda a, b: a - b,
    "deviation": lambda part: np.abs(part - 1),
    "largest": lambda *parts: np.max(parts, axis=0),
    "least": lambda *parts: np.min(parts, axis=0),
    "furthest": _furthest,  # from 1
    "apart": lambda *parts: np.exp(np.max(np.abs(np.log(parts)), axis=0)),  # a factor, up or down
    "excess": lambda first, *others: first - np.max(others, axis=0),
}

# What the text shows of a cell. Three more: ``spread``, the median with the range; ``all``, each
# member; ``p``, the chance that a member is as large as the mean of the first cell.
_STATISTICS = {
    "median": np.median,
    "mean": np.mean,
    "root": lambda cell: np.sqrt(np.mean(cell)),  # of the mean
    "min": np.min,
    "max": np.max,
    "sum": np.sum,
    "count": np.size,
}

_FIXED = "fixed"


def find(expression: Mapping, arguments: Mapping | None = None) -> Measured:
    """What an expression finds in the committed results: value, text, replicates."""
    return _Expression(expression, dict(arguments or {})).measured()


class _Expression:
    """One expression: the cells that are drawn, by group, and the statistic of them."""

    def __init__(self, expression: Mapping, arguments: dict):
        rest = dict(expression)
        self.text, self.nested = rest.pop("text"), rest.pop("nested", False)
        self.names, self.arguments = rest.pop("of", {}), arguments
        # in the order in which they are drawn: those with a name first
        self.groups: dict[str, list] = {name: [] for name in self.names}
        self.cells: dict[str, np.ndarray] = {}  # all of them, as {0}, {1}, ... in the text
        self.parts: list[Callable] | None = None  # what the outermost form compares
        self.leasts: list[dict] = []  # what each least with `for` compares, by label
        self.statistic = self._compiled(rest, arguments, "")
        self.drawn = {key: tuple(cells) for key, cells in self.groups.items() if cells}
        self.nested &= any(cell.ndim > 1 for cells in self.drawn.values() for cell in cells)
        if self.nested:
            self.drawn = {key: _as_many_each(cells) for key, cells in self.drawn.items()}
        self.once = {key: tuple(c[None] for c in cells) for key, cells in self.drawn.items()}

    def value(self) -> float | bool:
        """The value of all members, each once."""
        value = self.statistic(self.once)[0]
        return bool(value) if value.dtype == bool else float(value)

    def measured(self) -> Measured:
        """The value with its text and, where members are drawn, its replicates."""
        value, replicates = self.value(), None
        if self.drawn:
            replicates = bootstrap(
                lambda *drawn: self.statistic(dict(zip(self.drawn, drawn))),
                *self.drawn.values(),
                nested=self.nested,
            )
        return Measured(value, self._words(value, replicates), replicates)

    def _words(self, value, replicates) -> str:
        first = next(iter(self.cells.values()))
        words = {
            name: _Words(self._cell(c, self.arguments), first) for name, c in self.names.items()
        }
        words["value"], words["draws"] = _Words(value), _Words(replicates)
        words["each"] = _Several(_Words(part(self.once)[0]) for part in self.parts or [])
        leasts = [
            min((part(self.once)[0], at) for at, part in some.items()) for some in self.leasts
        ]
        words["least"] = [_Words(least) for least, _ in leasts]
        words["at"] = [at for _, at in leasts]
        cells = (_Words(cell, first) for cell in self.cells.values())
        return self.text.format(*cells, **self.arguments, **words)

    def _compiled(self, entry, names: dict, group: str) -> Callable:
        """A function of the drawn groups that gives one number for each draw."""
        if not isinstance(entry, Mapping):
            return self._leaf(median, entry, names, group)
        more = dict(entry)
        loop, order = more.pop("for", {}), _values(more.pop("order", []), names)
        ((form, inner),) = more.items()
        if form in _POOLED:
            return self._leaf(_POOLED[form], inner, names, group)
        if form in _CELLS:
            return self._leaf(median, more, names, group)
        if _FIXED in (form, group) and form in (_FIXED, "paired"):
            return self._compiled(inner, names, _FIXED)
        if form == "paired":
            self.groups[key := f"paired {len(self.groups)}"] = []
            return self._compiled(inner, names, key)
        if form not in (*_FORMS, "best", "rising"):
            known = ", ".join([*_FORMS, "best", "rising", *_POOLED, *_CELLS, "paired", _FIXED])
            raise ValueError(f"form must be one of {known}, got {form!r}")
        outermost, self.parts = self.parts is None, self.parts or []
        parts = [self._compiled(part, env, group) for part, env in _several(inner, loop, names)]
        if outermost:
            self.parts = parts
        labels = _values(*loop.values(), names) if loop else ()
        if form == "least" and loop:
            self.leasts.append(dict(zip(labels, parts)))
        if form in _FORMS:
            return lambda drawn: _FORMS[form](
                *np.broadcast_arrays(*(part(drawn) for part in parts))
            )
        if form == "best":
            return lambda drawn: np.array(labels)[
                np.argmin([part(drawn) for part in parts], axis=0)
            ]
        return lambda drawn: _rising({k: part(drawn) for k, part in zip(labels, parts)}, order)

    def _leaf(self, pool: Callable, entry, names: dict, group: str) -> Callable:
        """A function of the drawn groups that pools one cell, which joins its group."""
        cell = np.asarray(self._cell(entry, names))
        key = entry if self._named(entry) else _filled(json.dumps(entry), names)
        self.cells.setdefault(key, cell)
        if cell.size == 1 or group == _FIXED:
            value = pool(cell[None])
            return lambda drawn: value
        cells = self.groups.setdefault(group or key, [])
        if group or not cells:
            cells.append(cell)
        place = len(cells) - 1
        return lambda drawn: pool(drawn[group or key][place])

    def _named(self, entry) -> bool:
        return isinstance(entry, str) and entry in self.names

    def _cell(self, entry, names: dict):
        """The numbers of a cell, one for each member."""
        if self._named(entry):
            return self._cell(self.names[entry], self.arguments)
        if isinstance(entry, str):
            return _read(_filled(entry, names))
        if not isinstance(entry, Mapping):
            return entry
        more = dict(entry)
        loop = more.pop("for", {})
        ((form, inner),) = more.items()
        cells = [np.asarray(self._cell(part, env)) for part, env in _several(inner, loop, names)]
        fewest = min((len(cell) for cell in cells if cell.ndim), default=0)
        return _CELLS[form](*(cell[:fewest] if cell.ndim else cell for cell in cells))


def _several(inner, loop: Mapping, names: dict) -> list[tuple]:
    """What a form is of, each with the names that hold for it."""
    if loop:
        ((name, values),) = loop.items()
        return [(inner, {**names, name: value}) for value in _values(values, names)]
    return [(part, names) for part in (inner if isinstance(inner, list) else [inner])]


def _values(values, names: dict) -> list:
    """A list, or the argument of that name."""
    return names[values] if isinstance(values, str) else values


def _filled(text: str, names: dict) -> str:
    for name, value in names.items():
        text = text.replace(f"{{{name}}}", str(value))
    return text


def _as_many_each(cells: tuple) -> tuple:
    """Cells of the same members, those with nothing or one for each member repeated."""
    wide = [cell if cell.ndim > 1 else cell[:, None] for cell in cells]
    most = max(cell.shape[1] for cell in wide)
    return tuple(
        np.broadcast_to(cell, (len(cell), most)) if cell.shape[1] == 1 else cell for cell in wide
    )


def _rising(parts: Mapping, order) -> np.ndarray:
    """Whether values rise in an order of their labels; those of equal rank are a list."""
    ranks = [[parts[k] for k in (level if isinstance(level, list) else [level])] for level in order]
    steps = itertools.pairwise(ranks)
    return np.all([np.max(low, axis=0) < np.min(high, axis=0) for low, high in steps], axis=0)


# --- paths ----------------------------------------------------------------------------------


def _read(paths: str) -> np.ndarray:
    """The numbers at the first of some paths that exists."""
    first = None
    for path in paths.split(" or "):
        name, _, rest = path.partition("/")
        try:
            numbers = np.asarray(_at(results.read(name), rest, path))
        except ValueError as error:
            first = first or error
            continue
        if numbers.dtype == object:  # null among numbers
            numbers = np.array(numbers, float)
        return (
            np.where(np.isnan(numbers), np.inf, numbers) if numbers.dtype.kind == "f" else numbers
        )
    raise first


def _at(value, rest: str, path: str):
    """What stands at the rest of a path."""
    if not rest:
        return value
    head, _, tail = rest.partition("/")
    if isinstance(value, dict):
        keys = [key for key in value if rest == key or rest.startswith(f"{key}/")]
        if keys:
            key = max(keys, key=len)  # keys may hold a slash
            return _at(value[key], rest[len(key) + 1 :], path)
        known = ", ".join(map(repr, value))
    elif isinstance(value, list):
        if "=" in head:
            wanted = dict(pair.split("=", 1) for pair in head.split("&"))
            rows = [r for r in value if all(str(r.get(k)) == v for k, v in wanted.items())]
            if len(rows) == 1:
                return _at(rows[0], tail, path)
            entries = {k: sorted({str(r.get(k)) for r in value}) for k in wanted}
            known = f"one row of {len(value)} with {entries}, not {len(rows)}"
        else:
            if re.fullmatch(r"-?\d*:-?\d*", head):
                places = slice(*(int(end) if end else None for end in head.split(":")))
                return [_at(item, tail, path) for item in value[places]]
            if head.lstrip("-").isdigit() and -len(value) <= int(head) < len(value):
                return _at(value[int(head)], tail, path)
            known = f"':' and places below {len(value)}"
    else:
        known = "nothing: a number stands there"
    if "|" in head:
        return np.sum([_at(value, f"{key}/{tail}".rstrip("/"), path) for key in head.split("|")], 0)
    raise ValueError(f"path must lead into a result, got {path!r}: at {rest!r} there is {known}")


# --- words ----------------------------------------------------------------------------------


class _Words:
    """Numbers that a template shows by what stands after the colon."""

    def __init__(self, values, first=None):
        self.values, self.first = np.asarray(values), first

    def __format__(self, spec: str) -> str:
        name, _, rest = spec.partition(" ")
        if name == "spread":
            return spread(self.values, int(rest or 2))
        if name == "all":
            return ", ".join(_number(value, rest) for value in self.values)
        if name == "p":
            return format(p_value(self.first.mean(), self.values, "more"), rest)
        if name in _STATISTICS:
            return _number(_STATISTICS[name](self.values), rest)
        return _number(
            self.values.item() if self.values.ndim == 0 else np.median(self.values), spec
        )


class _Several(list):
    """Numbers that a template shows one after another, or a statistic of them."""

    def __format__(self, spec: str) -> str:
        if spec.partition(" ")[0] in _STATISTICS:
            return format(_Words([words.values for words in self]), spec)
        return ", ".join(format(words, spec) for words in self)


def _number(value, form: str) -> str:
    if not form or form.isdigit():
        return significant(value, int(form or 2))
    return scientific(value) if form == "power" else format(value, form).replace("%", " %")
