"""Somebody else's arm: its dynamics, its recordings, its parameters.

The arm and its motions are those of `book/data/characters.npz`; what is asserted of them was
computed by others.
"""

from pathlib import Path

import numpy as np
import pytest

from ddlib.control import pd
from ddlib.dynamics import Arm
from ddlib.effects import CoulombFriction, Effects, Noise, Quantisation, ViscousFriction
from ddlib.identification import (
    FRICTION,
    GRAVITY,
    RIGID,
    Equations,
    by_modulation,
    from_states,
    least_squares,
    repeat,
    true_parameters,
)
from ddlib.simulation import Recording, record
from ddlib.trajectories import APPENDIX_I, Trajectory

DATA = Path(__file__).parents[1] / "book" / "data"
BASE = dict(a=1.3727291666666667, b=0.5, d=0.5176145833333333)
ARM = Arm("characters", **BASE, lengths=(1.0, 1.0), gravity_moments=(2.625, 1.5))
LAW = pd((100.0, 40.0), (14.0, 5.0))
REAL = Effects(
    friction=(ViscousFriction((0.2, 0.1)), CoulombFriction((0.2, 0.1))),
    encoder=(Quantisation.encoder(16),),
    torque_sensor=(Noise((0.05, 0.02)),),
)
NAMES = (*RIGID, *GRAVITY, *FRICTION)
TRUTH = true_parameters(ARM, REAL, NAMES)
TRAINING = APPENDIX_I[:5]


@pytest.fixture(scope="module")
def characters():
    """The file's arrays, with the first angle counted from hanging down."""
    with np.load(DATA / "characters.npz") as file:
        content = dict(file)
    content["q"] = content["q"] + [np.pi / 2, 0.0]
    return content


def drawn(content) -> list[Recording]:
    """A recording for each character, as the file has it: torques at the samples."""
    recordings = []
    for end, samples in zip(np.cumsum(content["length"]), content["length"]):
        q, qd, qdd, tau = (content[name][end - samples : end] for name in ("q", "qd", "qdd", "tau"))
        t, reference = np.arange(samples) * 0.04, Trajectory(q, qd, qdd)
        recordings.append(Recording(t, reference, q, tau, q, qd, tau, control_step=0.0))
    return recordings


def joined(parts: list[Equations]) -> Equations:
    """One set of equations of many."""
    return Equations(
        parts[0].names,
        tuple(np.concatenate(part) for part in zip(*(p.regressor for p in parts))),
        tuple(np.concatenate(part) for part in zip(*(p.torque for p in parts))),
    )


def test_both_dynamics_agree_with_the_file(characters):
    q, qd, qdd, tau = (characters[name] for name in ("q", "qd", "qdd", "tau"))
    np.testing.assert_allclose(ARM.inverse_dynamics(q, qd, qdd), tau, atol=1e-13)
    np.testing.assert_allclose(ARM.forward_dynamics(q, qd, tau), qdd, atol=1e-12)
    terms = ARM.torque_terms(q, qd, qdd)
    parts = {
        "inertial": terms["inertial"] + terms["coupling"],
        "coriolis": terms["centrifugal"] + terms["coriolis"],
        "gravity": terms["gravity"],
    }
    for name, part in parts.items():
        np.testing.assert_allclose(part, characters[name], atol=1e-13)
    np.testing.assert_allclose(ARM.mass_matrix(q), characters["mass_matrix"], atol=1e-14)


def test_the_file_gives_the_parameters_of_its_arm(characters):
    states = (characters[name] for name in ("q", "qd", "qdd", "tau"))
    found = least_squares(from_states(*states, RIGID + GRAVITY))
    np.testing.assert_allclose(found.values, TRUTH[:5], rtol=1e-12)


def test_positions_and_torques_at_25_hz_give_the_parameters(characters):
    """The file's derivatives are smoother than its positions, by less than 1 % of a parameter.

    With a bump whose knots fall between samples (0.6 s are 15) they were wrong by 130 %.
    """
    for width in (0.48, 0.6):
        parts = [by_modulation(r, RIGID + GRAVITY, width) for r in drawn(characters)]
        found = least_squares(joined(parts))
        np.testing.assert_allclose(found.values, TRUTH[:5], rtol=0.01)


@pytest.mark.parametrize(
    "duration, log_step, control_step", [(2.5, 0.005, 0.001), (6.0, 0.02, 0.005)]
)
def test_any_duration_and_rate_gives_the_parameters(duration, log_step, control_step):
    options = dict(duration=duration, log_step=log_step, control_step=control_step)
    sharp = REAL.without("encoder", "torque_sensor")
    clean = record(ARM, LAW, TRAINING, effects=sharp, **options)
    found = least_squares(by_modulation(clean, NAMES))
    np.testing.assert_allclose(found.values[:5], TRUTH[:5], rtol=1e-3)
    many = repeat(ARM, LAW, TRAINING, REAL, repetitions=40, seed=1, **options)
    found = least_squares(by_modulation(many, NAMES))
    share = found.covers(TRUTH).mean(0)  # of intervals that hold the truth with 95 %
    assert share.mean() > 0.93 and share.min() > 0.8
