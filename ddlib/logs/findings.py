"""What a check finds: where, how bad, what it does to a result, and what to do about it."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ddlib.simulation import Recording
from ddlib.tables import plural

SEVERITIES = ("wrong", "doubtful", "note")
"""What a finding may be, the worst first."""

JOINTS = ("shoulder", "elbow")
_WIDTH = 100  # columns of a printed check


@dataclass(frozen=True)
class Finding:
    """One thing that a recording shows before anything is fitted to it."""

    kind: str  #: Like "spike" or "units of time".
    severity: str  #: "wrong": results will be; "doubtful": they may be; "note": good to know.
    run: int | None  #: Counted from 0; None: all of them.
    joint: int | None  #: 0 or 1; None: both.
    what: str  #: What was seen, with numbers.
    effect: str  #: What it does to a result.
    advice: str  #: What to do.
    rows: Sequence[int] = ()  #: Samples that are concerned, from 0; empty: all.
    lines: np.ndarray | None = None  #: Lines of the file that these samples stand in, if known.


@dataclass(frozen=True, repr=False)
class Check:
    """What `ddlib.identification.check_recording` found; `ddlib.figures.checked` draws it."""

    findings: tuple[Finding, ...]  #: The worst first.
    recording: Recording  #: What was checked, with an axis of runs.

    @property
    def wrong(self) -> tuple[Finding, ...]:
        """The findings that make a result wrong."""
        return tuple(finding for finding in self.findings if finding.severity == "wrong")

    def of(self, kind: str) -> tuple[Finding, ...]:
        """The findings of one kind."""
        return tuple(finding for finding in self.findings if finding.kind == kind)

    def __repr__(self):
        lines = [self._title()]
        for first, runs in grouped(self.findings):
            lines += ["", f"{first.severity:8s}  {place(first, runs)}: {first.kind}"]
            for text in (f"{first.what} {_rows(first, runs)}", first.effect, f"Do: {first.advice}"):
                lines += textwrap.wrap(text, _WIDTH, initial_indent="  ", subsequent_indent="  ")
        return "\n".join(lines)

    def _repr_markdown_(self) -> str:
        """The same as a list of a notebook."""
        lines = [f"**{self._title()}.**", ""]
        for first, runs in grouped(self.findings):
            head = f"- **{first.severity.capitalize()}: {first.kind}, {place(first, runs)}.**"
            what = f"{first.what} {_rows(first, runs)}".strip()
            lines.append(f"{head} {what} {first.effect} *{first.advice}*")
        return "\n".join(lines)

    def _title(self) -> str:
        runs, samples, _ = self.recording.q.shape
        counts = [sum(f.severity == severity for f in self.findings) for severity in SEVERITIES]
        by_severity = ", ".join(f"{n} {name}" for n, name in zip(counts, SEVERITIES))
        return f"{plural(runs, 'run')}, {plural(runs * samples, 'sample')}: {by_severity}"


def grouped(findings) -> list[tuple[Finding, list]]:
    """The first finding of each kind, severity and joint, with the runs in which it is."""
    groups = {}
    for finding in findings:
        key = (finding.severity, finding.kind, finding.joint)
        groups.setdefault(key, (finding, []))[1].append(finding.run)
    return list(groups.values())


def place(finding: Finding, runs) -> str:
    """Where findings are, in words."""
    of_joint = "" if finding.joint is None else f", {JOINTS[finding.joint]}"
    if runs[0] is None:
        return f"all runs{of_joint}"
    numbers = [str(run + 1) for run in dict.fromkeys(runs)]
    shown = ", ".join(numbers[:8]) + (f" and {len(numbers) - 8} more" if len(numbers) > 8 else "")
    return f"{'runs' if len(numbers) > 1 else 'run'} {shown}{of_joint}"


def _rows(finding: Finding, runs) -> str:
    """The first rows of a finding, by lines of the file if they are known."""
    if not len(finding.rows):
        return ""
    name, numbers = ("row", finding.rows) if finding.lines is None else ("line", finding.lines)
    where = f"run {finding.run + 1}, " if len(runs) > 1 else ""
    shown = ", ".join(str(int(number)) for number in numbers[:4])
    rest = f" and {len(numbers) - 4:,} more" if len(numbers) > 4 else ""
    return f"({where}{name}{'s' if len(numbers) > 1 else ''} {shown}{rest})"
