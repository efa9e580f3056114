"""Measures of filters, on planted ones with names known by hand."""

import numpy as np
import pytest

from workshop.report import committed
from workshop.report.measures import filters

pytestmark = pytest.mark.usefixtures("planted_members")

X = np.linspace(-1, 1, 21)
SHAPES = {"velocity": X, "acceleration": X**2 - (X**2).mean(), "noise": (-1.0) ** np.arange(21)}
"""A line, a parabola without its mean, and what no cubic fits."""


@pytest.fixture
def planted(monkeypatch):
    """Four networks of two filters; before training all is noise."""
    names = [("velocity", "noise"), ("noise", "noise"), ("acceleration", "velocity")]
    names.append(("acceleration", "noise"))
    trained = np.array([[SHAPES[name] for name in each] for each in names])
    before = np.broadcast_to(SHAPES["noise"], trained.shape)
    given = {"hidden": [trained, before], "direct": [before[:, :1], before[:, :1]]}
    monkeypatch.setattr(committed, "filters_of_layer", lambda width, layer, setup: given[layer])


def test_a_network_counts_if_one_filter_has_the_name(planted):
    for name, share in (("velocity", 0.5), ("acceleration", 0.5), ("jerk", 0.0)):
        assert filters.with_unit(21, name).value == share
    found = filters.with_unit(21, "velocity|acceleration")
    assert found.value == 0.75
    assert found.text == "3 of 4 networks, 4 of 8 filters; before training 0 networks"
    assert filters.with_unit(21, "velocity", layer="direct").value == 0


def test_filters_of_two_layers_are_counted_together(planted):
    assert filters.of_class(21, "velocity").value == 2 / 8
    assert filters.of_class(21, "velocity|acceleration", layer="hidden|direct").value == 4 / 12


@pytest.fixture
def of_windows(monkeypatch):
    """``of_windows({41: f, ...}, before)``: every filter of a window is `f`, on three networks."""

    def plant(shapes, before=SHAPES["noise"]):
        def layer(width, layer, setup):
            return [
                np.broadcast_to(f, (3, *np.atleast_2d(f).shape)) for f in (shapes[width], before)
            ]

        monkeypatch.setattr(committed, "filters_of_layer", layer)

    return plant


def test_roughness_by_hand(of_windows):
    """Second differences: 4 of ones of alternating sign, twice a step squared of a parabola."""
    rough, smooth = 16 / 6 / (1 - 1 / 21**2), (2 * 0.1**2) ** 2 / 6 / np.var(X**2)
    parabola, noise = SHAPES["acceleration"], SHAPES["noise"]
    of_windows({11: parabola, 21: parabola, 41: noise})
    assert filters.rougher(41, 21).value == pytest.approx(rough / smooth)
    assert filters.direct_smoothness().value == pytest.approx(rough)  # at the roughest window
    of_windows({41: noise + parabola})
    assert filters.changed_roughness(41).value == pytest.approx(smooth)


def test_shares_of_the_energy_by_hand(of_windows):
    """Of orthogonal polynomials with factors 0.6 and 0.8 one has 0.36 of the energy."""
    constant, line, _, cubic = np.linalg.qr(np.vander(X, 4, increasing=True))[0].T
    of_windows({11: line, 21: 0.6 * constant + 0.8 * line, 41: 0.6 * line + 0.8 * cubic})
    assert filters.explained().value == pytest.approx(0.36)
    assert filters.constant_share(width=21).value == pytest.approx(0.36)


def test_crossings_with_a_middle_off_the_centre(of_windows):
    """A parabola about a whole sample, one about the centre, and a line, which crosses once."""
    of_windows({21: np.stack([(X - 0.1) ** 2 - 0.3, X**2 - 0.3, X - 0.05])})
    assert filters.asymmetric(21).value == 0.5
