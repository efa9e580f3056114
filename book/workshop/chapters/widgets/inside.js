// "Look inside": one row of the network's weights, folded into a constant, a line and a parabola, and
// what the latter two measure while the arm moves.

import { buttonOf, make, put, short, write } from "ddlib/elements.js";
import { NAMES } from "ddlib/engine.js";
import { keyOf, stems, timeChart } from "./running.js";
import { folded } from "./world.js";

// The network from window to torques, with one row of its weights marked. Activity fills its units.
function netOf(hidden) {
  const [wide, high, dots] = [168, 112, 7];
  const spread = (n, from, to) => Array.from({ length: n }, (_, k) => from + ((to - from) * k) / (n - 1));
  const windows = [spread(dots, 6, 76), spread(dots, 92, wide - 6)];
  const units = spread(hidden, 12, wide - 12);
  const outputs = [wide / 2 - 24, wide / 2 + 24];
  const [inputY, hiddenY, outputY] = [88, 46, 10];
  const lines = (froms, y0, tos, y1) =>
    froms.flatMap((a) => tos.map((b) => `M${short(a)} ${y0}L${short(b)} ${y1}`)).join("");
  const faint = make("path", {
    class: "faint",
    d: lines(windows.flat(), inputY, units, hiddenY) + lines(units, hiddenY, outputs, outputY),
  });
  const marked = make("path", { class: "marked" });
  const circles = units.map((x) => make("circle", { class: "unit", cx: short(x), cy: hiddenY, r: 6 }));
  const places = windows.flatMap((xs, j) =>
    xs.map((x) => make("circle", { class: j ? "elbow" : "shoulder", cx: short(x), cy: inputY, r: 3 })),
  );
  const ends = outputs.map((x) => make("circle", { class: "output", cx: x, cy: outputY, r: 6 }));
  const name = (x, y, text, anchor) => make("text", { x, y, "text-anchor": anchor }, text);
  const names = [
    name(41, high - 4, "shoulder", "middle"),
    name(127, high - 4, "elbow", "middle"),
    name(0, outputY + 4, "torques", "start"),
  ];
  const el = make(
    "svg",
    { class: "net", viewBox: `0 0 ${wide} ${high}`, role: "img" },
    ...[faint, marked, ...places, ...circles, ...ends, ...names],
  );
  const choose = ({ unit, joint }) => {
    put(marked, {
      class: `marked ${joint ? "elbow" : "shoulder"}`,
      d: lines(windows[joint], inputY, [units[unit]], hiddenY),
    });
    circles.forEach((circle, k) => circle.classList.toggle("chosen", k === unit));
    el.setAttribute("aria-label", `The network: from the windows of both joints to ${hidden} hidden units, one of them marked, and to two torques`);
  };
  const shown = new Array(hidden).fill(-1);
  const draw = (activity) => {
    activity?.forEach((value, k) => {
      const part = Math.round(50 * value) / 50;
      if (part !== shown[k]) put(circles[k], { "fill-opacity": (shown[k] = part) });
    });
  };
  return { el, choose, draw };
}

export function insideOf(world, spec, id) {
  const { net } = world.model;
  let chosen = spec.units[0];
  let fold = 1;
  let parts = null;
  let frame = 0;

  // The row, and what it is folded into
  const drawing = netOf(spec.network.layout.hidden);
  const kinds = [
    { name: "what is left", colour: "network" },
    { name: "constant", colour: "constant" },
    { name: "line", colour: "odd" },
    { name: "parabola", colour: "even" },
  ];
  for (const kind of kinds) {
    kind.title = make("span");
    kind.stems = stems({ height: 84, label: kind.name, colour: kind.colour });
  }
  const equation = make(
    "div",
    { class: "equation" },
    make("div", { class: "whole" }, drawing.el),
    ...kinds.map(({ title, stems }) => make("div", {}, make("div", { class: "title" }, title), stems.el)),
  );

  // What line and parabola measure
  const charts = [
    ["velocity", "rad/s", "line", "odd", 1, (s) => s.v[chosen.joint], (s) => s.rates?.[chosen.joint]],
    ["acceleration", "rad/s²", "parabola", "even", 8, (s) => s.a[chosen.joint], (s) => s.bends?.[chosen.joint]],
  ].map(([what, unit, shape, colour, high, truth, of]) => {
    const lines = [{ colour: "ink", width: 2.5, dash: [], of: truth }, { colour, width: 2, dash: [6, 3], of }];
    const chart = timeChart({ height: 110, label: `${what} over three seconds`, low: -high, high, lines, bottom: true });
    const title = make("div", { class: "title" });
    const legend = make("div", { class: "legend" });
    legend.append(keyOf("ink", what), keyOf(`${colour} dashed`, `from the ${shape}`));
    return { chart, title, quantity: `${what}, ${unit}`, el: make("div", {}, title, legend, chart.el) };
  });

  const choices = spec.units.map((unit) =>
    buttonOf(unit.label, () => {
      choose(unit);
      unfold();
    }, { "aria-pressed": "false" }),
  );
  const slider = make("input", { id: `${id}-fold`, type: "range", min: 0, max: 100, step: 1 });
  const amount = make("output", { for: slider.id });
  slider.addEventListener("input", () => {
    cancelAnimationFrame(frame);
    set(slider.value / 100);
  });
  const label = make("label", { for: slider.id }, "Fold");
  const words = make("p", { class: "remark", role: "status" });
  // While nothing moves: what one would see, and how to see it.
  const hint = make("p", { class: "remark hint", hidden: "" });
  hint.append("At rest there is no velocity and no acceleration to measure. ");
  const el = make(
    "div",
    { class: "inside", id: `${id}-inside` },
    equation,
    make("div", { class: "choices" }, ...choices, make("div", { class: "slider" }, label, amount, slider)),
    words,
    hint,
    make("div", { class: "measured" }, ...charts.map(({ el }) => el)),
  );

  function choose(unit) {
    chosen = unit;
    choices.forEach((button, k) => button.setAttribute("aria-pressed", spec.units[k] === unit));
    const at = (unit.unit * 2 + unit.joint) * net.width;
    const weights = net.hiddenWeights.subarray(at, at + net.width);
    parts = { ...folded(weights), weights, largest: Math.max(...Array.from(weights, Math.abs)) };
    const [constant, line, parabola] = parts.shares.map((x) => `${Math.round(100 * x)} %`);
    const joint = NAMES[unit.joint];
    [constant, line, parabola].forEach((share, k) => {
      const { name, title, stems } = kinds[k + 1];
      write(title, `${k ? "+" : "="} ${name} ${share}`);
      stems.el.setAttribute("aria-label", `A ${name}, ${share} of the weights' energy`);
    });
    kinds[0].stems.el.setAttribute("aria-label", `The ${net.width} weights of the row, pale, and what is left of them`);
    for (const { title, quantity } of charts) {
      write(title, `${joint[0].toUpperCase()}${joint.slice(1)} ${quantity}`);
    }
    drawing.choose(unit);
    write(
      words,
      `These weights lead from the ${net.width} positions of the ${joint} to the marked hidden unit. A line ` +
        `measures velocity: it has ${line} of their energy. A parabola measures acceleration: it has ${parabola}.`,
    );
    set(fold);
  }

  function set(part) {
    fold = part;
    slider.value = Math.round(100 * part);
    write(amount, `${slider.value} %`);
    slider.setAttribute("aria-valuetext", amount.textContent);
    write(kinds[0].title, part === 1 ? "what is left" : "one row");
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

  // It stands open, folded.
  const api = { el, hint, open: true, unfold };
  api.close = () => {
    api.open = false;
    el.hidden = true;
  };
  api.toggle = () => {
    if (api.open) return api.close();
    api.open = true;
    el.hidden = false;
    api.resize();
    unfold();
  };
  api.resize = () => {
    if (api.open) for (const place of [...kinds.map(({ stems }) => stems), ...charts.map(({ chart }) => chart)]) place.resize();
  };
  api.draw = (samples, phase, colours) => {
    if (!api.open) return;
    const { weights, left, constant, line, parabola, largest } = parts;
    const three = [constant, line, parabola];
    const rest = left.map((x, i) => x + (1 - fold) * (constant[i] + line[i] + parabola[i]));
    kinds[0].stems.draw(rest, largest, colours, weights);
    three.forEach((part, k) => kinds[k + 1].stems.draw(part.map((x) => fold * x), largest, colours));
    charts.forEach(({ chart }) => chart.draw(samples, phase, colours));
    drawing.draw(samples[samples.length - 1 - world.half]?.hidden);
    hint.hidden = !world.still();
  };
  api.stop = () => cancelAnimationFrame(frame);
  choose(chosen);
  return api;
}
