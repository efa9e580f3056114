// What is wider than the page scrolls in its own box: by keyboard, too, and the box says so.
// A table of sentences becomes cards on a phone; a table of numbers keeps its first column in sight.
// Lines break where a reader would: in a name after a dot, never before a unit or a comma.
(() => {
  const TABLES = ".pst-scrollable-table-container, .cell_output .text_html";
  const BOXES = `${TABLES}, .ddlib-figure, mjx-container[display="true"], div.math, pre`;
  const SENTENCE = 60; // letters of a cell that is read, not compared
  const INTERVAL = /^[−\d.]+ \([−\d.]+ to [−\d.]+\)$/;
  const SHORT = 12; // letters of a cell that is a number with its unit
  const NAMES = "dt.sig .pre, .indextable a, .modindextable code .pre, \
article :is(h1, h2, h3), \
.prev-next-title, .bd-sidebar-secondary a, .bd-sidebar-secondary .pre";

  // Down to which share of its size a formula, or a table, is set smaller instead of scrolled.
  const LEAST = { "MJX-CONTAINER": 0.68, SECTION: 0.83, DIV: 0.83 };
  let fitted = new WeakMap(); // the width for which a box was set

  const fit = (box) => {
    const least = LEAST[box.tagName];
    const part = box.matches(TABLES) ? box.querySelector("table") : box;
    if (!least || !part || box.matches(".ddlib-figure, div.math")) return;
    const over = () => box.scrollWidth > box.clientWidth + 1;
    if (fitted.get(box) === box.clientWidth && !(part.style.fontSize && over())) return;
    fitted.set(box, box.clientWidth);
    part.style.fontSize = "";
    const own = parseFloat(getComputedStyle(part).fontSize);
    for (let share = 1; over() && share > least; share -= 0.01) {
      part.style.fontSize = `${(share - 0.01) * own}px`;
    }
    if (over()) part.style.fontSize = "";
  };

  let stops = 0; // each region has a name of its own
  const judge = (box) => {
    fit(box);
    const wide = box.scrollWidth > box.clientWidth + 1;
    box.classList.toggle("goes-on", wide);
    if (wide && box.getAttribute("tabindex") !== "0") {
      box.tabIndex = 0;
      box.dataset.stop = "ours";
      if (box.tagName !== "SECTION") {
        box.setAttribute("role", "region");
        box.setAttribute("aria-label", `Scrolls sideways, ${(stops += 1)}`);
      }
    } else if (!wide && box.dataset.stop) {
      for (const name of ["tabindex", "role", "aria-label"]) box.removeAttribute(name);
      delete box.dataset.stop;
    }
    if (!box.matches(TABLES) || !wide) return;
    const first = box.querySelector("tbody tr > :first-child");
    box.classList.toggle("keeps-first", first?.offsetWidth < 0.5 * box.clientWidth);
  };

  for (const name of document.querySelectorAll(NAMES)) {
    for (const text of [...name.childNodes].filter((node) => node.nodeType === 3)) {
      const parts = text.data.replace(/([._])(?=[a-z])/gi, "$1\0").split("\0");
      if (parts.length > 1) {
        text.replaceWith(...parts.flatMap((part) => [part, document.createElement("wbr")]));
      }
    }
  }

  for (const formula of document.querySelectorAll("article span.math")) {
    const after = formula.nextSibling;
    const mark = after?.nodeType === 3 && after.data.match(/^[,.;:?!)]+/)?.[0];
    if (!mark) continue;
    const kept = document.createElement("span");
    kept.className = "kept";
    formula.replaceWith(kept);
    kept.append(formula, mark);
    after.data = after.data.slice(mark.length);
  }

  for (const cell of document.querySelectorAll("article td")) {
    const text = cell.textContent.trim();
    if (text.length <= SHORT) cell.classList.add("short");
    else if (INTERVAL.test(text)) cell.classList.add("interval");
  }

  // Cards need one line of headings in plain words, to be said again in front of each cell.
  for (const table of document.querySelectorAll("article table")) {
    const heads = [...(table.tHead?.rows ?? [])];
    const cells = [...table.querySelectorAll("tbody td")];
    const sentences = cells.some((cell) => cell.textContent.trim().length > SENTENCE);
    const spans = table.querySelector("[rowspan], [colspan]");
    if (!sentences || spans || heads.length !== 1) continue;
    if (heads[0].cells.length < 3 || heads[0].querySelector(".math, mjx-container")) continue;
    const names = [...heads[0].cells].map((cell) => cell.textContent.trim());
    table.classList.add("cards");
    for (const cell of cells) {
      if (cell.cellIndex > 0) cell.dataset.name = names[cell.cellIndex];
    }
  }

  const watched = new ResizeObserver((seen) => seen.forEach((entry) => judge(entry.target)));
  const parts = () => document.querySelectorAll(`article :is(${BOXES})`);
  for (const part of parts()) watched.observe(part);
  const formulasStand = () => { // only now does everything have its width
    fitted = new WeakMap();
    for (const part of parts()) {
      judge(part);
      watched.observe(part);
    }
  };
  window.MathJax?.startup?.promise?.then(formulasStand);
  addEventListener("load", () => window.MathJax?.startup?.promise?.then(formulasStand));
})();
