"""Where a reader answers an exercise in a lesson, what judges the answer, and a right one."""

from __future__ import annotations

import re
from typing import NamedTuple

from lessons import FOLDED, OWN

STARTER = re.compile(r"(?m)^mine = \.\.\.")
# In Markdown, where a parser of HTML would take a "<" of a formula for a tag
FOLD = re.compile(r"(?s)<details.*?</details>")


class Exercise(NamedTuple):
    """An exercise of a lesson: where an answer goes, what judges it, and a right one."""

    starter: str
    check: str
    solution: str


def is_starter(cell) -> bool:
    """Whether an answer goes into a cell."""
    return cell.cell_type == "code" and STARTER.search(cell.source) is not None


def is_check(cell) -> bool:
    """Whether a cell judges an answer."""
    uses = re.search(r"\bmine\b", cell.source) is not None
    return cell.cell_type == "code" and uses and not is_starter(cell)


def is_open(cell) -> bool:
    """Whether a cell's code stands open to be read and run."""
    return cell.cell_type == "code" and not {*FOLDED, "hide-cell"} & {
        *cell.metadata.get("tags", ())
    }


def exercises(notebook) -> list[Exercise]:
    """The exercises of a lesson that have a cell for an answer, in order."""
    found, starter, check, below = [], "", "", False
    for cell in notebook.cells:
        if cell.cell_type == "markdown":
            below = below or OWN.strip() in cell.source.splitlines()
            answer = FOLD.search(cell.source)
            if starter and check and answer:
                found.append(Exercise(starter, check, solution(answer[0])))
                starter = check = ""
        elif below and is_starter(cell):
            starter = cell.source
        elif below and is_check(cell):
            check = cell.source
    return found


def solution(answer: str) -> str:
    """The code of a solution, in a fence or in backticks, that gives `mine`."""
    fenced = re.findall(r"```python\n(.*?)```", answer, flags=re.S)
    found = [code for code in fenced if "mine =" in code]
    return (found or re.findall(r"`(mine = [^`]+)`", answer) or [""])[0]
