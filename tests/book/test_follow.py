"""*Run this page*: what follows from a change, by the code, and against what running shows."""

import ast
import html
import io
import json
import sys
import types
from contextlib import chdir, redirect_stdout

import live_pages
import matplotlib
import pytest
from book_pages import ROOT, WALK
from chapter_rules import CHANGE_THIS, tags
from open_cells import SHORT, lesson

sys.path.insert(0, str(ROOT / "book" / "_ext"))
sys.path.insert(0, str(ROOT / "book" / "_ext" / "live_page"))
import handles
import kernel
import live
from names import names

SCRIPT = (live.PAGE / "follow.js").read_text(encoding="utf-8")
GRAPH = """(cells) => follow.graph(cells).map(({from, changes}) =>
  ({from: Object.fromEntries(from), changes: [...changes]}))"""
AFTER = "([cells, places]) => [...follow.after(cells, follow.graph(cells), places)].sort()"
RENAMED = "([before, now]) => { const r = follow.renamed(before, now); return r ? [...r] : null }"
SPOILED = "([cells, place, turn]) => follow.spoiled(follow.graph(cells), place, turn) ?? null"


@pytest.fixture(scope="module")
def script(browser):
    """A page in which `follow` is there."""
    tab = browser.new_page()
    tab.add_script_tag(content=SCRIPT)
    yield tab
    tab.close()


def told(*sources):
    return [{"names": names(source).told()} for source in sources]


@pytest.mark.parametrize(
    ("source", "wanted"),
    [
        ("x = y + 1", {"reads": ["y"], "writes": ["x"], "holds": {"x": ["y"]}}),
        ("x = 1\nx + 1", {"writes": ["x"]}),
        ("if a:\n    x = 1", {"reads": ["a"], "perhaps": ["x"]}),
        ("for k in a:\n    b = k\nb", {"reads": ["a"], "writes": ["b", "k"]}),
        ("a[0] = 1", {"reads": ["a"], "changes": ["a"]}),
        ("a.b.c = 1", {"reads": ["a"], "changes": ["a"]}),
        ("a += b", {"reads": ["a", "b"], "writes": ["a"], "changes": ["a"]}),
        ("x = a.append(1)", {"reads": ["a"], "writes": ["x"], "changes": ["a"]}),
        ("fit(a)", {"reads": ["a", "fit"], "changes": ["a"]}),
        ("ax.plot(t)", {"reads": ["ax", "t"], "changes": ["ax", "t"]}),
        ("print(a)", {"reads": ["a", "print"]}),
        ("def f(x):\n    return x * k", {"reads": ["k"], "writes": ["f"], "carries": {"f": ["k"]}}),
        ("def f():\n    a.append(1)", {"reads": ["a"], "alters": {"f": ["a"]}}),
        ("law = lambda q: k * q", {"reads": ["k"], "carries": {"law": ["k"]}}),
        ("[x := x + k for k in b]", {"reads": ["b", "x"], "writes": ["x"]}),
        ("x = [k * a for k in b]", {"reads": ["a", "b"], "writes": ["x"]}),
        ("del a", {"perhaps": ["a"]}),
        ("import a.b as c, d.e", {"writes": ["c", "d"], "imports": ["c", "d"]}),
        ("x = (", {}),
        ("", {}),
    ],
)  # fmt: skip
def test_names_of_a_cell(source, wanted):
    found = names(source).told()
    assert {kind: found.get(kind) for kind in wanted} == wanted
    assert wanted or not found


def test_a_module_that_draws_is_not_changed():
    assert "changes" not in names("figures.curves(t, x)", {"figures"}).told()
    assert names("figures = Own()\nfigures.draw(t)", {"figures"}).told()["changes"] == ["t"]


@pytest.mark.browser
@pytest.mark.parametrize(
    ("cells", "places", "wanted"),
    [
        (["a = 1", "b = a", "c = 1", "d = b"], [0], [1, 3]),
        (["a = 1", "a = 2", "b = a"], [0], []),
        (["a = []", "a.append(1)", "b = a", "c = 1"], [0], [1, 2]),
        (["a = []", "a.append(1)", "b = a"], [1], [2]),
        (["k = 1", "def f():\n    return k", "k = 2", "b = f()"], [2], [3]),
        (["k = 1", "def f():\n    return k", "g = [f]", "k = 2", "b = g[0]()"], [3], [4]),
        (["a = []", "def f():\n    a.append(1)", "x = f()", "b = a"], [2], [3]),
        (["if 1:\n    a = 1", "b = a"], [0], [1]),
        (["a = 1", "if b:\n    a = 2", "c = a"], [0], [2]),
    ],
)
def test_cells_that_follow(script, cells, places, wanted):
    assert script.evaluate(AFTER, [told(*cells), places]) == wanted


@pytest.mark.browser
def test_an_object_changed_in_place_is_made_again_first(script):
    cells = told("a = []\nb = 1", "a.append(b)", "c = a", "d = b")
    assert script.evaluate(SPOILED, [cells, 1, [1, 2, 3, 4]]) == {"maker": 0, "name": "a"}
    assert script.evaluate(SPOILED, [cells, 1, [5, 2, 3, 4]]) is None
    assert script.evaluate(SPOILED, [cells, 2, [1, 2, 3, 4]]) is None  # changed above, as it should
    assert script.evaluate(SPOILED, [cells, 3, [1, 2, 3, 4]]) is None
    cells = told("a = [1]", "a = [a, 2]", "a[0].append(3)")  # under the name of what holds it
    assert script.evaluate(SPOILED, [cells, 1, [1, 2, 3]]) == {"maker": 0, "name": "a"}


@pytest.mark.browser
def test_a_figure_to_handle_stays_as_the_reader_left_it(script):
    cells = told("a = Picker()", "b = a.recording", "a.extents = 1, 2")
    turns = [1, 2, 3]
    assert script.evaluate(SPOILED, [cells, 1, turns]) == {"maker": 0, "name": "a"}
    cells[0]["names"]["handled"] = ["a"]
    assert script.evaluate(SPOILED, [cells, 1, turns]) is None


@pytest.mark.browser
@pytest.mark.parametrize(
    ("before", "now", "wanted"),
    [
        ("a = 1\nb = 2", "a = 1\nb = 3", ["b"]),
        ("a, c = 1, 2  # m\nb = 2", "a, c = 1, 3  # m\nb = 2", ["a", "c"]),
        ("kp = 1\nlaw = pd(kp)\nb = 2", "kp = 2\nlaw = pd(kp)\nb = 2", ["kp", "law"]),
        ("a = 1  # m", "a = 1  # metres", []),
        ("a = 1", "a = 1\nb = 2", None),
        ("f(1)\na = 1", "f(2)\na = 1", None),
        ("a = (\n    1,\n)", "a = (\n    2,\n)", None),
        ("a = '# 1'", "a = '# 2'", None),
        ("a = 1\nif a:\n    b = 1", "a = 2\nif a:\n    b = 1", None),
    ],
)
def test_settings_that_differ(script, before, now, wanted):
    assert script.evaluate(RENAMED, [before, now]) == wanted


def opened(page: str) -> list[dict]:
    return [cell for cell in live.live_cells(lesson(page)) if cell["kind"] == "open"]


@pytest.mark.browser
@pytest.mark.slow
@pytest.mark.parametrize("page", WALK)
def test_the_graph_of_a_lesson_against_what_running_shows(script, page, monkeypatch):
    """Each open cell runs with the names alone that the graph gives it, and changes no others."""
    matplotlib.use("Agg")
    cells = opened(page)
    graph = script.evaluate(GRAPH, cells)
    settings = next(cell.id for cell in lesson(page).cells if CHANGE_THIS in tags(cell))
    space: dict = {}
    monkeypatch.setattr(kernel, "space", space)
    made: list[dict] = []
    with chdir(ROOT / "book"), redirect_stdout(io.StringIO()):
        for cell, found in zip(cells, graph):
            space.clear()
            space["__name__"] = "__main__"
            given = set().union(*(found["from"].keys(), found["changes"]))
            for each in made:
                space.update({name: value for name, value in each.items() if name in given})
            before = dict(space)
            every = {name: value for each in made for name, value in each.items()}
            prints = {name: kernel.footprint(value) for name, value in every.items()}
            exec(compile(cell["source"], cell["id"], "exec"), space)
            if cell["id"] == settings:
                exec(SHORT.get(page[5:], ""), space)
            wrote = {n for n, v in space.items() if before.get(n) is not v}
            wrote -= {"__builtins__", "__warningregistry__"}  # Python's own
            own = cell["names"]
            assert wrote <= {*own.get("writes", ()), *own.get("perhaps", ())}
            assert set(own.get("writes", ())) <= space.keys()
            altered = {
                n for n, seen in prints.items() if seen and kernel.footprint(every[n]) != seen
            }
            assert altered <= set(found["changes"])
            made.append({name: space[name] for name in wrote | set(own.get("writes", ()))})
    if "matplotlib.pyplot" in sys.modules:
        sys.modules["matplotlib.pyplot"].close("all")


# --- handles ---


@pytest.mark.parametrize(
    ("line", "wanted"),
    [
        ("window = 21  # samples, odd, from 7 on", [("window", "samples", 7, 83, 2)]),
        ("w, h = 21, 10  # samples (odd, 5 to 101), units",
         [("w", "samples", 5, 101, 2), ("h", "units", 2, 40, 1)]),
        ("width = 41  # samples that a network sees, up to 41", [("width", "samples", 3, 41, 2)]),
        ("derivative = 5  # samples, 5 or more", [("derivative", "samples", 5, 20, 1)]),
        ("kp = 300  # N m/rad, 50 to 1000", [("kp", "N m/rad", 50, 1000, 10)]),
        ("kp = (750.0, 225.0)  # N m/rad, springs",
         [("kp[0]", "N m/rad", 80, 3000, 10), ("kp[1]", "N m/rad", 23, 900, 1)]),
        ("viscous = 5.3  # N m s/rad, above 0", [("viscous", "N m s/rad", 0.1, 21.2, 0.1)]),
        ("initial = 0.03  # size; 0.3 hides it", [("initial", "", 0.003, 0.3, 0.001)]),
        ("momentum = 0.98", [("momentum", "", 0.1, 0.99, 0.01)]),
        ("settle, margin = 0.55, 60.0  # s, °: of a design",
         [("settle", "s", 0.06, 2.2, 0.01), ("margin", "°", 0, 90, 1)]),
        ("seed = 0", [("seed", "", 0, 20, 1)]),
        ("kd = 0.0", [("kd", "", 0, 10, 0.1)]),
        ("arm = with_load(ARM, 0.0)  # kg in the hand", [("arm", "kg", 0, 10, 0.1)]),
        ("link = Link(mass=14.0, com=0.09)  # kg, m",
         [("link, mass", "kg", 2, 56, 1), ("link, com", "m", 0.009, 0.36, 0.001)]),
        ("bearing = -80.0  # degrees", [("bearing", "degrees", -90, 90, 1)]),
        ("epochs = 4000", [("epochs", "", 1000, 8000, 100)]),
        ("late = (0, 1, 2, 3, 4, 5)", []),
        ("name = 'A0'", []),
        ("own = {1: [1]}", []),
        ("x = [[1, 2], [3, 4]]", []),
        ("x = 10**6", []),
    ],
)  # fmt: skip
def test_range_and_unit_of_a_handle(line, wanted):
    found = [(h.label, h.unit, h.low, h.high, h.step) for h in handles.handles(line)]
    assert found == wanted


@pytest.mark.parametrize("page", WALK)
def test_handles_of_a_lesson(page):
    """Each stands for a number of the code, on a step of its range; most settings have one."""
    source = next(cell.source for cell in lesson(page).cells if CHANGE_THIS in tags(cell))
    found = handles.handles(source)
    assert len({handle.label for handle in found}) == len(found) >= 5
    values = {
        node.value
        for node in ast.walk(ast.parse(source))
        if isinstance(node, ast.Constant) and type(node.value) in (int, float)
    }
    for handle in found:
        assert abs(handle.value) in values
        assert handle.low <= handle.value <= handle.high
        assert handle.high - handle.low >= 5 * handle.step
        steps = (handle.value - handle.low) / handle.step
        assert steps == pytest.approx(round(steps), abs=1e-6)
        assert handle.whole == isinstance(handle.value, int)
        if handle.whole:
            assert {type(end) for end in (handle.low, handle.high, handle.step)} == {int}


# --- the kernel ---


@pytest.fixture
def run(monkeypatch):
    """Run a cell below others: what is shown, and what is told of names."""
    for name in ("space", "made", "known", "drawn", "seen"):
        monkeypatch.setattr(kernel, name, {})

    async def nothing(package):
        return False

    def one(source, name, above=(), **how):
        said = []
        emit = lambda *each: said.append(each)  # noqa: E731
        with pytest.raises(StopIteration):  # it waits for nothing; Playwright has a loop of its own
            kernel.run(source, name, emit, nothing, above, **how).send(None)
        shown = [each for each in said if each[0] != "names"]
        about = [json.loads(text) for kind, text in said if kind == "names"]
        return shown, about[0] if about else None

    return one


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


def test_what_nobody_can_compare_differs(run):
    assert run("x = (k for k in range(3))", "one")[1]["prints"]["x"] is None


def test_what_was_changed_in_place_is_told(run):
    run("a, b = [1], [2]\ndef add():\n    b.append(3)", "one")
    assert run("a[0] = 1", "two", ["one"])[1]["altered"] == []  # as it was
    assert run("a.append(2)\nadd()", "two", ["one"])[1]["altered"] == ["a", "b"]


@pytest.mark.parametrize(
    ("one", "two", "altered"),
    [
        ("a = [1]\nb = a", "b.append(2)", ["a", "b"]),  # two names of one object
        ("a = [1]\nb = {'x': a}", "a.append(2)", ["a", "b"]),  # a part
        ("a = [1]\ndef f(x):\n    x.append(2)\n    return x", "b = f(a)", ["a"]),
        ("a = iter([1, 2])", "b = next(a)", ["a"]),
        ("a = (k for k in [1, 2])", "print(list(a))", ["a"]),
        ("def a(k, at=[]):\n    at.append(k)\n    return at", "b = a(1)", ["a"]),
        ("def a():\n    a.n += 1\na.n = 0", "a()", ["a"]),
        ("class A:\n    n = 0\n    def f(self):\n        self.n += 1\na = A()", "b = a.f()", ["a"]),
        ("class A:\n    n = 0\n    def on(self):\n        pass\na = A()", "b = a.on()", []),
        ("a = [1]\nb = a", "c = a + b", []),
    ],
)  # fmt: skip
def test_a_change_that_the_code_does_not_show_is_told(run, one, two, altered):
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
    monkeypatch.setitem(sys.modules, "tqdm", types.ModuleType("tqdm"))
    monkeypatch.setitem(sys.modules, "tqdm.auto", types.ModuleType("tqdm.auto"))
    monkeypatch.setattr(kernel.Progress, "pause", None)
    asked = []

    def pause():
        asked.append(True)
        if len(asked) == 3:
            raise KeyboardInterrupt("after three")
        return True

    kernel.start(pause)
    code = "from tqdm.auto import tqdm\nimport time\nfor done in tqdm(range(9), desc='epochs'):\n"
    shown, _ = run(f"{code}    time.sleep(0.11)", "one")
    kinds = [kind for kind, _ in shown]
    assert kinds == ["progress", "progress", "stopped"]
    assert json.loads(shown[0][1])[1:] == ["epochs", True]
    assert shown[-1] == ("stopped", "after three")
    assert isinstance(sys.last_value, KeyboardInterrupt)
    assert run("print(done)", "two", ["one"])[0] == [("text", "2\n")]


# --- the page ---


@pytest.fixture
def reader(browser, run):
    """Opens a page of such cells and changes some, one after the other: what each prints then."""
    tab = browser.new_page()

    def runs(message):
        shown, about = run(message["source"], message["run"], message["above"], **message["how"])
        said = [*shown, *([("names", json.dumps(about))] if about else [])]
        ended = {"run": message["run"], "done": True, "ok": True, "seconds": 0}
        return [*({"run": message["run"], "kind": k, "text": t} for k, t in said), ended]

    tab.expose_function("runs", runs)
    tab.add_init_script(live_pages.BESIDE)

    def one(cells, *changes):
        island = [
            {"id": f"c{k}", "source": source, **told(source)[0]} for k, source in enumerate(cells)
        ]
        tab.goto(live_pages.set_up(tab, island))
        tab.get_by_role("button", name="Run this page").click()
        tab.locator("html[data-live=idle]").wait_for()
        for k, source in changes:
            tab.get_by_role("textbox").nth(k).fill(source)
            tab.get_by_role("button", name="Run what follows").click()
            tab.locator("html[data-live=idle]").wait_for()
        assert not any(tab.locator(".live-mark").all_inner_texts())
        return [each.inner_text().strip() for each in tab.locator(".live-output").all()]

    one.tab = tab
    yield one
    tab.close()


@pytest.mark.browser
@pytest.mark.parametrize(
    ("cells", "changes"),
    [
        (["a = 1", "a = 2", "print(a)"], [(1, "# a = 2")]),
        (["a = [1]", "a.append(2)", "print(a)"], [(1, "# a.append(2)")]),
        (["i = 2", "a = [1]", "if i > 1:\n    a.append(2)", "print(a)"], [(0, "i = 0")]),
        (["def f():\n    return 1", "def f():\n    return 2", "print(f())"], [(1, "")]),
        (["a = 1", "b = 2", "print(a)"], [(1, "a = 3"), (1, "b = 2")]),
        (["a = [1]", "a += [2]", "a += [3]", "print(a)"], [(2, "a += [4]")]),
        (["a = [1]", "b = a", "b.append(3)", "print(a, b)"], [(2, "b.append(4)")]),
        (["a = [1]", "b = 2", "a.append(3)", "print(a)"], [(1, "b = 2\nprint(a)")]),
        (["a = [1]", "a = a", "a.append(3)", "print(a)"], [(2, "a.append(4)")]),
        (["a = [1]", "b = 2", "a.append(3)", "c = 4"],
         [(1, "print(a)\n1 / 0"), (1, "b = 2"), (3, "print(a)")]),
        (["a = map(str, [1, 2])", "print(list(a))"], [(1, "print(list(a), 1)")]),
    ],
)  # fmt: skip
def test_what_follows_gives_what_running_all_gives(reader, cells, changes):
    anew = list(cells)
    for k, source in changes:
        anew[k] = source
    wanted, space = [], {}
    for source in anew:
        with redirect_stdout(io.StringIO()) as printed:
            exec(source, space)
        wanted.append(printed.getvalue().strip())
    assert reader(cells, *changes) == wanted


@pytest.mark.parametrize("page", WALK)
def test_a_page_knows_graph_handles_and_solutions(page):
    found = live.live_cells(lesson(page))
    assert [cell for cell in found if cell.get("handles")] == found[:1]
    answers = [cell for cell in found if cell["kind"] == "answer"]
    assert len(answers) >= 3
    for cell in answers:
        assert "mine =" in cell["solution"] and "mine" in cell["solves"]["writes"]
    text = live.live_page(
        "".join(f'<div class="cell "><pre>{html.escape(c.source)}</pre></div>'
                for c in lesson(page).cells if c.cell_type == "code") + "</body>",
        lesson(page), page, [1, 2],
    )  # fmt: skip
    assert text.index("follow.js") < text.index("live.js")


@pytest.mark.browser
def test_all_that_follows_stays_marked_until_it_ran(reader):
    reader(["a = 1", "b = a", "print(b)"])
    reader.tab.get_by_role("textbox").first.fill("a = 2")
    said = reader.tab.locator(".live-mark")
    behind = "May show what came before your change."
    assert said.all_inner_texts() == ["Changed, and not run since.", behind, behind]
    for k, left in enumerate([["", behind, behind], ["", "", behind], [""] * 3], 1):
        reader.tab.get_by_role("button", name=f"Run: cell {k}", exact=True).click()
        reader.tab.locator("html[data-live=idle]").wait_for()
        assert said.all_inner_texts() == left
