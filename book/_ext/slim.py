"""The built pages made small, self-contained and accessible: what the theme leaves to do.

The theme brings a script of icons and the search index to every page, compressed 640 kB. Here its
icons become inline SVG, the index is loaded where there is a search, and no ``data:`` address is
left, so that the pages work under a content security policy of ``'self' 'unsafe-inline' blob:``.
"""

from __future__ import annotations

import hashlib
import json
import re
import shutil
import urllib.parse
import urllib.request
from functools import partial
from pathlib import Path
from typing import NamedTuple

from fontTools.pens.svgPathPen import SVGPathPen
from fontTools.pens.transformPen import TransformPen
from fontTools.ttLib import TTFont
from rewriter import Rewriter, tag

ICON_FONT = "vendor/fontawesome/webfonts/fa-solid-900.ttf"
UNUSED_FILES = ("vendor", "locales", "scripts/fontawesome.js*", "**/*.map", "*webpack-macros.html")

ICON_SCRIPT = "fontawesome.js"  # not needed: the icons are in the page
SEARCH_SCRIPTS = {"searchtools.js", "language_data.js", "searchindex.js"}
MATHS_SCRIPT = "tex-svg-full.js"

REFRESH = '<meta http-equiv="Refresh"'  # how the page begins that only leads to the first one
HEAD = (  # for that page: without an icon, browsers look for it
    '<!doctype html><html lang="en"><meta charset="utf-8"><title>To the first page</title>'
    '<link rel="icon" href="_static/favicon.svg">'
)
SCROLLED = "pst-scrollable-table-container"
CSS_DATA = re.compile(r"""url\((?:"(data:(?:[^"\\]|\\.)*)"|(data:[^)]*))\)""")
# Rules of single icons: `.fa-sun:before{content:"\\f185"}`, 1,900 of them.
ICON_RULES = re.compile(r"(?<=[};])(?:\.fa-[\w.-]+(?::{1,2}\w+)?,?)+\{[^{}]*\}")
ICON_FONTS = re.compile(r"@font-face\s*\{[^}]*Font ?Awesome[^}]*\}")
ICON_LETTER = re.compile(r"""(["'])(?:\\[ef][0-9a-f]{3}|[\ue000-\uf8ff])\1""", re.IGNORECASE)


def slim(out: Path, since: float) -> None:
    """Rewrite in place the pages of a built site that were written since then, and all styles."""
    static = out / "_static"
    if not (static / ICON_FONT).is_file():  # no page was written, so the theme copied nothing
        return
    icons = Icons(static / ICON_FONT)
    for pattern in UNUSED_FILES:
        for path in static.glob(pattern):
            shutil.rmtree(path) if path.is_dir() else path.unlink()
    pages = [path for path in out.rglob("*.html") if path.stat().st_mtime >= since]
    for path in [*pages, *static.rglob("*.css")]:
        store = partial(keep, out / "_images", "../" * (len(path.relative_to(out).parts) - 1))
        text = path.read_text(encoding="utf-8")
        text = slim_css(text, store) if path.suffix == ".css" else slim_page(text, icons, store)
        path.write_text(text, encoding="utf-8")


def slim_page(text: str, icons: Icons, store) -> str:
    """A page without what it does not use, repaired for assistive technology."""
    page = Page(text, icons)
    page.drop_scripts()
    page.separate_stills(store)
    return HEAD * text.startswith(REFRESH) + page.changed()


class Icons:
    """The theme's icons as inline SVG, from the outlines of its icon font."""

    def __init__(self, path: Path):
        self.glyphs = TTFont(path).getGlyphSet()

    def inline(self, attributes: dict[str, str]) -> str:
        """The icon that an ``<i class="fa-solid fa-sun">`` stands for, if the font has it."""
        names = attributes["class"].split()
        found = [name[3:] for name in names if name[3:] in self.glyphs]
        if not found:
            return ""
        glyph = self.glyphs[found[0]]
        pen = SVGPathPen(self.glyphs)
        glyph.draw(TransformPen(pen, (1, 0, 0, -1, 0, 448)))  # y downwards, from the top
        mode = {key: attributes[key] for key in ("data-mode",) if key in attributes}
        box = {"viewBox": f"0 0 {glyph.width:g} 512", "aria-hidden": "true"}
        svg = tag("svg", {"class": " ".join(["icon", *names]), **mode, **box})
        return f'{svg}<path fill="currentColor" d="{pen.getCommands()}"/></svg>'


class Script(NamedTuple):
    """A script of a page: where it stands in the text, and what it says."""

    start: int
    end: int
    attributes: dict[str, str]
    content: str

    @property
    def name(self) -> str:
        """The name of its file; empty if it has none."""
        return self.attributes.get("src", "").partition("?")[0].rpartition("/")[2]


class Page(Rewriter):
    """A page as Sphinx, the theme and myst-nb write it, with what it needs instead."""

    def __init__(self, text: str, icons: Icons):
        self.icons, self.scripts = icons, []
        self.opened = {"div": [], "script": [], "summary": []}  # what stands open, by its name
        self.has_formulas = self.has_results = False
        super().__init__(text)

    def handle_starttag(self, name, attributes):
        own = {key: value or "" for key, value in attributes}
        classes = own.get("class", "").split()
        self.has_formulas |= "math" in classes
        self.has_results |= own.get("id") == "search-results"
        if name in self.opened:
            self.opened[name].append((self.start, self.end, own))
        if name in ("i", "span") and any(kind.startswith("fa-") for kind in classes):
            end = f"</{name}>"
            drawn = self.icons.inline(own) if self.text.startswith(end, self.end) else ""
            if drawn:
                self.change(self.start, self.end + len(end), drawn)
        elif name == "link" and (own.get("rel"), own.get("as")) == ("preload", "script"):
            self.change(self.start, self.end, "")  # fails where scripts are off
        elif "toctree-toggle" in classes and self.opened["summary"]:  # an icon without words
            start, end, summary = self.opened["summary"][-1]
            named = {**summary, "aria-label": "Pages below this one"}
            self.change(start, end, tag("summary", named))
        elif SCROLLED in classes:
            self.change(self.start, self.end, tag("section", own))  # a div that scrolls has no role
        elif "search-button-field" in classes:  # its words say what it is
            kept = {key: own[key] for key in own if key not in ("title", "aria-label")}
            self.change(self.start, self.end, tag(name, kept))
        elif own.get("id") == "pst-primary-sidebar":  # closed until it is asked for
            closed = {"class": f"{own['class']} pst-sidebar-hidden", "role": "complementary"}
            self.change(self.start, self.end, tag(name, {**own, **closed}))
        elif role := self.role(own, classes):
            self.change(self.start, self.end, tag(name, {**own, "role": role}))

    @staticmethod
    def role(own: dict[str, str], classes: list[str]) -> str:
        """What assistive technology should take an element for; empty if it is as it should be."""
        if own.get("role") == "doc-biblioentry":  # deprecated
            return "listitem"
        return "presentation" if "indextable" in classes else ""

    def handle_endtag(self, name):
        if not self.opened.get(name):
            return
        start, inside, own = self.opened[name].pop()
        end = self.start + len(f"</{name}>")
        if name == "script":
            self.scripts.append(Script(start, end, own, self.text[inside : self.start]))
        elif SCROLLED in own.get("class", "").split():
            self.change(self.start, end, "</section>")

    def drop_scripts(self) -> None:
        """Take out those that the page does not need."""
        unused = {ICON_SCRIPT, *(() if self.has_results else SEARCH_SCRIPTS)}
        unused |= set() if self.has_formulas else {MATHS_SCRIPT}
        for script in self.scripts:
            if script.name in unused:
                self.change(script.start, script.end, "")

    def of_widgets(self, kind: str) -> list[Script]:
        """The scripts that hold widgets' "state" or "view" as JSON."""
        kind = f"application/vnd.jupyter.widget-{kind}+json"
        return [script for script in self.scripts if script.attributes.get("type") == kind]

    def separate_stills(self, store) -> None:
        """After each widget, its trait `still` as a picture for where there is no script.

        The picture becomes a file; what the trait held is no longer part of the page.
        """
        images = {}
        for script in self.of_widgets("state"):
            saved = json.loads(script.content)
            for model, entry in saved["state"].items():
                if address := entry.get("state", {}).pop("still", ""):
                    alt = entry["state"].get("still_alt", "")
                    image = tag("img", {"class": "still", "src": store(address), "alt": alt})
                    images[model] = f"<noscript>{image}</noscript>"
            state = json.dumps(saved).replace("</", "<\\/")
            new = f"{tag('script', script.attributes)}{state}</script>"
            self.change(script.start, script.end, new)
        for script in self.of_widgets("view"):
            model = json.loads(script.content)["model_id"]
            self.change(script.end, script.end, images.get(model, ""))


def keep(folder: Path, up: str, address: str) -> str:
    """Write what a ``data:`` address holds to a file; returns the file's relative address.

    Any other address is refused: a build opens nothing that a page names.
    """
    if not address.startswith("data:"):
        raise ValueError(f"address must begin with data:, got {address[:60]!r}")
    with urllib.request.urlopen(address) as opened:
        content, kind = opened.read(), opened.headers.get_content_subtype()
    name = f"{hashlib.sha256(content).hexdigest()[:12]}.{kind.removesuffix('+xml')}"
    folder.mkdir(exist_ok=True)
    (folder / name).write_bytes(content)
    return f"{up}{folder.name}/{name}"


def slim_css(css: str, store) -> str:
    """A style sheet without the icon font, what belongs to it, and ``data:``."""
    css = ICON_LETTER.sub('""', ICON_FONTS.sub("", ICON_RULES.sub("", css)))
    return CSS_DATA.sub(lambda url: f'url("{store(address(url))}")', css)


def address(url: re.Match) -> str:
    """The address in a ``url()``, as it is outside of style sheets."""
    quoted = url[1] or url[2]
    return urllib.parse.quote(re.sub(r"\\(.)", r"\1", quoted), safe=":/,;=%+")
