// Training in the page.

import { sigmoid } from "./engine.js";

// Batch gradient descent with momentum on scaled windows and targets, as in ddlib's `Descent`.
// Each epoch changes the network in place and returns the mean square error before the step.
// The sums are written out over one array of weights: most of the time of a page that trains.
export function descent(net, windows, targets, eps, momentum) {
  const { hidden: units, outputs, inputs, all } = net;
  const gradient = new Float64Array(all.length);
  const step = new Float64Array(all.length);
  const bias = units * inputs; // where the hidden biases begin, and so on
  const output = bias + units;
  const direct = output + outputs * units;
  const last = direct + outputs * inputs;
  const [active, back] = [new Float64Array(units), new Float64Array(units)];
  return (most = 1) => {
    gradient.fill(0);
    let square = 0;
    for (let n = 0; n < windows.length; n++) {
      const x = windows[n];
      for (let h = 0, at = 0; h < units; h++) {
        let sum = 0;
        for (let i = 0; i < inputs; i++) sum += all[at++] * x[i];
        active[h] = sigmoid(sum + all[bias + h]);
        back[h] = 0;
      }
      for (let o = 0; o < outputs; o++) {
        let [sum, at] = [0, direct + o * inputs];
        for (let i = 0; i < inputs; i++) sum += all[at++] * x[i];
        at = output + o * units;
        for (let h = 0; h < units; h++) sum += all[at + h] * active[h];
        const y = sigmoid(sum + all[last + o]);
        const error = y - targets[n][o];
        const delta = error * y * (1 - y);
        square += error * error;
        for (let h = 0; h < units; h++) {
          back[h] += delta * all[at + h];
          gradient[at + h] += delta * active[h];
        }
        at = direct + o * inputs;
        for (let i = 0; i < inputs; i++) gradient[at++] += delta * x[i];
        gradient[last + o] += delta;
      }
      for (let h = 0, at = 0; h < units; h++) {
        const delta = back[h] * active[h] * (1 - active[h]);
        gradient[bias + h] += delta;
        for (let i = 0; i < inputs; i++) gradient[at++] += delta * x[i];
      }
    }
    const alpha = Math.min(momentum, most);
    for (let i = 0; i < step.length; i++) {
      step[i] = alpha * step[i] - eps * gradient[i];
      all[i] += step[i];
    }
    return square / (windows.length * outputs);
  };
}
