"""The square of trajectories: pick one, watch the arm, record it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
import traitlets as t
from scipy.spatial import ConvexHull

from ddlib._check import finite_array, number
from ddlib.arm import CMU_DD_ARM_II, Arm
from ddlib.paper import TEST_TRAJECTORY, TRAINING_TRAJECTORIES
from ddlib.trajectories import APPENDIX_I, MAX_EXTENT_DEG, MOTION_SECONDS, pick_and_place
from ddlib.widgets.base import CurveWidget, Mark, Pad, Panel, Parameter, Scalar

HERE = Path(__file__).parent
JOINTS = ("shoulder", "elbow")
RIGID = "Lagrange-Euler"

# The motion with its last instant from the inside: at 3 s the reference is back at rest.
TIMES = np.linspace(0.0, MOTION_SECONDS, 101)
_INSIDE = np.append(TIMES[:-1], np.nextafter(MOTION_SECONDS, 0.0))

_TRAINING = APPENDIX_I[np.array(TRAINING_TRAJECTORIES) - 1]
_HULL = _TRAINING[ConvexHull(_TRAINING).vertices]
