// One switch in the page's header shows all code, or only what teaches; it is remembered.
(() => {
  const KEY = `all-code:${new URL("..", document.currentScript.src).pathname}`; // this book's
  const root = document.documentElement;
  const cells = document.querySelectorAll("article :is(.tag_bookkeeping, .tag_plumbing)");
  const folds = [...cells].map((cell) => cell.querySelector("details")).filter(Boolean);
  const place = document.querySelector(".article-header-buttons");
  if (!folds.length || !place) return;

  // A page opened from a folder, or with cookies off, may have no storage.
  const recall = () => {
    try {
      return localStorage.getItem(KEY) === "1";
    } catch {
      return false;
    }
  };
  const remember = (all) => {
    try {
      localStorage.setItem(KEY, all ? "1" : "0");
    } catch {
      // it is not remembered
    }
  };

  const button = document.createElement("button");
  button.type = "button";
  button.className = "btn btn-sm btn-all-code";
  button.textContent = "All code";
  const show = (all) => {
    root.dataset.code = all ? "all" : "teaching";
    for (const fold of folds) fold.open = all;
    button.setAttribute("aria-pressed", String(all));
    const lines = folds.reduce((sum, fold) => sum + parseInt(fold.textContent, 10), 0);
    button.title = `${all ? "Hide" : "Show"} the ${lines} lines of hidden code on this page`;
  };

  // What the reader looks at stays where it is; the browser's own guess is a fold that goes.
  const looked = () =>
    [...document.querySelectorAll("article :is(p, h1, h2, h3, li, figure)")].find(
      (el) => el.getBoundingClientRect().top > 60 && !el.closest("details") && el.checkVisibility(),
    );
  button.addEventListener("click", () => {
    const all = root.dataset.code !== "all";
    const kept = scrollY > 0 && looked();
    const before = kept && kept.getBoundingClientRect().top;
    root.style.overflowAnchor = "none";
    show(all);
    if (kept) scrollBy({ top: kept.getBoundingClientRect().top - before, behavior: "instant" });
    requestAnimationFrame(() => root.style.removeProperty("overflow-anchor"));
    remember(all);
  });
  place.prepend(button);
  show(recall());
})();

// Buttons that copy code are told apart: by their section, and by their number in it.
addEventListener("load", () => {
  const known = new Map();
  for (const button of document.querySelectorAll("article button.copybtn")) {
    const section = button.closest("section")?.querySelector("h1, h2, h3");
    const words = [...(section?.childNodes ?? [])].filter((node) => !node.matches?.("a.headerlink"));
    const name = words.map((node) => node.textContent).join("").trim();
    known.set(name, (known.get(name) ?? 0) + 1);
    button.setAttribute("aria-label", `Copy code: ${name}, ${known.get(name)}`);
  }
});

// A place that is chosen from the page's contents is in sight at once.
document.querySelector("#pst-secondary-sidebar-modal")?.addEventListener("click", (event) => {
  if (event.target.closest("a")) event.currentTarget.close();
});
