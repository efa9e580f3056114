// Shows Hero (hero.py): an arm to throw, the windows of its joints against their chords, threads from
// the shoulder's window to two rows of weights, and a balance for the network of each row.

import { buttonOf, dress, make, numbersOf, onKeys, put, safely, short, write } from "ddlib/elements.js";
import { JOINTS, NAMES, activity, networkOf, placesOf, scaledWindow, torqueOfOutput } from "ddlib/engine.js";
import { frameOf } from "ddlib/frame.js";
import { balanceOf, number, point, tiltOf } from "./balance.js";
import { worldOf } from "./world.js";

const FACING = (85 * Math.PI) / 180; // which way the arm points at zero angles
const NUDGE = 120; // ms that a key pulls at least
const PULLS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
const LEAD = 0.6; // s before the moment at which the arm stops, from which it is slow
const SLOW = 0.4;
const SWING = 1400; // ms in which a balance settles

// Where every piece stands, for a width. Beside each other where there is room, else in two columns.
function placesIn(wide) {
  if (wide >= 700) {
    const s = Math.min(1.15, wide / 1120);
    const [x, y] = [(v) => s * v, (v) => s * v];
    return {
      s, wide, high: 548 * s,
      base: [x(122), y(444)], metre: 335 * s, thick: 27 * s, arcs: [[68, 86, 102], [48, 64, 79]].map((r) => r.map((v) => v * s)),
      torque: [x(0), y(20)], says: [x(0), y(46)], // where no arc comes
      elbow: { from: x(230), to: x(370), y: y(40), name: [x(230), y(24)] },
      rows: { from: x(462), to: x(756), A: y(92), B: y(424), tall: 54 * s, badge: x(414), dot: 4.6 * s },
      chord: { from: x(482), to: x(736), y: y(258), name: [x(440), y(232)] },
      note: [x(609), y(518)],
      scales: { x: x(962), half: x(108), A: y(40), B: y(342), post: 126 * s, rope: 62 * s, verdict: 163 * s },
      button: [x(962) - 70 * s, y(222), 140 * s, 46 * s], under: [x(962), y(289)], bait: null,
    };
  }
  const s = Math.min(1.3, wide / 358);
  const x = (v) => s * v;
  return {
    narrow: true, s, wide: Math.min(wide, x(358)), high: x(530),
    base: [x(46), x(168)], metre: x(172), thick: x(15), arcs: [[38, 50, 60], [28, 38, 48]].map((r) => r.map(x)),
    torque: [x(232), x(124)], says: [x(232), x(150)],
    elbow: { from: x(240), to: x(346), y: x(52), name: [x(234), x(38)] },
    rows: { from: x(50), to: x(198), A: x(252), B: x(450), tall: x(34), badge: x(16), dot: x(3.1) },
    chord: { from: x(60), to: x(188), y: x(345), name: [x(60), x(334)] },
    note: [0, x(505)],
    scales: { x: x(284), half: x(46), A: x(200), B: x(366), post: x(92), rope: x(50), verdict: x(116) },
    button: null, under: [0, x(523)], bait: [x(232), x(150)],
  };
}

const rise = (path) => path.map((q, k) => q - path[0] - ((path.at(-1) - path[0]) * k) / (path.length - 1));

function build({ model, el }) {
  const spec = model.get("spec");
  const { width, arm, networks: specs } = spec;
  dress(el, spec.title, "ddlib-hero", "quiet");
  const values = numbersOf(model.get("weights"), "Float32");
  const each = values.length / specs.length;
  const networks = specs.map((network, k) => {
    const net = networkOf(network.layout, values.subarray(k * each, (k + 1) * each));
    return { ...network, net, row: [...net.hiddenWeights.subarray(0, width)] }; // unit 1, shoulder
  });
  const world = worldOf(spec);
  const { lengths } = spec.plant;
  const calm = matchMedia("(prefers-reduced-motion: reduce)");
  const half = width >> 1;
  const get = (name) => model.get(name);
  let at = placesIn(el.clientWidth || 1120);

  // The drawing
  const text = (kind, words = "") => make("text", { class: kind }, words);
  const group = (kind, ...children) => make("g", { class: kind }, ...children);
  const path = (kind) => make("path", { class: kind });
  const line = (kind) => make("line", { class: kind });
  const letter = (name) => group("letter", make("circle", {}), text("x", name));
  const say = (name) => text(`name ${name}`, `${name}, 0.2 s`);

  const links = ["shoulder", "elbow"].map((name) => line(`link ${name}`));
  const joints = ["shoulder", "elbow", "elbow hand"].map((name) => make("circle", { class: `joint ${name}` }));
  const ground = path("ground");
  const rope = line("rope");
  const handle = group("hand-handle", make("circle", { class: "room" }), make("circle", { class: "ring" }));
  put(handle, { tabindex: 0, role: "application", "aria-roledescription": "handle" });
  handle.dataset.runs = ""; // for benchmarks
  handle.setAttribute("aria-label", "The arm's hand: arrow keys pull it for as long as they are pressed");
  const bait = text("bait", "drag or throw");
  const arcs = JOINTS.map(() => ["truth", ...networks.map(() => "told")].map((kind) => ({
    path: path(`arc ${kind}`), head: path(`head ${kind}`),
  })));
  const letters = JOINTS.map(() => networks.map(({ name }) => letter(name)));
  const told = group("guessed", ...JOINTS.flatMap((j) => [...arcs[j].slice(1).flatMap(Object.values), ...letters[j]]));
  const truth = group("true", ...JOINTS.flatMap((j) => Object.values(arcs[j][0])));
  const strands = JOINTS.map((j) => ({
    area: path("area"), chord: line("chord"), beads: group(`beads ${NAMES[j]}`), lead: path(`lead ${NAMES[j]}`), name: say(NAMES[j]),
  }));
  strands.forEach(({ beads }) => beads.append(...networks[0].row.map(() => make("circle", {}))));
  const bend = text("bend x");
  const hatch = path("hatch");
  const rows = networks.map(({ name, row }) => {
    const stems = row.map((w) => [line("stem"), make("circle", { class: w < 0 ? "weight hollow" : "weight" })]);
    const threads = row.map((w) => (w < 0 ? [path("thread"), path("thread inner")] : [path("thread")]));
    const badge = make(
      "g",
      { class: "badge", role: "button", tabindex: 0, "aria-pressed": "false", "aria-label": `${name} has met this arm` },
      make("circle", { class: "room" }), make("circle", { class: "ring" }), make("circle", { class: "disc" }), text("x", name),
    ); // prettier-ignore
    return { name, stems, threads, badge, zero: line("zero"), most: Math.max(...row.map(Math.abs)) };
  });
  const note = text("small");
  const keys = [[path("arc truth"), text("y0", "torque")], [path("arc told"), text("y0", "what A and B say")]];
  const legend = [group("legend-truth", ...keys[0]), group("legend-told", ...keys[1])];
  const scales = networks.map(({ name }) => {
    const balance = balanceOf("this arm", name);
    const verdict = text("verdict x");
    return { ...balance, verdict, g: group("scale", balance.el, verdict) };
  });
  const under = text("small", "Weighed: all rows of each network.");
  const svg = make(
    "svg",
    { class: "stage", role: "group", "aria-label": "An arm, the windows of its joints, two rows of weights and two balances" },
    ...rows.flatMap(({ threads }) => threads.flat()),
    ...strands.flatMap(({ lead }) => lead),
    ...strands.flatMap(({ area, chord, beads, name }) => [area, chord, beads, name]),
    bend,
    ...rows.flatMap(({ zero, stems }) => [zero, ...stems.flat()]),
    ground, hatch, ...links, ...joints.slice(0, 2), told, truth, joints[2], rope, handle, bait,
    ...rows.map(({ badge }) => badge),
    note, ...legend, ...scales.map(({ g }) => g), under,
  ); // prettier-ignore

  function layout() {
    at = placesIn(el.clientWidth - 8 || 1120); // without the padding
    const { s, base, chord, elbow, rows: place } = at;
    put(svg, { width: at.wide, height: at.high, viewBox: `0 0 ${at.wide} ${at.high}` });
    svg.style.setProperty("--s", s);
    el.classList.toggle("narrow", Boolean(at.narrow));
    const [x, y] = base;
    const w = at.thick;
    put(ground, { d: `M${point(x - 0.7 * w, y)}L${point(x - w, y + 1.8 * w)}H${short(x + w)}L${point(x + 0.7 * w, y)}M${point(x - 2.2 * w, y + 1.8 * w)}H${short(x + 2.2 * w)}` });
    const strokes = Array.from({ length: 9 }, (_, k) => `M${point(x + (0.55 * k - 2) * w, y + 1.8 * w)}l${point(-0.4 * w, 0.4 * w)}`);
    put(hatch, { d: strokes.join("") });
    for (const link of links) link.style.strokeWidth = w;
    joints.forEach((joint, k) => put(joint, { r: [0.72, 0.62, 0.55][k] * w }));
    put(handle.children[0], { r: Math.max(26, w) });
    put(handle.children[1], { r: 0.85 * w });
    for (const marks of letters) for (const { firstChild } of marks) put(firstChild, { r: 9 * Math.min(1, s) });
    strands.forEach(({ name, beads }, j) => {
      const [left, top] = (j ? elbow : chord).name;
      put(name, { x: left, y: top, "text-anchor": j || at.narrow ? "start" : "end" });
      for (const bead of beads.children) put(bead, { r: (j ? 0.78 : 1) * (at.narrow ? 3.4 : 5 * s) });
    });
    const step = (place.to - place.from) / (width - 1);
    rows.forEach(({ name, stems, threads, zero, badge, most }, k) => {
      const level = place[name];
      put(zero, { x1: place.from - 8 * s, x2: place.to + 8 * s, y1: level, y2: level });
      stems.forEach(([stem, dot], i) => {
        const left = short(place.from + i * step);
        const top = short(level - (place.tall * networks[k].row[i]) / most);
        put(stem, { x1: left, x2: left, y1: level, y2: top });
        put(dot, { cx: left, cy: top, r: place.dot });
        const thick = (Math.abs(networks[k].row[i]) / most) * 7 * Math.min(1, s);
        const [outer, inner] = threads[i];
        outer.style.strokeWidth = short(inner ? thick + 1.6 : Math.max(0.5, thick));
        if (inner) inner.style.strokeWidth = short(thick);
      });
      badge.setAttribute("transform", `translate(${place.badge} ${level})`);
      [24, 20, 16].forEach((r, i) => put(badge.children[i], { r: at.narrow ? 0.82 * r : r * s }));
    });
    const largest = (k) => `${networks[k].name} ${Number(rows[k].most.toPrecision(2))}`;
    put(note, { x: at.note[0], y: at.note[1], "text-anchor": at.narrow ? "start" : "middle" });
    write(note, `Each row to its own height: largest ${at.narrow ? "" : "weight "}${largest(0)}, ${largest(1)}.`);
    keys.forEach(([key, words], k) => {
      const [left, middle] = k ? at.says : at.torque;
      put(key, { d: `M${point(left, middle - 5)}h30` });
      put(words, { x: left + 38, y: middle });
    });
    write(keys[1][1], at.narrow ? "A and B" : "what A and B say it is");
    const box = at.button?.map((v) => `${v}px`) ?? ["", "", "", ""]; // else below the words
    ["left", "top", "width", "height"].forEach((side, k) => (weigh.style[side] = box[k]));
    put(under, { x: at.under[0], y: at.under[1], "text-anchor": at.narrow ? "start" : "middle" });
  }

  // What stands in the window at a moment between two samples, and in its middle.
  let owed = 0; // s of simulated time
  function seen() {
    const { samples } = world;
    const phase = Math.min(1, (((world.count - 1) % spec.every) + owed / spec.step) / spec.every);
    const first = samples.length - width - 1;
    const mix = (of, k) => (1 - phase) * of(samples[first + k]) + phase * of(samples[first + k + 1]);
    const paths = JOINTS.map((j) => networks[0].row.map((_, k) => mix((s) => s.q[j], k)));
    return { paths, tau: JOINTS.map((j) => mix((s) => s.tau[j], half)), q: paths.map((x) => x[half]) };
  }

  // Torques as arcs, from the direction of the link
  function arc({ path: curve, head }, [x, y], radius, from, torque, most) {
    const turn = Math.max(-2.4, Math.min(2.4, (1.6 * torque) / most));
    const tip = 8 * Math.min(1.1, at.s) * (head.classList.contains("truth") ? 1.25 : 1);
    const on = (angle, r = radius) => [x + r * Math.cos(angle), y - r * Math.sin(angle)];
    const small = Math.abs(turn) * radius < tip; // an arrow that would be all head
    const end = from + turn - (Math.sign(turn) * Math.min(Math.abs(turn), 0.8 * tip / radius));
    put(curve, { d: small ? "M0 0" : `M${point(...on(from))}A${short(radius)} ${short(radius)} 0 0 ${turn > 0 ? 0 : 1} ${point(...on(end))}` });
    const reach = from + turn + (Math.sign(turn) * 0.6 * tip) / radius;
    put(head, { d: small ? "M0 0" : `M${point(...on(reach))}L${point(...on(end, radius + 0.75 * tip))}L${point(...on(end, radius - 0.75 * tip))}Z` });
    return on(reach + (Math.sign(turn || 1) * 13 * Math.min(1, at.s)) / radius, radius);
  }
  let lastHand = [0, 0];
  function drawArm({ q, tau, paths }) {
    const turned = [q[0] + FACING, q[1]];
    const [x, y] = at.base;
    const places = placesOf(lengths, turned).map(([a, b]) => [x + at.metre * a, y - at.metre * b]);
    const [elbow, hand] = places;
    lastHand = hand;
    put(links[0], { x1: x, y1: y, x2: short(elbow[0]), y2: short(elbow[1]) });
    put(links[1], { x1: short(elbow[0]), y1: short(elbow[1]), x2: short(hand[0]), y2: short(hand[1]) });
    [at.base, elbow, hand].forEach(([cx, cy], k) => put(joints[k], { cx: short(cx), cy: short(cy) }));
    handle.setAttribute("transform", `translate(${point(...hand)})`);
    const [baitX, baitY] = at.bait ?? [hand[0] + 1.1 * at.thick, hand[1] + 5];
    put(bait, { x: short(baitX), y: short(baitY) });
    const window = Float64Array.from(paths.flat());
    const said = networks.map((network) => torqueOfOutput(network, activity(network.net, scaledWindow(network, window)).output));
    const directions = [turned[0], turned[0] + turned[1]];
    JOINTS.forEach((j) => {
      [tau, ...said].forEach((torque, k) => {
        const [cx, cy] = arc(arcs[j][k], j ? elbow : at.base, at.arcs[j][k], directions[j], torque[j], spec.torques[j]);
        if (k) letters[j][k - 1].setAttribute("transform", `translate(${point(cx, cy)})`);
      });
    });
    const middle = (a, b) => a.map((v, i) => (v + b[i]) / 2);
    const [upper, fore] = [middle(at.base, elbow), middle(elbow, hand)];
    const goal = [at.chord.from - 8, at.chord.y];
    const bowed = `C${point(upper[0] + 100, upper[1] + 30)} ${point(goal[0] - 120, goal[1])} ${point(...goal)}`;
    put(strands[0].lead, { d: at.narrow ? "M0 0" : `M${point(...upper)}${bowed}` });
    const over = at.narrow ? [at.elbow.from - 6, at.elbow.y] : [(at.elbow.from + at.elbow.to) / 2, at.elbow.y + 44 * at.s];
    const via = at.narrow ? [(fore[0] + over[0]) / 2, over[1]] : [over[0], (fore[1] + over[1]) / 2 + 10];
    put(strands[1].lead, { d: `M${point(...fore)}Q${point(...via)} ${point(...over)}` });
  }

  // Beads against their chord, and the threads to both rows
  function drawStrand(j, path) {
    const { from, to, y } = j ? at.elbow : at.chord;
    const { area, chord, beads } = strands[j];
    const bent = rise(path).map((q) => (q * 180) / Math.PI);
    const most = Math.max(...bent.map(Math.abs));
    const room = (j ? 34 : 62) * Math.min(1.1, at.s);
    const scale = Math.min((j ? 40 : 32) * Math.min(1.1, at.s), room / Math.max(most, 1e-9));
    const places = bent.map((v, k) => [from + ((to - from) * k) / (width - 1), y - scale * v]);
    put(chord, { x1: from, x2: to, y1: y, y2: y });
    put(area, { d: `M${places.map((p) => point(...p)).join("L")}Z` });
    [...beads.children].forEach((bead, k) => put(bead, { cx: short(places[k][0]), cy: short(places[k][1]) }));
    const down = bent[half] < 0;
    if (j) return put(strands[1].name, { y: y + (down ? -16 : 28) });
    put(bend, { x: (from + to) / 2, y: y + (down ? -9 : 20) });
    write(bend, `bend ${number(most)}°`);
    if (at.narrow) write(strands[0].name, `shoulder, bend ${number(most)}°`);
    else write(strands[0].name, "shoulder, 0.2 s");
    rows.forEach(({ name, threads }, k) => {
      const level = at.rows[name];
      const step = (at.rows.to - at.rows.from) / (width - 1);
      places.forEach(([left, top], i) => {
        const [x2, y2] = [at.rows.from + i * step, level + (k ? -1 : 1) * 1.5];
        const middle = (top + y2) / 2;
        const d = `M${point(left, top)}C${point(left, middle)} ${point(x2, middle)} ${point(x2, y2)}`;
        for (const thread of threads[i]) put(thread, { d });
      });
    });
  }

  // The balances; `swung` goes from 0, level, to 1, where the weights leave them.
  let swung = 1;
  let load = 1; // how much of it lies on the pans
  function drawScales() {
    const { verdict, ...place } = at.scales;
    const weighed = get("weighed");
    scales.forEach((scale, k) => {
      const { name, weight, learnt } = networks[k];
      const { s, narrow } = at;
      const how = weighed ? { tilt: swung * tiltOf(arm, weight), load } : { tilt: 0 };
      scale.draw({ ...place, top: place[name], s, narrow }, arm, weighed ? weight : null, how);
      scale.pans[0].name.style.display = at.narrow ? "none" : "";
      put(scale.verdict, { x: place.x, y: place[name] + verdict });
      write(scale.verdict, weighed ? `${name} learnt ${learnt}.` : "");
    });
  }

  // What is said
  let asked = false; // for a guess, by a first press
  const said = make("p", { class: "verdict", role: "status" });
  const kg = (x) => `${number(x)} kg m²`;
  const right = networks.reduce((a, b) => (Math.abs(a.weight - arm) < Math.abs(b.weight - arm) ? a : b)).name;
  function tell() {
    const guess = get("guess");
    if (!get("weighed")) {
      const first = asked ? "A or B first?" : "Pick A or B, then weigh.";
      return said.replaceChildren(guess ? `You say ${guess}. Now weigh.` : first);
    }
    const weights = networks.map(({ name, learnt, weight }) => `${name} learnt ${learnt} and weighs ${kg(weight)}`);
    const verdict = guess && (guess === right ? "You were right. " : "Fooled. ");
    said.replaceChildren(
      verdict,
      make("span", { class: "spoken" }, `${weights.join(", ")}, the arm weighs ${kg(arm)}. `),
      "Now throw the arm and watch the dashed arcs.",
    );
  }
  function show() {
    const [guess, weighed] = [get("guess"), get("weighed")];
    rows.forEach(({ name, badge }) => {
      badge.setAttribute("aria-pressed", guess === name);
      if (weighed) badge.setAttribute("aria-disabled", "true");
      else badge.removeAttribute("aria-disabled");
    });
    el.classList.toggle("weighed", weighed);
    el.classList.toggle("asked", asked && !guess && !weighed);
    write(weigh, weighed ? "Again" : "Weigh");
    tell();
    drawScales();
  }
  function set(changes) {
    model.set(changes);
    model.save_changes();
    frame.changed();
  }
  const pick = (name) => get("weighed") || set({ guess: name });
  let swinging = 0;
  function swing() {
    cancelAnimationFrame(swinging);
    [swung, load] = calm.matches ? [1, 1] : [0, 0];
    show();
    if (calm.matches || !get("weighed")) return;
    const begin = performance.now();
    const turn = (now) => {
      const t = Math.min(1, Math.max(0, (now - begin) / SWING));
      load = Math.min(1, 5 * t);
      swung = t === 1 ? 1 : load === 1 ? 1 - Math.exp(-6 * (t - 0.2)) * Math.cos(14 * (t - 0.2)) : 0;
      drawScales();
      if (t < 1) swinging = requestAnimationFrame(turn);
    };
    swinging = requestAnimationFrame(turn);
  }
  function toggle() {
    const again = get("weighed");
    const ask = !again && !asked && !get("guess");
    asked = ask;
    if (ask) return show();
    set(again ? { weighed: false, guess: "" } : { weighed: true });
  }
  const weigh = buttonOf("Weigh", toggle, { class: "weigh" });
  rows.forEach(({ name, badge }) => {
    badge.addEventListener("click", () => pick(name));
    onKeys(badge, ({ key }) => (key === "Enter" || key === " " ? void pick(name) : false));
  });
  onKeys(el, ({ key }) => (key.toLowerCase() === "w" ? toggle() : false));

  // Time. The arm stops in the middle of a motion, so that its window never rests flat.
  let moving = 0;
  let last = 0;
  const arrives = () => world.mode === "play" && world.since() >= spec.moment;
  const draw = () => {
    const now = seen();
    drawArm(now);
    JOINTS.forEach((j) => drawStrand(j, now.paths[j]));
    const held = world.mode === "held";
    put(rope, { visibility: held && goal ? "visible" : "hidden" });
    if (held && goal) put(rope, { x1: short(lastHand[0]), y1: short(lastHand[1]), x2: goal[0], y2: goal[1] });
  };
  function run(now) {
    moving = 0;
    const slow = world.mode === "play" && world.since() > spec.moment - LEAD ? SLOW : 1;
    owed += slow * Math.min(0.05, Math.max(0, (now - last) / 1000));
    last = now;
    for (; owed >= spec.step && !arrives(); owed -= spec.step) world.period();
    if (world.still()) back();
    if (arrives()) owed = 0;
    else go();
    draw();
  }
  function go() {
    if (moving) return;
    moving = requestAnimationFrame(run);
  }
  function start() {
    if (!moving) last = performance.now();
    go();
  }
  // To the motion again, at once up to some seconds before the moment at which it stops.
  const skip = (before) => {
    while (world.since() < spec.moment - before) world.period();
  };
  function back() {
    if (calm.matches) open(); // nobody sees it go back
    else world.play();
  }
  function open() {
    world.stand([0, 0]);
    world.play();
    skip(calm.matches ? 0 : LEAD);
    owed = 0;
    draw();
  }

  // The hand
  let goal = null; // where the pointer pulls it, px
  let grip = null; // from the pointer to the hand, px
  const turnBack = ([x, y]) => {
    const [c, s] = [Math.cos(FACING), Math.sin(FACING)];
    return [c * x + s * y, c * y - s * x];
  };
  const placeOf = (event) => {
    const box = svg.getBoundingClientRect();
    const factor = at.wide / box.width;
    return [(event.clientX - box.x) * factor, (event.clientY - box.y) * factor];
  };
  const take = (pull) => {
    world.hold(pull);
    el.classList.add("taken");
    start();
  };
  const lead = (event) => {
    const [px, py] = placeOf(event);
    goal = [short(px + grip[0]), short(py + grip[1])];
    take({ place: turnBack([(goal[0] - at.base[0]) / at.metre, (at.base[1] - goal[1]) / at.metre]) });
  };
  const letGo = () => {
    goal = grip = null;
    if (world.mode === "held") world.release();
  };
  for (const part of [handle, ...links]) {
    part.addEventListener("pointerdown", (event) => {
      if (event.button || grip) return;
      event.preventDefault();
      part.setPointerCapture(event.pointerId);
      handle.focus({ preventScroll: true });
      const [px, py] = placeOf(event);
      grip = [lastHand[0] - px, lastHand[1] - py];
      lead(event);
    });
    part.addEventListener("pointermove", (event) => {
      if (grip && part.hasPointerCapture(event.pointerId)) lead(event);
    });
    // A style's touch-action does not hold for a part of a drawing everywhere.
    part.addEventListener("touchstart", (event) => event.preventDefault(), { passive: false });
    for (const end of ["pointerup", "pointercancel"]) part.addEventListener(end, letGo);
  }
  const pressed = new Map(); // keys, each with the time at which it went down
  function pullByKeys() {
    const push = [0, 1].map((i) => [...pressed.keys()].reduce((sum, key) => sum + PULLS[key][i], 0));
    if (push.some(Boolean)) take({ push: turnBack(push.map((x) => x / Math.hypot(...push))) });
    else letGo();
  }
  onKeys(handle, (event) => {
    if (!PULLS[event.key]) return false;
    if (event.repeat) return;
    pressed.set(event.key, performance.now());
    pullByKeys();
  });
  handle.addEventListener("keyup", ({ key }) => {
    const since = pressed.get(key);
    const loose = () => {
      if (pressed.get(key) !== since) return; // pressed again
      pressed.delete(key);
      pullByKeys();
    };
    const more = NUDGE - (performance.now() - since);
    if (more > 0) setTimeout(loose, more);
    else if (since !== undefined) loose();
  });
  handle.addEventListener("blur", () => {
    if (pressed.size) letGo();
    pressed.clear();
  });

  const frame = frameOf({ el, key: "hero", title: spec.title, linked: Boolean(model.kernelless), reset: () => {
    el.classList.remove("taken");
    asked = false;
    show();
    open();
    start();
  }, code: () => "" }); // prettier-ignore
  frame.keep("guess", () => get("guess"), (name) => {
    if (name && !rows.some((row) => row.name === name)) throw new Error(`guess is ${name}`);
    set({ guess: name });
  });
  frame.keep("weighed", () => String(get("weighed")), (text) => {
    set({ weighed: text === "true" });
  });
  const spoken = make("p", { class: "spoken" }, spec.spoken);
  el.replaceChildren(spoken, svg, said, weigh, frame.el);
  model.on("change:guess", show);
  model.on("change:weighed", swing);
  const sizes = new ResizeObserver(() => {
    layout();
    draw();
    drawScales();
  });
  layout();
  open();
  show();
  sizes.observe(el);
  // Once, when it comes into view, the motion goes on; nothing moves while it is out of sight.
  const sight = new IntersectionObserver(([entry]) => {
    if (entry.isIntersecting) return start();
    cancelAnimationFrame(moving);
    moving = 0;
  });
  sight.observe(svg);
  el.world = world; // for tests
  return () => {
    cancelAnimationFrame(moving);
    cancelAnimationFrame(swinging);
    for (const observer of [sizes, sight]) observer.disconnect();
    model.off("change:guess", show);
    model.off("change:weighed", swing);
    frame.stop();
  };
}

const render = safely(build);
export default { render };
