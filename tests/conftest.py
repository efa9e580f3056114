"""Fixtures that open built pages, and hypothesis settings that hold on a busy machine."""

from __future__ import annotations

import gc
import os
import shutil
import tempfile
from functools import cache

import chromium
import firefox
import pytest
from bs4 import BeautifulSoup
from hypothesis import settings
from widget_pages import CALM, NEXT_FRAME, page_of

from workshop.report import results
from workshop.report.evidence import verdicts
from workshop.report.evidence.claims import SHARED

CI = os.environ.get("CI", "").lower() in {"1", "true"}

settings.register_profile("book", deadline=None, derandomize=CI, print_blob=True)
settings.load_profile("book")


def pytest_configure(config):
    """What a claim measures is measured once, by whichever of the processes needs it first."""
    if SHARED not in os.environ:
        os.environ[SHARED] = tempfile.mkdtemp(prefix="measured-")
        config.add_cleanup(lambda: shutil.rmtree(os.environ.pop(SHARED), ignore_errors=True))


def pytest_collection_finish(session):
    """Modules and ten thousand tests stay: they need not be looked through for garbage."""
    gc.freeze()
    gc.set_threshold(50_000, 20, 50)


@pytest.fixture
def planted_members(monkeypatch):
    """Measures may be tested on planted members, few enough to reckon by hand."""
    monkeypatch.setattr(verdicts, "FEWEST", 1)


@pytest.fixture
def planted_results(monkeypatch):
    """``planted_results(NAME=content)``: committed results, made to be reckoned by hand."""
    return lambda **planted: monkeypatch.setattr(results, "read", planted.__getitem__)


@pytest.fixture(scope="session")
def playwright():
    """What drives browsers; there can be one of it."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as running:
        yield running


@pytest.fixture(scope="session")
def browser(request):
    """A headless Chromium. Without one the test is skipped, or fails under CI=true."""
    if chromium.find() is None:
        (pytest.fail if CI else pytest.skip)(chromium.HOW_TO_GET_ONE)
    with chromium.launched(request.getfixturevalue("playwright")) as running:
        yield running


@pytest.fixture(scope="session")
def built():
    """The folder of the built pages."""
    if not (chromium.HTML / ".built-from").is_file():
        pytest.fail("there is no clean build of the book: run `make book` first")
    return chromium.HTML


@pytest.fixture(scope="session")
def parsed(built):
    """``parsed(name)`` is a built page, read once."""
    return cache(lambda name: BeautifulSoup((built / f"{name}.html").read_bytes(), "html.parser"))


@pytest.fixture(scope="session")
def site(built):
    """The address of a loopback server with the built pages."""
    with chromium.serve(built) as address:
        yield address


class Visit:
    """An open page and everything that went wrong on it."""

    def __init__(self, context, url: str, lands: str | None):
        self.problems: list[str] = []
        self.responses: list = []
        self.home = url.split("/", 3)[2]  # host and port; empty for file:
        self.page = context.new_page()
        self.page.on("console", self._console)
        self.page.on("pageerror", lambda error: self.problems.append(f"page error: {error}"))
        self.page.on("request", self._request)
        self.page.on("requestfailed", lambda request: self._failed(request, bool(lands)))
        self.page.on("response", self._response)
        self.page.goto(url)
        if lands:
            self.page.wait_for_url(lands)
        chromium.settle(self.page)

    def _console(self, message):
        if message.type in {"error", "warning"}:
            self.problems.append(f"console {message.type}: {message.text}")

    def _request(self, request):
        scheme, _, rest = request.url.partition(":")
        local = scheme in {"data", "blob", "file"} or rest.split("/")[2] == self.home
        if not local:
            self.problems.append(f"external request: {request.url[:200]}")

    def _failed(self, request, leaving: bool):
        """A page that sends its reader on may be left before its icon has come."""
        if not (leaving and request.failure in {"net::ERR_ABORTED", "NS_BINDING_ABORTED"}):
            self.problems.append(f"failed: {request.url[:200]} ({request.failure})")

    def _response(self, response):
        self.responses.append(response)
        if response.status >= 400:
            self.problems.append(f"{response.status}: {response.url[:200]}")


@pytest.fixture
def page_with(tmp_path, visit):
    """``page_with(widget)``: an open page with widgets alone, on which nothing may go wrong.

    `query` ends its address, `calm` is a reader who wants no motion; other options are those of
    `widget_pages.page_of`.
    """
    opened = []

    def open_page(*widgets, query="", calm=False, **options):
        address = page_of(tmp_path / "page.html", *widgets, **options)
        opened.append(visit(f"{address}{query}", **(CALM if calm else {})))
        opened[-1].page.evaluate(NEXT_FRAME)
        return opened[-1].page

    yield open_page
    assert not [problem for each in opened for problem in each.problems]


@pytest.fixture
def visit(browser):
    """Open a page: `visit(url, scheme="light", width=1280, height=800)` -> Visit.

    `lands` is the address pattern that the page redirects to; other options are those of
    Playwright's ``new_context``.
    """
    contexts = []

    def open_page(
        url: str,
        scheme: str = "light",
        width: int = 1280,
        lands: str | None = None,
        height: int = 800,
        **options,
    ) -> Visit:
        size = {"width": width, "height": height}
        context = browser.new_context(color_scheme=scheme, viewport=size, **options)
        contexts.append(context)
        if chromium.FIREFOX and options.get("reduced_motion") == "reduce":
            context.add_init_script(firefox.CALM)
        return Visit(context, url, lands)

    yield open_page
    for context in contexts:
        context.close()
