"""What a file of a reader's own arm holds, before and after it is brought onto an even grid."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ddlib.simulation import Recording


@dataclass(frozen=True, repr=False)
class LoggedRun:
    """One run as it was logged: its steps may be uneven, and samples may be missing."""

    name: str  #: The file, and the run if the file holds several.
    t: np.ndarray  #: Times (samples,), s, in the order of the file.
    q: np.ndarray  #: Angles (samples, 2), rad; the second is counted from the upper arm.
    tau: np.ndarray  #: Torques (samples, 2), N m.
    lines: np.ndarray  #: Line of the file that each sample stands in, (samples,).


@dataclass(frozen=True, repr=False)
class Log:
    """The runs of one or several files, in SI units, and what reading them changed."""

    runs: tuple[LoggedRun, ...]
    notes: tuple[str, ...] = ()  #: Sentences: units converted, columns chosen, lines left out.


@dataclass(frozen=True, repr=False)
class LoggedRecording(Recording):
    """A recording that was made from a log: arrays (runs, time, 2) on one even grid.

    What a log does not tell is NaN: the reference, and what is true rather than measured.
    """

    names: tuple[str, ...] = ()  #: Each run's file, and its name in it.
    lines: np.ndarray | None = None  #: Nearest line of the file for each sample, (runs, time).
    notes: tuple[str, ...] = ()  #: Sentences: what reading and resampling changed.
