// Time that is played or chosen by a slider.

import { buttonOf, make, write } from "./elements.js";

// `draw(now)` shows a moment (s), words() what stands after it; with reduced motion each press of *Play*
// shows the moment half a second later, and nothing moves by itself. `rate()` is how many of its seconds pass in one; again() goes on
// after it has changed; stopped() is called when time stands still.
export function clockOf(view, { at, end, step, rate = () => 1, stopped = () => {} }, draw, words = () => "") {
  const id = `${view.id}-time`;
  const output = make("output", { for: id });
  const slider = make("input", { id, type: "range", min: 0, max: end, step });
  const play = buttonOf("Play", () => {
    if (calm.matches) stand(now < end ? Math.min(end, now + rate() / 2) : 0);
    else if (frame) pause();
    else start(now < end ? now : 0);
  });
  const el = make("div", { class: "slider" }, make("label", { for: id }, "Time"), output, slider);
  const calm = matchMedia("(prefers-reduced-motion: reduce)");
  let now = at;
  let from = 0; // the moment that stands for 0 s
  let frame = 0;
  function show() {
    draw(now);
    slider.value = now;
    write(output, `${(now / rate()).toFixed(2)}\u00a0s${words()}`);
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
    now = Math.min(end, rate() * passed);
    show();
    if (now < end) frame = requestAnimationFrame(run);
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
