"""The built pages as two PDFs: the walk through the lessons, and the evidence behind it.

`python book/_ext/pdf.py [walk] [evidence]` opens every page in Chromium as it is printed, joins
what it finds to one document a volume, and prints that twice: the second time with the page numbers
that the first one gave to contents, references and index. Solutions stand at the end.
"""

from __future__ import annotations

import html
import io
import re
import shutil
import sys
from collections import Counter
from pathlib import Path

import yaml

sys.path.append(str(Path(__file__).parents[2] / "tests" / "support"))  # how a browser is found
import chromium
from dd_public import repository, site
from offers import offer
from tqdm import tqdm

ROOT = Path(__file__).parents[2]
HERE = Path(__file__).with_name("pdf_pages")  # what runs in a page, and how a volume looks
AHEAD = ("book/index",)
BEHIND = ("book/use-it-on-your-arm", "book/notation", "book/glossary", "book/bibliography")
LEDGER = ("book/ledger", "book/provenance", "book/status", "book/glossary", "book/bibliography")
UNANNOUNCED = ("Before you start", "At hand")  # parts without a page of their own name
TITLE = "Learning the Dynamics of a Direct-Drive Arm"
VOLUMES = {"walk": "The walk", "evidence": "The evidence"}
WORDS = ("acceleration filter", "velocity filter", "position filter", "jerk filter", "null",
         "mean gradient", "moment", "two-link arm", "inverse dynamics", "mass matrix")  # fmt: skip
"""What the index has beside the glossary's terms."""
MOST_PLACES = 9  # a word that is everywhere needs no index


def contents(root: Path, volume: str) -> list[tuple[str, list[str]]]:
    """Parts of a volume, with the pages of each, as the table of contents orders them."""
    toc = yaml.safe_load((root / "_toc.yml").read_text(encoding="utf-8"))["parts"]
    numbered = [part for part in toc if part.get("numbered")]
    if volume == "walk":
        lessons = [(p["caption"], [page["file"] for page in p["chapters"]]) for p in numbered]
        return [(UNANNOUNCED[0], [*AHEAD]), *lessons, (UNANNOUNCED[1], [*BEHIND])]
    chapters = [page for part in numbered for page in part["chapters"]]
    behind = [below["file"] for page in chapters for below in page.get("sections", ())]
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
    page = browser.new_page(viewport={"width": 640, "height": 900}, color_scheme="light")
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


def filled(text: str, numbers: dict[str, int]) -> str:
    """Page numbers where `data-page` asks for them; three zeros hold the place before."""
    return re.sub(
        r'(<[^>]+ data-page="([^"]+)"[^>]*>)[^<]*',
        lambda m: f"{m[1]}{numbers.get(m[2], 0) or '000'}",
        text,
    )


def joined(volume: str, found: list[dict]) -> str:
    """A volume as one HTML document."""
    styles = dict.fromkeys(style for one in found for style in one["styles"])
    rules, body, listed, part = [], [], [], None
    for k, one in enumerate(found):
        if one["part"] != part:
            part = one["part"]
            if part not in UNANNOUNCED:
                body.append(f'<section class="part"><h1>{html.escape(part)}</h1></section>')
            listed.append(f'<li class="part">{html.escape(part)}</li>')
        rules.append(f"@page c{k} {{ @top-left {{ content: {_quoted(one['title'])}; }} }}")
        anchor, title = one["anchor"], html.escape(one["title"])
        body.append(f'<section class="chapter" style="page: c{k}">{one["body"]}</section>')
        listed.append(f'<li><a href="#{anchor}">{title}</a>{_page(anchor)}</li>')
    solved = [one for one in found if one["solutions"]]
    if solved:
        rules.append('@page solved { @top-left { content: "Solutions"; } }')
        body.append(
            '<section class="chapter" style="page: solved" id="solutions"><h1>Solutions</h1>'
        )
        body += [f"<h2>{html.escape(one['title'])}</h2>{one['solutions']}" for one in solved]
        body.append("</section>")
        listed.append(f'<li><a href="#solutions">Solutions</a>{_page("solutions")}</li>')
    if entries := index(found):
        rules.append('@page index { @top-left { content: "Index"; } }')
        body.append('<section class="chapter" style="page: index" id="index"><h1>Index</h1>')
        body.append(f'<ul class="index">{entries}</ul></section>')
        listed.append(f'<li><a href="#index">Index</a>{_page("index")}</li>')
    look = (HERE / "volume.css").read_text(encoding="utf-8")
    return (
        f'<!doctype html><html lang="en" data-theme="light"><head><meta charset="utf-8">'
        f"<title>{TITLE}: {VOLUMES[volume].lower()}</title>{''.join(styles)}"
        f"<style>{look}\n{' '.join(rules)}</style></head><body><main class='bd-article volume'>"
        f'<section class="front"><p class="title">{TITLE}</p><p>{VOLUMES[volume]}</p>'
        f"<p>The ddlib authors</p><p>{site(repository()) if repository() else ''}</p></section>"
        f'<section class="contents"><h1>Contents</h1><ul>{"".join(listed)}</ul></section>'
        f"{''.join(body)}</main></body></html>"
    )


def _quoted(text: str) -> str:
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'


def _page(anchor: str) -> str:
    return f'<a class="at" href="#{anchor}" data-page="{anchor}">000</a>'


def index(found: list[dict]) -> str:
    """Words, each with the pages where a chapter has it first."""
    places: dict[str, list[str]] = {}
    for one in found:
        for word, anchor in one["terms"]:
            places.setdefault(word, []).append(anchor)
    return "".join(
        f"<li>{html.escape(word)} {' '.join(_page(anchor) for anchor in anchors)}</li>"
        for word, anchors in sorted(places.items(), key=lambda pair: pair[0].lower())
        if len(anchors) <= MOST_PLACES
    )


def numbers(pdf: bytes) -> dict[str, int]:
    """Pages of a printed document's destinations, from 1 on."""
    from pypdf import PdfReader

    reader = PdfReader(io.BytesIO(pdf))
    places = reader.named_destinations
    return {
        name.lstrip("/"): 1 + reader.get_destination_page_number(place)
        for name, place in places.items()
    }


def once_a_page(text: str, at: dict[str, int]) -> str:
    """An index whose entries name each page once, and no place that was not printed."""

    def thinned(found: re.Match) -> str:
        seen = {0}
        return re.sub(
            r'<a class="at"[^>]* data-page="([^"]+)"[^>]*>[^<]*</a> ?',
            lambda m: "" if at.get(m[1], 0) in seen or seen.add(at[m[1]]) else m[0],
            found[0],
        )

    before, mark, after = text.partition('<ul class="index">')
    return before + mark + re.sub(r"<li>.*?</li>", thinned, after, flags=re.S)


def titled(entry, headings: list[str]) -> None:
    """Give an outline the titles of its headings: Chromium doubles some at the top of a page."""
    from pypdf.generic import NameObject, TextStringObject

    while entry is not None:
        entry = entry.get_object()
        told = Counter("".join(entry["/Title"].split()))
        for k, heading in enumerate(headings):
            once = Counter("".join(heading.split()))
            if once <= told <= once + once:
                entry[NameObject("/Title")] = TextStringObject(heading)
                del headings[: k + 1]
                break
        titled(entry.get("/First"), headings)
        entry = entry.get("/Next")


def printed(browser, path: Path) -> bytes:
    page = browser.new_page()
    page.set_default_timeout(600_000)
    page.goto(path.as_uri())
    try:
        return page.pdf(prefer_css_page_size=True, print_background=True, tagged=True, outline=True)
    finally:
        page.close()


def make(built: Path, folder: Path, volume: str, browser) -> Path:
    """Write a volume; the path of the PDF."""
    from pypdf import PdfWriter

    parts = contents(ROOT, volume)
    with tqdm(total=sum(len(p) for _, p in parts) + 2, desc=volume, unit="page") as progress:
        text = joined(volume, taken(browser, built, parts, progress))
        draft = folder / f"{volume}.html"
        draft.write_text(text, encoding="utf-8")
        at = numbers(printed(browser, draft))
        progress.update()
        draft.write_text(filled(once_a_page(text, at), at), encoding="utf-8")
        writer = PdfWriter(clone_from=io.BytesIO(printed(browser, draft)))
        headings = re.findall(r"<h[1-6][^>]*>(.*?)</h[1-6]>", text, re.S)
        plain = [" ".join(html.unescape(re.sub("<[^>]+>", "", h)).split()) for h in headings]
        titled(writer.root_object["/Outlines"].get_object().get("/First"), plain)
        writer.add_metadata({"/Title": f"{TITLE}: {VOLUMES[volume].lower()}",
                             "/Author": "The ddlib authors"})  # fmt: skip
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
