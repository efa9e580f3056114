"""The built pages made small, self-contained and accessible: what the theme leaves to do.

The theme brings a script of icons and the search index to every page, compressed 640 kB. Here its
icons become inline SVG, the index is loaded where there is a search, and no ``data:`` address is
left, so that the pages work under a content security policy of ``'self' 'unsafe-inline' blob:``.
"""

from __future__ import annotations

import hashlib
import html
import json
import re
import shutil
import urllib.parse
import urllib.request
from functools import partial
from pathlib import Path

from fontTools.pens.svgPathPen import SVGPathPen
from fontTools.pens.transformPen import TransformPen
from fontTools.ttLib import TTFont

ICON_FONT = "vendor/fontawesome/webfonts/fa-solid-900.ttf"
UNUSED_FILES = ("vendor", "locales", "scripts/fontawesome.js*", "**/*.map", "*webpack-macros.html")

ICON_SCRIPT = "fontawesome.js"  # not needed: the icons are in the page
SEARCH_SCRIPTS = {"searchtools.js", "language_data.js", "searchindex.js"}
MATHS_SCRIPT = "tex-svg-full.js"

TOGGLE = '<summary><span class="toctree-toggle"'  # in the contents: an icon without words
FIELD = 'field search-button__button pst-js-only"'
HEAD = (  # for the page that only leads to the first one: without an icon, browsers look for it
    '<!doctype html><html lang="en"><meta charset="utf-8"><title>To the first page</title>'
    '<link rel="icon" href="_static/favicon.svg">'
)
# What Sphinx, the theme and myst-nb write, and what assistive technology needs instead.
REPAIRS = (
    ('<div id="pst-primary-sidebar"', '<div id="pst-primary-sidebar" role="complementary"'),
    ('role="doc-biblioentry"', 'role="listitem"'),  # that role is deprecated
    ('<summary aria-label="Toggle hidden content">', "<summary>"),  # its text says more
    (TOGGLE, TOGGLE.replace("<summary>", '<summary aria-label="Pages below this one">')),
    ('field search-button__button pst-js-only" title="Search" aria-label="Search"', FIELD),
    ('<table class="indextable', '<table role="presentation" class="indextable'),
)

SCROLLED = re.compile(
    r'<div( class="pst-scrollable-table-container">\s*<table.*?</table>\s*)</div>', re.DOTALL
)
FORMULA = re.compile(r'<\w+ [^>]*class="[^"]*(?<![\w-])math(?![\w-])')
ICON = re.compile(r'<(i|span) class="([^"]*\bfa-[^"]*)"([^>]*)>\s*</\1>')
PRELOAD = re.compile(r'<link rel="preload" as="script"[^>]*>\n?')
SCRIPT = re.compile(r'[ \t]*<script[^>]*\bsrc="[^"]*?([^/"?]+\.js)[^"]*"[^>]*></script>\n?')
STATE = re.compile(
    r'(?<=<script type="application/vnd\.jupyter\.widget-state\+json">).*?(?=</script>)', re.DOTALL
)
VIEW = re.compile(
    r'<script type="application/vnd\.jupyter\.widget-view\+json">(.*?)</script>', re.DOTALL
)
CSS_DATA = re.compile(r"""url\((?:"(data:(?:[^"\\]|\\.)*)"|(data:[^)]*))\)""")
# Rules of single icons: `.fa-sun:before{content:"\\f185"}`, 1,900 of them.
ICON_RULES = re.compile(r"(?<=[};])(?:\.fa-[\w.-]+(?::{1,2}\w+)?,?)+\{[^{}]*\}")
ICON_FONTS = re.compile(r"@font-face\s*\{[^}]*\}")  # the theme has no others
ICON_LETTER = re.compile(r"""(["'])(?:\\[ef][0-9a-f]{3}|[\ue000-\uf8ff])\1""", re.IGNORECASE)


def slim(out: Path) -> None:
    """Rewrite all pages and style sheets of a built site in place."""
    static = out / "_static"
    icons = Icons(static / ICON_FONT)
    for pattern in UNUSED_FILES:
        for path in static.glob(pattern):
            shutil.rmtree(path) if path.is_dir() else path.unlink()
    for path in [*out.rglob("*.html"), *static.rglob("*.css")]:
        store = partial(keep, out / "_images", "../" * (len(path.relative_to(out).parts) - 1))
        text = path.read_text(encoding="utf-8")
        text = slim_css(text, store) if path.suffix == ".css" else slim_page(text, icons, store)
        path.write_text(text, encoding="utf-8")


def slim_page(text: str, icons: Icons, store) -> str:
    """A page without what it does not use, repaired for assistive technology."""
    text = re.sub(r'\A(?=<meta http-equiv="Refresh")', HEAD, text)
    for old, new in REPAIRS:
        text = text.replace(old, new)
    text = SCROLLED.sub(r"<section\1</section>", text)  # a div that scrolls has no role
    text = ICON.sub(icons.inline, text)
    text = PRELOAD.sub("", text)  # fails where scripts are off
    unused = {ICON_SCRIPT} if 'id="search-results"' in text else {ICON_SCRIPT, *SEARCH_SCRIPTS}
    unused |= set() if FORMULA.search(text) else {MATHS_SCRIPT}
    text = SCRIPT.sub(lambda tag: "" if tag[1] in unused else tag[0], text)
    return separate_stills(text, store)


class Icons:
    """The theme's icons as inline SVG, from the outlines of its icon font."""

    def __init__(self, path: Path):
        self.glyphs = TTFont(path).getGlyphSet()

    def inline(self, tag: re.Match) -> str:
        """The icon that an empty ``<i class="fa-solid fa-sun">`` stands for."""
        found = [name[3:] for name in tag[2].split() if name[3:] in self.glyphs]
        if not found:
            return tag[0]
        glyph = self.glyphs[found[0]]
        pen = SVGPathPen(self.glyphs)
        glyph.draw(TransformPen(pen, (1, 0, 0, -1, 0, 448)))  # y downwards, from the top
        mode = re.search(r'data-mode="\w+"', tag[3])
        return (
            f'<svg class="icon {" ".join(tag[2].split())}" {mode[0] if mode else ""} '
            f'viewBox="0 0 {glyph.width:g} 512" aria-hidden="true">'
            f'<path fill="currentColor" d="{pen.getCommands()}"/></svg>'
        )


def separate_stills(text: str, store) -> str:
    """After each widget, its trait `still` as a picture for where there is no script.

    The picture becomes a file; what the trait held is no longer part of the page.
    """
    found = STATE.search(text)
    if not found:
        return text
    saved = json.loads(found[0])
    images = {}
    for model, entry in saved["state"].items():
        address = entry.get("state", {}).pop("still", "")
        if address:
            alt = html.escape(entry["state"].get("still_alt", ""))
            image = f'<img class="still" src="{store(address)}" alt="{alt}">'
            images[model] = f"<noscript>{image}</noscript>"
    text = VIEW.sub(lambda view: view[0] + images.get(json.loads(view[1])["model_id"], ""), text)
    return STATE.sub(lambda _: json.dumps(saved).replace("</", "<\\/"), text)


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
