"""The training player, in Python and in a page without a kernel."""

from __future__ import annotations

import numpy as np
import pytest
from widget_pages import NEXT_FRAME, assert_curves, assert_exact_table, drag, settings

from ddlib.learning import TorqueModel, TrainingSet, Weights, cases
from ddlib.setups import STATE_FEEDBACK, split
from ddlib.widgets.hinton import _diagram
from ddlib.widgets.player import TrainingPlayer

EPOCHS = np.array([0, 1, 2, 5, 10, 30, 100, 300, 1000, 20_000])
WIDTH = 11


@pytest.fixture(scope="module")
def recording():
    return STATE_FEEDBACK.record()


@pytest.fixture(scope="module")
def model(recording):
    """Random weights that grow, for two members."""
    points = [Weights.random(2, WIDTH, initial=0.3 + 0.1 * k) for k in range(len(EPOCHS))]
    data = TrainingSet.from_recording(split(recording)[0], WIDTH)
    return TorqueModel(Weights.stack(points), data.inputs, data.outputs)


@pytest.fixture(scope="module")
def rmss(model, recording):
    """RMSS on the training runs and on run 6 at every epoch, from its definition."""
    found = {"training": [], "test": []}
    for name, part in zip(found, split(recording)):
        windows, torque = cases(part, WIDTH)
        for k in range(len(EPOCHS)):
            difference = model[k, 1].torque(windows) - torque
            found[name].append(np.sqrt(np.mean((difference / torque.std(0)) ** 2)))
    return found


@pytest.fixture(scope="module")
def player(model, recording):
    return TrainingPlayer(EPOCHS, model, recording, member=1)


def test_curves_are_the_recorded_ones(player, model, rmss):
    assert_exact_table(player)
    for values in settings(player, 40, seed=1):
        k = EPOCHS.tolist().index(values["epoch"])
        weights, shown = model.weights[k, 1], player.at_grid(**values)
        kind, name = values["unit"].split()
        number = int(name) if kind == "hidden" else ("shoulder", "elbow").index(kind)
        part = "hidden_weights" if kind == "hidden" else "direct_weights"
        f = getattr(weights, part)[number]
        np.testing.assert_allclose(shown["shoulder weights"], f[0], atol=2e-4)
        np.testing.assert_allclose(shown["elbow weights"], f[1], atol=2e-4)
        np.testing.assert_allclose(shown["weights of all units"], _diagram(weights, 5), atol=2e-4)
        for name in ("training", "test"):
            assert shown[f"{name} RMSS"][0] == pytest.approx(rmss[name][k], rel=1e-3)
        reached = getattr(model.weights, part)[:, 1, number]
        ends = [shown[name][0] for name in ("lowest", "highest")]
        assert ends == pytest.approx([reached.min(), reached.max()], abs=1e-4)


# In a page without a kernel

AT = """Number(
  document.querySelectorAll('.chart > svg')[1].querySelector('line.cursor').getAttribute('x1'))"""


def shown_epoch(page) -> int:
    page.evaluate(NEXT_FRAME)
    return int(page.locator("output[for$=epoch]").inner_text().replace(",", ""))


def assert_shown(page, model, rmss, epoch, unit):
    """The page shows the weights of a hidden unit, and the errors, at an epoch."""
    assert shown_epoch(page) == epoch
    k = EPOCHS.tolist().index(epoch)
    f = model.weights.hidden_weights[k, 1, unit]
    assert_curves(page, {"shoulder weights": f[0], "elbow weights": f[1]}, 5e-3)
    texts = page.locator(".scalars output").all_inner_texts()
    errors = [rmss[name][k] for name in ("training", "test")]
    assert [float(x) for x in texts[:2]] == pytest.approx(errors, abs=0.051)
    largest = np.abs(_diagram(model.weights[k, 1], WIDTH // 2)).max()
    assert float(texts[2]) == pytest.approx(largest, abs=0.006)


@pytest.mark.browser
def test_slider_diagram_and_menu(page_with, player, model, rmss):
    player.unit, player.epoch = "hidden 0", 0
    page = page_with(player)
    slider = page.get_by_role("slider")

    def shows(epoch, unit):
        assert_shown(page, model, rmss, epoch, unit)

    shows(0, 0)
    slider.press("End")
    shows(20_000, 0)
    last = page.evaluate(AT)
    drag(page, slider.bounding_box(), (0.99, 0.5), (0.34, 0.5))
    shows(5, 0)
    assert page.evaluate(AT) < last  # the cursor follows the epoch
    page.locator("[role=gridcell]").nth(5).click()
    shows(5, 3)
    page.locator("svg.hinton").press("ArrowDown")
    shows(5, 5)
    page.get_by_label("Unit", exact=True).select_option(label="hidden 9")
    shows(5, 8)


@pytest.mark.browser
def test_film_runs_and_stops(page_with, player):
    player.unit, player.epoch = "hidden 0", 0
    page = page_with(player)
    page.get_by_role("button", name="Play").click()
    page.wait_for_function("document.querySelector('output[for$=epoch]').textContent === '5'")
    page.get_by_role("button", name="Pause").click()
    assert shown_epoch(page) < 20_000
    page.get_by_role("button", name="Play").wait_for()
