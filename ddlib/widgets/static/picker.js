// What TrajectoryPicker (picker.py) computes, and what it adds to a CurveWidget: the map of errors
// under the pad, the arm, its player, the verdict about the hull of the training trajectories, and the
// button that records. The numbers stand beside the pad.

import { clockOf } from "./clock.js";
import { PATIENCE, computes, extras } from "./curves.js";
import { buttonOf, make, put, short, write } from "./elements.js";
import { JOINTS, NAMES, pickAndPlace, placesOf, recordingOf } from "./engine.js";
import { kernelOf } from "./kernel.js";
import { insidePolygon } from "./numbers.js";
import { armTorque } from "./physics.js";
import { modelsOf, scaledOf, toldTorques } from "./sliding.js";

// All curves and numbers of a trajectory.
function picked(loop, models, extents) {
  const { arm, times, motion, lines, during, shown, scale } = loop;
  const wanted = times.map((t) => pickAndPlace(extents, t, motion));
  const rigid = wanted.map(({ q, qd, qdd }) => armTorque(arm, ...q, ...qd, ...qdd));
  const curves = {};
  const lay = (line, torques) =>
    NAMES.forEach((joint, j) => (curves[`${joint} torque, ${line}`] = torques.map((tau) => tau[j])));
  lay(lines.rigid, rigid);
  NAMES.forEach((joint, j) => {
    curves[`${joint} angle`] = wanted.map(({ q }) => (q[j] * 180) / Math.PI);
    curves[`peak ${joint}`] = [Math.max(...rigid.map((tau) => Math.abs(tau[j])))];
  });
  if (!models.length) return { curves };
  const log = recordingOf(loop, extents);
  const recorded = log.tau.slice(...during);
  const sampled = (torques) => shown.map((k) => torques[k - during[0]]);
  lay(lines.recorded, sampled(recorded));
  const positions = JOINTS.map((j) => Float64Array.from(log.reading, (q) => q[j]));
  for (const model of models) {
    const told = toldTorques(model, scaledOf(model, positions), ...during);
    let sum = 0;
    for (const j of JOINTS) told.forEach((tau, k) => (sum += ((tau[j] - recorded[k][j]) / scale[j]) ** 2));
    curves[`RMSS, ${model.name}`] = [Math.sqrt(sum / (2 * told.length))];
    lay(model.name, sampled(told));
  }
  return { curves, log };
}

computes((view) => {
  const loop = view.model.get("loop");
  view.networks ??= modelsOf(loop.models, view.model.get("weights"));
  const extents = NAMES.map((joint) => (view.get(`${joint}_deg`) * Math.PI) / 180);
  if (view.picked?.key !== String(extents)) {
    view.picked = { key: String(extents), ...picked(loop, view.networks, extents) };
  }
  return view.picked.curves;
});

const FINE = 3; // parts of the map's grid in which it is drawn
const LEVELS = 10; // both ends are open

// The map: for every network its errors on a grid, of which one is drawn, in steps.
function mapOf(view) {
  const { side, errors } = view.model.get("map");
  const names = Object.keys(errors);
  const { under, legend, frame } = view.pad;
  const layers = Array.from({ length: LEVELS }, (_, k) => make("path", { class: "level", "fill-opacity": short(0.07 * k) }));
  under.append(...layers);
  const fine = FINE * (side - 1);
  const cell = frame.size / fine;

  function levelsOf(digits) {
    const values = digits.match(/../g).map((two) => parseInt(two, 36) / 100);
    const between = (x) => [Math.min(Math.floor(x / FINE), side - 2), x / FINE - Math.min(Math.floor(x / FINE), side - 2)];
    return Array.from({ length: fine }, (_, row) => {
      const [j, v] = between(row + 0.5);
      return Array.from({ length: fine }, (_, column) => {
        const [i, u] = between(column + 0.5);
        const at = j * side + i;
        const below = values[at] * (1 - u) + values[at + 1] * u;
        const above = values[at + side] * (1 - u) + values[at + side + 1] * u;
        return Math.min(LEVELS - 1, Math.floor(below * (1 - v) + above * v));
      });
    });
  }
  function draw(name) {
    const paths = layers.map(() => "");
    (errors[name] ? levelsOf(errors[name].digits) : []).forEach((row, k) => {
      const y = short(frame.top + frame.size - (k + 1) * cell);
      for (let from = 0, to; from < fine; from = to) {
        for (to = from + 1; to < fine && row[to] === row[from]; ) to++;
        paths[row[from]] += `M${short(frame.left + from * cell)} ${y}h${short((to - from) * cell)}v${short(cell)}h${short((from - to) * cell)}z`;
      }
    });
    layers.forEach((layer, k) => layer.setAttribute("d", paths[k]));
  }

  let shown = "";
  const buttons = [...names, ""].map((name) => [
    name,
    buttonOf(name || "none", () => {
      show(name);
      view.changed();
    }),
  ]);
  function show(name) {
    if (name && !errors[name]) throw new Error(`there is no network ${name}`);
    shown = name;
    for (const [other, button] of buttons) button.setAttribute("aria-pressed", String(other === name));
    draw(name);
    scale.hidden = !name;
    if (!name) return;
    const { low, high } = errors[name];
    scale.replaceChildren(`RMSS ${low.toFixed(2)} and less`, ramp, `${high.toFixed(2)} and more`);
  }
  const scale = make("div", { class: "scale" });
  const ramp = make("svg", { width: 12 * LEVELS, height: 12, "aria-hidden": "true" });
  layers.forEach((_, k) => ramp.append(make("rect", { class: "level", x: 12 * k, width: 12, height: 12, "fill-opacity": short(0.07 * k) })));
  const title = "Show the errors of";
  const words = { class: "presets under", role: "group", "aria-label": title };
  const choice = make("div", words, make("span", { "aria-hidden": "true" }, title), ...buttons.map(([, b]) => b));
  show(names[0]);
  legend.after(choice, scale);
  view.keep("map", () => shown, show);
}

// Elbow and hand at given joint angles (rad), in pixels.
const pose = (lengths, q, scale) => placesOf(lengths, q).map(([x, y]) => [short(scale * x), short(-scale * y)]);

function armOf(view) {
  const { lengths, angles, times } = view.model.get("arm");
  const { motion } = view.model.get("loop");
  const scale = 230 / (lengths[0] + lengths[1]);
  const rad = (x) => (x * Math.PI) / 180;
  const far = angles.map((name) => rad(view.spec.curves.find((c) => c.name === name).low));
  const [deepest] = pose(lengths, far, scale).slice(1); // to the right of and below the base
  const trail = make("path", { class: "trail" });
  const links = ["upper", "fore"].map((name) => make("line", { class: `link ${name}`, x1: 0, y1: 0 }));
  const elbow = make("circle", { class: "joint", r: 5 });
  const hand = make("circle", { class: "hand", r: 5 });
  const ground = make("line", { class: "ground", x1: 0, x2: 244, y1: 0, y2: 0 });
  const base = make("circle", { class: "joint", r: 7 });
  const words =
    "The arm from above. Dotted: the path of its hand. Pale: its paths in the " +
    "trajectories of the recording";
  const svg = make(
    "svg",
    { class: "arm", viewBox: `-20 -16 280 ${deepest[1] + 32}`, role: "img", "aria-label": words },
    ...[ground, ...view.spec.pad.marks.map(others), trail, ...links, base, elbow, hand],
  );
  let joints = [[0], [0]];

  // The path of the hand in a trajectory of the recording, with its number where the motion turns.
  function others({ x, y, label, group }) {
    const hands = times.map((t) => pose(lengths, pickAndPlace([rad(x), rad(y)], t, motion).q, scale)[1]);
    const [left, top] = hands[hands.length >> 1];
    const text = make("text", { x: left - 4, y: top + 4, "text-anchor": "end" }, label);
    return make("g", { class: `other ${group}` }, make("path", { d: `M${hands.map((p) => p.join(" ")).join("L")}` }), text);
  }
  function path(curves) {
    joints = angles.map((name) => curves[name]);
    const points = times.map((_, i) => pose(lengths, joints.map((q) => rad(q[i])), scale)[1]);
    trail.setAttribute("d", `M${points.map((p) => p.join(" ")).join("L")}`);
  }
  function stand(time) {
    const position = (time / times.at(-1)) * (times.length - 1);
    const i = Math.min(Math.floor(position), times.length - 2);
    const now = joints.map((q) => rad(q[i] + (position - i) * (q[i + 1] - q[i])));
    const [a, b] = pose(lengths, now, scale);
    put(links[0], { x2: a[0], y2: a[1] });
    put(links[1], { x1: a[0], y1: a[1], x2: b[0], y2: b[1] });
    put(elbow, { cx: a[0], cy: a[1] });
    put(hand, { cx: b[0], cy: b[1] });
  }
  return { svg, path, stand, end: times.at(-1) };
}

extras.push((view) => {
  const { model, spec } = view;
  const arm = armOf(view);
  view.el.classList.add("ddlib-picker");
  if (Object.keys(view.model.get("map").errors).length) mapOf(view);
  else view.el.classList.add("alone"); // the motion, without networks

  const clock = clockOf(view, { at: arm.end / 2, end: arm.end, step: arm.end / 300 }, (now) => {
    arm.stand(now);
    view.charts.forEach((c) => c.point(now));
  });

  // The verdict
  const verdict = make("p", { class: "verdict" });
  const words = () =>
    insidePolygon(spec.pad.region, ...view.values)
      ? "Between the training trajectories: a network interpolates."
      : "Outside the training trajectories: a network extrapolates.";
  view.words = () => [words().slice(0, -1)];

  // The button that records
  const said = make("p", { id: `${view.id}-said`, role: "status" });
  let waiting = 0;
  const kernel = kernelOf(model);
  function done() {
    clearTimeout(waiting);
    waiting = 0;
    record.disabled = false;
    said.textContent = model.get("record_status").text;
  }
  const ask = () => {
    record.disabled = true;
    said.textContent = "Recording…";
    waiting = setTimeout(late, PATIENCE);
    if (!kernel.send(() => model.send({ type: "record", extents_deg: view.values }))) gone();
  };
  const record = buttonOf("Record this trajectory", ask, { "aria-describedby": said.id });
  // The request waits in the kernel's queue: its answer may come at any time.
  function late() {
    waiting = setTimeout(late, PATIENCE);
    if (kernel.busy()) said.textContent = "The kernel is busy. It records as soon as it is free.";
    else {
      record.disabled = false; // it may have been lost
      said.textContent = "The kernel has not answered yet.";
    }
  }
  function gone() {
    if (!waiting) return;
    done();
    said.textContent = "The kernel is gone. Nothing was recorded.";
  }
  kernel.watch(gone);
  model.on("change:record_status", done);

  const goTo = view.controls.querySelector(".presets");
  view.top.firstChild.append(goTo);
  view.keep("time", () => clock.now().toFixed(2), (text) => clock.stand(Number(text)));
  clock.slider.addEventListener("input", view.changed);
  view.top.firstChild.after(view.numbers); // beside the pad: seen while it is dragged
  view.controls.append(verdict);
  if (!model.kernelless) view.controls.append(make("div", { class: "record" }, record, said));
  view.top.append(make("div", { class: "arm-box" }, arm.svg, make("div", { class: "player" }, clock.play, clock.el)));
  const charts = view.el.querySelector(".charts");
  const scene = make("div", { class: "scene" });
  charts.after(scene);
  scene.append(view.top, charts);
  const follow = (curves) => {
    arm.path(curves);
    clock.show();
    write(verdict, words());
  };
  view.after.push(follow);
  follow(view.curves);
  done();
  return () => {
    clock.pause();
    clearTimeout(waiting);
    kernel.leave();
    model.off("change:record_status", done);
  };
});
