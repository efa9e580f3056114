"""The house style: SVG that may stand in any page, in light and dark, and be read aloud."""

import re
import xml.etree.ElementTree as ET

import matplotlib as mpl
import numpy as np
import pytest
from book_pages import ROOT
from hypothesis import given, settings, strategies as st
from matplotlib.colors import to_rgb
from pictures import SVG, black_or_white, check_sound, drawn, ids, size, words
from PIL import Image
from pypdf import PdfReader

from ddlib.figures import COLOURS, DASHES, FAINT, MEANINGS, ROLES, TONES, illustrate, looks, style
from ddlib.figures.style import fixed


def draw(figure):
    """Lines, a clip path, markers, text with awkward characters."""
    axis = figure.subplots()
    axis.plot([0, 1, 2], [1.0, 3.0, 2.0], "o-", label='a "b" & <c> -- d')
    axis.fill_between([0, 1], [0, 1], alpha=0.3, color=FAINT)
    axis.set(title="torque $\\tau_1$ & <style>x</style>", xlabel="time, s")
    axis.legend()


def formulas(figure):
    axis = figure.subplots()
    axis.semilogy([0, 1], [1e-3, 10], label=r"error of $\tau_1$ & $\dot q_{\mathrm{fb}}$, N m")
    axis.set(xlabel=r"$a = 2 + b$, s", ylabel="two\nlines", title="first\nsecond")
    axis.legend()


def luminance(colour):
    """Relative luminance of WCAG 2."""
    c = np.array([int(colour[k : k + 2], 16) for k in (1, 3, 5)]) / 255
    c = np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)
    return c @ [0.2126, 0.7152, 0.0722]


def contrast(a, b):
    high, low = sorted((luminance(a), luminance(b)), reverse=True)
    return (high + 0.05) / (low + 0.05)


def test_colours_are_seen_in_light_and_in_dark_and_never_the_only_difference():
    assert contrast("#ffffff", "#000000") == pytest.approx(21)  # the yardstick
    for colour in (*COLOURS, FAINT):
        assert contrast(colour, "#ffffff") >= 3 and contrast(colour, "#121212") >= 3
    assert len(DASHES) == len(COLOURS) == len(set(COLOURS)) == len(set(map(str, DASHES)))
    vivid = [tone for pair in ROLES.values() for tone in pair]
    apart = [np.linalg.norm(np.subtract(to_rgb(a), to_rgb(b))) for a in COLOURS for b in vivid]
    assert min(apart) > 0.15  # what has no role looks like none


SAID = {
    "measured": "measured", "this arm's torques": "measured", "the network": "network",
    "elbow, trained": "elbow", "from the shoulder's window": "shoulder", "window": "window",
    "even part": "even", "a parabola": "even", "a line": "odd", "Coriolis": "odd",
    "reference": "wanted", "the true one": "measured", "before training": "before",
}  # fmt: skip


def test_a_name_says_its_role():
    for name, role in SAID.items():
        assert looks(["a", "b", "c", name])[name].tone == role
    for name in ("window 21", "window of 11", "linear filter", "least squares", "events"):
        assert isinstance(looks(["a", "b", name])[name].tone, int)
    few = looks(["measured", "equations", "network"])
    assert [few[name].tone for name in few] == ["measured", "before", "network"]
    assert looks(["a"], {"a": "odd"})["a"].line == {"color": TONES["odd"], "ls": "--"}


@given(names=st.lists(st.sampled_from([*SAID, *"abcdef"]), min_size=1, max_size=6, unique=True))
def test_no_two_curves_of_a_figure_look_alike(names):
    found = looks(names)
    assert list(found) == names and len({look.dash for look in found.values()}) == len(names)


def test_roles_are_legible_and_the_same_in_figures_and_in_the_page_s_style_sheet():
    style = (ROOT / "book" / "_static" / "book.css").read_text(encoding="utf-8")
    assert MEANINGS.keys() == TONES.keys() and len(TONES) == 10
    for role, (light, dark) in ROLES.items():
        assert contrast(light, "#ffffff") >= 4.5 and contrast(dark, "#16191d") >= 4.5
        assert f"--dd-{role}: {dark};" in style

    def even(figure):
        figure.subplots().plot([0, 1], color=ROLES["even"][0])

    made = illustrate(even, "A line.")
    assert f"var(--dd-even, {ROLES['even'][0]})" in made.svg and "var(" not in fixed(made.svg)


@pytest.mark.parametrize("make", [draw, formulas])
def test_an_illustration_is_sound_svg(make):
    """With the role `img` its texts would not be read aloud."""
    made = illustrate(make, "A curve that rises and falls.")
    check_sound(made)
    assert not black_or_white(made) and len(ids(made.svg)) > 1
    assert "<?xml" not in made.svg and "<!DOCTYPE" not in made.svg
    wide, narrow = re.findall(r"<svg .*?</svg>", made._repr_html_(), re.DOTALL)
    assert (wide, narrow) == (made.svg.strip(), made.narrow.strip())
    assert made == illustrate(make, "A curve that rises and falls.")
    assert made.svg.count("font-family") == 1


def test_texts_are_texts_in_their_order():
    texts = words(illustrate(formulas, "Formulas."))
    assert "error of τ1 & q̇fb, N m" in texts and "a=2+b, s" in texts and "10⁻³" in texts
    assert {"two", "lines", "first", "second"} <= set(texts)


# The narrow form


def side_by_side(figure, columns=2, rows=1, sharey=False):
    axes = figure.subplots(rows, columns, sharex=True, sharey=sharey, squeeze=False)
    for k, axis in enumerate(axes.ravel()):
        axis.plot([0, 1], [0, k + 1], label="a curve")
        axis.set_title(f"panel {k}")
    for axis in axes[-1]:
        axis.set_xlabel("time, s")
    for row in axes:
        row[0].set_ylabel("torque, N m")
    style.legend_above(figure, *axes[0, 0].get_legend_handles_labels())


@pytest.mark.parametrize(("columns", "rows"), [(1, 1), (3, 1), (2, 2)])
def test_on_a_narrow_page_panels_stand_below_each_other(columns, rows):
    made = illustrate(lambda figure: side_by_side(figure, columns, rows), "Panels.")
    width, height = size(made.narrow)
    assert width == pytest.approx(72 * style.NARROW) and height > (rows * columns - 1) * 72
    titles = [e for e in ET.fromstring(made.narrow).iter(f"{SVG}text") if "panel" in (e.text or "")]
    x, y = np.array([(float(e.attrib["x"]), float(e.attrib["y"])) for e in titles]).T
    assert [e.text for e in titles] == [f"panel {k}" for k in range(rows * columns)]
    assert len(set(x)) == 1 and (np.diff(y) > 0).all()


def test_what_neighbours_shared_each_panel_has_when_they_stand_apart():
    made = illustrate(lambda figure: side_by_side(figure, sharey=True), "Panels.")
    assert words(made).count("torque, N m") == 1
    assert made.narrow.count("torque, N m") == 2


def crowded(figure):
    axis = figure.subplots()
    for x in (0.2, 0.3):
        axis.text(x, 0.5, "a long label")


def beyond(figure):
    figure.subplots().text(0.5, 0.5, "a label that is longer than a narrow page is wide")


def heavy(figure):
    figure.subplots().plot(*np.random.default_rng(0).random((2, 3000)), ".")


@pytest.mark.parametrize("make", [crowded, beyond, heavy])
def test_where_it_cannot_be_read_there_is_none(make):
    made = illustrate(make, "A figure.")
    assert made.narrow == ""
    assert made._repr_html_() == f'<div class="ddlib-figure">{made.svg}</div>'


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
    made = illustrate(lambda figure: figure.text(0.5, 0.5, "x"), alt, 1.0, 1.0)
    assert ET.fromstring(made.svg).attrib["aria-label"] == alt


def test_a_label_with_a_sign_that_no_svg_may_have_is_drawn():
    made = illustrate(lambda figure: figure.text(0.5, 0.5, "a\x01b"), "A label.")
    assert words(made) == ["a\ufffdb"] and check_sound(made) is None


def test_a_saved_file_has_its_own_colours(tmp_path):
    path = tmp_path / "curve.svg"
    illustrate(draw, "A curve.").save(path)
    text = path.read_text(encoding="utf-8")
    root = ET.parse(path).getroot()  # sound XML: no attribute twice
    assert root.tag == f"{SVG}svg" and root.attrib["aria-label"] == "A curve."
    assert "background:#ffffff" in root.attrib["style"]
    assert "max-width:100%" in root.attrib["style"]
    assert "currentColor" not in text and "#1a1a1a" in text


def test_the_suffix_decides_what_is_saved(tmp_path):
    made = illustrate(draw, "A curve.", 4.0, 2.0)
    for suffix in (".png", ".PDF", ".svg"):
        made.save(str(tmp_path / f"curve{suffix}"))
    with Image.open(tmp_path / "curve.png") as picture:
        assert picture.format == "PNG" and picture.size == (800, 400)
        assert picture.convert("RGB").getpixel((0, 0)) == (255, 255, 255)
        assert np.asarray(picture.convert("L")).min() < 100  # something is drawn
    (page,) = PdfReader(tmp_path / "curve.PDF").pages
    assert [float(x) for x in page.mediabox[2:]] == pytest.approx([4 * 72, 2 * 72])
    assert ET.parse(tmp_path / "curve.svg").getroot().tag == f"{SVG}svg"
    with pytest.raises(ValueError, match=re.escape("suffix of path must be one of '.svg'")):
        made.save(tmp_path / "curve.jpg")


def test_the_matplotlib_figure_is_within_reach(tmp_path):
    made = illustrate(draw, "A curve.", 4.0, 2.0)
    assert made.figure.get_size_inches() == pytest.approx([4, 2])
    (axis,) = made.figure.axes
    axis.set_title("Changed")
    made.figure.savefig(tmp_path / "mine.svg")
    assert "Changed" in (tmp_path / "mine.svg").read_text(encoding="utf-8")


@pytest.mark.parametrize("names", [["a", "b"], ["training", "test, after 20,000 epochs"] * 3])
def test_a_legend_above_lies_on_no_curve(names):
    """Within the figure, outside the axes."""

    def draw(figure):
        lines = [figure.subplots().plot([0, 1], [0, 1])[0]] * len(names)
        style.legend_above(figure, lines, names)

    figure = drawn(lambda: illustrate(draw, "Lines"))[1]
    legend = figure.legends[0].get_window_extent()
    assert legend.y0 >= figure.axes[0].get_window_extent().y1
    assert legend.x1 <= figure.bbox.x1


def test_a_label_names_a_quantity():
    for label in ("rad/s", "N m", "shoulder, N m", "elbow", "", " , N m"):
        with pytest.raises(ValueError, match=re.escape(repr(label))):
            style.check_label(label)
    for label in ("shoulder torque, N m", "RMSS", "speed, times the paper's"):
        assert style.check_label(label) == label
