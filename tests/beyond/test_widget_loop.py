"""The loop with a learner inside: what the page shows is what the laws did."""

import numpy as np
import pytest
from traitlets import TraitError
from widget_pages import NEXT_FRAME, page_of

from ddlib.dynamics import CMU_DD_ARM_II, with_load
from ddlib.effects import Effects
from ddlib.setups import JOINT_DAMPING
from ddlib.widgets import Choice, CurveWidget, Panel
from ddlib.widgets.baking.baked import MAX_BYTES
from workshop.beyond.studies.loop.runs import adaptive as runs
from workshop.beyond.studies.page import learner
from workshop.beyond.widgets import loop
from workshop.report import results


@pytest.fixture(scope="module")
def widget():
    return loop.LoopLearner(checks=30)


def test_the_page_shows_the_same_in_every_setting(widget):
    assert widget.baked_bytes < MAX_BYTES / 10
    assert widget.interpolation_error(60) < 1e-3
    for who in loop.LEARNERS:
        widget.load, widget.friction, widget.learner, widget.rate = 0, False, who, "ten times"
        baked = widget.interpolate()
        for name, values in widget.curves.items():
            np.testing.assert_allclose(baked[name], values, atol=2e-3 * max(1.0, np.ptp(values)))


def test_it_shows_the_committed_result(widget):
    widget.load, widget.friction, widget.learner = 5, True, "Craig, Hsu & Sastry"
    widget.rate = "ten times"
    rate = list(loop.SPEEDS).index("ten times")
    kept = results.read("loop-learner")["loads"]["5"]["Craig, Hsu & Sastry"]
    errors = np.minimum(kept["errors"][1][rate], loop.MOST_ERROR)
    np.testing.assert_array_equal(widget.curves["error"], errors)
    estimates = np.array(kept["estimates"][1][rate])[:, 2]
    np.testing.assert_allclose(widget.curves["d"], estimates / loop.truth(5)[2])


def test_errors_of_many_runs_are_those_of_one_run_alone():
    errors, estimates = learner._learned(5)["Slotine & Li"].values()
    friction, rate = 1, list(learner.SPEEDS).index("as in the chapter")
    arm = with_load(CMU_DD_ARM_II, 5)
    effects = Effects(
        friction=JOINT_DAMPING.effects.friction,
        actuator=JOINT_DAMPING.effects.actuator,
        encoder=JOINT_DAMPING.effects.encoder,
    )
    laws = {"own": runs.make("with friction", JOINT_DAMPING, runs.TRUTH[None])}
    found, after = runs.trials(laws, runs.drawn(1, learner.MOTIONS, 11)[:2], arm, effects)
    alone = runs.by_law(found, laws)["own"][:, 0]
    np.testing.assert_allclose(errors[friction, rate, :2], alone, rtol=1e-4)
    np.testing.assert_allclose(
        estimates[friction, rate, 2], after["own"].estimate[0], rtol=1e-4, atol=1e-9
    )


def test_estimates_begin_at_the_unloaded_arm_and_nobody_learns_without_a_learner(widget):
    widget.load, widget.friction, widget.learner = 5, True, "none"
    curves = widget.curves
    np.testing.assert_array_equal(curves["error"], curves["nobody"])
    assert np.ptp(curves["a"]) == 0 and curves["F_v1"][0] == 0
    assert curves["a"][0] == pytest.approx(runs.TRUTH[0] / with_load(CMU_DD_ARM_II, 5).a)


def test_what_goes_beyond_the_charts_is_cut_off_and_marked(widget):
    limits = [panel["limits"] for panel in widget.spec["panels"]]
    assert limits == [[None, loop.MOST_ERROR], list(loop.BOUNDS)]
    assert "a hundred times" in loop.SPEEDS
    cut = 0
    for load in loop.LOADS:
        for name, (errors, estimates) in loop.learned(load).items():
            relative = estimates[..., list(loop.SHOWN.values())] / truths(load)
            gone = (relative <= loop.BOUNDS[0]) | (relative >= loop.BOUNDS[1])
            cut += gone.sum() + (errors >= loop.MOST_ERROR).sum()
            assert np.isfinite(errors).all() and np.isfinite(estimates).all()
            if name == "none":
                assert not gone.any() and (errors < loop.MOST_ERROR).all()
    assert cut > 0
    for curve in widget.spec["curves"]:
        low, high = limits[curve["name"] not in ("error", "nobody")]
        assert curve["high"] <= high + 1e-9 and (low is None or curve["low"] >= low - 1e-9)


def truths(load):
    return loop.truth(load)[list(loop.SHOWN.values())]


@pytest.mark.browser
def test_a_triangle_marks_what_was_cut_off(tmp_path, visit):
    """On a small figure with known values: one beyond above, one below, the others within."""
    x, values = np.arange(5), np.array([0.0, 6.0, 1.0, -2.0, 3.0])
    widget = CurveWidget(
        lambda on: {"y": values * (1 if on else 0.4)},
        [Choice("on", "Whole", {False: "off", True: "on"}, True, "switch")],
        [Panel("y, m", "y", "x", x, y_fit=True, limits=(-2, 6))],
        alt="A line",
    )
    opened = visit(page_of(tmp_path / "page.html", widget))
    page = opened.page
    page.evaluate(NEXT_FRAME)
    drawn = "document.querySelector('path.beyond').getAttribute('d').match(/M/g)?.length ?? 0"
    assert page.evaluate(drawn) == 2
    chart = page.locator(".chart > svg")
    chart.press("Home")
    readout = page.locator(".readout")
    assert "0" in readout.inner_text() and "beyond" not in readout.inner_text()
    chart.press("ArrowRight")
    assert "beyond 6" in readout.inner_text()
    page.get_by_role("switch").press("Space")
    page.evaluate(NEXT_FRAME)
    assert page.evaluate(drawn) == 0
    assert not opened.problems


@pytest.mark.parametrize("limits", [(1, 1), (2, 1), (0,), (np.nan, 1)])
def test_bad_limits_are_refused(limits):
    with pytest.raises(ValueError, match="limits of 'y, m' must"):
        Panel("y, m", "y", "x", [0, 1], limits=limits)
    with pytest.raises(ValueError, match="must be of lines"):
        Panel("y, m", "y", "x", [0, 1], kind="bars", limits=(0, 1))


def test_what_is_not_offered_is_refused(widget):
    with pytest.raises(TraitError, match="load must be one of"):
        widget.load = 3
