"""What every widget has: a state that is a link and code, reset, keys; traits set at any time."""

from __future__ import annotations

import pytest
from bs4 import BeautifulSoup
from IPython.core.formatters import DisplayFormatter
from lab import VIEW
from matplotlib.colors import to_rgb
from pictures import GREY, role_of
from traitlets import TraitError
from widget_pages import BRIDGE, NEXT_FRAME, copied, page_of
from widget_samples import make, sample_of, widget_kinds

from ddlib.figures import COLOURS, FAINT, ROLES

by_kind = pytest.mark.parametrize("kind", widget_kinds(), ids=lambda kind: kind.__name__)
in_browser = pytest.mark.browser


@by_kind
def test_what_a_choice_cannot_be_is_refused(kind):
    widget = sample_of(kind)
    for name in (parameter["name"] for parameter in widget.spec.get("parameters", ())):
        before = getattr(widget, name)
        for unfit in (-1e9, "nothing", [0]):
            with pytest.raises(TraitError, match=name):
                setattr(widget, name, unfit)
        assert getattr(widget, name) == before


@by_kind
def test_it_says_what_it_is(kind):
    assert repr(sample_of(kind)).startswith(f"{kind.__name__}(")


@by_kind
def test_a_viewer_that_shows_no_widget_has_its_picture(kind):
    widget = sample_of(kind)
    shown, _ = DisplayFormatter().format(widget)
    picture = BeautifulSoup(shown["text/html"], "html.parser").img
    assert VIEW in shown and picture["src"] == widget.still and picture["alt"] == widget.still_alt


SHOWN = """() => {
  const all = (what) => [...document.querySelectorAll(`.ddlib-widget ${what}`)];
  const fields = all("input:not([id$=-time]), select");
  return [
    fields.map((el) => (el.type === "checkbox" ? el.checked : el.value)),
    all("output:not([for$=-time]), [role=spinbutton]").map((el) => el.textContent),
    all("[role=slider]").map((el) => el.getAttribute("aria-valuenow")),
    all(".chart > svg > .curve").map((el) => el.getAttribute("d")),
  ];
}"""
"""What a reader sees of the state: fields, numbers, handles and curves. A moment that is played is
no part of it."""

SAME = f"(wanted) => JSON.stringify(({SHOWN})()) === JSON.stringify(wanted)"
HANDLES = "input, select, [role=slider], [role=button], [role=spinbutton], [role=application], "
HANDLES += "svg[tabindex], .ddlib-widget button"
IN_BAR = "(el) => Boolean(el.closest('.bar, .chart'))"
ADDRESS = "(link) => location.href.split('#')[0] === link.split('#')[0]"


def by_keyboard(page) -> str:
    """Change the first thing that keys change; the link to what it became."""
    start = copied(page, "Link")
    for handle in page.locator(HANDLES).all():
        if not handle.is_visible() or handle.is_disabled() or handle.evaluate(IN_BAR):
            continue
        for key in ("ArrowRight", "ArrowUp", "Space", "Home"):
            handle.press(key)
            page.evaluate(NEXT_FRAME)
            if copied(page, "Link") == start:
                continue
            for running in page.get_by_role("button", name="Pause").all():
                running.click()
            page.evaluate(NEXT_FRAME)
            return copied(page, "Link")
    raise AssertionError("no key changes the state")


@in_browser
@by_kind
def test_the_state_is_a_link_and_reset_is_the_start(page_with, kind):
    """By keys alone; what is copied as code is Python."""
    page = page_with(sample_of(kind), calm=True)
    url, start = page.url, page.evaluate(SHOWN)
    link = by_keyboard(page)
    changed = page.evaluate(SHOWN)
    page.wait_for_function(ADDRESS, arg=link)
    page.get_by_role("button", name="Reset to the start").click()
    page.wait_for_function(ADDRESS, arg=url)
    page.wait_for_function(SAME, arg=start)
    page.goto(link)
    page.wait_for_function(SAME, arg=changed)
    assert copied(page, "Link") == link
    if page.get_by_role("button", name="Code").count():
        compile(copied(page), "code", "exec")


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
HIDE = "<style>main > div { display: none }</style>"
SHOW = "document.querySelectorAll('main > div').forEach((el) => (el.style.display = 'block'))"
REACHED = "document.querySelector('.ddlib-trainer')?.school.epoch === 5"
EMPTY = """[...document.querySelectorAll(".chart > svg")]
  .filter((svg) => !svg.querySelector(".curve[d^=M]")).length"""


@pytest.fixture(scope="module")
def every():
    return [make(), *(sample_of(kind) for kind in widget_kinds())]


@in_browser
@pytest.mark.parametrize("hidden", [False, True], ids=["shown", "in a tab behind"])
def test_a_trait_may_be_set_before_there_is_a_size(page_with, every, hidden):
    extra = f"{HIDE if hidden else ''}<script>{CHANGES}</script>{BRIDGE}"
    page = page_with(*every, extra=extra, calm=True)
    page.wait_for_function(REACHED)
    if hidden:
        page.evaluate(SHOW)
    page.evaluate(NEXT_FRAME)
    page.wait_for_function(f"{EMPTY} === 0")
    assert not page.locator(".ddlib-widget-error").all_inner_texts()
    assert page.locator("main > div.ddlib-widget").count() == len(every)
    assert page.locator(".chart > svg").count() > 20


HUES = """() => {
  const plain = (colours) => colours.filter((c) => c.startsWith("rgb("));
  const of = (el) => plain([getComputedStyle(el).stroke, getComputedStyle(el).fill]);
  const all = (what) => [...document.querySelectorAll(`.ddlib-widget ${what}`)];
  const parts = all("svg :is(path, line, rect, circle, polyline, polygon)");
  const inks = all("").flatMap((el) => {
    const probe = el.appendChild(document.createElement("i"));
    const found = ["ink", "soft", "line", "paper"].map((name) => {
      probe.style.color = `var(--${name})`;
      return getComputedStyle(probe).color;
    });
    probe.remove();
    return found;
  });
  return {
    drawn: [...new Set(parts.filter((el) => !el.closest("defs")).flatMap(of))],
    inks,
    named: all(".legend span:has(path)")
      .map((el) => [el.textContent, of(el.querySelector("path:last-child"))]),
  };
}"""
"""Colours of all that is drawn, of the page's own inks, and of each name in a legend."""


@in_browser
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_colours_are_of_roles_and_a_name_has_its_own(tmp_path, visit, every, scheme):
    page = visit(page_of(tmp_path / "page.html", *every), scheme=scheme).page
    page.evaluate(NEXT_FRAME)
    found = page.evaluate(HUES)
    tones = {role: seen(pair[scheme == "dark"]) for role, pair in ROLES.items()}
    known = {*tones.values(), *found["inks"], *map(seen, (*COLOURS, FAINT, GREY, "white", "black"))}
    known |= {seen(("#f8ebbd", "#4d4526")[scheme == "dark"])}  # the window as an area
    on_grey = seen(ROLES["window"][1])
    assert set(found["drawn"]) <= {*known, on_grey}
    assert set(tones.values()) <= set(found["drawn"])
    named = [(role_of(name), name, hues) for name, hues in found["named"]]
    assert {role for role, *_ in named} > {"shoulder", "elbow", "network", "even", "odd", "wanted"}
    wrong = [(name, hues) for role, name, hues in named if role and tones[role] not in hues]
    assert not wrong, wrong


def seen(colour: str) -> str:
    """A colour as a browser writes it."""
    return "rgb({:.0f}, {:.0f}, {:.0f})".format(*(255 * part for part in to_rgb(colour)))
