"""Section 6 and Table 6-1: the network of exact states, from ``book/results``."""

from __future__ import annotations

import numpy as np

from ddlib import results
from ddlib.claims import Measured
from ddlib.tables import spread


def table_6_1(set_name: str, deviation: str = "own deviation") -> Measured:
    """A row of Table 6-1: the median over all networks."""
    errors = results.read("table-6-1")["errors"][set_name][deviation]
    return Measured(float(np.median(errors)), spread(errors))


def largest_weight() -> Measured:
    """Magnitude of the largest weight (Figure 6-1), the median over all networks."""
    largest = results.read("table-6-1")["largest weight"]
    return Measured(float(np.median(largest)), spread(largest, 3))


def slope() -> Measured:
    """Median steepness of the error at the end of training."""
    slopes = np.abs(results.read("table-6-1")["slope"])
    return Measured(float(np.median(slopes)), f"d ln(error) / d ln(epoch) {spread(slopes)}")
