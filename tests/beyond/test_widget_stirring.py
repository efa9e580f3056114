"""The stirring picker: its curves, what it refuses, and in a browser without a kernel."""

import numpy as np
import pytest
from axe import violations
from widget_pages import NEXT_FRAME, PATHS, assert_curves, assert_exact_table

from beyond.chapters.widgets.stirring import StirringPicker
from beyond.studies.loop.stirring import PLACES
from ddlib.dynamics import CMU_DD_ARM_II as ARM, reach
from workshop.report import results

VALUES = "document.querySelector('.ddlib-curves').view.values"


@pytest.fixture(scope="module")
def picker():
    return StirringPicker()


def test_curves_are_those_of_the_place(picker):
    with np.load(results.FOLDER / "stirring-picker.npz") as file:
        hand, torque = file["hand"].astype(float), file["torque"].astype(float)
    place = {"distance": 0.55, "bearing": -75, "radius": 0.08, "period": 3.0, "elbow": "positive"}
    for name, value in place.items():
        setattr(picker, name, value)
    at = tuple(PLACES[name].index(value) for name, value in place.items())
    curves = picker.curves
    np.testing.assert_allclose(curves["hand"], hand[(slice(None), *at)])
    for k, line in enumerate(("exact behind a window", "pick and place", "circles")):
        np.testing.assert_allclose(curves[f"elbow, {line}"], torque[(k, *at)][:, 1])
    q = np.deg2rad(np.stack([curves[f"{joint} angle"] for joint in ("shoulder", "elbow")], -1))
    centre = 0.55 * np.exp(1j * np.deg2rad(-75))
    z = ARM.lengths[0] * np.exp(1j * q[:, 0]) + ARM.lengths[1] * np.exp(1j * q.sum(-1))
    turned = np.unwrap(np.angle(z - centre))
    np.testing.assert_allclose(np.abs(z - centre), 0.08)
    np.testing.assert_allclose(np.diff(turned), 2 * np.pi / 3 * 0.05, rtol=1e-9)
    assert_exact_table(picker)


def test_what_cannot_be_reached_is_zero_and_marked(picker):
    picker.distance, picker.radius = 0.85, 0.16
    assert not any(x.any() for x in picker.curves.values())
    assert picker.workspace["reach"] == list(reach(ARM))
    near, far = reach(ARM)
    for distance in PLACES["distance"]:
        for radius in PLACES["radius"]:
            shown = picker.curves_at(**picker.values | {"distance": distance, "radius": radius})
            within = near < distance - radius and distance + radius < far
            assert any(x.any() for x in shown.values()) == within


@pytest.mark.browser
def test_a_page_without_kernel_refuses_in_words(page_with, picker):
    picker.distance, picker.radius, picker.bearing = 0.65, 0.12, -60
    page = page_with(picker)
    charts, verdict = page.locator(".charts"), page.locator(".verdict")
    assert charts.is_visible() and "Within reach" in verdict.inner_text()
    pad, before = page.locator("svg.pad"), page.evaluate(PATHS)
    box = pad.bounding_box()
    page.mouse.click(box["x"] + 0.72 * box["width"], box["y"] + 0.5 * box["height"])
    page.evaluate(NEXT_FRAME)
    assert page.evaluate(PATHS) != before
    now = dict(zip(picker.values, page.evaluate(VALUES)))
    assert now["bearing"] != -60
    exact = picker.curves_at(**now)
    angles = {name: exact[name] for name in ("shoulder angle", "elbow angle")}
    assert_curves(page, picker.at_grid(**now) | angles, 1e-9)
    for _ in range(5):  # to the edge, not beyond
        pad.press("ArrowUp")
    page.evaluate(NEXT_FRAME)
    assert not charts.is_visible() and "Refused: the hand would have to be" in verdict.inner_text()
    assert not violations(page)
