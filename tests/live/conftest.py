"""What is tested here lies in `book/_ext/live`, and runs there and in a browser."""

import json
import sys

import pytest
from book_pages import ROOT

sys.path.insert(0, str(ROOT / "book" / "_ext" / "live" / "page"))
import kernel


@pytest.fixture
def run(monkeypatch):
    """Run a cell below others: what is shown, and what is told of names."""
    for name in ("space", "made", "known", "drawn", "seen"):
        monkeypatch.setattr(kernel, name, {})

    async def nothing(package):
        return False

    def run(source, name, above=(), **how):
        messages = []
        emit = lambda *message: messages.append(message)  # noqa: E731
        with pytest.raises(StopIteration):  # it waits for nothing; Playwright has a loop of its own
            kernel.run(source, name, emit, nothing, above, **how).send(None)
        shown = [message for message in messages if message[0] != "names"]
        about = [json.loads(text) for kind, text in messages if kind == "names"]
        return shown, about[0] if about else None

    return run
