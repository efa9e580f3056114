// An old address of a section that stands on another page now leads there.
(() => {
  const MOVED = {}; // page: {page now: sections}, filled in by book/_ext/dd_moved.py
  const root = new URL(document.documentElement.dataset.content_root ?? "./", location);
  const page = location.pathname.slice(root.pathname.length).replace(/\.html$/, "");
  const name = decodeURIComponent(location.hash.slice(1));
  if (!name || document.getElementById(name)) return;
  for (const [now, names] of Object.entries(MOVED[page] ?? {})) {
    if (names.includes(name)) {
      location.replace(new URL(`${now}.html#${encodeURIComponent(name)}`, root));
    }
  }
})();
