// Arms seen from above, drawn over each other.

import { make, put, short } from "ddlib/elements.js";
import { placesOf } from "ddlib/engine.js";

// `kinds` are names of arms, the lowest first; `place(kind, q)` draws one at joint angles in rad.
export function armsOf(lengths, kinds, [left, bottom, right, top], label) {
  const scale = 300 / (right - left);
  const x = (v) => short(scale * (v - left));
  const y = (v) => short(scale * (top - v));
  const arms = new Map(
    kinds.map((kind) => {
      const links = ["upper", "fore"].map((link) => make("path", { class: `links ${link}` }));
      const hand = make("circle", { class: "hand", r: 4 });
      return [kind, { links, hand, el: make("g", { class: `arm ${kind}` }, ...links, hand) }];
    }),
  );
  const base = make("circle", { class: "joint", cx: x(0), cy: y(0), r: 6 });
  const size = [300, y(bottom)];
  const svg = make("svg", { class: "stage", role: "img", viewBox: `0 0 ${size.join(" ")}` });
  svg.setAttribute("aria-label", label);
  svg.append(...[...arms.values()].map(({ el }) => el), base);
  const place = (kind, q) => {
    const { links, hand } = arms.get(kind);
    const [elbow, end] = placesOf(lengths, q);
    const at = ([a, b]) => `${x(a)} ${y(b)}`;
    links[0].setAttribute("d", `M${at([0, 0])}L${at(elbow)}`);
    links[1].setAttribute("d", `M${at(elbow)}L${at(end)}`);
    put(hand, { cx: x(end[0]), cy: y(end[1]) });
  };
  return { svg, place, arms };
}
