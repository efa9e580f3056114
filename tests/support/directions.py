"""Words of direction, order and size in sentences about what was trained.

A network comes out otherwise on another machine, so such a word stands for a check: a value
chosen at run time (``quote("x-direction", "rises" if ... else "falls")``, seen as ``{glue:text}``
or as ``{...}`` of an f-string), or a `ddlib.evidence.statements.stated` in the page to which
``bound_words.yml`` ties the piece of the sentence. ``python tests/support/directions.py PAGE``
lists what is left.
"""

from __future__ import annotations

import ast
import json
import re
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path

import yaml
from book_pages import TOC, source
from prose import Sentence, sentence, sentences

WORDS = re.compile(
    r"\b(?:"
    # a direction
    r"ris(?:es?|ing)|rose|f(?:alls?|ell|alling)|drop(?:s|ped)?|gr(?:ows?|ew|own|owing)"
    r"|shrinks?|shr[au]nk|increas(?:es?|ed|ing)|decreas(?:es?|ed|ing)|lower(?:s|ed)?"
    r"|rais(?:es?|ed)|sinks?|climbs?|bends?|settles?|settled|loses?"
    # a comparison
    r"|larger|bigger|greater|smaller|higher|better|worse|more|less|fewer|faster|slower"
    r"|closer|nearer|further|steeper|flatter|heavier|lighter|earlier|later|longer|shorter"
    r"|smoother|rougher|stronger|weaker|easier|harder|calmer|sharper|above|below|beyond"
    r"|largest|biggest|greatest|smallest|highest|lowest|best|worst|nearest|closest"
    r"|(?<!\bat )most|(?<!\bat )least(?! squares|-squares)"
    r"|steepest|strongest|weakest|fastest|slowest|smoothest|roughest|hardest|easiest"
    # a size
    r"|twice|doubles?|doubled|half(?! a minute)|halves|thirds|a third of|quarters?|fifths?|tenths?"
    r"|several times"
    r"|nearly|almost|alike|hardly|barely|similar|equally|the same|close to|far from"
    r"|as (?:bad|good|well|large|small) as"
    r"|\w+(?<!mani)fold"
    # a count
    r"|all|none|every|both|neither|majority|never|always"
    r"|(?:two|three|four|five|six|seven|eight|nine|ten) of"
    # an order
    r"|first\b[^.]*\bthen"
    r")\b",
    re.IGNORECASE,
)
"""Words that say which way, how much or in which order."""

ON_NETWORKS = r"networks?|train(?:ed|ing)|descent|learn(?:s|t|ed)|epochs?|hidden units?"
TRAINED = re.compile(
    rf"\b(?:{ON_NETWORKS}|errors?|RMSS|weights?|filters?|units?|ensembles?|medians?"
    r"|roughness|solver|dots?|generali[sz]\w+)\b",
    re.IGNORECASE,
)
"""Words near which a chapter on networks speaks of what was trained."""

NETWORKS = re.compile(rf"\b(?:{ON_NETWORKS})\b", re.IGNORECASE)
"""Where the rest is deterministic: simulated arms, equations, tables of the paper."""

LEARNING = {
    chapter["file"]
    for part in TOC["parts"][1:]
    if part.get("numbered")
    for chapter in part["chapters"]
} | {TOC["root"]}
"""Pages on trained networks; in the others only sentences that name networks are read."""

REASONS = {
    "mathematics": "follows from definitions, on any machine",
    "definition": "names or measures something; nothing is claimed",
    "setting": "what was set up, not what came of it",
    "printed": "what the paper says or prints",
    "literature": "what someone else found",
    "simulation": "of the simulated arm, no network involved",
    "conjecture": "says of itself that it is not known",
    "question": "asks, or tells the reader what to do",
}
HEDGED = re.compile(r"\b(?:if|may|might|could|would|perhaps|likely|seems?|open)\b", re.IGNORECASE)

BOUND = Path(__file__).with_name("bound_words.yml")


def pieces(entries: Iterable[dict]) -> list[str]:
    """The pieces of text of a page's entries, without code, mathematics and quotations."""
    return [sentence(entry["text"]).bare for entry in entries]


def subject(page: str) -> re.Pattern:
    """What marks a sentence of a page as one about trained outcomes."""
    return TRAINED if page in LEARNING else NETWORKS


def loose(read: Iterable[Sentence], bound: Iterable[str] = (), about=TRAINED) -> Iterator[tuple]:
    """Sentences with words of direction that nothing stands behind, and the words.

    Parameters
    ----------
    read : iterable of Sentence
        In the order of the page: a sentence also speaks of what the one before spoke of.
    bound : iterable of str
        Pieces whose words are bound.
    about : Pattern
        What marks a sentence as one about trained outcomes.
    """
    before = ""
    for one in read:
        named, before = about.search(f"{before} {one.bare}"), one.bare
        if not named or one.bare.endswith("?"):
            continue
        left = one.bare
        for piece in sorted(bound, key=len, reverse=True):
            left = left.replace(piece, " … ")
        if found := WORDS.findall(left):
            yield one, found


def checks(path: Path) -> list[str]:
    """Names of the `stated` calls of a notebook, constants that check nothing left out."""
    if path.suffix != ".ipynb":
        return []
    found = []
    for cell in json.loads(path.read_text(encoding="utf-8"))["cells"]:
        if cell["cell_type"] == "code":
            for node in ast.walk(ast.parse("".join(cell["source"]))):
                if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "stated":
                    name, holds = node.args[:2]
                    if isinstance(name, ast.Constant) and not isinstance(holds, ast.Constant):
                        found.append(name.value)
    return found


def main(name: str) -> None:
    """Print the sentences of a page that are not bound, with their words."""
    entries = (yaml.safe_load(BOUND.read_text(encoding="utf-8")) or {}).get(name, [])
    page = f"book/{name}"
    for one, words in loose(sentences(source(page)), pieces(entries), subject(page)):
        print(f"{', '.join(words)}\n    {one.text}")


if __name__ == "__main__":
    main(sys.argv[1])
