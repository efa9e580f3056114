// Arms seen from above, drawn over each other.

import { make, put, short } from "ddlib/elements.js";
import { placesOf } from "ddlib/engine.js";

// `kinds` are names of arms, the lowest first; `place(kind, q)` draws one at joint angles in rad. `at` has
// the place of a point in m; `hand(kind)` is where a hand is, in m.
export function armsOf(lengths, kinds, [left, bottom, right, top], label) {
  const scale = 300 / (right - left);
  const x = (v) => short(scale * (v - left));
  const y = (v) => short(scale * (top - v));
  const arms = new Map(
    kinds.map((kind) => {
      const links = ["upper", "fore"].map((link) => make("path", { class: `links ${link}` }));
      const ends = ["elbow", "hand"].map((end) => make("circle", { class: end, r: end === "hand" ? 4 : 7 }));
      return [kind, { links, ends, el: make("g", { class: `arm ${kind}` }, ...links, ...ends) }];
    }),
  );
  const base = make("circle", { class: "joint", cx: x(0), cy: y(0), r: 8 });
  const size = [300, y(bottom)];
  const svg = make("svg", { class: "stage", role: "img", viewBox: `0 0 ${size.join(" ")}` });
  svg.setAttribute("aria-label", label);
  svg.append(...[...arms.values()].map(({ el }) => el), base);
  const place = (kind, q) => {
    const arm = arms.get(kind);
    arm.places = placesOf(lengths, q);
    const [elbow, hand] = arm.places;
    const to = ([a, b]) => `${x(a)} ${y(b)}`;
    arm.links[0].setAttribute("d", `M${to([0, 0])}L${to(elbow)}`);
    arm.links[1].setAttribute("d", `M${to(elbow)}L${to(hand)}`);
    arm.places.forEach(([a, b], k) => put(arm.ends[k], { cx: x(a), cy: y(b) }));
  };
  return { svg, place, arms, at: ([a, b]) => [x(a), y(b)], hand: (kind) => arms.get(kind).places[1] };
}
