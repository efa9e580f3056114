// The thrown arm without its picture: who moves the arm, what is logged, what the network makes of it.
// `spec` is ThrownArm's (throw.py).

import {
  JOINTS, activity, drive, networkOf, pickAndPlace, pid, placesOf, respond, scaledWindow,
  torqueOfForce, torqueOfOutput,
} from "ddlib/engine.js";
import { armMass } from "ddlib/physics.js";

const KEPT = 331; // samples of the log: what the charts show, and a window

export function worldOf(spec, values) {
  const { plant, lengths, step, every, motion } = { ...spec, lengths: spec.plant.lengths };
  const model = { ...spec.network, net: networkOf(spec.network.layout, values) };
  const { width } = model.net;
  const half = width >> 1;
  const seconds = (count) => count * step;
  let run = drive(plant, [0, 0], [0, 0], step);
  let plan = null; // of the motion that is played
  const world = { model, half, samples: [], count: 0, mode: "free", pull: null, shown: 0 };

  const laws = {
    free: () => [0, 0],
    play: pid(spec.gains, step),
    held: (_, q) => torqueOfForce(lengths, q, world.force(q)),
    tossed: (_, q) => {
      const part = (seconds(world.count) - world.thrown.from) / spec.toss.seconds;
      const size = Math.sin(Math.PI * Math.min(1, part)) ** 2;
      const [m11, m12, m22] = armMass(plant.arm, q[1]);
      const [a, b] = world.thrown.rates.map((rate) => size * rate);
      return [m11 * a + m12 * b, m12 * a + m22 * b];
    },
  };

  // The reader's force on the hand, N: a spring to a place, or a push in a direction.
  world.force = (q) => {
    const { place, push } = world.pull;
    if (push) return push.map((x) => spec.force * x);
    const hand = placesOf(lengths, q)[1];
    const force = place.map((x, i) => spec.spring * (x - hand[i]));
    const over = Math.hypot(...force) / spec.force;
    return over > 1 ? force.map((x) => x / over) : force;
  };

  function wantedNow() {
    if (world.mode !== "play") return null;
    const t = seconds(world.count - plan.begin) - plan.home;
    if (t >= 0) return pickAndPlace(plan.extents, t, motion);
    const s = 1 + t / plan.home; // to the start, from rest to rest
    const left = 1 - s ** 3 * (10 - 15 * s + 6 * s * s);
    return { q: plan.from.map((x) => left * x), qd: [0, 0], qdd: [0, 0] };
  }

  // Go to the start, then along the trajectory of that place in the list.
  world.play = (k) => {
    world.shown = k % spec.trajectories.length;
    const far = Math.max(...run.q.map(Math.abs));
    const home = far < 0.02 ? spec.rest : 0.5 + far;
    const extents = spec.trajectories[world.shown].extents;
    plan = { from: [...run.q], home: Math.round(home / step) * step, extents, begin: world.count };
    world.mode = "play";
  };
  world.hold = (pull) => {
    world.mode = "held";
    world.pull = pull;
  };
  // Accelerate both joints for a moment, each towards the other side of what it was trained on.
  world.toss = () => {
    const { low, gain } = model.inputs;
    const rates = JOINTS.map((j) => (run.q[j] > low[j] + 0.5 / gain[j] ? -spec.toss.rate : spec.toss.rate));
    world.mode = "tossed";
    world.thrown = { rates, from: seconds(world.count) };
  };
  world.release = () => (world.mode = "free");
  world.places = () => placesOf(lengths, run.q);
  world.angles = () => run.q;
  // Stand still somewhere, as if it had always stood there.
  world.stand = (q) => {
    run = drive(plant, q, [0, 0], step);
    world.mode = "free";
    world.samples = [];
    for (let k = KEPT * every; k > 0; k--) world.period();
  };

  function log() {
    const { reading, v, tau } = run;
    world.samples.push({ q: reading, v, tau, a: respond(plant, run.q, v, tau) });
    if (world.samples.length > KEPT) world.samples.shift();
    if (world.samples.length >= width) look(world.samples.length - 1 - half);
  }
  // What the network, and a line and a parabola, make of the window around a sample.
  function look(k) {
    const window = new Float64Array(2 * width);
    const [rates, bends] = [[0, 0], [0, 0]];
    for (const j of JOINTS) {
      for (let i = 0; i < width; i++) window[j * width + i] = world.samples[k - half + i].q[j];
      const part = window.subarray(j * width, (j + 1) * width);
      rates[j] = along(lineOf(half), part) / (step * every);
      bends[j] = along(parabolaOf(half), part) / (step * every) ** 2;
    }
    const { hidden, output } = activity(model.net, scaledWindow(model, window));
    const net = torqueOfOutput(model, output);
    Object.assign(world.samples[k], { net, hidden, output, rates, bends });
  }

  // One control period.
  world.period = () => {
    run.sample(laws[world.mode], wantedNow());
    if (world.count % every === 0) log();
    run.hold();
    world.count++;
    if (world.mode === "play" && seconds(world.count - plan.begin) >= plan.home + motion + spec.rest) {
      world.mode = "free";
    }
    if (world.mode === "tossed" && seconds(world.count) - world.thrown.from >= spec.toss.seconds) {
      world.release();
    }
  };

  // Whether nothing moves and nothing has moved for a while.
  world.still = () =>
    world.mode === "free" &&
    world.samples.slice(-40).every(({ v, tau }) => [...v, ...tau].every((x) => Math.abs(x) < 4e-3));

  // Whether a joint is beyond the angles of the training recordings.
  world.outside = () => {
    const { low, gain } = model.inputs;
    return JOINTS.some((j) => run.q[j] < low[j] - 0.02 || run.q[j] > low[j] + 1 / gain[j] + 0.02);
  };

  // Root mean square of the network's error over what is shown, and of the torque itself.
  world.errors = () => {
    const seen = world.samples.filter(({ net }) => net);
    const rms = (of) => Math.sqrt(seen.reduce((sum, s) => sum + of(s) ** 2, 0) / (seen.length || 1));
    return JOINTS.map((j) => [rms((s) => s.net[j] - s.tau[j]), rms((s) => s.tau[j])]);
  };
  return world;
}

// Filters over a window of 2 half + 1 samples, for the first and the second derivative of what lies
// under them, per sample: their weights lie on a line and on a parabola without a mean.

const windowed = (half, value) => Array.from({ length: 2 * half + 1 }, (_, i) => value(i - half));
const along = (f, x) => f.reduce((sum, value, i) => sum + value * x[i], 0);

function lineOf(half) {
  const line = windowed(half, (n) => n);
  const gain = along(line, line);
  return line.map((x) => x / gain);
}

function parabolaOf(half) {
  const mean = along(windowed(half, (n) => n), windowed(half, (n) => n)) / (2 * half + 1);
  const bowl = windowed(half, (n) => n * n - mean);
  const gain = along(bowl, windowed(half, (n) => (n * n) / 2));
  return bowl.map((x) => x / gain);
}

// Weights as a constant, a line, a parabola and what is left, and the three's shares of the energy.
export function folded(weights) {
  const half = weights.length >> 1;
  const onto = (shape) => {
    const factor = along(shape, weights) / along(shape, shape);
    return shape.map((x) => factor * x);
  };
  const three = [windowed(half, () => 1), lineOf(half), parabolaOf(half)].map(onto);
  const [constant, line, parabola] = three;
  const shares = three.map((part) => along(part, part) / along(weights, weights));
  const left = Array.from(weights, (x, i) => x - constant[i] - line[i] - parabola[i]);
  return { constant, line, parabola, left, shares };
}
