"""Whose filters, and the arm on the scales: their handles say what the networks say."""

import numpy as np
import pytest
from axe import violations
from widget_pages import NEXT_FRAME, assert_exact_table, drag

from ddlib.analysis import CLASSES, gains, mean_gradient
from ddlib.learning import Weights, cases
from ddlib.setups import JOINT_DAMPING
from ddlib.simulation import LOG_STEP
from workshop.chapters import inertia_in_the_weights, whose_filters as chapter
from workshop.chapters.widgets.hero import twins
from workshop.chapters.widgets.starts import UnitFromFiveStarts
from workshop.chapters.widgets.weigh import WeighTheArm
from workshop.chapters.widgets.whose import GuessRound, WhoseFilters
from workshop.report import committed, results

X = np.arange(-10, 11.0)
PARABOLAS = np.tile(X**2 - (X**2).mean(), (20, 1))
NOISE = np.random.default_rng(2).normal(size=(20, 21))
ROUNDS = [GuessRound(PARABOLAS, NOISE, f"learnt number {k}", f"Remark {k}.") for k in range(4)]


def answers(widget) -> str:
    """The side of the arm's network, round by round."""
    rounds = [shown["galleries"] for shown in widget.spec["rounds"]]
    return "".join("A" if first["arm"] else "B" for first, _ in rounds)


def test_galleries_have_rows_names_and_one_answer():
    widget = WhoseFilters(ROUNDS)
    assert widget.guesses == "----" and set(answers(widget)) == {"A", "B"}
    for shown, right in zip(widget.spec["rounds"], answers(widget)):
        own = shown["galleries"]["AB".index(right)]
        assert own["counts"] == [["acceleration", 20]]
        assert np.allclose(own["rows"], PARABOLAS / PARABOLAS.max(), atol=1e-3)


@pytest.mark.browser
def test_a_guess_is_judged_counted_and_kept(page_with):
    widget = WhoseFilters(ROUNDS)
    page = page_with(widget)
    verdict, score = page.locator(".verdict"), page.locator(".score")
    assert "Which of the two" in verdict.inner_text() and score.inner_text() == "no guess yet"
    assert page.locator(".row.even").count() == 0 and page.locator(".row").count() == 40
    right = answers(widget)
    page.get_by_role("button", name=f"{right[0]} learnt this arm").press("Enter")
    assert verdict.inner_text().startswith("Right:") and "Remark 0." in verdict.inner_text()
    assert page.locator(".row.even").count() == 20
    counts = page.locator(".told").all_inner_texts()
    assert any("20\u00a0acceleration" in text for text in counts)
    page.get_by_role("button", name="Next round").click()
    wrong = "AB"["BA".index(right[1])]
    page.get_by_role("button", name=f"{wrong} learnt this arm").click()
    assert verdict.inner_text().startswith("No:") and score.inner_text() == "1 of 2 right"
    assert not violations(page)
    page.get_by_role("button", name="Reset").click()
    page.evaluate(NEXT_FRAME)
    assert score.inner_text() == "no guess yet"


def test_torques_that_do_not_belong_are_as_large():
    own = chapter.torques("own")
    shifted, again = chapter.torques("shifted"), chapter.torques("shifted, again")
    assert np.allclose(np.sort(own, 0), np.sort(shifted, 0)) and not np.allclose(shifted, again)
    foreign = chapter.torques("another arm")
    assert np.corrcoef(own[:, 0], foreign[:, 0])[0, 1] > 0.9


def test_the_rounds_take_the_most_typical():
    shares = {name: np.zeros(3) for name in CLASSES}
    shares["acceleration"], shares["jerk"] = np.array([0.9, 0.1, 0.4]), np.array([0.1, 0.2, 0.3])
    study = {"hidden": {"classes": shares}}
    assert chapter.typical(study).tolist() == [2, 1, 0]  # medians: 0.4 and 0.2


def test_one_unit_is_shown_before_and_after():
    sizes = (0.1, 1.0)
    networks = {
        size: tuple(Weights.random(1, 21, 3, initial=size, seed=k)[0] for k in range(2))
        for size in sizes
    }
    widget = UnitFromFiveStarts(networks)
    widget.size, widget.unit, widget.joint = 0.1, 2, "elbow"
    shown, (before, after) = widget.curves, networks[0.1]
    assert np.allclose(shown["before"], before.hidden_weights[1, 1])
    parts = shown["even"] + shown["odd"] + shown["constant"]
    assert np.allclose(parts, after.hidden_weights[1, 1]) and np.isclose(shown["shares"].sum(), 1)
    assert_exact_table(widget)


@pytest.fixture(scope="module")
def scales():
    """The arm on the scales, with a network that learnt it and one that learnt a spring."""
    windows, _ = cases(committed.training(JOINT_DAMPING.name), 21)
    networks = {twin.learnt: twin.model for twin in twins()}
    return WeighTheArm(networks, windows, 6.4, lambda load: load * np.full((2, 2), 0.8))


@pytest.mark.parametrize("twin", twins(), ids=lambda twin: twin.name)
def test_all_samples_weigh_as_on_the_first_page_and_what_is_written_weighs_more(scales, twin):
    at = {"reach": 10, "learnt": twin.learnt}
    whole = scales.curves_at(**at)
    assert whole["sum"] == pytest.approx(twin.inertia, rel=0.01, abs=2e-3)
    assert np.isclose(whole["parts"].sum(), whole["sum"]) and whole["own"] == 6.4
    inner = scales.curves_at(**{**at, "reach": 3})
    assert np.isclose(inner["sum"], whole["parts"][7:14].sum())
    loaded = scales.curves_at(**at, load=2)
    assert np.isclose(loaded["own"], 8.0) and loaded["sum"] == whole["sum"]
    written = scales.curves_at(**at, load=2, pencil=True)
    more = written["sum"] - whole["sum"]  # a steeper sum bends the outputs' sigmoids more
    assert more == pytest.approx(1.6, rel=0.15)


@pytest.mark.browser
def test_the_scales_follow_the_pointer_and_a_written_load_levels_them(page_with, scales):
    page = page_with(scales, calm=True)
    view = "document.querySelector('.ddlib-weigh').view"

    def tilt():
        page.evaluate(NEXT_FRAME)
        return page.evaluate("""(() => {
          const { y1, y2 } = document.querySelector('.beam');
          return y2.baseVal.value - y1.baseVal.value; // positive: down on the network's side
        })()""")

    assert tilt() < -20
    for chart, place, reach in ((0, 0.75, 5), (1, 0.0, 10)):
        frame = page.locator(".chart path.frame").nth(chart).bounding_box()
        drag(page, frame, (0.5, 0.5), (place, 0.5))
        assert page.evaluate(f"{view}.get('reach')") == reach
    bare = page.locator(".load[d='M0 0']")
    assert 0 < tilt() < 12 and bare.count() == 1
    page.get_by_label("Load in the hand").fill("5")
    assert tilt() < -12 and bare.count() == 0
    page.get_by_label("Write it into the weights").check()
    assert abs(tilt()) < 12


def test_paths_add_up_to_the_network():
    model = results.median_network(21, JOINT_DAMPING.name)
    windows, _ = cases(committed.training(JOINT_DAMPING.name), 21)
    whole = gains(mean_gradient(model, windows), LOG_STEP)
    along = inertia_in_the_weights.paths()
    assert along.shape == (11, 3)
    assert np.allclose(along.sum(0), whole.reshape(-1, 2, 2, 3)[0, 0, 0])
