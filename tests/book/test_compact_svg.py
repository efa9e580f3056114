"""Figures in the pages take fewer bytes and look the same."""

import io
import re
import sys
import xml.etree.ElementTree as ET

import numpy as np
import pytest
from book_pages import ROOT
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

from ddlib import figures
from ddlib.figures import COLOURS, illustrate

sys.path.insert(0, str(ROOT / "book" / "_ext"))
from compact_svg import compact, relative


def draw(figure):
    """Curves, markers, alpha, clipped points, text in two sizes and turned by 90 degrees."""
    left, right = figure.subplots(1, 2)
    x = np.linspace(0, 10, 200)
    left.plot(x, np.sin(x), x, np.cos(x) ** 3, "--", label="curve")
    left.fill_between(x, np.sin(x), alpha=0.3)
    left.bar([2, 3], [0.5, 0.7], hatch="//", edgecolor="#c2559d")
    left.set(xlim=(1, 9), xlabel="time, s", ylabel="turned, °", title="$\\tau_1$ & <b>")
    rng = np.random.default_rng(0)
    right.scatter(*rng.normal(size=(2, 50)), c=rng.choice(COLOURS, 50), alpha=0.7)
    right.semilogy([1, 2, 3], [1e-3, 1, 1e4], "s-")
    left.legend(["a", "b"])


PICTURES = {
    "curves": lambda: illustrate(draw, "Curves & points."),
    "square": lambda: figures.extents_square([[0, 45], [45, 45], [20, 0]], [40, 15], [[3, 4]]),
}


def pixels(page, svg: str) -> np.ndarray:
    page.set_content(f'<body style="background:#fff;color:#123">{svg}')
    shot = page.screenshot(full_page=True)
    return np.asarray(Image.open(io.BytesIO(shot)).convert("RGB")).astype(int)


@pytest.mark.browser
@pytest.mark.parametrize("name", PICTURES)
def test_the_picture_stays(name, browser):
    svg = PICTURES[name]().svg
    page = browser.new_page()
    before, after = pixels(page, svg), pixels(page, compact(svg, "f0"))
    assert before.shape == after.shape
    assert (before < 128).any(axis=2).mean() > 0.002  # something is drawn
    assert (abs(before - after).max(axis=2) > 64).mean() < 2e-5
    assert abs(before - after).mean() < 0.2
    page.close()


@pytest.mark.parametrize("name", PICTURES)
def test_it_takes_fewer_bytes(name):
    svg = PICTURES[name]().svg
    assert len(compact(svg, "f0")) < 0.6 * len(svg)


def test_names_and_references_hold():
    svg = PICTURES["curves"]().svg
    small = [compact(svg, f"f{k}") for k in range(2)]
    roots = [ET.fromstring(one) for one in small]
    ids = [{e.get("id") for e in root.iter()} - {None} for root in roots]
    assert ids[0] and not ids[0] & ids[1]
    for one, own in zip(small, ids):
        targets = {a or b for a, b in re.findall(r'href="#([^"]*)"|url\(#([^)]*)\)', one)}
        assert targets == own  # each is used, and each is there
    for name in ("role", "aria-label", "viewBox", "style"):
        assert roots[0].get(name) == ET.fromstring(svg).get(name)


def test_letters_are_defined_once_on_a_page():
    svgs = [PICTURES[name]().svg for name in ("curves", "square", "curves")]
    letters = {}
    small = [compact(svg, f"f{k}", letters) for k, svg in enumerate(svgs)]
    assert letters
    assert [len(re.findall("<path id", one)) for one in small][2] < len(letters)
    elements = [e for one in small for e in ET.fromstring(one).iter()]
    ids = [e.get("id") for e in elements if "id" in e.keys()]
    assert len(ids) == len(set(ids))
    assert set(re.findall(r'href="#([^"]*)"', "".join(small))) <= set(ids)
    outlines = [e.get("d") for e in elements if e.get("transform") == "scale(0.25)"]
    assert len(outlines) == len(set(outlines)) == len(letters)


@pytest.mark.browser
def test_a_page_of_pictures_stays(browser):
    svgs = [PICTURES[name]().svg for name in ("square", "curves")]
    letters = {}
    small = [compact(svg, f"f{k}", letters) for k, svg in enumerate(svgs)]
    page = browser.new_page()
    folded = "<details><summary>folded</summary>{}</details>{}"  # letters come from in there
    before, after = (pixels(page, folded.format(*some)) for some in (svgs, small))
    assert (before < 128).any(axis=2).mean() > 0.002
    assert (abs(before - after).max(axis=2) > 64).mean() < 2e-5
    page.close()


def test_it_changes_nothing_twice():
    once = compact(PICTURES["curves"]().svg, "f0")
    assert compact(once, "f0") == once


def walk(path: str) -> list[tuple[float, float]]:
    """End points and control points of a path in relative or absolute commands."""
    points, here, start = [], np.zeros(2), np.zeros(2)
    for command, numbers in re.findall(r"([MmLlhvQqCcz])([^MmLlhvQqCcz]*)", path):
        values = [float(v) for v in re.findall(r"-?(?:\d+\.?\d*|\.\d+)", numbers)]
        if command == "z":
            here = start
            continue
        if command in "hv":
            pairs = [(v, 0.0) if command == "h" else (0.0, v) for v in values]
        else:
            pairs = list(zip(values[::2], values[1::2]))
        size = {"q": 2, "c": 3}.get(command.lower(), 1)
        for k in range(0, len(pairs), size):
            base = here if command.islower() else np.zeros(2)
            ends = [base + pair for pair in pairs[k : k + size]]
            points += [tuple(end) for end in ends]
            here = ends[-1]
            if command in "Mm" and k == 0:
                start = here
    return points


COORDINATE = st.floats(-500, 500).map(lambda v: round(v, 4))
POINT = st.tuples(COORDINATE, COORDINATE)
SEGMENT = st.one_of(
    st.tuples(st.sampled_from("ML"), st.lists(POINT, min_size=1, max_size=3)),
    st.tuples(st.just("Q"), st.lists(POINT, min_size=2, max_size=2)),
    st.tuples(st.just("C"), st.lists(POINT, min_size=3, max_size=3)),
    st.just(("z", [])),
)


@given(first=POINT, rest=st.lists(SEGMENT, max_size=30), factor=st.sampled_from([1.0, 1 / 16]))
def test_relative_paths_go_through_the_same_points(first, rest, factor):
    segments = [("M", [first]), *rest]
    path = " ".join(f"{c} " + " ".join(f"{x} {y}" for x, y in ps) for c, ps in segments)
    wanted = factor * np.array(walk(path))
    np.testing.assert_allclose(walk(relative(path, 2, factor)), wanted, atol=0.0051)


@pytest.mark.parametrize("path", ["M 0 0 A 1 1 0 0 0 2 2", "M 0 0 h 5", "M 1e-05 0 L 1 1"])
def test_other_paths_are_left_alone(path):
    assert relative(path, 2) == path
