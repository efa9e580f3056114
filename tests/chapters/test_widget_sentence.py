"""Sentences with numbers to move: their ends against ddlib, by keys, pointer and touch."""

from __future__ import annotations

import numpy as np
import pytest
from widget_pages import LESSONS, functions

from ddlib.dynamics import CMU_DD_ARM_II
from ddlib.setups import JOINT_DAMPING_VISCOUS
from workshop.chapters.widgets.sentence import LoopSentence, TorqueSentence

SPACE = "\u00a0"
ENDS = "([spec, all]) => all.map((values) => ENDS[spec.kind](spec, values))"


@pytest.fixture(scope="module")
def evaluate(browser):
    with functions(browser, LESSONS / "sentence.js") as call:
        yield call


def drawn(sentence, n, seed):
    """Random settings on the steps of the numbers, the corners among them."""
    rng = np.random.default_rng(seed)
    numbers = sentence.spec["numbers"]
    rows = [{k["name"]: k[end] for k in numbers} for end in ("low", "high", "value")]
    for _ in range(n):
        row = {}
        for k in numbers:
            steps = rng.integers(0, round((k["high"] - k["low"]) / k["step"]) + 1)
            row[k["name"]] = float(k["low"] + k["step"] * steps)
        rows.append(row)
    return rows


@pytest.mark.browser
@pytest.mark.parametrize("kind, n", [(TorqueSentence, 200), (LoopSentence, 60)])
def test_the_page_says_what_ddlib_says(evaluate, kind, n):
    sentence = kind()
    settings = drawn(sentence, n, 3)
    if kind is LoopSentence:  # not where rounding decides
        settings = [s for s in settings if abs(sentence.growth(**s)) > 1e-6]
    ends = evaluate(ENDS, [sentence.spec, settings])
    assert len({str(x) for x in ends}) > n / 4
    for values, texts in zip(settings, ends):
        known = sentence.results(**values)
        assert {k: v.replace(SPACE, " ") for k, v in texts.items()} == known


def test_torques_are_those_of_the_arm():
    sentence = TorqueSentence()
    b = CMU_DD_ARM_II.b  # elbow at a right angle: -2 b qd1 qd2 - b qd2^2, and b qd1^2
    known = [f"{x:.2f} N m".replace("-", "−") for x in (-4 * b - 4 * b, b)]
    assert list(sentence.results(elbow=90, first=1, second=2).values()) == known
    assert known[0] in sentence.text() and sentence.still_alt == sentence.text()


def test_the_limit_of_a_spring_lies_between_those_of_the_joints():
    """Twice the friction over the period, for each joint alone; the elbow's is the lower one."""
    sentence = LoopSentence()
    share = JOINT_DAMPING_VISCOUS[1] / JOINT_DAMPING_VISCOUS[0]
    lower = share / sentence.spec["ratios"]["kp"]  # of the elbow, in terms of the shoulder's gain
    for friction, period in ((5.3, 2.0), (3.0, 1.0)):
        limit = 2 * friction / (1e-3 * period)
        growth = [
            sentence.growth(period=period, kp=part * limit, kd=0, friction=friction)
            for part in (0.99 * lower, 1.01)
        ]
        assert lower < 1 and growth[0] < 0 < growth[1]
    assert "stable, and a disturbance" in sentence.results(**sentence.values)["verdict"]


READ = """() => {
  const copy = document.querySelector(".sentence").cloneNode(true);
  copy.querySelectorAll(".stepper").forEach((el) => el.remove());
  return copy.textContent;
}"""


def end_of(page):
    return page.evaluate(READ).replace(SPACE, " ")


@pytest.mark.browser
def test_keys_and_pointer(page_with):
    sentence = TorqueSentence()
    page = page_with(sentence)
    assert end_of(page) == sentence.text()
    number = page.get_by_role("spinbutton", name="Speed of the shoulder")
    number.press("ArrowUp")
    number.press("PageDown")
    sentence.values = {"first": 0.1}
    assert end_of(page) == sentence.text() and number.get_attribute("aria-valuenow") == "0.1"
    number.press("End")
    box = page.get_by_role("spinbutton", name="Elbow angle").bounding_box()
    page.mouse.move(box["x"] + 5, box["y"] + 5)
    page.mouse.down()
    page.mouse.move(box["x"] - 55, box["y"] + 5, steps=3)  # ten steps of five degrees
    page.mouse.up()
    sentence.values = {"first": 4, "elbow": 40}
    assert end_of(page) == sentence.text()
