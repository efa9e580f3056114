"""Measures of the filters' trial on a planted trial."""

import numpy as np
import pytest

from ddlib.analysis import CLASSES
from ddlib.learning import cases
from ddlib.setups import split
from ddlib.simulation import LOG_STEP
from workshop.report import committed, results
from workshop.report.measures import filter_trial as trial
from workshop.report.studies.nulls import TRIAL


def ensemble(velocity, acceleration, count, **more):
    """Networks or draws with given shares of two classes, the rest not analysable."""
    classes = {name: [0.0] * count for name in CLASSES}
    classes |= {"velocity": [velocity] * count, "acceleration": [acceleration] * count}
    classes["not analysable"] = [1 - velocity - acceleration] * count
    layer = {"classes": classes, "changes": classes}
    return {"hidden": layer, "direct": layer, **more}


@pytest.fixture
def planted(monkeypatch):
    """Give it a row; it becomes what the trial found, at any window."""

    def plant(row):
        asked = []

        def read(name):
            asked.append(name)
            return {"windows": {"21": row, "41": row}, "rows": {"two sines": row}}

        monkeypatch.setattr(results, "read", read)
        return asked

    return plant


def row(real, untrained, **nulls):
    return {"real": real, "untrained": untrained,
            "nulls": {name.replace("_", " "): null for name, null in nulls.items()}}  # fmt: skip


def test_shares_are_judged_by_the_null_that_has_most(planted):
    asked = planted(
        row(
            ensemble(0.5, 0.25, 8), ensemble(0, 0, 5), shifted=ensemble(0.25, 0.5, 19),
            phases=ensemble(0.4, 0.1, 19), shuffled=ensemble(0.9, 0, 5),
        )
    )  # fmt: skip
    found = trial.excess("velocity")
    assert found.value == pytest.approx(0.1)  # 0.5 less 0.4: the white null does not count
    assert found.replicates == pytest.approx(0.1)
    assert found.text == "50 %; shifted 25 % (p 0.05); phases 40 % (p 0.05); untrained 0 %"
    assert trial.excess("acceleration", 41).value == pytest.approx(-0.25)
    assert trial.excess("velocity|acceleration", layer="both").value == pytest.approx(0)
    assert trial.excess("any", "two sines", "direct", "changes").value == pytest.approx(0)
    assert asked[0] == asked[1] == "filter-trial" and asked[-1] == "filter-trial-elsewhere"


def test_both_layers_count_by_their_filters(planted):
    real, null = ensemble(0.5, 0, 6), ensemble(0, 0, 6)
    real["direct"] = ensemble(0.1, 0, 6)["direct"]
    planted(row(real, null, phases=null))
    assert trial.excess("velocity", layer="both").value == pytest.approx((20 * 0.5 + 4 * 0.1) / 24)


def test_other_numbers_beside_the_null_that_has_most(planted):
    real, before = {"cancelled": [0.8, 0.6, 0.7, 0.7, 0.7]}, {"cancelled": [0.5] * 5}
    nulls = {"shifted": {"cancelled": [0.6] * 6}, "other_run": {"cancelled": [0.65] * 6}}
    planted(row(real, before, **nulls))
    found = trial.above_null("cancelled")
    assert found.value == pytest.approx(0.05)
    assert found.text == "0.70; shifted 0.60; other run 0.65; untrained 0.50"
    assert np.median(found.replicates) == pytest.approx(0.05)


def test_units_that_follow_a_quantity(planted):
    def heard(*shares):
        return {"hidden": {"strongest": [list(shares)] * 6}}

    planted(row(heard(0.2, 0.3, 0.4, 0.1), None, shifted=heard(0.5, 0.3, 0.2, 0),
                phases=heard(0.9, 0, 0.1, 0)))  # fmt: skip
    assert trial.follow("acceleration").value == pytest.approx(0.2)
    found = trial.follow("velocity|acceleration")
    assert found.value == pytest.approx(0.2)
    assert found.text == "70 %; shifted 50 %; phases 10 %"


def test_gains_of_the_arm_by_other_means():
    """Mean mass matrix over the recorded positions; friction at a speed is the slope times it."""
    wanted = trial.arm_gains()
    q = split(TRIAL.record())[0].q_true
    training = split(TRIAL.record())[0]
    q = training.q_true[:, training.motion].reshape(-1, 2)
    a, b, d = TRIAL.arm.a, TRIAL.arm.b, TRIAL.arm.d
    mean = np.cos(q[:, 1]).mean()
    inertia = [[a + 2 * b * mean, d + b * mean], [d + b * mean, d]]
    assert np.allclose(wanted[..., 2], inertia)
    assert not wanted[..., 0].any()
    viscous = np.array([5.3, 1.1])
    slope = np.diag(wanted[..., 1])
    assert (slope > viscous).all() and (slope < 2 * viscous).all()  # Coulomb friction on top
    assert np.abs(wanted[..., 1] - np.diag(slope)).max() < 0.4


def test_gains_are_judged_by_their_worst_entry(planted):
    wanted = trial.arm_gains()
    off = wanted.copy()
    off[0, 0, 2] *= 1.1
    off[1, 1, 2] *= 0.8
    off[0, 0, 1] *= 1.5
    real = {"gains": [off.tolist()] * 7, "gains, direct": [wanted.tolist()] * 7}
    null = {"gains": [(1.9 * wanted).tolist()] * 18 + [wanted.tolist()],
            "gains, direct": [(0 * wanted).tolist()] * 19}  # fmt: skip
    planted(row(real, None, phases=null))
    found = trial.calibrated("inertia")
    assert found.value == pytest.approx(0.2)
    assert found.replicates == pytest.approx(0.2)
    m = wanted[0, 0, 2]
    assert found.text.startswith(f"M₁₁ {1.1 * m:.2f} (arm {m:.2f}), M₁₂ ")
    assert found.text.endswith(" kg m²; as near by chance: p 0.10")  # one draw of 19, and itself
    assert trial.calibrated("friction").value == pytest.approx(0.5)
    direct = trial.calibrated("friction", path="gains, direct")
    assert direct.value == pytest.approx(0)
    assert direct.text.endswith(" N m s/rad; as near by chance: p 0.05")


def test_probes_beside_those_before_training(planted):
    def probed(*probe):
        return {"probe": [list(probe)] * 6, "probe of sign": [[0.6, 0.8]] * 6}

    good, better, worse = probed(0.9, 0.1, 0.5, 0.3), probed(1, 0, 0.8, 0), probed(0.3, 0, 0.1, 0)
    planted(row(good, worse, phases=better))
    assert trial.readable("velocity").value == pytest.approx(0.7 - 0.9)  # the best control
    planted(row(good, better, phases=worse))
    found = trial.readable("velocity")
    assert found.value == pytest.approx(0.7 - 0.9)
    assert found.text == "0.70; untrained 0.90; phases 0.20"
    found = trial.readable("acceleration", "two sines")
    assert found.value == pytest.approx(0.2) and found.text == "0.20; untrained 0.00; phases 0.00"
    assert trial.readable("sign").value == pytest.approx(0)
    assert trial.readable("sign").text.startswith("0.70; ")


def test_interventions_are_ratios_to_the_networks_own(planted):
    def errors(training, test, again):
        return {"at once": [[training, test]] * 6, "refitted": [[again, 2 * again]] * 6}

    planted(
        {
            "interventions": {
                "as trained": errors(0.1, 0.2, 0.05),
                "pure parts": errors(0.3, 0.5, 0.06),
                "linear filter alone": [0.11, 0.12],
            }
        }
    )
    found = trial.replaced("pure parts")
    assert found.value == pytest.approx(3)
    assert found.text == "error 0.30, with its own 0.10; a linear filter alone 0.11"
    assert trial.replaced("pure parts", runs="trajectory 6").value == pytest.approx(2.5)
    assert trial.replaced("pure parts", refitted=True).value == pytest.approx(1.2)


def test_networks_of_the_table_are_judged_by_gains_that_finite_differences_confirm():
    """A slow parabola added to one joint's window moves the torque by the inertia (and more)."""
    found = trial.calibrated_networks(11, "state feedback")
    windows, _ = cases(committed.training("state feedback"), 11)
    model, x = committed.networks(11, "state feedback"), (np.arange(11) - 5) * LOG_STEP
    true = trial.arm_gains("state feedback")[..., 2]
    moved = np.empty((len(model.weights), 2, 2))
    for joint in range(2):
        bump = np.zeros((2, 11))
        bump[joint] = x**2 / 2
        there, back = (model.torque(windows + side * bump) for side in (1e-1, -1e-1))
        moved[..., joint] = ((there - back) / 2e-1).mean(-2)
    worst = np.abs(np.median(moved, 0) / true - 1).max()
    assert found.value == pytest.approx(worst, rel=1e-2)


def test_stiffness_is_a_share_of_what_the_inertia_is_worth(planted):
    wanted = trial.arm_gains()
    worth = (np.pi / 3) ** 2 * wanted[0, 0, 2]
    gains = wanted.copy()
    gains[0, 0, 0] = -worth / 2
    planted(row({"gains": [gains.tolist()] * 5}, None))
    found = trial.stiffness()
    assert found.value == pytest.approx(0.5) and found.replicates == pytest.approx(0.5)
    planted(row({"gains": [wanted.tolist()] * 5}, None))
    assert trial.stiffness().value == 0
