"""Put a release together in `dist/`: what `FILES` names, and notes, which begin with that list.

There are two sites: pages to open from a folder, and the live ones, which run Python in the browser
and want a server, as `python -m http.server`; neither needs a network.

`python book/_ext/release.py` says what does not agree, and writes nothing then: the version of the
package, of the citation and of the newest entry of the changelog, its date and the citation's, the
authors, the tag at this commit, and a tree without changes. `make release` makes what is collected
first.
"""

from __future__ import annotations

import hashlib
import json
import mimetypes
import re
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import yaml
from dd_cite import names

ROOT = Path(__file__).parents[2]
CRATE, SPDX = "ro-crate-metadata.json", "https://spdx.org/licenses/"
VERSION = re.compile(r'^__version__ = "(.+)"$', re.M)
ENTRY = re.compile(r"^## (\S+) \((\d{4}-\d\d-\d\d)\)$", re.M)
FILES = {
    "live-*.zip": ("live/index.html", "the book whose lessons run in the browser: unzip it, run "
                   "`python -m http.server --directory live`, open `http://localhost:8000`"),
    "site-*.zip": ("html/index.html", "the book to read: unzip it, open `site/index.html`"),
    "walk-*.pdf": ("pdf/walk.pdf", "the lessons, to print"),
    "evidence-*.pdf": ("pdf/evidence.pdf", "what lies behind the lessons, to print"),
    "book-*.epub": ("epub/book.epub", "the lessons, for a reader of e-books"),
    "notebooks-*.zip": ("html/notebooks.zip", "the notebooks with their figures, to read in "
                        "JupyterLab; to run them, unzip the source, and in it run `make lab`"),
    "source-*.zip": ("", "the repository: its `README.md` says how to build and test the book"),
    "*.whl": ("", "the package `ddlib` alone: `python -m pip install` and this file"),
    CRATE: ("", "this list for archives and indexes"),
    "SHA256SUMS": ("", "checksums: `sha256sum -c SHA256SUMS`"),
}  # fmt: skip
"""What a release holds (`*` is its version), where that is made below `_build`, what it is for."""
BESIDE = (".zenodo.json", "paper/paper.md", "paper/metadata.yaml", "LICENSE", "_config.yml",
          "book/cite-reuse-report.md")  # fmt: skip
"""What names the authors beside the citation."""


def git(root: Path, *words: str) -> str:
    """What git says, or nothing where it fails."""
    try:
        answer = subprocess.run(
            ["git", "-C", root, *words], capture_output=True, text=True, check=False
        )
    except OSError:  # no git here
        return ""
    return answer.stdout.strip() if answer.returncode == 0 else ""


def disagreements(root: Path) -> list[str]:
    """What speaks against a release of a folder, a sentence each."""
    package = VERSION.search((root / "ddlib" / "__init__.py").read_text("utf-8"))[1]
    cited = yaml.safe_load((root / "CITATION.cff").read_text("utf-8"))
    newest = ENTRY.search((root / "CHANGELOG.md").read_text("utf-8"))
    wrong = []
    if newest is None:
        wrong.append('CHANGELOG.md has no entry like "## 1.2.3 (2026-01-31)"')
    elif newest[1] != package:
        wrong.append(f"ddlib has version {package}, CHANGELOG.md begins with {newest[1]}")
    if str(cited.get("version")) != package:
        wrong.append(f"ddlib has version {package}, CITATION.cff {cited.get('version')}")
    if newest is not None and str(cited.get("date-released")) != newest[2]:
        released = cited.get("date-released")
        wrong.append(f"CHANGELOG.md is of {newest[2]}, CITATION.cff of {released}")
    families = [author.get("family-names") for author in cited["authors"]]
    if not all(a.get("family-names") and a.get("given-names") for a in cited["authors"]):
        wrong.append("an author in CITATION.cff is no person: family-names, given-names")
    if not any(a.get("email") for a in cited["authors"]):
        wrong.append("CITATION.cff has no email, and CODE_OF_CONDUCT.md sends readers there")
    for name in BESIDE:
        text = (root / name).read_text("utf-8")
        if unnamed := [family for family in families if family and family not in text]:
            wrong.append(f"{name} does not name {', '.join(unnamed)}")
        if "to be filled in" in text:
            wrong.append(f'{name} still says "to be filled in"')
    if f"v{package}" not in git(root, "tag", "--points-at", "HEAD").split():
        wrong.append(f"this commit has no tag v{package}: git tag -a v{package}")
    if git(root, "status", "--porcelain"):
        wrong.append("there are changes that are not committed")
    return wrong


def notes(cited: dict, changelog: str, folder: Path) -> str:
    """What a release is, what each of its files is for, and what is new."""
    parts = re.split(r"^(?=## )", changelog, flags=re.M)
    new = next(part for part in parts if ENTRY.match(part)).partition("\n")[2].strip()
    found = {name: next(folder.glob(name), Path(name)).name for name in FILES}
    listed = "\n".join(f"- `{found[name]}`: {what}." for name, (_, what) in FILES.items())
    title = f"# {cited['title']}, version {cited['version']} of {cited['date-released']}"
    return f"{title}\n\n## Its files\n\n{listed}\n\n## What is new\n\n{new}\n"


def crate(cited: dict, made: list[Path]) -> dict:
    """What a release holds, as an RO-Crate (version 1.1) for archives and indexes."""
    people = [
        {
            "@id": f"#author-{k}",
            "@type": "Person" if "family-names" in author else "Organization",
            "name": name,
        }
        for k, (author, name) in enumerate(zip(cited["authors"], names(cited["authors"])), 1)
    ]
    files = [
        {
            "@id": path.name,
            "@type": "File",
            "name": path.name,
            "contentSize": str(path.stat().st_size),
            "encodingFormat": mimetypes.guess_type(path.name)[0] or "application/octet-stream",
        }
        for path in made
    ]
    given = cited["license"] if isinstance(cited["license"], list) else [cited["license"]]
    licences = [{"@id": f"{SPDX}{name}", "@type": "CreativeWork", "name": name} for name in given]
    whole = {
        "@id": "./",
        "@type": "Dataset",
        "name": cited["title"],
        "description": " ".join(cited["abstract"].split()),
        "version": str(cited["version"]),
        "datePublished": str(cited["date-released"]),
        "author": [{"@id": person["@id"]} for person in people],
        "license": [{"@id": licence["@id"]} for licence in licences],
        "hasPart": [{"@id": file["@id"]} for file in files],
    }
    itself = {
        "@id": CRATE,
        "@type": "CreativeWork",
        "conformsTo": {"@id": "https://w3id.org/ro/crate/1.1"},
        "about": {"@id": "./"},
    }
    graph = [itself, whole, *files, *people, *licences]
    return {"@context": "https://w3id.org/ro/crate/1.1/context", "@graph": graph}


def archive(site: Path, target: Path, beside: list[Path]) -> None:
    """A site and what goes with it, in a folder of its own, without the build's hidden marks."""
    home = Path(target.name.partition("-")[0])
    paths = {path: path.relative_to(site) for path in site.rglob("*") if path.is_file()}
    paths |= {path: path.name for path in beside}
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as packed:
        for path, name in sorted(paths.items()):
            if not path.name.startswith("."):
                packed.write(path, home / name)


def wheel(root: Path, folder: Path) -> None:
    """The package alone."""
    asked = [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "-w", folder, "."]
    subprocess.run(asked, check=True, cwd=root)  # brackets in a path would be extras to pip


def source(root: Path, target: Path) -> None:
    """The repository as it was committed."""
    asked = ["git", "-C", root, "archive", "--prefix=source/", "-o", target, "HEAD"]
    subprocess.run(asked, check=True)


def collect(root: Path, folder: Path) -> list[Path]:
    """Make wheel, source and the sites' archives, copy the rest, sum them up; what is there then.

    Raises
    ------
    FileNotFoundError
        If something has not been made; the folder is not touched.
    """
    built, version = root / "_build", git(root, "describe", "--tags", "--always")
    made = {name.replace("*", version): place for name, (place, _) in FILES.items() if place}
    if missing := [place for place in made.values() if not (built / place).is_file()]:
        raise FileNotFoundError(f"not made yet, below _build: {', '.join(missing)}")
    new = folder.with_name(f".{folder.name}").resolve()  # whole or not at all
    shutil.rmtree(new, ignore_errors=True)
    new.mkdir(parents=True)
    wheel(root, new)
    source(root, new / f"source-{version}.zip")
    for name, place in made.items():
        if place.endswith(".html"):
            archive((built / place).parent, new / name, [*root.glob("LICENSE*")])
        else:
            shutil.copyfile(built / place, new / name)
    cited = yaml.safe_load((root / "CITATION.cff").read_text("utf-8"))
    said = notes(cited, (root / "CHANGELOG.md").read_text("utf-8"), new)
    (new / "NOTES.md").write_text(said, "utf-8")
    text = json.dumps(crate(cited, sorted(new.iterdir())), indent=1, ensure_ascii=False)
    (new / CRATE).write_text(text + "\n", encoding="utf-8")
    made = sorted(new.iterdir())
    sums = [f"{hashlib.sha256(path.read_bytes()).hexdigest()}  {path.name}\n" for path in made]
    (new / "SHA256SUMS").write_text("".join(sums), encoding="utf-8")
    shutil.rmtree(folder, ignore_errors=True)
    new.rename(folder)
    return sorted(folder.iterdir())


if __name__ == "__main__":
    if found := disagreements(ROOT):
        sys.exit("".join(f"==> {sentence}\n" for sentence in found) + "==> No release was made")
    if "--check" not in sys.argv[1:]:
        for path in collect(ROOT, ROOT / "dist"):
            print(f"==> {path.relative_to(ROOT)}, {path.stat().st_size / 1e6:.1f} MB")
