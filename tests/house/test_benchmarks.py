"""The benchmarks: python-control is asked for our loop, goals, and a failure writes nothing."""

from __future__ import annotations

import json
import sys

import numpy as np
import pytest
from book_pages import ROOT

from ddlib.setups import STATE_FEEDBACK

sys.path.insert(0, str(ROOT / "benchmarks"))
import measure
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


@pytest.mark.parametrize(
    "committed, now, reached",
    [
        (None, 2.1, True),
        (None, 1.9, False),
        (60.0, 41.0, True),
        (60.0, 39.0, False),
        (2.4, 1.9, False),
    ],
)
def test_a_goal_is_to_be_ahead_and_to_stay_so(committed, now, reached, tmp_path, monkeypatch):
    """Twice as fast as the peer, and no third slower than what is committed."""
    monkeypatch.setattr(measure, "COMMITTED", tmp_path / "benchmarks.json")

    def row(ratio, **options):
        return measure.ratio("g", "w", ("ours", 1.0), ("peer", ratio), **options)

    if committed:
        rows = [measure.quantity("g", "w", 99.0, "s"), row(committed, judged=False)]
        measure.COMMITTED.write_text(json.dumps({"rows": rows}))
    assert measure.met(row(now)) is reached
    assert measure.met(row(now, judged=False)) is None
