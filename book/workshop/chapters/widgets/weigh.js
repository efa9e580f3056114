// What WeighTheArm (weigh.py) adds to a CurveWidget: the arm with its load, the end of what counts under
// the pointer, and a balance between the arm and the samples that count.

import { extras } from "ddlib/curves.js";
import { make, put, short } from "ddlib/elements.js";
import { balanceOf, blockPath, number, tiltOf } from "./balance.js";
import { armsOf } from "./stage.js";

const POSE = [1.15, -0.75]; // rad, of the arm that is drawn

extras.push((view) => {
  const { el, charts } = view;
  el.classList.add("ddlib-weigh", "quiet");
  Object.assign(view, { tall: 165, left: 44 });
  const control = (name) => view.controls.querySelector(`[id$="-${name}"]`).closest(".choice, .slider");

  const { options } = view.parameter("reach");
  const step = charts[0].panel.x[1] - charts[0].panel.x[0];
  for (const { drag } of charts) {
    drag((time) => view.set({ reach: options[Math.min(options.length - 1, Math.round(Math.abs(time) / step))][0] }));
  }

  const stage = armsOf(view.model.get("lengths"), ["real"], [-0.13, -0.1, 0.8, 0.86], "The arm, its load in its hand");
  const load = make("path", { class: "load" });
  stage.svg.prepend(load);
  stage.place("real", POSE);

  const balance = balanceOf("the arm", "the network");
  const scales = make("svg", { class: "stage", role: "img" }, balance.el);
  const column = (kind, ...children) => make("div", { class: kind }, ...children);
  const scene = column(
    "scene",
    column("arm-box", stage.svg, control("load"), control("pencil")),
    column("counted", el.querySelector(":scope > .charts"), control("reach")),
    column("scales-box", scales, control("learnt")),
  );
  view.top.replaceChildren(scene);
  view.top.after(el.querySelector(":scope > .frame-bar"));

  const said = () => {
    const [sum, own] = [view.curves.sum[0], view.curves.own[0]];
    return `On the scales the network has ${number(sum)} kg m², the arm ${number(own)} kg m²`;
  };
  view.words = () => [said()];
  // The beam swings to where its weights leave it.
  const calm = matchMedia("(prefers-reduced-motion: reduce)");
  let [tilt, speed, last, frame] = [0, 0, 0, 0];
  function draw() {
    const { sum: [sum], own: [own] } = view.curves; // prettier-ignore
    const wide = scales.parentElement.clientWidth;
    const narrow = wide < 240;
    const s = wide / (narrow ? 170 : 320);
    const sizes = narrow ? { half: 46, post: 92, rope: 50, top: 50 } : { half: 108, post: 190, rope: 92, top: 62 };
    const place = Object.fromEntries(Object.entries(sizes).map(([name, size]) => [name, s * size]));
    const high = short(place.top + place.post + 14 * s);
    el.classList.toggle("narrow", narrow);
    put(scales, { width: wide, height: high, viewBox: `0 0 ${wide} ${high}` });
    scales.style.setProperty("--s", s);
    balance.draw({ ...place, x: wide / 2, s, narrow }, own, sum, { tilt });
  }
  function swing(now) {
    const goal = tiltOf(view.curves.own[0], view.curves.sum[0]);
    const passed = Math.min(0.03, (now - last) / 1000);
    last = now;
    speed += (150 * (goal - tilt) - 9 * speed) * passed;
    tilt += speed * passed;
    const still = calm.matches || Math.abs(goal - tilt) + Math.abs(speed) < 0.002;
    if (still) [tilt, speed] = [goal, 0];
    draw();
    frame = still ? 0 : requestAnimationFrame(swing);
  }
  view.after.push(() => {
    const kg = view.get("load");
    const [x, y] = stage.at(stage.hand("real"));
    const size = 22 + 4 * kg;
    put(load, { d: kg ? blockPath(x, y + size + 22, 0.8 * size, size, 1) : "M0 0" });
    put(scales, { "aria-label": said() });
    if (!frame) swing((last = performance.now()));
  });
  return () => cancelAnimationFrame(frame);
});
