"""The loop with a learner inside: what the page shows is what the laws did."""

import numpy as np
import pytest
from traitlets import TraitError

from ddlib.dynamics import CMU_DD_ARM_II, with_load
from ddlib.effects import Effects
from ddlib.experiments import JOINT_DAMPING
from ddlib.experiments.studies.loop.runs import adaptive as runs
from ddlib.widgets.baking.baked import MAX_BYTES
from ddlib.widgets.beyond import loop


@pytest.fixture(scope="module")
def widget():
    return loop.LoopLearner(checks=30)


def test_the_page_shows_the_same_in_every_setting(widget):
    assert widget.baked_bytes < MAX_BYTES / 10
    assert widget.interpolation_error(60) < 1e-3
    for learner in loop.LEARNERS:
        widget.load, widget.friction, widget.learner, widget.rate = 0, False, learner, "ten times"
        baked = widget.interpolate()
        for name, values in widget.curves.items():
            np.testing.assert_allclose(baked[name], values, atol=2e-3 * max(1.0, np.ptp(values)))


def test_its_errors_are_those_of_one_run_alone(widget):
    widget.load, widget.friction, widget.learner = 5, True, "Slotine & Li"
    widget.rate = "as in the chapter"
    arm = with_load(CMU_DD_ARM_II, 5)
    effects = Effects(
        friction=JOINT_DAMPING.effects.friction,
        actuator=JOINT_DAMPING.effects.actuator,
        encoder=JOINT_DAMPING.effects.encoder,
    )
    laws = {"own": runs.make("with friction", JOINT_DAMPING, runs.TRUTH[None])}
    found, after = runs.trials(laws, runs.drawn(1, loop.MOTIONS, 11)[:2], arm, effects)
    errors = runs.by_law(found, laws)["own"][:, 0]
    np.testing.assert_allclose(widget.curves["error"][:2], errors, rtol=1e-4)
    relative = after["own"].estimate[0] / loop.truth(5)
    assert widget.curves["a"][2] == pytest.approx(relative[0], rel=1e-4)
    assert widget.curves["F_c1"][2] == pytest.approx(relative[5], rel=1e-4)


def test_estimates_begin_at_the_unloaded_arm_and_nobody_learns_without_a_learner(widget):
    widget.load, widget.friction, widget.learner = 5, True, "none"
    curves = widget.curves
    np.testing.assert_array_equal(curves["error"], curves["nobody"])
    assert np.ptp(curves["a"]) == 0 and curves["F_v1"][0] == 0
    assert curves["a"][0] == pytest.approx(runs.TRUTH[0] / with_load(CMU_DD_ARM_II, 5).a)


def test_what_is_not_offered_is_refused(widget):
    with pytest.raises(TraitError, match="load must be one of"):
        widget.load = 3
