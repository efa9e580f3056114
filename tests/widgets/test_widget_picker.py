"""The trajectory picker: its Python side, and in a browser without a kernel."""

from __future__ import annotations

import base64
import gzip
import json
from dataclasses import replace

import numpy as np
import pytest
from axe import violations
from traitlets import TraitError
from widget_pages import LIVE, NEXT_FRAME, PATHS, READ, page_of, saved, settings, shown_values

from ddlib.control import Feedforward, pd
from ddlib.dynamics import CMU_DD_ARM_II
from ddlib.metrics import rmss
from ddlib.setups import POSITION_FEEDBACK, STATE_FEEDBACK, WINDOWS, errors, predict
from ddlib.trajectories import APPENDIX_I
from ddlib.widgets import TrajectoryPicker
from ddlib.widgets.picker import AXIS
from workshop.report import results


@pytest.fixture(scope="module")
def picker():
    """Motion and rigid torques alone."""
    return TrajectoryPicker()


@pytest.fixture(scope="module")
def networks():
    return {f"window {w}": results.median_network(w) for w in WINDOWS}


@pytest.fixture(scope="module")
def full(networks):
    """With the networks of the chapter."""
    return TrajectoryPicker(networks)


def silent():
    """The set-up that records for the picker."""
    return replace(
        STATE_FEEDBACK, effects=STATE_FEEDBACK.effects.without("encoder", "torque_sensor")
    )


# Python


def test_extents_and_sliders_follow_each_other():
    picker = TrajectoryPicker()
    assert picker.extents_deg == tuple(APPENDIX_I[5]) and not picker.interpolates
    picker.extents_deg = (20, 30)
    assert (picker.shoulder_deg, picker.elbow_deg) == (20, 30) and picker.interpolates
    picker.elbow_deg = 40
    assert picker.extents_deg == (20, 40)
    picker.extents_deg = np.array([1.5, 2.5])
    assert picker.values == {"shoulder_deg": 1.5, "elbow_deg": 2.5}


@pytest.mark.parametrize(
    "bad, message",
    [
        ((20, 46), r"extents_deg must lie in \[0, 45\], got 46"),
        ((-1, 3), r"extents_deg must lie in \[0, 45\], got -1"),
        ((1, np.nan), "extents_deg must be finite, got NaN"),
        ((np.inf, 1), "extents_deg must be finite, got NaN or infinity"),
        (3, r"extents_deg must have a last axis of length 2, got shape \(\)"),
        ((1, 2, 3), r"extents_deg must have a last axis of length 2, got shape \(3,\)"),
        ([[1, 2]], r"extents_deg must have shape \(2,\), got \(1, 2\)"),
        ("ab", "extents_deg must be an array of real numbers, got 'ab'"),
        (None, "extents_deg must be an array of real numbers, got None"),
        ((True, 2), "extents_deg must be a single number, got True"),
        ((1, "x"), "extents_deg must be an array of real numbers"),
    ],
)
def test_bad_extents_name_value_and_range(picker, bad, message):
    before = picker.extents_deg
    with pytest.raises(TraitError, match=message):
        picker.extents_deg = bad
    assert picker.extents_deg == before == (picker.shoulder_deg, picker.elbow_deg)


@pytest.mark.parametrize("name", ["shoulder_deg", "elbow_deg"])
def test_bad_joint_extents_name_joint_value_and_range(picker, name):
    for bad in (45.1, -0.1):
        with pytest.raises(TraitError, match=rf"{name} must lie in \[0, 45\], got {bad}"):
            setattr(picker, name, bad)


def test_arm_and_status_are_read_only(picker):
    for name in ("arm", "record_status"):
        with pytest.raises(TraitError, match="read-only"):
            setattr(picker, name, {})


def test_python_computes_only_what_it_is_asked_for(networks):
    picker, calls = TrajectoryPicker(), []
    function = picker._baked.function
    picker._baked.function = lambda **values: calls.append(values) or function(**values)
    picker.set_state({"shoulder_deg": 3.0, "elbow_deg": 4.0, "request": 1})
    assert calls == [] and picker.exact == b""
    peak = picker.curves["peak shoulder"]
    assert calls == [{"shoulder_deg": 3.0, "elbow_deg": 4.0}] and 0 < peak[0] < 5


def test_recording_from_the_page():
    calls = []
    picker = TrajectoryPicker(on_record=lambda e: calls.append(e) or len(calls))
    picker._handle_custom_msg({"type": "record", "extents_deg": [10, 20.5]}, [])
    assert calls == [(10, 20.5)] and picker.recording == 1 and picker.elbow_deg == 20.5
    assert "Recorded 10.0° and 20.5°" in picker.record_status["text"]
    picker._handle_custom_msg({"type": "record", "extents_deg": [10, 99]}, [])
    assert len(calls) == 1 and "must lie in [0, 45], got 99" in picker.record_status["text"]
    picker._handle_custom_msg({"type": "something else"}, [])
    assert len(calls) == 1 and picker.record_status["count"] == 2


def test_recording_is_the_experiments():
    picker = TrajectoryPicker()
    expected = STATE_FEEDBACK.record(picker.extents_deg)
    np.testing.assert_array_equal(picker.record().tau, expected.tau)


def test_networks_are_those_of_median_test_error(networks):
    cells = results.read("table-4-1")["setups"][STATE_FEEDBACK.name]
    recording = STATE_FEEDBACK.record()
    for width, (name, network) in zip((11, 21, 41), networks.items(), strict=True):
        assert name == f"window {width}" and network.weights.width == width
        test = errors(network, recording).test
        assert test == pytest.approx(np.median(cells[str(width)]["errors"]["test"]), rel=1e-3)


def test_networks_see_what_the_simulator_records(full, networks):
    batch = silent().record(APPENDIX_I)
    deviation = batch.tau[:5, batch.motion].reshape(-1, 2).std(0)
    recording, curves = batch[5], full.curves
    torque = recording.tau[recording.motion]
    np.testing.assert_allclose(curves["elbow torque, recorded"][:-1], torque[::4, 1])
    for name, network in networks.items():
        predicted = predict(network, recording)
        np.testing.assert_allclose(curves[f"shoulder torque, {name}"][:-1], predicted[::4, 0])
        error = rmss(predicted, torque, scale=deviation)
        assert curves[f"RMSS, {name}"][0] == pytest.approx(error)


def test_no_table_and_a_light_page(full, networks):
    """With the table of before it was 480 kB, of which 240 kB could not be compressed."""
    assert full.baked_bytes == 0 and full.spec["live"] and not full.spec["groups"]
    count = sum(sum(x.size for x in vars(m.weights).values()) for m in networks.values())
    assert len(full.weights) == 4 * count
    state = json.dumps(saved(full)["state"][full.model_id]).encode()
    assert len(state) < 200_000 and len(gzip.compress(state, 6)) < 60_000


def test_the_map_is_of_the_exact_errors(full, picker):
    assert full.map["side"] == AXIS.size and AXIS[[0, -1]].tolist() == [0, 45]
    for i, j in ((0, 0), (12, 4), (30, 30), (3, 29)):
        exact = full.interpolate(shoulder_deg=AXIS[i], elbow_deg=AXIS[j])
        for name, digits in full.map["errors"].items():
            assert len(digits) == 2 * AXIS.size**2
            at = 2 * (j * AXIS.size + i)
            error = exact[f"RMSS, {name}"][0]
            assert int(digits[at : at + 2], 36) / 100 == pytest.approx(error, abs=0.0051)
            assert full.numbers[f"RMSS, {name}"][i, j] == pytest.approx(error, rel=1e-9)
        peak = picker.numbers["peak elbow"][i, j]
        assert peak == pytest.approx(exact["peak elbow"][0], rel=1e-9)
    assert picker.map["errors"] == {} and set(picker.numbers) == {"peak shoulder", "peak elbow"}


def test_without_sensors_errors_are_much_the_same(full, networks):
    recording = STATE_FEEDBACK.record()
    for name, network in networks.items():
        noisy = errors(network, recording).by_training_deviation
        assert full.curves[f"RMSS, {name}"][0] == pytest.approx(noisy, rel=0.02)


def test_ranges_are_those_of_the_square(full):
    """Axes and decimals follow them."""
    low, high = ({c["name"]: c[end] for c in full.spec["curves"]} for end in ("low", "high"))
    assert low["elbow angle"] == pytest.approx(-45, abs=0.02) and high["elbow angle"] == 0
    for values in settings(full, 5, seed=2):
        for name, curve in full.interpolate(**values).items():
            wide = 0.02 * (high[name] - low[name])
            assert low[name] - wide <= curve.min() and curve.max() <= high[name] + wide


def test_controllers_that_the_page_does_not_have_are_refused(networks):
    setup = replace(STATE_FEEDBACK, controller=Feedforward(CMU_DD_ARM_II, pd((1, 1), (1, 1))))
    with pytest.raises(TypeError, match="controller must be a PID"):
        TrajectoryPicker(networks, setup)


@pytest.mark.parametrize("bad", [lambda e: 0, 3, "ensemble"])
def test_models_must_be_single_networks(networks, bad):
    if bad == "ensemble":
        bad = type(networks["window 11"]).load(results.networks_path("state feedback", 11))
    with pytest.raises(TypeError, match="models must be single networks by name, got mine"):
        TrajectoryPicker({"mine": bad})
    with pytest.raises(TypeError, match="models must be single networks by name, got recorded"):
        TrajectoryPicker({"recorded": networks["window 11"]})
    with pytest.raises(TypeError, match="on_record must be callable, got 3"):
        TrajectoryPicker(on_record=3)


# In a page without a kernel

browser_test = pytest.mark.browser


def assert_drawn(page, widget, extents):
    """The charts show what Python computes, as well as a chart can."""
    exact = widget.interpolate(**dict(zip(("shoulder_deg", "elbow_deg"), extents)))
    for number, panel in enumerate(widget.spec["panels"]):
        drawn = page.evaluate(READ, number)
        for (name, _), got in zip(panel["curves"], drawn, strict=True):
            wide = max(np.ptp(exact[name]) for name, _ in panel["curves"])
            np.testing.assert_allclose(got, exact[name], atol=0.002 * wide + 0.02, err_msg=name)
    shown = page.locator(".scalars output").all_inner_texts()
    for scalar, text in zip(widget.spec["scalars"], shown, strict=True):
        got = float(text.split()[0].replace("−", "-"))
        assert got == pytest.approx(exact[scalar["name"]][0], abs=0.0051)


SEEN = """() => {
  const { curves, log } = document.querySelector(".ddlib-picker").picker.picked;
  return [Object.fromEntries(Object.entries(curves).map(([name, x]) => [name, [...x]])), log];
}"""


@browser_test
@pytest.mark.parametrize("extents", [(39.5, 14.4), (45, 45), (0, 0), (0, 31.5), (12.3, 3.3)])
def test_the_page_computes_what_ddlib_does(extents, tmp_path, visit, full):
    """Angles to 1e-6 rad, torques and errors to a millionth of their size."""
    query = "shoulder_deg:{},elbow_deg:{}".format(*extents)
    page = visit(f"{page_of(tmp_path / 'page.html', full)}?trajectory-picker={query}").page
    curves, log = page.evaluate(SEEN)
    known = full.interpolate(shoulder_deg=extents[0], elbow_deg=extents[1])
    assert set(curves) == set(known)
    for name, values in known.items():
        small = np.rad2deg(1e-6) if "angle" in name else 1e-6 * np.abs(values).max() + 1e-9
        np.testing.assert_allclose(curves[name], values, rtol=0, atol=small, err_msg=name)
    recording = silent().record([extents])[0]
    np.testing.assert_allclose(log["reading"], recording.q, rtol=0, atol=1e-6)
    largest = np.abs(recording.tau).max(0) + 1e-3
    assert (np.abs(log["tau"] - recording.tau) <= 1e-6 * largest).all()
    assert page.locator(".ddlib-picker").get_attribute("data-values") == "computed"


@browser_test
def test_another_setup_is_computed_as_well(tmp_path, visit):
    """The page takes arm, friction and gains from the set-up, not from the book's default."""
    network = results.median_network(21, POSITION_FEEDBACK.name)
    widget = TrajectoryPicker({"mine": network}, POSITION_FEEDBACK)
    page = visit(page_of(tmp_path / "page.html", widget)).page
    curves, _ = page.evaluate(SEEN)
    known, other = widget.curves, TrajectoryPicker({"mine": network}).curves
    for name in ("shoulder torque, recorded", "elbow torque, mine", "RMSS, mine"):
        small = 1e-6 * np.abs(known[name]).max()
        np.testing.assert_allclose(curves[name], known[name], rtol=0, atol=small)
        assert np.abs(known[name] - other[name]).max() > 1e3 * small


@browser_test
@pytest.mark.parametrize("width", [390, 704, 850, 940, 1264])
def test_all_charts_have_the_same_room(width, tmp_path, browser, full):
    page = browser.new_page(viewport={"width": width, "height": 800})
    page.goto(page_of(tmp_path / "page.html", full))
    page.wait_for_selector(".curve[d]", state="attached")
    page.evaluate(NEXT_FRAME)
    boxes = [chart.bounding_box() for chart in page.locator(".chart").all()]
    assert len({round(box["width"]) for box in boxes}) == 1
    assert len({round(box["height"] / 30) for box in boxes}) <= 2  # a legend of two lines
    assert len({round(box["y"]) for box in boxes}) == (1 if width > 1000 else 3)
    page.close()


@browser_test
def test_random_extents_look_as_python_computes(tmp_path, visit, full):
    opened = visit(page_of(tmp_path / "page.html", full))
    page = opened.page
    assert_drawn(page, full, APPENDIX_I[5])
    for values in settings(full, 8, seed=6):
        steps = {name: round(2 * value) for name, value in values.items()}  # of half a degree
        for name, step in steps.items():
            page.locator(f"input[id$={name}]").fill(str(step))
        page.evaluate(NEXT_FRAME)
        assert_drawn(page, full, [step / 2 for step in steps.values()])
    assert not opened.problems


@browser_test
def test_drag_and_keys(tmp_path, visit, full):
    opened = visit(page_of(tmp_path / "page.html", full))
    page = opened.page
    before = page.evaluate(PATHS)
    assert len(before) == 12 and all(before)
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
    assert_drawn(page, full, (9.5, 40.0))
    assert page.locator(".record button").is_disabled()
    assert "kernel" in page.locator(".record p").inner_text()
    assert not opened.problems


@browser_test
@pytest.mark.parametrize(
    ("width", "height"),
    [(390, 700), (704, 800), (1264, 800)],  # phone; the pages' text at 1280 px; JupyterLab
)
def test_errors_stand_beside_the_pad(width, height, tmp_path, browser, full):
    """The handle and all numbers are in view at once, and change while it is dragged."""
    context = browser.new_context(viewport={"width": width, "height": height})
    page = context.new_page()
    page.goto(page_of(tmp_path / "page.html", full, extra='<div style="height: 900px"></div>'))
    page.wait_for_selector(".pad")
    page.evaluate(NEXT_FRAME)
    pad, numbers = page.locator(".pad .frame"), page.locator(".scalars output")
    pad.evaluate("(el) => scrollBy(0, el.getBoundingClientRect().top - 60)")
    assert numbers.count() == len(full.spec["scalars"]) == 5
    before = numbers.all_inner_texts()
    box = pad.bounding_box()
    for output in numbers.all():
        place = output.bounding_box()
        assert 0 <= place["y"] and place["y"] + place["height"] <= height
        assert 0 <= place["x"] and place["x"] + place["width"] <= width
        if width > 600:
            assert place["x"] > box["x"] + box["width"]  # to the right of the pad,
            assert place["y"] < box["y"] + box["height"]  # not below it
    page.mouse.move(box["x"] + 0.9 * box["width"], box["y"] + 0.7 * box["height"])
    page.mouse.down()
    page.mouse.move(box["x"] + 0.3 * box["width"], box["y"] + 0.8 * box["height"], steps=3)
    page.evaluate(NEXT_FRAME)
    assert all(a != b for a, b in zip(before, numbers.all_inner_texts(), strict=True))
    page.mouse.up()
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    context.close()


@browser_test
def test_a_drag_near_a_trajectory_ends_on_it(tmp_path, visit, full):
    opened = visit(page_of(tmp_path / "page.html", full))
    page = opened.page
    box = page.locator(".pad .frame").bounding_box()

    def drag_to(shoulder, elbow):
        x, y = box["x"] + shoulder / 45 * box["width"], box["y"] + (1 - elbow / 45) * box["height"]
        page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
        page.mouse.down()
        page.mouse.move(x, y, steps=3)
        page.mouse.up()
        page.evaluate(NEXT_FRAME)
        return shown_values(page)[:2]

    for k, extents in enumerate(APPENDIX_I.tolist(), 1):
        inward = [x - 0.9 if x > 22 else x + 0.9 for x in extents]
        assert drag_to(*inward) == [round(x, 1) for x in extents]
        button = page.get_by_role("button", name=str(k), exact=True)
        assert button.get_attribute("aria-pressed") == "true"
    near = drag_to(extents[0] - 3, extents[1])
    assert near[0] == pytest.approx(extents[0] - 3, abs=0.4)
    page.get_by_role("button", name="3", exact=True).click()
    page.evaluate(NEXT_FRAME)
    assert shown_values(page)[:2] == [round(x, 1) for x in APPENDIX_I[2]]


@browser_test
def test_the_map_shows_the_errors_of_one_network(tmp_path, visit, full):
    opened = visit(page_of(tmp_path / "page.html", full))
    page = opened.page
    at = """([x, y]) => {
      const [frame, svg] = [document.querySelector('.pad .frame'), document.querySelector('.pad')];
      const get = (name) => Number(frame.getAttribute(name));
      const point = svg.createSVGPoint();
      point.x = get('x') + x * get('width');
      point.y = get('y') + (1 - y) * get('height');
      return [...svg.querySelectorAll('.under .level')].findIndex((p) => p.isPointInFill(point));
    }"""
    names = ("window 11", "window 41")
    for name in names:
        page.get_by_role("button", name=name).click()
        levels = []
        for extents in ([40.3, 5.1], [22.3, 41.2], [10.3, 30.1]):
            values = dict(zip(("shoulder_deg", "elbow_deg"), extents))
            error = full.interpolate(**values)[f"RMSS, {name}"][0]
            got = page.evaluate(at, [x / 45 for x in extents])
            assert abs(got + 0.5 - min(error / 0.1, 9.5)) <= 0.75, (name, extents)
            levels.append(got)
        assert len(set(levels)) > 1
    page.wait_for_function("location.search.includes('map:window%252041')")
    page.get_by_role("button", name="none").click()
    assert page.evaluate(at, [0.5, 0.5]) == -1 and not opened.problems


@browser_test
def test_touch_drags_the_pad(tmp_path, browser, full):
    context = browser.new_context(viewport={"width": 380, "height": 800}, has_touch=True)
    page = context.new_page()
    page.goto(page_of(tmp_path / "page.html", full))
    page.wait_for_selector(".pad")
    page.evaluate(NEXT_FRAME)
    before = page.evaluate(PATHS)
    assert page.evaluate("document.documentElement.scrollWidth") <= 380
    box = page.locator(".pad .frame").bounding_box()
    handle = page.locator(".handle circle").first.bounding_box()
    client = context.new_cdp_session(page)
    x, y = handle["x"] + handle["width"] / 2, handle["y"] + handle["height"] / 2

    def touch(kind, *points):
        where = [{"x": a, "y": b} for a, b in points]
        client.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": where})

    touch("touchStart", (x, y))
    touch("touchMove", (x, y + 0.1 * box["height"]))
    touch("touchMove", (x, y + 0.2 * box["height"]))
    touch("touchEnd")
    page.evaluate(NEXT_FRAME)
    assert shown_values(page)[:2] == [pytest.approx(39.5, abs=0.3), pytest.approx(5.4, abs=0.3)]
    pairs = list(zip(before, page.evaluate(PATHS)))
    assert all(a != b for a, b in pairs[1:])  # the shoulder's angle may stay: straight down
    assert page.evaluate("scrollY") == 0  # the page did not take the drag
    context.close()


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
def test_reduced_motion_shows_poses(tmp_path, browser, picker):
    context = browser.new_context(reduced_motion="reduce")
    page = context.new_page()
    page.goto(page_of(tmp_path / "page.html", picker))
    page.locator("input[id$=time]").press("Home")
    page.evaluate("""() => {
      window.seen = new Set();
      const output = document.querySelector("output[for$=time]");
      new MutationObserver(() => seen.add(output.textContent)).observe(output, {childList: true});
    }""")
    page.locator(".player button").click()
    page.wait_for_function("[...seen].some((text) => text.startsWith('1.50'))")
    shown = {float(text.split("\u00a0")[0]) for text in page.evaluate("[...seen]")}
    assert shown <= {0, 0.5, 1, 1.5, 2}
    context.close()


@browser_test
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_accessible(tmp_path, visit, scheme, full):
    assert not violations(visit(page_of(tmp_path / "page.html", full), scheme).page)


@browser_test
def test_recording_asks_the_kernel(tmp_path, visit, picker):
    opened = visit(page_of(tmp_path / "page.html", picker, extra=LIVE))
    page = opened.page
    button, said = page.locator(".record button"), page.locator(".record p")
    button.click()
    assert page.evaluate("kernel.sent") == [
        {"type": "record", "extents_deg": APPENDIX_I[5].tolist()}
    ]
    assert button.is_disabled() and said.inner_text() == "Recording…"
    page.evaluate("kernel.model.set('record_status', {text: 'Recorded.', count: 1})")
    assert button.is_enabled() and said.inner_text() == "Recorded."
    page.evaluate("kernel.closed = true")
    button.click()
    assert said.inner_text() == "The kernel does not answer: nothing was recorded."
    assert button.is_enabled() and not opened.problems


@browser_test
def test_damaged_arm_is_reported_in_place(tmp_path, visit, picker):
    def change(entry):
        del entry["state"]["arm"]

    opened = visit(page_of(tmp_path / "page.html", picker, change=change))
    alert = opened.page.locator("[role=alert]")
    assert alert.count() == 1 and "are damaged: " in alert.inner_text()
    assert not opened.problems


@browser_test
def test_damaged_networks_are_reported_in_place(tmp_path, visit, full):
    def shortened(entry):
        where = next(b for b in entry["buffers"] if b["path"] == ["weights"])
        where["data"] = base64.b64encode(base64.b64decode(where["data"])[:-4]).decode()

    def gone(entry):
        entry["buffers"] = [b for b in entry["buffers"] if b["path"] != ["weights"]]

    def no_plant(entry):
        del entry["state"]["loop"]["plant"]

    damages = (shortened, gone, no_plant)
    opened = visit(page_of(tmp_path / "page.html", full, damages=damages))
    assert opened.page.locator("[role=alert]:visible").count() == len(damages)
    assert opened.page.locator(".ddlib-picker").count() == 1 and not opened.problems
