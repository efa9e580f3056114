// Window networks along a recording. Follows engine.js. Layouts, scalings and weights are what
// `networks` in plain.py writes.

function modelsOf(layouts, view) {
  if (!view?.buffer) throw new Error("the weights are missing");
  const data = new DataView(view.buffer, view.byteOffset, view.byteLength);
  const all = Float64Array.from({ length: data.byteLength / 4 }, (_, i) => data.getFloat32(4 * i, true));
  let at = 0;
  const models = layouts.map((model) => {
    const { hidden, outputs, joints, width } = model.layout;
    const units = hidden + outputs;
    const count = units * (joints * width + 1) + hidden * outputs;
    return { ...model, net: networkOf(model.layout, all.subarray(at, (at += count))) };
  });
  if (at !== all.length) throw new Error(`${all.length} weights in place of ${at}`);
  return models;
}

// Positions (rad), joint by joint: the window around a sample, for the input units.
function windowAt(model, positions, k) {
  const { width } = model.net;
  const window = new Float64Array(model.net.inputs);
  const first = k - (width >> 1);
  positions.forEach((x, j) => window.set(x.subarray(first, first + width), j * width));
  return scaledWindow(model, window);
}

// Torques (N m) that a network tells at the samples `from` to `to`, a pair for each.
function toldTorques(model, positions, from, to) {
  const hidden = new Float64Array(model.net.hidden);
  const output = new Float64Array(model.net.outputs);
  return Array.from({ length: to - from }, (_, k) => {
    activity(model.net, windowAt(model, positions, from + k), hidden, output);
    return torqueOfOutput(model, output);
  });
}
