// Python in a worker of its own: the page stays quick.
import { unpack, unzipped } from "./packs.mjs";
import { loadPyodide } from "./pyodide/pyodide.mjs";

const here = (path) => new URL(path, import.meta.url).href;
const tell = (message) => self.postMessage(message);

// All that Pyodide fetches is counted as it comes, for the progress bar.
const usual = self.fetch.bind(self);
self.fetch = async (...request) => {
  const answer = await usual(...request);
  if (!answer.ok || !answer.body) return answer;
  if (answer.url.endsWith(".wasm")) {
    tell({ bytes: Number(answer.headers.get("Content-Length")) });
    return answer; // as it came: a browser keeps what it compiles of that, for the next page
  }
  const count = new TransformStream({
    transform(chunk, out) {
      tell({ bytes: chunk.byteLength });
      out.enqueue(chunk);
    },
  });
  const { headers, status } = answer;
  return new Response(answer.body.pipeThrough(count), { headers, status });
};

// While it lives it holds a lock. The page waits for that, and knows at once if the worker is no more.
const life = `live-${Math.random()}`;
self.navigator.locks?.request(life, () => {
  tell({ lives: life });
  return new Promise(() => {});
});

// Modules of this site that stand in for others.
const INSTEAD = ["torch", "anywidget", "ipywidgets", "IPython"];
const instead = (module) => `instead/${module}.py`;
const MODULES = ["names.py", "kernel.py", ...INSTEAD.map(instead)];
let python, kernel, packages;

async function asked(path) {
  const answer = await fetch(here(path));
  if (!answer.ok) throw new Error(`${path} is missing on this site (${answer.status})`);
  return answer;
}
const file = async (path) => (await asked(path)).arrayBuffer();

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

async function start({ start: data, ahead }) {
  const started = asked("pyodide/started.gz").then(unzipped);
  const lock = await (await asked("pyodide/pyodide-lock.json")).json();
  packages = lock.packages;
  for (const name of ["numpy", "ddlib", ...ahead]) come(name);
  const files = Promise.all([...MODULES, ...data].map(file));
  python = await loadPyodide({
    indexURL: here("pyodide/"),
    packageBaseUrl: here("pyodide/"),
    lockFileContents: lock,
    convertNullToNone: true,
    _loadSnapshot: started,
  });
  await load(["numpy", "ddlib"]);
  for (const folder of ["data", "instead"]) python.FS.mkdirTree(`/book/${folder}`);
  python.FS.chdir("/book"); // where a notebook of the book runs
  const content = await files;
  [...MODULES, ...data].forEach((path, k) =>
    python.FS.writeFile(`/book/${path}`, new Uint8Array(content[k])),
  );
  python.runPython("import sys; sys.path.insert(0, '/book')");
  shut();
  kernel = python.pyimport("kernel");
  kernel.start();
  kernel.page = (text, buffers) => tell({ widget: JSON.parse(text), buffers: buffers.toJs() });
}

// Packages come all at once, in the order of the page's imports, while Python starts and cells run.
const coming = new Map();
function come(name) {
  if (!coming.has(name)) coming.set(name, asked(`pyodide/${packages[name].file_name}`).then(unzipped));
  coming.get(name).catch(() => coming.delete(name)); // it is asked for again by the cell that needs it
  return coming.get(name);
}

// Put packages with all that they depend on where Python finds them.
const there = new Set();
async function load(names) {
  for (const name of names) {
    if (there.has(name)) continue;
    there.add(name);
    const { depends, install_dir } = packages[name];
    await load(depends);
    const root = install_dir === "site" ? python._api.sitePackages : install_dir;
    try {
      await unpack(python, root, await come(name));
    } catch (error) {
      there.delete(name);
      throw new Error(`a package did not come whole (${name}: ${error.message})`);
    }
    coming.delete(name);
  }
}

// Get the package in which a module lies, once; whether there is one.
const wanted = new Set();
const refused = new Set(); // those that did not come, until the next cell
let now; // the cell that runs
async function get(module) {
  if (wanted.has(module) || refused.has(module)) return false;
  if (INSTEAD.includes(module)) {
    wanted.add(module);
    python.FS.rename(`/book/${instead(module)}`, `/book/${module}.py`);
    return true;
  }
  const name = Object.keys(packages).find((key) => packages[key].imports.includes(module));
  if (!name) return false;
  try {
    await load([name]);
    wanted.add(module);
    return true;
  } catch (error) {
    // there is no network: the cell says so, and Python goes on
    refused.add(module);
    tell({ run: now, kind: "warning", text: `${error.message}\n` });
    return false;
  }
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
      await start(message);
      pick(message.picked);
      if (interrupts) python.setInterruptBuffer(interrupts);
      return tell({ ready: true });
    }
    if (!run) return pick(message.picked);
    now = run;
    refused.clear();
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
