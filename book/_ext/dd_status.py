"""Tables of the page *Status*: speed, run times of the chapters and of the results.

``{status} benchmarks`` and ``{status} results`` show what lies in `book/results`;
``{status} chapters`` shows how long each notebook of this build took, and the end of the
build prints the same. The role ``{runtime}`` is a chapter's own time in words.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

from ddlib.tables import significant
from docutils import nodes
from docutils.parsers.rst.directives import choice
from myst_nb.sphinx_ import NbMetadataCollector
from sphinx.addnodes import pending_xref
from sphinx.transforms.post_transforms import SphinxPostTransform
from sphinx.util.docutils import SphinxDirective

RESULTS = Path("book", "results")
REPRODUCE_SECONDS = 600
MEASURED = "on one core when this page was built"

Cell = str | nodes.Node


def table(header: tuple[str, ...], rows: list[tuple[Cell, ...]]) -> nodes.table:
    """A table of texts and nodes."""
    group = nodes.tgroup(cols=len(header))
    group += [nodes.colspec(colwidth=1) for _ in header]
    for part, lines in ((nodes.thead(), [header]), (nodes.tbody(), rows)):
        for line in lines:
            cells = (cell if isinstance(cell, nodes.Node) else nodes.Text(cell) for cell in line)
            part += nodes.row("", *(nodes.entry("", nodes.paragraph("", "", c)) for c in cells))
        group += part
    return nodes.table("", group, classes=["colwidths-auto"])


def quantity(value: float, unit: str) -> str:
    """A number and its unit, not to be parted."""
    return f"{significant(value)}\N{NO-BREAK SPACE}{unit}"


def duration(seconds: float) -> str:
    """A time for a table, in the unit that suits it."""
    units = (("s", 1.0), ("ms", 1e-3), ("µs", 1e-6))
    unit, size = next((u for u in units if seconds >= u[1]), units[-1])
    return quantity(seconds / size, unit)


# --- benchmarks


def outcome(row: dict) -> str:
    """The target of a row of `benchmarks.json`, and whether it is met."""
    if "not measured" in row:
        return f"not measured: {row['not measured']}"
    for key, sign, value in (("at least", "≥", "ratio"), ("at most", "≤", "value")):
        if key in row:
            fine = row[value] >= row[key] if sign == "≥" else row[value] <= row[key]
            return (
                f"{sign}\N{NO-BREAK SPACE}{significant(row[key], 2)}: {'met' if fine else 'missed'}"
            )
    return "none"


def benchmark_table(rows: list[dict]) -> Iterator[nodes.Node]:
    """The table of one group, pairs of times or quantities with a limit, and what is beside it."""
    pairs = [row for row in rows if "ratio" in row]
    if not pairs:
        cells = (quantity(r["value"], r["unit"]) if "value" in r else "–" for r in rows)
        lines = [(row["what"], cell, outcome(row)) for row, cell in zip(rows, cells)]
        yield table(("what", "measured", "target"), lines)
        return
    first = pairs[0]
    shares = [key for key in first["details"] if key.startswith("share")]
    lines = []
    for row in rows:
        cells = ["–"] * (3 + len(shares))
        if row in pairs:
            times = [duration(row[side]["seconds"]) for side in ("ours", "other")]
            cells = [f"{row['details'][key]:.0%}" for key in shares]
            cells = [*times, quantity(row["ratio"], "×"), *cells]
        lines.append((row["what"], *cells, outcome(row)))
    names = (first["ours"]["name"], first["other"]["name"])
    yield table(("what", *names, "ratio", *shares, "target"), lines)
    for row in pairs:
        beside = {k: v for k, v in row["details"].items() if k.startswith("largest")}
        if beside:
            words = "; ".join(f"{key}: {significant(value)}" for key, value in beside.items())
            yield nodes.paragraph(text=f"{row['what']}: {words}.")


def benchmarks(folder: Path) -> list[nodes.Node]:
    """When and where `make bench` ran, and its tables."""
    path = folder / "benchmarks.json"
    if not path.is_file():
        return [nodes.paragraph(text="Not measured yet: make bench writes these tables.")]
    content = json.loads(path.read_text(encoding="utf-8"))
    made = content["made by"]
    versions = ", ".join(f"{name} {version}" for name, version in made["versions"].items())
    load = "" if made["load before"] is None else f"load {made['load before']:.1f} before, "
    where = (
        f"Measured on {made['date']}: {made['processor']}, {made['cores']} cores, {load}"
        f"Python {made['python']}, {versions}; {made['seconds']:.0f} s in all."
    )
    found: list[nodes.Node] = [nodes.paragraph(text=where)]
    for group in dict.fromkeys(row["group"] for row in content["rows"]):
        rows = [row for row in content["rows"] if row["group"] == group]
        found += [nodes.rubric(text=group), *benchmark_table(rows)]
    return found


# --- results


def made_results(folder: Path) -> list[nodes.Node]:
    """How long each committed result took, and all together."""
    times = {}
    for path in sorted(folder.glob("*.json")):
        made = json.loads(path.read_text(encoding="utf-8")).get("made by", {})
        if "code" in made:
            times[path.stem] = made["seconds"]
    rows = [(name, f"{seconds:.1f} s") for name, seconds in times.items()]
    rows.append(("sum", f"{sum(times.values()):.0f} s"))
    path = folder / "reproduce.json"
    if path.is_file():
        whole = json.loads(path.read_text(encoding="utf-8"))["made by"]
        seconds, jobs = whole["seconds"], whole["jobs"]
        verdict = "met" if seconds <= REPRODUCE_SECONDS else "missed"
        words = f"{seconds:.0f} s; target ≤ {REPRODUCE_SECONDS} s: {verdict}"
        rows.append((f"make reproduce, {jobs} at a time", words))
    return [table(("result", "time to make it"), rows)]


# --- chapters


class ChapterTimes(nodes.General, nodes.Element):
    """Stands for the table until all notebooks have been executed."""


def chapter_times(env) -> Iterator[tuple[str, float]]:
    """Pages with code, in the book's order, and the seconds their execution took, to a tenth.

    Rounded here, once: the table and the words of a page start from the same number.
    """
    data = NbMetadataCollector.get_doc_data(env)
    for page in pages(env):
        runtime = (data.get(page, {}).get("exec_data") or {}).get("runtime")
        if runtime is not None:
            yield page, round(runtime, 1)


def pages(env) -> list[str]:
    """All pages in the order of the table of contents."""
    found, ahead = [], [env.config.root_doc]
    while ahead:
        page = ahead.pop(0)
        found.append(page)
        ahead = list(env.toctree_includes.get(page, ())) + ahead
    return found


class RunTime(nodes.Inline, nodes.TextElement):
    """Stands for the time of its page, with the words to show where none was measured."""


def spoken_time(seconds: float) -> str:
    """A time as prose has it, rounded."""
    if seconds < 1.5:
        return "about a second"
    if seconds < 90:
        return f"about {5 * round(seconds / 5) if seconds > 20 else round(seconds)} seconds"
    return f"about {seconds / 60:.0f} minutes"


def runtime(name, rawtext, text, lineno, inliner, options=None, content=None):
    """``{runtime}`words without a measurement```: see `RunTime`."""
    return [RunTime(rawtext, text)], []


class InsertRunTimes(SphinxPostTransform):
    """Replace each `RunTime` by what this build measured for the page."""

    default_priority = 8

    def run(self, **kwargs):
        seconds = dict(chapter_times(self.env)).get(self.env.docname)
        for node in list(self.document.findall(RunTime)):
            words = node.astext() if seconds is None else f"{spoken_time(seconds)} {MEASURED}"
            node.replace_self(nodes.inline(text=words))


class InsertChapterTimes(SphinxPostTransform):
    """Replace the placeholder by the table; links in it are resolved afterwards."""

    default_priority = 8

    def run(self, **kwargs):
        times = dict(chapter_times(self.env))
        total = sum(times.values())
        rows = [
            (self.link(page), f"{seconds:.1f} s", f"{seconds / total:.0%}")
            for page, seconds in times.items()
        ]
        rows.append(("all", f"{total:.0f} s", "100%"))
        for node in list(self.document.findall(ChapterTimes)):
            node.replace_self(table(("chapter", "time", "share"), rows))

    def link(self, page: str) -> pending_xref:
        title = self.env.titles[page].astext()
        target = dict(refdomain="std", reftype="doc", reftarget=f"/{page}", refexplicit=True)
        return pending_xref("", nodes.inline(text=title), refdoc=self.env.docname, **target)


def print_times(app, exception):
    """Say at the end of a build how long each chapter took."""
    times = dict(chapter_times(app.env)) if exception is None else {}
    if not times:
        return
    total = sum(times.values())
    print(f"==> Executing the notebooks took {total:.0f} s on one core:")
    for page, seconds in times.items():
        print(f"    {Path(page).name:32s} {seconds:6.1f} s {seconds / total:6.0%}")


class Status(SphinxDirective):
    """``{status} benchmarks``, ``results`` or ``chapters``."""

    required_arguments = 1

    def run(self):
        which = choice(self.arguments[0], ("benchmarks", "results", "chapters"))
        if which == "chapters":
            return [ChapterTimes()]
        return {"benchmarks": benchmarks, "results": made_results}[which](
            Path(self.env.srcdir, RESULTS)
        )


def setup(app):
    app.add_directive("status", Status)
    app.add_node(ChapterTimes)
    app.add_node(RunTime)
    app.add_role("runtime", runtime)
    app.add_post_transform(InsertChapterTimes)
    app.add_post_transform(InsertRunTimes)
    app.connect("build-finished", print_times)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
