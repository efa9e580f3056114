"""Tables against scipy's interpolation, brute force and arms whose torques a table can hold."""

import numpy as np
import pytest
from scipy.interpolate import RegularGridInterpolator

from beyond.rivals.protocol import Cases
from beyond.rivals.tables import CellTable, GridTable, Nearest, full_table
from ddlib.dynamics import CMU_DD_ARM_II
from ddlib.trajectories import OutsideFamilyWarning

BOX = np.stack([np.full((2, 3), -2.0), np.full((2, 3), 3.0)])


def states(n=400, seed=0):
    return np.random.default_rng(seed).uniform(-2.0, 3.0, (n, 2, 3))


def torques(x):
    return CMU_DD_ARM_II.inverse_dynamics(*np.moveaxis(x, -1, 0))


def cases(x, torque=None):
    return Cases(x, torques(x) if torque is None else torque, "states", 0.01)


def nodes(cells, axes=6):
    """All nodes of a grid over `BOX`, the last axis fastest: as states ``(nodes, 2, 3)``."""
    edge = np.linspace(-2.0, 3.0, cells + 1)
    return np.stack(np.meshgrid(*[edge] * axes, indexing="ij"), -1).reshape(-1, 2, 3), edge


def test_a_full_table_is_scipys_interpolation_of_the_same_nodes():
    grid, edge = nodes(3)
    x = states(60, seed=3)
    values = torques(grid).reshape(4, 4, 4, 4, 4, 4, 2)
    scipys = RegularGridInterpolator([edge] * 6, values)(x.reshape(60, 6))
    np.testing.assert_allclose(full_table(torques, x, BOX, 3), scipys, rtol=1e-10, atol=1e-10)


def test_a_grid_fitted_to_scattered_cases_is_the_ridge_of_its_hat_functions():
    x = states(80)
    data = cases(x)
    rival = GridTable(1, ridge=0.3, limits=BOX).fit(data)  # 64 nodes: an independent dense solve
    u = (x - BOX[0]).reshape(80, 6) / 5
    weights = np.stack([np.prod(np.where(k, u, 1 - u), 1) for k in np.ndindex((2,) * 6)], 1)
    centred = data.torque - data.torque.mean(0)
    dense = np.linalg.solve(weights.T @ weights + 0.3 * np.eye(64), weights.T @ centred)
    np.testing.assert_allclose(rival.values, data.torque.mean(0) + dense, rtol=1e-8, atol=1e-9)


def test_nearest_is_brute_force():
    x, asked = states(300), states(40, seed=7) * 0.9
    rival = Nearest().fit(cases(x))
    away = (((asked[:, None] - x) / x.std(0)) ** 2).sum((2, 3))
    np.testing.assert_array_equal(rival.torque(asked), torques(x)[away.argmin(1)])
    assert rival.count() == 300 * 8 + 6


def test_cells_of_configurations_and_of_motions_hold_the_arm():
    """At one configuration torque is linear in accelerations and products of velocities."""
    x, asked = states(200), states(30, seed=5)
    x[..., 0] = asked[..., 0] = [0.3, -0.7]
    rival = CellTable(4, "configurations", ridge=1e-9, limits=BOX)
    rival.fit(cases(x, torques(x) + 2.0 * x[..., 1]))
    wanted = torques(asked) + 2.0 * asked[..., 1]
    np.testing.assert_allclose(rival.torque(asked), wanted, rtol=1e-5, atol=1e-5)
    mass = CMU_DD_ARM_II.mass_matrix(np.array([0.3, -0.7]))
    np.testing.assert_allclose(rival.coefficients[0, 1:3].T, mass, rtol=1e-5)
    x[..., 1] = asked[..., 1] = [1.0, -1.5]  # at one motion only accelerations are left
    rival = CellTable(4, "motions", ridge=1e-9, limits=BOX).fit(cases(x))
    np.testing.assert_allclose(rival.torque(asked), torques(asked), rtol=1e-5, atol=1e-5)


@pytest.mark.parametrize("make", [Nearest, CellTable, GridTable])
def test_states_outside_the_table_are_refused_by_name_or_taken_to_the_edge(make):
    x = states(300)
    rival = make(limits=BOX).fit(cases(x))
    far = states(5)
    far[2, 1, 1] = 3.5
    words = r"velocity of joint 1 from -2 to 3 rad/s, got 3.5 \(1 of 5 states lie outside\)"
    with pytest.raises(ValueError, match=words):
        rival.torque(far)
    kind = make(limits=BOX, beyond="edge").fit(cases(x))
    edge = far.copy()
    edge[2, 1, 1] = 3.0
    with pytest.warns(OutsideFamilyWarning, match="1 of 5 inputs"):
        found = kind.torque(far)
    np.testing.assert_allclose(found, kind.torque(edge))
