"""Figures of adaptive control: what they show, and what they refuse."""

import numpy as np
import pytest

from workshop.beyond.figures.adaptive import courses, stops_map


def test_courses_show_each_controller_once_and_the_change():
    errors = np.outer(np.arange(1, 5), np.linspace(1, 2, 6))
    found = courses(
        {"A": {"one": errors, "two": 2 * errors}, "B": {"one": errors, "two": errors}},
        2,
        "a load",
        "error, mm",
        "Errors of two.",
    )
    for text in ("one", "two", "a load", "error, mm", "motion, number"):
        assert text in found.svg
    assert found.svg.count(">one<") == 1 and found.alt == "Errors of two."


@pytest.mark.parametrize(
    "panels, change, message",
    [
        ({}, 1, "panels must hold"),
        ({"A": {"one": [[0.0, 1.0]]}}, 1, "must be positive"),
        ({"A": {"one": [1.0, 2.0]}}, 1, "must have shape"),
        ({"A": {"one": [[1.0, 2.0]]}}, 0, "change must be"),
    ],
)
def test_courses_refuse(panels, change, message):
    with pytest.raises(ValueError, match=message):
        courses(panels, change, "x", "error, mm", "alt")


def test_the_map_marks_what_was_stopped():
    errors = np.array([[1.0, np.inf, 3.0], [1.0, 2.0, 3.0]])
    stopped = ~np.isfinite(errors)
    labels = ("rate, multiples of 1", "delay, ms", "error, mm")
    some = stops_map([0.1, 1.0, 10.0], [0, 2], {"A": (errors, stopped)}, labels, "A map.")
    none = stops_map(
        [0.1, 1.0, 10.0], [0, 2], {"A": (errors[[1, 1]], 0 * stopped > 0)}, labels, "A map."
    )
    assert len(some.svg) > len(none.svg) and "delay, ms" in some.svg
    with pytest.raises(ValueError, match="panels must hold"):
        stops_map([1.0], [0], {}, labels, "x")
    with pytest.raises(ValueError, match="errors of 'A' must have shape"):
        stops_map([1.0], [0], {"A": (errors, stopped)}, labels, "x")
