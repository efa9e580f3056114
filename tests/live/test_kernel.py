"""*Run this page*: what Python does in the page, here without one: cells, names, what is told."""

import concurrent.futures
import importlib
import json
import sys
import types
from functools import partial

import kernel
import numpy as np
import pytest

from ddlib.learning import TrainingSet, Weights
from ddlib.setups import JOINT_DAMPING


def test_a_cell_finds_what_the_cells_above_gave_and_no_more(run):
    run("a, b = 1, 2", "one")
    run("a = 10", "two", ["one"])
    assert run("print(a)", "three", ["one"])[0] == [("text", "1\n")]  # not that of a cell below
    assert run("print(a, b)", "three", ["one", "two"])[0] == [("text", "10 2\n")]
    run("b = 3", "one")  # it gives no `a` any more
    assert run("print(b)\na", "three", ["one"])[0][0] == ("text", "3\n")
    assert run("a", "three", ["one"])[0][-1] == ("hint", "a")
    run("del b", "two", ["one"])
    assert run("b", "three", ["one", "two"])[0][-1] == ("hint", "b")
    run("def f():\n    return k", "one")
    run("k = 5", "two", ["one"])
    assert run("print(f())", "three", ["one", "two"])[0] == [("text", "5\n")]


FIGURE = """
class Figure:
    def __init__(self, draw):
        self.draw, self.svg = draw, "<svg>wide</svg>"
    @property
    def narrow(self):
        return self.draw()
    def _repr_html_(self):
        return self.svg + self.narrow
"""


def test_forms_for_a_narrow_page_are_drawn_when_they_are_wanted(run):
    drawn = []
    run(FIGURE, "one")
    kernel.made["one"]["drawn"] = drawn
    code = "a = 1\ndef draw():\n    drawn.append(a)\n    return f'narrow {a}'\nFigure(draw)"
    wide = '<div class="ddlib-figure"><svg>wide</svg></div>'
    assert run(code, "two", ["one"], wide=True)[0] == [("figure", wide)] and not drawn
    run("a = 2", "three", ["one", "two"])
    told = []
    for _ in range(2):
        kernel.forms(lambda *said: told.append(said))
    assert told == [("two", 0, "<svg>wide</svg>narrow 1")]  # by the names of its own cell
    assert run(code, "two", ["one"])[0] == [("html", told[0][2])]  # on a narrow page at once


def test_what_is_tried_beside_is_not_kept(run):
    run("mine = 1", "one")
    shown, about = run("mine = 2\nprint(mine)", "solution", [], keep=False)
    assert shown == [("text", "2\n")] and about is None
    assert run("print(mine)", "two", ["one"])[0] == [("text", "1\n")]


def test_a_cell_that_is_quiet_shows_problems_alone(run):
    assert run("print(1)\n2", "one", quiet=True)[0] == []
    assert [kind for kind, _ in run("1 / 0", "one", quiet=True)[0]] == ["error"]


@pytest.mark.parametrize(
    ("one", "other", "same"),
    [
        ("1", "1", True),
        ("1", "1.0", False),
        ("np.arange(3)", "np.arange(3)", True),
        ("np.arange(3)", "np.arange(4)", False),
        ("[1, {2: 'a'}]", "[1, {2: 'a'}]", True),
        ("lambda x: x + 1", "lambda x: x + 1", True),
        ("lambda x: x + 1", "lambda x: x + 2", False),
        ("made(2)", "made(2)", True),
        ("made(2)", "made(3)", False),
        ("Arm.from_links('a', Link(1.0, 1.0, 1.0, 1.0), Link(1.0, 1.0, 1.0, 1.0))",
         "Arm.from_links('a', Link(1.0, 1.0, 1.0, 1.0), Link(1.0, 1.0, 1.0, 2.0))", False),
        ("judging(print)", "judging(print)", True),  # a function that a package's function made
        ("judging(print)", "judging(len)", False),
        ("np.random.default_rng(1)", "np.random.default_rng(1)", True),
        ("np.random.default_rng(1)", "np.random.default_rng(2)", False),
    ],
)  # fmt: skip
def test_what_differs_and_what_does_not(run, one, other, same):
    head = "import numpy as np\nfrom ddlib.dynamics import Arm, Link\n"
    head += "from workshop.chapters.exercises import judging\n"
    head += "def made(k):\n    return lambda x: k * x\n"
    prints = [run(f"{head}value = {code}", "one")[1]["prints"]["value"] for code in (one, other)]
    assert None not in prints and (prints[0] == prints[1]) == same


@pytest.mark.parametrize(
    ("one", "two", "altered"),
    [
        ("a = [1]", "a[0] = 1", []),  # as it was
        ("a, b = [1], [2]\ndef add():\n    b.append(3)", "a.append(2)\nadd()", ["a", "b"]),
        ("a = [1]\nb = a", "b.append(2)", ["a", "b"]),  # two names of one object
        ("a = [1]\nb = {'x': a}", "a.append(2)", ["a", "b"]),  # a part
        ("a = [1]\ndef f(x):\n    x.append(2)\n    return x", "b = f(a)", ["a"]),
        ("a = (k for k in [1, 2])", "print(list(a))", ["a"]),
        ("def a(k, at=[]):\n    at.append(k)\n    return at", "b = a(1)", ["a"]),
        ("class A:\n    n = 0\n    def f(self):\n        self.n += 1\na = A()", "b = a.f()", ["a"]),
        ("a = [1]\nb = a", "c = a + b", []),
    ],
)  # fmt: skip
def test_what_was_changed_in_place_is_told(run, one, two, altered):
    run(one, "one")
    assert run(two, "two", ["one"])[1]["altered"] == altered


def test_a_name_that_the_code_does_not_show_is_told(run):
    run("def f():\n    global a\n    a = 1", "one")
    assert run("f()\nexec('b = 2')", "two", ["one"])[1]["perhaps"] == ["a", "b"]


def test_a_syntax_error_has_its_line_in_words(run):
    shown, about = run("a = 1\nb = (2", "one")
    assert [kind for kind, _ in shown] == ["error", "syntax"] and about is None
    assert json.loads(shown[1][1]) == [2, "'(' was never closed"]


def test_a_training_shows_its_progress_and_can_be_stopped(run, monkeypatch):
    monkeypatch.setattr(concurrent.futures, "ThreadPoolExecutor", None)  # given back at the end
    monkeypatch.setitem(sys.modules, "tqdm", types.ModuleType("tqdm"))
    monkeypatch.setitem(sys.modules, "tqdm.auto", types.ModuleType("tqdm.auto"))
    kernel.start()
    code = "from tqdm.auto import tqdm\nimport time\nfor done in tqdm(range(9), desc='epochs'):\n"
    stop = "    if done == 2:\n        raise KeyboardInterrupt('after three')"
    shown, _ = run(f"{code}    time.sleep(0.11)\n{stop}", "one")
    kinds = [kind for kind, _ in shown]
    assert kinds == ["progress", "progress", "stopped"]
    assert json.loads(shown[0][1])[1:] == ["epochs"]
    assert shown[-1] == ("stopped", "after three")
    assert isinstance(sys.last_value, KeyboardInterrupt)
    assert run("print(done)", "two", ["one"])[0] == [("text", "2\n")]


def test_cells_say_what_they_cannot(run, monkeypatch):
    monkeypatch.setitem(sys.modules, "torch", None)
    monkeypatch.setattr(kernel, "blocked", set())
    assert run("import torch\nimport math\nnet = 1", "one")[0] == [("torch", "PyTorch")]
    assert run("import math\nprint(math.pi > 3)\nnet", "two", ["one"])[0] == [
        ("text", "True\n"),
        ("above", "net"),
    ]
    assert run("net = 2\nnet + 1", "one")[0] == [("text", "3\n")]
    error, hint = run("x = 1\nx / 0", "one")[0]
    assert 'File "one", line 2' in error[1] and hint == ("after", "")


def test_ensembles_train_with_the_progress_bar_and_the_one_thread_of_a_page(monkeypatch):
    data = TrainingSet.from_recording(JOINT_DAMPING.record([(30, 20), (10, 40), (45, 5)]), 11)
    descent, threads = (
        importlib.import_module(f"ddlib.learning.{name}") for name in ("descent", "_threads")
    )
    start = Weights.random(3, 11, 3, seed=1)
    train = partial(descent.train_ensemble, start, data, epochs=60, progress=False)
    _, wanted, _ = train()
    monkeypatch.setattr(descent, "tqdm", kernel.Progress)
    monkeypatch.setattr(threads, "ThreadPoolExecutor", kernel.OneThread)
    np.testing.assert_array_equal(train()[1].training, wanted.training)


MASS = """
import functools
class Arm:
    __slots__ = ("links", "__dict__")
    def __init__(self):
        self.mass, self.links = 1.0, [1]
    @property
    def slow(self):
        raise RuntimeError
    @functools.cached_property
    def late(self):
        raise RuntimeError
    def __getattr__(self, name):
        raise RuntimeError
arm = Arm()
"""


@pytest.mark.parametrize(
    ("path", "some"),
    [
        ("arm", {"mass", "links", "slow", "late"}),
        ("arm.links", {"append"}),
        ("arm.mass", {"real"}),
        ("str", {"join"}),
        ("arm.slow", None),
        ("arm.late", None),
        ("arm.nothing", None),
        ("nobody", None),
    ],
)
def test_names_for_the_editor_are_looked_up_and_nothing_is_called(run, path, some):
    run(MASS, "one")
    run("arm = 0", "two", ["one"])
    found = json.loads(kernel.parts(path, False, ["one"]))  # not what a cell below gave
    assert some <= set(found) if some else found == []


def test_names_to_import_are_those_of_the_module_itself():
    assert json.loads(kernel.parts("ddlib.metrics", True, [])) == ["rmss"]
    assert "pd" in json.loads(kernel.parts("ddlib.control", True, []))
    assert json.loads(kernel.parts("ddlib.nothing", True, [])) == []
    assert json.loads(kernel.parts("antigravity", True, [])) == []  # nobody asked for it
