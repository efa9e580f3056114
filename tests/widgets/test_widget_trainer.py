"""The network trained in the page: its course against ddlib, and its page."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
import torch
from traitlets import TraitError, link
from widget_pages import (
    BRIDGE,
    NEXT_FRAME,
    copied,
    drag,
    flat,
    functions,
    linked,
    page_of,
    write,
)

from ddlib.analysis import CLASSES, classify, gains, mean_gradient
from ddlib.dynamics import CMU_DD_ARM_II, with_load
from ddlib.learning import Descent, TorqueModel, cases, default_rate
from ddlib.metrics import rmss
from ddlib.setups import JOINT_DAMPING
from ddlib.simulation import LOG_STEP
from ddlib.trajectories import APPENDIX_I
from ddlib.widgets import NetworkTrainer
from ddlib.widgets.engine import trainer
from workshop.report import results
from workshop.report.studies.page import training as study

SCHOOL = """([spec, book, choice, epochs]) => {
  book = { positions: Float64Array.from(book[0]), torques: Float64Array.from(book[1]) };
  const school = schoolOf(spec, choice, casesOf(spec, book, choice));
  for (let k = 0; k < epochs; k++) school.advance();
  const { outputs, error } = school.judge();
  return {
    all: [...school.net.all], error, events: school.events, names: school.names,
    inertia: school.inertia(), arm: school.model.arm,
    training: [...school.training].filter((x) => x === x),
  };
}"""
RECORD = """([spec, book, noise, extents]) => {
  book = { positions: Float64Array.from(book[0]), torques: Float64Array.from(book[1]) };
  const { positions, torques } = recordingAt(spec, book, noise, extents);
  return [[...positions], [...torques]];
}"""
STATE = """() => {
  const { school } = document.querySelector(".ddlib-trainer");
  return { epoch: school.epoch, weight: school.net.all[0], events: school.events };
}"""
REACHED = "document.querySelector('.ddlib-trainer').school.epoch >= %d"
CODE = "{extents} {scaling} {shifted} {seed} {rate} {momentum} {epochs}"


@pytest.fixture(scope="module")
def widget():
    return NetworkTrainer(code=CODE)


@pytest.fixture(scope="module")
def evaluate(browser):
    with functions(browser, "elements.js", "experiment.js", "trainer.js") as call:
        yield call


def book(widget):
    """Encoder steps and torques of the book's recording."""
    kept = (widget.positions, "<i2"), (widget.torques, "<f4")
    return [np.frombuffer(*one).astype(float).tolist() for one in kept]


def taught(evaluate, widget, epochs, seed=1, inputs="centred", shift=None, step=1.0, momentum=0.98):
    choice = {"seed": seed, "inputs": inputs, "shift": shift, "step": step, "momentum": momentum}
    return evaluate(SCHOOL, [widget.spec, book(widget), choice, epochs])


# The training


@pytest.mark.browser
@pytest.mark.parametrize(
    "inputs, shift, momentum",
    [("centred", None, 0.98), ("printed", None, 0.9), ("centred", 3, 0.0)],
)
def test_the_course_is_ddlibs(evaluate, widget, monkeypatch, inputs, shift, momentum):
    """Weights, errors, names and events of the first epochs, in double precision."""
    monkeypatch.setattr("ddlib.learning.descent._tensor", torch.tensor)
    monkeypatch.setattr("ddlib.learning._packed._HAS_ONEDNN", False)  # single precision alone
    epochs, seed = 60, 7
    page = taught(evaluate, widget, epochs, seed, inputs, shift, momentum=momentum)
    data, _, test = study._page_set(trainer._SCALINGS[inputs], shift)
    start = trainer.first_weights(seed)
    descent = Descent(start, data.x, data.y, default_rate(21) / len(data.x), momentum)
    for matrix in ("back", "delta"):
        setattr(descent, matrix, getattr(descent, matrix).double())
    errors = []
    for k in range(epochs + 1):
        if k % trainer.CHECK == 0:
            square = np.square(descent.weights()[0].activity(data.x)[1] - data.y).mean(0)
            errors.append(np.sqrt((square / data.y.var(0)).mean()))
        if k < epochs:
            descent.epoch()
    weights = descent.weights()[0]
    np.testing.assert_allclose(page["all"], flat(weights), atol=1e-6)
    np.testing.assert_allclose(page["training"], errors, atol=1e-6)
    output = weights.activity(test[0])[1]
    assert page["error"] == pytest.approx(rmss(output, test[1]), abs=1e-6)
    for layer in ("direct", "hidden"):
        f = getattr(weights, f"{layer}_weights")
        assert page["names"][layer] == [CLASSES.index(name) for name in classify(f).ravel()]
    # the inertia, by the mean gradient over the windows that the network has seen
    windows = data.inputs.unscale(data.x, -2)
    model = TorqueModel(weights, data.inputs, data.outputs)
    inertia = gains(mean_gradient(model, windows), LOG_STEP)[0, 0, 2]
    assert page["inertia"] == pytest.approx(inertia, rel=1e-4)
    own = JOINT_DAMPING.arm.mass_matrix(windows[..., 10])[:, 0, 0].mean()
    assert page["arm"] == pytest.approx(own, rel=1e-9)


@pytest.mark.browser
def test_a_readers_own_arm_window_and_trajectories(evaluate):
    """With a load in the hand: what the page is told to learn from, and the mass to be found."""
    own = replace(JOINT_DAMPING, arm=with_load(CMU_DD_ARM_II, 4.0))
    extents = [(60.0, 10.0), (20.0, 30.0), (40.0, 40.0), (20.0, 5.0)]
    widget = NetworkTrainer(own, extents, width=11, hidden=3)
    page = taught(evaluate, widget, 20)
    weights = trainer.first_weights(1, 11, 3)
    assert len(page["all"]) == flat(weights[0]).size
    recording = own.record(extents)
    windows, _ = cases(recording[:-1], 11)
    heavier = own.arm.mass_matrix(windows[::5][..., 5])[:, 0, 0].mean()
    assert page["arm"] == pytest.approx(heavier, rel=1e-9) and heavier > 8
    assert widget.spec["most"] == 60 and "trajectory 4" in widget.still_alt
    noise = np.frombuffer(widget.noise, "<f4").tolist()
    other = [*extents[:-1], (30.0, 25.5)]
    positions, _ = evaluate(RECORD, [widget.spec, book(widget), noise, other])
    motion, read = recording.motion, own.record(other).q[-1]
    seen = read[motion.start - 5 : motion.stop + 5] / widget.spec["encoder"]
    assert np.abs(np.reshape(positions, (4, -1, 2))[-1] - seen).max() < 1.01


@pytest.mark.browser
def test_the_page_records_as_the_set_up_does(evaluate, widget):
    """Encoder steps and torques of other trajectories, with the same noise."""
    extents = APPENDIX_I.copy()
    extents[[0, 3, 5]] = [(12.5, 40), (44.9, 8), (30, 25.5)]
    noise = np.frombuffer(widget.noise, "<f4").tolist()
    given = [widget.spec, book(widget), noise, extents.tolist()]
    positions, torques = map(np.array, evaluate(RECORD, given))
    recording = JOINT_DAMPING.record(extents)
    motion, (encoder,) = recording.motion, JOINT_DAMPING.effects.encoder
    seen = recording.q[:, motion.start - 10 : motion.stop + 10] / encoder.step
    assert (np.round(seen).ravel() == positions).mean() > 0.999  # one may lie between two steps
    np.testing.assert_allclose(torques, recording.tau[:, motion].ravel(), atol=1e-3)
    assert np.abs(recording.tau - recording.tau_true).max() > 0.3


@pytest.mark.browser
def test_names_follow_the_rule(evaluate, widget):
    rng = np.random.default_rng(0)
    x = np.linspace(-1, 1, 21)
    rough = rng.normal(size=(200, 21)) * rng.uniform(0, 0.5, (200, 1))
    smooth = rng.normal(size=(200, 4)) @ np.vander(x, 4).T
    f = [*(rough + smooth), *results.networks(21).weights.hidden_weights.reshape(-1, 21)[:200]]
    got = evaluate(
        "([all, basis]) => all.map((f) => classOf(f, basis))",
        [[one.tolist() for one in f], widget.spec["basis"]],
    )
    wanted = [CLASSES.index(str(classify(one))) for one in f]
    assert got == wanted and len(set(wanted)) >= 6


LOCKED = "Train (guess first)"

# In a page without a kernel


@pytest.mark.browser
def test_nothing_moves_before_a_guess(page_with, widget):
    page = page_with(widget, calm=True)
    for name in (LOCKED, "Step"):
        assert page.get_by_role("button", name=name, exact=True).is_disabled()
    assert page.evaluate(STATE)["epoch"] == 0
    page.get_by_role("button", name="Direct weights measure").click()
    page.wait_for_function(REACHED % 4)
    page.get_by_role("button", name="Pause").click()
    paused = page.evaluate(STATE)
    page.evaluate(NEXT_FRAME)
    assert page.evaluate(STATE) == paused
    assert f"Epoch {paused['epoch']}." in page.locator(".status").inner_text()
    page.get_by_role("button", name="Step").click()
    assert page.evaluate(STATE)["epoch"] == paused["epoch"] + 1
    page.get_by_role("button", name="Train", exact=True).click()
    page.wait_for_function("document.querySelector('.ddlib-trainer').school.events.some(Number)")
    page.get_by_role("button", name="Pause").click()
    first = min(filter(None, page.evaluate(STATE)["events"]))
    said = page.locator(".verdict").inner_text()
    assert f"came first, at epoch {first}" in said and said.startswith("Your guess: Direct")
    page.get_by_label("Torques").select_option("shifted")
    assert page.evaluate(STATE)["epoch"] == 0 and not page.locator(".verdict").inner_text()
    assert page.get_by_role("button", name=LOCKED, exact=True).is_disabled()


@pytest.mark.browser
def test_a_link_restores_settings_and_epoch(page_with, widget):
    query = "?trainer=seed:2,inputs:centred,momentum:0.9,guess:2,epoch:40"
    page = page_with(widget, query=query, calm=True)
    page.wait_for_function(REACHED % 40)
    page.get_by_role("button", name="Step").click()
    wanted = page.evaluate(STATE)
    page.wait_for_function("location.search.includes('epoch:41')")
    again = page_with(widget, query=page.evaluate("location.search"), calm=True)
    again.wait_for_function(REACHED % 41)
    assert again.evaluate(STATE) == wanted
    rate = f"{trainer.default_rate(21):.12g}"
    known = ", ".join(f"({a:g}, {b:g})" for a, b in APPENDIX_I)
    assert copied(again) == f"[{known}] (-1, 1) None 2 {rate} 0.9 41"


@pytest.mark.browser
def test_a_readers_own_experiment(page_with, capsys):
    """Other extents, recorded and learnt in the page: error and inertia of the code it copies."""
    widget = NetworkTrainer(epochs=400)
    page = page_with(widget, calm=True)
    recorded = page.locator(".recorded")
    page.get_by_text("Your own experiment").click()
    assert "Appendix I" in recorded.inner_text()
    write(page.get_by_label("shoulder in trajectory 1"), "30.5")
    page.locator(".pad").scroll_into_view_if_needed()
    _, down = drag(page, page.locator(".pad .frame").bounding_box(), (20.9 / 45, 1), (0.5, 0.5))
    dragged = page.get_by_label("elbow in trajectory 4").input_value()
    assert float(dragged) == round(45 * (1 - down), 1)
    assert "not recorded" in recorded.inner_text()
    page.get_by_role("button", name="Record and train").click()  # without a guess
    page.wait_for_function(REACHED % 400)
    assert recorded.inner_text() == "Recorded in your browser."
    exec(copied(page), {})
    *errors, inertia = re.findall(r"\d+\.\d+", capsys.readouterr().out)
    told = page.locator(".weighed b").all_inner_texts()
    assert told[0].startswith(f"{inertia} kg m² (the arm: 6.4)")
    assert float(told[1]) == pytest.approx(float(errors[1]), rel=0.02)

    page.goto(copied(page, "Link"))
    page.wait_for_function(REACHED % 400)
    assert page.locator(".weighed b").all_inner_texts() == told
    write(page.get_by_label("elbow in trajectory 2"), "50")
    page.get_by_label("elbow in trajectory 2").press("Tab")
    assert page.get_by_label("elbow in trajectory 2").input_value() == "32.2"
    write(page.get_by_label("elbow in trajectory 1"), "0")
    page.get_by_role("button", name="1 to 5 alike").click()
    assert "must move" in recorded.inner_text()
    assert page.get_by_role("button", name="Record and train").is_disabled()
    page.get_by_role("button", name="Appendix I").click()
    page.get_by_role("button", name="Record and train").click()
    assert "Appendix I" in recorded.inner_text()


# Driven from Python


@pytest.fixture(scope="module")
def driven(browser, tmp_path_factory):
    """A widget, its page, and a function that lets messages pass until something holds."""
    trainer_ = NetworkTrainer(epochs=60, code=CODE)
    url = page_of(tmp_path_factory.mktemp("driven") / "page.html", trainer_, extra=BRIDGE)
    with linked(browser, url, trainer_) as (page, settle):
        yield trainer_, page, settle


@pytest.mark.browser
def test_python_sets_the_choices_and_reads_what_comes_out(driven):
    """Weights of the same descent by ddlib; error and inertia of the model that is handed out."""
    own, page, settle = driven
    settle(lambda: own.weights is not None)
    np.testing.assert_array_equal(flat(own.weights), flat(trainer.first_weights(1)[0]))
    seen = []
    own.observe(lambda change: seen.append(change["new"]), "error")
    own.seed, own.inputs, own.momentum, own.epoch = 7, "centred", 0.9, 40
    assert own.error is None and own.model is None  # not yet computed
    settle(lambda: own.error is not None)
    assert page.evaluate(STATE)["epoch"] == own.epoch == 40 and seen[-1] == own.error
    data, _, _ = study._page_set(trainer._SCALINGS["centred"], None)
    descent = Descent(trainer.first_weights(7), data.x, data.y, default_rate(21) / len(data.x), 0.9)
    for _ in range(40):
        descent.epoch()
    np.testing.assert_allclose(flat(own.weights), flat(descent.weights()[0]), atol=2e-5)
    recording = JOINT_DAMPING.record(APPENDIX_I)
    windows, torque = cases(recording[-1], 21)
    apart = (own.model.torque(windows) - torque) / torque.std(0)
    assert own.error == pytest.approx(np.sqrt((apart**2).mean()), rel=1e-3)
    seen_in_training = data.inputs.unscale(data.x, -2)
    inertia = gains(mean_gradient(own.model, seen_in_training), 0.01)[0, 0, 2]
    assert own.inertia == pytest.approx(inertia, rel=1e-3)
    assert own.training_error == pytest.approx(
        page.evaluate("document.querySelector('.ddlib-trainer').school.trained()")
    )


@pytest.mark.browser
def test_python_sets_extents_and_the_page_records_them(driven):
    own, page, settle = driven
    other = APPENDIX_I.copy()
    other[[0, 5]] = [(12.5, 40), (30, 25.5)]
    own.epoch = 20
    own.extents_deg = other
    settle(lambda: own.error is not None)
    assert "Recorded in your browser." in page.locator(".recorded").text_content()
    assert page.get_by_label("shoulder in trajectory 1").input_value() == "12.5"
    assert page.evaluate(STATE)["epoch"] == 20
    recording = JOINT_DAMPING.record(other)
    high = recording[:-1].q[:, recording.motion.start - 10 : recording.motion.stop + 10].max((0, 1))
    np.testing.assert_allclose(own.model.inputs.high, high, atol=2e-4)


@pytest.mark.browser
def test_python_hears_what_the_reader_does(driven):
    own, page, settle = driven
    settle(lambda: own.weights is not None)
    other = NetworkTrainer(epochs=60)
    with_other = link((own, "seed"), (other, "seed"))
    page.get_by_role("button", name="New weights").click()
    page.get_by_text("Your own experiment").click()
    settle(lambda: own.weights is not None and own.epoch == 0)
    assert other.seed == own.seed
    page.get_by_role("button", name="Record and train").click()
    settle(lambda: own.epoch == 60 and own.error is not None)
    write(page.get_by_label("elbow in trajectory 2"), "20.5")
    settle(lambda: own.extents_deg[1][1] == 20.5)
    assert own.error is None and own.weights is None  # of other motions
    page.get_by_role("button", name="Record and train").click()
    settle(lambda: own.epoch == 60 and own.error is not None)
    page.get_by_role("button", name="Reset").click()
    settle(lambda: own.epoch == 0 and own.weights is not None)
    assert own.seed == other.seed == 1 and own.extents_deg == tuple(map(tuple, APPENDIX_I))
    with_other.unlink()


@pytest.mark.parametrize(
    "name, value, says",
    [
        ("seed", 51, "seed must be an integer from 1 to 50, got 51"),
        ("momentum", 0.7, "0.995"),
        ("extents_deg", [(9, 0.5)] * 5 + [(9, 9)], r"elbow in extents_deg .*\[1, inf\], got 0.5"),
    ],
)
def test_a_choice_outside_its_range_changes_nothing(widget, name, value, says):
    before = getattr(widget, name)
    with pytest.raises(TraitError, match=says):
        setattr(widget, name, value)
    assert getattr(widget, name) == before
