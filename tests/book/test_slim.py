"""What the build takes out of the pages and their styles."""

import sys

import pytest
from book_pages import ROOT

sys.path.insert(0, str(ROOT / "book" / "_ext"))
import slim


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
