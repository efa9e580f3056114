"""The thrown arm: its world against ddlib, and its page by pointer, touch and keyboard."""

from __future__ import annotations

import numpy as np
import pytest
from axe import violations_in
from widget_pages import NEXT_FRAME, page_of

from ddlib.analysis import shares
from ddlib.analysis.filters import savitzky_golay
from ddlib.control import Feedforward, pd
from ddlib.dynamics import CMU_DD_ARM_II
from ddlib.learning import sliding_windows
from ddlib.setups import JOINT_DAMPING, KD, KP, POSITION_FEEDBACK, STATE_FEEDBACK, Setup
from ddlib.trajectories import APPENDIX_I
from ddlib.widgets import ThrownArm, module
from ddlib.widgets.engine import plain
from ddlib.widgets.engine.throw import REST
from workshop.report import results

WORLD = """([spec, weights, moves]) => {
  const world = worldOf(spec, weights);
  for (const [act, argument, periods] of moves) {
    world[act](argument);
    for (let k = 0; k < periods; k++) world.period();
  }
  return world.samples.map((s) => ({ ...s, hidden: [...(s.hidden ?? [])], output: null }));
}"""


@pytest.fixture(scope="module")
def widget():
    return ThrownArm()


@pytest.fixture(scope="module")
def evaluate(browser):
    page = browser.new_page()
    page.add_script_tag(content=plain.source() + module("world.js"))
    yield page.evaluate
    page.close()


def given(widget):
    return [widget.spec, np.frombuffer(widget.weights, "<f4").tolist()]


def column(samples, name):
    return np.array([s[name] for s in samples])


# The world


@pytest.mark.browser
@pytest.mark.parametrize(
    "setup", [JOINT_DAMPING, STATE_FEEDBACK, POSITION_FEEDBACK], ids=lambda setup: setup.name
)
def test_a_played_motion_is_that_of_the_simulator(evaluate, setup):
    model = results.networks(21, setup.name)[3]
    widget = ThrownArm(model, setup)
    silent = setup.effects.without("torque_sensor")
    known = setup.record(APPENDIX_I[[5]], effects=silent, rest=REST)[0]
    periods = 5 * len(known.t)
    samples = evaluate(WORLD, [*given(widget), [["play", 0, periods]]])
    last = slice(-len(samples), None)
    np.testing.assert_allclose(column(samples, "q"), known.q[last], atol=1e-6)
    np.testing.assert_allclose(column(samples, "tau"), known.tau_true[last], atol=1e-4)
    np.testing.assert_allclose(column(samples, "v"), known.qd_true[last], atol=1e-5)
    seen = samples[10:-10]
    windows = sliding_windows(known.q[last], 21)
    hidden = model.weights.activity(model.scaled(windows))[0]
    assert len(seen) == len(windows) > 300
    np.testing.assert_allclose(column(seen, "net"), model.torque(windows), atol=1e-4)
    np.testing.assert_allclose(column(seen, "hidden"), hidden, atol=1e-6)
    rate, bend = (savitzky_golay(21, k, 0.01, degree=k + 1) for k in (1, 2))
    np.testing.assert_allclose(column(seen, "rates"), windows @ rate, atol=1e-6)
    np.testing.assert_allclose(column(seen, "bends"), windows @ bend, atol=1e-4)


@pytest.mark.browser
def test_a_throw_is_the_pull_and_then_friction_alone(evaluate, widget):
    """A force at the hand does the work that the arm gains and friction takes."""
    pull = [["hold", {"push": [0.6, -0.8]}, 150], ["release", None, 1000]]
    samples = evaluate(WORLD, [*given(widget), pull])
    q, v, tau = (column(samples, name) for name in ("q", "v", "tau"))
    assert np.abs(tau[31:]).max() == 0 and np.abs(tau[:30]).max() > 5
    arm = CMU_DD_ARM_II
    force = np.array([0.6, -0.8]) * widget.spec["force"]
    hand = arm.forward_kinematics(q)[:, 1]
    pulled = (hand[30] - hand[0]) @ force
    energy = arm.kinetic_energy(q, v)
    friction = JOINT_DAMPING.effects.friction_torque(v)
    lost = np.cumsum((friction * v).sum(-1)) * 0.01
    assert energy[30] == pytest.approx(pulled - lost[30], rel=0.1)
    assert energy[60] < energy[30] and np.abs(v[-1]).max() < 0.01


@pytest.mark.browser
def test_the_button_throws_within_the_training(evaluate, widget):
    """From the start and back: the network's error stays well below the torque."""
    throws = [["stand", [0, 0], 150], ["toss", None, 900], ["toss", None, 650]]
    samples = evaluate(WORLD, [*given(widget), throws])
    seen = [s for s in samples if "net" in s]
    q = column(samples, "q")
    assert np.ptp(q, axis=0).min() > np.deg2rad(20)
    low, high = results.networks(21, JOINT_DAMPING.name).inputs.low, np.deg2rad(6)
    assert (q > low).all() and (q < high).all()
    error = column(seen, "net") - column(seen, "tau")
    spread = np.sqrt((column(seen, "tau") ** 2).mean(0))
    assert (np.sqrt((error**2).mean(0)) < 0.5 * spread).all()


@pytest.mark.browser
def test_weights_fold_into_a_line_and_a_parabola(evaluate):
    weights = results.networks(21).weights.hidden_weights[2, :, 0]
    n = np.arange(-10, 11)
    for f in weights:
        got = evaluate("(f) => folded(f)", f.tolist())
        whole = np.sum([got["line"], got["parabola"], got["left"]], axis=0)
        np.testing.assert_allclose(whole, f, atol=1e-12)
        np.testing.assert_allclose(got["shares"], shares(f)[1:3], atol=1e-9)
        assert np.ptp(np.diff(got["line"])) < 1e-9
        assert np.ptp(np.diff(got["parabola"], 2)) < 1e-9
        left = np.array(got["left"])
        assert np.abs([left @ n, left @ (n**2 - (n**2).mean())]).max() < 1e-9


# The widget


def test_the_network_shown_is_the_median_one(widget):
    errors = results.read("table-4-1")["setups"][JOINT_DAMPING.name]["21"]["errors"]["test"]
    weights = results.networks(21, JOINT_DAMPING.name)[int(np.argsort(errors)[12])]
    assert widget.weights == plain.weight_bytes(weights)
    found = shares(weights.weights.hidden_weights)
    line, parabola = widget.spec["units"]
    assert found[line["unit"], line["joint"], 1] == found[..., 1].max() > 0.8
    assert found[parabola["unit"], parabola["joint"], 2] == found[..., 2].max() > 0.8


def test_the_whole_figure_is_small(widget):
    assert len(widget._esm.encode()) + len(widget.weights) < 40_000
    assert not any(line.startswith((" ", "//")) for line in widget._esm.splitlines())
    assert widget.still and "trajectory 6" in widget.still_alt


def test_texts_stay_within_a_line():
    """What makes it right to strip every line."""
    script = module(*plain.ENGINE, "world.js", "running.js", "inside.js", "throw.js")
    assert all(line.count("`") % 2 == 0 for line in script.splitlines())


@pytest.mark.parametrize(
    "options, error, words",
    [
        ({"model": results.networks(21)}, TypeError, "single network"),
        ({"setup": Setup("other", Feedforward(CMU_DD_ARM_II, pd(KP, KD)))}, TypeError, "PID"),
    ],
)
def test_bad_arguments_are_refused(options, error, words):
    with pytest.raises(error, match=words):
        ThrownArm(**{"model": results.networks(21)[0], **options})


# In a page without a kernel


STATE = """() => {
  const { world } = document.querySelector(".ddlib-throw");
  return { mode: world.mode, q: [...world.angles()], count: world.count, hand: world.places()[1] };
}"""
CALM = {"reduced_motion": "reduce"}


def until(page, holds: str):
    """Wait until something holds of `world`, however slow the machine."""
    world = "document.querySelector('.ddlib-throw').world"
    page.wait_for_function(f"(({{ world }}) => {holds})({{ world: {world} }})")


def said(page) -> str:
    return page.locator(".said").inner_text()


def handle_at(page):
    box = page.locator(".hand-handle .dot").bounding_box()
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2


@pytest.mark.browser
def test_it_stands_still_until_asked(tmp_path, visit, widget):
    opened = visit(page_of(tmp_path / "page.html", widget), **CALM)
    page = opened.page
    page.wait_for_timeout(300)
    before = page.evaluate(STATE)
    page.wait_for_timeout(300)
    assert page.evaluate(STATE) == before and "Paused on trajectory 6" in said(page)
    page.get_by_role("button", name="Play").click()
    until(page, f"world.mode === 'play' && world.count > {before['count'] + 20}")
    assert "trajectory 6" in said(page)
    page.get_by_role("button", name="Pause").click()
    paused = page.evaluate(STATE)
    page.wait_for_timeout(200)
    assert page.evaluate(STATE) == paused and said(page) == "Paused."
    assert not opened.problems


@pytest.mark.browser
def test_once_in_view_a_motion_greets(tmp_path, visit, widget):
    page = visit(page_of(tmp_path / "page.html", widget)).page
    until(page, "world.mode === 'play'")


@pytest.mark.browser
def test_the_hand_is_pulled_by_pointer(tmp_path, visit, widget):
    opened = visit(page_of(tmp_path / "page.html", widget), **CALM)
    page = opened.page
    page.get_by_role("button", name="Reset").click()
    page.evaluate(NEXT_FRAME)
    x, y = handle_at(page)
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x - 60, y + 120, steps=4)
    until(page, "world.mode === 'held' && world.places()[1][1] < -0.02")
    held = page.evaluate(STATE)
    assert page.locator(".rope").get_attribute("visibility") == "visible"
    page.mouse.up()
    assert page.evaluate(STATE)["mode"] == "free" and "friction" in said(page)
    until(page, f"world.places()[1][1] !== {held['hand'][1]}")
    page.get_by_role("button", name="Reset").click()
    page.evaluate(NEXT_FRAME)
    assert page.evaluate(STATE)["q"] == [0, 0]
    assert not opened.problems


@pytest.mark.browser
def test_the_hand_is_pulled_by_keys(tmp_path, visit, widget):
    page = visit(page_of(tmp_path / "page.html", widget), **CALM).page
    page.get_by_role("button", name="Reset").click()
    page.get_by_role("application", name="arrow keys").focus()
    page.keyboard.down("ArrowDown")
    until(page, "world.mode === 'held' && world.places()[1][1] < -0.01")
    page.keyboard.up("ArrowDown")
    until(page, "world.mode === 'free'")  # a key pulls for some time at least
    page.keyboard.down("ArrowLeft")
    page.keyboard.press("Tab")  # leaves the hand
    assert page.evaluate(STATE)["mode"] == "free"
    assert page.evaluate("document.activeElement.textContent") in ("Play", "Pause")


@pytest.mark.browser
def test_touch_pulls_the_hand_and_scrolls_elsewhere(tmp_path, browser, widget):
    context = browser.new_context(
        viewport={"width": 390, "height": 600}, has_touch=True, is_mobile=True, **CALM
    )
    page = context.new_page()
    page.goto(page_of(tmp_path / "page.html", widget))
    page.wait_for_selector(".ddlib-throw")
    page.evaluate(NEXT_FRAME)
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    devtools = context.new_cdp_session(page)

    def swipe(x, y, dy):
        touch = {"type": "touchStart", "touchPoints": [{"x": x, "y": y}]}
        devtools.send("Input.dispatchTouchEvent", touch)
        for k in range(1, 9):
            moved = {"type": "touchMove", "touchPoints": [{"x": x, "y": y + dy * k / 8}]}
            devtools.send("Input.dispatchTouchEvent", moved)
            page.wait_for_timeout(30)
        state = page.evaluate(STATE)
        devtools.send("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})
        return state

    x, y = handle_at(page)
    assert swipe(x, y, -100)["mode"] == "held"
    assert page.evaluate("scrollY") == 0
    page.get_by_role("button", name="Reset").click()
    page.evaluate(NEXT_FRAME)
    box = page.locator(".stage").bounding_box()
    assert swipe(box["x"] + 60, box["y"] + box["height"] / 2, -150)["mode"] == "free"
    assert page.evaluate("scrollY") > 50
    context.close()


@pytest.mark.browser
def test_looking_inside(tmp_path, visit, widget):
    opened = visit(page_of(tmp_path / "page.html", widget), **CALM)
    page = opened.page
    look = page.get_by_role("button", name="Look inside")
    assert look.get_attribute("aria-expanded") == "false"
    look.click()
    assert look.get_attribute("aria-expanded") == "true"
    titles = page.locator(".fold-row .title").all_inner_texts()
    found = shares(results.median_network(21, JOINT_DAMPING.name).weights.hidden_weights)
    line, parabola = (
        round(100 * found[u["unit"], u["joint"], k]) for k, u in enumerate(widget.spec["units"], 1)
    )
    assert titles[0] == "what is left" and titles[2] == f"a line: {line} %"
    page.get_by_role("button", name="closest to a parabola").click()
    assert page.locator(".fold-row .title").all_inner_texts()[4] == f"a parabola: {parabola} %"
    slider = page.get_by_label("Fold")
    slider.press("Home")
    assert page.locator(".fold-row .title").first.inner_text() == "weights"
    painted = "() => document.querySelectorAll('.inside canvas')[4].toDataURL()"
    flat = page.evaluate(painted)
    slider.press("End")
    assert page.evaluate(painted) != flat
    assert not opened.problems + violations_in(page, "light", "dark")


@pytest.mark.browser
def test_inside_at_rest_there_is_a_hint_and_a_way_on(tmp_path, visit, widget):
    """The stems of line and parabola are there, and a button moves the arm, by keyboard, too."""
    page = visit(page_of(tmp_path / "page.html", widget), **CALM).page
    page.get_by_role("button", name="Look inside").click()
    hint = page.locator(".hint")
    assert not hint.is_visible()  # paused in the middle of a motion
    page.get_by_role("button", name="Reset").click()
    hint.wait_for(state="visible")
    drawn = "() => [2, 4].map((k) => document.querySelectorAll('.inside canvas')[k].toDataURL())"
    blank = "document.createElement('canvas').toDataURL()"
    assert page.evaluate(blank) not in page.evaluate(drawn)
    hint.get_by_role("button").press("Enter")
    hint.wait_for(state="hidden")
    assert page.evaluate(STATE)["mode"] == "tossed"
    assert page.evaluate("document.activeElement.textContent") == "Look inside"


@pytest.mark.browser
def test_link_and_code_take_the_motion_along(tmp_path, visit, widget, capsys):
    url = page_of(tmp_path / "page.html", widget)
    opened = visit(f"{url}?thrown-arm=motion:2&other=1", **CALM)
    page = opened.page
    shown = "document.querySelector('.ddlib-throw').world.shown"
    assert page.evaluate(shown) == 2 and "trajectory 2" in said(page)
    page.evaluate("navigator.clipboard.writeText = async (text) => { window.copied = text; }")
    page.get_by_role("button", name="Look inside").click()
    page.get_by_role("button", name="Link").click()
    page.wait_for_function("window.copied")
    assert said(page) == "Link copied."
    link = page.evaluate("window.copied")
    assert link == f"{url}?other=1&thrown-arm=motion:2,inside:1"
    again = visit(link, **CALM).page
    assert again.evaluate(shown) == 2 and again.locator(".inside").is_visible()
    page.get_by_role("button", name="Code").click()
    page.wait_for_function("window.copied.startsWith('from')")
    found = {}
    exec(page.evaluate("window.copied"), found)
    assert capsys.readouterr().out
    assert (
        found["run"].q_true[:, 0] == JOINT_DAMPING.record(APPENDIX_I[[1]])[0].q_true[:, 0]
    ).all()
    assert found["told"].shape == (300, 2)
    assert not opened.problems


@pytest.mark.browser
def test_colours_follow_the_page(tmp_path, visit, widget):
    page = visit(page_of(tmp_path / "page.html", widget), **CALM).page
    painted = "() => document.querySelectorAll('.ddlib-throw canvas')[1].toDataURL()"
    page.evaluate(NEXT_FRAME)
    light = page.evaluate(painted)
    page.emulate_media(color_scheme="dark")
    page.evaluate(NEXT_FRAME)
    dark = page.evaluate(painted)
    page.emulate_media(color_scheme="dark", media="print")
    page.evaluate(NEXT_FRAME)
    assert light != dark and page.evaluate(painted) != dark


@pytest.mark.browser
def test_damage_is_reported_in_place(tmp_path, visit, widget):
    def shorter(entry):
        entry["buffers"][0]["data"] = entry["buffers"][0]["data"][:80]

    page = visit(page_of(tmp_path / "page.html", widget, damages=[shorter])).page
    assert "weights in place of" in page.get_by_role("alert").inner_text()
