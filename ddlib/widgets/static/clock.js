// Time that is played or chosen by a slider.

import { buttonOf, make, write } from "./elements.js";

// `draw(now)` shows a moment (s); with reduced motion each press of *Play* shows the moment half a second
// later, and nothing moves by itself. `rate()` is how many of its seconds pass in one; again() goes on
// after it has changed; stopped() is called when time stands still, which it does at `last()` if that is before the end.
export function clockOf(view, { at, end, step, rate = () => 1, stopped = () => {}, last = () => end }, draw) {
  const id = `${view.id}-time`;
  const output = make("output", { for: id });
  const slider = make("input", { id, type: "range", min: 0, max: end, step });
  const play = buttonOf("Play", () => {
    if (calm.matches) stand(now < last() ? Math.min(last(), now + rate() / 2) : 0);
    else if (frame) pause();
    else start(now < last() ? now : 0);
  });
  const el = make("div", { class: "slider" }, make("label", { for: id }, "Time"), output, slider);
  const calm = matchMedia("(prefers-reduced-motion: reduce)");
  let now = at;
  let from = 0; // the moment that stands for 0 s
  let frame = 0;
  function show() {
    const shown = Math.min(now, last());
    draw(shown);
    slider.value = shown;
    write(output, `${(shown / rate()).toFixed(2)}\u00a0s`);
    slider.setAttribute("aria-valuetext", output.textContent);
  }
  function pause() {
    cancelAnimationFrame(frame);
    frame = 0;
    write(play, "Play");
    stopped();
  }
  function run(moment) {
    const passed = Math.max(0, moment - from) / 1000; // a frame may bear an earlier stamp
    now = Math.min(last(), rate() * passed);
    show();
    if (now < last()) frame = requestAnimationFrame(run);
    else pause();
  }
  function start(time) {
    pause();
    from = performance.now() - (1000 * time) / rate();
    write(play, "Pause");
    frame = requestAnimationFrame(run);
  }
  function stand(time) {
    if (!(time >= 0 && time <= end)) throw new Error(`time is ${time}`);
    pause();
    now = time;
    show();
  }
  const again = () => frame && start(now);
  slider.addEventListener("input", () => stand(Number(slider.value)));
  return { el, play, slider, now: () => now, show, start, stand, pause, again };
}
