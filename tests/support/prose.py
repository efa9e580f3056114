"""The book's prose, sentence by sentence, and the numbers in it that nobody computed."""

from __future__ import annotations

import ast
import json
import re
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import NamedTuple

from ddlib import paper
from ddlib.setups import WINDOWS
from workshop.report import results
from workshop.report.evidence import claims
from workshop.report.studies.windows import _SIZES

# Words near which a number may be a result.
RESULT_WORDS = re.compile(
    r"\b(?:errors?|RMSS|torques?|times|per ?cent|factors?|medians?|correlations?|roughness|"
    r"shares?|ratios?|residuals?|deviations?|weights?|verdicts?|faster|slower|noise|gap|"
    r"overshoots?|settles?|falls?|rises?|drops?|costs?|reach(?:es)?|accuracy|accurate|"
    r"better|worse|R²)\b|%|‰|\bdB\b|\bN m\b|°",
    re.IGNORECASE,
)

# A number that is not part of a name, an exponent or an index.
NUMBER = re.compile(r"(?<![\w.,^_\\-])[-−±]?\d+(?:,\d{3})*(?:\.\d+)?(?:e-?\d+)?")

# Fences, directives and displayed equations.
BLOCKS = [
    re.compile(pattern, re.MULTILINE | re.DOTALL)
    for pattern in (r"^(`{3,}|:{3,}).*?^\1`*", r"^\$\$.*?^\$\$.*?$")
]

# What is computed, quoted or no sentence.
NO_PROSE = [
    re.compile(pattern, re.MULTILINE)
    for pattern in (
        r"\$[^$]+\$",  # mathematics
        r"\{[\w:.-]+\}`[^`]*`",  # roles: glue, cite, doc, numref, eq
        r"`[^`]*`",  # code
        r"<[^>\s][^>]*>",  # HTML and addresses
        r"\]\([^)]*\)",  # where links lead
        r"[“\"][^”\"]*[”\"]",  # quotations
        r"^#+ .*$",  # headings
        r"^\(.*\)=$",  # labels
        r"^\s*(?:\d+\.|\*\*\d+\.)\s",  # numbers of items
    )
]

NAMES = re.compile(
    r"\b(?:Figures?|Fig\.|Tables?|sections?|chapters?|Appendix|pages?|pp\.|exercises?|joints?|"
    r"axis|axes|links?|trajector(?:y|ies)|runs?|unit|degree|order|Python|set)"
    r"\s+\d[\d.-]*\w?\b(?:\s*(?:,|and|to|or|–)\s*\d[\d.-]*\b(?!\s?(?:%|N m|°|times)))*"
    r"|\bCMU-\w+-\d+-\d+|\b1[89]\d\d\b|\b20\d\d\b",
    re.IGNORECASE,
)
"""A number that only names something: a figure, a joint, a year."""


@cache
def _settings() -> re.Pattern:
    """Settings of experiments, taken from the code; 0 and 1 as points of reference."""
    known = {*WINDOWS, *_SIZES, paper.HIDDEN_UNITS, paper.SAMPLES_PER_TRAJECTORY, paper.EPOCHS}
    known |= {row["units"] for row in results.read("hidden-units")["rows"]}
    known |= {results.read(n)["members"] for n in ("table-4-1", "clean", "hidden-units")}
    known |= {results.read("longer")["epochs"], 298, 1500}
    one = "(?:" + "|".join(f"{n:,}" for n in sorted(known, reverse=True)) + ")"
    several = rf"{one}(?:(?:,? (?:and|or|to) |, | · ){one})*(?![\d.]?\d|,\d)"
    amount = r"(?!\s?(?:%|N m|°|dB|times|per cent|of the))"
    counted = (
        r"epochs?|networks?|units?|cases|samples|joints?|readings?|states|filters|points|members"
    )
    return re.compile(
        rf"\b(?:windows?|sizes?|widths?)(?: sizes?)?(?: of| at| is| are)? {several}{amount}"
        rf"|\b[Aa]t {several}{amount}"
        rf"|(?<![\d.,]){several} (?:other |random |hidden |trained )*(?:{counted})\b"
        rf"|\bepochs? {several}"
        r"|(?<![\d.,])(?:10|2|1\.2) ms\b|\b16[ -]bits?\b|\b95 % (?:confidence )?intervals?\b"
        r"|(?<![\d.,])(?:0|45)°"
        rf"|(?<![\d.,])[-−±]?[01]\b(?![.,:]\d){amount}"
    )


@cache
def printed_numbers() -> frozenset[float]:
    """What the paper prints: the values of `ddlib.paper` and of the claims."""
    found = set()
    values = [getattr(paper, name) for name in dir(paper) if name.isupper()]
    values += [claim.printed for claim in claims.load()]
    while values:
        value = values.pop()
        if isinstance(value, Mapping):
            values += value.values()
        elif isinstance(value, (tuple, list)):
            values += value
        elif isinstance(value, str):
            found |= {as_number(n) for n in NUMBER.findall(value)}
        else:
            found.add(float(value))
    return frozenset(found)


def as_number(text: str) -> float:
    """The value of a number as `NUMBER` finds it."""
    return float(text.replace(",", "").replace("−", "-").lstrip("±"))


class Sentence(NamedTuple):
    """A sentence of a page: as it is written, and without code, mathematics and quotations."""

    page: str
    text: str
    bare: str


def paragraphs(path: Path) -> Iterator[str]:
    """Prose of a page: Markdown, words of figures, and long plain strings in code."""
    if path.suffix == ".md":
        texts = [path.read_text(encoding="utf-8")]
    else:
        texts = []
        for cell in json.loads(path.read_text(encoding="utf-8"))["cells"]:
            source = "".join(cell["source"])
            if cell["cell_type"] == "markdown":
                texts.append(source)
            else:
                figure = cell["metadata"].get("mystnb", {}).get("figure", {})
                texts += figure.get("caption"), figure.get("alt")
                texts += strings(source)
    for text in filter(None, texts):
        for pattern in BLOCKS:
            text = pattern.sub("\n\n", text)
        yield from re.split(r"\n\s*\n", text)


def strings(source: str) -> list[str]:
    """Strings of a code cell that are sentences, such as alternative texts; values left out."""
    tree = ast.parse(source)
    joined = [node for node in ast.walk(tree) if isinstance(node, ast.JoinedStr)]
    inside = {id(part) for node in joined for value in node.values for part in ast.walk(value)}
    found = [
        "".join(x.value if isinstance(x, ast.Constant) else "{…}" for x in node.values)
        for node in joined
    ]
    found += [
        node.value
        for node in ast.walk(tree)
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in inside
    ]
    return [text for text in found if len(text.split()) > 5 and not _is_code(text)]


def _is_code(text: str) -> bool:
    """Whether a string is a program that readers can copy."""
    try:
        ast.parse(text.replace("{…}", "x"))
    except SyntaxError:
        return False
    return True


def sentences(path: Path) -> Iterator[Sentence]:
    """The sentences of a page; what an exercise asks for and rows of tables are left out."""
    for block in paragraphs(path):
        if re.match(r"\s*(\*\*\d+\.|\|)", block):
            continue
        for text in re.split(r"(?<=[.!?:;])\s+(?=[A-Z\"“*{$(\[])|\n(?=[-*] )", block):
            yield sentence(text, path.stem)


def sentence(text: str, page: str = "page") -> Sentence:
    """A sentence from its text."""
    bare = text
    for pattern in NO_PROSE:
        bare = pattern.sub(" ", bare)
    return Sentence(page, " ".join(text.split()), " ".join(bare.split()))


def typed_numbers(one: Sentence, allowed=()) -> list[str]:
    """Numbers that were typed in a sentence about results, and are neither names nor settings.

    Numbers in the `allowed` pieces of text are no results.
    """
    if not RESULT_WORDS.search(one.bare):
        return []
    bare = one.bare
    for piece in allowed:
        bare = re.sub(rf"(?<![\w.,]){re.escape(piece)}", " ", bare)
    left = NUMBER.findall(_settings().sub(" ", NAMES.sub(" ", bare)))
    if re.search(r"\b(?:paper|print(?:s|ed)?|report)\b", one.bare):
        left = [n for n in left if as_number(n) not in printed_numbers()]
    return left
