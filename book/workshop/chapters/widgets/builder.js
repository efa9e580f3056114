// Shows FilterBuilder (builder.py): a window of stems that the reader draws, and its output over the
// truth.

import { chart } from "ddlib/charts.js";
import { draggable } from "ddlib/dragging.js";
import {
  buttonOf, dress, freshId, make, numbersOf, onKeys, put, safely, short, tableOf, write,
} from "ddlib/elements.js";
import { frameOf } from "ddlib/frame.js";
import { encoderReading } from "ddlib/physics.js";

const NEAR = 28; // px from a stem within which a touch takes it; elsewhere a swipe up or down scrolls
const MINUS = (text) => text.replace("-", "−");

// Outputs of a filter over readings, one for each sample of the truth, without their mean.
function outputOf(f, seen, count) {
  const y = new Float64Array(count);
  let mean = 0;
  for (let t = 0; t < count; t++) {
    for (let i = 0; i < f.length; i++) y[t] += f[i] * seen[t + i];
    mean += y[t] / count;
  }
  return y.map((value) => value - mean);
}

// With the factor and the constant that fit best: output, factor, and error over the truth's
// deviation.
function fittedTo(truth, f, seen) {
  const count = truth.length;
  const y = outputOf(f, seen, count);
  const mean = truth.reduce((sum, a) => sum + a, 0) / count;
  let [power, common, spread, missed] = [0, 0, 0, 0];
  for (let t = 0; t < count; t++) {
    power += y[t] * y[t];
    common += y[t] * truth[t];
  }
  const factor = power > 1e-20 ? common / power : 0;
  const output = y.map((value) => mean + factor * value);
  for (let t = 0; t < count; t++) {
    spread += (truth[t] - mean) ** 2;
    missed += (truth[t] - output[t]) ** 2;
  }
  return { output, factor, error: Math.sqrt(missed / spread) };
}

const medianOf = (values) => {
  const sorted = [...values].sort((a, b) => a - b);
  const half = sorted.length >> 1;
  return sorted.length % 2 ? sorted[half] : (sorted[half - 1] + sorted[half]) / 2;
};

// The window as a drawing. stems() are heights, at most `most`; change(k, height) sets one; ghosts
// are other filters to be laid over.
function windowOf({ width, most, period }, { stems: heights, change }) {
  let levels = Array(width).fill(0);
  const half = width >> 1;
  const step = Math.round(1e3 * period);
  const grid = make("g", { class: "grid" });
  const over = make("g", {});
  const stems = levels.map((_, k) => {
    const stem = make("g", { class: "stem", role: "slider", tabindex: k === half ? 0 : -1 }, make("line", {}), make("circle", { class: "room", r: 9 }), make("circle", { class: "dot", r: 5 }));
    const label = `Weight at ${MINUS(String((k - half) * step))} ms`;
    put(stem, { "aria-orientation": "vertical", "aria-valuemin": -1, "aria-valuemax": 1, "aria-label": label });
    return stem;
  });
  const svg = make("svg", { class: "window", role: "group" }, grid, over, ...stems);
  svg.setAttribute("aria-label", "The window: Left and Right go from stem to stem, Up and Down move one, with Shift faster; 0 sets it to zero");
  let place = { left: 0, right: 1, top: 0, bottom: 1 };
  const x = (k) => place.left + ((k + 0.5) / width) * (place.right - place.left);
  const y = (v) => (place.top + place.bottom) / 2 - (v / most) * ((place.bottom - place.top) / 2);

  function resize(space, height) {
    place = { left: 30, right: space - 4, top: 8, bottom: height - 36 };
    put(svg, { width: space, height, viewBox: `0 0 ${space} ${height}` });
    const line = (at, kind) => make("line", { x1: place.left, x2: place.right, y1: short(y(at)), y2: short(y(at)), class: kind });
    grid.replaceChildren(
      ...[-1, 0, 1].flatMap((v) => [
        line(v * most, v ? "" : "zero"),
        make("text", { x: place.left - 6, y: short(y(v * most)), dy: "0.34em", class: "y" }, MINUS(String(v))),
      ]),
      ...[-half, -half / 2, 0, half / 2, half].map((n) =>
        make("text", { x: short(x(n + half)), y: place.bottom + 16, class: "x" }, MINUS(String(n * step))),
      ),
      make("text", { x: (place.left + place.right) / 2, y: height - 4, class: "x" }, "time from the centre, ms"),
    );
  }
  function draw(ghosts) {
    levels = heights();
    stems.forEach((stem, k) => {
      const [line, ...dots] = stem.children;
      const top = short(y(levels[k]));
      put(line, { x1: short(x(k)), x2: short(x(k)), y1: short(y(0)), y2: top });
      for (const dot of dots) put(dot, { cx: short(x(k)), cy: top });
      const value = (levels[k] / most).toFixed(2);
      put(stem, { "aria-valuenow": value, "aria-valuetext": MINUS(value) });
    });
    over.replaceChildren(
      ...ghosts.map(([look, f]) => {
        const points = f.map((v, i) => `${short(x(i))},${short(y(v))}`).join(" ");
        return make("polyline", { class: `curve ${look}`, points });
      }),
    );
  }

  // A stroke begins anywhere; all stems between two of its places are set.
  let last = null;
  const at = (event) => {
    const box = svg.getBoundingClientRect();
    const [px, py] = [event.clientX - box.left, event.clientY - box.top];
    const k = Math.floor(((px - place.left) / (place.right - place.left)) * width);
    const v = (1 - (2 * (py - place.top)) / (place.bottom - place.top)) * most;
    const whole = (value, low, high) => Math.min(high, Math.max(low, Math.round(value)));
    return { k: whole(k, 0, width - 1), v: whole(v, -most, most), py };
  };
  const focus = (k) => {
    stems.forEach((stem, i) => stem.setAttribute("tabindex", i === k ? 0 : -1));
    stems[k].focus({ preventScroll: true });
  };
  stems.forEach((stem) => {
    stem.addEventListener("focus", () => stem.setAttribute("class", "stem now"));
    stem.addEventListener("blur", () => stem.setAttribute("class", "stem"));
  });
  const onStem = (event) => {
    const { k, py } = at(event);
    const ends = [y(0), y(levels[k])];
    return py > Math.min(...ends) - NEAR && py < Math.max(...ends) + NEAR;
  };
  const paint = (event) => {
    const to = at(event);
    const from = last ?? to;
    const count = Math.abs(to.k - from.k);
    for (let i = count ? 1 : 0; i <= count; i++) {
      const share = count ? i / count : 1;
      change(from.k + Math.sign(to.k - from.k) * i, Math.round(from.v + share * (to.v - from.v)));
    }
    last = to;
  };
  draggable(svg, onStem, paint, (event) => {
    focus(at(event).k);
    last = null;
    paint(event);
  });
  onKeys(svg, (event) => {
    const k = stems.indexOf(event.target);
    if (k < 0) return false;
    const far = most / (event.shiftKey ? 10 : 50);
    const moved = { ArrowUp: far, ArrowDown: -far, PageUp: most / 10, PageDown: -most / 10 };
    const next = { ArrowLeft: k - 1, ArrowRight: k + 1, Home: 0, End: width - 1 };
    if (event.key in next) focus(Math.min(width - 1, Math.max(0, next[event.key])));
    else if (event.key in moved) change(k, heights()[k] + moved[event.key]); // several presses may fall into a frame
    else if (event.key === "0" || event.key === "Delete") change(k, 0);
    else return false;
  });
  return { svg, resize, draw };
}

function build({ model, el }) {
  const spec = model.get("spec");
  const { width, levels: most, period } = spec;
  const values = numbersOf(model.get("motion"), "Float64");
  const [q, truth] = [values.subarray(0, spec.samples), values.subarray(spec.samples)];
  const seen = spec.zeros.map((zero) => q.map((x) => encoderReading(spec.step, x + zero) - zero));
  const scores = (f) => {
    const [{ error }, ...others] = seen.map((reading) => fittedTo(truth, f, reading));
    return { error, others: others.map((fit) => fit.error) };
  };
  const named = new Map(spec.starts);
  const rivals = spec.rivals.map(([key, name, f]) => ({ key, name, f, ...scores(f) }));
  const least = rivals.find(({ key }) => key === "least").error;
  const shown = ["unit", "least"].map((key) => rivals.find((rival) => rival.key === key));

  dress(el, spec.title, "ddlib-builder");

  // State: the stems in levels; the starting point that they are, or ""; what has been tried.
  const levels = Array(width).fill(0);
  let start = "";
  let mirror = false;
  let level = false; // whether the weights' mean is taken out
  let tried = false;
  let compared = false;
  let best = Infinity;
  const shift = () => (level && !start ? levels.reduce((sum, v) => sum + v, 0) / width : 0);
  const filter = () => named.get(start) ?? levels.map((v) => (v - shift()) / most);

  const view = { id: freshId(), spec: { curves: spec.curves } };
  const frame = frameOf({
    el,
    key: "builder",
    title: spec.title,
    linked: Boolean(model.kernelless),
    reset: () => {
      best = Infinity;
      redraw();
    },
    code,
  });

  function begin(name) {
    start = name;
    named.get(name).forEach((v, k) => (levels[k] = Math.round(v * most)));
    later();
  }
  function change(k, v) {
    const stem = Math.min(most, Math.max(-most, Math.round(v + shift())));
    levels[k] = stem;
    if (mirror) levels[width - 1 - k] = stem;
    start = "";
    tried = true;
    later();
  }
  function code() {
    const f = start ? `builder.starts()[${JSON.stringify(start)}]` : `np.array([${levels.join(", ")}]) / ${most}`;
    const lines = level && !start ? ["f = f - f.mean()"] : [];
    return [
      "import numpy as np",
      "",
      "from workshop.chapters.widgets import builder",
      "",
      `f = ${f}  # oldest sample first`,
      ...lines,
      "q, truth = builder.windows(), builder.readings()[1]  # rad, (300, 21); rad/s²",
      "output = q @ f - (q @ f).mean()",
      "factor = output @ truth / max(output @ output, 1e-20)",
      "error = truth - truth.mean() - factor * output",
      "print(error.std() / truth.std())",
    ].join("\n");
  }

  const stage = windowOf({ width, most, period }, { stems: () => filter().map((v) => v * most), change });
  const starts = spec.starts.map(([name]) => buttonOf(name, () => begin(name)));
  const toggle = (name, words, set) => {
    const box = make("input", { type: "checkbox", role: "switch", id: `${view.id}-${name}` });
    box.addEventListener("input", () => {
      set(box.checked);
      later();
    });
    return { box, el: make("div", { class: "switch choice" }, make("label", { for: box.id }, words), box) };
  };
  const both = toggle("both", "Both sides alike", (on) => (mirror = on));
  const zero = toggle("zero", "Sum zero", (on) => (level = on));
  const compare = buttonOf("Compare", () => {
    compared = !compared;
    rebuild();
    later();
  });

  const number = make("output", { class: "error" });
  const times = make("span", { class: "times" });
  const elsewhere = make("p", { class: "remark" });
  const fill = make("div", { class: "fill" });
  const meter = make("div", { class: "meter", "aria-hidden": "true" }, fill);
  const spoken = make("p", { class: "spoken", "aria-live": "polite" });
  view.say = (text) => (spoken.textContent = text);
  const table = make("div", { class: "compared-with", hidden: "" });
  const place = make("div", { class: "charts" });
  const title = make("div", { class: "title" }, "Weights");
  el.replaceChildren(
    frame.el,
    make("div", { class: "starts" }, make("span", {}, "Begin with"), ...starts),
    make(
      "div",
      { class: "bench" },
      make("div", { class: "hands" }, title, stage.svg, make("div", { class: "below" }, both.el, zero.el, compare)),
      make(
        "div",
        { class: "results" },
        make("div", { class: "score" }, make("span", {}, "Error "), number, times),
        meter,
        place,
      ),
      make("div", { class: "words" }, elsewhere, table, make("p", { class: "remark" }, spec.hint)),
    ),
    spoken,
  );

  let drawn = [];
  function rebuild() {
    drawn = spec.panels.map((panel) =>
      chart(view, { ...panel, curves: compared ? panel.curves : panel.curves.slice(0, 2) }),
    );
    place.replaceChildren(...drawn.map((panel) => panel.el));
    drawn.forEach((panel) => panel.resize());
  }
  const plain = (x) => x.toFixed(x < 0.0995 ? 3 : 2);
  const range = (list) => `${plain(medianOf(list))} (${plain(Math.min(...list))} to ${plain(Math.max(...list))})`;
  // What spoils a drawn filter most, if one move mends a fifth of its error.
  function leak(f, error) {
    if (start) return "";
    const sum = f.reduce((total, v) => total + v, 0);
    const mends = (other) => fittedTo(truth, other, seen[0]).error < 0.8 * error;
    if (mends(f.map((v) => v - sum / width))) return `your weights sum to ${MINUS(sum.toFixed(2))}, so position leaks in`;
    return mends(f.map((v, k) => v + f[width - 1 - k])) ? "your two sides differ, so velocity leaks in" : "";
  }
  const far = (error) => (error / least).toFixed(error / least < 9.95 ? 1 : 0);

  let waiting = 0;
  let speaking = 0;
  function later() {
    frame.changed();
    waiting ||= requestAnimationFrame(redraw);
    clearTimeout(speaking);
    speaking = setTimeout(() => (spoken.textContent = `Error ${number.textContent}, ${times.textContent}`), 700);
  }
  function redraw() {
    cancelAnimationFrame(waiting);
    waiting = 0;
    const f = filter();
    const own = { ...scores(f), ...fittedTo(truth, f, seen[0]) };
    if (tried) best = Math.min(best, own.error);
    el.classList.toggle("compared", compared);
    el.score = own.error; // for tests
    stage.draw(
      compared
        ? shown.map((rival, k) => {
            const tallest = Math.max(...rival.f.map(Math.abs));
            return [spec.panels[0].curves[k + 2][2], rival.f.map((v) => (0.9 * most * v) / tallest)];
          })
        : [],
    );
    write(number, plain(own.error));
    write(times, leak(f, own.error) || `${far(own.error)} times the smallest that 21 weights can reach here`);
    const so = Number.isFinite(best) ? ` Your best so far: ${plain(best)}.` : "";
    const others = `With ${own.others.length} other zeros of the encoder the error is ${range(own.others)}.`;
    write(elsewhere, `${others}${so}`);
    fill.style.width = `${short((100 * Math.log(own.error)) / Math.log(least))}%`;
    starts.forEach((button, k) => button.setAttribute("aria-pressed", spec.starts[k][0] === start));
    both.box.checked = mirror;
    zero.box.checked = level;
    compare.disabled = !tried;
    write(compare, tried ? (compared ? "Hide the others" : "Compare") : "Compare (draw first)");
    table.hidden = !compared;
    if (compared) tabulate(own);
    const curves = { "own output": own.output, truth };
    for (const { key, f: theirs } of shown) curves[`${key} output`] = fittedTo(truth, theirs, seen[0]).output;
    drawn.forEach((panel) => {
      panel.redraw(curves);
      panel.describe(curves);
    });
  }
  function tabulate(own) {
    const textbook = spec.starts.slice(0, 4).map(([name, f]) => ({ name, ...scores(f) }));
    const rows = [{ name: "Yours", ...own }, ...textbook, ...rivals];
    const texts = rows.sort((a, b) => a.error - b.error).map((row) => [row.name, plain(row.error), range(row.others)]);
    table.replaceChildren(tableOf("Errors, smallest first", ["weights", "here", "with other encoder zeros"], texts));
  }

  begin(spec.starts[0][0]);
  const text = () => (start ? `s${spec.starts.findIndex(([name]) => name === start)}` : levels.map((v) => (v + most).toString(36).padStart(2, "0")).join(""));
  frame.keep("f", text, (given) => {
    const begun = spec.starts[given.match(/^s(\d)$/)?.[1]];
    if (begun) return begin(begun[0]);
    const read = (given.match(/../g) ?? []).map((pair) => parseInt(pair, 36) - most);
    if (read.length !== width || given.length !== 2 * width || !read.every((v) => Math.abs(v) <= most)) {
      throw new Error("no such filter");
    }
    read.forEach((v, k) => (levels[k] = v));
    start = "";
    tried = true;
  });
  frame.keep("both", () => (mirror ? "1" : ""), (given) => (mirror = given === "1"));
  frame.keep("zero", () => (level ? "1" : ""), (given) => (level = given === "1"));
  frame.keep("compare", () => (compared ? "1" : ""), (given) => {
    compared = given === "1";
    tried ||= compared;
    rebuild();
  });
  if (!drawn.length) rebuild();
  redraw();

  const size = new ResizeObserver(() => {
    const space = Math.floor(stage.svg.parentElement.clientWidth);
    stage.resize(Math.max(200, space), el.clientWidth < 560 ? 220 : 300);
    drawn.forEach((panel) => panel.resize());
    redraw();
  });
  size.observe(el);
  return () => {
    size.disconnect();
    frame.stop();
    cancelAnimationFrame(waiting);
    clearTimeout(speaking);
  };
}

const render = safely(build);
export default { render };
