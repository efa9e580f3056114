"""The first page's hero: twins and their weights, its arm against ddlib, its page by every hand."""

from __future__ import annotations

import numpy as np
import pytest
from widget_pages import LESSONS, NEXT_FRAME, Finger, copied, functions, page_of, phone

from ddlib.analysis import gains, mean_gradient
from ddlib.dynamics import CMU_DD_ARM_II
from ddlib.learning import cases
from ddlib.setups import JOINT_DAMPING
from ddlib.simulation import LOG_STEP
from ddlib.trajectories import APPENDIX_I
from workshop.chapters.widgets.hero import Hero, twins
from workshop.report import committed, results

WORLD = """([spec, moves]) => {
  const world = worldOf(spec);
  const seen = [];
  for (const [act, argument, periods] of moves) {
    world[act](argument);
    for (let k = 0; k < periods; k++) {
      world.period();
      if (world.count % spec.every === 1) seen.push(world.samples.at(-1));
    }
  }
  return seen;
}"""


@pytest.fixture(scope="module")
def widget():
    return Hero(twins(), results.read("twins")["arm"])


@pytest.fixture(scope="module")
def moved(browser, widget):
    """The log of a world that is moved, as columns."""
    with functions(browser, LESSONS / "world.js") as call:

        def log(*moves):
            samples = call(WORLD, [widget.spec, list(moves)])
            return lambda name: np.array([sample[name] for sample in samples])

        yield log


def test_what_lies_on_the_balances_is_read_from_the_committed_weights():
    windows, _ = cases(committed.training(JOINT_DAMPING.name), 21)
    for twin in twins():
        read = gains(mean_gradient(twin.model, windows), LOG_STEP)[0, 0, 2]
        assert twin.inertia == pytest.approx(read, rel=0.01, abs=1e-3)


def test_the_rows_look_alike_and_only_one_has_met_the_arm():
    a, b = (twin.model.weights.hidden_weights[0, 0] for twin in twins())
    assert np.corrcoef(a, b)[0, 1] > 0.9
    run = JOINT_DAMPING.record()[5]
    windows, torque = cases(run, 21)
    errors = [np.std(twin.model.torque(windows) - torque) / np.std(torque) for twin in twins()]
    assert errors[0] < 0.2 and errors[1] > 0.8


# The world


@pytest.mark.browser
def test_a_played_motion_is_that_of_the_simulator(moved, widget):
    silent = JOINT_DAMPING.effects.without("torque_sensor")
    known = JOINT_DAMPING.record(APPENDIX_I[[5]], effects=silent, rest=widget.spec["rest"])[0]
    seen = moved(["play", None, 5 * len(known.t)])
    np.testing.assert_allclose(seen("q"), known.q, atol=1e-6)
    np.testing.assert_allclose(seen("tau"), known.tau_true, atol=1e-4)
    np.testing.assert_allclose(seen("v"), known.qd_true, atol=1e-5)


@pytest.mark.browser
def test_a_throw_is_the_pull_and_then_friction_alone(moved, widget):
    """A force at the hand does the work that the arm gains and friction takes."""
    seen = moved(["hold", {"push": [0.0, -1.0]}, 60], ["release", None, 600])
    q, v, tau = (seen(name) for name in ("q", "v", "tau"))
    assert np.abs(tau[:12]).max() > 5 and np.abs(tau[12:]).max() == 0
    arm = CMU_DD_ARM_II
    hand = arm.forward_kinematics(q)[:, 1]
    pulled = (hand[12] - hand[0]) @ [0.0, -widget.spec["force"]]
    energy = arm.kinetic_energy(q, v)
    lost = np.cumsum((JOINT_DAMPING.effects.friction_torque(v) * v).sum(-1)) * 0.01
    assert energy[12] == pytest.approx(pulled - lost[12], rel=0.1)
    assert np.all(np.diff(energy[13:]) <= 1e-9)


@pytest.mark.browser
def test_rubber_stops_keep_the_arm_in_the_picture(moved, widget):
    low, high = (np.array(widget.spec["stops"][name]) for name in ("low", "high"))
    for push in ([1.0, 0.3], [0.3, -1.0], [-1.0, 0.5]):
        q = moved(["hold", {"push": push}, 1500])("q")
        assert np.all(q > low - 0.4) and np.all(q < high + 0.4)


# In a page without a kernel


COVERED = """(() => {
  const box = (el) => el.getBoundingClientRect();
  const words = [...document.querySelectorAll('.legend-truth, .legend-told')].map(box);
  const drawn = [...document.querySelectorAll('.letter, .arc:not(g[class^=legend] *)')];
  return drawn.map(box).filter((a) =>
    words.some((b) => a.x < b.right && b.x < a.right && a.y < b.bottom && b.y < a.bottom));
})()"""
"""Badges and arcs that lie on the words that explain them."""

BENT = "parseFloat(document.querySelector('text.bend').textContent.slice(5))"


def until(page, holds: str):
    """Wait until something holds of `world`, however slow the machine."""
    world = "document.querySelector('.ddlib-hero').world"
    page.wait_for_function(f"(({{ world }}) => {holds})({{ world: {world} }})")


def middle(box) -> tuple[float, float]:
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2


@pytest.mark.browser
def test_it_stands_where_the_window_is_bent(page_with, widget):
    page = page_with(widget, calm=True)
    run = JOINT_DAMPING.record()[5]
    torque = run.tau_true[run.motion][:150, 0]
    centre = run.motion.start + torque.argmax()
    path = np.rad2deg(run.q[centre - 10 : centre + 11, 0])
    bend = np.abs(path - np.linspace(path[0], path[-1], 21)).max()
    told = page.locator("text.bend").text_content()
    assert float(told.split()[1].strip("°")) == pytest.approx(bend, abs=0.1)
    page.wait_for_timeout(300)
    assert page.locator("text.bend").text_content() == told  # and rests there


@pytest.mark.browser
def test_nothing_is_given_away_before_it_is_weighed(page_with, widget):
    page = page_with(widget, calm=True)
    url, said = page.url, page.locator("p.verdict")
    dashed = page.locator(".guessed")
    assert not dashed.is_visible() and "spring" not in page.locator("main").inner_text()
    page.locator(".badge").last.click()
    assert page.locator(".badge").last.get_attribute("aria-pressed") == "true"
    assert said.inner_text() == "You say B. Now weigh." and not dashed.is_visible()
    assert copied(page, "Link").startswith(f"{url}?hero=guess:B")
    page.get_by_role("button", name="Weigh").click()
    told = "Fooled. A learnt this arm and weighs 6.8 kg m², B learnt a spring and weighs 0.0 kg m²"
    assert said.text_content().startswith(told)
    assert dashed.is_visible() and page.locator(".scale .verdict").all_text_contents() == [
        "A learnt this arm.",
        "B learnt a spring.",
    ]
    slopes = page.evaluate("""[...document.querySelectorAll('.beam')].map(
      (beam) => beam.y2.baseVal.value - beam.y1.baseVal.value)""")
    assert 0 < slopes[0] < 0.5 * -slopes[1]  # nearly level; up on the empty side
    page.get_by_role("button", name="Again").click()
    assert not dashed.is_visible() and "Pick A or B" in said.inner_text()


@pytest.mark.browser
def test_it_asks_for_a_guess_once(page_with, widget):
    page = page_with(widget, calm=True)
    said, weigh = page.locator("p.verdict"), page.get_by_role("button", name="Weigh")
    weigh.press("Enter")
    assert said.inner_text() == "A or B first?" and not page.locator(".guessed").is_visible()
    assert weigh.evaluate("(button) => button === document.activeElement")
    weigh.press("w")
    assert said.text_content().startswith("A learnt this arm")


@pytest.mark.browser
def test_by_keyboard_alone(page_with, widget):
    page = page_with(widget, calm=True)
    page.get_by_role("application", name="arrow keys").focus()
    page.keyboard.down("ArrowLeft")
    until(page, "world.mode === 'held'")
    page.keyboard.up("ArrowLeft")
    until(page, "world.mode === 'free'")  # a key pulls for some time at least
    page.keyboard.down("ArrowUp")
    page.keyboard.press("Tab")  # leaves the hand
    until(page, "world.mode === 'free'")
    focused = page.evaluate("document.activeElement.getAttribute('aria-label')")
    assert focused == "A has met this arm"
    page.keyboard.press("Enter")
    page.keyboard.press("w")
    assert page.locator("p.verdict").inner_text().startswith("You were right")
    until(page, "world.mode === 'play'")  # the arm came to rest, and moves again
    page.wait_for_function(f"{BENT} > 1")


@pytest.mark.browser
def test_thrown_by_the_mouse(page_with, widget):
    page = page_with(widget, calm=True, query="?hero=weighed:true")
    x, y = middle(page.locator(".hand-handle .ring").bounding_box())
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x - 120, y + 30, steps=4)
    until(page, "world.mode === 'held' && Math.abs(world.samples.at(-1).v[0]) > 0.05")
    assert page.locator(".rope").get_attribute("visibility") == "visible"
    x, y = middle(page.locator(".joint.shoulder").bounding_box())
    page.mouse.move(x + 150, y + 40, steps=4)
    until(page, "world.samples.at(-1).q[0] < -1")  # it hangs low
    assert page.evaluate(COVERED) == []
    page.mouse.up()
    until(page, "world.mode === 'free'")
    assert not page.locator(".bait").is_visible()


@pytest.mark.browser
@pytest.mark.chromium
def test_thrown_by_a_finger_on_a_phone(browser, tmp_path, widget):
    url = page_of(tmp_path / "page.html", widget)
    with phone(browser, url, reduced_motion="reduce") as page:
        box = page.locator(".stage").bounding_box()
        assert box["x"] >= 0 and box["x"] + box["width"] <= 390
        x, y = middle(page.locator(".hand-handle .ring").bounding_box())
        Finger(page).hold(x, y, -60, 10)
        until(page, "world.mode === 'held'")
        page.locator(".badge").first.tap(force=True)
        page.evaluate(NEXT_FRAME)
        outside = """[...document.querySelectorAll('.stage text')].filter((t) => {
          const { x, right, width } = t.getBoundingClientRect();
          return width && getComputedStyle(t).visibility !== 'hidden' && (x < 0 || right > 390);
        }).map((t) => t.textContent)"""
        assert page.evaluate(outside) == []
