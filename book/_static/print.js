// Paper is white and has nothing to click: a page is printed light, with its folds open, and is as
// it was after.
(() => {
  const root = document.documentElement;
  let shown = null;
  let opened = [];
  addEventListener("beforeprint", () => {
    shown ??= root.dataset.theme;
    root.dataset.theme = "light";
    for (const fold of document.querySelectorAll("article details:not([open])")) {
      fold.open = true;
      opened.push(fold);
    }
  });
  addEventListener("afterprint", () => {
    if (shown !== null) root.dataset.theme = shown;
    shown = null;
    for (const fold of opened) fold.open = false;
    opened = [];
  });
})();
