// What PIDTuner (tuner.py) computes and shows.

import { clockOf } from "ddlib/clock.js";
import { computes, extras } from "ddlib/curves.js";
import { buttonOf, make, write } from "ddlib/elements.js";
import { JOINTS, NAMES, behind, feedforward, pid, referenceOf } from "ddlib/engine.js";
import { calmPart, growthOf, guarded, marginOf } from "./loops.js";
import { armsOf } from "./stage.js";

const PAUSE = 800; // ms without a change of keys after which a setting is the one before the next
const THOUGHT = 250; // ms without a change after which it is sought what would make a loop stable
const BODE = "fig-pid-bode"; // figure of the chapter that explains margins

// Everything about one setting.
function tuned(loop, setting) {
  const { plant, modes, elbow, step, every, periods, motion } = loop;
  const gains = { differs: setting.noise };
  for (const name of ["kp", "ki", "kd"]) gains[name] = [setting[name], setting[name] * elbow[name]];
  const { reference } = loop;
  const { load, limit } = loop;
  const arm = { ...plant, coulomb: setting.dry ? loop.dry : [0, 0], encoder: setting.noise ? loop.count : 0 };
  Object.assign(arm, { load: setting.load ? load : null, limit: setting.limit === "none" ? null : limit });
  const cured = setting.limit === "anti-windup" ? { limit, anti_windup: "conditional" } : {};
  const feedback = pid({ ...gains, ...cured }, step);
  const law = behind(setting.late, setting.feedforward ? feedforward(plant.arm, feedback) : feedback);
  const velocity = setting.noise ? "difference" : "tachometer";
  const log = guarded(arm, law, reference, step, every, loop.most, velocity);
  const count = Math.floor((periods - 1) / every) + 1;
  const shape = (of) => JOINTS.map((j) => Float64Array.from({ length: count }, (_, k) => (k < log.q.length ? of(k, j) : NaN)));
  const wanted = reference.q.filter((_, k) => k % every === 0);
  const error = shape((k, j) => ((wanted[k][j] - log.q[k][j]) * 180) / Math.PI);
  const torque = shape((k, j) => log.tau[k][j]);
  const moving = Math.round(motion / step / every);
  const rms = error.map((x) => Math.sqrt(x.slice(0, moving).reduce((sum, e) => sum + e * e, 0) / moving));
  const growth = growthOf(modes, gains, step, setting.late);
  const margins = JOINTS.map((j) =>
    growth < 0 ? marginOf(modes, gains, step, setting.late, j) : { phase: NaN, crossover: NaN },
  );
  const calm = (names) => calmPart(modes, gains, step, setting.late, names);
  return { setting, log, wanted, error, torque, rms, growth, margins, calm, seconds: step * every };
}

// Runs by their settings, the newest last.
function memory(loop, most = 4) {
  loop = { ...loop, reference: referenceOf(loop) };
  const runs = new Map();
  return (setting) => {
    const key = JSON.stringify(setting);
    const run = runs.get(key) ?? tuned(loop, setting);
    runs.delete(key);
    runs.set(key, run);
    if (runs.size > most) runs.delete(runs.keys().next().value);
    return run;
  };
}

computes((view) => {
  const { model, spec } = view;
  view.tuned ??= memory(model.get("loop"));
  const setting = Object.fromEntries(spec.parameters.map((p) => [p.name, view.get(p.name)]));
  const now = view.tuned(setting);
  if (view.now && view.now !== now && !view.keeps) {
    const time = performance.now();
    const begins = view.grip ? view.grip === "fresh" : !(time - view.changed < PAUSE);
    if (begins) model.set("before", view.now.setting); // where a drag or a run of keys began
    view.changed = time;
    if (view.grip) view.grip = "moved";
  }
  view.keeps = false;
  view.now = now;
  view.ghost = view.tuned({ ...setting, ...model.get("before") });
  const curves = { crossover: [now.margins[0].crossover] };
  NAMES.forEach((name, j) => {
    curves[`${name} RMS`] = [now.rms[j]];
    curves[`${name} phase margin`] = [now.margins[j].phase];
    for (const what of ["error", "torque"]) {
      curves[`${name} ${what}`] = now[what][j];
      curves[`${name} ${what} before`] = view.ghost[what][j];
    }
  });
  return curves;
});

extras.push((view) => {
  const { model, spec, el } = view;
  const loop = model.get("loop");
  const { lengths } = loop.plant;
  const calm = matchMedia("(prefers-reduced-motion: reduce)");
  el.classList.add("ddlib-tuner", "quiet");
  view.tall = 215;

  // The arm, and time
  const far = lengths[0] + lengths[1];
  const kinds = ["ghost", "wanted", "real"];
  const box = [-0.09 * far, -0.84 * far, 1.07 * far, 0.36 * far];
  const stage = armsOf(lengths, kinds, box, "The arm from above. Pale: the arm with your previous setting");
  const end = (loop.periods - 1) * loop.step;
  const last = () => (view.now.log.stopped ?? Infinity) * view.now.seconds;
  const moments = { at: 1, end, step: loop.step * loop.every, last: () => Math.min(end, last()) };
  const clock = clockOf(view, moments, draw);
  const verdict = make("p", { class: "verdict", role: "status" });
  const remedy = make("p", { class: "remedy", role: "status" });
  const chapter = "Poles and margins";
  const figure = document.getElementById(BODE)
    ? make("a", { href: `#${BODE}` }, `the Bode plot under “${chapter}”`)
    : `the Bode plot in the lesson Feedback, under “${chapter}”`;
  const pointer = make("p", { class: "remark" }, "What is a margin? See ", figure, ".");
  const key = (kind, text) => {
    const line = make("path", { class: "links", d: "M2 6H24" });
    const icon = make("svg", { width: 26, height: 12, "aria-hidden": "true" });
    icon.append(make("g", { class: `arm ${kind}` }, line));
    return make("span", {}, icon, text);
  };
  const legend = make("div", { class: "legend" });
  legend.append(key("ghost", "your previous setting"), key("wanted", "wanted"));
  const row = make("div", { class: "time" }, clock.play, clock.el);
  const scene = make("div", { class: "scene" }, stage.svg, legend, row);
  const first = make("div", { class: "charts first" }, ...view.charts.slice(0, 2).map((c) => c.el));
  const told = make("div", { class: "told-so" }, verdict, pointer, remedy);
  const switches = make("div", { class: "controls" }, ...view.controls.querySelectorAll(".switch, .menu"));
  const names = spec.parameters.filter((p) => p.options && p.display !== "slider").map((p) => p.name);
  const what = view.charts[2].panel.y_label.split(",")[0].replace(/^\w+ /, "");
  const summary = make("summary", {}, `More: feedforward, load, friction, noise, a weak motor, and each ${what}`);
  const more = make("details", { class: "more" }, summary, switches, el.querySelector(":scope > .charts"), ...el.querySelectorAll(":scope > .remark"));
  const opened = () => (more.open ||= names.some((name) => view.get(name) !== view.parameter(name).value));
  opened();
  view.top.append(view.numbers, first, scene, told, more);

  // A drag, however slow, has one setting before it.
  const grasp = () => (view.grip = "fresh");
  const letGo = () => {
    if (view.grip === "fresh") view.changed = -Infinity; // a click changes after it
    view.grip = null;
  };
  view.top.addEventListener("pointerdown", grasp);
  for (const end of ["pointerup", "pointercancel"]) addEventListener(end, letGo);

  const along = (list, k) => {
    const i = Math.min(Math.floor(k), list.length - 1);
    const next = list[Math.min(i + 1, list.length - 1)];
    const part = Math.min(1, k - i);
    return list[i].map((q, j) => q + part * (next[j] - q));
  };
  function draw(time) {
    const { now, ghost } = view;
    const k = time / now.seconds;
    stage.place("wanted", along(now.wanted, k));
    stage.place("ghost", along(ghost.log.q, k));
    stage.place("real", along(now.log.q, k));
    stage.arms.get("real").el.classList.toggle("stopped", time >= last());
    for (const c of view.charts) c.point(time);
  }

  // What is seen, in words
  const span = (rate) => {
    const seconds = Math.LN2 / Math.abs(rate);
    return `${seconds < 10 ? seconds.toFixed(2) : Math.round(seconds)}\u00a0s`;
  };
  const degrees = Math.round((loop.most * 180) / Math.PI);
  function words() {
    const { growth, log, seconds } = view.now;
    const linear =
      growth < 0
        ? `The linear loop is stable: a disturbance halves in ${span(growth)}.`
        : `The linear loop is unstable: a disturbance doubles in ${span(growth)}.`;
    if (log.stopped === null) return linear;
    return `${linear} The run stopped at ${(log.stopped * seconds).toFixed(2)}\u00a0s: an error passed ${degrees}°.`;
  }
  view.words = () => [words().slice(0, -1), ...(remedy.textContent ? [remedy.textContent.slice(0, -1)] : [])];

  // An unstable loop has no margin: what would make it stable instead.
  let thinking = 0;
  const percent = (part) => `${Number((100 * part).toPrecision(2))}\u00a0%`;
  function remedied() {
    const { now } = view;
    const begin = "An unstable loop has no margin";
    clearTimeout(thinking);
    write(remedy, now.growth < 0 ? "" : (now.remedy ?? `${begin}.`));
    if (now.growth < 0 || now.remedy) return;
    thinking = setTimeout(() => {
      now.remedy = `${begin}. ${calming(now)}`;
      write(remedy, now.remedy);
    }, THOUGHT);
  }
  function calming({ calm }) {
    const part = calm();
    if (part === part) return `It would be stable if all three gains fell to ${percent(part)}.`;
    const alone = calm(["ki"]);
    if (alone === alone) return `Lowering all three gains does not help. The integral gain alone would have to fall to ${percent(alone)}.`;
    return "Lower gains do not help: neither all three together nor the integral gain alone.";
  }
  const outputs = [...view.numbers.querySelectorAll("output")];
  function numbered() {
    spec.scalars.forEach(({ name }, k) => {
      if (outputs[k].textContent === "none" && name.endsWith("RMS")) write(outputs[k], "none, stopped");
    });
  }

  const ask = asking(view, loop.questions, (change) => {
    model.set("before", change[0]);
    view.keeps = true;
    view.set(change[1]);
    opened();
    view.schedule();
    if (calm.matches) clock.stand(end);
    else clock.start(0);
  });
  view.top.before(ask);

  view.resets.push(() => {
    model.set("before", Object.fromEntries(spec.parameters.map((p) => [p.name, p.value])));
    view.keeps = true;
    view.schedule();
  });

  const follow = () => {
    write(verdict, words());
    remedied();
    numbered();
    el.toggleAttribute("data-stopped", view.now.log.stopped !== null);
    clock.show();
  };
  view.after.push(follow);
  const redraw = () => view.schedule();
  model.on("change:before", redraw);
  follow();
  return () => {
    clock.pause();
    clearTimeout(thinking);
    model.off("change:before", redraw);
    for (const end of ["pointerup", "pointercancel"]) removeEventListener(end, letGo);
  };
});

// A question at a time: the reader predicts, then it is shown.
function asking(view, questions, show) {
  let at = 0;
  const question = make("span", { class: "question" });
  const choices = make("div", { class: "choices" });
  const outcome = make("p", { class: "told", role: "status" });
  const tryIt = buttonOf("Try it", () => {
    const { right, why, settings, choices: texts } = questions[at];
    const chosen = choices.querySelector("input:checked");
    if (!chosen) return;
    const good = Number(chosen.value) === right;
    show(settings);
    write(outcome, `${good ? "You were right." : "It comes out differently."} ${texts[right]} ${why}`);
    choices.hidden = true; // the answer stands in its place
    next.focus({ preventScroll: true }); // a button that goes out of use would lose it
    tryIt.disabled = true;
  });
  const next = buttonOf("Next question", () => {
    at = (at + 1) % questions.length;
    pose();
  });
  function pose() {
    const { text, choices: texts } = questions[at];
    write(question, `… ${text}?`);
    write(outcome, "");
    choices.hidden = false;
    tryIt.disabled = true;
    choices.replaceChildren(
      ...texts.map((choice, k) => {
        const id = `${view.id}-choice-${k}`;
        const input = make("input", { id, type: "radio", name: `${view.id}-choice`, value: k });
        input.addEventListener("change", () => (tryIt.disabled = false));
        return make("div", {}, input, make("label", { for: id }, choice));
      }),
    );
  }
  pose();
  view.resets.push(pose);
  const legend = make("legend", {}, "Predict first. What happens if ", question);
  const buttons = make("div", { class: "buttons" }, tryIt, next);
  return make("fieldset", { class: "ask" }, legend, choices, outcome, buttons);
}
