"""A safety stop: which runs are stopped, when, why, and what the others notice of it."""

import numpy as np
import pytest

from beyond.control.adaptive import Watched
from beyond.control.guarded import REASONS, _Guarded
from ddlib.control import pd
from ddlib.dynamics import CMU_DD_ARM_II as ARM
from ddlib.simulation import record

STABLE, WILD = (300.0, 90.0), (8e5, 2e5)
DAMPING = (35.0, 10.0)


def driven(kp, extents, **limits):
    watched = Watched(_Guarded(pd(kp, DAMPING), **limits))
    return record(ARM, watched, extents, rest=0.1), watched.law.stops


def test_a_run_within_its_limits_is_what_it_is_without_a_guard():
    log, stops = driven(STABLE, [30, 20])
    plain = record(ARM, pd(STABLE, DAMPING), [30, 20], rest=0.1)
    np.testing.assert_array_equal(log.q_true, plain.q_true)
    np.testing.assert_array_equal(log.tau_true, plain.tau_true)
    assert not stops.stopped.any() and stops.running(log.t).all()


def test_a_wild_run_is_stopped_and_its_neighbour_goes_on():
    gains = np.array([STABLE, WILD])
    with pytest.raises(ValueError, match="diverges"):
        record(ARM, pd(gains, DAMPING), [[30, 20]] * 2, rest=0.1)
    log, stops = driven(gains, [[30, 20]] * 2)
    assert stops.stopped.tolist() == [False, True]
    assert "speed" in REASONS[stops.reason[1]] or "angle" in REASONS[stops.reason[1]]
    alone, _ = driven(STABLE, [30, 20])
    np.testing.assert_allclose(log.q_true[0], alone.q_true, atol=1e-12)
    off = ~stops.running(log.t)[1]
    assert off.any() and not off[0]
    assert (log.tau_true[1][off] == 0).all()


def test_the_first_limit_that_is_passed_is_the_reason_with_its_time():
    log, stops = driven(STABLE, [40, 20], angles=(0.5, 2.0))
    assert REASONS[int(stops.reason)] == "shoulder angle"
    late = np.abs(log.q_true[:, 0]) > 0.5
    assert stops.time == pytest.approx(log.t[late][0] - log.t[0], abs=0.011)
    assert not stops.running(log.t)[late].any()
    assert stops.running(log.t)[: late.argmax() - 1].all()
