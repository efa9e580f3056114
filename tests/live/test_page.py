"""*Run this page*: lessons with Python in a browser, changed, judged, stopped, kept."""

import hashlib
import json
import time

import chromium
import live_pages
import numpy as np
import pytest
from axe import violations
from book_pages import WALK
from live.cells import live_cells
from live_pages import IDLE, code
from open_cells import lesson

from ddlib.setups import STATE_FEEDBACK

FOCUSED = "(el) => el === document.activeElement"


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """All lessons with cells alone, live."""
    with live_pages.served(tmp_path_factory.mktemp("site"), WALK) as address:
        yield address


@pytest.mark.browser
@pytest.mark.slow
def test_a_reader_changes_a_cell_and_goes_back(browser, site):
    tab, asked = browser.new_page(viewport={"width": 390, "height": 800}), []
    tab.on("dialog", lambda dialog: dialog.accept())
    tab.context.on("request", lambda request: asked.append(request.url))
    tab.goto(f"{site}/book/feedback.html")
    assert len(asked) < 6  # the page, its script and style; no Python before the click
    tab.get_by_role("button", name="Run this page").click()
    tab.get_by_role("button", name="Stop").click()
    field = tab.get_by_role("textbox").first
    built = code(field)
    told = "import hashlib\nprint(hashlib.sha256(r.q.tobytes()).hexdigest(), abs(r.tau).sum())"
    field.fill(f"from ddlib.setups import STATE_FEEDBACK\nr = STATE_FEEDBACK.record()\n{told}")
    field.press("Control+Enter")
    tab.locator(IDLE).wait_for(timeout=900_000)
    bits, size = tab.locator(".live-output").first.inner_text().split()
    record = STATE_FEEDBACK.record()
    assert bits == hashlib.sha256(record.q.tobytes()).hexdigest()  # equal to the last bit
    assert float(size) == pytest.approx(np.abs(record.tau).sum(), rel=1e-12)
    assert not violations(tab)
    tab.reload()
    tab.get_by_role("button", name="Run this page").click()
    assert "STATE_FEEDBACK" in code(field)  # it was kept
    tab.get_by_role("button", name="Reset").click()
    assert code(field) == built
    field.press("Tab")  # passed through, a field lets go
    assert tab.get_by_role("button", name="Run: cell 1", exact=True).evaluate(FOCUSED)
    assert all(url.startswith((f"{site}/", f"blob:{site}/")) for url in asked)


@pytest.mark.browser
@pytest.mark.slow
@pytest.mark.parametrize("page", WALK)
def test_open_cells_run_through_in_the_page(browser, site, page):
    live_pages.runs_through(browser.new_page(), site, page)


def marked(tab) -> list[str]:
    return [said for said in tab.locator(".live-mark").all_inner_texts() if said]


KEEP = """() => {
  const make = URL.createObjectURL;
  URL.createObjectURL = (content) => make.call(URL, (window.handed = content));
}"""


def save(tab, target):
    """By the button. Of files that a page has made, Firefox's driver tells nothing."""
    button = tab.get_by_role("button", name="Save as a file")
    if chromium.FIREFOX:
        tab.evaluate(KEEP)
        button.click()
        target.write_text(tab.evaluate("() => window.handed.text()"), encoding="utf-8")
        return
    with tab.expect_download() as saved:
        button.click()
    saved.value.save_as(target)


@pytest.mark.browser
@pytest.mark.slow
def test_work_is_judged_and_kept_on_the_device_alone(browser, site, tmp_path):
    """A change, an exercise, the solution beside it; a file; all erased and there again."""
    tab, wrong = browser.new_page(accept_downloads=True), []
    tab.on("dialog", lambda dialog: dialog.accept())
    tab.on("pageerror", lambda error: wrong.append(str(error)))
    page, cells = "book/feedback", live_cells(lesson("book/feedback"))
    answer = next(k for k, cell in enumerate(cells) if cell["kind"] == "answer")
    tab.goto(f"{site}/{page}.html")
    tab.get_by_role("button", name="Run this page").click()
    tab.locator(IDLE).wait_for(timeout=900_000)
    name = f"cell {answer + 1}"
    mine = tab.get_by_role("textbox", name=f"Code of {name}", exact=True)
    summary = tab.locator(".live-own summary")
    assert summary.inner_text().startswith("Solved: 0 of ") and not marked(tab)
    asked = tab.locator(".live-output .exercise-answer").all_inner_texts()
    assert asked and all(said.startswith("Put your answer in place") for said in asked)

    def idle():
        tab.wait_for_timeout(200)
        tab.locator(IDLE).wait_for(timeout=300_000)

    def run(field):
        field.press("Control+Enter")
        idle()

    tab.get_by_role("button", name="Run the solution").first.click()
    tab.locator(".live-beside >> text=Right").wait_for(timeout=300_000)
    assert "mine = ..." in code(mine)  # the reader's own is as it was
    mine.fill("mine = F / (1.5 * period)")
    tab.get_by_role("button", name="Check the answer").first.click()  # which runs it, too
    idle()
    yours = tab.locator(".live-beside .live-output").first
    assert yours.inner_text().startswith("Right") and "Solved: 1 of " in summary.inner_text()
    tab.get_by_role("textbox").first.evaluate("(e) => e.scrollIntoView({ block: 'center' })")
    tab.get_by_role("combobox").select_option("load, N m")  # of three cells, one differs
    tab.get_by_role("slider").press("ArrowRight")
    tab.get_by_role("button", name="Run what follows").click()
    idle()
    assert not marked(tab)
    summary.click()
    save(tab, tmp_path / "work.json")
    kept = json.loads((tmp_path / "work.json").read_text(encoding="utf-8"))["pages"]
    assert kept["feedback.html"]["solved"] == [cells[answer]["id"]]
    both = tab.locator(".live-output .two-forms")
    assert not both.count()  # a wide page needs none of the narrow forms
    tab.set_viewport_size({"width": 390, "height": 800})
    both.first.wait_for(state="attached", timeout=60_000)
    tab.set_viewport_size({"width": 1280, "height": 800})
    assert not violations(tab)
    tab.reload()
    assert "Solved: 1 of " in summary.inner_text()
    tab.get_by_role("button", name="Run this page").click()
    assert code(mine) == "mine = F / (1.5 * period)"
    summary.click()
    tab.get_by_role("button", name="Erase").click()
    assert "Solved: 0 of " in summary.inner_text() and "mine = ..." in code(mine)
    assert not tab.evaluate("Object.keys(localStorage).filter((key) => key.startsWith('live'))")
    with tab.expect_file_chooser() as asked:
        tab.get_by_role("button", name="Open a file").click()
    asked.value.set_files(tmp_path / "work.json")
    tab.locator(".live-own >> text=was taken").wait_for()
    assert "Solved: 1 of " in summary.inner_text()
    run(mine)  # in a Python that has run nothing: what it needs of the cells above runs first
    tab.locator(".live-output >> text=Right").wait_for(timeout=300_000)
    assert not wrong


BROKEN = {  # code, and what stands below the cell
    "x = (1,\ny = 2": "Python cannot read line 1",
    "x = bytes(2**31 - 100)\ny = x + x": "more memory than a page has",
    "import numpy as np\nx = np.ones(2**28)": "more memory than a page has",
    "import numpy as np\nx = [np.ones(2**26) for _ in range(9)]": "more memory than a page has",
    "1 / 0": "ZeroDivisionError",
}


LATEST = """window.Worker = class extends Worker {
  constructor(...given) {
    super(...given);
    window.latest = this;
  }
}"""
"""Run before a page's own scripts, which start Python in a worker."""


@pytest.mark.browser
@pytest.mark.slow
def test_a_page_goes_on_after_whatever_a_cell_does(browser, site):
    tab, wrong = browser.new_page(), []
    refuse = "Object.defineProperty(window, 'localStorage', {get() { throw new Error('blocked') }})"
    tab.add_init_script(refuse)
    tab.add_init_script(LATEST)
    tab.on("pageerror", lambda error: wrong.append(str(error)))
    tab.goto(f"{site}/book/feedback.html")
    tab.get_by_role("button", name="Run this page").click()
    tab.get_by_role("button", name="Stop").click()
    field, output = tab.get_by_role("textbox").first, tab.locator(".live-output").first

    def run(source, timeout=300_000):
        field.fill(source)
        field.press("Control+Enter")
        tab.wait_for_timeout(200)
        tab.locator(IDLE).wait_for(timeout=timeout)
        return output.inner_text()

    def endless():
        field.press("Control+Enter")
        tab.get_by_text("running cell 1").first.wait_for(timeout=300_000)
        tab.wait_for_timeout(500)

    for source, told in BROKEN.items():
        assert told in run(source), source
        assert code(field) == source and run("print(6 * 7)").strip() == "42"
    assert not run("").strip()
    run("import sys\nsys.mine = 42")
    field.fill("while True: pass")
    for _ in range(2):  # once, and once more before what was asked the first time is over
        endless()
        tab.get_by_role("button", name="Stop").click()
        tab.locator(".live-output >> text=Stopped").wait_for(timeout=60_000)
        assert tab.evaluate("() => window.crossOriginIsolated")
        assert run("import sys\nprint(sys.mine)").strip() == "42"  # in the same Python
        field.fill("while True: pass")
    endless()
    began = time.monotonic()
    tab.evaluate("() => window.latest.terminate()")
    tab.locator(".live-output >> text=Python broke off").wait_for()
    assert time.monotonic() - began < 5
    assert run("print(6 * 7)").strip() == "42"
    assert "keeps nothing for this site" in tab.locator(".live-kept").text_content()
    # Firefox has this to say itself, of a worker that is ended while it computes
    assert set(wrong) <= ({"undefined"} if chromium.FIREFOX else set())


@pytest.mark.browser
@pytest.mark.slow
def test_where_no_memory_is_shared_stop_ends_python_and_says_so(browser, site):
    """As in a private window; the script that isolates pages goes with all that is erased."""
    context = browser.new_context(service_workers="block")
    tab = context.new_page()
    tab.goto(f"{site}/book/feedback.html")
    tab.get_by_role("button", name="Run this page").click()
    tab.get_by_role("button", name="Stop").click()
    field = tab.get_by_role("textbox").first
    field.fill("while True: pass")
    field.press("Control+Enter")
    tab.get_by_text("running cell 1").first.wait_for(timeout=300_000)
    tab.get_by_role("button", name="Stop").click()
    tab.locator(".live-output >> text=Python was ended and starts afresh").wait_for(timeout=60_000)
    field.fill("print(6 * 7)")
    field.press("Control+Enter")
    tab.locator(".live-output >> text=42").wait_for(timeout=300_000)
    context.close()


@pytest.mark.browser
@pytest.mark.slow
@pytest.mark.chromium  # of the two drivers, one can cut a page off
def test_a_page_runs_on_without_a_network(browser, site):
    """A package that nobody foresaw is asked for again when there is one."""
    context = browser.new_context()
    tab = context.new_page()
    tab.goto(f"{site}/book/feedback.html")
    tab.get_by_role("button", name="Run this page").click()
    tab.locator(".live-output svg").first.wait_for(timeout=300_000)
    tab.wait_for_load_state("networkidle")
    context.set_offline(True)
    tab.locator(IDLE).wait_for(timeout=300_000)
    assert not tab.locator(".live-error, .live-warning, .live-note").all_inner_texts()
    field, output = tab.get_by_role("textbox").first, tab.locator(".live-output").first
    for source, told in (
        ("import pandas", "did not come whole (pandas"),
        ("print(6 * 7)", "42"),
        ("import pandas\nprint(pandas.NA)", "<NA>"),
    ):
        field.fill(source)
        field.press("Control+Enter")
        output.get_by_text(told).wait_for(timeout=60_000)
        context.set_offline(source != "print(6 * 7)")
    context.close()


@pytest.mark.browser
@pytest.mark.slow
@pytest.mark.chromium
def test_the_script_that_isolates_reaches_this_site_alone_and_can_be_removed(browser, site):
    tab = browser.new_page()
    tab.on("dialog", lambda dialog: dialog.accept())
    tab.goto(f"{site}/book/feedback.html")
    scopes = """() => navigator.serviceWorker.getRegistrations()
      .then((all) => all.map(({ scope }) => new URL(scope).pathname))"""
    assert tab.evaluate(scopes) == []  # it comes with the click
    tab.get_by_role("button", name="Run this page").click()
    tab.get_by_role("button", name="Stop").click()
    assert tab.evaluate(scopes) == ["/"] and tab.evaluate("() => window.crossOriginIsolated")
    tab.locator(".live-own summary").click()
    tab.get_by_role("button", name="Erase").click()
    tab.wait_for_timeout(500)
    assert tab.evaluate(scopes) == []
    tab.reload()
    assert not tab.evaluate("() => window.crossOriginIsolated")
