"""The picker of rivals: what it shows is what the study kept."""

import numpy as np
import pytest
from traitlets import TraitError

from ddlib.widgets.baking.baked import MAX_BYTES
from workshop.beyond.studies.lineup import REFERENCE
from workshop.beyond.studies.rivals import GRID
from workshop.chapters.widgets.rivals import MEASURED, RivalPicker


def kept(path, names=("table", REFERENCE, "filter")):
    rng = np.random.default_rng(0)
    torque = rng.normal(size=(len(names) + 1, GRID**2, 6, 2)).astype(np.float16)
    torque[1] = torque[0]  # the first rival is perfect
    with open(path, "wb") as file:
        np.savez(file, names=[MEASURED, *names], torque=torque)
    return torque.astype(float)


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    path = tmp_path_factory.mktemp("rivals") / "torques.npz"
    torque = kept(path)
    return RivalPicker(path, "filter"), torque


def test_curves_are_those_of_the_place_and_the_rival_on_the_page_too(made):
    picker, torque = made
    picker.shoulder, picker.elbow, picker.rival = 2, 9, "filter"
    run = 1 * GRID + 8  # the elbow changes fastest
    for j, joint in enumerate(("shoulder", "elbow")):
        for line, who in ((MEASURED, 0), (REFERENCE, 2), ("rival", 3)):
            np.testing.assert_array_equal(picker.curves[f"{joint}, {line}"], torque[who, run, :, j])
    found = picker.curves["errors"]
    scale = torque[0].reshape(-1, 2).std(0)
    wanted = np.sqrt((((torque[2:, run] - torque[0, run]) / scale) ** 2).mean((1, 2)))
    np.testing.assert_allclose(found, [0, *wanted])
    assert picker.interpolation_error(40) < 1e-3
    picker.shoulder, picker.elbow, picker.rival = 9, 1, "table"
    baked = picker.interpolate()
    for name, values in picker.curves.items():
        np.testing.assert_allclose(baked[name], values, atol=2e-3)
    assert picker.still and "3 rivals" in picker.still_alt


def test_what_was_committed_fits():
    picker = RivalPicker()
    assert picker.baked_bytes < MAX_BYTES
    assert (picker.curves["errors"] > 0).all()


def test_what_makes_no_sense_is_refused(made, tmp_path):
    picker, _ = made
    with pytest.raises(TraitError, match="shoulder must be one of"):
        picker.shoulder = 10
    with pytest.raises(TraitError, match="rival must be one of"):
        picker.rival = MEASURED
    kept(tmp_path / "torques.npz")
    with pytest.raises(ValueError, match="rival must be one of 'table'"):
        RivalPicker(tmp_path / "torques.npz", "oracle")
    with pytest.raises(FileNotFoundError):
        RivalPicker(tmp_path / "none.npz")
