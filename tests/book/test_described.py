"""Alternative texts of the figures that open code makes: they say what is seen."""

from __future__ import annotations

import json
import re
import sys

import pytest
from book_pages import CHAPTERS, ROOT, source

sys.path.insert(0, str(ROOT / "book" / "_ext"))

FEWEST = 20  # words
HIDDEN = {"hide-input", "remove-input", "remove-cell"}
# Where and how: of axes, of what is drawn, and of where it stands
SEEN = re.compile(
    r"\b(?:axis|axes|across|over|against|left|right|above|below|upwards|top|middle|rows?|panels?|"
    r"columns?|lines?|curves?|dots?|bars?|squares?|circles?|stems|arch(?:es)?|valley|bell|hill)\b"
)
PAGES = [page for page in [*CHAPTERS, "book/use-it-on-your-arm"] if source(page)]


def open_figures(page: str) -> list[dict]:
    """What metadata say of the figures whose code stands open."""
    cells = json.loads(source(page).read_text(encoding="utf-8"))["cells"]
    told = [(cell["metadata"].get("mystnb", {}).get("figure"), cell["metadata"]) for cell in cells]
    return [one for one, data in told if one and not HIDDEN & set(data.get("tags", ()))]


def faults(figure: dict) -> list[str]:
    """Why a text does not do."""
    alt, caption = figure.get("alt", ""), figure["caption"]
    words, said = (set(re.findall(r"\w{4,}", text.lower())) for text in (alt, caption))
    found = [f"{len(alt.split())} words"] * (len(alt.split()) < FEWEST)
    found += ["the caption again"] * (len(words & said) > 0.6 * len(words))
    return found + ["nothing to be seen"] * (len(set(SEEN.findall(alt.lower()))) < 3)


def test_texts_say_what_is_seen():
    drawn = [(page, one) for page in PAGES for one in open_figures(page)]
    assert len(drawn) > 60
    assert not {(page, one["name"]): wrong for page, one in drawn if (wrong := faults(one))}
    assert len({one["alt"] for _, one in drawn}) == len(drawn)


@pytest.mark.built
def test_pages_have_the_words(parsed):
    for page in PAGES:
        for one in open_figures(page):
            forms = parsed(page).find(id=one["name"]).select('svg[role="figure"]')
            assert forms and all(one["alt"] in form["aria-label"] for form in forms), one["name"]
