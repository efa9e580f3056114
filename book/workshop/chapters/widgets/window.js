// What SlidingWindow (window.py) computes.

import { computes } from "ddlib/curves.js";
import { NAMES, activity } from "ddlib/engine.js";
import { modelsOf, recordedOf, scaledOf, toldTorques, windowAt } from "ddlib/sliding.js";

computes((view) => {
  const { model, spec } = view;
  const [strip, , chart] = spec.panels;
  const times = chart.x;
  const reach = (strip.x.length - 1) / 2;
  view.networks ??= modelsOf(model.get("layouts"), model.get("weights"));
  view.recorded ??= recordedOf(model.get("recorded"), times.length, reach);
  view.predicted ??= new Map(); // of the widths that were chosen
  const { positions, torques } = view.recorded;
  const [width, sample] = ["width", "sample"].map(view.get);
  const network = view.networks.find(({ net }) => net.width === width);
  if (!view.predicted.has(width)) {
    const scaled = scaledOf(network, positions);
    view.predicted.set(width, { scaled, predicted: toldTorques(network, scaled, reach, reach + times.length) });
  }
  const { scaled, predicted } = view.predicted.get(width);
  const { hidden, output } = activity(network.net, windowAt(network, scaled, reach + sample));
  const curves = { activity: [...hidden, ...output] };
  NAMES.forEach((name, j) => {
    curves[`${name} position`] = scaled[j].subarray(sample, sample + 2 * reach + 1);
    curves[`${name} torque`] = predicted.map((tau) => tau[j]);
    curves[`${name} network`] = [predicted[sample][j]];
    curves[`${name} measured`] = [torques[j][sample]];
  });
  const step = (times.at(-1) - times[0]) / (times.length - 1);
  const half = step * ((width >> 1) + 0.5);
  const inside = (t) => [Math.min(times.at(-1), Math.max(times[0], t))];
  Object.assign(curves, { from: inside(times[sample] - half), to: inside(times[sample] + half) });
  return Object.assign(curves, { first: [-1000 * half], last: [1000 * half] });
});
