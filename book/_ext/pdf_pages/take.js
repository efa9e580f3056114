// What a printed volume takes of a page: its text with stills for widgets, links into the volume,
// solutions apart, and the places of words for the index.
([name, chapters, where, words, book]) => { // book: for an EPUB, which wants MathML and XML
  const key = name.replace("book/", "").replaceAll("/", "-");
  const article = document.querySelector("article.bd-article").cloneNode(true);
  const live = document.querySelector("article.bd-article");
  // A canvas is not cloned with its picture.
  const copies = [...article.querySelectorAll("canvas")];
  live.querySelectorAll("canvas").forEach((canvas, k) => {
    const still = new Image();
    still.src = canvas.toDataURL();
    still.style.width = `${canvas.clientWidth}px`;
    copies[k].replaceWith(still);
  });
  const all = (selector, from = article) => [...from.querySelectorAll(selector)];
  const shown = all("*", live).map((el) => getComputedStyle(el).display !== "none");
  all("*").forEach((el, k) => { if (!shown[k] && !el.closest("svg, mjx-container, details")) el.dataset.gone = ""; });
  for (const el of all("[data-gone], script, .toctree-wrapper, .headerlink, .copybtn, .toggle-details, noscript, details.hide > summary, .tag_hide-input > details.hide, svg rect:not([width]), .ddlib-widget :is(button, select, input, .remark, .footer)")) el.remove();
  for (const place of all(".exercise-answer")) place.closest(".cell_output").remove(); // to be handled
  for (const fold of all("details:not(.claim)")) fold.open = true;
  for (const fold of all("details.hide")) fold.replaceWith(...fold.childNodes);
  for (const claim of all("details.claim")) claim.replaceChildren(claim.querySelector("summary"));
  for (const formula of all("mjx-container")) {
    const spoken = formula.querySelector("mjx-assistive-mml");
    if (!spoken) continue;
    if (book) formula.replaceWith(spoken.querySelector("math"));
    else spoken.remove();
  }

  const made = (tag, className, text) => Object.assign(document.createElement(tag), { className, textContent: text });
  for (const widget of all(".ddlib-widget")) {
    const told = where ? `To handle on the page ${where}` : `To handle on the page ${key}.html`;
    widget.append(made("p", "still", told));
  }

  // Names are a volume's own; a link leads into it, or says where it would lead.
  const own = (id) => `${key}--${id}`;
  for (const el of [article, ...all("[id]")]) if (el.id) el.id = own(el.id);
  for (const el of all("*")) {
    for (const attribute of ["xlink:href", "aria-labelledby", "aria-describedby", "for", "clip-path", "fill", "mask", "marker-end", "marker-start", "style"]) {
      const value = el.getAttribute(attribute);
      if (!value) continue;
      if (/^#/.test(value)) el.setAttribute(attribute, `#${own(value.slice(1))}`);
      else if (value.includes("url(#")) el.setAttribute(attribute, value.replace(/url\(#/g, `url(#${key}--`));
      else if (/^(aria|for)/.test(attribute)) el.setAttribute(attribute, value.split(" ").map(own).join(" "));
    }
  }
  const start = `${key}--start`;
  for (const img of all("img[src]")) {
    img.src = new URL(img.getAttribute("src"), location.href).href;
    img.loading = "eager";
  }
  for (const link of all("a[href]")) {
    const to = new URL(link.getAttribute("href"), location.href);
    if (to.protocol.startsWith("http")) continue;
    const page = /book\/((?:evidence\/)?[^/]+)\.html$/.exec(to.pathname)?.[1];
    if (!page || !chapters.includes(`book/${page}`)) { // elsewhere on the site
      const text = made("span", "elsewhere", "");
      text.append(...link.childNodes);
      link.replaceWith(text);
      continue;
    }
    const there = page.replaceAll("/", "-");
    const id = to.hash ? `${there}--${decodeURIComponent(to.hash.slice(1))}` : `${there}--start`;
    link.setAttribute("href", `#${id}`);
    if (!book && there !== key && page !== "glossary" && page !== "bibliography") {
      const at = made("a", "see", "000");
      at.href = `#${id}`;
      at.dataset.page = id;
      link.after(at);
    }
  }

  // Solutions go to the end; a line says where.
  const solutions = document.createElement("div");
  let before = null;
  for (const el of all("details.answer, .cell.tag_hide-cell")) {
    const question = all("h3.rubric")
      .filter((q) => q.compareDocumentPosition(el) & Node.DOCUMENT_POSITION_FOLLOWING).pop();
    const title = question?.textContent ?? "";
    if (title !== before) {
      const id = own(`solution-${all("[id]", solutions).length}`);
      const heading = made("h3", "", title);
      heading.id = id;
      solutions.append(heading);
      const line = made("p", "solved", "Solution: ");
      const at = made("a", "see", "000");
      at.href = `#${id}`;
      at.dataset.page = id;
      if (!book) line.append(at); // there are no pages
      el.before(line);
    }
    before = title;
    solutions.append(el);
  }

  // Where a word of the index stands first.
  const terms = [];
  const places = all("h1, h2, p, li, dt");
  const seen = new Set();
  for (const el of places) {
    const text = el.textContent.toLowerCase();
    for (const word of words) {
      if (seen.has(word) || !text.includes(word.toLowerCase())) continue;
      seen.add(word);
      el.id ||= own(`word-${terms.length}`);
      terms.push([word, el.id]);
    }
  }

  const heading = article.querySelector("h1");
  heading.id = start;
  const text = (el) => book
    ? [...el.childNodes].map((node) => new XMLSerializer().serializeToString(node)).join("")
    : el.innerHTML;
  const styles = all("link[rel=stylesheet], style", document).map((el) =>
    el.tagName === "LINK" ? `<link rel="stylesheet" href="${el.href.replaceAll("&", "&amp;")}">` : el.outerHTML);
  return { title: heading.textContent.trim(), anchor: start, body: text(article),
    solutions: text(solutions), terms, styles };
}
