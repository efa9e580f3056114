// Parameters of a widget (parts/parameters.py): a value as a part of the range, as a place in the grid,
// in words. Python has checked the description; what comes from elsewhere is brought into its range.

import { format, nice, ticks } from "./numbers.js";

export const toFraction = (p, value) =>
  p.scale === "log"
    ? Math.log(value / p.low) / Math.log(p.high / p.low)
    : (value - p.low) / (p.high - p.low);

export function fromFraction(p, fraction) {
  const value =
    p.scale === "log"
      ? p.low * (p.high / p.low) ** fraction
      : p.low + (p.high - p.low) * fraction;
  return Math.min(p.high, Math.max(p.low, value));
}

// The place of a Choice's key among its options; -1 for none.
export const indexOf = (p, key) => p.options.findIndex(([option]) => option === key);

// The place in a parameter's grid that is nearest to a value.
export const placeOf = (p, value) =>
  p.options ? Math.max(0, indexOf(p, value)) : Math.round(toFraction(p, value) * (p.grid - 1));

// The value that a parameter can have and that is nearest to the given one: on its grid, if it is so
// `stepped`. A missing one or one of another kind is that of the start.
export function valueNear(p, given, stepped) {
  if (p.options) return indexOf(p, given) < 0 ? p.value : given;
  const value = Number.isFinite(given) ? Math.min(p.high, Math.max(p.low, given)) : p.value;
  return stepped ? Number(fromFraction(p, placeOf(p, value) / (p.grid - 1)).toPrecision(12)) : value;
}

// A parameter's value from its text in the address, or an error.
export function valueOfText(p, text) {
  const value = p.options ? p.options.find(([key]) => String(key) === text)?.[0] : Number(text);
  if (p.options ? value === undefined : !(value >= p.low && value <= p.high)) throw new Error(`${p.name}: ${text}`);
  return value;
}

// How many steps a slider has, and the arrow keys: those of the grid, if it is so `stepped`, or else round
// ones of which the range is a multiple.
export function stepsOf(p, stepped) {
  if (stepped) return p.grid - 1;
  const range = p.high - p.low;
  const count = range / nice(range / 100);
  const round = p.scale === "linear" && Math.abs(count - Math.round(count)) < 1e-6;
  return round ? Math.round(count) : 200;
}

// A few round numbers, both ends among them where that is possible.
export function fullTicks(p) {
  if (p.scale === "log") return ticks(Math.log10(p.low), Math.log10(p.high), 4).map((x) => 10 ** x);
  const range = p.high - p.low;
  const count = [3, 4, 5, 2].find((n) => Math.abs((range / n).toPrecision(2) - range / n) < 1e-9);
  if (!count) return ticks(p.low, p.high, 4);
  return Array.from({ length: count + 1 }, (_, i) => p.low + (i * range) / count);
}

// A parameter's value in words.
export function show(p, value) {
  if (p.options) return p.options[indexOf(p, value)][1];
  const low = p.scale === "log" ? 0 : p.low;
  return format(value, low, p.scale === "log" ? value : p.high, p.unit);
}
