"""What a page loads: Pyodide's core from npm, wheels that its lock names, the editor, our own.

Each foreign file is taken by its hash, from a mirror or from Pyodide's own public address, and kept
for the next time.
"""

from __future__ import annotations

import base64
import hashlib
import io
import json
import math
import re
import shutil
import subprocess
import tarfile
import tempfile
import urllib.error
import urllib.request
import zipfile
from importlib.metadata import distribution
from pathlib import Path

import ddlib

PAGE = Path(__file__).with_name("page")  # what the page itself runs
COMPILE = Path(__file__).with_name("compile.mjs")
EDITOR = Path(__file__).with_name("editor")
START = Path(__file__).with_name("start.mjs")
SITE = "/lib/python{}.{}/site-packages/"  # of the Python in a page, by its version
BOOK = "/book"  # where cells run, and the rooms of the book are
VERSION = "314.0.3"
TARBALL = "sK40My6m8tmBUYtYH9au9rXUeh9x0wfahtHdOlGmJxZDsKBGKtP6KznyFB2+u/klbQTdDionR0uaVd176zVQzQ=="
CORE = ("pyodide.mjs", "pyodide.asm.mjs", "pyodide.asm.wasm", "python_stdlib.zip")
LOCK = "pyodide-lock.json"
STARTED = "started.gz"  # Python's memory after its start
CODES = ("code ", "errno ", "syscall ")  # what npm says before it says why
PUBLIC = f"https://cdn.jsdelivr.net/pyodide/v{VERSION}/full"  # where Pyodide keeps its wheels
WHEELS = (
    "numpy",
    "scipy",
    "sympy",
    "matplotlib",
    "pandas",
    "scikit-learn",
)  # and what these depend on
PURE = {  # from this environment: what each depends on, and what is imported of it
    "control": (["numpy", "scipy", "matplotlib"], "control"),
    "lazy-loader": ([], "lazy_loader"),
    "pyyaml": ([], "yaml"),
    "traitlets": ([], "traitlets"),
}
FIRST = ("numpy", "ddlib", "lazy-loader")  # before the first cell
LATER = {"fonttools"}  # what Matplotlib takes for a PDF alone: it comes if a cell saves one
ROOMS = "workshop"  # of the book, and Part IV's
OURS = (
    "control",
    "joblib",
    "yaml",
    "ddlib.widgets",
    ROOMS,
)  # what modules of ours import, any time
WIDGETS = "ddlib/widgets"  # a wheel of their own: few cells show one
STILL = f"{WIDGETS}/still.py"  # draws what a page does not show


class Refused(RuntimeError):
    """Something is missing, or is not as its hash says."""


def sha256(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


def with_dependencies(packages: dict, wanted=WHEELS) -> list[str]:
    """Names of packages of a lock, with all that they depend on."""
    complete: list[str] = []
    todo = list(wanted)
    while todo:
        name = todo.pop()
        if name not in complete:
            complete.append(name)
            todo += packages[name]["depends"]
    return sorted(complete)


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


def take(entries: list[dict], mirror: str, store: Path) -> None:
    """Wheels of a lock into a folder: all of them, or none that is not as the lock says."""
    lacking = {
        entry["file_name"]: entry["sha256"]
        for entry in entries
        if not (store / entry["file_name"]).is_file()
        or sha256((store / entry["file_name"]).read_bytes()) != entry["sha256"]
    }
    if not lacking:
        return
    source = mirror or PUBLIC
    files = f"{len(lacking)} wheels" if len(lacking) > 1 else next(iter(lacking))
    print(f"==> Taking {files} of Pyodide {VERSION} from {source}", flush=True)
    problems, contents = [], {}
    try:
        for name, wanted in lacking.items():
            content = read(source, name)
            if content is None:
                problems.append(f"{name} is missing")
            elif sha256(content) != wanted:
                problems.append(f"{name} has SHA-256 {sha256(content)}, the lock wants {wanted}")
            else:
                contents[name] = content
        why = "it has not all packages"
    except OSError as error:  # no network, no such host, or a break on the way
        why, problems = f"cannot be reached ({getattr(error, 'reason', error)})", list(lacking)
    if problems:
        wanted = f"Name a folder or an address with these files of Pyodide {VERSION} by MIRROR="
        raise Refused("\n    ".join([f"{source}: {why}. {wanted}:", *problems]))
    store.mkdir(parents=True, exist_ok=True)
    for name, content in contents.items():
        part = store / f"{name}.part"
        part.write_bytes(content)
        part.replace(store / name)


def core(store: Path) -> None:
    """Pyodide's core and its lock, out of npm's archive, which is kept and hashed each time."""
    archive = store / f"pyodide-{VERSION}.tgz"
    if not archive.is_file():
        store.mkdir(parents=True, exist_ok=True)
        npm(store, "pack", f"pyodide@{VERSION}")
    if base64.b64encode(hashlib.sha512(archive.read_bytes()).digest()).decode() != TARBALL:
        archive.unlink()
        raise Refused(f"pyodide {VERSION} of npm is not the archive with SHA-512 {TARBALL}")
    with tarfile.open(archive) as packed:
        for name in (*CORE, LOCK):
            (store / name).write_bytes(packed.extractfile(f"package/{name}").read())


def npm(folder: Path, *command: str) -> None:
    """Have npm do something in a folder."""
    program = shutil.which("npm")
    if program is None:
        raise Refused(
            "npm is missing: Pyodide's core and the editor come by it (https://nodejs.org)"
        )
    command = [*command, "--loglevel=error", "--fetch-retries=1"]
    done = subprocess.run([program, *command], cwd=folder, capture_output=True, text=True)
    if done.returncode:
        reasons = [line.removeprefix("npm error ") for line in done.stderr.splitlines()]
        sentences = (line for line in reasons if " " in line and not line.startswith(CODES))
        raise Refused(
            f"npm {' '.join(command[:-2])} ended with “{next(sentences, 'no reason')}”. Try again "
            f"with a way to npm's registry (npm config get registry); Pyodide's wheels come from "
            f"MIRROR= or {PUBLIC}."
        )


def editor(store: Path) -> Path:
    """The editor as one script: CodeMirror by the hashes of its lock, bundled once and kept."""
    sources = [EDITOR / name for name in ("editor.mjs", "package.json", "package-lock.json")]
    script = store / f"editor-{sha256(b''.join(path.read_bytes() for path in sources))}.js"
    if script.is_file():
        return script
    print("==> Bundling the editor (CodeMirror)", flush=True)
    store.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=store) as name:
        folder = Path(name)
        for path in sources:
            shutil.copy(path, folder)
        npm(folder, "ci", "--ignore-scripts", "--no-audit", "--no-fund")
        bundler = ["node", "node_modules/esbuild-wasm/bin/esbuild", "editor.mjs"]
        options = ["--bundle", "--minify", "--format=esm", "--log-level=error"]
        done = subprocess.run(
            [*bundler, *options], cwd=folder, stdin=subprocess.DEVNULL, capture_output=True
        )
        if done.returncode:
            raise Refused(f"the editor could not be bundled: {done.stderr.decode()[-500:]}")
        bundler = folder / "node_modules" / "esbuild-wasm"
        licences = {
            path.read_bytes()
            for path in folder.rglob("LICENSE*")
            if not path.is_relative_to(bundler)
        }
        texts = b"\n".join(sorted(licences))
        part = folder / "part"
        part.write_bytes(b"/*\n" + texts + b"*/\n" + done.stdout)
        part.replace(script)
    return script


def zipped(files: dict[str, bytes]) -> bytes:
    """A zip with the same bytes for the same files."""
    target = io.BytesIO()
    with zipfile.ZipFile(target, "w") as archive:
        for name in sorted(files):
            archive.writestr(zipfile.ZipInfo(name), files[name], zipfile.ZIP_DEFLATED)
    return target.getvalue()


def sources(folder: Path, under: Path) -> dict[str, bytes]:
    """Modules of a package, their stubs, and the scripts of its widgets, by their paths."""
    paths = [p for p in folder.rglob("*") if p.suffix in {".py", ".pyi", ".js", ".css"}]
    return {path.relative_to(under).as_posix(): path.read_bytes() for path in paths}


def installed(name: str) -> tuple[str, dict[str, bytes]]:
    """Version and modules of a package of this environment, without its tests."""
    package = distribution(name)
    modules = (
        path
        for path in package.files
        if path.suffix in {".py", ".pyi"} and not {"tests", ".."} & {*path.parts}
    )
    return package.version, {path.as_posix(): path.locate().read_bytes() for path in modules}


def wheel(name: str, version: str, files: dict, depends: list, imports: list, out: Path) -> dict:
    """Write a wheel; returns its entry for the lock."""
    plain = name.replace("-", "_")
    info = f"{plain}-{version}.dist-info"
    about = {
        f"{info}/METADATA": f"Metadata-Version: 2.1\nName: {name}\nVersion: {version}\n",
        f"{info}/WHEEL": "Wheel-Version: 1.0\nRoot-Is-Purelib: true\nTag: py3-none-any\n",
        f"{info}/RECORD": "",
    }
    file_name = f"{plain}-{version}-py3-none-any.whl"
    content = {**files, **{path: text.encode() for path, text in about.items()}}
    (out / file_name).write_bytes(zipped(content))
    return {
        "name": name, "version": version, "file_name": file_name, "install_dir": "site",
        "package_type": "package", "imports": imports, "depends": depends,
    }  # fmt: skip


def taken(mirror: str, store: Path) -> dict:
    """The lock, with those packages alone that a page may need; their files lie in the store,
    and the editor.
    """
    core(store)
    lock = json.loads((store / LOCK).read_text(encoding="utf-8"))
    packages = {name: lock["packages"][name] for name in with_dependencies(lock["packages"])}
    take(list(packages.values()), mirror, store)
    editor(store)
    return {**lock, "packages": packages}


def node(*words) -> None:
    """Run Pyodide's core where pages are built."""
    program = shutil.which("node")
    if program is None:
        raise Refused("node is missing: it compiles packages (https://nodejs.org)")
    done = subprocess.run([program, *words], capture_output=True, text=True)
    if done.returncode:
        raise Refused(f"packages could not be compiled: {done.stderr[-500:]}")


def compile_all(folder: Path, store: Path) -> dict[str, str]:
    """Packs in place of all wheels of a folder, with compiled code in place of sources.

    They are kept. Returns their names, by those of the wheels: these follow from what is in them,
    so that no browser has yesterday's.
    """
    kept = store / "compiled"
    kept.mkdir(parents=True, exist_ok=True)
    todo, found, names = [], {}, {}
    for path in sorted(folder.glob("*.whl")):
        found[path] = kept / sha256(path.read_bytes() + COMPILE.read_bytes())
        if not found[path].is_file():
            root = f"{BOOK}/" if path.name.startswith(f"{ROOMS}-") else SITE
            todo += [root, path, found[path].with_suffix(".part")]
    if todo:
        print(f"==> Compiling {len(todo) // 3} packages", flush=True)
        node(COMPILE, store.resolve(), *todo)
        for part in todo[2::3]:
            part.replace(part.with_suffix(""))
    for path, pack in found.items():
        digest = sha256(pack.read_bytes())[:12]
        names[path.name] = f"{path.name.partition('-')[0]}-{digest}.pack"
        shutil.copyfile(pack, folder / names[path.name])
        path.unlink()
    return names


def write_packages(root: Path, mirror: str, store: Path, out: Path) -> tuple[list[int], dict]:
    """All that the worker loads, into a folder; megabytes, at first and in all, and the lock's
    packages.
    """
    lock = taken(mirror, store)
    packages = lock["packages"]
    pyodide = out / "pyodide"
    pyodide.mkdir(parents=True)
    for name in (*CORE, *(entry["file_name"] for entry in packages.values())):
        shutil.copyfile(store / name, pyodide / name)
    for name, (depends, imports) in PURE.items():
        packages[name] = wheel(name, *installed(name), depends, [imports], pyodide)
    ours = sources(root / "ddlib", root)
    widgets = {path: ours.pop(path) for path in sorted(ours) if path.startswith(f"{WIDGETS}/")}
    widgets[STILL] = (PAGE / "instead" / "still.py").read_bytes()
    version, first = ddlib.__version__, [name for name in FIRST if name != "ddlib"]
    rooms = [sources(root / "book" / name, root / "book") for name in (ROOMS, "beyond")]
    for name, number, files, depends, imports in (
        ("ddlib", version, ours, first, ["ddlib"]),
        ("ddlib-widgets", version, widgets, ["traitlets"], [WIDGETS.replace("/", ".")]),
        (ROOMS, "0", rooms[0] | rooms[1], [], [ROOMS, "beyond"]),
    ):
        packages[name] = wheel(name, number, files, depends, imports, pyodide)
    packages[ROOMS]["install_dir"] = BOOK
    names = compile_all(pyodide, store)
    for entry in packages.values():
        entry["file_name"] = names[entry["file_name"]]
        entry["depends"] = [name for name in entry["depends"] if name not in LATER]
    (pyodide / LOCK).write_text(json.dumps(lock), encoding="utf-8")
    shutil.copyfile(editor(store), out / "editor.js")
    files = {name: pyodide / entry["file_name"] for name, entry in packages.items()}
    imported = with_dependencies(packages, (*FIRST, "matplotlib"))
    node(START, pyodide.resolve(), pyodide / STARTED, *(files[name] for name in imported))
    shutil.copytree(PAGE, out, dirs_exist_ok=True, ignore=shutil.ignore_patterns("__pycache__"))
    at_first = [*(pyodide / name for name in (*CORE, LOCK, STARTED)), *map(files.get, FIRST)]
    every = [path for path in out.rglob("*") if path.is_file()]
    megabytes = [
        math.ceil(sum(path.stat().st_size for path in files) / 1e6) for files in (at_first, every)
    ]
    return megabytes, packages
