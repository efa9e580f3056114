"""Measures of arms of more joints, on planted results with answers known by hand."""

import numpy as np
import pytest

from beyond.chapters import joints_three_and_four as chapter

pytestmark = pytest.mark.usefixtures("planted_members")


def row(joints, motions, error):
    return {"joints": joints, "motions": motions, "test": error * np.array([0.9, 1, 1.1, 1, 1])}


def test_what_is_needed_lies_between_the_numbers_tried(planted_results):
    planted_results(joints={"windows": [row(3, 5, 0.8), row(3, 20, 0.2), row(3, 80, 0.05)]})
    for level, motions in ((0.4, 10), (0.1, 40), (0.9, 5), (0.01, np.inf)):
        assert chapter._needed(3, level)[0] == pytest.approx(motions)
    planted_results(joints={"windows": [row(3, 5, 0.1), row(3, 10, 0.8), row(3, 40, 0.2)]})
    assert chapter._needed(3, 0.4)[0] == pytest.approx(20)  # until the last crossing


@pytest.mark.parametrize("power", [1.0, 2.0])
def test_a_planted_law_is_found(planted_results, power):
    need = {n: 4 * n**power for n in (1, 2, 4, 7)}
    planted_results(
        joints={"windows": [row(n, k * m, 0.2 / k) for n, m in need.items() for k in (0.5, 2.0)]}
    )
    found = chapter.growth(0.2)
    assert found.value == pytest.approx(power)
    assert np.percentile(found.replicates, 1) < power < np.percentile(found.replicates, 99)
    joints, motions, _ = chapter.law(0.2)
    np.testing.assert_allclose(joints, [2, 4, 7])
    np.testing.assert_allclose(motions[0], 4 * joints**power)
