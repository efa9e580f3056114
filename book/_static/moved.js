// An old address of a section that is no longer in a lesson leads to the lesson's evidence page.
(() => {
  const page = location.pathname.split("/").pop();
  const evidence = document.querySelector(`article a[href^="evidence-${page}"]`);
  const name = decodeURIComponent(location.hash.slice(1));
  if (!evidence || !name || document.getElementById(name)) return;
  location.replace(`evidence-${page}#${encodeURIComponent(name)}`);
})();
