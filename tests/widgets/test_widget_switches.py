"""The real-arm switches, in Python and in a page without a kernel."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from traitlets import TraitError
from widget_pages import NEXT_FRAME, PATHS, READ, page_of

from ddlib.control import pd
from ddlib.dynamics import CMU_DD_ARM_II
from ddlib.effects import CMU_DD_ARM_II_EFFECTS, IDEAL, Delay, Effects
from ddlib.setups import KD, KP
from ddlib.simulation import CONTROL_STEP, record
from ddlib.trajectories import APPENDIX_I
from ddlib.widgets.switches import (
    CLOSE_UP,
    DELAY,
    QUANTISATION,
    RANGES,
    SATURATION,
    TIMES,
    RealArmSwitches,
)

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


def test_axes_stay_and_hold_every_combination(switches):
    for panel, name in zip(switches.spec["panels"], RANGES):
        assert panel["y_range"] == list(RANGES[name]) and not panel["y_fit"]
    for levels in itertools.product(*(p.points()[::2] for p in switches._parameters.values())):
        curves = switches._function(**dict(zip(NAMES, levels)))
        for name, (low, high) in RANGES.items():
            assert low <= curves[name].min() and curves[name].max() <= high


@pytest.mark.parametrize(
    "levels, effects",
    [
        ({}, IDEAL),
        (
            {"friction": "assumed", "quantisation": "assumed"},
            CMU_DD_ARM_II_EFFECTS.without("actuator", "torque_sensor"),
        ),
        ({"delay": "strong"}, Effects(actuator=(Delay(DELAY["strong"]),))),
    ],
    ids=["off", "as assumed", "delay"],
)
def test_curves_are_the_recorded_ones(switches, levels, effects):
    shown = switches.interpolate(**OFF | levels)
    moving = TIMES < 3  # a rest after the motion has its own start
    error, torque = recorded(effects, TIMES[moving])
    np.testing.assert_allclose(shown["error"][moving], error, atol=2e-4)
    np.testing.assert_allclose(shown["torque"][moving], torque, atol=1e-3)
    np.testing.assert_allclose(shown["close-up"], recorded(effects, CLOSE_UP)[1], atol=1e-3)


def test_the_stronger_the_further_from_the_ideal_arm(switches):
    exact = switches._function(**OFF)
    for panel, name in zip(switches.spec["panels"], ("error", "torque", "close-up")):
        np.testing.assert_allclose(exact[name], dict(panel["fixed"])["ideal"], rtol=1e-5, atol=1e-5)
    for name in NAMES:
        levels = switches._parameters[name].points()
        off, weak, strong = (switches._function(**OFF | {name: level}) for level in levels)
        for deviation in DEVIATIONS:
            assert off[deviation] == 0 < weak[deviation] < strong[deviation]


def test_saturation_clips_every_torque(switches):
    for level, *others in itertools.product(("weak", "strong"), *(("off", "strong"),) * 3):
        values = dict(zip(("friction", "quantisation", "delay"), others), saturation=level)
        shown = switches.interpolate(**OFF | values)
        for name in ("torque", "close-up"):
            assert np.abs(shown[name]).max() <= SATURATION[level] + 1e-3
        assert np.abs(shown["torque"]).max() > 0.99 * SATURATION[level]


def test_quantisation_roughens_the_torque_not_the_position(switches):
    rough, away = [], []
    for level in QUANTISATION:
        exact = switches._function(**OFF | {"quantisation": level})
        rough.append(np.abs(np.diff(exact["close-up"], 2)).mean())
        away.append(exact["shoulder position"])
    # one step of the encoder in one period, seen by the derivative gain
    for bits, got in zip((16, 14), rough[1:]):
        step = KD[0] * 2 * np.pi / 2**bits / CONTROL_STEP
        assert 0.1 < got / step < 2
    assert rough[0] < 0.02 * rough[1] < 0.02 * rough[2]
    assert max(away) < 0.002  # degrees


def test_bad_values_are_refused(switches):
    for name, bad in (("friction", "weak"), ("delay", 1), ("quantisation", None)):
        with pytest.raises(TraitError, match=f"{name} must be one of 'off'"):
            setattr(switches, name, bad)


# In a page without a kernel


def assert_shown(page, switches, **levels):
    page.evaluate(NEXT_FRAME)
    exact = switches._function(**{**switches.values, **levels})
    for panel, name in enumerate(RANGES):
        _, real = page.evaluate(READ, panel)  # what stays is drawn below
        np.testing.assert_allclose(real, exact[name], atol=1e-3 * np.ptp(RANGES[name]))
    texts = page.locator(".scalars output").all_inner_texts()
    shown = [float(text.replace("°", " ").split()[0]) for text in texts]
    assert shown == pytest.approx([exact[name] for name in DEVIATIONS], abs=0.0051)


SEEN = """() => {
  const { found } = document.querySelector(".ddlib-switches").switches;
  return Object.fromEntries(Object.entries(found).map(([name, values]) => [name, [...values]]));
}"""


@pytest.mark.browser
@pytest.mark.parametrize(
    "levels",
    [
        {},
        {"friction": "strong", "saturation": "strong", "quantisation": "strong", "delay": "strong"},
        {"friction": "assumed", "dead_zone": "weak", "saturation": "weak", "delay": "weak"},
    ],
    ids=["off", "strong", "weak"],
)
def test_the_page_computes_what_ddlib_does(tmp_path, visit, switches, levels):
    """To 1e-6 rad, of every combination of effects that is tried."""
    query = ",".join(f"{name}:{level}" for name, level in (OFF | levels).items())
    page = visit(f"{page_of(tmp_path / 'page.html', switches)}?real-arm-switches={query}").page
    page.evaluate(NEXT_FRAME)
    seen, known = page.evaluate(SEEN), switches._function(**OFF | levels)
    assert set(seen) == set(known)
    for name, tolerance in (("error", np.rad2deg(1e-6)), ("torque", 1e-3), ("close-up", 1e-3)):
        np.testing.assert_allclose(seen[name], known[name], atol=tolerance)
    for name in DEVIATIONS:
        assert seen[name] == [pytest.approx(known[name], abs=1e-5)]


@pytest.mark.browser
def test_switches_alone_and_all(tmp_path, visit, switches):
    """By mouse and keyboard; the axes stay as they are."""
    opened = visit(page_of(tmp_path / "page.html", switches))
    page = opened.page
    assert_shown(page, switches)
    axes = page.locator(".chart svg text.y").all_inner_texts()
    before = page.evaluate(PATHS)
    page.get_by_role("switch", name="Torque limit").press("Space")
    assert_shown(page, switches, saturation="weak")
    page.get_by_role("combobox", name="Strength: Torque limit").select_option("strong")
    assert_shown(page, switches, saturation="strong")
    assert len(before) == 6 and before != page.evaluate(PATHS)
    page.get_by_role("combobox", name="Strength: Delay").select_option("strong")  # switches on
    page.evaluate(NEXT_FRAME)
    assert page.get_by_role("switch", name="Delay").is_checked()
    page.get_by_role("button", name="Delay alone").press("Enter")
    assert_shown(page, switches, **OFF | {"delay": "strong"})
    assert page.get_by_role("switch", checked=True).count() == 1
    page.get_by_role("button", name="All off").click()
    assert_shown(page, switches, **OFF)
    page.get_by_role("switch", name="Delay").check()  # as strong as it was
    assert_shown(page, switches, **OFF | {"delay": "strong"})
    page.get_by_role("button", name="As assumed").click()
    assert_shown(page, switches)
    page.get_by_role("button", name="All on").click()
    page.wait_for_function("document.querySelectorAll('[role=switch]:checked').length === 5")
    assert page.locator(".chart svg text.y").all_inner_texts() == axes
    assert not opened.problems
