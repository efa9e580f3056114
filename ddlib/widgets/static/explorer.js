// What FilterExplorer (explorer.py) adds to a HintonWidget: the name that the rule gives, and an
// order in which the weights of the chosen window stand beside the diagram.

import { extras } from "./curves.js";
import { make } from "./elements.js";

extras.push((view) => {
  const verdict = make("p", { class: "verdict" });
  const words = () => `Name by the rule: ${view.model.get("classes")[Math.round(view.curves.class[0])]}`;
  const presets = view.controls.querySelector(".presets") ?? "";
  view.top.append(make("div", { class: "beside" }, presets, verdict, view.charts[0].el));
  view.top.after(view.controls);
  view.el.classList.add("ddlib-explorer");
  view.words = () => [words()];
  view.after.push(() => (verdict.textContent = words()));
});
