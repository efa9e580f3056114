// The arm of the first page without its picture: who moves it, and what is logged. `spec` is Hero's
// (hero.py).

import { JOINTS, drive, pickAndPlace, pid, placesOf, torqueOfForce } from "ddlib/engine.js";

const KEPT = 60; // samples of the log: a window, and what says that the arm rests

export function worldOf(spec) {
  const { plant, step, every, motion, extents, rest, stops } = spec;
  const { lengths } = plant;
  const seconds = (count) => count * step;
  let run = drive(plant, [0, 0], [0, 0], step);
  let plan = null; // of the motion that is played
  let pull = null; // of the reader
  const world = { samples: [], count: 0, mode: "free" };

  // What pushes a joint back behind the end of its range, as a real arm's rubber stops do.
  const pushed = (q, v) =>
    JOINTS.map((j) => {
      const beyond = Math.min(0, q[j] - stops.low[j]) + Math.max(0, q[j] - stops.high[j]);
      return beyond && -stops.stiffness[j] * beyond - stops.damping[j] * v[j];
    });
  const laws = {
    free: (_, q, v) => pushed(q, v),
    play: pid(spec.gains, step),
    held: (_, q, v) => {
      const back = pushed(q, v);
      return torqueOfForce(lengths, q, world.force()).map((torque, j) => torque + back[j]);
    },
  };

  // The reader's force on the hand, N: a spring to a place, or a push in a direction.
  world.force = () => {
    const { place, push } = pull;
    if (push) return push.map((x) => spec.force * x);
    const hand = placesOf(lengths, run.q)[1];
    const force = place.map((x, i) => spec.spring * (x - hand[i]));
    const over = Math.hypot(...force) / spec.force;
    return over > 1 ? force.map((x) => x / over) : force;
  };
  world.hold = (how) => {
    world.mode = "held";
    pull = how;
  };
  world.release = () => (world.mode = "free");

  // Go to the start, then along the trajectory; and the seconds since that began.
  world.play = () => {
    const far = Math.max(...run.q.map(Math.abs));
    const home = far < 0.02 ? rest : 0.5 + far;
    plan = { from: [...run.q], home: Math.round(home / step) * step, begin: world.count };
    world.mode = "play";
  };
  world.since = () => seconds(world.count - plan.begin) - plan.home;
  function wanted() {
    if (world.mode !== "play") return null;
    const t = world.since();
    if (t >= 0) return pickAndPlace(extents, t, motion);
    const s = 1 + t / plan.home; // to the start, from rest to rest
    const left = 1 - s ** 3 * (10 - 15 * s + 6 * s * s);
    return { q: plan.from.map((x) => left * x), qd: [0, 0], qdd: [0, 0] };
  }

  // Stand still, as if it had always stood there.
  world.stand = (q) => {
    run = drive(plant, q, [0, 0], step);
    world.mode = "free";
    world.samples = [];
    for (let k = KEPT * every; k > 0; k--) world.period();
  };

  // One control period.
  world.period = () => {
    run.sample(laws[world.mode], wanted());
    if (world.count % every === 0) {
      world.samples.push({ q: run.reading, v: run.v, tau: run.tau });
      if (world.samples.length > KEPT) world.samples.shift();
    }
    run.hold();
    world.count++;
  };

  // Whether nothing moves and nothing has moved for a while.
  world.still = () =>
    world.mode === "free" &&
    world.samples.slice(-25).every(({ v, tau }) => [...v, ...tau].every((x) => Math.abs(x) < 0.02));
  return world;
}
