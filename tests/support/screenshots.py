"""Full-page pictures of the built book, for looking at it.

    python tests/support/screenshots.py OUTDIR [PAGE ...]

A page is a name such as `dynamics`; without any, all pages are taken. Each is taken light,
dark and narrow, tall ones in pieces of at most 2400 px.
"""

from __future__ import annotations

import sys
from pathlib import Path

import chromium
from book_pages import PAGES

VARIANTS = {"light": ("light", 1280), "dark": ("dark", 1280), "narrow": ("light", 400)}
PIECE = 2400  # px


def take(browser, url: str, stem: Path, scheme: str, width: int) -> None:
    context = browser.new_context(color_scheme=scheme, viewport={"width": width, "height": 900})
    page = context.new_page()
    page.goto(url)
    chromium.settle(page)
    height = page.evaluate("document.documentElement.scrollHeight")
    for number, top in enumerate(range(0, height, PIECE)):
        clip = {"x": 0, "y": top, "width": width, "height": min(PIECE, height - top)}
        page.screenshot(path=f"{stem}-{number}.png", full_page=True, clip=clip)
    context.close()


def main(outdir: str, *wanted: str) -> None:
    out = Path(outdir)
    out.mkdir(parents=True, exist_ok=True)
    names = {Path(page).name: page for page in PAGES}
    unknown = set(wanted) - set(names)
    if unknown:
        sys.exit(f"no such page: {', '.join(sorted(unknown))}; there are {', '.join(names)}")
    with chromium.serve(chromium.HTML) as site, chromium.launch() as browser:
        for name in wanted or names:
            for variant, (scheme, width) in VARIANTS.items():
                url = f"{site}/{names[name]}.html"
                take(browser, url, out / f"{name}-{variant}", scheme, width)
            print(f"{out}/{name}-*.png", flush=True)


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    main(*sys.argv[1:])
