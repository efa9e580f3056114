"""*Run this page*: in a page this is `ddlib.widgets.still`, which draws what it does not show."""

from traitlets import Unicode as Still  # noqa: F401

START = ""


def still_picture(*given) -> str:
    """No picture."""
    return ""


def encoded(svg: str) -> str:
    """Nothing."""
    return ""
