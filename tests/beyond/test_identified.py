"""Known structure: the arm's own parameters come back; ridge against scikit-learn's."""

import numpy as np
from sklearn.linear_model import Ridge
from sklearn.model_selection import KFold
from sklearn.preprocessing import StandardScaler

from beyond.rivals.identified import _RIDGES, Identified, Linear
from beyond.rivals.protocol import Cases
from ddlib.dynamics import CMU_DD_ARM_II
from ddlib.effects import CoulombFriction, Effects, ViscousFriction
from ddlib.identification import FRICTION, RIGID, true_parameters

EFFECTS = Effects(friction=(ViscousFriction((5.0, 1.0)), CoulombFriction((1.5, 0.4))))


def states(n=400, seed=0):
    return np.random.default_rng(seed).uniform(-2, 2, (n, 2, 3))


def torque(x):
    rigid = CMU_DD_ARM_II.inverse_dynamics(*np.moveaxis(x, -1, 0))
    return rigid + EFFECTS.friction_torque(x[..., 1])


def cases(n=400, seed=0):
    x = states(n, seed)
    x = x[(np.abs(x[..., 1]) > 0.01).all(-1)]  # where friction has its sign
    return Cases(x, torque(x), "states", 0.01)


def test_the_arms_own_parameters_come_back():
    rival = Identified().fit(cases())
    wanted = true_parameters(CMU_DD_ARM_II, EFFECTS, RIGID + FRICTION)
    np.testing.assert_allclose(list(rival.parameters().values()), wanted, rtol=1e-5)
    other = cases(seed=1)
    np.testing.assert_allclose(rival.torque(other.x), other.torque, atol=1e-4)
    assert rival.count() == 7
    without = Identified(RIGID).fit(cases()).torque(other.x) - other.torque
    assert np.abs(without).mean() > 0.5


def windows(n=60, width=9, seed=0):
    """Windows whose samples are much alike, and torques of a filter with noise."""
    rng = np.random.default_rng(seed)
    x = rng.normal(size=(n, 2, 3)) @ (np.arange(width) ** np.arange(3)[:, None]) / width
    x += 0.05 * rng.normal(size=x.shape)
    weights = rng.normal(size=(2 * width, 2))
    y = x.reshape(n, -1) @ weights + [3.0, -1.0] + rng.normal(size=(n, 2))
    return Cases(x, y, "windows", 0.01)


def test_the_penalty_is_ridge_regressions():
    data = windows()
    x = StandardScaler().fit_transform(data.x.reshape(60, -1))
    alpha = 1e-2 * np.linalg.norm(x, 2) ** 2
    wanted = Ridge(alpha, solver="svd").fit(x, data.torque).predict(x)
    np.testing.assert_allclose(Linear(ridge=1e-2).fit(data).torque(data.x), wanted, rtol=1e-9)


def test_the_penalty_is_chosen_by_leaving_out_blocks():
    data = windows()
    data, lost = Cases(data.x, data.torque / data.torque.std(0), "windows", 0.01), []
    for ridge in _RIDGES:
        lost.append(0.0)
        for kept, left in KFold(5).split(data.x):
            rival = Linear(ridge=ridge).fit(Cases(data.x[kept], data.torque[kept], "windows", 0.01))
            lost[-1] += ((rival._torque(data.x[left]) - data.torque[left]) ** 2).sum()
    best = int(np.argmin(lost))
    assert 0 < best < len(_RIDGES) - 1  # neither end
    assert Linear().fit(data).chosen == _RIDGES[best]
