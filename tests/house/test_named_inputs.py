"""Inputs that readers gave: what the error says then, in one short line."""

import re
import warnings
from dataclasses import replace

import control
import numpy as np
import pytest

from ddlib import analysis, figures, identification, learning, metrics, simulation, trajectories
from ddlib.control import PID, loop_gain, margins, opened_loop, pd, plant
from ddlib.dynamics import CMU_DD_ARM_II as ARM, Arm, Link, SpatialLink
from ddlib.setups import inside_hull
from ddlib.widgets import NetworkTrainer, TrajectoryPicker

KP, KD = (300.0, 90.0), (60.0, 20.0)
T = trajectories.time_grid(0.002, 0.5)


@pytest.fixture(scope="module")
def runs():
    return simulation.record(ARM, pd(KP, KD), [[45.0, 45.0], [38.0, 32.0], [5.0, 39.0]])


@pytest.fixture(scope="module")
def data(runs):
    return learning.TrainingSet.from_recording(runs, 7)


@pytest.fixture(scope="module")
def model(data):
    weights = learning.Weights.random(2, 7, hidden=3)
    return learning.TorqueModel(weights, data.inputs, data.outputs, data.step)


def refused(error, words, call, *arguments, **named):
    with pytest.raises(error, match=re.escape(words)) as caught:
        call(*arguments, **named)
    told = str(caught.value)
    assert "\n" not in told and len(told) <= 300


def _nan_from(start):
    def law(wanted, q, qd):
        return np.where(start <= law.calls * 0.002, np.nan, 0.0) * np.ones_like(q)

    law.calls = -1

    def counted(wanted, q, qd):
        law.calls += 1
        return law(wanted, q, qd)

    return counted


def test_a_sampled_transfer_function_has_the_margins_of_the_loop_it_describes():
    sampled = control.c2d(loop_gain(1.0, 0.5, 40.0), 0.01)
    ours = margins(opened_loop(plant(1.0, 0.5), 40.0, period=0.01))
    assert margins(sampled) == pytest.approx(ours, rel=1e-6)
    # late by half a period, to first order, against the loop in continuous time
    alone = margins(loop_gain(1.0, 0.5, 40.0))
    lost = np.rad2deg(alone.crossover * 0.01 / 2)
    assert margins(sampled).phase_deg == pytest.approx(alone.phase_deg - lost, abs=0.1)


def test_loops_that_have_no_margins():
    two = control.ss(-np.eye(2), np.eye(2), np.eye(2), 0)
    refused(ValueError, "loop must have one input and one output, got 2", margins, two)
    unknown = control.tf([1.0], [1.0, -0.5], True)
    refused(ValueError, "loop must have a sampling period", margins, unknown)


@pytest.mark.parametrize("seconds", [0, 0.002, -1, 1e9])
def test_a_response_needs_some_periods(seconds):
    for response in (simulation.predicted_response, simulation.simulated_response):
        how = {"viscous": (5.0, 1.0), "seconds": seconds}
        refused(ValueError, "seconds must lie in", response, ARM, PID(KP, kd=KD), **how)


def test_the_link_of_no_body():
    for inertia in (-np.eye(3), np.diag([1.0, 1.0, -1e-3]), np.diag([0, 0, -1e-6])):
        refused(
            ValueError,
            "inertia must have no negative principal moment",
            SpatialLink,
            0.0,
            0.5,
            0.0,
            1.0,
            (0.0, 0.0, 0.0),
            inertia,
        )
    SpatialLink(0.0, 0.5, 0.0, 0.0, (0.0, 0.0, 0.0), np.zeros((3, 3)))


@pytest.mark.parametrize("target", [(-5, 5), (0.2, 1.1), (0.8, 0.2), (0.5, 0.5), (0.2, 0.5, 0.8)])
def test_targets_are_what_a_sigmoid_unit_can_give(runs, target):
    windows, torque = learning.cases(runs, 7)
    refused(ValueError, "target must be", learning.TrainingSet.from_arrays, windows, torque, target)


@pytest.mark.parametrize("start", [0.0, 1.0])
def test_a_controller_that_returns_nan_is_to_blame_and_not_its_gains(start):
    told = f"controller must return finite torques, got NaN at t = {start - 0.5:.3f} s"
    refused(ValueError, told, simulation.record, ARM, _nan_from(start), [30.0, 20.0])
    refused(
        ValueError,
        "lower the gains",
        simulation.record,
        ARM,
        pd((1e6, 1e6), (0.0, 0.0)),
        [30.0, 20.0],
    )


def test_a_frequency_that_samples_do_not_show():
    f = np.array([-1.0, 0.0, 1.0]) / 0.02
    for frequency in (60.0, [1.0, -50.1]):
        refused(
            ValueError,
            "frequencies must not exceed half the sampling rate, 50 Hz",
            analysis.frequency_response,
            f,
            frequency,
            0.01,
        )
    at_the_limit = analysis.frequency_response(f, 50.0, 0.01)
    np.testing.assert_allclose(at_the_limit, 2j * np.sin(np.pi) / 0.02, atol=1e-9)


def test_ridge_without_a_penalty_needs_windows_that_vary(runs):
    t = np.linspace(0, 3, 301)
    q = np.stack([np.sin(2 * t), np.sin(3 * t)], -1)  # windows of two directions each
    windows = learning.sliding_windows(q, 7)
    smooth = learning.TrainingSet.from_arrays(windows, q[3:-3])
    refused(
        ValueError,
        "penalties must be above 0 for these windows, which vary in 4 of 14",
        analysis.ridge_filters,
        smooth,
        [1e-3, 0.0],
    )
    assert np.abs(analysis.ridge_filters(smooth, [1e-3])).max() < 1e3


def test_links_are_links_and_gravity_is_a_number():
    link = Link(4.0, 0.35, 0.16, 0.05)
    for pair in ((tuple(vars(link).values()), link), (link, [4.0, 0.35, 0.16, 0.05])):
        refused(
            TypeError,
            "must be a Link(mass, length, com, inertia), got",
            Arm.from_links,
            "mine",
            *pair,
        )
    for gravity in ("9.81", True, [0, -9.81]):
        refused(
            TypeError,
            "gravity must be a single number, got",
            Arm.from_links,
            "mine",
            link,
            link,
            gravity=gravity,
        )


def test_a_run_and_its_options():
    reference = trajectories.pick_and_place([30.0, 20.0], T)
    law = pd(KP, KD)
    refused(
        ValueError,
        f"log_every must be an integer from 1 to {T.size - 1}, got 10000",
        simulation.follow,
        ARM,
        law,
        reference,
        T,
        log_every=10**4,
    )
    refused(
        TypeError, "reference must be a Trajectory", simulation.follow, ARM, law, reference.q, T
    )
    for option in ({"noise": 3}, {"log_every": 5}):
        refused(
            TypeError,
            f"record has no option '{next(iter(option))}'; it has effects",
            simulation.record,
            ARM,
            law,
            [30.0, 20.0],
            **option,
        )


def test_what_is_wider_than_the_family():
    wide = trajectories.random_extents(3, 1, max_deg=90.0)
    assert wide.max() > 45
    with pytest.warns(trajectories.OutsideFamilyWarning, match="smooth_pick_and_place has no such"):
        trajectories.pick_and_place(wide, T)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        trajectories.smooth_pick_and_place(wide, T)


def test_a_widget_of_too_few_motions_or_of_motions_in_line():
    line = [[10.0, 10.0], [20.0, 20.0], [30.0, 30.0], [20.0, 10.0]]
    few = "must be 4 pairs or more, three to train on and the last one to test, got 3"
    refused(ValueError, few, TrajectoryPicker, trajectories_deg=line[:3])
    refused(ValueError, few, NetworkTrainer, extents_deg=line[:3])
    refused(ValueError, "not all on one line", TrajectoryPicker, trajectories_deg=line)
    same = [[20.0, 10.0]] * 4
    refused(ValueError, "extents_deg must differ", NetworkTrainer, extents_deg=same)
    assert inside_hull([20.0, 20.0]).ndim == 0


def test_calls_that_were_given_the_step_before(runs, data, model):
    filters = np.ones((2, 7))
    for call, error, words in (
        (lambda: identification.least_squares(runs), TypeError, "by_modulation(recording)"),
        (lambda: figures.decomposed(filters, 0.01), ValueError, "functions must have shape"),
        (lambda: figures.hinton(model), TypeError, "weights must be Weights, of a TorqueModel"),
        (lambda: figures.hinton(model.weights), ValueError, "weights must be of one network"),
        (
            lambda: learning.train_ensemble(model.weights[0], data, epochs=2),
            ValueError,
            "weights must have one leading axis of members (of one network: weights[None])",
        ),
        (lambda: analysis.mean_gradient(model.weights, data.x), TypeError, "model must be a Torq"),
    ):
        refused(error, words, call)
    one = learning.train_ensemble(model.weights[0][None], data, epochs=2, progress=False)[0]
    assert one.weights.hidden_bias.shape == (1, 3)


@pytest.mark.parametrize("width", [103, 399, 10**6 + 1])
def test_windows_that_are_too_wide(runs, width):
    words = "width must be at most 101, as the recording has 50 samples beside its motion"
    if width > 400:
        words = "width must not exceed the 400 samples of the recording"
    refused(ValueError, words, learning.TrainingSet.from_recording, runs, width)
    assert len(learning.TrainingSet.from_recording(runs, 101).x) == 900


def test_windows_that_are_too_narrow_for_four_derivatives():
    filters = learning.Weights.random(1, 3).hidden_weights
    refused(ValueError, "f must have 5 samples or more", analysis.shares, filters)
    assert analysis.decompose(filters).odd.shape == filters.shape  # three are enough for parts


def test_a_motor_without_torque_and_a_joint_at_rest_are_named(runs, data, model):
    silent = replace(runs, tau=runs.tau * [1.0, 0.0])  # R11
    still = replace(runs, q=runs.q * [0.0, 1.0])
    for recording, words in (
        (silent, "torque must change at each joint, but joint 2 is 0 throughout"),
        (still, "windows must change at each joint, but joint 1 is 0 throughout"),
    ):
        refused(ValueError, words, learning.TrainingSet.from_recording, recording, 7)
    windows, torque = learning.cases(runs, 7)
    rest = np.full_like(torque, 2.5)
    refused(ValueError, "target must change", metrics.rmss, model.torque(windows), rest)
    test = data.transform(windows, rest)
    for train in (learning.train_ensemble, learning.solve):
        refused(
            ValueError,
            "test must change at each joint, but joint 1 is",
            train,
            model.weights,
            data,
            test=test,
            progress=False,
        )


@pytest.mark.parametrize("bad", [np.nan, np.inf, True, "1", 1j, None, [], [[1.0]], [None], -1.0])
def test_penalties_that_are_none(data, bad):
    refused((TypeError, ValueError), "penalties must", analysis.ridge_filters, data, bad)


@pytest.mark.parametrize("many", [10**9 + 1, 10**18, 10**30])
def test_counts_beyond_any_memory(many):
    for call, name in (
        (lambda: trajectories.random_extents(many, 1), "n"),
        (lambda: learning.Weights.random(many, 7), "members"),
        (lambda: learning.Weights.random(1, many), "width"),
        (lambda: analysis.basis(many), "width"),
        (lambda: learning.surrogates("shifted", np.ones((2, 9, 2)), many), "draws"),
    ):
        refused(ValueError, f"{name} must be an integer", call)
    assert trajectories.random_extents(1, seed=10**30).shape == (1, 2)  # of seeds any will do


def test_arrays_are_taken_in_any_layout_and_of_any_real_kind():
    q, qd = np.random.default_rng(0).uniform(-1, 1, (2, 6, 2))
    wanted = ARM.gravity(q), ARM.kinetic_energy(q, qd)
    layouts = (
        np.asfortranarray,
        lambda x: np.repeat(x, 2, 0)[::2],
        lambda x: x[::-1].copy()[::-1],
        lambda x: x.tolist(),
        lambda x: x.astype(object),
        lambda x: x.astype(">f8"),
    )
    for like in layouts:
        found = ARM.gravity(like(q)), ARM.kinetic_energy(like(q), like(qd))
        for one, other in zip(found, wanted):
            np.testing.assert_allclose(one, other, rtol=1e-15)
