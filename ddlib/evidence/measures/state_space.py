"""Section 6 and Table 6-1: the network of exact states, from ``book/results``."""

from __future__ import annotations

import numpy as np

from ddlib import paper
from ddlib.analysis import shuffled, transition_range
from ddlib.evidence.verdicts import Measured, mean, median, over_members
from ddlib.experiments import random_states, results, states_along, torque
from ddlib.learning import TorqueModel
from ddlib.metrics import rmss
from ddlib.tables import spread


def _median(values, text: str) -> Measured:
    value, replicates = over_members(median, values)
    return Measured(value, text, replicates)


def table_6_1(set_name: str, deviation: str = "own deviation") -> Measured:
    """A row of Table 6-1: the median over all networks."""
    errors = results.read("table-6-1")["errors"][set_name][deviation]
    return _median(errors, spread(errors))


def largest_weight() -> Measured:
    """Magnitude of the largest weight (Figure 6-1), the median over all networks."""
    largest = results.read("table-6-1")["largest weight"]
    return _median(largest, spread(largest, 3))


def slope() -> Measured:
    """Median steepness of the error at the end of training."""
    slopes = np.abs(results.read("table-6-1")["slope"])
    return _median(slopes, f"d ln(error) / d ln(epoch) {spread(slopes)}")


def generalisation() -> Measured:
    """Error on random set B over that on random set A, network by network: the median."""
    errors = results.read("table-6-1")["errors"]
    a, b = (np.array(errors[f"random set {name}"]["own deviation"]) for name in "AB")
    return _median(b / a, f"B / A {spread(b / a)}")


def trajectory_shoulder() -> Measured:
    """Error of the shoulder's torque on trajectory 6, by its own deviation: the median."""
    states = states_along(paper.APPENDIX_I_EXTENTS_DEG[paper.TEST_TRAJECTORY - 1])
    errors = rmss(_networks().torque(states), torque(states), pooled=False)[:, 0]
    return _median(errors, f"RMSS {spread(errors)}")


def shoulder_position() -> Measured:
    """Change of the torque when q1 is shuffled over the mean change for the other inputs."""
    states = random_states(2000, seed=77)
    scale = torque(states).std(0)
    changes = shuffled(_networks().torque, states, scale).reshape(6, -1)
    ratio = changes[0] / changes[1:].mean(0)
    text = f"RMSS of the change {spread(changes[0])}, other inputs {spread(changes[1:].mean(0))}"
    return _median(ratio, text)


def velocity_ranges() -> Measured:
    """Share of hidden units with a transition region within the range of shoulder velocity."""
    along = transition_range(_networks().weights)
    within = {name: along[..., j, k] < 1 for name, j, k in (("v1", 0, 1), ("q2", 1, 0))}
    value, replicates = over_members(mean, within["v1"])
    text = f"{100 * value:.0f} % of the units; of elbow position {100 * within['q2'].mean():.0f} %"
    return Measured(value, text, replicates)


def best_of_sizes() -> Measured:
    """Least median error on 5,000 random states over all numbers of hidden units.

    There are three networks of each, too few to draw from: no replicates.
    """
    found = results.read("state-space-sizes")
    rows = {row["units"]: row["solver"]["test"] for row in found["units"] if row["solver"]}
    best = min(rows, key=lambda units: np.median(rows[units]))
    samples = found["solver's samples in units"]
    text = f"RMSS {spread(rows[best])} with {best} units, {samples:,} samples"
    return Measured(float(np.median(rows[best])), text)


def _networks() -> TorqueModel:
    return TorqueModel.load(results.FOLDER / "networks-state-space.npz")
