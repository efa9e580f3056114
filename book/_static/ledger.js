// The ledger: filters for its tiles, kept in the address; an address of a tile opens it.
(() => {
  const tiles = [...document.querySelectorAll("details.claim")];
  if (!tiles.length) return;

  const open = () => {
    const id = decodeURIComponent(location.hash.slice(1));
    const tile = id.startsWith("claim-") && document.getElementById(id);
    if (!tile) return;
    tile.hidden = false;
    for (let s = tile.closest("section"); s; s = s.parentElement.closest("section")) s.hidden = false;
    tile.open = true;
    tile.scrollIntoView({ block: "start" });
  };
  addEventListener("hashchange", open);

  for (const tile of tiles)
    tile.querySelector("summary").addEventListener("click", () => {
      if (!tile.open) history.replaceState(null, "", `#${tile.id}`);
    });

  const wall = document.querySelector(".wall");
  if (wall) filters();
  open();

  function filters() {
    const bar = document.createElement("form");
    bar.className = "claim-filter";
    bar.setAttribute("aria-label", "Which claims are shown");
    const verdicts = [...wall.querySelectorAll(".wall-legend > span")].map((item) => {
      const button = document.createElement("button");
      button.type = "button";
      button.dataset.verdict = item.textContent.trim().split(" ").slice(1).join(" ");
      button.setAttribute("aria-pressed", "true");
      button.append(...[...item.childNodes].map((node) => node.cloneNode(true)));
      return button;
    });
    const choice = (label, name, options) => {
      const box = document.createElement("select");
      box.setAttribute("aria-label", label);
      box.name = name;
      for (const [value, text] of [["", label], ...options]) box.add(new Option(text, value));
      return box;
    };
    const titles = [...wall.querySelectorAll(".wall-row")].flatMap((row) => {
      const inside = [...row.querySelectorAll("a")].map(
        (a) => document.getElementById(a.hash.slice(1)).dataset);
      const parts = [...new Set(inside.map((data) => data.part))].filter(Boolean);
      return [
        [inside[0].section, row.querySelector("span").textContent],
        ...parts.map((part) => [/^\d/.test(part) ? part.slice(0, 3) : part, `\u2003${part}`]),
      ];
    });
    const chapters = [...new Set(tiles.map((tile) => tile.dataset.chapter))].sort();
    const section = choice("All sections", "s", titles);
    const chapter = choice("All chapters", "c", chapters.map((c) => [c, c.replaceAll("-", " ")]));
    const words = document.createElement("input");
    Object.assign(words, { type: "search", name: "q", placeholder: "words" });
    words.setAttribute("aria-label", "Words of the claim");
    const count = document.createElement("output");
    const reset = document.createElement("button");
    Object.assign(reset, { type: "button", textContent: "Show all" });
    bar.append(...verdicts, section, chapter, words, reset, count);
    wall.before(bar);

    const read = () => {
      const asked = new URLSearchParams(location.hash.slice(1));
      const some = asked.get("v")?.split(",");
      for (const b of verdicts)
        b.setAttribute("aria-pressed", String(!some || some.includes(b.dataset.verdict)));
      section.value = asked.get("s") ?? "";
      chapter.value = asked.get("c") ?? "";
      words.value = asked.get("q") ?? "";
    };
    const squares = new Map(
      [...wall.querySelectorAll("a")].map((a) => [a.getAttribute("href").slice(1), a]));
    const show = (keep) => {
      const on = new Set(
        verdicts.filter((b) => b.ariaPressed === "true").map((b) => b.dataset.verdict));
      const asked = words.value.trim().toLowerCase();
      let shown = 0;
      for (const tile of tiles) {
        const { verdict, section: s, part, chapter: c } = tile.dataset;
        const place = section.value.includes(".") ? part.slice(0, 3) : part;
        const fits = on.has(verdict) && [s, place, ""].includes(section.value)
          && [c, ""].includes(chapter.value)
          && (!asked || tile.textContent.toLowerCase().includes(asked));
        tile.hidden = !fits;
        shown += fits;
        squares.get(tile.id)?.classList.toggle("off", !fits);
      }
      for (const part of document.querySelectorAll("section:has(> .cell details.claim)"))
        part.hidden = !part.querySelector("details.claim:not([hidden])");
      count.textContent = `${shown} of ${tiles.length} claims`;
      if (!keep) return;
      const state = new URLSearchParams();
      if (on.size < verdicts.length) state.set("v", [...on].join(","));
      for (const field of [section, chapter, words])
        if (field.value) state.set(field.name, field.value);
      history.replaceState(null, "", state.size ? `#${state}` : location.pathname.split("/").pop());
    };
    for (const button of verdicts)
      button.addEventListener("click", () => {
        const pressed = (b) => b.ariaPressed === "true";
        const press = (b, on) => b.setAttribute("aria-pressed", String(on));
        if (verdicts.every(pressed)) for (const b of verdicts) press(b, b === button); // this alone
        else press(button, !pressed(button));
        if (!verdicts.some(pressed)) for (const b of verdicts) press(b, true);
        show(true);
      });
    bar.addEventListener("input", () => show(true));
    bar.addEventListener("submit", (event) => event.preventDefault());
    reset.addEventListener("click", () => {
      for (const b of verdicts) b.setAttribute("aria-pressed", "true");
      section.value = chapter.value = words.value = "";
      show(true);
    });
    if (!location.hash.startsWith("#claim-")) read();
    show(false);
  }
})();
