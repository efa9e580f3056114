"""The benchmarks compare like with like: the same maths, the same arm, the same loop."""

from __future__ import annotations

import json
import sys
import xml.etree.ElementTree as ET

import numpy as np
import pytest
import torch
from book_pages import ROOT
from torch.utils.flop_counter import FlopCounterMode

from ddlib.dynamics import Link
from ddlib.learning import WindowNetwork, autograd, descent
from ddlib.setups import STATE_FEEDBACK

sys.path.insert(0, str(ROOT / "benchmarks"))
import ensembles
import measure
import recordings
import run


def test_works_take_turns_after_one_untimed_call():
    calls = []
    taken = measure.interleaved(2, a=lambda: calls.append("a"), b=lambda: calls.append("b"))
    assert calls == ["a", "b"] * 3 and 0 < taken["a"]["shortest"] <= taken["a"]["median"]


ROWS = [
    (measure.ratio("g", "w", ("x", 1.0), ("y", 8.0), 8.0), True, "met"),
    (measure.ratio("g", "w", ("x", 1.0), ("y", 7.9), 8.0), False, "MISSED"),
    (measure.ratio("g", "w", ("x", 1.0), ("y", 7.9)), None, "times"),
    (measure.limit("g", "w", 2.0, "GiB", 2.0), True, "met"),
    (measure.limit("g", "w", 2.1, "GiB", 2.0), False, "MISSED"),
    (measure.not_measured("g", "w", "no reason"), None, "reason"),
]


def test_a_target_is_met_or_not():
    told = [(measure.met(row), run.text(row).split()[-1]) for row, *_ in ROWS]
    assert told == [(fine, word) for _, fine, word in ROWS]


@pytest.mark.parametrize("width", [11, 21])
def test_operations_are_those_that_torch_counts(width):
    network, cases = WindowNetwork(width), 50
    with FlopCounterMode(display=False) as counter:
        network(torch.rand(cases, 2, width)).sum().backward()
    biases = 4 * cases * (10 + 2)  # a column of ones in the ensemble, additions in the module
    ours = ensembles.floating_point_operations(cases, width, 10, 2)
    assert ours - biases == counter.get_total_flops()


def test_the_eager_loop_is_the_reference():
    rng = np.random.default_rng(0)
    x, y = rng.random((40, 2, 5)), rng.random((40, 2))
    ours, reference = WindowNetwork(5), WindowNetwork(5)
    tensors = (torch.as_tensor(array, dtype=torch.float32) for array in (x, y))
    ensembles.eager_loop(ours, *tensors, rate=2.0, momentum=0.9, epochs=30)
    autograd.train(reference, x, y, rate=2.0, momentum=0.9, epochs=30, progress=False)
    for a, b in zip(ours.parameters(), reference.parameters()):
        torch.testing.assert_close(a, b)


def test_a_warm_up_is_that_of_the_ensemble():
    data, x, y = ensembles.training_set(5)
    options = dict(rate=4.0, momentum=0.98, epochs=40, warm_up=20)
    network = WindowNetwork(5)
    weights = ensembles.Weights.stack([network.weights()])
    ensembles.eager_loop(network, x, y, **options)
    model, *_ = descent.train_ensemble(weights, data, progress=False, **options)
    np.testing.assert_allclose(
        model.weights.hidden_weights[0], network.weights().hidden_weights, atol=1e-4
    )


def test_mujoco_gets_the_same_arm():
    """Masses, centres and inertias of the model give the arm's base parameters."""
    arm = STATE_FEEDBACK.arm
    root = ET.fromstring(recordings.mjcf(arm, "RK4", friction=True))
    upper, fore = root.findall(".//body")
    links = []
    for body in (upper, fore):
        inertial = body.find("inertial")
        com, length = float(inertial.get("pos").split()[0]), arm.lengths[len(links)]
        inertia = float(inertial.get("diaginertia").split()[2])
        links.append(Link(float(inertial.get("mass")), length, com, inertia))
    assert float(fore.get("pos").split()[0]) == arm.lengths[0]
    made = type(arm).from_links("MuJoCo's", *links)
    np.testing.assert_allclose((made.a, made.b, made.d), (arm.a, arm.b, arm.d), rtol=1e-14)
    viscous, coulomb = STATE_FEEDBACK.effects.friction
    joints = root.findall(".//joint")
    assert tuple(float(j.get("damping")) for j in joints) == viscous.coefficient
    assert tuple(float(j.get("frictionloss")) for j in joints) == coulomb.level


@pytest.mark.parametrize("written", [recordings.Written, recordings.Textbook])
@pytest.mark.parametrize("quantised", [True, False])
def test_python_control_repeats_our_loop(quantised, written):
    t, u, start = recordings.commands()
    loop = recordings.sampled_system(written())
    theirs = recordings.respond(loop, t, u, start, params={"quantised": quantised})
    off = ("torque_sensor",) if quantised else ("torque_sensor", "encoder")
    ours = recordings.ours(1, STATE_FEEDBACK.effects.without(*off), log_step=0.002)
    np.testing.assert_allclose(theirs, ours.q_true[0], atol=1e-12)


def test_a_part_that_fails_writes_nothing(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(run.results, "FOLDER", tmp_path)
    monkeypatch.setattr(run, "PARTS", {"good": None, "bad": None})
    row = measure.limit("g", "w", 1.0, "s", 2.0)
    monkeypatch.setattr(run, "run", lambda part: [row] if part == "good" else None)
    monkeypatch.setattr(sys, "argv", ["run.py"])
    with pytest.raises(SystemExit, match="failed: bad"):
        run.main()
    assert "met" in capsys.readouterr().out
    assert not list(tmp_path.iterdir())
    monkeypatch.setattr(run, "PARTS", {"good": None})
    run.main()
    content = json.loads((tmp_path / "benchmarks.json").read_text())
    assert content["rows"] == [row]
    assert {"date", "processor", "cores", "seconds"} <= set(content["made by"])
