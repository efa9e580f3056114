"""Words of a page, checked."""

import numpy as np
import pytest

from workshop.report.evidence.statements import resampled, stated
from workshop.report.evidence.verdicts import DRAWS


def test_what_is_so_passes_and_what_is_not_stops_with_its_name():
    for holds in (True, np.bool_(True), np.arange(100) < 80):
        stated("wet", holds)
    for holds in (False, [False], np.arange(100) < 79):
        with pytest.raises(AssertionError, match=r"'wet' holds in (0 % of 1|79 % of 100): a sent"):
            stated("wet", holds)
    with pytest.raises(TypeError, match=r"holds must be true or false, got 0.3"):
        stated("wet", 0.3)  # a number where a comparison was meant


def test_the_median_scatters_as_theory_says():
    # of n normal values the median deviates by sqrt(pi / 2 n)
    values = np.random.default_rng(1).normal(5.0, 2.0, 4000)
    draws = resampled(values)
    assert draws.shape == (DRAWS,)
    assert draws.mean() == pytest.approx(np.median(values), abs=0.02)
    assert draws.std() == pytest.approx(2.0 * np.sqrt(np.pi / 2 / values.size), rel=0.1)
