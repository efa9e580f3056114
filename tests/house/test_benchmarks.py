"""The benchmarks: python-control is asked for our loop, goals, and a failure writes nothing."""

from __future__ import annotations

import sys

import numpy as np
import pytest
from book_pages import ROOT

from ddlib.setups import STATE_FEEDBACK

sys.path.insert(0, str(ROOT / "benchmarks"))
import recordings


@pytest.mark.parametrize("written", [recordings.Written, recordings.Textbook])
@pytest.mark.parametrize("quantised", [True, False])
def test_python_control_repeats_our_loop(quantised, written):
    t, u, start = recordings.commands()
    loop = recordings.sampled_system(written())
    theirs = recordings.respond(loop, t, u, start, params={"quantised": quantised})
    off = ("torque_sensor",) if quantised else ("torque_sensor", "encoder")
    ours = recordings.ours(1, STATE_FEEDBACK.effects.without(*off), log_step=0.002)
    np.testing.assert_allclose(theirs, ours.q_true[0], atol=1e-12)
