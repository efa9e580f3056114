"""Root loci: the same poles as python-control finds, each on a way without jumps."""

import control
import numpy as np
import pytest

from ddlib.figures.loops import _paths

S = control.tf("s")
GAINS = np.geomspace(1e-3, 4, 3000)


@pytest.mark.parametrize("law", [750, 332 + 46 * S, 332 + 46 * S + 3000 / S])
def test_paths_are_those_of_python_control(law):
    loop = law / (3.6 * S**2 + 5.3 * S)
    ours, theirs = _paths(loop, GAINS), control.root_locus_map(loop, gains=GAINS).loci
    np.testing.assert_allclose(np.sort_complex(ours), np.sort_complex(theirs), rtol=1e-9)
    steps = [np.abs(np.diff(paths, axis=0)).sum() for paths in (ours, theirs)]
    assert steps[0] == pytest.approx(steps[1], rel=1e-6)
