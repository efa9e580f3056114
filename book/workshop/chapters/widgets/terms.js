// What TorqueTerms (terms.py) computes and adds to a CurveWidget: the arm along its motion, the torque
// of each joint as an arrow, and two guesses.

import { clockOf } from "ddlib/clock.js";
import { computes, extras } from "ddlib/curves.js";
import { buttonOf, make, short, write } from "ddlib/elements.js";
import { JOINTS, NAMES, pickAndPlace, placesOf } from "ddlib/engine.js";
import { armTorque, frictionTorque } from "ddlib/physics.js";
import { armsOf } from "./stage.js";

const [SUM, FRICTION, BEFORE] = ["actuation", "friction", "at single speed"];
const LETTERS = "ABCD";

// The torque of a state by its origin, a pair for each term: what is left of the equations of the
// arm if only one acceleration, or only the speeds of one joint, are there.
function termsOf({ viscous, coulomb, smoothing }, arm, { q, qd, qdd }, rubs) {
  const of = (v1, v2, a1, a2) => armTorque(arm, q[0], q[1], v1, v2, a1, a2);
  const [first, second] = [of(0, 0, qdd[0], 0), of(0, 0, 0, qdd[1])];
  const [turning, folding, both] = [of(qd[0], 0, 0, 0), of(0, qd[1], 0, 0), of(qd[0], qd[1], 0, 0)];
  const centrifugal = JOINTS.map((j) => turning[j] + folding[j]);
  const friction = JOINTS.map((j) => (rubs ? frictionTorque(viscous[j], coulomb[j], smoothing, qd[j]) : 0));
  const whole = of(qd[0], qd[1], qdd[0], qdd[1]);
  return {
    [SUM]: JOINTS.map((j) => whole[j] + friction[j]),
    centrifugal,
    coupling: [second[0], first[1]],
    Coriolis: JOINTS.map((j) => both[j] - centrifugal[j]),
    inertial: [first[0], second[1]],
    [FRICTION]: friction,
  };
}

const rmsOf = (values) => Math.sqrt(values.reduce((sum, x) => sum + x * x, 0) / values.length);

// The motion as it is chosen: its seconds, and state and terms at a part of it from 0 to 1.
function motionOf(view, doubled = view.get("doubled")) {
  const moving = view.model.get("moving");
  const seconds = moving.seconds / (doubled ? 2 : 1);
  const [arm, extents] = [moving.arms[view.get("load")], moving.extents[view.get("motion") - 1]];
  const stateAt = (part) => pickAndPlace(extents, Math.min(part, 1 - 1e-9) * seconds, seconds);
  const at = (part) => termsOf(moving, arm, stateAt(part), view.get("friction"));
  return { seconds, stateAt, at };
}

computes((view) => {
  const { terms } = view.model.get("moving");
  const along = ({ at }) => view.spec.panels[0].x.map((done) => at(done / 100));
  const all = along(motionOf(view));
  const before = along(motionOf(view, false));
  const curves = {};
  NAMES.forEach((joint, j) => {
    for (const name of terms) curves[`${joint} ${name}`] = all.map((torque) => torque[name][j]);
    curves[`${joint} ${BEFORE}`] = before.map((torque) => torque[SUM][j]);
    const sum = (a, b) => rmsOf(all.map((torque) => torque[a][j] + torque[b][j]));
    curves[`${joint} ratio`] = [(100 * sum("centrifugal", "Coriolis")) / sum("inertial", "coupling")];
  });
  return curves;
});

// An arrow around a joint (px), anticlockwise for a positive torque: `share` of the largest one.
function turnOf(radius) {
  const [line, tip] = [make("path", {}), make("path", { class: "tip" })];
  const el = make("g", { class: "turn" }, line, tip);
  const draw = ([x, y], from, share) => {
    const angle = from + 2.4 * share;
    const on = (a, r = radius) => `${short(x + r * Math.cos(a))} ${short(y - r * Math.sin(a))}`;
    line.setAttribute("d", `M${on(from)}A${radius} ${radius} 0 0 ${share > 0 ? 0 : 1} ${on(angle)}`);
    const ahead = angle + (Math.sign(share) * 9) / radius;
    tip.setAttribute("d", `M${on(angle, radius - 5)}L${on(ahead)}L${on(angle, radius + 5)}Z`);
    el.setAttribute("visibility", Math.abs(share) > 0.02 ? "visible" : "hidden");
  };
  return { el, draw };
}

const WHY = {
  coupling: "The elbow's motor mostly carries the forearm along while the shoulder speeds up or slows down.",
  inertial: "On this motion the elbow's motor mostly accelerates the forearm itself.",
};

extras.push((view) => {
  const { spec, model } = view;
  const { lengths, terms, extents } = model.get("moving");
  view.el.classList.add("ddlib-terms");
  const newtons = (x) => `${x.toFixed(2).replace("-", "−")}\u00a0N\u00a0m`;

  // The arm, its motion in pale pictures, and the torques as arrows
  const ghosts = [0, 1, 2, 3, 4].map((k) => `ghost g${k}`);
  const box = [-0.12, -0.84, 0.95, 0.13];
  const stage = armsOf(lengths, [...ghosts, "real"], box, "The arm from above. Pale: its whole motion. Arrows: the torque of each motor");
  const turns = [turnOf(36), turnOf(29)]; // outside the rings of the joints
  stage.svg.append(...turns.map(({ el }) => el));
  const scale = 300 / (box[2] - box[0]);
  const px = ([x, y]) => [scale * (x - box[0]), scale * (box[3] - y)];

  let motion = motionOf(view);
  const largest = () => NAMES.map((joint) => Math.max(...view.curves[`${joint} ${SUM}`].map(Math.abs)) || 1);
  function draw(now) {
    const part = now / end;
    const { q } = motion.stateAt(part);
    const torque = motion.at(part);
    stage.place("real", q);
    const most = largest();
    const places = placesOf(lengths, q);
    turns[0].draw(px([0, 0]), q[0], torque[SUM][0] / most[0]);
    turns[1].draw(px(places[0]), q[0] + q[1], torque[SUM][1] / most[1]);
    view.charts.forEach((c) => c.point(100 * part));
  }
  const { seconds: end } = model.get("moving");
  const speed = () => end / motion.seconds;
  const moments = { at: 0.3 * end, end, step: end / 300, rate: speed, stopped: view.changed };
  const clock = clockOf(view, moments, draw);

  // The guesses
  const ask = make("p", { class: "ask" });
  const answers = make("div", { class: "answers", role: "group" });
  const verdict = make("p", { class: "verdict", role: "status" });
  const guess = make("div", { class: "guess" }, verdict, ask, answers);
  let [first, second] = ["", ""];
  const four = terms.filter((name) => name !== SUM && name !== FRICTION);
  const rms = (name) => rmsOf(view.curves[`elbow ${name}`]);
  const top = () => four.reduce((a, b) => (rms(b) > rms(a) ? b : a));
  const BETS = ["They gain", "The ratio stays", "They fall behind"];
  let shown = null;
  function answer() {
    if (!first) return "";
    const best = top();
    const right = first === best ? "Yes" : `Not ${first}`;
    const largestTerm = `${right}: the largest at the elbow is ${best}, ${newtons(rms(best))} (root mean square). ${WHY[best] ?? ""}`.trim();
    if (!second) return largestTerm;
    const own = second === BETS[1] ? "Yes" : "No";
    const ratio = `${own}, the ratio stays. At double speed every term is four times as large.`;
    return `${ratio} Does friction, too? Switch it on.`;
  }
  function question() {
    const stage = first ? (second ? 2 : 1) : 0;
    const texts = [
      `Curve ${LETTERS[four.indexOf(top())]} is the largest at the elbow. Which term is it?`,
      "Now bet. At double speed, do centrifugal and Coriolis torque gain on the other two?",
      "",
    ];
    write(ask, texts[stage]);
    write(verdict, answer());
    if (stage === shown) return;
    shown = stage;
    view.el.classList.toggle("named", stage > 0);
    const choose = [
      ["inertial", "coupling", "centrifugal", "Coriolis"].map((name) => [name, () => set(name, "")]),
      BETS.map((bet) => [bet, () => { set(first, bet); view.set({ doubled: true }); }]),
      [],
    ];
    answers.replaceChildren(...choose[stage].map(([text, act]) => buttonOf(text, act)));
    const name = (term) => (stage || !four.includes(term) ? term : LETTERS[four.indexOf(term)]);
    for (const chart of view.charts) {
      chart.rename([...terms.map(name), BEFORE]);
      chart.describe(view.curves);
    }
  }
  function set(term, bet) {
    const held = answers.contains(document.activeElement);
    [first, second] = [term, bet];
    question();
    if (held) (answers.firstChild ?? clock.play).focus({ preventScroll: true });
    view.changed();
  }
  const restore = (text) => {
    const [term = "", bet = ""] = text.split(";");
    if (![...four, ""].includes(term) || ![...BETS, ""].includes(bet)) throw new Error(`no guess ${text}`);
    set(term, bet);
  };
  view.words = () => (first ? [answer().slice(0, -1)] : []);

  const player = make("div", { class: "player" }, clock.play, clock.el);
  view.top.prepend(make("div", { class: "arm-box" }, stage.svg, player));
  view.controls.append(guess);
  const charts = view.el.querySelector(".charts");
  const scene = make("div", { class: "scene" });
  charts.after(scene);
  scene.append(view.top, view.numbers, charts);
  let rate = 0;
  let path = "";
  const follow = () => {
    motion = motionOf(view);
    const chosen = String(extents[view.get("motion") - 1]);
    if (path !== chosen) ghosts.forEach((kind, k) => stage.place(kind, motion.stateAt(k / 8).q));
    path = chosen;
    view.el.classList.toggle("rubs", view.get("friction"));
    view.el.classList.toggle("doubled", view.get("doubled"));
    if (rate && rate !== motion.seconds) clock.again();
    rate = motion.seconds;
    clock.show();
    question();
  };
  view.after.push(follow);
  follow();
  view.keep("guess", () => (first ? `${first};${second}` : ""), restore, "");
  view.keep("time", () => clock.now().toFixed(2), (text) => clock.stand(Number(text)));
  return () => clock.pause();
});
