"""What a window reads as viscous friction, on torques of which every part was planted."""

import numpy as np
import pytest

from beyond.others import DATA, kr300
from beyond.studies import viscosity
from ddlib.learning import sliding_windows

STEP, AMPLITUDE, RATE = 0.01, 0.5, 2.9  # s, rad, rad/s: of the joint that is read


def read(viscous, dry, second):
    """The fourth joint, which swings by one sine or two."""
    t, joint = STEP * np.arange(4000)[:, None], np.arange(6)
    q = AMPLITUDE * np.sin((2 + 0.3 * joint) * t + joint)
    q += second * np.sin((3.1 + 0.4 * joint) * t)
    x = sliding_windows(q, viscosity._WIDTH)
    states = viscosity.Windowed(100, viscosity._WIDTH, x, np.zeros((len(x), 6))).states
    v, a = states[..., 1], states[..., 2]
    fold = x, states, 0.1 * a + viscous * v + dry * np.clip(v / 0.005, -1, 1) + 0.2
    return viscosity._joint(3, fold, fold)


def test_without_dry_friction_a_window_reads_the_viscous_one():
    found = read(viscous=0.7, dry=0.0, second=0.2)
    assert found["viscous"] == pytest.approx(0.7, rel=1e-3)
    for name in ("measured", "equations", "no dry", "three signs"):
        assert found["read"][name] == pytest.approx(1, abs=0.02)
    assert found["read"]["no viscous"] == pytest.approx(0, abs=0.02)
    assert found["errors"]["window"] < 1e-6


def test_dry_friction_is_read_as_viscous_until_signs_stand_beside():
    """Along one sine a filter can follow the sign's first harmonic, 4/pi of its height."""
    found, viscous = read(viscous=0.7, dry=0.4, second=0.0), 0.7
    first = 4 / np.pi * 0.4 / (AMPLITUDE * RATE) / viscous
    assert found["read"]["no viscous"] == pytest.approx(first, rel=0.05)
    assert found["read"]["measured"] == pytest.approx(1 + first, rel=0.05)
    assert found["read"]["no dry"] == pytest.approx(1, abs=0.02)
    assert found["read"]["three signs"] == pytest.approx(1, abs=0.1 * first)
    errors = found["errors"]
    assert errors["window and three signs"] < 0.2 * errors["window"]
    assert errors["three signs alone"] > errors["window and three signs"]


def test_motions_and_blocks_are_left_out_whole():
    arms = viscosity._arms()
    assert [len(folds) for folds in arms.values()] == [3, 5]
    for learnt, test in (fold for folds in arms.values() for fold in folds):
        rows = {row.tobytes() for row in learnt[0][:, 0]}
        assert not any(row.tobytes() in rows for row in test[0][:, 0])


def test_motions_are_those_of_the_file():
    with np.load(DATA / "kr300.npz") as file:
        position, torque = file["B_position_deg"], file["B_torque_nm"]
    motion = kr300()[1]
    assert motion.step == pytest.approx(0.01) and len(motion.q) == 1000
    assert np.rad2deg(motion.q[500]) == pytest.approx(position[1251], abs=0.05)
    assert motion.current.mean(0) == pytest.approx(torque.mean(0), abs=0.02)
