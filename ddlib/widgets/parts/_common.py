"""What every widget has: its name in the page's address, and its state as code."""

from __future__ import annotations

import inspect
import json
import re
from collections.abc import Mapping


def key_of(kind: type) -> str:
    """A class's name in the page's address: ``TrajectoryPicker`` is "trajectory-picker"."""
    return re.sub(r"(?<=[a-z])(?=[A-Z])", "-", kind.__name__).lower()


def default_code(kind: type, names) -> str:
    """Code that makes a widget with its state (names in braces), or none if it needs arguments."""
    given = inspect.signature(kind).parameters.values()
    if any(p.default is p.empty and p.kind not in (p.VAR_KEYWORD, p.VAR_POSITIONAL) for p in given):
        return ""
    module = kind.__module__
    if (parts := module.split("."))[:2] == ["ddlib", "widgets"] and len(parts) == 3:
        module = "ddlib.widgets"
    lines = [f"from {module} import {kind.__name__}", "", f"widget = {kind.__name__}()"]
    return "\n".join([*lines, *(f"widget.{name} = {{{name}}}" for name in names), "widget"])


def filled(code: str, values: Mapping) -> str:
    """`code` with the values in place of their names in braces, as the page's script does it."""
    named = {name: _literal(value) for name, value in values.items()}
    return re.sub(r"\{(\w+)\}", lambda match: named.get(match[1], match[0]), code)


def _literal(value: str | int | float | bool) -> str:
    """A parameter's value as Python writes it, numbers with six digits."""
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False)
    return str(value) if isinstance(value, (bool, int)) else f"{value:.6g}"
