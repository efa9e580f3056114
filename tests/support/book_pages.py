"""The pages of the book, as _toc.yml lists them."""

from __future__ import annotations

import json
from pathlib import Path

import yaml
from needed import needed

ROOT = Path(__file__).resolve().parents[2]
TOC = yaml.safe_load((ROOT / "_toc.yml").read_text(encoding="utf-8"))


def _chapters(numbered: bool) -> dict[str, list[str]]:
    """Pages, each with those that stand under it in the contents."""
    parts = [part for part in TOC["parts"] if bool(part.get("numbered")) is numbered]
    return {
        page["file"]: [below["file"] for below in page.get("sections", ())]
        for part in parts
        for page in part["chapters"]
    }


EVIDENCE_OF = _chapters(numbered=True)
"""Each lesson's pages with what stands behind it."""
CHAPTERS = list(EVIDENCE_OF)  # all in the shape of a lesson
EVIDENCE = [page for below in EVIDENCE_OF.values() for page in below]
TEN = [page["file"] for part in TOC["parts"][:3] for page in part["chapters"]]  # the walk
LESSONS = [page["file"] for part in TOC["parts"][:4] for page in part["chapters"]]
BACK_MATTER = [page for own, below in _chapters(numbered=False).items() for page in (own, *below)]
API = [page for page in BACK_MATTER if page.startswith("book/api")]
PAGES = [
    TOC["root"],
    *(p for own, below in EVIDENCE_OF.items() for p in (own, *below)),
    *BACK_MATTER,
]
WALK = CHAPTERS


def source(page: str) -> Path | None:
    """The file a page is written in, or None."""
    candidates = (ROOT / f"{page}{suffix}" for suffix in (".ipynb", ".md"))
    return next((path for path in candidates if path.is_file()), None)


def module_of(page: str) -> Path | None:
    """The module of a lesson, or of an evidence page, in the package of its part, or None."""
    name = page.rpartition("/")[2].replace("-", "_")
    homes = (ROOT / "book" / package / "chapters" for package in ("workshop", "beyond"))
    return next((home / f"{name}.py" for home in homes if (home / f"{name}.py").is_file()), None)


def code_cells(path: Path) -> list[str]:
    """The code of a notebook, cell by cell."""
    cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
    return ["".join(c["source"]) for c in cells if c["cell_type"] == "code"]


def has_widgets(page: str) -> bool:
    """Whether a page's notebook makes widgets."""
    path = source(page)
    return path is not None and path.suffix == ".ipynb" and bool(needed(code_cells(path)))


WITH_WIDGETS = [page for page in PAGES if has_widgets(page)]
