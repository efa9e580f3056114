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
    monkeypatch.setattr(committed, "_filters", lambda width, layer, setup: given[layer])


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
