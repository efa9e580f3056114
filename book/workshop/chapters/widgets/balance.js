// A balance: what is known lies on its left pan, what is asked on its right one.

import { make, put, short, write } from "ddlib/elements.js";

export const point = (x, y) => `${short(x)} ${short(y)}`;
export const number = (x) => x.toFixed(1).replace(/^-0\.0$/, "0.0").replace("-", "−");

// How far the beam turns, rad: down on the right if that is heavier than `own`.
export const tiltOf = (own, weight) => 0.24 * Math.tanh((3 * (weight - own)) / own);

// A block of metal that stands on its foot.
export function blockPath(x, foot, w, h, s) {
  return (
    `M${point(x - w, foot)}L${point(x - 0.86 * w, foot - h + 4)}Q${point(x - 0.84 * w, foot - h)} ${point(x - 0.72 * w, foot - h)}` +
    `H${short(x - 0.25 * w)}V${short(foot - h - 4 * s)}h${short(-4 * s)}v${short(-7 * s)}H${short(x + 0.25 * w + 4 * s)}v${short(7 * s)}h${short(-4 * s)}` +
    `V${short(foot - h)}H${short(x + 0.72 * w)}Q${point(x + 0.84 * w, foot - h)} ${point(x + 0.86 * w, foot - h + 4)}L${point(x + w, foot)}Z`
  );
}

// `draw(at, own, weight, how)`: `at` has x, top, half (of the beam), post, rope, the scale s, and whether it is
// narrow; weights are in kg m², null for one that is not known yet. Of `how`: tilt, rad; load, how much of the right one lies on its pan.
export function balanceOf(own, asked) {
  const text = (kind, words = "") => make("text", { class: kind }, words);
  const path = (kind) => make("path", { class: kind });
  const pan = (kind, words) => {
    const piece = { ropes: path("ropes"), dish: path("dish"), shape: path("shape"), number: text("number x"), unit: text("unit x", "kg m²") };
    piece.block = make("g", { class: `block ${kind}` }, piece.shape, piece.number, piece.unit);
    return { ...piece, name: text(`pan-name x ${kind}`, words) };
  };
  const parts = { post: path("post"), ticks: path("ticks"), beam: make("line", { class: "beam" }), needle: path("needle"), pivot: make("circle", { class: "pivot" }) };
  const pans = [pan("own", own), pan("net", asked)];
  const el = make("g", { class: "balance" }, ...Object.values(parts), ...pans.flatMap((p) => [p.ropes, p.dish, p.block, p.name]));

  function draw({ x, top, half, post, rope, s, narrow }, known, weight, { tilt, load = 1 }) {
    const ends = [-1, 1].map((side) => [x + side * half * Math.cos(tilt), top + side * half * Math.sin(tilt)]);
    put(parts.post, { d: `M${point(x - 4 * s, top)}L${point(x - 7 * s, top + post)}C${point(x - 20 * s, top + post + 2 * s)} ${point(x - 34 * s, top + post + 4 * s)} ${point(x - 36 * s, top + post + 10 * s)}H${short(x + 36 * s)}C${point(x + 34 * s, top + post + 4 * s)} ${point(x + 20 * s, top + post + 2 * s)} ${point(x + 7 * s, top + post)}L${point(x + 4 * s, top)}Z` });
    const on = (r, angle) => point(x + r * s * Math.sin(angle), top - r * s * Math.cos(angle));
    put(parts.ticks, { d: [-2, -1, 0, 1, 2].map((n) => `M${on(30, n * 0.18)}L${on(37, n * 0.18)}`).join("") });
    put(parts.needle, { d: `M${on(5, tilt + Math.PI / 2)}L${on(28, tilt)}L${on(5, tilt - Math.PI / 2)}Z` });
    put(parts.beam, { x1: short(ends[0][0]), y1: short(ends[0][1]), x2: short(ends[1][0]), y2: short(ends[1][1]) });
    put(parts.pivot, { cx: x, cy: top, r: 7 * s });
    const w = (narrow ? 26 : 40) * s;
    const size = Math.max(0.85, s); // of what holds words
    const [bw, bh] = narrow ? [23 * s, 31 * s] : [29 * size, 38 * size];
    pans.forEach(({ ropes, dish, block, shape, number: digits, unit, name }, side) => {
      const [left, end] = ends[side];
      const floor = end + rope;
      put(ropes, { d: `M${point(left - 0.8 * w, floor)}L${point(left, end)}L${point(left + 0.8 * w, floor)}` });
      put(dish, { d: `M${point(left - w, floor)}H${short(left + w)}Q${point(left, floor + 16 * s)} ${point(left - w, floor)}Z` });
      const value = side ? weight : known;
      const heavy = value > 0.1 * known; // a lighter block has no room for its number
      const foot = floor - (side ? (1 - load) * 26 * s : 0);
      put(shape, { d: heavy ? blockPath(left, foot, bw, bh, s) : "M0 0" });
      block.classList.toggle("bare", !heavy);
      block.style.opacity = side ? load : 1;
      put(digits, { x: short(left), y: short(foot - (heavy ? 0.5 * bh : 10 * s)) });
      put(unit, { x: short(left), y: short(foot - 0.14 * bh) });
      unit.style.display = heavy ? "" : "none";
      write(digits, value === null ? "?" : number(value));
      put(name, { x: short(left), y: short(floor + (narrow ? 21 : 24) * s) });
    });
  }
  return { el, pans, draw };
}
