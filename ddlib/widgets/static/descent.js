// Training in the page. Follows engine.js.

// Batch gradient descent with momentum on scaled windows and targets, as in ddlib's `Descent`.
// Each epoch changes the network in place and returns the mean square error before the step.
function descent(net, windows, targets, eps, momentum) {
  const gradient = networkOf({ ...net, joints: net.inputs / net.width }, new Float64Array(net.all.length));
  const step = new Float64Array(net.all.length);
  const [hidden, output] = [new Float64Array(net.hidden), new Float64Array(net.outputs)];
  const add = (sums, row, x, delta) => {
    for (let i = 0, at = row * x.length; i < x.length; i++) sums[at + i] += delta * x[i];
  };
  return (most = 1) => {
    gradient.all.fill(0);
    let square = 0;
    windows.forEach((x, n) => {
      activity(net, x, hidden, output);
      const back = new Float64Array(net.hidden);
      for (let o = 0; o < net.outputs; o++) {
        const error = output[o] - targets[n][o];
        const delta = error * output[o] * (1 - output[o]);
        square += error * error;
        add(back, 0, net.outputWeights.subarray(o * net.hidden, (o + 1) * net.hidden), delta);
        add(gradient.outputWeights, o, hidden, delta);
        add(gradient.directWeights, o, x, delta);
        gradient.outputBias[o] += delta;
      }
      for (let h = 0; h < net.hidden; h++) {
        const delta = back[h] * hidden[h] * (1 - hidden[h]);
        add(gradient.hiddenWeights, h, x, delta);
        gradient.hiddenBias[h] += delta;
      }
    });
    const alpha = Math.min(momentum, most);
    for (let i = 0; i < step.length; i++) {
      step[i] = alpha * step[i] - eps * gradient.all[i];
      net.all[i] += step[i];
    }
    return square / (windows.length * net.outputs);
  };
}
