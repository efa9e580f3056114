// What a trainer's network learns from, and the inertia that is in it afterwards. A book is {
// positions, torques } of the recorded runs: encoder steps around the motion, N m in it.

import { besideOf, draggable } from "./dragging.js";
import { buttonOf, make, short } from "./elements.js";
import { JOINTS, NAMES, activity, recordingOf } from "./engine.js";
import { rint } from "./physics.js";

// The runs' recording to extents in degrees: the book's where they are the same, others made anew.
// The torque sensor's noise is the book's.
export function recordingAt({ loop, extents: known, encoder, samples, layout }, book, noise, extents) {
  const [positions, torques] = [book.positions.slice(), book.torques.slice()];
  const half = layout.width >> 1;
  const [begin, around] = [loop.during[0], samples + layout.width - 1];
  extents.forEach((pair, run) => {
    if (String(pair) === String(known[run])) return;
    const log = recordingOf(loop, pair.map((x) => (x * Math.PI) / 180));
    for (const j of JOINTS) {
      for (let t = 0; t < around; t++) {
        positions[(run * around + t) * 2 + j] = rint(log.reading[begin - half + t][j] / encoder);
      }
      for (let t = 0, at = run * samples * 2 + j; t < samples; t++, at += 2) {
        torques[at] = log.tau[begin + t][j] + noise[at];
      }
    }
  });
  return { positions, torques };
}

// The map of each joint's range in the training runs to `target`, as ddlib's `Scaler` does it.
export function scalingOf(values, runs, factor, [first, last]) {
  const training = values.subarray(0, (values.length / runs) * (runs - 1));
  const each = JOINTS.map((j) => training.filter((_, i) => i % 2 === j));
  const low = each.map((x) => factor * x.reduce((a, b) => Math.min(a, b)));
  const gain = each.map((x, j) => (last - first) / (factor * x.reduce((a, b) => Math.max(a, b)) - low[j]));
  return { low, gain, first };
}

// The mean gradient of an output's torque by a joint's window, N m/rad, over scaled windows.
export function meanGradient({ net, inputs, outputs }, windows, output, joint) {
  const { width, hidden: units } = net;
  const through = new Float64Array(units);
  let direct = 0;
  const [active, told] = [new Float64Array(units), new Float64Array(net.outputs)];
  for (const x of windows) {
    activity(net, x, active, told);
    const slope = (told[output] * (1 - told[output])) / windows.length;
    direct += slope;
    for (let h = 0; h < units; h++) through[h] += slope * active[h] * (1 - active[h]);
  }
  const scale = inputs.gain[joint] / outputs.gain[output];
  const place = (row, i) => row * net.inputs + joint * width + i;
  return Float64Array.from({ length: width }, (_, i) => {
    let sum = direct * net.directWeights[place(output, i)];
    for (let h = 0; h < units; h++) {
      sum += through[h] * net.outputWeights[output * units + h] * net.hiddenWeights[place(h, i)];
    }
    return scale * sum;
  });
}

// A filter's gain on acceleration: half its second moment over the window's times.
export const accelerationGain = (f, step) =>
  f.reduce((sum, w, i) => sum + (w * (step * (i - (f.length >> 1))) ** 2) / 2, 0);

// Where the reader picks the runs' extents, degrees: a square with a mark for each run, to be dragged,
// and a table of numbers. changed() is called after every change.
export function picksOf({ extents: known, home, most, runs }, changed) {
  const extents = known.map((pair) => [...pair]);
  const [size, left, top] = [160, 36, 10];
  const place = ([a, b]) => [short(left + (size * a) / most), short(top + size * (1 - b / most))];
  const kind = (run) => (run < runs - 1 ? "training" : "test");
  const marks = extents.map((_, run) => make("g", { class: kind(run) }, make("circle", { r: 9 }), make("text", { dy: "0.36em", class: "x" }, String(run + 1))));
  const frame = make("rect", { x: left, y: top, width: size, height: size, class: "frame" });
  const text = (x, y, words) => make("text", { x, y, class: "x" }, words);
  const [middle, floor] = [left + size / 2, top + size];
  const svg = make(
    "svg",
    { viewBox: `0 0 ${left + size + 12} ${floor + 26}`, class: "pad", role: "img" },
    frame,
    text(left, floor + 20, "0"),
    text(middle, floor + 20, "shoulder, °"),
    text(left + size, floor + 20, String(most)),
    make("text", { transform: `translate(18 ${top + size / 2}) rotate(-90)`, class: "x" }, "elbow, °"),
    text(14, top + 4, String(most)),
    ...marks,
  );
  const fields = extents.map((pair, run) =>
    pair.map((_, j) => {
      const label = `Extent of the ${NAMES[j]} in trajectory ${run + 1}, degrees`;
      const field = make("input", { type: "number", min: 0, max: most, step: 0.1, "aria-label": label });
      field.addEventListener("input", () => {
        const value = field.valueAsNumber;
        if (value >= 0 && value <= most) enter(run, j, value);
      });
      let kept = pair[j];
      field.addEventListener("focus", () => (kept = extents[run][j]));
      field.addEventListener("change", () => {
        const value = field.valueAsNumber;
        if (!(value >= 0 && value <= most)) enter(run, j, kept); // its first digits may have fitted
        kept = extents[run][j];
        show();
      });
      return field;
    }),
  );
  function enter(run, j, value) {
    extents[run][j] = Math.round(10 * value) / 10;
    show(document.activeElement);
    changed();
  }
  // Numbers and marks; the number that is being typed stays as it is.
  function show(typed) {
    extents.forEach((pair, run) => {
      marks[run].setAttribute("transform", `translate(${place(pair)})`);
      fields[run].forEach((field, j) => field !== typed && (field.value = pair[j]));
    });
    const words = extents.map((pair, run) => `${run + 1} at ${pair.join(" and ")}`).join("; ");
    svg.setAttribute("aria-label", `Extents of shoulder and elbow in degrees, by trajectory: ${words}`);
  }
  function set(flat) {
    const fits = flat.length === 2 * runs && flat.every((x) => x >= 0 && x <= most);
    if (!fits) throw new Error("no such extents");
    lay(extents.map((_, run) => flat.slice(2 * run, 2 * run + 2)));
    changed();
  }
  // The same, in pairs and without a call of changed().
  function lay(pairs) {
    extents.forEach((pair, run) => pair.splice(0, 2, ...pairs[run]));
    show();
  }
  let held = 0;
  const move = (event) => {
    const box = frame.getBoundingClientRect();
    const at = [(event.clientX - box.left) / box.width, 1 - (event.clientY - box.top) / box.height];
    extents[held] = at.map((x) => Math.round(10 * most * Math.min(1, Math.max(0, x))) / 10);
    show();
    changed();
  };
  const away = (event, run) => {
    const box = marks[run].firstChild.getBoundingClientRect();
    return Math.hypot(event.clientX - box.x - box.width / 2, event.clientY - box.y - box.height / 2);
  };
  draggable(svg, (event) => marks.some((mark) => besideOf(mark.firstChild)(event)), move, (event) => {
    const all = extents.map((_, run) => away(event, run));
    held = all.indexOf(Math.min(...all));
    move(event);
  });
  const cells = (tag, texts) => texts.map((one) => make(tag, {}, one));
  const heads = extents.map((_, run) => (run < runs - 1 ? String(run + 1) : "test"));
  const rows = NAMES.map((name, j) => make("tr", {}, make("th", { scope: "row" }, `${name}, °`), ...cells("td", fields.map((pair) => pair[j]))));
  const table = make("table", {}, make("thead", {}, make("tr", {}, make("td", {}), ...cells("th", heads))), make("tbody", {}, ...rows));
  const title = make("div", { class: "title" }, `How far each joint goes: ${runs - 1} trajectories to learn from, and one to test`);
  const alike = buttonOf(`1 to ${runs - 1} alike`, () => set(extents.flatMap((pair, run) => (run < runs - 1 ? extents[0] : pair))));
  const back = buttonOf(home, () => set(known.flat()));
  const fit = () => JOINTS.every((j) => extents.slice(0, -1).some((pair) => pair[j] >= 1));
  show();
  return { extents, svg, title, table, buttons: make("div", { class: "buttons" }, alike, back), set, lay, fit };
}
