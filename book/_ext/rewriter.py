"""A few places of a page changed: a parser finds them, everything else stays byte for byte."""

from __future__ import annotations

from html import escape
from html.parser import HTMLParser
from itertools import accumulate
from operator import itemgetter


class Rewriter(HTMLParser):
    """Markup that is read once; a subclass notes changes at its tags, which `changed` makes.

    Writing a page anew from a tree would take longer, and would write all of it in another way.
    """

    def __init__(self, text: str):
        super().__init__(convert_charrefs=False)
        self.text, self.changes = text, []
        self.lines = [*accumulate((len(line) + 1 for line in text.split("\n")), initial=0)]
        self.feed(text)
        self.close()

    @property
    def start(self) -> int:
        """Where the tag begins that is read."""
        line, column = self.getpos()
        return self.lines[line - 1] + column

    @property
    def end(self) -> int:
        """Where the start tag ends that is read."""
        return self.start + len(self.get_starttag_text())

    def change(self, start: int, end: int, new: str) -> None:
        """Note what stands from `start` to `end` in the end."""
        self.changes.append((start, end, new))

    def changed(self) -> str:
        """The text with its changes."""
        pieces, before = [], 0
        for start, end, new in sorted(self.changes, key=itemgetter(0)):
            pieces += [self.text[before:start], new]
            before = end
        return "".join([*pieces, self.text[before:]])


def tag(name: str, attributes: dict[str, str | None]) -> str:
    """A start tag."""
    written = (f' {key}="{escape(value or "")}"' for key, value in attributes.items())
    return f"<{name}{''.join(written)}>"
