"""What knows the repository's address, what a reader's notebook fetches, what a release asks."""

import json
import shutil
import subprocess
import sys
import zipfile
from datetime import date

import dd_cite
import dd_public
import dd_reader
import missing
import nbformat
import pytest
import release
import yaml
from book_pages import ROOT
from packaging.requirements import Requirement


@pytest.mark.parametrize(
    "origin, name",
    [
        ("https://github.com/someone/the-arm.git", "someone/the-arm"),
        ("git@github.com:someone/the-arm", "someone/the-arm"),
        ("https://example.org/someone/the-arm.git", ""),
    ],
)
def test_the_address_is_githubs_or_none(origin, name, tmp_path, monkeypatch):
    monkeypatch.delenv("GITHUB_REPOSITORY", raising=False)
    subprocess.run(["git", "init", "-q", tmp_path], check=True)
    subprocess.run(["git", "-C", tmp_path, "remote", "add", "origin", origin], check=True)
    assert dd_public.repository.__wrapped__(tmp_path) == name
    monkeypatch.setenv("GITHUB_REPOSITORY", "other/name")
    assert dd_public.repository.__wrapped__(tmp_path) == "other/name"


def test_the_site_of_a_repository(monkeypatch):
    monkeypatch.delenv("DDLIB_SITE", raising=False)
    assert dd_public.site("Someone/the-arm") == "https://someone.github.io/the-arm/"
    assert dd_public.site("Someone/someone.github.io") == "https://someone.github.io/"
    monkeypatch.setenv("DDLIB_SITE", "https://arm.example.org")
    assert dd_public.site("Someone/the-arm") == "https://arm.example.org/"


def test_buttons_lead_where_the_address_says():
    found = dd_public.links(
        "someone/the-arm", "book/feedback", "book/feedback.ipynb", "02-feedback.ipynb"
    )
    report, edit, colab = (url for _, _, url in found)
    assert report.startswith("https://github.com/someone/the-arm/issues/new?title=")
    assert "book/feedback" in report and "\n" not in report and " " not in report
    assert edit == "https://github.com/someone/the-arm/edit/main/book/feedback.ipynb"
    assert colab.endswith("/github/someone/the-arm/blob/notebooks/02-feedback.ipynb")
    assert len(dd_public.links("someone/the-arm", "book/status", "book/status.md")) == 2


def test_only_what_is_absent_is_installed():
    absent, other = missing.lacking(["numpy>=1", "no-such-package-at-all>=2", "pytest<1"])
    assert list(map(Requirement, absent)) == [Requirement("no-such-package-at-all>=2")]
    assert len(other) == 1 and other[0].startswith("pytest ") and "<1" in other[0]


def test_the_first_cell_fetches_the_book(tmp_path):
    """From a repository in place of the address; then a lesson's judge is found, and data."""
    home = tmp_path / "repository"
    for part in ("ddlib", "book/workshop", "book/beyond", "book/_ext", "book/results", "book/data"):
        shutil.copytree(ROOT / part, home / part, ignore=shutil.ignore_patterns("__pycache__"))
    for name in ("pyproject.toml", "book/claims.yml", "book/cards.yml", "book/errata.yml"):
        shutil.copyfile(ROOT / name, home / name)
    me = ["git", "-C", home, "-c", "user.name=x", "-c", "user.email=x@example.org"]
    for words in (["init", "-q"], ["add", "."], ["commit", "-qm", "x"]):
        subprocess.run([*me, *words], check=True)
    away = tmp_path / "elsewhere"
    away.mkdir()
    cell = dd_reader.SETUP.format(address=home.as_uri(), folder="book")
    asked = "from workshop.chapters import feedback\nimport ddlib, os\n"
    asked += "print(ddlib.__file__, os.path.isdir('data'))"
    told = subprocess.run(
        [sys.executable, "-P", "-c", f"{cell}\n{asked}"],
        cwd=away,
        env={"PATH": "/usr/bin:/bin", "HOME": str(tmp_path)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert told.returncode == 0, told.stderr
    assert told.stdout.split()[-1] == "True"
    alone = dd_reader.SETUP.format(address="", folder="book")
    told = subprocess.run(
        [sys.executable, "-P", "-c", alone], cwd=away, env={}, capture_output=True, text=True
    )
    assert told.returncode and "make lab" in told.stderr


@pytest.mark.built
def test_all_notebooks_come_in_one_archive(built):
    with zipfile.ZipFile(built / dd_reader.ARCHIVE) as archive:
        names = archive.namelist()
        assert archive.testzip() is None
        notebook = nbformat.reads(archive.read("notebooks/02-feedback.ipynb"), as_version=4)
    made = set()
    for path in (built / "_sources" / "book").rglob("*.ipynb"):
        made.add(f"notebooks/{path.relative_to(built / '_sources' / 'book').as_posix()}")
    assert made < set(names) and any(name.startswith("notebooks/data/") for name in names)
    assert "the-book" in notebook.cells[2].source


CITED = "title: A book\nversion: {}\ndate-released: {}\nauthors:\n- {}\nlicense: MIT\nabstract: x\n"
NOETHER = "{family-names: Noether, given-names: Emmy, email: noether@example.org}"


@pytest.fixture
def tagged(tmp_path):
    """A folder that could be released: what `release.disagreements` reads, committed and tagged."""
    texts = {
        "ddlib/__init__.py": '__version__ = "1.2.0"\n',
        "CITATION.cff": CITED.format("1.2.0", "2026-01-31", NOETHER),
        **dict.fromkeys(release.BESIDE, "Emmy Noether"),
        "CHANGELOG.md": "# Changes\n\n## 1.2.0 (2026-01-31)\n\n- New.\n\n## 1.1.0 (2025-01-31)\n",
    }
    for name, text in texts.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(text)
    me = ["git", "-C", tmp_path, "-c", "user.name=x", "-c", "user.email=x@example.org"]
    for words in (["init", "-q"], ["add", "."], ["commit", "-qm", "x"], ["tag", "v1.2.0"]):
        subprocess.run([*me, *words], check=True)
    return tmp_path


def test_a_release_needs_tag_citation_and_changelog_to_agree(tagged):
    assert not release.disagreements(tagged)
    (tagged / "CITATION.cff").write_text(CITED.format("1.1.0", "2026-01-30", "family-names: Curie"))
    told = " ".join(release.disagreements(tagged))
    assert all(f"{name} does not name Curie" in told for name in release.BESIDE)
    (tagged / "paper/paper.md").write_text("Marie Curie, of: to be filled in")
    assert "paper/paper.md still says" in " ".join(release.disagreements(tagged))
    (tagged / "CITATION.cff").write_text(CITED.format("1.1.0", "2026-01-30", "name: Some group"))
    told = " ".join(release.disagreements(tagged))
    assert "no person" in told and "no email" in told
    assert "CITATION.cff 1.1.0" in told and "2026-01-30" in told and "not committed" in told
    (tagged / "CHANGELOG.md").write_text("# Changes\n\n## 1.3.0 (2026-02-01)\n")
    assert "begins with 1.3.0" in " ".join(release.disagreements(tagged))
    subprocess.run(["git", "-C", tagged, "tag", "-d", "v1.2.0"], check=True, capture_output=True)
    assert "no tag v1.2.0" in " ".join(release.disagreements(tagged))


def test_a_release_asks_wherever_a_group_stands_for_its_people():
    told = release.git(ROOT, "grep", "-il", "the ddlib authors", "--", ":!tests")
    assert set(told.splitlines()) <= {"CITATION.cff", *release.BESIDE}


def test_pages_of_a_release_name_it_and_link_the_newest(tagged, monkeypatch):
    monkeypatch.delenv("DDLIB_SITE", raising=False)
    edition = dd_cite.edition.__wrapped__
    assert edition(tagged) == "1.2.0 of 2026-01-31"
    monkeypatch.setattr(dd_cite, "edition", edition)
    (said,) = dd_cite.version(tagged, "someone/the-arm")
    assert said.startswith("This is version 1.2.0 of 2026-01-31. <a href=")
    assert "https://someone.github.io/the-arm/" in said
    assert dd_cite.version(tagged, "") == ["This is version 1.2.0 of 2026-01-31"]
    subprocess.run(["git", "-C", tagged, "tag", "-d", "v1.2.0"], check=True, capture_output=True)
    assert edition(tagged) == "" and dd_cite.version(tagged, "someone/the-arm") == []
    (tagged / "CITATION.cff").unlink()
    assert edition(tagged) == ""


def test_the_citation_names_the_newest_release_or_none():
    cited = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    newest = release.ENTRY.search((ROOT / "CHANGELOG.md").read_text(encoding="utf-8"))
    assert [cited.get("version"), cited.get("date-released")] == (
        [newest[1], date.fromisoformat(newest[2])] if newest else [None, None]
    )
    json.loads((ROOT / ".zenodo.json").read_text(encoding="utf-8"))


def test_a_release_is_whole_and_its_notes_say_what_each_file_is(tagged, monkeypatch):
    with pytest.raises(FileNotFoundError, match=r"live/index\.html.* pdf/walk\.pdf"):
        release.collect(tagged, tagged / "dist")
    assert not list(tagged.glob("*dist"))
    places = [place for place, _ in release.FILES.values() if place]
    for place in (*places, "html/.buildinfo", "html/book/a.html", "live/.built-from"):
        path = tagged / "_build" / place
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(place)
    monkeypatch.setattr(release, "wheel", lambda root, folder: (folder / "a-1.whl").touch())
    made = {path.name: path for path in release.collect(tagged, tagged / "dist")}
    title, _, rest = made["NOTES.md"].read_text().partition("\n")
    files, _, new = rest.partition("## What is new\n\n")
    assert title == "# A book, version 1.2.0 of 2026-01-31" and new == "- New.\n"
    listed = {line.split("`")[1] for line in files.splitlines() if line.startswith("- ")}
    assert listed == made.keys() - {"NOTES.md"} and "walk-v1.2.0.pdf" in listed
    packed = {}
    for kind in ("site", "live", "source"):
        with zipfile.ZipFile(made[f"{kind}-v1.2.0.zip"]) as archive:
            packed[kind] = {name for name in archive.namelist() if not name.endswith("/")}
    assert packed["site"] == {"site/index.html", "site/book/a.html", "site/notebooks.zip",
                              "site/LICENSE"}  # fmt: skip
    assert packed["live"] == {"live/index.html", "live/LICENSE"}
    told = release.git(tagged, "ls-files").splitlines()
    assert packed["source"] == {f"source/{name}" for name in told}
