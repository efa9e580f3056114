// A volume's page numbers, where `data-page` asks for them; an entry of the index names each page
// once, and no place that was not printed. Returns the headings.
(at) => {
  for (const entry of document.querySelectorAll(".index li")) {
    const named = new Set([undefined]);
    for (const link of entry.querySelectorAll("[data-page]")) {
      const page = at[link.dataset.page];
      if (named.has(page)) link.remove();
      named.add(page);
    }
  }
  for (const link of document.querySelectorAll("[data-page]")) {
    link.textContent = at[link.dataset.page] ?? "000";
  }
  const headings = [...document.querySelectorAll("h1, h2, h3, h4, h5, h6")];
  return headings.map((heading) => heading.textContent.trim().replace(/\s+/g, " "));
}
