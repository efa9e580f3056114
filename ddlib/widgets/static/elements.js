// Elements of a page, for every widget that draws.

const SVG = "http://www.w3.org/2000/svg";
const SVG_TAGS = new Set(
  "svg g path line text rect circle polygon polyline defs clipPath title".split(" "),
);

// An element with attributes and children, SVG or HTML by its name.
export function make(tag, attributes = {}, ...children) {
  const el = SVG_TAGS.has(tag) ? document.createElementNS(SVG, tag) : document.createElement(tag);
  put(el, attributes);
  el.append(...children);
  return el;
}

export function put(el, attributes) {
  for (const [name, value] of Object.entries(attributes)) el.setAttribute(name, value);
}

export function buttonOf(text, act, attributes = {}) {
  const el = make("button", { type: "button", ...attributes }, text);
  el.addEventListener("click", act);
  return el;
}

// A table with a caption, from texts.
export function tableOf(caption, heads, rows) {
  const cells = (kind, texts) => make("tr", {}, ...texts.map((text) => make(kind, {}, text)));
  const body = make("tbody", {}, ...rows.map((row) => cells("td", row)));
  return make("table", {}, make("caption", {}, caption), make("thead", {}, cells("th", heads)), body);
}

// The sample of a line, stem or bar in a legend; `c` are classes of its colour and its dash.
export function swatch(kind, c) {
  const samples = {
    line: [{ class: `curve ${c}`, d: "M0 5H26" }],
    stems: [{ class: `curve stem ${c}`, d: "M13 10V2" }, { class: `curve dots ${c}`, d: "M13 3h0" }],
    bars: [{ class: `curve bar ${c}`, d: "M8 10V0H18V10Z" }],
  };
  const paths = samples[kind].map((attributes) => make("path", attributes));
  return make("svg", { width: 26, height: 10, "aria-hidden": "true" }, ...paths);
}

// Text in an element; the same text again would lay it out again.
export function write(el, text) {
  if (el.textContent !== text) el.textContent = text;
}

// A number for a path, to hundredths of a pixel; quicker than toFixed.
export const short = (x) => Math.round(x * 100) / 100;

// Keys pressed on an element: `act(event)` returns false for those that it leaves alone.
export function onKeys(el, act) {
  el.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.altKey || event.metaKey || act(event) === false) return;
    event.preventDefault();
    event.stopPropagation(); // a notebook has its own arrow keys
  });
}

// The element of a widget, by its kind and its name for screen readers. In JupyterLab the keys are
// the handle's that has the focus, not the notebook's: else an arrow would move or fold a cell.
export function dress(el, label, ...kinds) {
  el.addEventListener("focusin", ({ target }) => {
    target.dataset.lmSuppressShortcuts = "true"; // the focused element alone is asked
  });
  el.classList.add("ddlib-widget", "ddlib-curves", ...kinds);
  put(el, { role: "group", "aria-label": label });
}

// What the ids of a widget's elements begin with.
export const freshId = () => `dd${Math.random().toString(36).slice(2, 10)}`;

const SIZES = { Float64: 8, Float32: 4, Int16: 2, Uint16: 2 };

// The little-endian numbers in the bytes of a trait.
export function numbersOf(bytes, kind) {
  if (!bytes?.buffer) throw new Error("bytes are missing");
  const data = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const length = Math.floor(data.byteLength / SIZES[kind]);
  return Float64Array.from({ length }, (_, i) => data[`get${kind}`](SIZES[kind] * i, true));
}

// Calls when the page changes its colours; returns a function that ends this.
export function onRecolour(callback) {
  const themes = new MutationObserver(callback);
  for (const root of [document.documentElement, document.body]) {
    themes.observe(root, { attributes: true, attributeFilter: ["data-theme", "data-jp-theme-light"] });
  }
  const media = ["(prefers-color-scheme: dark)", "print"].map((query) => matchMedia(query));
  media.forEach((list) => list.addEventListener("change", callback));
  return () => {
    themes.disconnect();
    media.forEach((list) => list.removeEventListener("change", callback));
  };
}

// Says in place of a figure what is wrong with it.
export function report(el, error) {
  el.className = "ddlib-widget-error";
  el.setAttribute("role", "alert");
  el.removeAttribute("aria-label");
  el.textContent = `The data of this interactive figure are damaged: ${error.message}.`;
}

// `build` as a script's `render`.
export function safely(build) {
  return ({ model, el }) => {
    try {
      return build({ model, el });
    } catch (error) {
      report(el, error);
    }
  };
}
