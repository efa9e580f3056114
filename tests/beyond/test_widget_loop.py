"""The loop with a learner inside: what the page shows is what the laws did."""

import numpy as np
import pytest
from widget_pages import assert_exact_table

from beyond.chapters.widgets import loop
from beyond.studies.loop import adaptive_laws as runs
from beyond.studies.page import learner
from ddlib.dynamics import CMU_DD_ARM_II, with_load
from ddlib.effects import Effects
from ddlib.setups import JOINT_DAMPING, JOINT_DAMPING_COULOMB, JOINT_DAMPING_VISCOUS
from workshop.report import results


@pytest.fixture(scope="module")
def widget():
    return loop.LoopLearner()


def truths(load):
    """True values of what is shown."""
    arm = with_load(CMU_DD_ARM_II, load)
    friction = JOINT_DAMPING_VISCOUS[0], JOINT_DAMPING_COULOMB[0]
    return np.array([arm.a, arm.b, arm.d, *friction])


def test_the_page_shows_the_committed_result_in_every_setting(widget):
    assert_exact_table(widget)
    kept, rate = results.read("loop-learner")["loads"], list(loop.SPEEDS).index("ten times")
    shown = {"a": 0, "b": 1, "d": 2, "F_v1": 3, "F_c1": 5}  # by place among the estimates
    for who in kept["5"]:
        widget.load, widget.friction, widget.learner, widget.rate = 5, True, who, "ten times"
        errors = np.minimum(kept["5"][who]["errors"][1][rate], 20)
        np.testing.assert_array_equal(widget.curves["error"], errors)
        estimates = np.array(kept["5"][who]["estimates"][1][rate])[:, list(shown.values())]
        for name, wanted in zip(shown, (estimates / truths(5)).T):
            np.testing.assert_allclose(widget.curves[name], np.clip(wanted, -2, 6))
        baked = widget.at_grid()
        for name, values in widget.curves.items():
            np.testing.assert_allclose(baked[name], values, atol=2e-3 * max(1.0, np.ptp(values)))


def test_errors_of_many_runs_are_those_of_one_run_alone():
    kept = results.read("loop-learner")["loads"]["5"]["Slotine & Li"]
    errors, estimates = np.array(kept["errors"]), np.array(kept["estimates"])
    friction, rate = 1, list(learner.SPEEDS).index("as in the chapter")
    arm = with_load(CMU_DD_ARM_II, 5)
    effects = Effects(
        friction=JOINT_DAMPING.effects.friction,
        actuator=JOINT_DAMPING.effects.actuator,
        encoder=JOINT_DAMPING.effects.encoder,
    )
    laws = {"own": runs.make("with friction", JOINT_DAMPING, runs.TRUTH[None])}
    found, after = runs.run_trials(
        laws, runs.drawn_extents(1, learner._MOTIONS, 11)[:2], arm, effects
    )
    alone = runs.errors_by_law(found, laws)["own"][:, 0]
    np.testing.assert_allclose(errors[friction, rate, :2], alone, rtol=1e-4)
    last = after["own"].estimate[0]
    np.testing.assert_allclose(estimates[friction, rate, 2], last, rtol=1e-4, atol=1e-9)
