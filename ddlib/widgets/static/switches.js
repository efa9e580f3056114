// What RealArmSwitches (switches.py) computes and shows.

import { computes, extras } from "./curves.js";
import { buttonOf, make } from "./elements.js";
import { NAMES, behind, follow, pid, referenceOf } from "./engine.js";

const DEGREES = 180 / Math.PI;

// The torque less what a dead zone takes.
function lossy(width, law) {
  return (...seen) => law(...seen).map((tau, j) => tau - Math.min(width[j], Math.max(-width[j], tau)));
}

// A run with effects of the named strengths, every period logged; without names, of the ideal arm.
function switched(loop, chosen) {
  const { plant, gains, share, levels, step } = loop;
  const strength = (name) => levels[name][chosen?.[name] ?? "off"];
  const pair = (name) => share.map((part) => part * strength(name));
  const reference = referenceOf(loop);
  const real = {
    ...plant,
    ...{ viscous: pair("friction"), coulomb: pair("friction") },
    ...{ encoder: strength("quantisation"), limit: pair("saturation") },
  };
  const law = lossy(pair("dead_zone"), behind(strength("delay"), pid(gains, step)));
  const log = follow(real, law, reference, step, 1, "difference");
  return { ...log, error: log.q.map((q, k) => (reference.q[k][0] - q[0]) * DEGREES) };
}

computes((view) => {
  const loop = view.model.get("loop");
  const chosen = Object.fromEntries(view.spec.parameters.map((p) => [p.name, view.get(p.name)]));
  const key = JSON.stringify(chosen);
  if (view.key === key) return view.found;
  view.ideal ??= switched(loop);
  const run = switched(loop, chosen);
  const whole = run.error.map((_, k) => k).filter((k) => k % loop.whole === 0);
  const close = run.tau.slice(...loop.close);
  const count = Math.round(loop.motion / loop.step);
  const rms = (gap) => {
    let sum = 0;
    for (let k = 0; k < count; k++) sum += gap(k) ** 2;
    return [Math.sqrt(sum / count)];
  };
  const found = {
    error: Float64Array.from(whole, (k) => run.error[k]),
    torque: Float64Array.from(whole, (k) => run.tau[k][0]),
    "close-up": Float64Array.from(close, (tau) => tau[0]),
  };
  NAMES.forEach((joint, j) => {
    found[`${joint} position`] = rms((k) => (run.q[k][j] - view.ideal.q[k][j]) * DEGREES);
    found[`${joint} torque`] = rms((k) => run.tau[k][j] - view.ideal.tau[k][j]);
  });
  Object.assign(view, { key, found });
  return found;
});

// In place of menus: a switch for each effect, its strength, and the effect alone.
extras.push((view) => {
  const { spec } = view;
  const strengths = {};
  const rows = spec.parameters.map((p) => {
    const [, ...on] = p.options.map(([key]) => key);
    strengths[p.name] = view.get(p.name) === "off" ? on[0] : view.get(p.name);
    const id = `${view.id}-${p.name}-on`;
    const input = make("input", { id, type: "checkbox", role: "switch" });
    const label = make("label", { for: id }, p.label);
    const strength = make(
      "select",
      { "aria-label": `Strength: ${p.label}` },
      ...p.options.slice(1).map(([key, text]) => make("option", { value: key }, text)),
    );
    const only = () => view.set({ ...all("off"), [p.name]: strengths[p.name] });
    const alone = buttonOf("Alone", only, { "aria-label": `${p.label} alone` });
    input.addEventListener("change", () => view.set({ [p.name]: input.checked ? strengths[p.name] : "off" }));
    strength.addEventListener("change", () => {
      strengths[p.name] = strength.value;
      view.set({ [p.name]: strength.value });
    });
    const update = () => {
      const now = view.get(p.name);
      input.checked = now !== "off";
      if (now !== "off") strengths[p.name] = now;
      strength.value = strengths[p.name];
      el.classList.toggle("off", now === "off");
    };
    const el = make("div", { class: "effect" }, input, label, strength, alone);
    return { el, update };
  });
  const all = (key) => Object.fromEntries(spec.parameters.map((p) => [p.name, key]));
  const start = () => Object.fromEntries(spec.parameters.map((p) => [p.name, p.value]));
  const whole = make(
    "div",
    { class: "whole" },
    buttonOf("All off", () => view.set(all("off"))),
    buttonOf("All on", () => view.set({ ...strengths })),
    buttonOf("As assumed", () => view.set(start())),
  );
  view.controls.replaceChildren(...rows.map(({ el }) => el), whole);
  view.el.classList.add("ddlib-switches");
  const follow = () => rows.forEach(({ update }) => update());
  view.after.push(follow);
  follow();
});
