"""The book to take along: page numbers where they are asked for, an index, XML for an EPUB."""

import io
import zipfile

import epub
import offers
import pdf
import pytest
from book_pages import CHAPTERS, EVIDENCE, ROOT
from bs4 import BeautifulSoup

import ddlib


def test_the_walk_has_every_lesson_and_the_second_volume_the_evidence():
    walk = [page for _, pages in pdf.contents(ROOT, "walk") for page in pages]
    behind = [page for _, pages in pdf.contents(ROOT, "evidence") for page in pages]
    assert [page for page in walk if page in CHAPTERS] == CHAPTERS
    assert not set(walk) & set(EVIDENCE) and [*behind[: len(EVIDENCE)]] == EVIDENCE


def volume(**changes) -> str:
    """A volume of two chapters in one part."""
    one = {
        "name": "book/a",
        "part": "I & II",
        "title": 'A "<b>"',
        "anchor": "a",
        "body": "<h1>A</h1>",
    }
    one |= {"solutions": "", "styles": ["<style>p {}</style>"], "terms": [("null", "a")]}
    two = one | {"title": "B", "anchor": "b", "body": '<h1 id="b">B</h1>'}
    return pdf.joined("walk", [one | changes, two | {"terms": [("null", "b"), ("null", "lost")]}])


def test_a_volume_has_parts_contents_and_index():
    made = BeautifulSoup(volume(), "html.parser")
    assert ", ".join(pdf.AUTHORS) in made.select_one(".front").text
    assert [item.text for item in made.select(".contents li")] == [
        "I & II", 'A "<b>"000', "B000", "Index000",
    ]  # fmt: skip
    assert [part.text.strip() for part in made.select(".part h1")] == ["I & II"]
    assert made.select_one(".index li").text.split() == ["null", "000", "000", "000"]
    assert """@page c0 { @top-left { content: "A \\"<b>\\""; } }""" in made.select("style")[1].text
    assert not made.select("#solutions") and made.select(".chapter h1")[1]["id"] == "b"
    solved = BeautifulSoup(volume(solutions="<p>1</p>"), "html.parser")
    assert [item.text for item in solved.select("#solutions :is(h1, h2, p)")] == [
        "Solutions", 'A "<b>"', "1",
    ]  # fmt: skip


@pytest.mark.browser
@pytest.mark.chromium
def test_page_numbers_are_filled_in_and_an_index_names_each_once(browser, tmp_path):
    path = tmp_path / "volume.html"
    path.write_text(volume(), encoding="utf-8")
    with pdf.opened(browser, path) as page:
        headings = page.evaluate((pdf.HERE / "fill.js").read_text("utf-8"), {"a": 7, "b": 7})
        told = (
            page.locator(".index li").inner_text(),
            page.locator(".contents a.at").all_inner_texts(),
        )
    assert told == ("null 7", ["7", "7", "000"])  # the index itself has no number here
    assert headings == ["Contents", "I & II", "A", "B", "Index"]


def test_a_site_offers_what_lies_in_it(tmp_path):
    first = tmp_path / offers.FIRST
    first.parent.mkdir()
    first.write_text(f"<p>a</p>{offers.PLACE}</div><div>b</div>")

    def offered() -> str:
        for _ in range(2):  # twice is as once
            offers.offer(tmp_path)
        before, _, after = first.read_text().partition(offers.PLACE)
        inside, _, after = after.partition("</div>")
        assert (before, after) == ("<p>a</p>", "<div>b</div>")
        return inside

    (tmp_path / "notebooks.zip").touch()
    assert offered() == ""  # the page says elsewhere where these are
    (tmp_path / "walk.pdf").write_bytes(bytes(2_600_000))
    assert '<a href="../walk.pdf" download>the walk as a PDF</a> (3 MB)' in offered()
    assert "notebooks.zip" in offered() and "book.epub" not in offered()
    (tmp_path / offers.LIVE).parent.mkdir(parents=True)
    (tmp_path / offers.LIVE).touch()
    assert "Run this page" in offered() and "walk.pdf" in offered()
    first.write_text("no place")
    with pytest.raises(ValueError, match="no place for offers"):
        offers.offer(tmp_path)


@pytest.mark.built
def test_the_first_page_has_a_place_for_offers(built):
    assert (built / offers.FIRST).read_text(encoding="utf-8").count(offers.PLACE) == 1


@pytest.mark.browser
@pytest.mark.chromium
def test_printed_places_have_their_pages(browser, tmp_path):
    path = tmp_path / "two.html"
    path.write_text(
        '<title>x</title><a href="#one">1</a> <a href="#two">2</a><h1 id="one">One</h1>'
        '<h1 id="two" style="break-before: page">Two</h1>',
        encoding="utf-8",
    )
    with pdf.opened(browser, path) as page:
        assert pdf.numbers(pdf.printed(page)) == {"one": 1, "two": 2}


def test_an_epub_leads_from_file_to_file(tmp_path, monkeypatch):
    monkeypatch.setattr(epub, "AUTHORS", ["Ada & Co", "Emmy Noether"])
    monkeypatch.setattr(epub, "git", lambda *words: "2026-01-31")
    picture = tmp_path / "a.png"
    picture.write_bytes(b"png")
    one = '<h1 id="a--start">A</h1><p data-x="1"><a href="#b--start">B</a></p>'
    one += f'<img src="{picture.as_uri()}"/><a href="#gone">x</a>'
    one += (
        '<svg xmlns="http://www.w3.org/2000/svg" role="figure" viewBox="0 0 1 1"/><mjx-a>y</mjx-a>'
    )
    found = [
        {"name": "book/a", "title": "A & B", "body": one, "solutions": ""},
        {"name": "book/b", "title": "B", "body": '<h1 id="b--start">B</h1>', "solutions": "<p/>"},
    ]
    epub.make(found, tmp_path / "book.epub")
    with zipfile.ZipFile(io.BytesIO((tmp_path / "book.epub").read_bytes())) as archive:
        assert archive.namelist()[0] == "mimetype"
        assert archive.infolist()[0].compress_type == zipfile.ZIP_STORED
        text = archive.read("book/a.xhtml").decode()
        assert 'href="b.xhtml#b--start"' in text and 'src="images/a.png"' in text
        assert "A &amp; B" in text and "data-x" not in text and "#gone" not in text
        assert '<svg viewBox="0 0 1 1" xmlns="http://www.w3.org/2000/svg" /><span>y</span>' in text
        assert text.count("<a>x</a>") == 1
        assert archive.read("book/images/a.png") == b"png"
        manifest = archive.read("book/content.opf").decode()
        assert '"a.xhtml" media-type="application/xhtml+xml" properties="svg"' in manifest
        assert ":walk:" + ddlib.__version__ + "<" in manifest and ">2026-01-31T00:" in manifest
        assert "<dc:creator>Ada &amp; Co</dc:creator>\n<dc:creator>Emmy Noether<" in manifest
        assert "solutions.xhtml" in archive.read("book/nav.xhtml").decode()
