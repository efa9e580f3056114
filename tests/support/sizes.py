"""How large each room is, for a review to judge: `python tests/support/sizes.py`.

Printed at the end of `make check`. Nothing fails: there is no size that a room must keep to.
"""

from __future__ import annotations

from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
ROOMS = (
    *("ddlib", "ddlib/figures", "ddlib/widgets"),
    *("book/workshop", "book/workshop/report", "book/workshop/chapters", "book/beyond"),
    *("book/_ext", "book/_static", "benchmarks", "tests", "tests/beyond"),
)
"""Folders. What lies in a room below another is counted in the lower one alone."""


def lines(room: str, *suffixes: str) -> int:
    """Lines of a room's files with such endings, without those of rooms below it."""
    below = {ROOT / other for other in ROOMS if other.startswith(f"{room}/")}
    paths = (path for suffix in suffixes for path in (ROOT / room).rglob(f"*.{suffix}"))
    own = (path for path in paths if not below & set(path.parents))
    return sum(len(path.read_text(encoding="utf-8").splitlines()) for path in own)


def main() -> None:
    """Print the table."""
    rows = [(room, lines(room, "py"), lines(room, "js", "mjs")) for room in ROOMS]
    total = ("all", *(sum(row[k] for row in rows) for k in (1, 2)))
    print("==> Sizes, in lines (a room is counted without the rooms below it)")
    for room, python, script in (("room", "Python", "JavaScript"), *rows, total):
        print(f"{room:24}{python or '':>8}{script or '':>12}".rstrip())


if __name__ == "__main__":
    main()
