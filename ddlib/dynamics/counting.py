"""Numbers that count the arithmetic done with them; what is known off-line costs nothing."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable
from typing import NamedTuple

from ddlib._check import integer, number


class Operations(NamedTuple):
    """How much arithmetic a computation needs. A subtraction counts as an addition."""

    multiplications: int
    additions: int
    divisions: int = 0
    functions: int = 0


class Tape:
    """A record of arithmetic.

    Operations among known numbers are free, so are adding a known zero, multiplying by a known
    zero, one or minus one, and a change of sign: it merges with the addition that follows.
    """

    def __init__(self):
        self._shared: dict[tuple, _Counted] = {}
        self._done: Counter = Counter()
        self._size = 0

    def unknown(self, value: float):
        """A number that is not known before the computation runs, like a joint angle."""
        return self._make(number("value", value), ())

    def known(self, value: float):
        """A number that is known off-line, like the mass of a link."""
        return self._once(("known", number("value", value)), value, None)

    @property
    def executed(self) -> Operations:
        """Everything that was computed, repetitions included."""
        return _tally(self._done)

    def needed(self, results: Iterable) -> Operations:
        """What the `results` need when nothing is computed twice or in vain."""
        waiting = [x for x in results if isinstance(x, _Counted)]
        seen, kinds = set(), Counter()
        while waiting:
            node = waiting.pop()
            if node.recipe and node.index not in seen:
                seen.add(node.index)
                kinds[node.recipe[0]] += 1
                waiting += node.recipe[1:]
        return _tally(kinds)

    def _make(self, value, recipe) -> _Counted:
        self._size += 1
        return _Counted(self, self._size, value, recipe)

    def _once(self, key, value, recipe) -> _Counted:
        """The number made before under the same key, or a new one."""
        if key not in self._shared:
            self._shared[key] = self._make(value, recipe)
        return self._shared[key]

    def _operate(self, kind: str, value: float, *operands: _Counted) -> _Counted:
        """The result of an operation of which one operand at least is not known."""
        self._done[kind] += 1
        return self._once((kind, *(x.index for x in operands)), value, (kind, *operands))


class _Counted:
    """A number of a `Tape`. It works in ``+ - * /``, `numpy.sin` and `numpy.cos`.

    Its `recipe`: kind of operation and operands; empty for an input, None if known off-line.
    """

    __slots__ = ("index", "negated", "recipe", "tape", "value")

    def __init__(self, tape: Tape, index: int, value: float, recipe: tuple | None):
        self.tape, self.index, self.value, self.recipe = tape, index, float(value), recipe
        self.negated = bool(recipe) and recipe[0] == "negate"

    def __repr__(self):
        return f"Counted({self.value!r})"

    def _is(self, *values) -> bool:
        """Whether it is known off-line to be one of the values."""
        return self.recipe is None and self.value in values

    def __neg__(self):
        if self.recipe is None:
            return self.tape.known(-self.value)
        if self.negated:
            return self.recipe[1]
        return self.tape._once(("negate", self.index), -self.value, ("negate", self))

    def __add__(self, other):
        other = self._lift(other)
        value = self.value + other.value
        if self.recipe is None or other.recipe is None:
            if self.recipe is other.recipe:
                return self.tape.known(value)
            if self._is(0.0) or other._is(0.0):
                return other if self._is(0.0) else self
        if self.negated and other.negated:
            return -(-self + -other)
        if self.negated or (not other.negated and other.index < self.index):
            self, other = other, self  # one order, so that a sum is recognised
        return self.tape._operate("add", value, self, other)

    __radd__ = __add__

    def __sub__(self, other):
        return self + -self._lift(other)

    def __rsub__(self, other):
        return self._lift(other) - self

    def __mul__(self, other):
        other = self._lift(other)
        value = self.value * other.value
        if self.recipe is None or other.recipe is None:
            if self.recipe is other.recipe:
                return self.tape.known(value)
            constant, factor = (self, other) if self.recipe is None else (other, self)
            if constant._is(-1.0, 0.0, 1.0):
                return {-1.0: -factor, 0.0: constant, 1.0: factor}[constant.value]
        if self.negated:
            return -(-self * other)
        if other.negated:
            return -(self * -other)
        if other.index < self.index:
            self, other = other, self
        return self.tape._operate("multiply", value, self, other)

    __rmul__ = __mul__

    def __truediv__(self, other):
        other = self._lift(other)
        if other.recipe is None:
            return self * self.tape.known(1 / other.value)  # the reciprocal is made off-line
        return self.tape._operate("divide", self.value / other.value, self, other)

    def __rtruediv__(self, other):
        return self._lift(other) / self

    def __pow__(self, power):
        """A power by repeated multiplication."""
        result = self
        for _ in range(1, integer("power", power, 1)):
            result = result * self
        return result

    def sin(self):
        """The sine, as `numpy.sin` calls it."""
        return self._function("sine", math.sin(self.value))

    def cos(self):
        """The cosine, as `numpy.cos` calls it."""
        return self._function("cosine", math.cos(self.value))

    def _function(self, kind, value):
        if self.recipe is None:
            return self.tape.known(value)
        return self.tape._operate(kind, value, self)

    def _lift(self, other) -> _Counted:
        """`other` as a number of this tape; a plain number is one that is known."""
        if not isinstance(other, _Counted):
            return self.tape.known(other)
        if other.tape is not self.tape:
            raise ValueError("other must be a number of the same tape")
        return other


def _tally(kinds: Counter) -> Operations:
    return Operations(
        kinds["multiply"], kinds["add"], kinds["divide"], kinds["sine"] + kinds["cosine"]
    )
