"""*Run this page*: in a page this is `anywidget`; what its widgets hold, the page shows.

The page has a model of each widget that it shows. Traits tagged ``sync`` are told both ways, as by
a kernel's comm: JSON, and the bytes of binary ones beside it.
"""

from __future__ import annotations

import itertools
import json
from contextlib import contextmanager

import kernel
import traitlets

_numbers = itertools.count(1)
shown: dict[int, AnyWidget] = {}  # those of which the page has a model


class AnyWidget(traitlets.HasTraits):
    """A widget whose script is `_esm`, and its style `_css`."""

    _number = 0  # its name in the page
    _held: set | None = None  # traits that changed while nothing is told

    def __init__(self, **traits):
        self._number, self._sent, self._heard = next(_numbers), {}, []
        self._moved: set[str] = set()
        super().__init__(**traits)

    def show(self) -> int:
        """Let the page have a model of this widget; returns its number there."""
        if self._number not in shown:
            shown[self._number] = self
            made = {"esm": str(self._esm), "css": str(getattr(self, "_css", ""))}
            self._tell(self.trait_names(sync=True), made=made)
        return self._number

    def close(self):
        """The page has no model of it any more."""
        shown.pop(self._number, None)
        self._sent.clear()

    def on_msg(self, callback):
        """Call ``callback(widget, content, buffers)`` at each message from the page's script."""
        self._heard.append(callback)

    def send(self, content, buffers=()):
        """Send the page's script a message."""
        if self._number in shown:
            message = {"number": self._number, "content": content}
            kernel.page(json.dumps(message, default=_plain), list(buffers))

    @contextmanager
    def hold_sync(self):
        """Tell all changes within at once."""
        if self._held is not None:
            yield
            return
        self._held = set()
        try:
            yield
        finally:
            names, self._held = self._held, None
            self._tell(names)

    def notify_change(self, change):
        """Tell the page, then those who observe."""
        name, trait = change["name"], self.traits()[change["name"]]
        if self._number:
            if not (trait.read_only and trait.metadata.get("sync")) and name != "request":
                self._moved.add(name)  # what is read only is an answer, not a setting
            if self._held is None:
                self._tell([name])
            else:
                self._held.add(name)
        super().notify_change(change)

    def _tell(self, names, **more):
        """Tell the page the values of traits that it does not have yet."""
        if self._number not in shown:
            return
        state, binary = {}, {}
        for name in names:
            if not self.trait_metadata(name, "sync"):
                continue
            value = getattr(self, name)
            of = binary if isinstance(value, bytes) else state
            value = value if of is binary else json.loads(json.dumps(value, default=_plain))
            if name not in self._sent or self._sent[name] != value:
                self._sent[name] = of[name] = value
        if state or binary or more:
            message = {"number": self._number, "state": state, "binary": list(binary), **more}
            kernel.page(json.dumps(message), list(binary.values()))

    def hear(self, state: dict):
        """Take over what the page has set, and tell it what came out differently."""
        known = {name: value for name, value in state.items() if self.has_trait(name)}
        self._sent |= known
        with self.hold_sync():
            self._held |= known.keys()
            with self.hold_trait_notifications():
                for name, value in known.items():
                    from_json = self.trait_metadata(name, "from_json")
                    self.set_trait(name, from_json(value, self) if from_json else value)


def _plain(value):
    """Numbers of numpy as Python's."""
    return value.tolist()


def heard(text: str, buffers) -> list[AnyWidget]:
    """Take a message of the page; returns the widgets whose traits that changed."""
    message = json.loads(text)
    widget = shown.get(message["number"])
    if widget is None:
        return []
    for other in shown.values():  # one may be linked to another
        other._moved.clear()
    parts = [bytes(part.to_py() if hasattr(part, "to_py") else part) for part in buffers]
    if "closed" in message:
        widget.close()
    elif "content" in message:
        for callback in widget._heard:
            callback(widget, message["content"], parts)
    else:
        widget.hear(message["state"] | dict(zip(message["binary"], parts)))
    return [moved for moved in shown.values() if moved._moved]
