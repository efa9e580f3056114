// Shows FoldBench (bench.py): a strip of weights that folds over its centre, a wire that is a joint's
// path in the window, and under each weight the product of both, which adds up in a jar for each part.

import { besideOf, draggable } from "ddlib/dragging.js";
import { buttonOf, dress, make, onKeys, put, safely, short, write } from "ddlib/elements.js";
import { frameOf } from "ddlib/frame.js";

const PARTS = { constant: "Constant", even: "Even half", odd: "Odd half" };
const WIRE = { lift: ["lift", "°"], tilt: ["tilt", "°/s"], bend: ["bend", "°/s²"] };
const TALLEST = 15; // degrees at the edge of the wire's field
const RISE = 22; // px by which the strip's edge comes up while it turns
const NEARER = 0.12; // by which that edge looks larger then
const PAPER = 16; // px of paper beyond the outermost weights
const RAD = Math.PI / 180;
const BESIDE = 204; // px beside the fields of a wide bench: sentence, jars, numbers
const SIGNS = {
  fold: "M-3 -5h0M3 -5h0M-3 0h0M3 0h0M-3 5h0M3 5h0",
  lift: "M0 -6V6M-3 -3L0 -6L3 -3M-3 3L0 6L3 3",
  tilt: "M-6 -1A6 6 0 0 1 5 -3M5 -7V-3H1M6 1A6 6 0 0 1 -5 3M-5 7V3H-1",
  bend: "M-6 0C-4 6 4 6 6 0M0 4V-6M-3 -3L0 -6L3 -3",
};
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
  let most, tall; // of a jar and of a product, if the wire moves in one way
  let highest; // of what is played
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

  const said = make("p", { class: "verdict", role: "status" });
  const aside = make("div", { class: "says" }, said);

  // The drawing
  const text = (kind, words = "") => make("text", { class: kind }, words);
  const group = (kind, ...children) => make("g", { class: kind }, ...children);
  const handleOf = (name, words) => {
    const dot = make("circle", { class: "dot", r: 13 });
    const sign = make("path", { class: "sign", d: SIGNS[name] });
    const label = text("handle-name", name === "fold" ? "" : name);
    const g = make("g", { class: `grip ${name}`, role: "slider", tabindex: 0, "aria-label": words }, dot, sign, label);
    return { g, dot, label };
  };
  const strip = {
    left: make("rect", { class: "left" }), // where the flap lay
    shade: make("polygon", { class: "shade" }),
    sheet: make("polygon", { class: "sheet" }),
    flap: make("polygon", { class: "flap" }),
    zero: make("line", { class: "zero" }),
    crease: make("line", { class: "crease" }),
    ghosts: group("ghosts"),
    stems: group("stems"),
    pieces: group("pieces"),
    over: make("path", { class: "over" }),
  };
  const wire = { zero: make("line", { class: "zero" }), stems: make("path", { class: "reach" }), path: make("path", { class: "wire" }), dots: group("beads") };
  const grips = {
    fold: handleOf("fold", "Fold the strip"),
    bend: handleOf("bend", "Bend the wire"),
    lift: handleOf("lift", "Lift the wire"),
    tilt: handleOf("tilt", "Tilt the wire"),
  };
  const bands = Object.entries(PARTS).map(([name, words]) => {
    const jar = { level: make("path", {}), number: text("number"), how: text("how") };
    const glass = make("path", { class: "glass" });
    const bits = { bars: group("bars"), arc: make("path", { class: "arc" }), pair: text("pair"), thumbs: group("thumbs") };
    const traces = { wanted: make("path", { class: "expected" }), got: make("path", { class: "trace" }) };
    const label = text(`name ${name}`, words);
    const shelf = { zero: make("line", { class: "zero" }), pours: make("path", { class: "pours" }), glass };
    const g = group(`band ${name}`, label, ...Object.values(bits), ...Object.values(traces), ...Object.values(jar));
    return { name, g, label, jar, shelf, ...bits, ...traces };
  });
  const [stripName, wireName] = [text("name", "The row"), text("name shoulder", "The joint")];
  const [stripSub, wireSub] = [text("how", `${n} weights`), text("how", "its path, a wire")];
  const hint = text("hint x", "Empty, until you fold the strip");
  const axis = group("axis");
  const guides = make("path", { class: "guides" });
  const svg = make(
    "svg",
    { class: "bench", role: "group", "aria-label": `${title}: strip, wire and jars` },
    guides, stripName, stripSub, strip.left, strip.shade, strip.sheet, strip.zero, strip.ghosts, strip.stems, strip.flap,
    strip.pieces, strip.crease, strip.over, grips.fold.g,
    wireName, wireSub, wire.zero, wire.stems, wire.path, wire.dots, grips.bend.g, grips.lift.g, grips.tilt.g,
    ...bands.flatMap(({ shelf, g }) => [shelf.zero, shelf.pours, g, shelf.glass]), hint, axis,
  ); // prettier-ignore
  const at = {}; // places of the drawing, set by layout()
  function layout() {
    const wide = el.clientWidth || 640;
    const narrow = wide < 620;
    Object.assign(at, { wide, narrow, x0: narrow ? 30 : 120, x1: wide - (narrow ? 84 : BESIDE + 16) });
    const name = narrow ? 20 : 0; // room above a field for its name
    let y = 0;
    const field = (height, over = 0) => {
      const top = y + name + over;
      y = top + height + 6;
      return { top, height, middle: top + height / 2, name: narrow ? top - 12 - over : top + height / 2 };
    };
    at.strip = field(84, narrow ? 14 : RISE);
    at.wire = field(90);
    at.bands = bands.map(() => field(48));
    const high = y + (narrow ? 24 : 48);
    put(svg, { width: wide, height: high, viewBox: `0 0 ${wide} ${high}` });
    at.axis = y + 18;
    put(hint, { x: (at.x0 + at.x1) / 2, y: at.bands[1].top - 4 });
    for (const [label, below, place] of [[stripName, stripSub, at.strip], [wireName, wireSub, at.wire]]) {
      put(label, { x: 0, y: place.name - (narrow ? 0 : 8) });
      put(below, { x: 0, y: place.name + 16, visibility: narrow ? "hidden" : "visible" });
    }
    bands.forEach(({ label }, i) => put(label, { x: 0, y: at.bands[i].name - (narrow ? 0 : 12) }));
    const ends = [0, half, n - 1].map((k) => `M${xOf(k)} ${at.wire.top}V${y + 6}`);
    put(guides, { d: ends.join("") });
    el.classList.toggle("wide", !narrow);
    put(aside, { style: narrow ? "" : `left: ${at.x1 + 44}px` });
    at.jar = at.x1 + (narrow ? 32 : 44);
    at.jarWide = narrow ? 40 : 60;
    bands.forEach(({ shelf }, i) => {
      const { top, height, middle } = at.bands[i];
      level(shelf.zero, at.bands[i]);
      const [from, to] = [at.x1 + 10, at.jar - 9];
      const zero = `M${at.jar} ${middle}h${at.jarWide}`;
      put(shelf.pours, { d: narrow ? zero : `${zero}M${from} ${middle}H${to}M${to - 4} ${middle - 4}L${to} ${middle}L${to - 4} ${middle + 4}` });
      const ticks = [0.28, 0.72].map((share) => `M${at.jar + at.jarWide} ${short(top + share * height)}h-7`);
      put(shelf.glass, { d: `M${at.jar - 4} ${top}q4 0 4 4v${height - 12}q0 8 8 8h${at.jarWide - 16}q8 0 8 -8v${12 - height}q0 -4 4 -4${ticks.join("")}` });
    });
  }
  function drawAxis() {
    const last = (motion[0].length - n) * step;
    const words = moment < 0 ? [`−${1e3 * step * half} ms`, "now", `${1e3 * step * half} ms`] : ["0 s", "", `${short(last)} s`];
    axis.replaceChildren(...words.map((word, k) => make("text", { class: "x", x: Math.max(28, xOf(k * half)), y: at.axis }, word)));
  }
  const xOf = (k) => short(at.x0 + (k / (n - 1)) * (at.x1 - at.x0));
  const level = (line, place) => put(line, { x1: at.x0, x2: at.x1, y1: place.middle, y2: place.middle });

  // A weight as a stem: filled if positive, hollow if negative, dotted if seen through the paper; as
  // `wide` as it looks on a flap that turns.
  function stem(left, base, height, kind = "", wide = 1) {
    const place = `translate(${short(left)} ${short(base - height)}) scale(${short(Math.max(0.3, wide))} 1)`;
    const dot = make("circle", { class: `weight ${height < 0 ? "hollow" : ""} ${kind}`, transform: place, r: at.narrow ? 3.2 : 4.5 });
    return [make("line", { class: `stem ${kind}`, x1: short(left), x2: short(left), y1: short(base), y2: short(base - height) }), dot];
  }
  function drawStrip() {
    const { top, height, middle } = at.strip;
    const [fold, centre, reachX] = [get("fold"), xOf(half), xOf(n - 1) - xOf(half)];
    const turn = Math.PI * fold;
    const scale = (0.42 * height) / largest(row);
    const edge = centre + (reachX + PAPER) * Math.cos(turn);
    const [up, more] = [RISE * Math.sin(turn), (NEARER * Math.sin(turn) * height) / 2];
    const right = xOf(n - 1) + PAPER;
    const corners = (points) => points.map((point) => point.map(short).join()).join(" ");
    put(strip.left, { x: centre, y: top, width: right - centre, height });
    put(strip.shade, { points: corners(fold < 0.5 ? [[centre, top + 8], [(edge + 2 * right) / 3, top + 14], [(edge + 2 * right) / 3, top + height], [centre, top + height]] : []) });
    put(strip.sheet, { points: corners([[xOf(0) - PAPER, top], [centre, top], [centre, top + height], [xOf(0) - PAPER, top + height]]) });
    put(strip.flap, { points: corners([[centre, top], [edge, top - up - more], [edge, top + height - up + more], [centre, top + height]]) });
    put(strip.zero, { x1: xOf(0) - PAPER, x2: centre, y1: middle, y2: middle });
    put(strip.crease, { x1: centre, x2: centre, y1: top - 6, y2: top + height + 6 });
    const [from, to] = [centre + 0.62 * reachX, centre - 0.4 * reachX];
    put(strip.over, { d: fold < 0.35 ? `M${short(from)} ${top - 10}Q${centre} ${top - 40} ${short(to)} ${top - 8}M${short(to + 3)} ${top - 16}L${short(to)} ${top - 8}L${short(to + 9)} ${top - 7}` : "M0 0" });
    const over = fold > 0.5;
    const stems = row.flatMap((f, k) => {
      if (k <= half) return stem(xOf(k), middle, scale * f);
      const share = (k - half) / half;
      const tall = scale * f * (1 + NEARER * Math.sin(turn) * share);
      return stem(centre + share * reachX * Math.cos(turn), middle - up * share, tall, over ? "behind" : "", Math.abs(Math.cos(turn)));
    });
    strip.stems.replaceChildren(...stems);
    const lands = fold > 0.2 && fold < 1 ? row.slice(half + 1) : []; // where the mirror image will lie
    strip.ghosts.replaceChildren(...lands.map((f, k) => make("circle", { class: "ghost", cx: xOf(half - 1 - k), cy: short(middle - scale * f), r: at.narrow ? 3.2 : 4.5 })));
    svg.insertBefore(strip.flap, over ? strip.zero : strip.stems);
    const pieces = fold === 1 ? row.slice(0, half + 1).flatMap((_, k) => {
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
    const percent = Math.round(100 * fold);
    put(g, { "aria-valuemin": 0, "aria-valuemax": 100, "aria-valuenow": percent, "aria-valuetext": `${percent} %` });
  }
  const now = () => (moment < 0 ? angles(x, { lift: get("lift"), tilt: get("tilt"), bend: get("bend") }) : motion[0].slice(moment, moment + n).map((q) => q / RAD));
  function drawWire(path) {
    const { middle, height } = at.wire;
    const scale = height / 2 / (moment < 0 ? TALLEST : widest * 1.05);
    const y = path.map((q) => short(middle - scale * q));
    level(wire.zero, at.wire);
    put(wire.stems, { d: y.map((v, k) => `M${xOf(k)} ${middle}V${v}`).join("") });
    put(wire.path, { d: `M${y.map((v, k) => `${xOf(k)} ${v}`).join("L")}` });
    wire.dots.replaceChildren(...y.map((v, k) => make("circle", { class: "bead", cx: xOf(k), cy: v, r: at.narrow ? 2.5 : 3.5 })));
    const places = { bend: 0, lift: half, tilt: n - 1 };
    for (const [name, k] of Object.entries(places)) {
      const { g, label } = grips[name];
      const value = Math.round(get(name) * 10) / 10;
      g.style.display = moment < 0 ? "" : "none";
      put(g, { transform: `translate(${xOf(k)} ${y[k]})`, "aria-valuemin": -reach[name], "aria-valuemax": reach[name], "aria-valuenow": value });
      put(g, { "aria-valuetext": minus(`${value} ${WIRE[name][1]}`) });
      put(label, { x: name === "tilt" && !at.narrow ? 18 : 0, y: name === "tilt" && !at.narrow ? 5 : y[k] < middle ? -19 : 29, class: `handle-name ${name === "tilt" && !at.narrow ? "" : "x"}` });
    }
  }
  const digits = () => Math.min(4, Math.max(0, 1 - Math.floor(Math.log10(most))));
  const numberOf = (value) => minus(value.toFixed(digits()).replace(/^-(0(\.0*)?)$/, "$1"));
  function drawBands(path) {
    const open = get("fold") === 1;
    hint.style.display = open ? "none" : "";
    const playing = moment >= 0;
    const poured = bands.map(({ name }) => parts[name].map((f, k) => f * path[k] * RAD));
    const longest = Math.max(tall, largest(poured.flat())); // of one scale in all lanes: nothing is cut
    const full = playing ? highest : Math.max(most, largest(poured.map(sum)));
    bands.forEach((band, i) => {
      const { middle, height, top } = at.bands[i];
      band.g.style.display = open ? "" : "none";
      const products = poured[i];
      const whole = sum(products);
      const width = 0.62 * (xOf(1) - xOf(0));
      const y = (value) => (value / longest) * (height / 2);
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
      const [a, both] = [first, first + last].map((value) => Number(value.toFixed(digits())));
      const b = both - a; // the second as printed, so that the sum closes
      write(band.pair, told ? `outer pair: ${numberOf(a)} ${b < 0 ? "−" : "+"} ${numberOf(Math.abs(b))} = ${numberOf(both)}` : "");
      // the row's part, small
      const thumb = largest([...parts.even, ...parts.odd]) / 10;
      const spot = (k) => 2 + 4.2 * k;
      band.thumbs.replaceChildren(...(at.narrow ? [] : parts[band.name].map((f, k) => make("path", { class: "thumb", d: `M${spot(k)} ${middle + 15}V${short(middle + 15 - f / thumb)}M${spot(k)} ${short(middle + 15 - f / thumb)}h0` }))));
      // the jar
      const fill = (whole / full) * (height / 2 - 5); // from zero, in the middle
      const [left, wave] = [at.jar + 2.5, (at.jarWide - 5) / 4];
      const surface = `q${wave / 2} -4 ${wave} 0t${wave} 0t${wave} 0t${wave} 0`;
      put(band.jar.level, { class: whole < 0 ? "level hollow" : "level", d: Math.abs(fill) < 1 ? "M0 0" : `M${left} ${short(middle - fill)}${surface}V${middle}H${left}Z` });
      put(band.jar.number, at.narrow ? { x: at.jar + at.jarWide + 4, y: at.bands[i].name, class: "number y" } : { x: at.jar + at.jarWide + 12, y: middle + 2, class: "number" });
      put(band.jar.how, { x: at.jar + at.jarWide + 12, y: middle + 18 });
      write(band.jar.number, numberOf(whole));
      write(band.jar.how, playing || at.narrow ? "" : howOf(products, whole));
    });
  }
  // How the products add up.
  function howOf(products, whole) {
    const size = sum(products.map(Math.abs));
    if (size < 0.02 * most) return "nearly nothing";
    const unlike = largest(products.map((value, k) => value + products[n - 1 - k]));
    if (unlike < 0.01 * largest(products)) return "pairs cancel";
    return Math.abs(whole) < 0.2 * size ? "mostly cancels" : "adds up";
  }

  // What the bench says
  const share = (value) => `${Math.round(100 * value)} %`;
  function sentence(path) {
    if (get("fold") < 1) return "Take the strip by its right edge and fold it over. By keyboard: arrow keys on the round handles.";
    if (moment >= 0) {
      const { odd, even, constant } = played;
      const leak = largest(constant.got) > 0.1 * highest ? " The constant lets position leak in." : "";
      return `Dashed: the joint’s speed and acceleration, each times a number. They explain ${share(odd.told)} of the odd jar and ${share(even.told)} of the even jar.${leak}`;
    }
    if (!get("lift") && !get("tilt") && !get("bend")) return "What agrees with its mirror image is the even half, what opposes it the odd half. Now move the wire.";
    const moved = Object.keys(WIRE).filter((name) => Math.abs(get(name)) > 0.02 * reach[name]);
    const words = { lift: "Lifted: the joint stands still.", tilt: "Tilted: a steady speed.", bend: "Bent: the joint speeds up." };
    const what = moved.length === 1 ? words[moved[0]] : "Several at once.";
    const filled = bands.filter(({ name }) => Math.abs(sum(parts[name].map((f, k) => f * path[k] * RAD))) > 0.1 * most);
    const names = filled.map(({ name }) => name);
    if (!names.length) return `${what} No jar gets much.`;
    return `${what} ${names.length === 1 ? `Only the ${names[0]} jar moves.` : `These jars move: ${names.join(", ")}.`}`;
  }

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
  play.classList.add("play");
  const choices = labels.map((label) => buttonOf(label, () => set({ row: label })));
  const bar = make("div", { class: "presets" }, make("span", {}, "Row"), ...choices);

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
      return set({ fold: folded > 0.75 ? 1 : Math.round(200 * folded) / 200 });
    }
    const angle = ((at.wire.middle - top) * 2 * TALLEST) / at.wire.height;
    const t = x[n - 1];
    const to = {
      lift: angle,
      tilt: (angle - get("lift") - (get("bend") * t * t) / 2) / t,
      bend: (2 * (angle - get("lift") + get("tilt") * t)) / (t * t),
    };
    const share = Math.round((100 * to[held]) / reach[held]) / 100;
    bendTo(held, Math.abs(share) < 0.08 ? 0 : share * reach[held]); // what is nearly straight is straight
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
      const over = pressed === "ArrowLeft" || pressed === "ArrowRight" ? -steps : steps; // the edge goes where the key points
      if (name === "fold") return set({ fold: ends ? (ends + 1) / 2 : Math.min(1, Math.max(0, get("fold") + 0.1 * over)) });
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
  el.replaceChildren(frame.el, bar, make("div", { class: "board" }, svg, aside, play));
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
