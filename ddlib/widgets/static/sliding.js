// Window networks along a recording. Layouts, scalings and weights are what `networks` in _plain.py
// writes.

import { numbersOf } from "./elements.js";
import { JOINTS, activity, networkOf, torqueOfOutput } from "./engine.js";

export function modelsOf(layouts, bytes) {
  const all = numbersOf(bytes, "Float32");
  let at = 0;
  const models = layouts.map((model) => {
    const { hidden, outputs, joints, width } = model.layout;
    const units = hidden + outputs;
    const count = units * (joints * width + 1) + hidden * outputs;
    return { ...model, net: networkOf(model.layout, all.subarray(at, (at += count))) };
  });
  if (at !== all.length) throw new Error(`${all.length} weights in place of ${at}`);
  return models;
}

// Positions (rad), joint by joint, scaled for a network's input units.
export const scaledOf = ({ inputs: { low, gain, first } }, positions) =>
  positions.map((x, j) => x.map((q) => first + (q - low[j]) * gain[j]));

// The window around a sample of scaled positions.
function windowAt({ net }, scaled, k, window = new Float64Array(net.inputs)) {
  const first = k - (net.width >> 1);
  scaled.forEach((x, j) => window.set(x.subarray(first, first + net.width), j * net.width));
  return window;
}

// Torques (N m) that a network tells at the samples `from` to `to`, a pair for each.
export function toldTorques(model, scaled, from, to) {
  const { net } = model;
  const [window, hidden, output] = [net.inputs, net.hidden, net.outputs].map((n) => new Float64Array(n));
  return Array.from({ length: to - from }, (_, k) => {
    activity(net, windowAt(model, scaled, from + k, window), hidden, output);
    return torqueOfOutput(model, output);
  });
}

// Positions (rad), joint by joint, and torques (N m) of the motion, from their bytes; positions reach
// `reach` samples beyond it on either side.
export function recordedOf(bytes, samples, reach) {
  const all = numbersOf(bytes, "Float64");
  const [around, wanted] = [samples + 2 * reach, 2 * (2 * samples + 2 * reach)];
  if (all.length !== wanted) throw new Error(`${all.length} numbers in place of ${wanted}`);
  const cut = (from, length) => JOINTS.map((j) => all.subarray(from + j * length, from + (j + 1) * length));
  return { positions: cut(0, around), torques: cut(2 * around, samples) };
}
