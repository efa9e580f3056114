// Python in a worker of its own: the page stays quick.
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

// While it lives it holds a lock. The page waits for that, and knows at once if the worker is no more.
const life = `live-${Math.random()}`;
self.navigator.locks?.request(life, () => {
  tell({ lives: life });
  return new Promise(() => {});
});

const MODULES = ["names.py", "kernel.py"];
// Modules of this site that stand in for others.
const INSTEAD = ["torch", "anywidget", "ipywidgets", "IPython"];
let python, kernel, packages;

async function file(path) {
  const answer = await fetch(here(path));
  if (!answer.ok) throw new Error(`${path} is missing on this site (${answer.status})`);
  return answer.arrayBuffer();
}

// Extents that the reader kept lie in a file, as beside a notebook (ddlib/trajectories.py); the
// page has its text from lesson to lesson.
const KEPT_IN = "/book/picked-extents.json";
let picked = "";
const pickedNow = () =>
  python.FS.analyzePath(KEPT_IN).exists ? python.FS.readFile(KEPT_IN, { encoding: "utf8" }) : "";
function pick(text = "") {
  picked = text;
  if (text) python.FS.writeFile(KEPT_IN, text);
  else if (pickedNow()) python.FS.unlink(KEPT_IN);
}

// Cells have no way to what other pages of this site's address keep.
function shut() {
  const gone = { indexedDB: self, caches: self, BroadcastChannel: self, Worker: self, storage: self.navigator };
  for (const [name, holder] of Object.entries(gone))
    for (let at = holder; at; at = Object.getPrototypeOf(at)) delete at[name];
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
  await load(["numpy", "ddlib"]);
  python.FS.mkdirTree("/book/data");
  python.FS.chdir("/book"); // where a notebook of the book runs
  [...MODULES, ...data].forEach((path, k) =>
    python.FS.writeFile(`/book/${path}`, new Uint8Array(files[k])),
  );
  python.runPython("import sys; sys.path.insert(0, '/book')");
  shut();
  kernel = python.pyimport("kernel");
  kernel.start();
  kernel.page = (text, buffers) => tell({ widget: JSON.parse(text), buffers: buffers.toJs() });
}

// Packages, by their hashes in the lock. Pyodide itself only writes down which of them it refused.
async function load(names) {
  const refused = [];
  const errorCallback = (text) => refused.push(text);
  await python.loadPackage(names, { messageCallback() {}, errorCallback });
  if (refused.length) throw new Error(`a package did not come whole (${refused[0].split("\n")[0]})`);
}

// Get the package in which a module lies, once; whether there is one.
const asked = new Set();
async function get(module) {
  if (asked.has(module)) return false;
  asked.add(module);
  if (INSTEAD.includes(module)) {
    python.FS.writeFile(`/book/${module}.py`, new Uint8Array(await file(`instead/${module}.py`)));
    return true;
  }
  if (module === "workshop" || module === "beyond") {
    python.unpackArchive(await file("workshop.zip"), "zip", { extractDir: "/book" });
    return true;
  }
  const name = Object.keys(packages).find((key) => packages[key].imports.includes(module));
  if (!name) return false;
  await load(name);
  return true;
}

// One message after the other, also where Python waits for a package.
let last = Promise.resolve();
self.onmessage = ({ data }) => (last = last.then(() => act(data)));

async function act(message) {
  const { start: data, interrupts, run, source, above, how, widget, buffers, forms, path } = message;
  try {
    if (forms) return kernel.forms((cell, number, text) => tell({ form: cell, number, text }));
    if (path) {
      const parts = kernel.parts(path, message.imported, python.toPy(above));
      return tell({ parts: JSON.parse(parts) });
    }
    if (widget) {
      const names = JSON.parse(kernel.heard(widget, buffers));
      return names.length && tell({ kind: "moved", names });
    }
    if (data) {
      await start(data);
      pick(message.picked);
      if (interrupts) python.setInterruptBuffer(interrupts);
      return tell({ ready: true });
    }
    if (!run) return pick(message.picked);
    const began = performance.now();
    const show = (kind, text) => tell({ run, kind, text });
    const ok = await kernel.run.callKwargs(source, run, show, get, {
      above: python.toPy(above ?? null),
      ...how,
    });
    if (pickedNow() !== picked) tell({ picked: (picked = pickedNow()) });
    tell({ run, done: true, ok, seconds: (performance.now() - began) / 1000 });
  } catch (error) {
    if (run && error.type === "KeyboardInterrupt") {
      tell({ run, kind: "stopped", text: "" });
      return tell({ run, done: true, ok: false, seconds: 0 });
    }
    tell({ failed: `${error.message ?? error}` });
  }
}
