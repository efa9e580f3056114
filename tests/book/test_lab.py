"""Chapters with widgets in a real JupyterLab: run them, move a control, kill the kernel, go on.

Five of them have every kind of widget: one that is pulled, one with a recording behind it, and
those of weights, filters and training. One is run whole, as a reader does; of the others the cells
that their widgets need, since every notebook is executed elsewhere, too. A handed-out notebook is
looked at, run in part, saved and opened again.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import time
import urllib.request
from pathlib import Path

import pytest
from book_pages import ROOT, code_cells, source
from lab import MADE, trust
from nbformat.sign import NotebookNotary
from needed import needed
from reactions import SLIDER, Handle, handles

pytestmark = [pytest.mark.browser, pytest.mark.slow]

TOKEN = "token-of-the-test"
STARTING, RUNNING, ANSWER = 120, 300, 60  # seconds, on a busy machine
NOTE = "The kernel does not answer"
WHOLE = "book/hinton-diagrams"
OTHERS = ("index", "trajectories-and-recording", "convolution-filters", "window-networks")
CHAPTERS = [WHOLE, *(f"book/{name}" for name in OTHERS)]


@pytest.fixture(scope="module")
def lab(tmp_path_factory):
    """The address of a JupyterLab on a copy of the book, with settings of its own."""
    home = tmp_path_factory.mktemp("lab")
    shutil.copytree(ROOT / "book", home / "book", ignore=shutil.ignore_patterns(".*", "_[a-z]*"))
    settings = home / "settings" / "@jupyterlab" / "notebook-extension"
    settings.mkdir(parents=True)
    # every cell is in the page, so that every widget is
    (settings / "tracker.jupyterlab-settings").write_text('{"windowingMode": "none"}')
    folders = {
        **{f"JUPYTER_{name}_DIR": name.lower() for name in ("CONFIG", "DATA", "RUNTIME")},
        **{f"JUPYTERLAB_{name}_DIR": name.lower() for name in ("SETTINGS", "WORKSPACES")},
        "IPYTHONDIR": "ipython",
    }
    options = [
        "--no-browser",
        "--ServerApp.ip=127.0.0.1",
        "--ServerApp.port=0",
        f"--ServerApp.root_dir={home}",
        f"--IdentityProvider.token={TOKEN}",
        "--LabApp.expose_app_in_browser=True",
        "--LabApp.extension_manager=readonly",
        f"--LabApp.app_settings_dir={ROOT / 'book' / '_ext' / 'lab-settings'}",
        "--FileContentsManager.pre_save_hook=lab.keep_widgets",
        *(["--allow-root"] if os.geteuid() == 0 else []),
    ]
    if MADE.is_dir():
        shutil.copytree(MADE, home / "handed-out")
        (home / "data").mkdir()
        trust(MADE, NotebookNotary(data_dir=str(home / "data")))
    log = home / "log.txt"
    with log.open("w") as output:
        server = subprocess.Popen(
            [sys.executable, "-m", "jupyterlab", *options],
            env={
                **os.environ,
                "OMP_NUM_THREADS": "1",
                "PYTHONPATH": os.pathsep.join((str(home / "book"), str(ROOT / "book" / "_ext"))),
                **{name: str(home / folder) for name, folder in folders.items()},
            },
            stdout=output,
            stderr=subprocess.STDOUT,
        )
        try:
            yield address(home / "runtime", server, log)
        finally:
            server.terminate()
            server.wait(ANSWER)


def address(runtime: Path, server: subprocess.Popen, log: Path) -> str:
    """Where the server listens, once it answers."""
    end = time.monotonic() + STARTING
    while time.monotonic() < end and server.poll() is None:
        for info in runtime.glob("jpserver-*.json"):
            try:
                url = json.loads(info.read_text())["url"]
                request(url + "api/status")
                return url
            except (OSError, ValueError):  # half-written, or not yet listening
                pass
        time.sleep(0.2)
    pytest.fail(f"JupyterLab did not start:\n{log.read_text()[-3000:]}")


def request(url: str, method: str = "GET"):
    """What the server's REST interface answers."""
    headers = {"Authorization": f"token {TOKEN}"}
    with urllib.request.urlopen(
        urllib.request.Request(url, method=method, headers=headers), timeout=30
    ) as answer:
        text = answer.read()
    return json.loads(text) if text else None


def wait(page, what: str, condition, seconds: float):
    """Until the condition holds; its value."""
    end = time.monotonic() + seconds
    while not (value := condition()):
        assert time.monotonic() < end, f"still waiting for {what}"
        page.wait_for_timeout(100)
    return value


def show(page, path: str):
    """Open a notebook."""
    page.evaluate("(path) => lab.show(path)", path)
    wait(page, "the notebook", lambda: page.evaluate("Boolean(window.panel)"), STARTING)


def values(page, model: str) -> dict:
    """The parameters of a widget, as Python has them."""
    code = (
        "import json as _json\n"
        "from ipywidgets.widgets.widget import _instances\n"
        f"print(_json.dumps(_instances[{model!r}].values))"
    )
    return json.loads(page.evaluate("(code) => lab.ask(code)", code))


def run(page, places: list[int] | None):
    """Run the code cells at those places, or all."""

    def done():
        state = page.evaluate("(places) => lab.ran(places)", places)
        assert not state["errors"]
        return state["todo"] == 0

    page.evaluate("(places) => lab.run(places)", places)
    wait(page, "the last prompt number", done, RUNNING)


def reacts(page, handle: Handle, model: str):
    """A change reaches Python, and exact values come back."""
    before, picture = values(page, model), handle.picture()
    handle.press()
    assert handle.picture() != picture
    wait(page, "the trait in Python", lambda: values(page, model) != before, ANSWER)
    exact = handle.root.and_(page.locator("[data-values=exact]"))
    wait(page, "exact values", lambda: exact.count() == 1, ANSWER)
    assert not handle.root.get_by_text(NOTE).is_visible()


def reacts_alone(page, handle: Handle):
    """A change is drawn from baked values, and the reader is told so."""
    picture = handle.picture()
    handle.press()
    wait(page, "a redraw without kernel", lambda: handle.picture() != picture, ANSWER)
    note = handle.root.get_by_text(NOTE)
    wait(page, "the note", note.is_visible, ANSWER)
    baked = handle.root.and_(page.locator("[data-values=baked]"))
    wait(page, "baked values", lambda: baked.count() == 1, ANSWER)


CELLS = """() => {
  const { content } = window.panel;
  const seen = content.widgets.filter((cell) => !cell.isHidden).length;
  return [content.activeCellIndex, content.mode, seen];
}"""


def keys_move_it(page, root):
    """Each arrow moves each slider of a widget, and no cell: JupyterLab has these keys, too."""
    sliders = root.locator(SLIDER).locator("visible=true")
    if not sliders.count():
        return
    sliders.first.focus()
    page.wait_for_timeout(300)  # until the notebook has made this cell the active one
    cells = page.evaluate(CELLS)
    for slider in sliders.all():
        for there, back in (("ArrowRight", "ArrowLeft"), ("ArrowUp", "ArrowDown")):
            least, most = (slider.get_attribute(end) for end in ("min", "max"))
            start = slider.input_value()
            for key in (back, there) if start == most else (there, back):
                before = slider.input_value()
                slider.press(key)
                assert slider.input_value() != before, (key, before, least, most)
                assert slider.evaluate("(el) => el === document.activeElement"), key
    assert page.evaluate(CELLS) == cells


def way_of(handle: Handle):
    """What to ask of a widget with a kernel, and without one."""
    if handle.root.evaluate("(root) => Boolean(root.world)"):
        return is_pulled, is_pulled
    if handle.root.get_attribute("data-values") in ("exact", "baked"):
        return reacts, reacts_alone
    return is_computed, is_computed


def is_computed(page, handle: Handle, model: str = ""):
    """A change is drawn by a widget that computes in the page, whether there is a kernel."""
    picture = handle.picture()
    handle.press()
    wait(page, "a redraw", lambda: handle.picture() != picture, ANSWER)


def is_pulled(page, handle: Handle, model: str = ""):
    """A key pulls the hand in a widget that computes in the page, whether there is a kernel."""
    mode = "(root) => root.world.mode"
    handle.handle.focus()
    page.keyboard.down("ArrowLeft")
    picture = handle.picture()
    assert handle.root.evaluate(mode) == "held"
    wait(page, "a motion", lambda: handle.picture() != picture, ANSWER)
    page.keyboard.up("ArrowLeft")
    wait(page, "the release", lambda: handle.root.evaluate(mode) == "free", ANSWER)


@pytest.fixture(scope="module")
def started(lab, browser):
    """JupyterLab in a page, and the errors that its scripts make."""
    context = browser.new_context(viewport={"width": 1400, "height": 900})
    context.set_default_timeout(1000 * STARTING)
    context.add_init_script(path=ROOT / "tests" / "support" / "lab.js")
    page = context.new_page()
    errors = []
    page.on("pageerror", lambda error: errors.append(str(error)))
    page.goto(f"{lab}lab?token={TOKEN}&reset")
    page.wait_for_selector("#jp-main-dock-panel")
    yield page, errors
    context.close()


@pytest.fixture
def opened(started):
    """JupyterLab with nothing open; its scripts make no errors."""
    page, errors = started
    yield page
    page.evaluate("lab.close()")
    assert not errors


@pytest.mark.parametrize("name", CHAPTERS)
def test_widgets_of_a_chapter_live_in_the_lab(name, lab, opened):
    """With a kernel, and when it is gone."""
    page = opened
    show(page, source(name).relative_to(ROOT).as_posix())
    run(page, None if name == WHOLE else needed(code_cells(source(name))))
    models = page.evaluate("lab.shown()")
    roots = page.locator(".jp-OutputArea-output .ddlib-widget")
    wait(page, "the widgets", lambda: roots.count() == len(models) > 0, ANSWER)
    firsts = [handles(roots.nth(k))[0] for k in range(len(models))]
    ways = [way_of(handle) for handle in firsts]
    for handle, model, (with_kernel, _) in zip(firsts, models, ways):
        with_kernel(page, handle, model)
    for k in range(len(models)):
        keys_move_it(page, roots.nth(k))
    kernel = page.evaluate("window.panel.sessionContext.session.kernel.id")
    request(f"{lab}api/kernels/{kernel}", "DELETE")
    for handle, (_, alone) in zip(firsts, ways):
        alone(page, handle)


@pytest.mark.built
def test_a_handed_out_notebook_is_seen_before_it_runs_and_after_it_was_saved(built, opened):
    page, path = opened, "handed-out/02-feedback.ipynb"
    roots = page.locator(".jp-OutputArea-output .ddlib-widget")

    def seen():
        show(page, path)
        shown = page.evaluate("lab.shown()")
        wait(page, "the widgets", lambda: roots.count() == len(shown) > 1, ANSWER)
        assert not page.get_by_text("Error displaying widget").count()
        return page.locator(".jp-OutputArea-output img")

    pictures = seen()
    assert pictures.count() > 3
    assert all(pictures.evaluate_all("(all) => all.map((one) => one.naturalWidth > 100)"))
    handle = handles(roots.first)[0]
    way_of(handle)[1](page, handle)
    run(page, [1])  # the first widget; the second stays the book's
    slider = roots.first.locator(SLIDER).first
    slider.press("ArrowRight")
    value = slider.input_value()
    page.wait_for_timeout(500)  # until Python has it
    page.evaluate("lab.save()")
    page.evaluate("lab.close()")
    seen()
    assert roots.first.locator(SLIDER).first.input_value() == value
