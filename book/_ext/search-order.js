// What Sphinx's search asks for: how much a hit counts, and what its excerpt is taken from.
// Chapters come in their order before the package's reference.
const REFERENCE = 1000; // points: more than any hit gets
var Scorer = {
  score([page, title, , , score]) {
    const chapter = Number(title.replace(/<[^>]*>/g, "").match(/^\s*(\d+)\./)?.[1] ?? 99);
    return score - chapter / 1000 - (page.startsWith("book/api") ? REFERENCE : 0);
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

// A page opened from a folder may not read others: excerpts come from a script, here as everywhere.
addEventListener("DOMContentLoaded", () => {
  const [LENGTH, BEFORE] = [240, 120]; // letters of an excerpt, and before the word
  const root = document.documentElement.dataset.content_root;
  const script = document.createElement("script");
  let texts = {};
  const loaded = new Promise((done) => {
    globalThis.searchTexts = (all) => done((texts = all));
  });
  script.src = `${root}_static/search-texts.js`;
  document.head.append(script);
  globalThis.fetch = async (address) => {
    await loaded;
    return { text: async () => address.slice(root.length).replace(/\.html$/, "") };
  };
  Search.makeSearchSummary = (page, words, anchor) => {
    const sections = texts[page] ?? {};
    const text = sections[anchor?.slice(1)] ?? Object.values(sections).join(" ");
    const lower = text.toLowerCase();
    const at = [...words].map((word) => lower.indexOf(word)).filter((place) => place >= 0);
    const wanted = Math.min(...at) - BEFORE;
    const from = at.length && wanted > 0 ? text.indexOf(" ", wanted) + 1 : 0;
    const summary = document.createElement("p");
    summary.className = "context";
    const more = [from > 0, from + LENGTH < text.length].map((cut) => (cut ? "…" : ""));
    summary.textContent = more.join(text.slice(from, from + LENGTH).trim());
    return summary;
  };

  // The glossary by its words, each once; what the package defines once, with what it is.
  const GLOSSARY = "book/glossary";
  const TERM = "#term-";
  const named = (anchor) => {
    const spelt = anchor.slice(TERM.length).split("-");
    const entries = Object.entries(Search._index.indexentries);
    const [entry] = entries.find(([, at]) => at.some(([, id]) => `#${id}` === anchor)) ?? [""];
    return entry.replace(/\p{L}+/gu, (word) => spelt.find((w) => w.toLowerCase() === word) ?? word);
  };
  const search = Search._performSearch;
  Search._performSearch = (...asked) => {
    const hits = search(...asked);
    const place = ([page, , anchor]) => page + anchor;
    const isTerm = ([page, , anchor]) => page === GLOSSARY && anchor.startsWith(TERM);
    const told = new Set(hits.filter((hit) => hit[3]).map(place));
    const terms = hits.some(isTerm);
    const kept = hits.filter((hit) => (hit[3] || !told.has(place(hit)))
      && (!terms || hit[0] !== GLOSSARY || isTerm(hit)));
    // shown last to first: sections that are called what was asked for come first
    const asking = asked[0].toLowerCase().trim();
    const called = ([, title]) => Number(title.toLowerCase().split(" > ").pop() === asking);
    kept.sort((one, other) => called(one) - called(other));
    return kept.map((hit) => (isTerm(hit) ? [hit[0], `Glossary > ${named(hit[2])}`, ...hit.slice(2)] : hit));
  };
}, { capture: true });
