"""The PID tuner, in Python and in a page without a kernel."""

from __future__ import annotations

import itertools

import control
import numpy as np
import pytest
from traitlets import TraitError
from widget_pages import NEXT_FRAME, PATHS, READ, page_of, settings

from ddlib.control import PID, Feedforward, closed_loop, opened_loop, plant
from ddlib.dynamics import CMU_DD_ARM_II
from ddlib.effects import Effects, ViscousFriction
from ddlib.experiments import KD, KP
from ddlib.simulation import CONTROL_STEP, record
from ddlib.trajectories import APPENDIX_I
from ddlib.widgets.tuner import TIMES, VISCOUS, PIDTuner, gains

ARM = CMU_DD_ARM_II
LATE = (TIMES >= 1) & (TIMES < 3)


@pytest.fixture(scope="module")
def tuner():
    return PIDTuner()


def rms(x):
    return np.sqrt(np.mean(x**2))


def test_interpolation_is_within_what_the_widget_states(tuner):
    assert tuner.spec["error"] <= 0.01
    assert tuner.interpolation_error(1000, seed=11) <= 0.01
    assert tuner.baked_bytes < 200_000


def test_the_books_gains_keep_their_ratio():
    law = gains(2 * KP[0], KP[0], 3 * KD[0])
    np.testing.assert_allclose(law["kp"], 2 * np.array(KP))
    np.testing.assert_allclose(law["ki"], KP)
    np.testing.assert_allclose(law["kd"], 3 * np.array(KD))


@pytest.mark.parametrize("feedforward", [False, True])
def test_curves_are_the_recorded_ones(tuner, feedforward):
    """The same runs with a rest before the motion, by `record`."""
    feedback = PID(**gains(200, 100, 30))
    recording = record(
        ARM,
        Feedforward(ARM, feedback) if feedforward else feedback,
        APPENDIX_I[5],
        effects=Effects(friction=(ViscousFriction(VISCOUS),)),
    )
    shown = tuner.interpolate(kp=200, ki=100, kd=30, feedforward=feedforward)
    at = np.searchsorted(recording.t, TIMES[:-1] - 1e-9)
    assert recording.t[at] == pytest.approx(TIMES[:-1])
    widths = {c["name"]: c["high"] - c["low"] for c in tuner.spec["curves"]}
    error, torque = np.rad2deg(recording.tracking_error), recording.tau_true
    for j, joint in enumerate(("shoulder", "elbow")):
        for name, exact in ((f"{joint} error", error), (f"{joint} torque", torque)):
            allowed = tuner.spec["error"] * widths[name]
            np.testing.assert_allclose(shown[name][:-1], exact[at, j], atol=allowed)
        exact = rms(error[recording.motion, j])
        assert shown[f"{joint} RMS"][0] == pytest.approx(exact, abs=0.01 * widths[f"{joint} RMS"])


def test_margins_are_python_controls_on_the_unit_circle(tuner):
    """From samples of the frequency response: another way through python-control."""
    joints = plant(ARM.mass_matrix([0.0, 0.0]), VISCOUS)
    omega = np.geomspace(0.3, 0.9999 * np.pi / CONTROL_STEP, 4000)
    for values in settings(tuner, 5, seed=2):
        law = gains(values["kp"], values["ki"], values["kd"])
        exact = tuner._function(**values)
        for j, joint in enumerate(("shoulder", "elbow")):
            loop = opened_loop(joints, **law, period=CONTROL_STEP, joint=j)
            answer = loop(np.exp(1j * omega * CONTROL_STEP))
            _, phase, _, _, crossover, _ = control.stability_margins(
                control.frd(answer, omega, smooth=True)
            )
            assert exact[f"{joint} phase margin"] == pytest.approx(phase, abs=0.01)
            if j == 0:
                assert exact["crossover"] == pytest.approx(crossover, rel=1e-4)
                # at the highest frequency the loop is real and negative
                assert exact["gain margin"] == pytest.approx(-20 * np.log10(-answer[-1].real), 1e-2)


def test_every_setting_is_stable(tuner):
    joints = plant(ARM.mass_matrix([0.0, 0.0]), VISCOUS)
    axes = [p.points() for name, p in tuner._parameters.items() if name != "feedforward"]
    for kp, ki, kd in itertools.product(*axes):
        loop = closed_loop(joints, **gains(kp, ki, kd), period=CONTROL_STEP)
        assert abs(loop.poles()).max() < 1


def test_what_each_gain_does(tuner):
    base = tuner.interpolate()
    stiff, damped, patient = (
        tuner.interpolate(**{name: value}) for name, value in (("kp", 500), ("kd", 70), ("ki", 150))
    )
    margin, error = "shoulder phase margin", "shoulder error"
    assert stiff["crossover"] > base["crossover"]
    assert stiff[margin] < base[margin] < damped[margin]
    assert patient[margin] < base[margin]
    assert rms(stiff[error][LATE]) < rms(base[error][LATE])
    # the reference jumps: the first torque is that of the damper
    assert damped["shoulder torque"][0] / base["shoulder torque"][0] == pytest.approx(2, abs=0.03)


def test_feedforward_repairs_what_a_model_can_know(tuner):
    """Not the jump of the reference at the start."""
    off, on = (tuner.interpolate(feedforward=on) for on in (False, True))
    for joint in ("shoulder", "elbow"):
        name = f"{joint} error"
        assert rms(on[name][LATE]) < rms(off[name][LATE]) / 4
        assert np.abs(on[name]).max() == pytest.approx(np.abs(off[name]).max(), rel=0.1)


@pytest.mark.parametrize(
    "name, bad", [("kp", 149), ("kp", np.nan), ("ki", -1), ("kd", 81), ("kd", "x"), ("ki", None),
                  ("feedforward", "on"), ("feedforward", 1)],
)  # fmt: skip
def test_bad_values_are_refused(tuner, name, bad):
    before = tuner.values
    with pytest.raises(TraitError, match=f"{name} must"):
        setattr(tuner, name, bad)
    assert tuner.values == before


# In a page without a kernel


def assert_shown(page, tuner, **values):
    """Curves and numbers of the page are Python's, within a hundredth of each curve's range."""
    page.evaluate(NEXT_FRAME)
    exact = tuner._function(**{**tuner.values, **values})
    width = {c["name"]: c["high"] - c["low"] for c in tuner.spec["curves"]}
    for panel, shown in enumerate(tuner.spec["panels"]):
        for got, (name, _) in zip(page.evaluate(READ, panel), shown["curves"]):
            np.testing.assert_allclose(got, exact[name], atol=0.01 * width[name])
    numbers = page.locator(".scalars output").all_inner_texts()
    for text, scalar in zip(numbers, tuner.spec["scalars"]):
        got = float(text.replace("−", "-").replace("°", " ").split()[0])
        assert got == pytest.approx(exact[scalar["name"]], abs=0.01 * width[scalar["name"]])


def value_of(page, tuner, name):
    """The parameter that the slider stands at."""
    place = page.locator(f"input[id$={name}]").evaluate("(x) => x.value / x.max")
    return tuner._parameters[name].place(place)


@pytest.mark.browser
def test_drag_keys_and_switch(tmp_path, visit, tuner):
    opened = visit(page_of(tmp_path / "page.html", tuner))
    page = opened.page
    page.evaluate(NEXT_FRAME)
    assert_shown(page, tuner)
    before = page.evaluate(PATHS)
    box = page.locator("input[id$=kp]").bounding_box()
    y = box["y"] + box["height"] / 2
    page.mouse.move(box["x"] + box["width"] / 2, y)
    page.mouse.down()
    page.mouse.move(box["x"] + 0.9 * box["width"], y, steps=5)
    page.mouse.up()
    page.evaluate(NEXT_FRAME)
    dragged = page.evaluate(PATHS)
    assert all(a != b for a, b in zip(before, dragged)) and len(before) == 4
    kp = value_of(page, tuner, "kp")
    assert tuner._parameters["kp"].place(0.85) < kp < tuner._parameters["kp"].place(0.95)
    assert_shown(page, tuner, kp=kp)
    page.locator("input[id$=kd]").press("Home")
    page.locator("input[id$=ki]").press("End")
    assert_shown(page, tuner, kp=kp, kd=20, ki=150)
    page.get_by_role("switch").press("Space")
    assert_shown(page, tuner, kp=kp, kd=20, ki=150, feedforward=True)
    assert not opened.problems


@pytest.mark.browser
def test_touch(tmp_path, browser, tuner):
    context = browser.new_context(viewport={"width": 380, "height": 900}, has_touch=True)
    page = context.new_page()
    page.goto(page_of(tmp_path / "page.html", tuner))
    page.wait_for_selector(".chart")
    page.evaluate(NEXT_FRAME)
    assert page.evaluate("document.documentElement.scrollWidth") <= 380
    before = page.evaluate(PATHS)
    slider = page.locator("input[id$=kd]")
    box = slider.bounding_box()
    page.touchscreen.tap(box["x"] + 0.8 * box["width"], box["y"] + box["height"] / 2)
    page.evaluate(NEXT_FRAME)
    kd = value_of(page, tuner, "kd")
    assert 50 < kd < 75 and page.evaluate(PATHS) != before
    assert_shown(page, tuner, kd=kd)
    page.get_by_role("switch").tap()
    assert_shown(page, tuner, kd=kd, feedforward=True)
    context.close()
