"""The screening design of Table 4-1 and what it varies, against closed forms."""

from dataclasses import replace
from itertools import combinations

import numpy as np

from ddlib.learning import cases
from ddlib.setups import JOINT_DAMPING
from workshop.report.studies.screening import _Range, _setup, _without_start, screening


def test_places_of_a_range():
    factor, step = _Range(0.5, 8.0), _Range(-1.0, 0.0, logarithmic=False)
    np.testing.assert_allclose(factor.value([-1, 0, 1]), [0.5, 2.0, 8.0])
    np.testing.assert_allclose(step.value([-1, 0, 0.5]), [-1.0, -0.5, -0.25])
    for its in (factor, step):
        np.testing.assert_allclose(its.place(its.value([-0.7, 0.2])), [-0.7, 0.2])


def test_the_design_separates_main_effects_from_all_of_second_order():
    x = screening()
    assert x.shape == (25, 12) and set(np.unique(x)) == {-1.0, 0.0, 1.0}
    np.testing.assert_array_equal(x.T @ x, 22 * np.eye(12))  # main effects from each other
    np.testing.assert_array_equal(x.sum(0), 0)
    second = [x[:, i] * x[:, j] for i, j in combinations(range(12), 2)]
    second = np.column_stack([x**2, *second])
    np.testing.assert_array_equal(x.T @ second, 0)  # and from squares and products
    assert ((x == 0).sum(0) == 3).all()  # each column is in the middle of its range three times
    assert np.linalg.matrix_rank(np.column_stack([np.ones(25), x, x**2])) == 25


def test_joint_damping_lies_inside_the_ranges_but_for_its_steps():
    """Twice the most that were screened: from a small start the solver needs more of them."""
    tuned = {"joint damping": 1, "Coulomb friction": 3, "position gain": 2.5, "encoder bits": 12.5,
             "torque noise": 1, "start left out": 0, "lowest input": 0, "decay": 1e-6,
             "steps": 60}  # fmt: skip
    made = _setup(tuned, "solver")
    level = made.effects.friction[1].level
    np.testing.assert_allclose(level, JOINT_DAMPING.effects.friction[1].level)  # to rounding
    same = replace(made.effects, friction=JOINT_DAMPING.effects.friction)
    assert made.steps == JOINT_DAMPING.steps / 2
    steps = JOINT_DAMPING.steps
    assert replace(made, name=JOINT_DAMPING.name, effects=same, steps=steps) == JOINT_DAMPING


def test_without_its_start_a_recording_has_fewer_cases():
    whole = JOINT_DAMPING.record()
    late = _without_start(whole, 0.25)
    (x, y), (x2, y2) = (cases(r, 11) for r in (whole, late))
    assert len(y) == 6 * 300 and len(y2) == 6 * 275
    np.testing.assert_array_equal(y.reshape(6, 300, 2)[:, 25:], y2.reshape(6, 275, 2))
    np.testing.assert_array_equal(x.reshape(6, 300, 2, 11)[:, 25:], x2.reshape(6, 275, 2, 11))
    np.testing.assert_array_equal(cases(_without_start(whole, 0.0), 11)[1], y)
