"""Widgets: their Python side, their script in Node, and both in a browser without a kernel."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from ipywidgets.embed import embed_data
from traitlets import TraitError

import ddlib.widgets
from ddlib.experiment import STATE_FEEDBACK
from ddlib.trajectories import APPENDIX_I
from ddlib.widgets import CurveWidget, Mark, Pad, Panel, Parameter, Scalar, TrajectoryPicker
from ddlib.widgets.baked import MAX_BYTES, Baked
from ddlib.widgets.picker import inside_hull

ROOT = Path(__file__).resolve().parent.parent
WIDGETS = Path(ddlib.widgets.__file__).parent
MOUNT = (ROOT / "book" / "_static" / "widget-mount.js").as_uri()
CI = os.environ.get("CI", "").lower() in {"1", "true"}
T = np.linspace(0, 1, 41)


def oscillation(gain, decay, phase):
    """Smooth in three parameters; one of them on a logarithmic scale."""
    y = np.exp(-decay * T) * np.cos(6 * T + phase) * np.log(gain)
    return {"position": y, "square": y**2 + gain, "constant": np.full(3, 2.5), "final": y[-1]}


def parameters(grid=7):
    return [
        Parameter("gain", "Gain", 1, 100, 10, "N m/rad", 9, "log"),
        Parameter("decay", "Decay", 0, 2, 0.5, "1/s", grid),
        Parameter("phase", "Phase", -1, 1, 0, "rad", grid),
    ]


def panels():
    return [
        Panel("Position, m", {"position": "hand"}, "time, s", T),
        Panel("Square, m²", ("square",), "time, s", T),
    ]


def make(**changes):
    pad = Pad("decay", "phase", [Mark(0.5, 0.5, "1", "training"), Mark(1, 0, "2", "test")])
    options = {
        "alt": "Two curves",
        "scalars": [Scalar("final", "Final position", "m")],
        "pad": pad,
        **changes,
    }
    return CurveWidget(oscillation, parameters(), panels(), **options)


@pytest.fixture(scope="module")
def picker():
    return TrajectoryPicker()


def settings(widget, n, seed=1):
    rng = np.random.default_rng(seed)
    for fractions in rng.uniform(size=(n, len(widget.values))):
        yield {
            p["name"]: float(Parameter(**p, value=p["high"]).place(f))
            for p, f in zip(widget.spec["parameters"], fractions)
        }


def saved(*widgets) -> dict:
    """The state as a notebook keeps it: whole, with script and style."""
    return embed_data(list(widgets), drop_defaults=False)["manager_state"]


# Python


@pytest.mark.parametrize("make_one", [make, TrajectoryPicker])
def test_interpolation_is_within_what_the_widget_states(make_one):
    widget = make_one()
    assert widget.interpolation_error(200, seed=0) == widget.spec["error"] <= 0.01
    assert widget.interpolation_error(300, seed=5) < 2 * widget.spec["error"]
    assert widget.baked_bytes == len(widget.baked) <= MAX_BYTES


def test_error_is_the_largest_deviation_of_any_curve():
    widget = make()
    width = {c["name"]: c["high"] - c["low"] or 2.5 for c in widget.spec["curves"]}
    worst = 0.0
    for values in settings(widget, 50, seed=3):
        exact = oscillation(**values)
        for name, curve in widget.interpolate(**values).items():
            worst = max(worst, np.abs(curve - exact[name]).max() / width[name])
    assert worst == pytest.approx(widget.interpolation_error(50, seed=3))


@pytest.mark.parametrize("cubic", [True, False])
def test_grid_points_come_back_within_half_a_step(cubic):
    baked = Baked(oscillation, parameters(4), cubic)
    for gain in parameters()[0].points()[[0, 3, 8]]:
        for decay in parameters(4)[1].points():
            values = {"gain": float(gain), "decay": float(decay), "phase": 1.0}
            exact, got = oscillation(**values), baked.interpolate(**values)
            for low, high, name in zip(baked.low, baked.high, got):
                np.testing.assert_allclose(got[name], exact[name], atol=0.51 * (high - low) / 65534)
    assert np.abs(baked.table.astype(int)).max() <= 32767


def test_cubic_is_exact_for_parabolas_and_linear_for_lines():
    axes = [Parameter("a", "a", -1, 3, 0, grid=5), Parameter("b", "b", 0, 1, 0, grid=3)]
    parabola = Baked(lambda a, b: {"y": [a**2 - 3 * a * b + b**2, 1.0]}, axes)
    assert parabola.error(100) < 3e-5
    line = Baked(lambda a, b: {"y": 2 * a - b + a * b}, axes, cubic=False)
    assert line.error(100) < 3e-5


def test_parameters_are_traits():
    widget, seen = make(), []
    widget.observe(lambda change: seen.append(change["new"]), "gain")
    widget.gain = 50
    assert seen == [50.0] and widget.values == {"gain": 50.0, "decay": 0.5, "phase": 0.0}
    assert widget.answer == {"request": 0, "values": [50.0, 0.5, 0.0]}
    exact = np.frombuffer(widget.exact, "<f4")
    np.testing.assert_allclose(exact, np.concatenate([*map(np.atleast_1d, widget.curves.values())]))
    np.testing.assert_allclose(widget.curves["position"], oscillation(50, 0.5, 0)["position"])


def test_page_asks_and_python_answers():
    widget = make()
    widget.set_state({"decay": 1.5, "phase": 0.25, "request": 7})
    assert widget.answer == {"request": 7, "values": [10.0, 1.5, 0.25]}
    assert np.frombuffer(widget.exact, "<f4")[:41] == pytest.approx(
        oscillation(10, 1.5, 0.25)["position"], abs=1e-6
    )


def test_failing_function_is_reported_to_the_page():
    def fragile(gain):
        if gain == 3:
            raise ZeroDivisionError("gain of three")
        return {"y": gain * T}

    gain = Parameter("gain", "Gain", 0, 10, 1, grid=2)
    widget = CurveWidget(fragile, [gain], [Panel("y", "y", "x", T)], alt="A line")
    widget.gain = 3
    assert widget.answer["error"] == "ZeroDivisionError: gain of three" and widget.exact == b""
    widget.gain = 4
    assert "error" not in widget.answer and len(widget.exact) == 4 * 41


@pytest.mark.parametrize("bad", [0.5, 101, np.nan, np.inf, "x", None, [1, 2]])
def test_bad_values_name_parameter_and_value(bad):
    widget = make()
    with pytest.raises(TraitError, match="gain must"):
        widget.gain = bad
    assert widget.gain == 10
    with pytest.raises((TypeError, ValueError), match="gain must"):
        widget.interpolate(gain=bad)


@pytest.mark.parametrize(
    "changes, message",
    [
        ({"name": "two words"}, "identifier.*'two words'"),
        ({"low": 5, "high": 5}, r"high of k must lie in \(5"),
        ({"value": 11}, r"k must lie in \[1, 10\], got 11"),
        ({"low": 0, "scale": "log"}, r"low of k must lie in \(0"),
        ({"grid": 1}, "grid of k"),
        ({"scale": "cubic"}, "scale of k"),
    ],
)
def test_bad_parameters(changes, message):
    with pytest.raises(ValueError, match=message):
        Parameter(**{"name": "k", "label": "k", "low": 1, "high": 10, "value": 2, **changes})


@pytest.mark.parametrize(
    "changes, message",
    [
        ({"tolerance": 1e-6}, "tolerance|interpolate to 1e-06"),
        ({"scalars": [Scalar("final!", "Final")]}, "curve must be one of"),
        ({"scalars": [Scalar("square", "Square")]}, "square must be one number"),
        ({"pad": Pad("decay", "nothing")}, "parameter of the pad"),
        ({"alt": " "}, "alt must describe"),
        ({"interpolation": "spline"}, "interpolation"),
    ],
)
def test_arguments_that_do_not_fit(changes, message):
    with pytest.raises(ValueError, match=message):
        make(**changes)


def test_too_large_a_grid_is_refused_before_the_work():
    calls = []

    def wide(a, b):
        calls.append(a)
        return {"y": np.zeros(1000)}

    axes = [Parameter(n, n, 0, 1, 0, grid=50) for n in "ab"]
    with pytest.raises(ValueError, match=f"at most {MAX_BYTES} baked bytes, got 5000000"):
        Baked(wide, axes)
    assert len(calls) == 1


def test_curves_must_be_finite_and_of_one_shape():
    axis = [Parameter("a", "a", 0, 1, 0, grid=3)]
    with pytest.raises(ValueError, match="y must be finite"):
        Baked(lambda a: {"y": [1.0, np.nan]}, axis)
    with pytest.raises(ValueError, match="same curves everywhere"):
        Baked(lambda a: {"y": np.zeros(2 if a < 0.5 else 3)}, axis)
    with pytest.raises(TypeError, match="must return a dict"):
        Baked(lambda a: np.zeros(3), axis)
    with pytest.raises(ValueError, match="position must have 40 samples"):
        CurveWidget(oscillation, parameters(3), [Panel("y", "position", "x", T[1:])], alt="a")
    with pytest.raises(ValueError, match="attribute of widgets"):
        layout = Parameter("layout", "Layout", 0, 1, 0)
        CurveWidget(lambda layout: {"y": T}, [layout], [Panel("y", "y", "x", T)], alt="a")


def test_state_embeds(picker):
    entry = saved(picker)["state"][picker.model_id]
    assert {tuple(b["path"]) for b in entry["buffers"]} == {("baked",), ("exact",)}
    state = entry["state"]
    assert "export default" in state["_esm"] and "import " not in state["_esm"]
    assert state["still"].startswith("data:image/svg+xml;base64,") and state["still_alt"]
    assert len(json.dumps(entry)) < MAX_BYTES


# The picker


def test_picker_knows_the_hull():
    assert inside_hull(APPENDIX_I[:5]).all()
    assert not inside_hull(APPENDIX_I[5])
    assert inside_hull(APPENDIX_I[:5].mean(0))
    assert not inside_hull([0.0, 0.0])


def test_extents_and_sliders_follow_each_other():
    picker = TrajectoryPicker(checks=5)
    assert picker.extents_deg == tuple(APPENDIX_I[5]) and not picker.interpolates
    picker.extents_deg = (20, 30)
    assert (picker.shoulder_deg, picker.elbow_deg) == (20, 30) and picker.interpolates
    picker.elbow_deg = 40
    assert picker.extents_deg == (20, 40)
    for bad in [(20, 46), (-1, 3), (1, np.nan), 3, (1, 2, 3)]:
        with pytest.raises(TraitError, match="extents_deg"):
            picker.extents_deg = bad
    assert picker.extents_deg == (20, 40)


def test_recording_from_the_page():
    calls = []
    picker = TrajectoryPicker(on_record=lambda e: calls.append(e) or len(calls), checks=5)
    picker._handle_custom_msg({"type": "record", "extents_deg": [10, 20.5]}, [])
    assert calls == [(10, 20.5)] and picker.recording == 1 and picker.elbow_deg == 20.5
    assert "Recorded 10.0° and 20.5°" in picker.record_status["text"]
    picker._handle_custom_msg({"type": "record", "extents_deg": [10, 99]}, [])
    assert len(calls) == 1 and "must lie in [0, 45], got 99" in picker.record_status["text"]


def test_recording_is_the_experiments():
    picker = TrajectoryPicker(checks=5)
    expected = STATE_FEEDBACK.record(picker.extents_deg)
    np.testing.assert_array_equal(picker.record().tau, expected.tau)


def test_models_add_torque_curves():
    picker = TrajectoryPicker(models={"slope": lambda e: np.outer(np.arange(300), e)}, checks=5)
    expected = np.minimum(picker.interpolate(shoulder_deg=10)["shoulder angle"] * 0 + 2990, 2990)
    assert picker.curves["shoulder torque, slope"][-1] == 299 * APPENDIX_I[5, 0]
    assert picker.interpolate(shoulder_deg=10)["shoulder torque, slope"][-1] == pytest.approx(
        expected[-1], rel=1e-3
    )
    for bad in (3, lambda e: np.zeros(300)):
        with pytest.raises((TypeError, ValueError), match="slope"):
            TrajectoryPicker(models={"slope": bad}, checks=5)


# The script


@pytest.fixture(scope="module")
def node():
    path = shutil.which("node")
    if path is None:
        (pytest.fail if CI else pytest.skip)("no Node.js found: install nodejs")
    return path


SCRIPT = """
import fs from "node:fs";
const [module, input] = process.argv.slice(2);
const { interpolate, readTable, insidePolygon, fromFraction, toFraction } = await import(module);
const { spec, baked, settings, points } = JSON.parse(fs.readFileSync(input));
const bytes = Uint8Array.from(Buffer.from(baked, "base64"));
const table = readTable(spec, new DataView(bytes.buffer));
const damage = (change) => {
  try { change(); return null; } catch (error) { return error.message; }
};
console.log(JSON.stringify({
  curves: settings.map((values) => [...interpolate(spec, table, values)]),
  inside: points.map((p) => insidePolygon(spec.pad.region, ...p)),
  back: settings.map((v) => spec.parameters.map((p, k) => fromFraction(p, toFraction(p, v[k])))),
  short: damage(() => readTable(spec, new DataView(bytes.buffer, 0, 10))),
  wrong: damage(() => { bytes[99] ^= 1; readTable(spec, new DataView(bytes.buffer)); }),
  empty: damage(() => readTable({}, new DataView(bytes.buffer))),
}));
"""


@pytest.mark.parametrize("interpolation", ["cubic", "linear"])
def test_script_interpolates_as_python_does(node, tmp_path, interpolation):
    import base64

    region = [(0, 0), (1, -1), (2, 1)]
    widget = make(interpolation=interpolation, tolerance=1, pad=Pad("decay", "phase", (), region))
    ends = [{p.name: x for p, x in zip(parameters(), corner)} for corner in
            ([1, 0, -1], [100, 2, 1], [10, 1, 0])]  # fmt: skip
    chosen = [*settings(widget, 30), *ends]
    data = {
        "spec": widget.spec,
        "baked": base64.b64encode(widget.baked).decode(),
        "settings": [list(values.values()) for values in chosen],
        "points": [(1, 0), (0.1, 0.5), (2, 1), (1.9, -1)],
    }
    for name, text in [("in.json", json.dumps(data)), ("run.mjs", SCRIPT),
                       ("widget.mjs", widget._esm)]:  # fmt: skip
        (tmp_path / name).write_text(text)
    command = [node, "run.mjs", (tmp_path / "widget.mjs").as_uri(), "in.json"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    out = json.loads(done.stdout)
    for values, got in zip(chosen, out["curves"]):
        expected = np.concatenate(list(widget.interpolate(**values).values()))
        np.testing.assert_allclose(got, expected, atol=1e-9)
    np.testing.assert_allclose(out["back"], data["settings"], atol=1e-9)
    assert out["inside"] == [True, False, True, False]
    assert out["short"] == f"10 bytes in place of {len(widget.baked)}"
    assert out["wrong"] == "the checksum is wrong" and out["empty"] == "no description"


# In a page without a kernel

VIEW = '<script type="application/vnd.jupyter.widget-view+json">%s</script>'
STATE = '<script type="application/vnd.jupyter.widget-state+json">%s</script>'


def page_of(path: Path, *widgets, change=None, extra="", mount=MOUNT) -> str:
    state = saved(*widgets)
    if change:
        change(state["state"][widgets[0].model_id])
    views = "".join(VIEW % json.dumps({"model_id": w.model_id}) for w in widgets)
    head = '<!doctype html><html lang="en"><meta charset="utf-8"><link rel="icon" href="data:,">'
    dark = "@media (prefers-color-scheme: dark) { body { background: #121212 } }"
    look = f"<style>body {{ margin: 8px }} {dark}</style>"
    scripts = f'{STATE % json.dumps(state)}{extra}<script src="{mount}" defer></script>'
    viewport = '<meta name="viewport" content="width=device-width">'
    path.write_text(f"{head}{viewport}<title>page</title>{look}<body>{views}{scripts}")
    return path.as_uri()


PATHS = "[...document.querySelectorAll('.chart > svg > .curve')].map((p) => p.getAttribute('d'))"
# What a reader would see: the curve in the units of its ticks.
READ = r"""(panel) => {
  const svg = document.querySelectorAll('.chart > svg')[panel];
  const ys = [...svg.querySelectorAll('text.y')].map(
    (t) => [Number(t.getAttribute('y')), Number(t.textContent.replace('−', '-'))]);
  const [[y0, v0], [y1, v1]] = [ys[0], ys.at(-1)];
  return [...svg.querySelectorAll('.curve')].map((p) => p.getAttribute('d').split(/[ML]/).slice(1)
    .map((s) => v0 + (Number(s.split(' ')[1]) - y0) * (v1 - v0) / (y1 - y0)));
}"""
NEXT_FRAME = "() => new Promise((r) => requestAnimationFrame(() => requestAnimationFrame(r)))"


def shown_values(page) -> list[float]:
    texts = page.locator(".slider output").all_inner_texts()
    return [float(re.match(r"[−\d.]+", x)[0].replace("−", "-")) for x in texts]


browser_test = pytest.mark.browser


@browser_test
def test_picker_without_a_kernel(tmp_path, visit, picker):
    opened = visit(page_of(tmp_path / "page.html", picker))
    page = opened.page
    page.evaluate(NEXT_FRAME)
    assert page.locator(".ddlib-widget").count() == 1
    before = page.evaluate(PATHS)
    assert len(before) == 4 and all(before)
    assert "extrapolates" in page.locator(".verdict").inner_text()
    box = page.locator(".pad .frame").bounding_box()
    page.mouse.move(box["x"] + 0.9 * box["width"], box["y"] + 0.7 * box["height"])
    page.mouse.down()
    page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 3, steps=5)
    page.mouse.up()
    page.evaluate(NEXT_FRAME)
    dragged = page.evaluate(PATHS)
    assert all(a != b for a, b in zip(before, dragged))
    assert "interpolates" in page.locator(".verdict").inner_text()
    shoulder, elbow, _ = shown_values(page)
    assert (shoulder, elbow) == (pytest.approx(22.5, abs=0.4), pytest.approx(30, abs=0.4))

    page.locator("input[id$=shoulder_deg]").focus()
    page.keyboard.press("Home")
    for _ in range(20):
        page.keyboard.press("ArrowRight")
    page.locator("input[id$=elbow_deg]").press("End")
    page.locator(".pad").focus()
    page.keyboard.press("Shift+ArrowDown")
    page.keyboard.press("ArrowLeft")
    page.evaluate(NEXT_FRAME)
    assert shown_values(page)[:2] == [9.5, 40.0]
    exact = TrajectoryPicker(checks=1)
    exact.extents_deg = (9.5, 40.0)
    for panel, names in enumerate(s["curves"] for s in picker.spec["panels"]):
        for got, name in zip(page.evaluate(READ, panel), names):
            wide = next(c["high"] - c["low"] for c in picker.spec["curves"] if c["name"] == name)
            # what the widget states, and a fiftieth of a pixel
            allowed = (picker.spec["error"] + 0.02 / 100) * wide
            np.testing.assert_allclose(got, exact.curves[name], atol=allowed)
    peaks = page.locator(".scalars output").all_inner_texts()
    assert [float(p.split()[0]) for p in peaks] == pytest.approx(
        [exact.curves[f"peak {j}"][0] for j in ("shoulder", "elbow")], abs=0.06
    )
    assert page.locator(".record button").is_disabled()
    assert "kernel" in page.locator(".record p").inner_text()
    assert not opened.problems


@browser_test
def test_player_moves_the_arm(tmp_path, visit, picker):
    opened = visit(page_of(tmp_path / "page.html", picker))
    page = opened.page
    hand = page.locator(".arm .hand")
    page.locator("input[id$=time]").press("Home")
    assert float(hand.get_attribute("cx")) == pytest.approx(230, abs=0.1)  # stretched out
    page.locator(".player button").click()
    page.wait_for_function("Number(document.querySelector('.arm .hand').getAttribute('cx')) < 229")
    page.locator(".player button", has_text="Pause").click()
    assert page.locator(".player button").inner_text() == "Play"
    page.locator("input[id$=time]").press("End")
    assert page.locator("output[for$=time]").inner_text() == "3.00\u00a0s"
    assert not opened.problems


@browser_test
def test_touch_drags_the_pad(tmp_path, browser, picker):
    context = browser.new_context(viewport={"width": 380, "height": 800}, has_touch=True)
    page = context.new_page()
    page.goto(page_of(tmp_path / "page.html", picker))
    page.wait_for_selector(".pad")
    page.evaluate(NEXT_FRAME)
    assert page.evaluate("document.documentElement.scrollWidth") <= 380
    box = page.locator(".pad .frame").bounding_box()
    client = context.new_cdp_session(page)
    x, y = box["x"] + 0.5 * box["width"], box["y"] + 0.5 * box["height"]
    touch = lambda kind, *points: client.send(  # noqa: E731
        "Input.dispatchTouchEvent",
        {"type": kind, "touchPoints": [{"x": a, "y": b} for a, b in points]},
    )
    touch("touchStart", (x, y))
    touch("touchMove", (x, y + 0.25 * box["height"]))
    touch("touchMove", (x, y + 0.3 * box["height"]))
    touch("touchEnd")
    page.evaluate(NEXT_FRAME)
    assert shown_values(page)[:2] == [pytest.approx(22.5, abs=0.3), pytest.approx(9, abs=0.3)]
    assert page.evaluate("scrollY") == 0  # the page did not take the drag
    context.close()


@browser_test
def test_sliders_of_two_widgets(tmp_path, visit):
    widget = make()
    opened = visit(page_of(tmp_path / "page.html", widget, make()))
    page = opened.page
    ids = page.evaluate("[...document.querySelectorAll('[id]')].map((el) => el.id)")
    assert len(ids) == len(set(ids)) >= 6
    first = page.locator(".ddlib-widget").first
    first.get_by_label("Gain").press("End")
    page.evaluate(NEXT_FRAME)
    assert first.locator(".slider output").first.inner_text() == "100\u00a0N m/rad"
    final = widget.interpolate(gain=100)["final"][0]
    shown = first.locator(".scalars output").inner_text().replace("−", "-").split()[0]
    assert float(shown) == pytest.approx(final, abs=0.006)
    second = page.locator(".ddlib-widget").nth(1)
    assert second.locator(".slider output").first.inner_text() == "10.0\u00a0N m/rad"
    page.wait_for_function("document.querySelector('.spoken').textContent.includes('Gain 100')")
    assert "Gain" not in second.locator(".spoken").inner_text()
    assert not opened.problems


@browser_test
def test_damaged_data_are_reported_in_place(tmp_path, visit):
    def damage(entry):
        entry["buffers"][0]["data"] = "AAAA" + entry["buffers"][0]["data"][4:]
        entry["buffers"][1]["data"] = entry["buffers"][0]["data"]

    opened = visit(page_of(tmp_path / "page.html", make(), change=damage))
    alert = opened.page.locator("[role=alert]")
    assert "damaged: " in alert.inner_text() and alert.count() == 1
    assert not opened.problems


# A kernel that answers, and one that does not: the same script with a live model.
SILENT = """<script>
{
  const blob = Blob;
  window.Blob = class extends blob {
    constructor([text], options) {
      const live = text.replace("export default { render };", `
      export default { render({ model, el }) {
        delete model.kernelless;
        model.save_changes = () => { if (window.alive) setTimeout(() => {
          const values = model.get("spec").parameters.map((p) => model.get(p.name));
          const exact = new DataView(new Float32Array(window.reply).buffer);
          model.set({ exact, answer: { request: model.get("request"), values } });
        }, 50); };
        return render({ model, el });
      } };`);
      super([live], options);
    }
  };
}
</script>"""


@browser_test
def test_kernel_that_answers_and_one_that_does_not(tmp_path, visit):
    widget = make()
    opened = visit(page_of(tmp_path / "page.html", widget, extra=SILENT))
    page = opened.page
    gain, root = page.get_by_label("Gain"), page.locator(".ddlib-widget")
    gain.press("ArrowRight")
    page.wait_for_selector(".note:not([hidden])", timeout=5000)
    assert page.locator(".note").inner_text() == (
        "The kernel does not answer: showing baked values."
    )
    assert root.get_attribute("data-values") == "interpolated"
    samples = len(widget.exact) // 4
    page.evaluate(f"window.alive = true; window.reply = Array({samples}).fill(1.25)")
    gain.press("ArrowRight")
    gain.press("ArrowRight")
    page.wait_for_selector("[data-values=exact]")
    page.wait_for_selector(".note[hidden]", state="attached")
    assert page.evaluate(READ, 0)[0] == pytest.approx([1.25] * 41, abs=0.01)
    assert not opened.problems
