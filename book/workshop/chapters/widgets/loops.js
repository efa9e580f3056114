// PID loops: their runs, and the linear loop around a posture. `modes` is what loops.py writes.

import { JOINTS, drive } from "ddlib/engine.js";

// Follow a reference; the run is over at the first logged sample with a joint's error beyond `most`
// (rad), whose place `stopped` then is.
export function guarded(plant, law, reference, step, every, most, velocity) {
  const run = drive(plant, reference.q[0], [0, 0], step);
  const log = { q: [], tau: [], stopped: null };
  for (let k = 0; k < reference.q.length; k++) {
    const wanted = { q: reference.q[k], qd: reference.qd[k], qdd: reference.qdd[k] };
    run.sample(law, wanted, velocity);
    if (k % every === 0) {
      log.q.push(run.q);
      log.tau.push(run.tau);
      if (!JOINTS.every((j) => Math.abs(wanted.q[j] - run.q[j]) <= most)) {
        log.stopped = k / every;
        break;
      }
    }
    run.hold();
  }
  return log;
}

// The sampled loop near a posture. A mode of the joints is damped at its rate; over a period of held
// torque its speed keeps the part `p`, and speed and torque move it by `b` and `c`.
const periodOf = ({ rate }, step) => {
  const x = rate * step;
  return { p: Math.exp(-x), b: -Math.expm1(-x) / rate, c: (x + Math.expm1(-x)) / rate ** 2 };
};

// How fast the slowest or least stable motion of the closed loop grows, 1/s; negative if it dies out.
// `differs`: the velocity is the difference of two readings, of which the older is a state, too.
export function growthOf(modes, { kp, ki, kd, differs }, step, late) {
  const integral = ki.some(Boolean);
  const older = integral ? 6 : 4;
  const waiting = older + (differs ? 2 : 0); // places of the torques on their way
  const n = waiting + 2 * late;
  const A = new Float64Array(n * n);
  const add = (row, column, x) => (A[row * n + column] += x);
  // The torque that acts: what the law makes of the newest reading, or the first on its way.
  const law = (row, i, factor) => {
    add(row, i, -factor * (kp[i] + step * ki[i]));
    if (differs) {
      add(row, i, (-factor * kd[i]) / step);
      add(row, older + i, (factor * kd[i]) / step);
    } else add(row, 2 + i, -factor * kd[i]);
    if (integral) add(row, 4 + i, factor);
  };
  const acts = late ? (row, i, factor) => add(row, waiting + i, factor) : law;
  for (const i of JOINTS) {
    add(i, i, 1);
    for (const mode of modes) {
      const { p, b, c } = periodOf(mode, step);
      for (const j of JOINTS) {
        add(i, 2 + j, b * mode.shape[i] * mode.dual[j]);
        add(2 + i, 2 + j, p * mode.shape[i] * mode.dual[j]);
        acts(i, j, c * mode.shape[i] * mode.shape[j]);
        acts(2 + i, j, b * mode.shape[i] * mode.shape[j]);
      }
    }
    if (integral) {
      add(4 + i, 4 + i, 1);
      add(4 + i, i, -step * ki[i]);
    }
    if (differs) add(older + i, i, 1);
    for (let k = 0; k < late; k++) {
      const row = waiting + 2 * k + i;
      if (k < late - 1) add(row, row + 2, 1);
      else law(row, i, 1);
    }
  }
  return logRadius(A, n) / step;
}

// The logarithm of the largest magnitude of a matrix's eigenvalues, by squaring it again and again.
function logRadius(A, n) {
  let sum = 0;
  for (let k = 0; k < 40; k++) {
    const size = A.reduce((most, x) => Math.max(most, Math.abs(x)), 0);
    sum += Math.log(size) / 2 ** k;
    const now = A.map((x) => x / size);
    const next = new Float64Array(n * n);
    for (let i = 0; i < n; i++) {
      for (let m = 0; m < n; m++) {
        const x = now[i * n + m];
        if (x) for (let j = 0; j < n; j++) next[i * n + j] += x * now[m * n + j];
      }
    }
    A = next;
  }
  return sum;
}

// The largest part of a loop's gains, together or its integral alone, with which it is stable; NaN if
// none is, down to a thousandth.
export function calmPart(modes, gains, step, late, names = ["kp", "ki", "kd"]) {
  const stable = (part) => {
    const less = names.map((name) => [name, gains[name].map((x) => part * x)]);
    return growthOf(modes, { ...gains, ...Object.fromEntries(less) }, step, late) < 0;
  };
  let [low, high] = [Math.log(1e-3), 0];
  if (!stable(Math.exp(low))) return NaN;
  for (let k = 0; k < 12; k++) {
    const middle = (low + high) / 2;
    if (stable(Math.exp(middle))) low = middle;
    else high = middle;
  }
  return Math.exp(low);
}

const times = ([a, b], [c, d]) => [a * c - b * d, a * d + b * c];
const over = (x, [c, d]) => times(x, [c / (c * c + d * d), -d / (c * c + d * d)]);
const plus = ([a, b], [c, d]) => [a + c, b + d];

// The loop cut open where one joint's torque is commanded, the other joint's loop closed: its answer
// to a sine of `omega` rad/s.
function openLoop(modes, { kp, ki, kd, differs }, step, late, joint, omega) {
  const z = [Math.cos(omega * step), Math.sin(omega * step)];
  const before = [z[0] - 1, z[1]];
  const delay = [Math.cos(omega * step * late), -Math.sin(omega * step * late)];
  const moved = modes.map((mode) => {
    const { p, b, c } = periodOf(mode, step);
    const speed = over([b, 0], [z[0] - p, z[1]]);
    return { shape: mode.shape, speed, angle: over(plus(times([b, 0], speed), [c, 0]), before) };
  });
  const H = (i, j) => {
    const spring = plus([kp[i], 0], over(times([ki[i] * step, 0], z), before));
    return moved.reduce((sum, { shape, speed, angle }) => {
      const rate = differs ? over(times(before, angle), times([step, 0], z)) : speed;
      const answer = plus(times(spring, angle), times([kd[i], 0], rate));
      return plus(sum, times([shape[i] * shape[j], 0], times(delay, answer)));
    }, [0, 0]);
  };
  const other = 1 - joint;
  const through = over(times(H(joint, other), H(other, joint)), plus([1, 0], H(other, other)));
  return plus(H(joint, joint), times([-1, 0], through));
}

// Phase margin (degrees) and crossover (rad/s) of such a loop; NaN if its gain is never 1.
export function marginOf(modes, gains, step, late, joint) {
  const loop = (x) => openLoop(modes, gains, step, late, joint, Math.exp(x));
  const loud = (x) => Math.hypot(...loop(x)) > 1;
  const [low, high, parts] = [Math.log(0.01), Math.log(Math.PI / step), 160];
  const found = { phase: NaN, crossover: NaN };
  const at = (k) => low + ((high - low) * k) / parts;
  let before = loud(low);
  for (let k = 1; k <= parts; k++) {
    const now = loud(at(k));
    if (now !== before) {
      let [a, b] = [at(k - 1), at(k)];
      for (let n = 0; n < 45; n++) {
        const middle = (a + b) / 2;
        if (loud(middle) === before) a = middle;
        else b = middle;
      }
      const [re, im] = loop(b);
      const phase = (Math.atan2(-im, -re) * 180) / Math.PI;
      if (!(Math.abs(phase) > Math.abs(found.phase))) Object.assign(found, { phase, crossover: Math.exp(b) });
    }
    before = now;
  }
  return found;
}
