"""The arm and its torque by terms: curves against ddlib, guesses, time, and keys."""

from __future__ import annotations

import numpy as np
import pytest
from widget_pages import NEXT_FRAME, SET, assert_curves

from ddlib.dynamics import CMU_DD_ARM_II, with_load
from ddlib.setups import JOINT_DAMPING
from ddlib.trajectories import APPENDIX_I, pick_and_place
from workshop.chapters.widgets.terms import TorqueTerms

TERMS = ("centrifugal", "coupling", "Coriolis", "inertial")
SETTINGS = [
    {},
    {"doubled": True, "motion": 3},
    {"load": 10, "friction": True, "motion": 5},
    {"load": 5, "friction": True, "doubled": True, "motion": 6},
]


@pytest.fixture(scope="module")
def terms():
    return TorqueTerms()


def known(motion=1, load=0, doubled=False, friction=False):
    """Torques by the arm's equations, at the middles of a hundred parts of the motion."""
    seconds = 1.5 if doubled else 3.0
    time = seconds * np.linspace(0.005, 0.995, 100)
    q, qd, qdd = pick_and_place(APPENDIX_I[motion - 1], time, seconds)
    rubbing = JOINT_DAMPING.effects.friction_torque(qd) if friction else np.zeros_like(qd)
    whole = with_load(CMU_DD_ARM_II, load).inverse_dynamics(q, qd, qdd) + rubbing
    return {
        f"{joint} {name}": x[:, j]
        for name, x in {"actuation": whole, "friction": rubbing}.items()
        for j, joint in enumerate(("shoulder", "elbow"))
    }


@pytest.mark.parametrize("levels", SETTINGS)
def test_terms_add_up_to_the_torque(terms, levels):
    curves = terms.curves_at(**levels)
    for name, torque in known(**levels).items():
        np.testing.assert_allclose(curves[name], torque, atol=1e-9)
    for joint in ("shoulder", "elbow"):
        parts = sum(curves[f"{joint} {term}"] for term in (*TERMS, "friction"))
        np.testing.assert_allclose(parts, curves[f"{joint} actuation"], atol=1e-9)


def test_double_speed_is_four_times_every_term_but_friction(terms):
    slow, fast = (terms.curves_at(doubled=x, friction=True) for x in (False, True))
    for joint in ("shoulder", "elbow"):
        for term in TERMS:
            np.testing.assert_allclose(
                fast[f"{joint} {term}"], 4 * slow[f"{joint} {term}"], atol=1e-9
            )
        ratio = np.abs(fast[f"{joint} friction"]).max() / np.abs(slow[f"{joint} friction"]).max()
        assert 1 < ratio < 2
        assert fast[f"{joint} ratio"] == pytest.approx(slow[f"{joint} ratio"])
        np.testing.assert_allclose(
            fast[f"{joint} at single speed"], slow[f"{joint} actuation"], atol=1e-9
        )


def test_code_gives_the_root_mean_squares(terms):
    place = {}
    *lines, last = terms.code.splitlines()
    exec("\n".join(lines), place)
    printed = eval(last, place)
    curves = terms.curves_at()
    for name in ("inertial", "coupling", "centrifugal"):
        rms = np.sqrt((curves[f"elbow {name}"] ** 2).mean())
        assert printed[name][1] == pytest.approx(rms, rel=1e-6)


@pytest.mark.browser
def test_the_page_computes_the_same(page_with, terms):
    page = page_with(terms)
    for levels in SETTINGS:
        page.evaluate(SET, {**terms.values, **levels})
        assert_curves(page, terms.curves_at(**levels), 1e-6)


def names(page):
    page.evaluate(NEXT_FRAME)
    return page.locator(".chart").nth(1).locator(".legend span").all_inner_texts()


@pytest.mark.browser
def test_guess_then_double_the_speed(page_with, terms):
    page = page_with(terms)
    assert names(page)[1:5] == list("ABCD")
    page.get_by_role("button", name="inertial").press("Enter")
    assert names(page)[1:5] == list(TERMS)
    verdict = page.locator(".guess .verdict")
    assert verdict.inner_text().startswith("Not inertial: the largest at the elbow is coupling")
    page.get_by_role("button", name="The ratio stays").click()
    assert verdict.inner_text().startswith("Yes, the ratio stays")
    assert_curves(page, terms.curves_at(doubled=True))
    assert page.get_by_role("switch", name="Double the speed").is_checked()


@pytest.mark.browser
def test_time_moves_the_arm_and_plays_twice_as_fast(page_with, terms):
    page = page_with(terms)
    arm = ".arm.real .links"
    start = page.get_attribute(arm, "d")
    page.get_by_role("slider", name="Time").press("Home")
    page.evaluate(NEXT_FRAME)
    assert page.get_attribute(arm, "d") != start
    page.get_by_role("switch", name="Double the speed").check()
    page.get_by_role("slider", name="Time").press("End")
    page.evaluate(NEXT_FRAME)
    assert page.locator(".player output").inner_text().startswith("1.50")
    page.get_by_role("button", name="Play").click()
    page.wait_for_function("parseFloat(document.querySelector('.player output').textContent) > 0.3")
    page.get_by_role("button", name="Pause").click()


@pytest.mark.browser
def test_who_wants_no_motion_steps_by_play(page_with, terms):
    page = page_with(terms, calm=True)
    page.get_by_role("slider", name="Time").press("Home")
    for moment in ("0.50", "1.00"):
        page.get_by_role("button", name="Play").click()
        page.wait_for_timeout(600)
        assert page.locator(".player output").inner_text().startswith(moment)
