"""What axe-core finds on an open page."""

from __future__ import annotations

from importlib.resources import files

import chromium

AXE = (files("axe_playwright_python") / "axe.min.js").read_text(encoding="utf-8")

# Rules of levels A, AA and AAA, best practices and experimental ones: none is left out.
RUN = """
async () => {
  const rules = axe.getRules().map((rule) => rule.ruleId);
  const runOnly = { type: "rule", values: rules };
  const { violations } = await axe.run(document, { runOnly, resultTypes: ["violations"] });
  return violations.flatMap(({ id, impact, nodes }) =>
    nodes.map(({ target, failureSummary }) =>
      `${id} (${impact}) at ${target.join(" ")}: ${failureSummary.split("\\n")[1].trim()}`));
}
"""
OPEN_ALL = "document.querySelectorAll('details').forEach((el) => { el.open = true; })"


def violations(page) -> list[str]:
    """What axe finds, with everything unfolded that a reader can unfold."""
    page.evaluate(OPEN_ALL)
    chromium.settle(page)
    page.evaluate(AXE)
    return page.evaluate(RUN)
