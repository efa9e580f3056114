// Python's own code is compiled where pages are built, by the Python that they run: an import takes half
// as long. `node compile.mjs FOLDER_OF_PYODIDE ROOT IN OUT [ROOT IN OUT ...]`, where zips unpack into ROOT.
import { readFileSync, writeFileSync } from "node:fs";
import { pathToFileURL } from "node:url";

const [folder, ...rest] = process.argv.slice(2);
const { loadPyodide } = await import(pathToFileURL(`${folder}/pyodide.mjs`));
const python = await loadPyodide({ indexURL: `${folder}/` });
python.runPython(`
import importlib.util, sys, zipfile
from importlib._bootstrap_external import _code_to_hash_pyc

def compiled(root):
    """The zip with code in place of its sources; nobody checks it against them."""
    root = root.format(*sys.version_info)
    with zipfile.ZipFile("/in") as before, zipfile.ZipFile("/out", "w") as after:
        for name in sorted(before.namelist()):
            data = before.read(name)
            if name.endswith(".py"):
                code = compile(data, root + name, "exec", dont_inherit=True)
                data = bytes(_code_to_hash_pyc(code, importlib.util.source_hash(data), False))
                name += "c"
            after.writestr(zipfile.ZipInfo(name), data, zipfile.ZIP_DEFLATED)
`);
const compiled = python.globals.get("compiled");
while (rest.length) {
  const [root, source, target] = rest.splice(0, 3);
  python.FS.writeFile("/in", readFileSync(source));
  compiled(root);
  writeFileSync(target, python.FS.readFile("/out"));
}
