"""What one chapter alone shows: a module for each, with the chapter's name.

Most have its figures and what its claims measure, ``ledger`` and ``status`` their tables,
``widgets`` what is handled.
"""

from importlib import import_module


def quoted(chapter: str, package: str = __name__) -> None:
    """Quote the numbers of a chapter's prose, which its module in the package names: `_quoted`."""
    import_module(f"{package}.{chapter}")._quoted()
