"""Figures of control engineering."""

import xml.etree.ElementTree as ET
from dataclasses import replace

import control
import numpy as np
import pytest
from pictures import words

from ddlib.control import loop_gain
from workshop.chapters.feedback import nyquist, root_loci
from workshop.chapters.feedforward import feedforward_loop

GAINS = np.geomspace(1e-4, 5, 50)
LOOPS = {"P": loop_gain(4.0, 0.0, 100.0), "PD": loop_gain(4.0, 0.0, 100.0, 0.0, 24.0)}

LOOPS_WITH_FRICTION = {
    "P": loop_gain(4.0, 1.0, 100.0),
    "PD": loop_gain(4.0, 1.0, 100.0, 0.0, 24.0),
}


def test_root_loci_name_the_poles():
    """Undamped: plus or minus 5i; with the damper: -3 plus or minus 4i."""
    figure = root_loci(LOOPS, GAINS)
    assert figure.alt == "Root loci. Poles at factor 1: P: 0 ± 5i; PD: −3 ± 4i."
    assert figure.svg.count("<svg ") == 1


@pytest.mark.parametrize(
    "arguments, name",
    [
        (({}, GAINS), "loops"),
        ((LOOPS, [0.0, 1.0]), "gains"),
        ((LOOPS, [1.0, 0.5]), "gains"),
        ((LOOPS, [1.0]), "gains"),
        ((LOOPS, [1.0, np.nan]), "gains"),
    ],
)
def test_bad_arguments_are_refused_by_name(arguments, name):
    with pytest.raises(ValueError, match=f"^{name} must"):
        root_loci(*arguments)


def test_nyquist_tells_the_largest_sensitivity():
    """Against python-control's stability margin, the smallest distance from -1."""
    figure = nyquist(LOOPS_WITH_FRICTION, np.geomspace(0.5, 50, 401))
    told = []
    for title, loop in LOOPS_WITH_FRICTION.items():
        _, _, nearest, _, _, at = control.stability_margins(loop)
        told.append(f"{title}: {1 / nearest:.3g} at {at:.2g} rad/s")
    assert figure.alt == f"Nyquist plots. Largest sensitivity: {'; '.join(told)}."
    assert figure.svg.count("<svg ") == 1


@pytest.mark.parametrize(
    "arguments, name",
    [
        (({}, [1.0, 2.0]), "loops"),
        ((LOOPS, [0.0, 1.0]), "frequencies"),
        ((LOOPS, [2.0, 1.0]), "frequencies"),
        ((LOOPS, [1.0]), "frequencies"),
        ((LOOPS, [1.0, np.nan]), "frequencies"),
    ],
)
def test_bad_frequencies_are_refused(arguments, name):
    with pytest.raises(ValueError, match=f"^{name} must"):
        nyquist(*arguments)


def test_the_block_diagram_stands_on_a_narrow_page():
    """From top to bottom, with the same blocks, signals and signs."""
    lying = feedforward_loop()
    standing = replace(lying, svg=lying.narrow)
    assert sorted(words(standing)) == sorted(words(lying)) and "inverse arm" in words(lying)
    across, down = (
        [float(x) for x in ET.fromstring(made.svg).attrib["viewBox"].split()[2:]]
        for made in (lying, standing)
    )
    assert across[0] > 2 * across[1] and down[1] > down[0]
