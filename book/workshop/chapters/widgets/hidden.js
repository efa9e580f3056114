// What HiddenTorque (window.py) shows. Its torque is covered from the window's first sample on, unless
// the reader has it uncovered.

import { computes, extras } from "ddlib/curves.js";
import { NAMES } from "ddlib/engine.js";
import { recordedOf } from "ddlib/sliding.js";

computes((view) => {
  const { model, spec } = view;
  const [whole, part] = spec.panels;
  const [samples, width] = [whole.x.length, part.x.length];
  const half = width >> 1;
  view.recorded ??= recordedOf(model.get("recorded"), samples, half);
  const [joint, sample, shown] = ["joint", "sample", "shown"].map(view.get);
  const j = NAMES.indexOf(joint);
  const degrees = view.recorded.positions[j].map((q) => (q * 180) / Math.PI);
  const inside = degrees.slice(sample, sample + width);
  const chord = inside.map((_, i) => inside[0] + ((inside[width - 1] - inside[0]) * i) / (width - 1));
  const last = shown ? samples : Math.max(1, sample - half + 1);
  const torque = view.recorded.torques[j].map((tau, k) => (k < last ? tau : NaN));
  const step = (whole.x.at(-1) - whole.x[0]) / (samples - 1);
  const end = (t) => [Math.min(whole.x.at(-1), Math.max(whole.x[0], t))];
  const reach = step * (half + 0.5);
  const most = 1.1 * view.recorded.torques[j].reduce((a, tau) => Math.max(a, Math.abs(tau)), 0);
  return {
    ...{ position: degrees.slice(half, half + samples), inside, chord, torque, low: [-most], high: [most] },
    ...{ from: end(whole.x[sample] - reach), to: end(whole.x[sample] + reach) },
  };
});

extras.push((view) => {
  view.el.classList.add("ddlib-hidden");
  const [whole, , torque] = view.charts;
  const [from, to] = [whole.panel.x[0], whole.panel.x.at(-1)];
  const last = whole.panel.x.length - 1;
  for (const { drag } of [whole, torque]) {
    drag((time) => view.set({ sample: Math.round((last * (time - from)) / (to - from)) }));
  }
});
