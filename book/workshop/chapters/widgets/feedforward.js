// What FeedforwardSwitches (feedforward.py) computes and shows.

import { computes, extras } from "ddlib/curves.js";
import { make, write } from "ddlib/elements.js";
import { NAMES, follow, pid, referenceOf } from "ddlib/engine.js";
import { armTorque, frictionTorque } from "ddlib/physics.js";

const DEGREES = 180 / Math.PI;

// From rest to rest: -extent (1 - cos omega t) / 2.
function smoothReference({ extents, periods, step, motion }) {
  const reference = { q: [], qd: [], qdd: [] };
  const omega = (2 * Math.PI) / motion;
  for (let k = 0; k < periods; k++) {
    const angle = omega * k * step;
    const part = (factor) => extents.map((x) => (-x / 2) * factor);
    reference.q.push(part(1 - Math.cos(angle)));
    reference.qd.push(part(omega * Math.sin(angle)));
    reference.qdd.push(part(omega * omega * Math.cos(angle)));
  }
  return reference;
}

// A run with the torques of a table, and feedback.
function driven(loop, plant, reference, table, feedback) {
  const law = pid(feedback ? loop.gains : { ...loop.gains, kp: [0, 0] }, loop.step);
  let k = 0;
  const both = (...seen) => {
    const correction = law(...seen);
    return table[k++].map((torque, j) => torque + correction[j]);
  };
  const log = follow(plant, both, reference, loop.step, loop.every, "tachometer");
  const wanted = reference.q.filter((_, n) => n % loop.every === 0);
  return { ...log, error: wanted.map((q, n) => q.map((x, j) => (x - log.q[n][j]) * DEGREES)) };
}

function figureOf(loop, { model, masses, known, feedback, friction, jump }) {
  const { plant } = loop;
  const real = friction ? plant : { ...plant, viscous: [0, 0], coulomb: [0, 0] };
  const reference = jump ? referenceOf(loop) : smoothReference(loop);
  const none = reference.q.map(() => [0, 0]);
  const table = reference.q.map((q, k) => {
    if (!model) return [0, 0];
    const [qd, qdd] = [reference.qd[k], reference.qdd[k]];
    return armTorque(plant.arm, ...q, ...qd, ...qdd).map((torque, j) => {
      const rubbing = known ? frictionTorque(plant.viscous[j], plant.coulomb[j], plant.smoothing, qd[j]) : 0;
      return (masses / 100) * torque + rubbing;
    });
  });
  const run = driven(loop, real, reference, table, feedback);
  const alone = driven(loop, real, reference, none, true);
  const ahead = table.filter((_, k) => k % loop.every === 0);
  const rms = (rows) => Math.sqrt(rows.reduce((sum, x) => sum + x * x, 0) / rows.length);
  const curves = {
    "shoulder error": Float64Array.from(run.error, ([x]) => x),
    "shoulder alone": Float64Array.from(alone.error, ([x]) => x),
    "shoulder ahead": Float64Array.from(ahead, ([x]) => x),
    "shoulder back": Float64Array.from(run.tau, ([x], k) => x - ahead[k][0]),
    share: [(100 * rms(run.error.flat())) / rms(alone.error.flat())],
  };
  NAMES.forEach((name, j) => (curves[`${name} RMS`] = [rms(run.error.map((e) => e[j]))]));
  return { curves, torques: { ahead: rms(curves["shoulder ahead"]), back: rms(curves["shoulder back"]) } };
}

computes((view) => {
  const setting = Object.fromEntries(view.spec.parameters.map((p) => [p.name, view.get(p.name)]));
  const key = JSON.stringify(setting);
  if (view.key !== key) Object.assign(view, { key, figure: figureOf(view.model.get("loop"), setting) });
  return view.figure.curves;
});

// Figure 2-1, whose boxes and arrows say what is switched.
extras.push((view) => {
  const { el } = view;
  el.classList.add("ddlib-feedforward", "quiet");
  view.tall = 180;
  const text = (x, y, words, kind = "") => make("text", { x, y, class: kind }, words);
  const box = (name, x, y, ...lines) => {
    const rows = lines.map((line, k) => text(x, y + 4.5 + 15 * (k - (lines.length - 1) / 2), line));
    return make("g", { class: `box ${name}` }, make("rect", { x: x - 50, y: y - 22, width: 100, height: 44, rx: 5 }), ...rows);
  };
  const flow = (name, d, ...rest) => make("g", { class: `flow ${name}` }, make("path", { d }), ...rest);
  const head = (x, y, turn = 0) => make("path", { class: "head", d: "M0 0L-9 -5V5Z", transform: `translate(${x} ${y}) rotate(${turn})` });
  const sum = (x, y) => make("circle", { class: "sum", cx: x, cy: y, r: 9 });
  const ahead = text(282, 34, "", "amount");
  const back = text(274, 108, "", "amount");
  const knows = text(190, 60, "", "small");
  const svg = make("svg", { class: "figure", role: "img", viewBox: "0 16 484 154" });
  const boxes = [
    box("model", 190, 45),
    box("feedback", 190, 120, "feedback", "at each joint"),
    box("", 52, 82, "reference", "trajectory"),
  ];
  boxes[0].append(text(190, 43, "inverse arm"), knows);
  const rubs = text(432, 146, "", "small");
  const joint = (kind, cx, cy, r) => make("circle", { class: kind, cx, cy, r });
  const arm = make(
    "g",
    { class: "arm" },
    make("path", { class: "link shoulder", d: "M370 120L412 62" }),
    make("path", { class: "link elbow", d: "M412 62L470 76" }),
    joint("shoulder", 370, 120, 10), joint("elbow", 412, 62, 9), joint("elbow", 470, 76, 7),
  ); // prettier-ignore
  svg.append(
    flow("", "M52 60V45H132", head(140, 45)),
    flow("", "M52 104V120H98", head(106, 120)),
    flow("feedback", "M124 120H132", head(140, 120)),
    flow("model", "M240 45H322V102", head(322, 111, 90)),
    flow("feedback", "M240 120H304", head(313, 120)),
    flow("total", "M331 120H346", head(354, 120)),
    flow("", "M370 132V166H115V138", head(115, 129, -90)),
    sum(115, 120), sum(322, 120), ...boxes, arm, rubs, ahead, back,
    text(130, 138, "−", "sign"), text(336, 104, "+", "sign"), text(240, 160, "measured motion", "small"),
  );
  view.top.prepend(svg);
  el.append(el.querySelector(":scope > .frame-bar"));

  const follow = () => {
    const on = (name) => view.get(name);
    const { torques } = view.figure;
    const amount = (x) => `${x.toFixed(1)} N m`;
    svg.classList.toggle("no-model", !on("model"));
    svg.classList.toggle("no-feedback", !on("feedback"));
    const masses = `${Math.round(on("masses"))} %`;
    write(knows, !on("model") ? "off" : on("known") ? `${masses}, friction` : `masses ${masses}`);
    write(rubs, on("friction") ? "arm with friction" : "rigid arm");
    write(ahead, on("model") ? amount(torques.ahead) : "");
    write(back, on("feedback") ? amount(torques.back) : "");
    const wide = (x) => Math.min(9, 1.5 + x / 2);
    svg.style.setProperty("--ahead", wide(torques.ahead));
    svg.style.setProperty("--back", wide(torques.back));
    const feedback = on("feedback") ? amount(torques.back) : "none";
    const words = `the model gives ${on("model") ? amount(torques.ahead) : "nothing"}, feedback ${feedback}`;
    svg.setAttribute("aria-label", `Block diagram: ${words}; the arm is ${on("friction") ? "with friction" : "rigid"}`);
  };
  view.words = () => [svg.getAttribute("aria-label")];
  view.after.push(follow);
  follow();
});
