"""Fresh and written verdicts: what is kept agrees, and follows from the committed results."""

import os

import pytest

from workshop.report import results
from workshop.report.evidence import claims, judging
from workshop.report.evidence.claims import Claim
from workshop.report.evidence.verdicts import Measured

AGAIN = "run `python -m workshop.report.evidence.judging --write` and look at what it lists"
BANDED = [claim for claim in claims.load() if claim.band]


@pytest.fixture(scope="module")
def kept():
    return results.read(judging._NAME)


def test_written_verdicts_are_the_fresh_ones(kept):
    assert {claim.id: claim.verdict for claim in BANDED} == kept["fresh"], AGAIN


@pytest.mark.skipif(not os.environ.get("CI"), reason="results made here are another draw")
def test_fresh_verdicts_are_of_the_committed_results(kept):
    assert kept["of results"] == judging._digest(), AGAIN


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setattr(results, "FOLDER", tmp_path)
    results.write_json(tmp_path / "a.json", {"made by": {"code": "1", "seconds": 2}, "x": [1, 2]})
    results.write_json(tmp_path / "b.json", {"made by": {"seconds": 2}, "x": 3})
    (tmp_path / "n.npz").write_bytes(b"weights")
    return tmp_path


def test_the_digest_sees_numbers_and_networks_alone(folder):
    before = judging._digest()
    results.write_json(folder / "a.json", {"made by": {"code": "2", "seconds": 9}, "x": [1, 2]})
    results.write_json(folder / "b.json", {"made by": {"seconds": 2}, "x": 4})
    assert judging._digest() == before
    results.write_json(folder / "a.json", {"made by": {"code": "2", "seconds": 9}, "x": [1, 3]})
    other = judging._digest()
    (folder / "n.npz").write_bytes(b"other weights")
    assert len({before, other, judging._digest()}) == 3


def planted(verdict, value=1.0, replicates=None):
    claim = Claim(
        id="a", where="section 1", chapter="dynamics", claim="x", printed="p", why="y",
        refuted="z", verdict=verdict, measure="m.f", band={"from": 0.8}, loose={"from": 0.5},
    )  # fmt: skip
    object.__setattr__(claim, "measured", lambda: Measured(value, "text", replicates))
    return claim


def test_contradicted_and_standing_verdicts_are_told(monkeypatch, capsys):
    import numpy as np

    half = np.repeat([1.0, 0.6], 1000)
    monkeypatch.setattr(judging, "load", lambda: [planted("qualitative")])
    assert judging._main([]) == 1
    assert "| CONTRADICTED\ncontradicted: a" in capsys.readouterr().out
    monkeypatch.setattr(judging, "load", lambda: [planted("qualitative", replicates=half)])
    assert judging._main([]) == 0
    assert "50.0 % qualitative" in (out := capsys.readouterr().out)
    assert "| undecided | qualitative | stands" in out
