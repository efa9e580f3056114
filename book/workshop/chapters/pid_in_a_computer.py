"""What the side path *PID in a computer* asks."""

from __future__ import annotations

import numpy as np

from ddlib.control import linear
from workshop.chapters.exercises import Exercise, OneOf, fitting, judging

_MOST, _LEAST_DEG = 10.0, 55.0  # N m of one count, phase margin


def _exercise(number: int, *given: float) -> Exercise:
    """An exercise, with what the page's cells give."""
    if number == 1:
        inertia, friction, period, late, spring, damper, count = given
        joint = linear.plant(inertia, friction)
        way = {"velocity": "difference"}

        def noise(smooth):
            return damper * count / (smooth + period)

        def angle(smooth):
            loop = linear.opened_loop(
                joint, spring, 0, damper, period, late, derivative_filter=smooth, **way
            )
            return linear.margins(loop).phase_deg

        tried = np.linspace(0, 0.04, 81)  # s
        slips = [
            (lambda smooth: smooth >= 1, "give it in seconds."),
            (lambda smooth: noise(smooth) > _MOST, "one count still costs more than that."),
            (lambda smooth: angle(smooth) <= _LEAST_DEG, "it takes too much of the margin."),
        ]
        return Exercise(
            "number",
            fitting(lambda smooth: noise(smooth) <= _MOST and angle(smooth) > _LEAST_DEG, tried),
            "it is slow enough for the motor and quick enough for the loop.",
            slips,
            unit="s",
            unless=[(lambda smooth: smooth < 0, "a time constant is above zero.")],
        )
    if number == 3:
        inertia, damper, smooth, period, late = given
        seeming = inertia - damper * (smooth + period + late * period)
        return Exercise(
            "number",
            seeming,
            "a late damper takes inertia away.",
            [
                (
                    2 * inertia - seeming,
                    "expand the late velocity. Which sign has its second term?",
                ),
                (
                    OneOf(
                        *(seeming + damper * x for x in (smooth, period / 2, period, late * period))
                    ),
                    "one of the four delays is missing, or two.",
                ),
                (inertia - seeming, "that is what the damper takes away."),
            ],
            "by how much is the damper's torque late, all in all?",
            tolerance=5e-3,
            unit="kg m²",
        )
    spring, most, weight = given
    step = np.rad2deg(most / (weight * spring))
    slips = [
        (weight * step, "that is without the weight."),
        (weight**2 * step, "does the weight make the torque larger?"),
        (np.deg2rad(step), "that is in radians."),
    ]
    return Exercise(
        "number",
        step,
        "the spring sees a part of the step, so the step may be larger.",
        slips,
        "which torque does the spring ask for?",
        unit="°",
    )


check = judging(_exercise)
