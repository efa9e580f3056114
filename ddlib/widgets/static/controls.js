// Sliders, menus, switches, presets and the pad.

import { besideOf, draggable } from "./dragging.js";
import { buttonOf, make, onKeys, put, write } from "./elements.js";
import { labels } from "./numbers.js";
import { fromFraction, fullTicks, indexOf, show, stepsOf, toFraction } from "./parameters.js";

export function slider(view, p, k) {
  const id = `${view.id}-${p.name}`;
  const output = make("output", { for: id });
  const steps = stepsOf(p, view.stepped);
  const input = make("input", { id, type: "range", min: 0, max: steps, step: 1 });
  input.addEventListener("input", () => view.set({ [k]: fromFraction(p, input.value / steps) }));
  const update = () => {
    write(output, show(p, view.values[k]));
    input.value = steps * toFraction(p, view.values[k]);
    input.setAttribute("aria-valuetext", output.textContent);
  };
  const el = make("div", { class: "slider" }, make("label", { for: id }, p.label), output, input);
  return { el, update };
}

// A discrete parameter: a menu, a switch, or a slider that steps over the options.
export function choice(view, p, k) {
  const id = `${view.id}-${p.name}`;
  const set = (index) => view.set({ [k]: p.options[index][0] });
  const now = () => indexOf(p, view.values[k]);
  const label = make("label", { for: id }, p.label);
  const output = make("output", { for: id });
  let input;
  if (p.display === "menu") {
    const options = p.options.map(([, text], i) => make("option", { value: i }, text));
    input = make("select", { id }, ...options);
    input.addEventListener("change", () => set(input.selectedIndex));
  } else if (p.display === "switch") {
    input = make("input", { id, type: "checkbox", role: "switch" });
    input.addEventListener("change", () => set(Number(input.checked)));
  } else {
    input = make("input", { id, type: "range", min: 0, max: p.options.length - 1, step: 1 });
    input.addEventListener("input", () => set(Number(input.value)));
  }
  const update = () => {
    if (p.display === "menu") input.selectedIndex = now();
    if (p.display === "switch") input.checked = now() === 1;
    if (p.display === "slider") {
      input.value = now();
      input.setAttribute("aria-valuetext", show(p, view.values[k]));
    }
    write(output, show(p, view.values[k]));
  };
  const order = { menu: [label, input], switch: [input, label, output], slider: [label, output, input] };
  return { el: make("div", { class: `${p.display} choice` }, ...order[p.display]), update };
}

// Buttons that set several parameters at once; pressed where they stand so.
export function presetsOf(view) {
  const { title, options } = view.spec.presets;
  const buttons = options.map(([label, values]) => buttonOf(label, () => view.set(values)));
  const near = (name, value) => view.near(view.parameter(name), value);
  const update = () => {
    options.forEach(([, values], i) => {
      const stands = Object.entries(values).every(([name, value]) => view.get(name) === near(name, value));
      buttons[i].setAttribute("aria-pressed", String(stands));
    });
  };
  const words = { class: "presets", role: "group", "aria-label": title };
  const heading = make("span", { "aria-hidden": "true" }, title);
  return { el: make("div", words, heading, ...buttons), update };
}

const SHAPES = [
  "M-5 0a5 5 0 1 0 10 0a5 5 0 1 0-10 0",
  "M-5-5H5V5H-5Z",
  "M0-6L6 5H-6Z",
  "M0-6L6 0L0 6L-6 0Z",
];

const WAYS = {
  ArrowLeft: [-1, 0],
  ArrowRight: [1, 0],
  ArrowDown: [0, -1],
  ArrowUp: [0, 1],
  Home: [-1, 0],
  End: [1, 0],
  PageDown: [0, -1],
  PageUp: [0, 1],
};

export function padOf(view) {
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
    const { look } = pad.marks.find((mark) => mark.group === group);
    return { d: SHAPES[k % SHAPES.length], class: `mark ${look}` };
  };
  const under = make("g", { class: "under" }); // for a subclass
  const handle = make("g", { class: "handle" }, make("circle", { r: 10 }), make("circle", { r: 2 }));
  const name = (p) => `${p.label}${p.unit ? `, ${p.unit}` : ""}`;
  const label =
    `${px.label} to the right, ${py.label} upwards; arrow keys move, with Shift faster, ` +
    "Home, End, Page Up and Page Down go to the edges";
  const middle = top + size / 2;
  const numbers = (p, attributes) => {
    const texts = labels(fullTicks(p), p.scale === "log");
    return fullTicks(p).map((v, k) => make("text", attributes(v), texts[k]));
  };
  const svg = make(
    "svg",
    { viewBox: `0 0 ${left + size + 14} ${top + size + 40}`, class: "pad", tabindex: 0 },
    frame,
    under,
    make("polygon", { points: region, class: "region" }),
    ...numbers(px, (v) => ({ x: x(v), y: top + size + 16, class: "x" })),
    ...numbers(py, (v) => ({ x: left - 6, y: y(v), dy: "0.34em", class: "y" })),
    make("text", { x: left + size / 2, y: top + size + 34, class: "x" }, name(px)),
    make("text", { transform: `translate(12 ${middle}) rotate(-90)`, class: "x" }, name(py)),
    ...pad.marks.map((mark) => {
      const inward = toFraction(px, mark.x) > 0.9 ? -13 : 13;
      const up = toFraction(py, mark.y) > 0.9 ? 18 : -9;
      const text = { x: inward, y: up, class: "x" };
      const place = `translate(${x(mark.x)} ${y(mark.y)})`;
      return make("g", { transform: place }, make("path", shape(mark.group)), make("text", text, mark.label));
    }),
    handle,
  );
  put(svg, { role: "application", "aria-roledescription": "two-dimensional slider" });

  const move = (fx, fy) => view.set({ [i]: fromFraction(px, fx), [j]: fromFraction(py, fy) });
  const away = (mark, fx, fy) => Math.hypot(toFraction(px, mark.x) - fx, toFraction(py, mark.y) - fy);
  const drag = (event) => {
    const box = frame.getBoundingClientRect();
    const at = [(event.clientX - box.left) / box.width, 1 - (event.clientY - box.top) / box.height];
    const near = pad.marks.find((mark) => away(mark, ...at) < pad.snap);
    if (near) view.set({ [i]: near.x, [j]: near.y });
    else move(...at);
  };
  draggable(svg, besideOf(handle), drag);
  onKeys(svg, (event) => {
    const way = WAYS[event.key];
    if (!way) return false;
    const [fx, fy] = [toFraction(px, view.values[i]), toFraction(py, view.values[j])];
    const count = event.key.startsWith("Arrow") ? (event.shiftKey ? 10 : 1) : 1e6; // or to the edge
    const along = (p, step) => (count * step) / stepsOf(p, view.stepped);
    move(fx + along(px, way[0]), fy + along(py, way[1]));
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
  view.pad = { svg, under, legend, frame: { left, top, size } };
  return { el: make("div", { class: "pad-box" }, svg, legend), update };
}

