"""The tutorial for an arm of one's own: open cells alone, other parameters, a file, the checks."""

import ast
import json
import re

import numpy as np
import pytest
from book_pages import ROOT, source

CELLS = [
    ("".join(cell["source"]), cell["id"], cell["metadata"].get("tags", []))
    for cell in json.loads(source("book/use-it-on-your-arm").read_text(encoding="utf-8"))["cells"]
    if cell["cell_type"] == "code"
]
OPEN = {name: code for code, name, tags in CELLS if tags in ([], ["change-this"])}
EXAMPLE = ROOT / "book" / "data" / "example-arm.csv"
BIG = "arm = Arm.from_links('b', Link(10, 0.5, 0.25, 0.2), Link(6, 0.5, 0.25, 0.12))"
CHANGES = {
    "as it stands": "",
    "another arm, window 15": f"{BIG}; kp, window, epochs = (400, 100), 15, 300",
    "PD gains, 6 hidden units": "kp, kd, hidden_units, epochs = (60, 20), (8, 2), 6, 300",
    "three motions, hung up": "arm = Arm.from_links('v', upper_arm, forearm, 9.81); "
    "extents, window, epochs = [[40, 20], [20, 40], [30, 30]], 11, 300",
    "a file, arm not known": f"arm, files, epochs = None, {str(EXAMPLE)!r}, 300",
}


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """What the open cells leave behind after a change, in a folder without the book."""
    made = {}

    def once(change):
        if change not in made:
            made[change] = space = {"__name__": "__main__"}
            with pytest.MonkeyPatch.context() as patch:
                patch.chdir(tmp_path_factory.mktemp("elsewhere"))
                for name, code in OPEN.items():
                    added = f"\n{CHANGES[change]}" * (name == "use-change")
                    exec(compile(code + added, name, "exec"), space)
        return made[change]

    return once


def test_open_cells_import_the_package_and_what_it_needs():
    nodes = [node for code in OPEN.values() for node in ast.walk(ast.parse(code))]
    found = {n.module.partition(".")[0] for n in nodes if isinstance(n, ast.ImportFrom)}
    found |= {name.name for n in nodes if isinstance(n, ast.Import) for name in n.names}
    assert found == {"ddlib", "numpy", "pathlib", "scipy", "tempfile"}
    assert "use-change" in OPEN and len(OPEN) > 12


@pytest.mark.parametrize("change", CHANGES)
def test_other_parameters_go_through_to_the_last_figure(change, run):
    space = run(change)
    own, linear = space["own"], space["moments"](space["linear"])
    assert np.isfinite(space["kept"]).all() and np.isfinite(space["in_null"]).all()
    assert space["errors"][1] < 0.5 and space["linear"].shape == (2, 2, space["window"])
    if change.startswith("a file"):
        own = run("as it stands")["own"]
        assert np.isnan(space["own"]).all()
    np.testing.assert_allclose(linear[0, 0, 2], own[0, 0, 2], rtol=0.25)


def test_a_well_damped_loop_swings_less(run):
    damped, free = (run(name)["swing"] for name in ("PD gains, 6 hidden units", "as it stands"))
    assert (damped < free / 2).all()


def test_the_example_is_what_the_page_writes(run, tmp_path):
    space = run("as it stands")
    space["write_csv"](tmp_path / "again.csv", space["recording"][:3])
    new, kept = (
        np.loadtxt(p, delimiter=",", skiprows=1) for p in (tmp_path / "again.csv", EXAMPLE)
    )
    np.testing.assert_allclose(new, kept, rtol=1e-3, atol=1e-4)


ANSWERS = {
    "use-one-check": ("1000**2", "1000"),
    "use-two-check": ("0.5 * sum(arm.lengths) ** 2", "0.5 * sum(arm.lengths)"),
    "use-three-check": ("((150.0, 50.0), (0.0, 0.0))", "((60.0, 20.0), (8.0, 2.0))"),
}


@pytest.mark.parametrize("check", ANSWERS)
def test_checks_say_right_or_why_not(check, run, capsys):
    space, (code,) = run("as it stands"), [code for code, name, _ in CELLS if name == check]
    page = source("book/use-it-on-your-arm").read_text(encoding="utf-8")
    assert f"`mine = {ANSWERS[check][0]}`" in page
    for answer, told in zip(("...", *ANSWERS[check]), ("^Put", "^Right", "^(Wrong|Not yet).* ")):
        exec(f"mine = {answer}\n{code}", dict(space))
        assert re.match(told, capsys.readouterr().out), (check, answer)
