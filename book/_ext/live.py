"""*Run this page*: `python book/_ext/live.py [--mirror FOLDER_OR_ADDRESS]`.

Copies the built site and adds to its lessons what runs their open cells in the browser: Pyodide's
core from npm, and from the mirror, or Pyodide's own public address, the wheels that its
`pyodide-lock.json` names, each by its SHA-256; they are kept for the next time. `ddlib`, the
workshop and two pure packages come from here. The site that `make book` writes stays as it is; what
a page loads, it loads on a click and from its own site.
"""

from __future__ import annotations

import argparse
import ast
import base64
import hashlib
import importlib.util
import io
import json
import math
import re
import shlex
import shutil
import subprocess
import sys
import tarfile
import urllib.error
import urllib.request
import zipfile
from functools import cache
from importlib.metadata import distribution
from pathlib import Path

import nbformat
from dd_lessons import chapters
from dd_reader import CHANGE_THIS, FOLDED, has_script
from handles import handles
from offers import FIRST as FIRST_PAGE, offer
from solved import exercises

ROOT = Path(__file__).parents[2]
PAGE = Path(__file__).with_name("live_page")  # what the page itself runs
sys.path.append(str(PAGE))
from names import names  # noqa: E402

BUILD = ROOT / "_build"
VERSION = "314.0.3"
TARBALL = "sK40My6m8tmBUYtYH9au9rXUeh9x0wfahtHdOlGmJxZDsKBGKtP6KznyFB2+u/klbQTdDionR0uaVd176zVQzQ=="
CORE = ("pyodide.mjs", "pyodide.asm.mjs", "pyodide.asm.wasm", "python_stdlib.zip")
LOCK = "pyodide-lock.json"
CODES = ("code ", "errno ", "syscall ")  # what npm says before it says why
PUBLIC = f"https://cdn.jsdelivr.net/pyodide/v{VERSION}/full"  # where Pyodide keeps its wheels
WHEELS = ("numpy", "scipy", "sympy", "matplotlib", "pandas")  # and what these depend on
PURE = {"lazy-loader": [], "traitlets": [], "control": ["numpy", "scipy", "matplotlib"]}
# from this environment
FIRST = ("numpy", "ddlib", "lazy-loader")  # before the first cell
WIDGETS = "ddlib/widgets"  # a wheel of their own: few cells show one
DATA = re.compile(r"""["']data/([\w.-]+)["']""")


class Refused(RuntimeError):
    """Something is missing, or is not as its hash says."""


class Unreachable(RuntimeError):
    """An address does not answer at all."""


def sha256(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


def needed(packages: dict, wanted=WHEELS) -> list[str]:
    """Names of packages of a lock, with all that they depend on."""
    found: list[str] = []
    names = list(wanted)
    while names:
        name = names.pop()
        if name not in found:
            found.append(name)
            names += packages[name]["depends"]
    return sorted(found)


def read(mirror: str, name: str) -> bytes | None:
    """A file of the mirror, a folder or an address; None if it has none of that name."""
    if not re.match(r"https?://", mirror):
        path = Path(mirror).expanduser() / name
        return path.read_bytes() if path.is_file() else None
    try:
        with urllib.request.urlopen(f"{mirror.rstrip('/')}/{name}", timeout=60) as opened:
            return opened.read()
    except urllib.error.HTTPError:
        return None
    except OSError as error:  # no network, no such host, or a break on the way
        why = getattr(error, "reason", error)
        raise Unreachable(f"{mirror} cannot be reached ({why})") from error


def take(entries: list[dict], mirror: str, kept: Path) -> None:
    """Wheels of a lock into a folder: all of them, or none that is not as the lock says."""
    lacking = [
        entry
        for entry in entries
        if not (kept / entry["file_name"]).is_file()
        or sha256((kept / entry["file_name"]).read_bytes()) != entry["sha256"]
    ]
    if not lacking:
        return
    source = mirror or PUBLIC
    files = f"{len(lacking)} wheels" if len(lacking) > 1 else lacking[0]["file_name"]
    print(f"==> Taking {files} of Pyodide {VERSION} from {source}", flush=True)
    problems, taken = [], {}
    for entry in lacking:
        name, wanted = entry["file_name"], entry["sha256"]
        try:
            content = read(source, name)
        except Unreachable as error:
            raise Refused(
                f"no {files} of Pyodide {VERSION}: {error}. Name a folder or an address that has "
                f"them by MIRROR=, or try again with a way to {PUBLIC}."
            ) from None
        if content is None:
            problems.append(f"{name} is missing")
        elif sha256(content) != wanted:
            problems.append(f"{name} has SHA-256 {sha256(content)}, the lock wants {wanted}")
        else:
            taken[name] = content
    if problems:
        wanted = f"a folder or an address with the packages of Pyodide {VERSION} is needed"
        raise Refused("\n    ".join([f"MIRROR={source}: {wanted}.", *problems]))
    kept.mkdir(parents=True, exist_ok=True)
    for name, content in taken.items():
        part = kept / f"{name}.part"
        part.write_bytes(content)
        part.replace(kept / name)


def core(kept: Path) -> None:
    """Pyodide's core and its lock, by npm."""
    if all((kept / name).is_file() for name in (*CORE, LOCK)):
        return
    npm = shutil.which("npm")
    if npm is None:
        raise Refused("npm is missing: Pyodide's core comes by it (https://nodejs.org)")
    kept.mkdir(parents=True, exist_ok=True)
    asked = [npm, "pack", "--loglevel=error", "--fetch-retries=1", f"pyodide@{VERSION}"]
    made = subprocess.run(asked, cwd=kept, capture_output=True, text=True)
    archive = kept / f"pyodide-{VERSION}.tgz"
    if made.returncode or not archive.is_file():
        said = [line.removeprefix("npm error ") for line in made.stderr.splitlines()]
        why = next((line for line in said if " " in line and not line.startswith(CODES)), "no file")
        raise Refused(
            f"no core of Pyodide {VERSION}, which npm's registry has: npm pack pyodide@{VERSION} "
            f"ended with “{why}”. Try again with a way to it (npm config get registry); wheels "
            f"come from MIRROR= or {PUBLIC}."
        )
    if base64.b64encode(hashlib.sha512(archive.read_bytes()).digest()).decode() != TARBALL:
        archive.unlink()
        raise Refused(f"pyodide {VERSION} of npm is not the archive with SHA-512 {TARBALL}")
    with tarfile.open(archive) as packed:
        for name in (*CORE, LOCK):
            (kept / name).write_bytes(packed.extractfile(f"package/{name}").read())
    archive.unlink()


def zipped(files: dict[str, bytes]) -> bytes:
    """A zip with the same bytes for the same files."""
    made = io.BytesIO()
    with zipfile.ZipFile(made, "w") as archive:
        for name in sorted(files):
            archive.writestr(zipfile.ZipInfo(name), files[name], zipfile.ZIP_DEFLATED)
    return made.getvalue()


def sources(folder: Path, under: Path) -> dict[str, bytes]:
    """Modules of a package, their stubs, and the scripts of its widgets, by their paths."""
    paths = [p for p in folder.rglob("*") if p.suffix in {".py", ".pyi", ".js", ".css"}]
    return {path.relative_to(under).as_posix(): path.read_bytes() for path in paths}


def installed(name: str) -> tuple[str, dict[str, bytes]]:
    """Version and modules of a package of this environment, as its own list of hashes has them."""
    found = distribution(name)
    files = {}
    for path in found.files:
        if path.suffix not in {".py", ".pyi"} or "tests" in path.parts or ".." in path.parts:
            continue
        content = path.locate().read_bytes()
        told = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).decode()
        if path.hash is None or told.rstrip("=") != path.hash.value:
            raise Refused(f"{name}: {path} is not as it was installed")
        files[path.as_posix()] = content
    return found.version, files


def wheel(name: str, version: str, files: dict[str, bytes], depends: list, out: Path) -> dict:
    """Write a wheel; returns its entry for the lock."""
    plain = name.replace("-", "_")
    info = f"{plain}-{version}.dist-info"
    told = {
        f"{info}/METADATA": f"Metadata-Version: 2.1\nName: {name}\nVersion: {version}\n",
        f"{info}/WHEEL": "Wheel-Version: 1.0\nRoot-Is-Purelib: true\nTag: py3-none-any\n",
        f"{info}/RECORD": "",
    }
    content = zipped({**files, **{path: text.encode() for path, text in told.items()}})
    file_name = f"{plain}-{version}-py3-none-any.whl"
    (out / file_name).write_bytes(content)
    return {
        "name": name, "version": version, "file_name": file_name, "install_dir": "site",
        "sha256": sha256(content), "package_type": "package", "imports": [plain],
        "depends": depends, "unvendored_tests": False,
    }  # fmt: skip


def runtime(root: Path, mirror: str, kept: Path, out: Path) -> dict[str, int]:
    """All that the worker loads, into a folder; returns megabytes, at first and in all."""
    core(kept)
    lock = json.loads((kept / LOCK).read_text(encoding="utf-8"))
    names = needed(lock["packages"])
    packages = {name: lock["packages"][name] for name in names}
    take(list(packages.values()), mirror, kept)
    pyodide = out / "pyodide"
    pyodide.mkdir(parents=True)
    for name in (*CORE, *(entry["file_name"] for entry in packages.values())):
        shutil.copyfile(kept / name, pyodide / name)
    for name, depends in PURE.items():
        packages[name] = wheel(name, *installed(name), depends, pyodide)
    ours = sources(root / "ddlib", root)
    widgets = {path: ours.pop(path) for path in sorted(ours) if path.startswith(f"{WIDGETS}/")}
    depends, version = [name for name in FIRST if name != "ddlib"], distribution("ddlib").version
    packages["ddlib"] = wheel("ddlib", version, ours, depends, pyodide)
    packages["ddlib-widgets"] = wheel("ddlib-widgets", version, widgets, ["traitlets"], pyodide)
    packages["ddlib-widgets"]["imports"] = [WIDGETS.replace("/", ".")]
    rooms = [sources(root / "book" / name, root / "book") for name in ("workshop", "beyond")]
    (out / "workshop.zip").write_bytes(zipped(rooms[0] | rooms[1]))
    (pyodide / LOCK).write_text(json.dumps({**lock, "packages": packages}), encoding="utf-8")
    shutil.copytree(PAGE, out, dirs_exist_ok=True, ignore=shutil.ignore_patterns("__pycache__"))
    at_first = [*CORE, LOCK, *(packages[name]["file_name"] for name in FIRST)]
    size = {path: path.stat().st_size for path in out.rglob("*") if path.is_file()}
    return {
        "first": math.ceil(sum(size[pyodide / name] for name in at_first) / 1e6),
        "all": math.ceil(sum(size.values()) / 1e6),
    }


def kind(cell) -> str:
    """What a code cell is on a page that runs: "open", "answer", "check", or ""."""
    answer = re.search(r"^mine = \.\.\.", cell.source, re.MULTILINE)
    if not {*FOLDED, "hide-cell"} & set(cell.metadata.get("tags", [])):
        return "answer" if answer else "open"
    judges = "hide-input" in cell.metadata["tags"] and re.search(r"\bmine\b", cell.source)
    return "check" if judges else ""


@cache
def stand_in():
    """What stands in for PyTorch in a page."""
    spec = importlib.util.spec_from_file_location("torch_of_a_page", PAGE / "instead" / "torch.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def lacking(path: str) -> bool:
    """Whether a dotted name of PyTorch is not in what stands in for it."""
    found = stand_in()
    for part in path.split(".")[1:]:
        found = getattr(found, part, None)
    return found is None or type(found).__name__ == "_Lacking"


def needs(source: str, known: dict[str, str]) -> str:
    """What a cell uses of PyTorch that the page lacks; `known`, names from its imports, grows."""
    used = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            names = [a for a in node.names if a.name.partition(".")[0] == "torch"]
            known |= {a.asname or "torch": a.name if a.asname else "torch" for a in names}
        elif isinstance(node, ast.ImportFrom) and f"{node.module}.".startswith("torch."):
            known |= {a.asname or a.name: f"{node.module}.{a.name}" for a in node.names}
            used |= {f"{node.module}.{a.name}" for a in node.names}
        elif isinstance(node, ast.Attribute):
            root, _, rest = ast.unparse(node).partition(".")
            if root in known and re.fullmatch(r"[\w.]+", rest):
                used.add(f"{known[root]}.{rest}")
    return ", ".join(sorted(filter(lacking, used)))


def live_cells(notebook) -> list[dict]:
    """The cells of a notebook that a reader of the page can run, in order.

    With the names that each takes and gives, the handles of *Change this*, and the solution of an
    exercise.
    """
    code = [cell for cell in notebook.cells if cell.cell_type == "code" and kind(cell)]
    found, imported, known = [], set(), {}
    for cell in code:
        told = names(cell.source, imported)
        imported = (imported - told.writes - told.perhaps) | told.imports
        one = {"id": cell.id, "kind": kind(cell), "source": cell.source}
        one["needs"] = needs(cell.source, known)
        one["names"] = told.told()
        if CHANGE_THIS in cell.metadata.get("tags", ()):
            one["handles"] = [handle._asdict() for handle in handles(cell.source)]
        found.append(one)
    answers = [one for one in found if one["kind"] == "answer"]
    for one, exercise in zip(answers, exercises(notebook)):
        one["solution"] = exercise.solution
        one["solves"] = names(f"{exercise.solution}\n{exercise.check}", imported).told()
    return found


def live_page(text: str, notebook, page: str, megabytes: list[int]) -> str:
    """A built page with its cells marked, and with the script that makes them run."""
    code = [cell for cell in notebook.cells if cell.cell_type == "code"]
    before, *parts = re.split(r'(?=<div class="cell )', text)
    if len(parts) != len(code):
        raise Refused(f"{page} has {len(parts)} cells, its notebook {len(code)}: make book first")
    for k, cell in enumerate(code):
        if kind(cell):
            parts[k] = parts[k].replace("<div", f'<div data-live="{cell.id}"', 1)
    cells = live_cells(notebook)
    told = {
        "cells": cells,
        "data": sorted({name for cell in cells for name in DATA.findall(cell["source"])}),
        "megabytes": megabytes,
        "notebook": f"../_sources/{page}.ipynb",
    }
    island = json.dumps(told).replace("</", "<\\/")
    added = (
        '<link rel="stylesheet" href="../_static/live/live.css">'
        '<script defer src="../_static/live/follow.js"></script>'
        '<script defer src="../_static/live/live.js"></script>'
        f'<script type="application/json" id="live-page">{island}</script>'
    )
    return "".join([before, *parts]).replace("</body>", f"{added}\n</body>", 1)


def write(root: Path, site: Path, mirror: str, kept: Path, out: Path) -> list[str]:
    """The site with its lessons live, in a folder of its own: whole, or as it was before."""
    if not (site / "index.html").is_file():
        raise Refused(f"{site} has no pages: make book first")
    part = out.with_name(f"{out.name}.part")
    shutil.rmtree(part, ignore_errors=True)
    try:
        shutil.copytree(site, part)
        folder = part / "_static" / "live"
        sizes = runtime(root, mirror, kept, folder)
        pages = []
        for path in chapters(root):
            page = path.relative_to(root).with_suffix("").as_posix()
            notebook = nbformat.read(path, as_version=4)
            target = part / f"{page}.html"
            if not target.is_file() or not has_script(notebook):
                continue
            text = target.read_text(encoding="utf-8")
            text = live_page(text, notebook, page, [sizes["first"], sizes["all"]])
            target.write_text(text, encoding="utf-8")
            pages.append(page)
            for name in DATA.findall("\n".join(c.source for c in notebook.cells)):
                (folder / "data").mkdir(exist_ok=True)
                shutil.copyfile(root / "book" / "data" / name, folder / "data" / name)
        if (part / FIRST_PAGE).is_file():
            offer(part)
        shutil.rmtree(out, ignore_errors=True)
        part.rename(out)
    finally:
        shutil.rmtree(part, ignore_errors=True)
    return pages


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.partition(":")[0])
    parser.add_argument(
        "--mirror", default="", help=f"folder or address with Pyodide's packages, or {PUBLIC}"
    )
    parser.add_argument("--html", default=BUILD / "html", type=Path, help="the site as built")
    parser.add_argument("--out", default=BUILD / "live", type=Path, help="where the new one goes")
    options = parser.parse_args()
    try:
        done = write(ROOT, options.html, options.mirror, BUILD / "pyodide" / VERSION, options.out)
    except (Refused, OSError) as error:
        sys.exit(f"==> FAILED: {error}")
    print(f"==> {len(done)} pages run in the browser. Serve them, and open the first:")
    print(f"    python -m http.server --directory {shlex.quote(str(options.out))}")
