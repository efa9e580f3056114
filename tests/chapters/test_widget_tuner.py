"""The PID tuner: what the page computes against ddlib and python-control, and its page."""

from __future__ import annotations

import re
from functools import cache

import numpy as np
import pytest
from widget_pages import LESSONS, NEXT_FRAME, drag, functions

from ddlib.control import PID, Feedforward, closed_loop, plant
from ddlib.dynamics import CMU_DD_ARM_II, IMI_ARM
from ddlib.effects import Effects, ViscousFriction
from ddlib.setups import JOINT_DAMPING_KP as KP, JOINT_DAMPING_VISCOUS as VISCOUS
from ddlib.simulation import CONTROL_STEP, record
from ddlib.trajectories import APPENDIX_I
from workshop.chapters.widgets import loops
from workshop.chapters.widgets.tuner import PIDTuner, tuned

ARM = CMU_DD_ARM_II
CALM = {"load": False, "dry": False, "limit": "none", "noise": False}
START = {"kp": KP[0], "ki": 0.0, "kd": 0.0, "late": 0, "feedforward": False, **CALM}
TIMES = 0.01 * np.arange(351)
LATE = (TIMES >= 1) & (TIMES < 3)
JOINTS = ("shoulder", "elbow")


@pytest.fixture(scope="module")
def tuner():
    return PIDTuner()


@pytest.fixture(scope="module")
def engine(browser):
    with functions(browser, LESSONS / "loops.js") as call:
        yield call


@cache
def known_run(**setting):
    """The same by ddlib; settings that are not given are those of the start."""
    return tuned(ARM, **{**START, **setting})


def gains(kp, ki, kd):
    """Of both joints, from the shoulder's."""
    stiff = np.array([1.0, KP[1] / KP[0]])
    return {"kp": kp * stiff, "ki": ki * stiff, "kd": kd * np.array([1.0, 0.2])}


def rms(x):
    return np.sqrt(np.mean(x**2))


# What is computed


def test_curves_are_the_recorded_ones():
    """The same run with a rest before the motion, by `record`."""
    feedback = PID(**gains(200, 100, 30))
    recording = record(
        ARM,
        Feedforward(ARM, feedback),
        APPENDIX_I[5],
        effects=Effects(friction=(ViscousFriction(VISCOUS),)),
    )
    shown = tuned(ARM, 200, 100, 30, 0, True)
    at = np.searchsorted(recording.t, TIMES[TIMES < 2.9995] - 1e-9)
    error = np.rad2deg(recording.tracking_error)
    for j, joint in enumerate(JOINTS):
        np.testing.assert_allclose(shown[f"{joint} error"][: len(at)], error[at, j], atol=1e-9)
        torque = recording.tau_true[at, j]
        np.testing.assert_allclose(shown[f"{joint} torque"][: len(at)], torque, atol=1e-9)
        assert shown[f"{joint} RMS"] == pytest.approx(rms(error[recording.motion, j]))


LINEAR = """([modes, all]) => all.map(([gains, step, late]) => {
  const margins = [0, 1].map((j) => marginOf(modes, gains, step, late, j));
  return [growthOf(modes, gains, step, late), ...margins.flatMap((m) => [m.phase, m.crossover])];
})"""


@pytest.mark.browser
@pytest.mark.parametrize("arm", [ARM, IMI_ARM], ids=lambda arm: arm.name)
def test_growth_and_margins_are_python_controls(engine, arm):
    """At random gains, delays and control periods; the margins where a loop is stable."""
    rng = np.random.default_rng(7)
    given, wanted = [], []
    for k in range(30):
        kp, kd = rng.uniform(40, 1200), rng.uniform(0, 80) * (k % 4 > 0)
        law = gains(kp, rng.uniform(0, 900) * (k % 3 > 0), kd)
        step, late = rng.choice([0.0005, 0.002, 0.008]), int(rng.choice([0, 1, 3, 20]))
        velocity = ("tachometer", "difference")[k % 2]
        near = loops.linear(arm, VISCOUS, law, late, step, velocity)
        gained = {name: x.tolist() for name, x in law.items()}
        given.append([{**gained, "differs": velocity == "difference"}, step, late])
        wanted.append([near.growth, *np.ravel([near.phase_deg, near.crossover], order="F")])
    answer = np.array(engine(LINEAR, [loops.modes(arm, VISCOUS), given]), dtype=float)
    wanted = np.array(wanted)
    stable = wanted[:, 0] < 0
    assert 5 < stable.sum() < 25
    np.testing.assert_allclose(answer[:, 0], wanted[:, 0], rtol=1e-6, atol=1e-6)
    np.testing.assert_allclose(answer[stable], wanted[stable], rtol=1e-5, atol=1e-5)


# The answers to what is asked


def swing(run, begin, end):
    at = (TIMES >= begin) & (TIMES < end)
    return max(np.ptp(run[f"{joint} error"][at]) / 2 for joint in JOINTS)


def asked(tuner):
    """Its questions, with the runs before and after what each asks about."""
    questions = tuner.loop["questions"]
    return questions, *zip(*([known_run(**x) for x in q["settings"]] for q in questions))


def test_what_happens_if(tuner):
    """Each answer that the page calls right, by ddlib, with a margin."""
    questions, before, after = asked(tuner)
    for k in (0, 2, 4, 5):
        assert "grows" in questions[k]["choices"][questions[k]["right"]]
        assert after[k]["growth"] > 0.5 and after[k]["stopped"] < 2.8
        assert before[k]["growth"] < 0 and np.isnan(before[k]["stopped"])
    for k in (1, 3):  # settles, where it grew
        assert before[k]["growth"] > 0.5 and after[k]["growth"] < -2
        assert swing(after[k], 2, 3) < swing(known_run(), 2, 3) / 5
    for joint in JOINTS:
        off, on = (x[6][f"{joint} error"] for x in (before, after))
        assert rms(on[LATE]) < rms(off[LATE]) / 2
        assert np.abs(on).max() == pytest.approx(np.abs(off).max(), rel=0.1)


def test_what_happens_if_torque_comes_first():
    tuner = PIDTuner(first="torque", kd=97.5)
    questions, before, after = asked(tuner)
    assert tuner.kd == 97.5 and len(questions) == 3
    clean, coarse = (x[0]["shoulder torque"] for x in (before, after))
    jumps = np.abs(np.diff(coarse - clean))
    assert 45 < np.percentile(jumps[jumps > 20], 50) < 65  # N m: of one count
    assert after[0]["growth"] < 0
    assert swing(after[0], 1, 3) == pytest.approx(swing(before[0], 1, 3), abs=0.1)
    limited, cured = after[1], known_run(**{**questions[1]["settings"][1], "limit": "anti-windup"})
    assert limited["growth"] < -1 and np.isnan(before[1]["stopped"])
    assert np.nanmax(np.abs(limited["shoulder error"])) > 20
    assert np.abs(cured["shoulder error"]).max() < 8
    first = [x[2]["shoulder torque"][0] for x in (before, after)]
    assert first[1] == pytest.approx(2 * first[0], rel=0.01) and first[0] < -10


# In a page without a kernel

SEEN = """() => {
  const { now, ghost } = document.querySelector(".ddlib-tuner").view;
  const { error, torque, rms, growth, log, margins } = now;
  return { error: error.map((x) => [...x]), torque: torque.map((x) => [...x]), rms, growth,
    stopped: log.stopped, margins, setting: now.setting, before: ghost.setting };
}"""


def assert_computed(page, **setting):
    """Everything that the page computed is ddlib's, to 1e-6 rad."""
    page.evaluate(NEXT_FRAME)
    seen, known = page.evaluate(SEEN), known_run(**setting)
    for j, joint in enumerate(JOINTS):
        error = np.deg2rad(np.array(seen["error"][j], float))
        np.testing.assert_allclose(error, np.deg2rad(known[f"{joint} error"]), atol=1e-6)
        torque = np.array(seen["torque"][j], float)
        np.testing.assert_allclose(torque, known[f"{joint} torque"], atol=1e-3)
        for got, name in ((seen["rms"][j], "RMS"), (seen["margins"][j]["phase"], "phase margin")):
            assert got == pytest.approx(known[f"{joint} {name}"], rel=1e-5, nan_ok=True)
    assert seen["growth"] == pytest.approx(known["growth"], rel=1e-6)
    ended = np.nan if seen["stopped"] is None else TIMES[seen["stopped"]]
    assert ended == pytest.approx(known["stopped"], nan_ok=True)


def value_of(page, tuner, name):
    """The parameter that the slider stands at."""
    place = page.locator(f"input[id$=-{name}]").evaluate("(x) => x.value / x.max")
    return tuner._parameters[name].place(place)


@pytest.mark.browser
def test_drag_keys_and_the_ghost(page_with, tuner):
    page = page_with(tuner, calm=True)
    assert_computed(page)
    drag(page, page.locator("input[id$=-kp]").bounding_box(), (0.56, 0.5), (0.9, 0.5))
    kp = value_of(page, tuner, "kp")
    assert_computed(page, kp=kp)
    assert page.evaluate(SEEN)["before"] == START  # the ghost stands where the change began
    page.wait_for_timeout(1000)  # a new change begins
    page.locator("input[id$=-kd]").press("End")
    page.locator("input[id$=-ki]").press("ArrowRight")
    page.evaluate(NEXT_FRAME)
    ki = value_of(page, tuner, "ki")
    page.locator("input[id$=-late]").press("ArrowRight")
    assert_computed(page, kp=kp, kd=150.0, ki=ki, late=1)
    assert page.evaluate(SEEN)["before"] == {**START, "kp": pytest.approx(kp)}
    assert "stable" in page.locator(".verdict").inner_text()


@pytest.mark.browser
def test_a_slow_drag_and_a_quick_click_begin_once(page_with, tuner):
    """The ghost is where the hand took hold, however long it rests on the way."""
    page = page_with(tuner, calm=True)
    box = page.locator("input[id$=-kp]").bounding_box()
    middle = box["y"] + box["height"] / 2
    page.mouse.move(box["x"] + 0.56 * box["width"], middle)
    page.mouse.down()
    for place in (0.65, 0.75):
        page.mouse.move(box["x"] + place * box["width"], middle, steps=3)
        page.wait_for_timeout(1000)
    page.mouse.up()
    page.evaluate(NEXT_FRAME)
    assert page.evaluate(SEEN)["before"] == START
    kp = value_of(page, tuner, "kp")
    page.locator(".more summary").click()
    page.locator("input[id$=-dry]").click()
    page.evaluate(NEXT_FRAME)
    assert page.evaluate(SEEN)["before"] == {**START, "kp": pytest.approx(kp)}


@pytest.mark.browser
def test_time_stands_where_the_run_stopped(page_with, tuner):
    page = page_with(tuner, query="?pidtuner=kp:9000", calm=True)
    time = page.get_by_role("slider", name="Time")
    time.press("End")
    page.evaluate(NEXT_FRAME)
    stopped = TIMES[page.evaluate(SEEN)["stopped"]]
    assert stopped < 3 and float(time.input_value()) == pytest.approx(stopped)
    page.locator(".arm.real.stopped").wait_for(state="attached")
    page.get_by_role("button", name="Play").click()  # from the start again
    assert float(time.input_value()) == 0


DISTURBED = [
    {"kd": 60.0, "ki": 1500.0, "load": True, "dry": True},
    {"kd": 60.0, "ki": 1500.0, "load": True, "limit": "yes"},
    {"kd": 60.0, "ki": 1500.0, "load": True, "limit": "anti-windup", "feedforward": True},
    {"kd": 60.0, "noise": True, "late": 1, "limit": "yes"},
]


@pytest.mark.browser
@pytest.mark.parametrize("setting", DISTURBED, ids=lambda setting: "-".join(setting))
def test_switches(page_with, tuner, setting):
    """From the page's address: everything is ddlib's, and a motor gives no more than its limit."""
    texts = {k: str(x).lower() if isinstance(x, bool) else x for k, x in setting.items()}
    query = ",".join(f"{k}:{x}" for k, x in texts.items())
    page = page_with(tuner, query=f"?pidtuner={query}", calm=True)
    assert_computed(page, **setting)
    assert page.locator("input[id$=-dry]").is_visible()  # what is set is shown
    most = np.nanmax(np.abs(np.array(page.evaluate(SEEN)["torque"], float)), axis=1)
    assert ("limit" in setting) == bool((most <= [20, 6]).all())


def test_an_integral_carries_the_load_and_a_clean_velocity_is_quiet():
    damped = {"kd": 60.0, "load": True}
    spring, patient = (known_run(**damped, ki=ki)["shoulder error"][LATE] for ki in (0.0, 1500.0))
    assert abs(patient.mean()) < abs(spring.mean()) / 2
    jumps = [
        np.abs(np.diff(known_run(kd=60.0, noise=on)["shoulder torque"][LATE])).mean()
        for on in (False, True)
    ]
    assert jumps[1] > 20 * jumps[0]


@pytest.mark.browser
def test_an_unstable_loop_says_what_would_calm_it(page_with, tuner):
    """In the page's own per cent: a little less is stable, a little more is not."""
    page = page_with(tuner, query="?pidtuner=kd:100,late:20", calm=True)
    page.wait_for_function("/%/.test(document.querySelector('.remedy').textContent)")
    remedy = page.locator(".remedy").inner_text()
    part = float(re.search(r"([\d.]+)\s%", remedy)[1]) / 100
    whole, joints = {**START, "kd": 100.0}, plant(ARM.mass_matrix([0.0, 0.0]), VISCOUS)
    stable = []
    for share in (0.96, 1.04):
        law = gains(*(part * share * whole[name] for name in ("kp", "ki", "kd")))
        loop = closed_loop(joints, **law, period=CONTROL_STEP, delay=20)
        stable.append(np.abs(loop.poles()).max() < 1)
    assert stable == [True, False]
