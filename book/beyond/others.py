"""Data that others made, in ``book/data``: a simulated arm's characters, two real arms."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import numpy as np

from workshop import BOOK

DATA = BOOK / "data"
_PUBLISHED_TEST = ("e", "q", "v")  # kept for the test by the loader of Deep Lagrangian Networks
_RATE = 1000  # samples a second of the real arm's recording


@dataclass(frozen=True)
class Characters:
    """Characters that a simulated two-joint arm draws; angles from the horizontal, rad; N m."""

    labels: np.ndarray
    length: np.ndarray  # samples of each character
    t: np.ndarray  # s, from the beginning of each character
    q: np.ndarray
    qd: np.ndarray
    qdd: np.ndarray
    tau: np.ndarray  # the sum of the three that follow
    inertial: np.ndarray
    coriolis: np.ndarray
    gravity: np.ndarray
    mass_matrix: np.ndarray

    STEP = 0.04  # sampling period, s

    def __len__(self) -> int:
        return len(self.labels)

    def of(self, labels) -> Characters:
        """Those of some labels, in the order of the file."""
        labels = set(labels)
        wanted = np.isin(self.labels, list(labels))
        rows = np.repeat(wanted, self.length)
        chosen = {
            f.name: getattr(self, f.name)[wanted if f.name in ("labels", "length") else rows]
            for f in fields(self)
        }
        return replace(self, **chosen)

    def split(self, test=_PUBLISHED_TEST) -> tuple[Characters, Characters]:
        """The characters to learn from, and those to be tested on."""
        test = set(test)
        return self.of(set(self.labels) - test), self.of(test)


@dataclass(frozen=True)
class RealArm:
    """A recording of a real arm."""

    t: np.ndarray
    q: np.ndarray  # rad
    current: np.ndarray  # of the motors, A, or their torque, N m
    step: float

    def at(self, rate: int) -> RealArm:
        """The same at fewer samples a second, each the mean of several."""
        many = round(1 / self.step) // rate
        samples = len(self.t) // many
        t, q, current = (
            x[: samples * many].reshape(samples, many, *x.shape[1:]).mean(1)
            for x in (self.t, self.q, self.current)
        )
        return RealArm(t, q, current, many * self.step)


def read_characters() -> Characters:
    """Twenty characters of the repository milutter/deep_lagrangian_networks (MIT licence)."""
    with np.load(DATA / "characters.npz") as file:
        return Characters(**file)


def staubli() -> RealArm:
    """Nine seconds of a Stäubli TX40, six joints on exciting trajectories (Apache licence 2.0).

    Source: repository thanhndv212/figaroh-examples, examples/staubli_TX40, of which each sample is
    the mean of five.
    """
    with np.load(DATA / "staubli-tx40.npz") as file:
        q, current = np.deg2rad(file["position_deg"]), np.array(file["current_a"])
    return RealArm(np.arange(len(q)) / _RATE, q, current, 1 / _RATE)


def kr300() -> list[RealArm]:
    """Three motions of a KUKA KR 300, six joints, 100 samples a second (MIT licence).

    Each sample is the mean over 10 ms. In the place of currents stand torques of the motors, N m.
    Source: repository JonasWeigand/Robot_Identification.
    """
    with np.load(DATA / "kr300.npz") as file:
        rate, kept = float(file["rate_hz"]), dict(file)
    motions = []
    for motion in "ABC":
        q, torque = np.deg2rad(kept[f"{motion}_position_deg"]), kept[f"{motion}_torque_nm"]
        t = np.arange(len(q)) / rate
        fine = np.arange(round(t[-1] * _RATE)) / _RATE
        each = (np.stack([np.interp(fine, t, x) for x in both.T], -1) for both in (q, torque))
        motions.append(RealArm(fine, *each, 1 / _RATE).at(100))
    return motions
