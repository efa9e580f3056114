"""What ANYmal's network hears of its past: slopes by torch against nudges of single samples."""

import numpy as np
import pytest

from beyond.chapters import networks_that_walk as chapter


@pytest.mark.parametrize("lag", [0, 7, 40])
@pytest.mark.parametrize("what", [0, 1], ids=["error", "velocity"])
def test_the_answer_to_a_sample_is_the_slope_of_the_torque(what, lag):
    """`_remembered` steps through the cells by hand, as the lesson does."""
    size, frequency, push = 0.1, 2.0, 1e-5
    waves = chapter._sines(size, frequency, 2 * chapter._REACH, cases=3)
    ends = []
    for sign in (1, -1):
        history = np.stack(waves, -1)[:, ::-1].copy()
        history[:, -1 - lag, what] += sign * push
        ends.append(chapter._remembered(history)[:, -1])
    slope = (ends[0] - ends[1]) / (2 * push)
    found = chapter._answers(size, frequency, cases=3)[:, what, lag]
    np.testing.assert_allclose(found, slope, rtol=1e-5, atol=1e-7)
