// What FilterFold (fold.py) computes: all curves are sums over a row's parts.

import { computes } from "ddlib/curves.js";

computes((view) => {
  const { time, rows } = view.model.get("folding");
  const { parts, ends } = rows[view.get("row")];
  const [angle, speed, acceleration] = ["angle", "speed", "acceleration"].map(view.get);
  const share = view.get("fold") / 100;
  const window = time.map((t) => angle + speed * t + (acceleration * t * t) / 2);
  const answers = parts.map((part) => part.reduce((sum, f, i) => sum + (f * window[i] * Math.PI) / 180, 0));
  const whole = (values) => values.reduce((sum, value) => sum + value, 0);
  const [constant, even, odd] = parts.map((part) => part.map((f) => share * f));
  const left = time.map((_, i) => (1 - share) * whole(parts.map((part) => part[i])));
  return { left, constant, even, odd, window, answers: [...answers, whole(answers)], ...ends };
});
