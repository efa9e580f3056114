"""Filters and errors on a real arm, on planted results with answers known by hand."""

import numpy as np
import pytest

from beyond.chapters import real_arm
from ddlib.analysis import CLASSES

pytestmark = pytest.mark.usefixtures("planted_members")

TRUE = np.array([1.0, 2.0, 3.0, 4.0, 5.0, 6.0])
OFF = [1.0, 1.1, 0.9, 1.0, 0.7, 1.2]


@pytest.fixture
def ensembles(planted_results):
    """``ensembles(real, *nulls)`` puts networks of such gains, over the true ones, in place."""

    def put(real, *nulls):
        planted_results(**{"real-arm": {"windows": {"21": {
            "real": ensemble(real), "untrained": ensemble(0, velocity=0.0),
            "identified": {"inertia": TRUE, "slope": TRUE}, "friction": TRUE / 7,
            "nulls": {k: ensemble(*n) for k, n in zip(("shifted", "phases"), nulls)},
            "deviations": {"velocity": 1 / TRUE, "acceleration": np.ones(6)},
            "curved": np.tile([0.1, 0.2, 0.3, 0.5, 0.6, 0.7], (4, 1)),
        }}}})  # fmt: skip

    return put


def ensemble(factor, velocity=0.5):
    gain = np.asarray(factor) * TRUE * np.ones((4, 6))
    hidden = np.zeros((4, len(CLASSES)))
    hidden[:, CLASSES.index("velocity")] = velocity
    hidden[:, CLASSES.index("jerk")] = 1 - velocity
    return {
        "velocity": gain, "acceleration": gain, "share of velocity": gain / 10,
        "unique velocity": gain / 10, "unique acceleration": gain / 20,
        "curved": gain / gain.max() if np.any(gain) else gain,
        "classes": {"hidden": hidden, "direct": np.zeros_like(hidden)},
    }  # fmt: skip


def test_names_beside_the_null_that_gives_most(ensembles):
    ensembles(1, (0, 0.2), (0, 0.3))
    found = real_arm.excess(21)
    assert found.value == pytest.approx(0.2 * 10 / 16)  # six direct filters have no name
    assert found.text == "31 %; shifted 12 % (p 0.20); phases 19 % (p 0.20); untrained 0 %"


def test_gains_are_off_by_the_worst_joint_and_beside_chance(ensembles):
    ensembles(OFF, (0.0,), (0.85,))
    for what in ("inertia", "friction"):
        found = real_arm.calibrated(what, 21)
        assert found.value == pytest.approx(0.3) and found.text.endswith("by chance: p 1.00")
    assert real_arm.beyond_null("friction", 21).value == 4  # 0.7 and 1.2 are further off than 0.85
    ensembles(OFF, (0.0,), (0.0,))
    assert real_arm.beyond_null("inertia", 21).value == 6
    # networks that scatter far to both sides are right in the median and not one by one
    ensembles(np.array([[0.5], [0.5], [1.5], [1.5]]) * np.ones(6), (0.6,), (0.6,))
    assert real_arm.beyond_null("friction", 21).value == 0


def test_correlations_are_in_units_of_each_joint(ensembles):
    ensembles(2.0, (-1.0,), (-2.0,))
    found = real_arm.follow("inertia", 21)
    assert found.value == pytest.approx(2.0)  # 1 less -1
    assert found.text.startswith("r 1.00; unrelated currents reach -1.00")
    ensembles([1, 2, 3, 4, 5, 7], (0.0,), (0.0,))
    assert real_arm.follow("friction", 21).value == 0  # as a share it is the same everywhere
    ensembles(1.0, (-1.0,), (1.0,))
    assert real_arm.shares_follow(21)[:2] == (
        pytest.approx(1.0),
        "r 1.00; as high by chance: p 1.00",
    )
