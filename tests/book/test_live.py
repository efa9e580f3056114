"""*Run this page*: what is taken by which hash, which cells run, and how they do in a browser."""

import asyncio
import hashlib
import html
import json
import re
import subprocess
import sys
from dataclasses import replace

import chromium
import firefox
import live_pages
import numpy as np
import pytest
from axe import violations
from book_pages import ROOT, WALK
from chapter_rules import is_check, is_starter, visible
from live_pages import IDLE, plain
from open_cells import lesson

from ddlib.control import pd
from ddlib.dynamics import CMU_DD_ARM_II
from ddlib.effects import (
    CoulombFriction,
    Effects,
    FlexibleJoint,
    StickSlipFriction,
    ViscousFriction,
)
from ddlib.learning import Descent, TrainingSet, Weights
from ddlib.setups import STATE_FEEDBACK
from ddlib.simulation import plant, record

sys.path.insert(0, str(ROOT / "book" / "_ext"))
sys.path.insert(0, str(ROOT / "book" / "_ext" / "live_page"))
import absent
import kernel
import live

ONE, OTHER = (20.0, 30.0), (45.0, 10.0)  # extents of motions, degrees
FOCUSED = "(el) => el === document.activeElement"


def entry(name: str) -> dict:
    return {"file_name": name, "sha256": hashlib.sha256(name.encode()).hexdigest(), "depends": []}


def test_only_what_the_lock_names_is_taken_and_nothing_is_left_half_done(tmp_path):
    site, kept, out = (tmp_path / name for name in ("html", "kept", "live"))
    for folder in (site, kept, out):
        folder.mkdir()
        (folder / "index.html").write_text(f"in {folder.name}")
    for name in (*live.CORE, live.LOCK):
        (kept / name).write_text(json.dumps({"packages": {n: entry(n) for n in live.WHEELS}}))
    before = sorted(kept.iterdir())
    (tmp_path / "numpy").write_text("numpy")
    (tmp_path / "scipy").write_text("tampered")
    with pytest.raises(live.Refused, match=r"(?s)matplotlib is missing.* scipy has SHA-256"):
        live.write(ROOT, site, str(tmp_path), kept, out)
    assert sorted(kept.iterdir()) == before  # not even the right one
    assert [path.read_text() for path in tmp_path.glob("live*/*")] == ["in live"]
    live.take([entry("numpy")], str(tmp_path), kept)
    (kept / "numpy").write_text("changed since")
    with pytest.raises(live.Refused, match=r"needed.\n +numpy is missing"):
        live.take([entry("numpy")], str(out), kept)


def test_without_a_mirror_wheels_come_from_pyodides_address_and_stay(tmp_path, monkeypatch, capsys):
    """With a server of this machine in its place."""
    served, kept = tmp_path / "served", tmp_path / "kept"
    served.mkdir()
    for name in ("numpy", "scipy"):
        (served / name).write_text(name)
    with chromium.serve(served) as address:
        monkeypatch.setattr(live, "PUBLIC", address)
        live.take([entry("numpy"), entry("scipy")], "", kept)
        assert capsys.readouterr().out.rstrip().endswith(f"Pyodide {live.VERSION} from {address}")
        assert {path.name for path in kept.iterdir()} == {"numpy", "scipy"}
        (served / "sympy").write_text("tampered")
        with pytest.raises(live.Refused, match=r"sympy has SHA-256 .* the lock wants"):
            live.take([entry("sympy")], "", kept)
        with pytest.raises(live.Refused, match="pandas is missing"):
            live.take([entry("pandas")], "", kept)
    live.take([entry("numpy"), entry("scipy")], "", kept)  # the server is gone, and not asked
    assert "wheels" not in capsys.readouterr().out
    with pytest.raises(live.Refused) as refusal:
        live.take([entry("numpy"), entry("sympy")], "", kept)
    said = str(refusal.value)
    assert (
        said.startswith("no sympy of Pyodide") and "MIRROR=" in said and "cannot be reached" in said
    )
    assert len(said.splitlines()) == 1 and len(said) <= 300


def test_without_npms_registry_one_sentence_says_what_is_missing(tmp_path, monkeypatch):
    said = "npm error code EAI_AGAIN\nnpm error errno EAI_AGAIN\nnpm error request to x failed\n"
    ended = subprocess.CompletedProcess([], 1, "", said)
    monkeypatch.setattr(live.shutil, "which", lambda name: name)
    monkeypatch.setattr(live.subprocess, "run", lambda *args, **how: ended)
    with pytest.raises(live.Refused) as refusal:
        live.core(tmp_path / "kept")
    told = str(refusal.value)
    assert len(told.splitlines()) == 1 and "ended with “request to x failed”" in told
    assert told.startswith(f"no core of Pyodide {live.VERSION}") and live.PUBLIC in told


def test_pyodides_address_has_its_version():
    assert re.fullmatch(rf"https://\S+/v{re.escape(live.VERSION)}/full", live.PUBLIC)


@pytest.mark.parametrize("page", WALK)
def test_open_cells_and_checks_become_live(page):
    notebook = lesson(page)
    shown, found = visible(notebook), live.live_cells(notebook)
    wanted = [cell for cell in notebook.cells if cell in shown or is_check(cell)]
    told = [(cell.id, cell.source) for cell in wanted]
    assert [c["kind"] == "answer" for c in found] == [is_starter(c) for c in wanted]
    assert not any(c["needs"] for c in found)  # all of a lesson runs in the page
    marked = live.live_page(plain(page), notebook, page, [1, 2])
    pairs = re.findall(r'data-live="([^"]+)".*?<pre>(.*?)</pre>', marked, re.S)
    assert [(name, html.unescape(code)) for name, code in pairs] == told
    with pytest.raises(live.Refused, match="make book first"):
        live.live_page(plain(page)[:-900], notebook, page, [1, 2])
    own = {path.name for path in live.PAGE.iterdir()}  # the normal site has none of it
    assert not own & {path.name for path in (ROOT / "book" / "_static").iterdir()}


def test_descent_in_the_page_is_that_of_the_package():
    rng = np.random.default_rng(0)
    data = TrainingSet.from_arrays(rng.normal(size=(80, 2, 5)), rng.normal(size=(80, 2)))
    start = Weights.random(3, 5, hidden=4)
    both = [made(start, data.x, data.y, 0.02, 0.9) for made in (Descent, absent.Descent)]
    for _ in range(200):
        errors = [each.epoch(True, 0.5) for each in both]
    np.testing.assert_allclose(*errors, rtol=1e-5)
    np.testing.assert_allclose(*(each.weights().hidden_weights for each in both), atol=1e-5)


VISCOUS, DRY = ViscousFriction((5.3, 1.1)), CoulombFriction((1.5, 0.45))


@pytest.mark.parametrize(
    ("arm", "effects", "plain"),
    [
        (CMU_DD_ARM_II, Effects(), True),
        (CMU_DD_ARM_II, Effects((VISCOUS,)), True),
        (CMU_DD_ARM_II, Effects((DRY, VISCOUS)), True),
        (CMU_DD_ARM_II, Effects((VISCOUS, StickSlipFriction((1.5, 0.45), (2.0, 0.6)))), False),
        (CMU_DD_ARM_II, Effects(transmission=(FlexibleJoint((2e3, 6e2), (0.2, 0.1)),)), False),
        (replace(CMU_DD_ARM_II, gravity_moments=(30.0, 10.0)), Effects((VISCOUS,)), False),
    ],
)
def test_a_single_run_in_the_page_is_that_of_the_package(monkeypatch, arm, effects, plain):
    law = pd((300.0, 90.0), (35.0, 10.0))
    wanted, both = (record(arm, law, angles, effects=effects) for angles in (ONE, [ONE, OTHER]))
    steps = []
    usual, quick = plant.Plant._advance, absent._runge_kutta
    monkeypatch.setattr(absent, "_runge_kutta", lambda *given: steps.append(1) or quick(*given))
    monkeypatch.setattr(plant.Plant, "_advance", absent.plainly(usual))
    made = record(arm, law, ONE, effects=effects)
    assert bool(steps) == plain
    np.testing.assert_allclose(made.q_true, wanted.q_true, rtol=0, atol=1e-13)
    np.testing.assert_allclose(made.tau_true, wanted.tau_true, rtol=0, atol=1e-9)
    steps.clear()  # several runs at once go as they did
    np.testing.assert_array_equal(record(arm, law, [ONE, OTHER], effects=effects).q, both.q)
    assert not steps


def test_cells_say_what_they_cannot(monkeypatch):
    monkeypatch.setitem(sys.modules, "torch", None)
    monkeypatch.setattr(kernel, "space", {})

    async def nothing(package):
        return False

    def run(source):
        told = []
        asyncio.run(kernel.run(source, "cell", lambda *said: told.append(said), nothing))
        return [said for said in told if said[0] != "names"]

    assert run("import torch\nimport math\nnet = 1") == [("torch", "PyTorch")]
    assert run("print(math.pi > 3)\nnet") == [("text", "True\n"), ("above", "net")]
    assert run("net = 2\nnet + 1") == [("text", "3\n")]
    error, follows = run("x = 1\nx / 0")
    assert 'File "cell", line 2' in error[1] and follows == ("after", "")


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
    built = field.input_value()
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
    assert "STATE_FEEDBACK" in field.input_value()  # it was kept
    tab.get_by_role("button", name="Reset").click()
    assert field.input_value() == built
    field.press("Tab")  # passed through, a field lets go
    assert tab.get_by_role("button", name="Run: cell 1", exact=True).evaluate(FOCUSED)
    assert all(url.startswith((f"{site}/", f"blob:{site}/")) for url in asked)


@pytest.mark.browser
@pytest.mark.slow
@pytest.mark.parametrize("page", WALK)
def test_open_cells_run_through_in_the_page(browser, site, page):
    live_pages.runs_through(browser.new_page(), site, page)


@pytest.mark.browser
@pytest.mark.slow
def test_a_lesson_runs_through_in_firefox_too(playwright, site):
    """Wherever one is installed; `make firefox` has all lessons run in it."""
    if firefox.find() is None:
        pytest.skip(firefox.HOW_TO_GET_ONE)
    with firefox.launched(playwright) as browser:
        live_pages.runs_through(browser.new_page(), site, "book/feedback")


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
    page, cells = "book/feedback", live.live_cells(lesson("book/feedback"))
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

    def run(field):
        field.press("Control+Enter")
        tab.wait_for_timeout(200)
        tab.locator(IDLE).wait_for(timeout=300_000)

    tab.get_by_role("button", name="Run the solution").first.click()
    tab.locator(".live-beside >> text=Right").wait_for(timeout=300_000)
    assert "mine = ..." in mine.input_value()  # the reader's own is as it was
    mine.fill("mine = F / (1.5 * period)")
    run(mine)
    yours = tab.locator(".live-beside .live-output").first
    assert yours.inner_text().startswith("Right") and "Solved: 1 of " in summary.inner_text()
    slider = tab.get_by_role("slider").last  # the load: of three cells, one differs from the next
    slider.press("ArrowRight")
    tab.get_by_role("button", name="Run what follows").click()
    tab.wait_for_timeout(200)
    tab.locator(IDLE).wait_for(timeout=300_000)
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
    assert mine.input_value() == "mine = F / (1.5 * period)"
    summary.click()
    tab.get_by_role("button", name="Erase").click()
    assert "Solved: 0 of " in summary.inner_text() and "mine = ..." in mine.input_value()
    assert not tab.evaluate("Object.keys(localStorage).filter((key) => key.startsWith('live'))")
    with tab.expect_file_chooser() as asked:
        tab.get_by_role("button", name="Open a file").click()
    asked.value.set_files(tmp_path / "work.json")
    tab.locator(".live-own >> text=is here again").wait_for()
    assert "Solved: 1 of " in summary.inner_text()
    tab.get_by_role("button", name="Stop").click()
    run(mine)  # in a Python that has run nothing: what it needs of the cells above runs first
    tab.locator(".live-output >> text=Right").wait_for(timeout=300_000)
    assert not wrong


BROKEN = {  # code, and what stands below the cell
    "x = (1,\ny = 2": "Python cannot read line 1",
    "x = bytes(2**31 - 100)\ny = x + x": "more memory than a page has",
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

    for source, told in BROKEN.items():
        assert told in run(source), source
        assert field.input_value() == source and run("print(6 * 7)").strip() == "42"
    assert not run("").strip()
    field.fill("while True: pass")
    field.press("Control+Enter")
    tab.get_by_text("Running cell 1").first.wait_for(timeout=300_000)
    tab.get_by_role("button", name="Stop").click()
    tab.locator(".live-output >> text=Stopped").wait_for(timeout=60_000)
    assert run("print(6 * 7)").strip() == "42"
    tab.evaluate("() => window.latest.terminate()")
    assert "Python broke off" in run("print(1)", 60_000)
    assert run("print(6 * 7)").strip() == "42"
    assert "keeps nothing for this site" in tab.locator(".live-kept").text_content()
    # Firefox has this to say itself, of a worker that is ended while it computes
    assert set(wrong) <= ({"undefined"} if chromium.FIREFOX else set())
