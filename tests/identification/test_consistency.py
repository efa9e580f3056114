"""Projection onto arms that exist, against a search and the mass matrix itself."""

from dataclasses import replace

import numpy as np
import pytest

from ddlib.dynamics import CMU_DD_ARM_II
from ddlib.identification import Estimate, physically_consistent

ANGLES = np.stack([np.zeros(721), np.linspace(-np.pi, np.pi, 721)], -1)


def positive(a, b, d):
    """Whether the mass matrix is positive definite at every elbow angle."""
    if d <= 0:
        return False
    try:
        arm = replace(CMU_DD_ARM_II, a=a, b=b, d=d)
    except ValueError:
        return False
    return np.linalg.eigvalsh(arm.mass_matrix(ANGLES)).min() > 0


def estimate(values, cover, names=("a", "b", "d")):
    return Estimate(names, np.array(values), np.sqrt(np.diag(cover)), None, 90, covariance=cover)


def test_the_condition_is_that_of_the_mass_matrix():
    rng = np.random.default_rng(0)
    inside = 0
    for a, b, d in rng.uniform([-0.5, -1, -0.5], [2, 1, 2], (60, 3)):
        c = np.cos(ANGLES[:, 1])
        mass = np.stack([a + 2 * b * c, d + b * c, d + b * c, d + 0 * c], -1).reshape(-1, 2, 2)
        exists = np.linalg.eigvalsh(mass).min() > 0
        found = physically_consistent(estimate([a, b, d], np.eye(3)), margin=0.0)
        unchanged = not found.notes
        inside += exists
        assert exists == unchanged
    assert 6 < inside < 54


@pytest.mark.parametrize("seed", range(4))
def test_no_arm_is_nearer(seed):
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(3, 3)) * [0.3, 0.1, 0.05]
    cover = root @ root.T + 1e-4 * np.eye(3)
    start = np.array([1.0, 0.7, 0.3])
    found = physically_consistent(estimate(start, cover), margin=1e-3)
    a, b, d = found.values
    assert positive(a, b, d) and found.notes and np.isnan(found.half_width()).any()
    weight = np.linalg.inv(cover)
    far = lambda x: np.einsum("...p,pq,...q->...", x - start, weight, x - start)  # noqa: E731
    # arms that exist, by Cholesky factors, thrown around the one that was found and anywhere
    p, r, s = rng.normal(size=(3, 400_000))
    x, y, z = p**2, p * r, r**2 + s**2
    eigen = (x + z) / 2 - np.hypot((x - z) / 2, y)
    good = eigen > 1e-3 * (x + z)
    others = np.stack([x + z, y, z], -1)[good]
    near = found.values + 0.05 * rng.normal(size=(400_000, 3))
    x, y, z = near[:, 0] - near[:, 2], near[:, 1], near[:, 2]
    good = (x + z) / 2 - np.hypot((x - z) / 2, y) > 1e-3 * (x + z)
    nearest = min(far(others).min(), far(near[good]).min())
    assert far(found.values) <= nearest * (1 + 1e-6)
    assert nearest < far(found.values) * 1.3 + 0.1, "the search was too coarse to tell"


def test_friction_is_not_negative_and_pulls_its_neighbours():
    names = ("F_v1", "F_c1")
    cover = np.array([[0.04, -0.03], [-0.03, 0.04]])
    found = physically_consistent(estimate([-0.1, 0.5], cover, names))
    # the closed form: the conditional mean of F_c1 if F_v1 is 0
    np.testing.assert_allclose(found.values, [0.0, 0.5 - 0.03 / 0.04 * 0.1], atol=1e-6)


def test_what_exists_stays_and_what_is_not_told_is_left_out():
    good = estimate([5.291, 0.63, 0.7134], 0.01 * np.eye(3))
    assert physically_consistent(good) is good
    untold = estimate([np.nan, 0.9, -0.2], np.eye(3))
    assert physically_consistent(untold) is untold


def test_repetitions_are_moved_one_by_one():
    values = np.array([[1.0, 0.7, 0.3], [5.291, 0.63, 0.7134]])
    many = Estimate(("a", "b", "d"), values, 0.1 * np.ones((2, 3)), None, 90)
    found = physically_consistent(many)
    np.testing.assert_array_equal(found.values[1], values[1])
    assert positive(*found.values[0])
    with pytest.raises(ValueError, match=r"margin must lie in \[0, 0.4\], got 0.9"):
        physically_consistent(many, 0.9)
