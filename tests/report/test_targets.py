"""The row of targets, made small: what the windows explain, what is mixed, what is counted."""

from dataclasses import replace

import numpy as np
import pytest

from ddlib.learning import related
from workshop.report.studies import targets as study
from workshop.report.studies.nulls import TRIAL, FilterTrial


@pytest.fixture(scope="module")
def made():
    setup = replace(TRIAL, hidden=3, epochs=20)
    return study._Targets(FilterTrial(setup, setup.record(), 11), 2)


def test_what_the_windows_contain_they_explain(made):
    """All targets have the torques' spread, processes the correlation that they are made for."""
    torques, row = made.trial.torques, made.row()
    assert made.scaled(row.pop("friction, own size")) == pytest.approx(row["friction"])
    for target in row.values():
        assert target.mean((1, 2)) == pytest.approx(np.tile(torques.mean((0, 1)), (2, 1)))
        assert target.std((1, 2)) == pytest.approx(np.tile(torques.std((0, 1)), (2, 1)))
    explained = {n: related(x[0].reshape(-1, 2), made.trial.windows) for n, x in row.items()}
    assert row["real torques"][0] == pytest.approx(torques)
    assert min(explained["position"]) > 0.99999 and min(explained["velocity"]) > 0.999
    assert max(explained["shuffled"]) < 0.1 < 0.8 < min(explained["friction"])
    for time, lag in ((0.02, 2), (0.1, 10)):
        drawn = row[f"Gaussian, {time:g} s"] - torques.mean((0, 1))
        correlation = (drawn[:, :, lag:] * drawn[:, :, :-lag]).mean() / (drawn**2).mean()
        assert correlation == pytest.approx(np.exp(-0.5), abs=0.05)


@pytest.mark.parametrize("name", study._MIXED)
def test_of_a_mixture_the_windows_explain_the_share_that_was_asked_for(made, name):
    target = made.row()[name]
    mixtures = made.mixtures(target)
    for share, mixture in zip(study._SHARES, mixtures, strict=True):
        found = made.fitted(mixture).var((1, 2)) / mixture.var((1, 2))
        assert found == pytest.approx(np.full_like(found, share), abs=1e-9)
    assert mixtures[-1] == pytest.approx(made.scaled(made.fitted(target)))


def test_planted_filters_are_counted_as_such_and_as_added(made):
    wanted = np.concatenate([made.row()["phases"], made.row()["position"]])
    weights, start = made.trial.train(wanted, 0)
    for size, most in ((1000.0, 1.0), (1e-3, 0.2)):
        ramp = size * np.linspace(-1.0, 1.0, 11)
        planted = replace(weights, hidden_weights=start.hidden_weights + ramp)
        found = made.described(planted, start, wanted)
        assert (found["added, velocity"] == 1).all() and (found["velocity"] <= most).all()
        assert (found["velocity"].min() == 1) == (found["moved"].min() > 1) == (most == 1)
