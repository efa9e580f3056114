"""The real-arm switches, in Python and in a page without a kernel."""

from __future__ import annotations

import numpy as np
import pytest
from widget_pages import assert_curves

from ddlib.control import pd
from ddlib.dynamics import CMU_DD_ARM_II
from ddlib.effects import CMU_DD_ARM_II_EFFECTS, IDEAL, Delay, Effects
from ddlib.setups import KD, KP
from ddlib.simulation import CONTROL_STEP, record
from ddlib.trajectories import APPENDIX_I
from ddlib.widgets.switches import STRENGTHS, RealArmSwitches

NAMES = ("friction", "dead_zone", "saturation", "quantisation", "delay")
OFF = dict.fromkeys(NAMES, "off")
DEVIATIONS = [f"{j} {what}" for what in ("position", "torque") for j in ("shoulder", "elbow")]


@pytest.fixture(scope="module")
def switches():
    return RealArmSwitches()


def recorded(effects, times):
    """Shoulder error (degrees) and torque by `record`, at the given times of the motion."""
    options = {"effects": effects, "velocity": "difference", "log_step": CONTROL_STEP}
    recording = record(CMU_DD_ARM_II, pd(KP, KD), APPENDIX_I[5], **options)
    at = np.searchsorted(recording.t, times - 1e-9)
    assert recording.t[at] == pytest.approx(times, abs=1e-9)
    return np.rad2deg(recording.tracking_error[at, 0]), recording.tau_true[at, 0]


@pytest.mark.parametrize(
    "levels, effects",
    [
        ({}, IDEAL),
        (
            {"friction": "assumed", "quantisation": "assumed"},
            CMU_DD_ARM_II_EFFECTS.without("actuator", "torque_sensor"),
        ),
        ({"delay": "strong"}, Effects(actuator=(Delay(STRENGTHS["delay"]["strong"]),))),
    ],
    ids=["off", "as assumed", "delay"],
)
def test_curves_are_the_recorded_ones(switches, levels, effects):
    shown = switches.curves_at(**OFF | levels)
    whole, _, close = (np.array(panel["x"]) for panel in switches.spec["panels"])
    moving = whole < 3  # a rest after the motion has its own start
    error, torque = recorded(effects, whole[moving])
    np.testing.assert_allclose(shown["error"][moving], error, atol=2e-4)
    np.testing.assert_allclose(shown["torque"][moving], torque, atol=1e-3)
    np.testing.assert_allclose(shown["close-up"], recorded(effects, close)[1], atol=1e-3)


def test_the_stronger_the_further_from_the_ideal_arm(switches):
    exact = switches.curves_at(**OFF)
    for panel, name in zip(switches.spec["panels"], ("error", "torque", "close-up")):
        ideal = next(values for label, values, _ in panel["fixed"] if label == "ideal")
        np.testing.assert_allclose(exact[name], ideal, rtol=1e-5, atol=1e-5)
    for name in NAMES:
        levels = switches._parameters[name].points()
        off, weak, strong = (switches.curves_at(**OFF | {name: level}) for level in levels)
        for deviation in DEVIATIONS:
            assert off[deviation] == 0 < weak[deviation] < strong[deviation]


def assert_shown(page, switches, **levels):
    exact = switches.curves_at(**{**switches.values, **levels})
    assert_curves(page, exact, 1e-4)
    texts = page.locator(".scalars output").all_inner_texts()
    shown = [float(text.replace("°", " ").split()[0]) for text in texts]
    assert shown == pytest.approx([exact[name][0] for name in DEVIATIONS], abs=0.0051)


@pytest.mark.browser
def test_switches_alone_and_all(page_with, switches):
    """By mouse and keyboard; the axes stay as they are."""
    weak = {"friction": "assumed", "dead_zone": "weak", "saturation": "weak", "delay": "weak"}
    strong = dict.fromkeys(("friction", "saturation", "quantisation", "delay"), "strong")
    for levels in (OFF | weak, OFF | strong):
        query = ",".join(f"{name}:{level}" for name, level in levels.items())
        page = page_with(switches, query=f"?real-arm-switches={query}")
        assert_shown(page, switches, **levels)
    page = page_with(switches)
    assert_shown(page, switches)
    axes = page.locator(".chart svg text.y").all_inner_texts()
    page.get_by_role("switch", name="Torque limit").press("Space")
    assert_shown(page, switches, saturation="weak")
    page.get_by_role("combobox", name="Strength: Torque limit").select_option("strong")
    assert_shown(page, switches, saturation="strong")
    page.get_by_role("combobox", name="Strength: Delay").select_option("strong")  # switches on
    page.get_by_role("button", name="Delay alone").press("Enter")
    assert_shown(page, switches, **OFF | {"delay": "strong"})
    assert page.get_by_role("switch", checked=True).count() == 1
    page.get_by_role("button", name="All on").click()
    page.wait_for_function("document.querySelectorAll('[role=switch]:checked').length === 5")
    assert page.locator(".chart svg text.y").all_inner_texts() == axes
