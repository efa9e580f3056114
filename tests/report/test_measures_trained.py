"""Measures that train, record or count: their calls planted, their arithmetic by hand."""

import re
from math import erf, log2
from types import SimpleNamespace

import numpy as np
import pytest

from ddlib.setups import POSITION_FEEDBACK
from ddlib.trajectories import pick_and_place
from workshop.report.measures import backpropagation, dynamics, networks, trajectories

SPEED = np.pi / 3 * np.deg2rad(45)  # of a sine that lasts six seconds, at its zero


# --- training ----------------------------------------------------------------------------------


def test_best_possible_answers_to_noisy_parity():
    """A bit is read rightly with the chance p of staying below half a step; parity then has
    (1 + (2p - 1)^3) / 2.
    """
    found = backpropagation.fine_distinctions()
    p = 0.5 * (1 + erf(0.5 / 0.25 / np.sqrt(2)))
    best = float(found.text.split("at best ")[1].split(" %")[0])
    assert best == pytest.approx(50 * (1 + (2 * p - 1) ** 3), abs=1.5)
    assert 0.5 < found.value <= 1.001  # chance, and as good as can be


def test_parity_takes_every_product_of_bits_and_one_of_signs():
    """As +1 or -1 it is the product of all 1 - 2 x: of bits all 2^n products, of signs one."""
    found = backpropagation.polynomial("bits", 8)
    assert found.value == pytest.approx(1.0)
    assert found.text == "4 at 2 bits, 256 at 8"
    assert backpropagation.polynomial("signs", 8).value == pytest.approx(0, abs=1e-12)


@pytest.mark.parametrize("name", ["binary counter"])
def test_growth_of_networks_for_parity(name):
    found = backpropagation.network(name, most=6, large=64)
    few, many = (int(word.replace(",", "")) for word in found.text.split() if word[0].isdigit()
                 and word.rstrip(",") not in ("6", "64"))  # fmt: skip
    assert found.value == pytest.approx(many / (64 * 6) / (few / (6 * log2(6))))


def test_networks_that_are_wrong_are_refused(monkeypatch):
    def odd(bits):
        return SimpleNamespace(output=lambda x: x[:, 0], coefficients=1)

    monkeypatch.setitem(backpropagation.parity_networks.NETWORKS, "wrong", odd)
    with pytest.raises(AssertionError, match="wrong is wrong at 2 bits"):
        backpropagation.network("wrong")


def test_units_and_steps_are_exact():
    assert backpropagation.unit().value < 1e-12
    assert 0 < backpropagation.chain_rule().value < 1e-4


# --- the family and its recordings -------------------------------------------------------------


def test_the_sine_in_closed_form():
    assert trajectories.period().value == pytest.approx(6.0)
    assert trajectories.period().text == "6.0 s; the motion lasts half of it"
    found = trajectories.start()
    assert found.value == 1.0
    assert found.text.startswith(f"starts at {SPEED:.2f} rad/s for an extent of 45°")
    assert trajectories.ends_and_middle().value is True


@pytest.mark.parametrize("away", [-0.1, 0.1])
@pytest.mark.parametrize("place", [0, 1])
def test_a_motion_that_ends_elsewhere_is_noticed(monkeypatch, away, place):
    def moved(extents, t):
        motion = pick_and_place(extents, t)
        motion.q[2, place * (t[1] > 2), 1] += away
        return motion

    monkeypatch.setattr(trajectories, "pick_and_place", moved)
    assert trajectories.ends_and_middle().value is False


def test_used_dimensions_are_of_both_joints():
    assert re.search(r"use \d+ of 42 dimensions$", trajectories.unreachable(21).text)


def test_samples_and_windows_of_the_recordings():
    assert trajectories.samples() == (300, "300 at 100 a second", None)
    found = trajectories.cases()
    assert found.value == 5 * 300
    assert found.text == "1,500 with the rests; windows within the motions give 1,450, 1,400, 1,300"


def test_misses_over_angles():
    motion = slice(1, 3)
    error = np.array([[[9, 9], [1, 0], [0, 1], [9, 9]]])
    angle = np.array([[[9, 9], [2, 2], [2, 2], [9, 9]]])
    run = SimpleNamespace(tracking_error=error, reference=SimpleNamespace(q=angle), motion=motion)
    assert trajectories._missed(run) == pytest.approx(np.sqrt(0.5) / 2)


def test_gains_from_which_the_arm_follows(monkeypatch):
    """Misses that fall with the square of the gain: 40 % at once, a tenth at twice the gain."""
    missed = {"position feedback": 0.4, "state feedback": 0.02}
    monkeypatch.setattr(trajectories.committed, "recording", lambda name: missed[name])
    monkeypatch.setattr(
        trajectories, "_missed", lambda x: x if isinstance(x, float) else 0.4 / x[0] ** 2
    )
    kp = np.array(POSITION_FEEDBACK.controller.kp)
    monkeypatch.setattr(
        type(POSITION_FEEDBACK), "record", lambda self: np.array(self.controller.kp) / kp
    )
    found = trajectories.driven(factors=(1, 3))
    assert found.value == pytest.approx(2.0)
    assert found.text == (
        "RMS error 40 % of the angle by position feedback, 2 % by state feedback; "
        "10 % from 2.0 times the assumed gains on"
    )


# --- the network of states ---------------------------------------------------------------------


def test_inputs_that_are_shuffled(monkeypatch):
    def shuffled(predict, states, scale):
        assert predict == "torque" and states.shape == (2000, 2, 3) and scale.shape == (2,)
        changes = np.ones((2, 3, 3))
        changes[0, 0] = [0.1, 0.2, 0.6]
        changes[1, 2] = 6.0
        return changes

    monkeypatch.setattr(networks, "_networks", lambda: SimpleNamespace(torque="torque"))
    monkeypatch.setattr(networks, "shuffled", shuffled)
    assert networks.shoulder_position().value == pytest.approx(0.2 / 2)


def test_transitions_within_the_range_of_velocity(monkeypatch):
    along = np.full((2, 5, 2, 3), 7.0)
    along[0, :3, 0, 1] = 0.9
    along[1, 0, 1, 0] = 0.9
    monkeypatch.setattr(networks, "_networks", lambda: SimpleNamespace(weights="weights"))
    monkeypatch.setattr(networks, "transition_range", lambda weights: along)
    found = networks.velocity_ranges()
    assert found.value == pytest.approx(0.3)
    assert found.text == "30 % of the units; of elbow position 10 %"


def test_the_shoulder_on_trajectory_6(monkeypatch):
    wanted = np.random.default_rng(0).normal(size=(300, 2))
    scatter = wanted.std(0)
    wrong = [wanted + np.array([f, 9.0]) * scatter for f in (0.1, 0.4, 0.2)]
    planted = SimpleNamespace(torque=lambda states: np.array(wrong))
    monkeypatch.setattr(networks, "_networks", lambda: planted)
    monkeypatch.setattr(networks, "states_along", lambda extents: tuple(extents))
    monkeypatch.setattr(networks, "torque", lambda states: wanted)
    assert networks.trajectory_shoulder().value == pytest.approx(0.2)


# --- the real arm ------------------------------------------------------------------------------


def test_shares_of_two_torques(monkeypatch):
    t = np.arange(3000) * 1e-3
    driven = np.ones((3000, 2)) * [4.0, -2.0]
    run = SimpleNamespace(t=t, motion=slice(None), tau_true=driven)
    monkeypatch.setattr(dynamics, "_ideal", lambda: run)
    left = np.ones((3000, 2)) * [1.0, -1.0]
    share, text = dynamics._shares(left)
    np.testing.assert_allclose(share, [0.25, 0.5])
    motion = dynamics.pick_and_place(dynamics.APPENDIX_I[5], t)
    asked = 100 / np.sqrt((dynamics.SETUP.arm.inverse_dynamics(*motion) ** 2).mean(0))
    assert text == (
        "25 % of the torque at the shoulder, 50 % at the elbow; "
        f"of what the reference asks for {asked[0]:.0f} and {asked[1]:.0f} %"
    )


def planted_runs(monkeypatch, left):
    """`_drive` is asked, notes the effects; each run leaves a constant torque at both joints."""
    asked = {}

    def drive(runs, **effects):
        asked.update(runs=runs, **effects)
        return SimpleNamespace(motion=slice(None))

    ideal = SimpleNamespace(motion=slice(None), tau_true=np.full((9, 2), 10.0))
    monkeypatch.setattr(dynamics, "_drive", drive)
    monkeypatch.setattr(dynamics, "_ideal", lambda: ideal)
    monkeypatch.setattr(
        dynamics, "residual_torque", lambda arm, run: np.ones((len(left), 9, 1)) * left[:, None]
    )
    monkeypatch.setattr(dynamics, "_shares", lambda torque: (None, "words"))
    return asked


def test_friction_that_is_significant(monkeypatch):
    """Shares in proportion to the multiple, the smaller one 10 %: a fifth at twice as much."""
    asked = planted_runs(monkeypatch, np.outer([1, 4], [1.0, 3.0]))
    found = dynamics.friction((1, 4))
    assert found.value == pytest.approx(2.0)
    assert found.text == "words; 20 % from 2.0 times the assumed friction on"
    viscous, coulomb = dynamics.SETUP.effects.friction
    own = asked["friction"]
    assert asked["runs"] == 2
    np.testing.assert_allclose(own[0].coefficient, np.outer([1, 4], viscous.coefficient))
    np.testing.assert_allclose(own[1].level, np.outer([1, 4], coulomb.level))


def test_play_that_is_significant(monkeypatch):
    """The run without play leaves torque too, which does not count."""
    asked = planted_runs(monkeypatch, 5.0 + np.outer([0, 1, 4], [0.5, 1.0]))
    dynamics._rattle.cache_clear()
    found = dynamics.backlash((1e-3, 4e-3))
    dynamics._rattle.cache_clear()
    assert found.value == pytest.approx(2e-3)
    assert found.text == (
        f"if it had gears, play of {np.rad2deg(1e-3):.2f}°: words; "
        f"20 % from {np.rad2deg(2e-3):.2f}° on"
    )
    (shaft,) = asked["transmission"]
    np.testing.assert_allclose(shaft.gap, [[0, 0], [1e-3, 1e-3], [4e-3, 4e-3]])
    assert asked["runs"] == 3


def test_softer_shafts(monkeypatch):
    asked = planted_runs(monkeypatch, np.array([[0.5, 1.0], [2.0, 1.0], [3.0, 9.0]]))
    found = dynamics.high_frequency()
    assert found.value == pytest.approx(0.1)
    assert found.text == (
        "springy shaft: words; the larger share is 20 % at 0.3, 90 % at 0.1 of the stiffness"
    )
    (shaft,) = asked["transmission"]
    np.testing.assert_allclose(shaft.stiffness, np.outer([1, 0.3, 0.1], dynamics.SHAFT.stiffness))
