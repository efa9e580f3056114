// Shows a CurveWidget (base.py): sliders, an optional pad, charts. Interpolates baked curves;
// with a kernel the exact ones replace them when they come.

const SVG = "http://www.w3.org/2000/svg";
const SVG_TAGS = new Set(["svg", "g", "path", "line", "text", "rect", "circle", "polygon"]);
const PATIENCE = 2000; // ms to wait for a kernel
const extras = []; // functions of the view, for widgets with more to show

function make(tag, attributes = {}, ...children) {
  const el = SVG_TAGS.has(tag) ? document.createElementNS(SVG, tag) : document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) el.setAttribute(name, value);
  el.append(...children);
  return el;
}

// --- numbers

function crc32(bytes) {
  let crc = ~0;
  for (const byte of bytes) {
    crc ^= byte;
    for (let k = 0; k < 8; k++) crc = (crc >>> 1) ^ (0xedb88320 & -(crc & 1));
  }
  return ~crc >>> 0;
}

// The baked table, or an error that says what is wrong with it.
export function readTable(spec, view) {
  if (!spec?.parameters?.length || !spec.curves?.length) throw new Error("no description");
  const samples = spec.curves.reduce((sum, curve) => sum + curve.length, 0);
  const wanted = 2 * spec.parameters.reduce((product, p) => product * p.grid, samples);
  const bytes = new Uint8Array(view.buffer, view.byteOffset, view.byteLength);
  if (bytes.length !== wanted) throw new Error(`${bytes.length} bytes in place of ${wanted}`);
  if (crc32(bytes) !== spec.checksum) throw new Error("the checksum is wrong");
  return Int16Array.from({ length: wanted / 2 }, (_, i) => view.getInt16(2 * i, true));
}

export const toFraction = (p, value) =>
  p.scale === "log"
    ? Math.log(value / p.low) / Math.log(p.high / p.low)
    : (value - p.low) / (p.high - p.low);

export function fromFraction(p, fraction) {
  const value =
    p.scale === "log"
      ? p.low * (p.high / p.low) ** fraction
      : p.low + (p.high - p.low) * fraction;
  return Math.min(p.high, Math.max(p.low, value));
}

// Grid points and weights, as Parameter.weights in baked.py.
export function weights(p, value, cubic) {
  const position = toFraction(p, value) * (p.grid - 1);
  const i = Math.min(Math.max(Math.trunc(position), 0), p.grid - 2);
  const f = position - i;
  if (!cubic || p.grid === 2) return [[i, 1 - f], [i + 1, f]];
  const [a, b, c, d] = [
    (((2 - f) * f - 1) * f) / 2,
    ((3 * f - 5) * f * f + 2) / 2,
    (((4 - 3 * f) * f + 1) * f) / 2,
    ((f - 1) * f * f) / 2,
  ];
  if (i === 0) return [[0, b + 3 * a], [1, c - 3 * a], [2, d + a]];
  if (i === p.grid - 2) return [[i - 1, a + d], [i, b - 3 * d], [i + 1, c + 3 * d]];
  return [[i - 1, a], [i, b], [i + 1, c], [i + 2, d]];
}

// All curves, one after the other, at one value per parameter.
export function interpolate(spec, table, values) {
  let corners = [[0, 1]];
  spec.parameters.forEach((p, k) => {
    const points = weights(p, values[k], spec.cubic);
    corners = corners.flatMap(([row, w]) => points.map(([i, u]) => [row * p.grid + i, w * u]));
  });
  const samples = spec.curves.reduce((sum, curve) => sum + curve.length, 0);
  const out = new Float64Array(samples);
  for (const [row, w] of corners) {
    for (let s = 0, at = row * samples; s < samples; s++) out[s] += w * table[at + s];
  }
  let s = 0;
  for (const { length, low, high } of spec.curves) {
    const [middle, step] = [(low + high) / 2, (high - low) / 65534];
    for (const end = s + length; s < end; s++) out[s] = middle + step * out[s];
  }
  return out;
}

// Cut into named curves.
export function split(spec, flat) {
  let start = 0;
  return Object.fromEntries(
    spec.curves.map(({ name, length }) => [name, flat.subarray(start, (start += length))]),
  );
}

export function insidePolygon(corners, x, y) {
  const sides = corners.map(([x0, y0], k) => {
    const [x1, y1] = corners[(k + 1) % corners.length];
    return (x1 - x0) * (y - y0) - (y1 - y0) * (x - x0);
  });
  return sides.every((s) => s >= -1e-9) || sides.every((s) => s <= 1e-9);
}

export function ticks(low, high, count) {
  const rough = (high - low) / count;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = power * [1, 2, 2.5, 5, 10].find((m) => m * power >= rough * 0.999);
  const first = Math.ceil(low / step - 1e-9);
  const last = Math.floor(high / step + 1e-9);
  return Array.from({ length: last - first + 1 }, (_, i) => (first + i) * step);
}

const short = (x) => String(Number(x.toPrecision(6))).replace("-", "−");

// A value with the digits that its range deserves.
export function format(value, low, high, unit = "") {
  const size = Math.log10(high - low || Math.abs(high) || 1);
  const digits = Math.min(6, Math.max(0, 2 - Math.floor(size)));
  const fixed = value.toFixed(digits).replace(/^-(?=[0.]*$)/, "").replace("-", "−");
  return unit ? `${fixed}${unit === "°" ? "" : "\u00a0"}${unit}` : fixed;
}

const show = (p, value) =>
  p.scale === "log" ? format(value, 0, value, p.unit) : format(value, p.low, p.high, p.unit);

// --- charts

function axis(low, high, scale, from, to, room) {
  const log = scale === "log";
  const [a, b] = log ? [Math.log10(low), Math.log10(high)] : [low, high];
  const place = (x) => from + (((log ? Math.log10(x) : x) - a) / (b - a)) * (to - from);
  let marks = ticks(a, b, Math.max(2, Math.floor(Math.abs(to - from) / room)));
  if (log) marks = marks.filter(Number.isInteger).map((x) => 10 ** x);
  return { place, marks };
}

function chart(view, panel) {
  const names = Object.keys(panel.curves);
  const ranges = view.spec.curves.filter((curve) => names.includes(curve.name));
  let low = Math.min(...ranges.map((r) => r.low));
  let high = Math.max(...ranges.map((r) => r.high));
  const log = panel.y_scale === "log";
  const margin = log ? 0 : 0.04 * (high - low || Math.abs(high) || 1);
  [low, high] = [low - margin, high + margin];
  if (log) low = Math.max(low, high * 1e-12);
  const grid = make("g", { class: "grid" });
  const cursor = make("line", { class: "cursor", visibility: "hidden" });
  const paths = names.map((_, k) => make("path", { class: `curve c${k % 6}` }));
  const svg = make("svg", { role: "img" }, grid, cursor, ...paths);
  const legend = make("div", { class: "legend" });
  names.forEach((name, k) => {
    const line = make("path", { class: `curve c${k % 6}`, d: "M0 5H26" });
    const swatch = make("svg", { width: 26, height: 10, "aria-hidden": "true" }, line);
    if (names.length > 1) legend.append(make("span", {}, swatch, panel.curves[name]));
  });
  const title = make("div", { class: "title" }, panel.y_label);
  const el = make("div", { class: "chart" }, title, legend, svg);
  let x, y, width, height;

  function resize() {
    width = Math.max(160, Math.floor(el.clientWidth));
    height = Math.round(Math.min(230, Math.max(150, width * 0.6)));
    for (const [name, value] of [["width", width], ["height", height]]) svg.setAttribute(name, value);
    const bottom = height - 36;
    y = axis(low, high, panel.y_scale, bottom, 6, 30);
    const left = 10 + 6.6 * Math.max(...y.marks.map((v) => short(v).length));
    x = axis(panel.x[0], panel.x.at(-1), panel.x_scale, left, width - 10, 52);
    grid.replaceChildren(
      ...y.marks.flatMap((v) => {
        const at = y.place(v).toFixed(1);
        const label = make("text", { x: left - 6, y: at, dy: "0.34em", class: "y" }, short(v));
        return [make("line", { x1: left, x2: width - 10, y1: at, y2: at }), label];
      }),
      ...x.marks.map((v) =>
        make("text", { x: x.place(v).toFixed(1), y: bottom + 16, class: "x" }, short(v)),
      ),
      make("path", { class: "frame", d: `M${left} 6V${bottom}H${width - 10}` }),
      make("text", { x: (left + width - 10) / 2, y: height - 3, class: "x" }, panel.x_label),
    );
    cursor.setAttribute("y1", 6);
    cursor.setAttribute("y2", bottom);
  }

  function redraw(curves) {
    names.forEach((name, k) => {
      let d = "";
      curves[name].forEach((value, i) => {
        const v = log ? Math.max(value, low) : value;
        d += `${i ? "L" : "M"}${x.place(panel.x[i]).toFixed(1)} ${y.place(v).toFixed(2)}`;
      });
      paths[k].setAttribute("d", d);
    });
  }

  function describe(curves) {
    const parts = names.map((name) => {
      const { low: l, high: h } = ranges.find((r) => r.name === name);
      const [min, max] = [Math.min(...curves[name]), Math.max(...curves[name])];
      return `${panel.curves[name]} from ${format(min, l, h)} to ${format(max, l, h)}`;
    });
    svg.setAttribute("aria-label", `${panel.y_label} over ${panel.x_label}: ${parts.join("; ")}`);
  }

  function point(at) {
    cursor.setAttribute("visibility", "visible");
    for (const end of ["x1", "x2"]) cursor.setAttribute(end, x.place(at).toFixed(1));
  }
  return { el, panel, resize, redraw, describe, point };
}

// --- controls

function slider(view, p, k) {
  const id = `${view.id}-${p.name}`;
  const output = make("output", { for: id });
  const input = make("input", { id, type: "range", min: 0, max: 1, step: 0.005 });
  input.addEventListener("input", () => view.set({ [k]: fromFraction(p, Number(input.value)) }));
  const update = () => {
    output.textContent = show(p, view.values[k]);
    input.value = toFraction(p, view.values[k]);
    input.setAttribute("aria-valuetext", output.textContent);
  };
  const el = make("div", { class: "slider" }, make("label", { for: id }, p.label), output, input);
  return { el, update };
}

const SHAPES = ["M-5 0a5 5 0 1 0 10 0a5 5 0 1 0-10 0", "M-5-5H5V5H-5Z", "M0-6L6 5H-6Z"];

function padOf(view) {
  const { pad, parameters } = view.spec;
  const [i, j] = [pad.x, pad.y].map((name) => parameters.findIndex((p) => p.name === name));
  const [px, py] = [parameters[i], parameters[j]];
  const [size, left, top] = [220, 46, 12];
  const x = (v) => left + size * toFraction(px, v);
  const y = (v) => top + size * (1 - toFraction(py, v));
  const frame = make("rect", { x: left, y: top, width: size, height: size, class: "frame" });
  const region = pad.region.map(([a, b]) => `${x(a)},${y(b)}`).join(" ");
  const groups = [...new Set(pad.marks.map((mark) => mark.group))];
  const shape = (group) => {
    const k = groups.indexOf(group);
    return { d: SHAPES[k % SHAPES.length], class: `mark c${k % 6}` };
  };
  const handle = make("g", { class: "handle" }, make("circle", { r: 10 }), make("circle", { r: 2 }));
  const name = (p) => `${p.label}${p.unit ? `, ${p.unit}` : ""}`;
  const label = `${px.label} to the right, ${py.label} upwards; arrow keys move, with Shift faster`;
  const middle = top + size / 2;
  const svg = make(
    "svg",
    { viewBox: `0 0 ${left + size + 14} ${top + size + 40}`, class: "pad", tabindex: 0 },
    frame,
    make("polygon", { points: region, class: "region" }),
    ...ticks(px.low, px.high, 3).map((v) =>
      make("text", { x: x(v), y: top + size + 16, class: "x" }, short(v)),
    ),
    ...ticks(py.low, py.high, 3).map((v) =>
      make("text", { x: left - 6, y: y(v), dy: "0.34em", class: "y" }, short(v)),
    ),
    make("text", { x: left + size / 2, y: top + size + 34, class: "x" }, name(px)),
    make("text", { transform: `translate(12 ${middle}) rotate(-90)`, class: "x" }, name(py)),
    ...pad.marks.map((mark) => {
      const inward = toFraction(px, mark.x) > 0.9 ? -11 : 11;
      const up = toFraction(py, mark.y) > 0.9 ? 14 : -8;
      const text = { x: inward, y: up, class: "x" };
      const place = `translate(${x(mark.x)} ${y(mark.y)})`;
      return make("g", { transform: place }, make("path", shape(mark.group)), make("text", text, mark.label));
    }),
    handle,
  );
  svg.setAttribute("role", "application");
  svg.setAttribute("aria-roledescription", "two-dimensional slider");

  const move = (fx, fy) => view.set({ [i]: fromFraction(px, fx), [j]: fromFraction(py, fy) });
  const drag = (event) => {
    const box = frame.getBoundingClientRect();
    move((event.clientX - box.left) / box.width, 1 - (event.clientY - box.top) / box.height);
  };
  svg.addEventListener("pointerdown", (event) => {
    if (event.button) return;
    svg.setPointerCapture(event.pointerId);
    svg.focus({ preventScroll: true });
    drag(event);
  });
  svg.addEventListener("pointermove", (event) => {
    if (svg.hasPointerCapture(event.pointerId)) drag(event);
  });
  svg.addEventListener("keydown", (event) => {
    const arrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowDown: [0, -1], ArrowUp: [0, 1] };
    const way = arrows[event.key];
    if (!way || event.ctrlKey || event.altKey || event.metaKey) return;
    event.preventDefault();
    event.stopPropagation(); // a notebook has its own arrow keys
    const step = event.shiftKey ? 0.1 : 0.01;
    const at = [toFraction(px, view.values[i]), toFraction(py, view.values[j])];
    move(at[0] + step * way[0], at[1] + step * way[1]);
  });

  const legend = make("div", { class: "legend" });
  const key = (attributes, text) => {
    const path = make("path", { transform: "translate(7 7)", ...attributes });
    const icon = make("svg", { width: 14, height: 14, "aria-hidden": "true" }, path);
    legend.append(make("span", {}, icon, text));
  };
  for (const group of groups) key(shape(group), group);
  if (region) key({ d: "M-7-5H7V5H-7Z", class: "region" }, pad.region_label);
  const update = () => {
    handle.setAttribute("transform", `translate(${x(view.values[i])} ${y(view.values[j])})`);
    const now = `${show(px, view.values[i])}, ${show(py, view.values[j])}`;
    svg.setAttribute("aria-label", `${label}. Now ${now}`);
  };
  return { el: make("div", { class: "pad-box" }, svg, legend), update };
}
