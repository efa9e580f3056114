"""Data that others made: characters drawn by a simulated arm, and a recording of a real one.

The files lie in ``book/data``; the ``README.md`` there has their sources and licences.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import numpy as np

from ddlib._check import integer
from workshop import BOOK

FOLDER = BOOK / "data"
"""Where the files are."""

PUBLISHED_TEST = ("e", "q", "v")
"""Characters that the loader of Deep Lagrangian Networks keeps for the test, if not told."""

RATE = 1000
"""Samples a second of the real arm's recording."""

REDUCTION = (32.0, 32.0, 45.0, -48.0, 45.0, 32.0)
"""Turns of each motor of the TX40 for one turn of its joint, from the source's configuration.
Motor 6 turns joint 5, too."""

VISCOUS = (8.05, 5.53, 1.97, 1.11, 1.86, 0.65)
"""Viscous friction of the TX40's joints, N m s/rad, from the source's configuration."""

COULOMB = (7.14, 8.26, 6.34, 2.48, 3.03, 0.28)
"""Coulomb friction of the TX40's joints, N m, from the source's configuration."""


@dataclass(frozen=True)
class Characters:
    """Characters that a simulated two-joint arm with gravity draws, 25 samples a second.

    The samples of all characters stand one after the other.

    Attributes
    ----------
    labels : ndarray of str, shape (characters,)
    length : ndarray of int, shape (characters,)
        Samples of each character.
    t : ndarray, shape (samples,)
        s, from the beginning of each character.
    q, qd, qdd : ndarray, shape (samples, 2)
        rad, rad/s, rad/s^2; the first angle is counted from the horizontal.
    tau, inertial, coriolis, gravity : ndarray, shape (samples, 2)
        The torque and its parts, N m.
    mass_matrix : ndarray, shape (samples, 2, 2)
        kg m^2.
    """

    labels: np.ndarray
    length: np.ndarray
    t: np.ndarray
    q: np.ndarray
    qd: np.ndarray
    qdd: np.ndarray
    tau: np.ndarray
    inertial: np.ndarray
    coriolis: np.ndarray
    gravity: np.ndarray
    mass_matrix: np.ndarray

    STEP = 0.04
    """Sampling period, s."""

    def __len__(self) -> int:
        return len(self.labels)

    def of(self, labels) -> Characters:
        """Some of the characters, in the order of the file.

        Parameters
        ----------
        labels : iterable of str

        Raises
        ------
        ValueError
            If one of them is not there, or none is asked for.
        """
        labels = set(labels)
        if not labels or labels - set(self.labels):
            raise ValueError(
                f"labels must be some of {', '.join(self.labels)}, got {sorted(labels)}"
            )
        kept = np.isin(self.labels, list(labels))
        rows = np.repeat(kept, self.length)
        chosen = {
            f.name: getattr(self, f.name)[kept if f.name in ("labels", "length") else rows]
            for f in fields(self)
        }
        return replace(self, **chosen)

    def split(self, test=PUBLISHED_TEST) -> tuple[Characters, Characters]:
        """The characters to learn from, and those to be tested on.

        Parameters
        ----------
        test : iterable of str
            Labels of the latter; default: as published (`PUBLISHED_TEST`).
        """
        test = set(test)
        return self.of(set(self.labels) - test), self.of(test)


@dataclass(frozen=True)
class RealArm:
    """A recording of a real arm.

    Attributes
    ----------
    t : ndarray, shape (samples,)
        s.
    q : ndarray, shape (samples, 6)
        Positions of the joints, rad.
    current : ndarray, shape (samples, 6)
        Currents of the motors, A.
    step : float
        Sampling period, s.
    """

    t: np.ndarray
    q: np.ndarray
    current: np.ndarray
    step: float

    def at(self, rate: int) -> RealArm:
        """The same at fewer samples a second, each the mean of several.

        Parameters
        ----------
        rate : int
            Samples a second, a divisor of those that there are.

        Raises
        ------
        ValueError
            If it is not.
        """
        now = round(1 / self.step)
        if now % integer("rate", rate, 1, now):
            raise ValueError(f"rate must divide {now} samples a second, got {rate}")
        many = now // rate
        count = len(self.t) // many
        t, q, current = (
            x[: count * many].reshape(count, many, *x.shape[1:]).mean(1)
            for x in (self.t, self.q, self.current)
        )
        return RealArm(t, q, current, many * self.step)


def characters() -> Characters:
    """Twenty characters, drawn by somebody else's simulated arm (MIT licence).

    Returns
    -------
    Characters

    Raises
    ------
    FileNotFoundError
        Outside the book's repository.

    Source: M. Lutter, C. Ritter, J. Peters, "Deep Lagrangian Networks", ICLR 2019; the file is
    that of the repository milutter/deep_lagrangian_networks.
    """
    with np.load(FOLDER / "characters.npz") as file:
        return Characters(**file)


def staubli() -> RealArm:
    """Nine seconds of a Stäubli TX40, six joints on exciting trajectories (Apache licence 2.0).

    Returns
    -------
    RealArm
        At `RATE` samples a second, each the mean of five of the source's.

    Raises
    ------
    FileNotFoundError
        Outside the book's repository.

    Source: repository thanhndv212/figaroh-examples, examples/staubli_TX40.
    """
    with np.load(FOLDER / "staubli-tx40.npz") as file:
        q, current = np.deg2rad(file["position_deg"]), np.array(file["current_a"])
    return RealArm(np.arange(len(q)) / RATE, q, current, 1 / RATE)
