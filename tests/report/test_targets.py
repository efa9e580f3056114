"""The row of targets, made small: what the windows explain, what is mixed, what is counted."""

from dataclasses import replace

import numpy as np
import pytest

from ddlib.learning import related
from workshop.report.studies import targets as study
from workshop.report.studies.nulls import TRIAL, _Trial


@pytest.fixture(scope="module")
def made():
    setup = replace(TRIAL, hidden=3)
    return study._Targets(_Trial(setup, setup.record(), 11), 2)


def test_targets_have_the_spread_of_the_torques_and_their_own_shape(made):
    """What the windows contain they explain; a process has the correlation that it is made for."""
    torques, row = made.trial.torques, made.row()
    explained = {}
    for name, target in row.items():
        assert target.shape == (2, *torques.shape)
        if name == "friction, own size":
            continue
        assert target.mean((1, 2)) == pytest.approx(np.tile(torques.mean((0, 1)), (2, 1)))
        assert target.std((1, 2)) == pytest.approx(np.tile(torques.std((0, 1)), (2, 1)))
        explained[name] = related(target[0].reshape(-1, 2), made.trial.windows)
    assert row["real torques"][0] == pytest.approx(torques)
    assert made.scaled(row["friction, own size"]) == pytest.approx(row["friction"])
    assert min(explained["position"]) > 0.99999 and min(explained["velocity"]) > 0.999
    assert max(explained["shuffled"]) < 0.1 < 0.8 < min(explained["friction"])
    for time in (0.02, 0.1):
        drawn = row[f"Gaussian, {time:g} s"] - torques.mean((0, 1))
        lag = round(time / 0.01)
        products = (drawn[:, :, lag:] * drawn[:, :, :-lag]).mean() / (drawn**2).mean()
        assert products == pytest.approx(np.exp(-0.5), abs=0.05)


def test_of_a_mixture_the_windows_explain_the_share_that_was_asked_for(made):
    """They explain their own part to the last digit, and of the rest nothing."""
    row = made.row()
    for name in ("phases", "real torques"):
        mixtures = made.mixtures(row[name])
        for share, mixture in zip(study._SHARES, mixtures, strict=True):
            found = (made.fitted(mixture).var((1, 2)) / mixture.var((1, 2))).ravel()
            assert found == pytest.approx(share, abs=1e-9)
        own = made.scaled(made.fitted(row[name]))
        assert mixtures[-1] == pytest.approx(own)


def test_planted_filters_are_counted_as_such_and_as_added(made):
    wanted = np.concatenate([made.row()["phases"], made.row()["position"]])
    weights, start = made.trial.train(wanted, 0)
    ramp = np.linspace(-1.0, 1.0, 11)
    planted = replace(weights, hidden_weights=start.hidden_weights + 1000 * ramp)
    found = made.described(planted, start, wanted)
    assert (found["velocity"] == 1).all() and (found["added, velocity"] == 1).all()
    small = replace(weights, hidden_weights=start.hidden_weights + 1e-3 * ramp)
    found = made.described(small, start, wanted)
    assert (found["velocity"] == study._counted(start.hidden_weights)["velocity"]).all()
    assert (found["added, velocity"] == 1).all() and (found["moved"] < 0.01).all()
    assert (found["explained"][2:] > 0.99).all() and (found["explained"][:2] < 0.9).all()


def test_the_study_runs_small():
    found = study.targets(members=2, width=5, epochs=20)
    assert set(found["targets"]) >= {"phases", "friction", "real torques"}
    assert len(found["mixed"]["phases"]) == len(found["shares"])
    assert len(found["by initial"]["real torques"]) == len(found["initial"])
    for row in found["targets"].values():
        assert all(len(values) == 2 for values in row.values())
        assert (row["learnt"] <= 1).all()
