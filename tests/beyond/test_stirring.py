"""Circles, via points and their study: families, what is learnt and asked, the picker's file."""

import itertools

import numpy as np
import pytest

from ddlib.dynamics import CMU_DD_ARM_II as ARM, Unreachable
from ddlib.learning import Scaler, TorqueModel, Weights
from ddlib.setups import JOINT_DAMPING
from ddlib.trajectories import APPENDIX_I, MOTION_SECONDS
from workshop.beyond.studies.loop import motions, stirring
from workshop.beyond.studies.loop.runs import days

T = motions.times()
INSIDE = (T >= 0) & (T < MOTION_SECONDS)
L1, L2 = ARM.lengths


def hand_of(q):
    z = L1 * np.exp(1j * q[..., 0]) + L2 * np.exp(1j * (q[..., 0] + q[..., 1]))
    return np.stack([z.real, z.imag], -1)


class TestCircles:
    def test_members_are_drawn_from_their_ranges(self):
        drawn = motions.random_circles(4000, 3)
        ranges = motions.RADIUS, motions.PERIOD, motions.DISTANCE, motions.BEARING
        names = "radius", "period", "distance", "bearing_deg"
        for name, (low, high) in zip(names, ranges):
            values = getattr(drawn, name)
            assert low <= values.min() < values.max() <= high
            assert values.mean() == pytest.approx((low + high) / 2, abs=0.02 * (high - low))
        assert drawn.clockwise.mean() == pytest.approx(0.5, abs=0.03)
        again = motions.random_circles(4000, 3)
        np.testing.assert_array_equal(again.radius, drawn.radius)

    @pytest.mark.parametrize("elbow", ["negative", "positive"])
    @pytest.mark.parametrize("start", ["jump", "smooth"])
    def test_the_hand_goes_round(self, elbow, start):
        circles = motions.random_circles(20, 1)
        q = motions.stirred(ARM, circles, T, elbow, start).q
        offset = hand_of(q) - circles.centre[:, None]
        np.testing.assert_allclose(
            np.linalg.norm(offset, axis=-1), circles.radius[:, None] + 0 * T, rtol=1e-9
        )
        assert (np.sign(q[..., 1]) == (1 if elbow == "positive" else -1)).all()
        angle = np.unwrap(np.arctan2(offset[..., 1], offset[..., 0]))
        turns = (angle[:, -1] - angle[:, 0]) / (2 * np.pi)
        lasts = MOTION_SECONDS - (motions._RAMP if start == "smooth" else 0)
        wanted = np.where(circles.clockwise, -1, 1) * lasts / circles.period
        np.testing.assert_allclose(turns, wanted, rtol=1e-9)
        farthest = np.linalg.norm(hand_of(q[:, 0]), axis=-1)  # where it begins
        np.testing.assert_allclose(farthest, circles.distance + circles.radius)

    @pytest.mark.parametrize("start", ["jump", "smooth"])
    def test_derivatives_are_those_of_finite_differences(self, start):
        reference = motions.stirred(ARM, motions.random_circles(10, 5), T, start=start)
        inner = np.flatnonzero(INSIDE)[2:-2]
        for x, rate in itertools.pairwise(reference):
            numeric = np.gradient(x, T, axis=1)[:, inner]
            np.testing.assert_allclose(rate[:, inner], numeric, atol=4e-3 * np.abs(rate).max())
        assert not reference.qd[:, ~INSIDE].any() and not reference.qdd[:, ~INSIDE].any()
        jump = np.abs(np.diff(reference.qd, axis=1)).max()
        assert jump < 0.05 if start == "smooth" else jump > 0.2

    def test_circles_out_of_reach_are_refused(self):
        one = np.ones(1)
        far = motions.Circles(0.1 * one, one, 0.85 * one, one, np.array([False]))
        with pytest.raises(Unreachable, match="hand must be"):
            motions.stirred(ARM, far, T)
        for bad in ([0.1], [True, False], [[True]]):
            with pytest.raises(ValueError, match="clockwise must hold"):
                motions.Circles(one, one, one, one, np.array(bad))
        with pytest.raises(ValueError, match="radius"):
            motions.Circles(-one, one, one, one, np.array([True]))

    def test_small_ones_stay_within_the_angles_of_pick_and_place(self):
        q = motions.stirred(ARM, motions._small_circles(200, 0), T).q
        assert -np.pi / 4 < q.min() and q.max() < 0


class TestViaPoints:
    @pytest.mark.parametrize("count", [1, 6])
    def test_they_pass_all_points_at_equal_times(self, count):
        points = motions.random_points(5, count, 0)
        assert (points <= 0).all() and (points >= -np.pi / 4).all()
        when = MOTION_SECONDS * np.arange(count + 2) / (count + 1)
        reference = motions.via_points(points, when)
        np.testing.assert_allclose(reference.q[:, 1:-1], points, atol=1e-12)
        for x in reference:
            np.testing.assert_allclose(x[:, [0, -1]], 0, atol=1e-9)  # rest at both ends
        dense = motions.via_points(points, T)
        inner = np.flatnonzero(INSIDE)[1:-1]  # the jerk jumps where the motion begins and ends
        for x, rate in itertools.pairwise(dense):
            numeric = np.gradient(x, T, axis=1)[:, inner]
            np.testing.assert_allclose(rate[:, inner], numeric, atol=3e-3 * np.abs(rate).max())


def test_pace_is_time_with_its_derivatives():
    np.testing.assert_array_equal(motions._pace(T)[0], np.clip(T, 0, 3))
    gone, rate, change = motions._pace(T, "smooth")
    assert gone[-1] == pytest.approx(3 - motions._RAMP) and rate.max() == 1
    np.testing.assert_allclose(np.gradient(gone, T), rate, atol=3e-5)
    np.testing.assert_allclose(np.gradient(rate, T), change, atol=0.03)
    with pytest.raises(ValueError, match="start must be one of"):
        motions._pace(T, "slow")


def test_as_many_cases_of_each_family():
    runs = days.training(JOINT_DAMPING, [1])[0]
    found = motions.learnt(runs, 11)
    assert list(found) == list(motions.FAMILIES)
    assert {len(cases) for cases in found.values()} == {1500}
    both = found["both"].x
    np.testing.assert_array_equal(both[:750], found["pick and place"].x[::2])
    np.testing.assert_array_equal(both[750:], found["circles"].x[::2])


def test_coverage_tells_a_family_from_its_like():
    tests = motions.asked(JOINT_DAMPING, 6, vias=False)
    found = motions.coverage(JOINT_DAMPING, tests, 6)
    for name in ("circles", "pick and place"):
        cell = found["positions"][name]
        assert cell["other family"]["shared"] < cell["same family"]["shared"]
        assert cell["other family"]["distance"] > 3 * cell["same family"]["distance"]
    same = {"pick and place": tests["circles"], "circles": tests["circles"]}
    found = motions.coverage(JOINT_DAMPING, same, 6)["all"]["circles"]["other family"]
    assert found == {"shared": 1.0, "distance": 0.0}


def test_errors_of_the_hand_are_distances_in_millimetres():
    reference = motions.stirred(ARM, motions.random_circles(2, 0), T)
    torques = np.stack([0 * reference.q, stirring.needed(JOINT_DAMPING, *reference)])
    log = stirring.through(JOINT_DAMPING, torques, reference)
    assert log.q.shape[:2] == (2, 2)
    gap = hand_of(log.q_true) - hand_of(log.reference.q)
    gap = np.sqrt((gap[..., log.motion, :] ** 2).sum(-1).mean(-1)) * 1000
    np.testing.assert_allclose(stirring.off(JOINT_DAMPING, log), gap)
    alone = motions.recorded(JOINT_DAMPING, reference)
    np.testing.assert_allclose(log.q_true[0], alone.q_true, atol=1e-9)  # no torque, no change


def test_the_pickers_file_marks_what_cannot_be_reached(tmp_path, monkeypatch):
    monkeypatch.setattr(stirring, "PICKER", tmp_path / "picker.npz")
    places = {"distance": (0.6, 0.85), "bearing": (-60,), "radius": (0.04, 0.1),
              "period": (2.0,), "elbow": ("negative",)}  # fmt: skip
    scalers = Scaler(-np.ones(2), np.ones(2)), Scaler(-np.ones(2), np.ones(2), (0.2, 0.8))
    weights = Weights.random(1, stirring.WIDTH, initial=0.1)[0]
    model = TorqueModel(weights, *scalers, 0.01)
    stirring._picker(JOINT_DAMPING, {"one": model, "two": model}, places)
    with np.load(stirring.PICKER) as kept:
        assert kept["names"].tolist() == ["none", "exact behind a window", "one", "two"]
        assert kept["reached"].ravel().tolist() == [True, True, True, False]
        assert kept["torque"].shape == (3, 2, 1, 2, 1, 1, 60, 2)
        assert not kept["hand"][:, 1, 0, 1].any() and (kept["hand"][:, 0] > 0).all()
        np.testing.assert_array_equal(kept["torque"][1], kept["torque"][2])


def test_recordings_of_days_do_not_depend_on_one_another():
    three = days.training(JOINT_DAMPING, [4, 0, 7])
    for name, run in days.training(JOINT_DAMPING, [0])[0].items():
        np.testing.assert_array_equal(three[1][name].q, run.q)
        np.testing.assert_array_equal(three[1][name].tau, run.tau)
    one, other = three[0]["pick and place"], three[2]["pick and place"]
    assert (one.tau != other.tau).mean() > 0.9 and (one.q != other.q).any()


def test_a_day_is_recorded_as_alone():
    today = JOINT_DAMPING.repeated(3)
    batch = days.training(JOINT_DAMPING, [3])[0]["pick and place"]
    single = today.record(APPENDIX_I[:5])
    np.testing.assert_array_equal(batch.q_true, single.q_true)
    np.testing.assert_array_equal(batch.q, single.q)
