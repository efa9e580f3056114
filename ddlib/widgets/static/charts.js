// Draws charts.

import { draggable, withinOf } from "./dragging.js";
import { make, put, short, swatch } from "./elements.js";
import { around, format, labels, powerText, ticks } from "./numbers.js";
import { readerOf, unitOf } from "./reading.js";

// Round numbers between two logarithms, as logarithms: powers of ten, or where there are fewer than
// three also twice and five times them, or all digits, or the ends; at least `room` px apart.
function decades(low, high, slope, room) {
  const first = Math.floor(low + 1e-9);
  const all = Array.from({ length: Math.ceil(high) - first + 1 }, (_, i) => first + i);
  const times = (digits) =>
    all.flatMap((x) => digits.map((d) => x + Math.log10(d))).filter((x) => x >= low - 1e-6 && x <= high + 1e-6);
  const whole = times([1]);
  const apart = (list) => list.length > 1 && list.every((x, i) => !i || (x - list[i - 1]) * slope >= room);
  if (whole.length > 2) {
    const step = Math.ceil(room / slope);
    return whole.filter((x) => Math.round(x) % step === 0);
  }
  const lists = [times([1, 2, 5]), whole, times([1, 2, 3, 4, 5, 6, 7, 8, 9])];
  return lists.find(apart) ?? [low, high];
}

function axis(low, high, log, from, to, room) {
  const [a, b] = log ? [Math.log10(low), Math.log10(high)] : [low, high];
  const slope = (to - from) / (b - a);
  const place = (x) => from + ((log ? Math.log10(x) : x) - a) * slope;
  if (!log) {
    const marks = ticks(a, b, Math.max(2, Math.floor(Math.abs(to - from) / room)));
    return { place, marks, texts: labels(marks) };
  }
  const powers = decades(a, b, Math.abs(slope), room);
  return { place, marks: powers.map((x) => 10 ** x), texts: powers.map(powerText) };
}

function extremes(lists) {
  let [low, high] = [Infinity, -Infinity];
  for (const list of lists) {
    for (const value of list) {
      if (value < low) low = value;
      if (value > high) high = value;
    }
  }
  return [low, high];
}

// What a chart of each kind draws for one curve: `xs` are places of the samples in px, `y` maps
// values to px, `base` is the place of zero, `shift` and `width` are a bar's in px.
const DRAW = {
  line: ({ xs, y, values }) => {
    let d = "";
    for (let i = 0; i < xs.length && values[i] === values[i]; i++) { // a run that was stopped ends in NaN
      d += `${i ? "L" : "M"}${xs[i]} ${short(y(values[i]))}`;
    }
    return [d];
  },
  stems: ({ xs, y, values, base, shift }) => {
    let [stalks, dots] = ["", ""];
    for (let i = 0; i < xs.length; i++) {
      const [x, top] = [short(xs[i] + shift), short(y(values[i]))];
      stalks += `M${x} ${base}V${top}`;
      dots += `M${x} ${top}h0`;
    }
    return [stalks, dots];
  },
  bars: ({ xs, y, values, base, shift, width }) => {
    let d = "";
    for (let i = 0; i < xs.length; i++) {
      const from = short(xs[i] + shift - width / 2);
      d += `M${from} ${base}V${short(y(values[i]))}h${short(width)}V${base}Z`;
    }
    return [d];
  },
};

export function chart(view, panel) {
  const { kind } = panel;
  const standing = kind !== "line"; // on zero
  const log = panel.y_scale === "log";
  const ranges = panel.curves.map(([name]) => view.spec.curves.find((c) => c.name === name));
  const fixed = panel.fixed.map(([legend, values, look], k) => ({
    legend,
    values,
    look,
    k: ranges.length + k,
    kind: kind === "stems" ? "line" : kind,
  }));
  const moving = panel.curves.map(([name, legend, look], k) => ({ name, legend, look, k, kind }));
  const curves = [...moving, ...fixed];
  for (const curve of curves) {
    const classes = { line: ["curve"], stems: ["curve stem", "curve dots"], bars: ["curve bar"] };
    curve.paths = classes[curve.kind].map((c) => make("path", { class: `${c} ${curve.look}` }));
  }

  // Triangles where a curve was cut off and goes on beyond: they lie on its end of the range.
  const [least, most] = panel.limits;
  const near = 1e-3 * (most !== null && least !== null ? most - least : Math.abs(most ?? least ?? 0));
  const beyond = (v) => (most !== null && v > most - near) - (least !== null && v < least + near);
  const cut = least !== null || most !== null ? moving : [];
  for (const curve of cut) curve.beyond = make("path", { class: `beyond ${curve.look}` });

  const clip = make("rect", {});
  const clipId = `${view.id}-clip${(view.clips = (view.clips ?? 0) + 1)}`;
  const grid = make("g", { class: "grid" });
  const span = make("rect", { class: "span", visibility: "hidden" });
  const cursor = make("line", { class: "cursor", visibility: "hidden" });
  const paths = [...fixed, ...moving].flatMap((curve) => curve.paths);
  for (const el of paths) el.setAttribute("clip-path", `url(#${clipId})`);
  const defs = make("defs", {}, make("clipPath", { id: clipId }, clip));
  const beyonds = cut.map((c) => c.beyond);
  const svg = make("svg", { role: "img", tabindex: 0 }, defs, span, grid, cursor, ...paths, ...beyonds);
  const legend = make("div", { class: "legend" });
  for (const curve of curves) {
    curve.label = make("span", {}, swatch(curve.kind, curve.look), curve.legend);
    if (curves.length > 1) legend.append(curve.label);
  }
  const title = make("div", { class: "title" }, panel.y_label);
  const el = make("div", { class: "chart" }, title, legend, svg);

  const gap = Math.min(...panel.x.slice(1).map((x, i) => x - panel.x[i]));
  const room = kind === "bars" || (kind === "stems" && panel.x_scale === "linear") ? gap / 2 : 0;
  const ends = [panel.x[0] - room, panel.x.at(-1) + room];
  let low, high, x, y, xs, left, right, bottom, base, width, height;
  const whole = wholeRange();
  [low, high] = whole;
  let shown = {}; // what was drawn last
  const valueOf = (curve, i) => (curve.values ?? shown[curve.name])?.[i] ?? NaN;
  const [, unit] = unitOf(panel.y_label);
  const follow = readerOf({
    ...{ el, svg, panel, curves },
    samples: () => xs,
    top: () => 6,
    bottom: () => bottom,
    left: () => left,
    right: () => right,
    base: () => base,
    across: (curve, i) => short(xs[i] + (curve.kind === "line" ? 0 : shiftOf(curve)[0])),
    place: (curve, i) => y.place(log ? Math.max(valueOf(curve, i), low) : valueOf(curve, i)),
    say: (text) => view.say(text),
    text: (curve, i) => textOf(valueOf(curve, i), unit),
  });

  // Enough digits for the axis as it stands; three where it is not linear.
  function textOf(value, unit) {
    if (Number.isNaN(value)) return "none";
    const side = beyond(value);
    if (side) return `beyond ${format(side > 0 ? most : least, low, high, unit)}`;
    if (!log) return format(value, low, high, unit);
    return powerText(Math.log10(value)) + (unit && `\u00a0${unit}`);
  }
  // Where a bar or stem stands beside its sample, and how wide it is, in px.
  function shiftOf(curve) {
    const count = kind === "bars" ? curves.length : moving.length;
    const pitch = kind === "bars" ? (0.8 * Math.abs(x.place(ends[0] + gap) - x.place(ends[0]))) / count : 6;
    return [(curve.k - (count - 1) / 2) * pitch, pitch];
  }

  function wholeRange() {
    let [a, b] = extremes([ranges.flatMap((r) => [r.low, r.high]), ...fixed.map((c) => c.values)]);
    if (standing) [a, b] = [Math.min(a, 0), Math.max(b, 0)];
    if (log) return [Math.max(a, b * 1e-12), b];
    const margin = 0.04 * (b - a || Math.abs(b) || 1);
    return [standing && a === 0 ? 0 : a - margin, standing && b === 0 ? 0 : b + margin];
  }
  function presentRange(all) {
    if (panel.y_range) return panel.y_range.map((end) => (typeof end === "string" ? all[end][0] : end));
    if (!panel.y_fit) return whole;
    let [a, b] = extremes(curves.map((curve) => curve.values ?? all[curve.name]));
    if (standing) [a, b] = [Math.min(a, 0), Math.max(b, 0)];
    return around(log ? Math.max(a, b * 1e-12) : a, b, log);
  }

  function draw(curve, values) {
    const visible = log ? values.map((v) => Math.max(v, low)) : values;
    const [shift, width] = shiftOf(curve);
    const drawn = DRAW[curve.kind]({ xs, y: y.place, values: visible, base, shift, width });
    drawn.forEach((d, i) => curve.paths[i].setAttribute("d", d));
    if (!curve.beyond) return;
    const triangle = (v, i) => `M${xs[i] - 6} ${short(y.place(v) + 5 * beyond(v))}h12l-6 ${-10 * beyond(v)}z`;
    curve.beyond.setAttribute("d", Array.from(values, (v, i) => (beyond(v) ? triangle(v, i) : "")).join(""));
  }

  // The horizontal axis, with marks so far apart that their texts have room.
  function across() {
    for (let room = panel.x_scale === "linear" ? 52 : 34; ; room += 10) {
      const made = axis(...ends, panel.x_scale === "log", left, right, room);
      const [at, long] = [made.marks.map(made.place), made.texts.map((text) => text.length)];
      const free = at.every((place, i) => !i || place - at[i - 1] > 3.5 * (long[i] + long[i - 1]) + 6);
      if (free || room > right - left) return made;
    }
  }

  // Axes, and the curves that stay, for the range and size as they are.
  function layout() {
    bottom = height - 36;
    y = axis(low, high, log, bottom, 6, 30);
    left = Math.max(view.left ?? 0, 9 + Math.max(...y.texts.map((t) => 7 * t.length + (t.startsWith("−") ? 3 : 0))));
    right = width - 10;
    x = across();
    xs = panel.x.map((v) => short(x.place(v)));
    base = short(log ? bottom : y.place(Math.min(high, Math.max(low, 0))));
    const marks = panel.ticks.length ? panel.ticks : x.marks.map((v, i) => [v, x.texts[i]]);
    grid.replaceChildren(
      ...y.marks.flatMap((v, i) => {
        const at = y.place(v).toFixed(2);
        const label = make("text", { x: left - 6, y: at, dy: "0.34em", class: "y" }, y.texts[i]);
        return [make("line", { x1: left, x2: right, y1: at, y2: at }), label];
      }),
      ...marks.map(([v, text]) =>
        make("text", { x: x.place(v).toFixed(1), y: bottom + 16, class: "x" }, text),
      ),
      make("path", { class: "frame", d: `M${left} 6V${bottom}H${right}` }),
      make("text", { x: (left + right) / 2, y: height - 3, class: "x" }, panel.x_label),
    );
    if (standing && base < bottom) {
      grid.append(make("line", { class: "zero", x1: left, x2: right, y1: base, y2: base }));
    }
    put(clip, { x: left - 2, y: 3, width: right - left + 6, height: bottom - 1 });
    put(cursor, { y1: 6, y2: bottom });
    put(span, { y: 6, height: bottom - 6 });
    for (const curve of fixed) draw(curve, curve.values);
  }

  function resize() {
    width = Math.max(160, Math.floor(el.clientWidth));
    height = Math.round(Math.min(view.tall ?? 260, Math.max(160, width * 0.6)));
    put(svg, { width, height, viewBox: `0 0 ${width} ${height}` });
    layout();
  }

  function redraw(all) {
    shown = all;
    if (!x) return; // not laid out yet
    const [a, b] = presentRange(all);
    if (a !== low || b !== high) {
      [low, high] = a < b ? [a, b] : [a - 1, a + 1];
      layout();
    }
    for (const curve of moving) draw(curve, all[curve.name]);
    const places = panel.cursor.map((name) => all[name][0]);
    if (places.length === 1) point(places[0]);
    if (places.length === 2) shade(...places);
    follow();
  }

  // A vertical line; nothing where it would lie beyond the axis.
  function point(at) {
    if (!x) return; // not laid out yet
    const inside = at >= ends[0] && at <= ends[1];
    cursor.setAttribute("visibility", inside ? "visible" : "hidden");
    if (inside) put(cursor, { x1: short(x.place(at)), x2: short(x.place(at)) });
  }

  function shade(a, b) {
    const [from, to] = [Math.min(a, b), Math.max(a, b)].map((v) =>
      x.place(Math.min(ends[1], Math.max(ends[0], v))),
    );
    put(span, { visibility: "visible", x: short(from), width: short(to - from) });
  }

  // The line or the shaded span follows the pointer: move(value of the axis, which is linear).
  function drag(move) {
    svg.style.cursor = "ew-resize";
    draggable(svg, withinOf(panel.cursor.length === 2 ? span : cursor), ({ clientX }) => {
      const part = (clientX - svg.getBoundingClientRect().left - left) / (right - left);
      move(ends[0] + Math.min(1, Math.max(0, part)) * (ends[1] - ends[0]));
    });
  }

  function describe(all) {
    const parts = curves.map((curve) => {
      const values = [...(curve.values ?? all[curve.name])];
      const [a, b] = curve.values ? extremes([values]) : [ranges[curve.k].low, ranges[curve.k].high];
      if (panel.ticks.length === values.length && values.length <= 8) {
        const each = values.map((v, i) => `${panel.ticks[i][1]} ${format(v, a, b)}`);
        return `${curve.legend}: ${each.join(", ")}`;
      }
      const [min, max] = extremes([values]);
      return `${curve.legend} from ${format(min, a, b)} to ${format(max, a, b)}`;
    });
    svg.setAttribute("aria-label", `${panel.y_label} over ${panel.x_label}: ${parts.join("; ")}. Arrow keys read values`);
  }

  // Other names of the curves, in their order.
  function rename(names) {
    names.forEach((name, i) => {
      curves[i].legend = name;
      curves[i].label.lastChild.data = name;
    });
    follow();
  }

  // The place of a point of the chart, px; for a class with more to draw in it.
  const at = (a, b) => [x.place(a), y.place(b)];

  return { el, panel, resize, redraw, describe, point, rename, at, drag };
}
