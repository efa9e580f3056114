"""95 % intervals hold the truth as often as they say, or there is none: a thousand motions each."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from ddlib.control import pd, proportional
from ddlib.dynamics import CMU_DD_ARM_II, Arm, Link
from ddlib.effects import (
    CMU_DD_ARM_II_EFFECTS,
    CoulombFriction,
    Effects,
    Noise,
    Quantisation,
    ViscousFriction,
)
from ddlib.identification import (
    FRICTION,
    GRAVITY,
    RIGID,
    by_modulation,
    least_squares,
    repeat,
    true_parameters,
)
from ddlib.setups import JOINT_DAMPING
from ddlib.simulation import follow
from ddlib.trajectories import APPENDIX_I, Trajectory, random_extents

MOTIONS, REPETITIONS = 1000, 200
LOWEST = 0.95 - 3 * np.sqrt(0.95 * 0.05 / REPETITIONS)  # three deviations of a binomial: .904
LOOP = pd((300.0, 90.0), (35.0, 10.0))
FINE = replace(
    CMU_DD_ARM_II_EFFECTS,
    encoder=(Quantisation.encoder(20),),
    torque_sensor=(Noise((0.02, 0.01)),),
)
COARSE = replace(CMU_DD_ARM_II_EFFECTS, encoder=(Quantisation.encoder(11),))
JITTER = replace(CMU_DD_ARM_II_EFFECTS, encoder=(Noise((1e-3, 1e-3)),))
VERTICAL = replace(CMU_DD_ARM_II, gravity_moments=(20.0, 5.0))
# A reader's arm, as *Use it on your arm* begins: no joint is damped by its controller
OWN = Arm.from_links("own", Link(4.0, 0.35, 0.16, 0.050), Link(2.5, 0.30, 0.14, 0.025))
OWN_EFFECTS = Effects(
    friction=(ViscousFriction((0.4, 0.2)), CoulombFriction((0.1, 0.03))),
    encoder=(Quantisation.encoder(16),),
)
# As small as an industrial robot of 100 kg; at a reversal its dry friction exceeds what moves it
GEARED = Arm.from_links("geared", Link(10.0, 0.36, 0.16, 0.13), Link(5.0, 0.38, 0.15, 0.07), 9.81)
GEARED_EFFECTS = Effects(
    friction=(ViscousFriction((4.0, 2.0)), CoulombFriction((4.0, 2.0))),
    encoder=(Quantisation.encoder(14),),
    torque_sensor=(Noise((0.03, 0.015)),),
)
MOVES = random_extents(5, seed=1)
KINDS = {
    "joint damping": (
        JOINT_DAMPING.arm,
        JOINT_DAMPING.controller,
        APPENDIX_I[:5],
        JOINT_DAMPING.effects,
    ),
    "own": (OWN, proportional((60.0, 20.0)), MOVES, OWN_EFFECTS),
    "hanging, geared": (GEARED, proportional((600.0, 200.0)), MOVES, GEARED_EFFECTS),
    "quiet": (CMU_DD_ARM_II, LOOP, APPENDIX_I[:5], FINE),
    "as reported": (CMU_DD_ARM_II, LOOP, APPENDIX_I[:5], CMU_DD_ARM_II_EFFECTS),
    "noisy, coarse encoder": (CMU_DD_ARM_II, LOOP, APPENDIX_I[:5], COARSE),
    "noisy, white": (CMU_DD_ARM_II, LOOP, APPENDIX_I[:5], JITTER),
    "vertical": (VERTICAL, LOOP, APPENDIX_I[:5], CMU_DD_ARM_II_EFFECTS),
    "ringing": (CMU_DD_ARM_II, proportional((300.0, 90.0)), APPENDIX_I[:5], CMU_DD_ARM_II_EFFECTS),
    "poorly excited": (CMU_DD_ARM_II, LOOP, [(14.0, 9.0)], CMU_DD_ARM_II_EFFECTS),
    "elbow at rest": (CMU_DD_ARM_II, LOOP, [(40.0, 0.0)], CMU_DD_ARM_II_EFFECTS),
}


@cache
def recorded(kind):
    arm, _, extents, effects = plant = KINDS[kind]
    names = RIGID + (GRAVITY if np.any(arm.gravity_moments) else ()) + FRICTION
    many = repeat(*plant, MOTIONS // len(extents), seed=11, spread=0.01)
    return many, names, true_parameters(arm, effects, names)


def shares(kind):
    """For each parameter the share of intervals that hold the truth among those given."""
    many, names, truth = recorded(kind)
    found = least_squares(by_modulation(many, names))
    given = np.isfinite(found.half_width())
    held = (found.covers(truth) & given).sum(0) / np.maximum(given.sum(0), 1)
    sums = []
    for one in found.combinations:
        given_one = np.isfinite(one.half_width)
        held_one = (np.abs(one.value - one.factors @ truth) <= one.half_width)[given_one]
        sums.append((str(one), held_one.mean() if given_one.mean() > 0.02 else 1.0))
    return given.mean(0), held, sums, found


@pytest.mark.parametrize("kind", KINDS)
def test_intervals_hold_the_truth_or_are_not_given(kind):
    given, held, sums, _ = shares(kind)
    assert (held[given > 0.02] >= LOWEST).all(), (given, held)
    assert all(share >= LOWEST for _, share in sums), sums


@pytest.mark.parametrize("kind", ("joint damping", "own", "as reported", "hanging, geared"))
def test_intervals_are_no_wider_than_they_need_be(kind):
    """A stated error of friction was two and three times the error where readings are coarse."""
    _, names, truth = recorded(kind)
    *_, found = shares(kind)
    stated = found.errors.mean(0) / (found.values - truth).std(0)
    assert 0.8 < stated.min() and stated.max() < 1.4, dict(zip(names, stated))


def swung(step):
    """The arm swings by three sines a joint, 6 s long; each torque is held for a step."""
    t, size = step * np.arange(round(6 / step)), 0.7 / np.sqrt(3)
    speed = 2 * np.pi * np.array([[0.4, 0.7, 1.1], [0.5, 0.8, 1.3]])
    angle = speed * t[:, None, None] + np.array([[0.0, 1.0, 2.0], [1.0, 2.0, 3.0]])
    waves = np.sin(angle), speed * np.cos(angle), -(speed**2) * np.sin(angle)
    reference = Trajectory(*(np.tile(size * x.sum(-1), (REPETITIONS, 1, 1, 1)) for x in waves))
    effects = replace(FINE, torque_sensor=(Noise((0.1, 0.05)),))
    seeds, start = (
        np.arange(REPETITIONS)[:, None],
        (reference.q[..., 0, :], reference.qd[..., 0, :]),
    )
    run = follow(
        CMU_DD_ARM_II, pd((120.0, 40.0), (20.0, 6.0)), reference, t, effects=effects,
        seed=seeds, log_every=1, start=start,
    )  # fmt: skip
    return replace(run, reference=Trajectory(*(x[0] for x in run.reference))), effects


@pytest.mark.parametrize("step", (0.02, 0.005))
def test_a_torque_that_is_held_for_long_moves_no_interval(step):
    """A bump's value in the middle of the hold would move `a` by .09 % at 20 ms, and miss it."""
    run, effects = swung(step)
    truth = true_parameters(CMU_DD_ARM_II, effects, RIGID + FRICTION)
    found = least_squares(by_modulation(run, RIGID + FRICTION))
    assert np.isfinite(found.half_width()).all()
    held = found.covers(truth).mean(0)
    assert (held >= LOWEST).all(), (step, held)


def told(recording, names, count=20):
    """In how many of the first repetitions an estimate says that what is left is no noise."""
    few = recording.mapped(lambda x: x[:count] if x.ndim == 4 else x)
    equations = by_modulation(few, names)
    parts = (
        equations._replace(
            regressor=tuple(a[k] for a in equations.regressor),
            torque=tuple(y[k] for y in equations.torque),
        )
        for k in range(count)
    )
    return sum("is no noise" in str(least_squares(part)) for part in parts)


def test_an_estimate_tells_where_its_equations_leave_more_than_noise():
    names = RIGID + FRICTION
    for kind in ("quiet", "as reported", "vertical", "ringing", "joint damping"):
        many, all_names, _ = recorded(kind)
        assert told(many, all_names) == 0, kind
    assert told(recorded("vertical")[0], names) == 20, "without gravity"
    run, _ = swung(0.01)
    assert told(run, names) == 0
    late = replace(run, tau=np.roll(run.tau, 2, axis=-2))
    assert told(late, names) == 20, "a torque that is logged late"
