// Shows FoldBench (bench.py): a strip of weights that folds over its centre, a wire that is a joint's
// path in the window, and under each weight the product of both, which adds up in a jar for each part.

import { besideOf, draggable } from "ddlib/dragging.js";
import { buttonOf, dress, make, onKeys, put, safely, short, write } from "ddlib/elements.js";
import { frameOf } from "ddlib/frame.js";

const PARTS = { constant: "Constant", even: "Even half", odd: "Odd half" };
const WIRE = { lift: ["lift", "°"], tilt: ["tilt", "°/s"], bend: ["bend", "°/s²"] };
const TALLEST = 15; // degrees at the edge of the wire's field
const RISE = 34; // px by which the strip's edge comes up while it turns
const PAPER = 16; // px of paper beyond the outermost weights
const RAD = Math.PI / 180;
const FRAME = 25; // ms for a sample that is played: 2.5 times slower than it was

const sum = (values) => values.reduce((all, value) => all + value, 0);
const largest = (values) => Math.max(...values.map(Math.abs), 1e-12);
const minus = (text) => text.replace("-", "−");

// A row as its mean and the halves that its mirror image leaves.
export function halvesOf(f) {
  const back = [...f].reverse();
  const mean = sum(f) / f.length;
  return {
    constant: f.map(() => mean),
    even: f.map((v, k) => (v + back[k]) / 2 - mean),
    odd: f.map((v, k) => (v - back[k]) / 2),
  };
}

export const angles = (x, { lift, tilt, bend }) => x.map((t) => lift + tilt * t + (bend * t * t) / 2);

// What a row and a motion (q, v, a) put into each jar at every moment, and what it would be if the part
// were a multiple of the joint's angle, acceleration and speed.
function playedOf(parts, x, [q, v, a]) {
  const moments = q.map((_, m) => m).slice(0, q.length - x.length + 1);
  const half = (x.length - 1) / 2;
  const by = { constant: [q, 0], even: [a, 2], odd: [v, 1] };
  const traces = Object.entries(parts).map(([name, part]) => {
    const [of, power] = by[name];
    const factor = sum(part.map((f, k) => f * x[k] ** power)) / (power || 1);
    const got = moments.map((m) => sum(part.map((f, k) => f * q[m + k])));
    const wanted = moments.map((m) => factor * of[m + half]);
    const missed = sum(got.map((y, m) => (y - wanted[m]) ** 2)) / (sum(got.map((y) => y * y)) || 1);
    return [name, { got, wanted, told: Math.max(0, 1 - missed) }];
  });
  return Object.fromEntries(traces);
}

function build({ model, el }) {
  const { key, title, step, reach, labels, rows, motion } = model.get("spec");
  dress(el, title, "ddlib-bench");
  const get = (name) => model.get(name);
  const n = rows[labels[0]].length;
  const half = (n - 1) / 2;
  const x = rows[labels[0]].map((_, k) => step * (k - half));
  const widest = largest(motion[0]) / RAD;
  let row, parts, played; // of the chosen row
  let most, tall, highest; // of a jar, of a product and of what is played
  let moment = -1; // of the motion, or -1 while the wire is the reader's
  let timer = 0;

  function set(changes) {
    for (const [name, value] of Object.entries(changes)) model.set(name, value);
    model.save_changes();
    frame.changed();
  }
  const within = (name, value) => Math.min(reach[name], Math.max(-reach[name], value));
  const bendTo = (name, value) => {
    rest();
    set({ [name]: within(name, value) });
  };

  // The drawing
  const text = (kind, words = "") => make("text", { class: kind }, words);
  const group = (kind, ...children) => make("g", { class: kind }, ...children);
  const handleOf = (name, words) => {
    const dot = make("circle", { class: "dot", r: 11 });
    const label = text("handle-name", name === "fold" ? "" : name);
    const g = make("g", { class: `grip ${name}`, role: "slider", tabindex: 0, "aria-label": words }, dot, label);
    return { g, dot, label };
  };
  const strip = {
    sheet: make("polygon", { class: "sheet" }),
    flap: make("polygon", { class: "flap" }),
    zero: make("line", { class: "zero" }),
    crease: make("line", { class: "crease" }),
    stems: group("stems"),
    pieces: group("pieces"),
  };
  const wire = { zero: make("line", { class: "zero" }), path: make("path", { class: "wire" }), dots: group("beads") };
  const grips = {
    fold: handleOf("fold", "Fold the strip"),
    bend: handleOf("bend", "Bend the wire"),
    lift: handleOf("lift", "Lift the wire"),
    tilt: handleOf("tilt", "Tilt the wire"),
  };
  const bands = Object.entries(PARTS).map(([name, words]) => {
    const jar = { level: make("rect", {}), glass: make("path", { class: "glass" }), number: text("number") };
    const bits = { zero: make("line", { class: "zero" }), bars: group("bars"), arc: make("path", { class: "arc" }), pair: text("pair") };
    const traces = { wanted: make("path", { class: "expected" }), got: make("path", { class: "trace" }) };
    const label = text(`name ${name}`, words);
    const g = group(`band ${name}`, label, ...Object.values(bits), ...Object.values(traces), ...Object.values(jar));
    return { name, g, label, jar, ...bits, ...traces };
  });
  const [stripName, wireName] = [text("name", "The row"), text("name shoulder", "The joint’s path")];
  const hint = text("hint x", "Nothing has come out yet: fold the strip");
  const axis = group("axis");
  const svg = make(
    "svg",
    { class: "bench", role: "group", "aria-label": `${title}: strip, wire and jars` },
    stripName, strip.sheet, strip.zero, strip.stems, strip.flap, strip.pieces, strip.crease, grips.fold.g,
    wireName, wire.zero, wire.path, wire.dots, grips.bend.g, grips.lift.g, grips.tilt.g,
    ...bands.map(({ g }) => g), hint, axis,
  ); // prettier-ignore

  const at = {}; // places of the drawing, set by layout()
  function layout() {
    const wide = el.clientWidth || 640;
    const narrow = wide < 620;
    Object.assign(at, { wide, narrow, x0: narrow ? 22 : 134, x1: wide - (narrow ? 84 : 164) });
    const name = narrow ? 20 : 0; // room above a field for its name
    let y = 0;
    const field = (height, over = 0) => {
      const top = y + name + over;
      y = top + height + 8;
      return { top, height, middle: top + height / 2, name: narrow ? y - height - 14 - over : top + height / 2 };
    };
    at.strip = field(104, narrow ? 16 : RISE);
    at.wire = field(132);
    at.bands = bands.map(() => field(62));
    put(svg, { width: wide, height: y + 22, viewBox: `0 0 ${wide} ${y + 22}` });
    at.axis = y + 12;
    put(hint, { x: (at.x0 + at.x1) / 2, y: at.bands[0].middle });
    for (const [label, place] of [[stripName, at.strip], [wireName, at.wire]]) put(label, { x: 0, y: place.name });
    bands.forEach(({ label }, i) => put(label, { x: 0, y: at.bands[i].name }));
  }
  function drawAxis() {
    const last = (motion[0].length - n) * step;
    const words = moment < 0 ? [`−${1e3 * step * half} ms`, "now", `${1e3 * step * half} ms`] : ["0 s", "", `${short(last)} s`];
    axis.replaceChildren(...words.map((word, k) => make("text", { class: "x", x: xOf(k * half), y: at.axis }, word)));
  }
  const xOf = (k) => short(at.x0 + (k / (n - 1)) * (at.x1 - at.x0));
  const level = (line, place) => put(line, { x1: at.x0, x2: at.x1, y1: place.middle, y2: place.middle });

  // A weight as a stem: filled if positive, hollow if negative, dotted if seen through the paper.
  function stem(left, base, height, kind = "") {
    const dot = make("circle", { class: `weight ${height < 0 ? "hollow" : ""} ${kind}`, cx: short(left), cy: short(base - height), r: at.narrow ? 3 : 4 });
    return [make("line", { class: `stem ${kind}`, x1: short(left), x2: short(left), y1: short(base), y2: short(base - height) }), dot];
  }
  function drawStrip() {
    const { top, height, middle } = at.strip;
    const [turn, centre, reachX] = [Math.PI * get("fold"), xOf(half), xOf(n - 1) - xOf(half)];
    const scale = (0.42 * height) / largest(row);
    const edge = centre + (reachX + PAPER) * Math.cos(turn);
    const up = RISE * Math.sin(turn);
    const corners = (points) => points.map((point) => point.map(short).join()).join(" ");
    put(strip.sheet, { points: corners([[xOf(0) - PAPER, top], [centre, top], [centre, top + height], [xOf(0) - PAPER, top + height]]) });
    put(strip.flap, { points: corners([[centre, top], [edge, top - up], [edge, top + height - up], [centre, top + height]]) });
    level(strip.zero, at.strip);
    put(strip.crease, { x1: centre, x2: centre, y1: top - 6, y2: top + height + 6 });
    const over = turn > Math.PI / 2;
    const stems = row.flatMap((f, k) => {
      if (k <= half) return stem(xOf(k), middle, scale * f);
      const share = (k - half) / half;
      return stem(centre + share * reachX * Math.cos(turn), middle - up * share, scale * f, over ? "behind" : "");
    });
    strip.stems.replaceChildren(...stems);
    svg.insertBefore(strip.flap, over ? strip.zero : strip.stems);
    const done = get("fold") === 1;
    const pieces = done ? row.slice(0, half + 1).flatMap((_, k) => {
      let from = 0;
      return Object.entries(parts).map(([name, part], i) => {
        const [y1, y2] = [middle - scale * from, middle - scale * (from + part[k])];
        from += part[k];
        return make("line", { class: `piece ${name}`, x1: xOf(k) + 3 * (i - 1), x2: xOf(k) + 3 * (i - 1), y1: short(y1), y2: short(y2) });
      });
    }) : [];
    strip.pieces.replaceChildren(...pieces);
    const { g } = grips.fold;
    put(g, { transform: `translate(${short(edge)} ${short(middle - up)})` });
    const percent = Math.round(100 * get("fold"));
    put(g, { "aria-valuemin": 0, "aria-valuemax": 100, "aria-valuenow": percent, "aria-valuetext": `${percent} %` });
  }
  const now = () => (moment < 0 ? angles(x, { lift: get("lift"), tilt: get("tilt"), bend: get("bend") }) : motion[0].slice(moment, moment + n).map((q) => q / RAD));
  function drawWire(path) {
    const { middle, height } = at.wire;
    const scale = height / 2 / (moment < 0 ? TALLEST : widest * 1.05);
    const y = path.map((q) => short(middle - scale * q));
    level(wire.zero, at.wire);
    put(wire.path, { d: `M${y.map((v, k) => `${xOf(k)} ${v}`).join("L")}` });
    wire.dots.replaceChildren(...y.map((v, k) => make("circle", { class: "bead", cx: xOf(k), cy: v, r: at.narrow ? 2.5 : 3.5 })));
    const places = { bend: 0, lift: half, tilt: n - 1 };
    for (const [name, k] of Object.entries(places)) {
      const { g, label } = grips[name];
      const value = Math.round(get(name) * 10) / 10;
      g.style.display = moment < 0 ? "" : "none";
      put(g, { transform: `translate(${xOf(k)} ${y[k]})`, "aria-valuemin": -reach[name], "aria-valuemax": reach[name], "aria-valuenow": value });
      put(g, { "aria-valuetext": minus(`${value} ${WIRE[name][1]}`) });
      put(label, { x: name === "tilt" && !at.narrow ? 16 : 0, y: name === "tilt" && !at.narrow ? 4 : y[k] < middle ? -17 : 26, class: `handle-name ${name === "tilt" && !at.narrow ? "" : "x"}` });
    }
  }
  const digits = () => Math.min(4, Math.max(0, 1 - Math.floor(Math.log10(most))));
  const numberOf = (value) => minus(value.toFixed(digits()).replace(/^-(0(\.0*)?)$/, "$1"));
  function drawBands(path) {
    const open = get("fold") === 1;
    hint.style.display = open ? "none" : "";
    bands.forEach((band, i) => {
      const { middle, height, top } = at.bands[i];
      band.g.style.display = open ? "" : "none";
      level(band.zero, at.bands[i]);
      const products = parts[band.name].map((f, k) => f * path[k] * RAD);
      const whole = sum(products);
      const width = 0.62 * (xOf(1) - xOf(0));
      const y = (value) => Math.max(-1, Math.min(1, value / tall)) * (height / 2);
      const playing = moment >= 0;
      band.bars.replaceChildren(...(playing ? [] : products.map((value, k) => make("rect", {
        class: value < 0 ? "bar hollow" : "bar", x: short(xOf(k) - width / 2), width: short(width),
        y: short(middle - Math.max(0, y(value))), height: short(Math.max(0.5, Math.abs(y(value)))),
      }))));
      const lineOf = (values, upTo) => `M${values.slice(0, upTo).map((v, m) => `${short(at.x0 + (m / (values.length - 1)) * (at.x1 - at.x0))} ${short(middle - (v / highest) * (height / 2))}`).join("L")}`;
      const { got, wanted } = played[band.name];
      put(band.got, { d: playing ? lineOf(got, moment + 1) : "M0 0" });
      put(band.wanted, { d: playing ? lineOf(wanted, moment + 1) : "M0 0" });
      // the outermost pair, which cancels or adds up
      const [first, last] = [products[0], products[n - 1]];
      const told = !playing && Math.abs(first) + Math.abs(last) > 0.25 * tall;
      put(band.arc, { d: told ? `M${xOf(0)} ${top + 4}C${xOf(3)} ${top - 8} ${xOf(n - 4)} ${top - 8} ${xOf(n - 1)} ${top + 4}` : "M0 0" });
      put(band.pair, { x: (at.x0 + at.x1) / 2, y: top + 7, class: "pair x" });
      write(band.pair, told ? `${numberOf(first)} ${last < 0 ? "−" : "+"} ${numberOf(Math.abs(last))} = ${numberOf(first + last)}` : "");
      // the jar
      const left = at.x1 + (at.narrow ? 32 : 44);
      const wide = at.narrow ? 40 : 54;
      const full = playing ? highest : most;
      const fill = Math.min(1, Math.abs(whole) / full) * (height - 8);
      put(band.jar.level, { class: whole < 0 ? "level hollow" : "level", x: left, width: wide, y: short(top + height - fill), height: short(fill) });
      put(band.jar.glass, { d: `M${left - 4} ${top + 2}h4v${height - 8}q0 6 6 6h${wide - 12}q6 0 6 -6v${-(height - 8)}h4` });
      put(band.jar.number, at.narrow ? { x: at.wide, y: at.bands[i].name, class: "number y" } : { x: left + wide + 8, y: middle + 6, class: "number" });
      write(band.jar.number, numberOf(whole));
    });
  }

  // What the bench says
  const share = (value) => `${Math.round(100 * value)} %`;
  function sentence(path) {
    if (get("fold") < 1) return "Take the strip by its right edge and fold it over. By keyboard: arrow keys on the round handles.";
    if (moment >= 0) {
      const { odd, even } = played;
      return `Dashed: the joint’s speed and its acceleration, each times one number. They explain ${share(odd.told)} of what went into the odd jar, and ${share(even.told)} of the even jar.`;
    }
    const moved = Object.keys(WIRE).filter((name) => Math.abs(get(name)) > 0.02 * reach[name]);
    const words = { lift: "Lifted: the joint stands still.", tilt: "Tilted: a steady speed.", bend: "Bent: the joint speeds up." };
    const what = moved.length === 1 ? words[moved[0]] : moved.length ? "Several at once." : "The joint stands at zero.";
    const filled = bands.filter(({ name }) => Math.abs(sum(parts[name].map((f, k) => f * path[k] * RAD))) > 0.1 * most);
    const names = filled.map(({ name }) => name);
    if (!names.length) return `${what} No jar gets much.`;
    return `${what} ${names.length === 1 ? `Only the ${names[0]} jar fills.` : `These jars fill: ${names.join(", ")}.`}`;
  }
  const said = make("p", { class: "verdict", role: "status" });

  function draw() {
    const path = now();
    drawStrip();
    drawWire(path);
    drawBands(path);
    drawAxis();
    play.disabled = get("fold") < 1;
    write(play, moment < 0 ? "Play a motion" : "Back to the wire");
    if (!timer) write(said, sentence(path));
  }
  function take() {
    row = rows[get("row")];
    parts = halvesOf(row);
    played = playedOf(parts, x, motion);
    const alone = Object.keys(reach).map((name) => angles(x, { lift: 0, tilt: 0, bend: 0, [name]: reach[name] }));
    const products = alone.flatMap((path) => Object.values(parts).map((part) => part.map((f, k) => f * path[k] * RAD)));
    most = largest(products.map(sum));
    tall = largest(products.flat());
    highest = largest(Object.values(played).flatMap(({ got }) => got));
    choices.forEach((choice, k) => choice.setAttribute("aria-pressed", String(labels[k] === get("row"))));
    draw();
  }

  // Playing
  const end = motion[0].length - n;
  const calm = matchMedia("(prefers-reduced-motion: reduce)");
  function rest() {
    cancelAnimationFrame(timer);
    [timer, moment] = [0, -1];
  }
  function run(begin) {
    timer = requestAnimationFrame((stamp) => {
      moment = calm.matches ? end : Math.min(end, Math.max(0, Math.floor((stamp - begin) / FRAME)));
      if (moment === end) timer = 0;
      draw();
      if (timer) run(begin);
    });
  }
  const play = buttonOf("Play a motion", () => {
    if (moment >= 0) {
      rest();
      return draw();
    }
    write(said, "The window slides along the motion; what goes into each jar is drawn.");
    run(performance.now());
  });
  const choices = labels.map((label) => buttonOf(label, () => set({ row: label })));
  const bar = make("div", { class: "presets" }, make("span", {}, "Row"), ...choices, play);

  // Handles
  const centreOf = ({ dot }) => {
    const box = dot.getBoundingClientRect();
    return [box.x + box.width / 2, box.y + box.height / 2];
  };
  const usable = () => Object.entries(grips).filter(([, { g }]) => g.style.display !== "none");
  let held = null;
  const away = (event, grip) => {
    const [left, top] = centreOf(grip);
    return Math.hypot(event.clientX - left, event.clientY - top);
  };
  const move = (event) => {
    if (!held) return;
    const box = svg.getBoundingClientRect();
    const [left, top] = [event.clientX - box.x, event.clientY - box.y];
    if (held === "fold") {
      const across = (left - xOf(half)) / (xOf(n - 1) - xOf(half) + PAPER);
      const folded = Math.acos(Math.max(-1, Math.min(1, across))) / Math.PI; // the grip under the pointer
      return set({ fold: folded > 0.9 ? 1 : Math.round(200 * folded) / 200 });
    }
    const angle = ((at.wire.middle - top) * 2 * TALLEST) / at.wire.height;
    const t = x[n - 1];
    const to = {
      lift: angle,
      tilt: (angle - get("lift") - (get("bend") * t * t) / 2) / t,
      bend: (2 * (angle - get("lift") + get("tilt") * t)) / (t * t),
    };
    bendTo(held, Math.round((100 * to[held]) / reach[held]) * (reach[held] / 100));
  };
  const near = (event) => usable().some(([, { dot }]) => besideOf(dot)(event));
  draggable(svg, near, move, (event) => {
    const close = usable().sort(([, a], [, b]) => away(event, a) - away(event, b))[0];
    held = away(event, close[1]) < 40 ? close[0] : null;
    if (held) grips[held].g.focus({ preventScroll: true });
    move(event);
  });
  const KEYS = { ArrowUp: 1, ArrowRight: 1, ArrowDown: -1, ArrowLeft: -1, PageUp: 5, PageDown: -5 };
  for (const [name, { g }] of Object.entries(grips)) {
    onKeys(g, ({ key: pressed, shiftKey }) => {
      const steps = (KEYS[pressed] ?? 0) * (shiftKey ? 5 : 1);
      const ends = { Home: -1, End: 1 }[pressed];
      if (!steps && !ends) return false;
      if (name === "fold") return set({ fold: ends ? (ends + 1) / 2 : Math.min(1, Math.max(0, get("fold") + 0.1 * steps)) });
      bendTo(name, ends ? ends * reach[name] : get(name) + (steps * reach[name]) / 20);
    });
  }

  const frame = frameOf({ el, key, title, linked: Boolean(model.kernelless), reset: () => (rest(), draw()), code: () => "" });
  frame.keep("row", () => get("row"), (label) => {
    if (!rows[label]) throw new Error(`row is ${label}`);
    set({ row: label });
  });
  for (const name of ["fold", ...Object.keys(reach)]) {
    frame.keep(name, () => String(get(name)), (given) => {
      const value = Number(given);
      const fits = name === "fold" ? value >= 0 && value <= 1 : Math.abs(value) <= reach[name];
      if (!fits) throw new Error(`${name} is ${given}`);
      set({ [name]: value });
    });
  }
  el.replaceChildren(frame.el, bar, said, svg);
  const events = ["fold", ...Object.keys(reach)].map((name) => `change:${name}`);
  for (const event of events) model.on(event, draw);
  model.on("change:row", take);
  const sizes = new ResizeObserver(() => {
    layout();
    draw();
  });
  layout();
  take();
  sizes.observe(el);
  return () => {
    rest();
    sizes.disconnect();
    for (const event of events) model.off(event, draw);
    model.off("change:row", take);
    frame.stop();
  };
}

const render = safely(build);
export default { render };
