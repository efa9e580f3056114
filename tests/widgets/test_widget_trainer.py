"""The network trained in the page: its course against ddlib, and its page."""

from __future__ import annotations

import re

import numpy as np
import pytest
import torch
from axe import violations_in
from reactions import first_answers
from widget_pages import NEXT_FRAME, page_of

from ddlib.analysis import CLASSES, classify
from ddlib.learning import Descent, default_rate, prepare
from ddlib.metrics import rmss
from ddlib.widgets import NetworkTrainer, module
from ddlib.widgets.engine import plain, trainer
from workshop.report import results
from workshop.report.studies.page import training as study

SCHOOL = """([spec, positions, torques, choice, epochs]) => {
  const school = schoolOf(spec, positions, torques, choice);
  for (let k = 0; k < epochs; k++) school.advance();
  const { outputs, error } = school.judge();
  return {
    all: [...school.net.all], error, outputs: outputs.map((y) => [...y]), events: school.events,
    training: [...school.training].filter((x) => x === x), names: school.names,
    epoch: school.epoch,
  };
}"""
STATE = """() => {
  const { school } = document.querySelector(".ddlib-trainer");
  return { epoch: school.epoch, weight: school.net.all[0], events: school.events };
}"""
NAMED = """() => {
  const { direct, hidden } = document.querySelector(".ddlib-trainer").school.names;
  return [direct, hidden].map((names) => names.filter((k) => k < 6).length);
}"""
PRESS = """(names) => names.forEach((name) =>
  [...document.querySelectorAll("button")].find((b) => b.innerText.trim() === name).click())"""
CALM = {"reduced_motion": "reduce"}


@pytest.fixture(scope="module")
def widget():
    return NetworkTrainer()


@pytest.fixture(scope="module")
def evaluate(browser):
    page = browser.new_page()
    script = plain.source() + module("elements.js", "trainer.js")
    page.add_script_tag(content=script.replace("export default", "void"))
    yield page.evaluate
    page.close()


def taught(evaluate, widget, epochs, seed=1, inputs="centred", shift=None, step=1.0, momentum=0.98):
    positions = np.frombuffer(widget.positions, "<i2").tolist()
    torques = np.frombuffer(widget.torques, "<f4").astype(float).tolist()
    choice = {"seed": seed, "inputs": inputs, "shift": shift, "step": step, "momentum": momentum}
    return evaluate(SCHOOL, [widget.spec, positions, torques, choice, epochs])


def flat(weights):
    return np.concatenate([np.ravel(getattr(weights, name)) for name in plain.FIELDS])


# The training


@pytest.mark.browser
def test_first_weights_are_the_pages(evaluate, widget):
    for seed in (1, 2, 50):
        page = taught(evaluate, widget, 0, seed)
        ours = flat(trainer.first_weights(seed))
        np.testing.assert_allclose(page["all"], ours, atol=1e-12)
        assert np.abs(ours).max() < 0.3 and np.abs(ours.mean()) < 0.03
        assert np.quantile(ours, [0.25, 0.75]) == pytest.approx([-0.15, 0.15], abs=0.04)
    with pytest.raises(ValueError, match="seed must"):
        trainer.first_weights(-1)


@pytest.mark.browser
@pytest.mark.parametrize(
    "inputs, shift, momentum",
    [("centred", None, 0.98), ("printed", None, 0.9), ("centred", 3, 0.0)],
)
def test_the_course_is_ddlibs(evaluate, widget, monkeypatch, inputs, shift, momentum):
    """Weights, errors, names and events of the first epochs, in double precision."""
    monkeypatch.setattr("ddlib.learning.descent._tensor", torch.tensor)
    monkeypatch.setattr("ddlib.learning.descent.ONEDNN", False)  # single precision alone
    epochs, seed = 60, 7
    page = taught(evaluate, widget, epochs, seed, inputs, shift, momentum=momentum)
    data, test = trainer.training_set(inputs, shift)
    start = trainer.first_weights(seed)
    descent = Descent(start, data.x, data.y, default_rate(21) / len(data.x), momentum)
    for matrix in ("back", "delta"):
        setattr(descent, matrix, getattr(descent, matrix).double())
    errors = []
    for k in range(epochs + 1):
        if k % study.CHECK == 0:
            square = np.square(descent.weights()[0].activity(data.x)[1] - data.y).mean(0)
            errors.append(np.sqrt((square / data.y.var(0)).mean()))
        if k < epochs:
            descent.epoch()
    weights = descent.weights()[0]
    np.testing.assert_allclose(page["all"], flat(weights), atol=1e-6)
    np.testing.assert_allclose(page["training"], errors, atol=1e-6)
    output = weights.activity(test[0])[1]
    assert page["error"] == pytest.approx(rmss(output, test[1]), abs=1e-6)
    names = {"direct": weights.direct_weights, "hidden": weights.hidden_weights}
    for layer, f in names.items():
        wanted = [CLASSES.index(name) for name in classify(f).ravel()]
        assert page["names"][layer] == wanted


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


def test_the_study_is_what_the_page_does():
    """Events in the page's terms, for weights that are reckoned by hand."""
    weights = trainer.first_weights(3)
    assert study.events(weights, np.array([0.3])).tolist() == [[False, False, False]]
    weights.hidden_weights[0, 4, 1] = np.arange(21.0)
    weights.direct_weights[0, 1, 0] = np.arange(-10, 11.0) ** 2
    assert study.events(weights, np.array([0.1])).tolist() == [[True, True, True]]
    data, test = study.page_set()
    assert len(data.x) * study.EVERY == 5 * len(test[0]) == 1500
    assert data.x.min() >= -1 and data.x.max() <= 1 and data.step == pytest.approx(0.01)
    seen = study.watched(weights, data, test, epochs=10)
    assert seen["direct"][0] == seen["hidden"][0] == 0 and np.isnan(seen["error"][0])
    for what, (x, y) in {"training": (data.x, data.y), "test": test}.items():
        moved = Descent(weights, data.x, data.y, default_rate(21) / len(data.x), study.MOMENTUM)
        for _ in range(10):
            moved.epoch()
        square = moved.mean_square(*prepare(x, y))
        assert seen[what] == pytest.approx(np.sqrt((square / y.var(0)).mean(-1)), rel=1e-4)


def test_what_was_committed_is_such_a_study():
    kept = results.read("page-training")
    assert kept["epochs"] == study.EPOCHS and kept["level"] == study.LEVEL
    for row in kept["rows"].values():
        assert len(row["training"]) == kept["members"] == 25
        for event in study.EVENTS:
            found = [x for x in row[event] if x is not None]
            assert all(0 <= x <= study.EPOCHS and x % study.CHECK == 0 for x in found)


def test_the_whole_figure_is_small(widget):
    assert len(widget._esm.encode()) < 62_000
    assert len(widget.positions) + len(widget.torques) < 23_000
    assert widget.still and "trajectory 6" in widget.still_alt
    assert all(line.count("`") % 2 == 0 for line in module("trainer.js").splitlines())


# In a page without a kernel


def opened(tmp_path, visit, widget, query="", **options):
    url = page_of(tmp_path / "page.html", widget)
    here = visit(f"{url}{query}", **options)
    here.page.evaluate(NEXT_FRAME)
    return here


@pytest.mark.browser
def test_nothing_moves_before_a_guess(tmp_path, visit, widget):
    here = opened(tmp_path, visit, widget)
    page = here.page
    for name in ("Train", "Step"):
        assert page.get_by_role("button", name=name, exact=True).is_disabled()
    page.wait_for_timeout(300)
    assert page.evaluate(STATE)["epoch"] == 0
    page.get_by_role("button", name="Direct weights measure").click()
    page.wait_for_function("document.querySelector('.ddlib-trainer').school.epoch > 3")
    page.get_by_role("button", name="Pause").click()
    paused = page.evaluate(STATE)
    page.wait_for_timeout(200)
    assert page.evaluate(STATE) == paused
    assert f"Epoch {paused['epoch']}." in page.locator(".status").inner_text()
    page.get_by_role("button", name="Step").click()
    assert page.evaluate(STATE)["epoch"] == paused["epoch"] + 1
    page.get_by_label("Torques").select_option("shifted")
    assert page.evaluate(STATE)["epoch"] == 0
    assert page.get_by_role("button", name="Train", exact=True).is_disabled()
    assert not here.problems + violations_in(page, "light", "dark")


@pytest.mark.browser
def test_the_end_of_a_run_answers_the_guess(tmp_path, visit, widget):
    """Of a short run, begun by a link close to its end."""

    def shortened(entry):
        spec = entry["state"]["spec"]
        spec["epochs"] = 90
        spec["panels"][0]["x"] = spec["panels"][0]["x"][: 90 // study.CHECK + 1]

    url = page_of(tmp_path / "page.html", widget, change=shortened)
    here = visit(f"{url}?trainer=guess:1,epoch:70", **CALM)
    page, wait = here.page, "document.querySelector('.ddlib-trainer').school.epoch >= %d"
    page.wait_for_function(wait % 70)
    page.get_by_role("button", name="Train", exact=True).click()
    page.wait_for_function(wait % 90)
    page.wait_for_selector(".runs table")
    state = page.evaluate(STATE)
    first = min(e for e in state["events"] if e is not None)
    verdict = page.locator(".verdict").inner_text()
    assert "Your guess: Direct weights measure acceleration" in verdict
    assert f"at epoch {first}" in verdict
    assert page.locator(".runs tbody tr").count() == 1
    assert "Training is over, 90 epochs" in page.locator(".status").inner_text()
    assert page.evaluate(NAMED) == [
        int(n) if n != "None" else 0 for n in re.findall(r"(\d+|None) of the (?:4|20)", verdict)
    ]
    ends = page.locator(".events dd").all_inner_texts()
    assert ends == ["never" if e is None else f"epoch {e}" for e in state["events"]]
    assert not here.problems + violations_in(page, "light", "dark")
    step = page.get_by_role("button", name="Step")
    assert step.get_attribute("aria-disabled") == "true"
    step.click(force=True)
    assert page.evaluate(STATE)["epoch"] == 90
    page.get_by_role("button", name="Begin anew").click()
    page.wait_for_function("document.querySelector('.ddlib-trainer').school.epoch < 90")
    assert not page.locator(".verdict").inner_text()
    assert step.get_attribute("aria-disabled") == "false"


@pytest.mark.browser
def test_a_link_restores_settings_and_epoch(tmp_path, visit, widget):
    page = opened(tmp_path, visit, widget).page
    page.get_by_role("button", name="New weights").click()
    page.get_by_label("Inputs").select_option("printed")
    page.get_by_label("Momentum").select_option("0.9")
    # both at once: the training would soon be over
    page.evaluate(PRESS, ["A hidden filter has a name", "Pause"])
    for _ in range(3):
        page.get_by_role("button", name="Step").click()
    wanted = page.evaluate(STATE)
    page.wait_for_function(f"location.search.includes('epoch:{wanted['epoch']}')")
    query = page.evaluate("location.search")
    again = opened(tmp_path, visit, widget, query).page
    goal = f"document.querySelector('.ddlib-trainer').school.epoch >= {wanted['epoch']}"
    again.wait_for_function(goal)
    assert again.evaluate(STATE) == wanted
    assert again.get_by_label("Inputs").input_value() == "printed"
    again.get_by_role("button", name="Reset").click()
    fresh = again.evaluate(STATE)
    assert (
        fresh["epoch"] == 0
        and fresh["weight"] == trainer.first_weights(1).hidden_weights[0, 0, 0, 0]
    )


@pytest.mark.browser
def test_copied_code_trains_the_same_network(tmp_path, visit, widget, capsys):
    query = "?trainer=seed:5,guess:0,torques:shifted,epoch:40"
    page = opened(tmp_path, visit, widget, query).page
    page.wait_for_function("document.querySelector('.ddlib-trainer').school.epoch >= 40")
    page.evaluate("navigator.clipboard.writeText = async (text) => { window.copied = text; }")
    page.get_by_role("button", name="Code").click()
    page.wait_for_function("window.copied")
    exec(page.evaluate("window.copied"), {})
    training, test = map(float, capsys.readouterr().out.split())
    school = "(() => { const { school } = document.querySelector('.ddlib-trainer'); return %s; })()"
    assert page.evaluate(school % "school.training[8]") == pytest.approx(training, rel=1e-3)
    assert page.evaluate(school % "school.test[8]") == pytest.approx(test, rel=1e-3)


@pytest.mark.browser
@pytest.mark.parametrize("width, height", [(1280, 800), (390, 844)])
def test_button_weights_and_error_are_seen_together(tmp_path, browser, widget, width, height):
    context = browser.new_context(viewport={"width": width, "height": height})
    page = context.new_page()
    page.goto(page_of(tmp_path / "page.html", widget))
    page.wait_for_selector(".ddlib-trainer .chart")
    page.evaluate(NEXT_FRAME)
    boxes = [
        page.locator(f".ddlib-trainer {place}").first.bounding_box()
        for place in (".buttons", "canvas", ".chart > svg")
    ]
    assert max(b["y"] + b["height"] for b in boxes) - min(b["y"] for b in boxes) < height - 60
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    context.close()


@pytest.mark.browser
def test_damage_is_reported_in_place(tmp_path, visit, widget):
    def shorter(entry):
        entry["buffers"][0]["data"] = entry["buffers"][0]["data"][:80]

    page = visit(page_of(tmp_path / "page.html", widget, damages=[shorter])).page
    assert "positions and" in page.get_by_role("alert").inner_text()


@pytest.mark.browser
@pytest.mark.parametrize("touch", [False, True])
def test_its_first_handle_answers(tmp_path, visit, widget, touch):
    options = {"width": 400, "has_touch": True, "is_mobile": True} if touch else {}
    here = opened(tmp_path, visit, widget, **options)
    first_answers(here.page.locator(".ddlib-trainer"), touch)
    assert not here.problems
