// Runs in the page; returns what a reader would see as wrong.
({ width, scheme }) => {
  const found = [];
  const root = document.documentElement;
  const all = (selector) => [...document.querySelectorAll(selector)];
  if (root.scrollWidth > width) {
    const box = (el) => el.getBoundingClientRect();
    const wide = all("main :not(mjx-container *)").filter((el) => box(el).right > width + 1);
    const names = wide.slice(0, 3).map((el) => `${el.tagName}.${el.className}`);
    found.push(`overflows: ${root.scrollWidth} px of ${width}: ${names.join(", ")}`);
  }
  if (root.dataset.theme !== scheme) found.push(`theme is ${root.dataset.theme}`);
  for (const img of all("img")) {
    if (!img.alt.trim()) found.push(`no alternative text: ${img.src.slice(0, 80)}`);
    if (img.complete && !img.naturalWidth) found.push(`broken image: ${img.alt}`);
  }
  for (const [kind, wanted] of [["light", scheme === "light"], ["dark", scheme === "dark"]]) {
    for (const el of all(`.only-${kind}`)) {
      if ((getComputedStyle(el).display !== "none") !== wanted) found.push(`only-${kind} is wrong`);
    }
  }
  const code = all(".highlight-ipython3 pre").map((el) => el.textContent).join("");
  const shades = new Set(all(".highlight-ipython3 span").map((el) => getComputedStyle(el).color));
  if (/\bimport\b.*"/s.test(code) && shades.size < 3) found.push("code without colours");
  for (const el of width < 1280 ? [] : all("mjx-container[display=true], div.math")) {
    const cut = el.scrollWidth - el.clientWidth;
    if (cut > 1) found.push(`an equation is cut by ${cut} px: ${el.closest("[id]")?.id}`);
  }
  for (const fold of all("article details")) {
    const inside = fold.cloneNode(true);
    inside.querySelector("summary")?.remove();
    const shows = inside.textContent.trim() || inside.querySelector("img, svg, table, script");
    if (!shows) found.push(`a fold opens onto nothing: ${fold.textContent.trim()}`);
    if (fold.open) found.push(`a fold stands open: ${fold.textContent.trim().slice(0, 60)}`);
  }
  for (const svg of all(".ddlib-figure svg")) {
    const whole = svg.getBoundingClientRect();
    for (const el of whole.width ? svg.querySelectorAll("text") : []) {
      const box = el.getBoundingClientRect();
      const out = [whole.left - box.left, box.right - whole.right,
                   whole.top - box.top, box.bottom - whole.bottom];
      if (Math.max(...out) > 1) found.push(`a figure cuts its text: ${el.textContent}`);
    }
  }
  const said = (el) => [...el.childNodes].some((node) => node.nodeType === 3 && node.data.trim());
  for (const el of all(":is(.ddlib-figure, .ddlib-widget) svg :is(text, tspan)")) {
    if (!said(el) || !el.getClientRects().length) continue;
    const { b, d } = el.getScreenCTM();
    const size = parseFloat(getComputedStyle(el).fontSize) * Math.hypot(b, d);
    if (size < (width < 600 ? 8.95 : 8))
      found.push(`text of ${size.toFixed(1)} px: ${el.textContent}`);
  }
  for (const svg of all(".ddlib-widget .chart svg")) {
    const marks = [...svg.querySelectorAll(".grid > text")].map((el) => [el, el.getBoundingClientRect()]);
    marks.forEach(([el, a], i) => marks.slice(0, i).forEach(([other, b]) => {
      if (el.getAttribute("class") !== other.getAttribute("class")) return; // of another axis
      const over = Math.min(a.right, b.right) - Math.max(a.left, b.left) > 0.5
        && Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top) > 2;
      if (a.width && over) found.push(`marks overlap: ${other.textContent} ${el.textContent}`);
    }));
  }
  for (const el of all("main :is(div, section, pre, mjx-container)")) {
    const inside = el.scrollWidth <= el.clientWidth + 1;
    if (inside || el.tabIndex >= 0 || !el.checkVisibility()) continue;
    if (!["auto", "scroll"].includes(getComputedStyle(el).overflowX)) continue;
    if (!el.querySelector("a[href], button, input, [tabindex='0']"))
      found.push(`scrolls, but not by keyboard: ${el.className} ${el.textContent.slice(0, 40)}`);
  }
  const loads = document.querySelector('script[src*="mathjax"]') !== null;
  const formulas = all("mjx-container, mjx-merror").length;
  if (loads !== formulas > 0) found.push(`MathJax for ${formulas} formulas: ${loads}`);
  for (const el of all("mjx-merror")) found.push(`bad TeX: ${el.textContent}`);
  const prose = document.querySelector("article, main").cloneNode(true);
  const set = "pre, code, script, style, mjx-container";
  prose.querySelectorAll(set).forEach((el) => el.replaceWith("•"));
  const raw = prose.textContent.match(/\\[([]|\$\$|\\begin\{|\\(frac|tau|ddot|dot|text)\b/);
  if (raw) found.push(`raw TeX: ${prose.textContent.substr(raw.index, 60)}`);
  const twice = prose.textContent.match(/\b(the|an?|of|to|in|and|is|are)(?:[ \t]+|[ \t]*\n[ \t]*)\1\b(?!\W*[_^=])/i);
  if (twice) found.push(`twice: ${prose.textContent.substr(twice.index - 20, 60)}`);
  return found;
}
