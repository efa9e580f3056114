"""What claims give on the committed results: it is what is kept of them, and what is written."""

import os
import subprocess
import sys

import numpy as np
import pytest

from workshop.report import results
from workshop.report.evidence import claims, judging
from workshop.report.evidence.claims import Claim
from workshop.report.evidence.verdicts import Measured

AGAIN = "run `python -m workshop.report.evidence.judging --write` and look at what it lists"
CI = os.environ.get("CI", "").lower() in {"1", "true"}
MEASURED = [claim for claim in claims.load() if claim.is_measured]


def in_git() -> bool:
    """Whether git keeps all results as they are here."""
    asked = ["git", "-C", results.FOLDER, "status", "--porcelain", "--", "."]
    told = subprocess.run(asked, capture_output=True, text=True, check=False)
    return told.returncode == 0 and not told.stdout


def test_measured_now_each_claim_has_its_written_verdict_and_the_kept_value():
    if not results._committed() and not (CI or in_git()):
        pytest.skip("results made here are another draw")
    assert results._committed(), AGAIN
    kept = results.read("verdicts")["claims"]
    assert {c.id: c.verdict for c in MEASURED} == {k: e.split(": ")[0] for k, e in kept.items()}
    changes = judging.changes(MEASURED, kept)
    assert not changes, "\n".join([AGAIN, *changes])


def test_it_runs_as_contributing_says():
    """With an option that there is not, as judging takes a minute."""
    called = [sys.executable, "-m", judging.__name__, "--there-is-not"]
    here = results.FOLDER.parent  # `book`
    told = subprocess.run(called, cwd=here, capture_output=True, text=True, check=False)
    assert told.returncode == 2 and "--write" in told.stderr


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setattr(results, "FOLDER", tmp_path)
    results.write_json(tmp_path / "a.json", {"made by": {"code": "1", "seconds": 2}, "x": [1, 2]})
    results.write_json(tmp_path / "b.json", {"made by": {"seconds": 2}, "x": 3})
    (tmp_path / "n.npz").write_bytes(b"weights")
    return tmp_path


def digest() -> str:
    return results._digest.__wrapped__(results.FOLDER)


def test_the_digest_sees_numbers_and_networks_alone(folder):
    before = digest()
    results.write_json(folder / "a.json", {"made by": {"code": "2", "seconds": 9}, "x": [1, 2]})
    results.write_json(folder / "b.json", {"made by": {"seconds": 2}, "x": 4})
    assert digest() == before
    results.write_json(folder / "a.json", {"made by": {"code": "2", "seconds": 9}, "x": [1, 3]})
    other = digest()
    (folder / "n.npz").write_bytes(b"other weights")
    assert len({before, other, digest()}) == 3


def planted(verdict, value=1.0, replicates=None, name="a"):
    claim = Claim(
        id=name, where="section 1", chapter="dynamics", claim="x", printed="p", why="y",
        refuted="z", verdict=verdict, measure="m.f", band={"from": 0.8}, loose={"from": 0.5},
    )  # fmt: skip
    object.__setattr__(claim, "measured", lambda: Measured(value, "text", replicates))
    return claim


HALF = np.repeat([1.0, 0.6], 1000)
MOST = np.repeat([1.0, 0.6], [1200, 800])


def test_contradicted_and_standing_verdicts_are_told(folder, monkeypatch, capsys):
    monkeypatch.setattr(judging, "load", lambda: [planted("qualitative")])
    assert judging.main([]) == 1
    assert "| CONTRADICTED\ncontradicted: a" in capsys.readouterr().out
    monkeypatch.setattr(judging, "load", lambda: [planted("qualitative", replicates=HALF)])
    assert judging.main([]) == 0
    assert "50.0 % qualitative" in (out := capsys.readouterr().out)
    assert "| undecided | qualitative | stands" in out


def test_what_changed_is_told_when_it_is_kept(folder, monkeypatch, capsys):
    """Then the results are the committed ones: a verdict that would stand on others is wrong."""
    for claim, wrong, told in (
        (planted("qualitative", replicates=MOST), True, ["a: - -> undecided: 1 0.84 0.6 1"]),
        (planted("undecided", replicates=MOST), False, []),
        (
            planted("undecided", 1.5, MOST),
            False,
            ["a: undecided: 1 0.84 0.6 1 -> undecided: 1.5 0.84 0.6 1"],
        ),
        (planted("reproduced", 1.5), False, ["a: undecided: 1.5 0.84 0.6 1 -> reproduced: 1.5"]),
        (planted("reproduced", 1.5 + 1e-8), False, []),  # but for rounding
    ):
        monkeypatch.setattr(judging, "load", lambda claim=claim: [claim])
        assert judging.main(["--write"]) == wrong and results._committed()
        head, *lines, _ = capsys.readouterr().out.splitlines()[1:]
        assert head.startswith("changed against what was kept") and lines == told
