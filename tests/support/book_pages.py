"""The pages of the book, as _toc.yml lists them."""

from __future__ import annotations

import json
from pathlib import Path

import yaml
from needed import needed

ROOT = Path(__file__).resolve().parents[2]
TOC = yaml.safe_load((ROOT / "_toc.yml").read_text(encoding="utf-8"))

NUMBERED = [
    page["file"] for part in TOC["parts"] if part.get("numbered") for page in part["chapters"]
]
EVIDENCE = [page for page in NUMBERED if page.startswith("book/evidence-")]
CHAPTERS = [page for page in NUMBERED if page not in EVIDENCE]
LESSONS = [page["file"] for part in TOC["parts"][:3] for page in part["chapters"]]
BACK_MATTER = [
    page["file"] for part in TOC["parts"] if not part.get("numbered") for page in part["chapters"]
]
API = [page for page in BACK_MATTER if page.startswith("book/api")]
PAGES = [TOC["root"], *NUMBERED, *BACK_MATTER]


SHARED = {
    "book/whose-filters": "book/evidence-why-smooth-filters",
    "book/inertia-in-the-weights": "book/evidence-convolution-filters",
}  # lessons whose evidence has the name of another page


def evidence_of(lesson: str) -> str:
    """The page with what stands behind a lesson."""
    return SHARED.get(lesson, lesson.replace("book/", "book/evidence-"))


WALK = [page for page in CHAPTERS if evidence_of(page) in EVIDENCE]  # in the shape of a lesson


def source(page: str) -> Path | None:
    """The file a page is written in, or None."""
    candidates = (ROOT / f"{page}{suffix}" for suffix in (".ipynb", ".md"))
    return next((path for path in candidates if path.is_file()), None)


def code_cells(path: Path) -> list[str]:
    """The code of a notebook, cell by cell."""
    cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
    return ["".join(c["source"]) for c in cells if c["cell_type"] == "code"]


def has_widgets(page: str) -> bool:
    """Whether a page's notebook makes widgets."""
    path = source(page)
    return path is not None and path.suffix == ".ipynb" and bool(needed(code_cells(path)))


WITH_WIDGETS = [page for page in PAGES if has_widgets(page)]
