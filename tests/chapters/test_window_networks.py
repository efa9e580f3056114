"""What the screening design tells of errors that were planted."""

import numpy as np
import pytest

from workshop.chapters.window_networks import effects
from workshop.report.studies.screening import screening


def test_effects_are_those_that_were_planted():
    """Squares and products of what is varied change neither them nor the empty columns."""
    design = screening()
    x = design[:, :2]
    planted = np.array([[0.5, -0.2], [0.3, 0.0]])
    logs = x @ planted + 0.7 * (x[:, :1] ** 2 + x[:, :1] * x[:, 1:])
    factors, chance = effects(design, logs, 2)
    np.testing.assert_allclose(factors, np.exp(2 * planted))
    assert chance == pytest.approx(1.0)
    logs = logs + 0.1 * design[:, [7]] * [1, 0]
    assert effects(design, logs, 2)[1] == pytest.approx(np.exp(0.2))
