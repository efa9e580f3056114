"""The filter that the reader draws: its error against ddlib, and its page."""

from __future__ import annotations

import numpy as np
import pytest
from axe import violations_in
from reactions import first_answers
from widget_pages import NEXT_FRAME, page_of

from ddlib.analysis import followed, frequency_response
from ddlib.setups import JOINT_DAMPING, split
from ddlib.simulation import LOG_STEP
from ddlib.widgets import FilterBuilder, module
from ddlib.widgets.engine import builder

SCORE = "document.querySelector('.ddlib-builder').score"


@pytest.fixture(scope="module")
def widget():
    return FilterBuilder()


@pytest.fixture(scope="module")
def evaluate(browser):
    page = browser.new_page()
    script = module("elements.js", "physics.js", "builder.js").replace("export default", "void")
    page.add_script_tag(content=script)
    yield page.evaluate
    page.close()


def drawn(n=20, seed=0):
    """Filters as a reader may draw them, some with a mean and some without."""
    f = np.random.default_rng(seed).integers(-builder.LEVELS, builder.LEVELS + 1, (n, 21))
    f = np.cumsum(f, axis=1) / builder.LEVELS
    return np.concatenate([f, f - f.mean(1, keepdims=True)])


# The error


def test_the_recording_is_that_of_the_set_up():
    run = split(JOINT_DAMPING.record())[1]
    q, truth, step = builder.readings()
    half = builder.WIDTH // 2
    seen = run.q[run.motion.start - half : run.motion.stop + half, 0]
    np.testing.assert_array_equal(np.round(q / step) * step, seen)
    np.testing.assert_array_equal(builder.windows()[0], seen[: builder.WIDTH])
    np.testing.assert_array_equal(builder.windows()[-1], seen[-builder.WIDTH :])
    speed = run.qd_true[run.motion.start - 1 : run.motion.stop + 1, 0]
    slope = (speed[2:] - speed[:-2]) / (2 * LOG_STEP)
    assert np.sqrt(np.mean((slope - truth) ** 2)) < 0.05 * truth.std()


def test_the_error_is_what_is_left_of_the_acceleration():
    """1 - error^2 is the squared correlation of the chapter's `followed`."""
    f = drawn(4)
    states = np.zeros((len(builder.readings()[1]), 1, 3))
    states[:, 0, 2] = builder.readings()[1]
    states[:, 0, :2] = np.random.default_rng(0).normal(size=(len(states), 2))
    alone = followed(f[:, None], builder.windows()[:, None], states).alone[:, 0, 2]
    np.testing.assert_allclose([1 - builder.score(one) ** 2 for one in f], alone, atol=1e-9)
    assert builder.score(np.zeros(21)) == pytest.approx(1, abs=1e-12)


def test_nothing_beats_least_squares_here():
    best = builder.least_squares()
    least, size = builder.score(best), np.abs(best).max()
    rng = np.random.default_rng(2)
    for far in (1e-3, 1e-2, 0.1, 1.0):
        for _ in range(20):
            assert builder.score(best + far * size * rng.normal(size=21)) > least
    elsewhere = [builder.score(best, zero) for zero in builder.zeros()[1:]]
    assert np.median(elsewhere) > 1.05 * least


def test_starting_points_are_what_they_are_called():
    low = [0.2, 0.4]
    for name, f in builder.starts().items():
        assert f.shape == (21,) and np.abs(f).max() == pytest.approx(
            0 if name == "Zero" else builder.TALL
        )
        gain = np.abs(frequency_response(f, low, LOG_STEP))
        if name != "Zero":
            order = 1 if name == "Velocity" else 2
            assert gain[1] / gain[0] == pytest.approx(2**order, rel=0.05)


@pytest.mark.parametrize("f", [np.zeros(20), [np.nan] * 21])
def test_bad_filters_are_refused(f):
    with pytest.raises(ValueError, match="f must"):
        builder.score(f)


@pytest.mark.browser
def test_the_page_computes_the_same(evaluate):
    q, truth, step = builder.readings()
    every = [*drawn(), *builder.starts().values(), builder.least_squares()]
    zeros = builder.zeros()[[0, 3, 20]]
    got = evaluate(
        """([q, truth, step, zeros, filters]) => filters.map((f) => zeros.map((zero) => {
          const seen = q.map((x) => encoderReading(step, x + zero) - zero);
          const fit = fittedTo(truth, f, seen);
          return { error: fit.error, output: [...fit.output] };
        }))""",
        [q.tolist(), truth.tolist(), step, zeros.tolist(), [list(map(float, f)) for f in every]],
    )
    for f, row in zip(every, got):
        for zero, cell in zip(zeros, row):
            assert cell["error"] == pytest.approx(builder.score(f, zero), abs=1e-9)
            np.testing.assert_allclose(cell["output"], builder.fitted(f, zero), atol=1e-7)


@pytest.mark.browser
def test_the_gain_is_that_of_the_filter(evaluate):
    nu = builder.FREQUENCIES
    for f in drawn(2):
        given = [f.tolist(), nu.tolist(), LOG_STEP]
        got = evaluate("([f, nu, step]) => nu.map((x) => gainOf(f, x, step))", given)
        np.testing.assert_allclose(got, np.abs(frequency_response(f, nu, LOG_STEP)), atol=1e-9)


def test_the_whole_figure_is_small(widget):
    assert len(widget._esm.encode()) < 50_000 and len(widget.motion) < 6_000
    assert widget.still and "trajectory 6" in widget.still_alt
    assert all(line.count("`") % 2 == 0 for line in module("builder.js").splitlines())


# In a page without a kernel


def opened(tmp_path, visit, widget, query="", **options):
    url = page_of(tmp_path / "page.html", widget)
    return visit(f"{url}{query}", **options)


def place(page, k, v):
    """Where stem k has the height v, -1 to 1."""
    dot = page.locator(".stem .dot").nth(k).bounding_box()
    box = page.locator("svg.window").bounding_box()
    top, bottom = box["y"] + 8, box["y"] + box["height"] - 36
    return dot["x"] + dot["width"] / 2, (top + bottom) / 2 - v * (bottom - top) / 2


def heights(page):
    stems = page.locator(".stem").all()
    return np.array([float(stem.get_attribute("aria-valuenow")) for stem in stems])


@pytest.mark.browser
def test_named_filters_begin_and_are_scored(tmp_path, visit, widget):
    here = opened(tmp_path, visit, widget)
    page = here.page
    page.evaluate(NEXT_FRAME)
    for name, f in builder.starts().items():
        page.get_by_role("button", name=name, exact=True).click()
        page.evaluate(NEXT_FRAME)
        assert page.evaluate(SCORE) == pytest.approx(builder.score(f), abs=1e-9)
        np.testing.assert_allclose(heights(page), f, atol=0.006)
    assert page.locator(".error").inner_text() == "1.00"
    assert not here.problems


@pytest.mark.browser
def test_one_stroke_paints_across_stems(tmp_path, visit, widget):
    here = opened(tmp_path, visit, widget)
    page = here.page
    page.evaluate(NEXT_FRAME)
    compare = page.get_by_role("button", name="Compare")
    assert compare.is_disabled()
    page.get_by_role("button", name="Zero", exact=True).click()
    page.get_by_role("switch", name="Both sides alike").check()
    page.evaluate(NEXT_FRAME)
    assert compare.is_disabled()
    page.mouse.move(*place(page, 0, 0.8))
    page.mouse.down()
    page.mouse.move(*place(page, 10, -0.8))  # one event: all stems between are set
    page.mouse.up()
    page.evaluate(NEXT_FRAME)
    found = heights(page)
    np.testing.assert_allclose(found[:11], np.linspace(0.8, -0.8, 11), atol=0.03)
    np.testing.assert_allclose(found, found[::-1], atol=0.011)
    slack = page.evaluate(SCORE)
    page.get_by_role("switch", name="Sum zero").check()
    page.evaluate(NEXT_FRAME)
    assert abs(heights(page).sum()) < 0.11
    assert page.evaluate(SCORE) < 0.5 * slack
    found = heights(page)
    assert page.evaluate(SCORE) == pytest.approx(builder.score(found - found.mean()), abs=0.01)
    compare.click()
    page.evaluate(NEXT_FRAME)
    table = page.locator(".compared-with table")
    rows = [row.split("\t") for row in table.inner_text().splitlines()[1:] if "\t" in row]
    errors = [float(row[1]) for row in rows[1:]] if rows[0][0] == "weights" else None
    assert errors == sorted(errors) and len(errors) == 8
    assert page.locator("svg.window .curve").count() == 2
    assert page.locator(".chart .legend").first.inner_text().count("least squares") == 1
    assert not here.problems + violations_in(page, "light", "dark")
    page.get_by_role("button", name="Reset").click()
    page.evaluate(NEXT_FRAME)
    assert page.evaluate(SCORE) == pytest.approx(
        builder.score(builder.starts()["Second difference"]), abs=1e-9
    )
    assert not table.is_visible()


@pytest.mark.browser
def test_stems_are_moved_by_keys(tmp_path, visit, widget):
    page = opened(tmp_path, visit, widget).page
    page.get_by_role("button", name="Zero", exact=True).click()
    page.get_by_role("slider", name="Weight at 0 ms").focus()
    page.keyboard.press("Shift+ArrowUp")
    page.keyboard.press("ArrowUp")
    page.keyboard.press("ArrowLeft")
    page.keyboard.press("PageDown")
    page.keyboard.press("End")
    page.keyboard.press("ArrowDown")
    page.evaluate(NEXT_FRAME)
    found = heights(page)
    wanted = np.zeros(21)
    wanted[[9, 10, 20]] = -0.1, 0.12, -0.02
    np.testing.assert_allclose(found, wanted, atol=1e-9)
    assert page.evaluate(SCORE) == pytest.approx(builder.score(wanted), abs=1e-9)
    page.keyboard.press("0")
    page.evaluate(NEXT_FRAME)
    assert heights(page)[20] == 0
    assert page.evaluate("document.activeElement.getAttribute('aria-label')") == "Weight at 100 ms"
    assert page.locator('.stem[tabindex="0"]').count() == 1


@pytest.mark.browser
def test_a_link_restores_what_was_drawn(tmp_path, visit, widget):
    page = opened(tmp_path, visit, widget).page
    page.evaluate(NEXT_FRAME)
    page.mouse.move(*place(page, 2, 0.5))
    page.mouse.down()
    page.mouse.move(*place(page, 6, -0.3))
    page.mouse.up()
    page.get_by_role("switch", name="Sum zero").check()
    page.get_by_role("button", name="Compare").click()
    page.wait_for_timeout(600)
    wanted, score = heights(page), page.evaluate(SCORE)
    query = page.evaluate("location.search")
    again = opened(tmp_path, visit, widget, query).page
    again.evaluate(NEXT_FRAME)
    np.testing.assert_array_equal(heights(again), wanted)
    assert again.evaluate(SCORE) == score
    assert again.locator(".compared-with table").is_visible()
    wrong = opened(tmp_path, visit, widget, "?builder=f:zz").page
    wrong.evaluate(NEXT_FRAME)
    assert heights(wrong)[10] == pytest.approx(-0.9)


@pytest.mark.browser
@pytest.mark.parametrize("query", ["", "?builder=f:s3", "?builder=f:" + "a1gogo" * 7 + ",zero:1"])
def test_copied_code_gives_the_same_error(tmp_path, visit, widget, query, capsys):
    page = opened(tmp_path, visit, widget, query).page
    page.evaluate("navigator.clipboard.writeText = async (text) => { window.copied = text; }")
    page.get_by_role("button", name="Code").click()
    page.wait_for_function("window.copied")
    exec(page.evaluate("window.copied"), {})
    assert float(capsys.readouterr().out) == pytest.approx(page.evaluate(SCORE), abs=1e-9)


@pytest.mark.browser
@pytest.mark.parametrize("width, height", [(1280, 800), (390, 844)])
def test_error_and_output_are_beside_the_stems(tmp_path, browser, widget, width, height):
    context = browser.new_context(viewport={"width": width, "height": height})
    page = context.new_page()
    page.goto(page_of(tmp_path / "page.html", widget))
    page.wait_for_selector(".ddlib-builder .chart")
    page.evaluate(NEXT_FRAME)
    boxes = [
        page.locator(place).first.bounding_box()
        for place in ("svg.window", ".score", ".ddlib-builder .chart > svg")
    ]
    assert max(b["y"] + b["height"] for b in boxes) - min(b["y"] for b in boxes) < height - 100
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    context.close()


@pytest.mark.browser
def test_touch_draws_anywhere_and_scrolls_upwards_beside_the_dots(tmp_path, browser, widget):
    context = browser.new_context(
        viewport={"width": 390, "height": 600}, has_touch=True, is_mobile=True
    )
    page = context.new_page()
    page.goto(page_of(tmp_path / "page.html", widget))
    page.wait_for_selector(".ddlib-builder .stem")
    page.evaluate(NEXT_FRAME)
    devtools = context.new_cdp_session(page)

    def swipe(start, end):
        for k in range(10):
            x, y = (a + (b - a) * k / 9 for a, b in zip(start, end))
            kind = "touchMove" if k else "touchStart"
            points = {"type": kind, "touchPoints": [{"x": x, "y": y}]}
            devtools.send("Input.dispatchTouchEvent", points)
            page.wait_for_timeout(20)
        devtools.send("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})
        page.evaluate(NEXT_FRAME)

    swipe(place(page, 3, 0.0), place(page, 3, 0.7))
    assert heights(page)[3] == pytest.approx(0.7, abs=0.03)
    assert page.evaluate("scrollY") == 0
    page.get_by_role("button", name="Zero", exact=True).click()
    page.evaluate(NEXT_FRAME)
    start, end = place(page, 2, 0.9), place(page, 14, -0.9)  # far from every dot
    swipe(start, end)
    np.testing.assert_allclose(heights(page)[2:15], np.linspace(0.9, -0.9, 13), atol=0.05)
    assert page.evaluate("scrollY") == 0
    page.touchscreen.tap(*place(page, 18, 0.8))
    page.evaluate(NEXT_FRAME)
    assert heights(page)[18] == pytest.approx(0.8, abs=0.03)
    before = heights(page)
    x, y = place(page, 16, 0.8)
    swipe((x, y), (x, y - 150))
    np.testing.assert_array_equal(heights(page), before)
    assert page.evaluate("scrollY") > 50
    context.close()


@pytest.mark.browser
def test_damage_is_reported_in_place(tmp_path, visit, widget):
    def shorter(entry):
        entry["buffers"][0]["data"] = entry["buffers"][0]["data"][:80]

    page = visit(page_of(tmp_path / "page.html", widget, damages=[shorter])).page
    assert "bytes of motion in place of" in page.get_by_role("alert").inner_text()


@pytest.mark.browser
@pytest.mark.parametrize("touch", [False, True])
def test_its_first_handle_answers(tmp_path, visit, widget, touch):
    options = {"width": 400, "has_touch": True, "is_mobile": True} if touch else {}
    here = opened(tmp_path, visit, widget, **options)
    first_answers(here.page.locator(".ddlib-builder"), touch)
    assert not here.problems
