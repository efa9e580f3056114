"""The picker of rivals: what it shows is what the study kept."""

import numpy as np
import pytest
from widget_pages import assert_exact_table

from beyond.chapters.widgets.rivals import _MEASURED, RivalPicker
from beyond.studies.lineup import REFERENCE
from beyond.studies.rivals import SQUARE_POINTS
from workshop.report import results


@pytest.fixture(scope="module")
def picker():
    return RivalPicker()


def test_curves_are_those_of_the_place_and_the_rival_on_the_page_too(picker):
    with np.load(results.FOLDER / "rivals-torques.npz") as file:
        names, torque = file["names"].tolist(), file["torque"].astype(float)
    picker.shoulder, picker.elbow, picker.rival = 2, 9, "linear filter"
    run = 1 * SQUARE_POINTS + 8  # the elbow changes fastest
    for j, joint in enumerate(("shoulder", "elbow")):
        for line, name in ((_MEASURED,) * 2, (REFERENCE,) * 2, ("rival", "linear filter")):
            wanted = torque[names.index(name), run, :, j]
            np.testing.assert_array_equal(picker.curves[f"{joint}, {line}"], wanted)
    scale = torque[0].reshape(-1, 2).std(0)
    wanted = np.sqrt((((torque[1:, run] - torque[0, run]) / scale) ** 2).mean((1, 2)))
    np.testing.assert_allclose(picker.curves["errors"], wanted)
    assert_exact_table(picker)
    picker.shoulder, picker.elbow = 9, 1
    baked = picker.at_grid()
    for name, values in picker.curves.items():
        np.testing.assert_allclose(baked[name], values, atol=2e-3)
