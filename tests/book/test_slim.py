"""What the build takes out of the pages and their styles."""

import json
import sys

import pytest
from book_pages import ROOT

sys.path.insert(0, str(ROOT / "book" / "_ext"))
import slim


class NoIcons:
    """In place of the theme's icon font."""

    def inline(self, attributes):
        return ""


def page(text: str) -> str:
    return slim.slim_page(text, NoIcons(), str)


def test_icon_fonts_go_and_leave_no_boxes():
    rules = "p{top:0}.fa-sun:before{content:'\\f185'}.fa-a,.fa-b::before{left:0}.fa-c p{left:1px}"
    fonts = "@font-face { src: url(x.woff2) }"
    icons = "p::after{content:'\\f107'}:root{--i:\"\uf05a\";--j:'\u2014 '}"
    left = 'p{top:0}.fa-c p{left:1px}p::after{content:""}:root{--i:"";--j:\'\u2014 \'}'
    assert slim.slim_css(rules + fonts + icons, str) == left


def test_no_other_address_than_data_is_opened(tmp_path):
    for address in ("http://localhost/x.svg", "file:///etc/hostname", "x.svg"):
        with pytest.raises(ValueError, match=r"^address must begin with data:"):
            slim.keep(tmp_path / "_images", "../", address)
    assert not list(tmp_path.iterdir())


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


REPAIRS = {
    '<div id="pst-primary-sidebar"><i class="fa-solid fa-sun"></i></div>': (
        '<div id="pst-primary-sidebar" role="complementary"><i class="fa-solid fa-sun"></i></div>'
    ),
    '<div class="citation" role="doc-biblioentry">&amp;</div>': (
        '<div class="citation" role="listitem">&amp;</div>'
    ),
    '<summary><span class="toctree-toggle"></span></summary>': (
        '<summary aria-label="Pages below this one"><span class="toctree-toggle"></span></summary>'
    ),
    '<button class="btn search-button-field" title="Search" aria-label="Search">': (
        '<button class="btn search-button-field">'
    ),
    '<table style="width: 100%" class="indextable genindextable">': (
        '<table style="width: 100%" class="indextable genindextable" role="presentation">'
    ),
    f'<div><div class="{slim.SCROLLED}"><table>\n<td><div>1</div></td></table></div>': (
        f'<div><section class="{slim.SCROLLED}"><table>\n<td><div>1</div></td></table></section>'
    ),
    '<link rel="preload" as="script" href="a.js" /><link rel="icon" href="a.svg"/>': (
        '<link rel="icon" href="a.svg"/>'
    ),
    '<meta http-equiv="Refresh" content="0; url=a.html" />': (
        f'{slim.HEAD}<meta http-equiv="Refresh" content="0; url=a.html" />'
    ),
    '<p title="a > b" hidden>&nbsp;&#x2F; <br><!-- <div id="x"> --><SVG viewBox="0 0 1 1"/>': None,
}


def test_pages_are_repaired_and_all_else_stays_as_it_is():
    for text, repaired in REPAIRS.items():
        assert page(text) == (repaired or text)


def test_icons_become_pictures_where_the_font_has_them():
    class Named:
        def inline(self, attributes):
            return f"[{attributes['class']}]" if "fa-sun" in attributes["class"] else ""

    text = (
        '<i class="fas fa-sun" data-mode="light"></i><i class="fas fa-none"></i><i class="a"></i>'
    )
    left = '[fas fa-sun]<i class="fas fa-none"></i><i class="a"></i>'
    assert slim.slim_page(text, Named(), str) == left


def test_stills_leave_the_state_of_widgets_for_files():
    state = {"state": {"m": {"state": {"still": "data:x", "still_alt": 'a "<" b', "k": "</p>"}}}}
    state = json.dumps(state).replace("</", "<\\/")
    kind = "application/vnd.jupyter.widget-"
    text = (
        f'<script type="{kind}view+json">{{"model_id": "m"}}</script><p>1</p>'
        f'<script type="{kind}state+json">{state}</script>'
    )
    made = slim.slim_page(text, NoIcons(), lambda address: f"_images/{address[5:]}.svg")
    assert (
        '<noscript><img class="still" src="_images/x.svg" alt="a &quot;&lt;&quot; b"></noscript>'
        "<p>1</p>" in made
    )
    assert made.endswith('"still_alt": "a \\"<\\" b", "k": "<\\/p>"}}}}</script>')
    assert "data:" not in made
