"""The book to take along: page numbers where they are asked for, an index, XML for an EPUB."""

import io
import sys
import zipfile

import pytest
from book_pages import CHAPTERS, EVIDENCE, ROOT
from pypdf import PdfReader, PdfWriter

sys.path.insert(0, str(ROOT / "book" / "_ext"))
import epub
import pdf


def test_the_walk_has_every_lesson_and_the_second_volume_the_evidence():
    walk = [page for _, pages in pdf.contents(ROOT, "walk") for page in pages]
    behind = [page for _, pages in pdf.contents(ROOT, "evidence") for page in pages]
    assert [page for page in walk if page in CHAPTERS] == CHAPTERS
    assert not set(walk) & set(EVIDENCE) and [*behind[: len(EVIDENCE)]] == EVIDENCE


def test_pages_are_filled_in_and_an_index_names_each_once():
    text = (
        f'<ul class="index"><li>null {pdf._page("a")} {pdf._page("b")} {pdf._page("c")}</li></ul>'
    )
    text = text.replace("</li>", f" {pdf._page('unprinted')}</li>")
    found = pdf.filled(pdf.once_a_page(text, {"a": 7, "b": 7, "c": 9}), {"a": 7, "b": 7, "c": 9})
    assert found.count(">7<") == 1 and found.count(">9<") == 1 and "000" not in found
    assert ">000<" in pdf.filled(pdf._page("lost"), {"a": 7})


def test_the_index_leaves_out_what_is_everywhere():
    pages = [{"terms": [("window", f"w{k}")] + [("null", "n")] * (k == 1)} for k in range(20)]
    assert "null" in pdf.index(pages) and "window" not in pdf.index(pages)
    assert {"acceleration filter", "mass matrix", "backlash"} <= set(pdf.words(ROOT))


def test_an_outline_has_no_title_twice():
    writer, headings = PdfWriter(), ["1. Dynamics", "1.1. Change this", "1.2. Go on"]
    writer.add_blank_page(100, 100)
    above = writer.add_outline_item(title="1. 1. DynamicsDynamics", page_number=0)
    writer.add_outline_item(title="1.1. Change this", page_number=0, parent=above)
    writer.add_outline_item(title="1.2. 1.2. Go onGo on", page_number=0)
    writer.add_outline_item(title="Nobody's", page_number=0)
    pdf.titled(writer.root_object["/Outlines"].get_object().get("/First"), headings)
    first, below, *others = PdfReader(writer.write(io.BytesIO())[1]).outline
    titles = [first.title, below[0].title, *(entry.title for entry in others)]
    assert titles == ["1. Dynamics", "1.1. Change this", "1.2. Go on", "Nobody's"]


def test_a_volume_is_offered_on_the_first_page_once(tmp_path):
    (tmp_path / "book").mkdir()
    first, made = tmp_path / "book" / "index.html", tmp_path / "new" / "walk.pdf"
    told = '<span class="pre">make</span> <span class="pre">pdf</span>'
    first.write_text(f'<p><code class="docutils literal notranslate">{told}</code> makes</p>')
    made.parent.mkdir()
    made.write_bytes(b"pdf")
    for _ in range(2):
        pdf.offered(tmp_path, made, "make pdf")
    assert first.read_text().count('<a href="../walk.pdf" download>') == 1
    assert (tmp_path / "walk.pdf").read_bytes() == b"pdf"


@pytest.mark.browser
@pytest.mark.chromium
def test_printed_places_have_their_pages(browser, tmp_path):
    path = tmp_path / "two.html"
    path.write_text(
        '<title>x</title><a href="#one">1</a> <a href="#two">2</a><h1 id="one">One</h1>'
        '<h1 id="two" style="break-before: page">Two</h1>',
        encoding="utf-8",
    )
    assert pdf.numbers(pdf.printed(browser, path)) == {"one": 1, "two": 2}


def test_an_epub_leads_from_file_to_file(tmp_path):
    picture = tmp_path / "a.png"
    picture.write_bytes(b"png")
    one = '<h1 id="a--start">A</h1><p data-x="1"><a href="#b--start">B</a></p>'
    one += f'<img src="{picture.as_uri()}"/><a href="#gone">x</a>'
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
        assert archive.read("book/images/a.png") == b"png"
        assert "solutions.xhtml" in archive.read("book/nav.xhtml").decode()
