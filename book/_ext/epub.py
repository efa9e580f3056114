"""The walk as an EPUB: the pages as they are printed, with MathML, and stills for widgets.

`python book/_ext/epub.py` writes `_build/epub/book.epub` from the built pages.
"""

from __future__ import annotations

import html
import re
import shutil
import sys
import zipfile
from pathlib import Path
from urllib.parse import unquote, urlsplit

import pdf
from offers import offer
from pdf import ROOT, TITLE, chromium, contents, taken
from tqdm import tqdm

STAMP = (1988, 8, 1, 0, 0, 0)  # the same bytes from the same pages
CONTAINER = """<?xml version="1.0"?>
<container version="1.0" xmlns="urn:oasis:names:tc:opendocument:xmlns:container"><rootfiles>
<rootfile full-path="book/content.opf" media-type="application/oebps-package+xml"/>
</rootfiles></container>"""
PAGE = """<?xml version="1.0" encoding="utf-8"?>
<!DOCTYPE html>
<html xmlns="http://www.w3.org/1999/xhtml" xmlns:epub="http://www.idpf.org/2007/ops" lang="en"
xml:lang="en"><head><title>{title}</title><link rel="stylesheet" href="look.css"/></head>
<body>{body}</body></html>"""
KINDS = {".svg": "image/svg+xml", ".png": "image/png", ".jpg": "image/jpeg"}
SOLUTIONS = "solutions"


def tidy(text: str, files: dict[str, str]) -> str:
    """XML of a page with links into the files of the book; `files` says where an id is."""

    def led(found: re.Match) -> str:
        where = files.get(found[1])
        return f'href="{where}.xhtml#{found[1]}"' if where else ""

    text = re.sub(r'(?<!xlink:)href="#([^"]+)"', led, text)
    text = re.sub(r'<a [^>]*class="see"[^>]*>[^<]*</a>', "", text)  # there are no pages
    text = re.sub(
        r' (?:data-[\w-]+|aria-live|aria-activedescendant|for|loading|target|rel)="[^"]*"', "", text
    )
    text = re.sub(r'(<svg\b[^>]*?) role="(?!img)[^"]*"', r"\1", text)
    text = re.sub(r"<(/?)mjx-[\w-]+[^>]*>", r"<\1span>", text)
    return re.sub(r' xmlns="http://www.w3.org/1999/xhtml"', "", text)


def places(found: list[dict]) -> dict[str, str]:
    """The file in which each id stands."""
    at = {}
    for one in found:
        name = one["name"].removeprefix("book/")
        at |= dict.fromkeys(re.findall(r'\bid="([^"]+)"', one["body"]), name)
        at |= dict.fromkeys(re.findall(r'\bid="([^"]+)"', one["solutions"]), SOLUTIONS)
    return at


def pictures(text: str, kept: dict[str, Path]) -> str:
    """Texts with pictures of the book's own; `kept` gathers them."""

    def mine(found: re.Match) -> str:
        path = Path(unquote(urlsplit(html.unescape(found[1])).path))
        kept[path.name] = path
        return f'src="images/{path.name}"'

    return re.sub(r'src="(file:[^"]+)"', mine, text)


def package(pages: dict[str, str], titles: dict[str, str], kept: dict[str, Path]) -> dict[str, str]:
    """Manifest, reading order and navigation."""
    kind = "application/xhtml+xml"
    items = [
        f'<item id="nav" href="nav.xhtml" media-type="{kind}" properties="nav"/>',
        '<item id="look" href="look.css" media-type="text/css"/>',
    ]
    for name, text in pages.items():
        has = [what for what, tag in (("mathml", "<math"), ("svg", "<svg")) if tag in text]
        said = f' properties="{" ".join(has)}"' if has else ""
        items.append(f'<item id="p-{name}" href="{name}.xhtml" media-type="{kind}"{said}/>')
    for k, name in enumerate(kept):
        kind = KINDS[Path(name).suffix]
        items.append(f'<item id="i-{k}" href="images/{name}" media-type="{kind}"/>')
    spine = "".join(f'<itemref idref="p-{name}"/>' for name in pages)
    package = f"""<?xml version="1.0" encoding="utf-8"?>
<package xmlns="http://www.idpf.org/2007/opf" version="3.0" unique-identifier="id" xml:lang="en">
<metadata xmlns:dc="http://purl.org/dc/elements/1.1/"><dc:identifier id="id">urn:x-ddlib:walk
</dc:identifier><dc:title>{TITLE}</dc:title><dc:language>en</dc:language>
<dc:creator>The ddlib authors</dc:creator><dc:rights>CC BY 4.0</dc:rights>
<meta property="dcterms:modified">1988-08-01T00:00:00Z</meta></metadata>
<manifest>{"".join(items)}</manifest><spine>{spine}</spine></package>"""
    listed = "".join(f'<li><a href="{n}.xhtml">{html.escape(titles[n])}</a></li>' for n in pages)
    nav = f'<nav epub:type="toc"><h1>Contents</h1><ol>{listed}</ol></nav>'
    return {"content.opf": package, "nav.xhtml": PAGE.format(title="Contents", body=nav)}


def make(found: list[dict], path: Path) -> None:
    """Write the book, whole or not at all."""
    files, kept = places(found), {}
    pages, titles = {}, {}
    for one in found:
        name = one["name"].removeprefix("book/")
        titles[name] = one["title"]
        pages[name] = PAGE.format(
            title=html.escape(one["title"]), body=tidy(pictures(one["body"], kept), files)
        )
    solved = [
        f"<h2>{html.escape(one['title'])}</h2>{tidy(pictures(one['solutions'], kept), files)}"
        for one in found
        if one["solutions"]
    ]
    titles[SOLUTIONS] = "Solutions"
    body = f"<h1>Solutions</h1>{''.join(solved)}"
    pages[SOLUTIONS] = PAGE.format(title="Solutions", body=body)
    look = (pdf.HERE / "epub.css").read_text(encoding="utf-8")
    texts = {f"{name}.xhtml": text for name, text in pages.items()}
    texts |= {"look.css": look} | package(pages, titles, kept)
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
