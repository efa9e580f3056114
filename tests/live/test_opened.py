"""*Run this page*: somebody else's work file is a program; an attack of each kind stands here."""

import json

import live_pages
import pytest
from test_kept import file, take

pytestmark = pytest.mark.browser
CELLS = [
    {"id": "one", "source": "a = 1", "names": {"writes": ["a"]}},
    {"id": "two", "source": "b = a", "names": {"reads": ["a"], "writes": ["b"]}},
    {"id": "three", "source": "b", "names": {"reads": ["b"]}},
]
EVIL = "open('/etc/passwd')"
OPENED = file(a={"changes": {"one": ["a = 1", EVIL]}})
READS = "parent.stolen = window.stolen = Object.keys(localStorage)"
SHOWN = {  # what a cell could show, in whose HTML a script lies
    "html": f'<b>seen</b><img src="data:," onerror="{READS}"><script>{READS}</script>',
    "figure": f'<b>seen</b><svg onload="{READS}"><script>{READS}</script></svg>',
    "markdown": f"seen $\\href{{javascript:{READS}}}{{x}}$",
    "latex": f"seen $\\href{{javascript:{READS}}}{{x}}$",
    "widget": "1",
}


@pytest.fixture
def page(browser):
    """A page with a file opened in it that has other code for its first cell; what then runs."""
    context = browser.new_context()
    tab, ran, shows = context.new_page(), [], []

    def runs(message):
        name = message.get("run")
        if not name:
            return []
        ran.append((name, message["source"]))
        shown = [{"run": name, "kind": kind, "text": text} for kind, text in shows]
        told = {"prints": {}, "altered": [], "writes": []}
        names = {"run": name, "kind": "names", "text": json.dumps(told)}
        return [*shown, names, {"run": name, "done": True, "ok": True, "seconds": 0}]

    tab.expose_function("runs", runs)
    context.add_init_script(live_pages.BESIDE)
    tab.on("pageerror", lambda error: pytest.fail(str(error)))
    tab.ran, tab.shows = ran, shows
    tab.goto(live_pages.set_up(tab, [*CELLS, {"id": "x", "source": "mine", "kind": "answer"}]))
    tab.get_by_role("button", name="Run this page").click()
    tab.locator(live_pages.IDLE).wait_for()
    yield tab
    context.close()


def settle(tab):
    tab.wait_for_timeout(100)
    tab.locator(live_pages.IDLE).wait_for()


def test_it_runs_by_its_own_button_alone(page):
    """By no other, not where a cell below needs it, not as it reacts, and not another day."""
    (asked,), _ = take(page, OPENED)
    assert "code for 1 cell on 1 page" in asked and "read it first" in asked
    assert page.get_by_role("textbox").first.input_value() == EVIL  # it is shown
    assert "From a file" in page.locator(".live-mark").first.inner_text()
    page.get_by_role("switch").check()
    page.get_by_role("textbox").nth(2).fill("b + 1")
    page.wait_for_timeout(700)  # it reacts
    for name in ("Run all", "Run to here: all cells down to cell 3", "Run: cell 2"):
        page.get_by_role("button", name=name).click()
        settle(page)
    page.get_by_role("textbox").first.press("End")
    page.keyboard.type("  # and more")  # who edits it has not accepted it
    page.wait_for_timeout(700)
    page.reload()
    page.get_by_role("button", name="Run this page").click()
    settle(page)
    assert len(page.ran) > 10 and EVIL not in str(page.ran)
    page.get_by_role("button", name="Run: cell 1", exact=True).click()
    settle(page)
    assert EVIL in str(page.ran)


@pytest.mark.parametrize("kind", SHOWN)
@pytest.mark.parametrize("cell", [1, 3])
def test_nothing_that_it_shows_runs_in_the_page(page, kind, cell):
    """Of its own cell, and of one of the book that runs after it in the same Python."""
    take(page, OPENED)
    page.get_by_role("button", name="Run: cell 1", exact=True).click()
    settle(page)
    page.shows[:] = [(kind, SHOWN[kind])]
    page.get_by_role("button", name=f"Run: cell {cell}", exact=True).click()
    settle(page)
    page.wait_for_timeout(300)
    output = page.locator(".live-output").nth(cell - 1)
    frame = output.locator("iframe")
    told = frame.content_frame.locator("body") if frame.count() else output
    assert ("script would run" if kind == "widget" else "seen") in told.inner_text()
    assert not output.locator("img, svg, script, a[href]:not([download])").count()
    assert page.evaluate("() => window.stolen") is None


def test_the_frame_is_needed(page):
    """Without it, such HTML of the reader's own does what it says."""
    page.shows[:] = [("html", SHOWN["html"])]
    page.get_by_role("button", name="Run: cell 1", exact=True).click()
    settle(page)
    page.wait_for_function("() => window.stolen")


def test_a_worker_that_forges_messages_reaches_no_script(page):
    take(page, OPENED)
    forged = [
        {"form": "cell 1", "number": 0, "text": SHOWN["html"]},
        {"widget": {"number": 1, "made": {"esm": READS, "css": ""}}, "buffers": []},
        {"picked": "x" * 100_000},
    ]
    page.evaluate("(all) => (window.forged = all)", forged)
    page.evaluate(
        "() => { const runs = window.runs; window.runs = async (message) => "
        "[...(message.run ? window.forged : []), ...(await runs(message))] }"
    )
    page.get_by_role("button", name="Run: cell 1", exact=True).click()
    settle(page)
    page.wait_for_timeout(300)
    assert page.evaluate("() => window.stolen") is None
    assert "xxx" not in page.evaluate("() => JSON.stringify(localStorage)")


@pytest.mark.parametrize(
    "given",
    [
        {"changes": {"one": ["a = 1", "a = 1 \u202e# nothing"]}},  # shown otherwise than it runs
        {"changes": {"one": ["a = 1", {"toString": 1}], "two": "ab", "x": ["mine"]}},
        json.loads('{"changes": {"__proto__": {"from": "accepted"}}, "solved": [{"x": 1}]}'),
        5,
    ],
)
def test_what_is_no_code_is_left_out(page, given):
    take(page, file(a=given))
    assert page.get_by_role("textbox").first.input_value() == "a = 1"
    assert page.evaluate("() => [{}.from, localStorage.length <= 1]") == [None, True]
    page.get_by_role("button", name="Run all").click()
    settle(page)
    assert page.ran[-4:-1] == [(f"cell {k}", c["source"]) for k, c in enumerate(CELLS, 1)]
