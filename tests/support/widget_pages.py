"""Pages with widgets and no kernel, for the tests of widgets."""

from __future__ import annotations

import ast
import copy
import json
import re
import time
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from book_pages import ROOT, code_cells, module_of
from ipywidgets.embed import embed_data

from ddlib.learning.network import WEIGHT_NAMES
from ddlib.widgets import bundle

LESSONS = ROOT / "book" / "workshop" / "chapters" / "widgets"
"""Where widgets of single lessons and their scripts are."""

MOUNT = (ROOT / "book" / "_static" / "widget-mount.js").as_uri()

VIEW = '<script type="application/vnd.jupyter.widget-view+json">%s</script>'
STATE = '<script type="application/vnd.jupyter.widget-state+json">%s</script>'

PATHS = "[...document.querySelectorAll('.chart > svg > .curve')].map((p) => p.getAttribute('d'))"
"""What is drawn, as text: changes with the curves."""

READ = r"""(panel) => {
  const svg = document.querySelectorAll('.chart > svg')[panel];
  const ys = [...svg.querySelectorAll('text.y')].map(
    (t) => [t.getAttribute('y'), t.textContent.replace('−', '-').replace(/,/g, '')].map(Number));
  const [[y0, v0], [y1, v1]] = [ys[0], ys.at(-1)];
  return [...svg.querySelectorAll('.curve')].map((p) => p.getAttribute('d').split(/[ML]/).slice(1)
    .map((s) => v0 + (parseFloat(s.split(' ')[1]) - y0) * (v1 - v0) / (y1 - y0)));
}"""
"""What a reader would see: the curves of a panel in the units of its ticks."""

NEXT_FRAME = "() => new Promise((r) => requestAnimationFrame(() => requestAnimationFrame(r)))"


CALM = {"reduced_motion": "reduce"}


@contextmanager
def functions(browser, *scripts):
    """`call(function, argument)`: a JavaScript function beside the engine's and the scripts'."""
    page = browser.new_page()
    script = bundle("engine.js", "descent.js", *scripts)
    page.add_script_tag(content=script.replace("export default", "void"))
    yield page.evaluate
    page.close()


class Finger:
    """A touch, sent to the browser as a screen would."""

    def __init__(self, page):
        self.page, self.client = page, page.context.new_cdp_session(page)

    def send(self, kind, *points):
        where = [{"x": x, "y": y} for x, y in points]
        self.client.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": where})

    def swipe(self, x, y, dx, dy):
        self.hold(x, y, dx, dy)
        self.send("touchEnd")
        self.page.evaluate(NEXT_FRAME)

    def hold(self, x, y, dx, dy):
        self.send("touchStart", (x, y))
        for part in range(1, 11):
            self.send("touchMove", (x + dx * part / 10, y + dy * part / 10))
            self.page.wait_for_timeout(20)


@contextmanager
def phone(browser, url, **options):
    """The address on a phone, with its widgets drawn."""
    size = {"width": 390, "height": 700}
    context = browser.new_context(viewport=size, has_touch=True, is_mobile=True, **options)
    page = context.new_page()
    page.goto(url)
    page.wait_for_selector(".ddlib-widget")
    page.evaluate(NEXT_FRAME)
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    yield page
    context.close()


def write(field, text: str) -> None:
    """As a hand would: Playwright's `fill` adds to what Firefox has in a field for numbers."""
    field.press("ControlOrMeta+a")
    field.press_sequentially(text)


def flat(weights) -> np.ndarray:
    """A network's weights in the page's order."""
    return np.concatenate([np.ravel(getattr(weights, name)) for name in WEIGHT_NAMES])


def drag(page, box, *places) -> tuple[float, float]:
    """With the mouse, through places in parts of a box's width and height; the last one reached.

    A mouse is at whole pixels: Firefox tells a page no others.
    """
    left, top, width, height = (box[name] for name in ("x", "y", "width", "height"))
    points = [(round(left + x * width), round(top + y * height)) for x, y in places]
    page.mouse.move(*points[0])
    page.mouse.down()
    for point in points[1:]:
        page.mouse.move(*point, steps=4)
    page.mouse.up()
    page.evaluate(NEXT_FRAME)
    return (points[-1][0] - left) / width, (points[-1][1] - top) / height


CLIPBOARD = """() => {
  window.copied = undefined;
  navigator.clipboard.writeText = async (text) => { window.copied = text; };
}"""


def copied(page, name="Code") -> str:
    """What a widget's button copies."""
    page.evaluate(CLIPBOARD)
    page.get_by_role("button", name=name).first.click()
    page.wait_for_function("window.copied")
    return page.evaluate("window.copied")


def code_of(chapter: str, name: str) -> str:
    """The text that a cell of a page, or its lesson's module, keeps under a name."""
    module = module_of(chapter)
    sources = [module.read_text(encoding="utf-8")] if module else []
    for source in code_cells(ROOT / "book" / f"{chapter}.ipynb") + sources:
        for line in ast.parse(source).body if f"{name} = " in source else ():
            if isinstance(line, ast.Assign) and line.targets[0].id == name:
                return ast.literal_eval(line.value)
    raise AssertionError(f"{chapter} has no {name}")


def settings(widget, n, seed=1):
    """`n` random settings of a widget's parameters."""
    rng = np.random.default_rng(seed)
    for fractions in rng.uniform(size=(n, len(widget.values))):
        yield {p.name: p.place(f) for p, f in zip(widget._parameters.values(), fractions)}


def assert_exact_table(widget, n=60):
    """At random points of the grids the table has the function's values, rounded to 16 bits."""
    width = {c["name"]: c["high"] - c["low"] for c in widget.spec["curves"]}
    rng = np.random.default_rng(4)
    for _ in range(n):
        values = {name: p.points()[rng.integers(p.grid)] for name, p in widget._parameters.items()}
        exact = widget.curves_at(**values)
        for name, curve in widget.at_grid(**values).items():
            allowed = 0.50001 / 65_535 * width[name] + 1e-12
            np.testing.assert_allclose(curve, exact[name], rtol=0, atol=allowed, err_msg=name)


def saved(*widgets) -> dict:
    """The state as a notebook keeps it: whole, with script and style."""
    return embed_data(list(widgets), drop_defaults=False)["manager_state"]


def page_of(path: Path, *widgets, change=None, extra="", mount=MOUNT, damages=()) -> str:
    """Write a page with the widgets, one below the other; its address.

    `change` changes the first widget's saved entry in place, and each of the `damages` a copy of
    it, shown after the widgets. `extra` is markup before the script at `mount`.
    """
    state = saved(*widgets)
    ids = [widget.model_id for widget in widgets]
    for k, damage in enumerate(damages):
        entry = copy.deepcopy(state["state"][ids[0]])
        damage(entry)
        state["state"][f"damaged-{k}"] = entry
        ids.append(f"damaged-{k}")
    if change:
        change(state["state"][ids[0]])
    views = "".join(VIEW % json.dumps({"model_id": model_id}) for model_id in ids)
    head = '<!doctype html><html lang="en"><meta charset="utf-8"><link rel="icon" href="data:,">'
    dark = "@media screen and (prefers-color-scheme: dark) { body { background: #121212; "
    dark += "color: #eee } }"
    look = f"<style>body {{ margin: 8px }} {dark}</style>"
    scripts = f'{STATE % json.dumps(state)}{extra}<script src="{mount}" defer></script>'
    viewport = '<meta name="viewport" content="width=device-width">'
    title = "<title>page</title>"
    body = f"<body><main><h1>Page</h1>{views}</main>{scripts}"
    path.write_text(f"{head}{viewport}{title}{look}{body}", encoding="utf-8")
    return path.as_uri()


CURVES = """() => {
  const { curves } = document.querySelector(".ddlib-curves").view;
  return Object.fromEntries(Object.entries(curves).map(([name, values]) => [name, [...values]]));
}"""


def assert_curves(page, known, small=1e-6):
    """What the page has computed or read is known, to a part of each curve's size."""
    page.evaluate(NEXT_FRAME)
    curves = page.evaluate(CURVES)
    for name, values in known.items():
        allowed = small * (np.nanmax(np.abs(values)) + 1e-3)
        np.testing.assert_allclose(
            np.array(curves[name], float), np.ravel(values), rtol=0, atol=allowed, err_msg=name
        )
    return curves


SET = "(values) => document.querySelector('.ddlib-curves').view.set(values)"
"""Sets parameters, all in one."""


def shown_values(page) -> list[float]:
    """The numbers beside the sliders, once what was changed has been drawn."""
    page.evaluate(NEXT_FRAME)
    texts = page.locator(".slider output").all_inner_texts()
    return [float(re.match(r"[−\d.]+", x)[0].replace("−", "-")) for x in texts]


LIVE = """<script>
{
  window.kernel = { alive: false, closed: false, sent: [] };
  const blob = Blob;
  window.Blob = class extends blob {
    constructor([text], options) {
      const live = text.replace("export default { render };", `
      export default { render({ model, el }) {
        delete model.kernelless;
        model.save_changes = () => {
          if (kernel.closed) throw new Error("Comm is closed");
          if (kernel.alive) setTimeout(() => {
            const values = model.get("spec").parameters.map((p) => model.get(p.name));
            const exact = new DataView(new Float32Array(kernel.reply).buffer);
            model.set({ exact, answer: { request: model.get("request"), values } });
          }, 50);
        };
        model.send = (content) => {
          if (kernel.closed) throw new Error("Comm is closed");
          kernel.sent.push(content);
        };
        const signal = (set) => ({ connect: (f) => set.add(f), disconnect: (f) => set.delete(f) });
        kernel.watchers = [new Set(), new Set()];
        const [statusChanged, disposed] = kernel.watchers.map(signal);
        model.widget_manager = { kernel: { statusChanged, disposed } };
        kernel.model = model;
        return render({ model, el });
      } };`);
      super([live], options);
    }
  };
}
</script>"""
"""A kernel that answers if `kernel.alive`: the same script with a live model, for `extra`."""

BRIDGE = """<script>
{
  window.models = [];
  window.early = window.early ?? (() => {});
  const blob = Blob;
  window.Blob = class extends blob {
    constructor([text], options) {
      const watched = text.replace("export default { render };", `
      export default { render({ model, el }) {
        const kept = {};
        if (window.toPython) {
          delete model.kernelless;
          const set = model.set;
          model.set = (name, value) => {
            const changes = typeof name === "string" ? { [name]: value } : name;
            if (!window.receiving) Object.assign(kept, changes);
            set.call(model, changes);
          };
          model.save_changes = () => {
            const sent = { ...kept };
            for (const name of Object.keys(kept)) delete kept[name];
            for (const [name, value] of Object.entries(sent)) {
              if (value instanceof DataView) {
                sent[name] = { bytes: [...new Uint8Array(value.buffer)] };
              }
            }
            window.toPython(sent);
          };
        }
        window.models.push(model);
        const stop = render({ model, el });
        window.early(model);
        return stop;
      } };`);
      super([watched], options);
    }
  };
}
</script>"""
"""Models in `models`, and `early(model)` called before anything is laid out; for `extra`. With a
function `toPython`, a kernel gets what the page sets: see `linked`."""


@contextmanager
def linked(browser, url, widget):
    """A page, made with BRIDGE, whose first widget and `widget` of this process are one."""
    page = browser.new_page(viewport={"width": 1280, "height": 800}, **CALM)
    problems = []
    page.on("pageerror", lambda error: problems.append(str(error)))

    def receive(sent):
        raw = {n: memoryview(bytes(v["bytes"])) for n, v in sent.items() if _packed(v)}
        received.update(sent)
        widget.set_state({**sent, **raw})
        received.clear()

    def send(change):
        state = json.loads(json.dumps(widget.get_state([change["name"]])))
        if state.items() <= received.items():
            return  # as with a comm: what was received does not go back
        code = "(state) => { receiving = true; models[0].set(state); receiving = false; }"
        waiting.append((code, state))

    waiting, received = [], {}
    names = [name for name in widget.keys if not name.startswith("_")]
    plain = [n for n in names if not isinstance(getattr(widget, n), (bytes, dict))]

    def settle(condition, seconds=60):
        """Let messages pass in both directions until a condition holds in Python."""
        end = time.monotonic() + seconds
        while True:
            while waiting:
                page.evaluate(*waiting.pop(0))
            if condition():
                return
            assert time.monotonic() < end, "still waiting"
            page.wait_for_timeout(20)

    page.expose_function("toPython", receive)
    page.goto(url)
    page.wait_for_selector(".ddlib-widget")
    widget.observe(send, plain)
    yield page, settle
    widget.unobserve(send, plain)
    page.close()
    assert not problems


def _packed(value) -> bool:
    return isinstance(value, dict) and set(value) == {"bytes"}
