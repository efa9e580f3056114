"""The API pages: every module of the package is documented, once, on the page of its package."""

from __future__ import annotations

import re

from book_pages import API, ROOT, source

PACKAGE = ROOT / "ddlib"
FILES = sorted(PACKAGE.rglob("*.py"))


def name_of(path) -> str:
    parts = path.relative_to(ROOT).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def page_of(module: str) -> str:
    """Where a module belongs: a module beside the packages is one of the basics."""
    _, *inside = module.split(".")
    if not inside:
        return "book/api"
    is_package = (PACKAGE / inside[0]).is_dir()
    return f"book/api/{inside[0] if is_package else 'basics'}"


def test_every_module_is_documented_once_on_the_page_of_its_package():
    texts = {page: source(page).read_text(encoding="utf-8") for page in API}
    places = [
        (module, page)
        for page, text in texts.items()
        for module in re.findall(r"automodule:: ([\w.]+)", text)
    ]
    modules = [name for path in FILES if not re.search(r"\._[a-z]", name := name_of(path))]
    own = sorted((module, page) for module, page in places if module.startswith("ddlib"))
    assert own == sorted((module, page_of(module)) for module in modules)
    assert len(dict(places)) == len(places), "a module is documented twice"
    assert re.findall(r"\{doc\}`(api/\w+)`", texts["book/api"]) == [page[5:] for page in API[1:]]
