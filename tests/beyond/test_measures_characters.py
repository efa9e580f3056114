"""What claims about the characters measure, on planted results."""

import numpy as np
import pytest

from workshop.beyond.measures import characters
from workshop.report import results

PUBLISHED = {"torque": 4e-4, "mass_matrix": 1.0}


def errors_of(values, part="torque"):
    return {"test": [{part: value} for value in values]}


@pytest.fixture
def plant(monkeypatch):
    def planted(study):
        monkeypatch.setattr(results, "read", lambda name: study[name])

    return planted


def test_an_error_is_judged_against_the_published_one_on_the_worse_split(plant):
    rivals = {
        "loader": {"network": errors_of([1e-4, 2e-4, 3e-4, 4e-4, 5e-4]), "line": errors_of([2e-4])},
        "figure": {"network": errors_of([8e-4, 7e-4, 6e-4, 9e-4, 8e-4]), "line": errors_of([1e-4])},
    }
    plant({"characters": {"published": PUBLISHED, "rivals": rivals}})
    found = characters.against_published("network")
    assert found.value == pytest.approx(2.0) and found.replicates.min() >= 1.5 - 1e-9
    assert found.text == "0.75 and 2.0 of the published error"
    alone = characters.against_published("line")
    assert alone.value == pytest.approx(0.5) and alone.replicates is None
    ratio = characters.ratio("line", "network")
    assert ratio.value == pytest.approx(2 / 3)  # 2e-4 / 3e-4 against 1e-4 / 8e-4
    assert ratio.text.startswith("2 · 10⁻⁴ against 3 · 10⁻⁴ (10⁻⁴ to 5 · 10⁻⁴); 10⁻⁴ against")


def test_the_error_of_a_part_is_a_median_over_seeds(plant):
    cell = errors_of([0.5, 0.1, 0.2, 0.9, 0.3], "mass_matrix")
    plant({"characters": {"rivals": {"loader": {"network": cell}}}})
    found = characters.error("network", "mass_matrix")
    assert found.value == 0.3 and found.replicates.min() < 0.3 < found.replicates.max()


def test_networks_as_published_are_judged_at_their_end(plant):
    networks = [{"course": [{"torque": 1.0}, {"torque": k * 4e-4}]} for k in (1, 2, 3, 40, 50)]
    study = {"marks": [100, 1500], "networks": networks, "dead starts": [True] * 3 + [False] * 9}
    plant({"characters": {"published": PUBLISHED, "as published": study}})
    found = characters.as_published()
    assert found.value == pytest.approx(3.0)
    assert found.text == "3.0 (1.0 to 50) times the published error after 1,500 epochs"
    dead = characters.dead_starts()
    assert dead.value == 0.25 and dead.text == "25 % of 12 starts"
    assert dead.replicates.std() == pytest.approx(np.sqrt(0.25 * 0.75 / 12), rel=0.1)


def test_intervals_and_errors_are_judged_day_by_day(plant):
    def days(covered, rmss):
        rows = [{"covered": c, "rmss": r} for c, r in zip(covered, rmss)]
        return {"trajectory 6": rows, "kept out": rows[::-1]}

    five = np.arange(5)
    processes = {
        "beside known structure": days(0.9 + 0.01 * five, [0.04, 0.06, 0.04, 0.04, 0.04]),
        "known structure": days(np.ones(5), [0.08, 0.05, 0.05, 0.05, 0.05]),
        "estimated states": days(np.ones(5), [0.05, 0.09, 0.08, 0.08, 0.08]),
    }
    plant({"gaussian-intervals": {"processes": processes}})
    assert characters.covered("beside known structure").value == pytest.approx(0.92)
    # 0.04 / 0.05, 0.06 / 0.05, then 0.04 / 0.05 three times
    found = characters.beside_structure()
    assert found.value == pytest.approx(0.8) and found.replicates.max() == pytest.approx(1.2)
