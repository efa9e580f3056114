// A film of a widget with a parameter "epoch": a button that steps over the epochs, its speed, and a
// loop. With reduced motion nothing moves by itself: each press shows a later picture.

import { extras } from "./curves.js";
import { make } from "./elements.js";

const STRIDE = 10; // pictures from one press to the next, with reduced motion
const SPEEDS = { slow: 400, normal: 130, fast: 45 }; // ms a picture

extras.push((view) => {
  const { options } = view.spec.parameters.find((p) => p.name === "epoch");
  const placeOf = (epoch) => options.findIndex(([key]) => key === epoch);
  const button = make("button", { type: "button" }, "Play");
  const select = make("select", { id: `${view.id}-speed` });
  for (const name of Object.keys(SPEEDS)) select.append(make("option", { value: name }, name));
  select.value = "normal";
  const loop = make("input", { id: `${view.id}-loop`, type: "checkbox" });
  const calm = matchMedia("(prefers-reduced-motion: reduce)");
  let timer = 0;
  let shown; // the epoch that the film has reached: another one is the reader's doing

  function pause() {
    clearTimeout(timer);
    timer = 0;
    button.textContent = "Play";
  }
  function go(index) {
    shown = options[index][0];
    view.set({ epoch: shown });
    const last = index === options.length - 1;
    if (last && !loop.checked) return pause();
    const wait = last ? 1200 : SPEEDS[select.value]; // the end stands for a while
    timer = setTimeout(() => go(last ? 0 : index + 1), wait);
  }
  button.addEventListener("click", () => {
    if (timer) return pause();
    const [now, end] = [placeOf(view.get("epoch")), options.length - 1];
    if (calm.matches) return view.set({ epoch: options[now === end ? 0 : Math.min(now + STRIDE, end)][0] });
    button.textContent = "Pause";
    go(now === end ? 0 : now);
  });
  view.after.push(() => {
    if (timer && view.get("epoch") !== shown) pause();
  });
  view.resets.push(pause);
  view.keep("speed", () => select.value, (name) => {
    if (!SPEEDS[name]) throw new Error(`there is no speed ${name}`);
    select.value = name;
  }, "normal");
  view.keep("loop", () => String(loop.checked), (text) => (loop.checked = text === "true"));
  for (const el of [select, loop]) el.addEventListener("change", view.changed);
  const named = (text, el) => make("label", { for: el.id }, text);
  view.controls.append(make("div", { class: "film" }, button, named("Speed", select), select, loop, named("Loop", loop)));
  return pause;
});
