"""The API pages: fields of a named tuple stand in its docstring, not once more below it."""

from __future__ import annotations


def skip_field(app, what, name, obj, skip, options):
    """Whether autodoc leaves a member out; None where it decides by itself."""
    return True if type(obj).__name__ == "_tuplegetter" else None


def setup(app):
    app.connect("autodoc-skip-member", skip_field)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
