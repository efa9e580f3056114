"""Mistakes planted in what claims measure: what is kept of them tells nearly all.

A mistake is a word of a path, a form or an argument in place of a related one, or two cells that
change places, where that leads to another value; all values doubled or halved; and, which only the
spread shows, members drawn apart that belong together, or on one level of two.
"""

import json
import math
import re

import numpy as np
import pytest

from workshop.report import results
from workshop.report.evidence import claims, judging
from workshop.report.evidence.expressions import _Expression, find

KEPT = {name: judging._parts(e) for name, e in results.read(judging._NAME)["claims"].items()}
FINDS = [claim for claim in claims.load() if claim.find]
MEASURES = [claim for claim in claims.load() if claim.measure]
ALIKE = [
    ("training", "test", "best test"), ("hidden", "direct"), ("shoulder", "elbow"),
    ("11", "21", "41"), ("real", "untrained", "phases", "shifted"), ("position", "velocity"),
    ("state feedback", "position feedback", "joint damping"), ("velocity", "acceleration"),
    ("inertia", "friction"), ("signs", "bits"), ("median", "mean"), ("ratio", "difference"),
    ("largest", "least", "furthest"), ("over", "less"),
]  # fmt: skip
pytestmark = pytest.mark.skipif(
    not results._committed(), reason="what is kept is of the committed results"
)


def misread(word: str):
    """A text in which one word is a related one, each in its turn."""
    for words in ALIKE:
        for found in re.finditer(rf"(?<!\w)({'|'.join(words)})(?!\w)", word):
            for other in (one for one in words if one != found[0]):
                yield word[: found.start()] + other + word[found.end() :]


def swapped(entry):
    """What stands in the claims file with one mistake, each in its turn."""
    if isinstance(entry, dict):
        for key, part in entry.items():
            others = {k: v for k, v in entry.items() if k != key}
            yield from ({new: part, **others} for new in misread(key) if new not in entry)
            yield from ({**entry, key: new} for new in swapped(part) if key != "text")
    elif isinstance(entry, list):
        for k, part in enumerate(entry):
            yield from ([*entry[:k], new, *entry[k + 1 :]] for new in swapped(part))
        if len(entry) == 2:
            yield entry[::-1]
    elif isinstance(entry, (str, int)) and not isinstance(entry, bool):
        yield from map(type(entry), misread(str(entry)))


def apart(entry):
    """An expression whose members are all drawn apart, and on one level."""
    if isinstance(entry, list):
        return [apart(part) for part in entry]
    if not isinstance(entry, dict):
        return entry
    more = {key: part for key, part in entry.items() if key != "nested"}
    more.update(more.pop("paired", {}))
    return {key: apart(part) for key, part in more.items()}


def once_each(entries) -> list:
    return [json.loads(entry) for entry in {json.dumps(entry): 0 for entry in entries}]


def tell(what: str, caught: list[bool], planted: int):
    """It fails if less than 97 % are caught, or hardly any were planted."""
    print(f"{what}: {sum(caught)} of {len(caught)} caught")
    assert len(caught) > planted and sum(caught) >= 0.97 * len(caught)


@np.errstate(all="ignore")
def test_another_cell():
    caught = []
    for claim in FINDS:
        right = _Expression(claim.find, claim.arguments).value()
        others = [[expression, claim.arguments] for expression in swapped(claim.find)]
        others += [[claim.find, arguments] for arguments in swapped(claim.arguments)]
        for other in once_each(others):
            try:
                value = float(_Expression(*other).value())
            except (LookupError, OSError, TypeError, ValueError):
                continue  # the path leads nowhere, which is told
            if math.isfinite(value) and value != right:
                caught.append(not judging._same(claim, KEPT[claim.id][1][:1], [value]))
    tell("another cell", caught, 500)


@pytest.mark.slow
def test_another_argument():
    caught = []
    for claim in MEASURES:
        for arguments in once_each(swapped(claim.arguments)):
            try:
                found = claims._measure(json.dumps([claim.measure, {}, arguments]))
            except Exception:
                continue  # whatever it is, it is told
            if found.value != claim.measured().value:
                caught.append(not judging._same(claim, KEPT[claim.id][1], judging._numbers(found)))
    tell("another argument", caught, 100)


def test_another_spread():
    caught = []
    for claim in FINDS:
        if (other := apart(claim.find)) != claim.find:
            right, found = claim.measured().replicates, find(other, claim.arguments)
            if not np.array_equal(right, found.replicates):
                caught.append(not judging._same(claim, KEPT[claim.id][1], judging._numbers(found)))
    tell("another spread", caught, 50)


@pytest.mark.parametrize("factor", [2, 0.5])
def test_another_size(factor):
    numbers = [(c, KEPT[c.id][1]) for c in (*FINDS, *MEASURES) if "is" not in c.band]
    caught = [not judging._same(c, n, [factor * x for x in n]) for c, n in numbers if n[0]]
    tell(f"{factor} times as large", caught, 300)
