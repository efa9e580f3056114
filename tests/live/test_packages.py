"""*Run this page*: what a page loads is taken by its hash, or not at all."""

import hashlib
import json
import re
import sys

import chromium
import pytest
from book_pages import ROOT
from live import packages, pages
from live.packages import PAGE, Refused, take
from live.pages import write


def entry(name: str) -> dict:
    return {"file_name": name, "sha256": hashlib.sha256(name.encode()).hexdigest(), "depends": []}


def test_only_what_the_lock_names_is_taken_and_nothing_is_left_half_done(tmp_path, monkeypatch):
    monkeypatch.setattr(packages, "core", lambda store: None)
    site, store, out = (tmp_path / name for name in ("html", "store", "live"))
    for folder in (site, store, out):
        folder.mkdir()
        (folder / "index.html").write_text(f"in {folder.name}")
    for name in (*packages.CORE, packages.LOCK):
        (store / name).write_text(json.dumps({"packages": {n: entry(n) for n in packages.WHEELS}}))
    before = sorted(store.iterdir())
    (tmp_path / "numpy").write_text("numpy")
    (tmp_path / "scipy").write_text("tampered")
    with pytest.raises(Refused, match=r"(?s)matplotlib is missing.* scipy has SHA-256"):
        write(ROOT, site, str(tmp_path), store, out)
    assert sorted(store.iterdir()) == before  # not even the right one
    assert [path.read_text() for path in tmp_path.glob("live*/*")] == ["in live"]


def test_recordings_of_others_come_with_their_licences(tmp_path, monkeypatch):
    """In a page that reads them."""

    def given(root, mirror, store, folder):
        folder.mkdir(parents=True)
        (folder / "isolate.js").touch()
        return [1, 1], {}

    monkeypatch.setattr(pages, "write_packages", given)
    monkeypatch.setattr(pages, "live_page", lambda text, *rest: text)
    (tmp_path / "html" / "book").mkdir(parents=True)
    for name in ("index.html", "book/real-arm.html"):
        (tmp_path / "html" / name).touch()
    write(ROOT, tmp_path / "html", "", tmp_path, tmp_path / "live")
    data = tmp_path / "live" / "_static" / "live" / "data"
    beside = {path.name for path in data.iterdir()}
    assert any(name.endswith(".npz") for name in beside)
    assert beside > {path.name for path in (ROOT / "book" / "data").glob("LICENSE-*")}
    assert "README.md" in beside


def test_without_a_mirror_wheels_come_from_pyodides_address_and_stay(tmp_path, monkeypatch, capsys):
    """With a server of this machine in its place."""
    assert packages.VERSION in packages.PUBLIC
    served, store = tmp_path / "served", tmp_path / "store"
    served.mkdir()
    for name in ("numpy", "scipy"):
        (served / name).write_text(name)
    with chromium.serve(served) as address:
        monkeypatch.setattr(packages, "PUBLIC", address)
        take([entry("numpy"), entry("scipy")], "", store)
        assert capsys.readouterr().out.rstrip().endswith(f"{packages.VERSION} from {address}")
        (served / "sympy").write_text("tampered")
        with pytest.raises(Refused, match=r"sympy has SHA-256 .* the lock wants"):
            take([entry("sympy")], "", store)
        (store / "numpy").write_text("changed since")
        take([entry("numpy")], "", store)
    take([entry("numpy"), entry("scipy")], "", store)  # the server is gone, and not asked
    assert {path.read_text() for path in store.iterdir()} == {"numpy", "scipy"}
    told = r"(?s)cannot be reached .* MIRROR=:\n    sympy\n    pandas$"  # all that is lacking
    with pytest.raises(Refused, match=told):
        take([entry(name) for name in ("numpy", "sympy", "pandas")], "", store)


def test_a_core_that_was_changed_since_is_not_taken(tmp_path):
    archive = tmp_path / f"pyodide-{packages.VERSION}.tgz"
    archive.write_bytes(b"another")
    with pytest.raises(Refused, match="is not the archive with SHA-512"):
        packages.core(tmp_path)
    assert not archive.exists()


def test_packages_are_asked_for_before_the_book_is_built():
    lines = (ROOT / "Makefile").read_text("utf-8").partition("\nlive:")[2].splitlines()[1:4]
    assert [line.split()[-1] for line in lines] == ["--packages", "book/_ext/build.py", "@$(LIVE)"]


def test_code_is_compiled_once_by_the_python_that_runs_it(tmp_path, monkeypatch):
    """With a `node` that writes down what it was given."""
    node = tmp_path / "node"
    node.write_text(
        f"#!{sys.executable}\nimport sys, shutil\n"
        f"open({str(tmp_path / 'asked')!r}, 'a').write('asked ')\n"
        "for given, made in zip(sys.argv[4::3], sys.argv[5::3]): shutil.copy(given, made)\n"
    )
    node.chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path))
    out = tmp_path / "out"
    out.mkdir()
    names = []
    for code in ("one", "two", "one"):
        (out / "a-1.whl").write_bytes(packages.zipped({"a.py": code.encode()}))
        names.append(packages.compile_all(out, tmp_path / "store")["a-1.whl"])
    assert (tmp_path / "asked").read_text() == "asked asked "
    # no browser takes a file for one that it kept before it changed
    assert names[0] == names[2] != names[1] and {path.name for path in out.iterdir()} == {*names}


def test_a_widget_finds_in_a_page_what_it_imports_of_its_still():
    """The module that draws it is not there."""
    imports = re.compile(r"from ddlib\.widgets\.still import (.+)")
    folders = (ROOT / "ddlib", ROOT / "book" / "workshop", ROOT / "book" / "beyond")
    texts = (path.read_text("utf-8") for folder in folders for path in folder.rglob("*.py"))
    wanted = {name for text in texts for line in imports.findall(text) for name in line.split(", ")}
    there: dict = {}
    exec((PAGE / "instead" / "still.py").read_text(encoding="utf-8"), there)
    assert {"Still", "still_picture"} <= wanted <= there.keys()
    assert there["still_picture"]({}, [], {}, None, "") == there["encoded"]("<svg/>") == ""
