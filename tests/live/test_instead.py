"""*Run this page*: what stands in for PyTorch and for widgets does as they do."""

import importlib.util
import io
import json
import subprocess
import sys
from contextlib import redirect_stdout

import kernel
import numpy as np
import pytest
import torch
import traitlets
from book_pages import ROOT, WALK
from live.packages import PAGE
from open_cells import SHORT, imports

import ddlib.learning
from ddlib.learning import TrainingSet, Weights
from ddlib.setups import JOINT_DAMPING

INSTEAD = PAGE / "instead"
LEARNING = [page for page in WALK if "torch" in imports(page)]
LEARNING += ["book/whose-filters", "book/learning-in-the-loop"]  # by ddlib alone


def stand_in(name: str):
    """A module of the page; under its own name in here."""
    spec = importlib.util.spec_from_file_location(f"{name}_of_a_page", INSTEAD / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


twin = stand_in("torch")

STEPS = [
    lambda t, a, b: a + b,
    lambda t, a, b: 2.5 - a,
    lambda t, a, b: a * b,
    lambda t, a, b: a / (b**2 + 1),
    lambda t, a, b: 3 / (a.square() + 1),
    lambda t, a, b: (a @ b.T) @ b / 3,
    lambda t, a, b: a @ b[0] + b[:, :1],
    lambda t, a, b: t.sigmoid(a) @ t.eye(3, dtype=t.float64),
    lambda t, a, b: t.tanh(a).exp(),
    lambda t, a, b: (a * a + 1).log().sqrt(),
    lambda t, a, b: t.cat([a, b], 1)[:, 1:4],
    lambda t, a, b: t.stack([a, b])[1] - a.mean(0, keepdim=True),
    lambda t, a, b: a.reshape(3, -1).T.flatten().reshape(b.shape),
    lambda t, a, b: t.where(b > 0, a, b * 2),
    lambda t, a, b: a.unsqueeze(1).transpose(0, 1)[0, [2, 0, 2]],
    lambda t, a, b: a.abs() + b.std(1, keepdim=True),
    lambda t, a, b: t.nn.Softsign()(a) - b.sum((0, 1)),
]


def expression(t, x, y, draws):
    a, b = (t.tensor(part, requires_grad=True) for part in (x, y))
    first = a, b
    for step in draws:
        a, b = b, STEPS[step](t, a, b)
    result = (a * b).mean() + (b**3).sum() / 7
    slopes = t.autograd.grad(result, first, **({} if t is twin else {"allow_unused": False}))
    return [result.detach().numpy(), *(slope.numpy() for slope in slopes)]


@pytest.mark.parametrize("seed", range(20))
def test_derivatives_are_those_of_pytorch(seed):
    rng = np.random.default_rng(seed)
    x, y = rng.normal(size=(2, 3, 3))
    draws = [seed % len(STEPS), *rng.integers(len(STEPS), size=4)]
    for ours, theirs in zip(*(expression(t, x, y, draws) for t in (twin, torch))):
        assert ours.shape == theirs.shape
        np.testing.assert_allclose(ours, theirs, rtol=1e-12, atol=1e-12 * np.abs(theirs).max())


def test_random_numbers_and_first_weights_are_those_of_pytorch():
    for seed in (0, 7, 2**31):
        twin.manual_seed(seed)
        torch.manual_seed(seed)
        np.testing.assert_array_equal(twin.rand(5, 3).numpy(), torch.rand(5, 3).numpy())
        ours, theirs = twin.nn.Linear(6, 4), torch.nn.Linear(6, 4)
        for name in ("weight", "bias"):
            parts = (getattr(layer, name).detach().numpy() for layer in (ours, theirs))
            np.testing.assert_array_equal(*parts)


@pytest.mark.parametrize(
    "optimiser",
    [lambda t, p: t.optim.SGD(p, 0.01, momentum=0.9), lambda t, p: t.optim.Adam(p, 0.01)],
)
def test_steps_are_those_of_pytorch(optimiser):
    ends = []
    for t in (twin, torch):
        t.manual_seed(0)
        net = t.nn.Sequential(t.nn.Linear(3, 5), t.nn.Tanh(), t.nn.Linear(5, 1)).double()
        x = t.tensor(np.random.default_rng(0).normal(size=(20, 3)))
        steps = optimiser(t, net.parameters())
        for _ in range(50):
            steps.zero_grad()
            ((net(x)[:, 0] - x[:, 0] * x[:, 1]) ** 2).mean().backward()
            steps.step()
        ends.append(net(x).detach().numpy())
    np.testing.assert_allclose(*ends, rtol=1e-9)


def test_solve_finds_the_same_by_what_stands_in_for_pytorch(monkeypatch):
    recording = JOINT_DAMPING.record([(30, 20), (10, 40), (45, 5)])
    data = TrainingSet.from_recording(recording, 11)
    start = Weights.random(2, 11, 3, seed=1)
    how = {"steps": 12, "decay": 1e-4, "progress": False}
    with pytest.warns(ddlib.learning.NotConverged):
        theirs = ddlib.learning.solve(start, data, **how)
    monkeypatch.setitem(sys.modules, "torch", twin)
    for name in ("gauss_newton", "levenberg_marquardt"):
        monkeypatch.delitem(sys.modules, f"ddlib.learning.{name}")
    module = importlib.import_module("ddlib.learning.levenberg_marquardt")
    with pytest.warns(module.NotConverged):
        ours = module.solve(start, data, **how)
    np.testing.assert_allclose(ours.objective, theirs.objective, rtol=1e-6)
    np.testing.assert_allclose(ours.history.training, theirs.history.training, rtol=1e-6)


def test_what_is_lacking_is_named():
    with pytest.raises(twin.Lacks, match=r"torch\.nn\.Conv1d is not in this page"):
        twin.nn.Conv1d(2, 3, 5)
    with pytest.raises(twin.Lacks, match=r"torch\.Tensor\.cumsum"):
        twin.zeros(3).cumsum(0)


WITHOUT_TORCH = """
import os, re, sys
from importlib.util import module_from_spec, spec_from_file_location
sys.path[:0] = {path}
spec = spec_from_file_location("torch", {instead!r})
sys.modules["torch"] = module_from_spec(spec)
spec.loader.exec_module(sys.modules["torch"])
"""

RUN = """
from chapter_rules import CHANGE_THIS, is_starter, tags, visible
from open_cells import execute, lesson
import matplotlib
matplotlib.use("Agg")
cells, space = visible(lesson({page!r})), {{"__name__": "__main__"}}
os.chdir("book")
for cell in cells:
    if not is_starter(cell):
        print(cell.id, execute(cell.source, space, cell.id))
    if CHANGE_THIS in tags(cell):
        exec({short!r}, space)
"""

TRAIN = """
from ddlib.learning import TrainingSet, Weights, train_ensemble
from ddlib.setups import JOINT_DAMPING
data = TrainingSet.from_recording(JOINT_DAMPING.record([(30, 20), (10, 40), (45, 5)]), 11)
start = Weights.random(40, 11, 3, seed=1)
_, history, kept = train_ensemble(start, data, snapshots=[5, 60], epochs=60, progress=False)
print(*history.training[-1, [0, -1]], abs(kept[60].hidden_weights).sum())
"""


def in_a_page(code: str) -> str:
    """What code prints where there is no PyTorch."""
    path = [str(ROOT / p) for p in ("tests/support", "book", "book/_ext/live/page", ".")]
    before = WITHOUT_TORCH.format(path=path, instead=str(INSTEAD / "torch.py"))
    command = [sys.executable, "-c", before + code]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert not done.returncode, done.stderr[-2000:]
    return done.stdout


def test_an_ensemble_is_trained_as_with_pytorch(capsys):
    exec(TRAIN, {})
    ours, theirs = (np.array(t.split(), float) for t in (in_a_page(TRAIN), capsys.readouterr().out))
    np.testing.assert_allclose(ours, theirs, rtol=1e-4)


@pytest.mark.slow
@pytest.mark.parametrize("page", LEARNING)
def test_open_cells_run_through_without_pytorch(page):
    printed = in_a_page(RUN.format(page=page, short=SHORT.get(page[5:], "")))
    assert len(printed.splitlines()) > 5


@pytest.fixture
def widgets(monkeypatch):
    """What stands in for anywidget, and what it tells the page."""
    told = []
    monkeypatch.setattr(kernel, "page", lambda text, parts: told.append((json.loads(text), parts)))
    monkeypatch.setattr(kernel, "space", {})
    module = stand_in("anywidget")
    monkeypatch.setitem(sys.modules, "anywidget", module)
    return module, told


def test_a_widget_and_the_page_share_their_values(widgets):
    module, told = widgets

    class Dial(module.AnyWidget):
        _esm = "export default {}"
        angle = traitlets.CFloat(1.0, max=90).tag(sync=True)
        table = traitlets.Bytes(b"ab").tag(sync=True, from_json=lambda value, _: bytes(value))
        answer = traitlets.Int(0, read_only=True).tag(sync=True)
        twice = traitlets.Float()

        def __init__(self):
            super().__init__()
            self.observe(lambda _: setattr(self, "twice", 2 * self.angle), "angle")

    def hear(*parts, **message):
        told.clear()
        message = {"number": dial._number, **message}
        return json.loads(kernel.heard(json.dumps(message), parts))

    dial = Dial()
    dial.angle = 2
    assert not told  # nobody sees it yet
    kernel.show(dial, lambda *said: told.append(said))
    (first, parts), shown = told
    assert (first["state"], first["binary"], parts) == (
        {"angle": 2, "answer": 0}, ["table"], [b"ab"],
    )  # fmt: skip
    assert first["made"]["esm"] == Dial._esm and shown == ("widget", str(dial._number))
    told.clear()
    with dial.hold_sync():
        dial.angle, dial.table = 3, b"cd"
    dial.angle = 3.0
    assert len(told) == 1 and (told[0][0]["state"], told[0][1]) == ({"angle": 3}, [b"cd"])

    kernel.space.update(mine=dial, other=1)
    assert hear(state={"angle": 5}, binary=[]) == ["mine"]
    assert (dial.angle, dial.twice) == (5, 10) and told == [
        ({"number": dial._number, "applied": True}, [])
    ]
    assert hear(b"ef", state={}, binary=["table"]) == ["mine"] and dial.table == b"ef"
    assert hear(state={"angle": 5, "answer": 4}, binary=[]) == []  # an answer is no setting
    assert hear(state={"angle": 100}, binary=[]) == [] and dial.angle == 5
    assert told[0][0]["state"] == {"angle": 5} and "TraitError" in told[1][0]["said"]

    dial.on_msg(lambda widget, content, parts: widget.set_trait("angle", content["to"]))
    assert hear(content={"to": 7}) == ["mine"] and told[0][0]["state"] == {"angle": 7}
    dial.observe(lambda change: print("now", change["new"]), "angle")
    hear(state={"angle": 8}, binary=[])
    assert told[0][0]["said"] == "now 8.0\n"
    hear(closed=True)
    dial.angle = 9
    assert len(told) == 1


def test_sliders_move_what_they_are_tied_to(widgets, monkeypatch):
    _, told = widgets
    monkeypatch.setattr(kernel, "emitting", lambda *said: told.append(said))
    sliders = stand_in("ipywidgets")
    whole, other = sliders.IntSlider(6, min=1, max=6), sliders.FloatSlider(max=45, step=0.5)
    sliders.link((whole, "value"), (other, "value"))
    printed = io.StringIO()
    with redirect_stdout(printed):

        @sliders.interact(number=whole)
        def show(number):
            print(number)

        whole.value = 9
        other.value = 2.0
    assert printed.getvalue() == "6\n2\n" and whole.value == 2 and other.value == 2.0
    assert ("widget", str(whole._number)) in told
    with pytest.raises(ImportError, match="Dropdown is not in this page"):
        sliders.Dropdown  # noqa: B018
