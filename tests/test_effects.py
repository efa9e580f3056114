"""Friction, actuator and sensors: symmetry, dissipation, rounding and seeded noise."""

from dataclasses import FrozenInstanceError

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ddlib.effects import (
    CMU_DD_ARM_II_EFFECTS,
    IDEAL,
    CoulombFriction,
    Effects,
    Noise,
    Quantisation,
    Saturation,
    ViscousFriction,
    pass_through,
)

FRICTIONS = (
    ViscousFriction((0.5, 0.15)),
    CoulombFriction((0.5, 0.15)),
    CoulombFriction((8.45, 2.35), smoothing=0.02),
    Effects(friction=(ViscousFriction((5.3, 1.1)), CoulombFriction((8.45, 2.35)))),
)


def torque_of(friction):
    return friction.friction_torque if isinstance(friction, Effects) else friction.torque


@pytest.mark.parametrize("friction", FRICTIONS, ids=repr)
@settings(deadline=None, max_examples=50)
@given(qd=st.tuples(st.floats(-50, 50), st.floats(-50, 50)))
def test_friction_is_odd_and_never_adds_energy(friction, qd):
    qd, torque = np.array(qd), torque_of(friction)
    np.testing.assert_array_equal(torque(-qd), -torque(qd))
    assert (qd * torque(qd) >= 0).all()
    assert (torque(qd)[np.abs(qd) > 1e-9] != 0).all()


@pytest.mark.parametrize("friction", FRICTIONS, ids=repr)
def test_friction_grows_with_speed_and_is_nothing_at_rest(friction):
    qd = np.linspace(-3, 3, 2001)[:, None] * np.ones(2)
    assert (np.diff(torque_of(friction)(qd), axis=0) >= 0).all()
    assert not torque_of(friction)(np.zeros(2)).any()


def test_viscous_friction_by_numbers():
    np.testing.assert_allclose(ViscousFriction((5.3, 1.1)).torque([2.0, -3.0]), [10.6, -3.3])


def test_coulomb_friction_is_its_level_once_the_joint_moves():
    friction = CoulombFriction((8.45, 2.35))
    np.testing.assert_allclose(friction.torque(np.array([0.5, -0.5])), [8.45, -2.35], rtol=1e-12)
    # within the smoothing it is a steep viscous friction of slope level / smoothing
    slope = friction.torque(np.array([1e-7, 1e-7])) / 1e-7
    np.testing.assert_allclose(slope, np.array([8.45, 2.35]) / 2e-3, rtol=1e-6)
    # at one smoothing width, tanh(1) of it
    wide = CoulombFriction((1.0, 1.0), smoothing=0.1)
    np.testing.assert_allclose(wide.torque(np.array([0.1, 0.2])), [0.761594, 0.964028], atol=1e-6)


def test_frictions_add_up():
    viscous, coulomb = ViscousFriction((1.0, 2.0)), CoulombFriction((3.0, 4.0))
    both = Effects(friction=(viscous, coulomb)).friction_torque(np.array([2.0, -1.0]))
    np.testing.assert_allclose(both, [1 * 2 + 3, -(2 * 1 + 4)])
    assert not IDEAL.friction_torque(np.array([2.0, -1.0])).any()


def test_friction_of_many_runs_at_once():
    strength = np.array([[0.0, 0.0], [0.5, 0.15], [2.0, 0.6]])
    qd = np.array([1.0, -1.0])
    np.testing.assert_allclose(ViscousFriction(strength).torque(qd), strength * qd)
    np.testing.assert_allclose(CoulombFriction(strength).torque(qd), strength * qd)


@settings(deadline=None, max_examples=100)
@given(x=st.lists(st.floats(-1e6, 1e6), min_size=2, max_size=2))
def test_saturation_clips_and_clips_only_once(x):
    saturation, x = Saturation((100.0, 30.0)), np.array(x)
    once = saturation.apply(x)
    assert (np.abs(once) <= [100.0, 30.0]).all()
    np.testing.assert_array_equal(saturation.apply(once), once)
    inside = np.abs(x) <= [100.0, 30.0]
    np.testing.assert_array_equal(once[inside], x[inside])
    np.testing.assert_array_equal(np.sign(once), np.sign(x))
    np.testing.assert_array_equal(np.abs(once)[~inside], np.array([100.0, 30.0])[~inside])


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


def test_pass_through_keeps_the_order():
    x, rng = np.array([0.149, 7.0]), np.random.default_rng(0)
    clip, coarse = Saturation((0.12, 0.12)), Quantisation(0.1)
    np.testing.assert_allclose(pass_through((clip, coarse), x, rng), [0.1, 0.1])
    np.testing.assert_allclose(pass_through((coarse, clip), x, rng), [0.1, 0.12])
    assert pass_through((), x, rng) is x


FULL = Effects(
    friction=(ViscousFriction((0.5, 0.15)),),
    actuator=(Saturation((100.0, 30.0)),),
    encoder=(Quantisation.encoder(16),),
    torque_sensor=(Noise((0.1, 0.1)),),
)
PARTS = ("friction", "actuator", "encoder", "torque_sensor")


@pytest.mark.parametrize("part", PARTS)
def test_without_switches_off_one_part_and_leaves_the_rest(part):
    less = FULL.without(part)
    assert getattr(less, part) == () and getattr(FULL, part) != ()
    for other in set(PARTS) - {part}:
        assert getattr(less, other) == getattr(FULL, other)


def test_without_all_is_ideal_and_without_nothing_is_a_copy():
    assert FULL.without(*PARTS) == IDEAL == Effects()
    assert FULL.without() == FULL


@pytest.mark.parametrize("name", ["frictions", "", "motor", None])
def test_without_refuses_unknown_parts(name):
    with pytest.raises(ValueError, match="torque_sensor"):
        FULL.without("friction", name)


@pytest.mark.parametrize(
    "make",
    [
        lambda: ViscousFriction((-0.1, 0.1)),
        lambda: ViscousFriction((0.1,)),
        lambda: ViscousFriction((np.nan, 0.1)),
        lambda: CoulombFriction((0.1, -0.1)),
        lambda: CoulombFriction((0.1, 0.1), smoothing=0.0),
        lambda: CoulombFriction((0.1, 0.1), smoothing=-1.0),
        lambda: Saturation((0.0, 30.0)),
        lambda: Saturation((100.0, -30.0)),
        lambda: Saturation((100.0, np.inf)),
        lambda: Quantisation(0.0),
        lambda: Quantisation(np.nan),
        lambda: Quantisation.encoder(0),
        lambda: Quantisation.encoder(64),
        lambda: Noise((-1.0, 1.0)),
        lambda: Noise((1.0, np.inf)),
    ],
)
def test_bad_values_are_refused_when_the_effect_is_made(make):
    with pytest.raises(ValueError, match=r"coefficient|level|smoothing|limit|step|bits|std"):
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
    torque = pass_through(effects.actuator, np.array([500.0, -500.0]), rng)
    assert torque.tolist() == [100.0, -30.0]
    reading = pass_through(effects.encoder, np.array([1.0, -1.0]), rng)
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
