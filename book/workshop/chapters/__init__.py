"""What one chapter alone shows: a module for each, with the chapter's name.

Most have its figures and what its claims measure, ``ledger`` and ``status`` their tables,
``widgets`` what is handled.
"""

import base64
import os
import tempfile
from importlib import import_module
from pathlib import Path

PNG = "ddlib-png"
"""Where the metadata of a figure's output have it as PNG."""


def quoted(chapter: str, package: str = __name__) -> None:
    """Quote the numbers of a chapter's prose, which its module in the package names: `_quoted`.

    If ``DDLIB_PNG`` names its page, as in the book's build, its figures come as PNG, too.
    """
    import_module(f"{package}.{chapter}")._quoted()
    if chapter.replace("_", "-") in os.environ.get("DDLIB_PNG", "").split():
        from IPython import get_ipython

        from ddlib.figures.style import Illustration

        formatters = get_ipython().display_formatter.formatters
        formatters["text/html"].for_type(Illustration, with_png)


def with_png(figure) -> tuple[str, dict]:
    """What a notebook shows of a figure, and the figure as PNG, in the metadata of that."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "figure.png")
        figure.save(path, dpi=150)
        png = base64.b64encode(path.read_bytes()).decode()
    return figure._repr_html_(), {PNG: png}
