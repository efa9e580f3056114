"""What every widget has: a state that is a link, reset, keys; and traits may be set at any time."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from widget_pages import BRIDGE, CALM, NEXT_FRAME, copied, page_of
from widget_samples import make, make_kinds

from ddlib import widgets as room
from ddlib.learning import TorqueModel, TrainingSet, Weights
from ddlib.setups import STATE_FEEDBACK, split
from workshop.chapters.widgets import (
    builder,
    feedforward,
    fold,
    sentence,
    terms,
    throw,
    tuner,
    weights,
    whose,
    window,
)
from workshop.chapters.widgets.weight import OneWeight

LESSONS = builder, feedforward, fold, sentence, terms, throw, tuner, weights, whose, window
pytestmark = [pytest.mark.browser, pytest.mark.slow]

HIDE = "<style>main > div { display: none }</style>"
SHOW = "document.querySelectorAll('main > div').forEach((el) => (el.style.display = 'block'))"
EMPTY = """[...document.querySelectorAll(".chart > svg")]
  .filter((svg) => !svg.querySelector(".curve[d^=M]")).length"""
# Every choice at the other end of its range, as Python could set it at once.
CHANGES = """
window.early = (model) => {
  const spec = model.get("spec");
  for (const p of spec.parameters ?? []) {
    const other = p.options ? p.options.map(([key]) => key) : [p.low, p.high];
    model.set(p.name, other.find((value) => value !== model.get(p.name)) ?? model.get(p.name));
  }
  if (spec.seeds) { model.set("seed", 2); model.set("epoch", 5); }
  if (spec.rounds) model.set("round", 1);
  for (const { name, high } of spec.numbers?.slice?.(0, 1) ?? []) {
    model.set("values", { ...model.get("values"), [name]: high });
  }
};
"""


@cache
def samples() -> dict:
    """What makes one of each public widget, and two plain ones."""
    recording = STATE_FEEDBACK.record()
    data = TrainingSet.from_recording(split(recording)[0], 7)
    ensemble = TorqueModel(Weights.random(3, 7, hidden=4), data.inputs, data.outputs)
    wide = TorqueModel(Weights.random(3, 11, hidden=4), data.inputs, data.outputs)
    single, (start, trained) = ensemble[0], Weights.random(2, 7, hidden=3)
    film = TorqueModel(
        Weights.stack([Weights.random(2, 7, hidden=4, seed=k) for k in (1, 2, 3)]),
        *(data.inputs, data.outputs),
    )
    rows = np.random.default_rng(0).normal(size=(2, 5, 9))
    rounds = [whose.GuessRound(*rows, "learnt noise", "A remark.")] * 2
    made = {
        "FilterBuilder": lambda: builder.FilterBuilder(np.arange(-10, 11.0) ** 2),
        "FilterExplorer": lambda: room.FilterExplorer({7: ensemble, 11: wide}, (0, 1), step=0.01),
        "FilterFold": lambda: fold.FilterFold({"up": rows[0, 0], "down": -rows[0, 0]}, 0.01),
        "FeedforwardSwitches": lambda: feedforward.FeedforwardSwitches(),
        "HiddenTorque": lambda: window.HiddenTorque(split(recording)[1]),
        "LoopSentence": lambda: sentence.LoopSentence(),
        "NetworkTrainer": lambda: room.NetworkTrainer(),
        "PIDTuner": lambda: tuner.PIDTuner(),
        "RealArmSwitches": lambda: room.RealArmSwitches(),
        "SlidingWindow": lambda: window.SlidingWindow(
            {7: single, 11: wide[0]}, split(recording)[1]
        ),
        "ThrownArm": lambda: throw.ThrownArm(single),
        "TorqueSentence": lambda: sentence.TorqueSentence(),
        "TorqueTerms": lambda: terms.TorqueTerms(),
        "TrainingPlayer": lambda: room.TrainingPlayer([0, 10, 20], film, recording, member=1),
        "TrajectoryPicker": lambda: room.TrajectoryPicker(),
        "WeightReader": lambda: weights.WeightReader(start, trained, 0.01),
        "WhoseFilters": lambda: whose.WhoseFilters(rounds),
        "CurveWidget": make,
        "OneWeight": OneWeight,
        "kinds": make_kinds,
    }
    return made


NAMES = (
    "FeedforwardSwitches", "FilterBuilder", "FilterExplorer", "FilterFold", "HiddenTorque",
    "LoopSentence", "NetworkTrainer", "PIDTuner", "RealArmSwitches", "SlidingWindow", "ThrownArm",
    "TorqueSentence", "TorqueTerms", "TrainingPlayer", "TrajectoryPicker", "WeightReader",
    "WhoseFilters", "CurveWidget", "OneWeight", "kinds",
)  # fmt: skip


OWN = ("LoopSentence", "NetworkTrainer", "PIDTuner", "ThrownArm", "TorqueSentence")
"""What these show hangs on more than their state, as a ghost of the one before: see their own."""


@pytest.fixture(scope="module")
def every():
    return [make() for make in samples().values()]


def test_every_public_widget_is_here():
    public = {n for n in dir(room) if hasattr(getattr(room, n), "_esm")}
    for module in LESSONS:
        for name, kind in vars(module).items():
            if hasattr(kind, "_esm") and kind.__module__ == module.__name__ and name[0] != "_":
                public.add(name)
    assert public <= set(samples()) == set(NAMES)


SHOWN = """() => {
  const all = (what) => [...document.querySelectorAll(`.ddlib-widget ${what}`)];
  const fields = all("input, select").map((el) => (el.type === "checkbox" ? el.checked : el.value));
  const texts = all("output").map((el) => el.textContent);
  return [fields, texts, all(".chart > svg > .curve").map((el) => el.getAttribute("d"))];
}"""
"""What a reader sees of the state: fields, numbers and curves."""

HANDLES = "input, select, [role=slider], [role=application], svg[tabindex], main button"


def by_keyboard(page):
    """Change the first thing that keys change: the address tells that one did."""
    for handle in page.locator(HANDLES).all():
        if not handle.is_visible() or handle.is_disabled() or handle.evaluate(IN_BAR):
            continue
        for key in ("ArrowRight", "ArrowUp", "Space", "Home"):
            handle.press(key)
            page.wait_for_timeout(60)
        page.wait_for_timeout(LATER)
        if page.evaluate("location.search"):
            return
    raise AssertionError("no key changes the state")


IN_BAR = "(el) => Boolean(el.closest('.bar, .chart'))"
LATER = 600  # ms in which the address has followed


@pytest.mark.parametrize("name", [name for name in NAMES if name not in OWN])
def test_the_state_is_a_link_and_reset_is_the_start(tmp_path, visit, name):
    """By keys alone; what is copied as code is Python."""
    url = page_of(tmp_path / "page.html", samples()[name]())
    here = visit(url, **CALM)
    page = here.page
    page.evaluate(NEXT_FRAME)
    start = page.evaluate(SHOWN)
    by_keyboard(page)
    link, changed = copied(page, "Link"), page.evaluate(SHOWN)
    assert link.startswith(f"{url}?") and link.endswith("-widget")
    again = visit(link, **CALM).page
    again.evaluate(NEXT_FRAME)
    assert again.evaluate(SHOWN) == changed
    page.bring_to_front()
    if page.get_by_role("button", name="Copy this state as Python code").count():
        page.evaluate("window.copied = undefined")
        compile(copied(page), "code", "exec")
    page.get_by_role("button", name="Reset to the start").click()
    page.wait_for_function("!location.search")
    page.evaluate(NEXT_FRAME)
    assert page.evaluate(SHOWN) == start
    assert not here.problems


@pytest.mark.parametrize("hidden", [False, True], ids=["shown", "in a tab behind"])
def test_a_trait_may_be_set_before_there_is_a_size(tmp_path, visit, every, hidden):
    extra = f"{HIDE if hidden else ''}<script>{CHANGES}</script>{BRIDGE}"
    here = visit(page_of(tmp_path / "page.html", *every, extra=extra), **CALM)
    page = here.page
    if hidden:
        page.wait_for_timeout(300)
        page.evaluate(SHOW)
    page.evaluate(NEXT_FRAME)
    page.wait_for_timeout(300)
    assert not page.locator(".ddlib-widget-error").all_inner_texts()
    assert page.locator("main > div.ddlib-widget").count() == len(every)
    assert page.evaluate(EMPTY) == 0 and page.locator(".chart > svg").count() > 20
    assert page.evaluate("document.querySelector('.ddlib-trainer').school.epoch") == 5
    assert not here.problems
