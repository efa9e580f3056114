"""The mass under a penalty: measures say what the study found."""

import numpy as np
import pytest

from workshop.chapters import excitation
from workshop.report import results
from workshop.report.studies.excitation import DRIVES, later, training_set

PENALTIES = np.geomspace(1e-9, 1, 37)


def planted(half, days=6, arm=6.0, drive="slow"):
    ridge = arm * half / (half + PENALTIES)
    members = np.full((3, 8), 2.0)
    return {
        "drive": drive, "left out": 0.0, "arm": arm, "ridge": [ridge.tolist()] * days,
        "half": [2 * half] * days, "descent": {"M11": members, "error": members / 20},
        "solver": {"M11": members[0], "error": members[0] / 20},
    }  # fmt: skip


@pytest.fixture
def study(monkeypatch):
    made = {"penalties": PENALTIES, "epochs": [100, 1000, 20_000]}
    made["cells"] = [planted(1e-4), planted(1e-6, drive="quick")]
    monkeypatch.setattr(results, "read", lambda name: made)
    return made


def test_half_of_the_mass_is_found_between_the_penalties(study):
    for cell, half in zip(study["cells"], (1e-4, 1e-6)):
        assert np.allclose(excitation.half_measured(cell), half, rtol=0.03)
    assert np.isclose(excitation.half_foretold().value, 2, rtol=0.03)
    study["cells"].append({**planted(1e-4), "ridge": [np.zeros(37)] * 6})
    assert np.isnan(excitation.half_measured(study["cells"][-1])).all()
    assert np.isclose(excitation.half_foretold().value, 2, rtol=0.03)  # never half: left out


def test_the_networks_mass_is_a_share_of_the_arms(study):
    share = excitation.mass_of_networks("quick")
    assert np.isclose(share.value, 1 / 3) and "0.10" in share.text


def test_leaving_out_the_start_moves_the_motion():
    whole = DRIVES["state feedback"][0].record()
    data, rest = training_set(whole), training_set(later(whole, 1.0))
    cut = data.inputs.unscale(data.x, -2).reshape(5, -1, 2, 21)[:, 100:].reshape(-1, 2, 21)
    assert np.allclose(cut, rest.inputs.unscale(rest.x, -2))
