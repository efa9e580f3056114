"""CONTRIBUTING.md: its drawing is the order that is tested, and its worked examples work."""

import importlib.util
import re
import shutil

import nbformat
import numpy as np
import pytest
import yaml
from test_imports import ORDER, ROOT

from ddlib.evidence import claims
from ddlib.evidence.measures import dynamics
from ddlib.experiments import SETUPS, code_hash, reproduce, results

HOUSE = ROOT.parent
TEXT = (HOUSE / "CONTRIBUTING.md").read_text(encoding="utf-8")


def examples(title: str) -> list[str]:
    """The fenced blocks of a section of the third level."""
    (section,) = re.findall(rf"^### {title}\n(.*?)(?=^##)", TEXT, re.M | re.S)
    return re.findall(r"^```\w+\n(.*?)^```$", section, re.M | re.S)


def run(source: str, names=None) -> dict:
    names = dict(names or {})
    exec(compile(source, "CONTRIBUTING.md", "exec"), names)
    return names


def test_the_drawing_is_the_order():
    drawing = re.search(r"## The plan of the house\n\n```\n(.*?)```", TEXT, re.S)[1]
    assert tuple(word for word in re.findall(r"\w+", drawing) if word in ORDER) == ORDER
    assert drawing.rstrip().endswith("──► book/")
    for line in drawing.splitlines():  # from a room to the next one there is one arrow
        rooms = [word for word in re.findall(r"\w+", line) if (ROOT / word).is_dir()]
        assert line.count("──►") == max(len(rooms) - 1, 0) + line.endswith("book/")


def test_paths_that_are_named_exist():
    named = set(re.findall(r"`((?:book|ddlib|tests)/[\w./-]*)`", TEXT))
    patterns = {path for path in named if "NAME" in path}
    added = {"book/results/following.json"}  # by an example
    assert len(named) > 12
    assert not [path for path in named - patterns - added if not (HOUSE / path).exists()]
    for pattern in patterns:
        assert list(HOUSE.glob(pattern.replace("NAME", "*")))


@pytest.fixture
def claim(tmp_path, monkeypatch):
    """Makes the claim of the example; its measure stands where the example puts it."""
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

    yield load
    claims._measured.cache_clear()


def test_the_claim_is_judged(claim):
    assert claim().judge() == claim().verdict == "reproduced"
    assert claim(band={"to": 0.05}).judge() == "not reproduced"


def test_the_study_is_run_and_read(tmp_path, monkeypatch):
    (source,) = examples("A study")
    function = run(source)["following"]
    package = tmp_path / "ddlib"
    shutil.copytree(ROOT, package, ignore=shutil.ignore_patterns("__pycache__", "static"))
    (package / "experiments" / "studies" / "following.py").write_text(source, encoding="utf-8")
    monkeypatch.setattr(code_hash, "ROOTS", {"ddlib": package})
    monkeypatch.setattr(results, "FOLDER", tmp_path / "results")
    monkeypatch.setattr(reproduce, "run", lambda name: function())
    reproduce.main(["following", "--jobs", "1"])
    found = results.read("following")
    assert found["made by"]["code"] == code_hash.code_hash("following")
    assert set(found["rms"]) == set(SETUPS)
    assert np.shape(found["rms"]["state feedback"]) == (6, 2)
    assert 0 < np.max(found["rms"]["state feedback"]) < 0.2


def test_the_widget_shows_its_function():
    (source,) = examples("A widget")
    names = run(source)
    widget, speed = names["FrictionCurve"](), names["SPEED"]
    widget.viscous, widget.coulomb = 0.25, 0.75
    (torque,) = widget.curves.values()
    np.testing.assert_allclose(torque, 0.25 * speed + 0.75 * np.sign(speed))
    assert widget.interpolation_error(50) < 0.01
    assert widget.still and widget.still_alt


CHECKS = importlib.util.spec_from_file_location(
    "chapter_checks", HOUSE / "tests" / "book" / "test_notebooks.py"
)


@pytest.fixture
def checks(monkeypatch):
    """The tests of notebooks, as functions of a page."""
    module = importlib.util.module_from_spec(CHECKS)
    CHECKS.loader.exec_module(module)
    grid = module.TestChapterGrid()
    return [
        module,
        [
            *(getattr(module, name) for name in dir(module) if name.startswith("test_")),
            *(getattr(grid, name) for name in dir(grid) if name.startswith("test_")),
        ],
    ]


def test_the_chapter_stands_in_the_grid(checks, tmp_path, monkeypatch):
    (source,) = examples("A chapter")
    chapter = run(source)["chapter"]
    path = tmp_path / "heavy.ipynb"
    nbformat.write(chapter, path)
    module, every = checks
    monkeypatch.setattr(module, "source", lambda page: path)
    asked = 0
    for check in every:
        names = check.__code__.co_varnames[: check.__code__.co_argcount]
        if "page" in names and set(names) <= {"self", "page"}:
            check("heavy")
            asked += 1
    assert asked >= 12


def test_the_chapter_runs():
    (source,) = examples("A chapter")
    chapter = run(source)["chapter"]
    names: dict = {}
    for cell in chapter.cells:
        if cell.cell_type == "code":
            exec(compile(cell.source, cell.id, "exec"), names)
    assert names["mass"][0, 0, 0] > names["mass"][1, 0, 0]
    quoted = re.findall(r"quote\('([\w-]+)'", source)
    assert quoted and all(f"{{glue:text}}`{name}" in source for name in quoted)
