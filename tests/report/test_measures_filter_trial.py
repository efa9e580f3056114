"""The gains by which networks are judged, against the arm and finite differences."""

import numpy as np
import pytest

from ddlib.learning import cases
from ddlib.setups import split
from ddlib.simulation import LOG_STEP
from workshop.report import committed
from workshop.report.measures import filter_trial as trial
from workshop.report.studies.nulls import TRIAL

pytestmark = pytest.mark.usefixtures("planted_members")


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


def test_the_worst_trajectory_of_the_median_network_decides(monkeypatch):
    """Planted: half of the arm's on the last trajectory in the median, exact on the others."""
    own, spread = np.array([6.0, 7.0, 8.0]), np.array([-4.0, -2.0, 0.0, 2.0, 4.0])
    network = own * [1, 1, 0.5] + 0.1 * spread[:, None]
    windows = {"21": {"network": network.tolist(), "filter": (network + 1).tolist()}}
    found = {"trajectories": [1, 2, 6], "slow": {"arm": own.tolist(), "windows": windows}}
    monkeypatch.setattr(trial.results, "read", {"filter-responses": found}.get)
    told = trial.response(21)
    assert told.value == pytest.approx(0.5) and (told.replicates > 0.4).all()
    assert "4.0 on trajectory 6 (arm 8.0)" in told.text
    assert told.text.endswith("as linear filters 7.0, 8.0, 5.0")
