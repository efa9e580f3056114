"""Section 6 of the paper: exact states of a simulated arm in place of windows of positions.

A state is a window of three numbers for each joint: position, velocity and desired
acceleration. So everything that is made for windows serves here too.
"""

from __future__ import annotations

import numpy as np

from ddlib._check import shaped
from ddlib.dynamics import CMU_DD_ARM_II, Arm
from ddlib.trajectories import MOTION_SECONDS, pick_and_place

# Half the edge of the hypercube that is sampled: rad, rad/s and rad/s^2 alike (section 6)
RADIUS = np.pi

SAMPLES = 298  # Number of states of each set (section 6)

EPOCHS = 12_000  # Passes through the training set "until it reached an asymptote" (section 6)

# Step size per case, acceleration, epochs with a momentum of 0.5, range of the initial weights.
# Assumed: the paper prints none of them. The book shows what other choices give.
RATE, MOMENTUM, WARM_UP, INITIAL = 4.0, 0.99, 500, 0.5

DESCENT = {"rate": RATE, "momentum": MOMENTUM, "warm_up": WARM_UP, "epochs": EPOCHS}


def random_states(samples: int = SAMPLES, seed: int = 0, radius: float = RADIUS) -> np.ndarray:
    """States drawn uniformly from the hypercube, shape (samples, joint, 3)."""
    size = (samples, 2, 3)
    return np.random.default_rng(seed).uniform(-radius, radius, size)


def states_along(extents_deg, samples: int = SAMPLES, duration=MOTION_SECONDS) -> np.ndarray:
    """States along a pick-and-place motion, equally spaced in time, shape (samples, joint, 3)."""
    step = duration / samples
    return np.stack(pick_and_place(extents_deg, np.arange(samples) * step, duration), -1)


def torque(states, arm: Arm = CMU_DD_ARM_II) -> np.ndarray:
    """Torque that the analytic model gives for states, shape ``(samples, joint)``, N m."""
    states = shaped("states", states, "(samples, 2, 3)")
    return arm.inverse_dynamics(*np.moveaxis(states, -1, 0))
