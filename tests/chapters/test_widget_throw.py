"""The thrown arm: its world against ddlib, and its page by pointer, touch and keyboard."""

from __future__ import annotations

import numpy as np
import pytest
from widget_pages import LESSONS, NEXT_FRAME, copied, functions

from ddlib.analysis import savitzky_golay, shares
from ddlib.dynamics import CMU_DD_ARM_II
from ddlib.learning import sliding_windows
from ddlib.setups import JOINT_DAMPING
from ddlib.trajectories import APPENDIX_I
from workshop.chapters.widgets.throw import ThrownArm
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
    model = results.median_network(21, JOINT_DAMPING.name)
    return ThrownArm(model, code="motion, line = {motion}, '{shoulder}'")


@pytest.fixture(scope="module")
def evaluate(browser):
    with functions(browser, LESSONS / "world.js") as call:
        yield call


def moved(evaluate, widget, *moves):
    """The log of a world as columns, and the samples that the network has seen."""
    weights = np.frombuffer(widget.weights, "<f4").tolist()
    samples = evaluate(WORLD, [widget.spec, weights, list(moves)])
    return lambda name, rows=samples: np.array([s[name] for s in rows if name in s])


# The world


@pytest.mark.browser
def test_a_played_motion_is_that_of_the_simulator(evaluate, widget):
    model = results.median_network(21, JOINT_DAMPING.name)
    silent = JOINT_DAMPING.effects.without("torque_sensor")
    known = JOINT_DAMPING.record(APPENDIX_I[[5]], effects=silent, rest=widget.spec["rest"])[0]
    seen = moved(evaluate, widget, ["play", 0, 5 * len(known.t)])
    last = slice(-len(seen("q")), None)
    np.testing.assert_allclose(seen("q"), known.q[last], atol=1e-6)
    np.testing.assert_allclose(seen("tau"), known.tau_true[last], atol=1e-4)
    np.testing.assert_allclose(seen("v"), known.qd_true[last], atol=1e-5)
    windows = sliding_windows(known.q[last], 21)
    net, rates, bends = (seen(name)[-len(windows) :] for name in ("net", "rates", "bends"))
    np.testing.assert_allclose(net, model.torque(windows), atol=1e-4)
    rate, bend = (savitzky_golay(21, k, 0.01, degree=k + 1) for k in (1, 2))
    np.testing.assert_allclose(rates, windows @ rate, atol=1e-6)
    np.testing.assert_allclose(bends, windows @ bend, atol=1e-4)
    assert len(windows) > 300


@pytest.mark.browser
def test_a_throw_is_the_pull_and_then_friction_alone(evaluate, widget):
    """A force at the hand does the work that the arm gains and friction takes."""
    pull = [["hold", {"push": [0.6, -0.8]}, 150], ["release", None, 1000]]
    seen = moved(evaluate, widget, *pull)
    q, v, tau = (seen(name) for name in ("q", "v", "tau"))
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
def test_weights_fold_into_a_constant_a_line_and_a_parabola(evaluate):
    n = np.arange(-10, 11)
    for f in results.networks(21).weights.hidden_weights[2, :, 0]:
        got = evaluate("(f) => folded(f)", f.tolist())
        parts = [got[name] for name in ("constant", "line", "parabola", "left")]
        whole = np.sum(parts, axis=0)
        np.testing.assert_allclose(whole, f, atol=1e-12)
        np.testing.assert_allclose(got["shares"], shares(f)[:3], atol=1e-9)
        rest = np.array(got["left"])
        assert np.abs([rest.sum(), rest @ n, rest @ n**2]).max() < 1e-8
        assert np.ptp(got["constant"]) == 0


# In a page without a kernel

STATE = """() => {
  const { world } = document.querySelector(".ddlib-throw");
  return { mode: world.mode, q: [...world.angles()], count: world.count, hand: world.places()[1] };
}"""


def until(page, holds: str):
    """Wait until something holds of `world`, however slow the machine."""
    world = "document.querySelector('.ddlib-throw').world"
    page.wait_for_function(f"(({{ world }}) => {holds})({{ world: {world} }})")


def status(page) -> str:
    return page.locator(".said").inner_text()


def press(page, name):
    page.get_by_role("button", name=name).first.click()
    page.evaluate(NEXT_FRAME)


@pytest.mark.browser
def test_the_hand_is_pulled_by_pointer_and_keys(page_with, widget):
    page = page_with(widget, calm=True)
    press(page, "Reset")
    box = page.locator(".hand-handle .dot").bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x - 60, y + 120, steps=4)
    until(page, "world.mode === 'held' && world.places()[1][1] < -0.02")
    held = page.evaluate(STATE)
    assert page.locator(".rope").get_attribute("visibility") == "visible"
    page.mouse.up()
    assert page.evaluate(STATE)["mode"] == "free" and "friction" in status(page)
    until(page, f"world.places()[1][1] !== {held['hand'][1]}")
    press(page, "Reset")
    assert page.evaluate(STATE)["q"] == [0, 0]
    page.get_by_role("application", name="arrow keys").focus()
    page.keyboard.down("ArrowDown")
    until(page, "world.mode === 'held' && world.places()[1][1] < -0.01")
    page.keyboard.up("ArrowDown")
    until(page, "world.mode === 'free'")  # a key pulls for some time at least
    page.keyboard.down("ArrowLeft")
    page.keyboard.press("Tab")  # leaves the hand
    assert page.evaluate(STATE)["mode"] == "free"


DRAWN = (
    "[...document.querySelectorAll('.equation canvas')].map((sheet) => sheet.toDataURL().length)"
)


@pytest.mark.browser
def test_a_row_is_folded_from_the_first_and_by_hand(page_with, widget):
    page = page_with(widget, calm=True)
    address, fold = page.url, page.get_by_role("slider", name="Fold")
    titles = page.locator(".equation .title")
    look = page.get_by_role("button", name="Look inside")
    assert look.get_attribute("aria-expanded") == "true" and fold.input_value() == "100"
    assert titles.all_inner_texts()[1:] == ["= constant 1 %", "+ line 58 %", "+ parabola 37 %"]
    whole = page.evaluate(DRAWN)
    fold.focus()
    page.keyboard.press("Home")
    page.evaluate(NEXT_FRAME)
    assert fold.input_value() == "0" and titles.first.inner_text() == "one row"
    flat = page.evaluate(DRAWN)
    assert all(a < b for a, b in zip(flat[2:], whole[2:]))  # line and parabola are still to come
    press(page, "Most of a line")
    assert page.locator(".net .unit.chosen").count() == 1 and fold.input_value() == "100"
    assert "elbow" in page.locator(".inside .remark").first.inner_text()
    look.click()
    assert look.get_attribute("aria-expanded") == "false"
    assert not page.locator(".inside").is_visible()
    query = "?thrown-arm=motion:0,inside:0"
    assert copied(page, "Link") == f"{address}{query}"
    assert not page_with(widget, query=query, calm=True).locator(".inside").is_visible()
