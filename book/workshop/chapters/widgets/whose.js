// Shows WhoseFilters (whose.py): in each round two galleries of filters, of which the reader says which
// one learnt this arm's torques.

import { buttonOf, dress, make, put, safely, short, write } from "ddlib/elements.js";
import { frameOf } from "ddlib/frame.js";

const SIDES = ["A", "B"];
const COLUMNS = 5;
const [WIDE, HIGH, GAP] = [60, 30, 6]; // of a filter's field, and what it leaves free

// Which colour a filter has once the answer is there.
const KINDS = { acceleration: "even", velocity: "odd", "velocity + acceleration": "c0", "not analysable": "none" };
const kindOf = (name) => KINDS[name] ?? "c2";
const calledOf = (name) => (name === "not analysable" ? "without a name" : name);

// A row of weights as a curve in its field, as high as its own largest weight.
function curveOf(row, k) {
  const [left, middle] = [(k % COLUMNS) * WIDE, (Math.floor(k / COLUMNS) + 0.5) * HIGH];
  const most = Math.max(...row.map(Math.abs)) || 1;
  const x = (i) => short(left + GAP / 2 + (i / (row.length - 1)) * (WIDE - GAP));
  const y = (v) => short(middle - (v / most) * (HIGH / 2 - GAP / 2));
  const zero = make("line", { class: "zero", x1: x(0), x2: x(row.length - 1), y1: middle, y2: middle });
  const path = make("path", { class: "row", d: `M${row.map((v, i) => `${x(i)} ${y(v)}`).join("L")}` });
  return [zero, path];
}

function galleryOf(letter, guess) {
  const svg = make("svg", { role: "img" });
  const button = buttonOf(`${letter} learnt this arm`, guess);
  const counted = make("p", { class: "told" });
  const head = make("p", { class: "letter" }, letter);
  return { svg, button, counted, el: make("div", { class: "gallery" }, head, svg, button, counted) };
}

// How many filters have which name, with its colour.
function countsOf(counts) {
  return counts.flatMap(([name, many], k) => [
    k ? ", " : "",
    make("span", { class: `swatch ${kindOf(name)}`, "aria-hidden": "true" }),
    ` ${many}\u00a0${calledOf(name)}`,
  ]);
}

function build({ model, el }) {
  const { key, title, rounds } = model.get("spec");
  dress(el, title, "ddlib-whose");
  const get = (name) => model.get(name);
  const guessOf = (k) => get("guesses")[k] ?? "-";
  const rightOf = (k) => SIDES[rounds[k].galleries.findIndex(({ arm }) => arm)];

  function keepAll(changes) {
    for (const [name, value] of Object.entries(changes)) model.set(name, value);
    model.save_changes();
    frame.changed();
  }
  const guess = (letter) => () => {
    const k = get("round");
    if (guessOf(k) !== "-") return;
    (next.disabled ? steps[k] : next).focus({ preventScroll: true }); // this button goes out of use
    keepAll({ guesses: rounds.map((_, i) => (i === k ? letter : guessOf(i))).join("") });
  };
  const galleries = SIDES.map((letter) => galleryOf(letter, guess(letter)));
  const steps = rounds.map((_, k) => buttonOf(String(k + 1), () => keepAll({ round: k }), { "aria-label": `Round ${k + 1}` }));
  const next = buttonOf("Next round", () => keepAll({ round: Math.min(get("round") + 1, rounds.length - 1) }));
  const score = make("output", { class: "score" });
  const verdict = make("p", { class: "verdict", role: "status" });
  const bar = make("div", { class: "presets" }, make("span", {}, "Round"), ...steps, next, score);

  const frame = frameOf({ el, key, title, linked: Boolean(model.kernelless), code: () => "" });
  const fresh = "-".repeat(rounds.length);
  const keepWhole = (text) => {
    if (text.length !== rounds.length || /[^AB-]/.test(text)) throw new Error(`guesses are ${text}`);
    keepAll({ guesses: text });
  };
  const keepRound = (text) => {
    const k = Number(text) - 1;
    if (!rounds[k]) throw new Error(`round is ${text}`);
    keepAll({ round: k });
  };
  frame.keep("guesses", () => get("guesses"), keepWhole, fresh);
  frame.keep("round", () => String(get("round") + 1), keepRound, "1");

  let drawn = -1;
  function draw(k) {
    drawn = k;
    rounds[k].galleries.forEach(({ rows }, side) => {
      const high = Math.ceil(rows.length / COLUMNS) * HIGH;
      put(galleries[side].svg, { viewBox: `0 0 ${COLUMNS * WIDE} ${high}` });
      galleries[side].svg.replaceChildren(...rows.flatMap(curveOf));
    });
  }
  function update() {
    const k = get("round");
    const [mine, right] = [guessOf(k), rightOf(k)];
    if (drawn !== k) draw(k);
    galleries.forEach(({ svg, button, counted }, side) => {
      const { names, counts } = rounds[k].galleries[side];
      const known = mine !== "-";
      svg.querySelectorAll(".row").forEach((path, i) => path.setAttribute("class", `row ${known ? kindOf(names[i]) : ""}`));
      const inWords = counts.map(([name, many]) => `${many} ${calledOf(name)}`).join(", ");
      svg.setAttribute("aria-label", `Gallery ${SIDES[side]}: ${names.length} rows of weights${known ? `: ${inWords}` : ""}`);
      counted.replaceChildren(...(known ? countsOf(counts) : ["\u00a0"]));
      button.disabled = known;
      button.setAttribute("aria-pressed", String(mine === SIDES[side]));
    });
    steps.forEach((step, i) => step.setAttribute("aria-pressed", String(i === k)));
    next.disabled = k === rounds.length - 1;
    const tried = rounds.map((_, i) => i).filter((i) => guessOf(i) !== "-");
    const hits = tried.filter((i) => guessOf(i) === rightOf(i)).length;
    write(score, tried.length ? `${hits} of ${tried.length} right` : "no guess yet");
    const other = SIDES.find((letter) => letter !== right);
    const answer = `${right} learnt this arm’s torques, ${other} ${rounds[k].learnt}.`;
    const begin = mine === right ? "Right:" : "No:";
    write(verdict, mine === "-" ? "Which of the two learnt this arm’s torques?" : `${begin} ${answer} ${rounds[k].remark}`);
  }
  const shown = make("div", { class: "galleries" }, ...galleries.map(({ el }) => el));
  el.replaceChildren(frame.el, bar, verdict, shown);
  const events = ["change:round", "change:guesses"];
  for (const event of events) model.on(event, update);
  update();
  return () => {
    for (const event of events) model.off(event, update);
    frame.stop();
  };
}

const render = safely(build);
export default { render };
