// Shows a CurveWidget (base.py): sliders, an optional pad, charts. Follows baked.js in the
// widget's module. With a kernel the exact curves replace the interpolated ones.

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

// --- charts

function axis(low, high, scale, from, to, room) {
  const log = scale === "log";
  const [a, b] = log ? [Math.log10(low), Math.log10(high)] : [low, high];
  const place = (x) => from + (((log ? Math.log10(x) : x) - a) / (b - a)) * (to - from);
  let marks = ticks(a, b, Math.max(2, Math.floor(Math.abs(to - from) / room)));
  if (log) marks = marks.filter(Number.isInteger).map((x) => 10 ** x);
  return { place, marks, texts: labels(marks, log) };
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
    const left = 10 + 6.6 * Math.max(...y.texts.map((text) => text.length));
    x = axis(panel.x[0], panel.x.at(-1), panel.x_scale, left, width - 10, 52);
    grid.replaceChildren(
      ...y.marks.flatMap((v, i) => {
        const at = y.place(v).toFixed(2);
        const label = make("text", { x: left - 6, y: at, dy: "0.34em", class: "y" }, y.texts[i]);
        return [make("line", { x1: left, x2: width - 10, y1: at, y2: at }), label];
      }),
      ...x.marks.map((v, i) =>
        make("text", { x: x.place(v).toFixed(1), y: bottom + 16, class: "x" }, x.texts[i]),
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
  const steps = Math.round(1 / stepOf(p));
  const input = make("input", { id, type: "range", min: 0, max: steps, step: 1 });
  input.addEventListener("input", () => view.set({ [k]: fromFraction(p, input.value / steps) }));
  const update = () => {
    output.textContent = show(p, view.values[k]);
    input.value = steps * toFraction(p, view.values[k]);
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
  const numbers = (p, attributes) => {
    const texts = labels(fullTicks(p), p.scale === "log");
    return fullTicks(p).map((v, k) => make("text", attributes(v), texts[k]));
  };
  const svg = make(
    "svg",
    { viewBox: `0 0 ${left + size + 14} ${top + size + 40}`, class: "pad", tabindex: 0 },
    frame,
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
    const [fx, fy] = [toFraction(px, view.values[i]), toFraction(py, view.values[j])];
    const steps = event.shiftKey ? 10 : 1;
    move(fx + steps * stepOf(px) * way[0], fy + steps * stepOf(py) * way[1]);
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

// --- the whole figure

function build({ model, el }) {
  const spec = model.get("spec");
  const view = { model, el, spec, id: `dd${Math.random().toString(36).slice(2, 10)}` };
  const table = readTable(spec, model.get("baked"));
  const names = spec.parameters.map((p) => p.name);
  view.values = names.map((name) => model.get(name));
  el.classList.add("ddlib-widget", "ddlib-curves");
  el.setAttribute("role", "group");
  el.setAttribute("aria-label", spec.title);

  view.charts = spec.panels.map((panel) => chart(view, panel));
  const controls = spec.parameters.map((p, k) => slider(view, p, k));
  const pad = spec.pad && padOf(view);
  view.controls = make("div", { class: "controls" }, ...controls.map((control) => control.el));
  view.top = make("div", { class: "top" }, ...(pad ? [pad.el] : []), view.controls);
  const charts = make("div", { class: "charts" }, ...view.charts.map((c) => c.el));
  const scalars = spec.scalars.map((s) => ({ ...s, output: make("output") }));
  const numbers = make("dl", { class: "scalars" });
  for (const s of scalars) numbers.append(make("div", {}, make("dt", {}, s.label), make("dd", {}, s.output)));
  const note = make("p", { class: "note", role: "status", hidden: "" });
  const problem = make("p", { class: "problem", role: "alert", hidden: "" });
  const spoken = make("p", { class: "spoken", "aria-live": "polite" });
  const footer = make("p", { class: "footer" }, footerText(model, spec));
  el.replaceChildren(view.top, charts, ...(scalars.length ? [numbers] : []), note, problem, footer, spoken);

  // The curves for the values as they stand: exact ones if the kernel has sent them.
  function current() {
    const { values = [], error } = model.get("answer") ?? {};
    const exact = model.get("exact");
    view.exact = values.every((v, k) => v === view.values[k]) && exact?.byteLength > 0;
    problem.hidden = !(error && values.every((v, k) => v === view.values[k]));
    problem.textContent = problem.hidden ? "" : `The exact curves could not be computed. ${error}`;
    if (!view.exact) return interpolate(spec, table, view.values);
    return Float64Array.from({ length: exact.byteLength / 4 }, (_, i) => exact.getFloat32(4 * i, true));
  }

  view.after = []; // called with the curves after each redraw
  let frame = 0;
  let speaking = 0;
  function redraw() {
    frame = 0;
    view.curves = split(spec, current());
    view.charts.forEach((c) => c.redraw(view.curves));
    controls.forEach((control) => control.update());
    pad?.update();
    for (const { name, output, unit } of scalars) {
      const { low, high } = spec.curves.find((curve) => curve.name === name);
      output.textContent = format(view.curves[name][0], low, high, unit);
    }
    el.dataset.values = view.exact ? "exact" : "interpolated";
    view.after.forEach((callback) => callback(view.curves));
    clearTimeout(speaking);
    speaking = setTimeout(speak, 700);
  }
  view.schedule = () => (frame ||= requestAnimationFrame(redraw));

  let moved = false; // nothing is spoken before the reader does something
  function speak() {
    view.charts.forEach((c) => c.describe(view.curves));
    const parts = spec.parameters.map((p, k) => `${p.label} ${show(p, view.values[k])}`);
    parts.push(...scalars.map((s) => `${s.label} ${s.output.textContent}`), ...(view.words?.() ?? []));
    if (moved) spoken.textContent = `${parts.join(". ")}.`;
  }

  // One request at a time; what changes meanwhile goes with the next one.
  let waiting = 0;
  let again = false;
  view.silence = (silent) => {
    note.hidden = !silent;
    note.textContent = silent ? "The kernel does not answer: showing baked values." : "";
  };
  function ask() {
    if (model.kernelless) return;
    again = Boolean(waiting);
    if (waiting) return;
    model.set("request", model.get("request") + 1);
    model.save_changes();
    waiting = setTimeout(() => {
      waiting = 0;
      view.silence(true);
    }, PATIENCE);
  }
  function answered() {
    if ((model.get("answer")?.request ?? 0) < model.get("request")) return;
    clearTimeout(waiting);
    waiting = 0;
    view.silence(false);
    view.schedule();
    if (again) ask();
  }

  view.set = (changes) => {
    moved = true;
    for (const [k, value] of Object.entries(changes)) model.set(names[k], value);
    ask();
  };
  const follow = () => {
    view.values = names.map((name) => model.get(name));
    view.schedule();
  };
  const events = [["change:answer", answered], ...names.map((name) => [`change:${name}`, follow])];
  for (const [event, callback] of events) model.on(event, callback);
  const stops = extras.map((extra) => extra(view));
  const size = new ResizeObserver(() => {
    view.charts.forEach((c) => c.resize());
    cancelAnimationFrame(frame);
    redraw(); // in the same frame: axes and curves never differ
  });
  size.observe(el);
  return () => {
    for (const [event, callback] of events) model.off(event, callback);
    stops.forEach((stop) => stop?.());
    size.disconnect();
    cancelAnimationFrame(frame);
    clearTimeout(waiting);
    clearTimeout(speaking);
  };
}

function footerText(model, spec) {
  const percent = Number((100 * spec.error).toPrecision(2)) || "below 0.001";
  const points = spec.parameters.map((p) => p.grid).join(" × ");
  const measured = `at most ${percent} % of a curve's range, at ${spec.checks} random settings`;
  return model.kernelless
    ? `Interpolated between ${points} settings computed when the page was built. Error: ${measured}.`
    : `Exact values from the kernel; until they come, interpolated ones. Their error: ${measured}.`;
}

function render({ model, el }) {
  try {
    return build({ model, el });
  } catch (error) {
    el.className = "ddlib-widget-error";
    el.setAttribute("role", "alert");
    el.textContent = `The data of this interactive figure are damaged: ${error.message}.`;
  }
}

export default { render };
