"""The public face: what needs to know where the book lies, all from one address.

The address is the repository's on GitHub: `GITHUB_REPOSITORY`, as its actions set it, or the
remote `origin`. From it come buttons (report a mistake, suggest an edit, Colab), cards for whoever
shares a page, and a map of the site. Without an address there is none of them, and nothing else
differs. The site's own address is GitHub's for such a repository, or `DDLIB_SITE`.
"""

from __future__ import annotations

import os
import re
import subprocess
from functools import cache
from pathlib import Path
from urllib.parse import quote
from xml.sax.saxutils import escape

from lessons import lesson

HOST = "https://github.com"
REMOTE = re.compile(r"(?:https://github\.com/|(?:ssh://)?git@github\.com[:/])(.+?)(?:\.git)?/?")
NAME = re.compile(r"[\w.-]+/[\w.-]+")
HANDED_OUT = "notebooks"  # branch that `publish.yml` fills with the readers' notebooks
COLAB = "https://colab.research.google.com/github"
ROOT = Path(__file__).parents[2]


@cache
def repository(root: Path = ROOT) -> str:
    """The repository on GitHub as "owner/name", or nothing."""
    named = os.environ.get("GITHUB_REPOSITORY", "")
    if not named:
        asked = ["git", "-C", str(root), "config", "--get", "remote.origin.url"]
        try:
            remote = subprocess.run(asked, capture_output=True, text=True, check=False).stdout
        except OSError:  # no git here
            remote = ""
        named = found[1] if (found := REMOTE.fullmatch(remote.strip())) else ""
    return named if NAME.fullmatch(named) else ""


def address(name: str) -> str:
    """Where a repository can be cloned from; nothing of none."""
    return f"{HOST}/{name}" if name else ""


def site(name: str) -> str:
    """Where the pages of a repository are, with a slash at the end."""
    owner, _, project = name.partition("/")
    own = f"https://{owner.lower()}.github.io/"
    usual = own if project.lower() == f"{owner.lower()}.github.io" else f"{own}{project}/"
    return os.environ.get("DDLIB_SITE", usual).rstrip("/") + "/"


def links(name: str, page: str, source: str, notebook: str = "") -> list[tuple[str, str, str]]:
    """Icon, text and address of a page's buttons; Colab's only for a notebook that it opens."""
    about = quote(f"A mistake on the page {page}")
    asked = quote("What does the page say, and what should it say?\n\n\nWhere (heading, figure):\n")
    issue = f"{address(name)}/issues/new?title={about}&body={asked}"
    found = [
        ("fas fa-flag", "Report a mistake", issue),
        ("fas fa-pencil-alt", "Suggest an edit", f"{address(name)}/edit/main/{source}"),
    ]
    if notebook:
        to = f"{COLAB}/{name}/blob/{HANDED_OUT}/{notebook}"
        found.append(("fas fa-play", "Run in Colab", to))
    return found


def offer(app, page, template, context, doctree):
    """The buttons, beside those of the theme."""
    handed_out = context.get("sourcename", "")
    if doctree is None or "header_buttons" not in context or not handed_out:
        return
    has_notebook = lesson(Path(app.srcdir), page) is not None and page != app.config.root_doc
    notebook = handed_out.removeprefix("book/") if has_notebook else ""
    source = Path(app.env.doc2path(page)).relative_to(app.srcdir).as_posix()
    buttons = [
        {"type": "link", "url": url, "text": text, "icon": icon, "tooltip": text,
         "label": f"{text.lower().replace(' ', '-')}-button"}
        for icon, text, url in links(repository(), page, source, notebook)
    ]  # fmt: skip
    context["header_buttons"].append(
        {"type": "group", "tooltip": "Report, edit, run elsewhere", "icon": "fas fa-comment-dots",
         "buttons": buttons, "label": "public-buttons"}
    )  # fmt: skip


def map_of(pages, at: str) -> str:
    """A sitemap of pages of the site."""
    urls = "\n".join(f"  <url><loc>{escape(at + page)}.html</loc></url>" for page in sorted(pages))
    space = "http://www.sitemaps.org/schemas/sitemap/0.9"
    return f'<?xml version="1.0" encoding="utf-8"?>\n<urlset xmlns="{space}">\n{urls}\n</urlset>\n'


def write_map(app, exception):
    if exception is None and app.builder.format == "html":
        text = map_of(app.env.found_docs, app.config.html_baseurl)
        Path(app.outdir, "sitemap.xml").write_text(text, encoding="utf-8")


def configure(app, config):
    config.html_baseurl = config.ogp_site_url = site(repository())
    config.ogp_site_name = config.project = config.html_title or config.project
    logo = "book/_static/logo.png"  # matplotlib draws the cards and reads no SVG
    config.ogp_social_cards = {"line_color": "#2f7fb8", "image": logo, "image_mini": logo,
                               "font": "DejaVu Sans"}  # fmt: skip


def setup(app):
    if repository():
        app.setup_extension("sphinxext.opengraph")
        app.connect("config-inited", configure, priority=100)
        app.connect("html-page-context", offer, priority=503)
        app.connect("build-finished", write_map)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
