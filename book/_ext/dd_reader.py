"""The reader's notebooks: each executed notebook as a plain one that JupyterLab shows as it is.

Numbers stand in the text, marked as the book's; links lead to other notebooks; figures have their
captions below. Pictures, tables and widgets are there before anything runs. Bookkeeping is folded,
solutions are folded and not run. Names begin with the number of the lesson, so that lists are in
the order of the contents. They take the place of the sources behind the download button, in Colab
and in one archive of all; `make lab` opens them. Taken elsewhere, the first cell fetches the book
and what it lacks. Of a lesson the open cells can be had as a script, too.
"""

from __future__ import annotations

import ast
import codecs
import posixpath
import re
import textwrap
import zipfile
from contextlib import suppress
from html import unescape
from pathlib import Path
from urllib.parse import quote

import latexcodec  # noqa: F401  (it knows TeX's letters: "ulatex")
import nbformat
from dd_failures import HYPHEN
from dd_public import address, repository
from dd_quiz import with_questions
from jupyter_cache import get_cache
from lab import VIEW, states
from lessons import CHANGE_THIS, FOLDED, Lesson, contents, handed_out, lesson, lessons
from pybtex.database import parse_file
from rewriter import tag

from ddlib.figures.style import fixed

NOTE = (
    "> **Your copy of a notebook of the book.** Numbers with a dotted line below them are the "
    "book's, from the run that made its pages: they stay when you change code. Figures, tables and "
    "widgets are the book's, too, until you run their cells. Where JupyterLab says *model not "
    "found*, run the cell; its *Settings > Save Widget State Automatically* keeps your widgets "
    "when you save. Code that only keeps numbers is folded."
)
SETUP = """# @title Where the book is not installed (in Colab, say), this fetches it: a minute, once
import importlib.util, os, subprocess, sys

if importlib.util.find_spec("workshop") is None:
    source = os.environ.get("DDLIB_SOURCE", "{address}")
    if not source:
        raise SystemExit("Not installed here: `make lab` in the book's folder opens this.")
    if not os.path.isdir("the-book"):
        subprocess.run(["git", "clone", "--quiet", "--depth", "1", source, "the-book"], check=True)
    subprocess.run([sys.executable, "the-book/book/_ext/missing.py"], check=True)
    sys.path[:0] = [os.path.abspath("the-book/book"), os.path.abspath("the-book")]
    os.chdir("the-book/{folder}")
    if "google.colab" in sys.modules:
        sys.modules["google.colab"].output.enable_custom_widget_manager()

from workshop.errors import short_errors

short_errors()"""
QUOTED = re.compile(r"(?m)^quoted\(.*\)$")  # the numbers stand in the text already
MARK = ('<abbr title="the book\'s number">', "</abbr>")  # around a number in the text
ARCHIVE = "notebooks.zip"  # beside the first page
HEADING = re.compile(r"(?m)^#+ .+$")
ROLE = re.compile(r"\{([\w:-]+)\}`([^`]+)`")
TARGET = re.compile(r"(?s)(.*?)\s*<([^<>]+)>")
EQUATION = re.compile(r"(?ms)^\$\$\n(.*?)\n\$\$[ \t]*\(([\w-]+)\)[ \t]*$")
DIRECTIVE = re.compile(r"(?ms)^(`{3,}|:{3,})\{(\w[\w-]*)\}([^\n]*)\n(.*?)^\1[ \t]*$")
ANCHOR = re.compile(r"(?m)^\([\w-]+\)=\n")
GLUED = "application/papermill.record/text/plain"
SVG = re.compile(r'(?s)<svg.*?aria-label="([^"]*)".*?</svg>')  # the wide form of a figure


class Known:
    """What the book knows when it is built: titles, numbers of figures and equations, authors."""

    def __init__(self, env):
        self.env, self.root = env, Path(env.srcdir)
        self.labels = env.get_domain("std").labels | {
            name: (*place, name) for name, place in env.get_domain("std").anonlabels.items()
            if name not in env.get_domain("std").labels
        }  # fmt: skip
        self.equations = env.get_domain("math").equations
        self.books = parse_file(str(self.root / "book" / "references.bib")).entries

    def name(self, page: str) -> str:
        """Of its notebook, without ending."""
        return handed_out(self.env, page)

    def number(self, kind: str, page: str, name: str) -> str:
        """Number of a figure or an equation, like "10.2"."""
        found = self.env.toc_fignumbers.get(page, {}).get(kind, {}).get(name, ())
        return ".".join(map(str, found)) or "?"

    def figure(self, label: str) -> str:
        """ "Fig. 10.2" for a figure's label."""
        page, name, *_ = self.labels.get(label, ("", label))
        return f"Fig. {self.number('figure', page, name)}"

    def equation(self, label: str) -> str:
        """ "10.3" for an equation's label."""
        page = self.equations[label][0] if label in self.equations else ""
        return self.number("displaymath", page, f"equation-{label}")

    def authors(self, key: str) -> tuple[str, str]:
        """Authors and year of an entry of the bibliography."""
        entry = self.books[key]
        people = entry.persons.get("author") or entry.persons.get("editor") or []
        names = [" ".join((*p.prelast_names, *p.last_names)) for p in people]
        names = [re.sub("[{}]", "", codecs.decode(name, "ulatex")) for name in names]
        authors = f"{names[0]} et al." if len(names) > 2 else " and ".join(names)
        return authors or entry.fields.get("title", key), entry.fields.get("year", "")


def values(executed) -> dict[str, object]:
    """What an executed notebook glued, by its key."""
    outputs = (output for cell in executed.cells for output in cell.get("outputs", ()))
    glued = (output for output in outputs if "scrapbook" in output.get("metadata", {}))
    return {o.metadata.scrapbook.name: _value(o.data.get(GLUED, "?")) for o in glued}


def _value(text: str):
    try:
        return ast.literal_eval(text)
    except (ValueError, SyntaxError):
        return text


class Plain:
    """Markdown of a page without roles and directives."""

    def __init__(self, page: str, known: Known, glued: dict):
        self.page, self.known, self.glued = page, known, glued

    def path(self, target: str) -> str:
        """The book's name of a page that this one names: from its folder, or from the top."""
        return posixpath.normpath(posixpath.join("/", posixpath.dirname(self.page), target))[1:]

    def link(self, page: str, title: str) -> str:
        """A link to a page's notebook, from this one's; its title alone if it has none."""
        if not (self.known.root / f"{page}.ipynb").is_file():
            return f"*{title}*"
        path = posixpath.relpath(self.known.name(page), posixpath.dirname(self.page))
        return f"[{title}]({path}.ipynb)"

    def text(self, source: str) -> str:
        """A cell's markdown."""
        source = ANCHOR.sub("", source)
        source = EQUATION.sub(self._equation, source)
        source = DIRECTIVE.sub(self._directive, source)
        return ROLE.sub(self._role, source)

    def _equation(self, found: re.Match) -> str:
        return f"$$\n{found[1]} \\tag{{{self.known.equation(found[2])}}}\n$$"

    def _directive(self, found: re.Match) -> str:
        _, kind, title, body = found.groups()
        if kind == "math":
            return f"$$\n{body.strip()}\n$$"
        if kind == "admonition":
            return textwrap.indent(f"**{title.strip()}**\n\n{body.strip()}", "> ", lambda _: True)
        return f"*(The page has a table here: {kind.replace('-', ' ')}.)*"

    def _role(self, found: re.Match) -> str:
        role, inside = found.groups()
        named = TARGET.fullmatch(inside)
        shown, target = (named[1], named[2]) if named else ("", inside)
        known = self.known
        match role:
            case "glue:text":
                return self._number(inside)
            case "doc":
                page = self.path(target)
                title = known.env.titles.get(page)
                return self.link(page, shown or (title.astext() if title else target))
            case "section":
                page, _, heading = target.partition(": ")
                return self.link(self.path(page), heading)
            case "numref":
                return known.figure(target)
            case "eq":
                return f"Eq. {known.equation(target)}"
            case "cite:t":
                return ", ".join("{} ({})".format(*known.authors(key)) for key in _keys(target))
            case "cite" | "cite:p":
                return f"({'; '.join(', '.join(known.authors(key)) for key in _keys(target))})"
            case "ref":
                return shown or known.labels.get(target, ("", "", target))[2]
            case "math":
                return f"${inside}$"
            case "term" | "runtime":
                return shown or target
            case _ if role.startswith("py:") or role in ("name", "snippet"):
                return f"`{target.strip('~').rpartition('.')[2]}`"
        return shown or target

    def _number(self, inside: str) -> str:
        key, _, form = inside.rpartition(":")
        key, form = (key, form) if key else (inside, "")
        value = self.glued.get(key, "?")
        try:
            number = HYPHEN.sub("−", format(value, form))
        except (TypeError, ValueError):
            number = str(value)
        return f"{MARK[0]}{number}{MARK[1]}"


def _keys(target: str) -> list[str]:
    return [key.strip() for key in target.split(",")]


def image(address: str, alt: str) -> dict[str, str]:
    """A picture as any viewer shows it: of markup they do not trust, they keep images, no SVG."""
    return {"text/html": tag("img", {"src": address, "alt": alt})}


def taken(output):
    """An output of the book's for a reader's notebook; None of what only keeps a number."""
    data = output.get("data")
    if data is None:  # something printed
        return output
    if "execution_count" in output:
        output.execution_count = None
    forms = {kind: text for kind, text in data.items() if kind != GLUED}
    markup = forms.get("text/html", "")
    if VIEW in forms:  # the picture is for where no widget is shown
        forms.pop("text/plain", None)
    elif "ddlib-figure" in markup:
        drawn = SVG.search(markup)
        svg = quote(fixed(drawn[0]), safe=" /:;=,()")
        forms = image(f"data:image/svg+xml,{svg}", unescape(drawn[1]))
    elif markup:  # an exercise that waits: its words are for the page
        del forms["text/html"]
    elif len(forms) > 1:
        del forms["text/plain"]
    return nbformat.from_dict({**output, "data": forms}) if forms else None


def reader_notebook(of: Lesson, known: Known, executed):
    """A notebook of the book as a reader's, with outputs of the executed one: see the module."""
    plain, cells = Plain(of.page, known, values(executed)), []
    for cell, ran in zip(of.notebook.cells, executed.cells):
        if cell.cell_type != "code":
            text = plain.text(with_questions(cell.source, of))
            cells.append(nbformat.v4.new_markdown_cell(text))
            continue
        tags = cell.metadata.get("tags", [])
        if "hide-cell" in tags:
            cells.append(nbformat.v4.new_markdown_cell(_solution(cell.source)))
            continue
        outputs = [] if "remove-cell" in tags else [taken(o) for o in ran.outputs]
        made = nbformat.v4.new_code_cell(
            QUOTED.sub("", cell.source).rstrip(), outputs=[*filter(None, outputs)]
        )
        if set(FOLDED) & set(tags):
            made.metadata["jupyter"] = {"source_hidden": True}
        cells.append(made)
        figure = cell.metadata.get("mystnb", {}).get("figure")
        if figure:
            text = f"**{known.figure(figure['name'])}.** {plain.text(figure['caption'].strip())}"
            cells.append(nbformat.v4.new_markdown_cell(text))
    setup = nbformat.v4.new_code_cell(
        SETUP.format(address=address(repository()), folder=posixpath.dirname(of.page))
    )
    setup.metadata = {"jupyter": {"source_hidden": True}, "cellView": "form"}
    cells[1:1] = [nbformat.v4.new_markdown_cell(NOTE), setup]
    for model in states(executed).values():
        model["state"].pop("still", None)
    made = nbformat.v4.new_notebook(cells=cells, metadata=executed.metadata)
    for number, cell in enumerate(made.cells):  # the same text at every build
        cell["id"] = f"cell-{number}"
    return made


def _solution(source: str) -> str:
    return f"<details>\n<summary>Solution</summary>\n\n```python\n{source}\n```\n\n</details>"


SHOW = """# In an editor with cells (# %%) figures and tables appear. Run as a whole, this prints
# tables and saves figures in the folder where it is run.
def show(made, saved=[]):
    if hasattr(made, "save"):
        saved.append(f"figure-{len(saved) + 1}.svg")
        made.save(saved[-1])
        print(f"Saved {saved[-1]}.")
    elif hasattr(made, "_repr_markdown_"):
        print(made._repr_markdown_())
    return made"""


def shown(source: str) -> str:
    """A cell's code with its last value handed to `show`."""
    *_, last = ast.parse(source).body
    if (
        not isinstance(last, ast.Expr)
        or getattr(getattr(last.value, "func", 0), "id", "") == "print"
    ):
        return source
    lines = source.splitlines()
    before, value = lines[: last.lineno - 1], "\n".join(lines[last.lineno - 1 : last.end_lineno])
    return "\n".join([*before, f"show({value})"])


def script(notebook) -> str:
    """The open cells alone, below the headings, as a script in cells (`# %%`)."""
    parts = [SHOW]
    for cell in notebook.cells:
        if cell.cell_type == "markdown":
            parts += [f"# %% [markdown]\n# {line}" for line in HEADING.findall(cell.source)]
        elif not {*FOLDED, "hide-cell"} & set(cell.metadata.get("tags", [])):
            parts.append(f"# %%\n{shown(cell.source)}")
    return "\n\n".join(parts) + "\n"


def has_script(notebook) -> bool:
    """Whether the open cells of a notebook are written to be run alone."""
    return any(CHANGE_THIS in cell.metadata.get("tags", []) for cell in notebook.cells)


def rename(app, page, template, context, doctree):
    """What the theme's button hands out, before the theme makes it."""
    if lesson(Path(app.srcdir), page) is not None:
        context["sourcename"] = f"{handed_out(app.env, page)}.ipynb"


def offer_script(app, page, template, context, doctree):
    """A button for it beside that for the notebook, once the theme has made its own."""
    of = lesson(Path(app.srcdir), page)
    if of is None or not has_script(of.notebook):
        return
    button = {
        "type": "link",
        "url": f"{context['pathto']('_sources', 1)}/{handed_out(app.env, page)}.py",
        "text": ".py",
        "icon": "fas fa-file-code",
        "tooltip": "Download the code that stands open, as a script",
        "label": "download-script-button",
    }
    for group in context.get("header_buttons", ()):
        if group.get("label") == "download-buttons":
            group["buttons"].insert(1, button)


def write(app, exception):
    """Put the readers' notebooks where the pages' download buttons lead."""
    if exception is not None or app.builder.format != "html" or app.config.only_page:
        return
    known = Known(app.env)
    cache = get_cache(app.config.nb_execution_cache_path)
    first = lesson(known.root, contents(known.root).root.docname)
    for of in (first, *lessons(known.root)):
        executed = of.notebook
        with suppress(KeyError):  # what failed has no outputs
            _, executed = cache.merge_match_into_notebook(of.notebook)
        made = reader_notebook(of, known, executed)
        target = Path(app.outdir, "_sources", f"{known.name(of.page)}.ipynb")
        target.parent.mkdir(parents=True, exist_ok=True)
        nbformat.write(made, target)
        if has_script(of.notebook):
            target.with_suffix(".py").write_text(script(of.notebook), encoding="utf-8")
    pack(Path(app.outdir), known.root / "book" / "data")


def pack(site: Path, data: Path) -> None:
    """All readers' notebooks and the data that they read, in one archive."""
    made = site / "_sources" / "book"
    paths = {path.relative_to(made).as_posix(): path for path in made.rglob("*.ipynb")}
    paths |= {f"data/{path.relative_to(data)}": path for path in data.rglob("*") if path.is_file()}
    with zipfile.ZipFile(site / ARCHIVE, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, path in sorted(paths.items()):
            entry = zipfile.ZipInfo(f"notebooks/{name}", (1988, 8, 1, 0, 0, 0))  # as ever the same
            archive.writestr(entry, path.read_bytes(), zipfile.ZIP_DEFLATED)


def setup(app):
    app.connect("html-page-context", rename, priority=400)
    app.connect("html-page-context", offer_script, priority=502)
    app.connect("build-finished", write)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
