"""Filters that are learnt with the equations: known ones are found, and parameters beside them."""

from dataclasses import replace

import numpy as np

from ddlib import identification
from ddlib.dynamics import Arm
from ddlib.identification import FRICTION, RIGID, FilteredEquations, joint_columns, joint_terms
from ddlib.learning import cases, sliding_windows
from ddlib.setups import JOINT_DAMPING, split

WIDTH, STEP, TRUE = 7, 0.01, np.array([5.0, 0.6, 0.7])
# Filters of the right scale, a sample late: far from Savitzky and Golay's
LATE = np.array([[0, 0, 1, 0, 0, 0, 0], [0, -50, 0, 50, 0, 0, 0], [2500, 0, -5000, 0, 2500, 0, 0]])


def regressor(states):
    return Arm.regressor(*np.moveaxis(states, -1, 0))[..., :3]


def made(runs, tau, pull=1.0, step=STEP, of=RIGID, **options):
    return FilteredEquations(of, WIDTH, step, pull, **options).fit(runs, tau)


def motions(runs, samples=200):
    rough = 0.02 * np.random.default_rng(1).standard_normal((runs, samples, 2)).cumsum(1)
    return list(np.sin(np.outer(np.arange(samples), [0.05, 0.08])) + rough)


def known(runs, samples=200):
    windows = [sliding_windows(q, WIDTH) for q in motions(runs, samples)]
    return windows, [regressor(x @ LATE.T) @ TRUE for x in windows]


def test_known_filters_and_parameters_are_found():
    found = made(*known(3), 1e-9, of=regressor)
    np.testing.assert_allclose(found.filters, LATE, atol=0.1, rtol=1e-4)
    np.testing.assert_allclose(found.filters[0], LATE[0], atol=1e-4)
    np.testing.assert_allclose(found.estimate.values, TRUE, rtol=1e-4)


def test_only_what_is_to_be_learnt_is_and_keeps_its_scale():
    found = made(*known(3), 1e-3, of=regressor, learn=("velocity",))
    np.testing.assert_array_equal(found.filters[[0, 2]], found.first[[0, 2]])
    np.testing.assert_allclose(found.filters[1] @ np.arange(WIDTH) * STEP, 1)
    assert found.filter_errors[1].min() > 0 == found.filter_errors[0].max()


def test_recordings_positions_and_windows_are_the_same_runs():
    recording = split(JOINT_DAMPING.record())[0][:2]
    around = slice(recording.motion.start - WIDTH // 2, recording.motion.stop + WIDTH // 2)
    positions, tau = recording.q[:, around], recording.tau[:, around]
    (x, y), found = cases(recording, WIDTH), made(recording, None)
    for same in (made(positions, tau), made(np.split(x, 2), np.split(y, 2))):
        np.testing.assert_allclose(same.filters, found.filters)
    np.testing.assert_allclose(found.predict(recording), found.predict(x).reshape(2, -1, 2))
    np.testing.assert_allclose(found.predict(recording)[1], found.predict(positions[1]))


def test_parameters_of_a_simulated_arm_without_the_bias_of_smoothing():
    training, _ = split(JOINT_DAMPING.repeated(1).record())
    simulated, off = (JOINT_DAMPING.arm, JOINT_DAMPING.effects, RIGID + FRICTION), []
    true = identification.true_parameters(*simulated)
    for learn in (("position", "velocity", "acceleration"), ()):
        arm = FilteredEquations(RIGID + FRICTION, 31, training.step, 1e-3, learn).fit(training)
        off.append(np.abs(np.array([*arm.parameters.values()]) / true - 1))
    assert (off[0] < off[1]).all() and off[0][0] < 0.06 < 0.3 < off[1][0]


def test_errors_are_the_scatter_if_neighbours_share_the_noise():
    windows, tau = known(2)
    rng, inside, narrow = np.random.default_rng(5), [], []
    for _ in range(40):
        white = rng.normal(0, 2, (2, len(tau[0]) + 4, 2))
        noisy = tau + sum(white[:, k : k + len(tau[0])] for k in range(5))
        found = made(windows, noisy, 1e-6, of=regressor)
        assert np.isnan(found.estimate.half_width()).all(), "with noisy positions it would not hold"
        half = replace(found.estimate, unsure=None).half_width()
        low, high = found.estimate.values - half, found.estimate.values + half
        inside.append((low <= TRUE) & (TRUE <= high))
        narrow.append(np.abs(low + high - 2 * TRUE) <= (high - low) / np.sqrt(5))
    assert 0.87 <= np.mean(inside) <= 0.99 and np.mean(narrow) < 0.8


def test_the_pull_is_the_best_on_runs_left_out():
    windows, tau = known(3, 60)
    tau = np.array(tau) + np.random.default_rng(0).normal(0, 9, np.shape(tau))
    wrong = {10.0**-k: 0.0 for k in range(6)}
    for pull, out in ((pull, out) for pull in wrong for out in range(3)):
        found = made(*(np.delete(x, out, 0) for x in (windows, tau)), pull, of=regressor)
        wrong[pull] += np.sum(((found.predict(windows[out]) - tau[out]) / tau.std((0, 1))) ** 2)
    chosen = made(windows, tau, None, of=regressor).pull
    assert chosen == min(wrong, key=wrong.get) and 1e-5 < chosen < 1  # at neither end


def test_columns_by_name_are_parameters_of_each_joint():
    x, y = np.split(np.random.default_rng(3).normal(size=(150, 6, WIDTH + 1)), [WIDTH], -1)
    y = y[..., 0]
    found = made([x], [y], of=joint_terms, learn=())
    row = [v for name, v in found.parameters.items() if name.endswith("joint 3")]
    expected = np.linalg.lstsq(joint_columns(x @ found.first.T, 2), y[:, 2])[0]
    np.testing.assert_allclose(row, expected, rtol=1e-6, atol=1e-9)
