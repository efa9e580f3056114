// Python in a worker of its own: the page stays quick, and to stop means to end the worker.
import { loadPyodide } from "./pyodide/pyodide.mjs";

const here = (path) => new URL(path, import.meta.url).href;
const tell = (message) => self.postMessage(message);

// All that Pyodide fetches is counted as it comes, for the progress bar.
const usual = self.fetch.bind(self);
self.fetch = async (...request) => {
  const answer = await usual(...request);
  if (!answer.ok || !answer.body) return answer;
  const count = new TransformStream({
    transform(chunk, out) {
      tell({ bytes: chunk.byteLength });
      out.enqueue(chunk);
    },
  });
  const { headers, status } = answer; // WebAssembly is compiled as it comes by its content type
  return new Response(answer.body.pipeThrough(count), { headers, status });
};

const MODULES = ["absent.py", "kernel.py"];
let python, kernel, packages;

async function file(path) {
  const answer = await fetch(here(path));
  if (!answer.ok) throw new Error(`${path} is missing on this site (${answer.status})`);
  return answer.arrayBuffer();
}

async function start(data) {
  const lock = here("pyodide/pyodide-lock.json");
  const [found, ...files] = await Promise.all([lock, ...MODULES, ...data].map(file));
  packages = JSON.parse(new TextDecoder().decode(found)).packages;
  python = await loadPyodide({
    indexURL: here("pyodide/"),
    packageBaseUrl: here("pyodide/"),
    lockFileURL: lock,
    convertNullToNone: true,
  });
  await python.loadPackage(["numpy", "ddlib"], quiet);
  python.FS.mkdirTree("/book/data");
  python.FS.chdir("/book"); // where a notebook of the book runs
  [...MODULES, ...data].forEach((path, k) =>
    python.FS.writeFile(`/book/${path}`, new Uint8Array(files[k])),
  );
  python.runPython("import sys; sys.path.insert(0, '/book'); import absent; absent.start()");
  kernel = python.pyimport("kernel");
}

const quiet = { messageCallback() {}, errorCallback() {} };

// Get the package in which a module lies, once; whether there is one.
const asked = new Set();
async function get(module) {
  if (asked.has(module)) return false;
  asked.add(module);
  if (module === "workshop" || module === "beyond") {
    python.unpackArchive(await file("workshop.zip"), "zip", { extractDir: "/book" });
    return true;
  }
  const name = Object.keys(packages).find((key) => packages[key].imports.includes(module));
  if (!name) return false;
  await python.loadPackage(name, quiet);
  return true;
}

self.onmessage = async ({ data: { start: data, run, source } }) => {
  try {
    if (data) {
      await start(data);
      return tell({ ready: true });
    }
    const began = performance.now();
    const ok = await kernel.run(source, run, (kind, text) => tell({ run, kind, text }), get);
    tell({ run, done: true, ok, seconds: (performance.now() - began) / 1000 });
  } catch (error) {
    tell({ failed: `${error.message ?? error}` });
  }
};
