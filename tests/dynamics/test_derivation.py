"""Derived equations against recursion, the two-link arm, and their own Lagrangian."""

import numpy as np
import pytest
import sympy as sp

from ddlib.dynamics import CMU_DD_ARM_II, Link, SerialArm, derive


def links(n, seed=0):
    return [Link(*row) for row in np.random.default_rng(seed).uniform(0.1, 2.0, (n, 4))]


def states(n, count=50, seed=1):
    return np.random.default_rng(seed).uniform(-3, 3, (3, count, n))


@pytest.mark.parametrize("gravity", [0.0, 9.81])
@pytest.mark.parametrize("n", range(1, 7))
def test_code_agrees_with_the_recursion(n, gravity):
    derivation, arm = derive(n, bool(gravity)), links(n)
    q, qd, qdd = states(n)
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


def test_torque_is_lagranges_equation_along_a_motion():
    """The chain rule was right: differentiate along q(t) = polynomials in time instead."""
    three, t = derive(3, True), sp.Symbol("t")
    paths = [sp.Rational(k + 1, 3) * t**2 - sp.Rational(k, 5) * t**3 + t for k in range(3)]
    values = dict(zip(three.base, three.base_values(links(3), 9.81)))
    rates = {x: f for x, f in zip(three.q, paths)}
    rates |= {v: f.diff(t) for v, f in zip(three.qd, paths)}
    rates |= {a: f.diff(t, 2) for a, f in zip(three.qdd, paths)}
    lagrangian = three.lagrangian.subs(values)
    for torque, x, v in zip(three.torque, three.q, three.qd):
        momentum = lagrangian.diff(v).subs(rates)
        by_time = momentum.diff(t) - lagrangian.diff(x).subs(rates)
        for moment in (0.3, 0.8):
            found = torque.subs(values).subs(rates).subs(t, moment)
            assert float(found) == pytest.approx(float(by_time.subs(t, moment)), rel=1e-10)


def test_refusals():
    for wrong in (0, 7):
        with pytest.raises(ValueError, match="links must be an integer from 1 to 6"):
            derive(wrong)
    with pytest.raises(ValueError, match="links must be 2"):
        derive(2).base_values(links(3))
