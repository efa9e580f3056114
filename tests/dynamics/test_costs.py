"""Counted operations against the literature, against hand counts, and against each other."""

from fractions import Fraction

import numpy as np
import pytest

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
JOINTS = range(1, 7)


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


def polynomial(values, degree):
    """Exact coefficients, highest power first, through values at 1, 2, ...; the rest must fit."""
    n = degree + 1
    matrix = [[Fraction(k) ** p for p in range(degree, -1, -1)] + [Fraction(values[k - 1])]
              for k in range(1, n + 1)]  # fmt: skip
    for i in range(n):
        pivot = next(r for r in range(i, n) if matrix[r][i])
        matrix[i], matrix[pivot] = matrix[pivot], matrix[i]
        matrix[i] = [x / matrix[i][i] for x in matrix[i]]
        for r in range(n):
            if r != i:
                matrix[r] = [x - matrix[r][i] * y for x, y in zip(matrix[r], matrix[i])]
    found = [row[-1] for row in matrix]
    for k, value in enumerate(values, 1):
        assert sum(c * Fraction(k) ** p for c, p in zip(found, range(degree, -1, -1))) == value
    return found


@pytest.fixture(scope="module")
def newton():
    return [costs.count(newton_euler, general(n)) for n in JOINTS]


@pytest.fixture(scope="module")
def lagrange():
    return [costs.count(lagrange_euler, general(n)) for n in JOINTS]


def test_newton_euler_is_linear_in_the_joints_and_near_the_published_count(newton):
    mult = polynomial([o.multiplications for o in newton], 1)
    add = polynomial([o.additions for o in newton], 1)
    assert (mult, add) == ([148, -24], [119, -24])
    published = costs.PUBLISHED["Newton-Euler"]
    assert mult[0] == pytest.approx(published.multiplications[0], rel=0.02)
    assert add[0] == pytest.approx(published.additions[0], rel=0.10)
    assert newton[5].multiplications == pytest.approx(
        published.six_joints.multiplications, rel=0.02
    )
    assert newton[5].additions == pytest.approx(published.six_joints.additions, rel=0.07)


def test_lagrange_euler_has_the_leading_terms_of_the_published_count(lagrange):
    mult = polynomial([o.multiplications for o in lagrange], 4)
    add = polynomial([o.additions for o in lagrange], 4)
    published = costs.PUBLISHED["Lagrange-Euler"]
    assert mult[0] == Fraction(65, 2) and add[0] == 25
    assert [mult[0], add[0]] == [published.multiplications[0], published.additions[0]]
    assert float(mult[1]) == pytest.approx(published.multiplications[1], rel=0.002)
    assert float(add[1]) == pytest.approx(published.additions[1], rel=0.006)
    assert lagrange[5].multiplications == pytest.approx(66271, rel=0.025)
    assert lagrange[5].additions == pytest.approx(51548, rel=0.015)


def test_hollerbachs_recursion_lies_between_the_closed_form_and_newton_euler(newton, lagrange):
    found = [costs.count(recursive_lagrange, general(n)) for n in JOINTS]
    joint = polynomial([o.multiplications for o in found], 1)[0]
    assert polynomial([o.additions for o in found], 1)[0] < joint
    # 3 x 3 products of a joint: W A, W' A, W'' A, and W, W' and W with derivatives of A; A D, J W''
    assert joint >= 8 * 27 and joint > 2 * polynomial([o.multiplications for o in newton], 1)[0]
    assert newton[5].multiplications < found[5].multiplications < lagrange[5].multiplications / 20


def test_published_polynomials_and_totals_agree_but_for_one():
    for name, p in costs.PUBLISHED.items():
        assert np.polyval(p.additions, 6) == pytest.approx(p.six_joints.additions)
        total = np.polyval(p.multiplications, 6)
        wanted = 67143 if name == "Lagrange-Euler" else p.six_joints.multiplications
        assert total == pytest.approx(wanted)


def test_a_single_joint_by_hand():
    """One planar link: tau = J qdd, whatever the method."""
    one = SerialArm.planar(CMU[:1])
    assert costs.count_closed_form(CMU[:1], shared=True) == Operations(1, 0)
    # the recursion has qd^2 terms that cancel only when the last cross products are multiplied out
    assert costs.count(newton_euler, one, "arm").functions == 0
    assert costs.count(newton_euler, one, "arm").multiplications <= 6


def test_two_links_by_hand():
    """cos, sin; b c, b s; v^2, 2 v1 v2 h, v2^2 h; the products with the accelerations."""
    assert costs.count_closed_form(CMU, shared=True) == Operations(15, 8, 0, 2)
    assert costs.count_closed_form(CMU, shared=False).functions == 6
    slow = costs.count_closed_form(CMU, shared=True, velocity_terms=False)
    assert slow == Operations(7, 5, 0, 1), "a cosine, no sine and no speeds"


@pytest.mark.parametrize("formulation", [newton_euler, lagrange_euler, recursive_lagrange])
@pytest.mark.parametrize("joints", [2, 4])
def test_the_more_is_known_the_less_is_computed(formulation, joints):
    arm = PUMA_560.first(joints)
    nothing, zeros, custom = (costs.count(formulation, arm, k) for k in costs.KNOWLEDGE)
    for less, more in ((custom, zeros), (zeros, nothing)):
        assert less.multiplications < more.multiplications and less.additions < more.additions


def test_customised_puma_is_near_the_published_count():
    ours = costs.count(newton_euler, PUMA_560, "arm")
    assert 1.0 <= ours.multiplications / costs.PUBLISHED_CUSTOMISED.multiplications < 1.3
    assert 1.0 <= ours.additions / costs.PUBLISHED_CUSTOMISED.additions < 1.3


def test_table_holds_what_the_counts_say():
    made = costs.table([2, 3], CMU[1])
    assert all(list(by_joints) == [2, 3] for by_joints in made.values())
    assert made["closed form, planar, shared"][2].multiplications == 15
    recursive = costs.count(recursive_lagrange, PUMA_560.first(3))
    assert made["recursive Lagrange, general"][3] == recursive
    assert made["Newton-Euler, general"][3] == costs.count(newton_euler, PUMA_560.first(3))
    equal = SerialArm.planar([CMU[1]] * 3)
    assert made["Newton-Euler, planar, customised"][3] == costs.count(newton_euler, equal, "arm")
    printed, shared = (made[f"closed form, planar, {k}"][3] for k in ("as printed", "shared"))
    assert shared.multiplications < printed.multiplications
    assert made["Lagrange-Euler, general"][3] == costs.count(lagrange_euler, general(3))


def test_refusals():
    with pytest.raises(ValueError, match="knowledge must be one of"):
        costs.count(newton_euler, PUMA_560, "everything")
    with pytest.raises(ValueError, match="links must be an integer"):
        costs.count_closed_form(CMU * 4, shared=True)
