// Shows a CurveWidget (base.py). Follows baked.js, frame.js, charts.js and controls.js in every
// widget's module. With a kernel the exact curves replace the interpolated ones.

const PATIENCE = 2000; // ms to wait for a kernel
const QUIET = 700; // ms without a change after which the figure is described anew

// Functions of the view, for widgets with more to show; each may return one that cleans up.
// The view has: model, spec, el, id, values (in the order of spec.parameters), curves (by name),
// get(name), set({name: value}), after (called with the curves after each redraw), charts,
// controls, top, numbers (a list between controls and charts), words (returns texts to be spoken), say(text),
// schedule() (redraws in the next frame), pad (its parts), keep(name, read, write) (a part of the state that is no
// parameter, see frame.js) with changed(), and resets (called by Reset).
const extras = [];

// What a widget that computes in the page sets (engine/_live.py): the view's curves by name; they end
// in NaN where a run is over.
let live = null;

function build({ model, el }) {
  const spec = model.get("spec");
  if (spec?.live) checkSpec(spec);
  const tables = spec?.live ? null : readTables(spec, model.get("baked"));
  const names = spec.parameters.map((p) => p.name);
  const view = { model, el, spec, id: freshId() };
  view.resets = [];
  const frame = frameOf({
    ...{ el, key: spec.key, title: spec.title, linked: Boolean(model.kernelless) },
    reset: () => view.resets.forEach((callback) => callback()),
    code: () => codeOf(spec, names.map((name) => model.get(name))),
  });
  Object.assign(view, { keep: frame.keep, changed: frame.changed });
  const read = () => {
    const values = names.map((name) => model.get(name));
    spec.parameters.forEach((p, k) => checkValue(p, values[k]));
    view.values = values;
  };
  read();
  for (const p of spec.parameters) {
    const now = () => String(model.get(p.name));
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
  const footer = make("p", { class: "footer" }, footerText(model, spec));
  const told = scalars.length ? [view.numbers] : [];
  const remark = spec.note ? [make("p", { class: "remark" }, spec.note)] : [];
  el.replaceChildren(frame.el, view.top, ...told, charts, ...remark, note, problem, footer, spoken);

  // The curves for the values as they stand: exact ones if the kernel has sent them.
  function current() {
    const { values, error } = model.get("answer") ?? {};
    const exact = model.get("exact");
    const fresh = values?.length === names.length && values.every((v, k) => v === view.values[k]);
    view.exact = fresh && exact?.byteLength === 4 * samplesOf(spec);
    problem.hidden = !(fresh && error);
    write(problem, problem.hidden ? "" : `The exact curves could not be computed. ${error}`);
    return view.exact ? numbersOf(exact, "Float32") : interpolate(spec, tables, view.values);
  }

  view.after = [];
  let due = 0;
  let speaking = 0;
  let laid = false; // a value may be set before there is a size, or in a tab that is not shown
  // Everything but the charts.
  function update() {
    due = 0;
    view.curves = spec.live ? live(view) : split(spec, current());
    controls.forEach((control) => control.update());
    for (const { name, output, unit, digits, scale } of scalars) {
      const { low, high } = spec.curves.find((curve) => curve.name === name);
      const [value] = view.curves[name];
      const text = scale === "power" ? powerText(value) : format(value, low, high, unit, digits);
      write(output, Number.isNaN(value) ? "none" : text);
    }
    el.dataset.values = spec.live ? "computed" : view.exact ? "exact" : "interpolated";
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

// A parameter's value from its text in the address, or an error.
function valueOfText(p, text) {
  const value = p.options ? p.options.find(([key]) => String(key) === text)?.[0] : Number(text);
  checkValue(p, value);
  return value;
}

// The state as Python code: names in braces stand for values.
function codeOf(spec, values) {
  const texts = spec.parameters.map((p, k) => [p.name, python(values[k])]);
  return filled(spec.code, Object.fromEntries(texts));
}

function footerText(model, spec) {
  if (spec.live) return "This page computes while you move things.";
  const percent = Number((100 * spec.error).toPrecision(2)) || "below 0.001";
  const points = spec.parameters.map((p) => p.grid).join(" × ");
  const measured = `at most ${percent} % of a curve's range, at ${spec.checks} random settings`;
  if (spec.parameters.every((p) => p.options)) {
    return model.kernelless
      ? `Computed for all ${points} settings when the page was built.`
      : "The kernel sends exact values. Until they come, you see values computed beforehand.";
  }
  return model.kernelless
    ? `Interpolated between ${points} settings computed when the page was built. Error: ${measured}.`
    : `The kernel sends exact values. Until they come, you see interpolated ones. Their error: ${measured}.`;
}

const render = safely(build);
export default { render };
