"""The house style: SVG that may stand in any page, in light and dark, and be read aloud."""

import re
import xml.etree.ElementTree as ET

import matplotlib as mpl
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ddlib.figures import COLOURS, DASHES, FAINT, INK, illustrate, style

SVG = "{http://www.w3.org/2000/svg}"


def draw(figure):
    """Lines, a clip path, markers, text with awkward characters."""
    axis = figure.subplots()
    axis.plot([0, 1, 2], [1.0, 3.0, 2.0], "o-", label='a "b" & <c> -- d')
    axis.fill_between([0, 1], [0, 1], alpha=0.3, color=FAINT)
    axis.set(title="torque $\\tau_1$ & <style>x</style>", xlabel="time, s")
    axis.legend()


def ids(svg):
    return [e.attrib["id"] for e in ET.fromstring(svg).iter() if "id" in e.attrib]


def luminance(colour):
    """Relative luminance of WCAG 2."""
    c = np.array([int(colour[k : k + 2], 16) for k in (1, 3, 5)]) / 255
    c = np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)
    return c @ [0.2126, 0.7152, 0.0722]


def contrast(a, b):
    high, low = sorted((luminance(a), luminance(b)), reverse=True)
    return (high + 0.05) / (low + 0.05)


@pytest.mark.parametrize("colour", [*COLOURS, FAINT])
def test_colours_are_seen_in_light_and_in_dark(colour):
    assert contrast("#ffffff", "#000000") == pytest.approx(21)  # the yardstick
    assert contrast(colour, "#ffffff") >= 3 and contrast(colour, "#121212") >= 3


def test_colour_is_never_the_only_difference():
    assert len(DASHES) == len(COLOURS) == len(set(COLOURS)) == len(set(map(str, DASHES)))


def test_an_illustration_is_sound_svg():
    made = illustrate(draw, "A curve that rises and falls.")
    root = ET.fromstring(made.svg)
    assert root.tag == f"{SVG}svg"
    assert root.attrib["role"] == "img"
    assert root.attrib["aria-label"] == made.alt == "A curve that rises and falls."
    assert made._repr_html_() == f'<div class="ddlib-figure">{made.svg}</div>'
    tags = {e.tag for e in root.iter()}
    assert not tags & {f"{SVG}{name}" for name in ("style", "script", "metadata", "text", "image")}
    assert "<?xml" not in made.svg and "<!DOCTYPE" not in made.svg


def test_ink_is_the_colour_of_the_page():
    made = illustrate(draw, "A curve.")
    assert INK not in made.svg and "currentColor" in made.svg
    fixed = re.findall(r"(?:fill|stroke): (#[0-9a-f]{6})", made.svg)
    # black could not be seen on a dark page, white not on a light one
    assert set(fixed) and not set(fixed) & {"#000000", "#ffffff", "#010203"}


def test_the_size_follows_the_page_but_not_beyond_its_own():
    made = illustrate(draw, "A curve.", width=5.0, height=2.5)
    root = ET.fromstring(made.svg)
    assert "width:5.00in" in root.attrib["style"] and "max-width:100%" in root.attrib["style"]
    assert "width" not in root.attrib and "height" not in root.attrib
    assert root.attrib["viewBox"].split() == ["0", "0", "360", "180"]


@pytest.mark.parametrize("alts", [("A.", "B."), ("A.", "A.")], ids=["other words", "same words"])
def test_ids_of_two_figures_differ(alts):
    def empty(figure):
        figure.text(0.5, 0.5, "nothing")

    other = empty if alts[0] == alts[1] else draw
    one, two = illustrate(draw, alts[0]).svg, illustrate(other, alts[1]).svg
    for svg in (one, two):
        assert len(set(ids(svg))) == len(ids(svg)) > 2
    assert not set(ids(one)) & set(ids(two))
    bare = illustrate(empty, "A.").svg, illustrate(empty, "B.").svg
    assert not set(ids(bare[0])) & set(ids(bare[1]))


def test_references_stay_inside():
    svg = illustrate(draw, "A curve.").svg
    found = re.findall(r'href="([^"]*)"|url\(([^)]*)\)', svg)
    assert len(found) > 10
    targets = {a or b for a, b in found}
    assert all(t.startswith("#") for t in targets)
    assert {t[1:] for t in targets} <= set(ids(svg))


def test_the_same_figure_is_the_same_text():
    assert illustrate(draw, "A curve.") == illustrate(draw, "A curve.")


def test_rounding_of_paths_is_not_seen(monkeypatch):
    """Coordinates keep their place to a hundredth of a point."""
    rounded = illustrate(draw, "A curve.").svg
    monkeypatch.setattr(style, "_rounded", lambda path: path[0])
    exact = illustrate(draw, "A curve.").svg
    assert len(rounded) < len(exact)

    def numbers(svg):
        return [
            float(x) for d in re.findall(r' d="([^"]*)"', svg) for x in re.findall(r"[\d.-]+", d)
        ]

    assert len(numbers(exact)) > 500
    np.testing.assert_allclose(numbers(rounded), numbers(exact), atol=0.0051)


def test_settings_of_the_reader_survive(monkeypatch):
    for name, value in (("axes.grid", False), ("font.size", 21.0), ("svg.hashsalt", "own")):
        monkeypatch.setitem(mpl.rcParams, name, value)
    before = dict(mpl.rcParams)
    illustrate(draw, "A curve.")
    assert dict(mpl.rcParams) == before

    def fails(figure):
        raise RuntimeError("in the middle")

    with pytest.raises(RuntimeError, match="in the middle"):
        illustrate(fails, "A curve.")
    assert dict(mpl.rcParams) == before


@settings(max_examples=15)
@given(alt=st.text("abc \"'<>&#;=$\\é–", min_size=1, max_size=30).filter(str.strip))
def test_any_words_can_describe_a_figure(alt):
    def little(figure):
        figure.text(0.5, 0.5, "x")

    made = illustrate(little, alt, 1.0, 1.0)
    assert ET.fromstring(made.svg).attrib["aria-label"] == alt


@pytest.mark.parametrize("alt", ["", "  ", "\n\t"])
def test_a_figure_without_words_is_refused(alt):
    def never(figure):
        raise AssertionError("drawn before the check")

    with pytest.raises(ValueError, match="alt must describe the figure"):
        illustrate(never, alt)


def test_a_saved_file_has_its_own_colours(tmp_path):
    made = illustrate(draw, "A curve.")
    path = tmp_path / "curve.svg"
    made.save(path, ink="#112233", paper="#fefefe")
    text = path.read_text(encoding="utf-8")
    root = ET.parse(path).getroot()  # sound XML: no attribute twice
    assert root.tag == f"{SVG}svg"
    assert "background:#fefefe" in root.attrib["style"]
    assert "max-width:100%" in root.attrib["style"]
    assert "currentColor" not in text and "#112233" in text
    assert root.attrib["aria-label"] == "A curve."


@pytest.mark.parametrize("names", [["a", "b"], ["training", "test, after 20,000 epochs"] * 3])
def test_a_legend_above_lies_on_no_curve(names):
    """Within the figure, outside the axes."""
    boxes = {}

    def draw(figure):
        axis = figure.subplots()
        lines = [axis.plot([0, 1], [k, 1])[0] for k in range(len(names))]
        style.legend_above(figure, lines, names)
        figure.draw_without_rendering()
        boxes["axis"], boxes["figure"] = axis.get_window_extent(), figure.bbox
        boxes["legend"] = figure.legends[0].get_window_extent()

    style.illustrate(draw, "Lines")
    assert boxes["legend"].y0 >= boxes["axis"].y1
    assert boxes["legend"].x1 <= boxes["figure"].x1


@pytest.mark.parametrize("label", ["rad/s", "N m", "shoulder, N m", "elbow", "", " , N m"])
def test_axis_labels_name_the_quantity(label):
    with pytest.raises(ValueError, match=re.escape(repr(label))):
        style.check_label(label)


@pytest.mark.parametrize("label", ["shoulder torque, N m", "RMSS", "speed, times the paper's"])
def test_good_labels_stay(label):
    assert style.check_label(label) == label
