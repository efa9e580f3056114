"""Figures of control engineering."""

import numpy as np
import pytest

from ddlib.control import loop_gain
from ddlib.figures import root_loci

GAINS = np.geomspace(1e-4, 5, 50)
LOOPS = {"P": loop_gain(4.0, 0.0, 100.0), "PD": loop_gain(4.0, 0.0, 100.0, 0.0, 24.0)}


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
