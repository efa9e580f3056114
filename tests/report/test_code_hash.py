"""The hash of what makes a result: it sees what can change a number, and nothing else."""

import re

import pytest

from workshop.report import code_hash as hashes, results

STUDY = """
from ddlib.code_hash import study
from ddlib.rooms import gain
from ddlib.rooms.noise import LEVEL
import numpy as np

@study
def first_one(scale=2.0):
    found = np.ones(3) * scale
    return {"value": gain(found, rate=LEVEL).sum()}

@study
def second():
    return {"value": np.zeros(3)}
"""
HANDED_ON = "from .plant import gain as gain\n"
PLANT = '''
from ddlib._check import number

def gain(x, rate=1.0):
    """Some words."""
    number("rate", rate, 0.0)
    if rate > 3:
        raise ValueError("too much")
    return [_turn(k, rate) for k in x]

def _turn(k, rate):
    return k + rate if k < 1 else _turn(k - 1, rate)
'''
FILES = {
    "studies/some.py": STUDY,
    "rooms/__init__.pyi": HANDED_ON,
    "rooms/plant.py": PLANT,
    "rooms/noise.py": "LEVEL = 0.5\nOTHER = 1.0\n",
    "_check.py": "def number(name, value, low): return value\n",
}


@pytest.fixture
def package(tmp_path, monkeypatch):
    """``package(file, old, new)`` edits a small package and returns the hash of its first study."""
    monkeypatch.setattr(hashes, "_ROOTS", {"ddlib": tmp_path})

    def write(name, text):
        path = tmp_path / name
        path.parent.mkdir(exist_ok=True)
        path.write_text(text)

    for name, text in FILES.items():
        write(name, text)

    def edit(*changes):
        for name, old, new in changes:
            text = (tmp_path / name).read_text() if (tmp_path / name).exists() else ""
            assert old in text
            write(name, text.replace(old, new) if old else text + new)
        return hashes.code_hash("first-one")

    return edit


IDLE = {
    "words": [("rooms/plant.py", "Some words.", "Other words, for `gain`.")],
    "layout": [("rooms/plant.py", "k + rate", "(k  # a remark\n        + rate)")],
    "an annotation": [("rooms/plant.py", "def gain(x, rate=1.0)", "def gain(x: list, rate=1.0)")],
    "a refusal": [("rooms/plant.py", "if rate > 3:", "if not rate <= 3:")],
    "a check": [("rooms/plant.py", 'number("rate", rate, 0.0)', "assert rate")],
    "a private name": [("rooms/plant.py", "_turn", "_turned")],
    "a local name": [("studies/some.py", "found", "ones")],
    "an import's name": [
        ("studies/some.py", "numpy as np", "numpy"),
        ("studies/some.py", "np.", "numpy."),
    ],
    "another constant": [("rooms/noise.py", "OTHER = 1.0", "OTHER = 2.0")],
    "another study": [("studies/some.py", "np.zeros(3)", "np.zeros(4)")],
    "a name that moves": [
        ("rooms/noise.py", "LEVEL = 0.5\n", ""),
        ("rooms/level.py", "", "STRENGTH = 0.5\n"),
        ("studies/some.py", "rooms.noise import LEVEL", "rooms.level import STRENGTH as LEVEL"),
    ],
    "another way to hand on": [
        ("rooms/__init__.pyi", HANDED_ON, ""),
        ("rooms/__init__.py", "", "from ddlib.rooms.plant import gain\n"),
    ],
}


@pytest.mark.parametrize("what", IDLE)
def test_what_cannot_change_a_number_does_not_count(package, what):
    before = package()
    assert package(*IDLE[what]) == before


BUSY = {
    "a constant": ("rooms/noise.py", "LEVEL = 0.5", "LEVEL = 0.6"),
    "a constant that is changed later": ("rooms/noise.py", "", "LEVEL += 1\n"),
    "a default": ("studies/some.py", "scale=2.0", "scale=2.5"),
    "an operator": ("rooms/plant.py", "k + rate", "k - rate"),
    "a branch": ("rooms/plant.py", "k < 1", "k <= 1"),
    "another function": ("studies/some.py", "np.ones", "np.zeros"),
    "an argument's name": ("studies/some.py", "rate=LEVEL", "LEVEL"),
    "the order of arguments": ("rooms/plant.py", "gain(x, rate=1.0)", "gain(rate, x=1.0)"),
    "a key": ("studies/some.py", '"value": gain', '"values": gain'),
    "a guard that also counts": ("rooms/plant.py", "if rate > 3:", "if (rate := 2 * rate) > 3:"),
    "a loop that fills": ("rooms/noise.py", "", "for _ in (1,):\n    LEVEL += 1\n"),
    "a default of the same name": (
        "rooms/plant.py",
        "def gain(x, rate=1.0):",
        "RATE = 2.0\n\ndef gain(x, rate=RATE):",
    ),
    "a decorator": ("rooms/plant.py", "def _turn", "@cache\ndef _turn"),
}


@pytest.mark.parametrize("what", BUSY)
def test_what_can_change_a_number_counts(package, what):
    before = package()
    assert package(BUSY[what]) != before


def test_studies_are_found_by_their_mark(package):
    assert hashes.places() == {
        "first-one": ("ddlib.studies.some", "first_one"),
        "second": ("ddlib.studies.some", "second"),
    }


def test_every_committed_result_is_what_this_code_gives():
    written = {name: results.read(name)["made by"]["code"] for name in hashes.places()}
    assert written == {name: hashes.code_hash(name) for name in written}, (
        "book/results is not what this code gives: run `make reproduce`"
    )
    assert len(set(written.values())) == len(written) > 30
    assert all(re.fullmatch("[0-9a-f]{16}", code) for code in written.values())
