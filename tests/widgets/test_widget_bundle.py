"""Scripts as modules: what is imported is there, and a bundle has each once, in their order."""

from __future__ import annotations

import re

import pytest
from book_pages import ROOT

from ddlib.widgets import bundle
from ddlib.widgets.scripts import _STATIC

FOLDERS = _STATIC, *ROOT.glob("book/*/chapters/widgets")
SCRIPTS = [path for folder in FOLDERS for path in sorted(folder.glob("*.js"))]
IMPORT = re.compile(r'^import \{([^}]*)\} from "([^"]+)";', re.M)
DECLARED = re.compile(r"^(?:export )?(?:async )?(?:function|const|let|class) (\w+)", re.M)


def needs(path) -> dict:
    """Names by the script from which another one imports them."""
    given = IMPORT.findall(path.read_text("utf-8"))
    return {
        _STATIC / name[6:] if name.startswith("ddlib/") else path.parent / name[2:]: re.findall(
            r"\w+", names
        )
        for names, name in given
    }


def test_every_name_that_is_imported_is_exported_and_used():
    assert len(SCRIPTS) > 35
    for path in SCRIPTS:
        body = IMPORT.sub("", path.read_text("utf-8"))
        for other, names in needs(path).items():
            exported = r"^export (?:function|const|let|class) (\w+)"
            there = re.findall(exported, other.read_text("utf-8"), re.M)
            assert set(names) <= set(there), (path.name, other.name)
            assert all(re.search(rf"\b{name}\b", body) for name in names), path.name


@pytest.mark.parametrize("path", SCRIPTS, ids=lambda path: path.stem)
def test_in_a_bundle_each_script_follows_what_it_imports(path):
    text = bundle(path)
    assert not re.search("^(import|export (?!default)|//)", text, re.M)
    code = [x.strip() for x in IMPORT.sub("", path.read_text("utf-8")).splitlines()]
    own = next(x for x in code if x and not x.startswith("//")).removeprefix("export ")
    before = text[: text.rindex(f"{own}\n")]
    for names in needs(path).values():
        assert set(names) <= set(DECLARED.findall(before))


def closure(path, found=()) -> list:
    """A script and all that it imports."""
    found = [*found, path]
    for other in needs(path):
        found = found if other in found else closure(other, found)
    return found


@pytest.mark.parametrize("path", SCRIPTS, ids=lambda path: path.stem)
def test_in_a_bundle_a_name_means_one_thing(path):
    every = [name for one in closure(path) for name in DECLARED.findall(one.read_text("utf-8"))]
    assert len(set(every)) == len(every)


def test_a_script_stands_once_and_only_as_code(tmp_path):
    texts = {
        "a.js": 'import { b } from "./b.js";\nimport {\n  c,\n} from "./c.js";\n\nb(c);\n',
        "b.js": '// About b.\n\nimport { c } from "./c.js";\n\nexport function b() {\n  c;\n}\n',
        "c.js": "export const c = 1;\nexport default { c };\n",
    }
    for name, text in texts.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    assert bundle(tmp_path / "a.js", tmp_path / "b.js").splitlines() == [
        "const c = 1;", "export default { c };", "function b() {", "c;", "}", "b(c);"]  # fmt: skip
