// An old address of a section that is no longer in a lesson leads to where it is now: another page
// that MOVED names for the page or for the section, or the lesson's evidence page.
(() => {
  // As JSON, since a test reads it.
  const MOVED = {
    "convolution-filters.html": {
      "a-fair-trial-the-shapes-come-without-the-arm": "whose-filters.html",
      "in-kg-m2-the-arm-shows": "inertia-in-the-weights.html",
      "how-much-regularisation-the-mass-survives": "inertia-in-the-weights.html",
      "fig-filters-beside": "whose-filters.html",
      "fig-filters-inertia": "inertia-in-the-weights.html"
    },
    "whose-filters.html": "evidence-why-smooth-filters.html",
    "inertia-in-the-weights.html": "evidence-convolution-filters.html"
  };
  const page = location.pathname.split("/").pop();
  const name = decodeURIComponent(location.hash.slice(1));
  if (!name || document.getElementById(name)) return;
  const moved = MOVED[page];
  const evidence = document.querySelector(`article a[href^="evidence-${page}"]`);
  const there = typeof moved === "string" ? moved : (moved?.[name] ?? (evidence && `evidence-${page}`));
  if (there) location.replace(`${there}#${encodeURIComponent(name)}`);
})();
