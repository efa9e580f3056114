// What TrainingPlayer (player.py) adds to a HintonWidget: a button that steps over the epochs.

extras.push((view) => {
  const { options } = view.spec.parameters.find((p) => p.name === "epoch");
  const button = make("button", { type: "button" }, "Play");
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
    if (index === options.length - 1) return pause();
    const [step, wait] = calm.matches ? [10, 1500] : [1, 130]; // calm: a few pictures
    timer = setTimeout(() => go(Math.min(index + step, options.length - 1)), wait);
  }
  button.addEventListener("click", () => {
    if (timer) return pause();
    button.textContent = "Pause";
    const now = options.findIndex(([key]) => key === view.get("epoch"));
    go(now === options.length - 1 ? 0 : now);
  });
  view.after.push(() => {
    if (timer && view.get("epoch") !== shown) pause();
  });
  view.controls.append(button);
  return pause;
});
