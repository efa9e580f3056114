"""Measures of the filters' trial on a planted trial."""

import numpy as np
import pytest

from ddlib.learning import cases
from ddlib.setups import split
from ddlib.simulation import LOG_STEP
from workshop.report import committed, results
from workshop.report.measures import filter_trial as trial
from workshop.report.studies.nulls import TRIAL


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
