"""*Run this page*: the editor of a cell, with Python of this machine in the worker's place."""

import json

import kernel
import live_pages
import nbformat
import pytest
from axe import violations
from book_pages import WALK
from live.cells import live_cells
from live.handles import handles
from live.packages import Refused, editor
from live_pages import code
from names import names
from open_cells import lesson
from sphinx.highlighting import PygmentsBridge
from test_kept import take
from test_opened import EVIL, OPENED

pytestmark = pytest.mark.browser
COLOURS = """(el) => {
  const walker = document.createTreeWalker(el, NodeFilter.SHOW_TEXT);
  const all = [];
  for (let at; (at = walker.nextNode()); ) {
    const { color } = getComputedStyle(at.parentElement);
    for (const letter of at.textContent) if (letter.trim()) all.push([letter, color]);
  }
  return all;
}"""
"""Each letter with its colour."""


@pytest.fixture(scope="session")
def script():
    """The bundle, as `make live` has it."""
    try:
        return editor(live_pages.KEPT).read_text("utf-8")
    except Refused as error:
        pytest.skip(str(error))


@pytest.fixture
def reader(browser, run, script):
    """Opens a page of such cells with their editor: the tab, and the fields of their code."""
    context = browser.new_context()
    tab = context.new_page()

    def runs(message):
        if "path" in message:
            found = kernel.parts(message["path"], message["imported"], message["above"])
            return [{"parts": json.loads(found)}]
        shown, about = run(message["source"], message["run"], message["above"], **message["how"])
        told = [*shown, ("names", json.dumps(about))]
        ended = {"run": message["run"], "done": True, "ok": True, "seconds": 0}
        return [*({"run": message["run"], "kind": k, "text": t} for k, t in told), ended]

    tab.expose_function("runs", runs)
    tab.on("pageerror", lambda error: pytest.fail(str(error)))

    def opened(*cells, style="", worker=live_pages.BESIDE):
        tab.add_init_script(worker)
        given = [{**cell, "names": names(cell["source"]).as_dict()} for cell in cells]
        tab.goto(live_pages.set_up(tab, given, editor=script, style=style))
        tab.get_by_role("button", name="Run this page").click()
        tab.locator(".live-code").last.wait_for()
        return tab, tab.get_by_role("textbox").all()

    yield opened
    context.close()


def test_at_the_click_code_keeps_its_colours(reader):
    book = PygmentsBridge("html", "a11y-high-contrast-light")  # as it draws pages
    every = [cell for page in WALK[:3] for cell in live_cells(lesson(page))]
    sources = [cell["source"] for cell in every if cell["kind"] != "check"]
    cells = [{"id": f"c{k}", "source": source} for k, source in enumerate(sources)]
    silent = live_pages.BESIDE.replace("await window.runs(message)", "[]")
    tab, _ = reader(*cells, style=book.get_stylesheet(), worker=silent)
    show = f"""(all) => all.map((html) => {{
      const el = document.body.appendChild(document.createElement("div"));
      el.innerHTML = html;
      return ({COLOURS})(el);
    }})"""
    still = tab.evaluate(show, [book.highlight_block(source, "ipython3") for source in sources])
    for _ in range(100):  # a busy machine reads the end of long code a little later
        now = tab.evaluate(f"() => [...document.querySelectorAll('.cm-content')].map({COLOURS})")
        if now == still:
            break
        tab.wait_for_timeout(200)
    assert now == still and len({colour for cell in still for _, colour in cell}) == 6


ARM = """class Arm:
    def __init__(self):
        self.mass, self.length = 1, 2
    @property
    def slow(self):
        raise RuntimeError("it was computed")
arm = Arm()"""


def test_a_reader_types(reader):
    tab, (above, field) = reader({"id": "one", "source": ARM}, {"id": "two", "source": "a = 1"})
    tab.locator(live_pages.IDLE).wait_for()
    offered = tab.get_by_role("option")

    def typed(text, *options):
        tab.keyboard.type(text)
        if options:
            offered.last.wait_for()
            assert offered.all_inner_texts() == list(options)
            assert not violations(tab)
            tab.wait_for_timeout(200)  # what has just come is not taken: it may be by mistake
            tab.keyboard.press("Tab")

    search = "(event) => event.key === '/' && event.preventDefault()"  # Sphinx's key for it
    tab.evaluate(f"() => document.addEventListener('keydown', {search})")
    focused = "() => document.activeElement.getAttribute('aria-label')"
    above.focus()
    for label in ("Run: cell 1", "Run to here: all cells down to cell 1", "Code of cell 2"):
        tab.keyboard.press("Tab")  # passed through, a field lets go
        assert tab.evaluate(focused) == label
    tab.keyboard.press("Control+End")
    typed("\nfor k in range(6/2")
    tab.keyboard.press("End")  # the bracket was closed
    typed(":\nif k:\narm", "armcell 1", "Armcell 1")
    typed(".")
    typed("ma", "mass")
    typed("\npass\n")
    tab.keyboard.press("Shift+Tab")
    typed("arm.slow.\n")
    wanted = "a = 1\nfor k in range(6/2):\n    if k:\n        arm.mass\n        pass\n    arm.slow."
    assert code(field).rstrip() == wanted
    tab.keyboard.press("Escape")
    tab.keyboard.press("Tab")
    assert tab.evaluate(focused) == "Run: cell 2"
    field.fill("print(arm.mass + 41)")
    field.press("Shift+Enter")
    tab.locator(".live-output >> text=42").wait_for()
    field.fill("from ddlib.metrics import r")
    typed("m", "rmss")
    assert code(field) == "from ddlib.metrics import rmss"


def test_a_handle_writes_into_the_editor_and_can_be_undone(reader):
    cell = nbformat.v4.new_code_cell("kp = 750.0  # N m/rad\nn = 9")
    cell.metadata["dd"] = {"handles": {"kp": {}, "n": {}}}
    tab, (field,) = reader({"id": "one", "source": cell.source, "handles": handles(cell)})
    slider = tab.locator(".live-handles input").first
    slider.press("ArrowRight")
    assert code(field) == "kp = 800.0  # N m/rad\nn = 9"
    assert "Changed" in tab.locator(".live-mark").inner_text()
    field.press("Control+z")
    assert code(field) == cell.source and slider.input_value() == "750"
    assert not tab.locator(".live-mark").inner_text()


def test_nobody_undoes_a_reset_into_code_of_a_file(reader):
    """It would have no mark then, and would run with the rest."""
    asked = {"id": "two", "source": "mine = ...", "kind": "answer"}
    tab, (field, _) = reader({"id": "one", "source": "a = 1"}, asked)
    take(tab, OPENED)
    assert code(field) == EVIL
    tab.on("dialog", lambda dialog: dialog.accept())
    tab.get_by_role("button", name="Reset").click()
    field.press("Control+z")
    assert code(field) == "a = 1"
