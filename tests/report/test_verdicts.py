"""How sure a measured value is, and what that makes of a verdict: against closed forms."""

import numpy as np
import pytest
from scipy import stats

from workshop.report.evidence.verdicts import (
    _CONTRADICTS,
    DECIDED,
    DRAWS,
    STANDS,
    bootstrap,
    mean,
    not_contradicted,
    share_told,
    turns_at,
    verdict_of_shares,
)


def test_the_spread_of_a_mean_is_its_standard_error():
    x = np.random.default_rng(1).normal(size=40)
    found = bootstrap(mean, x)
    assert found.shape == (DRAWS,)
    assert found.std() == pytest.approx(x.std() / np.sqrt(40), rel=0.06)
    assert found.mean() == pytest.approx(x.mean(), abs=0.01)


def test_the_interval_of_a_median_is_that_of_scipy():
    x = np.random.default_rng(2).gamma(2.0, size=25)
    other = stats.bootstrap((x,), np.median, axis=-1, n_resamples=9999, method="percentile")
    found = np.percentile(bootstrap(lambda x: np.median(x, -1), x), [2.5, 97.5])
    np.testing.assert_allclose(found, other.confidence_interval, rtol=0.1)


def test_columns_of_the_same_members_are_drawn_together():
    x = np.random.default_rng(3).normal(size=30)
    together = bootstrap(lambda pair: mean(pair[0] - pair[1]), (x, x + 2))
    assert together == pytest.approx(-2)
    apart = bootstrap(lambda a, b: mean(a) - mean(b), x, x + 2)
    assert apart.std() == pytest.approx(np.sqrt(2 / 30) * x.std(), rel=0.06)


def test_networks_on_recordings_are_drawn_on_both_levels():
    """Variance of a mean of means: that of the recordings and that of the networks, each shared."""
    rng = np.random.default_rng(5)
    days, networks = 8, 6
    x = rng.normal(0, 3.0, (days, 1)) + rng.normal(0, 1.0, (days, networks))
    found = bootstrap(mean, x, nested=True, draws=20_000)
    within = x.var(axis=1).mean() / (days * networks)
    between = x.mean(axis=1).var() / days
    assert found.var() == pytest.approx(between + within, rel=0.05)
    assert bootstrap(mean, x, draws=20_000).var() == pytest.approx(between, rel=0.05)
    flat = np.repeat(rng.normal(size=(days, 1)), networks, axis=1)
    assert (bootstrap(lambda cell: np.ptp(cell, axis=-1).max(-1), flat, nested=True) == 0).all()


def test_what_a_written_verdict_bears():
    for written, share, holds in (
        ("reproduced", 1.0, True),
        ("reproduced", STANDS, True),
        ("reproduced", 0.049, False),
        ("qualitative", 0.96, False),  # has 4 %
        ("qualitative", 0.94, True),
        ("undecided", 0.5, True),
        ("undecided", 0.999, True),
        ("undecided", _CONTRADICTS, False),
        ("not reproduced", 0.3, False),  # a planted one
    ):
        assert not_contradicted(written, {"reproduced": share, "qualitative": 1 - share}) is holds
    for share in np.linspace(0, 1, 201):
        found = {"reproduced": share, "not reproduced": 1 - share}
        assert not_contradicted(verdict_of_shares(found), found)


def test_where_a_share_reaches_a_level():
    values = np.array([1.0, 2.0, 4.0])
    assert turns_at(values, 0.05 * values, 0.15) == pytest.approx(3.0)
    assert turns_at(values, 0.4 / values**2, 0.2) == pytest.approx(np.sqrt(2))  # falling


def test_a_share_is_told_no_more_sharply_than_it_decides():
    told = [share_told(share) for share in (0.0, 0.049, 0.051, 0.5, DECIDED, 0.951, 1.0)]
    ends = ["less than 5 %"] * 2, ["more than 95 %"] * 2
    assert told == [*ends[0], "5 %", "50 %", "95 %", *ends[1]]
