// Reads and interpolates the values of baked.py, and writes numbers. Every widget's module
// starts with this file (see `module` in base.py).

function crc32(bytes) {
  let crc = ~0;
  for (const byte of bytes) {
    crc ^= byte;
    for (let k = 0; k < 8; k++) crc = (crc >>> 1) ^ (0xedb88320 & -(crc & 1));
  }
  return ~crc >>> 0;
}

// What there must be in each part of a description, separated by spaces.
const FIELDS = {
  spec: "key title note code presets parameters curves panels scalars pad groups checksum error checks",
  group: "parameters curves rank wide scale",
  parameter: "name label grid value",
  choice: "display",
  range: "low high unit scale",
  curve: "name length low high",
  panel: "y_label curves x_label x x_scale y_scale kind fixed cursor ticks y_range y_fit",
  scalar: "name label unit scale",
  pad: "x y marks region region_label snap",
};

function need(what, object) {
  const missing = FIELDS[what].split(" ").find((field) => object?.[field] === undefined);
  if (missing) throw new Error(`"${missing}" of the ${what} is missing`);
}

// Complain about a description in which something is missing.
export function checkSpec(spec) {
  if (!spec?.parameters?.length || !spec.curves?.length) throw new Error("no description");
  need("spec", spec);
  for (const p of spec.parameters) {
    need("parameter", p);
    need(p.options ? "choice" : "range", p);
  }
  spec.curves.forEach((curve) => need("curve", curve));
  spec.groups.forEach((group) => need("group", group));
  const names = new Set(spec.curves.map((curve) => curve.name));
  for (const panel of spec.panels) {
    need("panel", panel);
    for (const name of [...panel.curves.map(([curve]) => curve), ...panel.cursor]) {
      if (!names.has(name)) throw new Error(`there is no curve "${name}"`);
    }
  }
  spec.scalars.forEach((scalar) => need("scalar", scalar));
  if (spec.pad) need("pad", spec.pad);
}

// How many numbers all curves have together.
export const samplesOf = (spec) => spec.curves.reduce((sum, curve) => sum + curve.length, 0);

// How many spline coefficients a parameter has.
const sizeOf = (p) => p.grid + (p.options ? 0 : 2);

// The baked tables, one per group, or an error that says what is wrong with them.
export function readTables(spec, view) {
  checkSpec(spec);
  if (!view?.buffer) throw new Error("the baked values are missing");
  const starts = [0];
  for (const { length } of spec.curves) starts.push(starts.at(-1) + length);
  const groups = spec.groups.map((group) => {
    const pieces = group.curves.map((k) => ({ ...spec.curves[k], start: starts[k] }));
    const samples = pieces.reduce((sum, { length }) => sum + length, 0);
    const sizes = group.parameters.map((k) => sizeOf(spec.parameters[k]));
    const rows = sizes.reduce((product, size) => product * size, 1);
    return { ...group, pieces, samples, sizes, rows, columns: group.rank || samples };
  });
  const bytes = ({ rows, columns, rank, samples, wide }) =>
    rows * (columns + wide) + (rank ? (rank + wide) * samples : 0);
  const wanted = groups.reduce((sum, group) => sum + bytes(group), 0);
  const given = new Uint8Array(view.buffer, view.byteOffset, view.byteLength);
  if (given.length !== wanted) throw new Error(`${given.length} bytes in place of ${wanted}`);
  if (crc32(given) !== spec.checksum) throw new Error("the checksum is wrong");
  const data = new DataView(view.buffer, view.byteOffset, view.byteLength);
  let at = 0;
  const next = (size) => (size === 2 ? data.getInt16((at += 2) - 2, true) : data.getInt8(at++));
  for (const group of groups) {
    const { rows, columns, rank, samples, wide } = group;
    group.table = new Int16Array(rows * columns);
    group.shapes = new Int16Array(rank * samples);
    for (const [from, to, size] of [[0, wide, 2], [wide, columns, 1]]) {
      for (let row = 0; row < rows; row++) {
        for (let c = from; c < to; c++) group.table[row * columns + c] = next(size);
      }
    }
    for (let i = 0; i < rank * samples; i++) group.shapes[i] = next(i < wide * samples ? 2 : 1);
  }
  return groups;
}

// Complain about a parameter's value that is none.
export function checkValue(p, value) {
  const good = p.options
    ? indexOf(p, value) >= 0
    : typeof value === "number" && value >= p.low && value <= p.high;
  if (!good) throw new Error(`${p.name} is ${value === undefined ? "missing" : String(value)}`);
}

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

// Places among the spline's coefficients, and weights, as `weights` in parameters.py.
export function weights(p, value) {
  if (p.options) return [[indexOf(p, value), 1]];
  const position = toFraction(p, value) * (p.grid - 1);
  const i = Math.min(Math.max(Math.trunc(position), 0), p.grid - 2);
  const f = position - i;
  return [
    [i, (1 - f) ** 3 / 6],
    [i + 1, ((3 * f - 6) * f * f + 4) / 6],
    [i + 2, (((3 - 3 * f) * f + 3) * f + 1) / 6],
    [i + 3, f ** 3 / 6],
  ];
}

// The curves of a group, one after the other, each scaled to the range -1 to 1.
function mix(spec, group, values) {
  const { parameters, sizes, samples, rank, columns, scale, table, shapes } = group;
  let corners = [[0, 1]];
  parameters.forEach((k, axis) => {
    const points = weights(spec.parameters[k], values[k]);
    corners = corners.flatMap(([row, w]) => points.map(([i, u]) => [row * sizes[axis] + i, w * u]));
  });
  const mixed = new Float64Array(columns);
  for (const [row, w] of corners) {
    for (let s = 0, at = row * columns; s < columns; s++) mixed[s] += w * table[at + s];
  }
  if (!rank) return mixed.map((x) => x * scale[0]);
  const out = new Float64Array(samples);
  for (let k = 0; k < rank; k++) {
    const weight = mixed[k] * scale[k];
    for (let s = 0, at = k * samples; s < samples; s++) out[s] += weight * shapes[at + s];
  }
  return out;
}

// All curves, one after the other, at one value per parameter.
export function interpolate(spec, tables, values) {
  const out = new Float64Array(samplesOf(spec));
  for (const group of tables) {
    const scaled = mix(spec, group, values);
    let from = 0;
    for (const { start, length, low, high } of group.pieces) {
      const [middle, half] = [(low + high) / 2, (high - low) / 2];
      for (let s = 0; s < length; s++) out[start + s] = middle + half * scaled[from++];
    }
  }
  return out;
}

// Cut into named curves.
export function split(spec, flat) {
  let start = 0;
  return Object.fromEntries(
    spec.curves.map(({ name, length }) => [name, flat.subarray(start, (start += length))]),
  );
}

export function insidePolygon(corners, x, y) {
  const sides = corners.map(([x0, y0], k) => {
    const [x1, y1] = corners[(k + 1) % corners.length];
    return (x1 - x0) * (y - y0) - (y1 - y0) * (x - x0);
  });
  return sides.every((s) => s >= -1e-9) || sides.every((s) => s <= 1e-9);
}

// The round number next above `rough`, or it.
function nice(rough) {
  const power = 10 ** Math.floor(Math.log10(rough));
  return power * [1, 2, 2.5, 5, 10].find((m) => m * power >= rough * 0.999);
}

// How far one press of an arrow key moves: a round step of which the range is a multiple.
export function stepOf(p) {
  const range = p.high - p.low;
  const count = range / nice(range / 100);
  const round = p.scale === "linear" && Math.abs(count - Math.round(count)) < 1e-6;
  return round ? 1 / Math.round(count) : 0.005;
}

// The round numbers around an interval, or within a fiftieth of a step: less is not seen.
export function around(low, high, log = false) {
  if (log) return [10 ** Math.floor(Math.log10(low)), 10 ** Math.ceil(Math.log10(high))];
  const step = nice((high - low || Math.abs(high) || 1) / 4);
  const [first, last] = [Math.floor(low / step + 0.02), Math.ceil(high / step - 0.02)];
  return [first * step, Math.max(last, first + 1) * step];
}

// About `count` round numbers within an interval, never fewer than two.
export function ticks(low, high, count) {
  const step = nice((high - low) / count);
  const first = Math.ceil(low / step - 1e-9);
  const last = Math.floor(high / step + 1e-9);
  if (last <= first) return ticks(low, high, count + 1);
  return Array.from({ length: last - first + 1 }, (_, i) => (first + i) * step);
}

// A few round numbers, both ends among them where that is possible.
export function fullTicks(p) {
  if (p.scale === "log") return ticks(Math.log10(p.low), Math.log10(p.high), 4).map((x) => 10 ** x);
  const range = p.high - p.low;
  const count = [3, 4, 5, 2].find((n) => Math.abs((range / n).toPrecision(2) - range / n) < 1e-9);
  if (!count) return ticks(p.low, p.high, 4);
  return Array.from({ length: count + 1 }, (_, i) => p.low + (i * range) / count);
}

// Numbers as text, all with the same number of decimals unless they are powers of ten.
export function labels(numbers, log = false) {
  const texts = numbers.map((x) => String(Number(x.toPrecision(6))));
  const digits = Math.max(...texts.map((text) => (text.split(".")[1] ?? "").length));
  const short = log || texts.some((text) => text.includes("e"));
  return texts.map((text, i) => (short ? text : numbers[i].toFixed(digits)).replace("-", "−"));
}

// A value with the decimals that its range deserves, or with `digits` of them.
export function format(value, low, high, unit = "", digits = null) {
  const size = Math.log10(high - low || Math.abs(high) || 1);
  const decimals = digits ?? Math.min(6, Math.max(0, 2 - Math.floor(size)));
  const fixed = value.toFixed(decimals).replace(/^-(?=[0.]*$)/, "").replace("-", "−");
  return unit ? `${fixed}${unit === "°" ? "" : "\u00a0"}${unit}` : fixed;
}

// A parameter's value in words.
function show(p, value) {
  if (p.options) return p.options[indexOf(p, value)][1];
  const low = p.scale === "log" ? 0 : p.low;
  return format(value, low, p.scale === "log" ? value : p.high, p.unit);
}
