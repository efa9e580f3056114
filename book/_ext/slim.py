"""The built pages made small, self-contained and accessible: what the theme leaves to do.

The theme brings 2.3 MB of icons, styles and search index to every page. Here its icons become
inline SVG, scripts and style rules that no page uses go, and no ``data:`` address is left, so
that the pages work under a content security policy of ``'self' 'unsafe-inline' blob:``.
"""

from __future__ import annotations

import hashlib
import html
import itertools
import json
import re
import shutil
import urllib.parse
import urllib.request
from functools import partial
from pathlib import Path

import tinycss2
from fontTools.pens.svgPathPen import SVGPathPen
from fontTools.pens.transformPen import TransformPen
from fontTools.ttLib import TTFont

from compact_svg import compact

ICON_FONT = "vendor/fontawesome/webfonts/fa-solid-900.ttf"
UNUSED_FILES = ("vendor", "locales", "scripts/fontawesome.js*", "**/*.map", "*webpack-macros.html")

SEARCH = 'id="search-results"'
CODE = 'class="highlight'
# Scripts, and what a page must contain to load them.
NEEDS = {
    "fontawesome.js": None,  # the icons are in the page
    "searchtools.js": SEARCH,
    "language_data.js": SEARCH,
    "searchindex.js": SEARCH,
    "design-tabs.js": "sd-tab-set",
    "togglebutton.js": r'class="(?:[^"]* )?toggle[ "]|admonition[^"]* dropdown',
    "clipboard.min.js": CODE,
    "copybutton.js": CODE,
}

FIELD = 'field search-button__button pst-js-only"'
NO_SUMMARY = (  # of search results: fetching their pages fails from a folder
    '<script>DOCUMENTATION_OPTIONS.SHOW_SEARCH_SUMMARY &&= location.protocol !== "file:"</script>'
)
HEAD = (  # for the page that only leads to the first one: without an icon, browsers look for it
    '<!doctype html><html lang="en"><meta charset="utf-8"><title>To the first page</title>'
    '<link rel="icon" href="_static/favicon.svg">'
)
# What Sphinx, the theme and myst-nb write, and what assistive technology needs instead.
REPAIRS = (
    ('<div id="pst-primary-sidebar"', '<div id="pst-primary-sidebar" role="complementary"'),
    ('<div id="search-results">', NO_SUMMARY + '<div id="search-results">'),
    ('role="doc-biblioentry"', 'role="listitem"'),  # that role is deprecated
    ('<summary aria-label="Toggle hidden content">', "<summary>"),  # its text says more
    ('field search-button__button pst-js-only" title="Search" aria-label="Search"', FIELD),
    ('<table class="indextable', '<table role="presentation" class="indextable'),
)

SCROLLED = re.compile(
    r'<div( class="pst-scrollable-table-container">\s*<table.*?</table>\s*)</div>', re.DOTALL
)
ICON = re.compile(r'<(i|span) class="([^"]*\bfa-[^"]*)"([^>]*)>\s*</\1>')
FIGURE = re.compile(r'(<div class="ddlib-figure">)(<svg.*?</svg>)', re.DOTALL)
BLOCK = re.compile(r'(?<=<div class="highlight"><pre>).*?(?=</pre>)', re.DOTALL)
PRELOAD = re.compile(r'<link rel="preload" as="script"[^>]*>\n?')
SCRIPT = re.compile(r'[ \t]*<script[^>]*\bsrc="[^"]*?([^/"?]+\.js)[^"]*"[^>]*></script>\n?')
STATE = re.compile(
    r'(?<=<script type="application/vnd\.jupyter\.widget-state\+json">).*?(?=</script>)', re.DOTALL
)
VIEW = re.compile(
    r'<script type="application/vnd\.jupyter\.widget-view\+json">(.*?)</script>', re.DOTALL
)
CSS_DATA = re.compile(r"""url\((?:"(data:(?:[^"\\]|\\.)*)"|(data:[^)]*))\)""")
PRIVATE_USE = re.compile('"[\ue000-\uf8ff]"')  # icons of a font


def slim(out: Path) -> None:
    """Rewrite all pages and style sheets of a built site in place."""
    static = out / "_static"
    icons = Icons(static / ICON_FONT)
    coloured = coloured_code((static / "pygments.css").read_text(encoding="utf-8"))
    pages = {path: path.read_text(encoding="utf-8") for path in out.rglob("*.html")}
    used, scripts = set(), set()
    for path, text in pages.items():
        store = partial(keep, out / "_images", "../" * (len(path.relative_to(out).parts) - 1))
        text = slim_page(text, icons, coloured, store)
        path.write_text(text, encoding="utf-8")
        used |= names(text)
        scripts |= {static / src for src in re.findall(r'src="[^"]*?_static/([^"?]*\.js)', text)}
    for pattern in UNUSED_FILES:
        for path in static.glob(pattern):
            shutil.rmtree(path) if path.is_dir() else path.unlink()
    for path in scripts:
        used |= set(re.findall(r"[\w-]+", path.read_text(encoding="utf-8")))
    for path in static.rglob("*.css"):
        up = "../" * len(path.relative_to(out).parent.parts)
        css = path.read_text(encoding="utf-8")
        path.write_text(slim_css(css, used, partial(keep, out / "_images", up)), encoding="utf-8")


def slim_page(text: str, icons: Icons, coloured: set[str], store) -> str:
    """A page without what it does not use, repaired for assistive technology."""
    text = re.sub(r'\A(?=<meta http-equiv="Refresh")', HEAD, text)
    for old, new in REPAIRS:
        text = text.replace(old, new)
    text = SCROLLED.sub(r"<section\1</section>", text)  # a div that scrolls has no role
    text = ICON.sub(icons.inline, text)
    text = PRELOAD.sub("", text)  # fails where scripts are off
    text = SCRIPT.sub(lambda tag: tag[0] if wanted(tag[1], text) else "", text)
    plain = partial(re.sub, r'<span class="(\w+)">([^<]*)</span>', partial(uncoloured, coloured))
    text = BLOCK.sub(lambda block: plain(block[0]).replace("<span></span>", ""), text)
    numbers, letters = itertools.count(), {}

    def smaller(found):
        return found[1] + compact(found[2], f"f{next(numbers)}", letters)

    text = FIGURE.sub(smaller, text)
    return separate_stills(text, store)


def wanted(script: str, page: str) -> bool:
    """Whether the page uses what the script is for."""
    need = NEEDS.get(script, "")
    return need is not None and bool(re.search(need, page))


def coloured_code(css: str) -> set[str]:
    """Classes of code that look different from the rest of it, in light or in dark."""
    plain = re.findall(r"(\S*) \.highlight \{[^}]*?(color: #\w+)[^}]*\}", css)
    rules = re.findall(r"(\S*) \.highlight \.(\w+) \{([^}]*)\}", css)
    found = {name for where, name, style in rules if (where, style.strip(" ;")) not in plain}
    if not found:
        raise ValueError("the style sheet of code must colour something: was it written already?")
    return found


def uncoloured(coloured: set[str], span: re.Match) -> str:
    """A piece of code without its mark-up where no style follows from that."""
    return span[0] if span[1] in coloured else span[2]


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


def names(page: str) -> set[str]:
    """Classes and ids of a page."""
    values = re.findall(r'\b(?:class|id)="([^"]*)"', page)
    return {name for value in values for name in value.split()}


def slim_css(css: str, used: set[str], store) -> str:
    """A style sheet without rules that nothing can match, without fonts and ``data:``."""
    notices = re.findall(r"/\*!.*?\*/", css, flags=re.DOTALL)
    rules = tinycss2.parse_stylesheet(css, skip_comments=True, skip_whitespace=True)
    text = "\n".join(filter(None, (slim_rule(rule, used) for rule in rules)))
    text = CSS_DATA.sub(lambda url: f'url("{store(address(url))}")', PRIVATE_USE.sub('""', text))
    return "\n".join([*notices, text, ""])


def address(url: re.Match) -> str:
    """The address in a ``url()``, as it is outside of style sheets."""
    quoted = url[1] or url[2]
    return urllib.parse.quote(re.sub(r"\\(.)", r"\1", quoted), safe=":/,;=%+")


def slim_rule(rule, used: set[str]) -> str:
    """A rule with the selectors that can match something; empty if none can."""
    if rule.type == "qualified-rule":
        selectors = split(rule.prelude)
        alive = [s for s in selectors if set(needed(s)) <= used]
        return f"{','.join(alive)}{{{compressed(rule.content)}}}" if alive else ""
    if rule.type == "at-rule" and rule.lower_at_keyword in {"media", "supports"}:
        inner = tinycss2.parse_rule_list(rule.content, skip_comments=True, skip_whitespace=True)
        text = "".join(slim_rule(one, used) for one in inner)
        return f"@{rule.at_keyword}{tinycss2.serialize(rule.prelude)}{{{text}}}" if text else ""
    if rule.type == "at-rule" and rule.lower_at_keyword == "font-face":
        return ""
    return rule.serialize()


def split(prelude) -> list[str]:
    """The selectors of a list."""
    parts = [[]]
    for token in prelude:
        parts.append([]) if token == "," else parts[-1].append(token)
    return [tinycss2.serialize(part).strip() for part in parts]


def needed(selector: str) -> list[str]:
    """Classes and ids that must be in a page for the selector to match."""
    selector = re.sub(r"\[[^\]]*\]", "", selector)
    inner = 1
    while inner:  # what is in :not() or :is() may be absent
        selector, inner = re.subn(r":[\w-]+\([^()]*\)", "", selector)
    return [name.replace("\\", "") for name in re.findall(r"[.#]((?:[\w-]|\\.)+)", selector)]


def compressed(tokens) -> str:
    """Declarations without the spaces between them."""
    return re.sub(r"\s+", " ", tinycss2.serialize(tokens)).replace("; ", ";").strip(" ;")
