"""The foreign machines: each really differs from this one."""

import re
import subprocess
import sys

import foreign_machines as foreign
import nbformat
import pytest

DRAWS = """
import numpy as np
rng = np.random.default_rng(np.random.SeedSequence(3))
assert isinstance(rng, np.random.Generator) and rng.spawn(1)[0].random() < 1
draws = [rng.uniform(-1, 1, 3), rng.normal(2.0, 1.0, 3), rng.standard_normal(3), rng.random(3)]
print(*np.concatenate(draws).tolist(), rng.integers(0, 100), rng.permutation(9).tolist())
"""


def test_jogs_multiply_every_real_draw_and_leave_integers(tmp_path):
    env, command = foreign.environment("jog-7", tmp_path), [sys.executable, "-c", DRAWS]
    plain, jogged = (
        subprocess.run(command, env={**env, "DDLIB_JOG": jog}, capture_output=True, text=True)
        for jog in ("", env["DDLIB_JOG"])
    )
    assert not plain.stderr + jogged.stderr
    plain, jogged = plain.stdout.split(), jogged.stdout.split()
    assert [float(x) for x in jogged[:12]] == [float(x) * (1 + 7e-9) for x in plain[:12]]
    assert jogged[12:] == plain[12:]


def test_what_holds_and_what_fails_is_told(monkeypatch, capfd):
    for code, outcome in (("pass", "all hold"), ("raise SystemExit(1)", "jog-1: claims")):
        run = {"claims": ["-c", code]}
        monkeypatch.setattr(foreign, "commands", lambda jobs, root, ci, run=run: run)
        assert foreign.main(["jog-1", "--jobs", "1"]) == (outcome != "all hold")
        assert f"1 foreign machine: {outcome}" in capfd.readouterr().out


CELLS = {
    "fine": "import numpy as np, torch, os, warnings; assert os.environ['DDLIB_JOG'] == '7'\n"
    "assert type(np.random.default_rng()).__name__ == 'Jogged'\n"
    "assert torch.get_num_threads() == 1 and os.getcwd().endswith('pages')\n"
    "warnings.warn_explicit('of a library', UserWarning, 'x.py', 1, module='x')",
    "raises": "assert 1 > 2, 'not so'",
    "warns": "import warnings; warnings.warn('look here')",
}


@pytest.mark.slow
def test_notebooks_that_fail_are_told(tmp_path):
    """An error, and a warning of the notebook itself, but none of a library."""
    folder = tmp_path / "pages"
    folder.mkdir()
    for name, code in CELLS.items():
        cells = [nbformat.v4.new_code_cell(code), nbformat.v4.new_code_cell("'next'")]
        kernel = {"name": "python3", "display_name": "Python 3"}
        notebook = nbformat.v4.new_notebook(cells=cells, metadata={"kernelspec": kernel})
        nbformat.write(notebook, folder / f"{name}.ipynb")
    command = foreign.commands(2, foreign.ROOT)["notebooks"]
    options = [str(option) for option in command if not str(option).endswith(".ipynb")]
    answer = subprocess.run(
        [sys.executable, *options, *folder.glob("*.ipynb")], cwd=tmp_path,
        env=foreign.environment("jog-7", tmp_path / "measured"), capture_output=True, text=True,
    )  # fmt: skip
    assert answer.returncode == 1
    failed = dict(
        re.findall(r"^_+ .*?(\w+)\.ipynb _+$\n(.*?)(?=^_+ |\Z)", answer.stdout, re.M | re.S)
    )
    assert set(failed) == set(CELLS) - {"fine"}, answer.stdout + answer.stderr
    assert "not so" in failed["raises"] and "look here" in failed["warns"]
    assert "2 failed, 1 passed" in answer.stdout
