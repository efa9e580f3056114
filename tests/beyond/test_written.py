"""What is written by hand is there without training, and fails with the wrong sign; made small."""

from dataclasses import replace

import numpy as np
import pytest

from beyond.studies import written as study, written_pendulum as pendulum
from beyond.studies.two_link import regressor
from ddlib.analysis import gains
from ddlib.dynamics import CMU_DD_ARM_II, Arm, Link, with_load
from ddlib.setups import JOINT_DAMPING
from ddlib.simulation import LOG_STEP

SETUP = replace(JOINT_DAMPING, steps=0, decay=0.0)


@pytest.fixture(scope="module")
def row():
    setup, other = (one.repeated(3) for one in (SETUP, study.changed(SETUP)["3 kg"]))
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(study._NETWORKS, "descent", 2)
        model = study.learnt(setup, 21, "descent", 0)
        found = study._row(setup, other, model, "descent", 0)
    return found


def test_a_load_by_hand_is_most_of_what_the_network_lacks(row):
    error, tracking = row["error"], row["tracking"]
    assert error["written"].max() < 0.5 * error["unedited"].min()
    assert error["turned sign"].min() > 1.5 * error["unedited"].max()
    assert error["random filters"].min() > error["unedited"].max()
    assert error["rough filters"] == pytest.approx(error["written"], abs=0.05)
    assert tracking["written"].max() < 0.5 * tracking["unedited"].min()
    assert tracking["unedited"].max() < tracking["nothing"].min()
    assert error["nothing"] > 0.99 and len(error["written"]) == len(tracking["written"]) == 2


def test_what_is_written_is_read(row):
    """Within a fifth: by one pass, the slope of the outputs falls while the torques grow."""
    more = row["read"]["written"] - row["read"]["unedited"]
    assert more[..., 2] == pytest.approx(np.tile(row["change"][0, ..., 2], (2, 1, 1)), rel=0.2)


def test_the_change_is_that_of_the_equations():
    others, q = study.changed(SETUP), np.linspace(-1, 1, 20).reshape(5, 2, 2)
    change = study.difference(SETUP, others["3 kg"], q)
    loaded = with_load(CMU_DD_ARM_II, 3.0).mass_matrix(q) - CMU_DD_ARM_II.mass_matrix(q)
    assert change[..., 2] == pytest.approx(loaded.mean((0, 1))) and not change[..., :2].any()
    rubbing = study.difference(SETUP, others["no viscous friction"], q)
    assert rubbing[..., 1] == pytest.approx(-np.diag([5.3, 1.1])) and not rubbing[..., 2].any()
    whole = Arm.from_links("whole", Link(14.0, 0.5, 0.22, 0.4), Link(14.0, 0.4, 0.09, 0.6))
    half = replace(whole, a=whole.a - 7 * 0.5**2 - whole.d / 2, b=whole.b / 2, d=whole.d / 2)
    assert [getattr(study.LIGHT, k) for k in "abd"] == pytest.approx(
        [getattr(half, k) for k in "abd"]
    )
    assert whole.mass_matrix(q) == pytest.approx(CMU_DD_ARM_II.mass_matrix(q))


def test_other_filters_have_the_energy_or_the_moments():
    filters = study.other_filters(21, 4)
    own = study.moment_filters(21, LOG_STEP)
    energy = (own**2).sum(1)
    assert (filters["random filters"] ** 2).sum(1) == pytest.approx(energy)
    assert (filters["rough filters"] ** 2).sum(1) == pytest.approx(2 * energy)
    assert gains(filters["rough filters"], LOG_STEP) == pytest.approx(np.eye(3), abs=1e-9)
    assert np.abs(gains(filters["random filters"], LOG_STEP) - np.eye(3)).max() > 0.5


def test_slopes_of_the_pendulum_are_its_mass_matrix_and_its_gravity():
    states = np.random.default_rng(0).uniform(-1, 1, (50, 2, 3)) * [1, 0, 0]
    parameters = np.array([0.3, 0.05, 0.04, 2.0, 0.7, 0.1, *np.zeros(6)])
    slopes = pendulum._slopes(states, parameters)
    q = states[..., 0]
    a, b, d, g1, g2, rotor = parameters[:6]
    cosine = np.cos(q[:, 1]).mean()
    mass = [[a + 2 * b * cosine, d + b * cosine], [d + b * cosine, d + rotor]]
    assert slopes[..., 2] == pytest.approx(np.array(mass), rel=1e-6)
    hanging = g2 * np.cos(q.sum(1)).mean()
    upper = g1 * np.cos(q[:, 0]).mean()
    stiff = [[upper + hanging, hanging], [hanging, hanging]]
    assert slopes[..., 0] == pytest.approx(np.array(stiff), rel=1e-6)
    assert regressor(states).shape == (50, 2, 12)
