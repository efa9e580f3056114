"""What single readings of a log show, on motions made for it, with and without each defect."""

import warnings
from dataclasses import fields, replace

import numpy as np
import pytest

from ddlib.control import pd
from ddlib.dynamics import CMU_DD_ARM_II
from ddlib.effects import CoulombFriction, Effects, Noise, Quantisation, ViscousFriction
from ddlib.identification import by_modulation
from ddlib.logs import DoubtfulRecording, LoggedRecording, warn_of
from ddlib.logs.readings import readings, spikes
from ddlib.simulation import record
from ddlib.trajectories import random_extents


def logged(recording, **changes):
    """A recording as a log has it."""
    parts = {field.name: getattr(recording, field.name) for field in fields(recording)} | changes
    return LoggedRecording(**parts)


@pytest.fixture(scope="module")
def recordings():
    """Eight logs of three motions each: what sensors do, and no defect."""
    out = []
    for seed in range(8):
        effects = Effects(
            friction=(ViscousFriction((0.5, 0.15)), CoulombFriction((0.5, 0.15))),
            encoder=(Quantisation(2 * np.pi / 2 ** (20 - seed % 4 * 2)),),
            torque_sensor=(Noise((0.02 + 0.05 * seed, 0.01)),),
        )
        kp = np.array([300.0, 90.0])
        extents = random_extents(6, seed=seed)[:3]
        recording = record(CMU_DD_ARM_II, pd(kp, 0.12 * kp), extents, effects=effects, seed=seed)
        out.append(logged(recording))
    return out


def angles(change):
    return lambda log: replace(log, q=change(log.q.copy()))


def torques(change):
    return lambda log: replace(log, tau=change(log.tau.copy()))


def moved(row, size):
    def change(x):
        x[1, row, 0] += size
        return x

    return change


def held(x):
    for begin in range(70, 330, 40):
        x[:, begin : begin + 6] = x[:, begin : begin + 1]
    return x


def zeroed(x):
    for begin in range(75, 330, 40):
        x[:, begin : begin + 3] = 0.0
    return x


def locked(x):
    return x * [1, 0] + np.random.default_rng(2).normal(0, 1e-4, x.shape) * [0, 1]


def wrapped(x):
    """The shoulder of an absolute encoder whose zero lies in the middle of the motion."""
    x[..., 0] = (x[..., 0] - np.median(x[..., 0])) % (2 * np.pi) - np.pi
    return x


def commanded(log):
    """The torque as a law computes it from a velocity by differences of noisy readings."""
    q = log.q + np.random.default_rng(1).normal(0.0, 2e-4, log.q.shape)
    speed = np.diff(q, axis=1, prepend=q[:, :1]) / log.step
    return replace(log, q=q, tau=log.tau - np.array([35.0, 10.0]) * speed)


DEFECTS = {
    "units of time": lambda log: replace(log, t=1000 * log.t),
    "units of angle": angles(lambda q: 57 * q),
    "units of torque": torques(lambda tau: 1000 * tau),
    "wrap": angles(wrapped),
    "spike": angles(moved(137, 0.05)),
    "spike at rest": angles(moved(15, 0.05)),
    "drop-outs (held)": angles(held),
    "drop-outs (zero)": angles(lambda q: zeroed(q + 0.4)),
    "saturation": torques(lambda tau: np.clip(tau, -0.5 * tau.max(), 0.5 * tau.max())),
    "no torque": torques(lambda tau: tau * [1, 0]),
    "at rest": angles(locked),
    "command": commanded,
    "slow readings": lambda log: log.mapped(lambda x: np.repeat(x[:, ::4], 4, axis=1)),
}
WARNED = ("units of time", "wrap", "spike", "spike at rest", "drop-outs (zero)")


def found(log, *severities):
    return {finding.kind for finding in readings(log) if finding.severity in severities}


def test_sound_readings_show_nothing(recordings):
    for log in recordings:
        assert found(log, "wrong", "doubtful") <= {"command"}
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            warn_of(log)


@pytest.mark.parametrize("defect", DEFECTS)
def test_defects_are_found(defect, recordings):
    kind, caught = defect.removesuffix(" at rest") if "spike" in defect else defect, 0
    for log in map(DEFECTS[defect], recordings):
        caught += kind in found(log, "wrong", "doubtful")
        assert not found(log, "wrong") - {kind, "spike", "units of angle"}
        with warnings.catch_warnings(record=True) as told:
            warnings.simplefilter("always")
            warn_of(log)
        assert bool(told) == bool(found(log, "wrong"))
        if defect in WARNED:
            (warning,) = told
            assert warning.category is DoubtfulRecording and kind in str(warning.message)
            assert len(str(warning.message)) < 300 and "\n" not in str(warning.message)
    assert caught >= (6 if kind == "command" else 8), caught


@pytest.mark.parametrize("change", [lambda tau: tau + 100, lambda tau: 0.01 * np.round(100 * tau)])
def test_a_torque_far_from_zero_or_in_steps_is_a_torque(change, recordings):
    for log in recordings:
        assert not found(torques(change)(log), "wrong", "doubtful") - {"command"}


def test_spikes_are_rare_in_noise_and_in_steps():
    """One false spike in 300,000 samples or fewer; nearly all of those that are planted."""
    rng, t = np.random.default_rng(3), np.arange(3000) * 0.002
    false = hits = 0
    for k in range(100):
        w, phase = rng.uniform(1.0, 20.0, (2, 3))
        q = sum(0.5 / (j + 1) * np.sin(w[j] * t + phase[j]) for j in range(3))
        step, noise = ((3.8e-4, 0), (1e-5, 0), (1e-9, 1e-4), (1e-3, 1e-3))[k % 4]
        q = np.round((q + rng.normal(0, noise + 1e-15, q.size)) / step) * step
        false += len(spikes(q)[0])
        row, size = 1000 + k, max(0.02, 30 * noise)
        q[row] += size
        rows, sizes = spikes(q)
        hits += row in rows and abs(sizes[rows == row][0] / size - 1) < 0.5
    assert false <= 1 and hits >= 97


def test_fits_to_a_log_warn_of_what_makes_them_wrong(recordings):
    log = recordings[0]
    spiked = DEFECTS["spike"](log)
    plain = record(CMU_DD_ARM_II, pd((300, 90), (36, 11)), random_extents(2, seed=0))
    simulated = replace(plain, q=moved(137, 0.05)(plain.q.copy()))
    with warnings.catch_warnings():
        warnings.simplefilter("error", DoubtfulRecording)
        by_modulation(log)
        by_modulation(simulated)  # it is what it is
    with pytest.warns(DoubtfulRecording, match=r"spike \(run 2, shoulder\)"):
        by_modulation(spiked)
