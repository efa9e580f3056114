"""*Run this page*: what a reader did is kept, whatever happens to tabs, files and the book."""

import json

import live_pages
import nbformat
import pytest
from live import packages
from live.handles import handles
from names import names

from ddlib.trajectories import KEPT_IN

pytestmark = pytest.mark.browser
ONE, TWO = {"id": "one", "source": "a = 1"}, {"id": "two", "source": "b = 2"}
ASKED = {"id": "three", "source": "mine = ...", "kind": "answer"}
STORED = "() => JSON.parse(localStorage.getItem('live:/book/a.html'))"
FULL = "() => { Storage.prototype.setItem = () => { throw new Error('full') } }"


@pytest.fixture
def reader(browser):
    """Opens pages of such cells, in tabs that share what is kept."""
    context = browser.new_context()
    context.add_init_script(live_pages.BESIDE.replace("await window.runs(message)", "[]"))

    def opened(*cells, name="a.html"):
        tab = context.new_page()
        tab.on("pageerror", lambda error: pytest.fail(str(error)))
        show(tab, *cells, name=name)
        return tab

    yield opened
    context.close()


def show(tab, *cells, name="a.html"):
    tab.goto(live_pages.set_up(tab, [*(cells or (ONE, TWO)), ASKED], name))
    tab.get_by_role("button", name="Run this page").click()


def field(tab, k):
    return tab.get_by_role("textbox").nth(k)


def changes(tab) -> dict:
    return {name: code for name, (_, code, *_) in (tab.evaluate(STORED) or {})["changes"].items()}


def saved(tab) -> dict:
    tab.locator(".live-own").evaluate("(el) => (el.open = true)")
    tab.evaluate(
        "() => { URL.createObjectURL = (content) => ((window.handed = content), 'about:blank#');"
        " HTMLAnchorElement.prototype.click = () => {} }"
    )
    tab.get_by_role("button", name="Save as a file").click()
    return json.loads(tab.evaluate("() => window.handed.text()"))


def take(tab, content, accept=True):
    """Open a file; what was asked, and what is told then."""
    asked = []

    def answer(dialog):
        asked.append(dialog.message)
        (dialog.accept if accept else dialog.dismiss)()

    tab.once("dialog", answer)
    text = content if isinstance(content, str) else json.dumps(content)
    file = {"name": "x.json", "mimeType": "application/json", "buffer": text.encode()}
    kept = tab.locator(".live-kept")
    kept.evaluate("(el) => (el.textContent = '')")
    tab.locator("input[type=file]").set_input_files(file)
    tab.wait_for_function("() => document.querySelector('.live-kept').textContent")
    tab.remove_listener("dialog", answer)
    return asked, kept.text_content()


def file(**pages) -> dict:
    return {"format": "direct-drive-work-1", "pages": {f"{n}.html": of for n, of in pages.items()}}


def test_two_tabs_of_a_page_keep_what_was_done_in_each(reader):
    tab, other = reader(), reader()
    field(tab, 0).fill("a = 10")
    field(other, 1).fill("b = 20")
    field(other, 1).fill("b = 30")
    assert changes(tab) == {"one": "a = 10", "two": "b = 30"}
    assert saved(tab)["pages"]["a.html"]["changes"]["two"] == ["b = 2", "b = 30"]
    field(tab, 0).fill("a = 1")  # as in the book
    assert changes(tab) == {"two": "b = 30"}


def test_a_handle_moves_a_number_of_the_code_by_round_steps(reader):
    cell = nbformat.v4.new_code_cell("kp = (750.0, 0.05)  # N m/rad\nn = 9")
    cell.metadata["dd"] = {"handles": {"kp": {}, "n": {}}}
    tab = reader({"id": "one", "source": cell.source, "handles": handles(cell)})
    choice, slider, told = tab.get_by_role("combobox"), tab.get_by_role("slider"), []
    for name, key in (("kp[0]", "ArrowRight"), ("kp[1]", "ArrowLeft"), ("n", "ArrowRight")):
        choice.select_option(name)
        assert slider.get_attribute("aria-label") == name
        slider.press(key)
        told.append(slider.get_attribute("aria-valuetext"))
    assert field(tab, 0).input_value() == "kp = (800.0, 0.048)  # N m/rad\nn = 10"
    assert told == ["800", "0.048", "10"]


def test_handles_of_what_is_in_view_are_offered_and_stay_in_view(reader):
    cell = nbformat.v4.new_code_cell("a = 1\nb = 2.0\nc = 2 * b\nd = 3")
    cell.metadata["dd"] = {"handles": {"a": {}, "b": {}, "d": {}}}
    sources = (cell.source, "a + 0", "c + a", "e = 5")
    given = [{"source": s, "names": names(s, set()).as_dict()} for s in sources]
    given = [{"id": f"c{k}", **each} for k, each in enumerate(given)]
    tab = reader({**given[0], "handles": handles(cell)}, *given[1:])
    tab.add_style_tag(path=packages.PAGE / "live.css")
    tab.add_style_tag(content="[data-live] { min-height: 800px }")
    tab.locator("main").evaluate("(e) => (e.className = 'bd-article')")
    choice = tab.get_by_role("combobox")
    offered = "(e) => [e.selectedOptions[0].text, ...[...e.options].map((o) => o.text)]"
    for place, wanted in ((2, "aab"), (1, "aa"), (3, "aabd"), (2, "aab")):
        tab.locator(f"[data-live=c{place}]").evaluate("(e) => e.scrollIntoView()")
        tab.wait_for_timeout(200)
        assert "".join(choice.evaluate(offered)) == wanted
    assert tab.get_by_role("slider").bounding_box()["y"] < 100


def test_code_that_the_book_has_changed_since_is_kept(reader):
    tab = reader()
    field(tab, 0).fill("a = 10")
    field(tab, 1).fill("b = 20")
    show(tab, {"id": "one", "source": "a = 1.0"})  # and the second is gone
    assert "changed the code of 2 cells" in tab.locator(".live-kept").text_content()
    field(tab, 0).fill("a = 11.0")
    kept = {"one, earlier": "a = 10", "two": "b = 20", "one": "a = 11.0"}
    assert changes(tab) == kept
    assert saved(tab)["pages"]["a.html"]["changes"].keys() == kept.keys()
    show(tab)
    assert field(tab, 1).input_value() == "b = 20"


@pytest.mark.parametrize("accept", [True, False])
def test_a_file_is_taken_if_the_reader_says_so(reader, accept):
    tab = reader()
    field(tab, 0).fill("a = 10")
    field(tab, 1).fill("b = 20")
    given = {"changes": {"one": ["a = 1", "a = 7"]}, "solved": ["three"]}
    asked, told = take(tab, file(a=given, b=given, c=given), accept)  # the book has no such page
    assert len(asked) == 1 and "code for 2 cells on 2 pages" in asked[0]
    assert "your own code of 1 cell?" in asked[0]
    assert ("on 2 pages was taken" if accept else "Nothing was changed") in told
    assert changes(tab) == {"one": "a = 7" if accept else "a = 10", "two": "b = 20"}
    assert field(tab, 0).input_value() == changes(tab)["one"]
    assert f"Solved: {int(accept)} of 1" in tab.locator(".live-own summary").inner_text()
    kept = sorted(tab.evaluate("() => Object.keys(localStorage)"))
    assert kept == ["live:/book/a.html", *(["live:/book/b.html"] if accept else [])]
    show(tab, name="b.html")
    assert field(tab, 0).input_value() == ("a = 7" if accept else "a = 1")


@pytest.mark.parametrize(
    "content",
    [
        '{"format": "direct-drive-work-1", "pag',
        file() | {"format": "direct-drive-work-2"},
        file(a={"changes": {"one": ["a = 1", "a = 7" + " " * 1_000_000]}}),  # it fills the storage
    ],
)
def test_a_file_that_cannot_be_read_changes_nothing(reader, content):
    tab = reader()
    field(tab, 0).fill("a = 10")
    asked, told = take(tab, content)
    assert not asked and "Nothing was changed" in told and changes(tab) == {"one": "a = 10"}


def test_where_nothing_more_is_kept_it_is_told_and_a_file_has_all(reader):
    tab = reader()
    field(tab, 0).fill("a = 10")
    tab.evaluate(FULL)
    field(tab, 1).fill("b = 20")
    assert "keeps nothing" in tab.locator(".live-kept").text_content()
    beside = tab.locator(".live-status")  # of the button
    assert "until you leave the page; “Save as a file” keeps" in beside.text_content()
    field(tab, 0).fill("a = 11")
    found = saved(tab)["pages"]["a.html"]["changes"]
    assert {name: code for name, (_, code) in found.items()} == {"one": "a = 11", "two": "b = 20"}
    assert "keeps nothing" in take(tab, file(b={"changes": {"one": ["a = 1", "a = 7"]}}))[1]


def test_where_storage_is_blocked_it_is_said_beside_the_button_before_it_is_pressed(browser):
    tab = browser.new_page()
    refuse = "Object.defineProperty(window, 'localStorage', {get() { throw new Error('blocked') }})"
    tab.add_init_script(refuse)
    tab.goto(live_pages.set_up(tab, [ONE]))
    assert tab.locator(".live-status").text_content() == "your changes last until you leave"


def test_another_book_of_the_server_is_left_alone(reader):
    tab = reader()
    tab.evaluate("() => localStorage.setItem('live:/other/a.html', 'theirs')")
    tab.evaluate("() => localStorage.setItem('quiz:/', '[\"quiz-1\"]')")
    tab.evaluate("() => localStorage.setItem('quiz-twice:/', '{}')")
    tab.get_by_role("switch").check()
    field(tab, 0).fill("a = 10")
    assert saved(tab)["pages"].keys() == {"a.html"}
    tab.once("dialog", lambda dialog: dialog.accept())
    tab.get_by_role("button", name="Erase").click()
    assert tab.evaluate("() => Object.keys(localStorage)") == ["live:/other/a.html"]


EXTENTS = "[[10.0, 20.0], [30.0, 5.0], [44.0, 44.0], [0.0, 12.0]]\n"
PICKING = """window.Worker = class {
  async postMessage(message) {
    if (message.start) window.begun = message.picked;
    const of = { run: message.run, done: true, ok: true, seconds: 0 };
    const all = message.start ? [{ ready: true }] : message.run ? [{ picked: EXTENTS }, of] : [];
    for (const data of all) this.onmessage({ data });
  }
  terminate() {}
}"""


def test_extents_that_a_lesson_kept_come_back_in_the_next(browser):
    context = browser.new_context()
    context.add_init_script(PICKING.replace("EXTENTS", json.dumps(EXTENTS)))
    tab = context.new_page()
    show(tab, name="a.html")
    assert tab.evaluate("() => window.begun") == ""
    show(tab, name="b.html")
    assert tab.evaluate("() => window.begun") == EXTENTS
    content = saved(tab)
    assert content["extents"] == EXTENTS
    (asked,) = take(tab, content | {"extents": "[]"}, accept=False)[0]
    assert "the motions that you picked" in asked and saved(tab)["extents"] == EXTENTS
    tab.once("dialog", lambda dialog: dialog.accept())
    tab.get_by_role("button", name="Erase").click()
    assert not saved(tab)["extents"]
    context.close()


def test_worker_and_notebook_keep_them_in_the_same_file():
    worker = (packages.PAGE / "worker.mjs").read_text(encoding="utf-8")
    assert f'"/book/{KEPT_IN}"' in worker
