"""What programs, assistants and citers read: claims as data, lessons as plain text.

- ``claims.json``: each claim with what is printed, what is found, its verdict and its address
- ``llms.txt``: what the book is and where its texts are (the format of llmstxt.org)
- ``text/NAME.md``: a page as Markdown with its open code, the numbers of the book in it
"""

from __future__ import annotations

import json
import re
from pathlib import Path

import nbformat
import yaml
from dd_lessons import chapters
from dd_reader import NOTE

CLAIMS, TEXTS, MAP = "claims.json", "text", "llms.txt"
CITED, LEDGER = "CITATION.cff", "book/ledger.ipynb"
NUMBER = re.compile(r"<abbr title=\"the book's number\">(.*?)</abbr>")
SAID = """# {title}

> {about}

Each lesson asks one question, shows code that runs, and ends with what was found. Its evidence page
holds the proofs. Every sentence of the report that was tested is in `{claims}`, with what is
printed, what this book finds, the verdict, and what would have refuted it. Numbers in the texts are
from the run that made these pages.

## Start

- [Claims]({claims}): all verdicts as JSON
- [The first page]({texts}/index.md): the question, and the arm to throw
"""


def claims(root: Path) -> dict:
    """Every claim with its numbers and its address below the first page of the site."""
    from workshop.report.code_hash import code_hash, places
    from workshop.report.evidence.claims import load

    kept = json.loads((root / "book" / "results" / "verdicts.json").read_text(encoding="utf-8"))
    cited = yaml.safe_load((root / CITED).read_text(encoding="utf-8"))
    found = []
    for claim in load():
        entry = kept["claims"].get(claim.id, "")
        value, *spread = map(float, entry.partition(": ")[2].split()) if entry else (None,)
        found.append(
            {
                "id": claim.id,
                "where": claim.where,
                "claim": claim.claim,
                "printed": claim.as_printed(),
                "ours": value,
                "middle 95 % of draws": spread[1:] or None,
                "verdict": claim.verdict,
                "band": dict(claim.band) or None,
                "why": claim.why,
                "refuted by": claim.refuted,
                "judged on": claim.arm or "simulated arms",
                "page": page(root, claim.chapter),
                "address": f"book/ledger.html#claim-{claim.id}",
            }
        )
    return {
        "title": cited["title"],
        "version": str(cited["version"]),
        "license": cited["license"],
        "digest of the results": kept["of results"],
        "code that made each result": {name: code_hash(name) for name in sorted(places())},
        "claims": found,
    }


def page(root: Path, chapter: str) -> str:
    """Address of a chapter, or of an evidence page of its own."""
    lesson = (root / "book" / f"{chapter}.ipynb").is_file()
    return f"book/{chapter}.html" if lesson else f"book/evidence/{chapter}.html"


def plain(notebook) -> str:
    """A reader's notebook as Markdown: its words, and the code that stands open."""
    texts = []
    for cell in notebook.cells:
        source = cell.source.strip()
        if cell.cell_type == "markdown":
            told = NUMBER.sub(r"\1", source).replace(".ipynb", ".md")
            texts += [told] if source not in ("", NOTE) else []
        elif source and not cell.metadata.get("jupyter", {}).get("source_hidden"):
            texts.append(f"```python\n{source}\n```")
    return "\n\n".join(texts) + "\n"


def opening(text: str) -> tuple[str, str]:
    """Title of a text, and its first sentences below."""
    title = re.search(r"(?m)^# (.+)$", text)[1]
    below = text.partition(title)[2]
    paragraphs = (p.strip() for p in re.split(r"\n\s*\n", below))
    first = next((p for p in paragraphs if re.match(r"[\w*\"“(]", p)), "")
    return title, re.sub(r"\s+", " ", re.sub(r"<[^>]+>|\[([^]]*)\]\([^)]*\)|[*`]", r"\1", first))


def parts(root: Path) -> list[tuple[str, list[str]]]:
    """Captions of the table of contents, and the pages below each, in its order."""
    toc = yaml.safe_load((root / "_toc.yml").read_text(encoding="utf-8"))

    def under(entry: dict) -> list[str]:
        inner = entry.get("sections", []) + entry.get("chapters", [])
        own = [entry["file"]] if "file" in entry else []
        return own + [page for one in inner for page in under(one)]

    return [(part["caption"], under(part)) for part in toc["parts"]]


def write(app, exception):
    """Once the readers' notebooks are there; of the whole book alone."""
    root, out = Path(app.srcdir), Path(app.outdir)
    whole = all((root / name).is_file() for name in (CITED, LEDGER))
    if exception is not None or app.builder.format != "html" or not whole:
        return
    told = json.dumps(claims(root), indent=1, ensure_ascii=False)
    (out / CLAIMS).write_text(told + "\n", encoding="utf-8")
    texts = {}
    for path in (root / "book" / "index.ipynb", *chapters(root)):
        name = path.relative_to(root).with_suffix("")
        made = out / "_sources" / name.with_suffix(".ipynb")
        target = out / TEXTS / name.relative_to("book").with_suffix(".md")
        target.parent.mkdir(parents=True, exist_ok=True)
        text = plain(nbformat.read(made, as_version=4))
        target.write_text(text, encoding="utf-8")
        texts[name.as_posix()] = opening(text), target.relative_to(out).as_posix()
    cited = yaml.safe_load((root / CITED).read_text(encoding="utf-8"))
    about = re.sub(r"\s+", " ", cited["abstract"]).strip()
    told = SAID.format(title=cited["title"], about=about, claims=CLAIMS, texts=TEXTS)
    for caption, pages in parts(root):
        lines = [
            f"- [{title}]({at}): {first}"
            for (title, first), at in (texts[name] for name in pages if name in texts)
        ]
        told += f"\n## {caption}\n\n" + "\n".join(lines) + "\n" if lines else ""
    (out / MAP).write_text(told, encoding="utf-8")


def setup(app):
    app.connect("build-finished", write, priority=600)  # after dd_reader's
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
