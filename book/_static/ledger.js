// The ledger: an address of a row or card opens it; signs filter the cards, kept in the address.
(() => {
  const tiles = [...document.querySelectorAll("details.claim")];
  if (!tiles.length) return;

  const open = () => {
    const id = location.hash.slice(1); // of letters that no address has to write otherwise
    const tile = /^(claim|card)-/.test(id) && document.getElementById(id);
    if (!tile) return;
    for (let fold = tile; fold; fold = fold.parentElement.closest("details")) {
      fold.hidden = false;
      fold.open = true;
    }
    tile.scrollIntoView({ block: "start" });
  };
  addEventListener("hashchange", open);

  for (const tile of tiles)
    tile.querySelector("summary").addEventListener("click", () => {
      if (!tile.open) history.replaceState(null, "", `#${tile.id}`);
    });

  const legend = document.querySelector(".claim-legend");
  if (legend) filters();
  open();

  function filters() {
    const cards = tiles.filter((tile) => tile.dataset.verdict);
    const bar = document.createElement("form");
    bar.className = "claim-filter";
    bar.setAttribute("aria-label", "Which cards are shown");
    const verdicts = [...legend.querySelectorAll("[data-verdict]")].map((item) => {
      const button = document.createElement("button");
      button.type = "button";
      button.dataset.verdict = item.dataset.verdict;
      button.append(...item.childNodes);
      return button;
    });
    const words = document.createElement("input");
    Object.assign(words, { type: "search", name: "q", placeholder: "words" });
    words.setAttribute("aria-label", "Words of the card or its rows");
    const count = document.createElement("output");
    const reset = document.createElement("button");
    Object.assign(reset, { type: "button", textContent: "Show all" });
    bar.append(...verdicts, words, reset, count);
    legend.replaceWith(bar);

    const pressed = (button) => button.getAttribute("aria-pressed") === "true";
    const press = (button, on) => button.setAttribute("aria-pressed", String(on));
    const show = (keep) => {
      const on = verdicts.filter(pressed).map((button) => button.dataset.verdict);
      const asked = words.value.trim().toLowerCase();
      for (const card of cards)
        card.hidden = !on.includes(card.dataset.verdict)
          || !card.textContent.toLowerCase().includes(asked);
      count.textContent = `${cards.filter((card) => !card.hidden).length} of ${cards.length} cards`;
      if (!keep) return;
      const state = new URLSearchParams();
      if (on.length < verdicts.length) state.set("v", on.join(","));
      if (words.value) state.set("q", words.value);
      history.replaceState(null, "", state.size ? `#${state}` : location.pathname.split("/").pop());
    };
    for (const button of verdicts)
      button.addEventListener("click", () => {
        if (verdicts.every(pressed)) for (const b of verdicts) press(b, b === button); // this alone
        else press(button, !pressed(button));
        if (!verdicts.some(pressed)) for (const b of verdicts) press(b, true);
        show(true);
      });
    bar.addEventListener("input", () => show(true));
    bar.addEventListener("submit", (event) => event.preventDefault());
    reset.addEventListener("click", () => {
      for (const b of verdicts) press(b, true);
      words.value = "";
      show(true);
    });
    const asked = new URLSearchParams(location.hash.slice(1));
    const some = asked.get("v")?.split(",");
    for (const b of verdicts) press(b, !some || some.includes(b.dataset.verdict));
    words.value = asked.get("q") ?? "";
    show(false);
  }
})();
