// Reads the table of a widget's curves (table.py).

import { numbersOf } from "./elements.js";

const LAST = 2 ** 16 - 1; // largest integer: the upper end of a curve's range

// How many numbers a list of curves has together.
export const samplesOf = (curves) => curves.reduce((sum, { length }) => sum + length, 0);

// The table's curves, each with its first place in the table, and the table's integers.
export function readTable(spec, bytes) {
  const curves = [];
  let at = 0;
  for (const curve of spec.curves) {
    if (!curve.axes) continue; // the page computes it
    curves.push({ ...curve, at });
    at += curve.length * curve.axes.reduce((product, k) => product * spec.parameters[k].grid, 1);
  }
  const steps = at ? numbersOf(bytes, "Uint16") : [];
  if (steps.length !== at) throw new Error(`${steps.length} numbers in place of ${at}`);
  return { curves, steps };
}

// The table's curves by name, at one place for each parameter in its grid.
export function curvesAt(spec, { curves, steps }, places) {
  return Object.fromEntries(
    curves.map(({ name, length, low, high, axes, at }) => {
      const row = axes.reduce((row, k) => row * spec.parameters[k].grid + places[k], 0);
      const from = at + row * length;
      const value = (_, i) => low + (steps[from + i] / LAST) * (high - low);
      return [name, Float64Array.from({ length }, value)];
    }),
  );
}

// Cut into named curves.
export function split(curves, flat) {
  let start = 0;
  return Object.fromEntries(
    curves.map(({ name, length }) => [name, flat.subarray(start, (start += length))]),
  );
}
