"""The walk as an EPUB: the pages as they are printed, with MathML, and stills for widgets.

`python book/_ext/epub.py` writes `_build/epub/book.epub` from the built pages.
"""

from __future__ import annotations

import shutil
import sys
import zipfile
from datetime import date
from html import escape
from pathlib import Path
from typing import NamedTuple
from urllib.parse import unquote, urlsplit
from xml.etree import ElementTree

import pdf
from offers import offer
from pdf import AUTHORS, CITED, ROOT, TITLE, chromium, contents, taken
from release import git
from tqdm import tqdm

import ddlib

STAMP = (1988, 8, 1, 0, 0, 0)  # the same bytes from the same pages
CONTAINER = """<?xml version="1.0"?>
<container version="1.0" xmlns="urn:oasis:names:tc:opendocument:xmlns:container"><rootfiles>
<rootfile full-path="book/content.opf" media-type="application/oebps-package+xml"/>
</rootfiles></container>"""
KINDS = {".svg": "image/svg+xml", ".png": "image/png", ".jpg": "image/jpeg"}
SOLUTIONS = "solutions"
XHTML = "http://www.w3.org/1999/xhtml"
XLINK = "http://www.w3.org/1999/xlink"
NEEDLESS = ("aria-live", "aria-activedescendant", "for", "loading", "target", "rel")
"""Attributes of no use in a book, beside all that begin with ``data-``."""


class Page(NamedTuple):
    """A file of the book: its name without ending, its title, its body as XML."""

    name: str
    title: str
    body: str

    @property
    def has(self) -> str:
        """What the manifest has to say of it."""
        return " ".join(
            what for what, tag in (("mathml", "<math"), ("svg", "<svg")) if tag in self.body
        )


def parsed(body: str) -> ElementTree.Element:
    """What a page holds, as the elements of one without prefixes; `take.js` writes XML."""
    root = ElementTree.fromstring(f'<body xmlns="{XHTML}">{body}</body>')
    for element in root.iter():
        space, _, name = element.tag[1:].rpartition("}")
        element.tag = "span" if name.startswith("mjx-") else name
        if name in ("svg", "math"):
            element.set("xmlns", space)
        if link := element.attrib.pop(f"{{{XLINK}}}href", None):
            element.set("xlink:href", link)  # a page's first tag says what that is
    return root


def places(bodies: list[tuple[str, ElementTree.Element]]) -> dict[str, str]:
    """The file in which each id stands, from the names of files and what is in them."""
    return {element.attrib.get("id"): name for name, body in bodies for element in body.iter()}


def tidy(body: ElementTree.Element, files: dict[str, str], kept: dict[str, Path]) -> str:
    """XML of a page with links into the files of the book and with pictures of its own.

    `files` says where an id is; `kept` gathers the pictures.
    """
    for element in body.iter():
        for name, value in list(element.items()):
            new = value
            if name.startswith("data-") or name in NEEDLESS:
                new = None
            elif name == "href" and value.startswith("#"):
                where = files.get(value[1:])
                new = where and f"{where}.xhtml{value}"
            elif name == "src" and value.startswith("file:"):
                path = Path(unquote(urlsplit(value).path))
                kept[path.name] = path
                new = f"images/{path.name}"
            elif name == "role" and element.tag == "svg" and not value.startswith("img"):
                new = None
            element.attrib.pop(name) if new is None else element.set(name, new)
    inside = ElementTree.tostring(body, encoding="unicode").partition(">")[2]
    return inside.rpartition("</body>")[0]


def make(found: list[dict], path: Path) -> None:
    """Write the book, whole or not at all."""
    names = [chapter["name"].removeprefix("book/") for chapter in found]
    bodies = {name: parsed(chapter["body"]) for name, chapter in zip(names, found)}
    solved = [
        (chapter["title"], parsed(chapter["solutions"]))
        for chapter in found
        if chapter["solutions"]
    ]
    files = places([*bodies.items(), *((SOLUTIONS, body) for _, body in solved)])
    kept: dict[str, Path] = {}
    pages = [
        Page(name, chapter["title"], tidy(bodies[name], files, kept))
        for name, chapter in zip(names, found)
    ]
    answers = "".join(
        f"<h2>{escape(title)}</h2>{tidy(body, files, kept)}" for title, body in solved
    )
    pages.append(Page(SOLUTIONS, "Solutions", f"<h1>Solutions</h1>{answers}"))
    images = {name: KINDS[Path(name).suffix] for name in kept}
    page = pdf.template("page.xhtml").render
    nav = pdf.template("nav.xhtml").render(pages=pages)
    texts = {f"{made.name}.xhtml": page(title=made.title, body=made.body) for made in pages}
    texts["look.css"] = (pdf.HERE / "epub.css").read_text(encoding="utf-8")
    day = git(ROOT, "log", "-1", "--format=%cs") or CITED.get("date-released", date.today())
    about = {"title": TITLE, "authors": AUTHORS, "version": ddlib.__version__, "day": day}
    texts["content.opf"] = pdf.template("content.opf").render(**about, pages=pages, images=images)
    texts["nav.xhtml"] = page(title="Contents", body=nav)
    new = path.with_suffix(".new")
    with zipfile.ZipFile(new, "w") as archive:
        archive.writestr(zipfile.ZipInfo("mimetype", STAMP), "application/epub+zip")
        everything = {"META-INF/container.xml": CONTAINER.encode()}
        everything |= {f"book/{name}": text.encode() for name, text in texts.items()}
        everything |= {f"book/images/{name}": path.read_bytes() for name, path in kept.items()}
        for name, data in everything.items():
            archive.writestr(zipfile.ZipInfo(name, STAMP), data, zipfile.ZIP_DEFLATED)
    new.rename(path)


def main() -> None:
    built, folder = ROOT / "_build" / "html", ROOT / "_build" / "epub"
    if not (built / "index.html").is_file():
        sys.exit("there are no pages yet: make book")
    folder.mkdir(exist_ok=True)
    parts = contents(ROOT, "walk")
    with chromium.launch() as browser, tqdm(total=sum(len(p) for _, p in parts)) as progress:
        found = taken(browser, built, parts, progress, book=True)
    make(found, folder / "book.epub")
    shutil.copyfile(folder / "book.epub", built / "book.epub")
    offer(built)
    size = (folder / "book.epub").stat().st_size / 1e6
    print(f"==> {(folder / 'book.epub').relative_to(ROOT)}, {size:.1f} MB")


if __name__ == "__main__":
    main()
