// What the scales (weigh.py), the knob and the pencil (pencil.py) add to a CurveWidget: charts in
// lines that fit a screen with the handle, and what is written beside the row that it is written into.

import { extras } from "ddlib/curves.js";
import { make } from "ddlib/elements.js";

extras.push((view) => {
  const { el, charts, numbers } = view;
  el.classList.add("ddlib-scales", `of-${charts.length}`);
  const rows = charts.filter(({ panel }) => panel.curves[0][0].startsWith("row_"));
  if (!rows.length) return;
  const written = [...numbers.children].slice(-rows.length);
  rows.forEach((row, k) => {
    row.el.classList.add("row");
    const title = row.el.querySelector(".title");
    title.append(" ", make("b", { class: "more" }, written[k].querySelector("output")));
    written[k].remove();
  });
});
