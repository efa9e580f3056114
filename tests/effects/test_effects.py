"""Sensors, delay, play and the collection of all effects: rounding, noise, memory, order."""

from dataclasses import FrozenInstanceError

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ddlib.effects import (
    CMU_DD_ARM_II_EFFECTS,
    IDEAL,
    Backlash,
    ComputingTime,
    CoulombFriction,
    Delay,
    Effects,
    FlexibleJoint,
    Noise,
    Quantisation,
    Ripple,
    Saturation,
    ViscousFriction,
    started,
)


def test_frictions_add_up():
    viscous, coulomb = ViscousFriction((1.0, 2.0)), CoulombFriction((3.0, 4.0))
    both = Effects(friction=(viscous, coulomb)).friction_torque(np.array([2.0, -1.0]))
    np.testing.assert_allclose(both, [1 * 2 + 3, -(2 * 1 + 4)])
    assert not IDEAL.friction_torque(np.array([2.0, -1.0])).any()


@settings(deadline=None, max_examples=100)
@given(x=st.floats(-100, 100), bits=st.integers(4, 24))
def test_quantisation_is_the_nearest_step(x, bits):
    encoder = Quantisation.encoder(bits)
    once = encoder.apply(x)
    assert abs(once - x) <= encoder.step / 2 * (1 + 1e-6)
    count = once / encoder.step
    assert abs(count - round(count)) < 1e-6
    assert encoder.apply(once) == once
    assert encoder.apply(-x) == -once


def test_encoder_steps():
    assert Quantisation.encoder(16).step == pytest.approx(9.587e-5, abs=1e-8)
    assert Quantisation.encoder(1).step == pytest.approx(np.pi)
    assert Quantisation.encoder(14).step == 4 * Quantisation.encoder(16).step
    # a turn is a whole number of steps
    assert Quantisation.encoder(16).apply(2 * np.pi) == pytest.approx(2 * np.pi, rel=1e-15)


def test_quantisation_error_is_uniform():
    """Standard deviation step / sqrt 12, no mean."""
    encoder = Quantisation(0.01)
    x = np.random.default_rng(0).uniform(-1, 1, 200_000)
    error = encoder.apply(x) - x
    assert error.std() == pytest.approx(0.01 / np.sqrt(12), rel=0.01)
    assert abs(error.mean()) < 4 * error.std() / np.sqrt(x.size)


def test_noise_has_the_stated_size_per_joint():
    std = np.array([0.3, 0.02])
    n = 100_000
    noise = Noise(tuple(std)).apply(np.full((n, 2), 5.0), np.random.default_rng(1)) - 5.0
    np.testing.assert_allclose(noise.std(0), std, rtol=4 / np.sqrt(2 * n))
    assert (np.abs(noise.mean(0)) < 4 * std / np.sqrt(n)).all()
    correlation = np.corrcoef(noise.T)[0, 1], np.corrcoef(noise[1:, 0], noise[:-1, 0])[0, 1]
    assert np.abs(correlation).max() < 4 / np.sqrt(n)  # white, and joints independent
    assert np.mean(np.abs(noise[:, 0]) < std[0]) == pytest.approx(0.6827, abs=0.006)


def test_noise_is_seeded():
    noise, x = Noise((1.0, 1.0)), np.zeros((10, 2))
    first = noise.apply(x, np.random.default_rng(7))
    np.testing.assert_array_equal(first, noise.apply(x, np.random.default_rng(7)))
    assert not np.array_equal(first, noise.apply(x, np.random.default_rng(8)))
    assert not x.any()
    np.testing.assert_array_equal(Noise((0.0, 0.0)).apply(x + 3, np.random.default_rng(7)), x + 3)


def test_a_path_keeps_the_order():
    x, rng = np.array([0.149, 7.0]), np.random.default_rng(0)
    clip, coarse = Saturation((0.12, 0.12)), Quantisation(0.1)
    np.testing.assert_allclose(started((clip, coarse), 0 * x)(x, rng), [0.1, 0.1])
    np.testing.assert_allclose(started((coarse, clip), 0 * x)(x, rng), [0.1, 0.12])
    assert started((), 0 * x)(x, rng) is x


@settings(deadline=None, max_examples=50)
@given(periods=st.integers(0, 12), samples=st.integers(1, 30))
def test_delay_shifts_exactly(periods, samples):
    x = np.random.default_rng(samples).normal(size=(samples, 2))
    initial = np.array([5.0, -5.0])
    late = Delay(periods).start(initial)
    y = np.array([late(sample) for sample in x])
    np.testing.assert_array_equal(y, np.array([initial] * periods + list(x))[:samples])


def test_a_path_with_a_memory_starts_afresh_every_time():
    effects = (Delay(2), Backlash((0.2, 0.2)))
    x = np.random.default_rng(0).normal(size=(20, 3, 2))
    first, second = (started(effects, x[0]) for _ in range(2))
    early = [first(sample, None) for sample in x]
    np.testing.assert_array_equal(early, [second(sample, None) for sample in x])


# --- backlash: the play operator --------------------------------------------------------


def play(x, gap, initial=None):
    """The operator along a scalar history."""
    x = np.asarray(x, dtype=float)
    path = Backlash((gap, gap)).start(np.full(2, x[0] if initial is None else initial))
    return np.array([path(np.full(2, sample))[0] for sample in x])


HISTORY = st.lists(st.floats(-5, 5), min_size=2, max_size=12)
GAP = st.floats(0, 3)


@settings(deadline=None)
@given(x=HISTORY, gap=GAP)
def test_play_stays_within_half_the_gap(x, gap):
    assert np.abs(play(x, gap) - x).max() <= gap / 2 * (1 + 1e-12) + 1e-15


@settings(deadline=None, max_examples=50)
@given(x=HISTORY, gap=GAP, between=st.lists(st.integers(1, 6), min_size=11, max_size=11))
def test_play_does_not_depend_on_speed(x, gap, between):
    """Samples on the way from one point to the next change nothing: only turning points do."""
    slow, kept = [x[0]], [0]
    for start, end, n in zip(x, x[1:], between):
        slow += [start + (end - start) * k / n for k in range(1, n)] + [end]
        kept.append(len(slow) - 1)
    np.testing.assert_allclose(play(slow, gap)[kept], play(x, gap), atol=1e-12)


@settings(deadline=None)
@given(amplitude=st.floats(0.5, 10), gap=st.floats(0, 1))
def test_area_of_the_hysteresis_loop(amplitude, gap):
    """A parallelogram: the gap times the span of the reading, ``gap (2 amplitude - gap)``."""
    corners = np.array([amplitude, amplitude - gap, -amplitude, gap - amplitude])
    x = np.concatenate([[0.0], corners, corners])  # once to get into the loop, then around it
    loop_x, loop_y = corners, play(x, gap)[5:]
    area = 0.5 * abs(np.sum(loop_x * np.roll(loop_y, -1) - np.roll(loop_x, -1) * loop_y))
    assert area == pytest.approx(gap * (2 * amplitude - gap), rel=1e-9, abs=1e-9)
    assert np.abs(loop_y).max() == pytest.approx(amplitude - gap / 2)


@settings(deadline=None)
@given(x=HISTORY, y=HISTORY, gap=GAP)
def test_play_never_spreads_histories_apart(x, y, gap):
    """Two histories end up no further apart than they were at their furthest."""
    n = min(len(x), len(y))
    x, y = np.array(x[:n]), np.array(y[:n])
    assert np.abs(play(x, gap) - play(y, gap)).max() <= np.abs(x - y).max() + 1e-12


def test_play_by_hand_per_joint_and_without_gap():
    x = np.array([0.0, 0.4, 1.0, 0.6, 0.2, -0.5, 0.0, 0.4])
    np.testing.assert_allclose(play(x, 1.0), [0, 0, 0.5, 0.5, 0.5, 0.0, 0.0, 0.0])
    np.testing.assert_array_equal(play(x, 0.0), x)
    path = Backlash(([[1.0, 0.0]], [[0.0, 1.0]])).start(np.zeros(2))
    np.testing.assert_allclose(path(np.array([0.7, 0.7])), [[[0.2, 0.7]], [[0.7, 0.2]]])


# --- the collection -----------------------------------------------------------------------

SHAFT = FlexibleJoint((2e4, 6e3), (0.4, 0.15))
FULL = Effects(
    friction=(ViscousFriction((0.5, 0.15)),),
    actuator=(Saturation((100.0, 30.0)),),
    encoder=(Quantisation.encoder(16),),
    torque_sensor=(Noise((0.1, 0.1)),),
    motor=(Ripple((0.1, 0.1)),),
    transmission=(SHAFT,),
)
PARTS = ("friction", "actuator", "encoder", "torque_sensor", "motor", "transmission")


@pytest.mark.parametrize("part", PARTS)
def test_without_switches_off_one_part_and_leaves_the_rest(part):
    less = FULL.without(part)
    assert getattr(less, part) == () and getattr(FULL, part) != ()
    for other in set(PARTS) - {part}:
        assert getattr(less, other) == getattr(FULL, other)


def test_without_all_is_ideal_and_without_nothing_is_a_copy():
    assert FULL.without(*PARTS) == IDEAL == Effects()
    assert FULL.without() == FULL


@pytest.mark.parametrize("name", ["frictions", "", "gears", None])
def test_without_refuses_unknown_parts(name):
    with pytest.raises(ValueError, match="torque_sensor"):
        FULL.without("friction", name)


@pytest.mark.parametrize(
    "make",
    [
        lambda: Quantisation(0.0),
        lambda: Quantisation(np.nan),
        lambda: Quantisation.encoder(0),
        lambda: Quantisation.encoder(64),
        lambda: Noise((-1.0, 1.0)),
        lambda: Noise((1.0, np.inf)),
        lambda: Delay(-1),
        lambda: Backlash((0.1, -0.1)),
        lambda: Backlash((0.1, np.nan)),
        lambda: Effects(transmission=(SHAFT, SHAFT)),
    ],
)
def test_bad_values_are_refused_when_the_effect_is_made(make):
    with pytest.raises(ValueError, match=r"^(step|bits|std|periods|gap|transmission) must"):
        make()


@pytest.mark.parametrize(
    "make, name",
    [
        (lambda: Quantisation.encoder(16.0), "bits"),
        (lambda: Effects(friction=ViscousFriction((1, 1))), "friction"),
        (lambda: Effects(friction=("much",)), "friction"),
        (lambda: Effects(encoder=(ViscousFriction((1, 1)),)), "encoder"),
        (lambda: Effects(friction=(Saturation((1, 1)),)), "friction"),
        (lambda: Effects(torque_sensor=[Noise((1, 1))]), "torque_sensor"),
        (lambda: Effects(encoder=(ComputingTime(0.001),)), "encoder"),
        (lambda: Effects(friction=(SHAFT,)), "friction"),
        (lambda: Effects(motor=(ViscousFriction((1, 1)),)), "motor"),
        (lambda: Effects(actuator=(Ripple(),)), "actuator"),
        (lambda: Effects(transmission=(Backlash((0.1, 0.1)),)), "transmission"),
        (lambda: Delay(1.0), "periods"),
    ],
)
def test_wrong_kinds_are_refused_by_name(make, name):
    with pytest.raises(TypeError, match=name):
        make()


def test_surrogate_effects_by_numbers():
    effects = CMU_DD_ARM_II_EFFECTS
    # viscous plus Coulomb at 1 rad/s, one joint each way
    np.testing.assert_allclose(effects.friction_torque(np.array([1.0, -1.0])), [1.0, -0.3])
    np.testing.assert_allclose(effects.friction_torque(np.array([2.0, -2.0])), [1.5, -0.45])
    rng = np.random.default_rng(0)
    torque = started(effects.actuator, np.zeros(2))(np.array([500.0, -500.0]), rng)
    assert torque.tolist() == [100.0, -30.0]
    reading = started(effects.encoder, np.zeros(2))(np.array([1.0, -1.0]), rng)
    np.testing.assert_allclose(reading * 65536 / (2 * np.pi), [10430, -10430], rtol=1e-12)


def test_effects_cannot_be_changed():
    for effect, name in (
        (FULL, "friction"),
        (FULL.friction[0], "coefficient"),
        (FULL.actuator[0], "limit"),
        (FULL.encoder[0], "step"),
        (FULL.torque_sensor[0], "std"),
    ):
        with pytest.raises(FrozenInstanceError):
            setattr(effect, name, ())
