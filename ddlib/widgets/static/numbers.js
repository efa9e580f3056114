// Round numbers, and numbers as text.

export function insidePolygon(corners, x, y) {
  const sides = corners.map(([x0, y0], k) => {
    const [x1, y1] = corners[(k + 1) % corners.length];
    return (x1 - x0) * (y - y0) - (y1 - y0) * (x - x0);
  });
  return sides.every((s) => s >= -1e-9) || sides.every((s) => s <= 1e-9);
}

// The round number next above `rough`, or it.
export function nice(rough) {
  const power = 10 ** Math.floor(Math.log10(rough));
  return power * [1, 2, 2.5, 5, 10].find((m) => m * power >= rough * 0.999);
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

// A power of ten as text: whole ones with thousands apart, others with three digits.
export function powerText(x) {
  const value = Number((10 ** x).toPrecision(3));
  return value >= 1e-4 && value < 1e7 ? value.toLocaleString("en-US", { maximumFractionDigits: 6 }) : String(value).replace("-", "−");
}
