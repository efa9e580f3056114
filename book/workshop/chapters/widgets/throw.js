// Shows ThrownArm (throw.py): the arm with a handle at its hand, the strip of positions under
// the window, true torques and the network's. Everything is computed here.

import { coloursOf } from "ddlib/canvas.js";
import {
  buttonOf, dress, freshId, make, numbersOf, onKeys, onRecolour, put, safely, short, write,
} from "ddlib/elements.js";
import { placesOf } from "ddlib/engine.js";
import { insideOf } from "./inside.js";
import { keyOf, strip, timeChart } from "./running.js";
import { worldOf } from "./world.js";

const METRE = 200; // px of the drawing
const NUDGE = 120; // ms that a key pulls at least
const PULLS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

function stageOf(world, spec) {
  const { lengths } = spec.plant;
  const reach = METRE * (lengths[0] + lengths[1]) + 14;
  const at = ([x, y]) => [short(METRE * x), short(-METRE * y)];

  // Where the hand was while the network was trained.
  const { low, gain } = spec.network.inputs;
  const side = (of) => Array.from({ length: 13 }, (_, k) => of(k / 12));
  const angle = (s, j) => low[j] + s / gain[j];
  const corners = [
    ...side((s) => [angle(s, 0), angle(0, 1)]),
    ...side((s) => [angle(1, 0), angle(s, 1)]),
    ...side((s) => [angle(1 - s, 0), angle(1, 1)]),
    ...side((s) => [angle(0, 0), angle(1 - s, 1)]),
  ];
  const region = make("polygon", {
    class: "trained",
    points: corners.map((q) => at(placesOf(lengths, q)[1]).join()).join(" "),
  });
  const circle = make("circle", { class: "reach", r: reach - 14 });
  const rope = make("line", { class: "rope", visibility: "hidden" });
  const links = ["upper", "fore"].map((name) => make("line", { class: `link ${name}`, x1: 0, y1: 0 }));
  const elbow = make("circle", { class: "joint", r: 6 });
  const base = make("circle", { class: "joint", r: 8 });
  const handle = make(
    "g",
    { class: "hand-handle", tabindex: 0, role: "application", "aria-roledescription": "handle" },
    make("circle", { class: "room", r: 30 }),
    make("circle", { class: "ring", r: 15 }),
    make("circle", { class: "dot", r: 5 }),
  );
  handle.setAttribute("aria-label", "The arm's hand: arrow keys pull it for as long as they are pressed");
  const name = make("text", { class: "x", x: 0, y: reach + 14 }, "shaded: trained here");
  const svg = make(
    "svg",
    { class: "stage", viewBox: `${-reach} ${-reach} ${2 * reach} ${2 * reach + 22}`, role: "group" },
    ...[circle, region, name, ...links, base, elbow, rope, handle],
  );
  svg.setAttribute("aria-label", "The arm from above");

  const placeOf = (event) => {
    const point = new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM().inverse());
    return [point.x / METRE, -point.y / METRE];
  };
  function draw() {
    const [a, b] = world.places().map(at);
    put(links[0], { x2: a[0], y2: a[1] });
    put(links[1], { x1: a[0], y1: a[1], x2: b[0], y2: b[1] });
    put(elbow, { cx: a[0], cy: a[1] });
    handle.setAttribute("transform", `translate(${b[0]} ${b[1]})`);
    const held = world.mode === "held";
    rope.setAttribute("visibility", held ? "visible" : "hidden");
    if (!held) return;
    const force = world.force(world.angles()); // a newton is a centimetre
    const end = world.pull.place ? at(world.pull.place) : [b[0] + 2 * force[0], b[1] - 2 * force[1]];
    put(rope, { x1: b[0], y1: b[1], x2: end[0], y2: end[1] });
  }
  return { svg, handle, draw, placeOf };
}

function build({ model, el }) {
  const spec = model.get("spec");
  const world = worldOf(spec, numbersOf(model.get("weights"), "Float32"));
  const { width } = world.model.net;
  const id = freshId();
  const calm = matchMedia("(prefers-reduced-motion: reduce)");
  dress(el, spec.title, "ddlib-throw");

  // It begins in the middle of a motion, so that there is something to see before anything moves.
  const motions = spec.trajectories.length;
  world.play(motions - 1);
  while (world.mode === "play") world.period();
  const [, given, inner] = location.search.match(/[?&]thrown-arm=motion:(\d)(?:,inside:([01]))?/) ?? [];
  world.play(Number(given ?? 0));
  for (let k = (spec.rest + 0.6 * spec.motion) / spec.step; k > 0; k--) world.period();

  const stage = stageOf(world, spec);
  const { low, gain, first } = spec.network.inputs;
  const apart = Math.round(1e3 * spec.step * spec.every);
  const band = strip({
    height: 88,
    label: `Positions of both joints run under a window of ${width} samples`,
    width,
    lows: low,
    highs: low.map((x, j) => x + (1 - first) / gain[j]),
  });
  const torques = ["Shoulder", "Elbow"].map((joint, j) =>
    timeChart({
      height: j ? 104 : 76,
      label: `${joint} torque over the last three seconds: the true one and the network's`,
      low: -spec.torques[j],
      high: spec.torques[j],
      lines: [
        { colour: "ink", width: 2.5, of: (s) => s.tau[j] },
        { colour: "network", width: 2, dash: [6, 3], of: (s) => s.net?.[j] },
      ],
      bottom: j === 1,
    }),
  );
  const inside = insideOf(world, spec, id);
  const places = [band, ...torques];

  // Words and numbers
  const status = make("p", { class: "said", role: "status" });
  const outside = make("p", { class: "outside", "aria-hidden": "true" });
  const errors = make("p", { class: "remark errors" });
  const legend = make("div", { class: "legend" });
  legend.append(keyOf("ink", "true"), keyOf("network dashed", "network, from positions alone"));
  function tell() {
    const rounded = (x) => x.toFixed(1);
    const [[s, ts], [e, te]] = world.errors();
    write(
      errors,
      `Error of the network in this picture: ${rounded(s)} N m at the shoulder (torque: ${rounded(ts)}), ` +
        `${rounded(e)} N m at the elbow (torque: ${rounded(te)}). All are root mean squares.`,
    );
  }
  function say(text) {
    write(status, text);
    tell();
  }
  const named = () => spec.trajectories[world.shown].name;

  // Time
  let frame = 0;
  let last = 0;
  let owed = 0; // s of simulated time
  let paused = true;
  let several = false; // trajectories one after the other
  let reported = 0;
  let colours = coloursOf(el);

  function draw() {
    const phase = (((world.count - 1) % spec.every) + owed / spec.step) / spec.every;
    stage.draw();
    for (const place of places) place.draw(world.samples, phase, colours);
    inside.draw(world.samples, phase, colours);
    write(outside, world.outside() ? "The network was not trained on such angles." : "");
  }
  function run(now) {
    frame = 0;
    owed += Math.min(0.05, Math.max(0, (now - last) / 1000));
    last = now;
    const before = world.mode;
    for (; owed >= spec.step; owed -= spec.step) world.period();
    if (before === "play" && world.mode === "free") {
      if (several) next();
      else say("The motion is over.");
    } else if (before !== world.mode) say("Now only friction slows the arm."); // after a toss
    show();
    if (now - reported > 500) {
      reported = now;
      tell();
    }
    draw();
    if (world.still()) rest();
    else go();
  }
  function go() {
    if (!frame && !paused) frame = requestAnimationFrame(run);
  }
  function start() {
    paused = false;
    if (!frame) last = performance.now();
    go();
    show();
  }
  function rest() {
    several = false;
    say("At rest.");
    show();
  }
  function next() {
    world.play(world.shown + 1);
    say(`Playing ${named()}.`);
  }
  function show() {
    const running = world.mode === "play" && !paused;
    write(play, running ? "Pause" : "Play");
  }

  const play = buttonOf("Play", () => {
    several = true;
    if (world.mode === "play") {
      paused = !paused;
      cancelAnimationFrame(frame);
      frame = 0;
      if (!paused) start();
      say(paused ? "Paused." : `Playing ${named()}.`);
      return show();
    }
    world.play(world.shown + 1);
    say(`Playing ${named()}.`);
    start();
  });
  play.dataset.runs = ""; // for benchmarks
  const thrown = () => {
    several = false;
    world.toss();
    say("You threw the arm.");
    start();
  };
  const toss = buttonOf("Throw", thrown);
  inside.hint.append(buttonOf("Throw the arm", () => {
    thrown();
    look.focus(); // the hint goes
  }));
  const back = buttonOf("Reset", () => {
    several = false;
    paused = false;
    world.stand([0, 0]);
    say("Back at the start.");
    start();
  });
  const look = buttonOf("Look inside", () => {
    inside.toggle();
    look.setAttribute("aria-expanded", inside.open);
    draw();
  });
  if (inner === "0") inside.close();
  look.setAttribute("aria-expanded", inside.open);
  look.setAttribute("aria-controls", inside.el.id);

  // The state to take along; the common frame is too heavy for the first page.
  const address = () => {
    const url = new URL(location.href);
    url.searchParams.delete("thrown-arm");
    const state = `thrown-arm=motion:${world.shown}${inside.open ? "" : ",inside:0"}`;
    return `${url.origin === "null" ? "file://" : url.origin}${url.pathname}${url.search ? `${url.search}&` : "?"}${state}`;
  };
  const copies = (text, what, write) =>
    buttonOf(text, () => {
      const copied = write();
      navigator.clipboard.writeText(copied).then(
        () => say(`${what} copied.`),
        () => prompt("Press Ctrl+C", copied),
      );
    });
  const code = () => spec.code.replace("{motion}", spec.trajectories[world.shown].number - 1);
  const taken = [
    ...(model.kernelless ? [copies("Link", "Link", address)] : []),
    ...(spec.code ? [copies("Code", "Code", code)] : []),
  ];

  // The hand
  const { handle } = stage;
  const take = (pull) => {
    several = false;
    const held = world.mode === "held";
    world.hold(pull);
    if (!held) say("You pull the hand. The network sees only the positions of the joints.");
    start();
  };
  const release = () => {
    if (world.mode !== "held") return;
    world.release();
    say("You let go. Now only friction slows the arm.");
  };
  handle.addEventListener("pointerdown", (event) => {
    if (event.button) return;
    event.preventDefault();
    handle.setPointerCapture(event.pointerId);
    handle.focus({ preventScroll: true });
    take({ place: stage.placeOf(event) });
  });
  // A style's touch-action does not hold for a part of a drawing everywhere.
  handle.addEventListener("touchstart", (event) => event.preventDefault(), { passive: false });
  handle.addEventListener("pointermove", (event) => {
    if (handle.hasPointerCapture(event.pointerId)) world.pull = { place: stage.placeOf(event) };
  });
  for (const end of ["pointerup", "pointercancel"]) handle.addEventListener(end, release);
  const pressed = new Map(); // keys, each with the time at which it went down
  function pull() {
    const push = [0, 1].map((i) => [...pressed.keys()].reduce((sum, key) => sum + PULLS[key][i], 0));
    if (push.some(Boolean)) take({ push: push.map((x) => x / Math.hypot(...push)) });
    else release();
  }
  onKeys(handle, (event) => {
    if (!PULLS[event.key]) return false;
    if (event.repeat) return;
    pressed.set(event.key, performance.now());
    pull();
  });
  handle.addEventListener("keyup", ({ key }) => {
    const since = pressed.get(key);
    const letGo = () => {
      if (pressed.get(key) !== since) return; // pressed again
      pressed.delete(key);
      pull();
    };
    const more = NUDGE - (performance.now() - since);
    if (more > 0) setTimeout(letGo, more);
    else if (since !== undefined) letGo();
  });
  handle.addEventListener("blur", () => {
    if (pressed.size) release();
    pressed.clear();
  });

  const title = (...parts) => make("div", { class: "title" }, ...parts);
  const hint = make("p", { class: "remark" }, spec.hint);
  el.replaceChildren(make(
    "div",
    { class: "pieces" },
    make(
      "div",
      { class: "scene" },
      make("div", { class: "left" }, stage.svg, make("div", { class: "buttons" }, play, toss, back, look)),
      make(
        "div",
        { class: "right" },
        title(`A window of ${width} positions, ${apart} ms apart`),
        band.el,
        title("Shoulder torque, N m"),
        legend,
        torques[0].el,
        title("Elbow torque, N m"),
        torques[1].el,
      ),
    ),
    make("div", { class: "words" }, status, outside),
    inside.el,
    errors,
    hint,
    make("div", { class: "buttons taken" }, ...taken),
  ));
  world.changed = () => frame || draw();
  say("Grab the hand and throw it, or press Play.");

  const resize = new ResizeObserver(() => {
    for (const place of [...places, inside]) place.resize();
    draw();
  });
  resize.observe(el);
  const recolour = () => {
    colours = coloursOf(el);
    draw();
  };
  const stopRecolouring = onRecolour(recolour);

  // Once, when it comes into view, the motion goes on; nothing moves while it is out of sight.
  let greeted = calm.matches;
  let interrupted = false;
  const sight = new IntersectionObserver(([entry]) => {
    const moving = frame !== 0;
    if (!entry.isIntersecting) {
      cancelAnimationFrame(frame);
      frame = 0;
      interrupted = moving;
    } else if (!greeted) {
      greeted = true;
      if (inside.open) inside.unfold();
      say(`Playing ${named()}.`);
      start();
    } else if (interrupted) start();
  });
  sight.observe(stage.svg);
  el.world = world; // for tests

  return () => {
    cancelAnimationFrame(frame);
    inside.stop();
    stopRecolouring();
    for (const observer of [resize, sight]) observer.disconnect();
  };
}

const render = safely(build);
export default { render };
