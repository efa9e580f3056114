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
  view.told ??= new Map(); // of the widths that were chosen
  const { positions, torques } = view.recorded;
  const [width, sample] = ["width", "sample"].map(view.get);
  const network = view.networks.find(({ net }) => net.width === width);
  if (!view.told.has(width)) {
    const scaled = scaledOf(network, positions);
    view.told.set(width, { scaled, told: toldTorques(network, scaled, reach, reach + times.length) });
  }
  const { scaled, told } = view.told.get(width);
  const { hidden, output } = activity(network.net, windowAt(network, scaled, reach + sample));
  const curves = { activity: [...hidden, ...output] };
  NAMES.forEach((name, j) => {
    curves[`${name} position`] = scaled[j].subarray(sample, sample + 2 * reach + 1);
    curves[`${name} torque`] = told.map((tau) => tau[j]);
    curves[`${name} network`] = [told[sample][j]];
    curves[`${name} measured`] = [torques[j][sample]];
  });
  const step = (times.at(-1) - times[0]) / (times.length - 1);
  const half = step * ((width >> 1) + 0.5);
  const inside = (t) => [Math.min(times.at(-1), Math.max(times[0], t))];
  Object.assign(curves, { from: inside(times[sample] - half), to: inside(times[sample] + half) });
  return Object.assign(curves, { first: [-1000 * half], last: [1000 * half] });
});
