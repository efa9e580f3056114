// What FilterExplorer (explorer.py) adds to a HintonWidget: the name that the rule gives.

extras.push((view) => {
  const verdict = make("p", { class: "verdict" });
  const words = () => `By the rule: ${view.model.get("classes")[Math.round(view.curves.class[0])]}`;
  view.controls.append(verdict);
  view.words = () => [words()];
  view.after.push(() => (verdict.textContent = words()));
});
