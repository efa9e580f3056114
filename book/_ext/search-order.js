// What Sphinx's search asks for: how much a hit counts, and what its excerpt is taken from.
// Chapters come in their order before the package's reference; no formula is shown as its source.
const REFERENCE = 1000; // points: more than any hit gets
var Scorer = {
  score([page, title, , , score]) {
    const chapter = Number(title.replace(/<[^>]*>/g, "").match(/^\s*(\d+)\./)?.[1] ?? 99);
    return score - chapter / 1000 - (page.startsWith("book/api/") ? REFERENCE : 0);
  },
  objNameMatch: 11,
  objPartialMatch: 6,
  objPrio: { 0: 15, 1: 5, 2: -5 },
  objPrioDefault: 0,
  title: 15,
  partialTitle: 7,
  term: 5,
  partialTerm: 2,
};

addEventListener("DOMContentLoaded", () => {
  const unread = ".headerlink, script, style, noscript, summary, .cell_input, .ddlib-figure, svg";
  Search.htmlToText = (source, anchor) => {
    const page = new DOMParser().parseFromString(source, "text/html");
    const main = page.querySelector("article");
    const part = (anchor && main?.querySelector(anchor)) || main;
    for (const gone of part?.querySelectorAll(unread) ?? []) gone.remove();
    for (const formula of part?.querySelectorAll(".math") ?? []) formula.replaceWith("…");
    return part?.textContent.replace(/\s+/g, " ") ?? "";
  };
}, { capture: true });
