"""Committed results: files, freshness, a re-measurement."""

import json
import random
from dataclasses import fields

import numpy as np
import pytest

from ddlib import paper
from ddlib.learning import TorqueModel, Weights
from ddlib.setups import SETUPS, STATE_FEEDBACK, WINDOWS, errors
from workshop.report import reproduce, results
from workshop.report.code_hash import places

STALE = "book/results is not what this code gives: run `make reproduce`"


def test_json_keeps_five_digits_and_whole_numbers(tmp_path):
    path = tmp_path / "new" / "folder" / "a.json"
    content = {
        "matrix": np.array([[1.23456789, -2e-9], [np.float32(0.1), 123456.7]]),
        "mask": np.array([True, False]),
        "count": np.int64(1234567),
        "scalar": np.float32(0.000123456),
        "plain": [1, 0.1 + 0.2, "text", None],
        "gone": (np.nan, float("inf")),
    }
    results.write_json(path, content)
    assert json.loads(path.read_text()) == {
        "matrix": [[1.2346, -2e-9], [0.1, 123460.0]],
        "mask": [True, False],
        "count": 1234567,
        "scalar": 0.00012346,
        "plain": [1, 0.3, "text", None],
        "gone": [None, None],
    }
    assert '"count": 1234567,' in path.read_text() and "true" in path.read_text()
    assert [p.name for p in path.parent.iterdir()] == ["a.json"]


@pytest.fixture
def parts(tmp_path, monkeypatch):
    """Two quick studies in place of the real ones; the list says which have run.

    ``parts.studies`` has them, ``parts.codes`` their hashes.
    """

    class Ran(list):
        pass

    ran = Ran()
    ran.codes = {"longer": "1" * 16, "clean": "2" * 16}
    ran.studies = {n: lambda n=n: ran.append(n) or {"value": len(ran)} for n in ran.codes}
    monkeypatch.setattr(results, "FOLDER", tmp_path / "results")
    monkeypatch.setattr(reproduce, "places", lambda: dict.fromkeys(ran.codes, ("module", "name")))
    monkeypatch.setattr(reproduce, "run_study", lambda name: ran.studies[name]())
    monkeypatch.setattr(reproduce, "code_hash", lambda name: ran.codes[name])
    return ran


def test_what_is_up_to_date_is_not_made_again(parts, capsys):
    reproduce.main(["clean"])
    reproduce.main(["--jobs", "1"])
    assert parts == ["clean", "longer"]
    assert "==> clean: up to date" in capsys.readouterr().out
    reproduce.main(["--jobs", "1"])
    assert parts == ["clean", "longer"]
    parts.codes["longer"] = "3" * 16
    reproduce.main(["--jobs", "1"])
    assert parts == ["clean", "longer", "longer"] and results.read("longer")["value"] == 3
    reproduce.main(["--force", "clean"])
    assert parts[3:] == ["clean"]
    with pytest.raises(SystemExit):
        reproduce.main(["table-9-9"])
    assert "parts must be among longer, clean, got ['table-9-9']" in capsys.readouterr().err
    assert len(parts) == 4


def test_the_stamp_is_of_the_code_that_ran(parts, monkeypatch):
    """Code that changes while a long part runs does not get the credit for it."""
    before = parts.codes["longer"]

    def slow():
        parts.codes["longer"] = "4" * 16
        return {}

    monkeypatch.setitem(parts.studies, "longer", slow)
    reproduce.main(["longer"])
    assert results.read("longer")["made by"]["code"] == before


def test_nothing_is_left_over():
    assert not [p.name for p in results.FOLDER.rglob("*.part")], STALE
    unknown = {p.stem for p in results.FOLDER.glob("*.json")} - set(places())
    for name in unknown:  # made elsewhere: then it must not claim to be made here
        assert "code" not in results.read(name).get("made by", {}), name


@pytest.fixture(scope="module")
def table():
    if not (results.FOLDER / "table-4-1.json").is_file():
        pytest.fail(STALE)
    return results.read("table-4-1")


@pytest.mark.parametrize("setup", SETUPS)
def test_the_table_ends_where_its_histories_end(table, setup):
    for width in WINDOWS:
        cell = table["setups"][setup][str(width)]
        steps = SETUPS[setup].steps
        epochs = cell["history"]["epochs"]
        assert (epochs[0], epochs[-1]) == ((0, steps) if steps else (1, paper.EPOCHS))
        for name in ("training", "test"):
            last = np.array(cell["history"][name])[:, -1]
            np.testing.assert_allclose(last, cell["errors"][name], rtol=0.02, err_msg=STALE)
        least = np.min(cell["history"]["test"], 1)
        np.testing.assert_allclose(least, cell["best test"], rtol=1e-4)


DRAW = random.Random(1988)
SAMPLE = [(s, DRAW.choice(WINDOWS)) for s in SETUPS]


@pytest.mark.parametrize("setup, width", SAMPLE)
def test_committed_networks_measure_what_the_table_says(table, setup, width):
    """Recorded anew, loaded, measured: a sample of Table 4-1."""
    cell = table["setups"][setup][str(width)]
    path = results._networks_path(setup, width)
    assert path.is_file(), STALE
    model = TorqueModel.load(path)
    measured = errors(model, SETUPS[setup].record()).named()
    assert set(measured) == set(cell["errors"])
    for name, values in measured.items():
        np.testing.assert_allclose(
            values, cell["errors"][name], rtol=0.02, err_msg=f"{name}: {STALE}"
        )
    np.testing.assert_allclose(model.weights.largest, cell["largest weight"], rtol=1e-3)


@pytest.mark.parametrize("width", WINDOWS)
def test_courses_begin_at_the_seed_and_end_at_the_networks(width):
    epochs, model = results.course(width)
    assert epochs[0] == 0 and epochs[-1] == paper.EPOCHS and (np.diff(epochs) > 0).all()
    assert model.weights.hidden_bias.shape[:2] == (len(epochs), 2)
    seeded = Weights.random(2, width, initial=STATE_FEEDBACK.initial)
    networks = results.networks(width).weights
    for name in (field.name for field in fields(Weights)):
        own, wanted = getattr(model.weights, name), getattr(seeded, name)
        np.testing.assert_allclose(own[0], wanted, rtol=1e-6, atol=1e-9, err_msg=STALE)
        np.testing.assert_array_equal(own[-1], getattr(networks[:2], name))
