"""Inverse dynamics of linear, coupled joints: a model simpler than the arm."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ddlib._check import finite_array, instance, non_negative
from ddlib.dynamics.arm import Arm


@dataclass(frozen=True)
class SecondOrderModel:
    """Inverse dynamics of linear, coupled joints: ``tau = M qdd + F qd`` with constant M and F.

    This book's reading of the "second-order model to compensate for inter-joint coupling" (paper,
    section 1.1, after Asada, Kanade & Takeyama 1982). A vertical arm's weight is no part of it.
    """

    arm: Arm
    posture: tuple[float, float] = (0.0, 0.0)  #: Where its mass matrix is taken, rad.
    viscous: tuple[float, float] = (0.0, 0.0)  #: Viscous friction, N m s/rad.

    def __post_init__(self):
        instance("arm", self.arm, Arm)
        finite_array("posture", self.posture, 2)
        non_negative("viscous", self.viscous, 2)

    def __call__(self, q, qd, qdd) -> np.ndarray:
        """Torque (N m) for a motion, arrays ``(..., 2)``; the angles `q` do not matter."""
        M = self.arm.mass_matrix(self.posture)
        return np.asarray(qdd) @ M.T + np.asarray(self.viscous) * np.asarray(qd)
