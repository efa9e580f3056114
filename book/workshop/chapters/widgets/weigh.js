// What WeighTheArm (weigh.py) adds to a CurveWidget: the end of what counts follows the pointer.

import { extras } from "ddlib/curves.js";

extras.push((view) => {
  const { options } = view.parameter("reach");
  const { x } = view.charts.at(-1).panel;
  for (const { drag } of view.charts) {
    const far = (time) => Math.min(x.length - 1, Math.round(Math.abs(time) / x[1]));
    drag((time) => view.set({ reach: options[far(time)][0] }));
  }
});
