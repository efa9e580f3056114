"""Errors against costs: curves where the data are, names, refusals."""

import re

import numpy as np
import pytest

from workshop.beyond.figures.rivals import costs

CURVE = [100, 10, 1000], np.full((3, 4), 0.1), np.full((3, 4), 0.3)
LABELS = ("stored numbers", "RMSS")


def draw(panels=None, reference=("network", CURVE), floor=0.02, alt="Errors over numbers."):
    return costs(panels or {"tables": {"one": CURVE, "two": CURVE}}, reference, floor, LABELS, alt)


def test_every_rival_is_named_and_so_are_the_axes():
    svg = draw({"tables": {"one": CURVE}, "bases": {"two": CURVE}, "others": {"three": CURVE}}).svg
    for text in ("tables", "bases", "others", "one", "two", "three", "network", *LABELS):
        assert f">{text}<" in svg


def test_curves_go_through_medians_from_small_to_large():
    test = np.array([[0.2, 0.4, 0.3], [0.8, 0.9, 0.7], [0.1, 0.1, 0.4]])
    svg = draw({"tables": {"one": ([100, 10, 1000], test / 2, test)}}).svg
    lines = [
        np.array(re.findall(r"[ML] ([\d.]+) ([\d.]+)", d), float)
        for d in re.findall(r' d="([^"]+)"', svg)
    ]
    three = [line for line in lines if len(line) == 3 and (np.diff(line[:, 0]) > 0).all()]
    heights = [np.diff(line[:, 1]) for line in three]
    wanted = -np.diff(np.log10([0.8, 0.3, 0.1]))  # down on the page is down
    assert any(
        np.allclose(h * np.abs(wanted).sum(), wanted * np.abs(h).sum(), atol=0.01 * np.abs(h).sum())
        for h in heights
        if h.any()
    )


def test_what_makes_no_sense_is_refused():
    with pytest.raises(ValueError, match="panels must hold one family"):
        costs({}, ("network", CURVE), 0.02, LABELS, "x")
    with pytest.raises(ValueError, match="floor must lie in"):
        draw(floor=0.0)
    with pytest.raises(ValueError, match="cost of 'one' must be positive"):
        draw({"tables": {"one": ([0, 1, 2], *CURVE[1:])}})
    with pytest.raises(ValueError, match=r"errors of 'one' must have shape \(3, days\)"):
        draw({"tables": {"one": (CURVE[0], CURVE[1][:2], CURVE[2])}})
    with pytest.raises(ValueError, match="errors of 'network' must be positive"):
        draw(reference=("network", (CURVE[0], -CURVE[1], CURVE[2])))
    with pytest.raises(ValueError, match="alt"):
        draw(alt=" ")
