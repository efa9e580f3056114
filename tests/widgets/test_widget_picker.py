"""The trajectory picker: its Python side, and in a browser without a kernel."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from widget_pages import LIVE, NEXT_FRAME, assert_curves, drag, shown_values

from ddlib.metrics import rmss
from ddlib.setups import STATE_FEEDBACK, WINDOWS, errors, predict
from ddlib.trajectories import APPENDIX_I
from ddlib.widgets import TrajectoryPicker
from ddlib.widgets.picker import _AXIS
from workshop.report import results


@pytest.fixture(scope="module")
def picker():
    """Motion and rigid torques alone."""
    return TrajectoryPicker()


@pytest.fixture(scope="module")
def networks():
    return {f"window {w}": results.median_network(w) for w in WINDOWS}


@pytest.fixture(scope="module")
def full(networks):
    """With the networks of the chapter."""
    return TrajectoryPicker(networks)


def silent():
    """The set-up that records for the picker."""
    return replace(
        STATE_FEEDBACK, effects=STATE_FEEDBACK.effects.without("encoder", "torque_sensor")
    )


# Python


def test_recording_is_the_experiments_or_ones_own():
    picker = TrajectoryPicker()
    expected = STATE_FEEDBACK.record(picker.extents_deg)
    np.testing.assert_array_equal(picker.record().tau, expected.tau)
    calls = []
    picker = TrajectoryPicker(on_record=lambda e: calls.append(e) or len(calls))
    picker._handle_custom_msg({"type": "record", "extents_deg": [10, 20.5]}, [])
    assert calls == [(10, 20.5)] and picker.recording == 1 and picker.elbow_deg == 20.5
    assert "Recorded 10.0° and 20.5°" in picker.record_status["text"]
    picker._handle_custom_msg({"type": "record", "extents_deg": [10, 99]}, [])
    assert len(calls) == 1 and "must lie in [0, 45], got 99" in picker.record_status["text"]


def test_who_reads_the_recording_has_that_of_the_extents_as_they_stand():
    calls, seen = [], []
    picker = TrajectoryPicker(on_record=lambda e: calls.append(e) or tuple(e))
    picker.observe(lambda change: seen.append(change.new), "recording")
    assert picker.recording == picker.recording == picker.extents_deg == tuple(APPENDIX_I[5])
    assert len(calls) == 1 and picker.record_status["count"] == 1
    picker.shoulder_deg = 12.0  # as the page sets it while the point is dragged
    assert len(calls) == 1
    assert picker.recording == (12.0, APPENDIX_I[5, 1]) == picker.record()
    assert seen == [tuple(APPENDIX_I[5]), (12.0, APPENDIX_I[5, 1])]
    picker.extents_deg = (1, 2)
    assert (picker.shoulder_deg, picker.elbow_deg) == (1, 2) == picker.recording


def test_networks_see_what_the_simulator_records(full, networks):
    batch = silent().record(APPENDIX_I)
    deviation = batch.tau[:5, batch.motion].reshape(-1, 2).std(0)
    recording, curves = batch[5], full.curves
    torque = recording.tau[recording.motion]
    np.testing.assert_allclose(curves["elbow torque, recorded"][:-1], torque[::4, 1])
    measured = STATE_FEEDBACK.record()
    for name, network in networks.items():
        predicted = predict(network, recording)
        np.testing.assert_allclose(curves[f"shoulder torque, {name}"][:-1], predicted[::4, 0])
        error = curves[f"RMSS, {name}"][0]
        assert error == pytest.approx(rmss(predicted, torque, scale=deviation))
        # without sensors errors are much the same
        assert error == pytest.approx(errors(network, measured).by_training_deviation, rel=0.02)


def test_the_square_is_of_the_trajectories_that_were_recorded():
    own = [[5, 5], [40, 5], [5, 40], [20, 20]]
    picker = TrajectoryPicker(trajectories_deg=own)
    assert picker.extents_deg == (20, 20)
    assert len(picker.spec["pad"]["marks"]) == 4 and len(picker.spec["pad"]["region"]) == 3


def test_the_map_is_of_the_exact_errors(full, picker):
    maps = {name: each.values() for name, each in full.map["errors"].items()}
    assert full.map["side"] == _AXIS.size and _AXIS[[0, -1]].tolist() == [0, 45]
    low, high = ({c["name"]: c[end] for c in full.spec["curves"]} for end in ("low", "high"))
    for i, j in ((0, 0), (12, 4), (30, 30), (3, 29)):
        exact = full.curves_at(shoulder_deg=_AXIS[i], elbow_deg=_AXIS[j])
        for name, (low_end, high_end, digits) in maps.items():
            assert len(digits) == 2 * _AXIS.size**2
            at = 2 * (j * _AXIS.size + i)
            error = exact[f"RMSS, {name}"][0]
            shade = 9 * (error - low_end) / (high_end - low_end)
            assert int(digits[at : at + 2], 36) / 100 == pytest.approx(
                np.clip(shade, 0, 12.95), abs=0.0051
            )
            assert full.numbers[f"RMSS, {name}"][i, j] == pytest.approx(error, rel=1e-9)
            shades = {int("".join(two), 36) // 100 for two in zip(digits[::2], digits[1::2])}
            assert shades >= set(range(10))  # none is one plain square
        peak = picker.numbers["peak elbow"][i, j]
        assert peak == pytest.approx(exact["peak elbow"][0], rel=1e-9)
        for name, curve in exact.items():  # axes and decimals follow the whole square
            wide = 0.02 * (high[name] - low[name])
            assert low[name] - wide <= curve.min() and curve.max() <= high[name] + wide


# In a page without a kernel

browser_test = pytest.mark.browser


def assert_shown(page, widget, extents):
    """The page computes what Python does, and writes the numbers."""
    exact = widget.curves_at(**dict(zip(("shoulder_deg", "elbow_deg"), extents)))
    assert_curves(page, exact)
    shown = page.locator(".scalars output").all_inner_texts()
    for scalar, text in zip(widget.spec["scalars"], shown, strict=True):
        number = float(text.split()[0].replace("−", "-"))
        assert number == pytest.approx(exact[scalar["name"]][0], abs=0.0051)


@browser_test
def test_the_page_computes_what_ddlib_does(page_with, full):
    for extents in ((45, 45), (0, 0), (12.3, 3.3)):
        query = "?trajectory-picker=shoulder_deg:{},elbow_deg:{}".format(*extents)
        page = page_with(full, query=query)
        assert_shown(page, full, extents)
        log = page.evaluate("document.querySelector('.ddlib-picker').view.picked.log")
        recording = silent().record([extents])[0]
        np.testing.assert_allclose(log["reading"], recording.q, rtol=0, atol=1e-6)
        largest = np.abs(recording.tau).max(0) + 1e-3
        assert (np.abs(log["tau"] - recording.tau) <= 1e-6 * largest).all()


@browser_test
def test_drag_keys_and_sliders(page_with, full):
    page = page_with(full)
    assert_shown(page, full, APPENDIX_I[5])
    assert "extrapolates" in page.locator(".verdict").inner_text()
    drag(page, page.locator(".pad .frame").bounding_box(), (0.9, 0.7), (0.5, 1 / 3))
    assert "interpolates" in page.locator(".verdict").inner_text()
    assert shown_values(page)[:2] == pytest.approx([22.5, 30], abs=0.4)
    page.locator("input[id$=elbow_deg]").press("End")
    page.locator("input[id$=shoulder_deg]").press("Home")
    page.locator(".pad").press("Shift+ArrowDown")
    page.locator(".pad").press("ArrowRight")
    assert shown_values(page)[:2] == [0.5, 40.0]
    assert_shown(page, full, (0.5, 40.0))


@browser_test
def test_the_arm_is_drawn_with_its_paths(page_with, picker):
    page = page_with(picker)
    paths = page.locator(".arm .other path").evaluate_all(
        "all => all.map((p) => p.getAttribute('d'))"
    )
    assert len(set(paths)) == len(APPENDIX_I)
    assert page.locator(".arm .other text").all_text_contents() == list("123456")
    # that of the test is the path of the arm as it stands
    assert page.locator(".arm .trail").get_attribute("d") == paths[-1]
    page.locator("input[id$=elbow_deg]").press("Home")
    page.evaluate(NEXT_FRAME)
    assert page.locator(".arm .trail").get_attribute("d") != paths[-1]
    assert not page.locator(".record").count()  # no kernel, nothing that records


@browser_test
def test_recording_asks_the_kernel(page_with, picker):
    """One that answers, is busy, says nothing, dies, or is gone."""
    page = page_with(picker, extra=LIVE)
    button, said = page.locator(".record button"), page.locator(".record p")
    recorded = "kernel.model.set('record_status', {text: 'Recorded.', count: 1})"
    page.clock.install()
    button.click()
    asked = {"type": "record", "extents_deg": APPENDIX_I[5].tolist()}
    assert page.evaluate("kernel.sent") == [asked]
    assert button.is_disabled() and said.inner_text() == "Recording…"
    page.evaluate("kernel.model.widget_manager.kernel.status = 'busy'")
    page.clock.run_for(60_000)
    assert said.inner_text() == "The kernel is busy. It records as soon as it is free."
    assert button.is_disabled() and len(page.evaluate("kernel.sent")) == 1
    page.evaluate(recorded)
    page.clock.run_for(10_000)
    assert said.inner_text() == "Recorded." and button.is_enabled()
    page.evaluate("kernel.model.widget_manager.kernel.status = 'unknown'")
    button.click()  # no word of the kernel: it may be busy or gone
    page.clock.run_for(10_000)
    assert said.inner_text() == "The kernel has not answered yet." and button.is_enabled()
    page.evaluate("kernel.watchers[0].forEach((f) => f(null, 'dead'))")
    assert said.inner_text() == "The kernel is gone. Nothing was recorded."
    page.evaluate(recorded)
    page.evaluate("kernel.closed = true")
    button.click()
    assert said.inner_text() == "The kernel is gone. Nothing was recorded."
    assert button.is_enabled()
