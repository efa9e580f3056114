"""What axe-core finds on an open page."""

from __future__ import annotations

from importlib.resources import files

import chromium

# axe keeps the private fields of each colour in weak maps, and half of its time goes into them.
# Maps that keep a value on its object do the same.
KEPT = """
class Kept {
  key = Symbol();
  has(object) { return Object(object) === object && Object.hasOwn(object, this.key); }
  get(object) { return this.has(object) ? object[this.key] : undefined; }
  set(object, value) { object[this.key] = value; return this; }
  add(object) { return this.set(object, true); }
  delete(object) { return this.has(object) && delete object[this.key]; }
}
"""
# The same few colours are read thousands of times.
READ_ONCE = """
const { prototype } = axe.commons.color.Color;
const [parse, known] = [prototype.parseString, new Map()];
prototype.parseString = function (text) {
  if (!known.has(text)) {
    parse.call(this, text);
    known.set(text, [this.r, this.g, this.b, this.alpha]);
  }
  [this.r, this.g, this.b, this.alpha] = known.get(text);
  return this;
};
"""
PLAIN = (files("axe_playwright_python") / "axe.min.js").read_text(encoding="utf-8")
OWN_MAPS = f"(function (WeakMap, WeakSet) {{ {PLAIN} }}).call(window, Kept, Kept);"
AXE = f"(() => {{ {KEPT} {OWN_MAPS} {READ_ONCE} }})()"

# Rules of levels A, AA and AAA, best practices and experimental ones: none is left out.
RUN = """
async ([where, only]) => {
  const rules = only ?? axe.getRules().map((rule) => rule.ruleId);
  const runOnly = { type: "rule", values: rules };
  const include = where === "changed" ? window.changed : [document.querySelector(where)];
  if (!include.length) return [];
  const { violations } = await axe.run({ include }, { runOnly, resultTypes: ["violations"] });
  return violations.flatMap(({ id, impact, nodes }) =>
    nodes.map(({ target, failureSummary }) =>
      `${id} (${impact}) at ${target.join(" ")}: ${failureSummary.split("\\n")[1].trim()}`));
}
"""
OPEN_ALL = "document.querySelectorAll('details').forEach((el) => { el.open = true; })"

COLOURS = ["color-contrast", "color-contrast-enhanced", "link-in-text-block"]
"""Rules whose answer hangs on colours."""

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


def unfold(page) -> None:
    """Open everything that a reader can unfold, and have axe in the page."""
    page.evaluate(OPEN_ALL)
    chromium.settle(page)
    if not page.evaluate("Boolean(window.axe)"):
        page.evaluate(AXE)


def violations(page) -> list[str]:
    """What axe finds, with everything unfolded that a reader can unfold."""
    unfold(page)
    return page.evaluate(RUN, ["html", None])


def violations_in(page, *schemes: str, where: str = "html") -> list[str]:
    """What axe finds in each colour scheme, on a page or in a part of it.

    The rules on colours are asked in each of them about everything, the others in the first, and
    then about what has changed.
    """
    found = []
    for k, scheme in enumerate(schemes):
        chromium.coloured(page, scheme)
        unfold(page)
        page.evaluate(LOOK, where)
        some = [[where, COLOURS], ["changed", None]] if k else [[where, None]]
        found += [f"{scheme}: {fault}" for asked in some for fault in page.evaluate(RUN, asked)]
    return found
