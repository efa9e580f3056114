"""Firefox for Playwright's `moz-firefox` channel, with one command answered that it lacks.

Playwright drives any Firefox by WebDriver BiDi; the extended-support release does not know
``emulation.setMediaFeaturesOverride`` yet, which Playwright sends with each new page. This starts
`$FIREFOX` (or `firefox-esr`, `firefox`), passes everything on, and says yes to that command; pages
stay light. Once Firefox knows it, this file can go, but for `CALM`: that a reader wants no motion,
Playwright does not tell it at all.
"""

from __future__ import annotations

import asyncio
import json
import os
import re
import shlex
import shutil
import sys
import tempfile
from contextlib import contextmanager
from pathlib import Path

from tornado import httpserver, netutil, web, websocket

READY = "WebDriver BiDi listening on "
MOST = 2**30  # bytes of a message: a screenshot is one
NAMES = ("firefox-esr", "firefox")
HOW_TO_GET_ONE = "no Firefox found: apt-get install firefox-esr, or set FIREFOX"

CALM = """{
  const ask = window.matchMedia;
  const calm = (query) => (query === "(prefers-reduced-motion: reduce)" ? "all" : query);
  window.matchMedia = (query) => ask.call(window, calm(query));
}"""
"""Run before a page's own scripts, which then hear that the reader wants no motion."""


def find() -> str | None:
    """Path of a Firefox: $FIREFOX, else the first known name on the PATH."""
    wanted = os.environ.get("FIREFOX")
    if wanted:
        return shutil.which(wanted)
    return next(filter(None, map(shutil.which, NAMES)), None)


class Between(websocket.WebSocketHandler):
    """One client's messages, there and back."""

    behind = ""  # address of Firefox itself

    def check_origin(self, origin):
        return True

    async def open(self, path=""):
        self.other = await websocket.websocket_connect(
            f"{self.behind}/{path}", on_message_callback=self.back, max_message_size=MOST
        )

    def back(self, message):
        self.close() if message is None else self.write_message(message)

    async def on_message(self, message):
        asked = json.loads(message)
        if asked["method"] == "emulation.setMediaFeaturesOverride":
            self.write_message(json.dumps({"type": "success", "id": asked["id"], "result": {}}))
        else:
            await self.other.write_message(message)

    def on_close(self):
        self.other.close()


@contextmanager
def launched(playwright):
    """A running Firefox, as Playwright's browsers are."""
    if find() is None:
        raise FileNotFoundError(HOW_TO_GET_ONE)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "firefox"
        path.write_text(f'#!/bin/sh\nexec {shlex.join([sys.executable, __file__])} "$@"\n', "utf-8")
        path.chmod(0o755)
        browser = playwright.firefox.launch(executable_path=path, channel="moz-firefox")
        try:
            yield browser
        finally:
            browser.close()


async def main() -> int:
    firefox = await asyncio.create_subprocess_exec(
        find(), *sys.argv[1:], stderr=asyncio.subprocess.PIPE
    )
    while line := (await firefox.stderr.readline()).decode(errors="replace"):
        if found := re.search(rf"{READY}(ws://\S+)", line):
            Between.behind = found[1]
            sockets = netutil.bind_sockets(0, "127.0.0.1")
            app = web.Application([("/(.*)", Between)], websocket_max_message_size=MOST)
            httpserver.HTTPServer(app).add_sockets(sockets)
            port = sockets[0].getsockname()[1]
            line = f"{READY}ws://127.0.0.1:{port}\n"
        sys.stderr.write(line)
        sys.stderr.flush()
    return await firefox.wait()


if __name__ == "__main__":
    sys.exit(asyncio.run(main()))
