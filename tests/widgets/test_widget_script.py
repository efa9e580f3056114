"""The widgets' script: in Node against Python, and in a browser without a kernel."""

from __future__ import annotations

import base64
import json
import os
import shutil
import subprocess

import numpy as np
import pytest
from widget_pages import NEXT_FRAME, PATHS, READ, page_of, settings
from widget_samples import T, make, make_kinds, parameters, wave

from ddlib.widgets import CurveWidget, Pad, Panel, Parameter

CI = os.environ.get("CI", "").lower() in {"1", "true"}


@pytest.fixture(scope="module")
def waves():
    return make_kinds()


# In Node


@pytest.fixture(scope="module")
def node():
    path = shutil.which("node")
    if path is None:
        (pytest.fail if CI else pytest.skip)("no Node.js found: install nodejs")
    return path


SCRIPT = """
import fs from "node:fs";
const [module, input] = process.argv.slice(2);
const { interpolate, readTables, insidePolygon, fromFraction, toFraction, ticks, around } =
  await import(module);
const { spec, baked, settings, points } = JSON.parse(fs.readFileSync(input));
const bytes = Uint8Array.from(Buffer.from(baked, "base64"));
const tables = readTables(spec, new DataView(bytes.buffer));
const ranged = spec.parameters.map((p, k) => [p, k]).filter(([p]) => !p.options);
console.log(JSON.stringify({
  curves: settings.map((values) => [...interpolate(spec, tables, values)]),
  inside: points.map((p) => insidePolygon(spec.pad?.region ?? [], ...p)),
  back: settings.map((v) => ranged.map(([p, k]) => fromFraction(p, toFraction(p, v[k])))),
  ticks: [[-4, 4, 3], [0, 1, 2], [-0.35, 7.2, 4]].map((t) => ticks(...t)),
  around: [[-3.4, 8.1], [0, 0], [5, 5], [0.2, 30, true]].map((a) => around(...a)),
}));
"""


def run_script(node, folder, widget, chosen, points=()):
    data = {
        "spec": widget.spec,
        "baked": base64.b64encode(widget.baked).decode(),
        "settings": [list(values.values()) for values in chosen],
        "points": points,
    }
    files = {"in.json": json.dumps(data), "run.mjs": SCRIPT, "widget.mjs": widget._esm}
    for name, text in files.items():
        (folder / name).write_text(text, encoding="utf-8")
    command = [node, "run.mjs", (folder / "widget.mjs").as_uri(), "in.json"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def assert_same(out, widget, chosen):
    for values, got in zip(chosen, out["curves"], strict=True):
        expected = np.concatenate(list(widget.interpolate(**values).values()))
        np.testing.assert_allclose(got, expected, atol=1e-9)


def test_script_interpolates_as_python_does(node, tmp_path):
    region = [(0, 0), (1, -1), (2, 1)]
    widget = make(tolerance=1, pad=Pad("decay", "phase", (), region))
    corners = ([1, 0, -1], [100, 2, 1], [10, 1, 0])
    ends = [{p.name: x for p, x in zip(parameters(), corner)} for corner in corners]
    chosen = [*settings(widget, 30), *ends]
    points = [(1, 0), (0.1, 0.5), (2, 1), (1.9, -1)]
    out = run_script(node, tmp_path, widget, chosen, points)
    assert_same(out, widget, chosen)
    np.testing.assert_allclose(out["back"], [list(v.values()) for v in chosen], atol=1e-9)
    assert out["inside"] == [True, False, True, False]
    assert out["ticks"][0] == [-4, -2, 0, 2, 4] and out["ticks"][1] == [0, 0.5, 1]
    assert out["around"] == [[-5, 10], [0, 0.25], [4, 6], [0.1, 100]]


def test_script_reads_choices_and_numbers_of_one_byte(node, tmp_path, waves):
    a, b = Parameter("a", "a", 0, 3, 1, grid=60), np.arange(30)
    fading = np.exp(-0.3 * b[:, None] * (1 + T))
    panel = Panel("y", "y", "x", T)
    faint = CurveWidget(lambda a: {"y": np.cos(b * a) @ fading}, [a], [panel], alt="a")
    (group,) = faint.spec["groups"]
    assert 0 < group["wide"] < group["rank"]
    for widget in (waves, faint):
        chosen = list(settings(widget, 40))
        assert_same(run_script(node, tmp_path, widget, chosen), widget, chosen)


# In a page without a kernel

pytestmark = pytest.mark.browser


def test_every_control_of_a_choice(tmp_path, visit, waves):
    opened = visit(page_of(tmp_path / "page.html", waves))
    page = opened.page
    drawn = [page.evaluate(PATHS)]

    def changed():
        page.evaluate(NEXT_FRAME)
        drawn.append(page.evaluate(PATHS))
        return drawn[-1] != drawn[-2]

    page.get_by_label("Shape").select_option(label="a cosine")
    assert changed()
    page.get_by_role("switch", name="Twice as much").press("Space")
    assert changed() and page.locator(".switch output").inner_text() == "on"
    encoder = page.get_by_label("Encoder")
    encoder.press("ArrowLeft")
    assert changed() and encoder.get_attribute("aria-valuetext") == "3 bits"
    page.get_by_label("Gain").press("End")
    assert changed()
    exact = wave(5, "cosine", True, 3)
    line = page.evaluate(READ, 0)
    np.testing.assert_allclose(line[1], exact["y"], atol=0.06)
    np.testing.assert_allclose(line[0], 1, atol=0.06)  # the fixed curve is drawn first
    stems = page.evaluate(READ, 1)
    np.testing.assert_allclose(stems[1], exact["taps"], atol=0.2)
    assert not opened.problems
