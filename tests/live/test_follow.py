"""*Run this page*: what follows from a change, by the code, and against what running shows."""

import io
import json
import sys
from contextlib import chdir, redirect_stdout

import kernel
import live_pages
import matplotlib
import pytest
from book_pages import LESSONS, ROOT
from chapter_rules import CHANGE_THIS, tags
from live.cells import live_cells
from live.packages import PAGE
from names import names
from open_cells import SHORT, lesson

SCRIPT = (PAGE / "follow.js").read_text(encoding="utf-8")
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


def with_names(*sources):
    return [{"names": names(source, {"figures"}).as_dict()} for source in sources]


@pytest.mark.browser
@pytest.mark.parametrize(
    ("cells", "places", "wanted"),
    [
        (["a = 1", "b = a", "c = 1", "d = b"], [0], [1, 3]),
        (["a = 1", "a = 2", "b = a"], [0], []),
        (["a = 1", "if b:\n    a = 2", "c = a"], [0], [2]),
        (["a = 1", "del a", "a"], [1], [2]),
        (["a = 1", "a += 1", "b = a"], [0], [1, 2]),
        (["a = []", "a.append(1)", "b = a", "c = 1"], [0], [1, 2]),
        (["a = []", "a.append(1)", "b = a"], [1], [2]),
        (["a = []", "fit(a)", "b = a"], [1], [2]),
        (["a = []", "print(a)", "figures.curves(a)", "b = a"], [1, 2], []),
        (["a = []", "b = [x := x + k for k in a]", "c = x"], [0], [1, 2]),
        (["k = 1", "def f(x):\n    return x * k", "k = 2", "b = f(1)"], [2], [3]),
        (["k = 1", "def f():\n    return k", "g = [f]", "k = 2", "b = g[0]()"], [3], [4]),
        (["a = []", "def f():\n    a.append(1)", "x = f()", "b = a"], [2], [3]),
        (["a = 1", "import b.c, a.d", "x = a, b"], [0], []),
        (["a = 1", "x = (", "b = a"], [0, 1], [2]),
    ],
)
def test_cells_that_follow(script, cells, places, wanted):
    assert script.evaluate(AFTER, [with_names(*cells), places]) == wanted


@pytest.mark.browser
def test_an_object_changed_in_place_is_made_again_first(script):
    cells = with_names("a = []\nb = 1", "a.append(b)", "c = a", "d = b")
    assert script.evaluate(SPOILED, [cells, 1, [1, 2, 3, 4]]) == {"maker": 0, "name": "a"}
    assert script.evaluate(SPOILED, [cells, 1, [5, 2, 3, 4]]) is None
    assert script.evaluate(SPOILED, [cells, 2, [1, 2, 3, 4]]) is None  # changed above, as it should
    assert script.evaluate(SPOILED, [cells, 3, [1, 2, 3, 4]]) is None
    cells = with_names("a = [1]", "a = [a, 2]", "a[0].append(3)")  # under the name of what holds it
    assert script.evaluate(SPOILED, [cells, 1, [1, 2, 3]]) == {"maker": 0, "name": "a"}


@pytest.mark.browser
def test_a_figure_to_handle_stays_as_the_reader_left_it(script):
    cells = with_names("a = Picker()", "b = a.recording", "a.extents = 1, 2")
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
        ("a = '# 1'", "a = '# 2'", None),
        ("a = 1\nif a:\n    b = 1", "a = 2\nif a:\n    b = 1", None),
    ],
)
def test_settings_that_differ(script, before, now, wanted):
    assert script.evaluate(RENAMED, [before, now]) == wanted


def opened(page: str) -> list[dict]:
    return [cell for cell in live_cells(lesson(page)) if cell["kind"] == "open"]


@pytest.mark.browser
@pytest.mark.slow
@pytest.mark.parametrize("page", LESSONS)
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
            {"id": f"c{k}", "source": source, **with_names(source)[0]}
            for k, source in enumerate(cells)
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
        (["a = 1", "b = 2", "print(a)"], [(1, "a = 3"), (1, "b = 2")]),
        (["a = [1]", "b = a", "b.append(3)", "print(a, b)"], [(2, "b.append(4)")]),
        (["a = [1]", "b = 2", "a.append(3)", "print(a)"], [(1, "b = 2\nprint(a)")]),
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


@pytest.mark.browser
def test_all_that_follows_stays_marked_until_it_ran(reader):
    reader(["a = 1", "b = a", "print(b)"])
    reader.tab.get_by_role("link", name="change a number").click()
    reader.tab.get_by_role("textbox").first.fill("a = 2")
    said = reader.tab.locator(".live-mark")
    behind = "May show what came before your change."
    assert said.all_inner_texts() == ["Changed, and not run since.", behind, behind]
    for k, left in enumerate([["", behind, behind], ["", "", behind], [""] * 3], 1):
        reader.tab.get_by_role("button", name=f"Run: cell {k}", exact=True).click()
        reader.tab.locator("html[data-live=idle]").wait_for()
        assert said.all_inner_texts() == left
