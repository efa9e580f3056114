"""What axe-core finds on an open page."""

from __future__ import annotations

from importlib.resources import files

import chromium

AXE = (files("axe_playwright_python") / "axe.min.js").read_text(encoding="utf-8")

# Rules of levels A, AA and AAA, best practices and experimental ones: none is left out.
RUN = """
async ([include, colours, asked]) => {
  const rules = axe.getRules().map((rule) => rule.ruleId);
  const values = rules.filter((rule) => colours.includes(rule) === asked);
  if (include === "each look") include = window.looks;
  if (include === "what changed") include = window.changed;
  if (!include.length) return [];
  const runOnly = { type: "rule", values };
  const { violations } = await axe.run({ include }, { runOnly, resultTypes: ["violations"] });
  return violations.flatMap(({ id, impact, nodes }) =>
    nodes.map(({ target, failureSummary }) =>
      `${id} (${impact}) at ${target.join(" ")}: ${failureSummary.split("\\n")[1].trim()}`));
}
"""
OPEN_ALL = "document.querySelectorAll('details').forEach((el) => { el.open = true; })"

COLOURS = ["color-contrast", "color-contrast-enhanced", "link-in-text-block"]
"""Rules whose answer hangs on colours."""

# `looks`: of all that has text, the first that looks so, by its own colour and size, by the text
# around it and by what is behind it. Thousands of words of code have a dozen looks, and axe takes a
# second for a thousand.
LOOKS = """
(where) => {
  const behind = new Map([[null, ""]]);
  const ground = (el) => {
    if (!behind.has(el)) {
      const { backgroundColor, backgroundImage, opacity, filter } = getComputedStyle(el);
      const own = [el.tagName, el.getAttribute("class"), backgroundColor, backgroundImage];
      behind.set(el, [ground(el.parentElement), ...own, opacity, filter].join(" "));
    }
    return behind.get(el);
  };
  const found = new Map();
  const isText = (node) => node.nodeType === Node.TEXT_NODE && node.data.trim();
  for (const el of document.querySelectorAll(`${where}, ${where} *`)) {
    if (![...el.childNodes].some(isText)) continue;
    if (!el.checkVisibility({ visibilityProperty: true })) continue;
    const style = getComputedStyle(el);
    const own = ["color", "fill", "fontSize", "fontWeight", "textDecorationLine", "textShadow"];
    const around = el.parentElement && getComputedStyle(el.parentElement).color;
    const look = [ground(el), around, ...own.map((name) => style[name])].join(" ");
    if (!found.has(look)) found.set(look, el);
  }
  window.looks = [...found.values()];
  return [...found.keys()];
}
"""

# What other rules can see of each element; `changed`: what is seen and was not so before.
LOOK = """
(where) => {
  const before = window.looked ?? new Map();
  window.looked = new Map();
  window.changed = [];
  for (const el of document.querySelectorAll(`${where} *`)) {
    const { x, y, width, height } = el.getBoundingClientRect();
    const told = [el.checkVisibility({ visibilityProperty: true }), x, y, width, height];
    for (const { name, value } of el.attributes) told.push(name, value);
    const seen = told.join(" ");
    window.looked.set(el, seen);
    if (told[0] && before.get(el) !== seen) window.changed.push(el);
  }
}
"""


FRESH = "(places) => { window.looks = places.map((k) => window.looks[k]); }"
ASKED: set[tuple[str, str]] = set()
"""Colour schemes and looks that axe has been asked about, on this page or another."""


def unfold(page) -> None:
    """Open everything that a reader can unfold, and have axe in the page."""
    page.evaluate(OPEN_ALL)
    chromium.settle(page)
    if not page.evaluate("Boolean(window.axe)"):
        page.evaluate(f"(() => {{ {AXE} }})()")


def violations(page) -> list[str]:
    """What axe finds, with everything unfolded that a reader can unfold."""
    unfold(page)
    return page.evaluate(RUN, [["html"], [], False])


def violations_in(page, *schemes: str, where: str = "html") -> list[str]:
    """What axe finds in each colour scheme, on a page or in a part of it.

    The rules on colours are asked in each of them about each look that no page had before, the
    others in the first about everything, and then about what has changed.
    """
    found = []
    for k, scheme in enumerate(schemes):
        chromium.coloured(page, scheme)
        unfold(page)
        page.evaluate(LOOK, where)
        looks = [(scheme, look) for look in page.evaluate(LOOKS, where)]
        page.evaluate(FRESH, [place for place, look in enumerate(looks) if look not in ASKED])
        ASKED.update(looks)
        everything = "what changed" if k else [where]
        for asked in ([everything, COLOURS, False], ["each look", COLOURS, True]):
            found += [f"{scheme}: {fault}" for fault in page.evaluate(RUN, asked)]
    return found
