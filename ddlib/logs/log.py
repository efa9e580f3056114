"""What a file of a reader's own arm holds, before and after it is brought onto an even grid."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ddlib._check import integer
from ddlib.simulation import Recording


@dataclass(frozen=True, repr=False)
class LoggedRun:
    """One run as it was logged: its steps may be uneven, and samples may be missing."""

    name: str  #: The file, and the run if the file holds several.
    t: np.ndarray  #: Times (samples,), s, in the order of the file.
    q: np.ndarray  #: Angles (samples, 2), rad; the second is counted from the upper arm.
    tau: np.ndarray  #: Torques (samples, 2), N m.
    lines: np.ndarray  #: Line of the file, or row of the frame, of each sample, (samples,).
    joints: int = 2  #: For how many joints the file has such columns; two of them were picked.

    def __repr__(self):
        ends = f", {self.t[0]:g} to {self.t[-1]:g} s" if len(self.t) else ""
        return f"LoggedRun({self.name}: {len(self.t)} samples{ends})"


@dataclass(frozen=True, repr=False)
class Log:
    """The runs of one or several files, in SI units, and what reading them changed."""

    runs: tuple[LoggedRun, ...]
    notes: tuple[str, ...] = ()  #: Sentences: units converted, columns chosen, lines left out.

    def __repr__(self):
        samples = sum(len(run.t) for run in self.runs)
        return _with_notes(f"Log({len(self.runs)} runs, {samples} samples)", self.notes)


@dataclass(frozen=True, repr=False)
class LoggedRecording(Recording):
    """A recording that was made from a log: arrays (runs, time, 2) on one even grid.

    All samples are of the motion, as a log does not tell rests. What it does not tell is NaN: the
    reference, and what is true rather than measured. A sample's torque counts as that at its
    time, so `control_step` is 0; tell `by_modulation` by `hold` if a controller held it.
    """

    names: tuple[str, ...] = ()  #: Each run's file, and its name in it.
    lines: np.ndarray | None = None  #: Nearest line of the file for each sample, (runs, time).
    notes: tuple[str, ...] = ()  #: Sentences: what reading and resampling changed.
    margin: int = 0  #: Samples at each end that windows need and that are no cases.
    joints: int = 2  #: For how many joints the file has such columns; two of them were picked.

    def __repr__(self):
        return _with_notes("Logged" + super().__repr__(), self.notes)

    @property
    def motion(self) -> slice:
        """All samples, less the margin at each end."""
        return slice(self.margin, self.t.size - self.margin)

    def for_windows(self, width: int) -> LoggedRecording:
        """The recording with margins, so that each sample of the motion has a whole window."""
        half = integer("width", width, 1) // 2
        if width > self.t.size:
            raise ValueError(
                f"width must not exceed the {self.t.size} samples of a run, got {width}"
            )
        return replace(self, margin=half)

    def __getitem__(self, runs) -> LoggedRecording:
        """One run or several of many: ``recording[5]``, ``recording[:5]``."""
        chosen = super().__getitem__(runs)
        names = np.array(self.names, object)[runs] if self.names else ()
        names = (names,) if isinstance(names, str) else tuple(names)
        lines = None if self.lines is None else self.lines[runs]
        return replace(chosen, names=names, lines=lines)


def _with_notes(what: str, notes) -> str:
    return "\n".join([what, *(f"- {note}" for note in notes)])
