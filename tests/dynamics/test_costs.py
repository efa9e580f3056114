"""Counted operations against the literature, against hand counts, and against each other."""

import numpy as np
import pytest
import sympy as sp

from ddlib.dynamics import (
    PUMA_560,
    Link,
    Operations,
    SerialArm,
    SpatialLink,
    costs,
    lagrange_euler,
    newton_euler,
    recursive_lagrange,
)

CMU = [Link(14.0, 0.50, 0.22, 0.40), Link(14.0, 0.40, 0.09, 0.60)]


def general(joints) -> SerialArm:
    """An arm of which no constant is zero or one."""
    rng = np.random.default_rng(joints)
    inertia = np.array([[3.0, 0.4, 0.5], [0.4, 4.0, 0.6], [0.5, 0.6, 5.0]])
    return SerialArm(
        [
            SpatialLink(37.0, 0.7, 0.3, 2.5, rng.uniform(0.1, 0.9, 3), inertia)
            for _ in range(joints)
        ],
        (1.0, 2.0, 3.0),
    )


def counts(formulation):
    return [costs.count_operations(formulation, general(n)) for n in range(1, 7)]


def polynomials(formulation):
    """Exact coefficients of multiplications and additions by joints, highest power first."""
    n = sp.Symbol("n")
    for kind in ("multiplications", "additions"):
        values = [getattr(count, kind) for count in counts(formulation)]
        yield sp.Poly(sp.interpolate(values, n), n).all_coeffs()


def test_newton_euler_is_linear_in_the_joints_and_near_the_published_count():
    (mult, add), newton = polynomials(newton_euler), counts(newton_euler)
    assert (mult, add) == ([148, -24], [119, -24])
    published = costs.PUBLISHED["Newton-Euler"]
    assert mult[0] == pytest.approx(published.multiplications[0], rel=0.02)
    assert add[0] == pytest.approx(published.additions[0], rel=0.10)
    assert newton[5].multiplications == pytest.approx(
        published.six_joints.multiplications, rel=0.02
    )
    assert newton[5].additions == pytest.approx(published.six_joints.additions, rel=0.07)


def test_lagrange_euler_has_the_leading_terms_of_the_published_count():
    (mult, add), lagrange = polynomials(lagrange_euler), counts(lagrange_euler)
    published = costs.PUBLISHED["Lagrange-Euler"]
    assert len(mult) == len(add) == 5
    assert float(mult[0]) == published.multiplications[0] and add[0] == published.additions[0]
    assert float(mult[1]) == pytest.approx(published.multiplications[1], rel=0.002)
    assert float(add[1]) == pytest.approx(published.additions[1], rel=0.006)
    assert lagrange[5].multiplications == pytest.approx(66271, rel=0.025)
    assert lagrange[5].additions == pytest.approx(51548, rel=0.015)


def test_hollerbachs_recursion_lies_between_the_closed_form_and_newton_euler():
    (joint, _), (added, _) = polynomials(recursive_lagrange)
    (newtons, _), _ = polynomials(newton_euler)
    assert added < joint
    # 3 x 3 products of a joint: W A, W' A, W'' A, and W, W' and W with derivatives of A; A D, J W''
    assert joint >= 8 * 27 and joint > 2 * newtons
    ways = (newton_euler, recursive_lagrange, lagrange_euler)
    newton, recursive, closed = (counts(way)[5].multiplications for way in ways)
    assert newton < recursive < closed / 20


def test_two_links_by_hand():
    """cos, sin; b c, b s; v^2, 2 v1 v2 h, v2^2 h; the products with the accelerations."""
    assert costs.count_closed_form(CMU[:1], shared=True) == Operations(1, 0)
    assert costs.count_closed_form(CMU, shared=True) == Operations(15, 8, 0, 2)
    assert costs.count_closed_form(CMU, shared=False).functions == 6
    slow = costs.count_closed_form(CMU, shared=True, velocity_terms=False)
    assert slow == Operations(7, 5, 0, 1), "a cosine, no sine and no speeds"


def test_customised_puma_is_near_the_published_count():
    ours = costs.count_operations(newton_euler, PUMA_560, "arm")
    assert 1.0 <= ours.multiplications / costs.PUBLISHED_CUSTOMISED.multiplications < 1.3
    assert 1.0 <= ours.additions / costs.PUBLISHED_CUSTOMISED.additions < 1.3
