"""The rival that a reader adds in the chapter: it runs, and the protocol takes it."""

import json
from pathlib import Path

import numpy as np
import pytest
from sklearn.neighbors import KNeighborsRegressor

from ddlib.dynamics import CMU_DD_ARM_II, Operations
from workshop.beyond.rivals.protocol import Cases, Estimating, NotFitted, Rival, trial

CHAPTER = Path(__file__).parents[2] / "book" / "rivals.ipynb"
LINES = 30


@pytest.fixture(scope="module")
def added():
    cells = {c["id"]: "".join(c["source"]) for c in json.loads(CHAPTER.read_text())["cells"]}
    source = cells["rival-add-class"]
    assert len(source.splitlines()) <= LINES
    names = {
        "Rival": Rival,
        "Operations": Operations,
        "KNeighborsRegressor": KNeighborsRegressor,
    }
    exec(source, names)
    (kind,) = (x for x in names.values() if isinstance(x, type) and x.__base__ is Rival)
    return kind


def cases(n, seed):
    x = np.random.default_rng(seed).uniform(-1, 1, (n, 2, 3))
    return Cases(x, CMU_DD_ARM_II.inverse_dynamics(*np.moveaxis(x, -1, 0)), "states", 0.01)


def test_it_learns_and_tells_its_cost(added):
    data, other = cases(2000, 0), cases(200, 1)
    found = trial(added(), data, {"training": data, "other": other})
    assert found.rmss["training"] < 1e-6 < found.rmss["other"] < 0.5
    assert found.count == 6 + 2000 * 8
    assert found.operations.multiplications >= 2000 * 6


def test_the_protocol_takes_it(added):
    with pytest.raises(NotFitted):
        added().torque(np.zeros((1, 2, 3)))
    data = cases(50, 0)
    with pytest.raises(ValueError, match=r"x must have shape \(cases, 2, 3\)"):
        added().fit(data).torque(np.zeros((1, 3, 3)))
    assert Estimating(added()).kind == "windows"
