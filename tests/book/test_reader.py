"""The readers' notebooks: plain markdown with the book's numbers, and code that runs."""

import json
import os
import re
import subprocess
import sys
from types import MappingProxyType, SimpleNamespace

import nbformat
import pytest
from book_pages import ROOT, WALK
from chapter_rules import TUTORIAL
from chromium import HTML
from dd_reader import Plain, has_script, reader_notebook, script
from lab import GONE, STATE, VIEW, keep_widgets, lay_out, states

from ddlib.tables import Table

ROLE = re.compile(r"\{[\w:-]+\}`[^`]*`|^(?:`{3,}|:{3,})\{", re.MULTILINE)
NUMBER = re.compile(r'<abbr title="the book\'s number">(.*?)</abbr>')


class Known:
    root = ROOT
    env = SimpleNamespace(titles={})
    labels = MappingProxyType({"section": ("page", "s", "A section")})

    def name(self, page):
        return page.replace("feedback", "02-feedback")

    def figure(self, label):
        return f"Fig. 3.{len(label)}"

    def equation(self, label):
        return "3.1"

    def authors(self, key):
        return "A and B", "1988"


def plain(text, **glued):
    return Plain("book/page", Known(), glued).text(text)


@pytest.mark.parametrize("source, wanted", [
    ("{glue:text}`a:.2f` m", '<abbr title="the book\'s number">−0.50</abbr> m'),
    ("{glue:text}`name`", '<abbr title="the book\'s number">10⁻³</abbr>'),
    ("{glue:text}`missing:.1f`", '<abbr title="the book\'s number">?</abbr>'),
    ("{doc}`feedback`, {doc}`notation`", "[feedback](02-feedback.ipynb), *notation*"),
    ("{term}`nulls <null control>`", "nulls"),
    ("{numref}`fig` and {eq}`e`", "Fig. 3.3 and Eq. 3.1"),
    ("{cite:t}`Key` or {cite}`Key, Other`", "A and B (1988) or (A and B, 1988; A and B, 1988)"),
    ("{ref}`section` {py:func}`~ddlib.a.b`", "A section `b`"),
    ("$$\nx\n$$ (e)", "$$\nx \\tag{3.1}\n$$"),
    ("```{admonition} Note\nWords.\n```", "> **Note**\n> \n> Words."),
])  # fmt: skip
def test_markdown_without_roles(source, wanted):
    assert plain(source, a=-0.5, name="10⁻³") == wanted


def test_cells_are_open_folded_or_a_folded_solution():
    new = nbformat.v4
    code = {"open": [], "folded": ["remove-cell"], "solved": ["hide-cell"], "drawn": ["hide-input"]}
    cells = [new.new_code_cell(name, metadata={"tags": tags}) for name, tags in code.items()]
    cells[-1].metadata["mystnb"] = {"figure": {"name": "fig", "caption": "{term}`Curves`.\n"}}
    source = new.new_notebook(cells=[new.new_markdown_cell("# Title"), *cells])
    of = SimpleNamespace(notebook=source, page="page")
    made = reader_notebook(of, Known(), source)
    title, note, setup, opened, folded, solved, drawn, caption = made.cells
    assert title.source == "# Title" and "Your copy" in note.source and "the-book" in setup.source
    assert opened.source == "open" and not opened.metadata
    assert folded.metadata["jupyter"] == drawn.metadata["jupyter"] == {"source_hidden": True}
    assert solved.cell_type == "markdown" and "<details>" in solved.source
    assert caption.source == "**Fig. 3.3.** Curves."
    nbformat.validate(made)


def test_outputs_are_taken_as_any_viewer_shows_them():
    new = nbformat.v4
    widget = {"data": {VIEW: {"model_id": "m"}, "text/html": "<img>", "text/plain": "Widget()"}}
    svg = '<svg viewBox="0 0 72 9" aria-label="A &amp; B" style="width:1.00in;"></svg>'
    both = f'<div class="ddlib-figure"><div>{svg}</div><div class="narrow"><svg></svg></div></div>'
    kinds = {
        "glued": {"data": {"application/papermill.record/text/plain": "1.5"},
                  "metadata": {"scrapbook": {"name": "mass"}}},
        "figure": {"data": {"text/html": both, "text/plain": "Illustration()"}},
        "table": {"data": {"text/markdown": "| a |", "text/plain": "Table()"}},
        "waits": {"data": {"text/html": '<div class="exercise-answer">', "text/plain": "Put"}},
        "widget": widget,
    }  # fmt: skip
    cells = [
        new.new_code_cell(kind, outputs=[new.new_output("display_data", **output)])
        for kind, output in kinds.items()
    ]
    state = {"m": {"state": {"still": "data:,", "layout": "IPY_MODEL_l"}}}
    source = new.new_notebook(
        cells=[new.new_markdown_cell("# {glue:text}`mass:.2f` kg"), *cells],
        metadata={"widgets": {STATE: {"state": state}}},
    )
    made = reader_notebook(SimpleNamespace(notebook=source, page="page"), Known(), source)
    assert NUMBER.findall(made.cells[0].source) == ["1.50"]
    shown = {cell.source: cell.outputs for cell in made.cells[3:]}
    assert not shown.pop("glued")
    shown = {kind: outputs[0].data for kind, outputs in shown.items()}
    assert shown["table"] == {"text/markdown": "| a |"} and shown["waits"] == {"text/plain": "Put"}
    (kind, figure), *others = shown["figure"].items()
    assert kind == "text/html" and not others and 'alt="A &amp; B"' in figure
    assert figure.startswith('<img src="data:image/svg+xml,%3Csvg') and "narrow" not in figure
    assert shown["widget"] == {VIEW: {"model_id": "m"}, "text/html": "<img>"}
    assert "still" not in states(made)["m"]["state"]
    nbformat.validate(made)


def test_an_error_of_a_check_is_the_readers_lines_and_the_message():
    """Others are shown whole."""

    def told(code):
        start = "from workshop.errors import short_errors; short_errors()\n"
        start += "from ddlib.dynamics import CMU_DD_ARM_II as arm\n"
        ipython = [sys.executable, "-m", "IPython", "--no-banner", "--colors=NoColor"]
        env = {**os.environ, "PYTHONPATH": str(ROOT / "book")}
        made = subprocess.run(
            [*ipython, "-c", start + code], capture_output=True, text=True, env=env
        )
        return [line for line in made.stdout.splitlines() if line]

    *_, where, line, message = told("def mine(q):\n    return arm.mass_matrix(q)\nmine([0])")
    assert "in mine" in where and line.strip() == "return arm.mass_matrix(q)"
    assert message == "ValueError: q must have a last axis of length 2, got shape (1,)"
    assert len(told("arm.mass_matrix([0])")) == 4
    assert any("numpy" in line for line in told("import numpy as np\nnp.linalg.inv([[0]])"))


def test_a_script_has_the_open_cells_below_their_headings(capsys):
    new = nbformat.v4
    tags = {"mass = 2": ["change-this"], "hidden": ["hide-input"], "x = mass\nf(\n    x\n)": []}
    tags["solution"] = ["hide-cell"]
    cells = [new.new_code_cell(code, metadata={"tags": found}) for code, found in tags.items()]
    lesson = new.new_notebook(cells=[new.new_markdown_cell("# Title\n\nWords."), *cells])
    assert has_script(lesson) and not has_script(new.new_notebook(cells=cells[1:]))
    told = script(lesson)
    _, _, cells = told.partition("return made\n\n")
    assert cells == (
        "# %% [markdown]\n# # Title\n\n# %%\nmass = 2\n\n# %%\nx = mass\nshow(f(\n    x\n))\n"
    )
    space = {"f": lambda x: Table(("mass",), [(x,)])}
    exec(compile(told, "script", "exec"), space)
    assert "| 2 |" in capsys.readouterr().out


@pytest.mark.built
def test_lessons_hand_out_their_open_cells(parsed):
    for page in (*WALK, TUTORIAL):
        (link,) = [a["href"] for a in parsed(page).select("a[href]") if a["href"].endswith(".py")]
        code = (HTML / page).parent.joinpath(link).read_text(encoding="utf-8")
        compile(code, page, "exec")
        assert "workshop" not in code.replace("workshop.html", "")


def test_a_readers_own_changes_stay(tmp_path):
    made, lab = tmp_path / "made", tmp_path / "lab"
    made.mkdir()
    for name in ("mine.ipynb", "theirs.ipynb"):
        (made / name).write_text("first")
    assert lay_out(made, lab) == []
    (lab / "mine.ipynb").write_text("changed")
    for name in ("mine.ipynb", "theirs.ipynb"):
        (made / name).write_text("second")
    assert lay_out(made, lab) == ["mine.ipynb"]
    assert (lab / "mine.ipynb").read_text() == "changed"
    assert (lab / "theirs.ipynb").read_text() == "second"
    for path in made.glob("*.ipynb"):
        path.rename(made / f"01-{path.name}")
    assert lay_out(made, lab) == ["mine.ipynb"]
    assert sorted(path.name for path in lab.glob("*.ipynb")) == [
        "01-mine.ipynb", "01-theirs.ipynb", "mine.ipynb",
    ]  # fmt: skip


def test_a_saved_notebook_keeps_the_states_of_shown_widgets(tmp_path):
    """Of a widget that runs, of one that does not, and of one that has gone with its kernel."""

    def notebook(state, *shown):
        outputs = [{"data": {VIEW: {"model_id": name}}} for name in shown]
        cells = [{"cell_type": "markdown"}, {"cell_type": "code", "outputs": outputs}]
        return {"cells": cells, "metadata": {"widgets": {STATE: {"state": state}}}}

    old = {"still": {"state": {"layout": "IPY_MODEL_l"}}, "l": {"state": {}}, "not": {"state": {}}}
    (tmp_path / "a.ipynb").write_text(json.dumps(notebook(old)))
    new = notebook({"runs": {"state": {}}}, "runs", "still", "gone")
    manager = SimpleNamespace(root_dir=tmp_path)
    keep_widgets({"type": "notebook", "content": new}, "/a.ipynb", manager)
    assert set(states(new)) == {"runs", "still", "l"}
    data = [output["data"] for output in new["cells"][1]["outputs"]]
    assert [VIEW in each for each in data] == [True, True, False]
    assert data[2] == {"text/plain": GONE}


@pytest.mark.built
def test_no_notebook_has_a_raw_role_or_a_number_missing():
    made = sorted((HTML / "_sources" / "book").rglob("*.ipynb"))
    assert len(made) >= 20
    numbers = 0
    for path in made:
        cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
        text = "\n".join("".join(c["source"]) for c in cells if c["cell_type"] == "markdown")
        assert not ROLE.findall(text), path.name
        assert "?" not in NUMBER.findall(text) and "Fig. ?" not in text and "Eq. ?" not in text
        numbers += len(NUMBER.findall(text))
    assert numbers > 500


@pytest.mark.built
def test_pictures_and_widgets_are_there_before_anything_runs(parsed):
    for path in sorted((HTML / "_sources" / "book").rglob("*.ipynb")):
        notebook = json.loads(path.read_text(encoding="utf-8"))
        outputs = [o for cell in notebook["cells"] for o in cell.get("outputs", ())]
        data = [output["data"] for output in outputs if "data" in output]
        shown = {each[VIEW]["model_id"] for each in data if VIEW in each}
        assert shown <= set(states(notebook)) and '"still":' not in json.dumps(states(notebook))
        figures = sum("text/html" in each and VIEW not in each for each in data)
        page = path.relative_to(HTML / "_sources").with_name(re.sub(r"^\d\d-", "", path.stem))
        assert figures == len(parsed(page.as_posix()).select(".ddlib-figure")), path
        assert path.stat().st_size < 2e6
