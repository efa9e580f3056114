// Python's memory after its start, kept where pages are built: a page begins with it. What the packs and
// the page take of Python's own library is imported; numpy is not, for a memory with compiled libraries
// is no start for another Python. `node start.mjs FOLDER_OF_PYODIDE OUT PACK [PACK ...]`.
import { createReadStream, writeFileSync } from "node:fs";
import { Readable } from "node:stream";
import { pathToFileURL } from "node:url";
import { gzipSync } from "node:zlib";
import { unpack, unzipped } from "./page/packs.mjs";

const [folder, target, ...packs] = process.argv.slice(2);
process.argv[1] = "./this.program"; // as in a browser: Python keeps in its memory where its program lies
const { loadPyodide } = await import(pathToFileURL(`${folder}/pyodide.mjs`));
const options = { indexURL: `${folder}/`, convertNullToNone: true };
const whole = await loadPyodide(options);
for (const pack of packs) {
  const answer = { body: Readable.toWeb(createReadStream(pack)) };
  await unpack(whole, whole._api.sitePackages, await unzipped(answer));
}
const names = whole.runPython(`
import sys
import ast, concurrent.futures, hashlib, linecache, pickle, random, traceback
import ddlib.figures.style, matplotlib.backends.backend_svg
", ".join(n for n in sys.modules if n.partition(".")[0] in sys.stdlib_module_names)
`);
const first = await loadPyodide({ ...options, _makeSnapshot: true });
first.runPython(`import ${names}`);
const memory = first.makeMemorySnapshot();
await loadPyodide({ ...options, _loadSnapshot: memory }); // it has to fit: a Python begins with 30 MiB
writeFileSync(target, gzipSync(memory));
