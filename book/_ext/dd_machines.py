"""What programs, assistants and citers read: claims as data, lessons as plain text.

- ``claims.json``: each claim with what the report prints, what the book finds, the verdict, and the
  address of the ledger's entry
- ``llms.txt``: what the book is and where its texts are (the format of llmstxt.org)
- ``text/NAME.md``: a page as Markdown, with the code that is not folded and the book's numbers
"""

from __future__ import annotations

import json
import re
from pathlib import Path

import nbformat
import yaml
from dd_reader import MARK, NOTE
from lessons import chapters, handed_out, parts, with_below

# What is written, below the root of the site
CLAIMS, TEXTS, MAP = "claims.json", "text", "llms.txt"

# Files of the clone that only the whole book has
CITED, LEDGER = "CITATION.cff", "book/ledger.ipynb"

# How `MAP` begins
SAID = """# {title}

> {about}

Each lesson asks one question, shows code that runs, and ends with what was found. Its evidence page
holds the proofs. Every sentence of the report that was tested is in `{claims}`, with what is
printed, what this book finds, the verdict, and what would have refuted it. Numbers in the texts are
from the run that made these pages.

## Start

- [Claims]({claims}): all verdicts as JSON
- [The first page]({texts}/00-index.md): two rows of weights, and an arm to throw
"""


def claims(root: Path) -> dict:
    """What `CLAIMS` holds: every claim with its numbers and its address, and what made them.

    Addresses are relative to the root of the site.
    """
    import ddlib
    from workshop.report.code_hash import code_hash, places
    from workshop.report.evidence.claims import load

    kept = json.loads((root / "book" / "results" / "verdicts.json").read_text(encoding="utf-8"))
    cited = yaml.safe_load((root / CITED).read_text(encoding="utf-8"))
    entries = []
    for claim in load():
        # Like "reproduced: 0.935 0.93035 0.895 0.96": the verdict and the value; where it has
        # replicates, their mean and the ends of their middle 95 %
        entry = kept["claims"].get(claim.id, "")
        value, *of_draws = map(float, entry.partition(": ")[2].split()) if entry else (None,)
        entries.append(
            {
                "id": claim.id,
                "where": claim.where,
                "claim": claim.claim,
                "printed": claim.as_printed(),
                "ours": value,
                "middle 95 % of draws": of_draws[1:] or None,
                "verdict": claim.verdict,
                "band": dict(claim.band) or None,
                "why": claim.why,
                "refuted by": claim.outcome,
                "judged on": claim.arm or "simulated arms",
                "page": page(root, claim.chapter),
                "address": f"book/ledger.html#claim-{claim.id}",
            }
        )
    return {
        "title": cited["title"],
        "version": ddlib.__version__,
        "license": cited["license"],
        "digest of the results": kept["of results"],
        "code that made each result": {name: code_hash(name) for name in sorted(places())},
        "claims": entries,
    }


def page(root: Path, chapter: str) -> str:
    """Address of a chapter: a lesson, or else an evidence page without one."""
    is_lesson = (root / "book" / f"{chapter}.ipynb").is_file()
    return f"book/{chapter}.html" if is_lesson else f"book/evidence/{chapter}.html"


def plain(notebook) -> str:
    """A reader's notebook as Markdown: its words, and the code that stands open."""
    texts = []
    for cell in notebook.cells:
        source = cell.source.strip()
        if cell.cell_type == "markdown":
            words = source.replace(MARK[0], "").replace(MARK[1], "")
            words = words.replace(".ipynb", ".md")  # links lead to texts
            texts += [words] if source not in ("", NOTE) else []
        elif source and not cell.metadata.get("jupyter", {}).get("source_hidden"):
            texts.append(f"```python\n{source}\n```")
    return "\n\n".join(texts) + "\n"


def opening(text: str) -> tuple[str, str]:
    """Title of a text, and its first paragraph of prose on one line, without markup."""
    title = re.search(r"(?m)^# (.+)$", text)[1]
    body = text.partition(title)[2]
    paragraphs = (paragraph.strip() for paragraph in re.split(r"\n\s*\n", body))
    # Prose begins with a word, emphasis, a quotation or a bracket; the rest is code, lists, quotes
    first = next((p for p in paragraphs if re.match(r"[\w*\"“(]", p)), "")
    return title, re.sub(r"\s+", " ", re.sub(r"<[^>]+>|\[([^]]*)\]\([^)]*\)|[*`]", r"\1", first))


def write(app, exception):
    """Write all three, from the readers' notebooks that `dd_reader` has put below ``_sources``.

    Only the build of the whole book has them, not that of a few pages.
    """
    root, out = Path(app.srcdir), Path(app.outdir)
    is_whole = all((root / name).is_file() for name in (CITED, LEDGER)) and not app.config.only_page
    if exception is not None or app.builder.format != "html" or not is_whole:
        return
    as_json = json.dumps(claims(root), indent=1, ensure_ascii=False)
    (out / CLAIMS).write_text(as_json + "\n", encoding="utf-8")
    texts = {}  # by page: title and first words, and the address of its text
    for path in (root / "book" / "index.ipynb", *chapters(root)):
        name = path.relative_to(root).with_suffix("")
        named = handed_out(app.env, name.as_posix())
        readers = out / "_sources" / f"{named}.ipynb"
        target = out / TEXTS / f"{named.removeprefix('book/')}.md"
        target.parent.mkdir(parents=True, exist_ok=True)
        text = plain(nbformat.read(readers, as_version=4))
        target.write_text(text, encoding="utf-8")
        texts[name.as_posix()] = opening(text), target.relative_to(out).as_posix()
    cited = yaml.safe_load((root / CITED).read_text(encoding="utf-8"))
    about = re.sub(r"\s+", " ", cited["abstract"]).strip()
    contents = SAID.format(title=cited["title"], about=about, claims=CLAIMS, texts=TEXTS)
    for part in parts(root):
        lines = [
            f"- [{title}]({address}): {first}"
            for (title, first), address in (
                texts[name] for name in with_below(root, part.files()) if name in texts
            )
        ]
        contents += f"\n## {part.caption}\n\n" + "\n".join(lines) + "\n" if lines else ""
    (out / MAP).write_text(contents, encoding="utf-8")


def setup(app):
    app.connect("build-finished", write, priority=600)  # after dd_reader, which has the default
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
