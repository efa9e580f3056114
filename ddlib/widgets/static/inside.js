// "Look inside": the weights of one hidden unit, folded into a line and a parabola, and what these
// two measure while the arm moves. Follows world.js and running.js.

function insideOf(world, spec, id) {
  const { net } = world.model;
  let chosen = spec.units[0];
  let fold = 1;
  let parts = null;
  let frame = 0;

  const orange = { colour: "c1", width: 2, dash: [6, 3] };
  const both = (truth, told) => [{ colour: "ink", width: 2.5, dash: [], of: truth }, { ...orange, of: told }];
  const rows = [
    {
      colour: "c0",
      title: make("span"),
      live: ["Activity of the unit", [0, 1], [{ ...orange, dash: [], of: (s) => s.hidden?.[chosen.unit] }]],
    },
    {
      colour: "c1",
      title: make("span"),
      live: ["velocity, rad/s", [-1, 1], both((s) => s.v[chosen.joint], (s) => s.rates?.[chosen.joint])],
      pair: ["velocity", "what the line measures"],
    },
    {
      colour: "c2",
      title: make("span"),
      live: ["acceleration, rad/s²", [-8, 8], both((s) => s.a[chosen.joint], (s) => s.bends?.[chosen.joint])],
      pair: ["acceleration", "what the parabola measures"],
    },
  ];
  const cells = rows.map((row, k) => {
    const [what, [low, high], lines] = row.live;
    row.stems = stems({ height: 84, label: "Weights", colour: row.colour });
    row.chart = timeChart({ height: k === 2 ? 110 : 84, label: what, low, high, lines, bottom: k === 2 });
    row.name = make("span");
    const pair = row.pair ? [keyOf("ink", row.pair[0]), keyOf("c1 dashed", row.pair[1])] : [];
    return make(
      "div",
      { class: "fold-row" },
      make("div", {}, make("div", { class: "title" }, row.title), row.stems.el),
      make("div", {}, make("div", { class: "title" }, row.name), make("div", { class: "legend" }, ...pair), row.chart.el),
    );
  });

  const choices = spec.units.map((unit) =>
    buttonOf(unit.label, () => {
      choose(unit);
      unfold();
    }, { "aria-pressed": "false" }),
  );
  const slider = make("input", { id: `${id}-fold`, type: "range", min: 0, max: 100, step: 1 });
  const said = make("output", { for: slider.id });
  slider.addEventListener("input", () => {
    cancelAnimationFrame(frame);
    set(slider.value / 100);
  });
  const label = make("label", { for: slider.id }, "Fold");
  const words = make("p", { class: "remark", role: "status" });
  // While nothing moves: what one would see, and how to see it.
  const hint = make("p", { class: "remark hint", hidden: "" });
  hint.append("At rest velocity and acceleration are zero, and so is what a line and a parabola measure. ");
  const el = make(
    "div",
    { class: "inside", id: `${id}-inside`, hidden: "" },
    make("div", { class: "choices" }, ...choices, make("div", { class: "slider" }, label, said, slider)),
    words,
    hint,
    ...cells,
  );

  function choose(unit) {
    chosen = unit;
    choices.forEach((button, k) => button.setAttribute("aria-pressed", spec.units[k] === unit));
    const at = (unit.unit * 2 + unit.joint) * net.width;
    const weights = net.hiddenWeights.subarray(at, at + net.width);
    parts = { ...folded(weights), largest: Math.max(...Array.from(weights, Math.abs)) };
    const [line, parabola] = parts.shares.map((x) => `${Math.round(100 * x)} %`);
    const joint = NAMES[unit.joint];
    write(rows[1].title, `a line: ${line}`);
    write(rows[2].title, `a parabola: ${parabola}`);
    write(rows[0].name, `Activity of hidden unit ${unit.unit}`);
    write(rows[1].name, `${joint[0].toUpperCase()}${joint.slice(1)} velocity, rad/s`);
    write(rows[2].name, `${joint[0].toUpperCase()}${joint.slice(1)} acceleration, rad/s²`);
    rows[1].stems.el.setAttribute("aria-label", `A line, ${line} of the weights' energy`);
    rows[2].stems.el.setAttribute("aria-label", `A parabola, ${parabola} of the weights' energy`);
    const means = "Under a window a line measures velocity, a parabola acceleration.";
    write(
      words,
      `Hidden unit ${unit.unit} weights the ${net.width} positions of the ${joint} like this: ${line} ` +
        `of the weights' energy lies on a line, ${parabola} on a parabola. ${means}`,
    );
    set(fold);
  }

  function set(part) {
    fold = part;
    slider.value = Math.round(100 * part);
    write(said, `${slider.value} %`);
    slider.setAttribute("aria-valuetext", said.textContent);
    write(rows[0].title, part === 0 ? "weights" : part === 1 ? "what is left" : "weights, less the two");
    world.changed?.();
  }

  // From the weights as they are to their parts, in a second and a half.
  function unfold() {
    cancelAnimationFrame(frame);
    if (matchMedia("(prefers-reduced-motion: reduce)").matches) return set(1);
    const begin = performance.now();
    const turn = (now) => {
      const s = Math.min(1, Math.max(0, (now - begin - 500) / 1000));
      set(s * s * (3 - 2 * s));
      if (s < 1) frame = requestAnimationFrame(turn);
    };
    set(0);
    frame = requestAnimationFrame(turn);
  }

  const api = { el, hint, open: false };
  api.toggle = () => {
    api.open = el.hidden;
    el.hidden = !el.hidden;
    api.resize();
    if (api.open) unfold();
  };
  api.resize = () => {
    if (api.open) for (const row of rows) [row.stems, row.chart].forEach((place) => place.resize());
  };
  api.draw = (samples, phase, colours) => {
    if (!api.open) return;
    const { left, line, parabola, largest } = parts;
    const rest = left.map((x, i) => x + (1 - fold) * (line[i] + parabola[i]));
    rows[0].stems.draw(rest, largest, colours);
    rows[1].stems.draw(line.map((x) => fold * x), largest, colours);
    rows[2].stems.draw(parabola.map((x) => fold * x), largest, colours);
    rows.forEach((row) => row.chart.draw(samples, phase, colours));
    hint.hidden = !world.still();
  };
  api.stop = () => cancelAnimationFrame(frame);
  choose(chosen);
  return api;
}
