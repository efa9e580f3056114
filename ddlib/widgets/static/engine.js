// The live engine: an arm under sampled control, and window networks. As in ddlib, whose numbers it
// gives (tests/widgets/ test_engine.py): angles in rad, torques in N m, times in s, [shoulder, elbow]
// in every pair. A plant is what _plain.py writes: { arm, lengths, viscous, coulomb, smoothing,
// encoder, limit }, and a load (N m) that a page may put on the joints.

import { armAcceleration, armMass, armTorque, encoderReading, frictionTorque } from "./physics.js";

export const JOINTS = [0, 1];
export const NAMES = ["shoulder", "elbow"];

// The plant

// Accelerations under torques from which friction is not yet taken off.
export function respond(plant, q, v, tau) {
  const { viscous, coulomb, smoothing } = plant;
  const t1 = tau[0] - frictionTorque(viscous[0], coulomb[0], smoothing, v[0]);
  const t2 = tau[1] - frictionTorque(viscous[1], coulomb[1], smoothing, v[1]);
  return armAcceleration(plant.arm, q[0], q[1], v[0], v[1], t1, t2);
}

// One classical Runge-Kutta step under constant torques: new angles and velocities.
function advance(plant, q, v, tau, step) {
  const half = 0.5 * step;
  const along = (x, rate, h) => [x[0] + h * rate[0], x[1] + h * rate[1]];
  const a1 = respond(plant, q, v, tau);
  const v2 = along(v, a1, half);
  const a2 = respond(plant, along(q, v, half), v2, tau);
  const v3 = along(v, a2, half);
  const a3 = respond(plant, along(q, v2, half), v3, tau);
  const v4 = along(v, a3, step);
  const a4 = respond(plant, along(q, v3, step), v4, tau);
  const mean = (a, b, c, d, j) => (step / 6) * (a[j] + 2 * b[j] + 2 * c[j] + d[j]);
  return {
    q: JOINTS.map((j) => q[j] + mean(v, v2, v3, v4, j)),
    v: JOINTS.map((j) => v[j] + mean(a1, a2, a3, a4, j)),
  };
}

// Runge-Kutta steps that a control period needs: twice the fastest decay that friction makes.
function substeps(plant, step) {
  const slope = JOINTS.map((j) => plant.viscous[j] + plant.coulomb[j] / plant.smoothing);
  let fastest = 0;
  for (let k = 0; k <= 12; k++) {
    const [m11, m12, m22] = armMass(plant.arm, (k * Math.PI) / 12);
    const determinant = m11 * m22 - m12 * m12;
    const trace = (m22 * slope[0] + m11 * slope[1]) / determinant;
    const product = (slope[0] * slope[1]) / determinant;
    const root = Math.sqrt(Math.max(0, trace * trace - 4 * product));
    fastest = Math.max(fastest, (trace + root) / 2);
  }
  return Math.max(1, Math.ceil((fastest * step) / 2));
}

const readingOf = (plant, q) =>
  plant.encoder ? q.map((x) => encoderReading(plant.encoder, x)) : [...q];

const limited = (plant, tau) =>
  plant.limit ? tau.map((t, j) => Math.min(plant.limit[j], Math.max(-plant.limit[j], t))) : tau;

// Sampled control. A law is a function of what is wanted ({ q, qd, qdd }) and what is measured.

export function pid({ kp, ki, kd, limit = null, anti_windup: cure = null, derivative_filter: smooth = 0 }, step) {
  const integral = [0, 0];
  const damping = [0, 0];
  const kept = smooth / (smooth + step);
  return (wanted, q, v) =>
    JOINTS.map((j) => {
      const error = wanted.q[j] - q[j];
      const before = integral[j];
      integral[j] += ki[j] * error * step;
      damping[j] = kept * damping[j] + (1 - kept) * (wanted.qd[j] - v[j]);
      const asked = kp[j] * error + integral[j] + kd[j] * damping[j];
      if (!limit) return asked;
      const given = Math.min(limit[j], Math.max(-limit[j], asked));
      if (cure === "conditional") {
        if (given !== asked && asked * error > 0) integral[j] = before;
      } else if (cure) integral[j] += (given - asked) * Math.min(1, step / cure);
      return given;
    });
}

// The equations of an arm at what is wanted, and a law that corrects.
export function feedforward(arm, feedback) {
  return (wanted, q, v) => {
    const model = armTorque(arm, ...wanted.q, ...wanted.qd, ...wanted.qdd);
    const correction = feedback(wanted, q, v);
    return model.map((torque, j) => torque + correction[j]);
  };
}

// A plant that is driven period by period: the torque is held for `step` seconds.
export function drive(plant, q, v, step) {
  const parts = substeps(plant, step);
  const run = { q: [...q], v: [...v], tau: [0, 0] };
  run.reading = readingOf(plant, q.map((x, j) => x - step * v[j]));
  // Read the encoder, and let the law choose the torque of the period that begins.
  run.sample = (law, wanted, velocity = "tachometer") => {
    const before = run.reading;
    run.reading = readingOf(plant, run.q);
    const difference = run.reading.map((x, j) => (x - before[j]) / step);
    const speed = velocity === "tachometer" ? run.v : difference;
    run.tau = limited(plant, law(wanted, run.reading, speed));
  };
  run.hold = () => {
    const acts = plant.load ? run.tau.map((x, j) => x + plant.load[j]) : run.tau;
    for (let k = 0; k < parts; k++) {
      Object.assign(run, advance(plant, run.q, run.v, acts, step / parts));
    }
  };
  return run;
}

// The paper's family out and back to extents (rad): -extent sin(pi t / duration), at rest outside.
export function pickAndPlace(extents, t, duration) {
  const omega = Math.PI / duration;
  const moving = t >= 0 && t < duration * (1 - 1e-12);
  const part = (factor, shape) => extents.map((x) => (moving ? factor * x * shape(omega * t) : 0));
  return { q: part(-1, Math.sin), qd: part(-omega, Math.cos), qdd: part(omega * omega, Math.sin) };
}

// A motion of that family, period by period, from `rest` periods before it begins.
export function referenceOf({ extents, periods, step, motion }, rest = 0) {
  const reference = { q: [], qd: [], qdd: [] };
  const moving = Math.round(motion / step);
  for (let k = 0; k < periods; k++) {
    const wanted = pickAndPlace(extents, ((k - rest) * motion) / moving, motion);
    for (const name of Object.keys(reference)) reference[name].push(wanted[name]);
  }
  return reference;
}

// Follow a whole reference ({ q, qd, qdd }, a pair for each period); the log has every n-th sample.
export function follow(plant, law, reference, step, every, velocity) {
  const run = drive(plant, reference.q[0], [0, 0], step);
  const log = { reading: [], q: [], v: [], tau: [] };
  for (let k = 0; k < reference.q.length; k++) {
    const wanted = { q: reference.q[k], qd: reference.qd[k], qdd: reference.qdd[k] };
    run.sample(law, wanted, velocity);
    if (k % every === 0) for (const name of Object.keys(log)) log[name].push(run[name]);
    run.hold();
  }
  return log;
}

// The recording of a trajectory to extents in rad, from the rest before it to the rest after it.
export function recordingOf(loop, extents) {
  const { plant, gains, step, every, rest } = loop;
  const reference = referenceOf({ ...loop, extents }, rest);
  return follow(plant, pid(gains, step), reference, step, every, "tachometer");
}

// Where elbow and hand are, m; and the torques that a force at the hand (N) makes.

export function placesOf([l1, l2], [q1, q2]) {
  const elbow = [l1 * Math.cos(q1), l1 * Math.sin(q1)];
  return [elbow, [elbow[0] + l2 * Math.cos(q1 + q2), elbow[1] + l2 * Math.sin(q1 + q2)]];
}

export function torqueOfForce(lengths, q, [fx, fy]) {
  const [[ex, ey], [x, y]] = placesOf(lengths, q);
  return [x * fy - y * fx, (x - ex) * fy - (y - ey) * fx];
}

// Window networks. Weights lie in one array in the order of ddlib's `Weights`: hidden weights
// (unit, joint, sample), hidden biases, output weights (output, unit), direct weights (output,
// joint, sample), output biases.

export function networkOf({ hidden, outputs, joints, width }, values) {
  const inputs = joints * width;
  const net = { hidden, outputs, inputs, width, all: Float64Array.from(values) };
  let at = 0;
  const next = (count) => net.all.subarray(at, (at += count));
  net.hiddenWeights = next(hidden * inputs);
  net.hiddenBias = next(hidden);
  net.outputWeights = next(outputs * hidden);
  net.directWeights = next(outputs * inputs);
  net.outputBias = next(outputs);
  if (at !== net.all.length) throw new Error(`${net.all.length} weights in place of ${at}`);
  return net;
}

export const sigmoid = (x) => 1 / (1 + Math.exp(-x));

function dot(weights, row, x) {
  let sum = 0;
  for (let i = 0, at = row * x.length; i < x.length; i++) sum += weights[at + i] * x[i];
  return sum;
}

// Activities for a scaled window: oldest sample first, joint by joint.
export function activity(net, x, hidden = new Float64Array(net.hidden), output = new Float64Array(net.outputs)) {
  for (let h = 0; h < net.hidden; h++) {
    hidden[h] = sigmoid(dot(net.hiddenWeights, h, x) + net.hiddenBias[h]);
  }
  for (let o = 0; o < net.outputs; o++) {
    const sum = dot(net.directWeights, o, x) + dot(net.outputWeights, o, hidden);
    output[o] = sigmoid(sum + net.outputBias[o]);
  }
  return { hidden, output };
}

// A model is a network with the scaling of its inputs and outputs: { low, gain, first } each.

export function scaledWindow({ net, inputs }, window) {
  const x = new Float64Array(net.inputs);
  for (let i = 0; i < x.length; i++) {
    const j = Math.floor(i / net.width);
    x[i] = inputs.first + (window[i] - inputs.low[j]) * inputs.gain[j];
  }
  return x;
}

// Torques (N m) of output activities.
export const torqueOfOutput = ({ outputs: { low, gain, first } }, output) =>
  JOINTS.map((j) => low[j] + (output[j] - first) / gain[j]);

// A law whose torque comes some control periods late; zero until its first comes.
export function behind(periods, law) {
  const waiting = Array.from({ length: periods }, () => [0, 0]);
  return (...seen) => {
    waiting.push(law(...seen));
    return waiting.shift();
  };
}
