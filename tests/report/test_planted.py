"""Planted numbers are read back, and knobs move torques by what they are said to; made small."""

from dataclasses import replace

import numpy as np
import pytest

from ddlib.analysis import calibrated, gains, mean_gradient
from ddlib.dynamics import CMU_DD_ARM_II, IMI_ARM
from ddlib.learning import Scaler, TorqueModel, Weights
from ddlib.setups import JOINT_DAMPING
from ddlib.simulation import LOG_STEP
from workshop.report import known_torques, pencil
from workshop.report.studies import planted as study

WIDTH = 21
X = LOG_STEP * (np.arange(WIDTH) - WIDTH // 2)


@pytest.fixture(scope="module")
def day():
    setup = replace(JOINT_DAMPING, steps=0, decay=0.0, warm_up=500, epochs=4000)
    return known_torques.Day(setup.repeated(3), WIDTH)


@pytest.fixture(scope="module")
def kinds(day):
    return day.kinds(2, seed=5)


def test_filters_of_least_energy_have_one_moment_each():
    filters = pencil.moment_filters(WIDTH, LOG_STEP)
    assert gains(filters, LOG_STEP) == pytest.approx(np.eye(3), abs=1e-9)
    moments = np.stack([X**0, X, X**2 / 2, X**3 / 6])
    least = np.linalg.pinv(moments)[:, :3].T
    assert filters == pytest.approx(least, rel=1e-6, abs=1e-6)


def test_what_is_written_by_pencil_is_read_and_answers_the_knobs(day):
    """Read within 2 %; the knobs' answers within a fifth of 1, on both motions and joints."""
    kind = study.control_kind(day)
    model = study.by_pencil(day, kind, 1.0, 2, seed=7)
    read = gains(mean_gradient(model, day.windows), LOG_STEP)
    largest = np.abs(study.CONTROL).max((0, 1))
    assert np.abs(read - study.CONTROL).max((0, 1, 2)) / largest == pytest.approx(0, abs=0.02)
    row = study.described(day, kind, model)
    assert (row["error"] < 0.2).all()
    answers = row["knobs"]["moment"]
    assert answers == pytest.approx(np.ones_like(answers), abs=0.2)


def test_held_direct_weights_keep_their_half_and_hidden_units_add_the_other(day):
    """Within a quarter of the largest entry: the study finds 18 %, no finding would be a half."""
    kind = study.control_kind(day)
    half = study.by_pencil(day, kind, 0.5, 2, seed=7)
    model = study.hidden_trained(day, kind, half)
    assert model.weights.direct_weights == pytest.approx(half.weights.direct_weights, rel=1e-5)
    largest = np.abs(study.CONTROL).max((0, 1))
    direct = calibrated(model, day.windows, LOG_STEP).direct
    assert np.abs(direct - study.CONTROL / 2).max((0, 1, 2)) / largest == pytest.approx(0, abs=0.1)
    read = gains(mean_gradient(model, day.windows), LOG_STEP)
    assert np.abs(read - study.CONTROL).max((0, 1, 2)) / largest == pytest.approx(0, abs=0.25)
    assert (read - direct)[:, 0, 0, 2].min() > 0.3 * study.CONTROL[0, 0, 2]


def test_networks_tell_the_arm_from_a_spring_by_size_and_knob(day, kinds):
    some = {name: kinds[name] for name in (known_torques.ARM, "position alone")}
    rows = {
        name: study.described(day, some[name], model, start, more=True)
        for name, model, start in day.learnt(some, 2, "descent", seed=1)
    }
    arm, spring = rows.values()
    assert arm["read"][:, 0, 0, 2] == pytest.approx(6.4, rel=0.25)
    assert np.abs(spring["read"][:, 0, 0, 2]).max() < 0.3
    assert arm["knobs"]["shape"][:, 2].min() > 0.7
    stiffness = some["position alone"].stiffness[0, 0]
    leak = -stiffness * (X**2).mean() / 2 / 6.4  # a parabola against the constant's second moment
    assert spring["knobs"]["shape"][:, 2, :, 0] == pytest.approx(np.full((2, 2), leak), abs=0.02)
    assert spring["knobs"]["shape"][:, 0].min() > 0.8
    both = sum(arm["one layer"].values())[:, 2]
    assert both == pytest.approx(arm["knobs"]["shape"][:, 2], abs=0.05)
    assert arm["together"][..., 2] == pytest.approx(arm["knobs"]["shape"][:, 2], abs=0.1)


def test_a_knob_turns_one_part_and_leaves_a_window_of_zeros_alone():
    weights = Weights.random(2, WIDTH, hidden=3, initial=0.5, seed=1)
    scalers = Scaler(np.array([-1.0, -0.5]), np.array([0.5, 1.5])), Scaler(-np.ones(2), np.ones(2))
    model, zeros = TorqueModel(weights, *scalers), np.zeros((1, 2, WIDTH))
    for pairs in pencil.knobs(WIDTH).values():
        measures = pairs[0]
        assert measures @ pairs[1].T == pytest.approx(np.eye(3), abs=1e-9)
        for k, knob in enumerate(zip(*pairs)):
            turned = pencil.turned(model, knob, 1.2, ("hidden",))
            assert turned.torque(zeros) == pytest.approx(model.torque(zeros))
            assert np.array_equal(turned.weights.direct_weights, weights.direct_weights)
            before, after = (w.hidden_weights @ measures.T for w in (weights, turned.weights))
            wanted = np.where(np.arange(3) == k, 1.2, 1.0) * before
            assert after == pytest.approx(wanted)


def test_kinds_hold_what_they_say(day, kinds):
    q, qd, qdd = np.moveaxis(day.states, -1, 0)
    arm, spring, other = (
        kinds[name]
        for name in (known_torques.ARM, "position alone", "another arm along this motion")
    )
    k, b, m = spring.terms(day.states)
    assert spring.torque[0] == pytest.approx(k)
    assert k.std(0) == pytest.approx(day.torque.std(0))
    assert b + m == pytest.approx(
        CMU_DD_ARM_II.inverse_dynamics(q, 0 * qd, qdd) + qd * [5.3, 1.1], abs=1e-9
    )
    assert arm.truth(day.states)[..., 2] == pytest.approx(CMU_DD_ARM_II.mass_matrix(q).mean(0))
    assert other.truth(day.states)[..., 2] == pytest.approx(IMI_ARM.mass_matrix(q).mean(0))
    assert not other.truth(day.states)[..., :2].any()
    for name in ("shifted", "random phases", "smooth at random"):
        draws = kinds[name].torque
        assert not kinds[name].truth(day.states).any() and len(draws) == 2
        assert draws.std(1) == pytest.approx(np.tile(day.torque.std(0), (2, 1)), rel=1e-6)
        assert abs(np.corrcoef(draws[0, :, 0], draws[1, :, 0])[0, 1]) < 0.9


def test_intervals_are_of_recordings_and_extremes_of_networks():
    days = [{"x": np.array([1.0, 3.0])}, {"x": np.array([4.0, 6.0])}, {"x": np.array([7.0, 9.0])}]
    found = study.summary(days, True)["x"]
    assert found["mean"] == 5 and (found["least"], found["most"]) == (1, 9)
    assert found["half"] == pytest.approx(4.3027 * 3 / np.sqrt(3), rel=1e-4)
    assert set(study.summary(days, False)["x"]) == {"mean", "half"}
