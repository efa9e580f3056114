"""Words of a page, checked."""

import numpy as np
import pytest

from workshop.report.evidence.statements import resampled, stated
from workshop.report.evidence.verdicts import DRAWS


def test_what_is_so_passes_and_what_is_not_stops_with_its_name():
    for holds in (True, np.bool_(True), np.array([True])):
        assert stated("wet", holds) is None
    with pytest.raises(AssertionError, match="'wet' is not so: a sentence"):
        stated("wet", False)
    with pytest.raises(AssertionError, match="'wet' is not so: a"):
        stated("wet", [False], share=0.51)  # one value is not let off


def test_most_draws_must_agree():
    draws = np.arange(100) < 80
    stated("wet", draws)
    stated("wet", draws, share=0.8)
    with pytest.raises(AssertionError, match="true in 80 % of the draws"):
        stated("wet", draws, share=0.81)
    with pytest.raises(AssertionError, match="true in 79 % of the draws"):
        stated("wet", np.arange(100) < 79)


def test_what_cannot_be_checked_is_refused():
    for holds in (1, 0.3, "yes", [1, 0], None):
        with pytest.raises(TypeError, match="holds must be true or false"):
            stated("wet", holds)
    for share in (0.5, 0.0, 1.01, float("nan")):
        with pytest.raises(ValueError, match="share must be"):
            stated("wet", True, share=share)
    with pytest.raises(ValueError, match="holds must not be empty"):
        stated("wet", np.zeros(0, bool))
    for values in ([1.0], [], 3.0, [[1.0, 2.0]]):
        with pytest.raises(ValueError, match="at least two numbers in a row"):
            resampled(values)
    with pytest.raises(ValueError, match="values must be finite"):
        resampled([1.0, np.nan])


def test_the_median_scatters_as_theory_says():
    # of n normal values the median deviates by sqrt(pi / 2 n)
    values = np.random.default_rng(1).normal(5.0, 2.0, 4000)
    draws = resampled(values)
    assert draws.shape == (DRAWS,)
    assert draws.mean() == pytest.approx(np.median(values), abs=0.02)
    assert draws.std() == pytest.approx(2.0 * np.sqrt(np.pi / 2 / values.size), rel=0.1)
