"""What the build takes out of the pages and their styles, and what it puts right."""

import base64
import json
import re
import sys
from pathlib import Path

import pydata_sphinx_theme
import pytest
from book_pages import ROOT
from bs4 import BeautifulSoup

sys.path.insert(0, str(ROOT / "book" / "_ext"))
import slim

SVG = "<svg xmlns='http://www.w3.org/2000/svg'/>"


class NoIcons:
    """In place of the theme's icon font."""

    def inline(self, tag):
        return tag[0]


def page(text: str) -> str:
    return slim.slim_page(text, NoIcons(), str)


def test_icon_fonts_go_and_leave_no_boxes():
    rules = "p{top:0}.fa-sun:before{content:'\\f185'}.fa-a,.fa-b::before{left:0}.fa-c p{left:1px}"
    fonts = "@font-face { src: url(x.woff2) }"
    icons = "p::after{content:'\\f107'}:root{--i:\"\uf05a\";--j:'\u2014 '}"
    left = 'p{top:0}.fa-c p{left:1px}p::after{content:""}:root{--i:"";--j:\'\u2014 \'}'
    assert slim.slim_css(rules + fonts + icons, str) == left


ADDRESSES = (
    f'"data:image/svg+xml,{SVG}"',
    '"data:image/svg+xml,%3csvg xmlns=%27http://www.w3.org/2000/svg%27/%3e"',
    "data:image/svg+xml;base64," + base64.b64encode(SVG.encode()).decode(),
)


def test_data_in_styles_becomes_a_file_and_no_other_address_is_opened(tmp_path):
    folder = tmp_path / "_images"

    def store(data):
        return slim.keep(folder, "../", data)

    for address in ADDRESSES:
        made = slim.slim_css(f"p {{ background: url({address}) }}", store)
        name = re.fullmatch(r'p \{ background: url\("\.\./_images/(\w+\.svg)"\) \}', made)[1]
        assert (folder / name).read_text().lower() == SVG.lower()
    before = list(folder.iterdir())
    for address in ("http://localhost/x.svg", "file:///etc/hostname", "x.svg"):
        with pytest.raises(ValueError, match=r"^address must begin with data:"):
            store(address)
    assert list(folder.iterdir()) == before


def test_icons_are_drawn_in_the_page():
    theme = Path(pydata_sphinx_theme.__file__).parent
    icons = slim.Icons(next(theme.rglob(Path(slim.ICON_FONT).name)))
    tag = '<i class="theme-switch fa-solid  fa-sun fa-lg" data-mode="light" title="Light"></i>'
    made = BeautifulSoup(slim.ICON.sub(icons.inline, tag), "html.parser").svg
    assert made["class"] == ["icon", "theme-switch", "fa-solid", "fa-sun", "fa-lg"]
    assert made["data-mode"] == "light" and made["aria-hidden"] == "true"
    assert len(made.path["d"]) > 100
    unknown = '<i class="fa-solid fa-nothing-like-it"></i>'
    assert slim.ICON.sub(icons.inline, unknown) == unknown


SCRIPTS = [
    ("scripts/fontawesome.js?digest=1", 'class="highlight"', False),
    ("searchtools.js", "", False),
    ("searchtools.js", '<div id="search-results">', True),
    ("../searchindex.js", "", False),
    ("copybutton.js?v=1", "", True),
    ("doctools.js", "", True),
    ("mathjax/tex-svg-full.js", "", False),
    ("mathjax/tex-svg-full.js", '<p class="maths">a</p>', False),
    ("mathjax/tex-svg-full.js", '<span class="math notranslate">x</span>', True),
    ("mathjax/tex-svg-full.js", '<div id="e" class="math notranslate">x</div>', True),
    ("mathjax/tex-svg-full.js", '<div class="output text_latex math">x</div>', True),
]


def test_a_page_loads_the_scripts_it_uses():
    for script, body, stays in SCRIPTS:
        made = page(f'<script defer src="_static/{script}"></script>{body}')
        assert ("<script" in made) is stays, (script, body)


def test_the_page_that_leads_on_has_a_head():
    leads = '<meta http-equiv="Refresh" content="0; url=book/index.html" />'
    made = page(leads)
    assert made.startswith("<!doctype html>") and made.endswith(leads)
    assert 'rel="icon"' in made and page(made) == made


def test_a_table_that_scrolls_is_a_section():
    table = '<div class="pst-scrollable-table-container"><table><tr><td>1</td></tr></table>\n</div>'
    made = page(f"<div>{table}</div>")
    assert (
        made == "<div>" + table.replace("<div", "<section").replace("</div", "</section") + "</div>"
    )


def test_stills_become_files_for_pages_without_script():
    view = '<script type="application/vnd.jupyter.widget-view+json">{"model_id": "%s"}</script>'
    body = f"<p>{view % 'a'}</p><p>{view % 'b'}</p><p>{view % 'gone'}</p>"
    state = {
        "a": {"state": {"still": "data:,x", "still_alt": 'An "arm"', "words": "</script>"}},
        "b": {"state": {"x": 1}},
    }
    kind = '<script type="application/vnd.jupyter.widget-state+json">'
    saved = json.dumps({"state": state}).replace("</", "<\\/")
    made = slim.separate_stills(f"{kind}{saved}</script>{body}", lambda data: f"file-of-{data}")
    image = (
        '<noscript><img class="still" src="file-of-data:,x" alt="An &quot;arm&quot;"></noscript>'
    )
    assert made.endswith(body.replace(view % "a", view % "a" + image))
    left = json.loads(slim.STATE.search(made)[0])["state"]
    assert "still" not in left["a"]["state"]
    assert left["a"]["state"]["words"] == "</script>" and left["b"] == state["b"]
    assert slim.separate_stills("<p>text</p>", str) == "<p>text</p>"
