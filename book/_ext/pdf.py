"""The built pages as two PDFs: the walk through the lessons, and the evidence behind it.

`python book/_ext/pdf.py [walk] [evidence]` opens every page in Chromium as it is printed, joins
what it finds to one document a volume, and prints that twice: the second time with the page numbers
that the first one gave to contents, references and index. Solutions stand at the end.
"""

from __future__ import annotations

import io
import re
import shutil
import sys
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

sys.path.append(str(Path(__file__).parents[2] / "tests" / "support"))  # how a browser is found
import chromium
import yaml
from dd_cite import FILE, edition, names
from dd_public import repository, site
from jinja2 import Environment, FileSystemLoader, Template
from lessons import parts, with_below
from offers import offer
from release import git
from tqdm import tqdm

import ddlib

ROOT = Path(__file__).parents[2]
HERE = Path(__file__).with_name("pdf_pages")  # what runs in a page, and how a volume looks
AHEAD = ("book/index",)
BEHIND = ("book/use-it-on-your-arm", "book/notation", "book/glossary", "book/bibliography")
LEDGER = ("book/ledger", "book/provenance", "book/status", "book/glossary", "book/bibliography")
UNANNOUNCED = ("Before you start", "At hand")  # parts without a page of their own name
CITED = yaml.safe_load((ROOT / FILE).read_text(encoding="utf-8"))
TITLE, AUTHORS = CITED["title"], names(CITED["authors"])
VOLUMES = {"walk": "The walk", "evidence": "The evidence"}
WORDS = ("acceleration filter", "velocity filter", "position filter", "jerk filter", "null",
         "mean gradient", "moment", "two-link arm", "inverse dynamics", "mass matrix")  # fmt: skip
"""What the index has beside the glossary's terms."""
MOST_PLACES = 9  # a word that is everywhere needs no index


def contents(root: Path, volume: str) -> list[tuple[str, list[str]]]:
    """Parts of a volume, with the pages of each, as the table of contents orders them."""
    numbered = [part for part in parts(root) if part.numbered]
    if volume == "walk":
        chapters = [(part.caption, part.files()) for part in numbered]
        return [(UNANNOUNCED[0], [*AHEAD]), *chapters, (UNANNOUNCED[1], [*BEHIND])]
    own = {page for part in numbered for page in part.files()}
    behind = [p for part in numbered for p in with_below(root, part.files()) if p not in own]
    return [("Evidence", behind), (UNANNOUNCED[1], [*LEDGER])]


def words(root: Path) -> list[str]:
    """What the index looks for."""
    text = (root / "book" / "glossary.md").read_text(encoding="utf-8")
    terms = re.findall(r"^(\w[^\n]*)\n(?=  \S)", text.partition("{glossary}")[2], re.M)
    return sorted({*WORDS, *(re.sub(r" \(.*\)$", "", term) for term in terms)})


def taken(browser, built: Path, parts, progress, book: bool = False) -> list[dict]:
    """What `take.js` finds in each page: title, body, solutions, terms, and styles.

    For a book without pages (an EPUB) formulas are MathML, and texts are XML.
    """
    chapters = {name for _, pages in parts for name in pages}
    script, found = (HERE / "take.js").read_text(encoding="utf-8"), []
    page = browser.new_page(
        viewport={"width": 640, "height": 900}, color_scheme="light", reduced_motion="reduce"
    )  # what moves stands still, and the landing page's arm in its best moment
    page.emulate_media(media="print")
    for part, pages in parts:
        for name in pages:
            page.goto((built / f"{name}.html").as_uri())
            chromium.settle(page)
            where = f"{site(repository())}{name}.html" if repository() else ""
            asked = [name, sorted(chapters), where, words(ROOT), book]
            found.append({"name": name, "part": part, **page.evaluate(script, asked)})
            progress.update()
    page.close()
    return found


def quoted(text: str) -> str:
    """A text as style sheets quote one."""
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'


def template(name: str) -> Template:
    """A template of `HERE`; what it is given is escaped, but for what it calls safe."""
    home = Environment(
        loader=FileSystemLoader(HERE), autoescape=True, trim_blocks=True, lstrip_blocks=True
    )
    home.filters["quoted"] = quoted
    return home.get_template(f"{name}.jinja")


def imprint(root: Path) -> str:
    """Version and day of a release; between two releases, those of the text."""
    if released := edition(root):
        return f"Version {released}"
    day = git(root, "log", "-1", "--format=%cs")
    return f"Version {ddlib.__version__}, not released" + (f": the text of {day}" if day else "")


def joined(volume: str, found: list[dict]) -> str:
    """A volume as one HTML document; three zeros hold the places of its page numbers."""
    return template("volume.html").render(
        title=TITLE,
        authors=AUTHORS,
        name=VOLUMES[volume],
        address=site(repository()) if repository() else "",
        imprint=imprint(ROOT),
        styles=dict.fromkeys(style for chapter in found for style in chapter["styles"]),
        look=(HERE / "volume.css").read_text(encoding="utf-8"),
        chapters=found,
        unannounced=UNANNOUNCED,
        solved=[chapter for chapter in found if chapter["solutions"]],
        entries=index(found),
    )


def index(found: list[dict]) -> list[tuple[str, list[str]]]:
    """Words, each with where a chapter has it first."""
    places: dict[str, list[str]] = {}
    for chapter in found:
        for word, anchor in chapter["terms"]:
            places.setdefault(word, []).append(anchor)
    words = sorted(places, key=str.lower)
    return [(word, places[word]) for word in words if len(places[word]) <= MOST_PLACES]


def numbers(pdf: bytes) -> dict[str, int]:
    """Pages of a printed document's destinations, from 1 on."""
    from pypdf import PdfReader

    reader = PdfReader(io.BytesIO(pdf))
    places = reader.named_destinations
    return {
        name.lstrip("/"): 1 + reader.get_destination_page_number(place)
        for name, place in places.items()
    }


def titled(entry, headings: list[str]) -> None:
    """Give an outline the titles of its headings: Chromium doubles some at the top of a page."""
    from pypdf.generic import NameObject, TextStringObject

    while entry is not None:
        entry = entry.get_object()
        letters = Counter("".join(entry["/Title"].split()))
        for k, heading in enumerate(headings):
            once = Counter("".join(heading.split()))
            if once <= letters <= once + once:
                entry[NameObject("/Title")] = TextStringObject(heading)
                del headings[: k + 1]
                break
        titled(entry.get("/First"), headings)
        entry = entry.get("/Next")


@contextmanager
def opened(browser, path: Path) -> Iterator:
    """A volume in a browser, to be printed; it is long."""
    page = browser.new_page()
    page.set_default_timeout(600_000)
    page.goto(path.as_uri())
    try:
        yield page
    finally:
        page.close()


def printed(page) -> bytes:
    """The PDF of a page."""
    return page.pdf(prefer_css_page_size=True, print_background=True, tagged=True, outline=True)


def make(built: Path, folder: Path, volume: str, browser) -> Path:
    """Write a volume; the path of the PDF."""
    from pypdf import PdfWriter

    parts = contents(ROOT, volume)
    with tqdm(total=sum(len(p) for _, p in parts) + 2, desc=volume, unit="page") as progress:
        text = joined(volume, taken(browser, built, parts, progress))
        draft = folder / f"{volume}.html"
        draft.write_text(text, encoding="utf-8")
        with opened(browser, draft) as page:
            at = numbers(printed(page))
            progress.update()
        with opened(browser, draft) as page:  # anew: printed again, it would break pages elsewhere
            headings = page.evaluate((HERE / "fill.js").read_text(encoding="utf-8"), at)
            writer = PdfWriter(clone_from=io.BytesIO(printed(page)))
        titled(writer.root_object["/Outlines"].get_object().get("/First"), headings)
        writer.add_metadata({"/Title": f"{TITLE}: {VOLUMES[volume].lower()}",
                             "/Author": ", ".join(AUTHORS)})  # fmt: skip
        new, path = folder / f".{volume}.pdf", folder / f"{volume}.pdf"
        writer.write(new)
        new.rename(path)
        progress.update()
    return path


def main(wanted: list[str]) -> None:
    if unknown := set(wanted) - set(VOLUMES):
        sys.exit(f"volume must be one of {', '.join(VOLUMES)}, got {', '.join(sorted(unknown))}")
    built, folder = ROOT / "_build" / "html", ROOT / "_build" / "pdf"
    if not (built / "index.html").is_file():
        sys.exit("there are no pages yet: make book")
    folder.mkdir(exist_ok=True)
    with chromium.launch() as browser:
        for volume in wanted or VOLUMES:
            path = make(built, folder, volume, browser)
            shutil.copyfile(path, built / path.name)
            offer(built)
            print(f"==> {path.relative_to(ROOT)}, {path.stat().st_size / 1e6:.1f} MB")


if __name__ == "__main__":
    main(sys.argv[1:])
