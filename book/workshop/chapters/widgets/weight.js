// What OneWeight (weight.py) computes, and what it adds to a CurveWidget: the unit as a picture, the
// buttons that step, and the steps as points on the curve of the error.

import { computes, extras } from "ddlib/curves.js";
import { buttonOf, make, put, short, write } from "ddlib/elements.js";

const WANTED = 0.7;

function unitAt(weight) {
  const answer = 1 / (1 + Math.exp(-weight));
  const miss = answer - WANTED;
  return { answer, error: (miss * miss) / 2, slope: miss * answer * (1 - answer) };
}

// The change of the next step; `walk.last` is the step before, 0 after the weight was moved by hand.
const changeOf = (view) =>
  view.get("momentum") * view.walk.last - view.get("size") * unitAt(view.get("weight")).slope;

computes((view) => {
  const weight = view.get("weight");
  view.walk ??= { last: 0, at: weight, past: [] };
  if (weight !== view.walk.at) Object.assign(view.walk, { last: 0, at: weight, past: [] }); // by hand
  const { answer, error, slope } = unitAt(weight);
  const [{ x }] = view.spec.panels;
  const all = x.map(unitAt);
  return {
    error: all.map((unit) => unit.error),
    tangent: x.map((v) => error + slope * (v - weight)),
    answer: all.map((unit) => unit.answer),
    at: [weight],
    answers: [answer],
    errs: [error],
    slope: [slope],
    step: [changeOf(view)],
  };
});

// The unit: a wire as thick as its weight, the answer as a level between 0 and 1.
function drawnUnit() {
  const wire = make("line", { x1: 34, x2: 128, y1: 62, y2: 62 });
  const fill = make("rect", { class: "fill", x: 236, width: 22 });
  const weight = make("text", { class: "mid", x: 80, y: 44 });
  const answer = make("text", { x: 266, y: 66 });
  const [top, height] = [14, 96];
  const wanted = top + height * (1 - WANTED);
  const svg = make(
    "svg",
    { class: "unit", viewBox: "0 0 320 128", role: "img", "aria-label": "A unit with one input, its weight and its answer" },
    wire,
    make("line", { class: "grid-line", x1: 176, x2: 236, y1: 62, y2: 62, stroke: "currentColor", "stroke-width": 1.5 }),
    make("circle", { class: "body", cx: 24, cy: 62, r: 14 }),
    make("text", { class: "mid", x: 24, y: 66 }, "1"),
    make("text", { class: "mid", x: 24, y: 96 }, "input"),
    make("circle", { class: "body", cx: 152, cy: 62, r: 24 }),
    make("path", { class: "curve network", d: "M138 72C150 72 154 52 166 52" }),
    make("text", { class: "mid", x: 152, y: 106 }, "unit"),
    make("rect", { class: "gauge", x: 236, y: top, width: 22, height }),
    fill,
    make("line", { class: "wanted", x1: 230, x2: 264, y1: wanted, y2: wanted }),
    make("text", { x: 268, y: wanted + 4 }, "wanted"),
    weight,
    answer,
  );
  return {
    svg,
    show: (at) => {
      const y = unitAt(at).answer;
      put(wire, { class: `wire ${at < 0 ? "down" : "up"}`, "stroke-width": short(1 + 1.8 * Math.abs(at)) });
      put(fill, { y: short(top + height * (1 - y)), height: short(height * y) });
      const low = top + height * (1 - y);
      const beside = Math.abs(low - wanted) < 13 ? wanted + 18 : low + 4;
      put(answer, { y: short(Math.min(top + height, beside)) });
      write(weight, `weight ${at.toFixed(2).replace("-", "−")}`);
      write(answer, y.toFixed(3));
    },
  };
}

extras.push((view) => {
  const { spec } = view;
  const [{ low, high }] = spec.parameters;
  const calm = matchMedia("(prefers-reduced-motion: reduce)");
  const unit = drawnUnit();
  view.el.classList.add("ddlib-weight");
  const [chart] = view.charts;
  const points = make("path", { class: "walked" });
  const now = make("path", { class: "walked now" });
  const next = make("path", { class: "next" });
  const landing = make("circle", { class: "next", r: 6 });
  chart.el.querySelector(":scope > svg").append(points, now, next, landing);
  for (const { drag } of view.charts) drag((weight) => view.set({ weight }));
  const landed = () => Math.min(high, Math.max(low, view.get("weight") + changeOf(view)));

  function step() {
    const { walk } = view;
    const at = view.get("weight");
    const to = landed();
    // at an end of the range it stands
    const last = to === low || to === high ? 0 : to - at;
    Object.assign(walk, { last, at: to, past: [...walk.past, at] });
    view.set({ weight: to });
    view.schedule(); // at the end of the range nothing else does
  }
  let timer = 0;
  const stop = () => {
    clearInterval(timer);
    timer = 0;
  };
  function several() {
    stop();
    let remaining = 10;
    if (calm.matches) for (; remaining; remaining--) step();
    else {
      timer = setInterval(() => {
        step();
        if (!--remaining) stop();
      }, 250);
    }
  }
  const single = buttonOf("Step", () => {
    stop();
    step();
  });
  const ten = buttonOf("Ten steps", several);
  const status = make("p", { role: "status" });
  const clear = () => Object.assign(view.walk, { last: 0, past: [] });
  view.resets.push(() => {
    stop();
    clear();
    view.schedule();
  });

  const words = () => {
    const { past, at } = view.walk;
    if (!past.length) return "";
    const many = `${past.length} step${past.length > 1 ? "s" : ""} from ${past[0].toFixed(2)}`;
    const end = at === low || at === high ? ": the weight ran to the end of its range." : ".";
    return `${many.replace("-", "−")}${end}`;
  };
  view.words = () => [words().slice(0, -1)].filter(Boolean);
  view.controls.append(make("div", { class: "walk" }, single, ten, status));
  view.top.append(make("div", { class: "unit-box" }, unit.svg, view.numbers));
  const charts = view.el.querySelector(".charts");
  const scene = make("div", { class: "scene" });
  charts.after(scene);
  scene.append(view.top, charts);
  const dots = (weights) =>
    weights.map((w) => chart.at(w, unitAt(w).error).map(short)).map(([x, y]) => `M${x} ${y}h0`).join("");
  const follow = () => {
    const { past, at } = view.walk;
    if (timer && !past.length) stop(); // moved by hand meanwhile
    unit.show(at);
    put(points, { d: dots(past.slice(-60)) });
    put(now, { d: dots([at]) });
    const [x, y] = chart.at(landed(), unitAt(landed()).error).map(short);
    put(next, { d: `M${chart.at(at, unitAt(at).error).map(short).join(" ")}L${x} ${y}` });
    put(landing, { cx: x, cy: y });
    write(status, words());
  };
  view.after.push(follow);
  unit.show(view.get("weight"));
  return stop;
});
