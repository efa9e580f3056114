"""Measures of adaptive control: on results that were made up, each says what it is asked."""

import numpy as np
import pytest

from workshop.beyond.measures.loop import adaptive as measured
from workshop.report import results


@pytest.fixture
def planted(monkeypatch):
    ten = np.linspace(0.9, 1.1, 10)
    course = {
        s: {
            "settled": {
                "good": np.outer([4, 3, 2, k, 5, 4, 3, 3 * k], ten),
                "PD": np.outer([8] * 8, ten),
            },
            "unloaded": {"law": np.outer(ten, [x * 5.291, 1, 1])},
        }
        for s, k, x in (("joint damping", 1, 2.0), ("state feedback", 2, 3.0))
    }
    row = {"late": 0, "load": 5.0, "settled": {"joint models": np.outer([9, 2], ten)}}
    late = {"late": 4, "load": 5.0, "settled": {"joint models": np.outer([9, 6], ten)}}
    bed = {
        "nothing else": {
            "settled": {
                "adapted": ten,
                "held": ten,
                "rigid, adapted": 3 * ten,
                "rigid, held": 2 * ten,
            },
            "estimate": np.ones((10, 7)),
        },
        "dead zone": {
            "settled": {"adapted": ten, "held": 2 * ten},
            "estimate": np.ones((10, 7)) + np.eye(7)[5] * 0.4,
        },
        "ripple": {"settled": {"adapted": 3 * ten, "held": 2 * ten}, "estimate": np.ones((10, 7))},
    }
    drift = np.ones((3, 20, 3))
    drift[-1, :10, 0], drift[-1, 10:, 0] = 1.3, 0.9
    kept = {
        "course": course,
        "loads": {"joint damping": {"rows": [row, late]}},
        "bed": bed,
        "drift": {"estimates": {"plain": drift}},
        "lyapunov": {"continuous": {"largest": -0.1}, "a": [{"largest": 3.0}, {"largest": 2.0}]},
        "excitation": {
            "eigenvalues": [[0.1, 1.0, 2.0]] * 6,
            "estimate": [[0.6, 1.0, 1.1]] * 7,
            "settled": {"learning": [[5.0] * 7, [1.0] * 7], "not learning": [[5.0] * 7] * 2},
        },
        "sensors": {
            "tachometer": {
                n: {"settled": np.outer(np.arange(1, 7), ten) * f}
                for n, f in (("x", 1.0), ("y", 4.0))
            }
        },
        "compensation": {
            s: {
                "settled": {"adapted": [ten], "none": [4 * ten]},
                "estimate": np.outer(ten, [1, 2, 3, x]),
                "truth": [1, 2, 3, 4],
            }
            for s, x in (("joint damping", 4.0), ("state feedback", 2.0))
        },
    }
    monkeypatch.setattr(results, "read", lambda name: kept)
    return kept


def test_ratios_are_of_medians_in_the_worse_set_up(planted):
    found = measured.course_over("good", "PD", 4)
    assert found.value == pytest.approx(0.25)
    assert found.replicates.shape == (2000,) and np.allclose(found.replicates, 0.25, rtol=0.3)
    assert "1.0 against 8.0 mm (joint damping)" in found.text
    assert measured.taken_up("good").value == pytest.approx(3.0)


def test_delays_loads_and_sensors(planted):
    assert measured.delay_costs("joint models", 4).value == pytest.approx(3.0)
    assert measured.sensors_over("y", "x", "tachometer").value == pytest.approx(4.0)


def test_what_is_found(planted):
    assert measured.blind(1).value == pytest.approx(0.05)
    assert measured.left_over(5, "a").value == pytest.approx(0.4)
    assert measured.left_over(5).value == pytest.approx(0.4)
    assert measured.follows_all_the_same().value == pytest.approx(0.2)
    assert measured.inertia("law", True).value == pytest.approx(2.0, rel=1e-3)
    assert measured.inertia("law", False).value == pytest.approx(2.0, rel=1e-3)
    assert measured.drifted("plain").value == pytest.approx(0.3)
    assert measured.rounding_drives().value == pytest.approx(3.0)


def test_the_bed(planted):
    assert measured.bed("nothing else", True).value == pytest.approx(1.5)
    assert measured.bed("dead zone").value == pytest.approx(0.5)
    assert measured.not_taken_up(["dead zone", "ripple"]).value == pytest.approx(0.5)
    assert measured.bent("dead zone").value == pytest.approx(0.4)
    assert measured.bent("dead zone").text.endswith("of the shoulder's Coulomb friction")
    np.testing.assert_allclose(measured.bias("dead zone"), [0, 0, 0, 0, 0, 0.4, 0])


def test_friction_and_the_index(planted):
    assert measured.compensated().value == pytest.approx(0.25)
    assert measured.friction_found().value == pytest.approx(0.5)
    assert measured.never_rises().value == -0.1
    assert measured.sampled("a", "largest").value == 3.0
    assert measured.sampled("a", "largest", least=True).value == 2.0


def test_runs_that_were_stopped_are_infinite(planted):
    planted["course"] = [[1.0, None]]
    np.testing.assert_array_equal(measured.kept("course"), [[1.0, np.inf]])
