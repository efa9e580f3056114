// Python's own code is compiled where pages are built, by the Python that they run: an import takes half
// as long. `node compile.mjs FOLDER_OF_PYODIDE ROOT IN OUT [ROOT IN OUT ...]`: of each wheel comes a pack
// (page/packs.mjs), which unpacks into ROOT.
import { readFileSync, writeFileSync } from "node:fs";
import { pathToFileURL } from "node:url";

const [folder, ...rest] = process.argv.slice(2);
const { loadPyodide } = await import(pathToFileURL(`${folder}/pyodide.mjs`));
const python = await loadPyodide({ indexURL: `${folder}/` });
python.runPython(`
import gzip, importlib.util, json, sys, zipfile
from importlib._bootstrap_external import _code_to_hash_pyc
from pathlib import Path

def compiled(root):
    """A pack with code in place of sources; nobody checks it against them."""
    root, files = root.format(*sys.version_info), {}
    with zipfile.ZipFile("/in") as before:
        for name in sorted(n for n in before.namelist() if not n.endswith("/")):
            data = before.read(name)
            if name.endswith(".py"):
                code = compile(data, root + name, "exec", dont_inherit=True)
                data = bytes(_code_to_hash_pyc(code, importlib.util.source_hash(data), False))
                name += "c"
            files[name] = data
    sizes = json.dumps({name: len(data) for name, data in files.items()}).encode()
    content = len(sizes).to_bytes(4, "little") + sizes + b"".join(files.values())
    Path("/out").write_bytes(gzip.compress(content, mtime=0))
`);
const compiled = python.globals.get("compiled");
while (rest.length) {
  const [root, source, target] = rest.splice(0, 3);
  python.FS.writeFile("/in", readFileSync(source));
  compiled(root);
  writeFileSync(target, python.FS.readFile("/out"));
}
