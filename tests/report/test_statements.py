"""Words of a page, checked."""

import numpy as np
import pytest

from workshop.report.evidence.statements import resampled, stated
from workshop.report.evidence.verdicts import DRAWS


def test_what_is_so_passes_and_shows_nothing():
    assert stated("wet", True) is None
    assert stated("wet", np.bool_(True)) is None
    assert stated("wet", np.array([True])) is None


def test_what_is_not_so_stops_with_its_name():
    with pytest.raises(AssertionError, match="'wet' is not so: a sentence"):
        stated("wet", False)


def test_most_draws_must_agree():
    draws = np.arange(100) < 80
    stated("wet", draws)
    stated("wet", draws, share=0.8)
    with pytest.raises(AssertionError, match="true in 80 % of the draws"):
        stated("wet", draws, share=0.81)
    with pytest.raises(AssertionError, match="true in 79 % of the draws"):
        stated("wet", np.arange(100) < 79)


def test_one_value_is_not_let_off():
    with pytest.raises(AssertionError, match="'wet' is not so: a"):
        stated("wet", [False], share=0.51)


@pytest.mark.parametrize("holds", [1, 0.3, "yes", [1, 0], None])
def test_only_truth_values(holds):
    with pytest.raises(TypeError, match="holds must be true or false"):
        stated("wet", holds)


@pytest.mark.parametrize("share", [0.5, 0.0, 1.01, float("nan")])
def test_share_in_range(share):
    with pytest.raises(ValueError, match="share must be"):
        stated("wet", True, share=share)


def test_no_draws():
    with pytest.raises(ValueError, match="holds must not be empty"):
        stated("wet", np.zeros(0, bool))


def test_the_median_scatters_as_theory_says():
    # of n normal values the median deviates by sqrt(pi / 2 n)
    values = np.random.default_rng(1).normal(5.0, 2.0, 4000)
    draws = resampled(values)
    assert draws.shape == (DRAWS,)
    assert draws.mean() == pytest.approx(np.median(values), abs=0.02)
    assert draws.std() == pytest.approx(2.0 * np.sqrt(np.pi / 2 / values.size), rel=0.1)


def test_other_statistics_and_seeds():
    values = np.arange(10.0)
    means = resampled(values, np.mean)
    assert means.std() == pytest.approx(values.std() / np.sqrt(10), rel=0.1)
    assert (resampled(values) == resampled(values)).all()
    assert (resampled(values) != resampled(values, seed=1)).any()
    assert (resampled(values, np.max) <= 9).all() and (resampled(values, np.max) == 9).any()


@pytest.mark.parametrize("values", [[1.0], [], 3.0, [[1.0, 2.0]]])
def test_an_ensemble_has_members(values):
    with pytest.raises(ValueError, match="at least two numbers in a row"):
        resampled(values)


def test_values_are_finite():
    with pytest.raises(ValueError, match="values must be finite"):
        resampled([1.0, np.nan])
