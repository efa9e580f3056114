"""The filter that the reader draws: its error against ddlib, and its page."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from widget_pages import LESSONS, NEXT_FRAME, copied, functions

from ddlib.analysis import filter_responses
from ddlib.dynamics import CMU_DD_ARM_II, with_load
from ddlib.effects import IDEAL
from ddlib.setups import JOINT_DAMPING
from workshop.chapters.widgets import builder
from workshop.chapters.widgets.builder import FilterBuilder

SCORE = "document.querySelector('.ddlib-builder').score"


@pytest.fixture(scope="module")
def widget():
    return FilterBuilder(np.arange(-10, 11.0) ** 2)


@pytest.fixture(scope="module")
def evaluate(browser):
    with functions(browser, "elements.js", LESSONS / "builder.js") as call:
        yield call


def drawn(n=20, seed=0):
    """Filters as a reader may draw them, some with a mean and some without."""
    f = np.cumsum(np.random.default_rng(seed).uniform(-1, 1, (n, 21)), axis=1)
    return np.concatenate([f, f - f.mean(1, keepdims=True)])


def least_squares(widget):
    """The weights that the page lays over one's own."""
    return next(np.array(f) for name, _, f in widget.spec["rivals"] if name == "least")


def test_a_readers_own_arm_without_an_encoder(widget):
    """Its motion is another one, and nothing is rounded."""
    own = replace(JOINT_DAMPING, arm=with_load(CMU_DD_ARM_II, 4.0), effects=IDEAL)
    other = FilterBuilder(np.ones(21), own)
    assert other.motion != widget.motion and other.spec["step"] < 1e-6
    assert np.abs(least_squares(other)).max() > 2 * np.abs(least_squares(widget)).max()


# The error


def test_the_error_is_what_is_left_of_the_acceleration():
    """1 - error^2 is the squared correlation of the chapter's `filter_responses`."""
    f = drawn(4)
    states = np.zeros((len(builder.readings()[1]), 1, 3))
    states[:, 0, 2] = builder.readings()[1]
    states[:, 0, :2] = np.random.default_rng(0).normal(size=(len(states), 2))
    alone = filter_responses(f[:, None], builder.windows()[:, None], states).alone[:, 0, 2]
    np.testing.assert_allclose([1 - builder.score(weights) ** 2 for weights in f], alone, atol=1e-9)
    assert builder.score(np.zeros(21)) == pytest.approx(1, abs=1e-12)


def test_nothing_beats_least_squares_here(widget):
    best = least_squares(widget)
    least, size = builder.score(best), np.abs(best).max()
    rng = np.random.default_rng(2)
    for far in (1e-3, 1e-2, 0.1, 1.0):
        for _ in range(20):
            assert builder.score(best + far * size * rng.normal(size=21)) > least
    elsewhere = [builder.score(best, zero) for zero in widget.spec["zeros"][1:]]
    assert np.median(elsewhere) > 1.05 * least


@pytest.mark.browser
def test_the_page_computes_the_same(evaluate, widget):
    q, truth, step = builder.readings()
    every = [*drawn(), *builder.starts().values(), least_squares(widget)]
    zeros = [widget.spec["zeros"][k] for k in (0, 3, 20)]
    fits = evaluate(
        """([q, truth, step, zeros, filters]) => filters.map((f) => zeros.map((zero) => {
          const seen = q.map((x) => encoderReading(step, x + zero) - zero);
          const fit = fittedTo(truth, f, seen);
          return { error: fit.error, output: [...fit.output] };
        }))""",
        [q.tolist(), truth.tolist(), step, zeros, [list(map(float, f)) for f in every]],
    )
    for f, row in zip(every, fits):
        for zero, fit in zip(zeros, row):
            assert fit["error"] == pytest.approx(builder.score(f, zero), abs=1e-9)
            far = np.std(fit["output"] - truth) / np.std(truth)
            assert far == pytest.approx(fit["error"], abs=1e-9)


# In a page without a kernel


def place(page, k, v):
    """Where stem k has the height v, -1 to 1."""
    dot = page.locator(".stem .dot").nth(k).bounding_box()
    box = page.locator("svg.window").bounding_box()
    top, bottom = box["y"] + 8, box["y"] + box["height"] - 36
    return dot["x"] + dot["width"] / 2, (top + bottom) / 2 - v * (bottom - top) / 2


def heights(page):
    stems = page.locator(".stem").all()
    return np.array([float(stem.get_attribute("aria-valuenow")) for stem in stems])


def press(page, name, role="button"):
    page.get_by_role(role, name=name, exact=True).click()
    page.evaluate(NEXT_FRAME)


@pytest.mark.browser
def test_one_stroke_paints_across_stems(page_with, widget):
    page = page_with(widget, calm=True)
    compare = page.get_by_role("button", name="Compare")
    press(page, "Zero")
    press(page, "Both sides alike", "switch")
    assert compare.is_disabled()
    page.mouse.move(*place(page, 0, 0.8))
    page.mouse.down()
    page.mouse.move(*place(page, 10, -0.8))  # one event: all stems between are set
    page.mouse.up()
    page.evaluate(NEXT_FRAME)
    painted = heights(page)
    np.testing.assert_allclose(painted[:11], np.linspace(0.8, -0.8, 11), atol=0.03)
    np.testing.assert_allclose(painted, painted[::-1], atol=0.011)
    slack = page.evaluate(SCORE)
    total = f"your weights sum to {painted.sum():.2f}"[:-1].replace("-", "−")
    assert page.locator(".times").inner_text().startswith(total)
    press(page, "Sum zero", "switch")
    level = heights(page)
    assert "leaks" not in page.locator(".times").inner_text()
    assert abs(level.sum()) < 0.11 and page.evaluate(SCORE) < 0.5 * slack
    assert page.evaluate(SCORE) == pytest.approx(builder.score(level - level.mean()), abs=0.01)
    compare.click()
    page.evaluate(NEXT_FRAME)
    table = page.locator(".compared-with tbody tr")
    errors = [float(row.split("\t")[1]) for row in table.all_inner_texts()]
    assert errors == sorted(errors) and len(errors) == 8


@pytest.mark.browser
def test_stems_are_moved_by_keys(page_with, widget):
    page = page_with(widget, calm=True)
    press(page, "Zero")
    page.get_by_role("slider", name="Weight at 0 ms").focus()
    keys = ("Shift+ArrowUp", "ArrowUp", "ArrowLeft", "PageDown", "End", "ArrowDown")
    for key in keys:
        page.keyboard.press(key)
    page.evaluate(NEXT_FRAME)
    wanted = np.zeros(21)
    wanted[[9, 10, 20]] = -0.1, 0.12, -0.02
    np.testing.assert_allclose(heights(page), wanted, atol=1e-9)
    assert page.evaluate(SCORE) == pytest.approx(builder.score(wanted), abs=1e-9)
    page.keyboard.press("0")
    page.evaluate(NEXT_FRAME)
    assert heights(page)[20] == 0


@pytest.mark.browser
def test_code_gives_the_error_of_what_was_drawn(page_with, widget, capsys):
    query = f"?builder=f:{'a1gogo' * 7},zero:1,compare:1"
    page = page_with(widget, query=query, calm=True)
    assert page.locator(".compared-with table").is_visible() and np.ptp(heights(page)) > 0.3
    page.mouse.click(*place(page, 2, 0.5))
    page.evaluate(NEXT_FRAME)
    assert heights(page)[2] == pytest.approx(0.5, abs=0.03)
    exec(copied(page), {})
    assert float(capsys.readouterr().out) == pytest.approx(page.evaluate(SCORE), abs=1e-9)
