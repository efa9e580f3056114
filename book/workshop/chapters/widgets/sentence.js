// Shows a LiveSentence (sentence.py): numbers to drag or to step, and an end that is computed.

import { buttonOf, dress, make, onKeys, put, write } from "ddlib/elements.js";
import { filled, frameOf, python } from "ddlib/frame.js";
import { growthOf } from "./loops.js";
import { format } from "ddlib/numbers.js";
import { armTorque } from "ddlib/physics.js";

// What each kind of sentence computes: texts by the names of its results.
const ENDS = {
  torque: ({ arm }, { elbow, first, second }) => {
    const torque = armTorque(arm, 0, (elbow * Math.PI) / 180, first, second, 0, 0);
    const [shoulder, forearm] = torque.map((x) => `${signed(x, 2)}\u00a0N\u00a0m`);
    return { shoulder, forearm };
  },
  loop: (spec, { period, kp, kd, friction }) => {
    const modes = spec.modes.map((mode) => ({ ...mode, rate: (mode.rate * friction) / spec.friction }));
    const gains = { kp: [kp, kp * spec.ratios.kp], ki: [0, 0], kd: [kd, kd * spec.ratios.kd] };
    const growth = growthOf(modes, gains, period / 1000, 0);
    const seconds = Math.LN2 / Math.abs(growth);
    const time = `${seconds.toFixed(seconds < 10 ? 2 : 0)}\u00a0s`;
    const stable = `stable, and a disturbance halves in ${time}`;
    return { verdict: growth < 0 ? stable : `unstable, and a swing doubles in ${time}` };
  },
};

const PIXELS = 6; // of a drag for a step

// Sign, number and unit: on one line.
const together = (...parts) => make("span", { class: "together" }, ...parts);

const signed = (value, digits) => format(value, 0, 1, "", digits);

function render({ model, el }) {
  const spec = model.get("spec");
  dress(el, "A sentence whose numbers can be moved", "ddlib-sentence");
  const updates = [];

  function numberOf({ name, label, unit, low, high, step }) {
    const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
    const get = () => model.get("values")[name];
    const set = (value) => {
      const round = Math.round(value / step) * step;
      const next = Number(Math.min(high, Math.max(low, round)).toFixed(digits));
      if (next === get()) return;
      model.set("values", { ...model.get("values"), [name]: next });
      model.save_changes();
      frame.changed();
    };
    const number = make("span", { class: "number", role: "spinbutton", tabindex: 0, "aria-label": label });
    put(number, { "aria-valuemin": low, "aria-valuemax": high });
    const keys = { ArrowUp: 1, ArrowRight: 1, ArrowDown: -1, ArrowLeft: -1, PageUp: 10, PageDown: -10 };
    onKeys(number, (event) => {
      if (keys[event.key]) set(get() + keys[event.key] * step);
      else if (event.key === "Home") set(low);
      else if (event.key === "End") set(high);
      else return false;
    });
    let begun = null;
    number.addEventListener("pointerdown", (event) => {
      if (event.button) return;
      event.preventDefault();
      number.focus({ preventScroll: true });
      number.setPointerCapture(event.pointerId);
      begun = { x: event.clientX, value: get() };
    });
    number.addEventListener("pointermove", (event) => {
      if (begun) set(begun.value + Math.round((event.clientX - begun.x) / PIXELS) * step);
    });
    for (const end of ["pointerup", "pointercancel"]) number.addEventListener(end, () => (begun = null));
    // For fingers: they come with the focus, and the keyboard does without them.
    const nudge = (sign, by) => {
      const move = () => set(get() + by * step);
      const button = buttonOf(sign, move, { tabindex: -1, "aria-hidden": "true" });
      button.addEventListener("pointerdown", (event) => event.preventDefault()); // keeps the focus
      return button;
    };
    updates.push(() => {
      const text = `${signed(get(), digits)}${unit === "°" ? "" : "\u00a0"}${unit.replaceAll(" ", "\u00a0")}`;
      write(number, text);
      put(number, { "aria-valuenow": get(), "aria-valuetext": text });
    });
    const stepper = make("span", { class: "stepper" }, nudge("−", -1), nudge("+", 1));
    return make("span", { class: "movable" }, number, stepper);
  }

  const results = {};
  const words = [];
  for (const part of spec.parts) {
    const [, name, result] = part.match(/^(?:\{(\w+)\}|<(\w+)>)$/) ?? [];
    if (name) words.push(together(numberOf(spec.numbers.find((number) => number.name === name))));
    else if (result) words.push((results[result] = make("output", {})));
    else if (/^[,.;]/.test(part) && words.at(-1)?.className === "together") {
      words.at(-1).append(part[0]); // no line begins with it
      words.push(part.slice(1));
    } else words.push(part);
  }
  const update = () => {
    updates.forEach((show) => show());
    const texts = ENDS[spec.kind](spec, model.get("values"));
    for (const [name, output] of Object.entries(results)) {
      if (output.textContent === texts[name]) continue;
      const pieces = texts[name].split(" ").map((piece) => together(piece));
      output.replaceChildren(...pieces.flatMap((piece, k) => (k ? [" ", piece] : [piece])));
    }
  };
  const code = () => {
    const texts = Object.entries(model.get("values")).map(([name, value]) => [name, python(value)]);
    return filled(spec.code, Object.fromEntries(texts));
  };
  const frame = frameOf({ el, key: spec.key, title: "", linked: Boolean(model.kernelless), code });
  for (const { name, low, high, value } of spec.numbers) {
    const read = () => String(model.get("values")[name]);
    const restore = (text) => {
      const number = Number(text);
      if (!(number >= low && number <= high)) throw new Error(`${name} is ${text}`);
      model.set("values", { ...model.get("values"), [name]: number });
      model.save_changes();
    };
    frame.keep(name, read, restore, String(value));
  }
  el.replaceChildren(make("p", { class: "sentence" }, ...words), frame.el);
  model.on("change:values", update);
  update();
  return () => {
    model.off("change:values", update);
    frame.stop();
  };
}

export default { render };
