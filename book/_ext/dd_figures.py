"""All figures of a lecture as PNG and SVG, in an archive beside the first page.

Its notebooks are executed with a PNG of each figure beside its page's form (`with_png` in
`workshop.chapters`; `build.py` sets ``DDLIB_PNG`` to the names of their pages). When all pages have
been read, the figures of a lecture's lessons (`book/lectures.yml`) go into `figures-lecture-1.zip`,
with a list of their numbers, captions and alternative texts. The role ``{figures}`1``` is a link
that says how large that is.
"""

from __future__ import annotations

import base64
import re
import tempfile
import zipfile
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree

import dd_teaching
from dd_reader import Known
from docutils import nodes
from jupyter_cache import get_cache
from sphinx.transforms.post_transforms import SphinxPostTransform

from ddlib.figures.style import Illustration
from workshop.chapters import PNG

NAME = "figures-{}.zip"
ROLE = re.compile(r"\{[\w:-]+\}`([^`]*)`")
AS_EVER = (1988, 8, 1, 0, 0, 0)  # so that the same figures make the same archive


class Kept(NamedTuple):
    """A figure of an executed notebook; `png` is empty where none was made."""

    name: str
    caption: str
    svg: str
    alt: str
    png: bytes


def executed(cache: Path, path: Path) -> list[dict]:
    """The cells of a notebook with their outputs, or none where it is not in the cache."""
    kept = get_cache(str(cache))
    with suppress(KeyError):
        return kept.get_cache_bundle(kept.get_cached_project_nb(str(path)).pk).nb["cells"]
    return []


def figures(cells: list[dict]) -> Iterator[Kept]:
    """The numbered figures among the cells of an executed notebook, in its order."""
    for cell in cells:
        told = cell["metadata"].get("mystnb", {}).get("figure")
        for output in cell.get("outputs", ()) if told else ():
            svg = wide_form("".join(output.get("data", {}).get("text/html", "")))
            if svg:
                png = output.get("metadata", {}).get("text/html", {}).get(PNG, "")
                alt = ElementTree.fromstring(svg).attrib["aria-label"]
                alt = f"{alt} {told.get('alt', '')}".strip()
                yield Kept(told["name"], told["caption"], svg, alt, base64.b64decode(png))


def wide_form(markup: str) -> str:
    """The SVG of an `Illustration` as a page shows it, without its narrow form; of no other."""
    start, end = markup.find("<svg "), markup.find("</svg>")
    is_figure = markup.startswith('<div class="ddlib-figure') and end > start
    return markup[start : end + len("</svg>")] if is_figure else ""


def archive_of(name: str) -> str:
    """The file with the figures of a lecture."""
    return NAME.format(f"lecture-{name}" if name.isdecimal() else name)


def write(app, env) -> None:
    """The archives, as soon as all pages have been read and their figures have numbers."""
    if app.builder.format != "html":
        return
    root, known = Path(app.srcdir), Known(env)
    Path(app.outdir).mkdir(parents=True, exist_ok=True)
    for name, told in dd_teaching.lectures(root).items():
        paths = (root / "book" / f"{page}.ipynb" for page in told["pages"])
        cells = (executed(Path(app.config.nb_execution_cache_path), path) for path in paths)
        drawn = [each for page in cells for each in figures(page)]
        pack(Path(app.outdir, archive_of(name)), drawn, known.figure)


def pack(path: Path, kept: list[Kept], numbered) -> None:
    """Write an archive; `numbered` gives "Fig. 2.4" for a figure's name."""
    lines = []
    with (
        zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive,
        tempfile.TemporaryDirectory() as folder,
    ):
        drawn = Path(folder, "figure.svg")

        def put(name: str, content: bytes) -> None:
            archive.writestr(zipfile.ZipInfo(name, AS_EVER), content, zipfile.ZIP_DEFLATED)

        for each in kept:
            number = numbered(each.name)
            digits = number.removeprefix("Fig. ").replace("?", "x")
            stem = f"{digits}-{each.name.removeprefix('fig-')}"
            Illustration(each.svg, each.alt).save(drawn)
            put(f"{stem}.svg", drawn.read_bytes())
            if each.png:
                put(f"{stem}.png", each.png)
            lines += [
                f"{number} ({stem})",
                ROLE.sub(r"\1", each.caption).strip(),
                f"To be seen: {each.alt}",
                "",
            ]
        put("captions.txt", "\n".join(lines).encode())


class Figures(nodes.Inline, nodes.TextElement):
    """Stands for the link."""


def asked(name, rawtext, text, lineno, inliner, options=None, content=None):
    """``{figures}`1```."""
    return [Figures(rawtext, "", lecture=text)], []


class InsertLinks(SphinxPostTransform):
    """The links, when the archives are there."""

    default_priority = 8

    def run(self, **kwargs):
        for node in list(self.document.findall(Figures)):
            name = archive_of(node["lecture"])
            path = Path(self.app.outdir, name)
            size = f" ({path.stat().st_size / 1e6:.1f} MB)" if path.is_file() else ""
            which = f"lecture {node['lecture']}" if node["lecture"].isdecimal() else "this class"
            words = f"all figures of {which} as PNG and SVG"
            link = f'<a href="../{name}" download>{words}</a>{size}'
            node.replace_self(nodes.raw("", link, format="html"))


def setup(app):
    app.add_node(Figures)
    app.add_role("figures", asked)
    app.add_post_transform(InsertLinks)
    app.connect("env-check-consistency", write)  # by now figures have their numbers
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
