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

// The baked table, or an error that says what is wrong with it.
export function readTable(spec, view) {
  if (!spec?.parameters?.length || !spec.curves?.length) throw new Error("no description");
  const samples = spec.curves.reduce((sum, curve) => sum + curve.length, 0);
  const wanted = 2 * spec.parameters.reduce((product, p) => product * p.grid, samples);
  const bytes = new Uint8Array(view.buffer, view.byteOffset, view.byteLength);
  if (bytes.length !== wanted) throw new Error(`${bytes.length} bytes in place of ${wanted}`);
  if (crc32(bytes) !== spec.checksum) throw new Error("the checksum is wrong");
  return Int16Array.from({ length: wanted / 2 }, (_, i) => view.getInt16(2 * i, true));
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

// Grid points and weights, as Parameter.weights in baked.py.
export function weights(p, value, cubic) {
  const position = toFraction(p, value) * (p.grid - 1);
  const i = Math.min(Math.max(Math.trunc(position), 0), p.grid - 2);
  const f = position - i;
  if (!cubic || p.grid === 2) return [[i, 1 - f], [i + 1, f]];
  const [a, b, c, d] = [
    (((2 - f) * f - 1) * f) / 2,
    ((3 * f - 5) * f * f + 2) / 2,
    (((4 - 3 * f) * f + 1) * f) / 2,
    ((f - 1) * f * f) / 2,
  ];
  if (i === 0) return [[0, b + 3 * a], [1, c - 3 * a], [2, d + a]];
  if (i === p.grid - 2) return [[i - 1, a + d], [i, b - 3 * d], [i + 1, c + 3 * d]];
  return [[i - 1, a], [i, b], [i + 1, c], [i + 2, d]];
}

// All curves, one after the other, at one value per parameter.
export function interpolate(spec, table, values) {
  let corners = [[0, 1]];
  spec.parameters.forEach((p, k) => {
    const points = weights(p, values[k], spec.cubic);
    corners = corners.flatMap(([row, w]) => points.map(([i, u]) => [row * p.grid + i, w * u]));
  });
  const samples = spec.curves.reduce((sum, curve) => sum + curve.length, 0);
  const out = new Float64Array(samples);
  for (const [row, w] of corners) {
    for (let s = 0, at = row * samples; s < samples; s++) out[s] += w * table[at + s];
  }
  let s = 0;
  for (const { length, low, high } of spec.curves) {
    const [middle, step] = [(low + high) / 2, (high - low) / 65534];
    for (const end = s + length; s < end; s++) out[s] = middle + step * out[s];
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

// The round number next above `rough`.
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

export function ticks(low, high, count) {
  const step = nice((high - low) / count);
  const first = Math.ceil(low / step - 1e-9);
  const last = Math.floor(high / step + 1e-9);
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

// A value with the digits that its range deserves.
export function format(value, low, high, unit = "") {
  const size = Math.log10(high - low || Math.abs(high) || 1);
  const digits = Math.min(6, Math.max(0, 2 - Math.floor(size)));
  const fixed = value.toFixed(digits).replace(/^-(?=[0.]*$)/, "").replace("-", "−");
  return unit ? `${fixed}${unit === "°" ? "" : "\u00a0"}${unit}` : fixed;
}

const show = (p, value) =>
  p.scale === "log" ? format(value, 0, value, p.unit) : format(value, p.low, p.high, p.unit);
