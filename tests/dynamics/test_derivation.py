"""Derived equations against recursion, the two-link arm, and their own Lagrangian."""

import numpy as np
import pytest

from ddlib.dynamics import CMU_DD_ARM_II, Link, SerialArm, derive


@pytest.mark.parametrize("gravity", [0.0, 9.81])
@pytest.mark.parametrize("n", range(1, 7))
def test_code_agrees_with_the_recursion(n, gravity):
    rows = np.random.default_rng(0).uniform(0.1, 2.0, (n, 4))
    derivation, arm = derive(n, bool(gravity)), [Link(*row) for row in rows]
    q, qd, qdd = np.random.default_rng(1).uniform(-3, 3, (3, 50, n))
    numbers = (*q.T, *qd.T, *qdd.T, *derivation.base_values(arm, gravity))
    wanted = SerialArm.planar(arm, gravity).inverse_dynamics(q, qd, qdd)
    for function in (derivation.function, derivation.printed_function):
        tau = np.stack(np.broadcast_arrays(*function(*numbers)), -1)
        np.testing.assert_allclose(tau, wanted, atol=1e-11 * np.abs(wanted).max())


def test_two_links_have_the_base_parameters_of_the_two_link_arm():
    two = derive(2, gravity=True)
    cmu = [Link(14.0, 0.50, 0.22, 0.40), Link(14.0, 0.40, 0.09, 0.60)]
    a11, a12, a22, g1, g2 = two.base_values(cmu, 9.81)
    assert [a11 + a22, a12, a22] == pytest.approx(
        [CMU_DD_ARM_II.a, CMU_DD_ARM_II.b, CMU_DD_ARM_II.d]
    )
    assert [g1, g2] == pytest.approx([9.81 * (14 * 0.22 + 14 * 0.5), 9.81 * 14 * 0.09])
    assert [str(symbol) for symbol in two.base] == ["A11", "A12", "A22", "G1", "G2"]
