"""A release's archive of the live site: unzipped and served, it runs with no way to the outside."""

import subprocess
import sys
import zipfile

import pytest
import release
from book_pages import ROOT
from live_pages import KEPT, MIRROR, pages, runs_through

DEAD_END = {"server": "http://127.0.0.1:9", "bypass": "127.0.0.1"}  # a proxy that is not there


@pytest.fixture
def unzipped(built, tmp_path):
    """What a reader has who unzips `live-VERSION.zip` into an empty folder."""
    if not MIRROR:
        pytest.skip("set DDLIB_LIVE_MIRROR to a folder or an address with Pyodide's packages")
    pages.write(ROOT, built, MIRROR, KEPT, tmp_path / "live")
    release.archive(tmp_path / "live", tmp_path / "live-1.2.0.zip")
    with zipfile.ZipFile(tmp_path / "live-1.2.0.zip") as packed:
        packed.extractall(tmp_path / "unzipped")
    return tmp_path / "unzipped"


@pytest.fixture
def address(unzipped):
    """Its address on the server that readers are told to use."""
    command = [sys.executable, "-u", "-m", "http.server", "0", "--bind", "127.0.0.1"]
    told = {"stdout": subprocess.PIPE, "stderr": subprocess.DEVNULL, "text": True}
    with subprocess.Popen([*command, "--directory", unzipped], **told) as server:
        port = server.stdout.readline().split("port ")[1].split()[0]
        yield f"http://127.0.0.1:{port}"
        server.terminate()


@pytest.mark.built
@pytest.mark.browser
@pytest.mark.slow
def test_the_archive_runs_with_the_network_cut(browser, address):
    context = browser.new_context(proxy=DEAD_END)
    tab, wrong, asked = context.new_page(), [], []
    tab.on("pageerror", lambda error: wrong.append(str(error)))
    tab.on("console", lambda m: m.type in {"error", "warning"} and wrong.append(m.text))
    tab.on("response", lambda answer: answer.status >= 400 and wrong.append(answer.url))
    context.on("request", lambda request: asked.append(request.url))
    runs_through(tab, address, "book/feedback")
    assert not wrong
    assert any(url.endswith(".whl") for url in asked)  # what Python's worker asks is seen, too
    own = (f"{address}/", f"blob:{address}/", "data:")
    assert not [url for url in asked if not url.startswith(own)]
    reached = "() => fetch('http://example.com', { mode: 'no-cors' }).then(() => true, () => false)"
    assert not tab.evaluate(reached)  # had anything been asked outside, it would not have come
    context.close()
