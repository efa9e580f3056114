"""The square of extents: which trajectories lie in the hull, and recordings of all."""

import numpy as np
import pytest

from ddlib.setups import STATE_FEEDBACK, inside_hull, square
from ddlib.trajectories import APPENDIX_I


def test_picker_knows_the_hull():
    assert inside_hull(APPENDIX_I[:5]).all()
    assert not inside_hull(APPENDIX_I[5])
    assert inside_hull(APPENDIX_I[:5].mean(0))
    assert not inside_hull([0.0, 0.0])


def test_the_square_is_recorded_on_a_grid_up_to_45_degrees():
    found = square(STATE_FEEDBACK, 3)
    np.testing.assert_allclose(found.extents_deg[:4], [[15, 15], [15, 30], [15, 45], [30, 15]])
    assert found.extents_deg[-1].tolist() == [45.0, 45.0] and found.inside[-1]
    assert found.inside.tolist() == [bool(inside_hull(each)) for each in found.extents_deg]
    alone = STATE_FEEDBACK.record(found.extents_deg[1])
    assert found.recording.q.shape == (9, *alone.q.shape)
    reach = np.abs(found.recording.reference.q).max(-2)
    np.testing.assert_allclose(reach, np.deg2rad(found.extents_deg), rtol=1e-3)
    with pytest.raises(ValueError, match="points"):
        square(STATE_FEEDBACK, 1)
