"""What holds in every notebook, and in every chapter: each rule returns what is against it."""

from __future__ import annotations

import re

from book_pages import WALK
from bookkeeping import lines_of_bookkeeping

MAX_VISIBLE_LINES, MAX_VISIBLE_COLUMNS = 25, 84  # one idea, and what a page has room for
MAX_NEEDS = 40  # words of the grey line
HIDDEN = {"hide-input", "hide-cell", "remove-input", "remove-cell"}
TUTORIAL = "book/use-it-on-your-arm"
FROM_SCRATCH = {TUTORIAL, *WALK}  # open cells run alone, so they import and print
OWN, READING = "Try it yourself", "Further reading"
FOUND = "What you found"  # before what a reader tries
CHANGE_THIS = "change-this"  # tag of the one cell whose settings all open cells follow
MOST_WORDS = 2500
MOST_HIDDEN, LEAST_OPEN = 12, 0.6  # hidden lines of a lesson, share of its lines that stand open


def tags(cell) -> set[str]:
    return set(cell.metadata.get("tags", []))


def code_of(notebook) -> list:
    return [cell for cell in notebook.cells if cell.cell_type == "code"]


def visible(notebook) -> list:
    """The code cells that stand open."""
    return [cell for cell in code_of(notebook) if not tags(cell) & HIDDEN]


def headings(text: str, level: int) -> list[str]:
    """Markdown headings of one level, without attributes in braces; code fences are skipped."""
    text = re.sub(r"^(`{3,}|:{3,}).*?^\1", "", text, flags=re.M | re.S)
    return re.findall(rf"^#{{{level}}} +(.*?) *(?:\{{.*\}})?$", text, flags=re.M)


def prose(notebook) -> str:
    return "\n\n".join(cell.source for cell in notebook.cells if cell.cell_type == "markdown")


def paragraphs(text: str) -> list[str]:
    return re.split(r"\n\s*\n", text.strip())


# --- every notebook -----------------------------------------------------------------------


def has_one_title(notebook) -> list:
    found = headings(prose(notebook), 1)
    first = notebook.cells[0]
    return [] if len(found) == 1 and headings(first.source, 1) == found else [found]


def visible_code_is_short(notebook) -> list:
    wrong = []
    for cell in visible(notebook):
        lines = [line for line in cell.source.splitlines() if line.strip()]
        if len(lines) > MAX_VISIBLE_LINES or max(map(len, lines)) > MAX_VISIBLE_COLUMNS:
            wrong.append(cell.id)
    return wrong


def visible_code_teaches(notebook) -> list:
    return [line for cell in visible(notebook) for line in lines_of_bookkeeping(cell.source)]


EVERYWHERE = (
    has_one_title,
    visible_code_is_short,
    visible_code_teaches,
)


# --- every chapter ------------------------------------------------------------------------


def closing(notebook) -> list:
    """What was found, then exercises, then further reading; a chapter may lack the last two."""
    found = headings(prose(notebook), 2)
    last = [name for name in (FOUND, OWN, READING) if name in found]
    return [] if FOUND in found and found[-len(last) :] == last else found


def exercises(notebook) -> list:
    """The cells after the heading *Try it yourself*, up to the next one and with it."""
    section, found = "", []
    for cell in notebook.cells:
        if section == OWN:
            found.append(cell)
        if cell.cell_type == "markdown":
            section = ([section, *headings(cell.source, 2)])[-1]
    return found


def open_answer(text: str) -> str:
    """What a markdown cell says before its next question or heading, outside a closed fold."""
    before = re.split(r"^(?=\*\*\d+\. |## )", text, maxsplit=1, flags=re.M)[0]
    return re.sub(r"^<details .*?^</details>$", "", before, flags=re.M | re.S).strip()


CHAPTER = (closing,)


# --- every lesson, and the tutorial -------------------------------------------------------


def before_the_needs(notebook) -> list:
    """The cells before the grey line, the one with the time to run."""
    needs = (k for k, cell in enumerate(notebook.cells) if "{runtime}`" in cell.source)
    return notebook.cells[: next(needs, 0)]


def title_and_thesis_stand_alone(notebook) -> list:
    """A title and one paragraph, then the thing itself; below it, what to do with it."""
    cells = before_the_needs(notebook)
    shown = (
        k for k, c in enumerate(cells) if c.cell_type == "code" and "remove-cell" not in tags(c)
    )
    above = [c.source for c in cells[: next(shown, None)] if c.cell_type == "markdown"]
    return [] if len(above) == 1 and len(paragraphs(above[0])) == 2 else above or ["no title"]


def one_grey_line_follows(notebook) -> list:
    """What a reader needs, and how long the page runs: one paragraph, nothing else."""
    line = notebook.cells[len(before_the_needs(notebook))].source
    fine = line.startswith("You need ") and len(paragraphs(line)) == 1
    return [] if fine and len(line.split()) <= MAX_NEEDS else [line]


LESSON = (
    title_and_thesis_stand_alone,
    one_grey_line_follows,
)


# --- every lesson in its whole shape, and the tutorial -------------------------------------


def source_lines(cells) -> int:
    return sum(bool(line.strip()) for cell in cells for line in cell.source.splitlines())


def is_starter(cell) -> bool:
    """Whether a cell waits for an answer to an exercise."""
    return cell.cell_type == "code" and re.search(r"^mine = \.\.\.", cell.source, re.M) is not None


def is_check(cell) -> bool:
    """Whether a cell judges an answer."""
    uses = re.search(r"\bmine\b", cell.source) is not None
    return cell.cell_type == "code" and uses and not is_starter(cell)


def words(notebook) -> int:
    """Words of the prose; a formula, a number or a link in the text is one, a display none."""
    text = re.sub(r"^\$\$.*?^\$\$.*?$", " ", prose(notebook), flags=re.M | re.S)
    text = re.sub(r"\$[^$]+\$|\{[\w:-]+\}`[^`]*`|`[^`]*`", "x", text)
    text = re.sub(r"<[^>]+>", " ", text)  # tags; by now no formula has a < in it
    return len(re.findall(r"[\w'’-]*\w", text))


def is_short(notebook) -> list:
    return [f"{words(notebook)} words"] if words(notebook) > MOST_WORDS else []


def one_cell_to_change_comes_first(notebook) -> list:
    cells = [cell for cell in notebook.cells if CHANGE_THIS in tags(cell)]
    first = visible(notebook)[:1] == cells and len(cells) == 1
    headed = "Change this" in headings(prose(notebook), 2)
    return [] if first and headed else [f"{len(cells)} cells to change, heading: {headed}"]


def code_stands_open(notebook) -> list:
    cells = [cell for cell in code_of(notebook) if "hide-cell" not in tags(cell)]
    hidden = source_lines(c for c in cells if tags(c) & HIDDEN and not is_check(c))
    shown = source_lines(visible(notebook))
    fine = hidden <= MOST_HIDDEN and shown >= LEAST_OPEN * (shown + hidden) and shown >= 25
    return [] if fine else [f"{shown} lines open, {hidden} hidden"]


def figures_are_made_in_the_open(notebook) -> list:
    """Below the first screen; what comes from a file says that it is the book's."""
    later = notebook.cells[len(before_the_needs(notebook)) :]
    hidden = [c for c in later if c.cell_type == "code" and tags(c) & HIDDEN]
    told = (c.metadata.get("mystnb", {}).get("figure", {}).get("caption") for c in hidden)
    return [text for text in told if text and "the book's" not in text.lower()]


def exercises_wait_for_an_answer(notebook) -> list:
    """A question, an empty starter, a check, a folded solution; a lesson may have no exercises.

    What a question shows stands open above its starter; each check imports what judges.
    """
    cells, shown = exercises(notebook), visible(notebook)
    kinds = [
        "starter" if is_starter(cell) else "check" if is_check(cell) else cell.id
        for cell in cells
        if cell.cell_type == "code" and (is_starter(cell) or cell not in shown)
    ]
    asked = len(re.findall(r"^\*\*\d+\. ", prose(notebook).partition(f"## {OWN}")[2], re.M))
    wrong = [] if kinds == ["starter", "check"] * asked else [kinds]
    wrong += [c.id for c in cells if is_check(c) and " import check\n" not in c.source]
    return wrong + [c.id for c in cells if c.cell_type == "markdown" and open_answer(c.source)]


SHAPE = (
    is_short,
    one_cell_to_change_comes_first,
    code_stands_open,
    figures_are_made_in_the_open,
    exercises_wait_for_an_answer,
)
