"""Measures of the real arm, on planted results with answers known by hand."""

import numpy as np
import pytest

from ddlib.analysis import CLASSES
from workshop.beyond.measures import real_arm, real_arm_filters
from workshop.report import results

BLOCKS = 5
PAPER = (11, 21, 41)


def same(error, members=3):
    """Mean squares of networks that all have one error, block by block."""
    return np.full((BLOCKS, members), error**2).tolist()


def alone(error):
    return np.full(BLOCKS, error**2).tolist()


def cell(width, rate=100, network=1.0, training=0.1, weight=2.0, **others):
    found = {"ridge": 0.5, "states": 0.6, "identified": 0.2, "no friction": 1.0, **others}
    return {
        "rate": rate, "width": width, "network": same(network),
        "network, training": same(training), "largest weight": np.full((BLOCKS, 3), weight),
        **{name: alone(error) for name, error in found.items()},
    }  # fmt: skip


def variant(test, training=0.1):
    return {"test": same(test), "training": same(training)}


@pytest.fixture
def plant(monkeypatch):
    """``plant(**parts)`` puts a result in place of the committed one."""

    def put(**parts):
        monkeypatch.setattr(results, "read", lambda name: {"real-arm": parts}[name])

    return put


# --- errors -------------------------------------------------------------------------------


def test_errors_are_pooled_over_blocks_and_networks(plant):
    row = cell(21)
    row["network"] = (np.arange(15.0).reshape(5, 3) ** 2).tolist()
    plant(grid=[row])
    assert real_arm.error().value == pytest.approx(np.sqrt(np.mean(np.arange(15.0) ** 2)))
    assert real_arm.error().text.startswith("blocks: 1.3, 4.1, ")
    assert real_arm.error(column="training").value == pytest.approx(0.1)


def test_the_worst_and_the_best_window(plant):
    plant(grid=[cell(w, network=e) for w, e in zip((5, *PAPER), (0.9, 0.7, 0.4, 0.8))])
    assert real_arm.worst_window().value == pytest.approx(0.8)  # 5 is not the paper's
    assert real_arm.best_window().value == 21
    assert real_arm.in_order("test", [21, [11, 41]]).value is True
    assert real_arm.in_order("test", [11, 21, 41]).value is False


def test_training_and_test(plant):
    pairs = zip(PAPER, (0.8, 0.6, 0.9), (0.2, 0.2, 0.1))
    plant(grid=[cell(w, network=a, training=b) for w, a, b in pairs])
    assert real_arm.worse_on_test().value == pytest.approx(3.0)
    assert real_arm.in_order("training", [41, [11, 21]]).value is True
    assert real_arm.in_order("training", [41, 21, 11]).value is False  # equal is not in order


def test_memory_and_magnitudes(plant):
    memory = {k: {"41": [a, a, a]} for k, a in (("shuffled", 0.9), ("phases", 0.3))}
    plant(memory=memory, grid=[cell(21, weight=4.0), cell(41, weight=1.0)])
    assert real_arm.memory().value == pytest.approx(0.9)
    assert real_arm.memory().text == "0.90 shuffled, 0.30 with random phases"
    assert real_arm.memory("phases").value == pytest.approx(0.3)
    assert real_arm.magnitudes().value == pytest.approx(0.25)


def test_ratios_of_models(plant):
    grid = [cell(5, ridge=0.4, identified=0.1), cell(21, states=0.7, network=0.8), cell(81, 500)]
    plant(grid=grid, processes={n: alone(e) for n, e in (("windows", 0.9), ("on the rest", 0.25))})
    assert real_arm.tailored().value == pytest.approx(1.4)
    assert real_arm.without_friction().value == pytest.approx(5.0)
    assert real_arm.network_over("ridge").value == pytest.approx(2.0)  # at 21, at 5
    assert real_arm.network_over("ridge").text == "0.80 at 21 against 0.40 at 5"
    assert real_arm.over_identified("ridge").value == pytest.approx(4.0)
    assert real_arm.process_over().value == pytest.approx(0.8 / 0.9)
    assert real_arm.process_over("identified", "on the rest").value == pytest.approx(0.8)


def test_blocks_are_drawn_together(plant):
    """Two models whose ratio is the same in every block: no draw of blocks changes it."""
    row = cell(21)
    row["ridge"] = np.arange(1.0, 6)
    row["states"] = 4 * np.arange(1.0, 6)
    plant(grid=[row])
    found = real_arm.tailored()
    assert found.value == pytest.approx(2.0)
    np.testing.assert_allclose(found.replicates, 2.0)


def test_differences(plant):
    row = {"states": alone(0.9), "identified": alone(0.3)}
    plant(differences={"500": row, "100": row}, grid=[cell(21, 500)])
    found = real_arm.differencing()
    assert found.value == pytest.approx(1.5)
    assert found.text.startswith("0.90 and 0.60 at 500 samples a second, 0.90 by differences")


def test_variants(plant):
    plant(
        grid=[cell(21, network=0.9)],
        variants={
            "20 units": variant(1.8), "10 epochs": variant(0.7), "100 epochs": variant(0.6),
            "20000 epochs": variant(1.2), "decay 0": variant(0.8), "decay 0.001": variant(0.45),
            "on the rest, decay 0.01": variant(0.3), "on the rest, decay 0.001": variant(0.5),
        },
    )  # fmt: skip
    assert real_arm.more_hidden_units().value == pytest.approx(2.0)
    assert real_arm.rises_again().value == pytest.approx(2.0)
    assert real_arm.rises_again().text == "1.2 after 20000 epochs, 0.60 after 100 epochs"
    assert real_arm.decay_over_ridge().value == pytest.approx(0.9)
    assert real_arm.decay_over_ridge().text == "0.45 with decay 0.001, 0.80 without; linear 0.50"
    assert real_arm.on_the_rest().value == pytest.approx(1.5)
    assert real_arm.on_the_rest().text == "0.30 with decay 0.01; alone 0.20"


def test_hidden_units_beside_a_linear_filter(plant):
    row = {"alone": alone(0.4), "with hidden units": same(0.2)}
    plant(**{"hidden units": {"training": row, "test": {**row, "alone": alone(0.1)}}})
    assert real_arm.hidden_units_add().value == pytest.approx(2.0)
    assert real_arm.hidden_units_add("test").value == pytest.approx(0.5)


def test_the_share_of_friction_is_the_median_joints(plant):
    plant(windows={"21": {"friction": [0.1, 0.2, 0.3, 0.5, 0.8, 0.9]}})
    assert real_arm.friction_share().value == pytest.approx(0.4)


# --- filters ------------------------------------------------------------------------------

TRUE = np.array([1.0, 2.0, 3.0, 4.0, 5.0, 6.0])


def names(velocity, members=4):
    each = np.zeros((members, len(CLASSES)))
    each[:, CLASSES.index("velocity")] = velocity
    each[:, CLASSES.index("jerk")] = 1 - velocity
    return {"hidden": each, "direct": np.zeros_like(each)}


def ensemble(factor, members=4, velocity=0.5):
    gain = np.asarray(factor) * TRUE * np.ones((members, 6))
    return {
        "velocity": gain, "acceleration": gain, "share of velocity": gain / 10,
        "unique velocity": gain / 10, "unique acceleration": gain / 20,
        "curved": gain / gain.max() if np.any(gain) else gain,
        "classes": names(velocity, members),
    }  # fmt: skip


def planted(real, *nulls):
    wanted = {"inertia": TRUE, "slope": TRUE}
    deviations = {"velocity": 1 / TRUE, "acceleration": np.ones(6)}
    return {
        "21": {
            "real": real, "untrained": ensemble(0, velocity=0.0), "identified": wanted,
            "nulls": dict(zip(("shifted", "phases"), nulls)), "friction": TRUE / 7,
            "deviations": deviations, "curved": np.tile([0.1, 0.2, 0.3, 0.5, 0.6, 0.7], (4, 1)),
        }
    }  # fmt: skip


def test_names_beside_the_null_that_gives_most(plant):
    nulls = ensemble(0, velocity=0.2), ensemble(0, velocity=0.3)
    plant(windows=planted(ensemble(1, velocity=0.5), *nulls))
    found = real_arm_filters.excess(21)
    assert found.value == pytest.approx(0.2 * 10 / 16)  # six direct filters have no name
    assert found.text.startswith("31 %; shifted 12 % (p 0.20); phases 19 % (p 0.20); untrained 0 %")


def test_gains_are_off_by_the_worst_joint(plant):
    real = ensemble([1.0, 1.1, 0.9, 1.0, 0.7, 1.2])
    plant(windows=planted(real, ensemble(0.0), ensemble(0.8)))
    for what in ("inertia", "friction"):
        found = real_arm_filters.calibrated(what, 21)
        assert found.value == pytest.approx(0.3)
        assert "0.70" not in found.text and found.text.endswith("as near by chance: p 1.00")


def test_the_typical_network_is_compared_with_single_networks(plant):
    """Networks that scatter far to both sides are right in the median and not one by one."""
    scattered = np.array([[0.5], [0.5], [1.5], [1.5]]) * np.ones(6)
    plant(windows=planted(ensemble(scattered), ensemble(0.6), ensemble(0.6)))
    assert np.median(scattered, 0)[0] == 1.0
    assert real_arm_filters.beyond_null("friction", 21).value == 0


def test_joints_that_chance_does_not_reach(plant):
    real = ensemble([1.0, 1.1, 0.9, 1.0, 0.7, 1.2])
    plant(windows=planted(real, ensemble(0.0), ensemble(0.85)))
    found = real_arm_filters.beyond_null("friction", 21)
    assert found.value == 4  # 0.7 and 1.2 are further off than 0.85
    plant(windows=planted(real, ensemble(0.0), ensemble(0.0)))
    assert real_arm_filters.beyond_null("inertia", 21).value == 6


def test_correlations_are_in_units_of_each_joint(plant):
    plant(windows=planted(ensemble(2.0), ensemble(-1.0), ensemble(-2.0)))
    found = real_arm_filters.follow("inertia", 21)
    assert found.value == pytest.approx(2.0)  # 1 less -1
    assert found.text.startswith("r 1.00; unrelated currents reach -1.00")
    up = ensemble([1, 2, 3, 4, 5, 7])
    plant(windows=planted(up, ensemble(0.0), ensemble(0.0)))
    flat = real_arm_filters.follow("friction", 21)  # as a share the friction is the same everywhere
    assert flat.value == 0


def test_shares_and_friction(plant):
    plant(windows=planted(ensemble(1.0), ensemble(-1.0), ensemble(1.0)))
    found = real_arm_filters.shares_follow(21)
    assert found.value == pytest.approx(1.0) and found.text == "r 1.00; as high by chance: p 1.00"


def test_joints_that_follow_more_than_chance(plant):
    real = ensemble([1.0, 0.5, 1.0, 0.1, 1.0, 0.9])
    plant(windows=planted(real, ensemble(0.2), ensemble(0.6)))
    for what in ("velocity", "acceleration"):
        assert real_arm_filters.unique_beyond(what, 21).value == 4
    text = real_arm_filters.unique_beyond("velocity", 21).text
    assert text.startswith("10 (6), 10 (12), 30 (18), 4 (24), ")


def test_the_median_output_is_judged(plant):
    plant(windows=planted(ensemble(1.0), ensemble(0.0), ensemble(0.0)))
    found = real_arm_filters.compensate_friction(21)
    assert found.value == pytest.approx(0.4)
    assert found.text.endswith("unrelated currents reach 0.00 in one of twenty")
    plant(windows=planted(ensemble(1.0), ensemble(0.0), ensemble(1.0)))
    half = np.median(TRUE / TRUE.max())
    assert real_arm_filters.compensate_friction(21).text.endswith(
        f"reach {half:.2f} in one of twenty"
    )
