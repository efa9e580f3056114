// What WeightReader (weights.py) adds to its diagram (hinton.js): the chosen row as squares above its curve,
// square over stem; and the start that leaves both, slowly, when it is subtracted.

import { extras } from "ddlib/curves.js";
import { make, put, short } from "ddlib/elements.js";

const LEAVES = 900; // ms

extras.push((view) => {
  const [chart] = view.charts;
  const drawn = ["positive", "negative"].map((sign) => make("path", { class: sign }));
  const blob = make("rect", { class: "blob", y: 0, height: 22 });
  const strip = make("svg", { class: "hinton-key strip", width: 1, height: 22, "aria-hidden": "true" }, blob, ...drawn);
  chart.el.querySelector(".legend").append(strip);
  view.top.append(make("div", { class: "beside" }, chart.el, view.numbers, view.controls));
  view.el.classList.add("ddlib-weights");

  function squares(values, full) {
    const [left, right] = chart.el.querySelector("path.frame").getAttribute("d").match(/[MH]([\d.]+)/g).map((s) => Number(s.slice(1)));
    const pitch = (right - left) / values.length;
    const paths = ["", ""];
    values.forEach((value, i) => {
      const a = short(Math.min(pitch, 18) * Math.sqrt(Math.min(1, Math.abs(value) / full)));
      const [x, y] = [short(left + (i + 0.5) * pitch - a / 2), short(11 - a / 2)];
      if (a > 0.2) paths[value < 0 ? 1 : 0] += `M${x} ${y}h${a}v${a}h-${a}z`;
    });
    drawn.forEach((path, i) => path.setAttribute("d", paths[i]));
    put(blob, { x: left, width: right - left });
  }

  const calm = matchMedia("(prefers-reduced-motion: reduce)");
  const rowOf = () => `${view.get("unit")} ${view.get("joint")}`;
  let [row, subtracted, shown, frame, began, from] = ["", null, null, 0, 0, null];
  function step(now) {
    const part = Math.min(1, Math.max(0, (now - began) / LEAVES));
    const s = part * part * (3 - 2 * part);
    const { weights, full } = view.curves;
    shown = Array.from(weights, (to, i) => (1 - s) * from[i] + s * to);
    chart.redraw({ ...view.curves, weights: shown });
    squares(shown, full[0]);
    frame = part < 1 ? requestAnimationFrame(step) : 0;
  }
  view.after.push(({ weights, full }) => {
    const turned = row === rowOf() && subtracted !== view.get("subtract");
    if (row !== rowOf() || turned) {
      cancelAnimationFrame(frame);
      frame = 0;
    }
    [row, subtracted] = [rowOf(), view.get("subtract")];
    if (turned && !calm.matches) [from, began] = [shown, performance.now()];
    if (frame || (turned && !calm.matches)) {
      cancelAnimationFrame(frame);
      return step(performance.now()); // also where exact values come in between
    }
    shown = Array.from(weights);
    squares(shown, full[0]);
  });
  return () => cancelAnimationFrame(frame);
});
