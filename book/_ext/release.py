"""Put a release together in `dist/`: wheel, sites, PDFs, EPUB, notebooks, their list and checksums.

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
from pathlib import Path

import yaml

ROOT = Path(__file__).parents[2]
CRATE, SPDX = "ro-crate-metadata.json", "https://spdx.org/licenses/"
VERSION = re.compile(r'^__version__ = "(.+)"$', re.M)
ENTRY = re.compile(r"^## (\S+) \((\d{4}-\d\d-\d\d)\)$", re.M)
MADE = {"notebooks.zip": "html/notebooks.zip", "walk.pdf": "pdf/walk.pdf",
        "evidence.pdf": "pdf/evidence.pdf", "book.epub": "epub/book.epub"}  # fmt: skip
"""Names in the release, and where they are made below `_build`."""
BESIDE = (".zenodo.json", "paper/paper.md", "paper/metadata.yaml")
"""What names the authors beside the citation."""


def git(root: Path, *words: str) -> str:
    """What git says, or nothing where it fails."""
    answer = subprocess.run(
        ["git", "-C", root, *words], capture_output=True, text=True, check=False
    )
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


def notes(changelog: str) -> str:
    """What its newest entry says."""
    parts = re.split(r"^(?=## )", changelog, flags=re.M)
    return next(part for part in parts if ENTRY.match(part)).partition("\n")[2].strip() + "\n"


def crate(cited: dict, made: list[Path]) -> dict:
    """What a release holds, as an RO-Crate (version 1.1) for archives and indexes."""
    people = [
        {
            "@id": f"#author-{k}",
            "@type": "Person" if "family-names" in author else "Organization",
            "name": author.get("name") or f"{author['given-names']} {author['family-names']}",
        }
        for k, author in enumerate(cited["authors"], 1)
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
    names = cited["license"] if isinstance(cited["license"], list) else [cited["license"]]
    licences = [{"@id": f"{SPDX}{name}", "@type": "CreativeWork", "name": name} for name in names]
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


def archive(site: Path, target: Path) -> None:
    """A site as one file; unzipped and served by `python -m http.server`, it is whole."""
    shutil.make_archive(str(target.with_suffix("")), "zip", site)


def collect(root: Path, folder: Path) -> list[Path]:
    """Make the wheel and the sites' archives, copy the rest, sum them up; what is there then.

    Raises
    ------
    FileNotFoundError
        If something has not been made; the folder is not touched.
    """
    built, version = root / "_build", git(root, "describe", "--tags", "--always")
    missing = [str(path) for path in MADE.values() if not (built / path).is_file()]
    sites = {"site": "html", "live": "live"}
    firsts = [f"{folder}/index.html" for folder in sites.values()]
    missing += [first for first in firsts if not (built / first).is_file()]
    if missing:
        raise FileNotFoundError(f"not made yet, below _build: {', '.join(missing)}")
    new = folder.with_name(f".{folder.name}")  # whole or not at all
    shutil.rmtree(new, ignore_errors=True)
    new.mkdir(parents=True)
    wheel = [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "-w", new.resolve(), "."]
    subprocess.run(wheel, check=True, cwd=root)  # brackets in a path would be extras to pip
    for name, pages in sites.items():
        archive(built / pages, new / f"{name}-{version}.zip")
    for name, path in MADE.items():
        stem, dot, ending = name.rpartition(".")
        shutil.copyfile(built / path, new / f"{stem}-{version}{dot}{ending}")
    (new / "NOTES.md").write_text(notes((root / "CHANGELOG.md").read_text("utf-8")), "utf-8")
    cited = yaml.safe_load((root / "CITATION.cff").read_text("utf-8"))
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
