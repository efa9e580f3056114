// Shows a CurveWidget (base.py). With a kernel its exact curves replace those of the table, which has
// every setting of the parameters' grids.

import { chart } from "./charts.js";
import { choice, padOf, presetsOf, slider } from "./controls.js";
import { dress, freshId, make, numbersOf, report, safely, write } from "./elements.js";
import { filled, frameOf, python } from "./frame.js";
import { kernelOf } from "./kernel.js";
import { format } from "./numbers.js";
import { placeOf, show, valueNear, valueOfText } from "./parameters.js";
import { curvesAt, readTable, samplesOf, split } from "./table.js";

export const PATIENCE = 2000; // ms to wait for a kernel
const QUIET = 700; // ms without a change after which the figure is described anew

// Functions of the view, for widgets with more to show; each may return one that cleans up.
// The view has: model, spec, el, id, values (in the order of spec.parameters), curves (by name),
// get(name), parameter(name), set({name: value}), after (called with the curves after each redraw), charts,
// controls, top, numbers (a list between controls and charts), words (returns texts to be spoken), say(text),
// schedule() (redraws in the next frame), pad (its parts), keep(name, read, write) (a part of the state that is no
// parameter, see frame.js) with changed(), resets (called by Reset), tall and left (px: most height of a chart, and least
// room left of its axis).
export const extras = [];

const KERNEL = "The kernel sends exact values. Until they come, you see values computed beforehand.";

// What a widget that computes in the page sets (`Live` in table.py): of the view, curves by name; they
// end in NaN where a run is over.
let live = null;
export const computes = (curvesOf) => (live = curvesOf);

function build({ model, el }) {
  const spec = model.get("spec");
  const table = readTable(spec, model.get("baked"));
  const names = spec.parameters.map((p) => p.name);
  const view = { model, el, spec, id: freshId(), stepped: !spec.live };
  // Without a kernel there is nothing between the settings of the table.
  view.near = (p, value) => valueNear(p, value, view.stepped && model.kernelless);
  const read = () => {
    view.values = spec.parameters.map((p) => view.near(p, model.get(p.name)));
  };
  read();
  view.resets = [];
  const frame = frameOf({
    ...{ el, key: spec.key, title: spec.title, linked: Boolean(model.kernelless) },
    reset: () => view.resets.forEach((callback) => callback()),
    code: () => codeOf(spec, view.values),
  });
  Object.assign(view, { keep: frame.keep, changed: frame.changed });
  for (const [k, p] of spec.parameters.entries()) {
    const now = () => String(view.values[k]);
    const put = (text) => {
      const change = { [p.name]: valueOfText(p, text) };
      if (view.set) view.set(change);
      else model.set(change); // from the address, before anything is drawn
    };
    frame.keep(p.name, now, put, model.kernelless ? now() : String(p.value));
  }
  read();
  dress(el, spec.title);
  el.view = view; // for tests

  view.charts = spec.panels.map((panel) => chart(view, panel));
  const controls = spec.parameters.map((p, k) => (p.options ? choice : slider)(view, p, k));
  if (spec.pad) controls.push(padOf(view));
  if (spec.presets) controls.push(presetsOf(view));
  view.controls = make("div", { class: "controls" });
  view.controls.append(...controls.slice(0, names.length).map((control) => control.el));
  view.top = make("div", { class: "top" }, view.controls);
  if (spec.presets) view.controls.prepend(controls.at(-1).el);
  if (spec.pad) view.top.prepend(controls[names.length].el);
  const charts = make("div", { class: "charts" }, ...view.charts.map((c) => c.el));
  const scalars = spec.scalars.map((s) => ({ ...s, output: make("output") }));
  view.numbers = make("dl", { class: "scalars" });
  for (const s of scalars) view.numbers.append(make("div", {}, make("dt", {}, s.label), make("dd", {}, s.output)));
  const note = make("p", { class: "note", role: "status", hidden: "" });
  const problem = make("p", { class: "problem", role: "alert", hidden: "" });
  const spoken = make("p", { class: "spoken", "aria-live": "polite" });
  view.say = (text) => (spoken.textContent = text);
  const exact = model.kernelless || spec.live || !table.curves.length;
  const footer = make("p", { class: "footer" }, exact ? "" : KERNEL);
  footer.hidden = exact;
  const told = scalars.length ? [view.numbers] : [];
  const remark = spec.note ? [make("p", { class: "remark" }, spec.note)] : [];
  el.replaceChildren(frame.el, view.top, ...told, charts, ...remark, note, problem, footer, spoken);

  // The curves for the values as they stand: exact ones if the kernel has sent them.
  function current() {
    const { values, error } = model.get("answer") ?? {};
    const exact = model.get("exact");
    const fresh = values?.length === names.length && values.every((v, k) => v === view.values[k]);
    view.exact = fresh && exact?.byteLength === 4 * samplesOf(spec.curves);
    problem.hidden = !(fresh && error);
    write(problem, problem.hidden ? "" : `The exact curves could not be computed. ${error}`);
    if (view.exact) return split(spec.curves, numbersOf(exact, "Float32"));
    return curvesAt(spec, table, spec.parameters.map((p, k) => placeOf(p, view.values[k])));
  }

  view.after = [];
  let due = 0;
  let speaking = 0;
  let laid = false; // a value may be set before there is a size, or in a tab that is not shown
  // Everything but the charts.
  function update() {
    due = 0;
    view.curves = spec.live ? { ...current(), ...live(view) } : current();
    controls.forEach((control) => control.update());
    for (const { name, output, unit, digits } of scalars) {
      const { low, high } = spec.curves.find((curve) => curve.name === name);
      const [value] = view.curves[name];
      write(output, Number.isNaN(value) ? "none" : format(value, low, high, unit, digits));
    }
    el.dataset.values = spec.live ? "computed" : view.exact ? "exact" : "baked";
  }
  function redraw() {
    update();
    if (!laid) return;
    view.charts.forEach((c) => c.redraw(view.curves));
    view.after.forEach((callback) => callback(view.curves));
    clearTimeout(speaking);
    speaking = setTimeout(speak, QUIET);
  }
  view.schedule = () => (due ||= requestAnimationFrame(guarded(redraw)));

  let moved = false; // nothing is spoken before the reader does something
  const describe = () => view.charts.forEach((c) => c.describe(view.curves));
  function speak() {
    describe();
    const parts = spec.parameters.map((p, k) => `${p.label} ${show(p, view.values[k])}`);
    parts.push(...scalars.map((s) => `${s.label} ${s.output.textContent}`), ...(view.words?.() ?? []));
    if (moved) view.say(`${parts.join(". ")}.`);
  }

  // One request at a time; what changes meanwhile goes with the next one.
  let waiting = 0;
  let again = false;
  const kernel = kernelOf(model);
  view.silence = (silent) => {
    note.hidden = !silent;
    const why = kernel.busy() ? "The kernel is busy" : "The kernel does not answer";
    note.textContent = silent ? `${why}, so you see values that were computed beforehand.` : "";
  };
  function ask() {
    if (model.kernelless) return;
    if (spec.live) return void kernel.send(() => model.save_changes());
    again = Boolean(waiting);
    if (waiting) return;
    model.set("request", model.get("request") + 1);
    waiting = setTimeout(unanswered, PATIENCE);
    if (!kernel.send(() => model.save_changes())) unanswered();
  }
  function unanswered() {
    clearTimeout(waiting);
    waiting = 0;
    view.silence(true);
    if (again) ask();
  }
  function answered() {
    if ((model.get("answer")?.request ?? 0) < model.get("request")) return;
    clearTimeout(waiting);
    waiting = 0;
    view.silence(false);
    view.schedule();
    if (again) ask();
  }

  view.get = (name) => view.values[names.indexOf(name)];
  view.parameter = (name) => spec.parameters[names.indexOf(name)];
  // Changes by name, or by place among the parameters.
  view.set = (changes) => {
    moved = true;
    for (const [k, value] of Object.entries(changes)) model.set(names[k] ?? k, value);
    ask();
    frame.changed();
  };
  const follow = guarded(() => {
    read();
    view.schedule();
  });
  const events = [["change:answer", answered], ...names.map((name) => [`change:${name}`, follow])];
  for (const [event, callback] of events) model.on(event, callback);
  update(); // names and values are there from the start; the charts wait for their size
  describe();
  const stops = extras.map((extra) => extra(view));
  const size = new ResizeObserver(
    guarded(() => {
      laid = true;
      view.charts.forEach((c) => c.resize());
      cancelAnimationFrame(due);
      redraw(); // in the same frame: axes and curves never differ
    }),
  );
  size.observe(el);

  kernel.watch(unanswered);

  function stop() {
    for (const [event, callback] of events) model.off(event, callback);
    stops.forEach((clean) => clean?.());
    frame.stop();
    size.disconnect();
    kernel.leave();
    cancelAnimationFrame(due);
    clearTimeout(waiting);
    clearTimeout(speaking);
  }
  // What fails later than now is reported in place, too.
  function guarded(work) {
    return (...given) => {
      try {
        work(...given);
      } catch (error) {
        stop();
        report(el, error);
      }
    };
  }
  return stop;
}

// The state as Python code: names in braces stand for values.
function codeOf(spec, values) {
  const texts = spec.parameters.map((p, k) => [p.name, python(values[k])]);
  return filled(spec.code, Object.fromEntries(texts));
}

const render = safely(build);
export default { render };
