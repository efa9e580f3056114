"""What the paper prints, as data. Page and section numbers refer to CMU-CS-88-160.

The page Provenance shows constants with the notes below them.
"""

from __future__ import annotations

from types import MappingProxyType
from typing import NamedTuple

APPENDIX_I_EXTENTS_DEG = (
    (45.0, 45.0),
    (38.6, 32.2),
    (5.4, 39.4),
    (20.9, 0.0),
    (0.0, 45.0),
    (39.5, 14.4),
)
"""Extents (shoulder, elbow) of the six trajectories in degrees, Appendix I."""

TRAINING_TRAJECTORIES = (1, 2, 3, 4, 5)
"""Numbers of the trajectories that the networks are trained on, Appendix I."""

TEST_TRAJECTORY = 6
"""Number of the trajectory that tests generalisation, Appendix I."""


class _Rmss(NamedTuple):
    """A pair of printed errors: on the training data and on trajectory 6."""

    training: float
    test: float


TABLE_4_1 = MappingProxyType(
    {11: _Rmss(0.078, 0.22), 21: _Rmss(0.027, 0.10), 41: _Rmss(0.024, 0.13)}
)
"""RMSS error by window size, Table 4-1."""

TABLE_6_1 = MappingProxyType({"random set A": 0.068, "random set B": 0.083, "trajectory 6": 0.067})
"""RMSS error of the simulation network on its synthetic data sets, Table 6-1."""

LARGEST_WEIGHT = MappingProxyType({11: 18.9, 21: 11.7, 41: 4.2})
"""Magnitude of the largest weight by window size, captions of Figures 5-1 to 5-3."""

HIDDEN_UNITS = 10
"""Hidden units of every network, section 3.3."""

SAMPLES_PER_TRAJECTORY = 300
"""Samples of one trajectory at 100 a second, Appendix I."""

EPOCHS = 20_000
"""Training required "over" this many epochs, Appendix I."""

MULTIPLICATIONS_PER_EPOCH = 700_000
"""Multiplications an epoch "for our largest network": "over" this many, Appendix I."""
