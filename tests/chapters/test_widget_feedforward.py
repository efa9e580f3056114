"""Figure 2-1 as a thing to switch, in Python and in a page without a kernel."""

from __future__ import annotations

import numpy as np
import pytest
from widget_pages import SET, assert_curves

from ddlib.control import Feedforward, proportional
from ddlib.effects import CoulombFriction, Effects, ViscousFriction
from ddlib.setups import (
    JOINT_DAMPING,
    JOINT_DAMPING_COULOMB,
    JOINT_DAMPING_KP as KP,
    JOINT_DAMPING_VISCOUS,
)
from ddlib.simulation import record
from ddlib.trajectories import APPENDIX_I
from workshop.chapters.widgets.feedforward import FeedforwardSwitches


@pytest.fixture(scope="module")
def switches():
    return FeedforwardSwitches()


def test_with_the_jump_it_is_a_recording(switches):
    """By `record`, whose motion follows a rest."""
    arm = JOINT_DAMPING.arm
    law = Feedforward(arm, proportional(KP))
    joints = ViscousFriction(JOINT_DAMPING_VISCOUS), CoulombFriction(JOINT_DAMPING_COULOMB)
    recording = record(arm, law, APPENDIX_I[0], effects=Effects(friction=joints))
    shown = switches.curves_at(model=True, jump=True)
    moving = recording.motion
    error = np.rad2deg(recording.tracking_error[moving, 0])
    np.testing.assert_allclose(shown["shoulder error"], error, atol=1e-6)
    torque = shown["shoulder ahead"] + shown["shoulder back"]
    np.testing.assert_allclose(torque, recording.tau_true[moving, 0], atol=1e-5)
    assert len(error) == 300


def test_model_and_feedback_multiply(switches):
    """On the arm without friction a model's error is the share that is left."""
    for masses in (0, 80, 100, 200):
        share = switches.curves_at(model=True, masses=masses, friction=False)["share"][0]
        assert share == pytest.approx(abs(100 - masses), abs=0.5)
    rubbing = [switches.curves_at(model=True, known=known)["share"][0] for known in (0 > 1, True)]
    assert 25 < rubbing[0] < 45 and rubbing[1] < 1
    assert switches.curves_at(model=True, feedback=False)["share"][0] > 1000


@pytest.mark.browser
def test_the_page_computes_and_says_the_same(page_with, switches):
    page = page_with(switches)
    figure = page.locator("svg.figure")
    assert "the model gives nothing" in figure.get_attribute("aria-label")
    for setting, look in (
        ({"model": True, "masses": 130.0, "known": True}, "figure"),
        ({"model": True, "feedback": False}, "figure no-feedback"),
        ({"model": True, "friction": False, "jump": True}, "figure"),
    ):
        page.evaluate(SET, {**switches.values, **setting})
        assert_curves(page, switches.curves_at(**setting), 1e-5)
        assert figure.get_attribute("class").split() == look.split()
        box, words = (page.locator(f".box.model {x}").bounding_box() for x in ("rect", ".small"))
        assert box["x"] < words["x"] and words["width"] < box["width"]
        assert "the model gives nothing" not in figure.get_attribute("aria-label")
