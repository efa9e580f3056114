// Paper is white: a page printed from the dark mode is printed light, and is dark again after.
(() => {
  const root = document.documentElement;
  let shown = null;
  addEventListener("beforeprint", () => {
    shown ??= root.dataset.theme;
    root.dataset.theme = "light";
  });
  addEventListener("afterprint", () => {
    if (shown !== null) root.dataset.theme = shown;
    shown = null;
  });
})();
