"""Arms of more joints on given motions, and the study of them, cut short."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from ddlib.dynamics import CMU_DD_ARM_II
from ddlib.learning import sliding_windows
from ddlib.metrics import rmss
from ddlib.setups import JOINT_DAMPING, STATE_FEEDBACK
from ddlib.simulation import LOG_STEP
from workshop.beyond.studies.loop import joints as study
from workshop.beyond.studies.loop.chain import REACH, chain, extents, moved, recorded

READINGS = JOINT_DAMPING, STATE_FEEDBACK


@pytest.mark.parametrize("setup", READINGS, ids=lambda setup: setup.name)
def test_each_joint_answers_as_its_own_loop(setup):
    """The oscillator, integrated by another method; the reference jumps where it does."""
    made = chain(2, setup.name)
    answer = made.answer(360, 20)
    omega = np.pi / 3
    gains = setup.controller.kp, getattr(setup.controller, "kd", None)
    kp, kd = (np.zeros(2) if g is None else np.array(g) for g in gains)
    inertia = np.diag(CMU_DD_ARM_II.mass_matrix(np.zeros(2)))
    viscous = np.array(setup.effects.friction[0].coefficient)
    for j in range(2):

        def rate(t, x, j=j):
            moving = 0 <= t < 3
            r, v = -np.sin(omega * t) * moving, -omega * np.cos(omega * t) * moving
            return [
                x[1],
                (kp[j] * (r - x[0]) + kd[j] * (v - x[1]) - viscous[j] * x[1]) / inertia[j],
            ]

        options = {"rtol": 1e-10, "atol": 1e-12, "max_step": 0.01}
        first = solve_ivp(rate, (0, 3 - 1e-12), [0, 0], t_eval=LOG_STEP * np.arange(300), **options)
        np.testing.assert_allclose(answer[20:320, j, :2], first.y.T, atol=1e-6)
        last = solve_ivp(
            rate, (3, 3.39), answer[320, j, :2], t_eval=3 + LOG_STEP * np.arange(39), **options
        )
        np.testing.assert_allclose(answer[320:359, j, :2], last.y.T, atol=1e-6)
    assert not answer[:20].any()


def test_velocity_and_acceleration_are_derivatives():
    states = moved(chain(7), extents(7, 2, 3))[:, REACH + 1 : -REACH - 1]
    rate = (states[:, 2:, :, :2] - states[:, :-2, :, :2]) / (2 * LOG_STEP)
    np.testing.assert_allclose(
        rate, states[:, 1:-1, :, 1:], atol=0.05 * np.abs(states[..., 2]).max()
    )


def test_the_sine_is_the_reports():
    states = moved(chain(2), [[45.0, 30.0]], "sine")[0]
    t = LOG_STEP * (np.arange(len(states)) - REACH)
    np.testing.assert_allclose(states[:, 1, 0], -np.deg2rad(30) * np.sin(np.pi * t / 3), atol=1e-14)


def test_torque_is_the_books_with_friction():
    made, states = chain(2), moved(chain(2), extents(2, 3, 0))
    q, qd, qdd = np.moveaxis(states, -1, 0)
    wanted = CMU_DD_ARM_II.inverse_dynamics(q, qd, qdd) + JOINT_DAMPING.effects.friction_torque(qd)
    np.testing.assert_allclose(made.torque(states), wanted, atol=1e-10)


def test_readings_round_and_noise_is_there():
    made = chain(4)
    drawn = extents(4, 30, 1)
    found, exact = recorded(made, drawn, 1, spacing=1), moved(made, drawn)[..., 0]
    centres = slice(REACH, exact.shape[1] - REACH)
    true = sliding_windows(exact, 2 * REACH + 1, centres)[:, ::2].reshape(found.windows.shape)
    off = found.windows - true
    assert np.abs(off).max() <= made.encoder / 2 * (1 + 1e-9)
    noise = found.torque - made.torque(found.states)
    np.testing.assert_allclose(noise.std(0), made.noise, rtol=0.05)
    few = recorded(made, drawn, 1)
    np.testing.assert_allclose(few.windows, found.windows[..., ::5])


def test_sets_have_as_many_cases_and_none_of_the_test_motions():
    made = chain(3)
    test = study.tested(made)
    assert len(test.torque) == study.CASES
    for motions in (5, 20, 80):
        training = study.sets(made, motions, 1)
        assert len(training.torque) == study.CASES and training.runs == motions
    seen = set(map(tuple, extents(3, 80, 1)))
    assert not seen & set(map(tuple, extents(3, study.TEST_MOTIONS, study.TEST_SEED)))
    np.testing.assert_array_equal(extents(3, 5, 1), extents(3, 80, 1)[:5])


def test_known_structure_knows_the_arm():
    """Without noise and with exact states the equations have nothing left over."""
    made = chain(4)
    made = type(made)(**{**vars(made), "encoder": 1e-12, "noise": np.zeros(4), "smoothing": 1e-9})
    training, test = study.sets(made, 20, 1), study.tested(made)
    _, error = study.identified(made, training, test)
    assert error < 0.12, "what is left is the windows' own error"
    noisy = study.identified(chain(4), study.sets(chain(4), 20, 1), study.tested(chain(4)))[1]
    assert error <= noisy * 1.05


def test_interactions_of_two_joints_by_hand():
    made = chain(2)
    states = study.tested(made).states
    whole = made.torque(states)
    only = states.copy()
    only[:, 1] = 0
    left = whole[:, 0] - made.torque(only)[:, 0]
    found = study.interactions()["2"]
    assert found[0] == pytest.approx(left.std() / whole[:, 0].std())


def test_costs_of_two_joints_are_the_reports():
    first = study.costs()[0]
    assert first["network"] == 524
    assert first["Newton-Euler, this arm"] < first["Newton-Euler, general"]


def test_shuffling_finds_what_is_used():
    x = np.random.default_rng(0).normal(size=(4000, 2, 3))

    def first_only(x):
        return np.stack([x[:, 0, 0], 0 * x[:, 0, 0] + x[:, 1, 2]], -1)

    found = study._shuffled(first_only, x, np.ones(2), 1)
    np.testing.assert_allclose(found, np.sqrt(2) * np.eye(2), atol=0.06)


def test_the_study_cut_short(monkeypatch):
    for name, value in {"STEPS": 2, "SEEDS": 2, "CASES": 60}.items():
        monkeypatch.setattr(study, name, value)
    rows = study.by_motions("joint damping", {2: (5, 10)}, 2)
    assert [r["motions"] for r in rows] == [5, 10] and len(rows[0]["test"]) == 2
    found = study.pairs(seeds=1)
    assert np.shape(found["gains"]["real"]) == (1, 4, 4) == np.shape(found["used"]["unrelated"])
    loops = study.closed_loops(2)
    assert {r["taps"] for r in loops} == {5, 21}
    states, torque = study.random_cube(3, 50, 1)
    assert np.abs(states).max() <= np.pi
    assert float(rmss(chain(3).arm.inverse_dynamics(*np.moveaxis(states, -1, 0)), torque)) == 0
