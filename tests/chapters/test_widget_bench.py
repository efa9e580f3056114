"""A strip of weights to fold and a wire to bend, in Python and in a page without a kernel."""

from __future__ import annotations

import numpy as np
import pytest
import traitlets
from widget_pages import LESSONS, NEXT_FRAME, functions

from ddlib.analysis import decompose
from ddlib.simulation import LOG_STEP
from workshop.chapters.widgets.bench import REACH, FoldBench

S = np.arange(-7, 8)
ROUGH = 10 * np.random.default_rng(2).normal(size=15)
ROWS = {"line": 3.0 * S, "parabola": S**2 - (S**2).mean(), "rough": ROUGH}
T = LOG_STEP * np.arange(120)
MOTION = np.stack([np.sin(5 * T), 5 * np.cos(5 * T), -25 * np.sin(5 * T)], -1)


@pytest.fixture
def widget():
    return FoldBench(ROWS, LOG_STEP, MOTION)


@pytest.mark.parametrize(("name", "value"), [("tilt", 51.0), ("fold", 1.2), ("row", "none")])
def test_what_is_out_of_reach_is_refused(widget, name, value):
    with pytest.raises(traitlets.TraitError, match=name):
        setattr(widget, name, value)


@pytest.mark.browser
def test_the_page_takes_rows_apart_and_plays_as_python_does(browser):
    with functions(browser, LESSONS / "bench.js") as call:
        got = call("(f) => halvesOf(f)", ROUGH.tolist())
        parts = decompose(ROUGH)
        np.testing.assert_allclose(got["even"], parts.even, atol=1e-12)
        np.testing.assert_allclose(got["odd"], parts.odd, atol=1e-12)
        np.testing.assert_allclose(got["constant"], 15 * [parts.constant.item()], atol=1e-12)
        given = [ROWS["line"].tolist(), (LOG_STEP * S).tolist(), MOTION.T.tolist()]
        played = call("([f, x, m]) => playedOf(halvesOf(f), x, m)", given)
    odd = np.convolve(MOTION[:, 0], ROWS["line"][::-1], "valid")
    np.testing.assert_allclose(played["odd"]["got"], odd, atol=1e-9)
    np.testing.assert_allclose(
        played["odd"]["wanted"], LOG_STEP * (3 * S**2).sum() * MOTION[7:-7, 1]
    )
    assert played["odd"]["told"] > 0.99 and np.abs(played["even"]["got"]).max() < 1e-9


@pytest.mark.browser
def test_a_line_hears_speed_alone_and_a_parabola_acceleration_alone(browser):
    heard = """([f, x, motion]) => Object.values(halvesOf(f)).map((part) =>
      part.reduce((all, v, k) => all + v * angles(x, motion)[k], 0))"""
    still = dict.fromkeys(REACH, 0.0)
    with functions(browser, LESSONS / "bench.js") as call:
        for row, part, motion in (("line", 2, "tilt"), ("parabola", 1, "bend")):
            for moved, most in REACH.items():
                given = [ROWS[row].tolist(), (LOG_STEP * S).tolist(), {**still, moved: most}]
                answers = np.abs(call(heard, given)) > 1e-9
                assert answers.tolist() == [k == part and moved == motion for k in range(3)]


@pytest.mark.browser
def test_folded_by_pointer_then_tilted_by_keys(page_with, widget):
    page = page_with(widget, calm=True)
    play = page.get_by_role("button", name="Play a motion")
    assert play.is_disabled() and not page.locator(".band").first.is_visible()
    box = page.locator(".fold .dot").bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    flat = page.locator(".flap").bounding_box()["width"]
    page.mouse.move(x - 300, y, steps=5)
    assert page.locator(".flap").bounding_box()["width"] < 0.9 * flat  # the paper follows
    page.mouse.move(4, y, steps=5)
    page.mouse.up()
    lift, tilt = (page.get_by_role("slider", name=name) for name in ("Lift", "Tilt"))
    lift.press("ArrowUp")
    page.evaluate(NEXT_FRAME)
    assert page.locator(".verdict").inner_text().startswith("Lifted: the joint stands still.")
    lift.press("ArrowDown")
    tilt.press("End")
    page.evaluate(NEXT_FRAME)
    said = page.locator(".verdict").inner_text()
    assert said == "Tilted: a steady speed. Only the odd jar moves."
    answer = (ROWS["line"] @ np.deg2rad(50.0 * LOG_STEP * S)).item()
    number = page.locator(".band.odd .number").text_content()
    assert float(number.replace("−", "-")) == pytest.approx(answer, rel=0.02)
    above_zero = """() => {
      const [level, zero] = ['.band.odd .level', '.pours'].map((part) => {
        const { y, height } = [...document.querySelectorAll(part)].at(-1).getBoundingClientRect();
        return y + height / 2;
      });
      return zero - level;
    }"""
    assert page.evaluate(above_zero) * answer > 0
    tilt.press("Home")
    page.evaluate(NEXT_FRAME)
    assert page.evaluate(above_zero) * answer < 0  # what is negative lies below zero
    tilt.press("End")
    page.wait_for_function("location.search.includes('tilt:50')")
    play.click()
    page.wait_for_function("document.querySelector('.verdict').textContent.startsWith('Dashed')")
    page.get_by_role("button", name="Reset").click()
    assert page.locator(".hint").is_visible()
