"""Judges of answers that a lesson's own objects decide, on objects whose answers are known."""

from types import SimpleNamespace

import numpy as np

from workshop.chapters import (
    hinton_diagrams,
    inertia_in_the_weights,
    whose_filters,
    window_networks,
)

WIDTH = 21
K = np.arange(WIDTH) - WIDTH // 2
X = 0.01 * K


def judged(module, answer, *given, capsys, number=4):
    module.check(number, answer, *given)
    return capsys.readouterr().out


def test_the_bend_of_a_parabola_has_the_inertia_that_made_its_torque(capsys):
    rng = np.random.default_rng(0)
    a, v, q = rng.normal(size=(3, 50, 2, 1))
    windows = (q + v * X + a * X**2 / 2).reshape(50, -1)
    given = windows, a[..., 0] * (5.0, 2.0), 4.4
    answers = {5.0: "Right: three positions weigh it roughly. The arm's own mean is 4.4 kg",
               500.0: "Wrong: this is torque per bend.", 0.05: "Wrong: the ends are n samples",
               2.5: "Wrong: the bend is a (n", 2.0: "Wrong: this is the elbow's.",
               5.2: "Wrong: close", 7.0: "Wrong: divide the bend"}  # fmt: skip
    for answer, begins in answers.items():
        assert judged(window_networks, answer, *given, capsys=capsys).startswith(begins)


def test_rows_after_a_step_are_judged_with_and_without_the_start(capsys):
    rng = np.random.default_rng(1)
    start, added = rng.normal(size=(6, 2, WIDTH)), 1e-3 * np.ones((6, 2, 1)) * K
    networks = {
        e: [SimpleNamespace(direct_weights=w[:2], hidden_weights=w)]
        for e, w in enumerate((start, start + added))
    }
    rough = np.median(hinton_diagrams.roughness((start + added).reshape(-1, WIDTH)))
    answers = {(rough, 0.0): "Right: training writes", (0.0, rough): "Wrong: the other way round",
               (rough, rough): "Wrong: subtract the start", (0.0, 0.0): "Wrong: take"}  # fmt: skip
    for answer, begins in answers.items():
        assert judged(hinton_diagrams, answer, networks, capsys=capsys).startswith(begins)


def test_the_filter_with_the_recorded_torques_is_found_whatever_its_shape(capsys):
    rng = np.random.default_rng(2)
    windows, true = rng.normal(size=(300, 4)), np.array([1.0, -2.0, 3.0, 0.5])
    windows -= windows.mean(0)
    torque = (windows @ true + 7.0).reshape(2, 150, 1)
    six = np.array([0.5 * true, -true, rng.normal(size=4), 1.1 * true, 1.4 * true, 0 * true])
    answers = {0.1: "Right: filter 4 is the arm's; filter 5 comes next, 0.40.",
               0.5: "Wrong: this filter misses by as much", 2.0: "Wrong: its torques go down",
               0.1 * torque.std(): "Wrong: divide by", 7.0: "Wrong: what do the"}  # fmt: skip
    for answer, begins in answers.items():
        given = answer, six, windows, torque
        assert judged(whose_filters, *given, capsys=capsys, number=3).startswith(begins)


def test_direct_weights_are_weighed_with_slope_and_gains(capsys):
    given = 2000 * X**2, 0.2, 0.5, 0.01, X, 7.0
    moment = 1000 * (X**4).sum()
    mass = moment * 0.2 * 0.5 / 0.01
    answers = {mass: "Right: the whole network has 7.0 kg", 7.0: "Wrong: this is the whole",
               5 * mass: "Wrong: the output's slope", 2 * mass: "Wrong: the second moment",
               0.2 * moment: "Wrong: this is in scaled", 7.0 - mass: "Wrong: this is what the",
               -1.0: "Wrong: take the first part"}  # fmt: skip
    for answer, begins in answers.items():
        text = judged(inertia_in_the_weights, answer, *given, capsys=capsys, number=3)
        assert text.startswith(begins)
