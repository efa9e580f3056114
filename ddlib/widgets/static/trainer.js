// Shows NetworkTrainer (engine/trainer.py): a network that learns in the page.

import { coloursOf, sheet, stroke } from "./canvas.js";
import { chart } from "./charts.js";
import { descent } from "./descent.js";
import {
  buttonOf, dress, freshId, make, numbersOf, onRecolour, safely, swatch, tableOf, write,
} from "./elements.js";
import { JOINTS, NAMES, activity, networkOf, torqueOfOutput } from "./engine.js";
import { accelerationGain, meanGradient, picksOf, recordingAt, scalingOf } from "./experiment.js";
import { filled, frameOf } from "./frame.js";
import { format } from "./numbers.js";
import { armMass } from "./physics.js";

const BUDGET = 7; // ms of a frame that may be spent on epochs
const REST = 2500; // ms between two runs of the loop
const OFTEN = 500; // ms between two reports to the kernel of a run that goes on
const SPEEDS = { slow: [10, "10 epochs a second"], even: [60, "60 epochs a second"], fast: [1e9, "as fast as it goes"] };
const SHORT = { velocity: "v", acceleration: "a", jerk: "j", "velocity + acceleration": "v+a", "acceleration + jerk": "a+j", "other mix": "mix" };

// Numbers between 0 and 1, the same for the same seed: the generator mulberry32.
function uniform(seed) {
  let state = seed >>> 0;
  return () => {
    state = (state + 0x6d2b79f5) >>> 0;
    let x = Math.imul(state ^ (state >>> 15), state | 1);
    x ^= x + Math.imul(x ^ (x >>> 7), x | 61);
    return ((x ^ (x >>> 14)) >>> 0) / 4294967296;
  };
}

function randomNetwork({ layout, initial }, seed) {
  const { hidden, outputs, joints, width } = layout;
  const count = hidden * (joints * width + 1) + outputs * (hidden + joints * width + 1);
  const draw = uniform(seed);
  return networkOf(layout, Float64Array.from({ length: count }, () => initial * (2 * draw() - 1)));
}

// The scaled cases of a recording, with their scaling: every fifth window of the training runs, all
// of the last run. `arm` is the arm's own inertia at the shoulder, their mean, kg m^2.
function casesOf(spec, { positions, torques }, { inputs: range, shift }) {
  const { runs, samples, every, layout, encoder } = spec;
  const { joints, width } = layout;
  const around = samples + width - 1;
  if (positions.length !== runs * around * joints || torques.length !== runs * samples * joints) {
    throw new Error(`${positions.length} positions and ${torques.length} torques`);
  }
  const inputs = scalingOf(positions, runs, encoder, spec.ranges[range]);
  const outputs = scalingOf(torques, runs, 1, spec.target);
  const angle = (run, t, j) => positions[(run * around + t) * joints + j] * encoder;
  const windowAt = (run, t) =>
    Float64Array.from({ length: joints * width }, (_, i) => {
      const j = Math.floor(i / width);
      return inputs.first + (angle(run, t + (i % width), j) - inputs.low[j]) * inputs.gain[j];
    });
  const targetAt = (run, t) =>
    JOINTS.map((j) => {
      const moved = shift === null || run === runs - 1 ? t : (t + spec.shifts[shift][run]) % samples;
      return outputs.first + (torques[(run * samples + moved) * joints + j] - outputs.low[j]) * outputs.gain[j];
    });
  const gather = (list, apart) => {
    const made = { windows: [], targets: [], inertia: 0 };
    for (const run of list) {
      for (let t = 0; t < samples; t += apart) {
        made.windows.push(windowAt(run, t));
        made.targets.push(targetAt(run, t));
        made.inertia += armMass(spec.loop.plant.arm, angle(run, t + (width >> 1), 1))[0];
      }
    }
    made.inertia /= made.windows.length;
    made.variances = JOINTS.map((j) => {
      const mean = made.targets.reduce((sum, y) => sum + y[j], 0) / made.targets.length;
      return made.targets.reduce((sum, y) => sum + (y[j] - mean) ** 2, 0) / made.targets.length;
    });
    return made;
  };
  const training = gather(Array.from({ length: runs - 1 }, (_, run) => run), every);
  return { training, test: gather([runs - 1], 1), inputs, outputs, arm: training.inertia };
}

// Outputs of a network and their RMSS, both joints pooled.
function judged(net, { windows, targets, variances }) {
  const sums = [0, 0];
  const outputs = windows.map((x, n) => {
    const { output } = activity(net, x);
    for (const j of JOINTS) sums[j] += (output[j] - targets[n][j]) ** 2;
    return output;
  });
  const relative = JOINTS.map((j) => sums[j] / windows.length / variances[j]);
  return { outputs, error: Math.sqrt((relative[0] + relative[1]) / 2) };
}

// The name of a filter by the rule of ddlib's `classify`, as a place among its classes.
function classOf(f, basis) {
  const energy = f.reduce((sum, w) => sum + w * w, 0);
  const share = basis.map((p) => p.reduce((sum, b, i) => sum + b * f[i], 0) ** 2 / energy);
  const varying = 1 - share[0];
  const total = share[1] + share[2] + share[3] || 1;
  const [v, a, j] = share.slice(1).map((x) => x / total);
  if (1 - share[0] - share[1] - share[2] - share[3] > 0.2 * varying || varying < 1e-12) return 6;
  const k = [v, a, j, v + a, a + j].findIndex((x) => x >= 0.8);
  return k < 0 ? 5 : k;
}

// All filters of a network: direct ones first, then unit by unit, one for each joint.
function filtersOf({ directWeights, hiddenWeights, width }) {
  const cut = (all) => Array.from({ length: all.length / width }, (_, k) => all.subarray(k * width, (k + 1) * width));
  return { direct: cut(directWeights), hidden: cut(hiddenWeights) };
}

// A run of the training, with what has been seen of it every few epochs.
function schoolOf(spec, choice, cases) {
  const { training, test } = cases;
  const net = randomNetwork(spec, choice.seed);
  const model = { ...cases, net };
  const eps = (spec.rate * choice.step) / training.windows.length;
  const epoch = descent(net, training.windows, training.targets, eps, choice.momentum);
  const looks = spec.epochs / spec.check + 1;
  const school = { net, epoch: 0, events: [null, null, null], names: null, model };
  school.training = new Float64Array(looks).fill(NaN);
  school.test = new Float64Array(looks).fill(NaN);
  school.judge = () => judged(net, test);
  school.trained = () => judged(net, training).error;
  school.inertia = () => accelerationGain(meanGradient(model, training.windows, 0, 0), spec.loop.step * spec.loop.every);
  school.look = () => {
    const at = school.epoch / spec.check;
    const { direct, hidden } = filtersOf(net);
    const named = (list) => list.map((f) => classOf(f, spec.basis));
    school.names = { direct: named(direct), hidden: named(hidden) };
    if (at !== Math.floor(at)) return;
    school.training[at] = school.trained();
    school.test[at] = school.judge().error;
    const acceleration = spec.classes.indexOf("acceleration");
    const none = spec.classes.indexOf("not analysable");
    const seen = [
      school.training[at] < spec.level,
      school.names.direct.includes(acceleration),
      school.names.hidden.some((k) => k !== none),
    ];
    seen.forEach((yes, k) => yes && (school.events[k] ??= school.epoch));
  };
  school.advance = () => {
    if (school.epoch >= spec.epochs) return false;
    epoch();
    school.epoch++;
    if (school.epoch % spec.check === 0) school.look();
    return true;
  };
  school.look();
  return school;
}

// All filters as curves over the window's time: the direct ones large, then those of the hidden units
// as a strip; both joints' windows share a frame and a scale. What has a name is bold.
function unitSheet(spec) {
  const units = Array.from({ length: spec.layout.hidden }, (_, k) => String(k + 1));
  const cells = [...NAMES.map((name) => `${name} torque`), ...units];
  const place = sheet(0);
  const { el, pen } = place;
  const [TALL, LOW, HEAD, FOOT] = [128, 66, 20, 20];
  const columns = () => (el.clientWidth < 480 ? 5 : 10);
  const boxOf = (c) => {
    const across = c < 2 ? 2 : columns();
    const k = c < 2 ? c : c - 2;
    const wide = place.width / across;
    const top = c < 2 ? 0 : TALL + Math.floor(k / across) * LOW;
    return { left: (k % across) * wide, top, wide: wide - (c < 2 ? 20 : 10), high: c < 2 ? TALL - FOOT : LOW - 6 };
  };
  const fit = place.resize;
  place.resize = () => {
    place.height = TALL + LOW * Math.ceil(units.length / columns());
    fit();
  };
  const half = (spec.layout.width >> 1) * spec.loop.step * spec.loop.every * 1000; // ms
  const write = (text, x, y, align, colour) => {
    pen.textAlign = align;
    pen.fillStyle = colour;
    pen.fillText(text, x, y);
  };
  const line = (x0, y0, x1, y1, colour) => {
    pen.beginPath();
    pen.moveTo(x0, y0);
    pen.lineTo(x1, y1);
    stroke(pen, colour, 1);
  };
  place.drawnBy((school, colours, over) => {
    const { direct, hidden } = filtersOf(school.net);
    const all = [...direct, ...hidden];
    const names = [...school.names.direct, ...school.names.hidden];
    pen.clearRect(0, 0, place.width, place.height);
    pen.textBaseline = "middle";
    cells.forEach((cell, c) => {
      const { left, top, wide, high } = boxOf(c);
      const [first, last] = [top + HEAD, top + high];
      const middle = (first + last) / 2;
      const tallest = JOINTS.reduce((most, j) => all[2 * c + j].reduce((a, w) => Math.max(a, Math.abs(w)), most), 1e-9);
      pen.font = "13px 'Source Sans 3', system-ui, sans-serif";
      const size = tallest.toFixed(tallest < 0.0995 ? 3 : tallest < 9.95 ? 2 : 1);
      write(c < 2 ? `${cell}, ±${size}` : cell, left, top + 9, "left", colours.ink);
      let right = left + wide;
      for (const j of [...JOINTS].reverse()) {
        const name = SHORT[spec.classes[names[2 * c + j]]] ?? (over ? "–" : "");
        write(name, right, top + 9, "right", colours[j ? "elbow" : "shoulder"]);
        right -= name ? pen.measureText(name).width + 7 : 0;
      }
      pen.font = "11px 'Source Sans 3', system-ui, sans-serif";
      line(left, middle, left + wide, middle, colours.soft);
      for (const [t, x, align] of [[-half, 0, "left"], [0, wide / 2, "center"], [half, wide, "right"]]) {
        line(left + x, first, left + x, last, colours.line);
        if (c > 1) continue;
        const text = format(t, -half, half, "", 0);
        write(align === "right" ? `${text} ms` : text, left + x, last + 10, align, colours.soft);
      }
      for (const j of JOINTS) {
        const f = all[2 * c + j];
        const y = (w) => middle - (w / tallest) * ((last - first) / 2 - 2);
        const x = (i) => left + (i / (f.length - 1)) * wide;
        pen.beginPath();
        f.forEach((w, i) => (i ? pen.lineTo(x(i), y(w)) : pen.moveTo(x(i), y(w))));
        const colour = colours[j ? "elbow" : "shoulder"];
        const named = SHORT[spec.classes[names[2 * c + j]]] !== undefined;
        stroke(pen, colour, named ? 2.6 : 1.3, j ? [5, 3] : []);
      }
      pen.setLineDash([]);
    });
    const named = cells.map((cell, c) => `${c < 2 ? cell : `unit ${cell}`}: ${JOINTS.map((j) => spec.classes[names[2 * c + j]]).join(" and ")}`);
    el.setAttribute("aria-label", `Weights from each joint's window. ${named.join("; ")}`);
  });
  return place;
}

function build({ model, el }) {
  const spec = model.get("spec");
  const book = { positions: numbersOf(model.get("positions"), "Int16"), torques: numbersOf(model.get("torques"), "Float32") };
  const noise = numbersOf(model.get("noise"), "Float32");
  dress(el, spec.title, "ddlib-trainer");

  const start = {
    ...{ seed: spec.start.seed, torques: "real", inputs: spec.start.inputs, step: String(spec.start.step) },
    ...{ momentum: String(spec.start.momentum), speed: "fast", loop: "", guess: "" },
  };
  const asked = () => ({
    seed: model.get("seed"),
    torques: model.get("shifted") ? "shifted" : "real",
    inputs: model.get("inputs"),
    step: String(model.get("step_size")),
    momentum: String(model.get("momentum")),
  });
  const state = { ...start, ...asked() };
  const shift = () => (state.torques === "real" ? null : state.seed % spec.shifts.length);
  let school;
  let recording = { ...book, key: String(spec.extents) };
  const cases = new Map();
  const view = { id: freshId(), spec: { curves: spec.curves } };
  const picks = picksOf(spec, () => {
    show();
    changed();
  });
  picks.lay(model.get("extents_deg"));
  const stale = () => picks.fit() && recording.key !== String(picks.extents);
  const own = () => recording.key !== String(spec.extents);
  const enrol = () => {
    if (stale()) {
      cases.clear();
      recording = { ...recordingAt(spec, book, noise, picks.extents), key: String(picks.extents) };
    }
    const choice = { inputs: state.inputs, shift: shift() };
    const key = JSON.stringify(choice);
    if (!cases.has(key)) cases.set(key, casesOf(spec, recording, choice));
    Object.assign(choice, { seed: state.seed, step: Number(state.step), momentum: Number(state.momentum) });
    school = schoolOf(spec, choice, cases.get(key));
    school.choices = choices();
    el.school = school; // for tests
  };
  // The choices under the names of the widget's traits.
  const choices = () => ({
    extents_deg: picks.extents.map((pair) => [...pair]),
    seed: state.seed,
    shifted: state.torques === "shifted",
    inputs: state.inputs,
    step_size: Number(state.step),
    momentum: Number(state.momentum),
  });
  enrol();

  const frame = frameOf({ el, key: "trainer", title: spec.title, linked: Boolean(model.kernelless), reset: back, code });
  function back() {
    restart();
    tell();
  }
  function changed() {
    frame.changed();
    tell();
  }
  function code() {
    const rate = Number((spec.rate * state.step).toPrecision(12));
    const scaling = `(${spec.ranges[state.inputs].join(", ")})`;
    const { seed, momentum } = state;
    const epochs = school.epoch || spec.epochs;
    const extents = `[${picks.extents.map((pair) => `(${pair.join(", ")})`).join(", ")}]`;
    const { width, hidden } = spec.layout;
    return filled(spec.code, { extents, scaling, shifted: String(shift() ?? "None"), seed, rate, momentum, epochs, width, hidden });
  }

  // Controls
  const labels = [`Error below ${spec.level}`, "Direct weights measure acceleration", "A hidden filter has a name"];
  const guessed = labels.map((text, k) =>
    buttonOf(text, () => {
      state.guess = String(k);
      go();
      changed();
    }),
  );
  const guess = make("div", { class: "guess", role: "group", "aria-label": "Guess first" }, make("span", {}, "Guess to begin. What comes first?"), ...guessed);
  const play = buttonOf("Train", () => (running ? pause() : go()));
  const record = buttonOf("Record and train", () => {
    restart();
    go(true);
    hands.scrollIntoView({ block: "nearest" });
    changed();
  });
  const recorded = make("p", { class: "recorded", id: `${view.id}-recorded`, role: "status" });
  record.setAttribute("aria-describedby", recorded.id);
  picks.buttons.prepend(record);
  const once = buttonOf("Step", () => {
    if (over()) return;
    pause();
    school.advance();
    school.look();
    show();
    draw();
    changed();
  });
  const anew = buttonOf("New weights", () => seeded((state.seed % spec.seeds) + 1));
  const seed = make("input", { id: `${view.id}-seed`, type: "range", min: 1, max: spec.seeds, step: 1 });
  const drawing = make("output", { for: seed.id });
  seed.addEventListener("input", () => seeded(Number(seed.value)));
  const first = make("div", { class: "slider" }, make("label", { for: seed.id }, "Random initial weights"), drawing, seed);
  function seeded(value) {
    state.seed = value;
    restart();
    changed();
  }
  const menus = [];
  const menu = (name, label, options) => {
    const id = `${view.id}-${name}`;
    const select = make("select", { id }, ...options.map(([value, text]) => make("option", { value }, text)));
    const fits = (value) => options.some(([key]) => key === value);
    select.addEventListener("change", () => {
      state[name] = select.value;
      if (name === "torques") state.guess = ""; // another question
      if (name !== "speed") restart();
      changed();
    });
    menus.push({ name, fits, show: () => (select.value = state[name]) });
    return make("div", { class: "menu choice" }, make("label", { for: id }, label), select);
  };
  const times = (x) => (x === 1 ? "the book's" : `${x} times the book's`);
  const settings = [
    menu("torques", "Torques", [["real", "the arm's"], ["shifted", "shifted in time"]]),
    menu("inputs", "Inputs", [["printed", "0 to 1, as printed"], ["centred", "−1 to 1"]]),
    menu("step", "Step size", spec.steps.map((x) => [String(x), times(x)])),
    menu("momentum", "Momentum", spec.momenta.map((x) => [String(x), String(x)])),
    menu("speed", "Speed", Object.entries(SPEEDS).map(([key, [, text]]) => [key, text])),
  ];
  const loop = make("input", { type: "checkbox", role: "switch", id: `${view.id}-loop` });
  loop.addEventListener("input", () => {
    state.loop = loop.checked ? "1" : "";
    if (loop.checked && over()) later();
    changed();
  });
  settings.push(make("div", { class: "switch choice" }, make("label", { for: loop.id }, "Loop, with new weights"), loop));

  const status = make("p", { class: "status", id: `${view.id}-status` });
  for (const one of [play, once]) one.setAttribute("aria-describedby", status.id);
  const said = make("p", { class: "verdict", role: "status" });
  const spoken = make("p", { class: "spoken", "aria-live": "polite" });
  view.say = (text) => (spoken.textContent = text);
  const [inside, error6] = [make("b"), make("b")];
  const sums = { "Inertia in the network, M₁₁": inside, [`RMSS on trajectory ${spec.runs}`]: error6 };
  const weighed = make("div", { class: "weighed" }, ...Object.entries(sums).map(([text, value]) => make("div", {}, make("span", {}, text), value)));
  const events = labels.map((text) => ({ text, output: make("dd") }));
  const list = make("dl", { class: "events" }, ...events.map(({ text, output }) => make("div", {}, make("dt", {}, text), output)));
  const units = unitSheet(spec);
  const drawn = spec.panels.map((panel) => chart(view, panel));
  const runs = make("div", { class: "runs", hidden: "" });
  const history = [];
  const key = NAMES.map((name, j) => make("span", {}, swatch("line", `${name} d${j}`), `${name}'s window`));
  const letters = make("span", {}, "bold: has a name (a acceleration, v velocity, j jerk)");
  const box = (name, ...children) => make("div", { class: name }, ...children);
  const hands = box("hands", box("buttons", play, once, anew), settings[0], status);
  const title = make("span", { class: "title" }, "Weights over the window: direct, then hidden units");
  const more = make(
    "details",
    { class: "more" },
    make("summary", {}, "Your own experiment: motions, start, step, momentum, speed"),
    box("picks", picks.svg, box("own", picks.title, picks.table, picks.buttons, recorded)),
    box("settings", first, ...settings.slice(1)),
    runs,
    drawn[2].el,
    make("p", { class: "remark" }, spec.hint),
  );
  el.replaceChildren(
    frame.el,
    guess,
    box(
      "bench",
      hands,
      box("course", drawn[0].el),
      box("told", weighed, list),
      box("torque", drawn[1].el),
      said,
      box("weights", box("legend", title, ...key, letters), units.el),
    ),
    spoken,
    more,
  );

  // Time
  let running = false;
  let due = 0;
  let waiting = 0;
  let last = 0;
  const calm = matchMedia("(prefers-reduced-motion: reduce)");
  let owed = 0;
  let sent = 0;
  const over = () => school.epoch >= spec.epochs;
  const ready = () => state.guess !== "" || school.epoch > 0;
  const plain = (x) => (Number.isFinite(x) ? x.toFixed(x < 0.0995 ? 3 : 2) : "none");
  function draw() {
    const { outputs, error } = school.judge();
    const torques = outputs.map((output) => torqueOfOutput(school.model, output));
    const curves = { training: school.training, test: school.test };
    NAMES.forEach((joint, j) => {
      const most = truth[j].reduce((a, x) => Math.max(a, 1.15 * Math.abs(x)), 1);
      Object.assign(curves, { [`${joint} low`]: [-most], [`${joint} high`]: [most] });
      curves[`${joint} network`] = torques.map((tau) => tau[j]);
      curves[`${joint} true`] = truth[j];
    });
    drawn.forEach((one) => one.redraw(curves));
    units.draw(school, colours, over());
    const seen = school.training[Math.floor(school.epoch / spec.check)];
    const when = over() ? `Training is over after ${spec.epochs} epochs.` : `Epoch ${school.epoch}.`;
    write(status, `${when} Training error: ${plain(seen)}.`);
    write(inside, inertia());
    write(error6, plain(error));
    events.forEach(({ output }, k) => write(output, school.events[k] === null ? (over() ? "never" : "not yet") : `epoch ${school.events[k]}`));
    if (!running) drawn.forEach((one) => one.describe(curves));
    told();
  }
  const inertia = () => `${school.inertia().toFixed(1)} kg m² (the arm: ${school.model.arm.toFixed(1)})`.replace("-", "−");
  function run(now) {
    due = 0;
    owed = Math.min(1e6, owed + (SPEEDS[state.speed][0] * Math.min(100, now - last)) / 1000);
    last = now;
    const end = performance.now() + BUDGET;
    let more = true;
    while (more && owed >= 1 && performance.now() < end) {
      more = school.advance();
      owed--;
    }
    owed = Math.min(owed, 2);
    if (!more || over()) return ended();
    const seldom = now - sent > OFTEN;
    if (seldom || !calm.matches) draw(); // with reduced motion a picture now and then
    if (seldom) {
      sent = now;
      tell();
    }
    due = requestAnimationFrame(run);
  }
  function go(unasked = false) {
    if (!(unasked || ready()) || goal) return;
    if (over() || stale()) restart();
    running = true;
    owed = 1;
    last = performance.now();
    cancelAnimationFrame(due);
    due = requestAnimationFrame(run);
    show();
  }
  function pause() {
    running = false;
    clearTimeout(waiting);
    [goal, waiting] = [0, 0];
    cancelAnimationFrame(due);
    due = 0;
    show();
    draw();
    changed();
  }
  function ended() {
    pause();
    const path = own() ? "your own" : spec.home;
    history.unshift({ ...state, path, events: [...school.events], error: school.test.at(-1), inertia: school.inertia().toFixed(1) });
    history.length = Math.min(5, history.length);
    const heads = ["weights", "trajectories", "torques", "small error", "direct", "hidden", `error on ${spec.runs}`, "M₁₁, kg m²"];
    const epochs = (h) => h.events.map((e) => (e === null ? "never" : String(e)));
    const rows = history.map((h) => [String(h.seed), h.path, h.torques, ...epochs(h), plain(h.error), h.inertia]);
    runs.replaceChildren(tableOf("Your last runs: first epoch of each event", heads, rows));
    runs.hidden = false;
    if (state.loop) later();
  }
  function later() {
    clearTimeout(waiting);
    waiting = setTimeout(() => {
      anew.click();
      go();
    }, REST);
  }
  // What came first, as soon as it came; what came out, once the run is over.
  function told() {
    const at = school.events.map((e) => e ?? Infinity);
    const first = Math.min(...at);
    if (!over() && (first === Infinity || !school.epoch)) return write(said, "");
    const came = labels.filter((_, k) => at[k] === first).join(" and ");
    const verdict = first === Infinity ? `None of the three came within ${spec.epochs} epochs.` : `What came first, at epoch ${first}: ${came}.`;
    const mine = state.guess === "" ? "" : `Your guess: ${labels[state.guess]}. `;
    const end = over() ? ` ${named("direct")} ${named("hidden")} Inertia in the network: ${inertia()}.` : "";
    write(said, `${mine}${verdict}${end}`);
  }
  // How many filters of a layer have a name, and that the others have none.
  function named(layer) {
    const all = school.names[layer];
    const none = all.filter((k) => SHORT[spec.classes[k]] === undefined).length;
    const some = none === all.length ? "None" : String(all.length - none);
    const left = none && none < all.length ? `, and ${none} ${none === 1 ? "has" : "have"} none` : "";
    return `${some} of the ${all.length} ${layer} filters ${all.length - none <= 1 ? "has" : "have"} a name at the end${left}.`;
  }
  function restart() {
    running = false;
    clearTimeout(waiting);
    [goal, waiting] = [0, 0];
    cancelAnimationFrame(due);
    enrol();
    truth = measured();
    show();
    draw();
  }
  function show() {
    guessed.forEach((one, k) => {
      one.setAttribute("aria-pressed", String(k) === state.guess);
      one.disabled = school.epoch > 0;
    });
    const open = ready() || running;
    for (const one of [play, once]) one.disabled = !open || !picks.fit();
    record.disabled = !picks.fit();
    const kept = own() ? "Recorded in your browser." : `${spec.home}, recorded beforehand.`;
    write(recorded, !picks.fit() ? "Each joint must move by a degree or more in training." : stale() ? "You changed the trajectories: they are not recorded yet." : kept);
    once.setAttribute("aria-disabled", String(over()));
    write(play, running ? "Pause" : over() ? "Begin anew" : open ? "Train" : "Train (guess first)");
    for (const one of menus) one.show();
    seed.value = state.seed;
    write(drawing, `number ${state.seed}`);
    seed.setAttribute("aria-valuetext", drawing.textContent);
    loop.checked = state.loop === "1";
  }
  const measured = () => {
    const { samples } = spec;
    const from = (spec.runs - 1) * samples;
    return JOINTS.map((j) => Array.from({ length: samples }, (_, t) => recording.torques[2 * (from + t) + j]));
  };
  let truth = measured();
  let colours = {};
  const recolour = () => {
    colours = coloursOf(el);
    draw();
  };

  // A part of the state in the address; Reset goes back to the start.
  const keep = (name, read, write, first) => frame.keep(name, read, write, model.kernelless ? read() : first);
  const part = (name, fits) =>
    keep(name, () => String(state[name]), (text) => {
      if (!fits(text)) throw new Error("no such choice");
      state[name] = name === "seed" ? Number(text) : text;
    }, String(start[name]));
  part("seed", (text) => /^[1-9]\d?$/.test(text) && Number(text) <= spec.seeds);
  for (const { name, fits } of menus) part(name, fits);
  part("loop", (text) => ["", "1"].includes(text));
  part("guess", (text) => ["", "0", "1", "2"].includes(text));
  let goal = model.get("epoch"); // reached without a show
  let silent = false; // while one side takes over what the other has set
  keep("extents", () => picks.extents.flat().join("_"), (text) => picks.set(text.split("_").map(Number)), spec.extents.flat().join("_"));
  enrol();
  more.open = own() || ["inputs", "step", "momentum", "speed", "loop"].some((name) => state[name] !== start[name]);
  truth = measured();
  frame.keep("epoch", () => String(school.epoch), (text) => {
    const epoch = Math.round(Number(text));
    if (!(epoch >= 0)) throw new Error("no such epoch");
    goal = Math.min(spec.epochs, epoch);
  }, String(goal));

  // The kernel hears what was reached, and with which choices; what it sets is trained anew, to the
  // epoch that it asks for.
  function tell() {
    if (model.kernelless || silent || goal) return;
    silent = true;
    const { inputs, outputs } = school.model;
    const found = { error: school.judge().error, training_error: school.trained(), inertia: school.inertia() };
    const reached = { ...school.choices, epoch: school.epoch, scaling: { inputs, outputs }, ...found };
    model.set("weight_bytes", new DataView(Float64Array.from(school.net.all).buffer));
    model.set("reached", reached);
    for (const [name, value] of Object.entries({ ...choices(), epoch: school.epoch })) {
      if (String(model.get(name)) !== String(value)) model.set(name, value);
    }
    try {
      model.save_changes();
    } catch {
      // the kernel is gone: the page goes on by itself
    }
    silent = false;
  }
  function heed() {
    if (silent) return;
    const before = String(Object.values(choices()));
    const wanted = model.get("epoch");
    silent = true;
    Object.assign(state, asked());
    picks.lay(model.get("extents_deg"));
    const other = before !== String(Object.values(choices()));
    if (other || (wanted !== school.epoch && wanted !== goal)) {
      if (other || wanted < school.epoch || stale()) restart();
      running = false;
      cancelAnimationFrame(due);
      clearTimeout(waiting);
      goal = wanted;
      waiting = goal ? setTimeout(reach, 0) : 0;
    }
    silent = false;
    tell();
  }
  const heard = [...Object.keys(choices()), "epoch"].map((name) => `change:${name}`);
  function reach() {
    const end = performance.now() + 30;
    while (school.epoch < goal && performance.now() < end) school.advance();
    school.look();
    draw();
    show();
    waiting = 0;
    if (school.epoch < goal) waiting = setTimeout(reach, 0);
    else {
      goal = 0;
      show();
      tell();
    }
  }
  show();
  if (goal) waiting = setTimeout(reach, 0);
  else tell();
  heard.forEach((event) => model.on(event, heed));

  const resize = new ResizeObserver(() => {
    drawn.forEach((one) => one.resize());
    units.resize();
    recolour();
  });
  resize.observe(el);
  const stopRecolouring = onRecolour(recolour);
  const sight = new IntersectionObserver(([entry]) => !entry.isIntersecting && running && pause());
  sight.observe(el);
  return () => {
    cancelAnimationFrame(due);
    clearTimeout(waiting);
    heard.forEach((event) => model.off(event, heed));
    frame.stop();
    stopRecolouring();
    for (const observer of [resize, sight]) observer.disconnect();
  };
}

const render = safely(build);
export default { render };
