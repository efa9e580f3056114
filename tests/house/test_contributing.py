"""CONTRIBUTING.md: the paths that it names exist, and its worked examples work."""

import re
import shutil

import numpy as np
import yaml
from book_pages import ROOT
from widget_pages import assert_exact_table

from ddlib.dynamics import CMU_DD_ARM_II
from ddlib.setups import SETUPS
from workshop.chapters import dynamics
from workshop.report import code_hash, reproduce, results
from workshop.report.evidence import claims

TEXT = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
ADDED = {"book/results/following.json", "book/workshop/chapters/heavy.py"}  # by examples


def examples(title: str) -> list[str]:
    """The fenced blocks of a section of the third level."""
    (section,) = re.findall(rf"^### {title}\n(.*?)(?=^##)", TEXT, re.M | re.S)
    return re.findall(r"^```\w+\n(.*?)^```$", section, re.M | re.S)


def run(source: str, names=None) -> dict:
    names = dict(names or {})
    exec(compile(source, "CONTRIBUTING.md", "exec"), names)
    return names


def test_paths_that_are_named_exist():
    named = set(re.findall(r"`((?:book|ddlib|tests)/[\w./-]*)`", TEXT)) - ADDED
    assert len(named) > 12
    assert not [path for path in named if not list(ROOT.glob(path.replace("NAME", "*")))]


def test_the_claim_is_judged(tmp_path, monkeypatch):
    entry, function = examples("A claim")
    made = run(function, vars(dynamics))["elbow_inertia"]
    monkeypatch.setattr(dynamics, "elbow_inertia", made, raising=False)
    monkeypatch.delenv(claims.SHARED, raising=False)

    def load(**changes):
        claims._measured.cache_clear()
        path = tmp_path / "claims.yml"
        path.write_text(yaml.safe_dump([{**yaml.safe_load(entry)[0], **changes}]))
        (loaded,) = claims.load(path)
        return loaded

    try:
        assert load().judge() == load().verdict == "reproduced"
        assert load(band={"to": 0.05}).judge() == "not reproduced"
    finally:
        claims._measured.cache_clear()


def test_the_study_is_run_and_read(tmp_path, monkeypatch):
    (source,) = examples("A study")
    copy = tmp_path / "workshop"
    shutil.copytree(code_hash._ROOTS["workshop"], copy)
    (copy / "report" / "studies" / "following.py").write_text(source, encoding="utf-8")
    monkeypatch.setitem(code_hash._ROOTS, "workshop", copy)
    monkeypatch.setattr(results, "FOLDER", tmp_path / "results")
    monkeypatch.setattr(reproduce, "run_study", lambda name: run(source)[f"_{name}"]())
    reproduce.main(["following", "--jobs", "1"])
    following = results.read("following")
    assert following["made by"]["code"] == code_hash.code_hash("following")
    assert set(following["rms"]) == set(SETUPS)
    assert np.shape(following["rms"]["state feedback"]) == (6, 2)
    assert 0 < np.max(following["rms"]["state feedback"]) < 0.2


def test_the_widget_shows_its_function():
    (source,) = examples("A widget")
    names = run(source)
    widget, speed = names["FrictionCurve"](), names["SPEED"]
    widget.viscous, widget.coulomb = 0.25, 0.75
    assert repr(widget) == "FrictionCurve(viscous=0.25, coulomb=0.75)"
    (torque,) = widget.curves.values()
    np.testing.assert_allclose(torque, 0.25 * speed + 0.75 * np.sign(speed))
    assert_exact_table(widget)
    assert widget.still and widget.still_alt


def test_the_module_of_a_lesson_quotes_and_judges(capsys):
    (source,) = examples("A lesson")
    names = run(source)
    names["_quoted"]()
    capsys.readouterr()
    inertia = CMU_DD_ARM_II.mass_matrix(np.zeros(2))[0, 0]
    for answer, begins in ((..., "Put"), (inertia, "Right"), (-1, "Wrong")):
        names["check"](1, answer, CMU_DD_ARM_II)
        assert capsys.readouterr().out.startswith(begins)
