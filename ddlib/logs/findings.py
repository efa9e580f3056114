"""What a check finds: where, how bad, what it does to a result, and what to do about it."""

from __future__ import annotations

import textwrap
from dataclasses import dataclass, field

import numpy as np

from ddlib.logs.log import Log, LoggedRun
from ddlib.simulation import Recording

SEVERITIES = ("wrong", "doubtful", "note")
"""What a finding may be, the worst first."""

JOINTS = ("shoulder", "elbow")
_ADVICE = 100  # columns of a printed check


@dataclass(frozen=True)
class Finding:
    """One thing that a recording shows before anything is fitted to it."""

    kind: str  #: Like "spike" or "units of time".
    severity: str  #: "wrong": results will be; "doubtful": they may be; "note": good to know.
    where: tuple[int | None, int | None]  #: Run and joint, counted from 0; None: all of them.
    rows: np.ndarray  #: Samples of that run that are concerned, counted from 0; empty: all.
    what: str  #: What was seen, with numbers.
    effect: str  #: What it does to a result.
    advice: str  #: What to do.
    lines: np.ndarray | None = None  #: Lines of the file that these samples stand in, if known.


@dataclass(frozen=True, repr=False)
class Check:
    """What `check_recording` found; print it, or draw it by `ddlib.figures.checked`."""

    findings: tuple[Finding, ...]  #: The worst first.
    runs: tuple[LoggedRun, ...] = field(default=(), compare=False)  #: What was checked.

    @property
    def wrong(self) -> tuple[Finding, ...]:
        """The findings that make a result wrong."""
        return tuple(finding for finding in self.findings if finding.severity == "wrong")

    def of(self, kind: str) -> tuple[Finding, ...]:
        """The findings of one kind."""
        return tuple(finding for finding in self.findings if finding.kind == kind)

    def __repr__(self):
        groups = self._groups()
        heads = [f"{finding.severity:8s}  {place(finding, runs)}" for finding, runs in groups]
        lines = [self._title()]
        for head, (finding, runs) in zip(heads, groups):
            lines += ["", f"{head}: {finding.kind}"[:_ADVICE]]
            for text in (
                f"{finding.what} {_rows(finding, runs)}",
                finding.effect,
                f"Do: {finding.advice}",
            ):
                lines += textwrap.wrap(text, _ADVICE, initial_indent="  ", subsequent_indent="  ")
        return "\n".join(lines)

    def _repr_markdown_(self) -> str:
        """The same as a list of a notebook."""
        lines = [f"**{self._title()}.**", ""]
        for finding, runs in self._groups():
            head = f"- **{finding.severity.capitalize()}: {finding.kind}, {place(finding, runs)}.**"
            what = f"{finding.what} {_rows(finding, runs)}".strip()
            lines.append(f"{head} {what} {finding.effect} *{finding.advice}*")
        return "\n".join(lines)

    def _title(self) -> str:
        samples = sum(run.t.size for run in self.runs)
        counts = [sum(f.severity == severity for f in self.findings) for severity in SEVERITIES]
        by_severity = ", ".join(f"{n} {name}" for n, name in zip(counts, SEVERITIES))
        return f"{counted(len(self.runs), 'run')}, {counted(samples, 'sample')}: {by_severity}"

    def _groups(self) -> list[tuple[Finding, list]]:
        """The findings, those of one kind and joint in several runs together, by their first."""
        groups = {}
        for finding in self.findings:
            key = (finding.severity, finding.kind, finding.where[1])
            groups.setdefault(key, (finding, []))[1].append(finding.where[0])
        return list(groups.values())


def place(finding: Finding, runs) -> str:
    """Where findings are, in words."""
    joint = finding.where[1]
    of_joint = "" if joint is None else f", {JOINTS[joint]}"
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
    where = f"run {finding.where[0] + 1}, " if len(runs) > 1 else ""
    shown = ", ".join(str(int(number)) for number in numbers[:4])
    rest = f" and {len(numbers) - 4:,} more" if len(numbers) > 4 else ""
    return f"({where}{name}{'s' if len(numbers) > 1 else ''} {shown}{rest})"


def counted(number: int, thing: str) -> str:
    """A number of things in words: "1 stretch", "2,000 samples"."""
    plural = "es" if thing.endswith("ch") else "s"
    return f"{number:,} {thing}{'' if number == 1 else plural}"


def in_runs(recording: Recording | Log) -> tuple[LoggedRun, ...]:
    """The runs of a recording or a log, each with its own times; TypeError for anything else."""
    if isinstance(recording, Log):
        return recording.runs
    if not isinstance(recording, Recording):
        raise TypeError(
            f"recording must be a Recording, a LoggedRecording or a Log, got {recording!r:.80}"
        )
    q, tau = (np.asarray(x, float) for x in (recording.q, recording.tau))
    if q.shape[-2:] != (len(recording.t), 2) or tau.shape != q.shape:
        raise ValueError(
            f"recording must have q and tau of shape (..., {len(recording.t)}, 2), got {q.shape} "
            f"and {tau.shape}"
        )
    q, tau = q.reshape(-1, *q.shape[-2:]), tau.reshape(-1, *q.shape[-2:])
    names = getattr(recording, "names", ()) or [f"run {k + 1}" for k in range(len(q))]
    lines = getattr(recording, "lines", None)
    lines = [None] * len(q) if lines is None else np.reshape(lines, (len(q), -1))
    t = np.asarray(recording.t, float)
    return tuple(LoggedRun(*parts) for parts in zip(names, [t] * len(q), q, tau, lines))


def finding(run: LoggedRun, kind, severity, where, rows, what, effect, advice) -> Finding:
    """A finding, with the lines of the file where the run knows them."""
    rows = np.asarray(rows, int)
    lines = None if run is None or run.lines is None else np.asarray(run.lines)[rows]
    return Finding(kind, severity, where, rows, what, effect, advice, lines)
